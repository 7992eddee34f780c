# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Path from samples to a diagnosis, for windows of a stream and for whole records."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial
import itertools
import math
import threading
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import fault_frequencies, PLACES
from bearing_twin.diagnosis.combs.comb import accumulate, OrderSpectra
from bearing_twin.diagnosis.combs.harmonics import spaced_by_shaft
from bearing_twin.diagnosis.combs.plain_lines import low_lines
from bearing_twin.diagnosis.combs.search import CombSearch
from bearing_twin.diagnosis.combs.sidebands import sideband_ratio
from bearing_twin.diagnosis.detection_power import smallest_detectable
from bearing_twin.diagnosis.result import Diagnosis, insufficient
from bearing_twin.diagnosis.rules.evidence import Evidence
from bearing_twin.diagnosis.rules.table import answer, with_confidence_basis
from bearing_twin.diagnosis.signal.demodulation import (
    choose_layout,
    demodulate,
    highest_fault_order,
    SECONDS,
)
from bearing_twin.diagnosis.signal.drift import without_drift
from bearing_twin.diagnosis.signal.gate import check_record, Extent, FAINTEST, LARGEST
from bearing_twin.diagnosis.signal.severity import (
    Levels,
    measure_severity,
    SHORTEST,
    SLOW_HZ,
    valid_for_length,
)
from bearing_twin.diagnosis.signal.shaft import shafts_instead_hz, ShaftSpeed, SpeedProfile
from bearing_twin.diagnosis.thresholds import HARMONICS, INDEX_FAULT, RIVAL, SWAY, Z_SECOND_LOOK
from bearing_twin.diagnosis.window import analyse_window
import numpy as np
from numpy.typing import NDArray
from scipy import fft

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing, FaultFrequencies
    from bearing_twin.diagnosis.combs.candidate import Candidate
    from bearing_twin.diagnosis.result import Spectrum
    from bearing_twin.diagnosis.rules.verdict import Verdict
    from bearing_twin.diagnosis.settings import DiagnosisSettings
    from bearing_twin.diagnosis.signal.demodulation import Layout, Segment
    from bearing_twin.diagnosis.signal.severity import Severity
    from bearing_twin.diagnosis.window import Window


_CLEARER = 1.1
_KEPT_BYTES = 1 << 21
"""More than the bytes of any array of a window of 8 s at 25.6 kHz."""
_NO_ZONE = (
    f'no zone of ISO 20816-3: below {60.0 * SLOW_HZ:g} 1/min its velocity is that from 2 Hz on, '
    'and this one is from 10 Hz on'
)


@cache
def _keep_memory() -> None:
    """
    Make the C library keep the memory of a window for the next one.

    Glibc maps an array anew, page by page, if it is larger than every array freed before
    (``M_MMAP_THRESHOLD``). This took up to a third of the time of a verdict.
    """
    np.empty(_KEPT_BYTES, np.uint8)


class Stretch:
    """
    Consecutive samples, the step by which windows move on, with their computed segments.

    The samples have the shape (n,); ``speed_profile`` is the shaft speed during each part of them.
    """

    def __init__(self, samples: NDArray[np.float64], speed_profile: SpeedProfile) -> None:
        self.samples = samples
        self.speed_profile = speed_profile
        self._segments: dict[Layout, Segment] = {}
        self._lock = threading.Lock()

    @cached_property
    def extent(self) -> Extent:
        """Range of the samples."""
        return Extent.of(self.samples)

    def segment(self, layout: Layout, before: Sequence[Stretch]) -> Segment:
        """Return the segment that ends here; ``before``: the stretches right before this one."""
        with self._lock:
            segment = self._segments.get(layout)
            if segment is None:
                first, *parts = [stretch.samples for stretch in (*before, self)]
                missing = layout.hop + layout.lap - sum(map(len, parts))
                samples = np.concatenate((first[-missing:], *parts))
                segment = self._segments[layout] = demodulate(samples, layout)
            return segment


def is_simulated(sensor: str) -> bool:
    """
    Return whether a twin is the sensor, by its name.

    >>> is_simulated('bearing_housing y simulated'), is_simulated('bearing_housing y')
    (True, False)

    """
    return sensor.endswith(' simulated')


