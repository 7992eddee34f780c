# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Discrete filters between the housing and the published signal: resonance and decimation."""

from __future__ import annotations

import functools
import math

from bearing_twin.errors import BearingTwinError
import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

STEP_RATE = 25600.0
"""Lowest rate of the integrator's steps, Hz."""

_LENGTH = 32
"""Length of the decimator in output samples: -6 dB at 0.5 of the output rate, -80 dB from 0.58."""


def check_rate(sample_rate: float) -> float:
    """
    Return the output rate in Hz if it is inside 2000..204800.

    Examples
    --------
    >>> check_rate(25600)
    25600.0
    >>> check_rate(500.0)
    Traceback (most recent call last):
    bearing_twin.errors.BearingTwinError: sample_rate=500.0 is outside 2000..204800 Hz

    """
    if not 2000.0 <= sample_rate <= 204800.0:
        msg = f'sample_rate={sample_rate} is outside 2000..204800 Hz'
        raise BearingTwinError(msg)
    return float(sample_rate)


def least_steps(sample_rate: float) -> int:
    """
    Return the least steps of the integrator per output sample: at least `STEP_RATE`.

    Examples
    --------
    >>> least_steps(25600.0), least_steps(2000.0)
    (1, 13)

    """
    return max(1, math.ceil(STEP_RATE / sample_rate - 1e-9))


def oversampling(sample_rate: float) -> int:
    """
    Return the samples that are taken of the sensor per output sample: three of each step.

    Less would fold more of what lies above half the output rate into it: acceleration jumps where
    contact damping begins to act.

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
    Return how much earlier what an output sample shows has happened, s.

    The filter's middle is `_LENGTH` // 2 samples before its end. The sample k, whose time is
    ``k / sample_rate``, is made when the step to sample k + 1 is done.

    Examples
    --------
    >>> 1e3 * delay(25600.0)
    0.5859375

    """
    return (_LENGTH // 2 - 1) / sample_rate


@functools.lru_cache(maxsize=64)
def resonator(frequency: float, damping: float, step: float, samples: int) -> FloatArray:
    """
    Exact discretisation of a sensor resonance driven by the housing's acceleration.

    ``z'' + 2 zeta w z' + w^2 z = -a`` for the sensor's mass relative to the housing; it senses
    ``-(2 zeta w z' + w^2 z)``. The acceleration is the cubic through its values and slopes at the
    start and the end of a step, which the integrator has at hand, so the only approximation is
    that cubic.

    Parameters
    ----------
    frequency
        Hz; 0 for a sensor without resonance.
    damping
        Damping ratio.
    step
        Step of the integrator, s.
    samples
        How often a step the sensor is read, the last time at its end.

    Returns
    -------
    ndarray of shape (2 + samples, 6)
        Columns: both states ``w^2 z`` and ``w z'`` at the start, acceleration and ``step`` times
        jerk at the start, then at the end. Rows: both states at the end, then what is read.

    Examples
    --------
    Without resonance the acceleration at the end of the step is read:

    >>> table = resonator(0.0, 0.0, 1e-5, 1)
    >>> abs(table[-1].round(9)).tolist()
    [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]

    """
    table = np.zeros((2 + samples, 6))
    w = 2.0 * math.pi * frequency * step
    # The states, then value, slope, curvature and third derivative of the acceleration.
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
    # The same for all twins of a cloud.
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
