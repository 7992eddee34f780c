# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read the summary section at the end of a finished MCAP file; check CRC and chunk index."""

from __future__ import annotations

from array import array
from collections.abc import Collection, Iterable, Iterator
import struct
from typing import BinaryIO
import zlib

from bearing_twin.recording.mcap.mcapfile import (
    BrokenRecording,
    CHUNK_HEAD,
    content,
    LARGEST_TABLE,
    MAGIC,
    RawRecord,
    read_at,
    record_at,
    RECORD_HEAD,
    UnfinishedRecording,
)
from mcap.opcode import Opcode
import numpy as np
from numpy.typing import NDArray

FOOTER_LENGTH = RECORD_HEAD.size + 20
SMALLEST_CHUNK = RECORD_HEAD.size + CHUNK_HEAD.size + 8
INDEX_HEAD = struct.Struct('<QQQQ')
"""First and last log time, first byte and length of a chunk."""
BLOCK = 1024 * 1024
"""Bytes that are read at a time."""
MOST_RECORDS, BYTES_PER_RECORD = 100_000, 20
"""Limit of the records of a summary: a constant, and one more for this many bytes of the summary.
The shortest useful record, a schema without a name, takes 23 bytes."""


def summary_place(file: BinaryIO, size: int) -> tuple[int, int]:
    """
    Return first byte and end of the summary section of a finished file; equal if it has none.

    Raises
    ------
    UnfinishedRecording
        If the file has no footer.
    BrokenRecording
        If the summary is damaged.

    """
    end = size - FOOTER_LENGTH - len(MAGIC)
    tail = read_at(file, end, FOOTER_LENGTH + len(MAGIC)) if end >= len(MAGIC) else b''
    if not tail.endswith(MAGIC) or tail[:9] != RECORD_HEAD.pack(Opcode.FOOTER, 20):
        raise UnfinishedRecording('the recording was not finished: its end is missing', size)
    start, _, crc = struct.unpack_from('<QQI', tail, 9)
    if start == 0:
        return end, end
    if not len(MAGIC) <= start <= end:
        msg = f'the footer points to byte {start}, outside the file of {size} bytes'
        raise BrokenRecording(msg, end)
    if crc and _crc(file, start, end + FOOTER_LENGTH - 4) != crc:
        msg = f'the summary at byte {start} is damaged: its CRC does not fit'
        raise BrokenRecording(msg, start)
    return start, end


def summary_begin(file: BinaryIO, size: int) -> int:
    """Return the first byte of the summary section, be it damaged; ``size`` if none is known."""
    end, head = size - FOOTER_LENGTH - len(MAGIC), RECORD_HEAD.pack(Opcode.DATA_END, 4)
    try:
        tail = read_at(file, end, FOOTER_LENGTH) if end >= len(MAGIC) else b''
        if tail[:9] != RECORD_HEAD.pack(Opcode.FOOTER, 20):
            return size
        # The footer may be damaged as well: a summary begins behind the end of the data.
        (start,) = struct.unpack_from('<Q', tail, 9)
        before = start - len(head) - 4
        return start if 0 < before < end and read_at(file, before, len(head)) == head else size
    except BrokenRecording:
        return size


def summary_records(
    file: BinaryIO, size: int, wanted: Collection[int]
) -> Iterator[tuple[RawRecord, bytes]]:
    """Yield the records of the wanted kinds in the summary of a file, with their content."""
    at, stop = summary_place(file, size)
    unpack, left = RECORD_HEAD.unpack_from, MOST_RECORDS + (stop - at) // BYTES_PER_RECORD
    while at < stop:
        block = read_at(file, at, min(BLOCK, stop - at))
        place, last = 0, len(block) - RECORD_HEAD.size
        while place <= last:
            opcode, length = unpack(block, place)
            begin = place + RECORD_HEAD.size
            end = begin + length
            if end > len(block) or not opcode:
                break
            left -= 1
            if opcode in wanted:
                yield RawRecord(at + place, opcode, length), block[begin:end]
            place = end
        if left < 0:
            msg = 'the summary has too many records for its size: it is not used'
            raise BrokenRecording(msg, at)
        if not place:
            # The record is longer than a block, or damaged.
            raw = record_at(file, at, stop)
            if raw.opcode in wanted:
                yield raw, content(file, raw)
            place = raw.end - at
        at += place


def chunk_index(size: int, records: Iterable[tuple[RawRecord, bytes]]) -> NDArray[np.uint64]:
    """
    Return times and positions of the chunks that a summary lists, in order of time.

    They are first and last log time (ns), first byte and length, shape ``(n, 4)``.

    Raises
    ------
    BrokenRecording
        If an entry is damaged, or its chunk lies outside the file or overlaps another one.

    """
    fields = array('Q')
    for raw, data in records:
        if raw.length < INDEX_HEAD.size or len(fields) // 4 * SMALLEST_CHUNK > size:
            msg = f'the chunk index record at byte {raw.offset} is damaged'
            raise BrokenRecording(msg, raw.offset)
        fields.extend(INDEX_HEAD.unpack_from(data))
    table = np.array(fields, dtype=np.uint64).reshape(-1, 4)
    by_place = table[np.argsort(table[:, 2], kind='stable')]
    ends = np.append(by_place[1:, 2], np.uint64(size))
    fits = (by_place[:, 2] <= ends) & (by_place[:, 3] <= ends - np.minimum(by_place[:, 2], ends))
    if not fits.all():
        offset = int(by_place[np.argmin(fits), 2])
        msg = f'the index names a chunk at byte {offset} that does not fit between the others'
        raise BrokenRecording(msg, offset)
    return table[np.lexsort((table[:, 2], table[:, 0]))]


def _crc(file: BinaryIO, start: int, stop: int) -> int:
    crc = 0
    for at in range(start, stop, LARGEST_TABLE):
        crc = zlib.crc32(read_at(file, at, min(LARGEST_TABLE, stop - at)), crc)
    return crc
