# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take records; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""Prescribed kinematics of a group of a fleet: shafts and cages turn, defects pass."""

from __future__ import annotations

import math

from bearing_twin.dynamics.coefficients import CLEARANCE, DEPTH, K_B, SHAFT_HZ, SLIP, SPRING
from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.fleet_layout import WAVE_STEPS
from bearing_twin.dynamics.layout import SPIN_TURNS
from bearing_twin.dynamics.model import defect_path
from bearing_twin.dynamics.random import normal_pairs, WALK
from bearing_twin.dynamics.vector import (
    chosen,
    floor,
    L,
    load,
    load_words,
    sines,
    splat,
    store,
)
from bearing_twin.dynamics.waviness import look_up, Surfaces
import numpy as np

__all__ = ['first_slot', 'grid_point', 'look_up_waves', 'open_gap', 'wrap_phases']

_NOWHERE = 1e4
"""Number of no slot."""
_F = np.float32
_HALF = _F(0.5)
_TWO_PI = 2.0 * math.pi


@compiled(inline=True)
def first_slot(cage: float, n_balls: float, load: float) -> float:
    """Ball of slot 0, at a cage angle and a direction of the load in turns."""
    before = math.floor((load - cage) * n_balls)
    return before - n_balls * math.floor(before / n_balls)


@compiled(inline=True)
def _negative_number(ball, first, n_balls):
    """Negative number of the slot of a ball, where ``first`` is the ball of slot 0."""
    number = ball - first
    number += n_balls if number < 0.0 else 0.0
    return n_balls - number if 2.0 * number > n_balls else -number


@compiled(inline=True, fast=FAST)
def open_gap(group, spall, now, factor):
    """Find which slot a spall has under it, what it takes from the contact and at what rate."""
    passed = load(spall.passed, 0) + now * load(spall.growth, 0)
    nearest = floor(passed + _HALF)
    turns = floor((nearest + _F(0.25)) * load(group.per_ball, 0) + _HALF)
    beyond = nearest - load(group.n_balls, 0) * turns
    slot = load(spall.fixed, 0) + load(spall.on_race, 0) * beyond
    there = (slot >= load(spall.low, 0)) & (load(spall.high, 0) >= slot)
    store(spall.slot, 0, chosen(there, slot, splat(_F(_NOWHERE))))
    curvature = chosen(nearest == _F(1.0), load(spall.odd, 0), load(spall.even, 0))
    sunk, slope = defect_path(
        load(spall.profile, 0), load(spall.half, 0), load(spall.depth, 0), curvature,
        (passed - nearest) * load(spall.metres, 0),
    )  # fmt: skip
    store(spall.taken, 0, factor * sunk)
    store(spall.taken_rate, 0, factor * slope * load(spall.speed, 0))


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
    Set everything that is constant or linear up to the next grid point.

    ``inputs`` (6, L) are those at the grid point, ``growth`` theirs per step. Speeds are taken at
    the middle of the ``steps`` up to the next grid point.
    """
    g = group
    store(g.walk, 0, normal_pairs(index, WALK, load_words(g.seed))[0])
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
        turning = g.ftf_order[i] * carried + walk * math.sqrt(hz)
        rolling = g.spin_order[i] / g.ftf_order[i] * turning
        g.turning[i], g.omega[i] = _TWO_PI * turning, _TWO_PI * hz
        g.pull[i] = g.unbalance[i] * (_TWO_PI * hz) ** 2
        g.k_b[0, i], g.k_b[1, i] = inputs[K_B, i], growth[K_B, i]
        g.depth[0, i], g.depth[1, i] = inputs[DEPTH, i], growth[DEPTH, i]
        g.gap[0, i], g.gap[1, i] = inputs[CLEARANCE, i], growth[CLEARANCE, i]
        spring, rise = inputs[SPRING, i], growth[SPRING, i]
        g.foot_x[0, i], g.foot_x[1, i] = g.up_x[i] * spring + g.aside_x[i], g.up_x[i] * rise
        g.foot_y[0, i], g.foot_y[1, i] = g.up_y[i] * spring + g.aside_y[i], g.up_y[i] * rise
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
def look_up_waves(group, tables, first_step, last_step, h, balls, found, waves):
    """
    Fill ``waves`` with what waviness takes from the contacts, m, and at what rate, m/s.

    At every `WAVE_STEPS` steps after the grid point, about those from ``first_step`` to
    ``last_step``. ``tables`` are those of the lanes; ``balls`` and ``found`` are to work in.
    """
    g, rates_from = group, found.shape[2] // 2
    begin, end = first_step // WAVE_STEPS, (last_step - 1) // WAVE_STEPS + 2
    for i in range(L):
        n = int(g.n_balls[i])
        first = int(first_slot(g.cage[i], n * 1.0, g.load_turns[i]))
        for slot in range(n):
            ball = first + (slot + 1) // 2 if slot % 2 else first - slot // 2
            balls[slot, i] = ball + n if ball < 0 else (ball - n if ball >= n else ball)
        if g.outer_cells[i] == 0:
            continue
        room = found[i, 0]
        surfaces = Surfaces(
            tables[i], g.width[i], g.outer_cells[i], g.inner_cells[i], g.ball_cells[i], room, 0.0
        )
        cage, shaft, spin = g.cage[i], g.shaft[i], g.spin[i]
        rates = g.cage_hz[i], g.shaft_hz[i], g.spin_hz[i]
        for k in range(begin, end):
            time = k * WAVE_STEPS * h
            phases = cage + time * rates[0], shaft + time * rates[1], spin + time * rates[2]
            look_up(surfaces, n, phases, rates, found[i, k])
    for k in range(begin, end):
        for slot in range(g.balls_in):
            for i in range(L):
                ball = balls[slot, i]
                waves[k, slot, 0, i] = found[i, k, ball]
                waves[k, slot, 1, i] = found[i, k, rates_from + ball]


@compiled(inline=True)
def _small_sines(angle):
    """Cosine and sine of an angle up to 0.07 rad."""
    square = angle * angle
    c = 1.0 - square * (0.5 - square / 24.0)
    return c, angle * (1.0 - square * (1.0 / 6.0 - square / 120.0))


@compiled()
def wrap_phases(group, seconds):
    """Let the phases go on to the next grid point, ``seconds`` after the last one."""
    g = group
    for i in range(L):
        cage = g.cage[i] + seconds * g.cage_hz[i]
        shaft = g.shaft[i] + seconds * g.shaft_hz[i]
        spin = g.spin[i] + seconds * g.spin_hz[i]
        g.cage[i], g.shaft[i] = cage - math.floor(cage), shaft - math.floor(shaft)
        g.spin[i] = spin - SPIN_TURNS * math.floor(spin / SPIN_TURNS)
