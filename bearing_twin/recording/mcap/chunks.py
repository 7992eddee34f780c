# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Unpack the chunks of one MCAP file and step through their records at a bounded cost."""

from __future__ import annotations

from collections.abc import Iterator
from typing import BinaryIO, NoReturn, TYPE_CHECKING
import zlib

from bearing_twin.recording.mcap.mcapfile import BrokenRecording, content, parse, RECORD_HEAD
import lz4.frame  # type: ignore[import-untyped]
from mcap.opcode import Opcode
from mcap.records import Chunk
import zstandard

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.mcapfile import RawRecord


LARGEST_CHUNK = 128 * 1024 * 1024
"""Largest chunk after unpacking, bytes."""
MOST_UNPACKED, UNPACKED_PER_BYTE = 8 * 1024**3, 192
"""Limit of the unpacked bytes of all chunks: a constant, and the number added for each byte of the
file. Unpacking takes 0.2 to 0.33 s per GB, so a file of 100 MB takes 10 s at most. Blocks of zeros
are compressed 67 to 315 times."""
LARGE, FRESH = 16 * 1024 * 1024, 4
"""Chunks above this size (bytes) are unpacked into new memory, and their bytes count this many
times: the system takes three times as long to provide the memory as unpacking takes to fill it."""
MOST_MESSAGES, BYTES_PER_MESSAGE = 1_000_000, 4
"""Limit of the messages in all chunks: a constant, and one more for this many bytes of the file.
The index that other recorders write takes 16 bytes a message."""
MOST_WORK, BYTES_PER_WORK = 1_000_000, 20
"""Limit of the work besides messages, in units of about 1 us: a constant, and one more for this
many bytes of the file."""
CHUNK, NEW_DESCRIPTION, MESSAGE = 60, 20, 30
"""Units of work: cost of a chunk without messages, cost of a new schema or channel, and credit for
each message."""
OCTETS = 1024
"""Bytes of a record that cost one more unit of work."""


class ReadLimitExceeded(BrokenRecording):
    """The file costs more than its size allows; reading stops here."""


class Chunks:
    """
    Unpack the chunks of a file within limits that grow with the size of the file.

    A chunk of a few kB can unpack to millions of records. With a limit for each chunk only, a
    small file of many chunks could keep its reader busy for hours.
    """

    def __init__(self, file: BinaryIO, size: int) -> None:
        self.file = file
        self.size = size
        self._zstd = zstandard.ZstdDecompressor()
        self._unpacked = MOST_UNPACKED + UNPACKED_PER_BYTE * size
        self._messages = MOST_MESSAGES + size // BYTES_PER_MESSAGE
        self._work = MOST_WORK + size // BYTES_PER_WORK

    def unpack(self, raw: RawRecord) -> bytes:
        """
        Return the unpacked and checked records of a chunk.

        Raises
        ------
        ReadLimitExceeded
            If the chunks of the file unpack to more than the limit.
        BrokenRecording
            If the chunk is damaged (wrong CRC or size) or larger than ``LARGEST_CHUNK``.

        """
        chunk = parse(Opcode.CHUNK, content(self.file, raw), raw.offset)
        assert isinstance(chunk, Chunk)
        size = chunk.uncompressed_size
        if size > LARGEST_CHUNK:
            msg = (
                f'the chunk at byte {raw.offset} would unpack to {size} bytes; '
                f'limit {LARGEST_CHUNK}'
            )
            raise BrokenRecording(msg, raw.offset)
        self._unpacked -= size * FRESH if size > LARGE else size
        if self._unpacked < 0:
            self.refuse(raw.offset, 'its chunks unpack to too much for its size')
        self.work(raw.offset, CHUNK)
        return _unpack(chunk, raw.offset, self._zstd)

    def records(self, data: bytes, offset: int) -> Iterator[tuple[int, int, int]]:
        """
        Yield opcode, first byte and length of each record of an unpacked chunk.

        Raises
        ------
        ReadLimitExceeded
            If the chunks of the file hold more records than the limit.
        BrokenRecording
            If the chunk ends inside a record.

        """
        at = messages = 0
        while at < len(data):
            if at + RECORD_HEAD.size > len(data):
                break
            opcode, length = RECORD_HEAD.unpack_from(data, at)
            at += RECORD_HEAD.size
            if at + length > len(data):
                break
            if opcode == Opcode.MESSAGE:
                messages += 1
            else:
                self.work(offset, 1 + length // OCTETS)
            yield opcode, at, length
            at += length
        if messages:
            # Recorders write one chunk for each message of a slow topic: that is no excess.
            self._work += CHUNK + MESSAGE * messages
        self._messages -= messages
        if self._messages < 0:
            self.refuse(offset, 'it has more messages than its size allows')
        if at != len(data):
            raise BrokenRecording(f'the chunk at byte {offset} ends inside a record', offset)

    def work(self, offset: int, amount: int) -> None:
        """Subtract work besides messages from the limit."""
        self._work -= amount
        if self._work < 0:
            self.refuse(offset, 'it has too many records besides messages')

    def refuse(self, offset: int, reason: str) -> NoReturn:
        """Stop reading: raise a ReadLimitExceeded."""
        msg = f'nothing is read from byte {offset} on: {reason}'
        raise ReadLimitExceeded(msg, offset, self.size - offset)


def _unpack(chunk: Chunk, offset: int, unpacker: zstandard.ZstdDecompressor) -> bytes:
    """Unpack a chunk and check it; at most the stated number of bytes is held in memory."""
    size = chunk.uncompressed_size
    try:
        if chunk.compression == 'zstd':
            # zstandard allocates the size stated in the frame, whatever max_output_size is.
            if zstandard.frame_content_size(chunk.data) > size:
                raise ValueError(f'it states more than {size} bytes')
            data = unpacker.decompress(chunk.data, max_output_size=max(size, 1))
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
