# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Drift of a sensor: its bias settles after it is powered, and follows the temperature."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
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
    basis = _trends(len(x))
    return np.asarray(x - (basis @ x) @ basis)


@functools.lru_cache(maxsize=16)
def _trends(count: int) -> NDArray[np.float64]:
    """Return orthonormal polynomials up to ``_DEGREE``, shape (degree + 1, count)."""
    powers = np.linspace(-1.0, 1.0, count)[:, None] ** np.arange(min(_DEGREE, count - 1) + 1)
    return np.ascontiguousarray(np.linalg.qr(powers)[0].T)
