# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take records; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""Prescribed kinematics of a group of a fleet: rotation and passage of the defects."""

from __future__ import annotations

import math

from bearing_twin.dynamics.equations.coefficients import INPUTS, SHAFT_HZ, SLIP
from bearing_twin.dynamics.equations.layout import SPIN_TURNS
from bearing_twin.dynamics.equations.model import defect_path, RECTANGLE
from bearing_twin.dynamics.equations.waviness import gap_at, REPEATED
from bearing_twin.dynamics.fleet.layout import WAVE_STEPS
from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.random import normal_pairs, WALK
from bearing_twin.numerics.vector import (
    any_of,
    chosen,
    fetch_fours,
    floor,
    highest,
    L,
    load,
    magnitude,
    sines,
    splat,
    store,
)
import numpy as np

_LINE = 8
"""Nodes of a table in a line of the cache."""
_NOWHERE = 1e4
"""Slot number that no slot has."""
_STANDING = 1e-12
"""Negligible motion along a defect within a step, m; avoids a division by zero."""
_F = np.float32
_HALF = _F(0.5)
_TWO_PI = 2.0 * math.pi


@compiled(inline=True)
def first_slot(cage: float, n_balls: float, load: float) -> float:
    """Return the ball in slot 0 for a cage angle and a direction of the load, both in turns."""
    before = math.floor((load - cage) * n_balls)
    return before - n_balls * math.floor(before / n_balls)


@compiled(inline=True)
def _negative_number(ball, first, n_balls):
    """Return the negative slot number of a ball; ``first`` is the ball in slot 0."""
    number = ball - first
    number += n_balls if number < 0.0 else 0.0
    return n_balls - number if 2.0 * number > n_balls else -number


@compiled(inline=True, fast=FAST)
def open_gap(group, spall, now, factor):
    """
    Find the slot under a spall, the depth of the ball in it, m, and its rate, m/s.

    Returns whether any lane passes an edge at which the path jumps during this step.
    """
    passed = load(spall.passed, 0) + now * load(spall.growth, 0)
    nearest = floor(passed + _HALF)
    turns = floor((nearest + _F(0.25)) * load(group.per_ball, 0) + _HALF)
    beyond = nearest - load(group.n_balls, 0) * turns
    slot = load(spall.fixed, 0) + load(spall.on_race, 0) * beyond
    there = (slot >= load(spall.low, 0)) & (load(spall.high, 0) >= slot)
    store(spall.slot, 0, chosen(there, slot, splat(_F(_NOWHERE))))
    # A spall on a ball meets both races alternately, several times before the next grid point.
    odd = nearest - _F(2.0) * floor(nearest * _HALF) == _F(1.0)
    curvature = chosen(odd, load(spall.odd, 0), load(spall.even, 0))
    profile, half, depth = load(spall.profile, 0), load(spall.half, 0), load(spall.depth, 0)
    along = (passed - nearest) * load(spall.metres, 0)
    sunk, slope = defect_path(profile, half, depth, curvature, along)
    share, parted = splat(_F(1.0)), False
    jumps = profile == _F(RECTANGLE)
    if any_of(jumps):
        # Fraction of the step centred at ``now`` that lies inside the defect.
        step = magnitude(load(spall.growth, 0) * load(spall.metres, 0)) + _F(_STANDING)
        inside = (half - magnitude(along)) / step + _HALF
        inside = chosen(inside > _F(1.0), splat(_F(1.0)), inside)
        touched = jumps & (inside > _F(0.0))
        sunk, share = chosen(touched, depth, sunk), chosen(touched, inside, share)
        parted = any_of(_F(1.0) > share)
    store(spall.taken, 0, factor * sunk)
    store(spall.taken_rate, 0, factor * slope * load(spall.speed, 0))
    store(spall.share, 0, share)
    return parted


@compiled(inline=True, fast=FAST)
def _sines(turns):
    """Cosine and sine of an angle in turns, to 1e-7."""
    quarter = math.floor(4.0 * turns + 0.5)
    angle = _F((4.0 * turns - quarter) * (0.5 * math.pi))
    c, s = sines(angle)
    which = np.int32(quarter) & np.int32(3)
    odd = (which & np.int32(1)) != 0
    first = s if odd else c
    second = c if odd else s
    first = -first if (which == 1) | (which == 2) else first
    second = -second if which >= 2 else second
    return first, second