@dataclass(frozen=True, kw_only=True)
class Excerpt:
    """Samples that get one verdict: a window of a stream, or a whole record."""

    stretches: tuple[Stretch, ...]
    """Stretches of equal length."""
    before: Stretch | None = None
    """Stretch of the same length right before them, if there is one."""
    sample_rate: float
    bearing: Bearing
    settings: DiagnosisSettings
    first_sample: int = 0
    temperature: float = math.nan
    unit: str = ''
    sensor: str = ''
    """Frame and axis, with ' simulated' if a twin makes the samples."""
    notes: tuple[str, ...] = ()
    """Events of the stream since the previous excerpt."""
    run: int = 0
    """Number of the uninterrupted run of samples that holds the excerpt."""
    time: float = math.nan
    """Time of a snapshot of a series, s."""
    left_over: int = 0
    """Number of samples after the stretches, which are not analysed."""
    pieces: int = 1
    """Number of equally long windows in it; their spectra are averaged."""

    @classmethod
    def of(
        cls,
        samples: NDArray[np.float64],
        speed_profile: SpeedProfile | float,
        sample_rate: float,
        bearing: Bearing,
        settings: DiagnosisSettings,
        *,
        longest: float = math.inf,
        divided: bool = True,
        **known: Any,
    ) -> Excerpt:
        """
        Return an excerpt of samples that are all available.

        Parameters
        ----------
        samples
            Shape (n,).
        speed_profile
            Shaft speed during each part of the samples, or one steady speed, Hz.
        sample_rate, bearing, settings
            See the fields.
        longest
            Largest length of a window, shaft turns.
        divided
            Whether each segment of a window is whitened by its own noise; else the window as a
            whole.
        known
            Other fields.

        >>> from bearing_twin.bearing import find_bearing
        >>> from bearing_twin.diagnosis.settings import DiagnosisSettings
        >>> x = np.random.default_rng(0).standard_normal(51200)
        >>> known = 25600.0, find_bearing('6307'), DiagnosisSettings()
        >>> Excerpt.of(x, 25.0, *known).analyse().alone.result
        'healthy'

        """
        count, pieces, stretches = len(samples), 1, 1
        if not isinstance(speed_profile, SpeedProfile):
            speed_profile = SpeedProfile(np.array([speed_profile]), np.array([count]))
        if count and math.isfinite(sample_rate) and sample_rate > 0.0:
            turns = count / sample_rate * speed_profile.mean_hz
            # A shaft that stands still, or turns once in less than two samples, has no turns to
            # count.
            pieces = max(1, round(turns / longest)) if 0.0 < turns < count / 2 else 1
            if divided:
                each = max(SECONDS * sample_rate, SHORTEST)
                stretches = max(1, round(count / pieces / each))
        length = fft.prev_fast_len(max(count // (pieces * stretches), 1), real=True)
        edges = np.arange(pieces * stretches + 1) * min(length, count)
        return cls(
            stretches=tuple(
                Stretch(samples[begin:end], part)
                for (begin, end), part in zip(
                    itertools.pairwise(edges), speed_profile.parts(edges), strict=True
                )
            ),
            left_over=count - int(edges[-1]),
            sample_rate=sample_rate,
            bearing=bearing,
            settings=settings,
            pieces=pieces,
            **known,
        )

    @property
    def samples(self) -> NDArray[np.float64]:
        """Return the samples of all stretches."""
        return np.concatenate([stretch.samples for stretch in self.stretches])

    @cached_property
    def speed_profile(self) -> SpeedProfile:
        """Speed of the shaft."""
        return _together(self.stretches)

    @cached_property
    def sample_count(self) -> int:
        """Return the number of samples."""
        return sum(len(stretch.samples) for stretch in self.stretches) + self.left_over

    @property
    def end(self) -> int:
        """Index of the sample after the last."""
        return self.first_sample + self.sample_count

    @property
    def simulated(self) -> bool:
        """Whether a twin makes the samples, so that fault sizes may be named."""
        return is_simulated(self.sensor)

    def analyse(self) -> Analysis:
        """Return the analysis of these samples alone, which is most of the work of a verdict."""
        _keep_memory()
        rate, bearing = self.sample_rate, self.bearing
        profile = self.speed_profile
        mean_hz = profile.mean_hz
        extents = [stretch.extent for stretch in self.stretches]
        reasons = check_record(extents, rate, mean_hz, highest_fault_order(bearing))
        if not reasons and not ((profile.shaft_hz > 0.0) & np.isfinite(profile.shaft_hz)).all():
            reasons = ['the shaft stood still or turned backwards within the window']
        if reasons:
            return Analysis(self, mean_hz, refused=tuple(reasons))
        count = len(self.stretches) // self.pieces
        layout = choose_layout(
            rate,
            len(self.stretches[0].samples),
            count,
            bearing,
            mean_hz,
            float(profile.shaft_hz.max()) if profile.varies else 0.0,
        )
        windows = [self._window(piece * count, count, layout) for piece in range(self.pieces)]
        analysis = Analysis(self, mean_hz, windows[-1], tuple(w.orders for w in windows[:-1]))
        if not self.settings.averages:
            # Decided here, because this may run in another thread, and not when it is asked for.
            _ = analysis.alone
        return analysis

    def severity(self, shaft_hz: float) -> Severity | None:
        """
        Return the severity of samples that the record gate refused; None if it cannot be measured.

        Clipping only lowers it. At an unknown speed a zone is given only from C on, as for a slow
        machine. A shaft that stands still has no severity.
        """
        x, settings = self.samples, self.settings
        # At the smallest sampling rates the width of a bin underflows to 0.
        if len(x) < SHORTEST or not 0.0 < self.sample_rate / len(x) < math.inf or shaft_hz == 0.0:
            return None
        if not np.abs(x).max() <= LARGEST or not np.ptp(x) > FAINTEST:
            return None
        spectrum = fft.rfft(without_drift(x)) / len(x)
        found = measure_severity(
            Levels.of(x, spectrum, self.sample_rate), unit=self.unit or settings.unit,
            power_group=settings.power_group, mounting=settings.mounting,
            shaft_hz=shaft_hz if math.isfinite(shaft_hz) else 0.0,
        )  # fmt: skip
        return valid_for_length(found, len(x), self.sample_rate)

    def _window(self, first: int, count: int, layout: Layout) -> Window:
        """Return the window of ``count`` stretches from ``first`` on."""
        each = layout.hop // len(self.stretches[0].samples)
        # A NaN before the window must not enter it through the lap of the first segment.
        before = (self.before,) if self.before and not self.before.extent.bad else ()
        known = (*before, *self.stretches)
        offset = first + len(known) - len(self.stretches)
        segments = [
            known[end - 1].segment(layout, known[max(end - each - 1, 0) : end - 1])
            for end in range(offset + each, offset + count + 1, each)
        ]
        whole = self.pieces == 1
        profile = self.speed_profile if whole else _together(self.stretches[first:][:count])
        return analyse_window(
            segments, layout, self.bearing, profile, self.settings, unit=self.unit
        )


def _together(stretches: Sequence[Stretch]) -> SpeedProfile:
    """Return the speed during several stretches."""
    parts = [stretch.speed_profile for stretch in stretches]
    return SpeedProfile(
        np.concatenate([part.shaft_hz for part in parts]),
        np.concatenate([part.lengths for part in parts]),
    )


@dataclass(frozen=True)
class Analysis:
    """Analysis of the samples of an excerpt, without earlier windows."""

    excerpt: Excerpt
    shaft_hz: float
    """Mean speed, Hz."""
    window: Window | None = None
    """Newest window; None if the record gate refused the excerpt."""
    before: tuple[OrderSpectra, ...] = ()
    """Spectra of the earlier windows of the excerpt, oldest first."""
    refused: tuple[str, ...] = ()
    """Why the record gate refused the excerpt."""

    @cached_property
    def alone(self) -> Diagnosis:
        """Diagnosis from these samples alone."""
        return self.conclude(())

    def may_show(self, hertz: float, clearest: float) -> bool:
        """
        Return whether a comb at another shaft speed, Hz, is worth a diagnosis at that speed.

        ``clearest`` is the score of the clearest comb of an alarm at the given speed, or 0. At up
        to four times the given speed the spectra hold at least the first of the four lines of a
        comb. So they show at least half of its index, and a score that grows with the root of the
        number of lines. There the comb must come within 3 dB of ``clearest``.
        """
        if self.window is None:
            return False
        orders, speed = self.window.orders, self.window.speed
        there = replace(orders, given=hertz / speed.shaft_hz).at_given_speed()
        combs = CombSearch(there, self.excerpt.bearing, speed._replace(shaft_hz=hertz))

        def shows(comb: Candidate) -> bool:
            shown = min(there.top / comb.order, HARMONICS) // 1.0 / HARMONICS
            least = max(Z_SECOND_LOOK, clearest / RIVAL * math.sqrt(shown))
            return comb.z >= least and comb.index >= 0.5 * INDEX_FAULT

        return any(shows(combs.best(place)) for place in PLACES)

    def conclude(self, earlier: Sequence[OrderSpectra]) -> Diagnosis:
        """Return the diagnosis from these samples and spectra of earlier windows, oldest first."""
        excerpt, window = self.excerpt, self.window
        taken: dict[str, Any] = {
            'first_sample': excerpt.first_sample,
            'sample_count': excerpt.sample_count,
            'sample_rate': excerpt.sample_rate,
            'temperature': excerpt.temperature,
        }
        if window is None:
            return insufficient(
                [*excerpt.notes, *self.refused],
                excerpt.bearing,
                **taken,
                shaft_hz=self.shaft_hz,
                unit=excerpt.unit,
                severity=excerpt.severity(self.shaft_hz),
            )
        verdict, speed = self._verdict([*earlier, *self.before, window.orders], window)
        severity, shaft_hz = window.severity, speed.shaft_hz
        smallest = math.nan
        if excerpt.simulated:
            smallest = smallest_detectable(
                window.seconds, shaft_hz, excerpt.temperature, severity.rms, severity.unit,
                excerpt.bearing.d_ball,
            )  # fmt: skip
        remarks = self._remarks(verdict, severity, smallest)
        strongest, expected = verdict.strongest, fault_frequencies(excerpt.bearing, shaft_hz)
        # Without a fault the envelope spectrum of the whole band is shown.
        envelope = window.envelope_spectrum(strongest.band if strongest else 0)
        return Diagnosis(
            **taken,
            **(_lines(strongest, envelope, expected, shaft_hz) if strongest else {}),
            result=verdict.result,
            rule=verdict.rule,
            level=verdict.level,
            faults=verdict.faults,
            confidence=verdict.confidence,
            reasons=(*excerpt.notes, *verdict.reasons, *remarks),
            shaft_hz_given=self.shaft_hz,
            shaft_hz=shaft_hz,
            expected=expected,
            score={name: verdict.candidates[name].z for name in PLACES},
            modulation_index={name: verdict.candidates[name].index for name in PLACES},
            band=envelope.band,
            severity=severity,
            smallest_detectable=smallest,
            spectrum=window.spectrum(excerpt.sample_rate),
            envelope_spectrum=envelope,
            found_hz={name: c.order * shaft_hz for name, c in verdict.candidates.items()},
            trust=verdict.trust,
            kind=verdict.kind,
        )

    def _remarks(self, verdict: Verdict, severity: Severity, smallest: float) -> Iterator[str]:
        """Yield the reasons that follow those of the verdict."""
        excerpt, settings = self.excerpt, self.excerpt.settings
        zoned = settings.power_group and settings.mounting
        if zoned and not severity.iso_zone and self.shaft_hz < SLOW_HZ:
            yield _NO_ZONE
        if excerpt.simulated and verdict.result == 'insufficient':
            shown = f'one {smallest:.2g} mm wide' if smallest > 0.0 else 'none is sure to'
            yield f'smallest race fault that would have shown: {shown}'

    def _verdict(
        self, windows: Sequence[OrderSpectra], window: Window
    ) -> tuple[Verdict, ShaftSpeed]:
        """Return the verdict on the mean of several windows, and the shaft speed that it uses."""
        bearing, speed, given_hz = self.excerpt.bearing, window.speed, self.shaft_hz
        turns = window.revolutions * len(windows)
        steps = max(stretch.extent.steps for stretch in self.excerpt.stretches)

        def evidence(spectra: OrderSpectra, speed: ShaftSpeed) -> Evidence:
            combs = CombSearch(spectra, bearing, speed)
            outer_hz = combs.expected.without_slip.bpfo * speed.shaft_hz
            plain = partial(low_lines, window.amplitude, window.bin_hz, outer_hz, speed.shaft_hz)
            shafts = partial(self._other_shafts, window, combs)
            return Evidence(
                combs, turns, steps, window.kurtosis, plain, lambda: window.ball_passages, shafts
            )

        refined = evidence(accumulate(windows), speed)
        verdict = answer(refined)
        if speed.shaft_hz == given_hz:
            return with_confidence_basis(refined, verdict), speed
        # The lines of a fault beside an integer order can be mistaken for those of a shaft at a
        # slightly different speed. The speed at which the fault shows more clearly is then the
        # right one, unless two places cannot be told apart at the given speed: the lines of a
        # loose shaft at another speed look like that.
        apart = abs(speed.shaft_hz / given_hz - 1.0)
        given = ShaftSpeed(given_hz, max(speed.uncertainty, apart), 0.0, speed.tolerance)
        at_given = accumulate([each.at_given_speed() for each in windows])
        at_this, gap = evidence(at_given, given), speed.shaft_hz / given_hz
        mistaken = partial(_mistaken, at_given, gap=gap, tolerance=speed.tolerance)
        least = _CLEARER * verdict.weight
        clear = (comb for comb in at_this.candidates.values() if comb.weight > least)
        if not any(map(mistaken, clear)):
            return with_confidence_basis(refined, verdict), speed
        other = answer(at_this)
        sure = other.level == 'fault' and other.result in PLACES
        clearer = sure and other.weight > least
        if clearer and other.strongest and mistaken(other.strongest):
            return with_confidence_basis(at_this, other), given
        return with_confidence_basis(refined, verdict), speed

    def _other_shafts(
        self, window: Window, combs: CombSearch, comb: Candidate
    ) -> dict[str, float]:
        """
        Return speeds at which a comb is of another place and a shaft shows, Hz, by place.

        A speed that is known better than a nominal one is believed.
        """
        if not self.excerpt.settings.nominal:
            return {}
        expected, hertz = combs.expected, combs.shaft_hz
        ranges = {
            place: (low * hertz, high * hertz)
            for place, (low, high) in expected.other_speeds(comb).items()
        }
        return shafts_instead_hz(
            window.low.power,
            1.0 / window.seconds,
            self.shaft_hz,
            window.speed.tolerance,
            ranges,
            expected.lines(comb) * hertz,
        )


def _lines(
    strongest: Candidate, envelope: Spectrum, expected: FaultFrequencies, shaft_hz: float
) -> dict[str, Any]:
    """Return the fields of a diagnosis about the lines of the fault in the envelope spectrum."""
    fault_hz = strongest.order * shaft_hz
    line_hz = fault_hz * np.arange(1, HARMONICS + 1)
    rows = np.rint(line_hz / envelope.bin_hz).astype(int) - 1
    rows = np.clip(rows, 0, len(envelope.values) - 1)
    return {
        'slip': strongest.slip,
        'fault_hz': fault_hz,
        'fault_hz_expected': expected.impacts(strongest.place),
        'line_hz': line_hz.astype(np.float32),
        'line_level': envelope.values[rows] / envelope.floor[rows],
    }


def _mistaken(at_given: OrderSpectra, found: Candidate, gap: float, tolerance: float) -> bool:
    """
    Return whether the lines of a comb were mistaken for the harmonics of the shaft.

    They can be if the order of the comb is a whole number at the refined speed and the fault has
    shaft sidebands at the given speed, which look like the other multiples of a shaft. A comb
    without sidebands has too few lines for that, as the first two harmonics of the shaft do not
    count. Within half a bin the two speeds are the same, and the clearer fault is right, unless
    all its lines are equally high, as those of strikes once a turn are.
    """
    same = 2.0 * abs(gap - 1.0) < 1.01 * at_given.step
    order = found.order / gap
    if not same and abs(order - round(order)) > 3.0 * at_given.step:
        return False
    if sideband_ratio(at_given, found.order, found.band) < (1.0 / RIVAL if same else SWAY):
        return same
    return not spaced_by_shaft(at_given, found.order, np.array([found.band]), tolerance)
