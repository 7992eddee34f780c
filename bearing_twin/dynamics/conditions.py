# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""From temperature and speed to the quantities that the equations of motion take."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bearing_twin.dynamics.parameters import TwinParameters
from bearing_twin.dynamics.statics import spring_position
from bearing_twin.thermal import gcr15

__all__ = ['Material', 'material']


@dataclass(frozen=True, kw_only=True)
class Material:
    """Quantities at one temperature and speed; NaN where the thermal mode has none."""

    alpha: float
    """Instantaneous thermal expansion coefficient, 1/K."""
    hardness: float
    """Rockwell hardness, HRC."""
    friction: float
    """Average friction coefficient, dimensionless."""
    beta0: float
    """The paper's factor on stiffness and defect depth, dimensionless."""
    k_b: float
    """Hertz coefficient, N/m^1.5."""
    radial_clearance: float
    """Half the radial internal clearance, m."""
    slip: float
    """Cage slip, dimensionless."""
    spring_position: float
    """Position y_i0 of the shaft spring, m."""
    inner_ring_temperature: float = math.nan
    """degC."""
    outer_ring_temperature: float = math.nan
    """degC."""
    viscosity: float = math.nan
    """Kinematic viscosity, m^2/s."""
    kappa: float = math.nan
    """Viscosity ratio of ISO 281."""
    friction_moment: float = math.nan
    """N m."""
    life_hours: float = math.nan
    """Modified rating life L10mh of ISO 281, h."""


def material(parameters: TwinParameters, temperature: float) -> Material:
    """Evaluate the thermal mode at ``temperature``, degC."""
    beta0 = parameters.beta0.at(temperature)
    friction = gcr15.friction(temperature)
    k_b = beta0 * parameters.k_b0
    slip = {
        'none': 0.0,
        'constant': parameters.slip,
        'mu_proportional': parameters.slip * friction / parameters.beta0.reference_friction,
    }[parameters.slip_model]
    compliance = 1.0 / parameters.inner_stiffness + 1.0 / parameters.outer_stiffness
    return Material(
        alpha=gcr15.alpha(temperature, parameters.beta0.alpha_unit),
        hardness=gcr15.hardness(temperature),
        friction=friction,
        beta0=beta0,
        k_b=k_b,
        radial_clearance=parameters.clearance,
        slip=slip,
        spring_position=spring_position(
            parameters.load, k_b, parameters.clearance, compliance, parameters.bearing.n_balls
        ),
    )
