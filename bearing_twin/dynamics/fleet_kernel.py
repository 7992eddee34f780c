# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Compiled kernel of sixteen bearings side by side, in single precision.

The same equations, scheme and random numbers as `kernel`, with the bearings in the lanes of the
vector unit. All lanes take every branch, so the contact is written with selections; the work
arrays are flat with compile-time offsets, so that the compiler sees that nothing overlaps. Other
offsets are unsigned or sliced off, since an index that might be negative is gathered lane by lane.
Phases are kept in double precision between grid points and relative to them in between, so a fleet
does not drift. Speeds are constant between two grid points (1.25 ms at 25.6 kHz).
"""

from __future__ import annotations

import math
from typing import Any

from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.laws import CLEARANCE, DEPTH, K_B, SHAFT_HZ, SLIP, SPRING
from bearing_twin.dynamics.layout import CHUNK
from bearing_twin.dynamics.random import NOISE, normal_pair, WALK
import numpy as np
import numpy.typing as npt

__all__ = ['advance_group']

Array = npt.NDArray[Any]

L = 16
"""Bearings in a group: the single precision lanes of the widest vector units."""
TAPS = 11
"""Taps of the decimator applied at once."""
_REFRESH = 4
"""Grid points after which the rotated sines are computed anew."""
MAX_SPALLS = 4
"""Most spalls of one bearing of a fleet."""

# Rows of the flat work array; each row has L lanes. First the state that is carried on.
_Q, _V, _A, _J = 0, 4, 8, 12
_ZX, _WX, _ZY, _WY = 16, 17, 18, 19
STATE_ROWS = 20
# Constants: of the bearing; the three rows of the sensor's table, six each; balls.
CONSTANTS = 20
_LIGHT, _KI, _CI, _HEAVY, _KO, _CO, _CB, _UNBALANCE = range(CONSTANTS, CONSTANTS + 8)
_TO_Z, _TO_W, _READ = 28, 34, 40
_Z = 46
CONSTANT_ROWS = 27
# What is prescribed: values at the grid point and growth per step, then at the step.
_KB0, _KB1, _DEPTH0, _DEPTH1, _GAP0, _GAP1, _FOOT0, _FOOT1 = range(47, 55)
C, S, _CD, _SD, CS, SS, _CSD, _SSD, _TURNING, _OMEGA, _PULL = range(55, 66)
_KB, _FACTOR, _GAP, _FOOT = range(66, 70)
# The relative motion that the balls feel, its velocity and acceleration as seen from the cage, and
# the sums over the balls.
_X, _Y, _VX, _VY, _UX, _UY, _BX, _BY = range(70, 78)
_FX, _FY, _GX, _GY = range(78, 82)
# Predicted state: positions, velocities, accelerations.
_QP, _VP, _AP = 82, 86, 90
# Accelerations and jerks at the end of the step, and what the sensor gives.
_AN, _JN, _OUT = 94, 98, 102
SPALLS = 104
"""First row of the spalls; each has `SPALL_ROWS`."""
(
    U_SCALE, METRES, FIXED, EVEN, ODD, HALF, FULL, KIND, _U0, _DU, BALL, _TAKEN, _TAKEN_RATE, ONLY,
) = range(14)  # fmt: skip
SPALL_ROWS = 14
WORK_ROWS = SPALLS + MAX_SPALLS * SPALL_ROWS

# Rows of a ball: direction in the cage and undersize.
BALL_ROWS = 3

# Rows of the phases (float64): cage, shaft, spin; orders of cage and spin; walk; spalls' angles
# and which phases they follow.
CAGE, SHAFT, SPIN, FTF_ORDER, SPIN_ORDER, JITTER, NOISE_STD, FIRST_ANGLE = range(8)
PHASE_ROWS = 8 + 4 * MAX_SPALLS

_F, _U = np.float32, np.uint64
_ROW, _LANES, _FROM = np.uint64(2 * L), np.uint64(L), np.uint64(_OUT * L)
_ZERO, _ONE, _HALF_, _ONE_HALF = _F(0.0), _F(1.0), _F(0.5), _F(1.5)
_TWO_PI = 2.0 * math.pi


@compiled(fast=FAST)
def _predict(w, h):
    half, third = _F(0.5) * h, h / _F(3.0)
    for d in range(4):
        for i in range(L):
            a, j = w[(_A + d) * L + i], w[(_J + d) * L + i]
            v = w[(_V + d) * L + i]
            w[(_AP + d) * L + i] = a + h * j
            w[(_VP + d) * L + i] = v + h * (a + half * j)
            w[(_QP + d) * L + i] = w[(_Q + d) * L + i] + h * (v + half * (a + third * j))
    for i in range(L):
        turning = w[_TURNING * L + i]
        x = w[_QP * L + i] - w[(_QP + 2) * L + i]
        y = w[(_QP + 1) * L + i] - w[(_QP + 3) * L + i]
        vx = w[_VP * L + i] - w[(_VP + 2) * L + i]
        vy = w[(_VP + 1) * L + i] - w[(_VP + 3) * L + i]
        w[_X * L + i], w[_Y * L + i], w[_VX * L + i], w[_VY * L + i] = x, y, vx, vy
        w[_UX * L + i], w[_UY * L + i] = vx + turning * y, vy - turning * x
        ax = w[_AP * L + i] - w[(_AP + 2) * L + i]
        ay = w[(_AP + 1) * L + i] - w[(_AP + 3) * L + i]
        w[_BX * L + i], w[_BY * L + i] = ax + turning * vy, ay - turning * vx
        w[_FX * L + i] = _ZERO
        w[_FY * L + i] = _ZERO
        w[_GX * L + i] = _ZERO
        w[_GY * L + i] = _ZERO


@compiled(fast=FAST)
def _prescribe(w, step):
    """Turn the cage and the shaft by one step and evaluate the ramps at its end."""
    end = step + _ONE
    for i in range(L):
        c, s = w[C * L + i], w[S * L + i]
        w[C * L + i] = c * w[_CD * L + i] - s * w[_SD * L + i]
        w[S * L + i] = s * w[_CD * L + i] + c * w[_SD * L + i]
        c, s = w[CS * L + i], w[SS * L + i]
        w[CS * L + i] = c * w[_CSD * L + i] - s * w[_SSD * L + i]
        w[SS * L + i] = s * w[_CSD * L + i] + c * w[_SSD * L + i]
        w[_KB * L + i] = w[_KB0 * L + i] + end * w[_KB1 * L + i]
        w[_FACTOR * L + i] = w[_DEPTH0 * L + i] + end * w[_DEPTH1 * L + i]
        w[_GAP * L + i] = w[_GAP0 * L + i] + end * w[_GAP1 * L + i]
        w[_FOOT * L + i] = w[_FOOT0 * L + i] + end * w[_FOOT1 * L + i]


@compiled(inline=True, fast=FAST)
def _spoil(w, spall, step, per_second):
    """Which ball a spall has under it, what it takes from the contact and at what rate."""
    at = (SPALLS + spall * SPALL_ROWS) * L
    end = step + _ONE
    for i in range(L):
        # Loads first: a load behind a condition would keep the loop scalar.
        n_balls, fixed, metres = w[_Z * L + i], w[at + FIXED * L + i], w[at + METRES * L + i]
        only = w[at + ONLY * L + i]
        even, odd = w[at + EVEN * L + i], w[at + ODD * L + i]
        half, full, factor = w[at + HALF * L + i], w[at + FULL * L + i], w[_FACTOR * L + i]
        growth = w[at + _DU * L + i]
        u = w[at + _U0 * L + i] + end * growth
        nearest = _F(np.int32(u + _HALF_))  # u is positive
        on_race = fixed < _ZERO
        ball = n_balls - nearest
        ball = _ZERO if ball >= n_balls else ball
        ball = ball if on_race else fixed
        ball = ball if (only < _ZERO) | (ball == only) else -_ONE
        along = (u - nearest) * metres
        curvature = odd if (nearest == _ONE) & (not on_race) else even
        distance = abs(along)
        edge = half - distance
        sag = edge * edge * curvature
        depth = full if sag >= full else sag
        slope = _ZERO if sag >= full else _F(2.0) * edge * curvature
        slope = -slope if along > _ZERO else slope
        inside = edge > _ZERO
        w[at + BALL * L + i] = ball
        w[at + _TAKEN * L + i] = factor * depth if inside else _ZERO
        rate = factor * slope * metres * growth * per_second
        w[at + _TAKEN_RATE * L + i] = rate if inside else _ZERO


@compiled(fast=FAST)
def _spoil_first(w, step, per_second):
    """`_spoil` of slot 0, whose rows the compiler knows: nearly all fleets have no other."""
    _spoil(w, 0, step, per_second)


@compiled(fast=FAST)
def _spoil_smooth(w, spall, step, per_second):
    """As `_spoil` for the profiles with a cosine, one lane after the other."""
    at = (SPALLS + spall * SPALL_ROWS) * L
    for i in range(L):
        kind = w[at + KIND * L + i]
        if kind < _F(2.0):
            continue
        u = w[at + _U0 * L + i] + (step + _ONE) * w[at + _DU * L + i]
        metres, half = w[at + METRES * L + i], w[at + HALF * L + i]
        along = (u - math.floor(u + _HALF_)) * metres
        edge, flank = half - abs(along), _HALF_ * half
        if edge <= _ZERO:
            continue
        full = w[at + FULL * L + i]
        if kind == _F(2.0):
            angle = 0.5 * math.pi * along / half
            depth, slope = full * math.cos(angle), -full * 0.5 * math.pi / half * math.sin(angle)
        elif edge < flank:
            angle = math.pi * edge / flank
            depth = 0.5 * full * (1.0 - math.cos(angle))
            slope = 0.5 * full * math.pi / flank * math.sin(angle)
            slope = -slope if along > _ZERO else slope
        else:
            depth, slope = full * 1.0, 0.0
        factor = w[_FACTOR * L + i]
        w[at + _TAKEN * L + i] = factor * depth
        w[at + _TAKEN_RATE * L + i] = factor * slope * metres * w[at + _DU * L + i] * per_second


@compiled(inline=True, fast=FAST)
def _contact(c, s, gap, gap_rate, x, y, vx, vy, ux, uy, bx, by, kb, cb):
    """Force of a ball along its direction (c, s) and the rate of that, or zeros."""
    delta = x * c + y * s - gap
    closed = delta if delta > _ZERO else _ZERO
    stiff = kb * np.sqrt(closed)
    force = stiff * closed + cb * (vx * c + vy * s)
    rate = _ONE_HALF * stiff * (ux * c + uy * s - gap_rate) + cb * (bx * c + by * s)
    loaded = (delta > _ZERO) & (force > _ZERO)
    return force if loaded else _ZERO, rate if loaded else _ZERO


@compiled(inline=True, fast=FAST)
def _two_balls(w, balls, j, spalls):
    """Add the forces of balls ``j`` and ``j + 1`` and their rates to the sums."""
    number, following = _F(j), _F(j + 1)
    two = balls[j * BALL_ROWS * L : (j + 2) * BALL_ROWS * L]
    first = SPALLS * L
    for i in range(L):
        c0, s0, gap = w[C * L + i], w[S * L + i], w[_GAP * L + i]
        pc, ps = two[i], two[L + i]
        qc, qs = two[3 * L + i], two[4 * L + i]
        p_gap, q_gap = gap + two[2 * L + i], gap + two[5 * L + i]
        p_rate = q_rate = _ZERO
        if spalls > 0:
            ball = w[first + BALL * L + i]
            taken, taken_rate = w[first + _TAKEN * L + i], w[first + _TAKEN_RATE * L + i]
            p_gap += taken if ball == number else _ZERO
            p_rate += taken_rate if ball == number else _ZERO
            q_gap += taken if ball == following else _ZERO
            q_rate += taken_rate if ball == following else _ZERO
        if spalls > 1:
            for k in range(1, MAX_SPALLS):
                more = first + k * SPALL_ROWS * L
                ball = w[more + BALL * L + i]
                taken, taken_rate = w[more + _TAKEN * L + i], w[more + _TAKEN_RATE * L + i]
                p_gap += taken if ball == number else _ZERO
                p_rate += taken_rate if ball == number else _ZERO
                q_gap += taken if ball == following else _ZERO
                q_rate += taken_rate if ball == following else _ZERO
        x, y, vx, vy = w[_X * L + i], w[_Y * L + i], w[_VX * L + i], w[_VY * L + i]
        ux, uy, bx, by = w[_UX * L + i], w[_UY * L + i], w[_BX * L + i], w[_BY * L + i]
        kb, cb = w[_KB * L + i], w[_CB * L + i]
        c, s = c0 * pc - s0 * ps, s0 * pc + c0 * ps
        force, rate = _contact(c, s, p_gap, p_rate, x, y, vx, vy, ux, uy, bx, by, kb, cb)
        d, t = c0 * qc - s0 * qs, s0 * qc + c0 * qs
        other, change = _contact(d, t, q_gap, q_rate, x, y, vx, vy, ux, uy, bx, by, kb, cb)
        w[_FX * L + i] += force * c + other * d
        w[_FY * L + i] += force * s + other * t
        w[_GX * L + i] += rate * c + change * d
        w[_GY * L + i] += rate * s + change * t


@compiled(fast=FAST)
def _balls(w, balls, n_balls):
    """Add up all balls where there is no spall; ``n_balls`` is even."""
    for j in range(0, n_balls, 2):
        _two_balls(w, balls, j, 0)


@compiled(fast=FAST)
def _balls_over_a_spall(w, balls, n_balls):
    """As `_balls` with one spall a bearing."""
    for j in range(0, n_balls, 2):
        _two_balls(w, balls, j, 1)


@compiled(fast=FAST)
def _balls_over_spalls(w, balls, n_balls):
    """As `_balls` with up to `MAX_SPALLS` spalls a bearing."""
    for j in range(0, n_balls, 2):
        _two_balls(w, balls, j, 2)


@compiled(fast=FAST)
def _react(w):
    """Accelerations and jerks at the predicted state. Small loops: large ones stay scalar."""
    for i in range(L):
        turning = w[_TURNING * L + i]
        fx, fy = w[_FX * L + i], w[_FY * L + i]
        w[_GX * L + i] = w[_GX * L + i] - turning * fy
        w[_GY * L + i] = w[_GY * L + i] + turning * fx
    for i in range(L):
        omega, pull = w[_OMEGA * L + i], w[_PULL * L + i]
        px, py = pull * w[CS * L + i], pull * w[SS * L + i]
        ki, ci, light = w[_KI * L + i], w[_CI * L + i], w[_LIGHT * L + i]
        x, y = w[_QP * L + i], w[(_QP + 1) * L + i] - w[_FOOT * L + i]
        vx, vy = w[_VP * L + i], w[(_VP + 1) * L + i]
        ax, ay = w[_AP * L + i], w[(_AP + 1) * L + i]
        w[_AN * L + i] = (px - w[_FX * L + i] - ki * x - ci * vx) * light
        w[(_AN + 1) * L + i] = (py - w[_FY * L + i] - ki * y - ci * vy) * light
        w[_JN * L + i] = (-omega * py - w[_GX * L + i] - ki * vx - ci * ax) * light
        w[(_JN + 1) * L + i] = (omega * px - w[_GY * L + i] - ki * vy - ci * ay) * light
    for i in range(L):
        ko, co, heavy = w[_KO * L + i], w[_CO * L + i], w[_HEAVY * L + i]
        vx, vy = w[(_VP + 2) * L + i], w[(_VP + 3) * L + i]
        ax, ay = w[(_AP + 2) * L + i], w[(_AP + 3) * L + i]
        w[(_AN + 2) * L + i] = (w[_FX * L + i] - ko * w[(_QP + 2) * L + i] - co * vx) * heavy
        w[(_AN + 3) * L + i] = (w[_FY * L + i] - ko * w[(_QP + 3) * L + i] - co * vy) * heavy
        w[(_JN + 2) * L + i] = (w[_GX * L + i] - ko * vx - co * ax) * heavy
        w[(_JN + 3) * L + i] = (w[_GY * L + i] - ko * vy - co * ay) * heavy


@compiled(inline=True, fast=FAST)
def _weigh(w, row, i, z, v, a, j, a1, j1):
    """One row of the sensor's table; see `filters.resonator`."""
    return (
        (w[row * L + i] * z + w[(row + 1) * L + i] * v)
        + (w[(row + 2) * L + i] * a + w[(row + 3) * L + i] * j)
        + (w[(row + 4) * L + i] * a1 + w[(row + 5) * L + i] * j1)
    )


