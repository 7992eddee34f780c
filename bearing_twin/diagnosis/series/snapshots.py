# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagnosis of a series from the blocks of a stream, with one snapshot a cycle."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import asdict, replace
import math
from typing import Any, TYPE_CHECKING
import zlib

from bearing_twin.diagnosis.chain import Excerpt, is_simulated
from bearing_twin.diagnosis.machine.held import Known, Pace
from bearing_twin.diagnosis.machine.level import UNRATED_CONFIDENCE, with_fault_stage
from bearing_twin.diagnosis.machine.trend import Source
from bearing_twin.diagnosis.series.alone import answer_alone
from bearing_twin.diagnosis.series.monitor import SeriesMonitor
from bearing_twin.diagnosis.signal.severity import SHORTEST
from bearing_twin.diagnosis.signal.shaft import SpeedProfile
from bearing_twin.diagnosis.streaming import checked_block, PATIENCE, same_rate
from bearing_twin.errors import BearingTwinError
from bearing_twin.packed import pack, restored, unpack
import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.chain import Analysis
    from bearing_twin.diagnosis.result import Diagnosis
    from bearing_twin.diagnosis.series.result import SeriesReport
    from bearing_twin.diagnosis.settings import DiagnosisSettings


_VERSION = 1024
_LARGEST = 64 * 1024 * 1024
"""Largest unpacked size of a saved state, bytes: 5000 points are 2 MB."""
_SOONER = 0.75
"""Part of the cycle after which the next snapshot may begin: cycles are never exact."""


