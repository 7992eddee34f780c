# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Laws of the model: contact law, path of a ball through a defect, motion of the rings.

Each law is written once, here. The single bearing, the fleet, the static solver, the reference and
the bearing in three dimensions call these functions with plain numbers or with `vector.FLOATS`, so
they use only arithmetic and the operations of `vector` that accept both.

To replace the contact law edit `contact_law`. To add a selectable contact law, add

- its parameter to `parameters.TwinParameters`;
- its constant to `layout.MACHINE` (with the same name; fleets copy it),
  `coefficients.CONSTANTS` and `reference._Constants`;
- a field beside K_b to `Contact`, and to each place that makes a `Contact`;
- a branch to `contact_law`, as in `defect_path` for the profiles.

These parts assume the power 1.5 and do not call `contact_law`:

- the start of Newton's method in `statics.spring_position`, the margin for the unbalance in
  `stability.steps` and the substeps in `integrator`: they hold for any power near 1.5;
- `life.equivalent_load`, `candidates.passage` and `answer.estimates` of `calibration`, the contact
  pressure (force^(1/3)) in `coefficients` and `reference`, and the unit of K_b in `bearing.hertz`:
  closed formulas for steel on steel; another law needs its own;
- `load_zone`, for pictures: a TwinState contains K_b and no other constant of a law;
- the tests and `paper`, on purpose.

`vector` has square roots and no other powers: x**1.25 is x * root(root(x)).

To add a profile, add

- its name to `parameters.Profile`, and its description to the docstring of `parameters.Defect`;
- its path: a function beside those below, a branch in `defect_path`, a row in `PROFILES`;
- if the path jumps at its edges, a case in `fleet.kinematics.open_gap`: a fleet does not split
  steps there, and handles only `RECTANGLE`;
- its closed form to test_model.py and the error of a fleet to test_fleets.py, which require them;
- its error to docs/realtime.md, and update the table of parameters: ``python docs/tables.py
  docs/nodes.md``.

The equations (x right, y up), one line per axis, y shown::

    m_i y_i'' = -F_y - k_i (y_i - y_i0) - c_i y_i' + m_u e omega^2 sin(theta_s)
    m_o y_o'' = +F_y - K_2 y_o - C_2 y_o'      (along x K_1 and C_1)
    delta_j   = (x_i - x_o) cos(theta_j) + (y_i - y_o) sin(theta_j) - c_r - b_j C_d
    F         = sum_j max(K_b max(delta_j, 0)^1.5 + c_b v_j, 0) over loaded balls

v_j is the velocity of approach of the rings along ball j. The equations are 1 to 8 of Symmetry
2023, 15, 2166; masses and damping, which the paper leaves out, are from Sawalhi and Randall, Mech.
Syst. Signal Process. 2008, 22, 1924.
"""

from __future__ import annotations

from collections.abc import Callable
import math
from typing import Any, NamedTuple, TypeAlias

from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.vector import any_of, chosen, cosine_sine, magnitude, root

Value: TypeAlias = Any
"""A number, or a vector of a fleet's lanes."""
Pair: TypeAlias = tuple[Value, Value]
Four: TypeAlias = tuple[Value, Value, Value, Value]


class Contact(NamedTuple):
    """Parameters of the contact between a ball and the rings."""

    k_b: Value
    """Stiffness K_b of the contact law, N/m^1.5."""
    damping: Value
    """Contact damping, N s/m; zero in statics."""


@compiled(inline=True, fast=FAST)
def contact_law(delta: Value, contact: Contact) -> Pair:
    """
    Return the force of Hertz's point contact, N, and its derivative, N/m.

    ``delta`` is the approach, m, at least 0.

    Harris, Rolling Bearing Analysis, chapter 6.

    Examples
    --------
    >>> contact_law(4e-6, Contact(k_b=1e10, damping=0.0))
    (80.0, 30000000.0)

    """
    stiff = contact.k_b * root(delta)
    return stiff * delta, 1.5 * stiff


@compiled(inline=True, fast=FAST)
def contact_force(
    delta: Value, closing: Value, speed: Value, acceleration: Value, contact: Contact
) -> Pair:
    """
    Return the force of a ball between the rings, N, and its rate, N/s; only positive force acts.

    ``closing`` is the rate of the approach ``delta``, including the path of the ball through
    defects. ``speed`` and ``acceleration`` are those of the rings along the ball.
    """
    elastic, slope = contact_law(delta, contact)
    return elastic + contact.damping * speed, slope * closing + contact.damping * acceleration


