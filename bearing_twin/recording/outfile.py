# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Write one MCAP file; if the disk fails, bytes wait in memory and no exception is raised."""

from __future__ import annotations

from collections import Counter
import contextlib
from dataclasses import dataclass, field
import fcntl
import os
from pathlib import Path
import struct
import time
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin import __version__
from bearing_twin.recording.bagmetadata import BagFile, BagTopic, metadata_record
from bearing_twin.recording.mcap.mcapfile import MESSAGE_HEAD
from mcap.opcode import Opcode
from mcap.records import Channel, Message, Schema
from mcap.writer import CompressionType, Writer

if TYPE_CHECKING:
    from bearing_twin.disksync import DiskSync
    from bearing_twin.recording.mcap.schema import MessageSchema
    from mcap.data_stream import RecordBuilder


LIBRARY = f'bearing_twin {__version__}'
"""Writer of the file in its header; the first word marks files of this package."""
MOST_REPEATED = 2000
"""Most schemas and channels that are repeated in one chunk: more would fill it."""
REPEATED_EACH = 10
"""Chunks after which schemas and channels are repeated: 5 s with the default flush period."""
MOST_CHANNELS = 65_535
"""Most channels and schemas of one file: MCAP numbers each with two bytes, from 1 on."""
OVERHEAD = 250
"""Bytes of memory that a message takes in addition to its content."""


class MessageToStore(NamedTuple):
    """One message to store; times in ns."""

    topic: str
    type_name: str
    cdr: bytes
    log_time: int
    publish_time: int
    qos: str
    schema: MessageSchema

    @property
    def memory(self) -> int:
        """Bytes of memory that the message takes while it waits."""
        return OVERHEAD + len(self.cdr)


@dataclass(frozen=True)
class Attachment:
    """An attachment (``data``) or a metadata record (``values``)."""

    name: str
    media_type: str = ''
    data: bytes = b''
    values: dict[str, str] = field(default_factory=dict)


class _Spool:
    """Output stream of the MCAP writer: bytes wait here until the disk has taken them."""

    def __init__(self) -> None:
        self.waiting = bytearray()
        self.taken = 0

    def write(self, data: bytes) -> int:
        self.waiting += data
        return len(data)

    def tell(self) -> int:
        return self.taken + len(self.waiting)

    def flush(self) -> None:
        """Do nothing: OutputFile.drain moves the bytes."""


_MESSAGE_RECORD = struct.Struct('<BQHIQQ')


class _Message(Message):
    """A message that is packed in one call; the mcap package packs each field, 3 times slower."""

    def write(self, stream: RecordBuilder) -> None:
        length = MESSAGE_HEAD.size + len(self.data)
        stream.write(
            _MESSAGE_RECORD.pack(
                *(Opcode.MESSAGE, length),
                *(self.channel_id, self.sequence, self.log_time, self.publish_time),
            )
        )
        stream.write(self.data)


class _RepeatingWriter(Writer):
    """
    Repeat schemas and channels every ``REPEATED_EACH`` chunks.

    Otherwise damage to the first chunk, together with a summary that was not written because of a
    crash, would lose the description of a channel and so all of its messages.
    """

    def __init__(self, spool: _Spool, chunk_size: int, compression: str) -> None:
        super().__init__(
            spool,  # type: ignore[arg-type]
            chunk_size=chunk_size,
            compression=CompressionType[compression.upper()],
        )
        self._chunk_size = chunk_size
        self._described: list[Schema | Channel] = []
        # Index of the next record to repeat.
        self._next = 0
        self._age = 0

    def describe(self, record: Schema | Channel) -> None:
        """Add a record to those that are repeated, from the next chunk on."""
        self._described.append(record)

    def add(self, message: Message) -> None:
        """Add a message; :meth:`count` enters it in the summary."""
        builder = self._Writer__chunk_builder  # type: ignore[attr-defined]
        builder.add_message(message)
        if builder.count > self._chunk_size:
            self.flush()  # type: ignore[no-untyped-call]

    def count(self, channel_counts: dict[int, int], start: int, end: int) -> None:
        """Enter the added messages in the statistics of the summary; times in ns."""
        statistics = self._Writer__statistics  # type: ignore[attr-defined]
        statistics.channel_message_counts.update(channel_counts)
        statistics.message_count = sum(channel_counts.values())
        statistics.message_start_time, statistics.message_end_time = start, end

    def repeat(self) -> None:
        """At the begin of a chunk repeat new descriptions, or all of them when it is time."""
        builder = self._Writer__chunk_builder  # type: ignore[attr-defined]
        if builder.count:
            return
        self._age += 1
        if self._age > REPEATED_EACH and self._next >= len(self._described):
            self._age, self._next = 1, 0
        again = self._described[self._next : self._next + MOST_REPEATED]
        self._next += len(again)
        for record in again:
            record.write(builder.record_writer)


class _Channel(NamedTuple):
    """A topic with one schema, and its number in the file."""

    identity: int
    schema: MessageSchema
    about: BagTopic


