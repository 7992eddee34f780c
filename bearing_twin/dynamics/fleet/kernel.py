# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Compiled kernel of a group of sixteen bearings in vector lanes, in single precision.

Laws, scheme and random numbers are those of the single bearing. Phases at grid points are in
double precision, and steps between are relative to them, so a fleet does not drift. Speeds are
constant between two grid points (1.25 ms at 25.6 kHz). The records are in `layout`, the prescribed
kinematics in `kinematics`, the integrator in `motion` and sensor and decimation in `signal`.
"""

from __future__ import annotations

from typing import Any

from bearing_twin.dynamics.equations.coefficients import INPUTS
from bearing_twin.dynamics.equations.layout import CHUNK
from bearing_twin.dynamics.fleet.kinematics import grid_point, place_waves, wrap_phases
from bearing_twin.dynamics.fleet.layout import WAVE_STEPS
from bearing_twin.dynamics.fleet.motion import advance, Surfaces
from bearing_twin.dynamics.fleet.signal import copy, decimate, hand_out
from bearing_twin.numerics.compiled import compiled
from bearing_twin.numerics.vector import L
import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]


@compiled()
def _inputs(ramp, drift, fade, faded, lane, n, at, first, since_tick, oversample):
    """
    Return the inputs of a group at a grid point, ``at`` samples into the block, and their growth.

    The growth is per step. ``lane`` is the first bearing of the group, ``first`` the index of the
    first sample of the block.
    """
    inputs, growth = np.empty((INPUTS, L)), np.empty((INPUTS, L))
    for q in range(INPUTS):
        for i in range(L):
            begin, change = ramp[0, lane + i, q], drift[lane + i, 1, q]
            slope = (ramp[1, lane + i, q] - begin) / n
            inputs[q, i] = begin + slope * at
            inputs[q, i] += drift[lane + i, 0, q] + change * (since_tick + at)
            left = first + at - faded[lane + i]
            if left < 0:
                inputs[q, i] += fade[lane + i, q] * left
                change += fade[lane + i, q]
            growth[q, i] = (slope + change) / oversample
    return inputs, growth


@compiled()
def advance_all(
    groups: Array,
    slots: Array,
    surfaces: Array,
    history: Array,
    ramp: Array,
    drift: Array,
    fade: Array,
    faded: Array,
    taps: Array,
    first: int,
    since_tick: int,
    oversample: int,
    h: float,
    room: Array,
    out: Array,
    begin: int,
    n: int,
) -> None:
    """
    Advance every group by ``n`` output samples.

    Parameters
    ----------
    groups
        GROUP[groups]: state, constants and spalls.
    slots
        float32[groups, balls + 2, BALL_ROWS, L]: see `layout`.
    surfaces
        float32[bearings, numbers]: see `waviness.Surfaces`.
    history
        float32[groups, oversample, (t - 1) * 2 * L]: states of the decimators.
    ramp, drift, fade, faded
        float64[2, bearings, 7], float64[bearings, 2, 7], float64[bearings, 7], int64[bearings]:
        inputs, as for a single bearing.
    taps
        float32[oversample * t]: the decimator in polyphase form; t is a multiple of `signal.TAPS`.
    first, since_tick
        Index of the first output sample; output samples since the last thermal tick.
    oversample, h
        Internal steps per output sample; internal step, s.
    room
        float32[tile + oversample * ((t - 1) * 2 * L + tile)]: work array; tile = CHUNK * 2 * L.
    out, begin, n
        float32[2, bearings, samples]: acceleration of the sensors, m/s^2; index in it of the first
        sample; number of samples.

    """
    memory = history.shape[2]
    stride = memory + CHUNK * 2 * L
    tile, raw = room[: CHUNK * 2 * L], room[CHUNK * 2 * L :]
    step, steps = np.float32(h), CHUNK * oversample
    most = slots.shape[1]
    times = steps // WAVE_STEPS + 2
    under, starts = np.zeros((most, 3, L), np.int64), np.zeros((11, L), np.float32)
    waves = np.zeros((times, most, 2, L), np.float32)
    for number in range(groups.shape[0]):
        group, lane = groups[number], number * L
        rolled = surfaces[lane : lane + L].reshape(-1)
        balls, remembered = slots[number].reshape(-1), history[number].reshape(-1)
        for phase in range(oversample):
            copy(raw, phase * stride // L, remembered, phase * memory // L, memory // L)
        done = 0
        while done < n:
            within = (first + done) % CHUNK
            count = min(CHUNK - within, n - done)
            inputs, growth = _inputs(
                ramp, drift, fade, faded, lane, n, done - within, first, since_tick, oversample
            )
            grid_point(group, inputs, growth, (first + done) // CHUNK, within, steps, h)
            if group.wavy:
                place_waves(group, surfaces.shape[1], h, under, starts)
            advance(
                group, balls, Surfaces(rolled, under, starts, waves), within, count, oversample,
                step, raw, memory // L, stride // L,
            )  # fmt: skip
            decimate(tile, raw, taps, oversample, group, first + done, count)
            hand_out(tile, out, lane, begin + done, count)
            for phase in range(oversample):
                begins = phase * stride // L
                copy(raw, begins, raw, begins + 2 * count, memory // L)
            done += count
            if (first + done) % CHUNK == 0:
                wrap_phases(group, steps * h)
        for phase in range(oversample):
            copy(remembered, phase * memory // L, raw, phase * stride // L, memory // L)
