# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Compiled kernel of one bearing: RK4 on the equations of motion, resonator, decimation, noise.

The equations (x right, y up, load along -y), one line an axis, y shown::

    m_i y_i'' = -F_y - k_i (y_i - y_i0) - c_i y_i' + m_u e omega^2 sin(theta_s)
    m_o y_o'' = +F_y - k_o y_o - c_o y_o'
    delta_j   = (x_i - x_o) cos(theta_j) + (y_i - y_o) sin(theta_j) - c_r - b_j C_d
    F         = sum_j max(K_b max(delta_j, 0)^1.5 + c_b delta_j', 0) over loaded balls

Symmetry 2023, 15, 2166, equations 1 to 8, with the masses and damping that the paper leaves out
taken from Sawalhi and Randall, Mech. Syst. Signal Process. 2008, 22, 1924.
"""

from __future__ import annotations

import math

import numba as nb
import numpy as np

from bearing_twin.dynamics.random import NOISE, WALK, normal_pair

__all__ = ['advance', 'ball_forces']

# Layout of the state vector.
Q, V = 0, 4  # x_i, y_i, x_o, y_o and their velocities
CAGE, SHAFT, SPIN = 8, 9, 10  # phases in turns
RESONATOR = 11  # x, x', y, y' relative to the housing
STATE_SIZE = 15

# Ramped inputs.
KB, DEPTH, CLEARANCE, SHAFT_HZ, SLIP, Y0 = range(6)
RAMP_SIZE = 6

# Constants.
(
    MI, KI, CI, MO, KO, CO, CB, UNBALANCE, FTF_ORDER, SPIN_ORDER, JITTER, NOISE_STD, STEP,
    D_BALL, R_INNER, R_OUTER,
) = range(16)  # fmt: skip
CONST_SIZE = 16

# Columns of a defect: place, profile, half width (m), depth (m), angle (turns), ball, path factor
# on the inner and outer race (1/m).
PLACE, PROFILE, HALF, FULL_DEPTH, ANGLE, BALL, PATH_INNER, PATH_OUTER = range(8)
DEFECT_SIZE = 8

LANES = 8
"""Balls are padded to a multiple of this, so that the compiler can use vector instructions."""

WALK_EVERY = 16
"""Output samples over which one step of the cage's random walk is spread."""

_TWO_PI = 2.0 * math.pi
_FAST = {'contract', 'reassoc', 'nsz', 'arcp', 'nnan', 'ninf'}


@nb.njit(cache=True, inline='always', fastmath=_FAST)
def _path_depth(profile, half, depth, path, from_centre):  # type: ignore[no-untyped-def]
    """How far the ball sinks at a distance from the centre of a defect, m."""
    edge = half - abs(from_centre)
    if edge <= 0.0:
        return 0.0
    if profile == 0:
        return min(depth, edge * edge * path)
    if profile == 1:
        return depth
    if profile == 2:
        return depth * math.cos(0.5 * math.pi * from_centre / half)
    flank = 0.5 * half
    if edge >= flank:
        return depth
    return depth * 0.5 * (1.0 - math.cos(math.pi * edge / flank))


@nb.njit(cache=True, fastmath=_FAST)
def _place_balls(n_balls, cage, shaft, spin, clearance, factor, const, defects, balls, out):
    # type: ignore[no-untyped-def]
    """Fill ``out`` (3, padded): cos and sin of each ball, and the gap it has to close, m."""
    c0 = math.cos(_TWO_PI * cage)
    s0 = math.sin(_TWO_PI * cage)
    for j in range(out.shape[1]):
        out[0, j] = c0 * balls[0, j] - s0 * balls[1, j]
        out[1, j] = s0 * balls[0, j] + c0 * balls[1, j]
        out[2, j] = clearance + balls[2, j]
    for i in range(defects.shape[0]):
        place = defects[i, PLACE]
        if place == 3.0:
            continue
        if place == 2.0:
            phase = 2.0 * (spin - defects[i, ANGLE])
            nearest = math.floor(phase + 0.5)
            arc = (phase - nearest) * 0.5 * math.pi * const[D_BALL]
            ball = int(defects[i, BALL])
            path = defects[i, PATH_INNER] if nearest % 2.0 == 0.0 else defects[i, PATH_OUTER]
        else:
            inner = place == 0.0
            phase = cage - defects[i, ANGLE] - (shaft if inner else 0.0)
            nearest = math.floor(phase * n_balls + 0.5)
            ball = int(-nearest) % n_balls
            radius = const[R_INNER] if inner else const[R_OUTER]
            arc = (phase - nearest / n_balls + balls[3, ball]) * _TWO_PI * radius
            path = defects[i, PATH_INNER] if inner else defects[i, PATH_OUTER]
        out[2, ball] += factor * _path_depth(
            int(defects[i, PROFILE]), defects[i, HALF], defects[i, FULL_DEPTH], path, arc
        )


@nb.njit(cache=True, inline='always', fastmath=_FAST)
def _contact(place, x, y, vx, vy, kb, cb):  # type: ignore[no-untyped-def]
    """Sum of the contact forces on the outer ring, N."""
    fx = 0.0
    fy = 0.0
    for j in range(place.shape[1]):
        c = place[0, j]
        s = place[1, j]
        delta = x * c + y * s - place[2, j]
        loaded = delta > 0.0
        depth = delta if loaded else 0.0
        rate = (vx * c + vy * s) if loaded else 0.0
        force = kb * depth * math.sqrt(depth) + cb * rate
        force = force if force > 0.0 else 0.0
        fx += force * c
        fy += force * s
    return fx, fy


@nb.njit(cache=True, inline='always', fastmath=_FAST)
def _acceleration(place, q, v, kb, ux, uy, y0, const):  # type: ignore[no-untyped-def]
    xi, yi, xo, yo = q
    vxi, vyi, vxo, vyo = v
    fx, fy = _contact(place, xi - xo, yi - yo, vxi - vxo, vyi - vyo, kb, const[CB])
    return (
        (ux - fx - const[KI] * xi - const[CI] * vxi) / const[MI],
        (uy - fy - const[KI] * (yi - y0) - const[CI] * vyi) / const[MI],
        (fx - const[KO] * xo - const[CO] * vxo) / const[MO],
        (fy - const[KO] * yo - const[CO] * vyo) / const[MO],
    )


@nb.njit(cache=True, inline='always', fastmath=_FAST)
def _plus(a, factor, b):  # type: ignore[no-untyped-def]
    return (
        a[0] + factor * b[0],
        a[1] + factor * b[1],
        a[2] + factor * b[2],
        a[3] + factor * b[3],
    )


@nb.njit(cache=True, fastmath=_FAST)
def _integrate(
    state, const, defects, balls, ramp, resonator, n_balls, seed, first, oversample, raw
):
    # type: ignore[no-untyped-def]
    """Advance by ``raw.shape[1] - history`` internal steps, writing the sensor's acceleration."""
    steps = raw.shape[1]
    h = const[STEP]
    here = np.empty((3, balls.shape[1]))
    middle = np.empty((3, balls.shape[1]))
    q = (state[0], state[1], state[2], state[3])
    v = (state[4], state[5], state[6], state[7])
    cage, shaft, spin = state[CAGE], state[SHAFT], state[SPIN]
    zx, wx, zy, wy = state[11], state[12], state[13], state[14]
    per_step = ramp.copy()
    for i in range(RAMP_SIZE):
        per_step[1, i] = (ramp[1, i] - ramp[0, i]) / steps
    kb, factor, clearance = ramp[0, KB], ramp[0, DEPTH], ramp[0, CLEARANCE]
    hz, slip, y0 = ramp[0, SHAFT_HZ], ramp[0, SLIP], ramp[0, Y0]
    _place_balls(n_balls, cage, shaft, spin, clearance, factor, const, defects, balls, here)
    ux = const[UNBALANCE] * (_TWO_PI * hz) ** 2 * math.cos(_TWO_PI * shaft)
    uy = const[UNBALANCE] * (_TWO_PI * hz) ** 2 * math.sin(_TWO_PI * shaft)
    a1 = _acceleration(here, q, v, kb, ux, uy, y0, const)
    walk = 0.0
    ftf_order, spin_order = const[FTF_ORDER], const[SPIN_ORDER]
    for i in range(steps):
        sample = first + i // oversample
        if i == 0 or (i % oversample == 0 and sample % WALK_EVERY == 0):
            # Spread over its interval: the ball angle stays smooth, so RK4 keeps its order.
            pair = normal_pair(sample // WALK_EVERY, WALK, seed)
            walk = const[JITTER] * pair[0]
        for part in range(1, 3):
            w = i + 0.5 * part
            last_hz, last_slip = hz, slip
            hz = ramp[0, SHAFT_HZ] + per_step[1, SHAFT_HZ] * w
            slip = ramp[0, SLIP] + per_step[1, SLIP] * w
            turned = 0.25 * h * (hz + last_hz)
            carried = turned * (1.0 - 0.5 * (slip + last_slip))
            wander = walk * 0.5 * h * math.sqrt(0.5 * (hz + last_hz))
            shaft += turned
            cage += ftf_order * carried + wander
            spin += spin_order * carried
            shaft -= math.floor(shaft)
            cage -= math.floor(cage)
            spin -= math.floor(spin)
            kb = ramp[0, KB] + per_step[1, KB] * w
            factor = ramp[0, DEPTH] + per_step[1, DEPTH] * w
            clearance = ramp[0, CLEARANCE] + per_step[1, CLEARANCE] * w
            y0 = ramp[0, Y0] + per_step[1, Y0] * w
            pull = const[UNBALANCE] * (_TWO_PI * hz) ** 2
            ux = pull * math.cos(_TWO_PI * shaft)
            uy = pull * math.sin(_TWO_PI * shaft)
            place = middle if part == 1 else here
            _place_balls(
                n_balls, cage, shaft, spin, clearance, factor, const, defects, balls, place
            )
            if part == 1:
                v2 = _plus(v, 0.5 * h, a1)
                a2 = _acceleration(place, _plus(q, 0.5 * h, v), v2, kb, ux, uy, y0, const)
                v3 = _plus(v, 0.5 * h, a2)
                a3 = _acceleration(place, _plus(q, 0.5 * h, v2), v3, kb, ux, uy, y0, const)
            else:
                v4 = _plus(v, h, a3)
                a4 = _acceleration(place, _plus(q, h, v3), v4, kb, ux, uy, y0, const)
                q = _plus(q, h / 6.0, _plus(_plus(_plus(v, 2.0, v2), 2.0, v3), 1.0, v4))
                v = _plus(v, h / 6.0, _plus(_plus(_plus(a1, 2.0, a2), 2.0, a3), 1.0, a4))
                last_a = a1
                a1 = _acceleration(place, q, v, kb, ux, uy, y0, const)
        bx = resonator[2, 0] * last_a[2] + resonator[3, 0] * a3[2] + resonator[4, 0] * a1[2]
        cx = resonator[2, 1] * last_a[2] + resonator[3, 1] * a3[2] + resonator[4, 1] * a1[2]
        by = resonator[2, 0] * last_a[3] + resonator[3, 0] * a3[3] + resonator[4, 0] * a1[3]
        cy = resonator[2, 1] * last_a[3] + resonator[3, 1] * a3[3] + resonator[4, 1] * a1[3]
        zx, wx = (
            resonator[0, 0] * zx + resonator[0, 1] * wx + bx,
            resonator[1, 0] * zx + resonator[1, 1] * wx + cx,
        )
        zy, wy = (
            resonator[0, 0] * zy + resonator[0, 1] * wy + by,
            resonator[1, 0] * zy + resonator[1, 1] * wy + cy,
        )
        raw[0, i] = resonator[5, 0] * zx + resonator[5, 1] * wx + resonator[6, 0] * a1[2]
        raw[1, i] = resonator[5, 0] * zy + resonator[5, 1] * wy + resonator[6, 0] * a1[3]
    for i in range(4):
        state[Q + i] = q[i]
        state[V + i] = v[i]
    state[CAGE], state[SHAFT], state[SPIN] = cage, shaft, spin
    state[11], state[12], state[13], state[14] = zx, wx, zy, wy


@nb.njit(cache=True, fastmath=_FAST)
def advance(
    state,
    history,
    const,
    defects,
    balls,
    ramp,
    resonator,
    taps,
    n_balls,
    seed,
    first,
    oversample,
    out,
):  # type: ignore[no-untyped-def]
    """Advance one bearing by ``out.shape[1]`` output samples.

    Parameters
    ----------
    state : float64[STATE_SIZE]
        Changed in place.
    history : float64[2, taps - oversample]
        Last internal samples, the memory of the decimator; changed in place.
    const, defects, balls, ramp, resonator
        See the index constants of this module. ``ramp`` is (2, RAMP_SIZE): start and end values.
    taps : float64[T]
        Low-pass filter of the decimator.
    n_balls, seed, first, oversample
        Rolling elements; seed of the random numbers; running index of the first output sample;
        internal steps per output sample.
    out : float32[2, n]
        Acceleration of the sensor along x and y, m/s^2.
    """
    n = out.shape[1]
    memory = history.shape[1]
    raw = np.empty((2, memory + n * oversample))
    raw[:, :memory] = history
    _integrate(
        state, const, defects, balls, ramp, resonator, n_balls, seed, first, oversample,
        raw[:, memory:],
    )  # fmt: skip
    history[:, :] = raw[:, n * oversample :]
    noise = const[NOISE_STD]
    for k in range(n):
        start = k * oversample
        x = 0.0
        y = 0.0
        for i in range(taps.shape[0]):
            x += taps[i] * raw[0, start + i]
            y += taps[i] * raw[1, start + i]
        pair = normal_pair(first + k, NOISE, seed)
        out[0, k] = x + noise * pair[0]
        out[1, k] = y + noise * pair[1]


@nb.njit(cache=True)
def ball_forces(state, const, defects, balls, values, n_balls):  # type: ignore[no-untyped-def]
    """Contact force of each ball, N, float32[n_balls], at the present state and inputs."""
    place = np.empty((3, balls.shape[1]))
    _place_balls(
        n_balls, state[CAGE], state[SHAFT], state[SPIN], values[CLEARANCE], values[DEPTH],
        const, defects, balls, place,
    )  # fmt: skip
    forces = np.zeros(n_balls, dtype=np.float32)
    x, y = state[0] - state[2], state[1] - state[3]
    vx, vy = state[4] - state[6], state[5] - state[7]
    for j in range(n_balls):
        c, s = place[0, j], place[1, j]
        delta = x * c + y * s - place[2, j]
        if delta > 0.0:
            rate = vx * c + vy * s
            forces[j] = max(values[KB] * delta**1.5 + const[CB] * rate, 0.0)
    return forces
