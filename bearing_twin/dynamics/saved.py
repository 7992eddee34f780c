# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Format of saved states: kind and version, checksum, and identity of the twin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TYPE_CHECKING
import zlib

from bearing_twin.errors import BearingTwinError

if TYPE_CHECKING:
    import struct

    from bearing_twin.dynamics.parameters import TwinParameters


_CHECKSUM = 4
"""Bytes of the CRC-32 of all following bytes, little endian."""


@dataclass(frozen=True)
class StateFormat:
    """
    Format of one kind of saved states: magic number, checksum, fixed-size fields and body.

    Examples
    --------
    >>> import struct
    >>> demo = StateFormat(b'demo1', struct.Struct('<d'), 'a demo')
    >>> demo.unpack(demo.pack([25.0], b'state'))
    ((25.0,), b'state')

    """

    magic: bytes
    """Kind and version, at the beginning of the state."""
    fields: struct.Struct
    kind: str
    """Owner of the state, for error messages."""

    def pack(self, fields: Sequence[Any], body: bytes) -> bytes:
        """Return the bytes of a saved state."""
        packed = self.fields.pack(*fields)
        checksum = zlib.crc32(body, zlib.crc32(packed))
        return self.magic + checksum.to_bytes(_CHECKSUM, 'little') + packed + body

    def unpack(self, data: bytes) -> tuple[tuple[Any, ...], bytes]:
        """
        Return fields and body of a saved state.

        Raises
        ------
        BearingTwinError
            If ``data`` is of another kind or version, truncated or damaged.

        """
        data = bytes(data)
        if data[: len(self.magic)] != self.magic:
            msg = (
                f'saved state is not that of {self.kind} of this version of bearing_twin; '
                'start without it'
            )
            raise BearingTwinError(msg)
        head = len(self.magic) + _CHECKSUM
        checksum = int.from_bytes(data[len(self.magic) : head], 'little')
        if len(data) < head + self.fields.size or zlib.crc32(data[head:]) != checksum:
            msg = f'saved state of {len(data)} bytes is truncated or damaged; start without it'
            raise BearingTwinError(msg)
        return self.fields.unpack_from(data, head), data[head + self.fields.size :]


def identity(parameters: Sequence[TwinParameters]) -> int:
    """
    Return the checksum of geometries and thermal modes, which a saved state must match.

    Examples
    --------
    Load and preset may differ, the bearing may not:

    >>> from bearing_twin.dynamics import preset
    >>> identity([preset('paper')]) == identity([preset('incipient')])
    True
    >>> identity([preset('paper')]) == identity([preset('paper', bearing='6205')])
    False

    """
    known = [
        (b.n_balls, b.d_ball, b.d_pitch, b.contact_angle, p.thermal_mode)
        for p in parameters
        for b in [p.bearing]
    ]
    return zlib.crc32(repr(known).encode())
