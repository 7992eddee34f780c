# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Write ROS 2 recordings in MCAP: a new single file or a new bag folder.

The path of a message:

=========================  ======================================================================
`RecordingWriter.write`    checks it
`RecordingWriter.take`     writes it to the current file; it waits while the disk has a problem
`OutputFile.write`         describes its channel and adds it to the open chunk
`RecordingWriter.flush`    closes the chunk and gives all bytes to the operating system
`RecordingWriter.split`    ends the file and opens the next one
`FinishedFiles`            lists the ended files in ``metadata.yaml``
=========================  ======================================================================
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
import contextlib
from dataclasses import dataclass
from pathlib import Path
import time
from typing import Self, TYPE_CHECKING

from bearing_twin.disksync import DiskSync
from bearing_twin.errors import BearingTwinError, UsageError
from bearing_twin.quantity import check_fields, quantity
from bearing_twin.recording.bagmetadata import FinishedFiles
from bearing_twin.recording.mcap.schema import message_schema
from bearing_twin.recording.outfile import Attachment, MessageToStore, OutputFile
from bearing_twin.stamps import NANO

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.catalogue import RecordedMessage
    from bearing_twin.recording.mcap.schema import MessageSchema


LATEST = 2**63
"""Earliest time that MCAP cannot hold, ns."""


@dataclass(frozen=True, kw_only=True)
class WriterOptions:
    """Options of a recording."""

    compression: str = quantity(
        'zstd', 'Compression of the chunks.', choices=('zstd', 'lz4', 'none'), running=False
    )
    chunk_size: int = 1024 * 1024
    """Size at which a chunk is closed, bytes."""
    flush_period: float = quantity(
        0.5, 'Most recorded time that a crash can lose.', 's', 0.05, 60.0, running=False
    )
    """Time after which a chunk is closed, s."""
    split_size: int = 0
    """Size at which a bag folder continues in a new file, bytes; 0: never."""
    split_duration: float = quantity(
        0.0, 'Log time after which a new file is begun', 's', 0.0, 1e7, special=(0.0, 'never'),
        running=False,
    )  # fmt: skip
    storage_limit: int = 0
    """Largest size of the recording, bytes; 0: no limit."""
    delete_oldest: bool = quantity(
        False, 'At the limit delete the oldest file of this recording instead of stopping; '
        'needs max_bag_size or max_bag_duration.', running=False,
    )  # fmt: skip
    cache_size: int = 64 * 1024 * 1024
    """Most bytes that wait in memory while the disk cannot be written."""
    sync_period: float = quantity(
        5.0,
        'Interval of synchronising the files with the disk, in the background. A loss of power '
        'costs at most this and flush_period', 's', 0.0, 3600.0,
        special=(0.0, 'left to the operating system'), running=False,
    )  # fmt: skip


