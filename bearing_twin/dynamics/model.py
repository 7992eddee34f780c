# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The physics: contact law, path of a ball through a defect, motion of the rings.

Each law stands here once. The single bearing, the fleet, the static solver, the reference and the
bearing in three dimensions call these functions, with plain numbers or with `vector.FLOATS`, so
they use only arithmetic and the operations of `vector` that take both.

To replace the contact law edit `contact_law`. To make one selectable, its number goes

- into `parameters.TwinParameters`, `layout.MACHINE` with `tables.machine`, under the same name
  into `fleet_layout.GROUP` (a forgotten name is no error), `coefficients.law_table` and
  `reference._Constants`;
- through the arguments of all that call `contact_law` or `contact_force`, to a branch in
  `contact_law`, as `defect_path` has one for each profile.

What follows the power 1.5 and not `contact_law`:

- the start of Newton's method in `statics.spring_position`, the margin for the unbalance in
  `stability.check_step` and the pieces of a step in `integrator`: they hold for any power near it;
- `life.equivalent_load`, `calibration.passage` and `calibration.estimates`: closed formulas for
  steel on steel, as are the pressure under a ball (force^(1/3)) in `coefficients` and `reference`
  and the unit of K_b, which `bearing.hertz` computes. Another law needs others;
- `view.rerun.bearing3d`: a TwinState has K_b, and no other number of a law;
- the tests and `paper`, on purpose.

`vector` knows roots and no other powers: x**1.25 is x * root(root(x)).

To add a profile:

- its name: `parameters.Profile`, and what it is in the docstring of `parameters.Defect`;
- its code: a constant below, and its place in `CODES`;
- its path: a branch of `defect_path`, and where that path has a kink on
  either side of the centre, at most one, `path_kink`;
- a path that jumps at its edges: `fleet_kinematics.open_gap`, whose steps are not parted there,
  takes it for `RECTANGLE` alone;
- its closed form: `PATHS` in test_model.py, and the error of a fleet: `ERROR` in test_fleets.py;
- its error in docs/realtime.md, and the table: ``python docs/tables.py docs/nodes.md``.

The equations (x right, y up), one line an axis, y shown::

    m_i y_i'' = -F_y - k_i (y_i - y_i0) - c_i y_i' + m_u e omega^2 sin(theta_s)
    m_o y_o'' = +F_y - K_2 y_o - C_2 y_o'      (along x K_1 and C_1)
    delta_j   = (x_i - x_o) cos(theta_j) + (y_i - y_o) sin(theta_j) - c_r - b_j C_d
    F         = sum_j max(K_b max(delta_j, 0)^1.5 + c_b v_j, 0) over loaded balls

