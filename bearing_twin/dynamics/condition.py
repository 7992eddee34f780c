# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the twin knows about its bearing at one instant."""

from __future__ import annotations

import math
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import fault_orders
from bearing_twin.bearing.hertz import ellipses, pressure_of
from bearing_twin.dynamics import kernel
from bearing_twin.dynamics.coefficients import (
    ALPHA,
    BETA0,
    CLEARANCE,
    DEPTH,
    EQUIVALENT,
    evaluate,
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
from bearing_twin.dynamics.compiled import compiled
from bearing_twin.dynamics.limits import Limit, limits_passed, Strain, which_limits
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.bearing.hertz import Ellipse
    from bearing_twin.dynamics.layout import Records
    from bearing_twin.dynamics.parameters import TwinParameters


FloatArray = npt.NDArray[np.float64]

_TWO_PI = 2.0 * math.pi
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


def condition(
    parameters: TwinParameters,
    constants: Records,
    values: FloatArray,
    at: tuple[float, float, float],
    inputs: FloatArray,
    states: Records,
    tables: kernel.Tables,
) -> Condition:
    """
    Put together the condition from the state of motion.

    ``values`` are those of `coefficients.evaluate` with the outer ring's temperature for both;
    ``at`` are the temperatures of outer and inner ring, degC, and the shaft speed, Hz; ``inputs``
    those of the equations, which follow a quick change of these within a tick of `inner_ring`.

    >>> from bearing_twin.dynamics import preset, Simulator
    >>> round(Simulator(preset('paper'), temperature=60.0).condition().beta0, 3)
    1.011

    """
    deepest = max([defect.depth for defect in parameters.defects], default=0.0)
    contacts = ellipses(parameters.bearing)
    numbers, strain, passed, forces = _observed(
        constants, values, at, inputs, states, tables, deepest, contacts
    )
    which, sentences = limits_passed(strain, passed)
    return Condition._make((*numbers, which, sentences, forces))


@compiled()
def _observed(  # type: ignore[no-untyped-def]
    constants: Records,
    values: FloatArray,
    at: tuple[float, float, float],
    inputs: FloatArray,
    states: Records,
    tables: kernel.Tables,
    deepest: float,
    contacts: tuple[Ellipse, Ellipse],
):
    """
    Work out all but the sentences in one call.

    Returns the numbers of a `Condition` in its order, the strain and the limits that it passes,
    and the forces of all balls.
    """
    of, state, c = values.copy(), states[0], constants[0]
    if c.physical != 0.0:
        evaluate(constants, at[0], at[1], at[2], of)
    held, skidding = of[CLEARANCE], skids(constants, of)
    of[:INPUTS] = inputs
    # The contact angle makes the ball's force larger than its radial part.
    pressed = heaviest(constants, of) / c.cosine
    pressure = max(_pressure_of(pressed, contacts[0]), _pressure_of(pressed, contacts[1]))
    strain = Strain(
        c.load, of[EQUIVALENT], c.dynamic_rating, c.static_rating, pressure, of[KAPPA],
        of[SHAFT_HZ], of[THERMAL_GAP], held, of[INNER] - of[OUTER], skidding,
    )  # fmt: skip
    hz = of[SHAFT_HZ]
    bpfo, bpfi, bsf, ftf = _fault_orders(c, of[SLIP])
    numbers = (
        of[ALPHA], of[HARDNESS], of[FRICTION], of[BETA0], of[K_B], of[DEPTH] * deepest,
        of[CLEARANCE], of[THERMAL_GAP], of[SLIP], of[INNER], of[OUTER], of[VISCOSITY], of[KAPPA],
        of[MOMENT], of[LIFE], pressure, hz, hz * bpfo, hz * bpfi, hz * bsf, hz * ftf,
        _TWO_PI * (state.shaft % 1.0), _TWO_PI * (state.cage % 1.0), _TWO_PI * (state.spin % 1.0),
        state.q[0] - state.q[2], state.q[1] - state.q[3],
    )  # fmt: skip
    return numbers, strain, _which_limits(strain), kernel.ball_forces(states, tables, of)
