# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Hertzian point contact of a ball with its races."""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, TypeAlias

from bearing_twin.errors import BearingTwinError

if TYPE_CHECKING:
    from bearing_twin.bearing.geometry import Bearing


YOUNG_STEEL = 208e9
"""Young's modulus of bearing steel at 20 degC, Pa."""
POISSON_STEEL = 0.3
"""Poisson's ratio of bearing steel."""
CONFORMITY = {'inner': 0.515, 'outer': 0.525}
"""Groove radius over ball diameter."""
Ellipse: TypeAlias = tuple[float, float, float, float]
"""Contact ellipse: sum of curvatures, 1/m, ratio of the half axes, elliptic integrals K and E."""


def elliptic_integrals(m: float) -> tuple[float, float]:
    """
    Return the complete elliptic integrals K(m) and E(m), 0 <= m < 1.

    They are computed with the arithmetic-geometric mean.

    Abramowitz and Stegun, Handbook of Mathematical Functions, 17.6.

    Examples
    --------
    >>> elliptic_integrals(0.0)
    (1.5707963267948966, 1.5707963267948966)

    """
    a, b, total, weight = 1.0, math.sqrt(1.0 - m), 0.5 * m, 0.5
    while abs(a - b) > 1e-15:
        a, b, c = 0.5 * (a + b), math.sqrt(a * b), 0.5 * (a - b)
        weight *= 2.0
        total += weight * c * c
    k = math.pi / (a + b)
    return k, k * (1.0 - total)


def contact_stiffness(
    bearing: Bearing, race: str, *, conformity: float | None = None, young: float = YOUNG_STEEL
) -> float:
    """
    Load-deflection factor of one ball on one race, N/m^1.5.

    Parameters
    ----------
    bearing
        Geometry.
    race
        ``'inner'`` or ``'outer'``.
    conformity
        Groove radius over ball diameter, above 0.5; None: `CONFORMITY` of the race.
    young
        Young's modulus of ball and race, Pa.

    Notes
    -----
    Harris and Kotzalas, Essential Concepts of Bearing Technology, 5th ed., chapter 6: the
    ellipticity is the root of F(rho) = ((k^2 + 1) E - 2 K) / ((k^2 - 1) E), the approach is
    delta = delta* (3 Q / (2 sum(rho) E'))^(2/3) sum(rho) / 2. The elliptic integrals are exact.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> print(f'{contact_stiffness(find_bearing("6205"), "inner", conformity=0.52):.3g}')
    2.56e+10

    """
    rho_sum, ellipticity, k, e = _ellipse(bearing, race, conformity)
    approach = 2.0 * k / math.pi * (math.pi / (2.0 * ellipticity**2 * e)) ** (1.0 / 3.0)
    reduced = young / (1.0 - POISSON_STEEL**2)
    unit_load = (3.0 / (rho_sum * reduced)) ** (2.0 / 3.0) * rho_sum / 2.0
    return float((approach * unit_load) ** -1.5)


def contact_pressure(
    bearing: Bearing, force: float, race: str = 'inner', *, conformity: float | None = None
) -> float:
    """
    Greatest pressure between a ball and a ``race``, Pa, under a ``force`` in N.

    Which race has the higher pressure depends on the bearing: the inner race curves away from the
    ball; the outer race has the wider groove, which matters more for small balls. The half axes
    are ``a = (2 k^2 E / pi)^(1/3) (3 Q / (sum(rho) E'))^(1/3)`` and ``b = a / k``, the pressure is
    ``3 Q / (2 pi a b)`` (Harris and Kotzalas, chapter 6).

    Examples
    --------
    Under its static rating, the most loaded ball of a 6205 carries 5/Z of the load. Its pressure
    is the 4.2 GPa that define the rating, with the conformity that ISO 76 assumes:

    >>> from bearing_twin.bearing import find_bearing
    >>> bearing = find_bearing('6205')
    >>> force = 5.0 * 7850.0 / bearing.n_balls
    >>> round(contact_pressure(bearing, force, conformity=0.52) * 1e-9, 1)
    4.2

    """
    return pressure_of(force, _ellipse(bearing, race, conformity))


