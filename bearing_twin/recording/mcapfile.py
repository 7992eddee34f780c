# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Records of one MCAP file, read within stated bounds whatever the file claims.

The records are those of the MCAP specification (https://mcap.dev/spec) and are parsed by the mcap
package. Walking the file and unpacking chunks is done here, because a reader of files from outside
must neither believe a length that the file states nor unpack without a limit.
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
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Message,
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
    'LARGEST_CHUNK',
    'LARGEST_RECORD',
    'MAGIC',
    'BrokenRecording',
    'UnfinishedRecording',
    'chunk_records',
    'open_mcap',
    'read_record',
    'read_summary',
    'refuse_special',
    'walk',
]

MAGIC = b'\x89MCAP0\r\n'
LARGEST_RECORD = 256 * 1024 * 1024
"""Largest record that is read into memory, bytes."""
LARGEST_CHUNK = 256 * 1024 * 1024
"""Largest chunk after unpacking, bytes."""
FOOTER_LENGTH = 9 + 20
FAULTS = (McapError, struct.error, ValueError, OverflowError, EOFError, RuntimeError, TypeError)
"""What parsing damaged bytes raises: UnicodeDecodeError is a ValueError, lz4's a RuntimeError."""

PARSERS: dict[int, Callable[[ReadDataStream], McapRecord]] = {
    Opcode.HEADER: Header.read,
    Opcode.FOOTER: Footer.read,
    Opcode.SCHEMA: Schema.read,
    Opcode.CHANNEL: Channel.read,
    Opcode.CHUNK: Chunk.read,
    Opcode.CHUNK_INDEX: ChunkIndex.read,
    Opcode.ATTACHMENT: Attachment.read,
    Opcode.ATTACHMENT_INDEX: AttachmentIndex.read,
    Opcode.STATISTICS: Statistics.read,
    Opcode.METADATA: Metadata.read,
    Opcode.METADATA_INDEX: MetadataIndex.read,
    Opcode.DATA_END: DataEnd.read,
}


class BrokenRecording(BearingTwinError):
    """Bytes that are no MCAP; ``offset`` is where the trouble begins."""

    def __init__(self, text: str, offset: int) -> None:
        super().__init__(text)
        self.offset = offset


class UnfinishedRecording(BrokenRecording):
    """A recording whose end is missing; what is complete can be recovered."""


class RawRecord(NamedTuple):
    """A record as it lies in the file."""

    offset: int
    opcode: int
    length: int


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
    except OSError as error:
        msg = f'{path} cannot be read: {error.strerror}'
        raise BearingTwinError(msg) from None
    if file.read(len(MAGIC)) != MAGIC:
        file.close()
        msg = f'{path} is no MCAP file: it does not begin with the MCAP magic bytes'
        raise BrokenRecording(msg, 0)
    return file


def walk(file: BinaryIO, start: int, stop: int) -> Iterator[RawRecord]:
    """
    Step over the top-level records between two offsets.

    Raises
    ------
    UnfinishedRecording
        If the bytes end inside a record.

    """
    offset = start
    while offset < stop:
        file.seek(offset)
        head = file.read(9)
        if len(head) < 9:
            msg = f'the file ends at byte {stop} inside a record'
            raise UnfinishedRecording(msg, offset)
        opcode, length = struct.unpack('<BQ', head)
        if offset + 9 + length > stop:
            msg = f'the record at byte {offset} should have {length} bytes: the file ends before'
            raise UnfinishedRecording(msg, offset)
        yield RawRecord(offset, opcode, length)
        offset += 9 + length


def read_record(file: BinaryIO, raw: RawRecord) -> McapRecord | None:
    """
    Parse one record; None for a kind that is not in the specification.

    Raises
    ------
    BrokenRecording
        If its content is damaged or larger than ``LARGEST_RECORD``.

    """
    if raw.opcode not in PARSERS and raw.opcode != Opcode.MESSAGE:
        return None
    if raw.length > LARGEST_RECORD:
        msg = f'the record at byte {raw.offset} has {raw.length} bytes; limit {LARGEST_RECORD}'
        raise BrokenRecording(msg, raw.offset)
    file.seek(raw.offset + 9)
    return _parse(raw.opcode, file.read(raw.length), raw.offset)


def chunk_records(chunk: Chunk, offset: int) -> Iterator[McapRecord]:
    """
    Unpack a chunk and parse the schemas, channels and messages in it.

    Raises
    ------
    BrokenRecording
        If the chunk is damaged (CRC, sizes, content) or larger than ``LARGEST_CHUNK``.

    """
    data = _unpack(chunk, offset)
    view = memoryview(data)
    at = 0
    while at < len(data):
        if at + 9 > len(data):
            msg = f'the chunk at byte {offset} ends inside a record'
            raise BrokenRecording(msg, offset)
        opcode, length = struct.unpack_from('<BQ', data, at)
        at += 9
        if at + length > len(data):
            msg = f'the chunk at byte {offset} ends inside a record'
            raise BrokenRecording(msg, offset)
        if opcode in (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE):
            yield _parse(opcode, bytes(view[at : at + length]), offset)
        at += length


def read_summary(file: BinaryIO, size: int) -> list[McapRecord]:
    """
    Read the summary section at the end of a finished file; empty where it has none.

    Raises
    ------
    UnfinishedRecording
        If the file has no footer.
    BrokenRecording
        If the summary is damaged.

    """
    end = size - FOOTER_LENGTH - len(MAGIC)
    tail = b''
    if end >= len(MAGIC):
        file.seek(end)
        tail = file.read(FOOTER_LENGTH + len(MAGIC))
    if not tail.endswith(MAGIC) or tail[:9] != struct.pack('<BQ', Opcode.FOOTER, 20):
        msg = 'the recording was not finished: its end is missing'
        raise UnfinishedRecording(msg, size)
    start, _, _ = struct.unpack_from('<QQI', tail, 9)
    if start == 0:
        return []
    if not len(MAGIC) <= start <= end:
        msg = f'the footer points to byte {start}, outside the file of {size} bytes'
        raise BrokenRecording(msg, end)
    found = (read_record(file, raw) for raw in walk(file, start, end))
    return [record for record in found if record is not None]


def _parse(opcode: int, content: bytes, offset: int) -> McapRecord:
    stream = ReadDataStream(BytesIO(content))
    record: McapRecord
    try:
        if opcode == Opcode.MESSAGE:
            record = Message.read(stream, len(content))
        else:
            record = PARSERS[opcode](stream)
    except FAULTS as error:
        kind = Opcode(opcode).name.lower()
        msg = f'the {kind} record at byte {offset} is damaged ({type(error).__name__})'
        raise BrokenRecording(msg, offset) from None
    return record


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
