# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Ends of an axis for which the viewer writes at least two numbers on it."""

from __future__ import annotations

import math


def labelled_power(top: float, part: float) -> float:
    """
    Return the power of ten that an axis up to ``top`` must include to have a number beside 0.

    The viewer numbers each tenth of a power of ten on an axis up to ``part`` of that power, and
    only the power itself on a longer one. 0 means that the axis need not include more.

    Examples
    --------
    >>> labelled_power(85.0, 0.6), labelled_power(55.0, 0.6), labelled_power(0.0, 0.6)
    (100.0, 0.0, 0.0)

    """
    if not 0.0 < top < math.inf:
        return 0.0
    power: float = 10.0 ** math.ceil(math.log10(top) - 1e-9)
    return power if top > part * power else 0.0


def numbered_end(end: float, steps: float) -> float:
    """
    Return the end of an axis from 0 to about ``end`` on which the viewer writes two numbers.

    The viewer numbers every multiple of a power of ten if at most ``steps`` of them fit on the
    axis, else every tenth multiple. A longer axis therefore ends at ``steps`` or at ten multiples,
    whichever is nearer.

    Examples
    --------
    >>> numbered_end(530.0, 6.0), numbered_end(530.0, 4.0), numbered_end(900.0, 6.0)
    (530.0, 400.0, 1000.0)

    """
    step: float = 10.0 ** math.floor(math.log10(end) + 1e-9)
    if end <= steps * step:
        return end
    return steps * step if end**2 < 10.0 * steps * step**2 else 10.0 * step
