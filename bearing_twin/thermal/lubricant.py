# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Viscosity of the lubricant, and what it means for the contact.

Plain functions of floats, so that the simulator can compile them.
"""

from __future__ import annotations

from dataclasses import dataclass
import math

from bearing_twin.errors import BearingTwinError

__all__ = ['Lubricant', 'rated_viscosity', 'viscosity']

_KELVIN = 273.15


def viscosity(temperature: float, a: float, b: float) -> float:
    """
    Kinematic viscosity, m^2/s, at ``temperature`` in degC.

    ASTM D341: ``log10(log10(nu + 0.7)) = a - b log10(T)`` with nu in mm^2/s, T in kelvin.
    """
    exponent: float = 10.0 ** (a - b * math.log10(temperature + _KELVIN))
    return float((10.0**exponent - 0.7) * 1e-6)


def rated_viscosity(speed_rpm: float, mean_diameter: float) -> float:
    """
    Viscosity nu_1 that separates the surfaces, m^2/s; kappa = nu / nu_1.

    ISO 281:2007, 9.3.3.2, with the mean diameter in m. At rest there is none: infinite.
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
    An oil by its two viscosities, and how it reaches the contacts.

    Parameters
    ----------
    viscosity_40, viscosity_100
        Kinematic viscosity at 40 and 100 degC, m^2/s, 2e-6 to 5e-3. The default is ISO VG 68.
    replenishment
        K_rs of the SKF friction model: 3e-8 low oil level, 6e-8 grease or oil spot.
    boundary_friction, film_friction
        Sliding friction with metallic contact and on a full film: 0.12 and 0.05 (mineral oil).
    contamination
        e_C of ISO 281, table 13, below 100 mm pitch diameter: 1 extreme cleanliness, 0.8 to 0.6
        high, 0.6 to 0.5 normal, 0.5 to 0.3 slight, 0.3 to 0.1 typical, 0.1 to 0 severe
        contamination.

    """

    viscosity_40: float = 68e-6
    viscosity_100: float = 8.7e-6
    replenishment: float = 3e-8
    boundary_friction: float = 0.12
    film_friction: float = 0.05
    contamination: float = 0.5

    def __post_init__(self) -> None:
        if not 2e-6 < self.viscosity_100 < self.viscosity_40 < 5e-3:
            msg = (
                f'viscosity_40={self.viscosity_40}, viscosity_100={self.viscosity_100} m^2/s: '
                'need 2e-6 < viscosity_100 < viscosity_40 < 5e-3; are they in m^2/s?'
            )
            raise BearingTwinError(msg)
        for name, high in (
            ('replenishment', 1e-6),
            ('boundary_friction', 0.5),
            ('film_friction', 0.5),
            ('contamination', 1.0),
        ):
            value = getattr(self, name)
            if not 0.0 <= value <= high:
                msg = f'{name}={value} is outside 0..{high:g}'
                raise BearingTwinError(msg)

    @property
    def astm_constants(self) -> tuple[float, float]:
        """Constants a and b of ASTM D341 through both viscosities."""
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