class OutputFile:
    """
    Write one file of a recording.

    An open file is locked (flock). The lock distinguishes a recording in progress from one that a
    crash has left.
    """

    def __init__(self, path: Path, *, compression: str, chunk_size: int) -> None:
        self.path = path
        self.count = 0
        """Messages written."""
        self.given = 0
        """Messages that were completely given to the operating system."""
        self.start = 0
        """First log time, ns."""
        self.made = False
        """Whether this object has made the file."""
        self.vanished = False
        """Whether the file was removed while it was written."""
        self.alone = False
        """Whether its folder was gone and had to be made again."""
        self._end = 0
        self._fd = -1
        self._spool = _Spool()
        self._writer = _RepeatingWriter(self._spool, chunk_size, compression)
        self._writer.start(profile='ros2', library=LIBRARY)
        self._schemas: dict[MessageSchema, int] = {}
        self._channels: dict[tuple[str, MessageSchema], _Channel] = {}
        # Channel of the newest message, by topic.
        self._newest: dict[str, _Channel] = {}
        self._counts: Counter[int] = Counter()

    @property
    def size(self) -> int:
        """Bytes written, including those that wait for the disk."""
        return self._spool.tell()

    def knows(self, message: MessageToStore) -> bool:
        """Return whether the message has a channel, or a number is left for a new channel."""
        described = len(self._channels)
        return described < MOST_CHANNELS or (message.topic, message.schema) in self._channels

    def write(self, message: MessageToStore) -> None:
        """Add a message for which :meth:`knows` returned True; see RecordingWriter.write."""
        self._writer.repeat()
        topic, log_time = message.topic, message.log_time
        channel = self._newest.get(topic)
        if channel is None or channel.schema is not message.schema:
            channel = self._newest[topic] = self._described(message)
        if not self.count or log_time < self.start:
            self.start = log_time
        if log_time > self._end:
            self._end = log_time
        about, identity = channel.about, channel.identity
        self._writer.add(
            _Message(identity, log_time, message.cdr, message.publish_time, about.count)
        )
        self._counts[identity] += 1
        self.count += 1
        about.count += 1

    def attach(self, attached: Attachment) -> None:
        """Add an attachment or a metadata record."""
        if attached.values:
            self._writer.add_metadata(attached.name, attached.values)
        else:
            now = time.time_ns()
            self._writer.add_attachment(
                now, now, attached.name, attached.media_type, attached.data
            )

    def drain(self) -> str:
        """
        Close the chunk and give everything to the operating system; return what hinders that.

        It is '' if the disk took all bytes. Else the remaining ones wait in memory.
        """
        self._writer.flush()  # type: ignore[no-untyped-call]
        problem = self._push()
        self.given = self.given if problem else self.count
        return problem

    def sync(self, disk: DiskSync) -> None:
        """Request to synchronise the bytes given to the operating system with the disk."""
        if self._fd >= 0:
            disk.request(self._fd, self.path.parent)

    def end(self) -> None:
        """Write metadata for rosbag2, the summary and the end; only :meth:`close` may follow."""
        name, values = metadata_record([self.summary()])
        self.attach(Attachment(name, values=values))
        self._writer.count(self._counts, self.start, self._end)
        self._writer.finish()  # type: ignore[no-untyped-call]

    def close(self, disk: DiskSync | None) -> str:
        """
        Write all bytes, request to synchronise them through ``disk`` if given, and close the file.

        Returns as :meth:`drain`, but '' if the file has vanished.
        """
        problem = self._push()
        if problem and not self.vanished:
            return problem
        if disk is not None:
            self.sync(disk)
        self.abandon()
        return ''

    def abandon(self) -> None:
        """Close the file without writing the waiting bytes."""
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1

    def summary(self) -> BagFile:
        """Return the entry of this file in metadata.yaml."""
        return BagFile(
            name=self.path.name,
            size=self.size,
            count=self.count,
            start=self.start,
            end=self._end,
            topics=[channel.about for channel in self._channels.values()],
        )

    def _described(self, message: MessageToStore) -> _Channel:
        """Return the channel of a message; write its description to the file if it is new."""
        topic, schema, writer = message.topic, message.schema, self._writer
        known = self._channels.get((topic, schema))
        if known is not None:
            # Keep this schema object: for the next message a test of identity is then enough.
            return known._replace(schema=schema)
        name = message.type_name
        if schema not in self._schemas:
            text = schema.text.encode()
            identity = writer.register_schema(name, schema.encoding, text)
            writer.describe(Schema(identity, text, schema.encoding, name))
            self._schemas[schema] = identity
        about = {'offered_qos_profiles': message.qos, 'topic_type_hash': schema.type_hash}
        identity = writer.register_channel(topic, 'cdr', self._schemas[schema], about)
        writer.describe(Channel(identity, topic, 'cdr', about, self._schemas[schema]))
        of_bag = BagTopic(topic, name, message.qos, schema.type_hash)
        channel = self._channels[topic, schema] = _Channel(identity, schema, of_bag)
        return channel

    def _push(self) -> str:
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
        except OSError as error:
            return f'{self.path}: {error.strerror}'
        return ''

    def _create(self) -> None:
        # One level only: if the parent folder is gone too, the disk may have been unmounted, and
        # the bytes would go to the disk of the mount point.
        self.alone = not self.path.parent.exists()
        self.path.parent.mkdir(exist_ok=True)
        self._fd = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)
        self.made = True
        with contextlib.suppress(OSError):
            # Some network file systems do not support locks.
            fcntl.flock(self._fd, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def _is_there(self) -> bool:
        try:
            named = self.path.stat()
        except FileNotFoundError:
            return False
        opened = os.fstat(self._fd)
        return (named.st_dev, named.st_ino) == (opened.st_dev, opened.st_ino)
