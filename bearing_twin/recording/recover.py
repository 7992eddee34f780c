# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recover the complete messages of a recording after a crash, a full disk or a bad copy."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field
import fcntl
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcap.mcapfile import (
    BrokenRecording,
    check_magic,
    MAGIC,
    parse,
    read_record,
    record_at,
    refuse_special,
    UnfinishedRecording,
)
from bearing_twin.recording.mcap.messages import in_file_order, Selection
from bearing_twin.recording.mcap.salvage import open_mcap
from bearing_twin.recording.mcap.summary import summary_place, summary_records
from bearing_twin.recording.reader import recording_files
from bearing_twin.recording.writer import whole_recording
from bearing_twin.stamps import NANO
from mcap.opcode import Opcode
from mcap.records import Attachment, Header, Metadata, Statistics

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.catalogue import RecordedChannel, RecordedMessage
    from bearing_twin.recording.mcap.mcapfile import RawRecord
    from bearing_twin.recording.writer import RecordingWriter


MOST_LOOKED_AT = 1000
MOST_TOLD = 1000
"""Most losses that are listed one by one."""


@dataclass
class RecoveryReport:
    """Saved messages and losses of a recovery; times in ns."""

    source: Path
    target: Path
    kept: int = 0
    """Messages saved."""
    start: int = 0
    """First log time saved; 0 if no message was saved."""
    end: int = 0
    """Last log time saved."""
    topics: dict[str, int] = field(default_factory=dict)
    """Messages saved by topic."""
    size: int = 0
    """Bytes of the source."""
    lost_bytes: int = 0
    """Bytes of the source that could not be read as a recording."""
    lost_messages: int = 0
    """Messages that were not saved, in files whose sound summary states their number."""
    losses: list[str] = field(default_factory=list)
    """Losses and their causes, as sentences."""
    unlisted_losses: int = 0
    """Number of further losses that are not listed."""

    @property
    def duration(self) -> float:
        """Time saved, s."""
        return (self.end - self.start) / NANO

    def keep(self, message: RecordedMessage) -> None:
        """Add a saved message."""
        time = message.log_time
        self.start = min(self.start, time) if self.kept else time
        self.end = max(self.end, time)
        self.kept += 1
        self.topics[message.topic] = self.topics.get(message.topic, 0) + 1

    def lose(self, text: str, octets: int) -> None:
        """Add a loss of so many bytes (``octets``)."""
        self.lost_bytes += octets
        if len(self.losses) < MOST_TOLD:
            self.losses.append(text)
        else:
            self.unlisted_losses += 1


def recover(source: Path, target: Path) -> RecoveryReport:
    """
    Write every message in the sound chunks of ``source`` to the new recording ``target``.

    Damage loses the records between the last sound record before it and the next sound chunk. If
    the description of a channel is lost, it is taken from the summary or from other chunks.

    Raises
    ------
    BearingTwinError
        If no file of the source is a ROS 2 recording, if one is still being written, or if the
        target exists or cannot be written. Then no part of the target is left.

    """
    files = recording_files(source)
    for path in files:
        if _is_being_written(path):
            raise BearingTwinError(f'{path} is still being written; end its recorder first')
    report = RecoveryReport(source, target)
    sound = [path for path in files if _holds_something(path, report, only=len(files) == 1)]
    if not sound:
        msg = f'{source} holds no MCAP file with content: {"; ".join(report.losses)}'
        raise BearingTwinError(msg)
    with whole_recording(target) as writer:
        for path in sound:
            _copy(path, writer, report)
        if not report.kept and any('not as cdr' in text for text in report.losses):
            raise BearingTwinError('; '.join(report.losses))
    return report


def find_unfinished(folder: Path) -> list[Path]:
    """
    Return the recordings in ``folder`` that the recorder of this package left after a crash.

    The search covers MCAP files in the folder and in the bag folders inside it.
    """
    found = []
    candidates: list[Path] = []
    # A folder that cannot be listed (no file descriptor left, no permission) must not stop a
    # recorder from starting.
    with contextlib.suppress(OSError):
        candidates += [*folder.glob('*.mcap'), *folder.glob('*/*.mcap')]
    for path in sorted(candidates)[:MOST_LOOKED_AT]:
        # Nothing can be recovered from a file that is unreadable or not an MCAP file.
        with contextlib.suppress(BearingTwinError, OSError):
            if _is_our_torn_file(path):
                found.append(path.parent if path.parent != folder else path)
    return list(dict.fromkeys(found))


def _is_our_torn_file(path: Path) -> bool:
    refuse_special(path)
    with path.open('rb') as file:
        # A large file that does not begin as ours do is not searched: the recorder is starting.
        check_magic(file)
        size = path.stat().st_size
        try:
            summary_place(file, size)
        except UnfinishedRecording:
            header = read_record(file, record_at(file, len(MAGIC), size))
            ours = isinstance(header, Header) and header.library.startswith('bearing_twin ')
            return ours and not _is_being_written(path)
    return False


def _is_being_written(path: Path) -> bool:
    if not path.is_file():
        return False
    # An unreadable file is reported when it is opened for recovery.
    with contextlib.suppress(OSError), path.open('rb') as file:
        try:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False


def _holds_something(path: Path, report: RecoveryReport, *, only: bool) -> bool:
    try:
        open_mcap(path).close()
    except BrokenRecording as error:
        if only:
            raise
        report.size += error.length
        report.lose(str(error), error.length)
        return False
    return True


def _copy(path: Path, writer: RecordingWriter, report: RecoveryReport) -> None:
    size = path.stat().st_size
    report.size += size
    kept = report.kept

    def damaged(error: BrokenRecording) -> None:
        report.lose(f'{path.name}: {error}', error.length)

    def copy_extra(raw: RawRecord, data: bytes) -> None:
        record = parse(raw.opcode, data, raw.offset)
        if isinstance(record, Attachment):
            writer.attach(record.name, record.data, record.media_type)
        elif isinstance(record, Metadata) and record.name != 'rosbag2':
            writer.metadata(record.name, record.metadata)

    foreign: dict[RecordedChannel, tuple[int, int]] = {}
    with open_mcap(path) as file:
        # All files of a split recording have the same attachments: those of the first are enough.
        extra = None if writer.written else copy_extra
        for message in in_file_order(file, size, Selection(), damaged, extra):
            channel = message.channel
            if channel.encoding != 'cdr':
                messages, octets = foreign.get(channel, (0, 0))
                foreign[channel] = (messages + 1, octets + len(message.cdr))
                continue
            try:
                writer.copy(message)
            except BearingTwinError as error:
                report.lose(f'{path.name}: {channel.topic}: {error}', len(message.cdr))
                continue
            if writer.problem:
                raise BearingTwinError(writer.problem)
            report.keep(message)
        for channel, (messages, octets) in foreign.items():
            text = f'{channel.topic}: {messages} messages are encoded as {channel.encoding!r}'
            damaged(BrokenRecording(f'{text}, not as cdr', size, octets))
        report.lost_messages += max(0, _stated_count(path, size) - (report.kept - kept))


def _stated_count(path: Path, size: int) -> int:
    """Return the number of messages stated in the summary of a file; 0 if there is none."""
    with open_mcap(path) as file, contextlib.suppress(BrokenRecording):
        for raw, data in summary_records(file, size, (Opcode.STATISTICS,)):
            record = parse(raw.opcode, data, raw.offset)
            return record.message_count if isinstance(record, Statistics) else 0
    return 0
