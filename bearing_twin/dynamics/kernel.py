# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Compiled kernel of one bearing: equations of motion, resonance, decimation, noise.

The equations (x right, y up, load along -y), one line an axis, y shown::

    m_i y_i'' = -F_y - k_i (y_i - y_i0) - c_i y_i' + m_u e omega^2 sin(theta_s)
    m_o y_o'' = +F_y - k_o y_o - c_o y_o'
    delta_j   = (x_i - x_o) cos(theta_j) + (y_i - y_o) sin(theta_j) - c_r - b_j C_d
    F         = sum_j max(K_b max(delta_j, 0)^1.5 + c_b v_j, 0) over loaded balls

with v_j the rings' velocity of approach along ball j: Symmetry 2023, 15, 2166, equations 1 to 8,
with the masses and damping that the paper leaves out taken from Sawalhi and Randall, Mech. Syst.
Signal Process. 2008, 22, 1924.

The integrator is the Hermite scheme of order 4 (Makino and Aarseth, Publ. Astron. Soc. Japan 1992,
44, 141). It needs the force and its time derivative once a step where Runge-Kutta needs the force
four times; the derivative costs little beside the square root that both share. A single bearing
is bound by the latency of one force after the other, so this is what its speed comes from.
"""

from __future__ import annotations

import math

import numba as nb
import numpy as np
import numpy.typing as npt

from bearing_twin.dynamics.laws import CLEARANCE, DEPTH, INPUTS, K_B, SHAFT_HZ, SLIP, SPRING
from bearing_twin.dynamics.random import NOISE, WALK, normal_pair

__all__ = ['advance', 'ball_forces', 'start']

FloatArray = npt.NDArray[np.float64]

# Layout of the state: x_i, y_i, x_o, y_o; then velocity, acceleration and jerk of each.
Q, V, A, J = 0, 4, 8, 12
CAGE, SHAFT, SPIN = 16, 17, 18  # phases, turns
CAGE_COS, CAGE_SIN, SHAFT_COS, SHAFT_SIN = 19, 20, 21, 22
RESONATOR = 23  # two states of x, two of y
STATE_SIZE = 27

# Constants of one bearing.
(
    MI, KI, CI, MO, KO, CO, CB, UNBALANCE, FTF_ORDER, SPIN_ORDER, JITTER, NOISE_STD, STEP,
    D_BALL, R_INNER, R_OUTER,
) = range(16)  # fmt: skip
CONST_SIZE = 16

# Columns of a defect: place, profile, half width (m), depth (m), angle (turns), ball, curvature of
# the path on the inner and on the outer race (1/m).
PLACE, PROFILE, HALF, FULL_DEPTH, ANGLE, BALL, PATH_INNER, PATH_OUTER = range(8)
DEFECT_SIZE = 8

# Rows of the ball table: cos and sin in the cage, undersize (m), displacement (turns).
BALL_COS, BALL_SIN, UNDERSIZE, SHIFT = range(4)

# Rows of a ball's place at one step: direction, gap to close (m) and its rate (m/s).
COS, SIN, GAP, GAP_RATE = range(4)

LANES = 8
"""Balls are padded to a multiple of this, so that the compiler can use vector instructions."""
WALK_EVERY = 16
"""Output samples over which one step of the cage's random walk is spread."""
REFRESH_EVERY = 64
"""Output samples after which the rotated sines are computed anew."""

_CHUNK = 64
_TWO_PI = 2.0 * math.pi
_FAST = {'contract', 'reassoc', 'nsz', 'arcp', 'nnan', 'ninf'}


@nb.njit(cache=True, inline='always', fastmath=_FAST)
def path(profile, half, depth, curvature, along):  # type: ignore[no-untyped-def]
    """How far a ball sinks at a distance from the centre of a defect, m, and its slope there."""
    edge = half - abs(along)
    inward = -1.0 if along > 0.0 else 1.0
    if edge <= 0.0:
        return 0.0, 0.0
    if profile == 0.0:
        sag = edge * edge * curvature
        if sag < depth:
            return sag, inward * 2.0 * edge * curvature
        return depth, 0.0
    if profile == 1.0:
        return depth, 0.0
    if profile == 2.0:
        angle = 0.5 * math.pi * along / half
        return depth * math.cos(angle), -depth * 0.5 * math.pi / half * math.sin(angle)
    flank = 0.5 * half
    if edge >= flank:
        return depth, 0.0
    angle = math.pi * edge / flank
    slope = 0.5 * depth * math.pi / flank * math.sin(angle)
    return 0.5 * depth * (1.0 - math.cos(angle)), inward * slope


