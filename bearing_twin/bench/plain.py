# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
The same bearing by a plain Runge-Kutta scheme of order 4 with equal steps, compiled.

What one writes first: the equations of motion with an inner race defect and the sensor as states,
directions of the balls by one sine and cosine a half step, no memory taken in the loop. It knows
nothing of kinks and of losses of contact, and shares with the kernel the contact law and the path
over the defect. Without jitter, noise, waviness and unbalance.
"""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_orders
from bearing_twin.dynamics import coefficients, filters
from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.model import CODES, contact_force, defect_path
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters
    from bearing_twin.dynamics.reference import Reference


FloatArray = npt.NDArray[np.float64]

_STEPS = (1, 2, 3, 4, 6, 8, 12, 16)
"""Steps tried for an internal sample."""
_RUNS = 6
"""The first one compiles."""


@compiled(fast=FAST, borrows=True)
def _place(cage, shaft, machine, ahead, balls):
    """Fill ``balls``, float64[3, n]: directions and gaps at angles of cage and shaft, rad."""
    factor, clearance, radius, profile, half, depth, curvature, where = machine[11:19]
    c, s = math.cos(cage), math.sin(cage)
    for k in range(balls.shape[1]):
        balls[0, k] = c * ahead[0, k] - s * ahead[1, k]
        balls[1, k] = s * ahead[0, k] + c * ahead[1, k]
        turns = (cage + ahead[2, k] - shaft - where) / (2.0 * math.pi)
        along = (turns - math.floor(turns + 0.5)) * 2.0 * math.pi * radius
        balls[2, k] = clearance
        if abs(along) < half:
            balls[2, k] += factor * defect_path(profile, half, depth, curvature, along)[0]


@compiled(fast=FAST, borrows=True)
def _rates(state, machine, balls, out):
    """Fill ``out`` with the time derivative of positions, velocities and sensor, float64[12]."""
    k_b, damping, mi, ki, ci, mo, ko, co, foot, resonance, damped = machine[:11]
    fx = 0.0
    fy = 0.0
    x, y = state[0] - state[2], state[1] - state[3]
    vx, vy = state[4] - state[6], state[5] - state[7]
    for k in range(balls.shape[1]):
        c, s = balls[0, k], balls[1, k]
        delta = x * c + y * s - balls[2, k]
        if delta > 0.0:
            force = max(contact_force(delta, 0.0, vx * c + vy * s, 0.0, k_b, damping)[0], 0.0)
            fx += force * c
            fy += force * s
    for i in range(4):
        out[i] = state[4 + i]
    out[4] = (-fx - ki * state[0] - ci * state[4]) / mi
    out[5] = (-fy - ki * (state[1] - foot) - ci * state[5]) / mi
    out[6] = (fx - ko * state[2] - co * state[6]) / mo
    out[7] = (fy - ko * state[3] - co * state[7]) / mo
    for axis in range(2):
        z, w = state[8 + 2 * axis], state[9 + 2 * axis]
        out[8 + 2 * axis] = resonance * w
        out[9 + 2 * axis] = -resonance * (z + 2.0 * damped * w + out[6 + axis])


@compiled(fast=FAST, borrows=True)
def _run(state, machine, ahead, speeds, angles, h, steps, room, out):
    """
    Advance by ``out.shape[1]`` internal samples of ``steps`` steps of ``h`` seconds.

    ``speeds`` and ``angles`` are those of cage and shaft, rad/s and rad; ``room``, float64[5, 12],
    and the directions behind it are to work in.
    """
    rates, balls = room
    damped = machine[10]
    moved = rates[4]
    _place(angles[0], angles[1], machine, ahead, balls[0])
    done = 0
    for sample in range(out.shape[1]):
        for _ in range(steps):
            begin, end = balls[done % 2 * 2], balls[2 - done % 2 * 2]
            middle = balls[1]
            t = done * h
            at = t + 0.5 * h
            cage, shaft = angles[0] + speeds[0] * at, angles[1] + speeds[1] * at
            _place(cage, shaft, machine, ahead, middle)
            at = t + h
            cage, shaft = angles[0] + speeds[0] * at, angles[1] + speeds[1] * at
            _place(cage, shaft, machine, ahead, end)
            _rates(state, machine, begin, rates[0])
            for i in range(12):
                moved[i] = state[i] + 0.5 * h * rates[0, i]
            _rates(moved, machine, middle, rates[1])
            for i in range(12):
                moved[i] = state[i] + 0.5 * h * rates[1, i]
            _rates(moved, machine, middle, rates[2])
            for i in range(12):
                moved[i] = state[i] + h * rates[2, i]
            _rates(moved, machine, end, rates[3])
            for i in range(12):
                inner = 2.0 * (rates[1, i] + rates[2, i])
                state[i] += h / 6.0 * (rates[0, i] + inner + rates[3, i])
            done += 1
        out[0, sample] = -state[8] - 2.0 * damped * state[9]
        out[1, sample] = -state[10] - 2.0 * damped * state[11]


def solve_plainly(
    p: TwinParameters, begin: FloatArray, samples: int, steps: int, *, shaft_hz: float
) -> tuple[FloatArray, float]:
    """
    Acceleration of the sensor, m/s^2, shape (2, samples), and the processor time it took, s.

    Parameters
    ----------
    p
        A bearing with one defect, of the inner race, and a load that acts downwards.
    begin
        State after the first internal sample, as `dynamics.reference` has it.
    samples
        Output samples at 25.6 kHz; the first ones lack what was before them.
    steps
        Steps for each internal sample.
    shaft_hz
        Hz; the temperature is 20 degC.

    """
    bearing, (defect,) = p.bearing, p.defects
    values = np.empty(coefficients.CONDITION_SIZE)
    coefficients.evaluate(coefficients.law_table(p), 20.0, 20.0, shaft_hz, values)
    factor = filters.oversampling(25600.0)
    inner = 0.5 * (bearing.d_pitch - bearing.d_ball)
    machine = np.array(
        [
            values[coefficients.K_B], p.contact_damping, p.inner_mass, p.inner_stiffness,
            p.inner_damping, p.outer_mass, p.outer_stiffness, p.outer_damping,
            values[coefficients.FOOT_Y], 2.0 * math.pi * p.resonance_hz, p.resonance_damping,
            values[coefficients.DEPTH], values[coefficients.CLEARANCE], inner,
            CODES[defect.profile], 0.5 * defect.width, defect.depth,
            1.0 / bearing.d_ball + 0.5 / inner, defect.angle,
        ]
    )  # fmt: skip
    at = 2.0 * math.pi * np.arange(bearing.n_balls) / bearing.n_balls
    ahead = np.array([np.cos(at), np.sin(at), at])
    omega = 2.0 * math.pi * shaft_hz
    ftf = fault_orders(bearing, float(values[coefficients.SLIP])).ftf
    speeds, first = np.array([ftf * omega, omega]), 1.0 / (25600.0 * factor)
    room = np.empty((5, 12)), np.empty((3, 3, bearing.n_balls))
    state, raw = begin.copy(), np.empty((2, samples * factor))
    began = time.process_time()
    _run(
        state, machine, ahead, speeds, p.start_angle + first * speeds, first / steps, steps, room,
        raw[:, 1:],
    )  # fmt: skip
    raw[:, 0] = -begin[[8, 10]] - 2.0 * p.resonance_damping * begin[[9, 11]]
    taps = filters.decimator(factor)
    padded = np.concatenate([np.zeros((2, len(taps) - factor)), raw], axis=1)
    windows = np.lib.stride_tricks.sliding_window_view(padded, len(taps), axis=1)
    found = windows[:, ::factor] @ taps
    return found, time.process_time() - began


def relative_error(got: FloatArray, expected: FloatArray) -> float:
    """Relative L2 of signals of one shape."""
    return float(np.linalg.norm(got - expected) / np.linalg.norm(expected))


def error_after_start(got: FloatArray, reference: Reference) -> float:
    """Relative L2 of a signal, shape (2, n), without the samples that lack what was before."""
    skip = len(filters.decimator(filters.oversampling(25600.0)))
    expected = np.array([reference.x, reference.y])[:, skip:]
    return relative_error(got[:, skip:], expected)


def time_at(p: TwinParameters, reference: Reference, error: float, *, shaft_hz: float) -> float:
    """
    Processor time of the steps whose relative error is ``error``, s; between those tried.

    ``reference`` is the solution that the error is taken against. Where the most steps tried have
    a larger error, their time.
    """
    errors, times = [], []
    for steps in _STEPS:
        runs = [
            solve_plainly(p, reference.states[:, 0], len(reference.x), steps, shaft_hz=shaft_hz)
            for _ in range(_RUNS)
        ]
        errors.append(error_after_start(runs[0][0], reference))
        times.append(min(took for _, took in runs))
        if errors[-1] <= error:
            break
    logs = np.log(errors[::-1]), np.log(times[::-1])
    return float(np.exp(np.interp(np.log(error), *logs)))
