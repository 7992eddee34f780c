# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Serialise messages fast: write changed numbers directly into the bytes of an earlier message."""

from __future__ import annotations

from collections.abc import Callable, Sequence
import functools
import struct
from typing import Any

from bearing_twin.errors import BearingTwinError
import numpy as np
from numpy.typing import NDArray

CODES = {'double': 'd', 'uint64': 'Q', 'uint32': 'I', 'int32': 'i', 'uint8': 'B'}
PROBES = 8
"""Number of messages that are serialised to locate numbers: in one, bytes may match by chance."""
WIDEST_PADDING = 7


class MessageTemplate:
    """
    Serialised messages of one type with constant strings and array lengths.

    The position of each number is found by serialising messages with known numbers, so it is
    correct for the middleware in use. Filling a template takes a few microseconds; building and
    serialising a message object takes ten times as long.

    Parameters
    ----------
    message
        A message; its fields are overwritten.
    numbers
        Names of number fields to fill, in the order of the message; dotted if nested.
    arrays
        Names of float32 array fields to fill.
    serialize
        Function that returns the bytes of a message.

    Raises
    ------
    BearingTwinError
        If the position of a number in the bytes is not unique, or arrays to fill have another
        length.

    """

    def __init__(
        self,
        message: Any,
        numbers: Sequence[str],
        arrays: Sequence[str],
        serialize: Callable[[Any], bytes],
    ) -> None:
        fields = [_field(message, name) for name in numbers]
        codes = [CODES[owner.get_fields_and_field_types()[last]] for owner, last in fields]
        sizes = [len(getattr(message, name)) for name in arrays]
        draw = np.random.default_rng(0)
        samples = []
        for _ in range(PROBES):
            # Bytes of 1 to 63 never form an infinity, a NaN, or zeros, which could be padding.
            probes = [_bytes(draw, struct.calcsize(f'={code}')) for code in codes]
            blocks = [_bytes(draw, 4 * size) for size in sizes]
            for (owner, last), code, raw in zip(fields, codes, probes, strict=True):
                setattr(owner, last, struct.unpack(f'={code}', raw)[0])
            for name, raw in zip(arrays, blocks, strict=True):
                # Write into the existing array of the field: no conversion of types.
                np.frombuffer(getattr(message, name), np.uint8)[:] = np.frombuffer(raw, np.uint8)
            samples.append((bytes(serialize(message)), probes, blocks))
        # Set differing bytes to zero: they are the numbers to fill, or meaningless padding.
        serialized = np.array([np.frombuffer(cdr, np.uint8) for cdr, _, _ in samples])
        same = (serialized == serialized[0]).all(axis=0)
        self._buffer = buffer = bytearray(np.where(same, serialized[0], 0).tobytes())
        places = [
            _place(name, [(cdr, probes[k]) for cdr, probes, _ in samples])
            for k, name in enumerate(numbers)
        ]
        if places != sorted(places):
            msg = f'the numbers of {type(message).__name__} stand in another order: {places}'
            raise BearingTwinError(msg)
        self._runs = _runs(buffer, places, codes)
        # The bytes before, between and behind the arrays.
        ends = [0]
        for k, (name, size) in enumerate(zip(arrays, sizes, strict=True)):
            at = (
                _place(name, [(cdr, blocks[k]) for cdr, _, blocks in samples])
                if size
                else ends[-1]
            )
            ends += [at, at + 4 * size]
        ends.append(len(buffer))
        self._first, *self._others = [
            memoryview(buffer)[begin:end] for begin, end in zip(ends[::2], ends[1::2], strict=True)
        ]

    def fill(self, numbers: Sequence[float], *arrays: NDArray[np.float32]) -> bytes:
        """Return the bytes of the message with these numbers and arrays."""
        for layout, at, first, last in self._runs:
            layout.pack_into(self._buffer, at, *numbers[first:last])
        parts = [self._first]
        for values, piece in zip(arrays, self._others, strict=True):
            parts += [values.data, piece]
        message = b''.join(parts)
        if len(message) != len(self._buffer):
            msg = f'{len(message)} bytes, but {len(self._buffer)} in the message of the template'
            raise BearingTwinError(msg)
        return message


def _field(message: Any, name: str) -> tuple[Any, str]:
    """Return the message that has a field, and its name there, from its dotted name."""
    *path, last = name.split('.')
    return functools.reduce(getattr, path, message), last


def _bytes(draw: np.random.Generator, count: int) -> bytes:
    return draw.integers(1, 64, count, np.uint8).tobytes()


def _place(name: str, samples: list[tuple[bytes, bytes]]) -> int:
    """Return the position of the bytes of a field, the same in every sample."""
    first, raw = samples[0]
    places, at = [], first.find(raw)
    while at >= 0:
        if all(cdr.startswith(other, at) for cdr, other in samples):
            places.append(at)
        at = first.find(raw, at + 1)
    if len(places) != 1:
        msg = f'{name} occurs {len(places)} times in the serialized message, expected once'
        raise BearingTwinError(msg)
    return places[0]


def _runs(
    buffer: bytearray, places: list[int], codes: list[str]
) -> list[tuple[struct.Struct, int, int, int]]:
    """Return a layout for each run of adjacent numbers, with its position, first and end index."""
    runs: list[tuple[str, int, int, int]] = []
    for k, (at, code) in enumerate(zip(places, codes, strict=True)):
        if runs:
            text, begin, first, _ = runs[-1]
            end = begin + struct.calcsize(text)
            gap = at - end
            if gap <= WIDEST_PADDING and not any(buffer[end:at]):
                runs[-1] = (f'{text}{gap}x{code}', begin, first, k + 1)
                continue
        runs.append((f'={code}', at, k, k + 1))
    return [(struct.Struct(text), at, first, last) for text, at, first, last in runs]
