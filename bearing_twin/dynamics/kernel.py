# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Compiled kernel of one bearing: equations of motion, resonance, decimation, noise.

The equations (x right, y up, load along -y), one line an axis, y shown::

    m_i y_i'' = -F_y - k_i (y_i - y_i0) - c_i y_i' + m_u e omega^2 sin(theta_s)
    m_o y_o'' = +F_y - k_o y_o - c_o y_o'
    delta_j   = (x_i - x_o) cos(theta_j) + (y_i - y_o) sin(theta_j) - c_r - b_j C_d
    F         = sum_j max(K_b max(delta_j, 0)^1.5 + c_b v_j, 0) over loaded balls

with v_j the rings' velocity of approach along ball j: Symmetry 2023, 15, 2166, equations 1 to 8,
with the masses and damping that the paper leaves out taken from Sawalhi and Randall, Mech. Syst.
Signal Process. 2008, 22, 1924. `turning` has what is prescribed, `contact` the forces, `motion`
the integrator, `layout` the arrays.
"""

from __future__ import annotations

import math

from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.contact import FAR, motion
from bearing_twin.dynamics.laws import CLEARANCE, DEPTH, K_B, SHAFT_HZ, SLIP, SPRING
from bearing_twin.dynamics.layout import (
    A,
    BALL_COS,
    BALL_SIN,
    CAGE,
    CAGE_COS,
    CAGE_SIN,
    CB,
    CHUNK,
    COS,
    EXPECTED,
    FTF_ORDER,
    GAP,
    J,
    JITTER,
    NEAR,
    NOISE_STD,
    SHAFT,
    SHAFT_COS,
    SHAFT_SIN,
    SIN,
    SPIN,
    SPIN_ORDER,
    STEP,
    TABLE_SIZE,
    TOUCHING,
    UNBALANCE,
    UNDERSIZE,
)  # fmt: skip
from bearing_twin.dynamics.motion import expect, integrate
from bearing_twin.dynamics.random import NOISE, normal_pair, WALK
from bearing_twin.dynamics.turning import prescribe, refresh, spoil, turn
import numpy as np
import numpy.typing as npt

__all__ = ['FAST_HZ', 'advance', 'ball_forces', 'start']

FloatArray = npt.NDArray[np.float64]

_TWO_PI = 2.0 * math.pi
FAST_HZ = 30.0
"""Shaft speed above which steps are short: events crowd, and errors would pass 0.1 %."""
_MOST_KINKS = 32
"""Most kinks of all defects within one step."""


@compiled(fast=FAST)
def advance(
    state: FloatArray,
    history: FloatArray,
    consts: FloatArray,
    defects: FloatArray,
    balls: FloatArray,
    ramp: FloatArray,
    drift: FloatArray,
    long: FloatArray,
    short: FloatArray,
    taps: FloatArray,
    n_balls: int,
    seed: int,
    first: int,
    since_tick: int,
    steps: int,
    stiff: bool,
    out: npt.NDArray[np.float32],
) -> None:
    """
    Advance one bearing by ``out.shape[1]`` output samples.

    Parameters
    ----------
    state : float64[STATE_SIZE]
        Changed in place.
    history : float64[2, taps - oversample]
        Last internal samples, the memory of the decimator; changed in place.
    consts : float64[2, CONST_SIZE]
        Constants for long and for short steps.
    defects, balls
        See `layout`.
    ramp : float64[2, INPUTS]
        Inputs at the start and at the end of the block.
    drift : float64[2, INPUTS]
        Addition to the inputs at the last thermal tick, and its growth per output sample.
    long, short, taps
        Tables of `filters.resonator`, for the samples of the sensor within a long step and within
        a short one, and of `filters.decimator`.
    n_balls, seed
        Rolling elements; seed of the random numbers.
    first, since_tick
        Index of the first output sample; output samples since the last thermal tick.
    steps, stiff
        Long steps of the integrator per output sample; whether all have to be short. They are also
        where the shaft turns faster than `FAST_HZ`.
    out : float32[2, n]
        Acceleration of the sensor along x and y, m/s^2.

    """
    n = out.shape[1]
    memory = history.shape[1]
    parts = (long.shape[0] - 2) // (short.shape[0] - 2)
    oversample = steps * (long.shape[0] - 2)
    # Everything between two grid points stays in the fastest cache.
    raw = np.empty((2, memory + CHUNK * oversample))
    table = np.empty((CHUNK * steps * parts, TABLE_SIZE))
    gaps = np.empty((CHUNK * steps * parts, 4, balls.shape[1]))
    kinked = np.empty(CHUNK * steps * parts, np.int64)
    row, beside = np.empty((1, TABLE_SIZE)), np.empty((1, 4, balls.shape[1]))
    times = np.empty(_MOST_KINKS)
    raw[:, :memory] = history
    done = 0
    while done < n:
        within = (first + done) % CHUNK
        count = min(CHUNK - within, n - done)
        if within == 0:
            refresh(state)
        walk = consts[0, JITTER] * normal_pair((first + done) // CHUNK, WALK, seed)[0]
        hz = _input(ramp, drift, n, SHAFT_HZ, done - within, since_tick)
        fine = stiff or hz > FAST_HZ
        const, resonator = (consts[1], short) if fine else (consts[0], long)
        each = steps * parts if fine else steps
        if state[EXPECTED] != const[STEP]:
            expect(state, const[STEP])
        base, step = _inputs(ramp, drift, n, each, done - within, since_tick)
        rows, begin = count * each, float(within * each)
        new = count * oversample
        turn(
            state, const, defects, balls, base, step, n_balls, walk, begin, table[:rows],
            gaps[:rows], kinked,
        )  # fmt: skip
        integrate(
            state, const, table[:rows], gaps[:rows], kinked, resonator,
            raw[0, memory : memory + new], raw[1, memory : memory + new], begin, defects, balls,
            base, step, n_balls, row, beside, times,
        )  # fmt: skip
        _decimate(raw, taps, oversample, out[:, done : done + count])
        for i in range(memory):
            raw[0, i] = raw[0, new + i]
            raw[1, i] = raw[1, new + i]
        done += count
    history[:, :] = raw[:, :memory]
    _add_noise(consts[0, NOISE_STD], seed, first, out)


@compiled(inline=True, fast=FAST)
def _inputs(ramp, drift, n, steps, at, since_tick):
    """
    Return the inputs at a grid point, ``at`` samples into the block, and their growth a step.

    Relative to the grid, so that held inputs give the same bits in every block.
    """
    return (
        (
            _input(ramp, drift, n, 0, at, since_tick),
            _input(ramp, drift, n, 1, at, since_tick),
            _input(ramp, drift, n, 2, at, since_tick),
            _input(ramp, drift, n, 3, at, since_tick),
            _input(ramp, drift, n, 4, at, since_tick),
            _input(ramp, drift, n, 5, at, since_tick),
        ),
        (
            ((ramp[1, 0] - ramp[0, 0]) / n + drift[1, 0]) / steps,
            ((ramp[1, 1] - ramp[0, 1]) / n + drift[1, 1]) / steps,
            ((ramp[1, 2] - ramp[0, 2]) / n + drift[1, 2]) / steps,
            ((ramp[1, 3] - ramp[0, 3]) / n + drift[1, 3]) / steps,
            ((ramp[1, 4] - ramp[0, 4]) / n + drift[1, 4]) / steps,
            ((ramp[1, 5] - ramp[0, 5]) / n + drift[1, 5]) / steps,
        ),
    )


@compiled(inline=True, fast=FAST)
def _input(ramp, drift, n, i, at, since_tick):
    slope = (ramp[1, i] - ramp[0, i]) / n
    return ramp[0, i] + slope * at + (drift[0, i] + drift[1, i] * (since_tick + at))


@compiled(fast=FAST)
def _decimate(raw, taps, oversample, out):
    for k in range(out.shape[1]):
        at = k * oversample
        left, up = raw[0, at : at + taps.shape[0]], raw[1, at : at + taps.shape[0]]
        x = 0.0
        y = 0.0
        for i in range(taps.shape[0]):
            x += taps[i] * left[i]
            y += taps[i] * up[i]
        out[0, k] = x
        out[1, k] = y


@compiled(fast=FAST)
def _add_noise(level, seed, first, out):
    """Add white noise; whole chunks of the grid are drawn, so that all samples are alike."""
    x, y = np.empty(CHUNK, np.float32), np.empty(CHUNK, np.float32)
    level = np.float32(level)
    key = np.uint64(seed)
    origin = first - first % CHUNK
    while origin < first + out.shape[1]:
        for i in range(CHUNK):
            pair = normal_pair(origin + i, NOISE, key)
            x[i] = level * pair[0]
            y[i] = level * pair[1]
        begin = max(first - origin, 0)
        end = min(first + out.shape[1] - origin, CHUNK)
        for i in range(begin, end):
            out[0, origin + i - first] += x[i]
            out[1, origin + i - first] += y[i]
        origin += CHUNK


@compiled(fast=FAST)
def _instant(state, const, defects, balls, values, n_balls):
    """Row and gaps at the present phases and inputs, without the cage's walk."""
    table, gaps = np.empty((1, TABLE_SIZE)), np.zeros((1, 4, balls.shape[1]))
    c, s = state[CAGE_COS], state[CAGE_SIN]
    gaps[0, GAP] = values[CLEARANCE] + balls[UNDERSIZE]
    gaps[0, COS] = c * balls[BALL_COS] - s * balls[BALL_SIN]
    gaps[0, SIN] = s * balls[BALL_COS] + c * balls[BALL_SIN]
    hz = values[SHAFT_HZ]
    carried = hz * (1.0 - values[SLIP])
    turning = const[FTF_ORDER] * carried
    spoil(
        n_balls, (state[CAGE], state[SHAFT], state[SPIN]),
        (turning, hz, const[SPIN_ORDER] * carried), values[DEPTH], const, defects, gaps, 0,
    )  # fmt: skip
    sines = (state[SHAFT_COS], state[SHAFT_SIN])
    prescribe(
        table, 0, _TWO_PI * hz, values[K_B], values[SPRING], sines, turning, const[UNBALANCE]
    )
    return table, gaps