def pressure_of(force: float, ellipse: Ellipse) -> float:
    """
    Greatest pressure in a contact, Pa, under a ``force`` in N; see `contact_pressure`.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> round(pressure_of(1000.0, ellipses(find_bearing('6205'))[0]) * 1e-9, 1)
    2.4

    """
    rho_sum, ellipticity, _, e = ellipse
    reduced = YOUNG_STEEL / (1.0 - POISSON_STEEL**2)
    long = (2.0 * ellipticity**2 * e / math.pi * 3.0 * force / (rho_sum * reduced)) ** (1.0 / 3.0)
    return float(1.5 * force / (math.pi * long * long / ellipticity)) if force > 0.0 else 0.0


@functools.lru_cache(maxsize=256)
def ellipses(bearing: Bearing) -> tuple[Ellipse, Ellipse]:
    """
    Return the contact ellipses of a ball on the inner and outer race, for `pressure_of`.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> [round(contact[1], 1) for contact in ellipses(find_bearing('6205'))]
    [11.0, 6.4]

    """
    return _ellipse(bearing, 'inner', None), _ellipse(bearing, 'outer', None)


@functools.lru_cache(maxsize=256)
def _ellipse(bearing: Bearing, race: str, conformity: float | None) -> Ellipse:
    conformity = CONFORMITY[race] if conformity is None else conformity
    if not 0.5 < conformity < 1.0:
        msg = f'{conformity=} of the {race} race is outside 0.5..1; typical values are 0.515..0.53'
        raise BearingTwinError(msg)
    sign = {'inner': 1.0, 'outer': -1.0}[race]
    d, g = bearing.d_ball, bearing.gamma
    rolling = sign * 2.0 * g / (d * (1.0 - sign * g))
    groove = 1.0 / (conformity * d)
    rho_sum = 4.0 / d + rolling - groove
    rho_difference = (rolling + groove) / rho_sum

    def excess(ellipticity: float) -> float:
        k2 = ellipticity * ellipticity
        k, e = elliptic_integrals(1.0 - 1.0 / k2)
        return ((k2 + 1.0) * e - 2.0 * k) / ((k2 - 1.0) * e) - rho_difference

    low, high = 1.0 + 1e-6, 1e3
    for _ in range(100):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
    ellipticity = math.sqrt(low * high)
    return rho_sum, ellipticity, *elliptic_integrals(1.0 - 1.0 / ellipticity**2)


def load_deflection_factor(bearing: Bearing, *, young: float = YOUNG_STEEL) -> float:
    """
    Load-deflection factor K_b of a ball between both races, N/m^1.5.

    The contacts are in series: ``K = (K_i^(-2/3) + K_o^(-2/3))^(-3/2)`` (Harris and Kotzalas,
    chapter 7).

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> print(f'{load_deflection_factor(find_bearing("6307-catalogue")):.4g}')
    1.228e+10

    """
    inner, outer = (contact_stiffness(bearing, race, young=young) for race in ('inner', 'outer'))
    return float((inner ** (-2.0 / 3.0) + outer ** (-2.0 / 3.0)) ** -1.5)


def radial_factor(bearing: Bearing) -> float:
    """
    Ratio of a ball's radial force to its radial displacement^1.5, N/m^1.5.

    A radial displacement delta deforms the ball by ``delta cos(alpha)``, and ``cos(alpha)`` of the
    contact force is radial, so ``K_r = K cos(alpha)^2.5`` (Harris and Kotzalas, chapter 7, with a
    constant contact angle).

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> bearing = find_bearing('6307')
    >>> radial_factor(bearing) == load_deflection_factor(bearing)
    True

    """
    return float(load_deflection_factor(bearing) * math.cos(bearing.contact_angle) ** 2.5)
