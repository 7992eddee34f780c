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
    CD,
    CS,
    CSD,
    DEPTH0,
    DEPTH1,
    DU,
    EVEN,
    FACTOR,
    FIRST_ANGLE,
    FIXED,
    FOOT,
    FOOT0,
    FOOT1,
    FTF_ORDER,
    FULL,
    GAP,
    GAP0,
    GAP1,
    HALF,
    JITTER,
    KB,
    KB0,
    KB1,
    KIND,
    L,
    METRES,
    N_BALLS,
    ODD,
    OMEGA,
    ONLY,
    PHASE_ROWS,
    PULL,
    S,
    SD,
    SHAFT,
    SPALL_ROWS,
    SPALLS,
    SPIN,
    SPIN_ORDER,
    SS,
    SSD,
    TAKEN,
    TAKEN_RATE,
    TURNING,
    U0,
    U_SCALE,
    UNBALANCE,
)
from bearing_twin.dynamics.laws import CLEARANCE, DEPTH, K_B, SHAFT_HZ, SLIP, SPRING
from bearing_twin.dynamics.random import normal_pair, WALK
import numpy as np

__all__ = ['grid_point', 'prescribe', 'spoil', 'spoil_first', 'spoil_smooth']

_REFRESH = 4
"""Grid points after which the rotated sines are computed anew."""

_F = np.float32
_ZERO, _ONE, _HALF_ = _F(0.0), _F(1.0), _F(0.5)
_TWO_PI = 2.0 * math.pi


@compiled(fast=FAST)
def prescribe(w, step):
    """Turn the cage and the shaft by one step and evaluate the ramps at its end."""
    end = step + _ONE
    for i in range(L):
        c, s = w[C * L + i], w[S * L + i]
        w[C * L + i] = c * w[CD * L + i] - s * w[SD * L + i]
        w[S * L + i] = s * w[CD * L + i] + c * w[SD * L + i]
        c, s = w[CS * L + i], w[SS * L + i]
        w[CS * L + i] = c * w[CSD * L + i] - s * w[SSD * L + i]
        w[SS * L + i] = s * w[CSD * L + i] + c * w[SSD * L + i]
        w[KB * L + i] = w[KB0 * L + i] + end * w[KB1 * L + i]
        w[FACTOR * L + i] = w[DEPTH0 * L + i] + end * w[DEPTH1 * L + i]
        w[GAP * L + i] = w[GAP0 * L + i] + end * w[GAP1 * L + i]
        w[FOOT * L + i] = w[FOOT0 * L + i] + end * w[FOOT1 * L + i]


@compiled(inline=True, fast=FAST)
def spoil(w, spall, step, per_second):
    """Which ball a spall has under it, what it takes from the contact and at what rate."""
    at = (SPALLS + spall * SPALL_ROWS) * L
    end = step + _ONE
    for i in range(L):
        # Loads first: a load behind a condition would keep the loop scalar.
        n_balls, fixed, metres = w[N_BALLS * L + i], w[at + FIXED * L + i], w[at + METRES * L + i]
        only = w[at + ONLY * L + i]
        even, odd = w[at + EVEN * L + i], w[at + ODD * L + i]
        half, full, factor = w[at + HALF * L + i], w[at + FULL * L + i], w[FACTOR * L + i]
        growth = w[at + DU * L + i]
        u = w[at + U0 * L + i] + end * growth
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
        w[at + TAKEN * L + i] = factor * depth if inside else _ZERO
        rate = factor * slope * metres * growth * per_second
        w[at + TAKEN_RATE * L + i] = rate if inside else _ZERO


@compiled(fast=FAST)
def spoil_first(w, step, per_second):
    """`spoil` of slot 0, whose rows the compiler knows: nearly all fleets have no other."""
    spoil(w, 0, step, per_second)


@compiled(fast=FAST)
def spoil_smooth(w, spall, step, per_second):
    """As `spoil` for the profiles with a cosine, one lane after the other."""
    at = (SPALLS + spall * SPALL_ROWS) * L
    for i in range(L):
        kind = w[at + KIND * L + i]
        if kind < _F(2.0):
            continue
        u = w[at + U0 * L + i] + (step + _ONE) * w[at + DU * L + i]
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
        factor = w[FACTOR * L + i]
        w[at + TAKEN * L + i] = factor * depth
        w[at + TAKEN_RATE * L + i] = factor * slope * metres * w[at + DU * L + i] * per_second


@compiled(fast=FAST)
def grid_point(w, phases, keys, inputs, growth, index, within, steps, h, spalls):
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
        w[TURNING * L + i] = _TWO_PI * turning
        w[OMEGA * L + i] = _TWO_PI * hz
        w[PULL * L + i] = w[UNBALANCE * L + i] * (_TWO_PI * hz) ** 2
        for row, quantity in ((KB0, K_B), (DEPTH0, DEPTH), (GAP0, CLEARANCE), (FOOT0, SPRING)):
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
            w[at + U0 * L + i] = scale * (phase - math.floor(phase))
            w[at + DU * L + i] = scale * speed * h
        phases[PHASE_ROWS, i], phases[PHASE_ROWS + 1, i] = turning, hz
        phases[PHASE_ROWS + 2, i] = rolling
