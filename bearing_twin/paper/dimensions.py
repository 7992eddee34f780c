# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Dimensions, found by evaluating a term in other units of mass, length, time and current."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


Dimension = tuple[float, float, float, float]
"""Exponents of kg, m, s and A."""

_SYMBOLS: Mapping[str, Dimension] = {
    'kg': (1, 0, 0, 0),
    'm': (0, 1, 0, 0),
    's': (0, 0, 1, 0),
    'A': (0, 0, 0, 1),
    'N': (1, 1, -2, 0),
    'V': (1, 2, -3, -1),
}
# Size of each new unit in old ones. They are prime: no product of their powers is 1 by chance.
_RESCALED = (2.0, 3.0, 5.0, 7.0)


def dimension(unit: str) -> Dimension:
    """
    Dimension of a unit, e.g. ``'N s/m'`` or ``'N/m^1.5'``; everything after / divides.

    Raises
    ------
    KeyError
        If a symbol is not known.

    """
    above, _, below = unit.partition('/')
    total = [0.0] * len(_RESCALED)
    for part, sign in ((above, 1.0), (below, -1.0)):
        for symbol, power in re.findall(r'([A-Za-z]+)(?:\^([\d.]+))?', part):
            for k, exponent in enumerate(_SYMBOLS[symbol]):
                total[k] += sign * exponent * float(power or 1.0)
    kilogram, metre, second, ampere = total
    return kilogram, metre, second, ampere


def derived(
    term: Callable[..., float], quantities: Mapping[str, tuple[float, str]]
) -> Dimension | None:
    """
    Dimension of the value of ``term``, from values and units of its arguments.

    Each base unit is changed in turn; the exponent is the logarithm of the change of the value.
    None if the term is not homogeneous: the change depends on the values, as in a sum of unlike
    dimensions.
    """
    found = []
    for share in (1.0, 0.5):
        # Other values of the last argument: a sum of unlike dimensions scales otherwise.
        values = {name: value for name, (value, _) in quantities.items()}
        values[list(values)[-1]] *= share
        dimensions = {name: dimension(unit) for name, (_, unit) in quantities.items()}
        before = term(**values)
        exponents = []
        for k, factor in enumerate(_RESCALED):
            scaled = {
                name: value * factor ** -dimensions[name][k] for name, value in values.items()
            }
            change = term(**scaled) / before
            if not change > 0.0:
                return None
            exponents.append(-math.log(change, factor))
        found.append(exponents)
    if not all(math.isclose(a, b, abs_tol=1e-9) for a, b in zip(*found, strict=True)):
        return None
    kilogram, metre, second, ampere = (round(value, 9) + 0.0 for value in found[0])
    return kilogram, metre, second, ampere
