# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
What is prescribed and not felt: shaft, cage and balls turn, and defects pass under the balls.

All of it is known before the equations of motion are solved, the instants included at which the
path of a ball through a defect has a kink.
"""

from __future__ import annotations

import math

from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.laws import CLEARANCE, DEPTH, K_B, SHAFT_HZ, SLIP, SPRING
from bearing_twin.dynamics.layout import (
    ANGLE,
    BALL,
    BALL_COS,
    BALL_SIN,
    CAGE,
    CAGE_COS,
    CAGE_SIN,
    COS,
    D_BALL,
    FOOT,
    FTF_ORDER,
    FULL_DEPTH,
    GAP,
    GAP_RATE,
    HALF,
    KINK_INNER,
    KINK_OUTER,
    LANES,
    PATH_INNER,
    PATH_OUTER,
    PHASE,
    PLACE,
    PROFILE,
    PULL,
    R_INNER,
    R_OUTER,
    SHAFT,
    SHAFT_COS,
    SHAFT_SIN,
    SIN,
    SINES,
    SPEED,
    SPIN,
    SPIN_ORDER,
    STEP,
    STIFF,
    TURNING,
    UNBALANCE,
    UNDERSIZE,
)  # fmt: skip

__all__ = ['kinks', 'path', 'prescribe', 'refresh', 'spoil', 'stand', 'turn']

_TWO_PI = 2.0 * math.pi
_SHORTEST_KINK = 1e-9
"""Kinks closer to the ends of a step than this part of it are none, nor are nearly equal ones."""


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
def _under(n_balls, phases, rates, const, defects, i):
    """
    Find what is next to defect ``i``.

    Returns the ball, how far along the race it is from the centre (m), its speed there (m/s), and
    whether it is on the inner race.
    """
    place = defects[i, PLACE]
    if place == 2.0:
        phase = 2.0 * (phases[2] - defects[i, ANGLE])
        nearest = math.floor(phase + 0.5)
        metres = math.pi * const[D_BALL]
        inside = nearest - 2.0 * math.floor(0.5 * nearest) == 0.0
        return int(defects[i, BALL]), 0.5 * (phase - nearest) * metres, rates[2] * metres, inside
    inside = place == 0.0
    phase = phases[0] - defects[i, ANGLE]
    speed = rates[0]
    if inside:
        phase -= phases[1]
        speed -= rates[1]
    nearest = math.floor(phase * n_balls + 0.5)
    metres = _TWO_PI * (const[R_INNER] if inside else const[R_OUTER])
    return int(-nearest) % n_balls, (phase - nearest / n_balls) * metres, speed * metres, inside


@compiled(inline=True, fast=FAST)
def spoil(n_balls, phases, rates, factor, const, defects, gaps, row):
    """
    Add to ``gaps[row]`` what the defects take away, m, and its rate, m/s.

    ``phases`` and ``rates`` are those of cage, shaft and ball spin, turns and turns/s.
    """
    for i in range(defects.shape[0]):
        ball, along, speed, inside = _under(n_balls, phases, rates, const, defects, i)
        half = defects[i, HALF]
        if abs(along) < half and (defects[i, PLACE] != 3.0 or ball == int(defects[i, BALL])):
            curvature = defects[i, PATH_INNER] if inside else defects[i, PATH_OUTER]
            depth, slope = path(
                defects[i, PROFILE], half, defects[i, FULL_DEPTH], curvature, along
            )
            gaps[row, GAP, ball] += factor * depth
            gaps[row, GAP_RATE, ball] += factor * slope * speed


@compiled(inline=True, fast=FAST)
def _kinked(n_balls, phases, rates, h, const, defects):
    """Return the balls, one bit each, that pass a kink in the step that ends at ``phases``."""
    balls = 0
    for i in range(defects.shape[0]):
        ball, along, speed, inside = _under(n_balls, phases, rates, const, defects, i)
        half, before = defects[i, HALF], along - speed * h
        if min(abs(along), abs(before)) > half and along * before > 0.0:
            continue
        other = defects[i, KINK_INNER] if inside else defects[i, KINK_OUTER]
        passed = (along - half) * (before - half) <= 0.0
        passed |= (along + half) * (before + half) <= 0.0
        passed |= (along - other) * (before - other) <= 0.0
        passed |= other >= 0.0 and (along + other) * (before + other) <= 0.0
        if passed:
            balls |= 1 << min(ball, 62)
    return balls


@compiled(fast=FAST, borrows=True)
def kinks(n_balls, phases, rates, h, const, defects, times):
    """
    Fill ``times`` with the instants, in s and in order, at which a step meets a kink.

    ``phases`` are those at the start of the step. Returns how many there are, at most the length
    of ``times``.
    """
    found = 0
    ends = (phases[0] + h * rates[0], phases[1] + h * rates[1], phases[2] + h * rates[2])
    for i in range(defects.shape[0]):
        _, along, speed, inside = _under(n_balls, ends, rates, const, defects, i)
        other = defects[i, KINK_INNER] if inside else defects[i, KINK_OUTER]
        for at in (defects[i, HALF], -defects[i, HALF], other, -other):
            if speed == 0.0 or abs(at) > defects[i, HALF]:
                continue
            time = h + (at - along) / speed
            if not _SHORTEST_KINK * h < time < (1.0 - _SHORTEST_KINK) * h:
                continue
            if found == times.shape[0]:
                break
            k = found
            while k > 0 and times[k - 1] >= time:
                k -= 1
            if k < found and times[k] == time:
                continue
            for later in range(found, k, -1):
                times[later] = times[later - 1]
            times[k] = time
            found += 1
    return found


@compiled(inline=True, fast=FAST)
def prescribe(table, i, omega, stiff, foot, sines, turning, unbalance):
    """Fill one row of the table of what is prescribed; ``sines`` of the shaft."""
    pull = unbalance * omega * omega
    table[i, TURNING], table[i, STIFF], table[i, FOOT] = _TWO_PI * turning, stiff, foot
    table[i, PULL], table[i, PULL + 1] = pull * sines[0], pull * sines[1]
    table[i, PULL + 2], table[i, PULL + 3] = -pull * omega * sines[1], pull * omega * sines[0]


@compiled(inline=True, fast=FAST)
def _place_balls(clearance, c, s, balls, gaps, i):
    """Directions and gaps of all balls of a cage at (c, s), without defects."""
    for group in range(0, balls.shape[1], LANES):
        for lane in range(LANES):
            k = group + lane
            gaps[i, GAP, k] = clearance + balls[UNDERSIZE, k]
            gaps[i, GAP_RATE, k] = 0.0
            gaps[i, COS, k] = c * balls[BALL_COS, k] - s * balls[BALL_SIN, k]
            gaps[i, SIN, k] = s * balls[BALL_COS, k] + c * balls[BALL_SIN, k]


@compiled(fast=FAST, borrows=True)
def turn(state, const, defects, balls, base, step, n_balls, walk, begin, table, gaps, kinked):
    """
    Turn shaft, cage and balls through a chunk of steps.

    Fills the rows ``begin`` onwards of ``table`` and ``gaps``, and in ``kinked`` the balls whose
    path has a kink within the step. The inputs at the end of step i are ``base + (i + 1) step``;
    i counts from the grid point, whatever ``begin`` is.
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
        table[i, SPEED], table[i, SPEED + 1], table[i, SPEED + 2] = turning, hz, rolling
        table[i, PHASE], table[i, PHASE + 1], table[i, PHASE + 2] = cage, shaft, spin
        table[i, SINES], table[i, SINES + 1] = c, s
        table[i, SINES + 2], table[i, SINES + 3] = cs, ss
        cage += h * turning
        shaft += h * hz
        spin += h * rolling
        c, s = _rotate(c, s, _TWO_PI * h * turning)
        cs, ss = _rotate(cs, ss, _TWO_PI * h * hz)
        _place_balls(base[CLEARANCE] + step[CLEARANCE] * end, c, s, balls, gaps, i)
        phases, rates = (cage, shaft, spin), (turning, hz, rolling)
        depth = base[DEPTH] + step[DEPTH] * end
        spoil(n_balls, phases, rates, depth, const, defects, gaps, i)
        kinked[i] = _kinked(n_balls, phases, rates, h, const, defects)
        omega = _TWO_PI * (base[SHAFT_HZ] + step[SHAFT_HZ] * end)
        prescribe(
            table, i, omega, base[K_B] + step[K_B] * end, base[SPRING] + step[SPRING] * end,
            (cs, ss), turning, const[UNBALANCE],
        )  # fmt: skip
    state[CAGE], state[SHAFT], state[SPIN] = cage, shaft, spin
    state[CAGE_COS], state[CAGE_SIN] = c, s
    state[SHAFT_COS], state[SHAFT_SIN] = cs, ss


