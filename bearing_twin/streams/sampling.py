# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Incoming samples to blocks with a running index: gaps, rates, channels."""

from __future__ import annotations

from collections import deque
import math
from typing import Any, NamedTuple

from bearing_twin.errors import BearingTwinError
from bearing_twin.stamps import NANO, samples_ns
import numpy as np
from numpy.typing import NDArray

ESTIMATE_FROM = 256
"""Number of stamps for the estimate of an unknown sample rate."""

LONGEST_ESTIMATE = 4 * ESTIMATE_FROM
"""Longest time from the first to the last of these stamps, in median steps. A longer time contains
a pause or a clock step, and the memory of the estimate grows with it."""

MEDIAN_STEPS = 64
"""Number of stamp steps in the median; it does not move while less than half of them are gaps."""

LONGEST_GAP = 3600 * NANO
"""Stamp step, ns, above which the clock was set and no samples are missing."""

MOST_MESSAGES = 1_000_000
"""Step of a message number above which the publisher was restarted."""

TRACKING_GAIN = 0.02
"""Fraction of a stamp's deviation that corrects the expected time of the next stamp."""

LEAST_TOLERATED, MOST_TOLERATED = 0.5, 1.5
"""Limits of the deviation of a stamp that counts as jitter, sample periods. The first holds for
regular stamps. For irregular ones four times their mean deviation is added, up to the second."""


def split_channels(
    values: NDArray[Any], channels: int, *, interleaved: bool
) -> NDArray[np.float32]:
    """
    Return the samples of each channel, shape (channels, n).

    ``interleaved`` values begin with one sample of every channel; otherwise all samples of the
    first channel come first.

    Raises
    ------
    BearingTwinError
        If the number of values is not a multiple of the channels.

    """
    # What is too large for these numbers becomes infinite, and is counted as not finite.
    with np.errstate(over='ignore'):
        flat = np.asarray(values).astype(np.float32).ravel()
    if flat.size % channels:
        msg = f'{flat.size} values do not divide into {channels} channels; set channels'
        raise BearingTwinError(msg)
    return flat.reshape(-1, channels).T if interleaved else flat.reshape(channels, -1)


class StampTracker:
    """
    Detect missing samples from the stamps of samples that arrive one by one.

    Each sample is expected one period after the one before. The expected time follows the stamps
    slowly, so a rate that is wrong by one percent causes no gaps. With regular stamps a single
    missing sample is detected. With jitter, deviations up to 1.5 periods are tolerated once the
    jitter has been measured: stamps that jitter by over 0.2 periods (RMS) may cause a false gap at
    the beginning.

    ``rate`` is in Hz; with 0 it is estimated from the first stamps.
    """

    def __init__(self, rate: float) -> None:
        self._given = rate
        self.restart()

    def restart(self) -> None:
        """Forget all stamps; an estimated rate is estimated again."""
        self.rate = self._given
        """Sample rate, Hz; 0 while it is not known."""
        self.crowded = False
        """Whether the last stamp is after the one before, but by less than the jitter allows. A
        source that stamps its samples when it sends them, and was held up, does so."""
        self._first: list[int] = []
        self._expected: float | None = None
        self._jitter = 0.12  # start value, low enough to detect a single loss
        self._last: int | None = None
        self._steps: deque[int] = deque(maxlen=MEDIAN_STEPS)

    @property
    def usual_rate(self) -> float:
        """Inverse of the median step of the last stamps, Hz; NaN before the first step."""
        usual = float(np.median(self._steps)) if self._steps else math.nan
        return NANO / usual if usual > 0.0 else math.nan

    def missing(self, stamp: int) -> int:
        """
        Return the number of samples missing before the one at ``stamp``, ns.

        It is 0 if the sample follows the last one, and always while :attr:`rate` is 0. It is
        negative if the stamp is too early, beyond the jitter, or more than an hour late: the clock
        was set or the source restarted.
        """
        if not self.rate:
            self._estimate(stamp)
            return 0
        in_order = self._last is not None and stamp > self._last
        if self._last is not None:
            self._steps.append(stamp - self._last)
        self._last = stamp
        period = NANO / self.rate
        gap = 0
        self.crowded = False
        if self._expected is None:
            self._expected = float(stamp)
        error = stamp - self._expected
        tolerated = min(LEAST_TOLERATED + 4.0 * self._jitter, MOST_TOLERATED) * period
        if abs(error) > tolerated:
            gap = (round(error / period) or -1) if error <= LONGEST_GAP else -1
            self.crowded = in_order and error < 0.0
            self._expected = float(stamp)
            error = 0.0
        self._jitter += TRACKING_GAIN * (abs(error) / period - self._jitter)
        self._expected += period + TRACKING_GAIN * error
        return gap

    def _estimate(self, stamp: int) -> None:
        if self._first and stamp <= self._first[-1]:
            self._first.clear()
        self._first.append(stamp)
        if len(self._first) < ESTIMATE_FROM:
            return
        seconds = (np.array(self._first, dtype=np.int64) - self._first[0]) / NANO
        steps = np.diff(seconds)
        usual = float(np.median(steps))
        if seconds[-1] > LONGEST_ESTIMATE * usual:
            del self._first[: int(steps.argmax()) + 1]
            return
        # The rate at which the stamps are most in phase: lost samples and jitter do not shift it.
        about = 1.0 / usual
        rates = np.arange(0.9 * about, 1.1 * about, 0.05 / seconds[-1])
        beat = np.abs(np.exp(2j * math.pi * np.outer(rates, seconds)).sum(axis=1))
        self.rate = float(rates[beat.argmax()])
        self._first.clear()


