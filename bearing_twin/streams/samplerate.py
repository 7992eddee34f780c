# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Measurement of the actual sample rate from the stamps."""

from __future__ import annotations

from collections import deque
import math
from statistics import median
from typing import NamedTuple

from bearing_twin.stamps import NANO

SPAN = NANO
"""Duration of one measurement of the rate, ns; a message that is 10 ms late shifts it by 1 %."""

SPANS = 15
"""Most measurements in the median: a pause or a stall spoils one of them, not the median."""

FEWEST = 3
"""Least number of measurements for a rate."""

WARNED, REFUSED = 0.02, 0.1
"""Relative deviations from the declared rate. Above the first there is a warning: the search for
the fault frequencies tolerates about as much. Above the second samples are refused: the search
for one fault frequency would then find another one, or none."""


class RateProblem(NamedTuple):
    """A deviation of the measured from the declared sample rate."""

    refused: bool
    """Whether the deviation is too large for a diagnosis."""
    text: str


class RateMeter:
    """
    Measure the sample rate from sample indices and stamps.

    Stamps are used, not times of arrival, so a recording that is replayed faster has the rate of
    the original. Samples without a time, whose stamps do not change, have no measured rate.

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
        self._first = self._latest = (0, 0)

    def take(self, index: int, stamp: int) -> None:
        """
        Take the index and time of a sample.

        Parameters
        ----------
        index
            Running index. When index or stamp goes back, or the stamp alone goes on, a new
            measurement begins: a source may count the samples of each snapshot from 0.
        stamp
            Time of the sample, ns.

        """
        former, begun = self._anchor or (index + 1, stamp)
        if index < former or stamp < begun or (index == former and stamp > begun):
            self._rates.clear()
            self.rate = math.nan
            former, begun = self._anchor = self._first = (index, stamp)
        self._latest = (index, stamp)
        elapsed = stamp - begun
        if elapsed >= SPAN:
            self._rates.append((index - former) * NANO / elapsed)
            self._anchor = (index, stamp)
            if len(self._rates) >= FEWEST:
                self._forget_former_rate()
                self.rate = median(self._rates)

    def _forget_former_rate(self) -> None:
        """Keep only the latest measurements if these agree on another rate than the median."""
        latest = list(self._rates)[-FEWEST:]
        agree = max(latest) <= (1.0 + WARNED) * min(latest)
        usual = median(self._rates)
        if agree and abs(median(latest) - usual) > REFUSED * usual:
            self._rates.clear()
            self._rates.extend(latest)

    def doubts(self, declared: float) -> bool:
        """
        Return whether the stamps contradict the declared rate (Hz) before the rate is measured.

        Examples
        --------
        >>> meter = RateMeter()
        >>> for block in range(25):
        ...     meter.take(1024 * block, round(1024 * block / 12000 * NANO))
        >>> meter.rate, meter.doubts(25600.0), meter.doubts(12000.0)
        (nan, True, False)

        """
        samples, elapsed = (b - a for a, b in zip(self._first, self._latest, strict=True))
        if not elapsed or not math.isnan(self.rate):
            return False
        due = samples * NANO / declared
        return abs(elapsed - due) > REFUSED * max(due, SPAN)

    def problem(self, declared: float) -> RateProblem | None:
        """
        Compare the measured rate with the declared one; None if they agree.

        ``declared`` is the rate in a parameter or message, Hz; above 0.
        """
        measured = self.rate
        off = measured / declared - 1.0
        refused = abs(off) > REFUSED
        if not refused and not (abs(off) > WARNED and len(self._rates) == SPANS):
            return None
        return RateProblem(refused, off_rate(measured, declared))


def off_rate(measured: float, declared: float) -> str:
    """
    Return the text on a measured rate that differs from the declared one, both in Hz.

    >>> off_rate(12000.0, 25600.0)
    '12000 samples a second arrive, sample_rate says 25600 (-53.1 %): set sample_rate to 12000'

    """
    return (
        f'{measured:.5g} samples a second arrive, sample_rate says {declared:.6g} '
        f'({100.0 * (measured / declared - 1.0):+.1f} %): set sample_rate to {round(measured):d}'
    )