@nb.njit(cache=True, fastmath=_FAST)
def _place(
    n_balls, phases, rates, c0, s0, clearance, factor, const, defects, balls, out
):  # type: ignore[no-untyped-def]
    """Fill ``out`` (4, padded) for phases and rates (cage, shaft, spin) in turns and turns/s."""
    for j in range(out.shape[1]):
        out[COS, j] = c0 * balls[BALL_COS, j] - s0 * balls[BALL_SIN, j]
        out[SIN, j] = s0 * balls[BALL_COS, j] + c0 * balls[BALL_SIN, j]
        out[GAP, j] = clearance + balls[UNDERSIZE, j]
        out[GAP_RATE, j] = 0.0
    cage, shaft, spin = phases
    for i in range(defects.shape[0]):
        place = defects[i, PLACE]
        if place == 3.0:
            continue
        if place == 2.0:
            phase = 2.0 * (spin - defects[i, ANGLE])
            nearest = math.floor(phase + 0.5)
            metres = math.pi * const[D_BALL]
            along = 0.5 * (phase - nearest) * metres
            speed = rates[2] * metres
            ball = int(defects[i, BALL])
            inside = nearest - 2.0 * math.floor(0.5 * nearest) == 0.0
        else:
            inside = place == 0.0
            phase = cage - defects[i, ANGLE]
            speed = rates[0]
            if inside:
                phase -= shaft
                speed -= rates[1]
            nearest = math.floor(phase * n_balls + 0.5)
            ball = int(-nearest) % n_balls
            metres = _TWO_PI * (const[R_INNER] if inside else const[R_OUTER])
            along = (phase - nearest / n_balls + balls[SHIFT, ball]) * metres
            speed *= metres
        half = defects[i, HALF]
        if abs(along) < half:
            curvature = defects[i, PATH_INNER] if inside else defects[i, PATH_OUTER]
            depth, slope = path(
                defects[i, PROFILE], half, defects[i, FULL_DEPTH], curvature, along
            )
            out[GAP, ball] += factor * depth
            out[GAP_RATE, ball] += factor * slope * speed


@nb.njit(cache=True, inline='always', fastmath=_FAST)
def _contact(place, x, y, vx, vy, ax, ay, turning, kb, cb):  # type: ignore[no-untyped-def]
    """Force of the balls on the outer ring, N, and its time derivative, N/s.

    ``turning`` is the speed of the cage, rad/s.
    """
    fx = 0.0
    fy = 0.0
    gx = 0.0
    gy = 0.0
    for j in range(place.shape[1]):
        c = place[COS, j]
        s = place[SIN, j]
        delta = x * c + y * s - place[GAP, j]
        closed = delta if delta > 0.0 else 0.0
        root = math.sqrt(closed)
        v = vx * c + vy * s
        stiff = kb * root
        force = stiff * closed + cb * v
        rate = 1.5 * stiff * (v + turning * (y * c - x * s) - place[GAP_RATE, j]) + cb * (
            ax * c + ay * s + turning * (vy * c - vx * s)
        )
        loaded = (delta > 0.0) & (force > 0.0)
        force = force if loaded else 0.0
        rate = rate if loaded else 0.0
        fx += force * c
        fy += force * s
        gx += rate * c
        gy += rate * s
    return fx, fy, gx - turning * fy, gy + turning * fx


@nb.njit(cache=True, inline='always', fastmath=_FAST)
def _motion(place, q, v, a, turning, kb, y0, pull, const):  # type: ignore[no-untyped-def]
    """Acceleration and jerk of both rings."""
    fx, fy, gx, gy = _contact(
        place, q[0] - q[2], q[1] - q[3], v[0] - v[2], v[1] - v[3], a[0] - a[2], a[1] - a[3],
        turning, kb, const[CB],
    )  # fmt: skip
    ki, ci, ko, co = const[KI], const[CI], const[KO], const[CO]
    light, heavy = 1.0 / const[MI], 1.0 / const[MO]
    return (
        (
            (pull[0] - fx - ki * q[0] - ci * v[0]) * light,
            (pull[1] - fy - ki * (q[1] - y0) - ci * v[1]) * light,
            (fx - ko * q[2] - co * v[2]) * heavy,
            (fy - ko * q[3] - co * v[3]) * heavy,
        ),
        (
            (pull[2] - gx - ki * v[0] - ci * a[0]) * light,
            (pull[3] - gy - ki * v[1] - ci * a[1]) * light,
            (gx - ko * v[2] - co * a[2]) * heavy,
            (gy - ko * v[3] - co * a[3]) * heavy,
        ),
    )