class SeriesDiagnoser:
    """
    Takes one snapshot a cycle from the blocks of a sensor and judges all as one series.

    It is used instead of :class:`bearing_twin.diagnosis.StreamingDiagnoser` if
    ``settings.series_cycle`` is not 0. No samples are needed between snapshots. Time is the sample
    index over the rate of each block. If the index starts anew, the next snapshot is one cycle
    after the last one.

    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.diagnosis import DiagnosisSettings
    >>> settings = DiagnosisSettings(series_cycle=600.0, series_snapshot=0.1, baseline_windows=10)
    >>> diagnoser = SeriesDiagnoser(find_bearing('6307'), settings)
    >>> rng = np.random.default_rng(0)
    >>> for number in range(40):
    ...     x = (1.0 if number < 30 else 6.0) * rng.standard_normal(2560)
    ...     due = diagnoser.take(0, x, 25600.0, 25.0)
    ...     said = [diagnoser.judge(excerpt.analyse()) for excerpt in due]
    >>> said[0].result, said[0].level, round(said[0].severity.level_over_baseline)
    ('ambiguous', 'fault', 16)
    """

    def __init__(self, bearing: Bearing, settings: DiagnosisSettings) -> None:
        self.other_source = ''
        """Why the last snapshot is of another source than the series; '' if it is not."""
        self._source = Source()
        # Time at the sample after the newest block, and of the newest snapshot.
        self._ended, self._last = 0.0, -math.inf
        self._next = 0
        self._rate = math.nan
        # Time of the newest snapshot that was long enough, or of the first block.
        self._whole = math.nan
        self._short = ''
        self._parts: list[tuple[NDArray[np.float64], float]] = []
        self._bearing, self._settings = bearing, settings
        self._monitor = SeriesMonitor(self._bearing, self._settings)
        # Whether single snapshots tell enough to call the bearing healthy.
        self._known = Known()

    @property
    def bearing(self) -> Bearing:
        """Geometry in use."""
        return self._bearing

    @property
    def settings(self) -> DiagnosisSettings:
        """Return the settings in use."""
        return self._settings

    def reconfigure(
        self, bearing: Bearing | None = None, settings: DiagnosisSettings | None = None
    ) -> None:
        """Change geometry or settings; the series goes on with snapshots of its own bearing."""
        self._bearing, self._settings = bearing or self._bearing, settings or self._settings
        before, self._monitor = self._monitor, SeriesMonitor(self._bearing, self._settings)
        self._monitor.load(*before.save())
        self._parts.clear()

    def take(
        self,
        first_sample: int,
        x: ArrayLike,
        sample_rate: float,
        shaft_hz: float,
        *,
        speed_measured: bool = False,
        temperature: float = math.nan,
        unit: str = '',
        sensor: str = '',
    ) -> list[Excerpt]:
        """Take a block; return complete snapshots. Parameters: see StreamingDiagnoser.take."""
        first_sample, block, sample_rate, shaft_hz, temperature = checked_block(
            first_sample, x, sample_rate, shaft_hz, temperature
        )
        known = {'temperature': temperature, 'unit': unit, 'sensor': sensor}
        found = []
        steady = same_rate(self._rate, sample_rate)
        if self._parts and (first_sample != self._next or not steady):
            found += self._snapshot(speed_measured, known)
        now = self._time_of(first_sample, sample_rate)
        begins = self._begins(now)
        # A pause without samples does not count as overdue.
        self._whole += max(now - self._ended - self._settings.series_cycle, 0.0)
        if not (self._parts and steady):
            self._rate = sample_rate
        self._ended = now + len(block) / sample_rate
        self._next = first_sample + len(block)
        if math.isnan(self._whole):
            self._whole = now
        if not (self._parts or begins):
            return found
        if not self._parts:
            self._last = now
        self._parts.append((block, shaft_hz))
        if self._held >= round(self._settings.series_snapshot * self._rate):
            found += self._snapshot(speed_measured, known)
        return found

    def has_gap(self, first_sample: int, sample_rate: float) -> bool:
        """
        Return whether samples that matter may be missing before a block.

        Within a snapshot all matter, between two only those that may hold the begin of one.
        """
        if self.may_pause and first_sample > self._next:
            return self._begins(self._time_of(first_sample, sample_rate))
        return first_sample != self._next

    def _begins(self, time: float) -> bool:
        """Return whether a block at a time (s) begins a snapshot, unless one has begun before."""
        return not time < self._last + _SOONER * self._settings.series_cycle

    def _time_of(self, first_sample: int, sample_rate: float) -> float:
        """Return the time at the first sample of a block, s."""
        if first_sample < self._next:
            # The source starts its index anew, maybe for each snapshot.
            return self._last + self._settings.series_cycle
        return self._ended + (first_sample - self._next) / sample_rate

    @property
    def next_sample(self) -> int:
        """Index of the sample after the newest block."""
        return self._next

    @property
    def overdue(self) -> str:
        """Why no snapshot can be judged although samples arrive; '' if one can."""
        elapsed = self._ended - self._whole
        if not elapsed > PATIENCE * self._settings.series_cycle:
            return ''
        return f'no verdict in {elapsed:.0f} s of the series{self._short}'

    @property
    def may_pause(self) -> bool:
        """Whether blocks may be left out now: between two snapshots."""
        return not self._parts

    @property
    def _held(self) -> int:
        return sum(len(part) for part, _ in self._parts)

    def _snapshot(self, speed_measured: bool, known: dict[str, Any]) -> list[Excerpt]:
        simulated = is_simulated(known['sensor'])
        settings = self._settings.for_speed(measured=speed_measured, simulated=simulated)
        parts, count = self._parts, self._held
        self._parts = []
        if count < SHORTEST:
            self._short = f': the last snapshot has {count} samples, and {SHORTEST} are the least'
            return []
        self._whole, self._short = self._last, ''
        return [
            Excerpt.of(
                np.concatenate([part for part, _ in parts]),
                SpeedProfile(
                    np.array([hz for _, hz in parts]), np.array([len(x) for x, _ in parts])
                ),
                self._rate,
                self._bearing,
                settings,
                first_sample=self._next - count,
                time=self._last,
                **known,
            )
        ]

    def judge(self, analysis: Analysis) -> Diagnosis:
        """Return the diagnosis of a snapshot together with all earlier ones."""
        return with_fault_stage(self._judged(analysis))

    def _judged(self, analysis: Analysis) -> Diagnosis:
        excerpt = analysis.excerpt
        found = answer_alone(analysis)
        source = Source(excerpt.sensor, excerpt.bearing.name, excerpt.unit, excerpt.sample_rate)
        if not self._source.sample_rate:
            self._source = source
        self.other_source = ''
        if not self._source.same(source):
            self.other_source = f'the series is of {self._source}, this is {source}'
            return replace(found, reasons=(*found.reasons, self.other_source))
        point = self._monitor.add(
            excerpt.time, excerpt.samples, excerpt.sample_rate, excerpt.speed_profile.mean_hz,
            temperature=excerpt.temperature, unit=excerpt.unit, answer=found,
        )  # fmt: skip
        report = self._monitor.report()
        reasons = (*found.reasons, *(f'series: {text}' for text in report.reasons))
        severity = found.severity
        if point is not None:
            severity = replace(
                severity, rms=point.rms, iso_zone=point.iso_zone,
                level_over_baseline=point.over_baseline if point.measure else math.nan,
                correction=point.correction, correction_sd=point.correction_sd,
                correction_basis=str(report.law),
                rising=math.ceil(point.rising * self._settings.series_cycle / 60.0),
            )  # fmt: skip
        silent, cycle = found.level == 'none', excerpt.settings.series_cycle
        longest = excerpt.settings.longest_hold
        pace = Pace(1, cycle, cycle, longest, excerpt.simulated, window=cycle)
        self._known.take(not silent, pace, unusable=silent and point is None)
        return _held(replace(found, severity=severity, reasons=reasons), report, self._known)

    def save(self) -> bytes:
        """Return the state to keep over a restart: the series without an incomplete snapshot."""
        values, arrays = self._monitor.save()
        own = {
            'source': asdict(self._source),
            'known': asdict(self._known),
            'ended': self._ended,
            'last': self._last,
            'next': self._next,
            # Not loaded: it tells a re-run that a snapshot was begun, or given up.
            'held': self._held,
        }
        # Compressed: most orders of most bands are zero, and points repeat their texts.
        return zlib.compress(pack(_VERSION, {'series': values, **own}, arrays), 1)

    def load(self, data: bytes) -> None:
        """
        Restore a saved state.

        Raises
        ------
        BearingTwinError
            If the bytes are no such state. The present state is unchanged then.

        """
        # unpack refuses any other data, and states of other versions.
        with suppress(zlib.error):
            data = zlib.decompressobj().decompress(data, _LARGEST)
        values, arrays = unpack(data, _VERSION)
        monitor = SeriesMonitor(self._bearing, self._settings)
        try:
            monitor.load(values['series'], arrays)
            # Inconsistent values raise here, and not with the next snapshot.
            monitor.report()
            source = restored(Source, values['source'])
            known = restored(Known, values['known'])
            ended, last, following = (values[name] for name in ('ended', 'last', 'next'))
            ended, last, following = float(ended), float(last), int(following)
        except (KeyError, TypeError, ValueError, IndexError, OverflowError) as error:
            msg = f'saved series lacks {error}; use what save() returned'
            raise BearingTwinError(msg) from error
        self._monitor, self._source, self._known = monitor, source, known
        self._ended, self._last, self._next = ended, last, following
        self._whole = math.nan
        self._parts.clear()