@compiled(inline=True, fast=FAST)
def _sense(w, axis, h):
    """Sensor along one axis of the housing."""
    for i in range(L):
        a, a1 = w[(_A + 2 + axis) * L + i], w[(_AN + 2 + axis) * L + i]
        j, j1 = h * w[(_J + 2 + axis) * L + i], h * w[(_JN + 2 + axis) * L + i]
        z, v = w[(_ZX + 2 * axis) * L + i], w[(_WX + 2 * axis) * L + i]
        w[(_OUT + axis) * L + i] = _weigh(w, _READ, i, z, v, a, j, a1, j1)
        w[(_ZX + 2 * axis) * L + i] = _weigh(w, _TO_Z, i, z, v, a, j, a1, j1)
        w[(_WX + 2 * axis) * L + i] = _weigh(w, _TO_W, i, z, v, a, j, a1, j1)


@compiled(fast=FAST)
def _sense_both(w, h, raw, at):
    """Sensors of both axes, to the two rows of ``raw`` at the unsigned ``at``."""
    _sense(w, 0, h)
    _sense(w, 1, h)
    for i in range(_ROW):
        raw[at + i] = w[_FROM + i]


@compiled(fast=FAST)
def _correct(w, h):
    """Hermite's corrector."""
    half, twelfth = _HALF_ * h, h * h / _F(12.0)
    for d in range(4):
        for i in range(L):
            a, b = w[(_A + d) * L + i], w[(_AN + d) * L + i]
            v, j = w[(_V + d) * L + i], w[(_JN + d) * L + i]
            faster = v + (half * (a + b) + twelfth * (w[(_J + d) * L + i] - j))
            w[(_Q + d) * L + i] += half * (v + faster) + twelfth * (a - b)
            w[(_V + d) * L + i], w[(_A + d) * L + i], w[(_J + d) * L + i] = faster, b, j


