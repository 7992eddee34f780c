# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Variables of MATLAB files from outside (versions 4 to 7; 7.3 is HDF5 and is refused).

scipy reads the file; before it does, the structure of the file is walked over, because neither
unpacked size nor nesting is limited by scipy. The format is that of "MAT-File Format", MathWorks.
"""

from __future__ import annotations

import struct
import warnings
import zlib
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from bearing_twin.errors import BearingTwinError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ['read_mat']

MOST_UNPACKED = 1024 * 1024 * 1024
DEEPEST = 32
HEADER = 128
MATRIX, COMPRESSED = 14, 15


def read_mat(path: Path) -> dict[str, Any]:
    """Read the numeric arrays, scalars and texts of a ``.mat`` file.

    Fields of structs are given by their own name; where two have the same one, the first wins.
    A CWRU record's ``X123RPM`` and ``X123_DE_time`` are also given as ``rpm`` and ``DE_time``.

    Raises
    ------
    BearingTwinError
        If the file is damaged, too large when unpacked, nested too deeply or of version 7.3.
    """
    # Loaded when needed: scipy takes a second.
    from scipy.io import loadmat

    try:
        content = path.read_bytes()
        _check(content, path)
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')
            variables = loadmat(BytesIO(content), squeeze_me=True, struct_as_record=True)
        found: dict[str, Any] = {}
        for name, value in variables.items():
            if not name.startswith('__'):
                _collect(name, value, found, 0)
    except BearingTwinError:
        raise
    except Exception as error:
        # The bytes come from outside: scipy raises many kinds on damaged ones.
        msg = f'{path} cannot be read as .mat ({type(error).__name__}: {error})'
        raise BearingTwinError(msg) from None
    return found


def _collect(name: str, value: Any, found: dict[str, Any], depth: int) -> None:
    array = np.asarray(value)
    if array.dtype.names and depth < DEEPEST:
        for field in array.dtype.names:
            first = array[field].ravel()
            if first.size:
                _collect(field, first[0], found, depth + 1)
    elif array.dtype.kind in 'fiuUS':
        found.setdefault(_plain(name), array)


def _plain(name: str) -> str:
    """Return ``DE_time`` for CWRU's ``X097_DE_time``, ``rpm`` for ``X097RPM``."""
    if name[:1] == 'X' and name[1:4].isdecimal():
        rest = name[4:].lstrip('_')
        return 'rpm' if rest == 'RPM' else rest or name
    return name


def _check(content: bytes, path: Path) -> None:
    """Refuse what scipy would not survive."""
    if len(content) < HEADER or content[:4] == bytes(4) or content[126:128] not in (b'IM', b'MI'):
        # Version 4: flat, and no larger in memory than on the disk.
        return
    order = '<' if content[126:128] == b'IM' else '>'
    (version,) = struct.unpack_from(f'{order}H', content, 124)
    if version != 0x0100:
        msg = f"{path} is MATLAB 7.3 (HDF5), which is not read; save it with '-v7'"
        raise BearingTwinError(msg)
    total = 0
    for kind, data in _elements(memoryview(content)[HEADER:], order, padded=False):
        unpacked = data
        if kind == COMPRESSED:
            unpacked = memoryview(_inflate(bytes(data), MOST_UNPACKED - total, path))
        total += len(unpacked)
        if _is_deep(unpacked if kind == COMPRESSED else data, order, inner=kind == MATRIX):
            msg = f'{path} nests more than {DEEPEST} levels of cells and structs'
            raise BearingTwinError(msg)


def _inflate(data: bytes, limit: int, path: Path) -> bytes:
    unpacked = zlib.decompressobj().decompress(data, limit + 1)
    if len(unpacked) > limit:
        msg = f'{path} would unpack to more than {MOST_UNPACKED} bytes'
        raise BearingTwinError(msg)
    return unpacked


def _is_deep(data: memoryview, order: str, *, inner: bool) -> bool:
    """Whether matrices stand in matrices more than ``DEEPEST`` deep, without recursion."""
    waiting = [(data, 1 if inner else 0)]
    while waiting:
        part, depth = waiting.pop()
        if depth > DEEPEST:
            return True
        waiting += [
            (content, depth + 1)
            for kind, content in _elements(part, order, padded=True)
            if kind == MATRIX
        ]
    return False


def _elements(data: memoryview, order: str, *, padded: bool) -> Iterator[tuple[int, memoryview]]:
    """Yield type and content of the data elements; the last may be cut off."""
    at = 0
    while at + 8 <= len(data):
        first, size = struct.unpack_from(f'{order}II', data, at)
        if first >> 16:
            # Small element: up to four bytes in the tag itself.
            yield first & 0xFFFF, data[at + 4 : at + 8]
            at += 8
            continue
        yield first, data[at + 8 : at + 8 + size]
        at += 8 + size
        if padded:
            at += -at % 8
