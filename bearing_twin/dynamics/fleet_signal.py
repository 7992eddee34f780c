# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""From the housings of a group of a fleet to what is published: sensors, noise, decimation."""

from __future__ import annotations

from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.fleet_layout import A, AN, J, JN, L, OUT, READ, TO_W, TO_Z, WX, ZX
from bearing_twin.dynamics.random import NOISE, normal_pair
import numpy as np

__all__ = ['TAPS', 'decimate', 'sense']

TAPS = 11
"""Taps of the decimator applied at once."""

_F, _U = np.float32, np.uint64
_ROW, _LANES, _FROM = np.uint64(2 * L), np.uint64(L), np.uint64(OUT * L)


@compiled(inline=True, fast=FAST)
def _weigh(w, row, i, z, v, a, j, a1, j1):
    """One row of the sensor's table; see `filters.resonator`."""
    return (
        (w[row * L + i] * z + w[(row + 1) * L + i] * v)
        + (w[(row + 2) * L + i] * a + w[(row + 3) * L + i] * j)
        + (w[(row + 4) * L + i] * a1 + w[(row + 5) * L + i] * j1)
    )


@compiled(inline=True, fast=FAST)
def _sense_axis(w, axis, h):
    """Sensor along one axis of the housing."""
    for i in range(L):
        a, a1 = w[(A + 2 + axis) * L + i], w[(AN + 2 + axis) * L + i]
        j, j1 = h * w[(J + 2 + axis) * L + i], h * w[(JN + 2 + axis) * L + i]
        z, v = w[(ZX + 2 * axis) * L + i], w[(WX + 2 * axis) * L + i]
        w[(OUT + axis) * L + i] = _weigh(w, READ, i, z, v, a, j, a1, j1)
        w[(ZX + 2 * axis) * L + i] = _weigh(w, TO_Z, i, z, v, a, j, a1, j1)
        w[(WX + 2 * axis) * L + i] = _weigh(w, TO_W, i, z, v, a, j, a1, j1)


@compiled(fast=FAST)
def sense(w, h, raw, at):
    """Sensors of both axes, to the two rows of ``raw`` at the unsigned ``at``."""
    _sense_axis(w, 0, h)
    _sense_axis(w, 1, h)
    for i in range(_ROW):
        raw[at + i] = w[_FROM + i]


@compiled(fast=FAST)
def _some_taps(tile, raw, begin, taps, first, size):
    """
    Add `TAPS` taps to ``size`` values: one long loop over samples, axes and lanes.

    Written out, since an inner loop over the taps would be vectorised instead. Unsigned indices
    cannot count from the end, which keeps the loop simple.
    """
    begin, first = np.uint64(begin), np.uint64(first)
    t0, t1, t2 = taps[first], taps[first + _U(1)], taps[first + _U(2)]
    t3, t4, t5 = taps[first + _U(3)], taps[first + _U(4)], taps[first + _U(5)]
    t6, t7, t8 = taps[first + _U(6)], taps[first + _U(7)], taps[first + _U(8)]
    t9, t10 = taps[first + _U(9)], taps[first + _U(10)]
    for i in range(np.uint64(size)):
        k = begin + i
        tile[i] += (
            (t0 * raw[k] + t1 * raw[k + _ROW] + t2 * raw[k + _U(2) * _ROW])
            + (t3 * raw[k + _U(3) * _ROW] + t4 * raw[k + _U(4) * _ROW])
            + (t5 * raw[k + _U(5) * _ROW] + t6 * raw[k + _U(6) * _ROW])
            + (t7 * raw[k + _U(7) * _ROW] + t8 * raw[k + _U(8) * _ROW])
            + (t9 * raw[k + _U(9) * _ROW] + t10 * raw[k + _U(10) * _ROW])
        )


@compiled(fast=FAST)
def _noise(tile, at, level, keys, index):
    for i in range(_LANES):
        pair = normal_pair(index, NOISE, keys[i])
        tile[at + i] = level[i] * pair[0]
        tile[at + _LANES + i] = level[i] * pair[1]


@compiled()
def decimate(tile, raw, taps, oversample, level, keys, first, count):
    """
    Fill ``tile`` with ``count`` output samples: the sensors' noise and the decimated signal.

    ``raw`` holds the internal samples by their place within an output sample (polyphase), so that
    a tap is the same shift for all output samples.
    """
    for k in range(count):
        _noise(tile, np.uint64(k) * _ROW, level, keys, first + k)
    stride = raw.shape[0] // oversample
    each = taps.shape[0] // oversample
    for phase in range(oversample):
        for tap in range(0, each, TAPS):
            begin = phase * stride + tap * 2 * L
            _some_taps(tile, raw, begin, taps, phase * each + tap, count * 2 * L)
