# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Save what is complete in a recording that a crash, a full disk or a bad copy has left."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field
import fcntl
from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcapfile import (
    BrokenRecording,
    MAGIC,
    open_mcap,
    read_record,
    read_summary,
    UnfinishedRecording,
    walk,
)
from bearing_twin.recording.messages import in_file_order, Selection
from bearing_twin.recording.reader import recording_files
from bearing_twin.recording.writer import RecordingWriter
from bearing_twin.stamps import NANO
from mcap.opcode import Opcode
from mcap.records import Attachment, Header, Metadata

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ['RecoveryReport', 'find_unfinished', 'recover']

MOST_LOOKED_AT = 1000


@dataclass
class RecoveryReport:
    """What was saved and what was not; times in ns."""

    source: Path
    target: Path
    kept: int = 0
    """Messages saved."""
    start: int = 0
    """First log time saved; 0 where nothing was."""
    end: int = 0
    """Last log time saved."""
    topics: dict[str, int] = field(default_factory=dict)
    """Messages saved by topic."""
    size: int = 0
    """Bytes of the source."""
    lost_bytes: int = 0
    """Bytes of the source that hold something that could not be saved."""
    losses: list[str] = field(default_factory=list)
    """What was lost and why."""

    @property
    def duration(self) -> float:
        """Time saved, s."""
        return (self.end - self.start) / NANO


def recover(source: Path, target: Path) -> RecoveryReport:
    """
    Write every message in the complete chunks of ``source`` to the new recording ``target``.

    Parameters
    ----------
    source
        File or bag folder. It is not changed.
    target
        File (``.mcap``) or bag folder to make.

    Raises
    ------
    BearingTwinError
        If the source is no recording of ROS 2 or still being written, or the target exists or
        cannot be written.

    """
    files = recording_files(source)
    for path in files:
        if _is_being_written(path):
            msg = f'{path} is still being written; end its recorder first'
            raise BearingTwinError(msg)
    report = RecoveryReport(source, target)
    with RecordingWriter(target) as writer:
        for path in files:
            _copy(path, writer, report)
    return report


def find_unfinished(folder: Path) -> list[Path]:
    """
    Return the recordings of our own recorder under ``folder`` that a crash has left.

    Looked at are the MCAP files in the folder and in the bag folders in it.
    """
    found = []
    candidates = [*folder.glob('*.mcap'), *folder.glob('*/*.mcap')]
    for path in sorted(candidates)[:MOST_LOOKED_AT]:
        # A file that is not readable or no MCAP file offers nothing to recover.
        with contextlib.suppress(BearingTwinError, OSError):
            if _is_our_torn_file(path):
                found.append(path.parent if path.parent != folder else path)
    return list(dict.fromkeys(found))


def _is_our_torn_file(path: Path) -> bool:
    with open_mcap(path) as file:
        size = path.stat().st_size
        try:
            read_summary(file, size)
        except UnfinishedRecording:
            raw = next(walk(file, len(MAGIC), size), None)
            header = read_record(file, raw) if raw else None
            ours = isinstance(header, Header) and header.library.startswith('bearing_twin ')
            return ours and not _is_being_written(path)
    return False


def _is_being_written(path: Path) -> bool:
    with path.open('rb') as file:
        try:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False


def _copy(path: Path, writer: RecordingWriter, report: RecoveryReport) -> None:
    size = path.stat().st_size
    report.size += size

    def damaged(error: BrokenRecording) -> None:
        report.losses.append(f'{path.name}: {error}')
        if isinstance(error, UnfinishedRecording):
            report.lost_bytes += size - error.offset

    with open_mcap(path) as file:
        _copy_extras(path, size, writer)
        for message in in_file_order(file, size, Selection(), damaged):
            channel = message.channel
            if channel.encoding != 'cdr':
                msg = f'{path}: {channel.topic} is encoded as {channel.encoding!r}, not as cdr'
                raise BearingTwinError(msg)
            writer.copy(message)
            first = not report.kept
            report.kept += 1
            report.topics[channel.topic] = report.topics.get(channel.topic, 0) + 1
            report.start = message.log_time if first else min(report.start, message.log_time)
            report.end = max(report.end, message.log_time)


def _copy_extras(path: Path, size: int, writer: RecordingWriter) -> None:
    """Copy attachments and metadata; of a split recording, those of the first file are enough."""
    if writer.written:
        return
    with open_mcap(path) as file:
        try:
            for raw in walk(file, len(MAGIC), size):
                if raw.opcode not in (Opcode.ATTACHMENT, Opcode.METADATA):
                    continue
                record = read_record(file, raw)
                if isinstance(record, Attachment):
                    writer.attach(record.name, record.data, record.media_type)
                elif isinstance(record, Metadata) and record.name != 'rosbag2':
                    writer.metadata(record.name, record.metadata)
        except BrokenRecording:
            # Reported when the messages are copied.
            return
