# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the twin knows about its bearing at one instant."""

from __future__ import annotations

import math
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import fault_orders
from bearing_twin.bearing.hertz import pressure_of
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
    heaviest,
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
from bearing_twin.dynamics.limits import Limit, limits_passed, Strain, which_limits
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
"""Where the inputs, and the values of `evaluate`, begin in what was seen."""
SEEN = VALUES + CONDITION_SIZE + 1
"""Numbers from which a condition is put together, see :func:`condition`."""
_fault_orders = compiled()(fault_orders)
_pressure_of = compiled()(pressure_of)
_which_limits = compiled()(which_limits)


class Condition(NamedTuple):
    """
    State of the twin at the end of a block; NaN where the thermal mode has no such value.

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
    """Half the radial internal clearance that the equations use, m."""
    thermal_clearance: float
    """What the ring temperatures leave of it, m. Outside `network.clearance_limits`, where the
    model does not hold, the equations go on with the nearest limit. They follow a quick change of
    temperature within 0.2 s."""
    slip: float
    """Cage slip, dimensionless."""
    inner_ring_temperature: float
    """degC."""
    outer_ring_temperature: float
    """degC."""
    viscosity: float
    """Kinematic viscosity at the rings' mean temperature, m^2/s."""
    kappa: float
    """Viscosity ratio of ISO 281."""
    friction_moment: float
    """N m; a preload is taken for the load of `life.equivalent_load`, the least that it adds."""
    life_hours: float
    """Modified rating life L10mh of ISO 281, h, under that load; NaN where a limit is passed at
    which it ends."""
    contact_pressure: float
    """Of the hardest pressed ball of a sound bearing at rest, Pa."""
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
    """rad, 0 to 2 pi, from +x."""
    cage_angle: float
    """rad, 0 to 2 pi, position of ball 0 from +x."""
    ball_angle: float
    """rad, 0 to 2 pi, spin of the balls."""
    inner_x: float
    """Displacement of the inner ring against the outer ring, m."""
    inner_y: float
    """m."""
    limits_passed: Limit
    """Limits of model and life that are passed."""
    warnings: tuple[str, ...]
    """A sentence for each of them."""
    ball_force: npt.NDArray[np.float32]
    """Radial contact force of each ball, N."""


def condition(equations: Equations, seen: FloatArray) -> Condition:
    """
    Put together the condition from what was seen of a bearing at one instant.

    Parameters
    ----------
    equations
        The bearing.
    seen : float64[SEEN]
        Its state of motion, a record `layout.STATE` as numbers; the inputs of the equations, which
        follow a quick change of temperature within a tick of `inner_ring`; the values of
        `coefficients.evaluate` with the outer ring's temperature for both; and the temperature of
        the inner ring, degC.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset, Simulator
    >>> round(Simulator(preset('paper'), temperature=60.0).condition().beta0, 3)
    1.011

    """
    numbers, strain, passed, forces = _observed(equations, seen)
    which, sentences = limits_passed(Strain._make(strain), passed)
    return Condition._make((*numbers, which, sentences, forces))


@compiled()
def _observed(equations: Any, seen: FloatArray) -> Any:
    """
    Work out all but the sentences in one call.

    Returns the numbers of a `Condition` in its order, those of a `Strain`, the limits that it
    passes, and the forces of all balls. A named tuple would be given back more slowly.
    """
    c, state = equations.constants[0], seen[:MOTION].view(STATE)
    inputs, of = seen[MOTION:VALUES], seen[VALUES:-1].copy()
    if c.physical != 0.0:
        at_rings(c, of[OUTER], seen[-1], of[SHAFT_HZ], of)
    held = of[CLEARANCE]
    of[:INPUTS] = inputs
    # The contact angle makes the ball's force larger than its radial part.
    pressed = heaviest(equations.constants, of) / c.cosine
    inner, outer = equations.contacts
    pressure = max(_pressure_of(pressed, inner), _pressure_of(pressed, outer))
    strain = (
        c.load, of[EQUIVALENT], c.dynamic_rating, c.static_rating, pressure, of[KAPPA],
        of[SHAFT_HZ], of[THERMAL_GAP], held, of[INNER] - of[OUTER],
        skids(equations.constants, of),
    )  # fmt: skip
    passed = _which_limits(Strain(*strain))
    hz, moved = of[SHAFT_HZ], state[0]
    bpfo, bpfi, bsf, ftf = _fault_orders(c, of[SLIP])
    numbers = (
        of[ALPHA], of[HARDNESS], of[FRICTION], of[BETA0], of[K_B], of[DEPTH] * equations.deepest,
        of[CLEARANCE], of[THERMAL_GAP], of[SLIP], of[INNER], of[OUTER], of[VISCOSITY], of[KAPPA],
        of[MOMENT], of[LIFE], pressure, hz, hz * bpfo, hz * bpfi, hz * bsf, hz * ftf,
        _TWO_PI * (moved.shaft % 1.0), _TWO_PI * (moved.cage % 1.0), _TWO_PI * (moved.spin % 1.0),
        moved.q[0] - moved.q[2], moved.q[1] - moved.q[3],
    )  # fmt: skip
    return numbers, strain, passed, kernel.ball_forces(state, equations.tables, of)
