# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read the messages of one MCAP file in time order or in file order."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
import heapq
from typing import BinaryIO, TYPE_CHECKING

from bearing_twin.recording.mcap.catalogue import (
    Catalogue,
    DEFINITIONS,
    own_definitions,
    RecordedChannel,
    RecordedMessage,
)
from bearing_twin.recording.mcap.chunks import Chunks, ReadLimitExceeded
from bearing_twin.recording.mcap.mcapfile import (
    BrokenRecording,
    check_magic,
    MESSAGE_HEAD,
    message_head,
    record_at,
)
from bearing_twin.recording.mcap.salvage import sound_records
from bearing_twin.recording.mcap.summary import chunk_index, summary_begin, summary_records
from mcap.opcode import Opcode
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.mcapfile import RawRecord


EXTRAS = (Opcode.ATTACHMENT, Opcode.METADATA)
MOST_MERGED = 256 * 1024 * 1024
"""Most bytes of overlapping chunks that are held to sort messages by time."""


@dataclass(frozen=True)
class Selection:
    """Selection of messages by topic and log time; times in ns, ``end`` excluded."""

    topics: Collection[str] | None = None
    start: int | None = None
    end: int | None = None

    def wants(self, channel: RecordedChannel, log_time: int) -> bool:
        """Whether a message is wanted."""
        return (
            (self.topics is None or channel.topic in self.topics)
            and (self.start is None or log_time >= self.start)
            and (self.end is None or log_time < self.end)
        )

    def overlaps(self, start: int, end: int) -> bool:
        """Whether a chunk with these first and last log times can hold wanted messages."""
        return (self.start is None or end >= self.start) and (self.end is None or start < self.end)


def in_time_order(file: BinaryIO, size: int, keep: Selection) -> Iterator[RecordedMessage]:
    """Yield messages by the index in order of log time; without an index in file order."""
    check_magic(file)
    chunks = Chunks(file, size)
    catalogue = Catalogue(chunks)

    def index_records() -> Iterator[tuple[RawRecord, bytes]]:
        for raw, data in summary_records(file, size, (*DEFINITIONS, Opcode.CHUNK_INDEX)):
            if raw.opcode in DEFINITIONS:
                catalogue.learn(raw.opcode, data, raw.offset)
            else:
                yield raw, data

    places = chunk_index(size, index_records())
    if not len(places):
        yield from in_file_order(file, size, keep)
        return
    waiting = [place for place in places[::-1] if keep.overlaps(int(place[0]), int(place[1]))]
    # Chunks that overlap the current time; equal log times are ordered by position in the file.
    heap: list[tuple[int, int, _OpenChunk]] = []
    held = 0
    while heap or waiting:
        while waiting and (not heap or int(waiting[-1][0]) <= heap[0][0]):
            _, _, offset, length = map(int, waiting.pop())
            chunk = _OpenChunk(chunks, offset, length, catalogue, keep)
            if not chunk.exhausted:
                heapq.heappush(heap, (chunk.time, offset, chunk))
                held += chunk.memory
            if held > MOST_MERGED:
                msg = f'chunks that overlap in time hold more than {MOST_MERGED} bytes'
                raise BrokenRecording(msg, offset)
        if heap:
            _, offset, chunk = heap[0]
            yield chunk.pop()
            if chunk.exhausted:
                heapq.heappop(heap)
                held -= chunk.memory
            else:
                heapq.heapreplace(heap, (chunk.time, offset, chunk))


