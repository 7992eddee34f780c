# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read the sound records of one MCAP file from front to back; skip damaged parts if asked."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import suppress
from io import BytesIO
from pathlib import Path
import re
import struct
from typing import BinaryIO

from bearing_twin.recording.finding import reading_hint
from bearing_twin.recording.mcap.chunks import Chunks, ReadLimitExceeded
from bearing_twin.recording.mcap.mcapfile import (
    BrokenRecording,
    check_magic,
    CHUNK_HEAD,
    content,
    MAGIC,
    MESSAGE_HEAD,
    parse_from,
    RawRecord,
    read_at,
    record_at,
    RECORD_HEAD,
    refuse_special,
    UnfinishedRecording,
)
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode

BLOCK = 4 * 1024 * 1024
"""Bytes that are searched at a time."""
SECTOR = 4096
"""Bytes that are skipped if the disk cannot read one of them."""
CHUNK = re.compile(rb'\x06(?=.{5}\0\0\0.{28}(?:\x04\0\0\0zstd|\x03\0\0\0lz4|\0\0\0\0))', re.DOTALL)
"""Possible begin of a chunk: its opcode, a length below 2^40, a known compression."""
EITHER = re.compile(rb'[\x05\x06](?=.{5}\0\0\0)', re.DOTALL)
"""Possible begin of a chunk or, in a file without chunks, of a message."""
CHUNK_FIXED = CHUNK_HEAD.size + 8
"""Bytes of the content of a chunk without the name of its compression and its data."""
LONGEST_NAME = 16
"""Longest name of a compression, bytes."""
LONGEST_HEAD = RECORD_HEAD.size + CHUNK_FIXED + LONGEST_NAME
ATTEMPT = 1024
"""Bytes that each tested position costs of the limit of a search."""
LENGTHS = {Opcode.FOOTER: 20, Opcode.DATA_END: 4, Opcode.SUMMARY_OFFSET: 17}
"""Lengths of the records of fixed length, bytes."""
TABLES = (Opcode.HEADER, Opcode.SCHEMA, Opcode.CHANNEL, Opcode.METADATA)
IDLE = (
    *(Opcode.ATTACHMENT_INDEX, Opcode.CHUNK_INDEX, Opcode.DATA_END, Opcode.METADATA_INDEX),
    Opcode.STATISTICS,
)
"""Kinds whose length cannot be checked by their content."""
REPEATABLE = (*TABLES, Opcode.ATTACHMENT)
"""Kinds whose exact repetitions are skipped; so are those of an empty chunk."""
MOST_REMEMBERED = 1000
MOST_TABLES, BYTES_PER_TABLE = 20_000, 2000
"""Limit of repeatable records outside chunks that are read one by one: a constant, and one more
for this many bytes of the file."""
INDEX_HEAD = struct.Struct('<HI')
"""Channel and length of the entries of a message index."""
SHORT = 4096
"""Longest idle record and message that is handled together with others, bytes."""
PRIVATE = 0x80
"""First opcode that is free for private use."""
STEPPED_OVER = {*IDLE, *range(PRIVATE, 256)}
"""Kinds whose content no reader uses."""


def open_mcap(path: Path) -> BinaryIO:
    """
    Open an MCAP file; it may be damaged anywhere.

    Raises
    ------
    BrokenRecording
        If it cannot be opened, or if it has neither the MCAP magic bytes nor a sound chunk or
        message.

    """
    refuse_special(path)
    try:
        file = path.open('rb')
    except OSError as error:
        raise BrokenRecording(f'{path} cannot be read: {error.strerror}', 0) from None
    try:
        check_magic(file)
    except BrokenRecording as error:
        size = path.stat().st_size
        chunks = Chunks(file, size)
        for _ in sound_records(chunks, (Opcode.CHUNK, Opcode.MESSAGE), lambda _: None):
            return file
        file.close()
        msg = f'{path} is no MCAP file: {error}{reading_hint(path)}'
        raise BrokenRecording(msg, 0, size) from None
    return file