with v_j the rings' velocity of approach along ball j: Symmetry 2023, 15, 2166, equations 1 to 8,
with the masses and damping that the paper leaves out taken from Sawalhi and Randall, Mech. Syst.
Signal Process. 2008, 22, 1924.
"""

from __future__ import annotations

import math
from typing import Any, TypeAlias

from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.vector import any_of, chosen, cosine_sine, magnitude, root

Value: TypeAlias = Any
"""A number, or lanes of a fleet."""
Pair: TypeAlias = tuple[Value, Value]
Four: TypeAlias = tuple[Value, Value, Value, Value]

BALL, RECTANGLE, HALF_SINE, COSINE_FLANKS = 0.0, 1.0, 2.0, 3.0
CODES = {'ball': BALL, 'rect': RECTANGLE, 'halfsine': HALF_SINE, 'smooth': COSINE_FLANKS}
"""Code of each of `parameters.PROFILES`, as compiled code takes it."""


@compiled(inline=True, fast=FAST)
def contact_law(delta: Value, k_b: Value) -> Pair:
    """
    Force of Hertz's point contact, N, and its derivative, N/m, at an approach of ``delta`` >= 0 m.

    ``k_b`` in N/m^1.5 (Harris, Rolling Bearing Analysis, chapter 6).

    Examples
    --------
    >>> contact_law(4e-6, 1e10)
    (80.0, 30000000.0)

    """
    stiff = k_b * root(delta)
    return stiff * delta, 1.5 * stiff


@compiled(inline=True, fast=FAST)
def contact_force(
    delta: Value, closing: Value, speed: Value, acceleration: Value, k_b: Value, damping: Value
) -> Pair:
    """
    Force of a ball between the rings, N, and its rate, N/s; it acts where it is positive.

    ``closing`` is the rate of the approach ``delta``, the ball's own path through defects
    included; ``speed`` and ``acceleration`` are those of the rings alone, along the ball.
    """
    elastic, slope = contact_law(delta, k_b)
    return elastic + damping * speed, slope * closing + damping * acceleration


@compiled(inline=True, fast=FAST)
def defect_path(profile: Value, half: Value, depth: Value, curvature: Value, along: Value) -> Pair:
    """
    How far a ball sinks ``along`` m from the centre of a defect, m, and the slope of its path.

    ``half`` is half the width; ``curvature`` is 1/d + 1/D on the inner race, 1/d - 1/D on the
    outer one, with the diameters d of the ball and D of the race, 1/m.

    Examples
    --------
    In the middle a ball bridges a deep spall and touches the ground of a shallow one:

    >>> [round(1e6 * defect_path(BALL, 0.5e-3, depth, 100.0, 0.0)[0], 3) for depth in (5e-5, 2e-5)]
    [25.0, 20.0]

    """
    edge = half - magnitude(along)
    sag = edge * edge * curvature
    rolls = depth > sag
    sunk, slope = chosen(rolls, sag, depth), chosen(rolls, 2.0 * edge * curvature, 0.0)
    if any_of(profile > BALL):
        rectangle, sine = profile == RECTANGLE, profile == HALF_SINE
        flanks = profile == COSINE_FLANKS
        sunk, slope = chosen(rectangle, depth, sunk), chosen(rectangle, 0.0, slope)
        if any_of(sine):
            angle = 0.5 * math.pi * magnitude(along) / half
            c, s = cosine_sine(angle)
            sunk = chosen(sine, depth * c, sunk)
            slope = chosen(sine, depth * 0.5 * math.pi / half * s, slope)
        if any_of(flanks):
            flank = 0.5 * half
            angle = math.pi * chosen(flank > edge, edge, flank) / flank
            c, s = cosine_sine(angle)
            flanks, level = flanks & (flank > edge), flanks & (edge >= flank)
            sunk = chosen(flanks, 0.5 * depth * (1.0 - c), chosen(level, depth, sunk))
            slope = chosen(flanks, 0.5 * depth * math.pi / flank * s, chosen(level, 0.0, slope))
    inside = edge > 0.0
    slope = chosen(along > 0.0, -slope, slope)
    return chosen(inside, sunk, 0.0), chosen(inside, slope, 0.0)


def path_kink(profile: float, half: float, depth: float, curvature: float) -> float:
    """
    Return where `defect_path` has a kink besides those at both edges, m from the centre.

    -1 for a path without one. The integrator parts its steps there.

    Raises
    ------
    ValueError
        If no profile has the code.

    Examples
    --------
    >>> path_kink(BALL, 0.5e-3, 6.25e-6, 100.0)  # where the ball touches the ground
    0.00025

    """
    if profile == BALL:
        return max(0.0, half - math.sqrt(depth / curvature))
    if profile == COSINE_FLANKS:
        return 0.5 * half
    if profile in (RECTANGLE, HALF_SINE):
        return -1.0
    msg = f'no profile has the code {profile}'
    raise ValueError(msg)


@compiled(inline=True, fast=FAST)
def ring_motion(
    machine: Any, drive: Any, force: Pair, rate: Pair, q: Four, v: Four, a: Four
) -> tuple[Four, Four]:
    """
    Acceleration and jerk of both rings, (x_i, y_i, x_o, y_o), under the balls' force.

    ``force`` (x, y), N, of the balls on the outer ring, and its ``rate``, N/s. ``machine`` has
    masses, stiffness and damping as `layout.MACHINE`; ``drive`` the unbalance and the foot of the
    shaft's spring as `layout.STEP`.
    """
    m, d = machine, drive
    k, c = m.inner_stiffness, m.inner_damping
    k_x, c_x, k_y, c_y = (
        m.outer_stiffness_x, m.outer_damping_x, m.outer_stiffness_y, m.outer_damping_y,
    )  # fmt: skip
    return (
        (
            (d.pull_x - force[0] - k * (q[0] - d.foot_x) - c * v[0]) * m.inner_light,
            (d.pull_y - force[1] - k * (q[1] - d.foot_y) - c * v[1]) * m.inner_light,
            (force[0] - k_x * q[2] - c_x * v[2]) * m.outer_light,
            (force[1] - k_y * q[3] - c_y * v[3]) * m.outer_light,
        ),
        (
            (d.pull_rate_x - rate[0] - k * v[0] - c * a[0]) * m.inner_light,
            (d.pull_rate_y - rate[1] - k * v[1] - c * a[1]) * m.inner_light,
            (rate[0] - k_x * v[2] - c_x * a[2]) * m.outer_light,
            (rate[1] - k_y * v[3] - c_y * a[3]) * m.outer_light,
        ),
    )
