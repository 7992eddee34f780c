# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Conversion of acceleration units, as spelled in files and messages, to m/s^2."""

import math

GRAVITY = 9.80665
"""m/s^2 in one g."""

_FACTORS = {
    **dict.fromkeys(('m/s^2', 'm/s2', 'm/s²', 'm/s/s', 'm s-2', 'm s^-2', 'm/sec^2'), 1.0),
    **dict.fromkeys(('g', 'G', 'gn', 'g_n'), GRAVITY),
    **dict.fromkeys(('mm/s^2', 'mm/s2', 'mm/s²'), 1e-3),
    'mg': 1e-3 * GRAVITY,
}


def acceleration_factor(unit: str) -> float:
    """
    Return the factor from ``unit`` to m/s^2; NaN if it is not a known unit of acceleration.

    >>> acceleration_factor('g'), acceleration_factor('V')
    (9.80665, nan)

    """
    return _FACTORS.get(unit.strip(), math.nan)
