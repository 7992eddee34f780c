# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Dimensions of units, as exponents of mass, length, time and current."""

from __future__ import annotations

import re

Dimension = tuple[float, float, float, float]
"""Exponents of kg, m, s and A."""

_SYMBOLS: dict[str, Dimension] = {
    'kg': (1, 0, 0, 0),
    'm': (0, 1, 0, 0),
    's': (0, 0, 1, 0),
    'A': (0, 0, 0, 1),
    'N': (1, 1, -2, 0),
    'V': (1, 2, -3, -1),
}


def dimension(unit: str) -> Dimension:
    """
    Dimension of a unit, e.g. ``'N s/m'`` or ``'N/m^1.5'``; everything after / divides.

    Raises
    ------
    KeyError
        If a symbol is not known.

    """
    above, _, below = unit.partition('/')
    total = [0.0] * 4
    for part, sign in ((above, 1.0), (below, -1.0)):
        for symbol, power in re.findall(r'([A-Za-z]+)(?:\^([\d.]+))?', part):
            for k, exponent in enumerate(_SYMBOLS[symbol]):
                total[k] += sign * exponent * float(power or 1.0)
    kilogram, metre, second, ampere = total
    return kilogram, metre, second, ampere
