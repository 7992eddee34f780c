# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""Sensors, noise and decimation of a group of a fleet."""

from __future__ import annotations

from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.random import NOISE, normal_pairs
from bearing_twin.numerics.vector import L, load, splat, store
import numpy as np

TAPS = 11
"""Taps of the decimator applied at once."""

_ROW, _LANES = np.uint64(2 * L), np.uint64(L)


@compiled(inline=True, fast=FAST)
def _weigh(row, z, v, a, j, a1, j1):
    """Apply one row of the sensor table; see `filters.resonator`."""
    return (
        (load(row, 0) * z + load(row, 1) * v)
        + (load(row, 2) * a + load(row, 3) * j)
        + (load(row, 4) * a1 + load(row, 5) * j1)
    )


@compiled(inline=True, fast=FAST)
def sense(group, z, v, a, j, a1, j1):
    """Return both states of one sensor axis at the end of a step, and its output."""
    z, v = _weigh(group.to_z, z, v, a, j, a1, j1), _weigh(group.to_w, z, v, a, j, a1, j1)
    read = group.read
    return z, v, load(read, 0) * z + load(read, 1) * v + load(read, 2) * a1


@compiled(fast=FAST, borrows=True)
def _some_taps(tile, raw, begin, taps, first, rows):
    """Apply `TAPS` taps, which stay in registers, to ``rows`` rows."""
    t0, t1, t2 = splat(taps[first]), splat(taps[first + 1]), splat(taps[first + 2])
    t3, t4, t5 = splat(taps[first + 3]), splat(taps[first + 4]), splat(taps[first + 5])
    t6, t7, t8 = splat(taps[first + 6]), splat(taps[first + 7]), splat(taps[first + 8])
    t9, t10 = splat(taps[first + 9]), splat(taps[first + 10])
    for i in range(rows):
        k = begin + i
        some = t0 * load(raw, k) + t1 * load(raw, k + 2) + t2 * load(raw, k + 4)
        more = t3 * load(raw, k + 6) + t4 * load(raw, k + 8) + t5 * load(raw, k + 10)
        some = some + t6 * load(raw, k + 12) + t7 * load(raw, k + 14) + t8 * load(raw, k + 16)
        more = more + t9 * load(raw, k + 18) + t10 * load(raw, k + 20)
        store(tile, i, load(tile, i) + (some + more))


@compiled(fast=FAST, borrows=True)
def _noise(tile, group, first, count):
    strength, seeds = load(group.noise, 0), load(group.seed, 0)
    for k in range(count):
        x, y = normal_pairs(first + k, NOISE, seeds)
        store(tile, 2 * k, strength * x)
        store(tile, 2 * k + 1, strength * y)


@compiled(fast=FAST, borrows=True)
def copy(to, begin, source, first, rows):
    """Copy rows; within one array only towards its beginning."""
    for i in range(rows):
        store(to, begin + i, load(source, first + i))


@compiled(fast=FAST, borrows=True)
def hand_out(tile, out, lane, begin, count):
    """Copy ``count`` samples to ``out``, from row ``lane`` and sample ``begin`` on."""
    # Unsigned, because each index that might be negative is checked.
    lane, begin = np.uint64(lane), np.uint64(begin)
    for axis in range(np.uint64(2)):
        for i in range(_LANES):
            for k in range(np.uint64(count)):
                out[axis, lane + i, begin + k] = tile[k * _ROW + axis * _LANES + i]


@compiled()
def decimate(tile, raw, taps, oversample, group, first, count):
    """
    Fill ``tile`` with ``count`` output samples: sensor noise plus the decimated signal.

    ``raw`` holds the internal samples in polyphase order, so that a tap is the same shift for all
    output samples.
    """
    _noise(tile, group, first, count)
    stride = raw.shape[0] // oversample // L
    each = taps.shape[0] // oversample
    for phase in range(oversample):
        for tap in range(0, each, TAPS):
            begin = phase * stride + 2 * tap
            _some_taps(tile, raw, begin, taps, phase * each + tap, 2 * count)
