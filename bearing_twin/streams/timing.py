# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Periodicity and execution time of a cycle, as in controller_manager."""

from __future__ import annotations

from collections import deque
import math
from typing import NamedTuple

from bearing_twin.streams.pacer import RECENT
import numpy as np


class Spread(NamedTuple):
    """Statistics of one quantity; NaN before the first value."""

    mean: float
    low: float
    high: float
    std: float

    def scaled(self, factor: float) -> Spread:
        """Return the statistics in another unit."""
        return Spread(*(factor * value for value in self))

    def named(self, name: str, unit: str) -> dict[str, float]:
        """Return mean, minimum, maximum and standard deviation, named as in ros2_control."""
        return {
            f'{name}_{unit}': self.mean,
            f'{name}_min_{unit}': self.low,
            f'{name}_max_{unit}': self.high,
            f'{name}_std_{unit}': self.std,
        }


class CycleStatistics:
    """Collect start times and durations of the last `RECENT` cycles, one a block."""

    def __init__(self) -> None:
        self._began = math.nan
        self._intervals: deque[float] = deque(maxlen=RECENT)
        self._durations: deque[float] = deque(maxlen=RECENT)

    def add(self, began: float, duration: float) -> None:
        """
        Add one cycle.

        ``began`` is its start on the clock that paces the cycles; both arguments are in s.
        """
        if began > self._began:
            self._intervals.append(began - self._began)
        self._began = began
        self._durations.append(duration)

    def pause(self) -> None:
        """Do not count the interval from the last cycle to the next one."""
        self._began = math.nan

    @property
    def periodicity(self) -> Spread:
        """
        Rate of the cycles, Hz.

        It is computed from the statistics of the intervals, not of their inverses: a cycle that
        follows a late one at once would count as a rate of thousands of Hz. The standard deviation
        is a first-order approximation.
        """
        interval = _spread(np.array(self._intervals))
        return Spread(
            1.0 / interval.mean,
            1.0 / interval.high,
            1.0 / interval.low,
            interval.std / interval.mean**2,
        )

    @property
    def execution_time(self) -> Spread:
        """Duration of the cycles, s."""
        return _spread(np.array(self._durations))


def _spread(values: np.ndarray) -> Spread:
    if not values.size:
        return Spread(math.nan, math.nan, math.nan, math.nan)
    return Spread(
        float(values.mean()), float(values.min()), float(values.max()), float(values.std())
    )
