# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Impulsive outliers: single shocks that do not repeat each turn of the cage."""

from __future__ import annotations

import statistics

import numpy as np
from numpy.typing import NDArray

_ABOVE = 2.0
_TURNS = 5
"""Least number of cage turns for a median; a segment of 20 shaft turns holds 6 to 9."""


def limit_impulsive_outliers(
    x: NDArray[np.float64], sample_rate: float, cage_hz: float
) -> NDArray[np.float64]:
    """
    Return samples with single shocks limited to twice the peak that half of the cage turns reach.

    Every bearing fault strikes at least once a cage turn, so at least half of the turns show its
    height. A shock from elsewhere occurs in few of them. A few shocks fill the squared envelope
    spectrum with broad ripples that look like combs and hide true combs.

    Parameters
    ----------
    x
        Samples without their mean, shape (n,).
    sample_rate
        Hz.
    cage_hz
        Cage frequency, Hz.

    Returns
    -------
    The limited samples, or ``x`` itself without outliers.

    >>> x = np.sin(np.arange(1000.0))
    >>> limit_impulsive_outliers(x, 1000.0, 10.0) is x
    True
    >>> x[500] = 50.0
    >>> bool(limit_impulsive_outliers(x, 1000.0, 10.0).max() < 2.1)
    True

    """
    length = max(round(sample_rate / cage_hz), 1)
    turns = len(x) // length
    if turns < _TURNS:
        return x
    tiles = x[: turns * length].reshape(turns, length)
    heights = np.maximum(tiles.max(axis=1), -tiles.min(axis=1))
    limit = _ABOVE * statistics.median(heights.tolist())
    if max(float(heights.max()), float(np.abs(x[turns * length :]).max(initial=0.0))) <= limit:
        return x
    return np.clip(x, -limit, limit)
