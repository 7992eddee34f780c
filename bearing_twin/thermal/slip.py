# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Cage slip of a radially loaded ball bearing, from the balance of oil drag and ball traction.

The oil drags on cage and balls with a force F along the pitch circle. F follows from the power
``M_0 omega = F v``, where v is the orbital speed of the balls and M_0 Palmgren's load-independent
friction moment, ``M_0 = 1e-7 f_0 (nu n)^(2/3) d_m^3`` in N mm, mm^2/s, 1/min and mm, with f_0 = 2
for an oil bath (Harris and Kotzalas, Essential Concepts of Bearing Technology, 5th ed.,
chapter 10). F is an upper bound: part of the moment brakes the spin of the balls, not their orbit.
The formula holds for nu n of at least 2000; below, it is too small, but metallic contact drives
the balls there. SKF's minimum radial load against skidding,
``k_r (nu n/1000)^(2/3) (d_m/100)^2``, has the same form.

The inner race drives the loaded balls and the outer race holds them. With a slip s both contacts
slide at the fraction s of their rolling speed, and each transmits the traction ``mu(s) Q`` under
its force Q. The slip is the root of ``F = 2 sum Q mu(s)`` over the loaded balls, with

    mu(s) = phi mu_bl tanh(k_e s / mu_bl) + (1 - phi) tau_E / p asinh(k s p / tau_E)
    1 / k = 1 / k_e + 1 / k_f,   k_e = C_11 G / (pi p),   k_f = eta(p) u / (h p)

where

- phi is the share of metallic contact in SKF's friction model (`friction.metallic_share`),
- p is the mean contact pressure; one contact stands for the mean of those with both races,
- k_e is the elastic creep of steel (Kalker, Three-Dimensional Elastic Bodies in Rolling Contact,
  1990: C_11 = 3.3 for a contact ten times as wide as long),
- k_f is the slope of an oil film of thickness h (Hamrock and Dowson 1977) at the rolling speed u,
  with Roelands' viscosity eta(p),
- tau_E is the Eyring stress at which the film yields (Johnson and Tevaarwerk 1977).

Range: full to mixed films, from the onset of skidding to the static rating. The slip passes 1 %
between half and twice SKF's minimum load (6203, 6205 and 6307, 1500 to 6000 1/min, 30 and 50 degC,
ISO VG 68), and is below 0.01 % at a tenth of the dynamic rating. It grows with the speed. Near
skidding it also grows with the viscosity; a thinner film transmits less traction, so at a given
load the slip has a minimum over the viscosity. Metallic contact ends the slip. More clearance
loads fewer balls more. Near skidding this mostly reduces the slip, with 10 um to a half at least;
below a slip of 0.01 % it changes it by a fifth either way. If the traction does not suffice, cage
and balls skid: the slip is then `HIGHEST_SLIP`, the end of the model's range.
"""

from __future__ import annotations

import math

from bearing_twin.bearing import POISSON_STEEL, YOUNG_STEEL

HIGHEST_SLIP = 0.05
"""Upper limit of the slip in this model; cage and balls skid."""

_F_0 = 2.0
"""Palmgren's factor of a deep groove ball bearing in an oil bath."""
_DENSITY = 870.0
"""Density of mineral oil, kg/m^3."""
_EYRING = 5e6
"""Eyring stress, at which a film of mineral oil yields, Pa."""
_KALKER = 3.3
"""Creep coefficient C_11."""
_ROELANDS_EXPONENT, _ROELANDS_PRESSURE, _ROELANDS_LOG = 0.6, 1.0 / 5.1e-9, 9.67
"""Roelands: eta = eta_0 exp((ln eta_0 + 9.67) ((1 + 5.1e-9 p)^0.6 - 1)), Pa s and Pa."""
_REDUCED = YOUNG_STEEL / (1.0 - POISSON_STEEL**2)
_SHEAR = 0.5 * YOUNG_STEEL / (1.0 + POISSON_STEEL)


def drag(speed_rpm: float, nu: float, mean_diameter: float, inner_race: float) -> float:
    """
    Drag force of the oil on cage and balls along the pitch circle, N.

    Parameters
    ----------
    speed_rpm
        Shaft speed, 1/min.
    nu
        Kinematic viscosity, m^2/s.
    mean_diameter, inner_race
        (bore + outside)/2, and the diameter of the inner raceway, m.

    Examples
    --------
    A 6307 at 1500 1/min in an oil of 68 mm^2/s:

    >>> round(drag(1500.0, 68e-6, 57.5e-3, 43.5e-3), 1)
    7.6

    """
    product = nu * 1e6 * speed_rpm
    moment = 1e-10 * _F_0 * product ** (2.0 / 3.0) * (mean_diameter * 1e3) ** 3
    return float(4.0 * moment / inner_race)


def film_slope(pressure: float, force: float, nu: float, rolling: float, d_ball: float) -> float:
    """
    Slope k_f of the traction coefficient of an oil film over the slide-to-roll ratio.

    Parameters
    ----------
    pressure, force
        Mean contact pressure, Pa, and contact force, N.
    nu
        Kinematic viscosity at ambient pressure, m^2/s.
    rolling
        Rolling speed of the surfaces, m/s.
    d_ball
        Ball diameter, m.

    Examples
    --------
    >>> round(film_slope(0.5e9, 200.0, 68e-6, 2.1, 14e-3), 1)
    1.0

    """
    eta = _DENSITY * nu
    log_eta, radius = math.log(eta) + _ROELANDS_LOG, 0.5 * d_ball
    rise = log_eta * ((1.0 + pressure / _ROELANDS_PRESSURE) ** _ROELANDS_EXPONENT - 1.0)
    modulus = _ROELANDS_EXPONENT / _ROELANDS_PRESSURE * log_eta * _REDUCED
    thickness = 2.69 * radius * (eta * rolling / (_REDUCED * radius)) ** 0.67 * modulus**0.53
    thickness *= (force / (_REDUCED * radius * radius)) ** -0.067
    return float(eta * math.exp(rise) * rolling / (thickness * pressure))


def traction(
    slip: float, pressure: float, slope: float, metallic: float, boundary: float
) -> tuple[float, float]:
    """
    Return the traction coefficient of a sliding contact and its derivative over the slip.

    Parameters
    ----------
    slip
        Sliding over rolling speed.
    pressure
        Mean pressure, Pa.
    slope
        Slope k_f of the film, see `film_slope`.
    metallic, boundary
        Share phi of metallic contact, and its friction coefficient.

    Examples
    --------
    A film at 0.5 GPa gives a few per cent, metallic contact twelve:

    >>> round(traction(0.01, 0.5e9, 20.0, 0.0, 0.12)[0], 3)
    0.036
    >>> round(traction(0.01, 0.5e9, 20.0, 1.0, 0.12)[0], 3)
    0.12

    """
    elastic = _KALKER * _SHEAR / (math.pi * pressure)
    film = slope * elastic / (slope + elastic)
    held = math.tanh(elastic * slip / boundary) if boundary > 0.0 else 0.0
    yields = film * slip * pressure / _EYRING
    value = metallic * boundary * held
    value += (1.0 - metallic) * _EYRING / pressure * math.asinh(yields)
    growth = metallic * elastic * (1.0 - held * held) if boundary > 0.0 else 0.0
    growth += (1.0 - metallic) * film / math.sqrt(1.0 + yields * yields)
    return value, growth
