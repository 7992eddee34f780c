# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read variables of MATLAB 7.3 files, which are HDF5, by h5py (extra ``files``)."""

from __future__ import annotations

from collections.abc import Iterator
import math
from pathlib import Path
from typing import Any

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.signals.reading import DEEPEST, library, refuse_large
import numpy as np

SIGNATURE = b'\x89HDF\r\n\x1a\n'
MOST_OBJECTS = 10_000
LONGEST_TEXT = 1000


def read_hdf5(path: Path) -> dict[str, Any]:
    """
    Return the numeric arrays, scalars and texts of a MATLAB 7.3 file by name.

    Fields of structs are listed by field name; of equal names, the first one is kept. Links to
    other files and storage outside the file are not followed.

    Raises
    ------
    BearingTwinError
        If h5py is missing, the values are too many, or all variables are cells, tables or objects.

    """
    h5py = library('h5py', path)
    found: dict[str, Any] = {}
    others: list[str] = []
    room = 0
    with h5py.File(path, 'r') as file:
        for name, data in _datasets(h5py, file, set(), 0):
            kind = data.attrs.get('MATLAB_class', b'')
            is_text = kind == b'char'
            plain = not data.is_virtual and not data.id.get_create_plist().get_external_count()
            if not (
                plain and data.dtype.kind in 'fiu' and 'MATLAB_object_decode' not in data.attrs
            ):
                others.append(name)
                continue
            if name in found or 'MATLAB_empty' in data.attrs:
                continue
            # A chunk is unpacked whole, however few of its values are of the array.
            room += max(math.prod(data.shape), math.prod(data.chunks or ()))
            refuse_large(path, room)
            if is_text and data.size <= LONGEST_TEXT:
                units = data[()].ravel().astype('<u2').tobytes()
                found[name] = np.array(units.decode('utf-16-le', 'replace'))
            elif not is_text:
                # MATLAB writes the last axis first.
                found[name] = data[()].T.squeeze()
    if others and all(value.size < 2 for value in found.values()):
        raise BearingTwinError(
            f'{path}: {", ".join(others[:10])} is no array of numbers but a cell, a table or an '
            'object; save the samples as an array of numbers, e.g. x = data{1}'
        )
    return found


def _datasets(h5py: Any, group: Any, seen: set[Any], depth: int) -> Iterator[tuple[str, Any]]:
    """Yield name and data set of what lies in the file, each once."""
    for name in group:
        # '#refs#' holds the contents of cells.
        if name[:1] == '#' or not isinstance(group.get(name, getlink=True), h5py.HardLink):
            continue
        item = group[name]
        if item in seen:
            continue
        seen.add(item)
        if depth > DEEPEST or len(seen) > MOST_OBJECTS:
            msg = f'it nests more than {DEEPEST} structs, or has more than {MOST_OBJECTS} entries'
            raise BearingTwinError(f'{group.file.filename}: {msg}')
        if isinstance(item, h5py.Group):
            yield from _datasets(h5py, item, seen, depth + 1)
        elif isinstance(item, h5py.Dataset):
            yield name, item
