# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages of a ROS 2 recording in MCAP, and what is inside: a file, or a bag folder of files."""

from __future__ import annotations

from dataclasses import dataclass, field
import re
from typing import BinaryIO, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcapfile import (
    BrokenRecording,
    MAGIC,
    open_mcap,
    read_record,
    read_summary,
    refuse_special,
    UnfinishedRecording,
    walk,
)
from bearing_twin.recording.messages import (
    Catalogue,
    in_file_order,
    in_time_order,
    known_fields,
    RecordedChannel,
    RecordedMessage,
    Selection,
)
from bearing_twin.stamps import NANO
from mcap.records import Attachment, AttachmentIndex, Header, Metadata, MetadataIndex, Statistics

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from pathlib import Path

__all__ = [
    'RecordedChannel',
    'RecordedMessage',
    'RecordingInfo',
    'TopicInfo',
    'known_fields',
    'read_messages',
    'recording_files',
    'recording_info',
]


@dataclass
class TopicInfo:
    """One topic of a recording."""

    type_name: str
    type_hash: str
    qos: str
    """Offered profiles as rosbag2 writes them, YAML."""
    count: int = 0


@dataclass
class RecordingInfo:
    """What is inside a recording; times in ns."""

    path: Path
    files: list[Path]
    size: int = 0
    """Bytes of all files."""
    start: int = 0
    """First log time; 0 without messages."""
    end: int = 0
    """Last log time; 0 without messages."""
    count: int = 0
    """Messages."""
    finished: bool = True
    """Whether every file has its end."""
    problems: list[str] = field(default_factory=list)
    """What could not be read."""
    profile: str = ''
    library: str = ''
    topics: dict[str, TopicInfo] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, int] = field(default_factory=dict)
    """Name and size in bytes."""

    @property
    def duration(self) -> float:
        """Time between the first and the last message, s."""
        return (self.end - self.start) / NANO


def recording_files(path: Path) -> list[Path]:
    """
    Return the MCAP files of a recording, in their order.

    Raises
    ------
    BearingTwinError
        If there is none, or one is a pipe, socket or device.

    """
    if path.is_dir():
        files = sorted(path.glob('*.mcap'), key=_natural)
        if files:
            for file in files:
                refuse_special(file)
            return files
        msg = f'{path} is no recording: no .mcap file is in it'
        raise BearingTwinError(msg)
    if not path.exists():
        msg = f'{path} does not exist'
        raise BearingTwinError(msg)
    refuse_special(path)
    return [path]


def read_messages(
    path: Path,
    *,
    topics: Collection[str] | None = None,
    start: int | None = None,
    end: int | None = None,
    recover: bool = False,
) -> Iterator[RecordedMessage]:
    """
    Yield the messages of a recording in the order of their log time.

    Files without an index (unfinished ones, or written without chunks) are read in the order in
    which they were written. Memory stays within that of a few chunks.

    Parameters
    ----------
    path
        An MCAP file or a bag folder.
    topics
        Topics to yield; None for all.
    start, end
        First log time, and the one before which to end, ns.
    recover
        Read a file without end up to where it breaks off, and step over damaged chunks, instead of
        raising.

    Raises
    ------
    BearingTwinError
        If a file cannot be read, is unfinished or damaged.

    """
    keep = Selection(topics, start, end)
    for file_path in recording_files(path):
        with open_mcap(file_path) as file:
            size = file_path.stat().st_size
            try:
                if recover:
                    yield from in_file_order(file, size, keep, lambda _: None)
                else:
                    yield from in_time_order(file, size, keep)
            except UnfinishedRecording as error:
                msg = f"{file_path}: {error}; mend it with 'bearing-twin recover {file_path}'"
                raise UnfinishedRecording(msg, error.offset) from None
            except BrokenRecording as error:
                msg = f"{file_path}: {error}; 'bearing-twin recover {file_path}' saves the rest"
                raise BrokenRecording(msg, error.offset) from None


def _natural(path: Path) -> list[tuple[int, str]]:
    """Sort key that puts bag_10 after bag_9."""
    words = re.split(r'(\d+)', path.name)
    return [(int(word), '') if word.isdigit() else (-1, word) for word in words]


def recording_info(path: Path) -> RecordingInfo:
    """
    Say what is inside a recording, from its summary where it has one.

    A file without end is read from front to back, as far as it goes.

    Raises
    ------
    BearingTwinError
        If there is no recording, or a file is no MCAP file.

    """
    info = RecordingInfo(path, recording_files(path))
    for file_path in info.files:
        with open_mcap(file_path) as file:
            size = file_path.stat().st_size
            info.size += size
            try:
                _from_summary(file, size, info)
            except BrokenRecording as error:
                info.finished &= not isinstance(error, UnfinishedRecording)
                info.problems.append(f'{file_path.name}: {error}')
                _from_messages(file, size, info)
    return info


def _from_summary(file: BinaryIO, size: int, info: RecordingInfo) -> None:
    records = read_summary(file, size)
    statistics = next((r for r in records if isinstance(r, Statistics)), None)
    if statistics is None:
        _from_messages(file, size, info)
        return
    _read_header(file, size, info)
    catalogue = Catalogue()
    for record in records:
        catalogue.learn(record)
        if isinstance(record, AttachmentIndex):
            info.attachments[record.name] = record.data_size
        elif isinstance(record, MetadataIndex):
            raw = next(walk(file, record.offset, size), None)
            found = read_record(file, raw) if raw else None
            if isinstance(found, Metadata):
                info.metadata[found.name] = found.metadata
    for identity, channel in catalogue.channels.items():
        count = statistics.channel_message_counts.get(identity, 0)
        _count(info, channel, count)
    if statistics.message_count:
        _span(info, statistics.message_start_time, statistics.message_end_time)


def _from_messages(file: BinaryIO, size: int, info: RecordingInfo) -> None:
    _read_header(file, size, info)
    for message in in_file_order(file, size, Selection(), lambda _: None):
        _count(info, message.channel, 1)
        _span(info, message.log_time, message.log_time)
    try:
        for raw in walk(file, len(MAGIC), size):
            record = read_record(file, raw) if raw.opcode in (9, 12) else None
            if isinstance(record, Metadata):
                info.metadata[record.name] = record.metadata
            elif isinstance(record, Attachment):
                info.attachments[record.name] = len(record.data)
    except BrokenRecording:
        # Already in the list of problems.
        return


def _read_header(file: BinaryIO, size: int, info: RecordingInfo) -> None:
    raw = next(walk(file, len(MAGIC), size), None)
    header = read_record(file, raw) if raw else None
    if isinstance(header, Header):
        info.profile, info.library = header.profile, header.library


def _count(info: RecordingInfo, channel: RecordedChannel, count: int) -> None:
    topic = info.topics.setdefault(
        channel.topic, TopicInfo(channel.type_name, channel.type_hash, channel.qos)
    )
    topic.count += count
    info.count += count


def _span(info: RecordingInfo, start: int, end: int) -> None:
    known = info.end or info.start
    info.start = min(info.start, start) if known else start
    info.end = max(info.end, end)
