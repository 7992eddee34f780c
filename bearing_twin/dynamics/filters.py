# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Discrete filters between the housing and the published signal: resonance and decimation."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

__all__ = ['INTERNAL_RATE', 'decimator', 'oversampling', 'resonator']

FloatArray = npt.NDArray[np.float64]

INTERNAL_RATE = 76800.0
"""Lowest internal rate, Hz: the presets at 25 Hz are then within 0.1 % of an adaptive solver over
a second, where 51.2 kHz is within 0.14 %."""

_LENGTH = 32
"""Length of the decimator in output samples: -6 dB at 0.5 of the output rate, -80 dB from 0.58."""


def oversampling(sample_rate: float) -> int:
    """Return the internal steps per output sample: at least 2, and at least `INTERNAL_RATE`."""
    return max(2, math.ceil(INTERNAL_RATE / sample_rate - 1e-9))


def decimator(factor: int) -> FloatArray:
    """
    Low-pass filter for decimation by ``factor``: linear phase, Kaiser window, unit gain at 0.

    Its length is a multiple of ``factor`` plus one, its delay `_LENGTH` // 2 output samples.
    """
    half = _LENGTH * factor // 2
    k = np.arange(-half, half + 1)
    taps = np.sinc(k / factor) * np.kaiser(2 * half + 1, 7.86)
    return np.asarray(taps / taps.sum())


def resonator(frequency: float, damping: float, step: float) -> FloatArray:
    """
    Exact discretisation of a sensor resonance driven by the housing's acceleration.

    ``z'' + 2 zeta w z' + w^2 z = -a`` for the sensor's mass relative to the housing; it senses
    ``-(2 zeta w z' + w^2 z)``. The acceleration is the parabola through its values at the start,
    middle and end of a step, which the integrator has at hand, so the only approximation is that
    parabola.

    Parameters
    ----------
    frequency
        Hz; 0 for a sensor without resonance.
    damping
        Damping ratio.
    step
        Internal step, s.

    Returns
    -------
    ndarray of shape (7, 2)
        Rows 0-1 transition matrix, rows 2-4 input at start, middle, end, row 5 output of the
        state, row 6 direct output.

    """
    table = np.zeros((7, 2))
    if frequency == 0.0:
        table[6, 0] = 1.0
        return table
    w = 2.0 * math.pi * frequency
    # States w^2 z and w z', both accelerations, and the parabola's value, slope and curvature.
    a = np.zeros((5, 5))
    a[0, 1] = w * step
    a[1, :3] = -w * step, -2.0 * damping * w * step, -w * step
    a[2, 3] = a[3, 4] = 1.0
    whole = _exponential(a)
    table[:2] = whole[:2, :2]
    # value u0; slope -3 u0 + 4 um - u1; curvature 4 u0 - 8 um + 4 u1.
    from_values = np.array([[1.0, 0.0, 0.0], [-3.0, 4.0, -1.0], [4.0, -8.0, 4.0]])
    table[2:5] = (whole[:2, 2:] @ from_values).T
    table[5] = -1.0, -2.0 * damping
    return table


def _exponential(matrix: FloatArray) -> FloatArray:
    """Matrix exponential by scaling, Taylor series and squaring."""
    result = term = np.eye(len(matrix))
    for k in range(1, 20):
        term = term @ (matrix / 16.0) / k
        result = result + term
    for _ in range(4):
        result = result @ result
    return np.asarray(result)
