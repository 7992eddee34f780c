# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Write ROS 2 recordings in MCAP: a single file or a bag folder, never over an existing one."""

from __future__ import annotations

from collections import deque
import contextlib
from dataclasses import dataclass
import time
from typing import TYPE_CHECKING

from bearing_twin.disksync import DiskSync
from bearing_twin.errors import BearingTwinError
from bearing_twin.quantity import check_fields, quantity
from bearing_twin.recording.bagmetadata import BagFile, metadata_record, write_metadata_file
from bearing_twin.recording.outfile import OutputFile
from bearing_twin.recording.sink import Attached, MessageSink, Written
from bearing_twin.stamps import NANO

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


MOST_FILES = 10_000
"""Most files of a bag that metadata.yaml names: it takes 0.12 ms for each, at each split."""


@dataclass(frozen=True, kw_only=True)
class WriterOptions:
    """How a recording is written."""

    compression: str = quantity(
        'zstd', 'Compression of the chunks.', choices=('zstd', 'lz4', 'none'), running=False
    )
    chunk_size: int = 1024 * 1024
    """A chunk is closed when it holds this many bytes..."""
    flush_period: float = quantity(
        0.5, 'Most recorded time that a crash can lose.', 's', 0.05, 60.0, running=False
    )
    """...or when this time has passed."""
    split_size: int = 0
    """Bytes after which a bag folder goes on in a new file; 0: never."""
    split_duration: float = quantity(
        0.0, 'Log time after which a new file is begun', 's', 0.0, 1e7, special=(0.0, 'never'),
        running=False,
    )  # fmt: skip
    storage_limit: int = 0
    """Most bytes the recording may take; 0: no limit."""
    delete_oldest: bool = quantity(
        False, 'At the limit delete the oldest file of this recording instead of stopping; '
        'needs max_bag_size or max_bag_duration.', running=False,
    )  # fmt: skip
    cache_size: int = 64 * 1024 * 1024
    """Most bytes that wait in memory while the disk takes none."""
    sync_period: float = quantity(
        5.0,
        'Interval of synchronising the files with the disk, in the background. A loss of power '
        'costs at most this and flush_period', 's', 0.0, 3600.0,
        special=(0.0, 'left to the operating system'), running=False,
    )  # fmt: skip


