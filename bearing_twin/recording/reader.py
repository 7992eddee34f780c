# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read messages and contents of a ROS 2 recording: an MCAP file or a bag folder of files."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
import contextlib
from dataclasses import dataclass, field
import itertools
from pathlib import Path
import struct
from typing import BinaryIO

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.finding import natural, reading_hint
from bearing_twin.recording.mcap.catalogue import (
    Catalogue,
    DEFINITIONS,
    RecordedChannel,
    RecordedMessage,
)
from bearing_twin.recording.mcap.chunks import Chunks
from bearing_twin.recording.mcap.mcapfile import (
    BrokenRecording,
    check_magic,
    MAGIC,
    parse,
    RawRecord,
    read_record,
    record_at,
    refuse_special,
    UnfinishedRecording,
)
from bearing_twin.recording.mcap.messages import in_file_order, in_time_order, Selection
from bearing_twin.recording.mcap.salvage import MOST_TABLES, open_mcap
from bearing_twin.recording.mcap.summary import summary_records
from bearing_twin.stamps import NANO
from mcap.opcode import Opcode
from mcap.records import Attachment, Header, Metadata, Statistics

MOST_METADATA = 8 * 1024 * 1024
"""Most bytes of metadata that are read from a recording."""
ATTACHMENT_INDEX = struct.Struct('<32xQI')
"""Size of the attachment and length of its name; the name follows."""
METADATA_INDEX = struct.Struct('<Q')
"""Offset of the metadata record in the file."""


@dataclass
class TopicInfo:
    """One topic of a recording."""

    type_name: str
    type_hash: str
    qos: str
    """Offered QoS profiles in the YAML of rosbag2."""
    count: int = 0
    schemas: set[tuple[str, str, str]] = field(default_factory=set)
    """Type, encoding and definition; several if descriptions of the topic differ."""


@dataclass
class RecordingInfo:
    """Contents of a recording; times in ns."""

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
    """Whether no file lacks its end."""
    problems: list[str] = field(default_factory=list)
    """Errors of the parts that could not be read."""
    profile: str = ''
    library: str = ''
    topics: dict[str, TopicInfo] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    metadata_size: int = 0
    """Bytes of the metadata of the last file, without repetitions."""
    attachments: dict[str, int] = field(default_factory=dict)
    """Size in bytes, by name."""

    @property
    def duration(self) -> float:
        """Time between the first and the last message, s."""
        return (self.end - self.start) / NANO


def recording_files(path: Path) -> list[Path]:
    """Return the MCAP files of a recording in natural order of their names."""
    try:
        files = sorted(path.glob('*.mcap'), key=lambda file: natural(file.name))
        is_folder, exists = path.is_dir(), path.exists()
    except OSError as error:
        raise BearingTwinError(f'{path} cannot be read: {error.strerror}') from None
    if files:
        return files
    if is_folder or not exists:
        msg = f'{path} does not exist'
        if is_folder:
            # The folder of a demo holds the bag folder and its Rerun file.
            inside = sorted({str(found.parent) for found in path.glob('*/*.mcap')})
            hint = f'; name the bag in it, e.g. {inside[0]}' if inside else reading_hint(path)
            msg = f'{path} is no recording: no .mcap file is in it{hint}'
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
    problems: list[str] | None = None,
) -> Iterator[RecordedMessage]:
    """
    Yield the messages of a recording in the order of their log time.

    Files without an index (unfinished ones, or written without chunks) are read in file order. The
    memory in use is that of a few chunks.

    Parameters
    ----------
    path
        An MCAP file or a bag folder.
    topics
        Topics to yield; None for all.
    start, end
        First log time, and end (excluded), ns.
    recover
        Read an unfinished file up to its last complete record, and skip damaged chunks, instead of
        raising.
    problems
        List to which the errors of broken files in a bag folder are appended; the other files are
        read. With None the first broken file raises its error.

    Raises
    ------
    BearingTwinError
        If a file cannot be read, is unfinished or damaged. With ``problems``: only if all files
        are.

    """
    keep = Selection(topics, start, end)
    files = recording_files(path)
    broken: list[BrokenRecording] = []
    for file_path in files:
        yield from _messages_of(file_path, keep, broken, recover=recover)
        if broken and (problems is None or len(broken) == len(files)):
            raise broken[-1]
        if problems is not None:
            problems.extend(text for text in map(str, broken) if text not in problems)


