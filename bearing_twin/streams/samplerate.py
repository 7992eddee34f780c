# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The sample rate that really arrives, measured against the stamps. Knows no ROS."""

from __future__ import annotations

from collections import deque
import math
from statistics import median
from typing import NamedTuple

from bearing_twin.stamps import NANO

SPAN = NANO
"""Time over which one rate is taken, ns: a message that is 10 ms late shifts it by 1 %."""

SPANS = 15
"""Spans whose median counts: a pause or a stall spoils one of them, not the median."""

FEWEST = 3
"""Spans from which a large deviation counts."""

WARNED, REFUSED = 0.02, 0.1
"""Deviation that is worth a warning, as the search of the fault frequencies allows about as much;
and that at which each fault frequency lies where another one, or none, is expected."""


class RateProblem(NamedTuple):
    """A sample rate that is not the one declared."""

    refused: bool
    """Whether samples with so wrong a rate cannot be diagnosed."""
    text: str


class RateMeter:
    """
    Measure how many samples come in a second of their own stamps.

    Stamps, not times of arrival: a recording that is replayed faster has the rate it was
    recorded with. Undated samples, whose stamps stand still, have no measured rate.

    Examples
    --------
    >>> meter = RateMeter()
    >>> for second in range(20):
    ...     meter.take(12000 * second, second * NANO)
    >>> meter.rate
    12000.0
    >>> print(meter.problem(25600.0).text)
    12000 samples a second arrive, sample_rate says 25600 (-53.1 %): set sample_rate to 12000

    """

    def __init__(self) -> None:
        self.rate = math.nan
        """Measured rate, Hz; NaN while it is not known."""
        self._rates: deque[float] = deque(maxlen=SPANS)
        self._anchor: tuple[int, int] | None = None

    def take(self, index: int, stamp: int) -> None:
        """
        Take note of a sample.

        Parameters
        ----------
        index
            Its running index. One that goes back, or a stamp that does, begins a new measurement.
        stamp
            Its time, ns.

        """
        if self._anchor is None or index < self._anchor[0] or stamp < self._anchor[1]:
            self._rates.clear()
            self.rate = math.nan
            self._anchor = (index, stamp)
        elapsed = stamp - self._anchor[1]
        if elapsed >= SPAN:
            self._rates.append((index - self._anchor[0]) * NANO / elapsed)
            self._anchor = (index, stamp)
            if len(self._rates) >= FEWEST:
                self.rate = median(self._rates)

    def problem(self, declared: float) -> RateProblem | None:
        """
        Compare the measured rate with the declared one.

        ``declared`` is that of a parameter or message, Hz; above 0.
        """
        measured = self.rate
        off = measured / declared - 1.0
        refused = abs(off) > REFUSED
        if not refused and not (abs(off) > WARNED and len(self._rates) == SPANS):
            return None
        return RateProblem(refused, off_rate(measured, declared))


def off_rate(measured: float, declared: float) -> str:
    """
    Say how far a measured rate is from the declared one, Hz.

    >>> off_rate(12000.0, 25600.0)
    '12000 samples a second arrive, sample_rate says 25600 (-53.1 %): set sample_rate to 12000'

    """
    return (
        f'{measured:.5g} samples a second arrive, sample_rate says {declared:.6g} '
        f'({100.0 * (measured / declared - 1.0):+.1f} %): set sample_rate to {round(measured):d}'
    )
