# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Thermal network of the bearing: ring temperatures and the change of clearance they cause.

Plain functions of floats, so that the simulator can compile them.
"""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import NamedTuple

from bearing_twin.quantity import check_fields, quantity

EXPANSION_STEEL = 12e-6
"""Linear thermal expansion coefficient of 100Cr6/GCr15, 1/K."""
_PITCH = 57.5e-3
"""Pitch diameter of a 6307, m. The values of a 6307 are scaled to other bearings."""
_LEAST, _MOST = -5e-6, 50e-6
"""Limits of the radial clearance of a 6307, m."""

RING_LOW, RING_HIGH = -60.0, 250.0
"""Range of inner ring temperatures for the temperature laws, degC. Above it hardened steel
tempers; the clearance leaves its limits long before."""


def clearance_change(inner: float, outer: float, d_pitch: float) -> float:
    """
    Change of the radial clearance (half the diametral one) due to ring temperatures, m.

    The diametral change is ``dG_r = alpha [(D_p + d)(T_o - T0) - (D_p - d)(T_i - T0) - 2 d (T_b -
    T0)]`` (Harris and Kotzalas, Essential Concepts of Bearing Technology, chapter 3). With the
    ball temperature T_b = (T_i + T_o)/2, ball diameter and T0 cancel:
    ``dG_r = alpha D_p (T_o - T_i)``. Temperatures are in degC, ``d_pitch`` is in m.

    Examples
    --------
    An inner ring 10 K warmer than the outer ring reduces the clearance of a 6307 by 3.45 um:

    >>> round(clearance_change(60.0, 50.0, 57.5e-3) * 1e6, 2)
    -3.45

    """
    return 0.5 * EXPANSION_STEEL * d_pitch * (outer - inner)


def clearance_limits(d_pitch: float) -> tuple[float, float]:
    """
    Return the least and the greatest radial clearance for which the model holds, m.

    They are -5 and 50 um for a 6307 and proportional to the pitch diameter for other bearings, so
    the strain of the rings is the same. Below, a bearing seizes: friction heat and deformation of
    the rings, which the model takes as rigid, decide. The upper limit is more than twice the
    clearance of new bearings.

    Examples
    --------
    A 6307 and a bearing with 200 mm bore:

    >>> [[round(1e6 * limit) for limit in clearance_limits(d)] for d in (57.5e-3, 310e-3)]
    [[-5, 50], [-27, 270]]

    """
    size = d_pitch / _PITCH
    return _LEAST * size, _MOST * size


def relative_modulus(temperature: float) -> float:
    """
    Ratio of Young's modulus of bearing steel to its value at 20 degC; it falls by 3e-4 per K.

    Examples
    --------
    >>> round(relative_modulus(120.0), 3)
    0.97

    """
    return 1.0 - 3e-4 * (temperature - 20.0)


def inner_ring_target(
    outer: float, shaft: float, power: float, ring_to_ring: float, ring_to_shaft: float
) -> float:
    """
    Steady-state temperature of the inner ring, degC.

    ``outer`` and ``shaft`` are temperatures, degC, ``power`` is the friction power, W, and the
    conductances ``ring_to_ring`` and ``ring_to_shaft`` are in W/K.

    Examples
    --------
    >>> inner_ring_target(60.0, 70.0, 6.0, 2.0, 8.0)
    68.3

    """
    flow = 0.5 * power + ring_to_ring * outer + ring_to_shaft * shaft
    return flow / (ring_to_ring + ring_to_shaft)


def inner_ring_step(
    inner: float,
    target: float,
    duration: float,
    capacity: float,
    ring_to_ring: float,
    ring_to_shaft: float,
) -> float:
    """
    Inner ring temperature after ``duration`` seconds, degC; exact for constant inputs.

    Solves ``C_i dT_i/dt = P/2 - G_io (T_i - T_o) - G_is (T_i - T_sh)``. ``target`` is the steady
    state of `inner_ring_target`, degC; ``capacity`` C_i is in J/K, conductances are in W/K.

    Examples
    --------
    >>> round(inner_ring_step(50.0, 60.0, 8.0, 80.0, 2.0, 8.0), 2)
    56.32

    """
    decay = math.exp(-duration * (ring_to_ring + ring_to_shaft) / capacity)
    return target + (inner - target) * decay


@dataclass(frozen=True, kw_only=True)
class ThermalNetwork:
    """
    Parameters of the thermal network: the inner ring between outer ring and shaft.

    The temperature T_o of the outer ring is measured.

    ::

        C_i dT_i/dt = P/2 - G_io (T_i - T_o) - G_is (T_i - T_sh)

    A capacity or conductance of None is scaled from a 6307 (80 J/K, its inner ring has 0.17 kg;
    2 W/K between the rings, 8 W/K to the shaft): a capacity is proportional to the cube of the
    pitch diameter, a conductance to the diameter. ``shaft_ratio`` is above 1 if heat comes in
    along the shaft (motor, pump, turbine), below 1 if the housing is heated.

    Examples
    --------
    >>> ThermalNetwork().scaled(115e-3).inner_capacity
    640.0
    >>> round(ThermalNetwork().scaled(115e-3).inner_excess(70.0), 1)
    4.0

    """

    inner_capacity: float | None = quantity(
        None, 'Thermal mode physical: heat capacity of the inner ring.', 'J/K', 0.1, 1e6,
        special=(None, '80 J/K of a 6307 times the cube of the pitch diameter over 57.5 mm'),
    )  # fmt: skip
    ring_to_ring: float | None = quantity(
        None, 'Thermal mode physical: conductance between the rings.', 'W/K', 1e-3, 1e4,
        special=(None, '2 W/K of a 6307 times the pitch diameter over 57.5 mm'),
    )  # fmt: skip
    ring_to_shaft: float | None = quantity(
        None, 'Thermal mode physical: conductance from inner ring to shaft.', 'W/K', 1e-3, 1e4,
        special=(None, '8 W/K of a 6307 times the pitch diameter over 57.5 mm'),
    )  # fmt: skip
    ambient: float = quantity(
        20.0, 'Thermal mode physical: temperature of the surroundings.', 'degC', -40.0, 110.0
    )
    shaft_ratio: float = quantity(
        1.1,
        'Thermal mode physical: rise of the shaft over ambient divided by that of the outer ring.',
        '', 0.0, 2.0,
    )  # fmt: skip

    def __post_init__(self) -> None:
        check_fields(self)

    def scaled(self, d_pitch: float) -> Scaled:
        """Return the network of a bearing of this pitch diameter, m."""
        size = d_pitch / _PITCH
        return Scaled(
            inner_capacity=80.0 * size**3 if self.inner_capacity is None else self.inner_capacity,
            ring_to_ring=2.0 * size if self.ring_to_ring is None else self.ring_to_ring,
            ring_to_shaft=8.0 * size if self.ring_to_shaft is None else self.ring_to_shaft,
            ambient=self.ambient,
            shaft_ratio=self.shaft_ratio,
        )


class Scaled(NamedTuple):
    """A `ThermalNetwork` scaled to one bearing; units as there."""

    inner_capacity: float
    ring_to_ring: float
    ring_to_shaft: float
    ambient: float
    shaft_ratio: float

    def shaft(self, outer: float) -> float:
        """Shaft temperature, degC, at the outer ring temperature ``outer``."""
        return self.ambient + self.shaft_ratio * (outer - self.ambient)

    def inner_excess(self, outer: float) -> float:
        """Inner minus outer ring temperature in the steady state without friction, K."""
        return (
            inner_ring_target(outer, self.shaft(outer), 0.0, self.ring_to_ring, self.ring_to_shaft)
            - outer
        )