def _messages_of(
    path: Path, keep: Selection, broken: list[BrokenRecording], *, recover: bool
) -> Iterator[RecordedMessage]:
    """Yield the messages of one file up to the first error, which is appended to ``broken``."""
    try:
        file = open_mcap(path)
    except BrokenRecording as error:
        broken.append(error)
        return
    with file:
        size = path.stat().st_size
        try:
            if recover:
                yield from in_file_order(file, size, keep, lambda _: None)
            else:
                yield from in_time_order(file, size, keep)
        except BrokenRecording as error:
            broken.append(_advised(path, error))


def _advised(path: Path, error: BrokenRecording) -> BrokenRecording:
    """Return the error with the name of the file and the remedy."""
    advice = f"'bearing-twin recover {path}' saves the rest"
    if isinstance(error, UnfinishedRecording):
        advice = f"mend it with 'bearing-twin recover {path}'"
    return type(error)(f'{path}: {error}; {advice}', error.offset, error.length)


def recording_info(
    path: Path,
    on_message: Callable[[RecordedMessage], object] | None = None,
    on_damage: Callable[[str], object] = str,
) -> RecordingInfo:
    """
    Return the contents of a recording, from its summary if it has one.

    An unfinished file is read from front to back. In a bag folder, a file that is not an MCAP file
    is listed among the problems. With ``on_message``, which is called with each message, every
    file is read completely; ``on_damage`` is called with file name and error of each damaged part.

    Raises
    ------
    BearingTwinError
        If there is no recording, or no file is an MCAP file.

    """
    info = RecordingInfo(path, recording_files(path))
    for file_path in list(info.files):
        try:
            file = open_mcap(file_path)
        except BrokenRecording as error:
            if info.files == [file_path]:
                raise
            info.size += error.length
            info.files.remove(file_path)
            info.finished = False
            info.problems.append(str(error))
            on_damage(str(error))
            continue
        with file:
            info.metadata_size = 0
            _look_into(file, file_path, info, on_message, on_damage)
    return info


def _look_into(
    file: BinaryIO,
    path: Path,
    info: RecordingInfo,
    on_message: Callable[[RecordedMessage], object] | None,
    on_damage: Callable[[str], object],
) -> None:
    size = path.stat().st_size
    info.size += size
    try:
        check_magic(file)
        told = _from_summary(file, size, info)
    except BrokenRecording as error:
        info.finished &= not isinstance(error, UnfinishedRecording)
        info.problems.append(f'{path.name}: {error}')
        told = False
    if told and on_message is None:
        return
    messages = in_file_order(
        file,
        size,
        Selection(),
        lambda error: on_damage(f'{path.name}: {error}'),
        extra=None if told else _extras(file, info),
    )
    if not told:
        with contextlib.suppress(BrokenRecording):
            # The error is already in the list of problems.
            _read_header(file, size, info)
        messages = _counted(messages, info)
    for message in messages:
        if on_message is not None:
            on_message(message)
        del message


