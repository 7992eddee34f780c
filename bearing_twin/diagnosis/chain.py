# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The one path from samples to a verdict, for windows of a stream and whole records."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
import math
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.comb import accumulate, OrderSpectra
from bearing_twin.diagnosis.evidence import Evidence
from bearing_twin.diagnosis.gate import check_record, check_speeds
from bearing_twin.diagnosis.report import insufficient, not_shown, report
from bearing_twin.diagnosis.rules import decide
from bearing_twin.diagnosis.search import CombSearch
from bearing_twin.diagnosis.shaft import resample_to_angle, ShaftSpeed, varies
from bearing_twin.diagnosis.sidebands import sideband_ratio
from bearing_twin.diagnosis.window import analyse_window, highest_fault_order
import numpy as np
from scipy import fft

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.result import Diagnosis
    from bearing_twin.diagnosis.settings import DiagnosisSettings
    from bearing_twin.diagnosis.verdict import Verdict
    from bearing_twin.diagnosis.window import Window
    from numpy.typing import NDArray

__all__ = ['Analysis', 'Excerpt']

_CLEARER = 1.1
_SIDEBANDS_SHOWN = 0.25


@dataclass(frozen=True, kw_only=True)
class Excerpt:
    """Samples that get one verdict: a window of a stream, or a whole record."""

    samples: NDArray[np.float64]
    """Shape (n,)."""
    shaft_hz: NDArray[np.float64]
    """Speed during each part of them, Hz, shape (b,)."""
    lengths: NDArray[np.intp]
    """Samples of each part, shape (b,); they add up to n."""
    sample_rate: float
    bearing: Bearing
    settings: DiagnosisSettings
    first_sample: int = 0
    temperature: float = math.nan
    unit: str = ''
    sensor: str = ''
    """Frame and axis, and ' simulated' where a twin makes the samples."""
    notes: tuple[str, ...] = ()
    """What happened to the stream since the excerpt before."""
    run: int = 0
    """Number of the uninterrupted run of samples that it belongs to."""
    longest: float = math.inf
    """Most shaft turns that are analysed together; more are cut, and their spectra averaged."""

    @property
    def end(self) -> int:
        """Index of the sample after the last."""
        return self.first_sample + len(self.samples)

    @property
    def simulated(self) -> bool:
        """Whether a twin makes the samples, so that sizes of its faults may be named."""
        return self.sensor.endswith(' simulated')

    def analyse(self) -> Analysis:
        """Analyse the samples: most of the work of a verdict, and a function of them alone."""
        x, rate, bearing = self.samples, self.sample_rate, self.bearing
        speeds = self.shaft_hz
        if len(speeds) > 1:
            speeds = np.repeat(speeds, self.lengths)
        mean_hz = float(speeds.mean()) if len(speeds) else math.nan
        reasons = check_record(x, rate, mean_hz, highest_fault_order(bearing))
        if reasons and self.simulated:
            reasons += not_shown(
                x, rate, mean_hz, temperature=self.temperature, unit=self.unit, bearing=bearing
            )
        reasons = reasons or check_speeds(self.shaft_hz)
        if reasons:
            return Analysis(self, mean_hz, refused=tuple(reasons))
        if varies(speeds):
            x, mean_hz = resample_to_angle(x, rate, speeds)
        pieces = max(1, round(len(x) / rate * mean_hz / self.longest))
        length = fft.prev_fast_len(len(x) // pieces) if math.isfinite(self.longest) else len(x)
        windows = [
            analyse_window(
                x[i * length : (i + 1) * length],
                rate,
                bearing,
                mean_hz,
                self.settings,
                unit=self.unit,
            )
            for i in range(pieces)
        ]
        analysis = Analysis(self, mean_hz, windows[-1], tuple(w.orders for w in windows[:-1]))
        if not self.settings.averages:
            # Decided here, where there may be other threads to do it, and not when it is asked.
            _ = analysis.alone
        return analysis


@dataclass(frozen=True)
class Analysis:
    """What the samples of an excerpt say, before anything that came earlier is asked."""

    excerpt: Excerpt
    shaft_hz: float
    """Mean speed, Hz."""
    window: Window | None = None
    """The newest window; None where the record gate refused the excerpt."""
    before: tuple[OrderSpectra, ...] = ()
    """Spectra of the excerpt's windows before it, oldest first."""
    refused: tuple[str, ...] = ()
    """Why the record gate refused it."""

    @cached_property
    def alone(self) -> Diagnosis:
        """Diagnosis from these samples alone."""
        return self._conclude(())

    def conclude(self, earlier: Sequence[OrderSpectra] = ()) -> Diagnosis:
        """Diagnosis from these samples and the spectra of earlier windows, oldest first."""
        return self._conclude(earlier) if earlier else self.alone

    def _conclude(self, earlier: Sequence[OrderSpectra]) -> Diagnosis:
        excerpt = self.excerpt
        if self.window is None:
            return insufficient(
                [*excerpt.notes, *self.refused],
                excerpt.bearing,
                first_sample=excerpt.first_sample,
                sample_count=len(excerpt.samples),
                sample_rate=excerpt.sample_rate,
                shaft_hz=self.shaft_hz,
                temperature=excerpt.temperature,
                unit=excerpt.unit,
            )
        windows = [*earlier, *self.before, self.window.orders]
        verdict, speed = _verdict(
            windows,
            excerpt.bearing,
            self.window.speed,
            self.shaft_hz,
            self.window.revolutions * len(windows),
        )
        return report(
            replace(verdict, reasons=(*excerpt.notes, *verdict.reasons)),
            replace(self.window, speed=speed),
            excerpt.bearing,
            first_sample=excerpt.first_sample,
            sample_count=len(excerpt.samples),
            sample_rate=excerpt.sample_rate,
            shaft_hz_given=self.shaft_hz,
            temperature=excerpt.temperature,
            simulated=excerpt.simulated,
        )


def _verdict(
    windows: Sequence[OrderSpectra],
    bearing: Bearing,
    speed: ShaftSpeed,
    given_hz: float,
    turns: float,
) -> tuple[Verdict, ShaftSpeed]:
    """Verdict on the mean of several windows, and the speed on which it rests."""

    def decided(spectra: OrderSpectra, speed: ShaftSpeed) -> Verdict:
        return decide(Evidence(CombSearch(spectra, bearing, speed), turns))

    verdict = decided(accumulate(windows), speed)
    if speed.shaft_hz == given_hz:
        return verdict, speed
    # A fault beside an integer order can pass for a shaft that runs a little off: the speed under
    # which the fault shows more clearly is then the right one.
    apart = abs(speed.shaft_hz / given_hz - 1.0)
    given = ShaftSpeed(given_hz, max(speed.uncertainty, apart), 0.0, speed.tolerance)
    at_given = accumulate([window.at_given_speed() for window in windows])
    other = decided(at_given, given)
    clearer = other.level == 'fault' and other.weight > _CLEARER * verdict.weight
    if clearer and _mistaken(at_given, other, speed.shaft_hz / given_hz):
        return other, given
    return verdict, speed


def _mistaken(at_given: OrderSpectra, verdict: Verdict, gap: float) -> bool:
    """
    Whether the lines of a fault were mistaken for the harmonics of the shaft.

    They can be where the fault's order is a whole number at the refined speed, unless the fault
    itself has sidebands ``gap`` (refined over given speed) apart: the shaft does turn like that.
    """
    found = verdict.strongest
    if found is None:
        return False
    order = found.order / gap
    if abs(order - round(order)) > 3.0 * at_given.step:
        return False
    refined, given = (
        sideband_ratio(at_given, found.order, found.band, side) for side in (gap, 1.0)
    )
    return refined < max(_CLEARER * given, _SIDEBANDS_SHOWN)
