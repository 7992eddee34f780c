# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""What is prescribed and not felt, for a group of a fleet: shafts and cages turn, defects pass."""

from __future__ import annotations

import math

from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.fleet_layout import (
    BALL,
    C,
    CAGE,
    CS,
    DEPTH0,
    DEPTH1,
    DU,
    EVEN,
    FIRST_ANGLE,
    FIXED,
    FOOT0,
    FTF_ORDER,
    FULL,
    GAP0,
    HALF,
    HIGH,
    JITTER,
    KB0,
    KIND,
    LOW,
    METRES,
    N_BALLS,
    ODD,
    OMEGA,
    ONLY,
    PER_BALL,
    PHASE_ROWS,
    PULL,
    RACE,
    S,
    SHAFT,
    SLOT,
    SPALL_ROWS,
    SPALLS,
    SPEED,
    SPIN,
    SPIN_ORDER,
    SS,
    TAKEN,
    TAKEN_RATE,
    TURN,
    TURNING,
    U0,
    U_SCALE,
    UNBALANCE,
    WALK,
)
from bearing_twin.dynamics.laws import CLEARANCE, DEPTH, K_B, SHAFT_HZ, SLIP, SPRING
from bearing_twin.dynamics.random import normal_pairs
from bearing_twin.dynamics.random import WALK as STRAY
from bearing_twin.dynamics.vector import (
    chosen,
    floor,
    L,
    load,
    load_words,
    magnitude,
    sines,
    splat,
    store,
)
import numpy as np

__all__ = ['first_slot', 'grid_point', 'spoil', 'spoil_smooth']

_LOAD = -0.25
"""Direction of the load, turns."""
_NOWHERE = 1e4
"""Number of no slot."""
_F = np.float32
_ZERO, _ONE, _HALF_ = _F(0.0), _F(1.0), _F(0.5)
_TWO_PI = 2.0 * math.pi


@compiled(inline=True)
def first_slot(cage: float, n_balls: float) -> float:
    """Ball of slot 0, at a cage angle in turns."""
    before = math.floor((_LOAD - cage) * n_balls)
    return before - n_balls * math.floor(before / n_balls)


@compiled(inline=True)
def _negative_number(ball, first, n_balls):
    """Negative number of the slot of a ball, where ``first`` is the ball of slot 0."""
    number = ball - first
    number += n_balls if number < 0.0 else 0.0
    return n_balls - number if 2.0 * number > n_balls else -number


@compiled(inline=True, fast=FAST)
def spoil(w, spall, now, factor):
    """Which slot a spall has under it, what it takes from the contact and at what rate."""
    at = SPALLS + spall * SPALL_ROWS
    u = load(w, at + U0) + now * load(w, at + DU)
    nearest = floor(u + _HALF_)
    n_balls = load(w, N_BALLS)
    turns = floor((nearest + _F(0.25)) * load(w, PER_BALL) + _HALF_)
    slot = load(w, at + FIXED) + load(w, at + RACE) * (nearest - n_balls * turns)
    there = (slot >= load(w, at + LOW)) & (load(w, at + HIGH) >= slot)
    store(w, at + SLOT, chosen(there, slot, splat(_F(_NOWHERE))))
    along = (u - nearest) * load(w, at + METRES)
    curvature = chosen(nearest == _ONE, load(w, at + ODD), load(w, at + EVEN))
    edge, full = load(w, at + HALF) - magnitude(along), load(w, at + FULL)
    bend = edge * curvature
    sag = bend * edge
    on_path, inside, nought = full > sag, edge > _ZERO, splat(_ZERO)
    depth = chosen(on_path, sag, full)
    slope = chosen(on_path & inside, bend, nought)
    slope = chosen(along > _ZERO, -slope, slope)
    store(w, at + TAKEN, chosen(inside, factor * depth, nought))
    store(w, at + TAKEN_RATE, factor * slope * load(w, at + SPEED))


