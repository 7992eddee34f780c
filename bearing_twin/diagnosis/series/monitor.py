# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Monitor of a series of short snapshots: baseline, trend, change point, alarm and its place.

A single snapshot of a few shaft turns is not enough for a diagnosis. The levels of many snapshots
of a settled machine are its baseline, and a lasting rise over this baseline is an alarm. Snapshots
may be seconds or weeks apart.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from functools import cached_property
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import LEVELS
from bearing_twin.diagnosis.chain import Excerpt
from bearing_twin.diagnosis.machine.baseline import SETTLED_DB
from bearing_twin.diagnosis.machine.dependence import Condition, Law, Z90
from bearing_twin.diagnosis.machine.level import by_zone, FALLEN, FAULT_DB, SUSPECT_DB
from bearing_twin.diagnosis.machine.onset import Rise, rise_begins, slope
from bearing_twin.diagnosis.machine.trend import Source
from bearing_twin.diagnosis.series.alone import answer_alone, CONFIRMING, WHY
from bearing_twin.diagnosis.series.averaging import AveragedEnvelope, LEAST_AVERAGED
from bearing_twin.diagnosis.series.newest import EARLIER, judged_counts, lasting, levels_reached
from bearing_twin.diagnosis.series.result import SeriesPoint, SeriesReport
from bearing_twin.diagnosis.series.state import SeriesMemory
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.signal.drift import without_drift
from bearing_twin.diagnosis.signal.gate import FAINTEST, LARGEST
from bearing_twin.diagnosis.signal.impact_height import impact_height, lowest_hz
from bearing_twin.diagnosis.signal.severity import (
    band_name,
    iso_zone,
    least_limits,
    Levels,
    measure_severity,
    MEASURES,
    monitored_levels,
    Severity,
    SHORTEST,
    valid_for_length,
)
from bearing_twin.diagnosis.streaming import HIGHEST_RATE, LOWEST_RATE
from bearing_twin.errors import BearingTwinError
from bearing_twin.given import one_axis, real_number
from bearing_twin.packed import restored
from bearing_twin.quantity import check_range, signed
from bearing_twin.stamps import time_unit
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.result import Diagnosis
    from bearing_twin.diagnosis.series.averaging import Comb


FALL_DB = 2.0
"""Hysteresis: a level ends when it has fallen this far below its threshold, dB."""
SCATTER_FACTOR = 6.0
"""Standard deviations of the baseline from which a machine with a large scatter is suspect; it has
a fault from twice as many. A level with a memory of 10 snapshots exceeds the limit within 10 000
snapshots in 7 of 100 simulated lives: 60 snapshots do not give the scatter more exactly. A level
that wanders by up to 1.2 dB (memory of 20 snapshots) stays below 6 dB in 99 of 100 such lives."""
_FAINT = 1e-9
"""Least height of impacts over the RMS, as of the RMS in a band."""
LEAST_BASELINE = 10
"""Least number of snapshots of a baseline."""
MOST = 5000
"""Most points that are kept; at this number every second one of the older half is dropped."""
IMPACTS = 'impacts'
"""Measure of :func:`impact_height`, watched in a series only."""
WATCHED = (*MEASURES, IMPACTS)
"""Names of the levels of a series."""
_FALLEN = f'{FAULT_DB:g} dB or more below the baseline, or the lowest before it: {FALLEN}'


@dataclass(frozen=True, eq=False)
class _Snapshot:
    """One snapshot; see :meth:`SeriesMonitor.add`."""

    time: float
    x: NDArray[np.float64]
    sample_rate: float
    shaft_hz: float
    temperature: float
    unit: str

    @cached_property
    def steady(self) -> NDArray[np.float64]:
        """Return the samples without drift, shape (n,)."""
        return without_drift(self.x)

    @property
    def condition(self) -> Condition:
        """Operating condition of the machine."""
        return Condition.at(self.temperature, self.shaft_hz)


