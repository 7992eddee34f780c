# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and records of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Prescribed kinematics: rotation of shaft, cage and balls, and passage of the defects.

All of it is known before the equations of motion are solved, including the instants at which the
path of a ball through a defect has a kink.
"""

from __future__ import annotations

from collections import namedtuple
import math
from typing import Any, NamedTuple

from bearing_twin.bearing import PLACES
from bearing_twin.dynamics.equations.layout import COS, GAP, GAP_RATE, LANES, SIN, SPIN_TURNS
from bearing_twin.dynamics.equations.model import defect_path
from bearing_twin.dynamics.equations.waviness import look_up_gaps
from bearing_twin.numerics.compiled import compiled, FAST

_TWO_PI = 2.0 * math.pi
_SHORTEST_KINK = 1e-9
"""Kinks closer than this fraction of a step to its ends are ignored."""
_INNER, _BALL, _CAGE = (PLACES.index(place) for place in ('inner', 'ball', 'cage'))


Inputs = namedtuple('Inputs', 'k_b depth clearance shaft_hz slip foot_x foot_y')
"""Inputs of the equations of motion, or their growth per step, in the order of `coefficients`."""


class KernelBearing(NamedTuple):
    """Constants and inputs of one bearing; the inputs hold at the last grid point."""

    machine: Any
    """Record `layout.MACHINE`."""
    defects: Any
    """Records `layout.DEFECT`."""
    balls: Any
    """Undersize and direction in the cage of each ball, float64[4, padded]; rows GAP, COS, SIN."""
    surfaces: Any
    """See `waviness.Surfaces`."""
    inputs: Any
    growth: Any


@compiled(inline=True, fast=FAST)
def _under(machine, defect, phases, rates):
    """
    Find the ball that is nearest to a defect.

    Returns the ball, its distance from the centre of the defect along the race (m), its speed
    there (m/s), and whether the contact is on the inner race.
    """
    if defect.place == _BALL:
        phase = 2.0 * (phases[2] - defect.angle)
        nearest = math.floor(phase + 0.5)
        metres = math.pi * machine.d_ball
        inside = nearest - 2.0 * math.floor(0.5 * nearest) == 0.0
        return defect.ball, 0.5 * (phase - nearest) * metres, rates[2] * metres, inside
    inside = defect.place == _INNER
    phase = phases[0] - defect.angle
    speed = rates[0]
    if inside:
        phase -= phases[1]
        speed -= rates[1]
    n_balls = machine.n_balls
    nearest = math.floor(phase * n_balls + 0.5)
    metres = _TWO_PI * (machine.inner_radius if inside else machine.outer_radius)
    return int(-nearest) % n_balls, (phase - nearest / n_balls) * metres, speed * metres, inside


@compiled(inline=True, fast=FAST)
def open_gaps(bearing, phases, rates, factor, gaps, row):
    """
    Add the depth of the defects under the balls, m, and its rate, m/s, to ``gaps[row]``.

    ``phases`` and ``rates`` are those of cage, shaft and ball spin, turns and turns/s.
    """
    for i in range(bearing.defects.shape[0]):
        defect = bearing.defects[i]
        ball, along, speed, inside = _under(bearing.machine, defect, phases, rates)
        if abs(along) < defect.half and (defect.place != _CAGE or ball == defect.ball):
            curvature = defect.inner_curvature if inside else defect.outer_curvature
            sunk, slope = defect_path(defect.profile, defect.half, defect.depth, curvature, along)
            gaps[row, GAP, ball] += factor * sunk
            gaps[row, GAP_RATE, ball] += factor * slope * speed


@compiled(inline=True, fast=FAST)
def _kinked(bearing, phases, rates):
    """Return a bit mask of the balls that pass a kink in the step that ends at ``phases``."""
    balls = 0
    h = bearing.machine.step
    for i in range(bearing.defects.shape[0]):
        defect = bearing.defects[i]
        ball, along, speed, inside = _under(bearing.machine, defect, phases, rates)
        half, before = defect.half, along - speed * h
        if min(abs(along), abs(before)) > half and along * before > 0.0:
            continue
        other = defect.inner_kink if inside else defect.outer_kink
        passed = (along - half) * (before - half) <= 0.0
        passed |= (along + half) * (before + half) <= 0.0
        passed |= (along - other) * (before - other) <= 0.0
        passed |= other >= 0.0 and (along + other) * (before + other) <= 0.0
        if passed:
            balls |= 1 << min(ball, 62)
    return balls


@compiled(fast=FAST, borrows=True)
def kinks(machine, defects, phases, rates, times):
    """
    Fill ``times`` with the instants, s, at which a ball meets a kink within a step, sorted.

    ``phases`` are those at the start of the step. Returns the number of kinks, at most the length
    of ``times``.
    """
    found = 0
    h = machine.step
    ends = (phases[0] + h * rates[0], phases[1] + h * rates[1], phases[2] + h * rates[2])
    for i in range(defects.shape[0]):
        defect = defects[i]
        _, along, speed, inside = _under(machine, defect, ends, rates)
        other = defect.inner_kink if inside else defect.outer_kink
        for at in (defect.half, -defect.half, other, -other):
            if speed == 0.0 or abs(at) > defect.half:
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
def drive(step, machine, inputs, growth, at, turning, shaft):
    """
    Fill in the values of a `layout.STEP` at its end, ``at`` steps after the inputs.

    ``turning`` is the speed of the cage, turns/s; ``shaft`` is (cos, sin) of the shaft angle.
    """
    omega = _TWO_PI * (inputs.shaft_hz + growth.shaft_hz * at)
    step.turning = _TWO_PI * turning
    step.k_b = inputs.k_b + growth.k_b * at
    step.foot_x = inputs.foot_x + growth.foot_x * at
    step.foot_y = inputs.foot_y + growth.foot_y * at
    pull = machine.unbalance * omega * omega
    step.pull_x, step.pull_y = pull * shaft[0], pull * shaft[1]
    step.pull_rate_x, step.pull_rate_y = -pull * omega * shaft[1], pull * omega * shaft[0]


@compiled(inline=True, fast=FAST)
def place_balls(bearing, clearance, c, s, phases, rates, gaps, i):
    """
    Fill row ``i`` of ``gaps`` for a cage angle with (cos, sin) = (c, s), without defects.

    ``phases`` and ``rates`` are those of cage, shaft and ball spin, turns and turns/s.
    """
    balls, surfaces = bearing.balls, bearing.surfaces
    if surfaces.outer > 0:
        look_up_gaps(surfaces, bearing.machine.n_balls, phases, rates, surfaces.room)
    opened, rates_from = surfaces.room, surfaces.room.shape[0] // 2
    for group in range(0, balls.shape[1], LANES):
        for lane in range(LANES):
            k = group + lane
            gaps[i, GAP, k] = clearance + balls[GAP, k] + opened[k]
            gaps[i, GAP_RATE, k] = opened[rates_from + k]
            gaps[i, COS, k] = c * balls[COS, k] - s * balls[SIN, k]
            gaps[i, SIN, k] = s * balls[COS, k] + c * balls[SIN, k]


@compiled(fast=FAST, borrows=True)
def advance_steps(state, bearing, walk, begin, steps, gaps):
    """
    Rotate shaft, cage and balls through ``steps``, from step ``begin`` after the grid point.

    ``walk`` is the random part of the cage speed, see `tables.machine`.
    """
    machine, inputs, growth = bearing.machine, bearing.inputs, bearing.growth
    h = machine.step
    cage, shaft, spin = state.cage, state.shaft, state.spin
    c, s = state.cage_cos, state.cage_sin
    cs, ss = state.shaft_cos, state.shaft_sin
    # A fast ramp that begins between grid points extrapolates below zero at the grid point.
    wander = walk * math.sqrt(max(inputs.shaft_hz, 0.0))
    spin_per_cage = machine.spin_order / machine.ftf_order  # proportional speeds
    for i in range(steps.shape[0]):
        middle, end = begin + i + 0.5, begin + i + 1.0
        hz = inputs.shaft_hz + growth.shaft_hz * middle
        carried = hz * (1.0 - (inputs.slip + growth.slip * middle))
        turning = machine.ftf_order * carried + wander
        rolling = turning * spin_per_cage
        step = steps[i]
        step.speeds[0], step.speeds[1], step.speeds[2] = turning, hz, rolling
        step.phases[0], step.phases[1], step.phases[2] = cage, shaft, spin
        step.cage_cos, step.cage_sin = c, s
        step.shaft_cos, step.shaft_sin = cs, ss
        cage += h * turning
        shaft += h * hz
        spin += h * rolling
        c, s = _rotate(c, s, _TWO_PI * h * turning)
        cs, ss = _rotate(cs, ss, _TWO_PI * h * hz)
        phases, rates = (cage, shaft, spin), (turning, hz, rolling)
        clearance = inputs.clearance + growth.clearance * end
        place_balls(bearing, clearance, c, s, phases, rates, gaps, i)
        open_gaps(bearing, phases, rates, inputs.depth + growth.depth * end, gaps, i)
        step.kinked = _kinked(bearing, phases, rates)
        drive(step, machine, inputs, growth, end, turning, (cs, ss))
    state.cage, state.shaft, state.spin = cage, shaft, spin
    state.cage_cos, state.cage_sin = c, s
    state.shaft_cos, state.shaft_sin = cs, ss


@compiled(fast=FAST, borrows=True)
def at_time(time, aside, step, number, bearing, here, gaps):
    """
    Fill the step ``here`` and row 0 of ``gaps`` for the instant ``time`` seconds into ``step``.

    ``number`` is the number of ``step`` from the grid point. Defects are evaluated ``aside``
    seconds later, which selects the side of a kink.
    """
    inputs, growth = bearing.inputs, bearing.growth
    turning, hz, rolling = step.speeds[0], step.speeds[1], step.speeds[2]
    at = number + time / bearing.machine.step
    c, s = _rotate(step.cage_cos, step.cage_sin, _TWO_PI * time * turning)
    shaft = _rotate(step.shaft_cos, step.shaft_sin, _TWO_PI * time * hz)
    rates = turning, hz, rolling
    clearance, depth = inputs.clearance + growth.clearance * at, inputs.depth + growth.depth * at
    phases = _after(step.phases, time, rates)
    place_balls(bearing, clearance, c, s, phases, rates, gaps, 0)
    open_gaps(bearing, _after(step.phases, time + aside, rates), rates, depth, gaps, 0)
    drive(here, bearing.machine, inputs, growth, at, turning, shaft)


@compiled(inline=True, fast=FAST)
def _after(phases, seconds, rates):
    return (
        phases[0] + seconds * rates[0],
        phases[1] + seconds * rates[1],
        phases[2] + seconds * rates[2],
    )


@compiled(inline=True, fast=FAST)
def _rotate(c, s, angle):
    """Rotate (cos, sin) by an angle of at most 0.15 rad."""
    square = angle * angle
    cd = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0)))
    sd = angle * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0 - square / 5040.0)))
    return c * cd - s * sd, s * cd + c * sd


@compiled(borrows=True)
def wrap_phases(state):
    """Wrap the phases and compute their sines and cosines."""
    state.cage -= math.floor(state.cage)
    state.shaft -= math.floor(state.shaft)
    state.spin -= SPIN_TURNS * math.floor(state.spin / SPIN_TURNS)
    state.cage_cos = math.cos(_TWO_PI * state.cage)
    state.cage_sin = math.sin(_TWO_PI * state.cage)
    state.shaft_cos = math.cos(_TWO_PI * state.shaft)
    state.shaft_sin = math.sin(_TWO_PI * state.shaft)