class Profile(NamedTuple):
    """
    Path of a ball through a defect.

    The first arguments of its functions are half the width, m, the depth, m, and the curvature of
    the path, 1/m, as in `defect_path`.
    """

    code: float
    """Code of the profile in compiled functions."""
    path: Callable[[Value, Value, Value, Value], Pair]
    """Depth, m, and slope towards the centre at ``away`` m from the centre."""
    kink: Callable[[float, float, float], float]
    """Distance from the centre, m, of the kinks between centre and edges; -1 for none. The
    integrator splits its steps there and at the edges."""


@compiled(inline=True, fast=FAST)
def _bridge(half: Value, depth: Value, curvature: Value, away: Value) -> Pair:
    """Path of a ball that rolls over the edge until it touches the ground."""
    edge = half - away
    sag = edge * edge * curvature
    rolls = depth > sag
    return chosen(rolls, sag, depth), chosen(rolls, 2.0 * edge * curvature, 0.0)


@compiled(inline=True, fast=FAST)
def _step(half: Value, depth: Value, curvature: Value, away: Value) -> Pair:
    return depth, 0.0


@compiled(inline=True, fast=FAST)
def _half_sine(half: Value, depth: Value, curvature: Value, away: Value) -> Pair:
    c, s = cosine_sine(0.5 * math.pi * away / half)
    return depth * c, depth * 0.5 * math.pi / half * s


@compiled(inline=True, fast=FAST)
def _cosine_flanks(half: Value, depth: Value, curvature: Value, away: Value) -> Pair:
    edge, flank = half - away, 0.5 * half
    falls = flank > edge
    c, s = cosine_sine(math.pi * chosen(falls, edge, flank) / flank)
    sunk, slope = 0.5 * depth * (1.0 - c), 0.5 * depth * math.pi / flank * s
    return chosen(falls, sunk, depth), chosen(falls, slope, 0.0)


BALL, RECTANGLE, HALF_SINE, COSINE_FLANKS = 0.0, 1.0, 2.0, 3.0
PROFILES = {
    'ball': Profile(BALL, _bridge, lambda half, d, k: max(0.0, half - math.sqrt(d / k))),
    'rect': Profile(RECTANGLE, _step, lambda *_: -1.0),
    'halfsine': Profile(HALF_SINE, _half_sine, lambda *_: -1.0),
    'smooth': Profile(COSINE_FLANKS, _cosine_flanks, lambda half, depth, curvature: 0.5 * half),
}
"""Path of each of `parameters.PROFILES`."""


@compiled(inline=True, fast=FAST)
def defect_path(profile: Value, half: Value, depth: Value, curvature: Value, along: Value) -> Pair:
    """
    Return how deep a ball sinks ``along`` m from the centre of a defect, m, and the path slope.

    ``profile`` is a code of `PROFILES`, ``half`` half the width, m. ``curvature``, 1/m, is
    1/d + 1/D on the inner race and 1/d - 1/D on the outer race, with ball diameter d and race
    diameter D.

    Examples
    --------
    At the centre a ball bridges a deep spall and touches the ground of a shallow one:

    >>> [round(1e6 * defect_path(BALL, 0.5e-3, depth, 100.0, 0.0)[0], 3) for depth in (5e-5, 2e-5)]
    [25.0, 20.0]

    """
    away = magnitude(along)
    path = _bridge(half, depth, curvature, away)
    if any_of(profile > BALL):
        path = _or(path, profile == RECTANGLE, _step, half, depth, curvature, away)
        path = _or(path, profile == HALF_SINE, _half_sine, half, depth, curvature, away)
        path = _or(path, profile == COSINE_FLANKS, _cosine_flanks, half, depth, curvature, away)
    sunk, slope = path
    inside = half > away
    slope = chosen(along > 0.0, -slope, slope)
    return chosen(inside, sunk, 0.0), chosen(inside, slope, 0.0)


@compiled(inline=True, fast=FAST)
def _or(
    path: Pair, other: Any, of: Any, half: Value, depth: Value, curvature: Value, away: Value
) -> Pair:
    """Return the path ``of`` another profile where the mask ``other`` is set, else ``path``."""
    sunk, slope = path
    if any_of(other):
        deep, steep = of(half, depth, curvature, away)
        sunk, slope = chosen(other, deep, sunk), chosen(other, steep, slope)
    return sunk, slope


@compiled(inline=True, fast=FAST)
def ring_motion(
    machine: Any, drive: Any, force: Pair, rate: Pair, q: Four, v: Four, a: Four
) -> tuple[Four, Four]:
    """
    Return acceleration and jerk of both rings, (x_i, y_i, x_o, y_o), under the ball forces.

    ``force`` (x, y), N, is the force of the balls on the outer ring, ``rate`` its rate, N/s.
    ``machine`` has masses, stiffness and damping as in `layout.MACHINE`; ``drive`` has unbalance
    and foot of the shaft spring as in `layout.STEP`.
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
