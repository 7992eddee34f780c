# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Height of impacts that come back each turn of the cage, however rare and short they are."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, median_filter

CAGE_TURN = 2.5
"""Shaft turns of a turn of the cage; in bearings it takes 2 to 3."""
UNKNOWN_TURN = 0.5
"""Length of a stretch at an unknown speed, s: a turn of the cage at 300 1/min."""
_LOWEST_HZ, _LOWEST_SHARE = 1000.0, 0.125
"""Lowest frequency, Hz, and its largest share of the sample rate: a quarter of the band."""
_BLOCK_SAMPLES, _BLOCK_TIME = 16, 0.3e-3
"""Least length of a block in samples and in s. An impact rings for longer; a spike, of electricity
for instance, is of one to three samples."""
_STEPS = 2.0
"""Least height in steps of the converter: from one step to two would be 6 dB."""
_FLOOR = 1.8
"""Least height over the mean of the middle half of all blocks: noise reaches 1.6 in a turn of the
cage."""
_SPEED_ERROR = 0.01
_PARTNER = 0.5
"""Height of an impact one turn of the shaft away, over that of an impact which it explains."""
_LEAST_TURN = 8.0
"""Least number of blocks in a turn of the shaft, to part impacts that are a turn away."""


def lowest_hz(sample_rate: float) -> float:
    """
    Return the frequency from which on impacts are measured, Hz, at a sample rate in Hz.

    >>> lowest_hz(25600.0), lowest_hz(2000.0)
    (1000.0, 250.0)

    """
    return min(_LOWEST_HZ, _LOWEST_SHARE * sample_rate)


def impact_height(x: NDArray[np.float64], sample_rate: float, shaft_hz: float) -> float:
    """
    Return the height of rare impacts that half of the turns of the cage reach.

    Rare impacts hardly raise the RMS: four rings of 2 ms with peaks of 15 times the RMS, in 0.4 s,
    raise it by some dB. But every damaged part strikes at least once a turn of the cage. So the
    height of each turn is taken, and the median over the turns: a single shock is in few of them.
    Impacts that are there one turn of the shaft before and after as well are left out. They are of
    a coupling or a gear, or of a race; those of a race are many, and raise the RMS.

    The height of a turn is that of its highest block, and a quarter of the samples of a block are
    higher than the height of the block. A spike of some samples is not. For the same reason the
    frequencies below :func:`lowest_hz` are taken off with a moving median: any linear filter would
    widen the spike.

    Parameters
    ----------
    x
        Samples as the sensor gave them, shape (n,).
    sample_rate
        Hz.
    shaft_hz
        Hz; NaN if unknown. No impacts are left out then.

    Returns
    -------
    Height in the unit of x; 0 if the signal has nothing at these frequencies. In noise it is about
    twice the RMS.

    >>> rng = np.random.default_rng(0)
    >>> x = rng.standard_normal(10240)
    >>> ring = 15.0 * np.exp(-np.arange(100.0) / 40.0) * np.sin(np.arange(100.0))
    >>> worn, spoilt = x.copy(), x.copy()
    >>> for first in range(500, 10000, 2500):
    ...     worn[first : first + 100] += ring
    ...     spoilt[first] += 60.0
    >>> [round(impact_height(each, 25600.0, 25.0), 1) for each in (x, worn, spoilt)]
    [1.9, 10.3, 1.9]
    >>> [round(float(each.std()), 1) for each in (x, worn, spoilt)]
    [1.0, 1.4, 1.6]

    """
    count = len(x)
    size = min(round(sample_rate / lowest_hz(sample_rate)) | 1, count)
    high = np.abs(x - median_filter(x, size=size, mode='nearest'))
    # Values of a converter are equal, or a step apart.
    step = float(high[high > 0.0].min(initial=math.inf))
    if math.isinf(step):
        return 0.0
    block = min(max(round(_BLOCK_TIME * sample_rate), _BLOCK_SAMPLES), count)
    blocks, rank = count // block, block - 1 - block // 4
    heights = np.partition(high[: blocks * block].reshape(blocks, block), rank, axis=1)[:, rank]
    rare = np.where(_PARTNER * heights > _a_turn_away(heights, sample_rate / shaft_hz / block),
                    heights, 0.0)  # fmt: skip
    cage_hz = shaft_hz / CAGE_TURN if math.isfinite(shaft_hz) else 1.0 / UNKNOWN_TURN
    turns = int(min(max(count / sample_rate * cage_hz, 1.0), blocks))
    each = rare[: turns * (blocks // turns)].reshape(turns, -1).max(axis=1)
    quiet = float(np.sort(heights)[blocks // 4 : blocks - blocks // 4].mean())
    return max(float(np.median(each)), _FLOOR * quiet, _STEPS * step)


def _a_turn_away(heights: NDArray[np.float64], turn: float) -> NDArray[np.float64]:
    """
    Return the heights that are there both a turn of the shaft before and after each block.

    At the ends one of both counts. They are 0 if a turn, in blocks, is too short or unknown.
    """
    if not _LEAST_TURN <= turn < len(heights):
        return np.zeros(len(heights))
    near = maximum_filter1d(heights, 2 * math.ceil(_SPEED_ERROR * turn) + 3)
    lag = round(turn)
    before, after = np.full((2, len(heights)), math.inf)
    before[lag:], after[:-lag] = near[:-lag], near[lag:]
    both = np.minimum(before, after)
    return np.where(np.isfinite(both), both, 0.0)
