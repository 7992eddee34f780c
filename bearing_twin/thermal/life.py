# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Load ratings and modified rating life of radial ball bearings.

ISO 281:2007 (dynamic rating, modified life) and ISO 76:2006 (static rating).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import basic_dynamic_rating, basic_static_rating
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


_COSINES = np.cos(np.pi * (np.arange(64) + 0.5) / 64)
"""Cosines of the ball angles from the load direction, at 64 positions on one side of the ring."""
_STRIBECK = 0.228828
"""Mean of cos^2.5 over the ring, 0 beyond 90 degrees. Z times it is the ratio of bearing load to
highest ball load."""
_CUBIC = 0.562499
"""Cube root of the mean of (cos^1.5)^3 over the ring: cubic mean over highest ball load."""


def dynamic_rating(bearing: Bearing) -> float:
    """
    Return the basic dynamic radial load rating C_r of a single row, N.

    The maker's value is used; if there is none, ISO 281, 5.1 gives it from the geometry.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> dynamic_rating(find_bearing('6205'))
    14000.0

    """
    return bearing.dynamic_rating or basic_dynamic_rating(
        bearing.n_balls, bearing.d_ball, bearing.gamma, bearing.contact_angle
    )


def static_rating(bearing: Bearing) -> float:
    """
    Return the basic static radial load rating C_0r of a single row, N.

    The maker's value is used; if there is none, ISO 76, 5.1 gives it from the geometry.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> static_rating(find_bearing('6205'))
    7850.0

    """
    return bearing.static_rating or basic_static_rating(
        bearing.n_balls, bearing.d_ball, bearing.gamma, bearing.contact_angle
    )


def equivalent_load(load: float, k_b: float, clearance: float, n_balls: int) -> float:
    """
    Load that fatigues the bearing equally with zero clearance, N.

    ISO 281 assumes Stribeck's load distribution: half of the ring is loaded, with zero clearance.
    A preload, or a clearance that leaves few balls loaded, raises the ball loads under the same
    ``load``. For the ring that rotates relative to the load, the mean of the cubes of the ball
    loads counts (Lundberg and Palmgren; ISO/TS 16281:2008, 4.3). The rings are rigid.

    Parameters
    ----------
    load
        Radial load, N.
    k_b
        Radial load-deflection factor of a ball, N/m^1.5.
    clearance
        Radial clearance, m; below 0 the bearing is preloaded.
    n_balls
        Number of balls.

    Examples
    --------
    500 N with zero clearance, a preload of 5 um and a clearance of 50 um:

    >>> [round(equivalent_load(500.0, 1.2e10, c, 8)) for c in (0.0, -5e-6, 50e-6)]
    [500, 608, 750]

    """
    sink = (load / (n_balls * k_b * _STRIBECK)) ** (2.0 / 3.0)
    # Newton's method, from a displacement at which the first ball is in contact.
    shift = (sink + max(clearance, 0.0)) / _COSINES[0]
    cubes, share = 0.0, n_balls * k_b / len(_COSINES)
    for _ in range(100):
        force = slope = cubes = 0.0
        for cos in _COSINES:
            delta = shift * cos - clearance
            if delta > 0.0:
                root = math.sqrt(delta)
                force += delta * root * cos
                slope += 1.5 * root * cos * cos
                cubes += (delta * root) ** 3
        step = (force * share - load) / (slope * share)
        shift -= step
        if abs(step) < 1e-12 * shift:
            break
    mean = k_b * (cubes / len(_COSINES)) ** (1.0 / 3.0)
    return float(n_balls * _STRIBECK * mean / _CUBIC)


def fatigue_limit(bearing: Bearing) -> float:
    """
    Fatigue load limit C_u, N, estimated as C_0 / 22 (ISO 281, B.3.3.3).

    Above 100 mm pitch diameter it is reduced by (100 mm / D_pw)^0.5.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> round(fatigue_limit(find_bearing('6205')))
    357

    """
    limit = static_rating(bearing) / 22.0
    if bearing.d_pitch > 0.1:
        limit *= (0.1 / bearing.d_pitch) ** 0.5
    return limit


def life_factor(kappa: float, contamination_load: float) -> float:
    """
    Life modification factor a_ISO of radial ball bearings (ISO 281, equations 31-33), 0.1 to 50.

    The viscosity ratio ``kappa`` is limited to 4, as the standard says. Below 0.1, where the
    standard does not apply, the result is NaN. ``contamination_load`` is ``e_C C_u / P``.

    Examples
    --------
    >>> round(life_factor(1.0, 0.1), 2)
    2.43

    """
    if not kappa >= 0.1:
        return math.nan
    kappa = min(kappa, 4.0)
    if kappa < 0.4:
        film = 2.5671 - 2.2649 / kappa**0.054381
    elif kappa < 1.0:
        film = 2.5671 - 1.9987 / kappa**0.19087
    else:
        film = 2.5671 - 1.9987 / kappa**0.071739
    base = 1.0 - film**0.83 * contamination_load ** (1.0 / 3.0)
    if base <= 0.0:
        return 50.0
    return float(min(max(0.1 * base**-9.3, 0.1), 50.0))


def life_hours(
    factor: float, load: float, speed_rpm: float, rating: float, static: float
) -> float:
    """
    Return the modified life L_10mh, h: ``a_ISO (C/P)^3 1e6 / (60 n)``; infinite at rest.

    NaN if the load P exceeds half the dynamic ``rating`` C or the ``static`` rating C_0, where the
    standard does not apply. ``factor`` is a_ISO; loads and ratings are in N.

    Examples
    --------
    A bearing with C = 14 kN under a tenth of that at 1500 1/min:

    >>> round(life_hours(1.0, 1400.0, 1500.0, 14e3, 7850.0))
    11111

    """
    if load > min(0.5 * rating, static):
        return math.nan
    if speed_rpm <= 0.0:
        return math.inf
    return factor * (rating / load) ** 3 * 1e6 / (60.0 * speed_rpm)
