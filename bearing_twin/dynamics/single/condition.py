# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Condition of the twin's bearing at one instant."""

from __future__ import annotations

import math
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import fault_orders
from bearing_twin.bearing.hertz import pressure_of
from bearing_twin.dynamics.equations import inner_ring
from bearing_twin.dynamics.equations.coefficients import (
    ALPHA,
    at_rings,
    BETA0,
    CLEARANCE,
    CONDITION_SIZE,
    DEPTH,
    EQUIVALENT,
    FRICTION,
    HARDNESS,
    highest_ball_force,
    INNER,
    INPUTS,
    K_B,
    KAPPA,
    LIFE,
    MOMENT,
    OUTER,
    SHAFT_HZ,
    skids,
    SLIP,
    THERMAL_GAP,
    VISCOSITY,
)
from bearing_twin.dynamics.equations.layout import STATE
from bearing_twin.dynamics.limits import exceeded_limits, Limit, OperatingPoint, which_limits
from bearing_twin.dynamics.single import kernel
from bearing_twin.numerics.compiled import compiled
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.single.objects import Equations


FloatArray = npt.NDArray[np.float64]

_TWO_PI = 2.0 * math.pi
MOTION = STATE.itemsize // 8
VALUES = MOTION + INPUTS
"""Index of the first input, and of the first value of `evaluate`, in ``snapshot``."""
SNAPSHOT_SIZE = VALUES + CONDITION_SIZE + 1
"""Length of ``snapshot``, from which :func:`condition` computes a condition."""
_fault_orders = compiled()(fault_orders)
_pressure_of = compiled()(pressure_of)
_which_limits = compiled()(which_limits)


class Condition(NamedTuple):
    """
    State of the twin at the end of a block; NaN if the thermal mode has no such value.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset, Simulator
    >>> state = Simulator(preset('paper'), temperature=80.0).condition()
    >>> round(state.beta0, 3), round(state.bpfi, 1)
    (1.095, 126.7)

    """

    alpha: float
    """Instantaneous thermal expansion coefficient of table 1, 1/K."""
    hardness: float
    """Rockwell hardness of table 2, HRC."""
    friction: float
    """Average friction coefficient of table 3, dimensionless."""
    beta0: float
    """The paper's factor on stiffness and defect depth; 1 in the physical mode."""
    k_b: float
    """Hertz coefficient, N/m^1.5."""
    c_d: float
    """Greatest defect depth in use, the paper's C_d, m; 0 without a defect."""
    radial_clearance: float
    """Radial clearance in the equations, half the radial internal clearance, m."""
    thermal_clearance: float
    """Radial clearance at the ring temperatures, m. Outside `network.clearance_limits`, where the
    model does not hold, the equations use the nearest limit. They follow a quick change of
    temperature within 0.2 s."""
    slip: float
    """Cage slip, dimensionless."""
    inner_ring_temperature: float
    """degC."""
    outer_ring_temperature: float
    """degC."""
    viscosity: float
    """Kinematic viscosity at the mean ring temperature, m^2/s."""
    kappa: float
    """Viscosity ratio of ISO 281."""
    friction_moment: float
    """Friction moment, N m. A preloaded bearing has the load of `life.equivalent_load`, a lower
    bound of the effect of the preload."""
    life_hours: float
    """Modified rating life L10mh of ISO 281 under `life.equivalent_load`, h; NaN outside the
    limits of the standard."""
    contact_pressure: float
    """Contact pressure of the most loaded ball of a healthy bearing at rest, Pa."""
    shaft_hz: float
    """Shaft speed, Hz."""
    bpfo: float
    """Expected ball pass frequency, outer race, slip included, Hz."""
    bpfi: float
    """Expected ball pass frequency, inner race, slip included, Hz."""
    bsf: float
    """Expected ball spin frequency, slip included, Hz."""
    ftf: float
    """Expected cage frequency, slip included, Hz."""
    shaft_angle: float
    """Angle of the shaft from +x, rad, 0 to 2 pi."""
    cage_angle: float
    """Angle of ball 0 from +x, rad, 0 to 2 pi."""
    ball_angle: float
    """Spin angle of the balls, rad, 0 to 2 pi."""
    inner_x: float
    """Horizontal displacement of the inner ring relative to the outer ring, m."""
    inner_y: float
    """Vertical displacement, m."""
    limits_passed: Limit
    """Limits of model and life that are exceeded."""
    warnings: tuple[str, ...]
    """One sentence per limit."""
    ball_force: npt.NDArray[np.float32]
    """Radial contact force of each ball, N."""


