# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""When a machine has settled, and what it did then: the baseline of its levels."""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import NamedTuple, TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ['MOST_SCATTER_DB', 'SETTLED_DB', 'SETTLED_K', 'Baseline', 'Level', 'settled']

SETTLED_DB, SETTLED_K = 1.0, 1.5
"""Change over a window up to which level and temperature count as settled. Film and clearance, and
with them the vibration, move as long as a bearing warms up."""


MOST_SCATTER_DB = 2.0
"""Scatter up to which a machine has a baseline. Six times as much are 12 dB: a machine that
scatters more would be called ok at four times its level. Several machines in one series do."""


class Level(NamedTuple):
    """Levels of a snapshot."""

    time: float
    """s."""
    levels: NDArray[np.float64]
    """dB, one a measure; the first is that of the whole signal."""
    temperature: float
    """degC; NaN if unknown."""


@dataclass(frozen=True)
class Baseline:
    """What a settled machine does."""

    levels: NDArray[np.float64]
    """Median of each measure, dB."""
    scatter: NDArray[np.float64]
    """Its standard deviation, from the median of the distances, dB."""
    temperature: float
    """degC; NaN if unknown."""
    shaft_hz: float
    times: tuple[float, float]
    """First and last, s."""

    def lower_than(self, other: Baseline) -> bool:
        """Whether the whole signal is lower by more than 1 dB and what the other scatters by."""
        fall = float(other.levels[0] - self.levels[0])
        return fall >= max(SETTLED_DB, 2.0 * float(other.scatter[0]))


def settled(window: Sequence[Level], shaft_hz: float) -> Baseline | None:
    """
    Return the baseline of a window over which level and temperature stay; None if they move.

    Examples
    --------
    >>> base = settled([Level(t, np.array([3.0]), 60.0) for t in range(20)], 25.0)
    >>> base.times, float(base.levels[0])
    ((0.0, 19.0), 3.0)
    >>> settled([Level(t, np.array([3.0]), 40.0 + t) for t in range(20)], 25.0) is None
    True

    """
    levels = np.array([item.levels for item in window])
    heat = np.array([item.temperature for item in window])
    if _drift(levels[:, 0]) > SETTLED_DB:
        return None
    known = heat[np.isfinite(heat)]
    if len(known) > len(heat) // 2 and _drift(known) > SETTLED_K:
        return None
    middle = np.median(levels, axis=0)
    scatter = 1.4826 * np.median(np.abs(levels - middle), axis=0)
    if scatter[0] > MOST_SCATTER_DB:
        return None
    return Baseline(
        levels=middle,
        scatter=scatter,
        temperature=float(np.median(known)) if len(known) else math.nan,
        shaft_hz=shaft_hz,
        times=(float(window[0].time), float(window[-1].time)),
    )


def _drift(values: NDArray[np.float64]) -> float:
    """Change over a window: between the medians of its halves lies half of a steady one."""
    early, late = np.array_split(values, 2)
    return 2.0 * abs(float(np.median(late)) - float(np.median(early)))