@compiled(fast=FAST)
def grid_point(group, inputs, growth, index, within, steps, h):
    """
    Set all values that are constant or linear up to the next grid point.

    ``inputs`` (INPUTS, L) hold at the grid point; ``growth`` is their growth per step. Speeds are
    those in the middle of the ``steps`` up to the next grid point.
    """
    g = group
    store(g.walk, 0, normal_pairs(index, WALK, load(g.seed, 0))[0])
    for i in range(L):
        cage, shaft, spin = g.cage[i], g.shaft[i], g.spin[i]
        n_balls = g.n_balls[i] * 1.0
        first = first_slot(cage, n_balls, g.load_turns[i])
        if within == 0:
            g.directions[0, i], g.directions[1, i] = _sines(cage + first / n_balls)
            g.directions[2, i], g.directions[3, i] = _sines(shaft)
        hz = inputs[SHAFT_HZ, i] + 0.5 * steps * growth[SHAFT_HZ, i]
        slip = inputs[SLIP, i] + 0.5 * steps * growth[SLIP, i]
        walk = g.jitter[i] * g.walk[i]
        carried = hz * (1.0 - slip)
        # A fast ramp that begins late in a chunk extrapolates below zero in its middle.
        turning = g.ftf_order[i] * carried + walk * math.sqrt(abs(hz))
        rolling = g.spin_order[i] / g.ftf_order[i] * turning
        g.turning[i], g.omega[i] = _TWO_PI * turning, _TWO_PI * hz
        g.pull[i] = g.unbalance[i] * (_TWO_PI * hz) ** 2
        for q in range(INPUTS):
            g.inputs[q, 0, i], g.inputs[q, 1, i] = inputs[q, i], growth[q, i]
        g.turned[0, i], g.turned[1, i] = _small_sines(_TWO_PI * h * turning)
        g.turned[2, i], g.turned[3, i] = _small_sines(_TWO_PI * h * hz)
        for k in range(g.spalls_in):
            s = g.spalls[k]
            phase = s.by_cage[i] * cage + s.by_shaft[i] * shaft + s.by_spin[i] * spin - s.angle[i]
            speed = s.by_cage[i] * turning + s.by_shaft[i] * hz + s.by_spin[i] * rolling
            passed = s.scale[i] * (phase - math.floor(phase)) + s.on_race[i] * first
            passed -= s.on_race[i] * n_balls * math.floor(passed / n_balls + 0.5)
            s.passed[i], s.growth[i] = passed, s.scale[i] * speed * h
            s.speed[i] = s.scale[i] * speed * s.metres[i]
            worn = _negative_number(s.only[i] * 1.0, first, n_balls)
            own = _negative_number(s.ball[i] * 1.0, first, n_balls)
            s.fixed[i] = 0.0 if s.on_race[i] > 0.0 else own
            s.low[i] = -_NOWHERE if s.only[i] < 0.0 else worn
            s.high[i] = _NOWHERE - 1.0 if s.only[i] < 0.0 else worn
        g.cage_hz[i], g.shaft_hz[i], g.spin_hz[i] = turning, hz, rolling


@compiled(fast=FAST, borrows=True)
def place_waves(group, stride, h, begins, starts):
    """
    Find the positions of the balls in the tables of `waviness` at the grid point.

    ``stride`` is the table length of a lane. ``begins``, int64[slots, 3, L], receives the first
    indices of the tables of outer race, inner race and ball. ``starts``, float32[11, L], receives
    for each of the three the node under slot 0, the nodes per step and the number of nodes, then
    the nodes between two slots for both races.
    """
    g = group
    for i in range(L):
        n, cage, spin = int(g.n_balls[i]), g.cage[i], g.spin[i] / SPIN_TURNS
        first = int(first_slot(cage, n * 1.0, g.load_turns[i]))
        turn = cage - g.shaft[i] + first / n
        cage += first / n
        outer, inner, track = g.outer_nodes[i], g.inner_nodes[i], g.ball_nodes[i]
        starts[0, i] = (cage - math.floor(cage)) * outer
        starts[1, i] = (turn - math.floor(turn)) * inner
        starts[2, i] = (spin - math.floor(spin)) * track
        starts[3, i] = h * g.cage_hz[i] * outer
        starts[4, i] = h * (g.cage_hz[i] - g.shaft_hz[i]) * inner
        starts[5, i] = h * g.spin_hz[i] / SPIN_TURNS * track
        # Perfect surfaces have one node with a gap of zero.
        starts[6, i], starts[7, i], starts[8, i] = max(outer, 1), max(inner, 1), max(track, 1)
        starts[9, i], starts[10, i] = outer / n, inner / n
        row = i * stride + 2
        on_inner, on_ball = row + 2 * (outer + REPEATED), 2 * (track + REPEATED)
        balls = on_inner + 2 * (inner + REPEATED)
        for slot in range(g.balls_in):
            ball = first + (slot + 1) // 2 if slot % 2 else first - slot // 2
            ball = ball + n if ball < 0 else (ball - n if ball >= n else ball)
            ball = ball if slot < n else 0
            begins[slot, 0, i], begins[slot, 1, i] = row, on_inner
            begins[slot, 2, i] = balls + ball * on_ball