@compiled(fast=FAST)
def start(
    state: FloatArray,
    const: FloatArray,
    defects: FloatArray,
    balls: FloatArray,
    values: FloatArray,
    n_balls: int,
) -> None:
    """
    Set what of ``state`` follows from its phases, positions and velocities.

    Sines, accelerations, jerks, loaded balls and the prediction for the next step. To be
    called where a trajectory begins and where parameters change; ``values`` are the inputs.
    """
    refresh(state)
    table, gaps = _instant(state, const, defects, balls, values, n_balls)
    q = (state[0], state[1], state[2], state[3])
    v = (state[4], state[5], state[6], state[7])
    a = (0.0, 0.0, 0.0, 0.0)
    j = a
    touching, near = 0, FAR
    for _ in range(2):  # the jerk of the contact damping takes the acceleration found first
        a, j, touching, near = motion(table, gaps, 0, q, v, a, const)
    for i in range(4):
        state[A + i], state[J + i] = a[i], j[i]
    state[TOUCHING], state[NEAR] = touching, near
    state[EXPECTED] = 0.0
    expect(state, const[STEP])


@compiled()
def ball_forces(
    state: FloatArray,
    const: FloatArray,
    defects: FloatArray,
    balls: FloatArray,
    values: FloatArray,
    n_balls: int,
) -> npt.NDArray[np.float32]:
    """Contact force of each ball, N, float32[n_balls], at the present state and inputs."""
    _table, gaps = _instant(state, const, defects, balls, values, n_balls)
    forces = np.zeros(n_balls, dtype=np.float32)
    x, y = state[0] - state[2], state[1] - state[3]
    vx, vy = state[4] - state[6], state[5] - state[7]
    for j in range(n_balls):
        c, s = gaps[0, COS, j], gaps[0, SIN, j]
        delta = x * c + y * s - gaps[0, GAP, j]
        if delta > 0.0:
            forces[j] = max(values[K_B] * delta**1.5 + const[CB] * (vx * c + vy * s), 0.0)
    return forces
