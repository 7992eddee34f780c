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
Signal Process. 2008, 22, 1924.

The integrator is the Hermite scheme of order 4 (Makino and Aarseth, Publ. Astron. Soc. Japan 1992,
44, 141). It needs the force and its time derivative once a step where Runge-Kutta needs the force
four times; the derivative costs little beside the square root that both share. A single bearing
is bound by the latency of one force after the other, so this is what its speed comes from.
"""

from __future__ import annotations

import math

from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.laws import CLEARANCE, DEPTH, K_B, SHAFT_HZ, SLIP, SPRING
from bearing_twin.dynamics.random import NOISE, normal_pair, WALK
import numpy as np
import numpy.typing as npt

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

# Rows of the ball table: cos and sin in the cage, undersize (m).
BALL_COS, BALL_SIN, UNDERSIZE = range(3)

LANES = 8
"""Balls are padded to a multiple of this, so that the compiler can use vector instructions."""
CHUNK = 32
"""Output samples, on a fixed grid, over which the cage's random walk holds its speed. At each
grid point the phases are wrapped and the rotated sines are computed anew."""

_TWO_PI = 2.0 * math.pi
# Without reassociation the sum over the balls stays scalar and skips the unloaded ones, which
# for one bearing is faster than vector lanes that have to be added up.
_IN_ORDER = FAST - {'reassoc'}

# Columns of what is prescribed at one step.
TURNING, STIFF, FOOT, PULL = range(4)  # PULL and the next three: unbalance and its rate
TABLE_SIZE = 7
# Rows of a ball at one step: gap to close (m), its rate (m/s), direction.
GAP, GAP_RATE, COS, SIN = range(4)


@compiled(inline=True, fast=FAST)
def path(profile, half, depth, curvature, along):
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


@compiled(inline=True, fast=FAST)
def _spoil(n_balls, phases, rates, factor, const, defects, gaps, step):
    """
    Add to ``gaps[step]`` what the defects take away, m, and its rate, m/s.

    ``phases`` and ``rates`` are those of cage, shaft and ball spin, turns and turns/s.
    """
    for i in range(defects.shape[0]):
        place = defects[i, PLACE]
        if place == 2.0:
            phase = 2.0 * (phases[2] - defects[i, ANGLE])
            nearest = math.floor(phase + 0.5)
            metres = math.pi * const[D_BALL]
            along = 0.5 * (phase - nearest) * metres
            speed = rates[2] * metres
            ball = int(defects[i, BALL])
            inside = nearest - 2.0 * math.floor(0.5 * nearest) == 0.0
        else:
            inside = place == 0.0
            phase = phases[0] - defects[i, ANGLE]
            speed = rates[0]
            if inside:
                phase -= phases[1]
                speed -= rates[1]
            nearest = math.floor(phase * n_balls + 0.5)
            ball = int(-nearest) % n_balls
            metres = _TWO_PI * (const[R_INNER] if inside else const[R_OUTER])
            along = (phase - nearest / n_balls) * metres
            speed *= metres
        half = defects[i, HALF]
        if place == 3.0 and ball != int(defects[i, BALL]):
            continue
        if abs(along) < half:
            curvature = defects[i, PATH_INNER] if inside else defects[i, PATH_OUTER]
            depth, slope = path(
                defects[i, PROFILE], half, defects[i, FULL_DEPTH], curvature, along
            )
            gaps[step, GAP, ball] += factor * depth
            gaps[step, GAP_RATE, ball] += factor * slope * speed


@compiled(inline=True, fast=_IN_ORDER)
def _contact(table, gaps, i, x, y, vx, vy, ax, ay, cb):
    """Force of the balls on the outer ring, N, and its time derivative, N/s."""
    turning, kb = table[i, TURNING], table[i, STIFF]
    fx = 0.0
    fy = 0.0
    gx = 0.0
    gy = 0.0
    for k in range(gaps.shape[2]):
        c, s = gaps[i, COS, k], gaps[i, SIN, k]
        delta = x * c + y * s - gaps[i, GAP, k]
        if delta > 0.0:
            v = vx * c + vy * s
            stiff = kb * math.sqrt(delta)
            force = stiff * delta + cb * v
            if force > 0.0:
                rate = 1.5 * stiff * (
                    v + turning * (y * c - x * s) - gaps[i, GAP_RATE, k]
                ) + cb * (ax * c + ay * s + turning * (vy * c - vx * s))
                fx += force * c
                fy += force * s
                gx += rate * c
                gy += rate * s
    return fx, fy, gx - turning * fy, gy + turning * fx


@compiled(inline=True, fast=FAST)
def _motion(table, gaps, i, q, v, a, const):
    """Acceleration and jerk of both rings."""
    fx, fy, gx, gy = _contact(
        table, gaps, i, q[0] - q[2], q[1] - q[3], v[0] - v[2], v[1] - v[3], a[0] - a[2],
        a[1] - a[3], const[CB],
    )  # fmt: skip
    ki, ci, ko, co = const[KI], const[CI], const[KO], const[CO]
    light, heavy = 1.0 / const[MI], 1.0 / const[MO]
    return (
        (
            (table[i, PULL] - fx - ki * q[0] - ci * v[0]) * light,
            (table[i, PULL + 1] - fy - ki * (q[1] - table[i, FOOT]) - ci * v[1]) * light,
            (fx - ko * q[2] - co * v[2]) * heavy,
            (fy - ko * q[3] - co * v[3]) * heavy,
        ),
        (
            (table[i, PULL + 2] - gx - ki * v[0] - ci * a[0]) * light,
            (table[i, PULL + 3] - gy - ki * v[1] - ci * a[1]) * light,
            (gx - ko * v[2] - co * a[2]) * heavy,
            (gy - ko * v[3] - co * a[3]) * heavy,
        ),
    )


@compiled(inline=True, fast=FAST)
def _prescribe(table, i, omega, stiff, foot, sines, turning, unbalance):
    """Fill one row of the table of what is prescribed; ``sines`` of the shaft."""
    pull = unbalance * omega * omega
    table[i, TURNING], table[i, STIFF], table[i, FOOT] = _TWO_PI * turning, stiff, foot
    table[i, PULL], table[i, PULL + 1] = pull * sines[0], pull * sines[1]
    table[i, PULL + 2], table[i, PULL + 3] = -pull * omega * sines[1], pull * omega * sines[0]


@compiled(fast=FAST)
def _turn(state, const, defects, balls, base, step, n_balls, walk, begin, table, gaps):
    """
    Turn shaft, cage and balls through a chunk of steps: this motion is prescribed, not felt.

    Fills the rows ``begin`` onwards of ``table`` and ``gaps``. The inputs at the end of step i
    are ``base + (i + 1) step``; i counts from the grid point, whatever ``begin`` is.
    """
    h = const[STEP]
    cage, shaft, spin = state[CAGE], state[SHAFT], state[SPIN]
    c, s = state[CAGE_COS], state[CAGE_SIN]
    cs, ss = state[SHAFT_COS], state[SHAFT_SIN]
    wander = walk * math.sqrt(base[SHAFT_HZ])
    spin_per_cage = const[SPIN_ORDER] / const[FTF_ORDER]  # the balls roll as fast as they travel
    for i in range(table.shape[0]):
        middle, end = begin + i + 0.5, begin + i + 1.0
        hz = base[SHAFT_HZ] + step[SHAFT_HZ] * middle
        carried = hz * (1.0 - (base[SLIP] + step[SLIP] * middle))
        turning = const[FTF_ORDER] * carried + wander
        rolling = turning * spin_per_cage
        cage += h * turning
        shaft += h * hz
        spin += h * rolling
        c, s = _rotate(c, s, _TWO_PI * h * turning)
        cs, ss = _rotate(cs, ss, _TWO_PI * h * hz)
        clearance = base[CLEARANCE] + step[CLEARANCE] * end
        for group in range(0, balls.shape[1], LANES):
            for lane in range(LANES):
                k = group + lane
                gaps[i, GAP, k] = clearance + balls[UNDERSIZE, k]
                gaps[i, GAP_RATE, k] = 0.0
                gaps[i, COS, k] = c * balls[BALL_COS, k] - s * balls[BALL_SIN, k]
                gaps[i, SIN, k] = s * balls[BALL_COS, k] + c * balls[BALL_SIN, k]
        _spoil(
            n_balls, (cage, shaft, spin), (turning, hz, rolling),
            base[DEPTH] + step[DEPTH] * end, const, defects, gaps, i,
        )  # fmt: skip
        omega = _TWO_PI * (base[SHAFT_HZ] + step[SHAFT_HZ] * end)
        _prescribe(
            table, i, omega, base[K_B] + step[K_B] * end, base[SPRING] + step[SPRING] * end,
            (cs, ss), turning, const[UNBALANCE],
        )  # fmt: skip
    state[CAGE], state[SHAFT], state[SPIN] = cage, shaft, spin
    state[CAGE_COS], state[CAGE_SIN] = c, s
    state[SHAFT_COS], state[SHAFT_SIN] = cs, ss


@compiled(inline=True, fast=FAST)
def _rotate(c, s, angle):
    """Rotate (cos, sin) by a small angle, up to 0.07 rad."""
    square = angle * angle
    cd = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0)))
    sd = angle * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0)))
    return c * cd - s * sd, s * cd + c * sd


@compiled()
def _refresh(state):
    """Wrap the phases to 0..1 and compute the sines that follow from them."""
    for at in (CAGE, SHAFT, SPIN):
        state[at] -= math.floor(state[at])
    state[CAGE_COS] = math.cos(_TWO_PI * state[CAGE])
    state[CAGE_SIN] = math.sin(_TWO_PI * state[CAGE])
    state[SHAFT_COS] = math.cos(_TWO_PI * state[SHAFT])
    state[SHAFT_SIN] = math.sin(_TWO_PI * state[SHAFT])


@compiled(inline=True, fast=FAST)
def _taylor(h, a, b):
    return (a[0] + h * b[0], a[1] + h * b[1], a[2] + h * b[2], a[3] + h * b[3])


@compiled(fast=_IN_ORDER)
def _integrate(state, const, table, gaps, resonator, left, up):
    """Advance both rings and the sensor through the rows of ``table``."""
    h = const[STEP]
    third, half, twelfth = h / 3.0, 0.5 * h, h * h / 12.0
    q = (state[0], state[1], state[2], state[3])
    v = (state[4], state[5], state[6], state[7])
    a = (state[8], state[9], state[10], state[11])
    j = (state[12], state[13], state[14], state[15])
    zx, wx, zy, wy = state[23], state[24], state[25], state[26]
    for i in range(table.shape[0]):
        ahead = _taylor(h, a, j)
        faster = _taylor(h, v, _taylor(half, a, j))
        further = _taylor(h, q, _taylor(half, v, _taylor(third, a, j)))
        a1, j1 = _motion(table, gaps, i, further, faster, ahead, const)
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
        left[i] = resonator[5, 0] * zx + resonator[5, 1] * wx + resonator[6, 0] * a1[2]
        up[i] = resonator[5, 0] * zy + resonator[5, 1] * wy + resonator[6, 0] * a1[3]
        v, a, j = v1, a1, j1
    for i in range(4):
        state[Q + i], state[V + i], state[A + i], state[J + i] = q[i], v[i], a[i], j[i]
    state[23], state[24], state[25], state[26] = zx, wx, zy, wy


@compiled(fast=FAST)
def advance(
    state: FloatArray,
    history: FloatArray,
    const: FloatArray,
    defects: FloatArray,
    balls: FloatArray,
    ramp: FloatArray,
    drift: FloatArray,
    resonator: FloatArray,
    taps: FloatArray,
    n_balls: int,
    seed: int,
    first: int,
    since_tick: int,
    oversample: int,
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
    # Everything between two grid points stays in the fastest cache.
    raw = np.empty((2, memory + CHUNK * oversample))
    table = np.empty((CHUNK * oversample, TABLE_SIZE))
    gaps = np.empty((CHUNK * oversample, 4, balls.shape[1]))
    raw[:, :memory] = history
    done = 0
    while done < n:
        within = (first + done) % CHUNK
        count = min(CHUNK - within, n - done)
        if within == 0:
            _refresh(state)
        walk = const[JITTER] * normal_pair((first + done) // CHUNK, WALK, seed)[0]
        base, step = _inputs(ramp, drift, n, oversample, done - within, since_tick)
        rows = count * oversample
        _turn(
            state, const, defects, balls, base, step, n_balls, walk,
            float(within * oversample), table[:rows], gaps[:rows],
        )  # fmt: skip
        _integrate(
            state, const, table[:rows], gaps[:rows], resonator,
            raw[0, memory : memory + rows], raw[1, memory : memory + rows],
        )  # fmt: skip
        _decimate(raw, taps, oversample, out[:, done : done + count])
        for i in range(memory):
            raw[0, i] = raw[0, rows + i]
            raw[1, i] = raw[1, rows + i]
        done += count
    history[:, :] = raw[:, :memory]
    _add_noise(const[NOISE_STD], seed, first, out)


@compiled(inline=True, fast=FAST)
def _inputs(ramp, drift, n, oversample, at, since_tick):
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
            ((ramp[1, 0] - ramp[0, 0]) / n + drift[1, 0]) / oversample,
            ((ramp[1, 1] - ramp[0, 1]) / n + drift[1, 1]) / oversample,
            ((ramp[1, 2] - ramp[0, 2]) / n + drift[1, 2]) / oversample,
            ((ramp[1, 3] - ramp[0, 3]) / n + drift[1, 3]) / oversample,
            ((ramp[1, 4] - ramp[0, 4]) / n + drift[1, 4]) / oversample,
            ((ramp[1, 5] - ramp[0, 5]) / n + drift[1, 5]) / oversample,
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
    _spoil(
        n_balls, (state[CAGE], state[SHAFT], state[SPIN]),
        (turning, hz, const[SPIN_ORDER] * carried), values[DEPTH], const, defects, gaps, 0,
    )  # fmt: skip
    sines = (state[SHAFT_COS], state[SHAFT_SIN])
    _prescribe(
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
    Set sines, acceleration and jerk of ``state`` from its phases, positions and velocities.

    To be called where a trajectory begins and where parameters change; ``values`` are the inputs.
    """
    _refresh(state)
    table, gaps = _instant(state, const, defects, balls, values, n_balls)
    q = (state[0], state[1], state[2], state[3])
    v = (state[4], state[5], state[6], state[7])
    a = (0.0, 0.0, 0.0, 0.0)
    j = a
    for _ in range(2):  # the jerk of the contact damping takes the acceleration found first
        a, j = _motion(table, gaps, 0, q, v, a, const)
    for i in range(4):
        state[A + i], state[J + i] = a[i], j[i]


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