def sound_records(
    chunks: Chunks, wanted: Collection[int], damaged: Callable[[BrokenRecording], object] | None
) -> Iterator[tuple[RawRecord, bytes]]:
    """
    Yield the records of the wanted kinds with their content.

    The content of a chunk is unpacked. For a message the content is the whole record; short
    messages that follow it are yielded together, as records to step through like those of a chunk.

    Parameters
    ----------
    chunks
        The file and the remaining limits for its chunks.
    wanted
        Opcodes.
    damaged
        Called with each skipped part, from a record that cannot be read to the next one that can.
        With None the error is raised.

    """
    search, idle = _Search(chunks), _Idle(chunks.size)
    file, size = chunks.file, chunks.size
    offset = 0
    while offset <= size:
        found = _record(search, offset, wanted, strict=damaged is None)
        if isinstance(found, BrokenRecording):
            if damaged is None:
                raise found
            if isinstance(found, ReadLimitExceeded):
                damaged(found)
                return
            following = search.sound_from(offset)
            kind = BrokenRecording if following < size else type(found)
            damaged(kind(str(found), offset, following - offset))
            # No record begins at the end of the file: leave the loop.
            offset = following if following < size else size + 1
            continue
        raw, data = found
        if raw.opcode == Opcode.FOOTER:
            return
        end = raw.end
        private = end - raw.offset if raw.opcode >= PRIVATE else 0
        if raw.length <= SHORT and raw.opcode != Opcode.MESSAGE:
            end, more = idle.behind(raw, file)
            private += more
        if damaged is not None and private:
            text = f'{private} bytes from byte {raw.offset} on are records of unknown kinds'
            damaged(BrokenRecording(text, raw.offset, private))
        if data is not None:
            yield raw, data
            if raw.opcode == Opcode.MESSAGE and raw.length <= SHORT:
                for run, records in _messages_behind(raw, file):
                    yield run, records
                    end = run.end
            # Free the chunk before the next one is unpacked, as in_file_order does.
            del found, data
        offset = end


def _record(
    search: _Search, offset: int, wanted: Collection[int], *, strict: bool
) -> tuple[RawRecord, bytes | None] | BrokenRecording:
    """Return the record at ``offset`` and, if wanted, its content; or the error as a value."""
    file, size = search.file, search.size
    try:
        if not offset:
            check_magic(file)
            offset = len(MAGIC)
        if offset == size:
            raise UnfinishedRecording('the recording was not finished: its end is missing', size)
        raw = record_at(file, offset, size)
        if not (strict or search.consistent(raw)):
            msg = (
                f'the record at byte {offset} is damaged: kind {raw.opcode}, '
                f'{raw.length} bytes do not fit its content'
            )
            raise BrokenRecording(msg, offset)
        if raw.opcode == Opcode.FOOTER:
            _check_end(file, raw, size)
        search.chunked |= raw.opcode == Opcode.CHUNK
        if raw.opcode not in wanted:
            return raw, None
        if raw.opcode == Opcode.CHUNK:
            return raw, search.chunks.unpack(raw)
        head = RECORD_HEAD.pack(raw.opcode, raw.length) if raw.opcode == Opcode.MESSAGE else b''
        return raw, head + content(file, raw)
    except BrokenRecording as error:
        return error


def _check_end(file: BinaryIO, raw: RawRecord, size: int) -> None:
    if not MAGIC.startswith(read_at(file, raw.end, len(MAGIC))):
        msg = f'the footer at byte {raw.offset} is not followed by the magic bytes'
        raise UnfinishedRecording(msg, raw.offset)
    if raw.end + len(MAGIC) < size:
        msg = f'{size - raw.end - len(MAGIC)} bytes follow the end of the recording'
        raise UnfinishedRecording(msg, raw.offset)


