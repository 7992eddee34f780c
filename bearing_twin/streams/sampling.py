# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Samples as they come to blocks with a running index: gaps, rates, channels. Knows no ROS."""

from __future__ import annotations

from collections import deque
import math
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.stamps import NANO, samples_ns
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


ESTIMATE_FROM = 256
"""Stamps from which an unknown sample rate is estimated."""

LONGEST_ESTIMATE = 4 * ESTIMATE_FROM
"""Time from the first to the last of these stamps, in median steps, above which a pause or a
stepped clock lies among them: the memory that the estimate takes grows with it."""

USUAL = 64
"""Last steps of the stamps whose median is the usual one: losses below a half do not move it."""

LONGEST_GAP = 3600 * NANO
"""Step of the stamps above which the clock was set and no samples are missing, ns."""

MOST_MESSAGES = 1_000_000
"""Step of a message number above which the publisher was restarted."""

FOLLOW = 0.02
"""Part of a stamp's deviation by which the expected time of the next one is corrected."""

LEAST_TOLERATED, MOST_TOLERATED = 0.5, 1.5
"""Deviation of a stamp that is still jitter and no gap, sample periods: from regular stamps to
irregular ones, where four times their mean deviation is added."""


def split_channels(
    values: NDArray[np.float32], channels: int, *, interleaved: bool
) -> NDArray[np.float32]:
    """
    Return the samples of each channel, shape (channels, n).

    Where they are ``interleaved`` a sample of every channel comes first, else a channel after the
    other.

    Raises
    ------
    BearingTwinError
        If the values do not divide into the channels.

    """
    flat = np.asarray(values, dtype=np.float32).ravel()
    if flat.size % channels:
        msg = f'{flat.size} values do not divide into {channels} channels; set channels'
        raise BearingTwinError(msg)
    return flat.reshape(-1, channels).T if interleaved else flat.reshape(channels, -1)


class StampTracker:
    """
    See missing samples in the stamps of samples that come one by one.

    Each sample is expected one period after the one before. The expectation follows the stamps
    slowly, so that a rate that is wrong by one percent makes no gaps. Where stamps are regular a
    single missing sample is seen; where they jitter, up to one and a half period passes as jitter,
    once they have shown it: stamps that jitter by over 0.2 periods (RMS) may begin with a gap that
    is none.

    ``rate`` is in Hz; 0 to estimate it from the first stamps.
    """

    def __init__(self, rate: float) -> None:
        self._given = rate
        self.restart()

    def restart(self) -> None:
        """Forget the stamps seen; an estimated rate is estimated anew."""
        self.rate = self._given
        """Sample rate, Hz; 0 while it is not known."""
        self._first: list[int] = []
        self._expected: float | None = None
        self._jitter = 0.12  # until the stamps have shown theirs; a single loss is seen then too
        self._last: int | None = None
        self._steps: deque[int] = deque(maxlen=USUAL)

    @property
    def usual_rate(self) -> float:
        """Rate of the median step of the last stamps, Hz; NaN while there is none."""
        usual = float(np.median(self._steps)) if self._steps else math.nan
        return NANO / usual if usual > 0.0 else math.nan

    def missing(self, stamp: int) -> int:
        """
        Return the samples missing before this one.

        Parameters
        ----------
        stamp
            Time of the sample, ns.

        Returns
        -------
        int
            0 where it follows the last one; negative where its stamp lies so far back, or more
            than an hour ahead, that the clock was set or the source restarted. While
            :attr:`rate` is 0 the answer is 0.

        """
        if not self.rate:
            self._estimate(stamp)
            return 0
        if self._last is not None:
            self._steps.append(stamp - self._last)
        self._last = stamp
        period = NANO / self.rate
        gap = 0
        if self._expected is None:
            self._expected = float(stamp)
        error = stamp - self._expected
        tolerated = min(LEAST_TOLERATED + 4.0 * self._jitter, MOST_TOLERATED) * period
        if abs(error) > tolerated:
            gap = (round(error / period) or -1) if error <= LONGEST_GAP else -1
            self._expected = float(stamp)
            error = 0.0
        self._jitter += FOLLOW * (abs(error) / period - self._jitter)
        self._expected += period + FOLLOW * error
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
        # The rate at which the stamps beat together: neither missing samples nor jitter shift it.
        about = 1.0 / usual
        rates = np.arange(0.9 * about, 1.1 * about, 0.05 / seconds[-1])
        beat = np.abs(np.exp(2j * math.pi * np.outer(rates, seconds)).sum(axis=1))
        self.rate = float(rates[beat.argmax()])
        self._first.clear()


class SequenceTracker:
    """See missing messages in the numbers that the middleware gives them."""

    def __init__(self) -> None:
        self._source: object = None
        self._last: int | None = None

    def missing(self, source: object, number: int | None) -> int:
        """
        Return the messages missing before this one; negative after a new or restarted source.

        Parameters
        ----------
        source
            The publisher.
        number
            The publisher's running number; None where the middleware gives none (0 is returned).

        """
        changed = self._source is not None and source != self._source
        gap = -1 if changed else 0
        if not changed and number is not None and self._last is not None:
            gap = max(0, number - self._last - 1)
            gap = gap if gap <= MOST_MESSAGES else -1
        self._source, self._last = source, number
        return gap


class SampledBlock(NamedTuple):
    """One block to be published."""

    first_sample: int
    stamp: int
    """Time of the first sample, ns."""
    samples: NDArray[np.float32]
    """Shape (channels, n)."""


class BlockBuilder:
    """
    Collect samples into blocks of equal length with a running index.

    Before a gap the samples collected so far are given out as a shorter block, so that a block
    never holds a gap.
    """

    def __init__(self, size: int) -> None:
        self.size = size
        self.next_sample = 0
        self._parts: list[NDArray[np.float32]] = []
        self._count = 0
        self._stamp = 0

    def gap(self, missing: int) -> list[SampledBlock]:
        """
        Give out what is collected; the index then skips ``missing`` samples.

        A negative number starts the index again at 0: the source has restarted.
        """
        blocks = [self._take(self._count)] if self._count else []
        self.next_sample = self.next_sample + missing if missing >= 0 else 0
        return blocks

    def push(self, samples: NDArray[np.float32], *, stamp: int, rate: float) -> list[SampledBlock]:
        """
        Add samples and return the blocks that are full.

        ``stamp``, ns, is that of the first sample; their shape is (channels, n).
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
