# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Load ratings and modified rating life of radial ball bearings.

ISO 281:2007 (dynamic rating, modified life) and ISO 76:2006 (static rating).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing

__all__ = [
    'dynamic_rating',
    'fatigue_limit',
    'life_factor',
    'life_hours',
    'static_rating',
]

_FC = (
    29.1, 35.8, 40.3, 43.8, 46.7, 49.1, 51.1, 52.8, 54.3, 55.5, 56.6, 57.5, 58.2, 58.8, 59.3,
    59.6, 59.8, 59.9, 60.0, 59.9, 59.8, 59.6, 59.3, 59.0, 58.6, 58.2, 57.7, 57.1, 56.6, 56.0,
    55.3, 54.6, 53.9, 53.2, 52.4, 51.7, 50.9, 50.0, 49.2, 48.4,
)  # fmt: skip
"""f_c of ISO 281, table 2, for single row radial and angular contact groove ball bearings, at
D_w cos(alpha) / D_pw = 0.01, 0.02 ... 0.40."""

_F0 = (
    14.7, 14.9, 15.1, 15.3, 15.5, 15.7, 15.9, 16.1, 16.3, 16.5, 16.4, 16.1, 15.9, 15.6, 15.4,
    15.2, 14.9, 14.7, 14.4, 14.2, 14.0, 13.7, 13.5, 13.2, 13.0, 12.8, 12.5, 12.3, 12.1, 11.8,
    11.6, 11.4, 11.2, 10.9, 10.7, 10.5, 10.3, 10.0, 9.8, 9.6, 9.4,
)  # fmt: skip
"""f_0 of ISO 76, table 1, for radial and angular contact groove ball bearings, at
D_w cos(alpha) / D_pw = 0, 0.01 ... 0.40."""


def _looked_up(bearing: Bearing, table: tuple[float, ...], first: float) -> float:
    """
    Return the value of a table in steps of 0.01 of ``gamma`` by linear interpolation.

    Beyond a table, where no ball bearing is made, its last value holds.
    """
    at = first + 0.01 * np.arange(len(table))
    return float(np.interp(bearing.gamma, at, table))


def dynamic_rating(bearing: Bearing) -> float:
    """Return the basic dynamic radial load rating C_r of a single row, N (ISO 281, 5.1)."""
    f_c = _looked_up(bearing, _FC, 0.01)
    d = bearing.d_ball * 1e3
    size = d**1.8 if d <= 25.4 else 3.647 * d**1.4
    cos = math.cos(bearing.contact_angle)
    return float(1.3 * f_c * cos**0.7 * bearing.n_balls ** (2.0 / 3.0) * size)


def static_rating(bearing: Bearing) -> float:
    """Return the basic static radial load rating C_0r of a single row bearing, N (ISO 76, 5.1)."""
    f_0 = _looked_up(bearing, _F0, 0.0)
    size = (bearing.d_ball * 1e3) ** 2
    return f_0 * bearing.n_balls * size * math.cos(bearing.contact_angle)


def fatigue_limit(bearing: Bearing) -> float:
    """Fatigue load limit C_u, N, by the estimate of ISO 281, B.3.3.3: C_0 / 22."""
    limit = static_rating(bearing) / 22.0
    if bearing.d_pitch > 0.1:
        limit *= (0.1 / bearing.d_pitch) ** 0.5
    return limit


def life_factor(kappa: float, contamination_load: float) -> float:
    """
    Life modification factor a_ISO of radial ball bearings (ISO 281, equations 31-33), 0.1 to 50.

    Parameters
    ----------
    kappa
        Viscosity ratio. Above 4 the standard takes 4; below 0.1 it makes no statement: NaN.
    contamination_load
        ``e_C C_u / P``.

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


def life_hours(factor: float, load: float, speed_rpm: float, rating: float) -> float:
    """Return the modified life L_10mh, h: ``a_ISO (C/P)^3 1e6 / (60 n)``; infinite at rest."""
    if speed_rpm <= 0.0:
        return math.inf
    return factor * (rating / load) ** 3 * 1e6 / (60.0 * speed_rpm)
