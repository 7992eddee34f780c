# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Drift of a sensor: its bias settles after it is powered, and follows the temperature."""

from __future__ import annotations

import functools

from bearing_twin.numerics.compiled import compiled, FAST
import numpy as np
from numpy.typing import NDArray

_DEGREE = 3
"""Degree of the polynomial: of a bias that settles over a third of the samples it leaves a step of
less than 2 % of its height from the last sample to the first."""


def without_drift(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """
    Return samples without their cubic trend.

    A transform takes samples as periodic. A drift is then a step from the last sample to the
    first, whose lines fall as 1/f: those from 10 Hz on raise the velocity of ISO 20816-3.

    Parameters
    ----------
    x
        Shape (n,).

    >>> n = np.arange(1000.0)
    >>> settling, vibration = 30.0 * np.exp(-n / 300.0), np.sin(n)
    >>> bool(np.abs(without_drift(settling + vibration) - vibration).max() < 1.0)
    True

    """
    x = np.ascontiguousarray(x, np.float64)
    left = np.empty(len(x))
    _take_cubic(x, _inverse_gram(len(x)) @ _moments(x), left)
    return left


@functools.lru_cache(maxsize=16)
def _inverse_gram(count: int) -> NDArray[np.float64]:
    """Return the matrix that makes coefficients of 1, t, ... of the moments of `_moments`."""
    powers = np.linspace(-1.0, 1.0, count)[:, None] ** np.arange(_DEGREE + 1)
    return np.asarray(np.linalg.pinv(powers.T @ powers))


# Not as a product with a matrix: its columns are four times as long as the samples, which would
# throw all else out of the cache.
@compiled(fast=FAST, borrows=True)
def _moments(x: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Return the sums of x, x t, x t^2, x t^3, where t rises from -1 to 1."""
    step = 2.0 / max(len(x) - 1, 1)
    zeroth, first, second, third = 0.0, 0.0, 0.0, 0.0
    for n in range(len(x)):
        t = n * step - 1.0
        at = x[n]
        zeroth += at
        at *= t
        first += at
        at *= t
        second += at
        third += at * t
    return zeroth, first, second, third


@compiled(fast=FAST, borrows=True)
def _take_cubic(
    x: NDArray[np.float64], coefficients: NDArray[np.float64], left: NDArray[np.float64]
) -> None:
    """Write ``x`` without the polynomial of these coefficients of 1, t, t^2, t^3 to ``left``."""
    step = 2.0 / max(len(x) - 1, 1)
    c0, c1, c2, c3 = coefficients[0], coefficients[1], coefficients[2], coefficients[3]
    for n in range(len(x)):
        t = n * step - 1.0
        left[n] = x[n] - (c0 + t * (c1 + t * (c2 + t * c3)))
