# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Thermal network of both rings: their temperatures, and the clearance that they leave.

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
"""Pitch diameter of a 6307, whose values are scaled to other bearings, m."""
_LEAST, _MOST = -5e-6, 50e-6
"""Limits of the radial clearance of a 6307, m."""

RING_LOW, RING_HIGH = -60.0, 250.0
"""Temperatures of an inner ring that the laws of this room hold for, degC. Above, hardened
steel tempers; a bearing that is heated so has left the clearance's limits long before."""


def clearance_change(inner: float, outer: float, d_pitch: float) -> float:
    """
    Change of the radial clearance (half the diametral one) against rings of one temperature, m.

    ``dG_r = alpha [(D_p + d)(T_o - T0) - (D_p - d)(T_i - T0) - 2 d (T_b - T0)]`` is diametral
    (Harris and Kotzalas, Essential Concepts of Bearing Technology, chapter 3). With the balls
    midway between the rings, T_b = (T_i + T_o)/2, ball diameter and T0 cancel:
    ``dG_r = alpha D_p (T_o - T_i)``.

    Examples
    --------
    An inner ring 10 K warmer than the outer one takes 3.45 um off a 6307:

    >>> round(clearance_change(60.0, 50.0, 57.5e-3) * 1e6, 2)
    -3.45

    """
    return 0.5 * EXPANSION_STEEL * d_pitch * (outer - inner)


def clearance_limits(d_pitch: float) -> tuple[float, float]:
    """
    Return the least and the greatest radial clearance for which the model holds, m.

    -5 and 50 um for a 6307, for others in proportion to the pitch diameter, as the strain of the
    rings goes. Below, a bearing seizes: its heat and the yielding of rings that the model takes as
    rigid decide. Above is more than twice the clearance that bearings are made with.

    Examples
    --------
    Of a 6307 and of a bearing of 200 mm bore:

    >>> [[round(1e6 * limit) for limit in clearance_limits(d)] for d in (57.5e-3, 310e-3)]
    [[-5, 50], [-27, 270]]

    """
    size = d_pitch / _PITCH
    return _LEAST * size, _MOST * size


def relative_modulus(temperature: float) -> float:
    """
    Young's modulus of bearing steel over its value at 20 degC: it falls by 3e-4 per kelvin.

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
    Inner ring temperature in the steady state, degC, for the outer ring and shaft given.

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
    Inner ring temperature after ``duration`` seconds towards ``target``, degC; exact.

    The node's balance is ``C_i dT_i/dt = P/2 - G_io (T_i - T_o) - G_is (T_i - T_sh)``.

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
    The inner ring between outer ring, whose temperature is measured, and shaft.

    ::

        C_i dT_i/dt = P/2 - G_io (T_i - T_o) - G_is (T_i - T_sh)

    Capacity and conductances that are None are those of a 6307 (its inner ring of 0.17 kg has 80
    J/K; 2 W/K between the rings, 8 W/K to the shaft), scaled to the bearing: a capacity goes with
    the cube of the pitch diameter, a conductance with the diameter itself. ``shaft_ratio`` is
    above 1 where heat comes in along the shaft (motor, pump, turbine), below 1 where the housing
    is heated.

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
    """A `ThermalNetwork` of one bearing, nothing left open."""

    inner_capacity: float
    ring_to_ring: float
    ring_to_shaft: float
    ambient: float
    shaft_ratio: float

    def shaft(self, outer: float) -> float:
        """Shaft temperature, degC, at the outer ring temperature ``outer``."""
        return self.ambient + self.shaft_ratio * (outer - self.ambient)

    def inner_excess(self, outer: float) -> float:
        """Inner less outer ring temperature in the steady state without friction, K."""
        return (
            inner_ring_target(outer, self.shaft(outer), 0.0, self.ring_to_ring, self.ring_to_shaft)
            - outer
        )