def _held(alone: Diagnosis, report: SeriesReport, known: Known) -> Diagnosis:
    """Return the diagnosis of a snapshot with the level and answer that the series holds."""
    level, result = report.level, report.result
    if level == 'ok' and not known.known:
        # Nothing has risen, but snapshots that say nothing alone show no healthy bearing.
        result = 'insufficient'
    if (result, level) == (alone.result, alone.level):
        return alone
    holds = 'level not known yet' if level == 'none' else f'{level} held'
    texts = []
    if level == 'ok' and (alone.level == 'none') == known.known:
        texts.append(f'series: {result} held: of single snapshots {known}')
    if alone.level != 'none':
        texts.append(f'series: {holds}; this snapshot alone says {alone.result}, {alone.level}')
    faults: tuple[str, ...] = (report.place,) if report.place else ()
    if not faults and level in ('suspect', 'fault') and report.doubt in ('', alone.rule):
        faults = alone.faults
    # The rule of this snapshot is not that of the series' answer.
    return replace(
        alone, result=result, level=level, rule=report.doubt, kind='',
        confidence=0.0 if result == 'insufficient' else UNRATED_CONFIDENCE, faults=faults,
        reasons=(*alone.reasons, *texts), window=(alone.result, alone.level),
    )  # fmt: skip
