# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Lubricant properties: viscosity over temperature, and the viscosity that a full film needs.

Plain functions of floats, so that the simulator can compile them.
"""

from __future__ import annotations

from dataclasses import dataclass
import math

from bearing_twin.errors import BearingTwinError
from bearing_twin.quantity import check_fields, quantity

_KELVIN = 273.15


def viscosity(temperature: float, a: float, b: float) -> float:
    """
    Kinematic viscosity, m^2/s, at ``temperature`` in degC.

    ASTM D341: ``log10(log10(nu + 0.7)) = a - b log10(T)`` with nu in mm^2/s, T in kelvin.

    Examples
    --------
    >>> a, b = Lubricant().astm_constants
    >>> round(viscosity(100.0, a, b) * 1e6, 2)
    8.7

    """
    exponent: float = 10.0 ** (a - b * math.log10(temperature + _KELVIN))
    return float((10.0**exponent - 0.7) * 1e-6)


def rated_viscosity(speed_rpm: float, mean_diameter: float) -> float:
    """
    Return the reference viscosity nu_1 of adequate lubrication, m^2/s; kappa = nu / nu_1.

    ISO 281:2007, 9.3.3.2, with the mean diameter in m. Infinite at rest.

    Examples
    --------
    >>> round(rated_viscosity(1500.0, 57.5e-3) * 1e6, 1)
    15.3

    """
    if speed_rpm <= 0.0:
        return math.inf
    root = math.sqrt(mean_diameter * 1e3)
    if speed_rpm < 1000.0:
        return float(45000e-6 * speed_rpm**-0.83 / root)
    return 4500e-6 / math.sqrt(speed_rpm) / root


@dataclass(frozen=True, kw_only=True)
class Lubricant:
    """
    Properties of a lubricating oil: viscosity, friction coefficients, supply and contamination.

    The default is ISO VG 68. The friction coefficients 0.12 and 0.05 are those of mineral oil.
    e_C of ISO 281, table 13, below 100 mm pitch diameter: 1 extreme cleanliness, 0.8 to 0.6 high
    cleanliness, 0.6 to 0.5 normal cleanliness, 0.5 to 0.3 slight contamination, 0.3 to 0.1 typical
    contamination, 0.1 to 0 severe contamination.

    Examples
    --------
    >>> round(Lubricant(viscosity_40=100e-6, viscosity_100=11e-6).viscosity(40.0) * 1e6)
    100

    """

    viscosity_40: float = quantity(
        68e-6, 'Kinematic viscosity of the oil at 40 degC.', 'm^2/s', 2e-6, 5e-3
    )
    viscosity_100: float = quantity(
        8.7e-6, 'Kinematic viscosity of the oil at 100 degC.', 'm^2/s', 2e-6, 5e-3
    )
    replenishment: float = quantity(
        3e-8, 'Replenishment constant K_rs of SKF: 3e-8 low oil level, 6e-8 grease or oil spot.',
        '', 0.0, 1e-6,
    )  # fmt: skip
    boundary_friction: float = quantity(
        0.12, 'Friction coefficient of sliding with metallic contact.', '', 0.0, 0.5
    )
    film_friction: float = quantity(
        0.05, 'Friction coefficient of sliding on a full film.', '', 0.0, 0.5
    )
    contamination: float = quantity(
        0.5, 'Contamination factor e_C of ISO 281: 1 extreme cleanliness, 0 severe contamination.',
        '', 0.0, 1.0,
    )  # fmt: skip

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.viscosity_100 < self.viscosity_40:
            msg = (
                f'viscosity_40={self.viscosity_40}, viscosity_100={self.viscosity_100} m^2/s: '
                'need viscosity_100 < viscosity_40, since oil thins as it warms; check both'
            )
            raise BearingTwinError(msg)

    @property
    def astm_constants(self) -> tuple[float, float]:
        """Constants a and b of ASTM D341 that give both viscosities."""
        high, low = (
            math.log10(math.log10(nu * 1e6 + 0.7))
            for nu in (self.viscosity_40, self.viscosity_100)
        )
        x40, x100 = math.log10(40.0 + _KELVIN), math.log10(100.0 + _KELVIN)
        b = (high - low) / (x100 - x40)
        return high + b * x40, b

    def viscosity(self, temperature: float) -> float:
        """Kinematic viscosity, m^2/s, at ``temperature`` in degC."""
        return viscosity(temperature, *self.astm_constants)
