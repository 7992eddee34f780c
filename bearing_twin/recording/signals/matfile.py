# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Read variables of untrusted MATLAB files (versions 4 to 7, and 7.3 by :mod:`.hdf5file`).

scipy.io.loadmat (1.17) is not used, because damaged files crash it with a segmentation fault. The
format is described in "MAT-File Format", The MathWorks, 2019. Only real numbers, texts, and
structs of these are read.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
import math
from pathlib import Path
import struct
from typing import Any
import zlib

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.signals.hdf5file import read_hdf5, SIGNATURE
from bearing_twin.recording.signals.reading import DEEPEST, MOST_UNPACKED, readable
import numpy as np

MOST_FIELDS = 10_000
HEADER = 128

NUMBERS = {
    1: 'i1', 2: 'u1', 3: 'i2', 4: 'u2', 5: 'i4', 6: 'u4', 7: 'f4', 9: 'f8', 12: 'i8', 13: 'u8',
}  # fmt: skip
"""Data types of numeric elements."""
TEXTS = {1: 'latin-1', 2: 'latin-1', 4: 'utf-16', 16: 'utf-8', 17: 'utf-16', 18: 'utf-32'}
MATRIX, COMPRESSED = 14, 15
STRUCT, CHAR = 2, 4
NUMERIC = range(6, 16)
"""Array classes double to uint64."""
VERSION_4 = ('f8', 'f4', 'i4', 'i2', 'u2', 'u1')


def read_mat(path: Path) -> dict[str, Any]:
    """
    Return the numeric arrays, scalars and texts of a ``.mat`` file by name.

    Fields of structs are listed by field name; of equal names, the first one is kept. ``X123RPM``
    and ``X123_DE_time`` of CWRU records become ``rpm`` and ``DE_time``.

    Raises
    ------
    BearingTwinError
        If the file is damaged, too large when unpacked or nested too deeply.

    """
    found: dict[str, Any] = {}
    with readable(path, '.mat', 'is it complete?'):
        content = path.read_bytes()
        if SIGNATURE in content[:520]:
            return {_plain(name): value for name, value in read_hdf5(path).items()}
        try:
            for name, value in _variables(content):
                found.setdefault(_plain(name), value)
        except BearingTwinError as error:
            raise BearingTwinError(f'{path}: {error}') from None
    return found


def _plain(name: str) -> str:
    """Return ``DE_time`` for CWRU's ``X097_DE_time``, ``rpm`` for ``X097RPM``."""
    if name[:1] == 'X' and name[1:4].isdecimal():
        rest = name[4:].lstrip('_')
        return 'rpm' if rest == 'RPM' else rest or name
    return name


def _variables(content: bytes) -> Iterator[tuple[str, Any]]:
    mark = content[126:HEADER]
    if mark not in (b'IM', b'MI'):
        yield from _version_4(content)
        return
    order = '<' if mark == b'IM' else '>'
    (version,) = struct.unpack_from(f'{order}H', content, 124)
    if version != 0x0100:
        raise BearingTwinError(f'its header states version {version:#x}, and it is no HDF5')
    room = MOST_UNPACKED
    for kind, data in _elements(memoryview(content)[HEADER:], order, padded=False):
        if kind == COMPRESSED:
            unpacked = zlib.decompressobj().decompress(data, room + 1)
            if len(unpacked) > room:
                raise BearingTwinError(f'it would unpack to more than {MOST_UNPACKED} bytes')
            room -= len(unpacked)
            for inner, part in _elements(memoryview(unpacked), order, padded=True):
                if inner == MATRIX:
                    yield from _matrix(part, order, '', 0)
        elif kind == MATRIX:
            yield from _matrix(data, order, '', 0)


