# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the twin knows about its bearing at one instant."""

from __future__ import annotations

import math
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import contact_pressure, fault_frequencies
from bearing_twin.dynamics import coefficients, kernel
from bearing_twin.dynamics.compiled import compiled
from bearing_twin.dynamics.limits import Limit, limits_passed
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.layout import Records
    from bearing_twin.dynamics.parameters import TwinParameters


FloatArray = npt.NDArray[np.float64]


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
    limits_passed: Limit
    """Limits of model and life that are passed."""
    warnings: tuple[str, ...]
    """A sentence for each of them."""
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
    found, held, skids, pressed, ratings, motion, forces = _observed(
        constants, values, at, inputs, states, tables
    )
    # As plain numbers at once: each look into an array takes longer.
    of, bearing = found.tolist(), parameters.bearing
    hz, slip = of[coefficients.SHAFT_HZ], of[coefficients.SLIP]
    left = of[coefficients.THERMAL_GAP]
    # The contact angle makes the ball's force larger than its radial part.
    pressed /= math.cos(bearing.contact_angle)
    inner, outer = contact_pressure(bearing, pressed), contact_pressure(bearing, pressed, 'outer')
    pressure = max(inner, outer)
    passed = limits_passed(
        load=parameters.load,
        equivalent=of[coefficients.EQUIVALENT],
        dynamic_rating=ratings[0],
        static_rating=ratings[1],
        pressure=pressure,
        kappa=of[coefficients.KAPPA],
        shaft_hz=hz,
        clearance=(left, held),
        apart=of[coefficients.INNER] - of[coefficients.OUTER],
        skids=skids,
    )
    deepest = max([defect.depth for defect in parameters.defects], default=0.0)
    bpfo, bpfi, bsf, ftf = fault_frequencies(bearing, hz, slip)
    shaft, cage, spin, x, y = motion
    return Condition(
        alpha=of[coefficients.ALPHA],
        hardness=of[coefficients.HARDNESS],
        friction=of[coefficients.FRICTION],
        beta0=of[coefficients.BETA0],
        k_b=of[coefficients.K_B],
        c_d=of[coefficients.DEPTH] * deepest,
        radial_clearance=of[coefficients.CLEARANCE],
        thermal_clearance=left,
        slip=slip,
        inner_ring_temperature=of[coefficients.INNER],
        outer_ring_temperature=of[coefficients.OUTER],
        viscosity=of[coefficients.VISCOSITY],
        kappa=of[coefficients.KAPPA],
        friction_moment=of[coefficients.MOMENT],
        life_hours=of[coefficients.LIFE],
        contact_pressure=pressure,
        limits_passed=passed.which,
        warnings=passed.sentences,
        shaft_hz=hz,
        bpfo=bpfo,
        bpfi=bpfi,
        bsf=bsf,
        ftf=ftf,
        shaft_angle=2.0 * math.pi * (shaft % 1.0),
        cage_angle=2.0 * math.pi * (cage % 1.0),
        ball_angle=2.0 * math.pi * (spin % 1.0),
        inner_x=x,
        inner_y=y,
        ball_force=forces,
    )


@compiled()
def _observed(  # type: ignore[no-untyped-def]
    constants: Records,
    values: FloatArray,
    at: tuple[float, float, float],
    inputs: FloatArray,
    states: Records,
    tables: kernel.Tables,
):
    """
    Return what of the condition takes arrays, in one call.

    Coefficients, the clearance that the temperatures leave to the equations, whether the balls
    skid, force on the heaviest ball, ratings, phases and displacement, forces of all balls.
    """
    found, state, c = values.copy(), states[0], constants[0]
    if c.physical != 0.0:
        coefficients.evaluate(constants, at[0], at[1], at[2], found)
    held, skids = found[coefficients.CLEARANCE], coefficients.skids(constants, found)
    found[: coefficients.INPUTS] = inputs
    pressed = coefficients.heaviest(constants, found)
    motion = state.shaft, state.cage, state.spin, state.q[0] - state.q[2], state.q[1] - state.q[3]
    forces = kernel.ball_forces(states, tables, found)
    return found, held, skids, pressed, (c.dynamic_rating, c.static_rating), motion, forces