class SequenceTracker:
    """Detect missing messages from the sequence numbers of the middleware."""

    def __init__(self) -> None:
        self._source: object = None
        self._last: int | None = None

    def missing(self, source: object, number: int | None) -> int:
        """
        Return the number of messages missing before this one.

        It is negative for a new or restarted source.

        Parameters
        ----------
        source
            Identity of the publisher.
        number
            Sequence number of the publisher; None if the middleware gives none (0 is returned).

        """
        changed = self._source is not None and source != self._source
        gap = -1 if changed else 0
        if not changed and number is not None and self._last is not None:
            gap = max(0, number - self._last - 1)
            gap = gap if gap <= MOST_MESSAGES else -1
        self._source, self._last = source, number
        return gap


class SampledBlock(NamedTuple):
    """A block to publish."""

    first_sample: int
    stamp: int
    """Time of the first sample, ns."""
    samples: NDArray[np.float32]
    """Shape (channels, n)."""


class BlockBuilder:
    """
    Collect samples into blocks of equal length with a running index.

    At a gap the samples collected so far become a shorter block, so a block never contains a gap.
    """

    def __init__(self, size: int) -> None:
        self.size = size
        self.next_sample = 0
        self._parts: list[NDArray[np.float32]] = []
        self._count = 0
        self._stamp = 0

    def gap(self, missing: int) -> list[SampledBlock]:
        """
        Return the collected samples as a block, and skip ``missing`` samples in the index.

        With a negative number, after a restart of the source, the index begins again at 0.
        """
        blocks = [self._take(self._count)] if self._count else []
        self.next_sample = self.next_sample + missing if missing >= 0 else 0
        return blocks

    def push(self, samples: NDArray[np.float32], *, stamp: int, rate: float) -> list[SampledBlock]:
        """
        Add samples, shape (channels, n), and return the full blocks.

        ``stamp`` is the time of the first sample, ns; ``rate`` is in Hz.
        """
        blocks = []
        done = 0
        while done < samples.shape[1]:
            if not self._count:
                self._stamp = stamp + samples_ns(done, rate)
            part = samples[:, done : done + self.size - self._count]
            self._parts.append(part)
            self._count += part.shape[1]
            done += part.shape[1]
            if self._count == self.size:
                blocks.append(self._take(self.size))
        return blocks

    def _take(self, count: int) -> SampledBlock:
        block = SampledBlock(self.next_sample, self._stamp, np.concatenate(self._parts, axis=1))
        self.next_sample += count
        self._parts.clear()
        self._count = 0
        return block
