# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One MCAP file being written, in which a failing disk loses no byte and raises nothing."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field
import fcntl
import os
import time
from typing import TYPE_CHECKING

from bearing_twin import __version__
from bearing_twin.recording.bagmetadata import BagFile, BagTopic
from mcap.writer import CompressionType, Writer

if TYPE_CHECKING:
    from pathlib import Path

    from bearing_twin.recording.schema import MessageSchema

__all__ = ['LIBRARY', 'Attached', 'OutputFile']

LIBRARY = f'bearing_twin {__version__}'
"""Who wrote a file, as its header says; the first word marks our own."""


@dataclass(frozen=True)
class Attached:
    """An attachment (``data``) or a metadata record (``values``)."""

    name: str
    media_type: str = ''
    data: bytes = b''
    values: dict[str, str] = field(default_factory=dict)


class _Spool:
    """Stream for the MCAP writer: what it writes waits here until the disk has taken it."""

    def __init__(self) -> None:
        self.waiting = bytearray()
        self.taken = 0

    def write(self, data: bytes) -> int:
        self.waiting += data
        return len(data)

    def tell(self) -> int:
        return self.taken + len(self.waiting)

    def flush(self) -> None:
        """Nothing to do: OutputFile.drain moves the bytes."""


class OutputFile:
    """
    Write one file of a recording.

    While it is open it is locked (flock), by which a recording in progress is told from one that
    a crash has left.

    Parameters
    ----------
    path
        File to make, at the first :meth:`drain`.
    compression
        ``zstd``, ``lz4`` or ``none``.
    chunk_size
        Size at which a chunk is closed, bytes.

    """

    def __init__(self, path: Path, *, compression: str, chunk_size: int) -> None:
        self.path = path
        self.count = 0
        """Messages written."""
        self.start = 0
        """First log time, ns."""
        self.vanished = False
        """Whether the file was removed while it was written."""
        self._end = 0
        self._fd = -1
        self._spool = _Spool()
        self._writer = Writer(
            self._spool,  # type: ignore[arg-type]
            chunk_size=chunk_size,
            compression=CompressionType[compression.upper()],
        )
        self._writer.start(profile='ros2', library=LIBRARY)
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._topics: dict[str, BagTopic] = {}

    @property
    def size(self) -> int:
        """Bytes written, those that wait for the disk included."""
        return self._spool.tell()

    def write(
        self,
        topic: str,
        type_name: str,
        cdr: bytes,
        log_time: int,
        publish_time: int,
        qos: str,
        schema: MessageSchema,
    ) -> None:
        """Add a message; see RecordingWriter.write."""
        channel = self._channels.get(topic)
        if channel is None or self._topics[topic].type_name != type_name:
            channel = self._describe(topic, type_name, qos, schema)
        if not self.count:
            self.start = log_time
        self.start = min(self.start, log_time)
        self._end = max(self._end, log_time)
        self._writer.add_message(
            channel_id=channel,
            log_time=log_time,
            data=cdr,
            publish_time=publish_time,
            sequence=self._topics[topic].count,
        )
        self.count += 1
        self._topics[topic].count += 1

    def attach(self, attached: Attached) -> None:
        """Add an attachment or a metadata record."""
        if attached.values:
            self._writer.add_metadata(attached.name, attached.values)
        else:
            now = time.time_ns()
            self._writer.add_attachment(
                now, now, attached.name, attached.media_type, attached.data
            )

    def drain(self, *, fsync: bool = False) -> str:
        """
        Close the chunk and give everything to the operating system.

        Returns
        -------
        str
            Why the disk did not take it, '' if it did. What it did not take waits.

        """
        self._writer.flush()  # type: ignore[no-untyped-call]
        return self._push(fsync=fsync)

    def end(self) -> None:
        """Add the end of the file; only :meth:`close` may follow."""
        self._writer.finish()  # type: ignore[no-untyped-call]

    def close(self) -> str:
        """
        Give everything to the operating system and close the file; returns as :meth:`drain`.

        A file that has vanished counts as closed.
        """
        problem = self._push(fsync=False)
        if problem and not self.vanished:
            return problem
        os.close(self._fd)
        self._fd = -1
        return ''

    def summary(self) -> BagFile:
        """Return what metadata.yaml says of this file."""
        return BagFile(
            name=self.path.name,
            size=self.size,
            count=self.count,
            start=self.start,
            end=self._end,
            topics=list(self._topics.values()),
        )

    def _describe(self, topic: str, type_name: str, qos: str, schema: MessageSchema) -> int:
        if type_name not in self._schemas:
            self._schemas[type_name] = self._writer.register_schema(
                type_name, schema.encoding, schema.text.encode()
            )
        self._channels[topic] = self._writer.register_channel(
            topic,
            'cdr',
            self._schemas[type_name],
            {'offered_qos_profiles': qos, 'topic_type_hash': schema.type_hash},
        )
        self._topics[topic] = BagTopic(topic, type_name, qos, schema.type_hash)
        return self._channels[topic]

    def _push(self, *, fsync: bool) -> str:
        spool = self._spool
        try:
            if self._fd < 0:
                self._create()
            elif not self._is_there():
                self.vanished = True
                return f'{self.path} was removed while it was written'
            while spool.waiting:
                taken = os.write(self._fd, spool.waiting)
                del spool.waiting[:taken]
                spool.taken += taken
            if fsync:
                os.fsync(self._fd)
        except OSError as error:
            return f'{self.path}: {error.strerror}'
        return ''

    def _create(self) -> None:
        # One level only: where the folder above is gone too, a disk may have been unmounted, and
        # writing to the disk below would be wrong.
        self.path.parent.mkdir(exist_ok=True)
        self._fd = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)
        with contextlib.suppress(OSError):
            # Some network file systems know no locks.
            fcntl.flock(self._fd, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def _is_there(self) -> bool:
        try:
            named = self.path.stat()
        except FileNotFoundError:
            return False
        opened = os.fstat(self._fd)
        return (named.st_dev, named.st_ino) == (opened.st_dev, opened.st_ino)
