# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Integrator of a group of a fleet: fourth-order Hermite scheme with the laws of `model`.

All lanes take every branch, so the contact uses selections. Balls that cannot be loaded in any
lane are skipped; these are mostly the half opposite the load.
"""

from __future__ import annotations

from collections import namedtuple
import math
from typing import Any, NamedTuple

from bearing_twin.dynamics.equations.coefficients import CLEARANCE, DEPTH, FOOT_X, FOOT_Y, K_B
from bearing_twin.dynamics.equations.hermite import correct, taylor, ZERO
from bearing_twin.dynamics.equations.layout import CHUNK
from bearing_twin.dynamics.equations.model import Contact, contact_force, ring_motion
from bearing_twin.dynamics.fleet.kinematics import look_up_waves, open_gap
from bearing_twin.dynamics.fleet.layout import BALL_COS, BALL_ROWS, BALL_SIN, NUMBER, WAVE_STEPS
from bearing_twin.dynamics.fleet.signal import sense
from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.vector import any_of, chosen, load, magnitude, splat, store
import numpy as np

_F = np.float32
_ZERO = _F(0.0)


_Machine = namedtuple(
    '_Machine',
    'inner_light inner_stiffness inner_damping outer_light outer_stiffness_x outer_stiffness_y '
    'outer_damping_x outer_damping_y',
)
"""Fields of `layout.MACHINE` that `model.ring_motion` needs, in lanes."""
_Drive = namedtuple('_Drive', 'foot_x foot_y pull_x pull_y pull_rate_x pull_rate_y')
"""Fields of `layout.STEP` that it needs, in lanes."""


class _Waves(NamedTuple):
    """Gaps due to waviness at two instants, for interpolation between them."""

    wavy: Any
    rows: Any
    """Gap (m) and its rate (m/s) of each slot: at the earlier instant from row `begin` on, at the
    later one `stride` rows further."""
    begin: Any
    stride: Any
    share: Any
    """Position of the step between the instants, 0 to 1."""
    seconds: Any
    """Time between the instants, s."""


Surfaces = namedtuple('Surfaces', 'tables begins starts waves')
"""Arguments of `look_up_waves`."""


@compiled(inline=True, fast=FAST)
def _four(rows):
    return load(rows, 0), load(rows, 1), load(rows, 2), load(rows, 3)


@compiled(inline=True, fast=FAST)
def _keep(rows, values):
    for d in range(4):
        store(rows, d, values[d])


@compiled(inline=True, fast=FAST)
def _machine(group):
    return _Machine(
        load(group.inner_light, 0), load(group.inner_stiffness, 0), load(group.inner_damping, 0),
        load(group.outer_light, 0), load(group.outer_stiffness_x, 0),
        load(group.outer_stiffness_y, 0), load(group.outer_damping_x, 0),
        load(group.outer_damping_y, 0),
    )  # fmt: skip


@compiled(inline=True, fast=FAST)
def _drive(group, now, c, s):
    """Return unbalance and spring foot at step ``now``, with the shaft direction (c, s)."""
    omega, pull = load(group.omega, 0), load(group.pull, 0)
    px, py = pull * c, pull * s
    return _Drive(
        _at(group, FOOT_X, now), _at(group, FOOT_Y, now), px, py, -omega * py, omega * px
    )


@compiled(inline=True, fast=FAST)
def _at(group, which, now):
    """Return an input ``now`` steps after the grid point."""
    return load(group.inputs, 2 * which) + now * load(group.inputs, 2 * which + 1)


@compiled(inline=True, fast=FAST)
def _few_are_enough(group, slots, few, c0, s0, x, y, gap):
    """Whether no ball from slot ``few`` on is in contact; the next on each side are nearest."""
    # Rotation to the load's frame.
    up_x, up_y = load(group.up_x, 0), load(group.up_y, 0)
    c0, s0 = up_y * c0 - up_x * s0, up_x * c0 + up_y * s0
    x, y = up_y * x - up_x * y, up_x * x + up_y * y
    left, right = few * BALL_ROWS, (few + 1) * BALL_ROWS
    low = s0 * load(slots, left) + c0 * load(slots, left + 1)
    high = s0 * load(slots, right) + c0 * load(slots, right + 1)
    least = chosen(low > high, high, low)
    # The other balls have at least this sine, and a cosine of at most one.
    reach = chosen(y > _ZERO, y, y * least)
    return not any_of(magnitude(x) + reach > gap)


@compiled(inline=True, fast=FAST)
def _wave(waves, slot):
    """Return gap due to waviness in a slot, m, and its rate, m/s, by cubic interpolation."""
    row = waves.begin + 2 * slot
    here, rate = load(waves.rows, row), load(waves.rows, row + 1)
    row += waves.stride
    there, later = load(waves.rows, row), load(waves.rows, row + 1)
    u, v = waves.share, _F(1.0) - waves.share
    change = there - here
    gap = here + u * u * (_F(1.0) + _F(2.0) * v) * change
    gap += waves.seconds * u * v * (v * rate - u * later)
    steep = _F(6.0) * u * v / waves.seconds
    return gap, steep * change + v * (v - _F(2.0) * u) * rate + u * (u - _F(2.0) * v) * later


@compiled(inline=True, fast=FAST)
def _balls_force(group, slots, waves, parted, n_balls, c0, s0, gap, k_b, q, v, a):
    """
    Return the force of the balls on the outer ring, N, and its rate, N/s.

    If an edge lies within a step (``parted``), the force is the weighted mean of both sides.
    """
    turning = load(group.turning, 0)
    x, y, vx, vy = q[0] - q[2], q[1] - q[3], v[0] - v[2], v[1] - v[3]
    ax, ay = a[0] - a[2], a[1] - a[3]
    # Velocity and acceleration as seen from the cage.
    ux, uy = vx + turning * y, vy - turning * x
    bx, by = ax + turning * vy, ay - turning * vx
    contact = Contact(k_b, load(group.contact_damping, 0))
    zero = splat(_ZERO)
    fx, fy, gx, gy = zero, zero, zero, zero
    for j in range(n_balls):
        pc, ps = load(slots, j * BALL_ROWS + BALL_COS), load(slots, j * BALL_ROWS + BALL_SIN)
        number = load(slots, j * BALL_ROWS + NUMBER)
        c, s = c0 * pc - s0 * ps, s0 * pc + c0 * ps
        delta, closing = x * c + y * s - gap, ux * c + uy * s
        if waves.wavy:
            opened, opening = _wave(waves, j)
            delta, closing = delta - opened, closing - opening
        bare, share = delta, splat(_F(1.0))
        for k in range(group.spalls_in):
            spall = group.spalls[k]
            under, taken = load(spall.slot, 0) == number, load(spall.taken, 0)
            delta = chosen(under, delta - taken, delta)
            closing = chosen(under, closing - load(spall.taken_rate, 0), closing)
            if parted:
                part = load(spall.share, 0)
                bare = chosen(under & (part >= _F(1.0)), bare - taken, bare)
                share = chosen(under, share * part, share)
        speed, acceleration = vx * c + vy * s, bx * c + by * s
        force, rate = _pressed(delta, closing, speed, acceleration, contact)
        if parted:
            beside, change = _pressed(bare, closing, speed, acceleration, contact)
            force, rate = beside + share * (force - beside), change + share * (rate - change)
        fx, fy, gx, gy = fx + force * c, fy + force * s, gx + rate * c, gy + rate * s
    return (fx, fy), (gx - turning * fy, gy + turning * fx)


@compiled(inline=True, fast=FAST)
def _pressed(delta, closing, speed, acceleration, contact):
    """Return `model.contact_force` where the ball is loaded, else zero."""
    zero = splat(_ZERO)
    touches = delta > zero
    force, rate = contact_force(
        chosen(touches, delta, zero), closing, speed, acceleration, contact
    )
    loaded = touches & (force > zero)
    return chosen(loaded, force, zero), chosen(loaded, rate, zero)


@compiled(fast=FAST, borrows=True)
def advance(group, slots, surfaces, first, count, oversample, h, raw, begin, stride):
    """
    Advance a group by ``count`` output samples, from sample ``first`` of the chunk on.

    Writes the sensor samples to ``raw`` from row ``begin`` on: two rows per sample, and a distance
    of ``stride`` rows between the internal samples of an output sample.
    """
    g, n_balls = group, group.balls_in
    few = min(2 * ((n_balls + 3) // 4), n_balls)
    # Slots are assigned to balls at grid points. The first ``few`` hold half of the balls, so that
    # no other ball comes under the load within a quarter of a cage turn.
    if any_of(magnitude(load(g.turning, 0)) > _F(0.5 * math.pi / (CHUNK * oversample * h))):
        few = n_balls
    tables, begins, starts, waves = surfaces
    first_step, last_step = first * oversample, (first + count) * oversample
    rows, known, most_slots = waves.reshape(-1), n_balls, waves.shape[1]
    if g.wavy:
        known = few
        look_up_waves(tables, begins, starts, h, first_step, last_step, 0, few, waves)
    q, v, a, j = _four(g.q), _four(g.v), _four(g.a), _four(g.j)
    zx, wx, zy, wy = _four(g.sensor)
    c, s, cs, ss = _four(g.directions)
    for sample in range(count):
        for phase in range(oversample):
            number = (first + sample) * oversample + phase + 1
            now = _F(number)
            cd, sd, csd, ssd = _four(g.turned)
            c, s = c * cd - s * sd, s * cd + c * sd
            cs, ss = cs * csd - ss * ssd, ss * csd + cs * ssd
            parted = False
            for k in range(g.spalls_in):
                parted |= open_gap(g, g.spalls[k], now, _at(g, DEPTH, now))
            further, faster, ahead = taylor(h, q, v, a, j, ZERO)
            gap = _at(g, CLEARANCE, now)
            enough = _few_are_enough(
                g, slots, few, c, s, further[0] - further[2], further[1] - further[3],
                gap - load(g.highest, 0),
            )  # fmt: skip
            if not enough and known < n_balls:
                look_up_waves(
                    tables, begins, starts, h, first_step, last_step, known, n_balls, waves
                )
                known = n_balls
            before = number // WAVE_STEPS
            passing = _Waves(
                g.wavy, rows, 2 * most_slots * before, 2 * most_slots,
                _F(number - WAVE_STEPS * before) / _F(WAVE_STEPS), _F(WAVE_STEPS) * h,
            )  # fmt: skip
            force, rate = _balls_force(
                g, slots, passing, parted, few if enough else n_balls, c, s, gap, _at(g, K_B, now),
                further, faster, ahead,
            )  # fmt: skip
            a1, j1 = ring_motion(
                _machine(g), _drive(g, now, cs, ss), force, rate, further, faster, ahead
            )
            at = begin + phase * stride + 2 * sample
            zx, wx, felt = sense(g, zx, wx, a[2], j[2], a1[2], j1[2])
            store(raw, at, felt)
            zy, wy, felt = sense(g, zy, wy, a[3], j[3], a1[3], j1[3])
            store(raw, at + 1, felt)
            q, v = correct(h, q, v, a, j, a1, j1)
            a, j = a1, j1
    _keep(g.q, q)
    _keep(g.v, v)
    _keep(g.a, a)
    _keep(g.j, j)
    _keep(g.sensor, (zx, wx, zy, wy))
    _keep(g.directions, (c, s, cs, ss))