@nb.njit(cache=True, inline='always', fastmath=_FAST)
def _input(ramp, drift, quantity, steps, since_tick):  # type: ignore[no-untyped-def]
    """Ramp over the block plus the drift of the inner ring's temperature since its last tick."""
    slope = (ramp[1, quantity] - ramp[0, quantity]) * steps
    return ramp[0, quantity] + slope + (drift[0, quantity] + drift[1, quantity] * since_tick)


@nb.njit(cache=True, fastmath=_FAST)
def _turn(
    state, const, defects, balls, ramp, drift, n_balls, seed, sample, part, oversample, done,
    share, since_tick, tables, places,
):  # type: ignore[no-untyped-def]
    """Turn shaft, cage and balls through a chunk of steps; what moves is prescribed, not felt.

    Fills ``places`` (steps, 4, balls) and ``tables`` (steps, 7): cage speed in rad/s, K_b, y_i0,
    pull of the unbalance along x and y and its derivative.
    """
    h = const[STEP]
    walk = const[JITTER] * normal_pair(sample // WALK_EVERY, WALK, seed)[0]
    for i in range(places.shape[0]):
        if part == 0 and sample % WALK_EVERY == 0:
            # Spread over its interval: the ball angle stays smooth, and the scheme its order.
            walk = const[JITTER] * normal_pair(sample // WALK_EVERY, WALK, seed)[0]
        middle, end = (done + i + 0.5) * share, (done + i + 1.0) * share
        hz = _input(ramp, drift, SHAFT_HZ, middle, since_tick + i + 0.5)
        slip = _input(ramp, drift, SLIP, middle, since_tick + i + 0.5)
        carried = hz * (1.0 - slip)
        turning = const[FTF_ORDER] * carried + walk * math.sqrt(hz)
        rolling = const[SPIN_ORDER] * carried
        cage = state[CAGE] + h * turning
        shaft = state[SHAFT] + h * hz
        spin = state[SPIN] + h * rolling
        cage -= math.floor(cage)
        shaft -= math.floor(shaft)
        spin -= math.floor(spin)
        state[CAGE], state[SHAFT], state[SPIN] = cage, shaft, spin
        part += 1
        if part == oversample:
            part = 0
            sample += 1
        if part == 0 and sample % REFRESH_EVERY == 0:
            state[CAGE_COS], state[CAGE_SIN] = math.cos(_TWO_PI * cage), math.sin(_TWO_PI * cage)
            state[SHAFT_COS] = math.cos(_TWO_PI * shaft)
            state[SHAFT_SIN] = math.sin(_TWO_PI * shaft)
        else:
            _rotate(state, CAGE_COS, _TWO_PI * h * turning)
            _rotate(state, SHAFT_COS, _TWO_PI * h * hz)
        now = since_tick + i + 1.0
        omega = _TWO_PI * _input(ramp, drift, SHAFT_HZ, end, now)
        pull = const[UNBALANCE] * omega * omega
        tables[i, 0] = _TWO_PI * turning
        tables[i, 1] = _input(ramp, drift, K_B, end, now)
        tables[i, 2] = _input(ramp, drift, SPRING, end, now)
        tables[i, 3] = pull * state[SHAFT_COS]
        tables[i, 4] = pull * state[SHAFT_SIN]
        tables[i, 5] = -pull * omega * state[SHAFT_SIN]
        tables[i, 6] = pull * omega * state[SHAFT_COS]
        _place(
            n_balls, (cage, shaft, spin), (turning, hz, rolling), state[CAGE_COS],
            state[CAGE_SIN], _input(ramp, drift, CLEARANCE, end, now),
            _input(ramp, drift, DEPTH, end, now), const, defects, balls, places[i],
        )  # fmt: skip


@nb.njit(cache=True, inline='always', fastmath=_FAST)
def _rotate(state, at, angle):  # type: ignore[no-untyped-def]
    """Rotate the pair (cos, sin) at index ``at`` by a small angle, up to 0.07 rad, rounded once."""
    square = angle * angle
    c = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0)))
    s = angle * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0 - square * (1.0 / 5040.0))))
    c0, s0 = state[at], state[at + 1]
    state[at] = c0 * c - s0 * s
    state[at + 1] = s0 * c + c0 * s