class SeriesMonitor:
    """
    Monitor of the snapshots of one sensor, in order of time.

    The baseline is learnt from the first snapshots over which level and temperature have settled.
    It is learnt again if the machine settles lower, because run-in and warm-up are no damage. A
    machine may be damaged from the first snapshot on. So before there is a baseline, alarms come
    from a rise to four times the lowest level so far, from a zone, and from diagnoses of single
    snapshots.

    Parameters
    ----------
    bearing
        Geometry, to diagnose each snapshot alone and to find the place in the averaged envelope;
        None: alarms have no place, and no envelope is averaged.
    settings
        See :class:`DiagnosisSettings`; ``baseline_windows`` is at least 10 here.

    Raises
    ------
    BearingTwinError
        If ``baseline_windows`` is less than 10.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> monitor = SeriesMonitor(None)
    >>> for number in range(80):
    ...     height = 1.0 if number < 70 else 6.0
    ...     x = height * rng.standard_normal(2560)
    ...     point = monitor.add(10.0 * number, x, 25600.0, 30.0)
    >>> point.level, round(point.over_baseline), round(monitor.report().change)
    ('fault', 15, 700)

    """

    def __init__(self, bearing: Bearing | None, settings: DiagnosisSettings | None = None) -> None:
        self._settings = settings or DiagnosisSettings()
        if self._settings.baseline_windows < LEAST_BASELINE:
            raise BearingTwinError(
                f'a baseline of {self._settings.baseline_windows} snapshots is too short: give at '
                f'least {LEAST_BASELINE}'
            )
        self._bearing = bearing
        self._kept = SeriesMemory()
        # Of each watched measure, and the velocity over 1 mm/s, dB.
        self._levels: list[NDArray[np.float64]] = []
        self._quiet = AveragedEnvelope()
        self._loud = AveragedEnvelope()
        self._recent = AveragedEnvelope()

    def add(
        self,
        time: float,
        x: ArrayLike,
        sample_rate: float,
        shaft_hz: float,
        *,
        temperature: float = math.nan,
        unit: str = '',
        answer: Diagnosis | None = None,
    ) -> SeriesPoint | None:
        """
        Take a snapshot; return the state after it, or None if it cannot be judged.

        Parameters
        ----------
        time
            s; a snapshot that is not later than the previous one is not judged.
        x
            Samples, shape (n,).
        sample_rate
            Hz.
        shaft_hz
            Hz; NaN if unknown.
        temperature
            degC; NaN if unknown.
        unit
            Unit of x.
        answer
            Diagnosis of the snapshot alone, if it is known already.

        Raises
        ------
        BearingTwinError
            If x is not one-dimensional, or a value is no number. The state is unchanged then.

        """
        snapshot = _Snapshot(
            real_number('time', time), one_axis(x), real_number('sample_rate', sample_rate),
            real_number('shaft_hz', shaft_hz), real_number('temperature', temperature), unit,
        )  # fmt: skip
        check_range('sample_rate', snapshot.sample_rate, LOWEST_RATE, HIGHEST_RATE, 'Hz')
        reason = self._refuse(snapshot)
        if reason:
            self._kept.leave_out(reason)
            return None
        self._ask_alone(snapshot, answer)
        severity, levels = self._measure(snapshot)
        reason = self._incomparable(levels[0], snapshot.condition)
        if reason:
            self._not_compared(snapshot.time, reason)
            return None
        self._kept.unjudged = 0
        self._kept.source = Source(unit=unit, sample_rate=snapshot.sample_rate)
        changes, deviations = self._corrections(snapshot, levels)
        # The velocity is NaN in short snapshots.
        known = severity.velocity_rms > 0.0
        velocity = 20.0 * math.log10(severity.velocity_rms) if known else -math.inf
        self._levels.append(np.append(levels - changes, velocity))
        self._follow_rise()
        recent = self._recent_levels()
        over, measure = self._over(recent, snapshot.condition)
        sure = over - Z90 * float(deviations[measure])
        by_level = self._wanted(sure, measure, recent, self._zone_level(recent, severity))
        envelope = self._envelope(snapshot)
        self._hold(snapshot.time, _highest(by_level, self._by_answers()))
        if by_level in ('suspect', 'fault') and math.isnan(self._kept.risen):
            self._kept.risen = snapshot.time
        self._remember(snapshot, levels, envelope)
        point = SeriesPoint(
            time=snapshot.time, level=self._kept.held, over_baseline=over, rms=severity.rms,
            measure=WATCHED[measure] if self._kept.memory.base else '',
            temperature=snapshot.temperature, iso_zone=severity.iso_zone,
            correction=float(changes[0]), correction_sd=float(deviations[0]),
            rising=self._kept.rise.lasting if self._kept.rise.found else 0,
        )  # fmt: skip
        self._kept.points.append(point)
        if len(self._kept.points) >= MOST:
            # The older half is thinned out.
            del self._kept.points[: MOST // 2 : 2], self._levels[: MOST // 2 : 2]
        return point

    def _measure(self, snapshot: _Snapshot) -> tuple[Severity, list[float]]:
        """Return the severity of a snapshot, and the level of each watched measure, dB."""
        x, sample_rate, shaft_hz = snapshot.steady, snapshot.sample_rate, snapshot.shaft_hz
        severity = measure_severity(
            Levels.of(x, fft.rfft(x) / len(x), sample_rate), unit=snapshot.unit,
            power_group=self._settings.power_group, mounting=self._settings.mounting,
            shaft_hz=shaft_hz,
        )  # fmt: skip
        severity = valid_for_length(severity, len(x), sample_rate)
        height = max(impact_height(snapshot.x, sample_rate, shaft_hz), _FAINT * severity.rms)
        return severity, [*monitored_levels(severity), round(20.0 * math.log10(height), 6)]

    def _incomparable(self, level: float, now: Condition) -> str:
        """Return why a level, dB, is not compared with the baseline; '' if it is."""
        memory = self._kept.memory
        if not all(law.comparable(now, memory.at) for law in self._laws()):
            return f'another speed than the {2.0**memory.at.octaves:.4g} Hz of the baseline'
        fallen = memory.has_fallen(level - float(self._changes_at(now)[0][0]), now)
        return _FALLEN if fallen else ''

    def _corrections(self, snapshot: _Snapshot, levels: list[float]) -> NDArray[np.float64]:
        """Learn the baseline if it is due; return corrections to it, and deviations, dB."""
        now, most = snapshot.condition, SUSPECT_DB if self._teaches else -math.inf
        found = self._changes_at(now)
        if self._kept.memory.learn(
            snapshot.time, levels, now, self._settings.baseline_windows, most
        ):
            # A machine that has run in, or was repaired, is compared with its present state.
            self._kept.rise = Rise()
            self._quiet.clear()
            found = self._changes_at(now)
        return found

    def _follow_rise(self) -> None:
        """Add the newest level to the slow rise over the baseline."""
        base = self._kept.memory.base
        if base is not None:
            # A shock counts no more than the smallest rise that is an alarm.
            over = min(float(self._levels[-1][0]) - base.levels[0], self._limit(0))
            self._kept.rise.add(over, base.scatter[0])

    def _envelope(self, snapshot: _Snapshot) -> AveragedEnvelope:
        """Return the envelope of a snapshot; look for a strong fault in those of the newest."""
        envelope = AveragedEnvelope()
        # Without a bearing nobody asks for a place.
        if self._bearing is None:
            return envelope
        if math.isfinite(snapshot.shaft_hz):
            envelope.add(snapshot.steady, snapshot.sample_rate, snapshot.shaft_hz)
        self._recent.join(envelope)
        if self._recent.count == LEAST_AVERAGED:
            self._kept.strong = self._recent.strong(self._bearing, snapshot.shaft_hz)
            self._recent.clear()
        return envelope

    def _by_answers(self) -> str:
        """Return the level that single snapshots and a strong fault in their average require."""
        said = self._kept.answers.level
        # Healthy snapshots alone do not make the level known: this takes a baseline.
        if said == 'ok' and self._kept.memory.base is None:
            said = 'none'
        return said if self._kept.strong is None else _highest(said, 'suspect')

    def _remember(
        self, snapshot: _Snapshot, levels: list[float], envelope: AveragedEnvelope
    ) -> None:
        """Keep levels of a healthy machine, and the envelope with others of its state."""
        teaches = self._teaches
        if teaches:
            self._kept.memory.record.add(levels, snapshot.condition)
        if self._kept.memory.base is not None or not teaches:
            (self._quiet if teaches else self._loud).join(envelope)

    @property
    def _teaches(self) -> bool:
        """
        Whether the newest snapshots are learnt: not while the machine is suspect or worse.

        A suspicion from the answers of single snapshots alone may be about another machine nearby,
        which does not end. Such a machine is learnt as it is, so that a rise shows.
        """
        doubted = self._kept.held == 'suspect' and math.isnan(self._kept.risen)
        return self._kept.held in ('ok', 'none') or doubted

    def _ask_alone(self, snapshot: _Snapshot, answer: Diagnosis | None) -> None:
        """Take the answer of a snapshot alone."""
        if answer is None and self._bearing is not None:
            excerpt = Excerpt.of(
                snapshot.x, snapshot.shaft_hz, snapshot.sample_rate, self._bearing, self._settings,
                temperature=snapshot.temperature, unit=snapshot.unit,
            )  # fmt: skip
            answer = answer_alone(excerpt.analyse())
        if answer is not None:
            self._kept.answers.add(answer, sound=self._kept.held in ('ok', 'none'))

    def _not_compared(self, time: float, reason: str) -> None:
        """Leave out a snapshot whose level is not comparable; its answer may still raise it."""
        self._kept.leave_out(reason)
        if LEVELS.index(self._kept.answers.level) > LEVELS.index(self._kept.held):
            self._hold(time, self._kept.answers.level)

    def _refuse(self, snapshot: _Snapshot) -> str:
        """Return why a snapshot cannot be judged; '' if it can."""
        x, points, before = snapshot.x, self._kept.points, self._kept.source
        if not math.isfinite(snapshot.time):
            return 'no time; give it in s'
        if points and not snapshot.time > points[-1].time:
            return 'not later than the one before; sort the files, mend times, leave copies out'
        source = Source(unit=snapshot.unit, sample_rate=snapshot.sample_rate)
        if points and not before.same(source):
            return (
                f'{source.sample_rate:g} Hz and unit {source.unit!r} are not the '
                f'{before.sample_rate:g} Hz and {before.unit!r} of this series; another sensor?'
            )
        if len(x) < SHORTEST:
            return f'fewer than {SHORTEST} samples'
        if not np.isfinite(x).all():
            return 'NaN or infinite samples'
        if np.abs(x).max() > LARGEST:
            return 'samples that no sensor tells'
        if np.ptp(x) <= FAINTEST:
            return 'a constant signal'
        if snapshot.shaft_hz <= 0.0:
            return 'the machine stands still'
        if snapshot.shaft_hz > HIGHEST_RATE:
            return f'a shaft speed above {HIGHEST_RATE:g} Hz; is it in Hz?'
        return ''

    def _laws(self) -> list[Law]:
        """Return the law of each measure."""
        return self._kept.memory.laws(len(WATCHED))

    def _changes_at(self, now: Condition) -> NDArray[np.float64]:
        """Return corrections to the baseline's condition, and standard deviations, dB."""
        pairs = [law.correct(now, self._kept.memory.at) for law in self._laws()]
        return np.asarray(np.transpose(pairs))

    def _limit(self, measure: int) -> float:
        """Return the level over the baseline from which a measure is suspect, dB."""
        base = self._kept.memory.base
        return max(SUSPECT_DB, SCATTER_FACTOR * base.scatter[measure] if base else 0.0)

    def _over(self, recent: NDArray[np.float64], now: Condition) -> tuple[float, int]:
        """Return the level of the last snapshots over their reference, dB, and its measure."""
        over = self._kept.memory.over(recent[:-1].tolist(), now)
        over = [0.0 if math.isnan(value) else value for value in over]
        # The measures are compared by their ratio to their thresholds.
        most = int(np.argmax([value / self._limit(n) for n, value in enumerate(over)]))
        return over[most], most

    def _wanted(
        self, over: float, measure: int, recent: NDArray[np.float64], zone_level: str
    ) -> str:
        """Return the level that the vibration of the newest snapshots requires."""
        if len(self._levels) < CONFIRMING:
            return self._kept.held
        if self._kept.memory.base is None:
            return _highest('fault' if over >= FAULT_DB else 'none', zone_level)
        suspect = self._limit(measure)
        thresholds = {'suspect': suspect, 'fault': max(FAULT_DB, 2.0 * suspect)}
        wanted = 'ok'
        for level, threshold in thresholds.items():
            standing = LEVELS.index(self._kept.held) >= LEVELS.index(level)
            # A level held only by answers was never over the threshold.
            standing &= math.isfinite(self._kept.risen)
            if over >= threshold - FALL_DB * standing:
                wanted = level
        if wanted == 'fault' and self._kept.memory.was_settled_at(recent[:-1]) is not None:
            wanted = 'suspect'
        by_rise = 'suspect' if self._kept.rise.found else 'ok'
        return _highest(wanted, zone_level, by_rise)

    def _zone(self, recent: NDArray[np.float64]) -> tuple[float, str]:
        """Return the velocity, mm/s, that the newest snapshots reach, and its zone."""
        reached = 10.0 ** (float(recent[-1]) / 20.0)
        return reached, iso_zone(reached, self._settings.power_group, self._settings.mounting)

    def _zone_level(self, recent: NDArray[np.float64], severity: Severity) -> str:
        """Return the level that the velocity of the newest snapshots requires."""
        reached, zone = self._zone(recent)
        return by_zone(replace(severity, velocity_rms=reached, iso_zone=zone))[0]

    def _recent_levels(self) -> NDArray[np.float64]:
        """Return the level of each measure and the velocity that the newest snapshots reach."""
        base, sound = self._kept.memory.base, len(self._levels)
        if not self._teaches and math.isfinite(self._kept.risen):
            sound = 1 + bisect_left(self._kept.points, self._kept.risen, key=lambda it: it.time)
        watched = range(len(WATCHED))
        limits = [base.levels[n] + self._limit(n) if base else math.inf for n in watched]
        zone_c = least_limits(self._settings.power_group, self._settings.mounting)[1]
        counts = judged_counts(self._levels, [*limits, 20.0 * math.log10(zone_c)], sound)
        return levels_reached(np.array(self._levels[-EARLIER:]), counts)

    def _hold(self, time: float, wanted: str) -> None:
        """Update the held level, its place and rule; if an alarm ends, forget its envelopes."""
        kept, before = self._kept, self._kept.held
        if kept.hold(time, wanted, self._settings.longest_hold):
            self._loud.clear()
        if LEVELS.index(kept.answers.level) >= LEVELS.index(kept.held):
            kept.place, kept.doubt = kept.answers.place, kept.answers.doubt
        elif kept.held != before:
            kept.place = kept.doubt = ''

    def report(self) -> SeriesReport:
        """Return the report on all snapshots so far."""
        base = self._kept.memory.base
        comb, place = None, ''
        if self._bearing is not None and self._alarmed:
            comb = self._loud.place(self._bearing, self._quiet) or self._kept.strong
            place = self._kept.place or (comb.place if comb and not comb.turns else '')
        alone = self._alarmed and math.isnan(self._kept.risen)
        doubt = self._kept.doubt if alone and not place else ''
        change = self._change(self._kept.risen)
        warmer = math.nan
        if base is not None:
            heat = [point.temperature for point in self._kept.points[-CONFIRMING:]]
            warmer = float(np.median(heat)) - base.temperature
        return SeriesReport(
            level='none' if self.lost else self._kept.held, points=tuple(self._kept.points),
            baseline=(base.times[0], base.times[1]) if base else None,
            scatter=base.scatter[0] if base else math.nan,
            change=change, alarm=self._kept.began,
            first_alarm=self._kept.alarms.get('suspect', math.nan),
            first_fault=self._kept.alarms.get('fault', math.nan),
            changes=self._kept.changes, trend=self._trend(), warmer=warmer, place=place,
            doubt=doubt, law=self._laws()[0],
            reasons=self._reasons(change, warmer, comb, place, doubt),
        )  # fmt: skip

    @property
    def lost(self) -> bool:
        """Whether too many snapshots were not judged to call the machine healthy still."""
        return self._kept.held == 'ok' and self._kept.unjudged >= self._settings.baseline_windows

    def save(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Return plain values and arrays to keep over a restart; see :meth:`load`."""
        values = {
            'kept': asdict(self._kept),
            'averaged': [[a.count, a.turns] for a in self._averages.values()],
        }
        arrays = {
            'levels': np.array(self._levels, dtype=np.float64).reshape(-1, len(WATCHED) + 1),
            **{name: a.power for name, a in self._averages.items()},
        }
        return values, arrays

    @property
    def _averages(self) -> dict[str, AveragedEnvelope]:
        return {'quiet': self._quiet, 'loud': self._loud, 'recent': self._recent}

    def load(self, values: dict[str, Any], arrays: dict[str, NDArray[Any]]) -> None:
        """
        Restore what :meth:`save` returned.

        Raises
        ------
        KeyError, TypeError, ValueError, IndexError, OverflowError, BearingTwinError
            If the data is anything else. The monitor must not be used then.

        """
        self._kept = restored(SeriesMemory, values['kept'])
        self._levels = list(arrays['levels'])
        if arrays['levels'].shape != (len(self._kept.points), len(WATCHED) + 1):
            msg = f'saved levels have shape {arrays["levels"].shape}; use what save() returned'
            raise BearingTwinError(msg)
        saved = zip(self._averages.items(), values['averaged'], strict=True)
        for (name, average), (count, turns) in saved:
            average.load(int(count), float(turns), arrays[name])

    def _change(self, alarm: float) -> float:
        """Return the onset of the rise to an alarm, the last zero of Page's CUSUM; NaN if none."""
        if math.isnan(alarm):
            return math.nan
        times = np.array([point.time for point in self._kept.points])
        until = int(np.searchsorted(times, alarm)) + 1
        measure = WATCHED.index(self._kept.points[until - 1].measure or WATCHED[0])
        levels = np.array([levels[measure] for levels in self._levels[:until]])
        base = self._kept.memory.base
        start, floor = 0, float(np.median(levels[: max(until // 2, 1)]))
        reference = 0.25 * SUSPECT_DB
        if base is not None and base.times[1] < alarm:
            start = int(np.searchsorted(times, base.times[1]))
            floor = base.levels[measure]
            reference = max(reference, base.scatter[measure])
        if np.median(levels[-CONFIRMING:]) <= floor + reference:
            # Without a rise: a zone may be an alarm from the first snapshot on.
            return math.nan
        levels = levels[start:]
        limit = floor + self._limit(measure)
        [count] = judged_counts([*levels[:, np.newaxis]], [limit], len(levels))
        kept = lasting(levels, count) if len(levels) >= count else levels
        # A level that comes and goes does not last.
        kept = kept if kept[-1] > floor + reference else levels
        first = rise_begins(kept, floor, reference)
        first += int(np.argmax(levels[first:] > floor + reference))
        return float(times[start + first])

    def _trend(self) -> float:
        base = self._kept.memory.base
        if base is None:
            return math.nan
        times = np.array([point.time for point in self._kept.points])
        last = times >= times[-1] - 0.25 * (times[-1] - base.times[0])
        levels = np.array([levels[0] for levels in self._levels])
        return slope(times[last] / 3600.0, levels[last])

    def _reasons(
        self, change: float, warmer: float, comb: Comb | None, place: str, doubt: str
    ) -> tuple[str, ...]:
        reasons = [*self._told_of_answers(place, doubt), *self._told_of_baseline()]
        if self.lost:
            reasons.append(f'not known: the last {self._kept.unjudged} snapshots were not judged')
        elif self._kept.unjudged >= CONFIRMING:
            count = self._kept.unjudged
            reasons.append(f'the last {count} snapshots were not judged: what follows is older')
        if self._kept.points:
            reasons += self._told_of_level(self._kept.points[-1])
        if math.isfinite(change):
            since = _long(self._kept.points[-1].time - change)
            which = 'the level' if self._alarmed else 'the last alarm has ended; its level'
            reasons.append(f'{which} began to rise {since} ago')
        if self._kept.rise.found:
            reasons.append(f'the level has been rising for {self._kept.rise.lasting} snapshots')
        if math.isfinite(warmer):
            reasons.append(str(self._laws()[0]))
            reasons.append(f'{signed(warmer, 0)} K against the baseline')
        if comb is not None:
            reasons.append(str(comb))
        elif not place and self._alarmed and self._bearing is not None:
            few = self._loud.count < LEAST_AVERAGED
            why = f'{self._loud.count} snapshots since the alarm, {LEAST_AVERAGED} are needed'
            none = 'no comb stands out of the averaged envelope'
            reasons.append(f'place unknown: {why if few else none}')
        reasons += [
            f'{count} snapshots not judged: {why}' for why, count in self._kept.refused.items()
        ]
        return tuple(reasons)

    @property
    def _alarmed(self) -> bool:
        return self._kept.held in ('suspect', 'fault')

    def _told_of_answers(self, place: str, doubt: str) -> Iterator[str]:
        """Say what the single snapshots answer, now and when the level was raised."""
        kept = self._kept
        if text := str(kept.answers):
            yield text
        if doubt and doubt != kept.answers.doubt:
            yield f'{kept.held} held: {WHY[doubt]}'
        if place and place == kept.place != kept.answers.place:
            yield f'{kept.held} held: earlier snapshots say {place}'

    def _told_of_baseline(self) -> Iterator[str]:
        """Say why there is no baseline."""
        if self._kept.memory.base is not None:
            return
        if not self._teaches:
            yield f'no baseline: a machine at {self._kept.held} is not learnt'
            return
        count, hertz = self._kept.memory.most_at_one_speed()
        wanted = self._settings.baseline_windows
        why = f'{wanted} snapshots in a row wanted; {len(self._kept.points)} judged'
        if count >= wanted:
            why = f'in {wanted} snapshots {self._kept.memory.why_not_settled()}'
        elif not math.isnan(hertz):
            why = f'{wanted} snapshots at one speed wanted; most: {count} at {hertz:.4g} Hz'
        yield (
            f'no baseline: {why}. Until there is one, only {FAULT_DB:g} dB over the lowest '
            'level, a zone or a comb is an alarm'
        )

    def _told_of_level(self, last: SeriesPoint) -> Iterator[str]:
        """Say how far the newest levels are over the baseline, what may explain it, the zone."""
        recent, base = self._recent_levels(), self._kept.memory.base
        if base is not None:
            measure = _measured(last.measure, self._kept.source.sample_rate)
            over = f'{measure}: {signed(last.over_baseline)} dB over the baseline'
            if (limit := self._limit(index := WATCHED.index(last.measure))) > SUSPECT_DB:
                scatter = base.scatter[index]
                over += f'; it scatters by {scatter:.1f} dB: suspect from {limit:.1f} dB'
            yield over
            rise = recent[:-1] - np.array(base.levels)
            usual = self._kept.memory.was_settled_at(recent[:-1])
            if self._alarmed and usual is not None:
                begin, end = (_long(last.time - time) for time in usual.times)
                yield (
                    f'as loud as from {begin} to {end} ago, when it was settled too: '
                    'another load, or is it not run in?'
                )
            elif self._alarmed and rise.min() >= SUSPECT_DB and np.ptp(rise) <= SETTLED_DB:
                # No damage raises what a gear, the shaft and a bearing make by as much.
                yield 'all measures rose alike: was the gain or the sensor changed?'
        if (zone := self._zone(recent)[1]) in ('C', 'D'):
            yield f'zone {zone} of ISO 20816-3'
        elif last.iso_zone in ('C', 'D'):
            yield f'zone {last.iso_zone} of ISO 20816-3 in the last snapshot'


def _measured(measure: str, sample_rate: float) -> str:
    """Return the name of a measure at a sample rate, Hz, in plain words."""
    if measure == IMPACTS:
        return f'impacts in most turns of the cage, from {lowest_hz(sample_rate):g} Hz on'
    return band_name(MEASURES.index(measure), sample_rate)


def _long(seconds: float) -> str:
    unit, length = time_unit(seconds)
    return f'{seconds / length:.{0 if unit == "s" else 1}f} {unit}'


def _highest(*levels: str) -> str:
    return max(levels, key=LEVELS.index)