@compiled(fast=FAST)
def spoil_smooth(w, spall, now, per_second):
    """As `spoil` for the profiles with a cosine, one lane after the other."""
    at = (SPALLS + spall * SPALL_ROWS) * L
    for i in range(L):
        kind = w[at + KIND * L + i]
        if kind < _F(2.0):
            continue
        u = w[at + U0 * L + i] + now * w[at + DU * L + i]
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
        factor = w[DEPTH0 * L + i] + now * w[DEPTH1 * L + i]
        w[at + TAKEN * L + i] = factor * depth
        w[at + TAKEN_RATE * L + i] = factor * slope * metres * w[at + DU * L + i] * per_second


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
def _turn_to(w, phases):
    """Set the directions of slot 0 and of the shaft."""
    for i in range(L):
        cage, n_balls = phases[CAGE, i], w[N_BALLS * L + i] * 1.0
        slot = cage + first_slot(cage, n_balls) / n_balls
        w[C * L + i], w[S * L + i] = _sines(slot)
        w[CS * L + i], w[SS * L + i] = _sines(phases[SHAFT, i])


@compiled(fast=FAST)
def grid_point(w, phases, keys, inputs, growth, index, within, steps, h, spalls):
    """
    Set everything that is constant or linear up to the next grid point.

    ``inputs`` (6, L) are those at the grid point, ``growth`` theirs per step. Speeds are taken at
    the middle of the ``steps`` up to the next grid point.
    """
    store(w, WALK, normal_pairs(index, STRAY, load_words(keys))[0])
    if within == 0:
        _turn_to(w, phases)
    for i in range(L):
        hz = inputs[SHAFT_HZ, i] + 0.5 * steps * growth[SHAFT_HZ, i]
        slip = inputs[SLIP, i] + 0.5 * steps * growth[SLIP, i]
        walk = phases[JITTER, i] * w[WALK * L + i]
        carried = hz * (1.0 - slip)
        turning = phases[FTF_ORDER, i] * carried + walk * math.sqrt(hz)
        rolling = phases[SPIN_ORDER, i] / phases[FTF_ORDER, i] * turning
        w[TURNING * L + i] = _TWO_PI * turning
        w[OMEGA * L + i] = _TWO_PI * hz
        w[PULL * L + i] = w[UNBALANCE * L + i] * (_TWO_PI * hz) ** 2
        for row, quantity in ((KB0, K_B), (DEPTH0, DEPTH), (GAP0, CLEARANCE), (FOOT0, SPRING)):
            w[row * L + i] = inputs[quantity, i]
            w[(row + 1) * L + i] = growth[quantity, i]
        cage, shaft, spin = phases[CAGE, i], phases[SHAFT, i], phases[SPIN, i]
        n_balls = w[N_BALLS * L + i] * 1.0
        first = first_slot(cage, n_balls)
        for row, speed in ((C, turning), (CS, hz)):
            angle = _TWO_PI * h * speed  # up to 0.07 rad
            square = angle * angle
            w[(row + TURN) * L + i] = 1.0 - square * (0.5 - square / 24.0)
            w[(row + TURN + 1) * L + i] = angle * (1.0 - square * (1.0 / 6.0 - square / 120.0))
        for k in range(spalls):
            at = (SPALLS + k * SPALL_ROWS) * L
            row = FIRST_ANGLE + 4 * k
            by_cage, by_shaft, by_spin = phases[row + 1, i], phases[row + 2, i], phases[row + 3, i]
            phase = by_cage * cage + by_shaft * shaft + by_spin * spin - phases[row, i]
            speed = by_cage * turning + by_shaft * hz + by_spin * rolling
            scale, on_race = w[at + U_SCALE * L + i], w[at + RACE * L + i]
            u = scale * (phase - math.floor(phase)) + on_race * first
            u -= on_race * n_balls * math.floor(u / n_balls + 0.5)
            w[at + U0 * L + i] = u
            w[at + DU * L + i] = scale * speed * h
            w[at + SPEED * L + i] = 2.0 * scale * speed * w[at + METRES * L + i]
            ball, only = w[at + BALL * L + i] * 1.0, w[at + ONLY * L + i] * 1.0
            fixed = 0.0 if on_race > 0.0 else _negative_number(ball, first, n_balls)
            worn = _negative_number(only, first, n_balls)
            w[at + FIXED * L + i] = fixed
            w[at + LOW * L + i] = -_NOWHERE if only < 0.0 else worn
            w[at + HIGH * L + i] = _NOWHERE - 1.0 if only < 0.0 else worn
        phases[PHASE_ROWS, i], phases[PHASE_ROWS + 1, i] = turning, hz
        phases[PHASE_ROWS + 2, i] = rolling
