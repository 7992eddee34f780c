# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One update of a stream: the window that is due, to be analysed wherever there is time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.chain import conclude
from bearing_twin.diagnosis.gate import check_record, check_speeds
from bearing_twin.diagnosis.report import insufficient, not_shown
from bearing_twin.diagnosis.shaft import resample_to_angle, varies
from bearing_twin.diagnosis.window import analyse_window, highest_fault_order
import numpy as np

if TYPE_CHECKING:
    from collections import deque
    from collections.abc import Sequence

    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.comb import OrderSpectra
    from bearing_twin.diagnosis.result import Diagnosis
    from bearing_twin.diagnosis.settings import DiagnosisSettings
    from bearing_twin.diagnosis.window import Window
    from numpy.typing import NDArray

__all__ = ['Analysis', 'Update']


@dataclass(frozen=True)
class Analysis:
    """What the samples of a window say, before anything that came earlier is asked."""

    answer: Diagnosis | Window
    """Verdict on the window alone; where windows before it have a say, the window itself."""
    shaft_hz: float
    """Mean speed over the window, Hz."""
    refused: bool = False
    """Whether the gate has refused it: then it says nothing about the machine."""


@dataclass(frozen=True, kw_only=True)
class Update:
    """Everything that an update rests on; nothing that is pushed later changes it."""

    samples: NDArray[np.float64]
    """The window, shape (n,)."""
    shaft_hz: NDArray[np.float64]
    """Speed handed in with each block of it, Hz, shape (b,)."""
    lengths: NDArray[np.intp]
    """Samples of each block, shape (b,); they add up to n."""
    end: int
    """Index of the sample after the window."""
    sample_rate: float
    bearing: Bearing
    settings: DiagnosisSettings
    speed_measured: bool
    temperature: float
    unit: str
    notes: Sequence[str]
    """What happened to the stream since the update before."""
    earlier: deque[tuple[int, OrderSpectra]]
    """Windows of the same run of samples, each with its end; the stream's, not to be changed."""

    @property
    def first_sample(self) -> int:
        """Index of the first sample of the window."""
        return self.end - len(self.samples)

    def analyse(self) -> Analysis:
        """Analyse the window: most of the work of an update, and a function of it alone."""
        x = self.samples
        speeds = np.repeat(self.shaft_hz, self.lengths)
        mean_hz = float(speeds.mean())
        reasons = check_record(x, self.sample_rate, mean_hz, highest_fault_order(self.bearing))
        if reasons:
            reasons += not_shown(
                x,
                self.sample_rate,
                mean_hz,
                temperature=self.temperature,
                unit=self.unit,
                bearing=self.bearing,
            )
        else:
            reasons = check_speeds(self.shaft_hz)
        if reasons:
            refused = insufficient(
                [*self.notes, *reasons],
                self.bearing,
                first_sample=self.first_sample,
                sample_count=len(self.samples),
                sample_rate=self.sample_rate,
                shaft_hz=mean_hz,
                temperature=self.temperature,
                unit=self.unit,
            )
            return Analysis(refused, mean_hz, refused=True)
        if varies(speeds):
            x, mean_hz = resample_to_angle(x, self.sample_rate, speeds)
        settings = self.settings
        if self.speed_measured:
            settings = replace(settings, speed_tolerance=settings.measured_speed_tolerance)
        window = analyse_window(
            x, self.sample_rate, self.bearing, mean_hz, settings, unit=self.unit
        )
        if settings.averages or self.earlier:
            return Analysis(window, mean_hz)
        return Analysis(self.conclude(window, mean_hz), mean_hz)

    def conclude(
        self, window: Window, shaft_hz: float, earlier: Sequence[OrderSpectra] = ()
    ) -> Diagnosis:
        """Judge the analysed window, averaged with ``earlier`` ones, oldest first."""
        return conclude(
            window,
            self.bearing,
            earlier=earlier,
            shaft_hz_given=shaft_hz,
            notes=self.notes,
            first_sample=self.first_sample,
            sample_count=len(self.samples),
            sample_rate=self.sample_rate,
            temperature=self.temperature,
        )
