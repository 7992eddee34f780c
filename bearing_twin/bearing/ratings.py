# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Load ratings of radial ball bearings, and the balls that published ratings stand for.

Makers print boundary dimensions, C_r, C_0r and f_0 of every bearing, but rarely its balls.
ISO 281 and ISO 76 compute those three from number, diameter and pitch diameter of the balls, and
balls come in the sizes of ISO 3290: so the printed ratings tell the balls.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from bearing_twin.errors import BearingTwinError
import numpy as np

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

_SIZES = sorted(
    {round(25.4 * n / 32.0, 3) for n in range(2, 33)}
    | {round(25.4 * n / 16.0, 3) for n in range(17, 60)}
    | {round(25.4 * n / 64.0, 3) for n in (5, 7, 9, 11, 13, 15, 17, 19, 31)}
    | {0.5 * n for n in range(4, 32)}
    | {float(n) for n in (*range(16, 27), 28, 30, 32, 34, 35, 36, 38, 40)}
)
"""Ball diameters of ISO 3290 that bearings of 10 mm bore and more have, mm."""

_ROUNDING = 0.004
"""Standard error of a printed rating: makers round to two or three digits."""
_FACTOR_ROUNDING = 0.06
"""Standard error of a printed f_0: one decimal."""
_PITCH_SPREAD = 0.015
"""Standard deviation of the pitch diameter about the mean of bore and outside, relative."""
_METRIC_COST = 2.0
"""Squared standard errors that a size in whole or half millimetres must fit better by: balls of
bearings in metric sizes are rare."""
_UNIQUE = 6.0
"""Squared standard errors by which the second best number or size must fit worse."""
_POOR = 12.0
"""Squared standard errors above which the ratings are not those of such a bearing."""


def _looked_up(table: tuple[float, ...], gamma: float, first: float) -> float:
    """
    Return the value of a table in steps of 0.01 of gamma by linear interpolation.

    Beyond a table, where no ball bearing is made, its last value holds.
    """
    return float(np.interp(gamma, first + 0.01 * np.arange(len(table)), table))


def static_factor(gamma: float) -> float:
    """
    Return f_0 of ISO 76, table 1, at ``gamma`` = D_w cos(alpha) / D_pw.

    Examples
    --------
    >>> static_factor(0.2)
    14.0

    """
    return _looked_up(_F0, gamma, 0.0)


def basic_dynamic_rating(
    n_balls: int, d_ball: float, gamma: float, contact_angle: float = 0.0
) -> float:
    """
    Return the basic dynamic radial load rating C_r of a single row, N (ISO 281, 5.1).

    Parameters
    ----------
    n_balls
        Number of balls.
    d_ball
        Their diameter, m.
    gamma
        D_w cos(alpha) / D_pw.
    contact_angle
        alpha, rad.

    Examples
    --------
    The 6205 of a maker, printed as 14.0 kN:

    >>> round(basic_dynamic_rating(9, 7.938e-3, 0.2034))
    14021

    """
    d = d_ball * 1e3
    size = d**1.8 if d <= 25.4 else 3.647 * d**1.4
    cos = math.cos(contact_angle)
    f_c = _looked_up(_FC, gamma, 0.01)
    return float(1.3 * f_c * cos**0.7 * n_balls ** (2.0 / 3.0) * size)


def basic_static_rating(
    n_balls: int, d_ball: float, gamma: float, contact_angle: float = 0.0
) -> float:
    """
    Return the basic static radial load rating C_0r of a single row, N (ISO 76, 5.1).

    Parameters are those of :func:`basic_dynamic_rating`.

    Examples
    --------
    >>> round(basic_static_rating(9, 7.938e-3, 0.2034))
    7882

    """
    size = (d_ball * 1e3) ** 2
    return static_factor(gamma) * n_balls * size * math.cos(contact_angle)


