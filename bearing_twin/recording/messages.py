# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages out of the records of one MCAP file, in time order or in file order."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
import heapq
from typing import Any, BinaryIO, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcapfile import (
    BrokenRecording,
    chunk_records,
    MAGIC,
    RawRecord,
    read_record,
    read_summary,
    UnfinishedRecording,
    walk,
)
from bearing_twin.recording.schema import store_from_text
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, ChunkIndex, McapRecord, Message, Schema

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator

__all__ = [
    'Catalogue',
    'RecordedChannel',
    'RecordedMessage',
    'Selection',
    'in_file_order',
    'in_time_order',
    'known_fields',
]

MOST_MERGED = 512 * 1024 * 1024
"""Most bytes of overlapping chunks that are held to put messages in order."""


@dataclass(frozen=True)
class RecordedChannel:
    """A topic as one file describes it."""

    topic: str
    type_name: str
    """``pkg/msg/Type``."""
    encoding: str
    """Of the messages: ``cdr`` in ROS 2."""
    schema_encoding: str
    """Of the schema: ``ros2msg`` in ROS 2."""
    schema: str
    qos: str
    """Offered QoS profiles as rosbag2 writes them, YAML; '' where the file has none."""
    type_hash: str
    """``RIHS01_...``; '' where the file has none."""


@dataclass(frozen=True)
class RecordedMessage:
    """One message; times in ns."""

    channel: RecordedChannel
    log_time: int
    """When it was received."""
    publish_time: int
    """When it was sent."""
    cdr: bytes

    @property
    def topic(self) -> str:
        """Topic it was recorded on."""
        return self.channel.topic

    @property
    def type_name(self) -> str:
        """Type, ``pkg/msg/Type``."""
        return self.channel.type_name

    def decode(self) -> Any:
        """
        Return an object with the fields of the ROS message, number arrays as numpy arrays.

        Raises
        ------
        BearingTwinError
            If schema or bytes are damaged or of another encoding.

        """
        channel = self.channel
        if channel.encoding != 'cdr' or channel.schema_encoding != 'ros2msg':
            msg = (
                f'{channel.topic} holds {channel.encoding or "unknown"} messages with a '
                f'{channel.schema_encoding or "missing"} schema; cdr with ros2msg is read'
            )
            raise BearingTwinError(msg)
        store = store_from_text(channel.type_name, channel.schema)
        try:
            return store.deserialize_cdr(self.cdr, channel.type_name)
        except Exception as error:
            # The bytes come from a file: rosbags raises many kinds on damaged ones.
            msg = f'a message on {channel.topic} is damaged ({type(error).__name__}: {error})'
            raise BearingTwinError(msg) from None


@contextmanager
def known_fields(topic: str, type_name: str) -> Iterator[None]:
    """
    Turn what goes wrong with the fields of a decoded message into a BearingTwinError.

    A recording brings its own definition of a type, which may lack the fields we know, or have
    them of other types.
    """
    try:
        yield
    except (AttributeError, TypeError, ValueError, OverflowError) as error:
        msg = f'{topic} has another {type_name} than this version knows ({error})'
        raise BearingTwinError(msg) from None


@dataclass(frozen=True)
class Selection:
    """Which messages are wanted; times in ns, ``end`` excluded."""

    topics: Collection[str] | None = None
    start: int | None = None
    end: int | None = None

    def wants(self, message: Message, channel: RecordedChannel) -> bool:
        """Whether a message is wanted."""
        return (
            (self.topics is None or channel.topic in self.topics)
            and (self.start is None or message.log_time >= self.start)
            and (self.end is None or message.log_time < self.end)
        )

    def overlaps(self, index: ChunkIndex) -> bool:
        """Whether a chunk can hold wanted messages."""
        return (self.start is None or index.message_end_time >= self.start) and (
            self.end is None or index.message_start_time < self.end
        )


