# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Lines of the outer race in the amplitude spectrum, for impacts that ring too low for an envelope.

A ringing at ten times the rate of the impacts does not decay between them. Its lines are as steady
as those of a gear, so they are capped before the envelope and modulate little.
"""

from __future__ import annotations

from bearing_twin.diagnosis.signal.lines import without_two_highest
from bearing_twin.diagnosis.signal.spectra import local_floor, quantiles
from bearing_twin.diagnosis.thresholds import CARRIER, MAINS_HZ, SLIP, UNLIKELY_SLIP, Z_ELSEWHERE
import numpy as np
from numpy.typing import NDArray

_LOWEST = 4
"""Lowest harmonic that counts: passing balls make the lower ones."""

_OTHERS = 2
"""Number of highest lines that do not count."""

_BESIDE = np.concatenate((np.linspace(0.7, 0.9, 150), np.linspace(1.1, 1.3, 150)))
"""Frequencies of the combs of the null, relative to the outer race's frequency."""

_FEWEST = 3
"""Least number of other lines."""


def low_lines(
    amplitude: NDArray[np.floating], bin_hz: float, outer_hz: float, shaft_hz: float
) -> float:
    """
    Return the share of the power from the 4th to the 12th outer race harmonic in its lines.

    It is zero if these lines, without the two highest, are not significant against combs at other
    frequencies, or if fewer than five lie off the multiples of shaft and mains.

    Parameters
    ----------
    amplitude
        Amplitude spectrum, bin k at k bin_hz.
    bin_hz
        Spacing of the bins, Hz.
    outer_hz
        Frequency of the outer race without slip, Hz.
    shaft_hz
        Shaft speed, Hz.

    >>> amplitude = np.sqrt(np.random.default_rng(0).exponential(size=4000))
    >>> low_lines(amplitude, 1.0, 174.0, 48.6)
    0.0
    >>> amplitude[173 * np.arange(4, 9)] = 30.0
    >>> round(low_lines(amplitude, 1.0, 174.0, 48.6), 2)
    0.75

    """
    numbers = np.arange(_LOWEST, min(CARRIER, 0.9 * len(amplitude) * bin_hz / outer_hz) + 1.0)
    if len(numbers) < _OTHERS + _FEWEST:
        return 0.0
    end = int((numbers[-1] + 1.0) * 1.3 * outer_hz / bin_hz) + 2
    power = np.asarray(amplitude[1:end], np.float32) ** 2
    floor = local_floor(power, max(int(2.0 * outer_hz / bin_hz), 32))
    logs = np.log1p(power / floor)
    logs[1:-1] = np.maximum(np.maximum(logs[:-2], logs[2:]), logs[1:-1])

    def rows(hertz: NDArray[np.float64]) -> NDArray[np.intp]:
        at = np.rint(hertz[:, None] * numbers / bin_hz).astype(np.intp) - 1
        return np.minimum(at, len(power) - 2)

    def scores(hertz: NDArray[np.float64]) -> NDArray[np.float64]:
        # The two highest do not count: lines of a gear may lie on a harmonic or two.
        sums = np.empty(len(hertz))
        without_two_highest(logs[:-1], hertz, bin_hz, _LOWEST, len(numbers), sums)
        return sums / (len(numbers) - _OTHERS)

    step = 0.5 * bin_hz / numbers[-1]
    near = np.arange((1.0 - UNLIKELY_SLIP) * outer_hz, (1.0 - SLIP[0]) * outer_hz, step)
    null = scores(outer_hz * _BESIDE)
    center, upper = (float(q) for q in quantiles(null))
    score = scores(near)
    best = int(np.argmax(score))
    if score[best] < center + Z_ELSEWHERE * max(upper - center, 1e-3):
        return 0.0
    lines = numbers * near[best]
    of_others = np.array([shaft_hz, *MAINS_HZ])[:, None]
    away = np.abs(lines - of_others * np.rint(lines / of_others)).min(axis=0)
    at = rows(near[best : best + 1])[0, away > 1.5 * bin_hz]
    if len(at) < _OTHERS + _FEWEST:
        return 0.0
    above = np.maximum(power - floor, 0.0)
    first, last = (int((k * near[best]) / bin_hz) for k in (numbers[0] - 0.5, numbers[-1] + 0.5))
    held = sum(above[at + shift] for shift in (-1, 0, 1))
    return float(np.sum(held) / power[first:last].sum())