@nb.njit(cache=True, inline='always', fastmath=_FAST)
def _taylor(h, a, b):  # type: ignore[no-untyped-def]
    return (a[0] + h * b[0], a[1] + h * b[1], a[2] + h * b[2], a[3] + h * b[3])


@nb.njit(cache=True, fastmath=_FAST)
def _integrate(state, const, tables, places, resonator, raw):  # type: ignore[no-untyped-def]
    """Advance both rings and the sensor through the steps of ``places``."""
    h = const[STEP]
    third, half, twelfth = h / 3.0, 0.5 * h, h * h / 12.0
    q = (state[0], state[1], state[2], state[3])
    v = (state[4], state[5], state[6], state[7])
    a = (state[8], state[9], state[10], state[11])
    j = (state[12], state[13], state[14], state[15])
    zx, wx, zy, wy = state[23], state[24], state[25], state[26]
    for i in range(places.shape[0]):
        row = tables[i]
        pull = (row[3], row[4], row[5], row[6])
        ahead = _taylor(h, a, j)
        faster = _taylor(h, v, _taylor(half, a, j))
        further = _taylor(h, q, _taylor(half, v, _taylor(third, a, j)))
        a1, j1 = _motion(
            places[i], further, faster, ahead, row[0], row[1], row[2], pull, const
        )
        v1 = (
            v[0] + half * (a[0] + a1[0]) + twelfth * (j[0] - j1[0]),
            v[1] + half * (a[1] + a1[1]) + twelfth * (j[1] - j1[1]),
            v[2] + half * (a[2] + a1[2]) + twelfth * (j[2] - j1[2]),
            v[3] + half * (a[3] + a1[3]) + twelfth * (j[3] - j1[3]),
        )
        q = (
            q[0] + half * (v[0] + v1[0]) + twelfth * (a[0] - a1[0]),
            q[1] + half * (v[1] + v1[1]) + twelfth * (a[1] - a1[1]),
            q[2] + half * (v[2] + v1[2]) + twelfth * (a[2] - a1[2]),
            q[3] + half * (v[3] + v1[3]) + twelfth * (a[3] - a1[3]),
        )
        mx = 0.5 * (a[2] + a1[2]) + 0.25 * half * (j[2] - j1[2])
        my = 0.5 * (a[3] + a1[3]) + 0.25 * half * (j[3] - j1[3])
        zx, wx = (
            resonator[0, 0] * zx + resonator[0, 1] * wx
            + (resonator[2, 0] * a[2] + resonator[3, 0] * mx + resonator[4, 0] * a1[2]),
            resonator[1, 0] * zx + resonator[1, 1] * wx
            + (resonator[2, 1] * a[2] + resonator[3, 1] * mx + resonator[4, 1] * a1[2]),
        )  # fmt: skip
        zy, wy = (
            resonator[0, 0] * zy + resonator[0, 1] * wy
            + (resonator[2, 0] * a[3] + resonator[3, 0] * my + resonator[4, 0] * a1[3]),
            resonator[1, 0] * zy + resonator[1, 1] * wy
            + (resonator[2, 1] * a[3] + resonator[3, 1] * my + resonator[4, 1] * a1[3]),
        )  # fmt: skip
        raw[0, i] = resonator[5, 0] * zx + resonator[5, 1] * wx + resonator[6, 0] * a1[2]
        raw[1, i] = resonator[5, 0] * zy + resonator[5, 1] * wy + resonator[6, 0] * a1[3]
        v, a, j = v1, a1, j1
    for i in range(4):
        state[Q + i], state[V + i], state[A + i], state[J + i] = q[i], v[i], a[i], j[i]
    state[23], state[24], state[25], state[26] = zx, wx, zy, wy


