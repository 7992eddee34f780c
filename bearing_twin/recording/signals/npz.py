# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read arrays of untrusted ``.npz`` and ``.npy`` files: no pickle, and with bounded memory."""

from __future__ import annotations

from collections.abc import Collection, Mapping
import math
from pathlib import Path
from typing import Any, IO
import zipfile

from bearing_twin.errors import BearingTwinError
from bearing_twin.given import real_numbers
from bearing_twin.recording.mcap.mcapfile import refuse_special
from bearing_twin.recording.signals.reading import MOST_UNPACKED, readable
import numpy as np
from numpy.typing import NDArray

MOST_MEMBERS = 10_000
MADE = 'is it complete, and made by NumPy?'


def read_npz(path: Path, wanted: Collection[str] | None = None) -> dict[str, Any]:
    """
    Return the arrays of an ``.npz`` file by name: all, or those in ``wanted`` that exist.

    Raises
    ------
    BearingTwinError
        If the file is damaged, an array holds Python objects, or the arrays are too large.

    """
    refuse_special(path)
    arrays: dict[str, Any] = {}
    room = MOST_UNPACKED
    with readable(path, '.npz', MADE), zipfile.ZipFile(path) as archive:
        members = archive.infolist()
        if len(members) > MOST_MEMBERS:
            msg = f'{path} has {len(members)} members; at most {MOST_MEMBERS} are read'
            raise BearingTwinError(msg)
        for member in members:
            name = member.filename.removesuffix('.npy')
            if wanted is not None and name not in wanted:
                continue
            with archive.open(member) as file:
                arrays[name] = _read_array(file, member.file_size, room, f'{path}: {name}')
            room -= arrays[name].nbytes
    return arrays


def read_npy(path: Path) -> dict[str, Any]:
    """Return the array of an ``.npy`` file as ``x``; errors as :func:`read_npz`."""
    with readable(path, '.npy', MADE), path.open('rb') as file:
        return {'x': _read_array(file, path.stat().st_size, MOST_UNPACKED, str(path))}


def temperature_readings(
    path: Path, arrays: Mapping[str, Any]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return times ``temp_t_s`` (s) and temperatures ``temp_C`` (degC) of a file, shape (n,)."""
    times, temperatures = (
        real_numbers(f'{path}: {name}', arrays[name]).ravel() for name in ('temp_t_s', 'temp_C')
    )
    if times.size != temperatures.size:
        msg = f'{path}: temp_t_s has {times.size} values and temp_C has {temperatures.size}'
        raise BearingTwinError(msg)
    return times, temperatures


def _read_array(file: IO[bytes], size: int, room: int, what: str) -> Any:
    """Return one member; check the size in its header before memory is allocated."""
    if np.lib.format.read_magic(file) == (1, 0):
        shape, by_column, dtype = np.lib.format.read_array_header_1_0(file)
    else:
        shape, by_column, dtype = np.lib.format.read_array_header_2_0(file)
    if dtype.hasobject:
        raise BearingTwinError(f'{what} holds Python objects, which are never loaded from a file')
    needed = math.prod(shape) * dtype.itemsize
    if not 0 <= needed <= min(size, room):
        raise BearingTwinError(
            f'{what} would need {needed} bytes; the member has {size}, and of the '
            f'{MOST_UNPACKED} bytes that are read of a file {room} are left'
        )
    content = bytearray(file.read(needed))
    return np.ndarray(shape, dtype, content, order='F' if by_column else 'C')
