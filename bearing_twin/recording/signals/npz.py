# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Arrays of ``.npz`` files from outside: no pickle, and no memory that the file does not fill."""

from __future__ import annotations

import math
from typing import Any, BinaryIO, TYPE_CHECKING
import zipfile

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcap.mcapfile import refuse_special
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path


MOST_UNPACKED = 1024 * 1024 * 1024
"""Most that is read of a file, unpacked, bytes."""
MOST_MEMBERS = 10_000


def read_npz(path: Path, wanted: Collection[str] | None = None) -> dict[str, Any]:
    """
    Read the arrays of an ``.npz`` file; all, or those of ``wanted`` that are there.

    Raises
    ------
    BearingTwinError
        If the file is damaged, an array holds Python objects, or all are too large together.

    """
    refuse_special(path)
    arrays: dict[str, Any] = {}
    room = MOST_UNPACKED
    try:
        with zipfile.ZipFile(path) as archive:
            members = archive.infolist()
            if len(members) > MOST_MEMBERS:
                msg = f'{path} has {len(members)} members; at most {MOST_MEMBERS} are read'
                raise BearingTwinError(msg)
            for member in members:
                name = member.filename.removesuffix('.npy')
                if wanted is None or name in wanted:
                    with archive.open(member) as file:
                        array = _read_array(file, member.file_size, room, f'{path}: {name}')
                    room -= array.nbytes
                    arrays[name] = array
    except BearingTwinError:
        raise
    except Exception as error:
        # The bytes come from outside: zipfile, numpy and the tokenizer it uses raise many kinds.
        reason = getattr(error, 'strerror', None) or error
        msg = f'{path} cannot be read as .npz ({type(error).__name__}: {reason})'
        raise BearingTwinError(msg) from None
    return arrays


def _read_array(file: Any, size: int, room: int, what: str) -> Any:
    """Read one member, after a look at what its header would have numpy allocate."""
    head = _Rewindable(file)
    version = np.lib.format.read_magic(head)
    if version == (1, 0):
        shape, _, dtype = np.lib.format.read_array_header_1_0(head)
    else:
        shape, _, dtype = np.lib.format.read_array_header_2_0(head)
    if dtype.hasobject:
        msg = f'{what} holds Python objects, which are never loaded from a file'
        raise BearingTwinError(msg)
    needed = math.prod(shape) * dtype.itemsize
    if needed > min(size, room):
        msg = (
            f'{what} would need {needed} bytes; the member has {size}, and of the '
            f'{MOST_UNPACKED} bytes that are read of a file {room} are left'
        )
        raise BearingTwinError(msg)
    return np.lib.format.read_array(head.rewound(), allow_pickle=False)


class _Rewindable:
    """Give a stream's first bytes out a second time: members of archives cannot seek cheaply."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._head = b''
        self._again = b''
        self._recording = True

    def read(self, size: int = -1) -> bytes:
        data = self._again[:size] if size >= 0 else self._again
        self._again = self._again[len(data) :]
        if len(data) < size or size < 0:
            data += self._file.read(size - len(data) if size >= 0 else -1)
        if self._recording:
            self._head += data
        return data

    def rewound(self) -> Any:
        self._recording = False
        self._again = self._head
        return self
