# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Load ratings of radial ball bearings."""

from __future__ import annotations

import math

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


def _looked_up(table: tuple[float, ...], gamma: float, first: float) -> float:
    """
    Return the linearly interpolated value of a table with steps of 0.01 in gamma.

    Outside the table, where no ball bearing is made, its end value holds.
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

    ``gamma`` is D_w cos(alpha) / D_pw; the contact angle is in rad, the ball diameter in m.

    Examples
    --------
    A 6205, for which a maker's catalogue has 14.0 kN:

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