class Balls(NamedTuple):
    """The balls that published ratings stand for."""

    n_balls: int
    d_ball: float
    """m."""
    d_pitch: float
    """m."""
    unique: bool
    """Whether no other number or size of balls fits the ratings nearly as well."""


def infer_balls(
    bore: float, outside: float, dynamic_rating: float, static_rating: float, factor: float
) -> Balls:
    """
    Return the balls of a deep groove bearing from what its maker prints.

    C_0r = f_0 Z D_w^2 and C_r = 1.3 f_c Z^(2/3) D_w^1.8 are solved for a whole number Z and a ball
    size of ISO 3290; the residuals are weighed by the rounding of the printed values. The pitch
    diameter is the mean of bore and outside diameter, moved as far as the printed f_0 asks for.

    Of the bearings whose balls are published (CWRU 6203 and 6205, XJTU-SY UER204, Harris' 209) all
    numbers and sizes come out right; the pitch diameters differ by -1.1 to +1.9 %, which moves
    the fault orders of races by at most 0.6 % and that of a ball by 2.1 %.

    Parameters
    ----------
    bore, outside
        Boundary dimensions, m.
    dynamic_rating, static_rating
        C_r and C_0r as printed, N.
    factor
        f_0 as printed.

    Raises
    ------
    BearingTwinError
        If no balls fit: the values are not those of a deep groove ball bearing.

    Examples
    --------
    >>> infer_balls(25e-3, 52e-3, 14.0e3, 7.85e3, 13.9)
    Balls(n_balls=9, d_ball=0.007938, d_pitch=0.03873, unique=True)

    """
    mean = 0.5 * (bore + outside)
    found = []
    for size in _SIZES:
        d_ball = 1e-3 * size
        if not 0.2 < d_ball / (outside - bore) < 0.36:
            continue
        pitch = _pitch(mean, d_ball, factor)
        gamma = d_ball / pitch
        for count in range(6, int(math.pi / math.asin(gamma)) + 1):
            off = (
                (basic_dynamic_rating(count, d_ball, gamma) / dynamic_rating - 1.0) / _ROUNDING,
                (basic_static_rating(count, d_ball, gamma) / static_rating - 1.0) / _ROUNDING,
                (static_factor(gamma) - factor) / _FACTOR_ROUNDING,
                (pitch / mean - 1.0) / _PITCH_SPREAD,
            )
            metric = _METRIC_COST * ((2.0 * size).is_integer() and not _in_inches(size))
            found.append((sum(x * x for x in off) + metric, Balls(count, d_ball, pitch, True)))
    found.sort()
    if not found or found[0][0] > _POOR:
        msg = (
            f'no balls give {dynamic_rating:g} N, {static_rating:g} N and f_0 = {factor:g} '
            f'between {bore * 1e3:g} and {outside * 1e3:g} mm; are these the values of a deep '
            'groove ball bearing?'
        )
        raise BearingTwinError(msg)
    (best, balls), *others = found
    unique = not others or others[0][0] - best >= _UNIQUE
    return Balls(balls.n_balls, round(balls.d_ball, 6), round(balls.d_pitch, 5), unique)


def _pitch(mean: float, d_ball: float, factor: float) -> float:
    """Pitch diameter nearest to ``mean`` at which f_0 rounds to ``factor``; at most 3 % off."""
    tried = mean * (1.0 + 1e-3 * np.arange(-15, 31))
    off = np.abs(np.interp(d_ball / tried, 0.01 * np.arange(len(_F0)), _F0) - factor)
    near = np.maximum(off - 0.05, 0.0)
    fitting = tried[near <= near.min() + 1e-9]
    return float(fitting[np.argmin(np.abs(fitting - mean))])


def _in_inches(size: float) -> bool:
    """Whether a diameter in mm is a whole number of 1/32 in."""
    return abs(round(size / 25.4 * 32.0) * 25.4 / 32.0 - size) < 1e-3
