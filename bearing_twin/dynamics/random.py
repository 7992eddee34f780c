# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Counter-based random numbers: sample k of a stream is a function of (seed, k), not of history.

No state has to be carried, so splitting a block or restoring a simulator changes no bit.
Philox2x32-10 of Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1, 2, 3",
SC11, followed by Box and Muller's transform.
"""

from __future__ import annotations

import math

import numba as nb
import numpy as np

__all__ = ['NOISE', 'WALK', 'normal_pair', 'philox']

NOISE, WALK = 0, 1
"""Streams of one seed: sensor noise and cage phase."""

_MULTIPLIER = np.uint64(0xD256D193)
_WEYL = np.uint64(0x9E3779B9)
_LOW = np.uint64(0xFFFFFFFF)
_SHIFT = np.uint64(32)
_TO_UNIT = 2.0**-32


@nb.njit(cache=True, inline='always')
def philox(counter_low, counter_high, key):  # type: ignore[no-untyped-def]
    """Ten rounds of Philox2x32 on uint64 values below 2^32; returns two of them."""
    low, high = counter_low, counter_high
    for _ in range(10):
        product = low * _MULTIPLIER
        low = (product >> _SHIFT) ^ key ^ high
        high = product & _LOW
        key = (key + _WEYL) & _LOW
    return low, high


@nb.njit(cache=True, inline='always')
def normal_pair(index, stream, seed):  # type: ignore[no-untyped-def]
    """Two independent standard normal numbers for sample ``index`` of a ``stream``.

    ``index`` counts to 2^62; ``seed`` is a uint64 of which 32 bits are used.
    """
    k = np.uint64(index)
    low = k & _LOW
    high = (k >> _SHIFT) | (np.uint64(stream) << np.uint64(30))
    a, b = philox(low, high, np.uint64(seed) & _LOW)
    radius = math.sqrt(-2.0 * math.log((a + 0.5) * _TO_UNIT))
    angle = 2.0 * math.pi * b * _TO_UNIT
    return radius * math.cos(angle), radius * math.sin(angle)
