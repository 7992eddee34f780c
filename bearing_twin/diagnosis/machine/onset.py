# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Onset of a rise of a level: whether it rises, since when, and how fast."""

from __future__ import annotations

from dataclasses import dataclass
import math

from bearing_twin.errors import BearingTwinError
import numpy as np
from numpy.typing import NDArray

REFERENCE_DB = 3.0
"""Reference of the CUSUM: half of the 6 dB (twice the acceleration) to be found, which is the
optimum (Moustakides, Annals of Statistics 1986, 14, 1379)."""
DECISION_DB = 40.0
"""Sum above which a level has risen. Of 100 simulated machines with one level a minute, a baseline
of 60 levels and a wander of 1.2 dB with a memory of 20 levels, 51 reach it in a year; with a
memory of 10 levels 11 do, and of those that wander by 0.8 dB none (``python -m
bearing_twin.studies.rise``). A rise of 4 dB is found after 46 levels, one of 6 dB after 14."""
WANDER_DB = 1.2
"""Standard deviation of a level up to which both limits hold; they grow with a larger one."""

MOST = 300
"""Most points of a slope: all pairs are compared, and more points add no information."""
LEAST = 10


@dataclass
class Rise:
    """
    Page's CUSUM of a level over its baseline. Its fields are plain values that can be saved.

    It finds a lasting rise that is too small for the limits of one window.

    Examples
    --------
    >>> rise = Rise()
    >>> [rise.add(4.0) for _ in range(41)][-2:], rise.lasting
    ([False, True], 41)

    """

    total: float = 0.0
    """CUSUM of the levels over the reference, dB."""
    lasting: int = 0
    """Number of levels since the sum was last zero."""
    found: bool = False
    """Whether the level has risen."""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.total) and min(self.total, self.lasting) >= 0):
            raise BearingTwinError(f'saved rise is {self}; use what save() returned')

    def add(self, over: float, scatter: float = 0.0) -> bool:
        """
        Take a level and return whether it has risen.

        Parameters
        ----------
        over
            Level over the baseline, dB.
        scatter
            Standard deviation of the baseline, dB.

        """
        scale = max(1.0, scatter / WANDER_DB)
        # Limited to twice the threshold: a long alarm must end soon after its cause.
        raised = self.total + over - scale * REFERENCE_DB
        self.total = min(max(raised, 0.0), 2.0 * scale * DECISION_DB)
        self.lasting = self.lasting + 1 if self.total > 0.0 else 0
        self.found = self.total > scale * DECISION_DB
        return self.found


def rise_begins(levels: NDArray[np.float64], floor: float, reference: float) -> int:
    """
    Return the index from which levels stay above ``floor``: the last zero of Page's CUSUM.

    Page, Biometrika 1954, 41, 100: the sum of levels less ``floor + reference``, never below zero.
    If the alarm is at the end, the last zero is the maximum likelihood estimate of the change.

    The levels, dB, end at the alarm; ``reference`` is half the smallest rise of interest.

    Examples
    --------
    >>> rise_begins(np.array([0.0, 0.2, -0.1, 5.0, 6.0, 6.5]), 0.0, 1.5)
    3

    """
    sums = np.cumsum(levels - floor - reference)
    # The sum that is reset at zero is the distance to the lowest plain sum so far.
    reset = np.flatnonzero(sums <= np.minimum.accumulate(np.minimum(sums, 0.0)))
    return min(int(reset[-1]) + 1 if len(reset) else 0, len(levels) - 1)


def slope(times: NDArray[np.float64], levels: NDArray[np.float64]) -> float:
    """
    Return the robust slope of levels over times (Theil and Sen); NaN from fewer than ten points.

    Examples
    --------
    >>> slope(np.arange(20.0), 3.0 * np.arange(20.0))
    3.0

    """
    step = max(len(times) // MOST, 1)
    if len(times) < LEAST:
        return float('nan')
    times, levels = times[::step], levels[::step]
    apart = times[:, None] - times
    rises = levels[:, None] - levels
    # scipy.stats has the same estimate, and the tests compare with it, but its import takes as
    # long as two hundred snapshots.
    return float(np.median(rises[apart > 0.0] / apart[apart > 0.0]))
