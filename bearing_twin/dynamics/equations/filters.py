# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Discrete filters from housing acceleration to output signal: sensor resonance, decimation."""

from __future__ import annotations

import functools
import math

from bearing_twin.given import real_number
from bearing_twin.quantity import check_range
import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

STEP_RATE = 25600.0
"""Lowest step rate of the integrator, Hz."""

_LENGTH = 32
"""Length of the decimator in output samples: -6 dB at 0.5 of the output rate, -80 dB from 0.58."""


def check_rate(sample_rate: float) -> float:
    """
    Return the output rate in Hz if it is inside 2000..204800.

    Examples
    --------
    >>> check_rate(25600)
    25600.0

    """
    rate = real_number('sample_rate', sample_rate)
    check_range('sample_rate', rate, 2000.0, 204800.0, 'Hz')
    return rate


def least_steps(sample_rate: float) -> int:
    """
    Return the least integrator steps per output sample, for a step rate of at least `STEP_RATE`.

    Examples
    --------
    >>> least_steps(25600.0), least_steps(2000.0)
    (1, 13)

    """
    return max(1, math.ceil(STEP_RATE / sample_rate - 1e-9))


def oversampling(sample_rate: float) -> int:
    """
    Return the sensor samples per output sample: three per step of `least_steps`.

    Fewer would cause more aliasing: the acceleration jumps where contact damping begins to act.

    Examples
    --------
    >>> oversampling(25600.0), oversampling(2000.0)
    (3, 39)

    """
    return 3 * least_steps(sample_rate)


def decimator(factor: int) -> FloatArray:
    """
    Low-pass filter for decimation by ``factor``: linear phase, Kaiser window, unit gain at 0.

    Its length is a multiple of ``factor`` plus one.

    Examples
    --------
    >>> taps = decimator(3)
    >>> taps.shape, round(float(taps.sum()), 9)
    ((97,), 1.0)

    """
    half = _LENGTH * factor // 2
    k = np.arange(-half, half + 1)
    taps = np.sinc(k / factor) * np.kaiser(2 * half + 1, 7.86)
    return np.asarray(taps / taps.sum())


def delay(sample_rate: float) -> float:
    """
    Return the delay between an event and the output sample that shows it, s.

    The centre of the filter is `_LENGTH` // 2 samples before its end. Sample k, whose time is
    ``k / sample_rate``, is computed after the step to sample k + 1.

    Examples
    --------
    >>> 1e3 * delay(25600.0)
    0.5859375

    """
    return (_LENGTH // 2 - 1) / sample_rate


@functools.lru_cache(maxsize=64)
def resonator(frequency: float, damping: float, step: float, samples: int) -> FloatArray:
    """
    Exact discretisation of a sensor resonance driven by the acceleration of the housing.

    The seismic mass moves by z relative to the housing: ``z'' + 2 zeta w z' + w^2 z = -a``. The
    sensor output is ``-(2 zeta w z' + w^2 z)``. Within a step the acceleration is the cubic
    through its values and slopes at start and end, which the integrator provides. This cubic is
    the only approximation.

    Parameters
    ----------
    frequency
        Resonance frequency, Hz; 0 for a sensor without resonance.
    damping
        Damping ratio.
    step
        Step of the integrator, s.
    samples
        Sensor samples per step, the last one at its end.

    Returns
    -------
    ndarray of shape (2 + samples, 6)
        Columns: states ``w^2 z`` and ``w z'`` at the start, acceleration and ``step`` times jerk
        at the start, the same two at the end. Rows: both states at the end, then the samples.

    Examples
    --------
    Without resonance the output is the acceleration at the end of the step:

    >>> table = resonator(0.0, 0.0, 1e-5, 1)
    >>> abs(table[-1].round(9)).tolist()
    [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]

    """
    table = np.zeros((2 + samples, 6))
    w = 2.0 * math.pi * frequency * step
    # Rows: the states, then value and first three derivatives of the acceleration.
    a = np.zeros((6, 6))
    a[0, 1] = w
    a[1, :3] = -w, -2.0 * damping * w, -w
    a[2, 3] = a[3, 4] = a[4, 5] = 1.0
    from_ends = np.array(
        [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [-6.0, -4.0, 6.0, -2.0],
            [12.0, 6.0, -12.0, 6.0],
        ]
    )
    for k in range(1, samples + 1):
        whole = _exponential(a * (k / samples))
        whole = np.hstack([whole[:, :2], whole[:, 2:] @ from_ends])
        table[1 + k] = whole[2] if frequency == 0.0 else -whole[0] - 2.0 * damping * whole[1]
    if frequency:
        table[:2] = whole[:2]
    # The cache returns the same array to all twins.
    table.flags.writeable = False
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