class _Idle:
    """
    Idle records, which are stepped over many at a time.

    These are the kinds whose content no reader uses, and exact repetitions of earlier records. A
    small file can hold millions of them, which would take minutes one by one. After
    ``MOST_TABLES`` all repeatable records are idle.
    """

    def __init__(self, size: int) -> None:
        self._known: set[bytes] = set()
        self._tables = MOST_TABLES + size // BYTES_PER_TABLE

    def behind(self, raw: RawRecord, file: BinaryIO) -> tuple[int, int]:
        """Return the end of the idle records that follow ``raw``; bytes of private kinds."""
        self._tables -= raw.opcode in REPEATABLE
        is_empty_chunk = raw.opcode == Opcode.CHUNK and raw.length == CHUNK_FIXED
        if (raw.opcode in REPEATABLE or is_empty_chunk) and len(self._known) < MOST_REMEMBERED:
            # A bad sector inside a record that is not wanted does no harm.
            with suppress(BrokenRecording):
                self._known.add(read_at(file, raw.offset, raw.end - raw.offset))
        end, private = raw.end, 0
        for records in _short_records(file, end, self._holds):
            end += sum(map(len, records))
            private += sum(len(record) for record in records if record[0] >= PRIVATE)
        return end, private

    def _holds(self, record: bytes) -> bool:
        opcode = record[0]
        if opcode == Opcode.MESSAGE_INDEX:
            return _index_length(record[RECORD_HEAD.size :]) == len(record) - RECORD_HEAD.size
        if opcode in REPEATABLE and self._tables < 0:
            return True
        return opcode in STEPPED_OVER or record in self._known


def _messages_behind(raw: RawRecord, file: BinaryIO) -> Iterator[tuple[RawRecord, bytes]]:
    """
    Yield the short messages that directly follow ``raw``, many records at a time.

    Read one by one, millions of messages without chunks take twice as long.
    """
    least, end = RECORD_HEAD.size + MESSAGE_HEAD.size, raw.end
    for records in _short_records(
        file, end, lambda record: record[0] == Opcode.MESSAGE and len(record) >= least
    ):
        data = b''.join(records)
        yield RawRecord(end, Opcode.MESSAGE, len(data) - RECORD_HEAD.size), data
        end += len(data)


def _short_records(
    file: BinaryIO, offset: int, belongs: Callable[[bytes], bool]
) -> Iterator[list[bytes]]:
    """
    Yield the short records from ``offset`` on, with their heads, many at a time.

    They end before the first record that is long, incomplete, or does not belong to them.
    """
    # Most records are followed by few that belong: begin with a short look ahead.
    room, ended = RECORD_HEAD.size + SHORT, False
    while not ended:
        try:
            block = read_at(file, offset, room)
        except BrokenRecording:
            # A bad sector: the records before it are read one by one.
            return
        records, at = [], 0
        while not ended and at + RECORD_HEAD.size <= len(block):
            _, length = RECORD_HEAD.unpack_from(block, at)
            end = at + RECORD_HEAD.size + length
            if end > len(block) and length <= SHORT:
                # The next block has the whole record.
                break
            record = block[at:end]
            ended = length > SHORT or not belongs(record)
            if not ended:
                records.append(record)
                at = end
        if not records:
            return
        yield records
        offset += at
        room = min(8 * room, BLOCK)


