# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Hermite's scheme of order 4 and the forces of the balls, for a group of a fleet.

All lanes take every branch, so the contact is written with selections. Balls that cannot be loaded
in any lane are passed over: mostly the half on the side away from the load.
"""

from __future__ import annotations

from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.fleet_layout import (
    A,
    BALL_ROWS,
    C,
    CB,
    CI,
    CO,
    DEPTH0,
    DEPTH1,
    FOOT0,
    FOOT1,
    GAP0,
    GAP1,
    HEAVY,
    J,
    KB0,
    KB1,
    KI,
    KO,
    LIGHT,
    OMEGA,
    PULL,
    Q,
    SENSOR,
    SLOT,
    SPALL_ROWS,
    SPALLS,
    TAKEN,
    TAKEN_RATE,
    TURN,
    TURNING,
    V,
)
from bearing_twin.dynamics.fleet_signal import sense
from bearing_twin.dynamics.fleet_turning import spoil, spoil_smooth
from bearing_twin.dynamics.hermite import correct, taylor, ZERO
from bearing_twin.dynamics.vector import any_of, chosen, load, magnitude, root, splat, store
import numpy as np

__all__ = ['advance']

_F = np.float32
_ZERO = _F(0.0)


@compiled(inline=True, fast=FAST)
def _at(w, row):
    return load(w, row), load(w, row + 1), load(w, row + 2), load(w, row + 3)


@compiled(inline=True, fast=FAST)
def _keep(w, row, values):
    for d in range(4):
        store(w, row + d, values[d])


@compiled(inline=True, fast=FAST)
def _few_are_enough(balls, few, c0, s0, x, y, gap):
    """Whether no ball from slot ``few`` on touches: the next on each side are the nearest."""
    left, right = few * BALL_ROWS, (few + 1) * BALL_ROWS
    low = s0 * load(balls, left) + c0 * load(balls, left + 1)
    high = s0 * load(balls, right) + c0 * load(balls, right + 1)
    least = chosen(low > high, high, low)
    # The sine of all others is at least that, their cosine at most one.
    reach = chosen(y > _ZERO, y, y * least)
    return not any_of(magnitude(x) + reach > gap)


@compiled(inline=True, fast=FAST)
def _contact(w, balls, n_balls, spalls, c0, s0, gap, kb, turning, q, v, a):
    """Force of the balls on the outer ring, N, and its rate, N/s."""
    x, y, vx, vy = q[0] - q[2], q[1] - q[3], v[0] - v[2], v[1] - v[3]
    ax, ay = a[0] - a[2], a[1] - a[3]
    # Velocity and acceleration as seen from the cage.
    ux, uy = vx + turning * y, vy - turning * x
    bx, by = ax + turning * vy, ay - turning * vx
    cb, three_halves = load(w, CB), _F(1.5) * kb
    nought = splat(_ZERO)
    fx, fy, gx, gy = nought, nought, nought, nought
    for j in range(n_balls):
        pc, ps = load(balls, j * BALL_ROWS), load(balls, j * BALL_ROWS + 1)
        number = load(balls, j * BALL_ROWS + 2)
        c, s = c0 * pc - s0 * ps, s0 * pc + c0 * ps
        delta, closing = x * c + y * s - gap, ux * c + uy * s
        for k in range(spalls):
            at = SPALLS + k * SPALL_ROWS
            under = load(w, at + SLOT) == number
            delta = chosen(under, delta - load(w, at + TAKEN), delta)
            closing = chosen(under, closing - load(w, at + TAKEN_RATE), closing)
        touches = delta > nought
        closed = chosen(touches, delta, nought)
        deep = root(closed)
        force = kb * deep * closed + cb * (vx * c + vy * s)
        rate = three_halves * deep * closing + cb * (bx * c + by * s)
        loaded = touches & (force > nought)
        force, rate = chosen(loaded, force, nought), chosen(loaded, rate, nought)
        fx, fy, gx, gy = fx + force * c, fy + force * s, gx + rate * c, gy + rate * s
    return fx, fy, gx - turning * fy, gy + turning * fx


@compiled(inline=True, fast=FAST)
def _rings(w, cs, ss, foot, fx, fy, gx, gy, q, v, a):
    """Acceleration and jerk of both rings under the balls' force and its rate."""
    omega, pull = load(w, OMEGA), load(w, PULL)
    px, py = pull * cs, pull * ss
    ki, ci, light = load(w, KI), load(w, CI), load(w, LIGHT)
    ko, co, heavy = load(w, KO), load(w, CO), load(w, HEAVY)
    return (
        (
            (px - fx - ki * q[0] - ci * v[0]) * light,
            (py - fy - ki * (q[1] - foot) - ci * v[1]) * light,
            (fx - ko * q[2] - co * v[2]) * heavy,
            (fy - ko * q[3] - co * v[3]) * heavy,
        ),
        (
            (-omega * py - gx - ki * v[0] - ci * a[0]) * light,
            (omega * px - gy - ki * v[1] - ci * a[1]) * light,
            (gx - ko * v[2] - co * a[2]) * heavy,
            (gy - ko * v[3] - co * a[3]) * heavy,
        ),
    )


@compiled(fast=FAST, borrows=True)
def advance(
    w, balls, n_balls, few, spalls, smooth, first, count, oversample, h, raw, begin, stride
):
    """
    Advance a group by ``count`` output samples, from ``first`` of the chunk on.

    Writes the sensors to ``raw``: two rows a sample, from row ``begin`` on, the internal samples
    of an output sample ``stride`` rows apart.
    """
    per_second = _F(1.0) / h
    q, v, a, j = _at(w, Q), _at(w, V), _at(w, A), _at(w, J)
    zx, wx, zy, wy = _at(w, SENSOR)
    c, s, cs, ss = _at(w, C)
    for sample in range(count):
        for phase in range(oversample):
            now = _F((first + sample) * oversample + phase + 1)
            cd, sd, csd, ssd = _at(w, C + TURN)
            c, s = c * cd - s * sd, s * cd + c * sd
            cs, ss = cs * csd - ss * ssd, ss * csd + cs * ssd
            for k in range(spalls):
                spoil(w, k, now, load(w, DEPTH0) + now * load(w, DEPTH1))
            if smooth:
                for k in range(spalls):
                    spoil_smooth(w, k, now, per_second)
            further, faster, ahead = taylor(h, q, v, a, j, ZERO)
            gap = load(w, GAP0) + now * load(w, GAP1)
            enough = _few_are_enough(
                balls, few, c, s, further[0] - further[2], further[1] - further[3], gap
            )
            fx, fy, gx, gy = _contact(
                w, balls, few if enough else n_balls, spalls, c, s, gap,
                load(w, KB0) + now * load(w, KB1), load(w, TURNING), further, faster, ahead,
            )  # fmt: skip
            foot = load(w, FOOT0) + now * load(w, FOOT1)
            a1, j1 = _rings(w, cs, ss, foot, fx, fy, gx, gy, further, faster, ahead)
            at = begin + phase * stride + 2 * sample
            zx, wx, felt = sense(w, zx, wx, a[2], j[2], a1[2], j1[2])
            store(raw, at, felt)
            zy, wy, felt = sense(w, zy, wy, a[3], j[3], a1[3], j1[3])
            store(raw, at + 1, felt)
            q, v = correct(h, q, v, a, j, a1, j1)
            a, j = a1, j1
    _keep(w, Q, q)
    _keep(w, V, v)
    _keep(w, A, a)
    _keep(w, J, j)
    _keep(w, SENSOR, (zx, wx, zy, wy))
    _keep(w, C, (c, s, cs, ss))
