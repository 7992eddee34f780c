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
from bearing_twin.dynamics.fleet_layout import L, PHASE_ROWS
from bearing_twin.dynamics.fleet_motion import (
    balls_alone,
    balls_over_a_spall,
    balls_over_spalls,
    correct,
    predict,
    react,
)
from bearing_twin.dynamics.fleet_signal import decimate, sense
from bearing_twin.dynamics.fleet_turning import (
    grid_point,
    prescribe,
    spoil,
    spoil_first,
    spoil_smooth,
)
from bearing_twin.dynamics.layout import CHUNK
import numpy as np
import numpy.typing as npt

__all__ = ['advance_all']

Array = npt.NDArray[Any]

_F = np.float32


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
    out: Array,
) -> None:
    """
    Advance L bearings by ``out.shape[2]`` output samples.

    Parameters
    ----------
    w
        float32[WORK_ROWS * L]: work array; its first `STATE_ROWS` rows are the state.
    balls, n_balls
        float32[n * BALL_ROWS * L]: the balls; how many of them are in use, an even number.
    phases
        float64[PHASE_ROWS + 3, L]: phases at the last grid point and what they follow.
    history
        float32[oversample, (t - 1) * 2 * L]: memory of the decimator.
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
    out
        float32[2, L, n]: acceleration of the sensors, m/s^2.

    """
    n = out.shape[2]
    memory = history.shape[1]
    stride = memory + CHUNK * 2 * L
    raw = np.empty(oversample * stride, np.float32)
    tile = np.empty(CHUNK * 2 * L, np.float32)
    for phase in range(oversample):
        raw[phase * stride : phase * stride + memory] = history[phase]
    inputs, growth = np.empty((6, L)), np.empty((6, L))
    step_size, per_second = _F(h), _F(1.0 / h)
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
        begin, end = within * oversample, (within + count) * oversample
        grid_point(
            w,
            phases,
            keys,
            inputs,
            growth,
            (first + done) // CHUNK,
            begin,
            CHUNK * oversample,
            h,
            spalls,
        )
        for step in range(begin, end):
            number = _F(step)
            prescribe(w, number)
            if spalls > 0:
                spoil_first(w, number, per_second)
            for k in range(1, spalls):
                spoil(w, k, number, per_second)
            if smooth:
                for k in range(spalls):
                    spoil_smooth(w, k, number, per_second)
            predict(w, step_size)
            if spalls > 1:
                balls_over_spalls(w, balls, n_balls)
            elif spalls > 0:
                balls_over_a_spall(w, balls, n_balls)
            else:
                balls_alone(w, balls, n_balls)
            react(w)
            sample, phase = divmod(step - begin, oversample)
            at = phase * stride + memory + sample * 2 * L
            sense(w, step_size, raw, np.uint64(at))
            correct(w, step_size)
        decimate(tile, raw, taps, oversample, level, keys, first + done, count)
        for axis in range(2):
            for i in range(L):
                for k in range(count):
                    out[axis, i, done + k] = tile[(2 * k + axis) * L + i]
        moved = count * 2 * L
        for phase in range(oversample):
            for i in range(memory):
                raw[phase * stride + i] = raw[phase * stride + moved + i]
        done += count
        if (first + done) % CHUNK == 0:
            for i in range(L):
                for row in range(3):
                    phase = phases[row, i] + CHUNK * oversample * h * phases[PHASE_ROWS + row, i]
                    phases[row, i] = phase - math.floor(phase)
    for phase in range(oversample):
        history[phase] = raw[phase * stride : phase * stride + memory]


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
    out: Array,
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
            w[g].reshape(-1), balls[g].reshape(-1), balls_in[g], phases[g], history[g], keys[g],
            level[g], inputs, drifts, taps, spalls_in[g], smooth_in[g], first,
            since_tick, oversample, h, out[:, g * lanes : (g + 1) * lanes],
        )  # fmt: skip
