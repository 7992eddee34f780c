# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Read the records of one MCAP file within fixed limits, whatever lengths the file states.

The MCAP specification (https://mcap.dev/spec) defines the records. The mcap package parses records
of texts and tables. This room itself walks through the file, unpacks chunks and reads message
heads: a file from outside may be hostile, so its stated lengths are not trusted, unpacking is
limited, and no object is kept for each of millions of records.
"""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
import struct
from typing import BinaryIO, NamedTuple

from bearing_twin.errors import BearingTwinError
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    Channel,
    Chunk,
    Header,
    McapRecord,
    Metadata,
    Schema,
    Statistics,
)

MAGIC = b'\x89MCAP0\r\n'
LAST_OFFSET = 2**63 - 1
"""Last possible byte of a file."""
LARGEST_RECORD = 128 * 1024 * 1024
"""Largest record that is read into memory, bytes."""
LARGEST_TABLE = 4 * 1024 * 1024
"""Largest record of texts and tables, bytes: each entry becomes several objects."""
RECORD_HEAD = struct.Struct('<BQ')
MESSAGE_HEAD = struct.Struct('<HIQQ')
CHUNK_HEAD = struct.Struct('<QQQII')
"""Start, end, unpacked size, CRC, length of the name of the compression."""
FAULTS = (McapError, struct.error, ValueError, OverflowError, EOFError, RuntimeError, TypeError)
"""Exceptions from parsing damaged bytes; UnicodeDecodeError is a ValueError, lz4 raises
RuntimeError."""

PARSERS: dict[int, Callable[[ReadDataStream], McapRecord]] = {
    Opcode.HEADER: Header.read,
    Opcode.SCHEMA: Schema.read,
    Opcode.CHANNEL: Channel.read,
    Opcode.CHUNK: Chunk.read,
    Opcode.ATTACHMENT: Attachment.read,
    Opcode.STATISTICS: Statistics.read,
    Opcode.METADATA: Metadata.read,
}
BULKY = (Opcode.CHUNK, Opcode.ATTACHMENT, Opcode.MESSAGE)


class BrokenRecording(BearingTwinError):
    """The file is damaged: ``length`` bytes from ``offset`` on are lost."""

    def __init__(self, text: str, offset: int, length: int = 0) -> None:
        super().__init__(text)
        self.offset = offset
        self.length = length


class UnfinishedRecording(BrokenRecording):
    """The end of the recording is missing; the complete records can be recovered."""


class RawRecord(NamedTuple):
    """Position, kind and length of a record in the file."""

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
    """Refuse pipes, sockets and devices: opening or reading one may never end."""
    if path.exists() and not path.is_file() and not path.is_dir():
        msg = f'{path} is no file but a pipe, socket or device; copy its content into a file'
        raise BrokenRecording(msg, 0)


def check_magic(file: BinaryIO) -> None:
    """Refuse a file that does not begin with the MCAP magic bytes."""
    head = read_at(file, 0, len(MAGIC))
    if head != MAGIC:
        reason = 'does not begin with the MCAP magic bytes'
        if not head.strip(b'\0'):
            reason = 'begins with zeros: the disk never got its content' if head else 'is empty'
        raise BrokenRecording(f'it {reason}', 0)


def read_at(file: BinaryIO, offset: int, length: int) -> bytes:
    """Return up to ``length`` bytes from ``offset`` on."""
    if length < 0 or offset > LAST_OFFSET:
        raise BrokenRecording(f'byte {offset} is behind the end of the file', offset)
    try:
        file.seek(offset)
        return file.read(length)
    except OSError as error:
        raise BrokenRecording(f'byte {offset} cannot be read: {error.strerror}', offset) from None


def record_at(file: BinaryIO, offset: int, stop: int) -> RawRecord:
    """
    Return the record that begins at ``offset``; the readable bytes end at ``stop``.

    Raises
    ------
    UnfinishedRecording
        If the bytes end inside the record.
    BrokenRecording
        If no record begins there.

    """
    head = read_at(file, offset, min(RECORD_HEAD.size, stop - offset))
    if len(head) < RECORD_HEAD.size:
        raise UnfinishedRecording(f'the file ends at byte {stop} inside a record', offset)
    raw = RawRecord(offset, *RECORD_HEAD.unpack(head))
    if raw.opcode == 0:
        raise BrokenRecording(f'no record begins at byte {offset}', offset)
    if raw.end > stop:
        msg = f'the record at byte {offset} should have {raw.length} bytes: the file ends before'
        raise UnfinishedRecording(msg, offset)
    return raw


def read_record(file: BinaryIO, raw: RawRecord) -> McapRecord | None:
    """Parse one record; return None for a kind that no reader needs."""
    if raw.opcode not in PARSERS:
        return None
    return parse(raw.opcode, content(file, raw), raw.offset)


def content(file: BinaryIO, raw: RawRecord) -> bytes:
    """Return the bytes of a record, without its head."""
    limit = LARGEST_RECORD if raw.opcode in BULKY else LARGEST_TABLE
    if raw.length > limit:
        msg = f'the record at byte {raw.offset} has {raw.length} bytes; limit {limit}'
        raise BrokenRecording(msg, raw.offset)
    return read_at(file, raw.begin, raw.length)


def message_head(data: bytes, at: int, length: int, offset: int) -> tuple[int, int, int]:
    """Return channel number, log time and publish time (ns) of a message; its content follows."""
    if length < MESSAGE_HEAD.size:
        msg = f'the message record at byte {offset} is damaged: it has {length} bytes'
        raise BrokenRecording(msg, offset)
    channel, _, log_time, publish_time = MESSAGE_HEAD.unpack_from(data, at)
    return channel, log_time, publish_time


def parse(opcode: int, content: bytes, offset: int) -> McapRecord:
    """Parse the content of a record."""
    return parse_from(ReadDataStream(BytesIO(content)), opcode, offset)


def parse_from(stream: ReadDataStream, opcode: int, offset: int) -> McapRecord:
    """Parse a record from a stream, which counts its bytes; raises as :func:`parse`."""
    try:
        return PARSERS[opcode](stream)
    except FAULTS as error:
        kind = Opcode(opcode).name.lower()
        msg = f'the {kind} record at byte {offset} is damaged ({type(error).__name__})'
        raise BrokenRecording(msg, offset) from None
