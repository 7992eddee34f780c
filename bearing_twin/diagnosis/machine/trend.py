# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Trend of one machine: its baseline, learnt while healthy, and the held answer."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import FAULT_CODES, LEVELS
from bearing_twin.diagnosis.machine.baseline import Memory, WARM_UP
from bearing_twin.diagnosis.machine.dependence import Condition, KNOWN_DB, Z90
from bearing_twin.diagnosis.machine.held import HeldLevel, Known
from bearing_twin.diagnosis.machine.level import (
    FALLEN,
    FAULT_DB,
    SUSPECT_DB,
    with_fault_stage,
    with_required_level,
)
from bearing_twin.diagnosis.machine.onset import Rise
from bearing_twin.diagnosis.rules.confidence import kind_of
from bearing_twin.diagnosis.rules.table import NOTHING_SHOWS
from bearing_twin.diagnosis.signal.severity import band_name, MEASURES, monitored_levels
from bearing_twin.errors import BearingTwinError
from bearing_twin.quantity import signed
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.diagnosis.machine.held import Pace
    from bearing_twin.diagnosis.result import Diagnosis


_SAME_RATE = 0.05
_DOUBTFUL = 0.1
"""Suspect and faulty windows, over those of the baseline, above which a reason mentions them."""
_NOT_YET = (
    'no baseline: {wanted} settled healthy windows wanted; {count} healthy, {doubtful} doubtful'
)
_LEARNT_IN_DOUBT = (
    'the baseline was learnt from {wanted} healthy windows among {doubtful} that were suspect or '
    'faulty: a level over it may be that over a damaged machine; ~/reset learns it anew'
)
_LOWEST = 'no baseline yet: over the lowest level so far; ~/reset if the machine was idle then'
_MAY_START = (
    'louder than at first, before there is a baseline, and no lines of a shaft show at the given '
    'speed: does the machine start up? Not compared; measure the speed'
)
_AFTER_REPAIR = 'after a repair reset the diagnosis'
_BLIND = (
    'it was found at a known speed, and no lines of a shaft show at the given one, so this window '
    f'does not tell that it has ended; measure the speed; {_AFTER_REPAIR}'
)
_LONG = 600.0
"""Pause before a level falls, s, from which a reason mentions that a reset ends it at once."""
_MOST_OVER_DB = 0.5 * SUSPECT_DB
"""Level over the lowest, dB, from which a settled stream makes no baseline. A machine that settles
below it, on its way to 10 dB, is suspect in the end all the same."""
_FIRST = 60
"""First healthy minutes of a machine, the reference of a rise."""


@dataclass(frozen=True)
class Source:
    """
    Source of the levels of a baseline. Levels of different sources are not compared.

    >>> machine = Source('imu y', '6205', 'm/s^2', 12000.0)
    >>> machine.same(replace(machine, sample_rate=12003.2)), machine.same(Source())
    (True, False)
    >>> print(machine)
    sensor 'imu y', bearing '6205', 'm/s^2', 12000 Hz
    >>> print(replace(machine, unit=''))
    sensor 'imu y', bearing '6205', unit unknown, 12000 Hz

    """

    sensor: str = ''
    """Frame and axis."""
    bearing: str = ''
    unit: str = ''
    """Unit of the samples."""
    sample_rate: float = 0.0
    """Hz. A rate estimated from stamps differs a little between starts."""

    def same(self, other: Source) -> bool:
        """Return whether levels of both sources are comparable."""
        near = abs(self.sample_rate - other.sample_rate) <= _SAME_RATE * self.sample_rate
        named = (self.sensor, self.bearing, self.unit)
        return near and named == (other.sensor, other.bearing, other.unit)

    def __str__(self) -> str:
        """Return the source in words, for a message."""
        rate = f'{self.sample_rate:.5g} Hz'
        unit = repr(self.unit) if self.unit else 'unit unknown'
        return f'sensor {self.sensor!r}, bearing {self.bearing!r}, {unit}, {rate}'


@dataclass(frozen=True)
class HeldAnswer:
    """
    Answer that is shown while the level is held, in plain values that can be saved.

    >>> print(HeldAnswer('ambiguous', ['ball', 'cage']), HeldAnswer('inner', ['outer', 'inner']))
    ambiguous ball or cage outer and inner

    """

    result: str = ''
    """One of ``RESULTS``; empty before the first verdict."""
    faults: list[str] = field(default_factory=list)
    rule: str = ''
    """Rule that decided."""
    confidence: float = 0.0
    stage: int = 0

    @classmethod
    def of(cls, diagnosis: Diagnosis) -> HeldAnswer:
        """Return the answer of a diagnosis."""
        return cls(
            diagnosis.result, list(diagnosis.faults), diagnosis.rule, diagnosis.confidence,
            diagnosis.severity.stage,
        )  # fmt: skip

    def same(self, other: HeldAnswer) -> bool:
        """Return whether both are the same result with the same faults."""
        return (self.result, self.faults) == (other.result, other.faults)

    def __str__(self) -> str:
        """Return the answer in words."""
        if self.result in self.faults:
            return ' and '.join(self.faults)
        return f'{self.result} {" or ".join(self.faults)}'.rstrip()


