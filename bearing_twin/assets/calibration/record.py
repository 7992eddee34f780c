# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The newest vibration of one sensor, to which the twin is fitted."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
import math
from typing import TYPE_CHECKING

from bearing_twin.calibration.residual import MOVED
from bearing_twin.diagnosis.streaming import same_rate
from bearing_twin.stamps import NANO
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.streams.vibration_input import VibrationBlock


@dataclass
class Record:
    """The newest blocks of one sensor, without a gap."""

    blocks: deque[VibrationBlock] = field(default_factory=deque)
    """Blocks in order; the shaft speed of each is set, or NaN if unknown."""
    held: int = 0
    """Number of samples in the blocks."""

    @property
    def newest(self) -> VibrationBlock:
        """Return the newest block."""
        return self.blocks[-1]

    @property
    def sample_rate(self) -> float:
        """Sample rate of the oldest block, Hz; later rates may differ slightly by clock drift."""
        return self.blocks[0].sample_rate

    @property
    def end(self) -> int:
        """Index of the next sample."""
        return self.newest.first_sample + len(self.newest.samples)

    def add(self, block: VibrationBlock, most: int) -> None:
        """Append a block; drop the oldest blocks while at least ``most`` samples remain."""
        if not (self.blocks and self._goes_on(block)):
            self.blocks.clear()
            self.held = 0
        self.blocks.append(block)
        self.held += len(block.samples)
        while self.held - len(self.blocks[0].samples) >= most:
            self.held -= len(self.blocks.popleft().samples)

    def _goes_on(self, block: VibrationBlock) -> bool:
        was = (self.end, self.newest.unit, self.newest.frame_id)
        alike = (block.first_sample, block.unit, block.frame_id) == was
        return alike and same_rate(self.sample_rate, block.sample_rate)

    def stamped_rate(self) -> float:
        """Return the sample rate by the stamps, Hz; NaN if the stamps do not advance."""
        elapsed = self.newest.stamp - self.blocks[0].stamp
        before = self.held - len(self.newest.samples)
        return before * NANO / elapsed if elapsed > 0 else math.nan

    def samples(self, wanted: int) -> NDArray[np.float64]:
        """Return the newest samples, shape (wanted,)."""
        parts = [block.samples for block in self.blocks]
        return np.concatenate(parts)[-wanted:].astype(np.float64)

    def shaft_hz(self) -> tuple[float, str]:
        """Return the mean shaft speed, Hz, and ''; or NaN and why no speed can be used."""
        speeds = np.array([block.shaft_hz for block in self.blocks])
        if not np.isfinite(speeds).all():
            return math.nan, 'no shaft speed: set shaft_hz, or joint where joint_states has it'
        slowest, fastest = float(speeds.min()), float(speeds.max())
        mean = float(np.average(speeds, weights=[len(block.samples) for block in self.blocks]))
        if fastest <= 0.0:
            return math.nan, 'the shaft stands still: start the machine'
        if fastest - slowest > MOVED * mean:
            return math.nan, (
                f'the speed moved from {slowest:.3g} to {fastest:.3g} Hz within the window, more '
                f'than {100.0 * MOVED:g} %: keep it steady, or choose a shorter window'
            )
        return mean, ''