class Catalogue:
    """Schemas and channels seen so far; turns message records into :class:`RecordedMessage`."""

    def __init__(self) -> None:
        self._schemas: dict[int, Schema] = {}
        self.channels: dict[int, RecordedChannel] = {}

    def learn(self, record: McapRecord | None) -> None:
        """Take note of a schema or channel."""
        if isinstance(record, Schema):
            self._schemas[record.id] = record
        elif isinstance(record, Channel):
            schema = self._schemas.get(record.schema_id)
            self.channels[record.id] = RecordedChannel(
                topic=record.topic,
                type_name=schema.name if schema else '',
                encoding=record.message_encoding,
                schema_encoding=schema.encoding if schema else '',
                schema=schema.data.decode('utf-8', 'replace') if schema else '',
                qos=record.metadata.get('offered_qos_profiles', ''),
                type_hash=record.metadata.get('topic_type_hash', ''),
            )

    def message(self, record: Message, offset: int) -> RecordedMessage:
        """
        Return a message with its channel.

        Raises
        ------
        BrokenRecording
            If its channel has not been described before.

        """
        channel = self.channels.get(record.channel_id)
        if channel is None:
            msg = f'a message near byte {offset} belongs to an unknown channel'
            raise BrokenRecording(msg, offset)
        return RecordedMessage(channel, record.log_time, record.publish_time, record.data)


def in_time_order(file: BinaryIO, size: int, keep: Selection) -> Iterator[RecordedMessage]:
    catalogue = Catalogue()
    indexes = []
    for record in read_summary(file, size):
        catalogue.learn(record)
        if isinstance(record, ChunkIndex):
            indexes.append(record)
    if not indexes:
        yield from in_file_order(file, size, keep, None)
        return
    indexes.sort(key=lambda index: (index.message_start_time, index.chunk_start_offset))
    waiting = [index for index in reversed(indexes) if keep.overlaps(index)]
    # Messages of the chunks that overlap the current time; position breaks ties of log time.
    heap: list[tuple[int, int, RecordedMessage]] = []
    held = 0
    position = 0
    while heap or waiting:
        while waiting and (not heap or waiting[-1].message_start_time <= heap[0][0]):
            for message in _messages_of_chunk(file, size, waiting.pop(), catalogue, keep):
                heapq.heappush(heap, (message.log_time, position, message))
                position += 1
                held += len(message.cdr)
            if held > MOST_MERGED:
                msg = f'chunks that overlap in time hold more than {MOST_MERGED} bytes'
                raise BrokenRecording(msg, 0)
        if heap:
            message = heapq.heappop(heap)[2]
            held -= len(message.cdr)
            yield message


def _messages_of_chunk(
    file: BinaryIO, size: int, index: ChunkIndex, catalogue: Catalogue, keep: Selection
) -> Iterator[RecordedMessage]:
    offset = index.chunk_start_offset
    raw = next(walk(file, offset, size), None)
    chunk = read_record(file, raw) if raw else None
    if not isinstance(chunk, Chunk):
        msg = f'the index points to byte {offset}, where no chunk is'
        raise BrokenRecording(msg, offset)
    yield from _messages(chunk_records(chunk, offset), offset, catalogue, keep)


def _messages(
    records: Iterator[McapRecord], offset: int, catalogue: Catalogue, keep: Selection
) -> Iterator[RecordedMessage]:
    for record in records:
        if isinstance(record, Message):
            message = catalogue.message(record, offset)
            if keep.wants(record, message.channel):
                yield message
        else:
            catalogue.learn(record)


def in_file_order(
    file: BinaryIO,
    size: int,
    keep: Selection,
    damaged: Callable[[BrokenRecording], None] | None,
) -> Iterator[RecordedMessage]:
    """Read from front to back; with ``damaged`` what is broken is reported and stepped over."""
    catalogue = Catalogue()

    def of(raw: RawRecord) -> list[RecordedMessage]:
        record = read_record(file, raw)
        if isinstance(record, Chunk):
            records = chunk_records(record, raw.offset)
        else:
            records = iter([record] if record is not None else [])
        return list(_messages(records, raw.offset, catalogue, keep))

    try:
        for raw in walk(file, len(MAGIC), size):
            try:
                messages = of(raw)
            except BrokenRecording as error:
                if damaged is None:
                    raise
                damaged(error)
            else:
                yield from messages
            if raw.opcode == Opcode.FOOTER:
                return
        msg = 'the recording was not finished: its end is missing'
        raise UnfinishedRecording(msg, size)
    except UnfinishedRecording as error:
        if damaged is None:
            raise
        damaged(error)