@compiled(fast=FAST, borrows=True)
def look_up_waves(tables, begins, starts, h, first_step, last_step, low, high, waves):
    """
    Fill ``waves`` with the gaps due to waviness, m, and their rates, m/s.

    They are computed for the slots from ``low`` to before ``high``, every `WAVE_STEPS` steps from
    the grid point, so that the steps from ``first_step`` to ``last_step`` are covered. ``tables``
    are those of all lanes.
    """
    begin, end = first_step // WAVE_STEPS, (last_step - 1) // WAVE_STEPS + 2
    room, firsts, into = starts.reshape(-1), begins.reshape(-1), waves.reshape(-1)
    per_step, steps = _F(1.0 / h), _F(last_step - first_step)
    for slot in range(low, high):
        for which in range(3):
            _fetch_next(tables, firsts, room, slot, which, _F(last_step), steps)
        for k in range(begin, end):
            gap, rate = splat(_F(0.0)), splat(_F(0.0))
            for which in range(3):
                at = _node_at(room, slot, which, _F(k * WAVE_STEPS))
                node, speed = floor(at), load(room, 3 + which) * per_step
                more, faster = gap_at(tables, firsts, 3 * slot + which, node, at - node, speed)
                gap, rate = gap + more, rate + faster
            row = 2 * (k * waves.shape[1] + slot)
            store(into, row, gap)
            store(into, row + 1, rate)


@compiled(inline=True, fast=FAST)
def _node_at(room, slot, which, step):
    """Return the place under a ball, in nodes, ``step`` steps from the grid point."""
    nodes, at = load(room, 6 + which), load(room, which) + step * load(room, 3 + which)
    if which < 2:
        at = at + _F((slot + 1) // 2 if slot % 2 else -(slot // 2)) * load(room, 9 + which)
    return at - nodes * floor(at / nodes)


@compiled(inline=True, fast=FAST)
def _fetch_next(tables, begins, room, slot, which, step, steps):
    """Bring the nodes into the cache that a ball will pass from ``step`` on in ``steps`` steps."""
    fastest = highest(magnitude(load(room, 3 + which)))
    lines = int(fastest * steps / _F(_LINE)) + 1
    for k in range(lines + 1):
        at = _node_at(room, slot, which, step + steps * (_F(k) / _F(lines)))
        fetch_fours(tables, begins, 3 * slot + which, at)


@compiled(inline=True)
def _small_sines(angle):
    """Cosine and sine of an angle of at most 0.07 rad."""
    square = angle * angle
    c = 1.0 - square * (0.5 - square / 24.0)
    return c, angle * (1.0 - square * (1.0 / 6.0 - square / 120.0))


@compiled()
def wrap_phases(group, seconds):
    """Advance the phases by ``seconds`` to the next grid point and wrap them."""
    g = group
    for i in range(L):
        cage = g.cage[i] + seconds * g.cage_hz[i]
        shaft = g.shaft[i] + seconds * g.shaft_hz[i]
        spin = g.spin[i] + seconds * g.spin_hz[i]
        g.cage[i], g.shaft[i] = cage - math.floor(cage), shaft - math.floor(shaft)
        g.spin[i] = spin - SPIN_TURNS * math.floor(spin / SPIN_TURNS)
