# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Absolute deadlines for blocks of samples, and the policy for late blocks."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
import math
from typing import NamedTuple

from bearing_twin.errors import BearingTwinError
from bearing_twin.stamps import NANO, samples_ns
import numpy as np

RECENT = 1500
"""Blocks in the statistics: one minute at 25 blocks/s."""

STEP_TOLERANCE = 50_000_000
"""Difference of the two clocks above which the stamps get a new anchor, ns."""


class Due(NamedTuple):
    """A block that is due."""

    first_sample: int
    stamp: int
    """Time of its first sample on the node's clock, ns."""
    lateness: float
    """Time since its deadline, s."""
    number: int = 0
    """Number of blocks returned so far, including this one."""
    dropped: int = 0
    """Number of blocks skipped so far."""


@dataclass(frozen=True)
class LatenessReport:
    """Lateness of the recent blocks, and counts since the start."""

    published: int
    late: int
    dropped: int
    recently_dropped: int
    """Dropped among the recent blocks, over which the percentiles are taken."""
    clock_steps: int
    p50: float
    p99: float
    worst: float
    """Median, 99th percentile and maximum of the lateness, s; NaN before the first block."""


class Pacer:
    """
    Decide which blocks are due.

    Block k covers samples ``k n .. (k+1) n - 1`` and is due when its last sample has been taken:
    ``start + (k + 1) n / rate``. Deadlines are absolute, so errors do not accumulate. A late
    caller gets up to ``catch_up`` blocks in one call; up to ``behind`` blocks wait. Older blocks
    are skipped and counted. The sample index counts them, so every reader sees the gap.

    Pacing follows ``ticks`` (a steady clock, or /clock); stamps follow the node's clock. Each call
    compares the two clocks: if the node's clock has been stepped or has drifted by more than
    50 ms, the stamps get a new anchor and the step is counted.

    Parameters
    ----------
    block
        Samples per block n.
    rate
        Sample rate, Hz.
    catch_up
        Most blocks that one call returns, at least 1.
    late_after
        Lateness above which a block counts as late, s.
    behind
        Most blocks that may be waiting, including those the present call returns; at least
        ``catch_up``.

    """

    def __init__(
        self, *, block: int, rate: float, catch_up: int, late_after: float, behind: int = 0
    ) -> None:
        if block < 1 or rate <= 0.0 or catch_up < 1:
            raise BearingTwinError(f'{block=}, {rate=}, {catch_up=}: all three must be positive')
        self.block = block
        self.rate = rate
        self.catch_up = catch_up
        self.late_after = late_after
        self.behind = max(behind, catch_up)
        self.next_sample = 0
        self.published = 0
        self.waiting = 0
        """Number of blocks that were due at the last call of :meth:`due` and not returned."""
        self.late = 0
        self.dropped = 0
        self.clock_steps = 0
        self._after_late = -math.inf
        self._recent: deque[float] = deque(maxlen=RECENT)
        self._drops: deque[tuple[int, int]] = deque()
        self._tick_anchor: int | None = None
        self._time_anchor = 0
        self._anchor_sample = 0

    @property
    def period(self) -> float:
        """Time between deadlines, s."""
        return self.block / self.rate

    @property
    def punctual(self) -> float:
        """Duration of the blocks since the last late one, s; infinite if none was late."""
        return (self.next_sample - self._after_late) / self.rate

    def _offset(self, sample: int) -> int:
        """Nanoseconds from the anchor to ``sample``, without accumulated rounding errors."""
        return samples_ns(sample - self._anchor_sample, self.rate)

    def anchor(self, *, ticks: int, time: int) -> None:
        """Let the next block begin now: ``ticks`` on the pacing clock, ``time`` on the node's."""
        self._tick_anchor = ticks
        self._time_anchor = time
        self._anchor_sample = self.next_sample
        self.waiting = 0

    def release(self) -> None:
        """Let the next block begin with the next call of :meth:`due`."""
        self._tick_anchor = None

    def step(self, *, ticks: int, time: int) -> None:
        """Let the next block begin now because a clock was set; arguments as in :meth:`anchor`."""
        self.clock_steps += 1
        self.anchor(ticks=ticks, time=time)

    def due(self, *, ticks: int, time: int) -> list[Due]:
        """Return the blocks to compute now, oldest first; clocks as in :meth:`anchor`."""
        if self._tick_anchor is None:
            self.anchor(ticks=ticks, time=time)
            return []
        elapsed = ticks - self._tick_anchor
        if elapsed < self._offset(self.next_sample) - STEP_TOLERANCE:
            # Blocks of a future time have been returned: the clock was set back.
            self.step(ticks=ticks, time=time)
            return []
        drift = (time - self._time_anchor) - elapsed
        if abs(drift) > STEP_TOLERANCE:
            self.clock_steps += 1
            self._time_anchor += drift
        # Floor division: the last sample of a due block has been taken.
        taken = self._anchor_sample + int(elapsed * self.rate // NANO)
        count = max(0, (taken - self.next_sample) // self.block)
        if count > self.behind:
            skipped = count - self.behind
            self.dropped += skipped
            self._drops.append((self.published, skipped))
            self.next_sample += skipped * self.block
        blocks = []
        for _ in range(min(count, self.catch_up)):
            deadline = self._tick_anchor + self._offset(self.next_sample + self.block)
            lateness = (ticks - deadline) / NANO
            stamp = self._time_anchor + self._offset(self.next_sample)
            number = self.published + 1
            blocks.append(Due(self.next_sample, stamp, lateness, number, self.dropped))
            self.next_sample += self.block
            self.published += 1
            if lateness > self.late_after:
                self.late += 1
                self._after_late = self.next_sample
            self._recent.append(lateness)
        self.waiting = min(count, self.behind) - len(blocks)
        return blocks

    def wake_up(self, ticks: int, slots: int = 1) -> int:
        """
        Return the time of the next wake-up after the one at about ``ticks``, ns.

        There are ``slots`` wake-ups in a period. Their times are computed from the anchor, like
        the deadlines: a timer has a period in whole ns, and would drift by up to 0.1 ms per hour.
        """
        if self._tick_anchor is None:
            return ticks + round(self.period * NANO / slots)
        spacing = self.block * NANO / (self.rate * slots)
        number = round((ticks - self._tick_anchor) / spacing) + 1
        return self._tick_anchor + math.ceil(number * self.block * NANO / (self.rate * slots))

    def phase(self, ticks: int) -> float:
        """Return the elapsed fraction of the current period, 0 to 1."""
        if self._tick_anchor is None:
            return 0.0
        begun = self._tick_anchor + self._offset(self.next_sample)
        return min(max((ticks - begun) / NANO / self.period, 0.0), 1.0)

    def report(self) -> LatenessReport:
        """Return counts and the lateness of the last 1500 blocks."""
        recent = np.array(self._recent) if self._recent else np.array([np.nan])
        p50, p99 = np.percentile(recent, [50, 99])
        while self._drops and self._drops[0][0] < self.published - RECENT:
            self._drops.popleft()
        return LatenessReport(
            self.published,
            self.late,
            self.dropped,
            sum(skipped for _, skipped in self._drops),
            self.clock_steps,
            float(p50),
            float(p99),
            float(recent.max()),
        )