@compiled(fast=FAST)
def _grid_point(w, phases, keys, inputs, growth, index, within, steps, h, spalls):
    """
    Set everything that is constant or linear up to the next grid point.

    ``inputs`` (6, L) are those at the grid point, ``growth`` theirs per step. Speeds are taken at
    the middle of the ``steps`` up to the next grid point.
    """
    for i in range(L):
        hz = inputs[SHAFT_HZ, i] + 0.5 * steps * growth[SHAFT_HZ, i]
        slip = inputs[SLIP, i] + 0.5 * steps * growth[SLIP, i]
        walk = phases[JITTER, i] * normal_pair(index, WALK, keys[i])[0]
        carried = hz * (1.0 - slip)
        turning = phases[FTF_ORDER, i] * carried + walk * math.sqrt(hz)
        rolling = phases[SPIN_ORDER, i] / phases[FTF_ORDER, i] * turning
        w[_TURNING * L + i] = _TWO_PI * turning
        w[_OMEGA * L + i] = _TWO_PI * hz
        w[_PULL * L + i] = w[_UNBALANCE * L + i] * (_TWO_PI * hz) ** 2
        for row, quantity in ((_KB0, K_B), (_DEPTH0, DEPTH), (_GAP0, CLEARANCE), (_FOOT0, SPRING)):
            w[row * L + i] = inputs[quantity, i]
            w[(row + 1) * L + i] = growth[quantity, i]
        cage, shaft, spin = phases[CAGE, i], phases[SHAFT, i], phases[SPIN, i]
        for row, phase, speed in ((C, cage, turning), (CS, shaft, hz)):
            if within == 0 and index % _REFRESH == 0:
                w[row * L + i] = math.cos(_TWO_PI * phase)
                w[(row + 1) * L + i] = math.sin(_TWO_PI * phase)
            angle = _TWO_PI * h * speed  # up to 0.07 rad
            square = angle * angle
            w[(row + 2) * L + i] = 1.0 - square * (0.5 - square / 24.0)
            w[(row + 3) * L + i] = angle * (1.0 - square * (1.0 / 6.0 - square / 120.0))
        for k in range(spalls):
            at = (SPALLS + k * SPALL_ROWS) * L
            row = FIRST_ANGLE + 4 * k
            by_cage, by_shaft, by_spin = phases[row + 1, i], phases[row + 2, i], phases[row + 3, i]
            phase = by_cage * cage + by_shaft * shaft + by_spin * spin - phases[row, i]
            speed = by_cage * turning + by_shaft * hz + by_spin * rolling
            scale = w[at + U_SCALE * L + i]
            w[at + _U0 * L + i] = scale * (phase - math.floor(phase))
            w[at + _DU * L + i] = scale * speed * h
        phases[PHASE_ROWS, i], phases[PHASE_ROWS + 1, i] = turning, hz
        phases[PHASE_ROWS + 2, i] = rolling


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
def _decimate(tile, raw, taps, oversample, level, keys, first, count):
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


@compiled()
def advance_group(
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
        _grid_point(
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
            _prescribe(w, number)
            if spalls > 0:
                _spoil_first(w, number, per_second)
            for k in range(1, spalls):
                _spoil(w, k, number, per_second)
            if smooth:
                for k in range(spalls):
                    _spoil_smooth(w, k, number, per_second)
            _predict(w, step_size)
            if spalls > 1:
                _balls_over_spalls(w, balls, n_balls)
            elif spalls > 0:
                _balls_over_a_spall(w, balls, n_balls)
            else:
                _balls(w, balls, n_balls)
            _react(w)
            sample, phase = divmod(step - begin, oversample)
            at = phase * stride + memory + sample * 2 * L
            _sense_both(w, step_size, raw, np.uint64(at))
            _correct(w, step_size)
        _decimate(tile, raw, taps, oversample, level, keys, first + done, count)
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