def _elements(data: memoryview, order: str, *, padded: bool) -> Iterator[tuple[int, memoryview]]:
    """Yield type and content of the data elements; each must lie inside ``data``."""
    at = 0
    while at + 8 <= len(data):
        first, size = struct.unpack_from(f'{order}II', data, at)
        if first >> 16:
            # Small element: the tag itself contains up to four bytes of data.
            yield first & 0xFFFF, data[at + 4 : at + 4 + min(first >> 16, 4)]
            at += 8
            continue
        if at + 8 + size > len(data):
            msg = f'an element of {size} bytes exceeds the {len(data)} bytes of its parent'
            raise BearingTwinError(msg)
        yield first, data[at + 8 : at + 8 + size]
        at += 8 + size
        if padded:
            at += -at % 8


def _matrix(data: memoryview, order: str, name: str, depth: int) -> Iterator[tuple[str, Any]]:
    """Yield name and value of one array, or of the fields of a struct."""
    if depth > DEEPEST:
        raise BearingTwinError(f'it nests more than {DEEPEST} levels of structs')
    elements = _elements(data, order, padded=True)
    head = [part for _, part in islice(elements, 3)]
    if len(head) < 3 or len(head[0]) < 4:
        return
    kind = struct.unpack_from(f'{order}I', head[0])[0] & 0xFF
    whole = len(head[1]) % 4 == 0
    shape = list(map(int, np.frombuffer(head[1], f'{order}i4'))) if whole else []
    name = bytes(head[2]).decode('latin-1') or name
    if kind == STRUCT:
        yield from _struct(elements, order, depth)
        return
    stored, part = next(elements, (0, data[:0]))
    if kind == CHAR and stored in TEXTS:
        yield name, np.array(_text(stored, part, order))
    elif kind in NUMERIC and stored in NUMBERS:
        values = np.frombuffer(part, f'{order}{NUMBERS[stored]}')
        if math.prod(shape) != values.size:
            msg = f'{name} has {values.size} values, which do not make {shape}'
            raise BearingTwinError(msg)
        yield name, values.reshape(shape, order='F').squeeze()


def _struct(
    elements: Iterator[tuple[int, memoryview]], order: str, depth: int
) -> Iterator[tuple[str, Any]]:
    """Yield the fields of a struct, or of the first struct of an array."""
    layout = [part for _, part in islice(elements, 2)]
    if len(layout) < 2 or len(layout[0]) < 4:
        return
    (length,) = struct.unpack_from(f'{order}i', layout[0])
    names = bytes(layout[1])
    if not 1 <= length <= 256 or len(names) // length > MOST_FIELDS:
        raise BearingTwinError(f'a struct has field names of {length} bytes, {len(names)} in all')
    for at in range(0, len(names) - length + 1, length):
        name = names[at : at + length].split(b'\0')[0].decode('latin-1')
        kind, part = next(elements, (0, memoryview(b'')))
        if kind == MATRIX:
            yield from _matrix(part, order, name, depth + 1)


def _text(stored: int, part: memoryview, order: str) -> str:
    encoding = TEXTS[stored]
    if encoding in ('utf-16', 'utf-32'):
        encoding += '-le' if order == '<' else '-be'
    return bytes(part).decode(encoding, 'replace')


def _version_4(content: bytes) -> Iterator[tuple[str, Any]]:
    at = 0
    while at + 20 <= len(content):
        order = '<' if 0 <= struct.unpack_from('<i', content, at)[0] < 1000 else '>'
        code, rows, columns, imaginary, length = struct.unpack_from(f'{order}5i', content, at)
        kind = VERSION_4[code // 10 % 10] if code // 10 % 10 < len(VERSION_4) else ''
        if not (0 <= code < 5000 and kind and rows >= 0 and columns >= 0 and 1 <= length <= 256):
            raise BearingTwinError('it begins neither as version 4 nor as version 5')
        name = content[at + 20 : at + 20 + length].split(b'\0')[0].decode('latin-1')
        at += 20 + length
        size = rows * columns * np.dtype(kind).itemsize
        if at + size > len(content):
            msg = f'{name} should have {rows} x {columns} values: the file ends before'
            raise BearingTwinError(msg)
        values = np.frombuffer(content, f'{order}{kind}', rows * columns, at)
        at += size * (2 if imaginary else 1)
        if code % 10 == 0:
            yield name, values.reshape((rows, columns), order='F').squeeze()