class RecordingWriter(MessageSink):
    """
    Write messages to a recording that others can read at any time.

    A path that ends in ``.mcap`` is a single file, any other one a bag folder ``NAME`` with
    ``NAME_0.mcap``, ``NAME_1.mcap``, ... and ``metadata.yaml``.

    A disk that is full, gone or not writable does not stop the caller: messages wait in memory up
    to ``cache_size``, then the newest are dropped and counted, :attr:`problem` says what is wrong,
    and writing goes on in the same file as soon as the disk takes it.

    Raises
    ------
    BearingTwinError
        If the path exists, cannot be made, or the options do not fit together.

    """

    def __init__(self, path: Path, options: WriterOptions | None = None) -> None:
        self.path = path
        self.options = options or WriterOptions()
        self.bag = path.suffix != '.mcap'
        self.problem = ''
        """What keeps messages from the disk; '' if nothing."""
        self.stopped = ''
        """Why the recording has ended by itself (storage limit); '' if it has not."""
        self.written = 0
        """Messages given to the file."""
        self.dropped = 0
        """Messages lost because the disk took none and the memory for them was full."""
        self.removed = 0
        """Messages lost with files that somebody removed while they were being written."""
        self._check_options()
        self._waiting: deque[Written] = deque()
        self._waiting_bytes = 0
        self._attached: list[Attached] = []
        self._finished: list[BagFile] = []
        # Messages and bytes of files before them, which are no longer listed.
        self._earlier_count = self._earlier_size = 0
        # Files whose end the disk has not taken yet.
        self._ending: list[OutputFile] = []
        # What is wrong with metadata.yaml, the files that it is to name, and those it names.
        self._unlisted = ''
        self._to_list = self._listed = list[BagFile]()
        self._index = 0
        self._flushed = self._synced = time.monotonic()
        self._disk = DiskSync()
        self._closed = False
        try:
            if path.exists():
                msg = f'{path} exists and is not overwritten; choose another name'
                raise BearingTwinError(msg)
            (path if self.bag else path.parent).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            msg = f'{path} cannot be made: {error.strerror}'
            raise BearingTwinError(msg) from None
        self._file = self._open()
        problem = self._file.drain()
        if problem:
            msg = f'the recording cannot be made: {problem}'
            raise BearingTwinError(msg)

    @property
    def lost(self) -> int:
        """Messages lost: dropped, or removed with their files."""
        return self.dropped + self.removed

    @property
    def sync_problem(self) -> str:
        """Return why the disk has not kept what it was given; '' if it has. It stays."""
        return self._disk.problem

    @property
    def size(self) -> int:
        """Bytes of the recording so far, those still in memory included."""
        finished = self._earlier_size + sum(file.size for file in self._finished)
        unfinished = self._ending if self._closed else (*self._ending, self._file)
        return finished + sum(file.size for file in unfinished)

    def take(self, message: Written) -> None:
        """
        Write one message that has been checked; :meth:`write` is the door.

        Raises
        ------
        BearingTwinError
            If a single file has no number left for a further topic.

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

    def add(self, attached: Attached) -> None:
        """Add it to every file of a split recording."""
        self._attached.append(attached)
        self._file.attach(attached)

    def flush(self) -> None:
        """Close the chunk and hand everything to the operating system; see :attr:`problem`."""
        self._flushed = time.monotonic()
        self.problem = self._settle() or self._file.drain()
        if self._file.vanished or self._file.alone:
            self._count_removed()
        if self._file.vanished:
            # What it held is gone with it; the recording goes on in a new file.
            self._lose(self._file.count)
            self._file.abandon()
            self._index += 1
            self._file = self._open()
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
        """Go on in a new file (bag folders only)."""
        self._check_bag()
        self._finish()
        self.problem = self._settle()
        self._index += 1
        self._file = self._open()

    def close(self) -> None:
        """
        Finish the recording; a second call does nothing.

        Raises
        ------
        BearingTwinError
            If the end could not be written: what has been flushed can then be recovered.

        """
        if self._closed:
            return
        self._closed = True
        self.flush()
        self._finish()
        self.problem = self._settle()
        self._disk.settle()
        if self._listed is not self._to_list:
            self._unlisted = 'metadata.yaml waits for the disk'
        self.problem = self.problem or self._unlisted
        if self.problem:
            lost = len(self._waiting)
            for file in self._ending:
                lost += file.count - file.given
                file.abandon()
            msg = (
                f'{self.path} could not be finished: {self.problem}; {lost} messages'
                f" are lost, 'bearing-twin recover {self.path}' saves the rest"
            )
            raise BearingTwinError(msg)

    def discard(self) -> None:
        """Remove what has been made of the recording: a result that was not to be left cut."""
        self._closed = True
        self._disk.settle()
        for file in (*self._ending, self._file):
            file.abandon()
        names = [file.name for file in self._finished]
        names += [file.path.name for file in (*self._ending, self._file)]
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
            # A bag says it in its metadata.yaml, which is UTF-8.
            self.path.name.encode()
        except UnicodeEncodeError:
            msg = f'{str(self.path)!r} is not UTF-8; choose another name'
            raise BearingTwinError(msg) from None
        splits = o.split_size > 0 or o.split_duration > 0
        if splits:
            self._check_bag()
        if o.delete_oldest and not (splits and o.storage_limit > 0):
            msg = 'deleting the oldest file needs a storage limit, and a split size or duration'
            raise BearingTwinError(msg)

    def _check_bag(self) -> None:
        if not self.bag:
            msg = f'{self.path} is a single file and cannot be split; give a folder name'
            raise BearingTwinError(msg)

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

    def _sync(self) -> None:
        """Have the disk keep what it was given, unless it is still busy with the last time."""
        period = self.options.sync_period
        due = 0.0 < period <= time.monotonic() - self._synced
        if due and not self._disk.busy:
            self._synced = time.monotonic()
            self._file.sync(self._disk)

    def _count_removed(self) -> None:
        """Count what was finished in a folder that has been removed."""
        self._file.alone = False
        if self._earlier_count and not (self.path / f'{self.path.name}_0.mcap').exists():
            self._lose(self._earlier_count)
            self._earlier_count = self._earlier_size = 0
        for finished in list(self._finished):
            if not (self.path / finished.name).exists():
                self._lose(finished.count)
                self._finished.remove(finished)

    def _lose(self, count: int) -> None:
        self.removed += count
        self.written -= count

    def _put(self, message: Written) -> None:
        numbered = self._file.knows(message)
        if not (numbered or self.bag):
            msg = (
                f'{self.path} has as many topics as MCAP can number: no number is left for '
                f'{message.topic!r:.60}; give a folder name, which goes on in a further file'
            )
            raise BearingTwinError(msg)
        if not numbered or self._is_full(message.log_time):
            self.split()
        self._file.write(message)
        self.written += 1

    def _is_full(self, log_time: int) -> bool:
        o, file = self.options, self._file
        if not file.count or self.problem:
            return False
        sizes = [o.split_size, o.storage_limit // 2 if o.delete_oldest else 0]
        # So that at the limit there is an older file to delete.
        too_large = any(0 < size <= file.size for size in sizes)
        too_long = 0 < o.split_duration * NANO <= log_time - file.start
        return too_large or too_long

    def _keep_within_limit(self) -> None:
        o = self.options
        if not o.delete_oldest:
            if 0 < o.storage_limit < self.size:
                self.stopped = f'the storage limit of {o.storage_limit} bytes is reached'
            return
        while self._finished and (self.size > o.storage_limit or len(self._finished) > MOST_FILES):
            oldest = self._finished[0]
            try:
                (self.path / oldest.name).unlink(missing_ok=True)
            except OSError as error:
                self.problem = f'{oldest.name} cannot be deleted: {error.strerror}'
                return
            del self._finished[0]

    def _finish(self) -> None:
        """Write the end of the current file to its spool."""
        name, values = metadata_record([self._file.summary()])
        self._file.attach(Attached(name, values=values))
        self._file.end()
        self._ending.append(self._file)

    def _settle(self) -> str:
        """Bring ended files, and metadata.yaml of a bag, to the disk; return what went wrong."""
        while self._ending:
            file = self._ending[0]
            problem = file.close(self._disk if self.options.sync_period else None)
            if problem:
                return problem
            del self._ending[0]
            if file.vanished:
                self._lose(file.count)
                continue
            self._finished.append(file.summary())
            if len(self._finished) > MOST_FILES and not self.options.delete_oldest:
                earlier = self._finished.pop(0)
                self._earlier_count += earlier.count
                self._earlier_size += earlier.size
            if self.bag:
                self._to_list = list(self._finished)
                self._disk.do(self._list_files)
        return ''

    def _list_files(self) -> None:
        """Write the newest metadata.yaml: with thousands of files it takes a second."""
        files = self._to_list
        if files is not self._listed:
            self._unlisted = write_metadata_file(self.path, files)
            self._listed = files


@contextlib.contextmanager
def whole_recording(path: Path) -> Iterator[RecordingWriter]:
    """
    Write a recording that is there as a whole or, after an error, not at all.

    Raises
    ------
    BearingTwinError
        As a RecordingWriter, and where the disk did not take everything.

    """
    writer = RecordingWriter(path)
    try:
        with writer:
            yield writer
        if writer.lost:
            msg = f'{writer.lost} messages found no room in memory while the disk was full'
            raise BearingTwinError(msg)
    except BaseException as error:
        # Ctrl-C too: what is left of it would look whole.
        writer.discard()
        if isinstance(error, BearingTwinError) and (writer.problem or writer.lost):
            reason = writer.problem or error
            msg = f'{path} was not written: {reason}; make room, or choose another disk'
            raise BearingTwinError(msg) from None
        raise