@nb.njit(cache=True, fastmath=_FAST)
def advance(
    state, history, const, defects, balls, ramp, drift, resonator, taps, n_balls, seed, first,
    since_tick, oversample, out,
):  # type: ignore[no-untyped-def]
    """Advance one bearing by ``out.shape[1]`` output samples.

    Parameters
    ----------
    state : float64[STATE_SIZE]
        Changed in place.
    history : float64[2, taps - oversample]
        Last internal samples, the memory of the decimator; changed in place.
    const, defects, balls
        See the index constants of this module.
    ramp : float64[2, INPUTS]
        Inputs at the start and at the end of the block.
    drift : float64[2, INPUTS]
        Addition to the inputs at the last thermal tick, and its growth per output sample.
    resonator, taps
        Tables of `filters.resonator` and `filters.decimator`.
    n_balls, seed
        Rolling elements; seed of the random numbers.
    first, since_tick
        Index of the first output sample; output samples since the last thermal tick.
    oversample
        Internal steps per output sample.
    out : float32[2, n]
        Acceleration of the sensor along x and y, m/s^2.
    """
    n = out.shape[1]
    memory = history.shape[1]
    steps = n * oversample
    raw = np.empty((2, memory + steps))
    raw[:, :memory] = history
    places = np.empty((_CHUNK, 4, balls.shape[1]))
    tables = np.empty((_CHUNK, 7))
    per_step = drift.copy()
    per_step[1] /= oversample
    for done in range(0, steps, _CHUNK):
        count = min(_CHUNK, steps - done)
        _turn(
            state, const, defects, balls, ramp, per_step, n_balls, seed,
            first + done // oversample, done % oversample, oversample, done, 1.0 / steps,
            since_tick * oversample + done, tables, places[:count],
        )  # fmt: skip
        _integrate(
            state, const, tables, places[:count], resonator, raw[:, memory + done :]
        )
    history[:, :] = raw[:, steps:]
    noise = const[NOISE_STD]
    for k in range(n):
        at = k * oversample
        x = 0.0
        y = 0.0
        for i in range(taps.shape[0]):
            x += taps[i] * raw[0, at + i]
            y += taps[i] * raw[1, at + i]
        pair = normal_pair(first + k, NOISE, seed)
        out[0, k] = x + noise * pair[0]
        out[1, k] = y + noise * pair[1]


@nb.njit(cache=True, fastmath=_FAST)
def start(state, const, defects, balls, values, n_balls):  # type: ignore[no-untyped-def]
    """Set sines, acceleration and jerk of ``state`` from its phases, positions and velocities.

    To be called where a trajectory begins and where parameters change; ``values`` are the inputs.
    """
    cage, shaft, spin = state[CAGE], state[SHAFT], state[SPIN]
    state[CAGE_COS], state[CAGE_SIN] = math.cos(_TWO_PI * cage), math.sin(_TWO_PI * cage)
    state[SHAFT_COS], state[SHAFT_SIN] = math.cos(_TWO_PI * shaft), math.sin(_TWO_PI * shaft)
    place = np.empty((4, balls.shape[1]))
    hz = values[SHAFT_HZ]
    carried = hz * (1.0 - values[SLIP])
    turning = const[FTF_ORDER] * carried
    _place(
        n_balls, (cage, shaft, spin), (turning, hz, const[SPIN_ORDER] * carried),
        state[CAGE_COS], state[CAGE_SIN], values[CLEARANCE], values[DEPTH], const, defects,
        balls, place,
    )  # fmt: skip
    omega = _TWO_PI * hz
    force = const[UNBALANCE] * omega * omega
    pull = (
        force * state[SHAFT_COS],
        force * state[SHAFT_SIN],
        -force * omega * state[SHAFT_SIN],
        force * omega * state[SHAFT_COS],
    )
    q = (state[0], state[1], state[2], state[3])
    v = (state[4], state[5], state[6], state[7])
    a = (0.0, 0.0, 0.0, 0.0)
    j = a
    for _ in range(2):  # the jerk of the contact damping takes the acceleration found first
        a, j = _motion(
            place, q, v, a, _TWO_PI * turning, values[K_B], values[SPRING], pull, const
        )
    for i in range(4):
        state[A + i], state[J + i] = a[i], j[i]


@nb.njit(cache=True)
def ball_forces(state, const, defects, balls, values, n_balls):  # type: ignore[no-untyped-def]
    """Contact force of each ball, N, float32[n_balls], at the present state and inputs."""
    place = np.empty((4, balls.shape[1]))
    _place(
        n_balls, (state[CAGE], state[SHAFT], state[SPIN]), (0.0, 0.0, 0.0), state[CAGE_COS],
        state[CAGE_SIN], values[CLEARANCE], values[DEPTH], const, defects, balls, place,
    )  # fmt: skip
    forces = np.zeros(n_balls, dtype=np.float32)
    x, y = state[0] - state[2], state[1] - state[3]
    vx, vy = state[4] - state[6], state[5] - state[7]
    for j in range(n_balls):
        c, s = place[COS, j], place[SIN, j]
        delta = x * c + y * s - place[GAP, j]
        if delta > 0.0:
            forces[j] = max(values[K_B] * delta**1.5 + const[CB] * (vx * c + vy * s), 0.0)
    return forces