@dataclass
class Trend:
    """Baseline and held answer of one machine. All fields are plain values that can be saved."""

    count: int = 0
    """Number of healthy windows in the baseline so far."""
    doubtful: int = 0
    """Number of suspect or faulty windows meanwhile."""
    judged: float = 0.0
    """Time from one update to the next, of all windows so far together, s."""
    memory: Memory = field(default_factory=Memory)
    """Levels of the machine so far, and the baseline from them."""
    first: list[list[float]] = field(default_factory=list)
    """Temperature, octaves and level of the whole signal, of each of the first healthy minutes."""
    minute: list[list[float]] = field(default_factory=list)
    """Temperature, octaves and all levels, of each window of the present minute."""
    rise: Rise = field(default_factory=Rise)
    measure: int = 0
    """Index in :data:`MEASURES` of the measure furthest over the baseline."""
    shaft: float = 0.0
    """Windows in a row with a known speed; infinite as soon as they were ``Pace.updates``."""
    seen: bool = False
    """Whether the speed was known in the newest window that asked for the held fault."""
    source: Source = field(default_factory=Source)
    """Source of the levels; its sample rate is 0 before the first window."""
    held: HeldLevel = field(default_factory=HeldLevel)
    known: Known = field(default_factory=Known)
    silent_rule: str = ''
    """Rule of the newest window that told nothing."""
    silent_why: str = ''
    """Its reasons."""
    answer: HeldAnswer = field(default_factory=HeldAnswer)
    """Held answer at the held level."""
    other: HeldAnswer = field(default_factory=HeldAnswer)
    """Other answer at the held level that the last verdicts had."""
    other_count: int = 0
    """Number of verdicts in a row with that answer."""

    def __post_init__(self) -> None:
        """Refuse a saved trend with an unknown measure or answer."""
        words = {self.answer.result, *self.answer.faults} - {''}
        sound = bool(self.answer.result) == bool(self.held.level) and words <= FAULT_CODES.keys()
        if not (sound and 0 <= self.measure < len(MEASURES)):
            msg = 'saved trend holds an answer or a measure that there is not; start without it'
            raise BearingTwinError(msg)

    def takes(self, source: Source) -> bool:
        """Return whether windows of ``source`` belong to this trend."""
        return not self.source.sample_rate or self.source.same(source)

    def update(
        self,
        diagnosis: Diagnosis,
        source: Source,
        *,
        wanted: int,
        pace: Pace,
        full: bool,
        speed_known: bool = True,
    ) -> Diagnosis:
        """
        Take a diagnosis; return it with the level over the baseline, stage and held answer.

        Parameters
        ----------
        diagnosis
            Verdict on one window.
        source
            Source of the window, which the trend :meth:`takes`.
        wanted
            Number of healthy windows in a baseline, which is then kept as it is.
        pace
            How verdicts follow each other, and how long a level is held. An answer at the held
            level changes after ``pace.updates`` equal verdicts in a row.
        full
            Whether the window is full. The first full window sets the level at once.
        speed_known
            Whether the speed is measured, or lines of the shaft show at the nominal one.

        """
        severity = diagnosis.severity
        # Combs at a wrong speed do not tell that a fault at the right one has ended.
        blind = self.held.level == 'fault' and self.seen and not speed_known
        if not severity.rms > 0.0:
            return self._shown(diagnosis, pace, full, blind)
        self._look_for_shaft(speed_known, pace)
        levels, memory = monitored_levels(severity), self.memory
        now = Condition.at(diagnosis.temperature, diagnosis.shaft_hz)
        if not self.source.sample_rate:
            self.source = source
        self.judged += pace.interval
        if memory.base is None:
            alone = with_required_level(diagnosis).level
            self.doubtful += full and alone in ('suspect', 'fault')
            louder = memory.over(levels, now)[0] >= SUSPECT_DB
            # If no fault could show, the level is as good as that of a healthy window.
            silent = full and alone == 'none' and diagnosis.rule in NOTHING_SHOWS
            # A healthy window among faulty ones is of a damaged machine.
            if (alone == 'ok' or silent) and (louder or self.held.is_low(pace)):
                self.count += 1
                if memory.learn(self.judged, levels, now, wanted, _MOST_OVER_DB):
                    memory.windows.clear()
        own = with_required_level(self._compared(diagnosis, levels, now, wanted))
        if full:
            self.minute.append([*now, *levels])
            if len(self.minute) >= max(round(60.0 / pace.interval), 1):
                self._take_minute(healthy=own.level == 'ok')
        shown = self._shown(own, pace, full, blind)
        if own.level == 'fault' == self.held.level and not blind:
            self.seen = speed_known
        return shown

    def _look_for_shaft(self, speed_known: bool, pace: Pace) -> None:
        """
        Count windows with a known speed, and begin anew when the speed becomes known.

        Before that the machine stood still or was starting up, at other levels. Later than
        `WARM_UP` after the first level it may be damage that shows lines of the shaft.
        """
        if math.isinf(self.shaft):
            return
        self.shaft = self.shaft + 1.0 if speed_known else 0.0
        if self.shaft < pace.updates:
            return
        late = self.judged - self.memory.began >= WARM_UP
        if self.judged > self.shaft * pace.interval and not late:
            self.memory, self.rise = Memory(), Rise()
            self.count = self.doubtful = 0
            self.first.clear()
            self.minute.clear()
        self.shaft = math.inf

    def _compared(
        self, diagnosis: Diagnosis, levels: list[float], now: Condition, wanted: int
    ) -> Diagnosis:
        """Return a diagnosis with its levels over those of this machine so far."""
        memory, said, severity = self.memory, list(diagnosis.reasons), diagnosis.severity
        base, laws, at = memory.base, memory.laws(), memory.at
        if self.doubtful > _DOUBTFUL * wanted or (base is None and self.count > wanted):
            text = _LEARNT_IN_DOUBT if base else _NOT_YET
            said.append(text.format(wanted=wanted, count=self.count, doubtful=self.doubtful))
        changes, deviations = zip(*(law.correct(now, at) for law in laws), strict=True)
        same = [law.comparable(now, at) for law in laws]
        none = -math.inf if same[0] else math.nan
        corrected = [dB - change for dB, change in zip(levels, changes, strict=True)]
        over = memory.over(corrected, now)
        over = [dB if known else none for dB, known in zip(over, same, strict=True)]
        # A machine that starts up gets louder. Without its speed nothing tells this from damage.
        starts = not self.shaft and self.judged - memory.began < WARM_UP
        if base is None and (starts or not over[0] >= SUSPECT_DB):
            said += [_MAY_START] * (over[0] >= SUSPECT_DB)
            over = [math.nan] * len(over)
        sure = [dB - Z90 * deviation for dB, deviation in zip(over, deviations, strict=True)]
        most = self.measure = self._leading(sure)
        severity = replace(
            severity,
            level_over_baseline=over[most],
            rising=self.rise.lasting if self.rise.found else 0,
            correction=changes[most],
            correction_sd=deviations[most],
            correction_basis=str(laws[most]) if base else '',
        )
        if not same[0]:
            hertz = 2.0**at.octaves
            said.append(f'baseline is of {hertz:.4g} Hz: not compared at this speed')
        elif base is None and over[0] >= SUSPECT_DB:
            said.append(_LOWEST)
        elif over[0] <= -FAULT_DB:
            # A dead sensor does not mean a healthy machine; a named place means that it is not
            # dead.
            if not diagnosis.faults:
                diagnosis = replace(
                    diagnosis, result='insufficient', level='none', confidence=0.0, kind=''
                )
            said.append(f'{over[0]:.1f} dB over the baseline: {FALLEN}')
        elif most:
            band = band_name(most, diagnosis.sample_rate)
            said.append(f'{band}: {signed(over[most])} dB over the baseline')
        return replace(diagnosis, severity=severity, reasons=tuple(said))

    def _leading(self, over: list[float]) -> int:
        """
        Return the measure that is furthest over the baseline.

        The previous measure stays until another is clearly further over the baseline, or requires
        a higher level. Otherwise the text would change with each window if two are about equal.
        """
        most = max(range(len(over)), key=over.__getitem__)
        highest, named = over[most], over[self.measure]
        clear = not highest - named < KNOWN_DB
        asks = any(named < limit <= highest for limit in (SUSPECT_DB, FAULT_DB))
        return most if clear or asks else self.measure

    def _shown(self, own: Diagnosis, pace: Pace, full: bool, blind: bool) -> Diagnosis:
        """
        Return the shown diagnosis; a single window without information changes no answer.

        A ``blind`` window does not know the speed at which the held fault was found.
        """
        nothing = own.level == 'none'
        if full or self.held.level:
            # What cannot be told of a whole window is a fact of the input: a machine that stands
            # still, a dead sensor, an unknown speed.
            fallen = own.severity.level_over_baseline <= -FAULT_DB
            refused = full and own.rule not in NOTHING_SHOWS
            self.known.take(not nothing, pace, unusable=nothing and (fallen or refused))
        if nothing:
            self.silent_rule, self.silent_why = own.rule, '; '.join(own.reasons)
        held = not nothing or self.held.level not in ('', 'none')
        shown = with_fault_stage(self._held(own, pace, full, blind) if held else own)
        stage = shown.severity.stage
        if own.level == shown.level:
            self.answer = replace(self.answer, stage=stage)
        elif shown.level == 'fault' and stage < self.answer.stage:
            # A window without the fault does not tell its stage.
            return replace(shown, severity=replace(shown.severity, stage=self.answer.stage))
        return shown

    def _take_minute(self, *, healthy: bool) -> None:
        """Add a minute to the healthy record, and look for a rise over the first minutes."""
        heat, octaves, *levels = np.median(self.minute, axis=0).tolist()
        self.minute.clear()
        now, memory = Condition(heat, octaves), self.memory
        if healthy:
            memory.record.add(levels, now)
        if len(self.first) < _FIRST:
            self.first += [[heat, octaves, levels[0]]] * healthy
            return
        base, law = memory.at, memory.laws()[0]
        rows = [(Condition(h, o), was) for h, o, was in self.first]
        floors = [was - law.correct(c, base)[0] for c, was in rows if law.comparable(c, base)]
        if memory.base and floors and law.comparable(now, base):
            floor = float(np.median(floors))
            scatter = 1.4826 * float(np.median(np.abs(np.array(floors) - floor)))
            self.rise.add(levels[0] - law.correct(now, base)[0] - floor, scatter)

    def _held(self, own: Diagnosis, pace: Pace, full: bool, blind: bool) -> Diagnosis:
        """Return the diagnosis of a window with the held level and answer."""
        held = self.held
        if not held.level and not full:
            # The first full window sets the level; before it the level is unknown.
            return replace(own, level='none', window=(own.result, own.level))
        newest = HeldAnswer.of(own)
        # Without information a fault is held for as long as that lasts, any other answer for a
        # while. A blind window tells that the fault lasts, but neither its end nor its place.
        told = own.level == 'fault' if blind else (own.level != 'none' or held.level == 'suspect')
        before, level = held.level, held.take(own.level, pace) if told else held.level
        if told and own.level != level:
            self.other, self.other_count = HeldAnswer(), 0
        elif (told and not blind) and (
            level != before or newest.same(self.answer) or self._another(newest, pace.updates)
        ):
            self.answer = newest
            self.other, self.other_count = HeldAnswer(), 0
        answer, unknown = self.answer, level == 'ok' and not self.known.known
        if unknown:
            answer, level = HeldAnswer('insufficient', rule=self.silent_rule), 'none'
        if own.level == level and newest.same(answer):
            if unknown and self.known.needed and self.known.usable:
                return replace(own, reasons=(*own.reasons, str(self.known)))
            return own
        why = _BLIND if blind else self._why_held(newest, own.level, pace)
        text = f'{answer}, {level} held: {why}'
        return replace(
            own,
            result=answer.result,
            level=level,
            rule=answer.rule,
            faults=tuple(answer.faults),
            confidence=answer.confidence,
            kind=kind_of(answer.result, level, answer.faults, answer.rule),
            reasons=(*own.reasons, text),
            window=(own.result, own.level),
        )

    def _why_held(self, newest: HeldAnswer, level: str, pace: Pace) -> str:
        """Say why another answer, with its level, is not shown."""
        held = self.held
        if level == 'none' and held.level != 'suspect':
            what = self.known if held.level == 'ok' else _AFTER_REPAIR
            return f'this window tells nothing; {what}'
        if held.level == 'ok' and not self.known.known:
            return (
                f'{self.known}; the newest verdict says {newest}, {level}; '
                f'the last one that told nothing says {self.silent_why}'
            )
        if level == held.level:
            return f'{self.other_count} of {pace.updates} verdicts say {newest}'
        if LEVELS.index(level) > LEVELS.index(held.level):
            return f'{held.in_a_row(level)} of {pace.updates} verdicts say {newest}, {level}'
        wait, back = held.wait(pace), ', as it has come back' if held.returned else ''
        reset = f'; {_AFTER_REPAIR}' if wait >= _LONG else ''
        return (
            f'{held.quiet:.9g} of {wait:.9g} s without it{back}; '
            f'the newest verdict says {newest}, {level}{reset}'
        )

    def _another(self, answer: HeldAnswer, hold: int) -> bool:
        """Count another answer at the held level; return whether it becomes the held one."""
        self.other_count = self.other_count + 1 if answer.same(self.other) else 1
        self.other = answer
        return self.other_count >= hold

    def values(self) -> dict[str, Any]:
        """Return the fields as plain values for saving."""
        return asdict(self)