class _OpenChunk:
    """An unpacked chunk that returns its messages in order of log time."""

    def __init__(
        self, chunks: Chunks, offset: int, length: int, catalogue: Catalogue, keep: Selection
    ) -> None:
        raw = record_at(chunks.file, offset, offset + length)
        if raw.opcode != Opcode.CHUNK or raw.end != offset + length:
            msg = f'the index points to byte {offset}, where no chunk of {length} bytes is'
            raise BrokenRecording(msg, offset)
        self._offset = offset
        self._catalogue = catalogue
        self._data = chunks.unpack(raw)
        times, places = array('Q'), array('Q')
        for opcode, at, size in chunks.records(self._data, offset):
            if opcode in DEFINITIONS:
                catalogue.learn(opcode, self._data[at : at + size], offset)
            elif opcode == Opcode.MESSAGE:
                identity, log_time, _ = message_head(self._data, at, size, offset)
                if keep.wants(_known(catalogue, identity, offset), log_time):
                    times.append(log_time)
                    places.extend((at, size))
        self._times = np.array(times, dtype=np.uint64)
        self._places = np.array(places, dtype=np.uint64).reshape(-1, 2)
        order = np.argsort(self._times, kind='stable')
        self._times, self._places = self._times[order], self._places[order]
        self._next = 0
        self.memory = len(self._data) + self._times.nbytes + self._places.nbytes
        """Bytes that it holds."""

    @property
    def exhausted(self) -> bool:
        return self._next >= len(self._times)

    @property
    def time(self) -> int:
        """Log time of the next message, ns."""
        return int(self._times[self._next])

    def pop(self) -> RecordedMessage:
        at, size = map(int, self._places[self._next])
        self._next += 1
        identity, log_time, publish_time = message_head(self._data, at, size, self._offset)
        cdr = self._data[at + MESSAGE_HEAD.size : at + size]
        channel = self._catalogue.channels[identity]
        return RecordedMessage(channel, log_time, publish_time, cdr)


def in_file_order(
    file: BinaryIO,
    size: int,
    keep: Selection,
    damaged: Callable[[BrokenRecording], object] | None = None,
    extra: Callable[[RawRecord, bytes], None] | None = None,
) -> Iterator[RecordedMessage]:
    """
    Yield the messages in the order of the file.

    Parameters
    ----------
    file, size
        The file and its size, bytes.
    keep
        Messages to yield.
    damaged
        Called with each error; the damaged part is skipped. With None the error is raised.
    extra
        Called with each attachment and metadata record.

    """
    chunks = Chunks(file, size)
    elsewhere = own_definitions(chunks) if damaged is not None else ()
    catalogue = Catalogue(chunks, elsewhere)
    lost: dict[int, tuple[int, int]] = {}

    def described(identity: int, cdr: bytes, offset: int) -> RecordedChannel | None:
        """Return the channel of a message from any part of the file; count it if there is none."""
        channel = catalogue.channel(identity)
        if channel is None:
            if damaged is None:
                _known(catalogue, identity, offset)
            messages, octets = lost.get(identity, (0, 0))
            lost[identity] = (messages + 1, octets + MESSAGE_HEAD.size + len(cdr))
        return channel

    everything, summary = keep == Selection(), summary_begin(file, size)
    wanted = (*DEFINITIONS, Opcode.MESSAGE, Opcode.CHUNK, *(EXTRAS if extra else ()))
    for raw, data in sound_records(chunks, wanted, damaged):
        try:
            if extra and raw.opcode in EXTRAS:
                extra(raw, data)
                continue
            if raw.opcode in DEFINITIONS:
                catalogue.learn(raw.opcode, data, raw.offset)
                continue
            if raw.opcode == Opcode.MESSAGE and raw.offset >= summary:
                msg = 'a message in the summary: the kind of the record is damaged'
                raise BrokenRecording(msg, raw.offset)
            for opcode, at, length in chunks.records(data, raw.offset):
                if opcode == Opcode.MESSAGE:
                    identity, log_time, publish_time = message_head(data, at, length, raw.offset)
                    cdr = data[at + MESSAGE_HEAD.size : at + length]
                    channel = catalogue.channels.get(identity)
                    if channel is None:
                        channel = described(identity, cdr, raw.offset)
                    if channel is not None and (everything or keep.wants(channel, log_time)):
                        yield RecordedMessage(channel, log_time, publish_time, cdr)
                elif opcode in DEFINITIONS:
                    catalogue.learn(opcode, data[at : at + length], raw.offset)
        except BrokenRecording as error:
            if damaged is None:
                raise
            if isinstance(error, ReadLimitExceeded):
                damaged(error)
                break
            damaged(BrokenRecording(str(error), raw.offset, raw.end - raw.offset))
        # Free the chunk and its last message before the next one is unpacked.
        data = cdr = b''
    if damaged is not None:
        for identity, (messages, octets) in lost.items():
            text = f'{messages} messages of channel {identity}, whose description is lost'
            damaged(BrokenRecording(text, size, octets))


def _known(catalogue: Catalogue, identity: int, offset: int) -> RecordedChannel:
    channel = catalogue.channels.get(identity)
    if channel is None:
        msg = f'a message near byte {offset} belongs to an unknown channel'
        raise BrokenRecording(msg, offset)
    return channel