@compiled(fast=FAST, borrows=True)
def stand(time, aside, table, i, number, const, defects, balls, base, step, n_balls, row, gaps):
    """
    Fill ``row`` and ``gaps`` (one row each) ``time`` seconds into step ``i`` of ``table``.

    ``number`` counts the step from the grid point. The defects are taken ``aside`` seconds later,
    which decides on which side of a kink they are seen.
    """
    turning, hz, rolling = table[i, SPEED], table[i, SPEED + 1], table[i, SPEED + 2]
    at = number + time / const[STEP]
    c, s = _rotate(table[i, SINES], table[i, SINES + 1], _TWO_PI * time * turning)
    sines = _rotate(table[i, SINES + 2], table[i, SINES + 3], _TWO_PI * time * hz)
    _place_balls(base[CLEARANCE] + step[CLEARANCE] * at, c, s, balls, gaps, 0)
    seen = time + aside
    phases = (
        table[i, PHASE] + seen * turning,
        table[i, PHASE + 1] + seen * hz,
        table[i, PHASE + 2] + seen * rolling,
    )
    depth = base[DEPTH] + step[DEPTH] * at
    spoil(n_balls, phases, (turning, hz, rolling), depth, const, defects, gaps, 0)
    prescribe(
        row, 0, _TWO_PI * (base[SHAFT_HZ] + step[SHAFT_HZ] * at), base[K_B] + step[K_B] * at,
        base[SPRING] + step[SPRING] * at, sines, turning, const[UNBALANCE],
    )  # fmt: skip


@compiled(inline=True, fast=FAST)
def _rotate(c, s, angle):
    """Rotate (cos, sin) by a small angle, up to 0.15 rad."""
    square = angle * angle
    cd = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0)))
    sd = angle * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0 - square / 5040.0)))
    return c * cd - s * sd, s * cd + c * sd


@compiled(borrows=True)
def refresh(state):
    """Wrap the phases to 0..1 and compute the sines that follow from them."""
    for at in (CAGE, SHAFT, SPIN):
        state[at] -= math.floor(state[at])
    state[CAGE_COS] = math.cos(_TWO_PI * state[CAGE])
    state[CAGE_SIN] = math.sin(_TWO_PI * state[CAGE])
    state[SHAFT_COS] = math.cos(_TWO_PI * state[SHAFT])
    state[SHAFT_SIN] = math.sin(_TWO_PI * state[SHAFT])
