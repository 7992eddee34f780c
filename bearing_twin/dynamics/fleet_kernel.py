# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Compiled kernel of sixteen bearings side by side, in single precision.

The same equations, scheme and random numbers as `kernel`, with the bearings in the lanes of the
vector unit. The work arrays are flat with compile-time offsets, so that the compiler sees that
nothing overlaps. Other offsets are unsigned or sliced off, since an index that might be negative
is gathered lane by lane. Phases are kept in double precision between grid points and relative to
them in between, so a fleet does not drift. Speeds are constant between two grid points (1.25 ms at
25.6 kHz). `fleet_turning` has what is prescribed, `fleet_motion` forces and integrator,
`fleet_signal` what is published, `fleet_layout` the arrays.
"""

from __future__ import annotations

import math
from typing import Any

from bearing_twin.dynamics.compiled import compiled
from bearing_twin.dynamics.fleet_layout import PHASE_ROWS
from bearing_twin.dynamics.fleet_motion import advance
from bearing_twin.dynamics.fleet_signal import copy, decimate, hand_out
from bearing_twin.dynamics.fleet_turning import grid_point
from bearing_twin.dynamics.layout import CHUNK
from bearing_twin.dynamics.vector import L
import numpy as np
import numpy.typing as npt

__all__ = ['advance_all', 'room_size']

Array = npt.NDArray[Any]


def room_size(oversample: int, memory: int) -> int:
    """Numbers that the kernel needs to work in; ``memory`` is that of the decimator's phases."""
    return CHUNK * 2 * L + oversample * (memory + CHUNK * 2 * L)


@compiled()
def _advance_group(
    w: Array,
    balls: Array,
    n_balls: int,
    phases: Array,
    history: Array,
    keys: Array,
    level: Array,
    ramp: Array,
    drift: Array,
    taps: Array,
    spalls: int,
    smooth: bool,
    first: int,
    since_tick: int,
    oversample: int,
    h: float,
    room: Array,
    out: Array,
    lane: int,
    begin: int,
    n: int,
) -> None:
    """
    Advance L bearings by ``n`` output samples.

    Parameters
    ----------
    w
        float32[WORK_ROWS * L]: work array; its first `STATE_ROWS` rows are the state.
    balls, n_balls
        float32[(n + 2) * BALL_ROWS * L]: the slots of the balls; how many of them are in use.
    phases
        float64[PHASE_ROWS + 3, L]: phases at the last grid point and what they follow.
    history
        float32[oversample * (t - 1) * 2 * L]: memory of the decimator.
    keys, level
        uint64[L], float32[L]: seeds; standard deviation of the noise.
    ramp, drift
        float64[2, 6, L]: inputs, as for a single bearing.
    taps
        float32[oversample * t]: the decimator by the place of an internal sample within an output
        sample; t is a multiple of `TAPS`.
    spalls, smooth
        Most spalls of any lane; whether any has a profile with a cosine.
    first, since_tick
        Index of the first output sample; output samples since the last thermal tick.
    oversample, h
        Internal steps per output sample; internal step, s.
    room
        float32[room_size(oversample, (t - 1) * 2 * L)]: to work in.
    out, lane, begin, n
        float32[2, bearings, samples]: acceleration of the sensors, m/s^2; where in it the first
        bearing and the first sample stand; samples.

    """
    memory = history.shape[0] // oversample
    stride = memory + CHUNK * 2 * L
    tile, raw = room[: CHUNK * 2 * L], room[CHUNK * 2 * L :]
    for phase in range(oversample):
        copy(raw, phase * stride // L, history, phase * memory // L, memory // L)
    inputs, growth = np.empty((6, L)), np.empty((6, L))
    step_size = np.float32(h)
    few = 2 * ((n_balls + 3) // 4)
    done = 0
    while done < n:
        within = (first + done) % CHUNK
        count = min(CHUNK - within, n - done)
        for q in range(6):
            for i in range(L):
                slope = (ramp[1, q, i] - ramp[0, q, i]) / n
                inputs[q, i] = ramp[0, q, i] + slope * (done - within)
                inputs[q, i] += drift[0, q, i] + drift[1, q, i] * (since_tick + done - within)
                growth[q, i] = (slope + drift[1, q, i]) / oversample
        grid_point(
            w, phases, keys, inputs, growth, (first + done) // CHUNK, within, CHUNK * oversample,
            h, spalls,
        )  # fmt: skip
        advance(
            w, balls, n_balls, few, spalls, smooth, within, count, oversample, step_size, raw,
            memory // L, stride // L,
        )  # fmt: skip
        decimate(tile, raw, taps, oversample, level, keys, first + done, count)
        hand_out(tile, out, lane, begin + done, count)
        for phase in range(oversample):
            begins = phase * stride // L
            copy(raw, begins, raw, begins + 2 * count, memory // L)
        done += count
        if (first + done) % CHUNK == 0:
            for i in range(L):
                for row in range(3):
                    phase = phases[row, i] + CHUNK * oversample * h * phases[PHASE_ROWS + row, i]
                    phases[row, i] = phase - math.floor(phase)
    for phase in range(oversample):
        copy(history, phase * memory // L, raw, phase * stride // L, memory // L)


@compiled()
def advance_all(
    w: Array,
    balls: Array,
    balls_in: Array,
    phases: Array,
    history: Array,
    keys: Array,
    level: Array,
    ramp: Array,
    drift: Array,
    taps: Array,
    spalls_in: Array,
    smooth_in: Array,
    first: int,
    since_tick: int,
    oversample: int,
    h: float,
    room: Array,
    out: Array,
    begin: int,
    n: int,
) -> None:
    """Advance every group; arrays as in `_advance_group` with the group first."""
    lanes = w.shape[2]
    inputs, drifts = np.empty((2, 6, lanes)), np.empty((2, 6, lanes))
    for g in range(w.shape[0]):
        for i in range(lanes):
            for q in range(6):
                for part in range(2):
                    inputs[part, q, i] = ramp[part, g * lanes + i, q]
                    drifts[part, q, i] = drift[g * lanes + i, part, q]
        _advance_group(
            w[g].reshape(-1), balls[g].reshape(-1), balls_in[g], phases[g],
            history[g].reshape(-1), keys[g], level[g], inputs, drifts, taps, spalls_in[g],
            smooth_in[g], first, since_tick, oversample, h, room, out, g * lanes, begin, n,
        )  # fmt: skip
