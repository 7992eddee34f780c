# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The balls and rollers that published ratings stand for, as the rows of the catalogue have them.

Makers print boundary dimensions, C_r, C_0r and f_0 of every bearing, but rarely its balls.
ISO 281 and ISO 76 compute those three from number, diameter and pitch diameter of the balls, and
balls come in the sizes of ISO 3290: so the printed ratings tell the balls.

Of cylindrical roller bearings makers print the diameters of both raceways, which are those of the
roller and of the pitch circle, and C_0r, which tells the number if rollers are whole millimetres
long. C_r says nothing more: at one C_0r it changes as Z^(-1/36).
"""

import math
from typing import NamedTuple

from bearing_twin.bearing import basic_dynamic_rating, basic_static_rating, static_factor
import numpy as np

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
    assert found[0][0] <= _POOR, 'these are not the values of a deep groove ball bearing'
    (best, balls), *others = found
    unique = not others or others[0][0] - best >= _UNIQUE
    return Balls(balls.n_balls, round(balls.d_ball, 6), round(balls.d_pitch, 5), unique)


def _pitch(mean: float, d_ball: float, factor: float) -> float:
    """Pitch diameter nearest to ``mean`` at which f_0 rounds to ``factor``; at most 3 % off."""
    tried = mean * (1.0 + 1e-3 * np.arange(-15, 31))
    off = np.abs([static_factor(d_ball / pitch) - factor for pitch in tried])
    near = np.maximum(off - 0.05, 0.0)
    fitting = tried[near <= near.min() + 1e-9]
    return float(fitting[np.argmin(np.abs(fitting - mean))])


def _in_inches(size: float) -> bool:
    """Whether a diameter in mm is a whole number of 1/32 in."""
    return abs(round(size / 25.4 * 32.0) * 25.4 / 32.0 - size) < 1e-3


_CORNERS = ((14.0, 1.0), (18.0, 1.6), (24.0, 2.0), (30.0, 2.4), (math.inf, 3.0))
"""Largest diameter of a roller and the part of its length that does not bear, both mm."""
_FILLED = (0.75, 0.88)
"""Part of the pitch circle that the rollers of the reinforced design fill."""


def roller_static_rating(count: int, length: float, d_roller: float, d_pitch: float) -> float:
    """
    Return C_0r of a cylindrical roller bearing with rollers of a nominal length, kN (ISO 76).

    C_0r = 44 (1 - D_we / D_pw) Z L_we D_we; all lengths are in mm.
    """
    corners = next(lost for largest, lost in _CORNERS if d_roller <= largest)
    return 0.044 * (1.0 - d_roller / d_pitch) * count * (length - corners) * d_roller


def rounds_to(value: float, printed: float) -> bool:
    """Whether a value is printed as ``printed``, with three digits."""
    unit = 10.0 ** (math.floor(math.log10(printed)) - 2)
    return abs(value - printed) <= 0.52 * unit


def infer_roller_counts(
    d_roller: float, d_pitch: float, printed: list[tuple[float, float]]
) -> list[int]:
    """
    Return the numbers of rollers for which every printed C_0r is that of rollers of whole mm.

    Bearings of several widths with the same raceways have the same number of rollers.

    Parameters
    ----------
    d_roller, d_pitch
        Half the difference and the mean of the diameters of both raceways, mm.
    printed
        Width, mm, and C_0r, kN, of each bearing with these raceways.

    """
    places = math.pi * d_pitch / d_roller
    return [
        count
        for count in range(math.ceil(_FILLED[0] * places), math.floor(_FILLED[1] * places) + 1)
        if all(
            any(
                rounds_to(roller_static_rating(count, length, d_roller, d_pitch), rating)
                for length in range(math.ceil(d_roller), int(width))
            )
            for width, rating in printed
        )
    ]