def _from_summary(file: BinaryIO, size: int, info: RecordingInfo) -> bool:
    """Add the contents in the summary to ``info``; return False if it has no statistics."""
    catalogue = Catalogue(Chunks(file, size))
    last: tuple[RawRecord, bytes] | None = None
    attachments: dict[str, int] = {}
    # Offsets of metadata records, each once: an index may repeat an offset many times.
    metadata: dict[int, None] = {}
    wanted = (*DEFINITIONS, Opcode.STATISTICS, Opcode.ATTACHMENT_INDEX, Opcode.METADATA_INDEX)
    try:
        for raw, data in summary_records(file, size, wanted):
            if raw.opcode in DEFINITIONS:
                catalogue.learn(raw.opcode, data, raw.offset)
            elif raw.opcode == Opcode.STATISTICS:
                last = raw, data
            elif raw.opcode == Opcode.ATTACHMENT_INDEX:
                octets, length = ATTACHMENT_INDEX.unpack_from(data)
                begin = ATTACHMENT_INDEX.size
                attachments[data[begin : begin + length].decode()] = octets
            else:
                metadata[METADATA_INDEX.unpack_from(data)[0]] = None
    except (struct.error, UnicodeDecodeError) as error:
        msg = f'the summary is damaged: an index record cannot be read ({error})'
        raise BrokenRecording(msg, 0) from None
    if last is None:
        return False
    statistics = parse(last[0].opcode, last[1], last[0].offset)
    assert isinstance(statistics, Statistics)
    _read_header(file, size, info)
    info.attachments |= attachments
    for offset in itertools.islice(metadata, MOST_TABLES):
        _add_metadata(file, record_at(file, offset, size), info)
    if len(metadata) > MOST_TABLES:
        info.problems.append(f'more than {MOST_TABLES} records of metadata: no more are shown')
    for identity, channel in catalogue.channels.items():
        _count(info, channel, statistics.channel_message_counts.get(identity, 0))
    if statistics.message_count:
        _span(info, statistics.message_start_time, statistics.message_end_time)
    return True


def _add_metadata(file: BinaryIO, raw: RawRecord, info: RecordingInfo) -> None:
    if info.metadata_size > MOST_METADATA:
        text = f'more than {MOST_METADATA} bytes of metadata: the rest is not shown'
        if text not in info.problems:
            info.problems.append(text)
        return
    found = read_record(file, raw)
    if isinstance(found, Metadata) and info.metadata.get(found.name) != found.metadata:
        # Only new or changed metadata count: each file of a bag repeats them.
        info.metadata_size += raw.length
        info.metadata[found.name] = found.metadata


def _extras(file: BinaryIO, info: RecordingInfo) -> Callable[[RawRecord, bytes], None]:
    """Return a function that adds metadata and attachments of a file to ``info``."""

    def extra(raw: RawRecord, data: bytes) -> None:
        if raw.opcode == Opcode.METADATA:
            _add_metadata(file, raw, info)
        else:
            record = parse(raw.opcode, data, raw.offset)
            if isinstance(record, Attachment):
                info.attachments[record.name] = len(record.data)

    return extra


def _counted(
    messages: Iterator[RecordedMessage], info: RecordingInfo
) -> Iterator[RecordedMessage]:
    """Yield the messages; add topics and times to ``info``, once for each run on a channel."""
    channel: RecordedChannel | None = None
    count = first = last = 0
    for message in messages:
        log_time = message.log_time
        if message.channel is not channel:
            if channel is None:
                first = last = log_time
            else:
                _count(info, channel, count)
            channel, count = message.channel, 0
        count += 1
        if log_time < first:
            first = log_time
        if log_time > last:
            last = log_time
        yield message
        del message
    if channel is not None:
        _count(info, channel, count)
        _span(info, first, last)


def _read_header(file: BinaryIO, size: int, info: RecordingInfo) -> None:
    header = read_record(file, record_at(file, len(MAGIC), size))
    if isinstance(header, Header):
        info.profile, info.library = header.profile, header.library


def _count(info: RecordingInfo, channel: RecordedChannel, count: int) -> None:
    topic = info.topics.setdefault(
        channel.topic, TopicInfo(channel.type_name, channel.type_hash, channel.qos)
    )
    topic.schemas.add((channel.type_name, channel.schema_encoding, channel.schema))
    topic.count += count
    info.count += count


def _span(info: RecordingInfo, start: int, end: int) -> None:
    known = info.end or info.start
    info.start = min(info.start, start) if known else start
    info.end = max(info.end, end)
