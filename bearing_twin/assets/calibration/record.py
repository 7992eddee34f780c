# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The newest vibration of one sensor, from which the twin is fitted."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
import math
from typing import TYPE_CHECKING

from bearing_twin.calibration.residual import MOVED
from bearing_twin.diagnosis.streaming import same_rate
from bearing_twin.stamps import NANO
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.streams.vibration_input import VibrationBlock
    from numpy.typing import NDArray


@dataclass
class Record:
    """The newest blocks of one sensor, without a gap."""

    blocks: deque[VibrationBlock] = field(default_factory=deque)
    """The shaft speed of each is the one to use, NaN where none is known."""
    held: int = 0
    """Samples."""

    @property
    def newest(self) -> VibrationBlock:
        """The newest block."""
        return self.blocks[-1]

    @property
    def sample_rate(self) -> float:
        """Of the oldest block, Hz: those of the others may differ by what clocks drift."""
        return self.blocks[0].sample_rate

    @property
    def end(self) -> int:
        """Index of the sample that is still to come."""
        return self.newest.first_sample + len(self.newest.samples)

    def add(self, block: VibrationBlock, most: int) -> None:
        """Append a block, and drop the oldest as long as ``most`` samples are left."""
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
        """Return the sample rate that the stamps tell, Hz; NaN where they stand still."""
        elapsed = self.newest.stamp - self.blocks[0].stamp
        before = self.held - len(self.newest.samples)
        return before * NANO / elapsed if elapsed > 0 else math.nan

    def samples(self, wanted: int) -> NDArray[np.float64]:
        """Return the newest samples."""
        parts = [block.samples for block in self.blocks]
        return np.concatenate(parts)[-wanted:].astype(np.float64)

    def shaft_hz(self) -> tuple[float, str]:
        """Return the mean speed, Hz, and why there is none to fit at; '' if there is."""
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