class _Search:
    """Find the next sound record after damage; the number of bytes read for this is limited."""

    def __init__(self, chunks: Chunks) -> None:
        self.chunked = False
        """Whether the file has chunks."""
        self.chunks = chunks
        self.file = chunks.file
        self.size = chunks.size
        self._room = 4 * self.size + 64 * 1024 * 1024

    def consistent(self, raw: RawRecord) -> bool:
        """
        Return whether the length of a record agrees with the lengths in its content.

        A wrong length would skip sound records and lead into the middle of another one.
        """
        if not (raw.opcode <= Opcode.DATA_END or raw.opcode >= PRIVATE):
            return False
        if raw.opcode in LENGTHS:
            return raw.length == LENGTHS[Opcode(raw.opcode)]
        if raw.opcode == Opcode.CHUNK:
            head = read_at(self.file, raw.begin, CHUNK_FIXED + LONGEST_NAME)
            return _chunk_length(head) == raw.length
        if raw.opcode == Opcode.MESSAGE_INDEX:
            return _index_length(read_at(self.file, raw.begin, INDEX_HEAD.size)) == raw.length
        if raw.opcode == Opcode.ATTACHMENT:
            return self._attachment_length(raw) == raw.length
        if raw.opcode == Opcode.MESSAGE:
            return raw.length >= MESSAGE_HEAD.size
        if raw.opcode in TABLES:
            stream = ReadDataStream(BytesIO(content(self.file, raw)))
            parse_from(stream, raw.opcode, raw.offset)
            # Later versions of the format may add fields at the end.
            rest = raw.begin + stream.count
            return rest == raw.end or not self._plausible(rest)
        return True

    def sound_from(self, offset: int) -> int:
        """Return the next sound record after damage at ``offset``; the file size if none."""
        if not offset and self.size > len(MAGIC) and self._fitting(len(MAGIC)) is not None:
            # Only the magic bytes are damaged.
            return len(MAGIC)
        try:
            raw = record_at(self.file, offset, self.size)
            self._room -= raw.length
            if self.consistent(raw) and raw.opcode != Opcode.FOOTER and self._plausible(raw.end):
                return raw.end
        except BrokenRecording:
            # The end of the damaged record is unknown: search.
            pass
        pattern, fits = (CHUNK, self._is_chunk) if self.chunked else (EITHER, self._is_any)
        at = offset + 1
        while at < self.size and self._room > 0:
            block = self._read(at)
            for found in pattern.finditer(block, 0, BLOCK):
                if fits(at + found.start()):
                    return at + found.start()
                if self._room <= 0:
                    break
            at += BLOCK
        return self.size

    def _read(self, at: int, length: int = BLOCK + LONGEST_HEAD) -> bytes:
        try:
            return read_at(self.file, at, length)
        except BrokenRecording:
            # Read the sectors beside the bad one; replace the bad one by zeros.
            middle = (at + length // 2) // SECTOR * SECTOR
            middle += 0 if middle > at else SECTOR
            if middle >= at + length:
                return bytes(length)
            return self._read(at, middle - at) + self._read(middle, at + length - middle)

    def _is_any(self, offset: int) -> bool:
        return self._is_chunk(offset) or self._is_message(offset)

    def _is_chunk(self, offset: int) -> bool:
        raw = self._fitting(offset)
        return raw is not None and raw.opcode == Opcode.CHUNK

    def _is_message(self, offset: int) -> bool:
        """Return whether three consistent records follow one another from here."""
        for _ in range(3):
            raw = self._fitting(offset)
            if raw is None:
                return False
            offset = raw.end
        return True

    def _plausible(self, offset: int) -> bool:
        return offset == self.size or self._fitting(offset) is not None

    def _fitting(self, offset: int) -> RawRecord | None:
        self._room -= ATTEMPT
        try:
            raw = record_at(self.file, offset, self.size)
            return raw if self.consistent(raw) else None
        except BrokenRecording:
            return None

    def _attachment_length(self, raw: RawRecord) -> int:
        """Return the length by the lengths of name, media type and data; -1 if too large."""
        at = 16
        for size in ('<I', '<I', '<Q'):
            head = read_at(self.file, raw.begin + at, struct.calcsize(size))
            if at + len(head) > raw.length or len(head) < struct.calcsize(size):
                return -1
            at += len(head) + struct.unpack(size, head)[0]
        return at + 4


def _chunk_length(head: bytes) -> int:
    """Return the length of a chunk by the lengths in its head; -1 if they are damaged."""
    if len(head) < CHUNK_FIXED:
        return -1
    name = CHUNK_HEAD.unpack_from(head)[-1]
    if name > LONGEST_NAME or len(head) < CHUNK_FIXED + name:
        return -1
    (data,) = struct.unpack_from('<Q', head, CHUNK_HEAD.size + name)
    return int(CHUNK_FIXED + name + data)


def _index_length(head: bytes) -> int:
    """Return the length of a message index by the length of its entries; -1 if it has none."""
    if len(head) < INDEX_HEAD.size:
        return -1
    return INDEX_HEAD.size + int(INDEX_HEAD.unpack_from(head)[1])
