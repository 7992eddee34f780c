# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Counter-based random numbers: sample k of a stream depends only on the seed and k.

There is no generator state, so splitting a block or restoring a simulator changes no bit.
Philox2x32-10 of Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1, 2, 3",
SC11, followed by Box and Muller's transform in single precision, free of branches and calls so
that the compiler works on many samples, or many bearings, at once.
"""

from __future__ import annotations

import math

from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.vector import (
    chosen,
    has_bit,
    logarithm,
    real,
    root,
    sines,
    splat,
    split,
)
import numpy as np

NOISE, WALK, SURFACE = 0, 1, 2
"""Streams of one seed: sensor noise, cage phase, profiles of races and balls."""

_MULTIPLIER = np.uint64(0xD256D193)
_WEYL = np.uint64(0x9E3779B9)
_LOW = np.uint64(0xFFFFFFFF)
_SHIFT = np.uint64(32)
_STREAM = np.uint64(30)
_EIGHT = np.uint64(8)
_QUADRANT = np.uint64(30)
_FRACTION = np.uint64(0x3FFFFFFF)

_F = np.float32
_QUARTER_TURN = _F(0.5 * math.pi * 2.0**-30)
_EIGHTH = _F(0.25 * math.pi)


@compiled(inline=True)
def _philox_round(low, high, key):
    product = low * _MULTIPLIER
    return (product >> _SHIFT) ^ key ^ high, product & _LOW, (key + _WEYL) & _LOW


@compiled(inline=True)
def philox(counter_low, counter_high, key):
    """
    Return two random uint64 below 2^32 after ten rounds of Philox2x32.

    The rounds are written out: a loop here would prevent vectorising the caller's loop over
    samples.
    """
    low, high, key = _philox_round(counter_low, counter_high, key)
    low, high, key = _philox_round(low, high, key)
    low, high, key = _philox_round(low, high, key)
    low, high, key = _philox_round(low, high, key)
    low, high, key = _philox_round(low, high, key)
    low, high, key = _philox_round(low, high, key)
    low, high, key = _philox_round(low, high, key)
    low, high, key = _philox_round(low, high, key)
    low, high, key = _philox_round(low, high, key)
    low, high, key = _philox_round(low, high, key)
    return low, high


@compiled(inline=True, fast=FAST)
def _log(u):
    """Natural logarithm of a positive float32, to 1e-7."""
    bits = np.int32(_F(u).view(np.int32))
    # Split at sqrt(1/2), so that the mantissa lies in 0.707..1.414.
    exponent = np.int32((bits - np.int32(0x3F3504F3)) >> np.int32(23))
    m = np.int32(bits - np.int32(exponent << np.int32(23))).view(np.float32)
    return logarithm(_F(exponent), m)


@compiled(inline=True, fast=FAST)
def normal_pair(index, stream, seed):
    """
    Two independent standard normal numbers (float32) for sample ``index`` of a ``stream``.

    ``index`` counts to 2^62; ``seed`` is a uint64 below 2^32.
    """
    k = np.uint64(index)
    low = k & _LOW
    high = (k >> _SHIFT) | (np.uint64(stream) << _STREAM)
    a, b = philox(low, high, np.uint64(seed) & _LOW)
    u = (_F(np.int32(a >> _EIGHT)) + _F(0.5)) * _F(2.0**-24)
    radius = np.sqrt(_F(-2.0) * _log(u))
    # 30 bits give the angle in the quarter turn around 0, two bits choose the quarter.
    angle = _F(np.int32(b & _FRACTION)) * _QUARTER_TURN - _EIGHTH
    c, s = sines(angle)
    quarter = b >> _QUADRANT
    odd = (quarter & np.uint64(1)) != np.uint64(0)
    first = -s if odd else c
    second = c if odd else s
    signed = -radius if quarter >= np.uint64(2) else radius
    return signed * first, signed * second


@compiled(inline=True, fast=FAST)
def normal_pairs(index, stream, seeds):
    """Like `normal_pair`, for sixteen seeds (`vector.WORDS`)."""
    k = np.uint64(index)
    low = splat(k & _LOW)
    high = splat((k >> _SHIFT) | (np.uint64(stream) << _STREAM))
    a, b = philox(low, high, seeds & _LOW)
    exponent, rest = split((real(a >> _EIGHT) + _F(0.5)) * _F(2.0**-24))
    radius = root(_F(-2.0) * logarithm(exponent, rest))
    c, s = sines(real(b & _FRACTION) * _QUARTER_TURN - _EIGHTH)
    odd = has_bit(b, _QUADRANT)
    signed = chosen(has_bit(b, _QUADRANT + np.uint64(1)), -radius, radius)
    return signed * chosen(odd, -s, c), signed * chosen(odd, c, s)
