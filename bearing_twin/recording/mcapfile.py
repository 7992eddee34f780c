# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Records of one MCAP file, read within stated bounds whatever the file claims.

The records are those of the MCAP specification (https://mcap.dev/spec). Those with texts and
tables are parsed by the mcap package. Walking the file, unpacking chunks and the heads of messages
are done here: a reader of files from outside must neither believe a length that the file states,
nor unpack without a limit, nor hold an object for each of millions of records.
"""

from __future__ import annotations

from io import BytesIO
import struct
from typing import BinaryIO, NamedTuple, TYPE_CHECKING
import zlib

from bearing_twin.errors import BearingTwinError
import lz4.frame  # type: ignore[import-untyped]
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)
import zstandard

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

__all__ = [
    'CHUNK_HEAD',
    'LARGEST_CHUNK',
    'LARGEST_RECORD',
    'LARGEST_TABLE',
    'MAGIC',
    'MESSAGE_HEAD',
    'RECORD_HEAD',
    'BrokenRecording',
    'RawRecord',
    'UnfinishedRecording',
    'chunk_records',
    'content',
    'message_head',
    'open_mcap',
    'parse',
    'parse_from',
    'read_at',
    'read_record',
    'record_at',
    'refuse_special',
    'unpacked_chunk',
    'walk',
]

MAGIC = b'\x89MCAP0\r\n'
LARGEST_RECORD = 128 * 1024 * 1024
"""Largest record that is read into memory, bytes."""
LARGEST_CHUNK = 128 * 1024 * 1024
"""Largest chunk after unpacking, bytes."""
LARGEST_TABLE = 4 * 1024 * 1024
"""Largest record that consists of texts and tables, bytes: each entry becomes objects."""
RECORD_HEAD = struct.Struct('<BQ')
MESSAGE_HEAD = struct.Struct('<HIQQ')
CHUNK_HEAD = struct.Struct('<QQQII')
"""Start, end, unpacked size, CRC, length of the name of the compression."""
FAULTS = (McapError, struct.error, ValueError, OverflowError, EOFError, RuntimeError, TypeError)
"""What parsing damaged bytes raises: UnicodeDecodeError is a ValueError, lz4's a RuntimeError."""

PARSERS: dict[int, Callable[[ReadDataStream], McapRecord]] = {
    Opcode.HEADER: Header.read,
    Opcode.SCHEMA: Schema.read,
    Opcode.CHANNEL: Channel.read,
    Opcode.CHUNK: Chunk.read,
    Opcode.ATTACHMENT: Attachment.read,
    Opcode.ATTACHMENT_INDEX: AttachmentIndex.read,
    Opcode.STATISTICS: Statistics.read,
    Opcode.METADATA: Metadata.read,
    Opcode.METADATA_INDEX: MetadataIndex.read,
}
BULKY = (Opcode.CHUNK, Opcode.ATTACHMENT, Opcode.MESSAGE)


class BrokenRecording(BearingTwinError):
    """Bytes that are no MCAP: ``length`` of them are lost from ``offset`` on."""

    def __init__(self, text: str, offset: int, length: int = 0) -> None:
        super().__init__(text)
        self.offset = offset
        self.length = length


class UnfinishedRecording(BrokenRecording):
    """A recording whose end is missing; what is complete can be recovered."""


class RawRecord(NamedTuple):
    """A record as it lies in the file."""

    offset: int
    opcode: int
    length: int

    @property
    def begin(self) -> int:
        """First byte of the content."""
        return self.offset + RECORD_HEAD.size

    @property
    def end(self) -> int:
        """First byte after the record."""
        return self.begin + self.length


def refuse_special(path: Path) -> None:
    """
    Refuse pipes, sockets and devices: opening one may wait forever, reading one never end.

    Raises
    ------
    BearingTwinError
        If the path is there and is neither a file nor a folder, or leads there.

    """
    if path.exists() and not path.is_file() and not path.is_dir():
        msg = f'{path} is no file but a pipe, socket or device; copy its content into a file'
        raise BearingTwinError(msg)


def open_mcap(path: Path) -> BinaryIO:
    """
    Open an MCAP file.

    Raises
    ------
    BearingTwinError
        If it cannot be opened or does not begin as an MCAP file does.

    """
    refuse_special(path)
    try:
        file = path.open('rb')
        head = file.read(len(MAGIC))
    except OSError as error:
        msg = f'{path} cannot be read: {error.strerror}'
        raise BearingTwinError(msg) from None
    if head != MAGIC:
        file.close()
        reason = 'does not begin with the MCAP magic bytes'
        if not head.strip(b'\0'):
            reason = 'begins with zeros: the disk never got its content' if head else 'is empty'
        msg = f'{path} is no MCAP file: it {reason}'
        raise BrokenRecording(msg, 0, path.stat().st_size)
    return file


def read_at(file: BinaryIO, offset: int, length: int) -> bytes:
    """
    Return up to ``length`` bytes from ``offset`` on.

    Raises
    ------
    BrokenRecording
        If the disk cannot read them.

    """
    try:
        file.seek(offset)
        return file.read(length)
    except OSError as error:
        msg = f'byte {offset} cannot be read: {error.strerror}'
        raise BrokenRecording(msg, offset) from None


def record_at(file: BinaryIO, offset: int, stop: int) -> RawRecord:
    """
    Return the record that begins at a byte.

    Raises
    ------
    UnfinishedRecording
        If the bytes end inside it.
    BrokenRecording
        If none begins there.

    """
    head = read_at(file, offset, min(RECORD_HEAD.size, stop - offset))
    if len(head) < RECORD_HEAD.size:
        msg = f'the file ends at byte {stop} inside a record'
        raise UnfinishedRecording(msg, offset)
    raw = RawRecord(offset, *RECORD_HEAD.unpack(head))
    if raw.opcode == 0:
        msg = f'no record begins at byte {offset}'
        raise BrokenRecording(msg, offset)
    if raw.end > stop:
        msg = f'the record at byte {offset} should have {raw.length} bytes: the file ends before'
        raise UnfinishedRecording(msg, offset)
    return raw


def walk(file: BinaryIO, start: int, stop: int) -> Iterator[RawRecord]:
    """Step over the top-level records between two offsets; raises as :func:`record_at`."""
    offset = start
    while offset < stop:
        raw = record_at(file, offset, stop)
        yield raw
        offset = raw.end


def read_record(file: BinaryIO, raw: RawRecord) -> McapRecord | None:
    """
    Parse one record; None for a kind that nobody here needs.

    Raises
    ------
    BrokenRecording
        If its content is damaged or larger than is read.

    """
    if raw.opcode not in PARSERS:
        return None
    return parse(raw.opcode, content(file, raw), raw.offset)


def content(file: BinaryIO, raw: RawRecord) -> bytes:
    """
    Return the bytes of a record.

    Raises
    ------
    BrokenRecording
        If it is larger than is read.

    """
    limit = LARGEST_RECORD if raw.opcode in BULKY else LARGEST_TABLE
    if raw.length > limit:
        msg = f'the record at byte {raw.offset} has {raw.length} bytes; limit {limit}'
        raise BrokenRecording(msg, raw.offset)
    return read_at(file, raw.begin, raw.length)


def unpacked_chunk(file: BinaryIO, raw: RawRecord) -> bytes:
    """
    Return the unpacked and checked records of a chunk.

    Raises
    ------
    BrokenRecording
        If the chunk is damaged (CRC, sizes) or larger than ``LARGEST_CHUNK``.

    """
    chunk = parse(Opcode.CHUNK, content(file, raw), raw.offset)
    assert isinstance(chunk, Chunk)
    return _unpack(chunk, raw.offset)


def chunk_records(data: bytes, offset: int) -> Iterator[tuple[int, int, int]]:
    """
    Step over the records of an unpacked chunk: opcode, first byte, length.

    Raises
    ------
    BrokenRecording
        If the chunk ends inside a record.

    """
    at = 0
    while at < len(data):
        if at + RECORD_HEAD.size > len(data):
            break
        opcode, length = RECORD_HEAD.unpack_from(data, at)
        at += RECORD_HEAD.size
        if at + length > len(data):
            break
        yield opcode, at, length
        at += length
    if at != len(data):
        msg = f'the chunk at byte {offset} ends inside a record'
        raise BrokenRecording(msg, offset)


def message_head(data: bytes, at: int, length: int, offset: int) -> tuple[int, int, int]:
    """
    Return channel, log time and publish time of a message; its bytes follow ``MESSAGE_HEAD``.

    Raises
    ------
    BrokenRecording
        If it is too short.

    """
    if length < MESSAGE_HEAD.size:
        msg = f'the message record at byte {offset} is damaged: it has {length} bytes'
        raise BrokenRecording(msg, offset)
    channel, _, log_time, publish_time = MESSAGE_HEAD.unpack_from(data, at)
    return channel, log_time, publish_time


def parse(opcode: int, content: bytes, offset: int) -> McapRecord:
    """
    Parse the content of a record.

    Raises
    ------
    BrokenRecording
        If it is damaged.

    """
    return parse_from(ReadDataStream(BytesIO(content)), opcode, offset)


def parse_from(stream: ReadDataStream, opcode: int, offset: int) -> McapRecord:
    """Parse a record out of a stream, which then counts its bytes; raises as :func:`parse`."""
    try:
        return PARSERS[opcode](stream)
    except FAULTS as error:
        kind = Opcode(opcode).name.lower()
        msg = f'the {kind} record at byte {offset} is damaged ({type(error).__name__})'
        raise BrokenRecording(msg, offset) from None


def _unpack(chunk: Chunk, offset: int) -> bytes:
    """Unpack a chunk: at most as many bytes as it states are ever held, and checked."""
    size = chunk.uncompressed_size
    if size > LARGEST_CHUNK:
        msg = f'the chunk at byte {offset} would unpack to {size} bytes; limit {LARGEST_CHUNK}'
        raise BrokenRecording(msg, offset)
    try:
        if chunk.compression == 'zstd':
            unpacker = zstandard.ZstdDecompressor(max_window_size=LARGEST_CHUNK)
            data = unpacker.stream_reader(chunk.data).read(size + 1)
        elif chunk.compression == 'lz4':
            data = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size + 1)
        elif chunk.compression == '':
            data = chunk.data
        else:
            msg = f'the chunk at byte {offset} is packed with {chunk.compression!r}: not supported'
            raise BrokenRecording(msg, offset)
    except (zstandard.ZstdError, RuntimeError, ValueError, EOFError, MemoryError) as error:
        msg = f'the chunk at byte {offset} cannot be unpacked ({error})'
        raise BrokenRecording(msg, offset) from None
    if len(data) != size:
        msg = f'the chunk at byte {offset} unpacks to {len(data)} bytes instead of {size}'
        raise BrokenRecording(msg, offset)
    if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
        msg = f'the chunk at byte {offset} is damaged: its CRC does not fit'
        raise BrokenRecording(msg, offset)
    return data
