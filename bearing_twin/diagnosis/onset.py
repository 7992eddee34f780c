# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""When a level began to rise, and how fast it does."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ['rise_begins', 'slope']

MOST = 300
"""Points that a slope is taken from: all are compared pair by pair, and more tell no more."""
LEAST = 10


def rise_begins(levels: NDArray[np.float64], floor: float, reference: float) -> int:
    """
    Index from which levels stand over ``floor`` for good: the last zero of Page's CUSUM.

    Page, Biometrika 1954, 41, 100: the sum of levels less ``floor + reference``, never below zero.
    Where an alarm is raised at the end, its last zero is the maximum likelihood estimate of the
    change.

    Parameters
    ----------
    levels
        dB, shape (n,), up to the alarm.
    floor
        Level before the change, dB.
    reference
        Half the smallest rise of interest, dB.

    Examples
    --------
    >>> rise_begins(np.array([0.0, 0.2, -0.1, 5.0, 6.0, 6.5]), 0.0, 1.5)
    3

    """
    sums = np.cumsum(levels - floor - reference)
    # The sum that is reset at zero is the distance to the lowest plain sum so far.
    reset = np.flatnonzero(sums <= np.minimum.accumulate(np.minimum(sums, 0.0)))
    return min(int(reset[-1]) + 1 if len(reset) else 0, len(levels) - 1)


def slope(times: NDArray[np.float64], levels: NDArray[np.float64]) -> float:
    """
    Robust slope of levels over times (Theil and Sen); NaN from fewer than ten points.

    Examples
    --------
    >>> slope(np.arange(20.0), 3.0 * np.arange(20.0))
    3.0

    """
    # Loaded when needed: half a second.
    from scipy.stats import theilslopes

    step = max(len(times) // MOST, 1)
    if len(times) < LEAST:
        return float('nan')
    return float(theilslopes(levels[::step], times[::step])[0])