class RecordingWriter:
    """
    Write messages to a recording that can be read at any time.

    A path that ends in ``.mcap`` is a single file; any other path is a bag folder ``NAME`` with
    ``NAME_0.mcap``, ``NAME_1.mcap``, ... and ``metadata.yaml``.

    A disk that is full, gone or not writable does not stop the caller. Messages wait in memory up
    to ``cache_size``; then the newest are dropped and counted. :attr:`problem` names the cause.
    Writing continues in the same file as soon as the disk accepts data.

    Leaving the context finishes the recording. With ``begin`` False a subclass makes it later.

    Raises
    ------
    BearingTwinError
        If the path exists or cannot be made, or if the options contradict each other.

    """

    def __init__(
        self, path: Path, options: WriterOptions | None = None, *, begin: bool = True
    ) -> None:
        self.path = path
        self.options = options or WriterOptions()
        self.bag = path.suffix != '.mcap'
        self.problem = ''
        """Why messages cannot be written to the disk; '' if they can."""
        self.stopped = ''
        """Why the recording has stopped by itself (storage limit); '' if it has not."""
        self.written = 0
        """Messages written to the files."""
        self.dropped = 0
        """Messages lost because the disk failed and the memory for waiting messages was full."""
        self.removed = 0
        """Messages lost with files that were removed during the recording."""
        self._check_options()
        self._waiting: deque[MessageToStore] = deque()
        self._waiting_bytes = 0
        self._attached: list[Attachment] = []
        # Files whose end is not written yet.
        self._ending: list[OutputFile] = []
        self._disk = DiskSync()
        self._finished = FinishedFiles(self.path, self._disk)
        self._index = 0
        self._begun = self._closed = False
        if begin:
            self._begin()

    def __enter__(self) -> Self:
        """Return the writer."""
        return self

    def __exit__(self, *_: object) -> None:
        """Finish the recording."""
        self.close()

    def _begin(self) -> None:
        """Make the recording and its first file."""
        path = self.path
        try:
            if path.exists():
                msg = f'{path} exists and is not overwritten; choose another name'
                raise BearingTwinError(msg)
            # Another recorder may make the same folder, or the same file, at this moment.
            (path if self.bag else path.parent).mkdir(parents=True, exist_ok=not self.bag)
        except OSError as error:
            raise BearingTwinError(f'{path} cannot be made: {error.strerror}') from None
        self._file = self._open()
        self._flushed = self._synced = time.monotonic()
        problem = self._file.drain()
        if problem:
            self._remove()
            raise BearingTwinError(f'the recording cannot be made: {problem}')
        self._begun = True

    @property
    def lost(self) -> int:
        """Messages lost: dropped, or removed with their files."""
        return self.dropped + self.removed

    @property
    def sync_problem(self) -> str:
        """Return the reason of a failed synchronisation with the disk; '' if none ever failed."""
        return self._disk.problem

    @property
    def size(self) -> int:
        """Bytes of the recording so far, including those still in memory."""
        open_files = [self._file] if self._begun and not self._closed else []
        return self._finished.size + sum(file.size for file in (*self._ending, *open_files))

    def write(
        self,
        topic: str,
        type_name: str,
        cdr: bytes,
        *,
        log_time: int,
        publish_time: int | None = None,
        qos: str = '',
        schema: MessageSchema | None = None,
    ) -> None:
        """
        Check and store one serialised message.

        Parameters
        ----------
        topic, type_name
            Topic, and type as ``pkg/msg/Type``.
        cdr
            The message with its CDR header, as received.
        log_time, publish_time
            Time of reception and time of sending, ns. With None it was received as it was sent.
        qos
            Offered QoS profiles, YAML (:func:`bearing_twin.recording.qos.qos_yaml`). Those of the
            first message of a topic are stored.
        schema
            Schema of the message. With None the installed package provides it.

        """
        schema = schema or message_schema(type_name)
        publish_time = log_time if publish_time is None else publish_time
        if not (0 <= log_time < LATEST and 0 <= publish_time < LATEST):
            raise BearingTwinError(f'{log_time=}, {publish_time=}: times are 0..{LATEST - 1} ns')
        self.take(MessageToStore(topic, type_name, cdr, log_time, publish_time, qos, schema))

    def copy(self, message: RecordedMessage) -> None:
        """Store a message from a recording unchanged; raises as :meth:`write`."""
        channel = message.channel
        self.write(
            channel.topic,
            channel.type_name,
            message.cdr,
            log_time=message.log_time,
            publish_time=message.publish_time,
            qos=channel.qos,
            schema=channel.message_schema,
        )

    def take(self, message: MessageToStore) -> None:
        """
        Write one checked message; callers use :meth:`write`, which checks it.

        Raises
        ------
        BearingTwinError
            If a single file has no channel number left for another topic.

        """
        if self.stopped:
            self.dropped += 1
            return
        if self.problem:
            if self._waiting_bytes + message.memory > self.options.cache_size:
                self.dropped += 1
            else:
                self._waiting.append(message)
                self._waiting_bytes += message.memory
        else:
            self._put(message)
        if time.monotonic() - self._flushed >= self.options.flush_period:
            self.flush()

    def add(self, attached: Attachment) -> None:
        """Add an attachment or a metadata record to this file and all later ones."""
        self._attached.append(attached)
        if self._begun:
            self._file.attach(attached)

    def attach(self, name: str, data: bytes, media_type: str) -> None:
        """Attach a small file to every file of the recording."""
        self.add(Attachment(name, media_type=media_type, data=data))

    def metadata(self, name: str, values: dict[str, str]) -> None:
        """Add named texts to every file of the recording; what is not UTF-8 is escaped."""
        known = {
            key: text.encode(errors='backslashreplace').decode() for key, text in values.items()
        }
        self.add(Attachment(name, values=known))

    def flush(self) -> None:
        """Close the chunk and write all bytes to the operating system; sets :attr:`problem`."""
        self._flushed = time.monotonic()
        self.problem = self._settle() or self._file.drain()
        if self._file.vanished or self._file.alone:
            # Others may be gone with it, or with its folder.
            self._file.alone = False
            self._lose(self._finished.forget_removed())
        if self._file.vanished:
            # The recording continues in a new file.
            self._lose(self._file.count)
            self._file.abandon()
            self._open_next()
        elif not self.problem:
            self._sync()
        while self._waiting and not self.problem:
            message = self._waiting.popleft()
            self._waiting_bytes -= message.memory
            try:
                self._put(message)
            except BearingTwinError:
                self.dropped += 1
        if not self.problem:
            self._keep_within_limit()

    def split(self) -> None:
        """Continue in a new file (bag folders only)."""
        self._check_bag()
        self._finish()
        self.problem = self._settle()
        self._open_next()

    def close(self) -> None:
        """
        Finish the recording; a second call does nothing.

        Raises
        ------
        BearingTwinError
            If the end could not be written. The flushed messages can then be recovered.

        """
        if self._closed:
            return
        self._closed = True
        self.flush()
        self._finish()
        self.problem = self._settle()
        self._disk.settle()
        self.problem = self.problem or self._finished.unlisted
        if self.problem:
            lost = len(self._waiting)
            for file in self._ending:
                lost += file.count - file.given
                file.abandon()
            raise BearingTwinError(
                f'{self.path} could not be finished: {self.problem}; {lost} messages'
                f" are lost, 'bearing-twin recover {self.path}' saves the rest"
            )

    def discard(self) -> None:
        """Close and remove all files of the recording, so that no incomplete result is left."""
        self._closed = True
        self._remove()

    def _remove(self) -> None:
        self._disk.settle()
        for file in (*self._ending, self._file):
            file.abandon()
        names = [file.name for file in self._finished.files]
        names += [file.path.name for file in (*self._ending, self._file) if file.made]
        folder = self.path if self.bag else self.path.parent
        with contextlib.suppress(OSError):
            for name in (*names, *(('metadata.yaml',) if self.bag else ())):
                (folder / name).unlink(missing_ok=True)
            if self.bag:
                folder.rmdir()

    def _check_options(self) -> None:
        o = self.options
        check_fields(o)
        try:
            # A bag stores the name in its metadata.yaml, which is UTF-8.
            self.path.name.encode()
        except UnicodeEncodeError:
            msg = f'{str(self.path)!r} is not UTF-8; choose another name'
            raise UsageError(msg) from None
        splits = o.split_size > 0 or o.split_duration > 0
        if splits:
            self._check_bag()
        if o.delete_oldest and not (splits and o.storage_limit > 0):
            msg = 'deleting the oldest file needs a storage limit, and a split size or duration'
            raise UsageError(msg)

    def _check_bag(self) -> None:
        if not self.bag:
            msg = f'{self.path} is a single file and cannot be split; give a folder name'
            raise UsageError(msg)

    def _open(self) -> OutputFile:
        name = f'{self.path.name}_{self._index}.mcap'
        file = OutputFile(
            self.path / name if self.bag else self.path,
            compression=self.options.compression,
            chunk_size=self.options.chunk_size,
        )
        for attached in self._attached:
            file.attach(attached)
        return file

    def _open_next(self) -> None:
        self._index += 1
        self._file = self._open()

    def _sync(self) -> None:
        """Synchronise the file with the disk when due, unless the last request still runs."""
        period = self.options.sync_period
        due = 0.0 < period <= time.monotonic() - self._synced
        if due and not self._disk.busy:
            self._synced = time.monotonic()
            self._file.sync(self._disk)

    def _lose(self, count: int) -> None:
        self.removed += count
        self.written -= count

    def _put(self, message: MessageToStore) -> None:
        numbered = self._file.knows(message)
        if not (numbered or self.bag):
            raise BearingTwinError(
                f'{self.path} has as many topics as MCAP can number: no number is left for '
                f'{message.topic!r:.60}; give a folder name, which goes on in a further file'
            )
        if not numbered or self._is_full(message.log_time):
            self.split()
        self._file.write(message)
        self.written += 1

    def _is_full(self, log_time: int) -> bool:
        o, file = self.options, self._file
        if not file.count or self.problem:
            return False
        sizes = [o.split_size, o.storage_limit // 2 if o.delete_oldest else 0]
        # Half of the limit, so that there is an older file to delete at the limit.
        too_large = any(0 < size <= file.size for size in sizes)
        too_long = 0 < o.split_duration * NANO <= log_time - file.start
        return too_large or too_long

    def _keep_within_limit(self) -> None:
        o = self.options
        if not o.delete_oldest:
            if 0 < o.storage_limit < self.size:
                self.stopped = f'the storage limit of {o.storage_limit} bytes is reached'
            return
        while (
            self._finished.files
            and not self.problem
            and (self._finished.too_many or self.size > o.storage_limit)
        ):
            self.problem = self._finished.delete_oldest()

    def _finish(self) -> None:
        """Write the end of the current file to its spool."""
        self._file.end()
        self._ending.append(self._file)

    def _settle(self) -> str:
        """Write ended files, and metadata.yaml of a bag; return the error, '' if none."""
        while self._ending:
            file = self._ending[0]
            problem = file.close(self._disk if self.options.sync_period else None)
            if problem:
                return problem
            del self._ending[0]
            if file.vanished:
                self._lose(file.count)
                continue
            self._finished.files.append(file.summary())
            if self._finished.too_many and not self.options.delete_oldest:
                self._finished.leave_out_oldest()
            if self.bag:
                self._finished.write_list()
        return ''


@contextlib.contextmanager
def whole_recording(path: Path) -> Iterator[RecordingWriter]:
    """
    Open a writer of a recording that is removed after an error, so that it is complete or absent.

    Raises
    ------
    BearingTwinError
        As RecordingWriter, and if not all messages could be written.

    """
    writer = RecordingWriter(path)
    try:
        with writer:
            yield writer
        if writer.lost:
            msg = f'{writer.lost} messages found no room in memory while the disk was full'
            raise BearingTwinError(msg)
    except BaseException as error:
        # Also after Ctrl-C: the incomplete recording would look complete.
        writer.discard()
        if isinstance(error, BearingTwinError) and (writer.problem or writer.lost):
            reason = writer.problem or error
            msg = f'{path} was not written: {reason}; make room, or choose another disk'
            raise BearingTwinError(msg) from None
        raise