def condition(equations: Equations, snapshot: FloatArray) -> Condition:
    """
    Compute the condition from the numbers recorded of a bearing at one instant.

    Parameters
    ----------
    equations
        The bearing.
    snapshot : float64[SNAPSHOT_SIZE]
        State of motion, a record `layout.STATE` as numbers; inputs of the equations, which follow
        a quick change of temperature within a tick of `inner_ring`; values of
        `coefficients.evaluate` with both rings at the outer ring temperature; inner ring
        temperature, degC.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset, Simulator
    >>> round(Simulator(preset('paper'), temperature=60.0).condition().beta0, 3)
    1.011

    """
    numbers, point, passed, forces = _observed(equations, snapshot)
    which, sentences = exceeded_limits(OperatingPoint._make(point), passed)
    return Condition._make((*numbers, which, sentences, forces))


@compiled()
def put_inputs(
    values: FloatArray,
    behind: FloatArray,
    drift: FloatArray,
    rings: FloatArray,
    since_tick: int,
    tick: int,
    snapshot: FloatArray,
) -> None:
    """Write all of a ``snapshot`` that follows the motion; arguments as in `inner_ring`."""
    snapshot[MOTION:VALUES] = inner_ring.inputs(values, behind, drift, since_tick)
    snapshot[VALUES:-1] = values
    snapshot[-1] = inner_ring.temperature(rings, since_tick, tick)


@compiled()
def _observed(equations: Any, snapshot: FloatArray) -> Any:
    """
    Compute everything except the sentences in one call.

    Returns the numbers of a `Condition` and of an `OperatingPoint` in their order, the exceeded
    limits as bits, and the forces of all balls. Plain tuples are returned faster than named ones.
    """
    c, state = equations.constants[0], snapshot[:MOTION].view(STATE)
    inputs, of = snapshot[MOTION:VALUES], snapshot[VALUES:-1].copy()
    if c.physical != 0.0:
        at_rings(c, of[OUTER], snapshot[-1], of[SHAFT_HZ], of)
    held = of[CLEARANCE]
    of[:INPUTS] = inputs
    # With a contact angle the contact force exceeds its radial component.
    pressed = highest_ball_force(equations.constants, of) / c.cosine
    inner, outer = equations.contacts
    pressure = max(_pressure_of(pressed, inner), _pressure_of(pressed, outer))
    point = (
        c.load, of[EQUIVALENT], c.dynamic_rating, c.static_rating, pressure, of[KAPPA],
        of[SHAFT_HZ], of[THERMAL_GAP], held, of[INNER] - of[OUTER],
        skids(equations.constants, of),
    )  # fmt: skip
    passed = _which_limits(OperatingPoint(*point))
    hz, moved = of[SHAFT_HZ], state[0]
    bpfo, bpfi, bsf, ftf = _fault_orders(c, of[SLIP])
    numbers = (
        of[ALPHA], of[HARDNESS], of[FRICTION], of[BETA0], of[K_B], of[DEPTH] * equations.deepest,
        of[CLEARANCE], of[THERMAL_GAP], of[SLIP], of[INNER], of[OUTER], of[VISCOSITY], of[KAPPA],
        of[MOMENT], of[LIFE], pressure, hz, hz * bpfo, hz * bpfi, hz * bsf, hz * ftf,
        _TWO_PI * (moved.shaft % 1.0), _TWO_PI * (moved.cage % 1.0), _TWO_PI * (moved.spin % 1.0),
        moved.q[0] - moved.q[2], moved.q[1] - moved.q[3],
    )  # fmt: skip
    return numbers, point, passed, kernel.ball_forces(state, equations.tables, of)
