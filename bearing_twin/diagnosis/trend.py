# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Memory of one asset: its baseline, learnt while healthy, and an answer that does not chatter."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
import math
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import FAULT_CODES, LEVELS, PLACES, RESULTS
from bearing_twin.diagnosis.dependence import Condition, HealthyRecord, Law
from bearing_twin.diagnosis.level import FALLEN, FAULT_DB, raised, staged
from bearing_twin.diagnosis.onset import Rise
from bearing_twin.diagnosis.severity import watched
from bearing_twin.errors import BearingTwinError
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.diagnosis.result import Diagnosis

__all__ = ['Source', 'Trend']

_SAME_RATE = 0.05
_DOUBTFUL = 0.1
"""Share of doubtful windows above which the baseline says that it was learnt beside them."""
_NOT_YET = (
    'no baseline: {doubtful} windows were suspect or faulty and {count} of {wanted} healthy; '
    'what combs and the ISO zone say holds without it'
)
_LEARNT_IN_DOUBT = (
    'the baseline was learnt from {wanted} healthy windows among {doubtful} that were suspect or '
    'faulty: a level over it may be that over a damaged machine; ~/reset learns it anew'
)
_FIRST = 60
"""Minutes over which a rise is looked for: what a machine does in its first healthy hour."""


class Source(NamedTuple):
    """
    What a baseline is learnt from: levels of different sources are not compared.

    >>> machine = Source('imu y', '6205', 'm/s^2', 12000.0)
    >>> machine.same(machine._replace(sample_rate=12003.2)), machine.same(Source())
    (True, False)
    >>> print(machine)
    sensor 'imu y', bearing '6205', 'm/s^2', 12000 Hz

    """

    sensor: str = ''
    """Frame and axis."""
    bearing: str = ''
    unit: str = ''
    """Of the samples."""
    sample_rate: float = 0.0
    """Hz. One that is estimated from stamps differs a little from start to start."""

    def same(self, other: Source) -> bool:
        """Whether levels of both are comparable."""
        near = abs(self.sample_rate - other.sample_rate) <= _SAME_RATE * self.sample_rate
        return near and self[:3] == other[:3]

    def __str__(self) -> str:
        """Return it for a message."""
        rate = f'{self.sample_rate:.5g} Hz'
        return f'sensor {self.sensor!r}, bearing {self.bearing!r}, {self.unit!r}, {rate}'


@dataclass
class Trend:
    """Baseline and held answer; plain values, so that they can be saved."""

    count: int = 0
    """Healthy windows learnt from so far."""
    doubtful: int = 0
    """Windows that were suspect or faulty meanwhile."""
    mean: float = 0.0
    """Their mean level, dB."""
    temperature: float = math.nan
    """Their mean temperature, degC; NaN if unknown."""
    octaves: float = math.nan
    """Mean base-2 logarithm of their shaft speed in Hz; NaN if unknown."""
    temperature_count: int = 0
    """Healthy windows with a temperature."""
    octaves_count: int = 0
    """Healthy windows with a speed."""
    record: HealthyRecord = field(default_factory=HealthyRecord)
    """Level, temperature and speed of each healthy minute."""
    first: list[list[float]] = field(default_factory=list)
    """Temperature, octaves and level of the first healthy minutes."""
    minute: list[list[float]] = field(default_factory=list)
    """The same of the windows of the present minute."""
    rise: Rise = field(default_factory=Rise)
    sensor: str = ''
    bearing: str = ''
    unit: str = ''
    sample_rate: float = 0.0
    level: str = ''
    """Level that is held; empty before the first statement."""
    pending: str = ''
    """Level that wants to take over."""
    pending_count: int = 0
    """Verdicts in a row that asked for it."""
    answer: str = ''
    """Answer that is held at that level, with its faults: ``'ambiguous ball cage'``."""
    confidence: float = 0.0
    """Confidence of that answer."""
    other: str = ''
    """Answer of the same level that wants to take over."""
    other_count: int = 0
    """Verdicts in a row that gave it."""

    @property
    def source(self) -> Source:
        """What it is learnt from; its sample rate is 0 before the first statement."""
        return Source(self.sensor, self.bearing, self.unit, self.sample_rate)

    def takes(self, source: Source) -> bool:
        """Whether windows of ``source`` belong to it."""
        return not self.sample_rate or self.source.same(source)

    def update(
        self,
        diagnosis: Diagnosis,
        source: Source,
        *,
        wanted: int,
        hold: int,
        full: bool,
        minute: int = 60,
    ) -> Diagnosis:
        """
        Take a diagnosis in; return it with level over baseline, stage and the held answer.

        Parameters
        ----------
        diagnosis
            Fresh verdict.
        source
            What it was made from, which the trend :meth:`takes`.
        wanted
            Healthy windows that make a baseline; it is then kept as it is.
        hold
            Verdicts in a row before level or answer change.
        full
            Whether the window was full. The first full one sets the level at once.
        minute
            Windows in a minute.

        """
        severity = diagnosis.severity
        if not severity.rms > 0.0:
            return self._shown(diagnosis, hold, full)
        level = float(watched(severity)[0])
        now = Condition.at(diagnosis.temperature, diagnosis.shaft_hz)
        if not self.sample_rate:
            self.sensor, self.bearing, self.unit, self.sample_rate = source
        if self.count < wanted:
            alone = raised(diagnosis).level
            self.doubtful += full and alone in ('suspect', 'fault')
            # A healthy window among faulty ones shows a damaged machine.
            if alone == 'ok' and self.level in ('', 'ok'):
                self._learn(level, now)
        if self.doubtful > _DOUBTFUL * wanted:
            said = _NOT_YET if self.count < wanted else _LEARNT_IN_DOUBT
            said = said.format(count=self.count, wanted=wanted, doubtful=self.doubtful)
            diagnosis = replace(diagnosis, reasons=(*diagnosis.reasons, said))
        over = math.nan
        if self.count >= wanted:
            law = next(iter(self.record.laws()), Law())
            base = Condition(self.temperature, self.octaves)
            if law.comparable(now, base):
                correction, deviation = law.correct(now, base)
                over = level - correction - self.mean
                severity = replace(severity, correction=correction, correction_sd=deviation)
            else:
                said = f'baseline is of {2.0**base.octaves:.4g} Hz: not compared at this speed'
                diagnosis = replace(diagnosis, reasons=(*diagnosis.reasons, said))
            severity = replace(severity, correction_basis=str(law))
        if over <= -FAULT_DB:
            # Neither combs nor a low level of a sensor that hears nothing say that all is well.
            diagnosis = replace(
                diagnosis, result='insufficient', level='none', faults=(), confidence=0.0,
                fault_code=FAULT_CODES['insufficient'], kind='',
                reasons=(*diagnosis.reasons, f'{over:.1f} dB over the baseline: {FALLEN}'),
            )  # fmt: skip
        rising = self.rise.lasting if self.rise.found else 0
        severity = replace(severity, level_over_baseline=over, rising=rising)
        own = raised(replace(diagnosis, severity=severity))
        if full:
            self.minute.append([*now, level])
            if len(self.minute) >= minute:
                self._take_minute(healthy=own.level == 'ok')
        return self._shown(own, hold, full)

    def _shown(self, own: Diagnosis, hold: int, full: bool) -> Diagnosis:
        """Return what is shown of a window; one that tells nothing does not end an alarm."""
        held = own.level != 'none' or self.level in ('suspect', 'fault')
        return staged(self._held(own, hold, full) if held else own)

    def _learn(self, level: float, now: Condition) -> None:
        self.count += 1
        self.mean += (level - self.mean) / self.count
        for name, value in zip(('temperature', 'octaves'), now, strict=True):
            if math.isfinite(value):
                # Of the windows that know it, which may be fewer than all.
                known = getattr(self, f'{name}_count') + 1
                before = getattr(self, name) if known > 1 else value
                setattr(self, f'{name}_count', known)
                setattr(self, name, before + (value - before) / known)

    def _take_minute(self, *, healthy: bool) -> None:
        """Take a minute into the healthy record, and look for a rise over the first ones."""
        heat, octaves, level = np.median(self.minute, axis=0).tolist()
        self.minute.clear()
        now = Condition(heat, octaves)
        if healthy:
            self.record.add([level], now)
        if len(self.first) < _FIRST:
            self.first += [[heat, octaves, level]] * healthy
            return
        base = Condition(self.temperature, self.octaves)
        law = next(iter(self.record.laws()), Law())
        rows = [(Condition(h, o), was) for h, o, was in self.first]
        floors = [was - law.correct(c, base)[0] for c, was in rows if law.comparable(c, base)]
        if floors and law.comparable(now, base):
            floor = float(np.median(floors))
            scatter = 1.4826 * float(np.median(np.abs(np.array(floors) - floor)))
            self.rise.add(level - law.correct(now, base)[0] - floor, scatter)

    def _held(self, own: Diagnosis, hold: int, full: bool) -> Diagnosis:
        """Return a window's own diagnosis with the level and the answer that are held."""
        if not self.level and not full:
            # The first full window sets the level; before it none is known.
            return replace(own, level='none', window=(own.result, own.level))
        said = ' '.join((own.result, *own.faults))
        known = own.level != 'none'
        before, level = self.level, self._hold(own.level, hold) if known else self.level
        if own.level != level:
            self.other, self.other_count = '', 0
        elif level != before or said == self.answer or self._another(said, hold):
            self.answer, self.confidence = said, own.confidence
            self.other, self.other_count = '', 0
        if (own.level, said) == (level, self.answer):
            return own
        result, *faults = self.answer.split()
        count, words = self.other_count, _spoken(said)
        if own.level != level:
            count, words = self.pending_count, f'{_spoken(said)}, {own.level}'
        text = f'{_spoken(self.answer)}, {level} held: '
        text += f'{count} of {hold} verdicts say {words}' if known else 'this window tells nothing'
        return replace(
            own,
            result=result,
            level=level,
            faults=tuple(faults),
            fault_code=FAULT_CODES[result],
            confidence=self.confidence,
            reasons=(*own.reasons, text),
            window=(own.result, own.level),
        )

    def _another(self, said: str, hold: int) -> bool:
        """Whether another answer of the held level takes over."""
        self.other_count = self.other_count + 1 if said == self.other else 1
        self.other = said
        return self.other_count >= hold

    def _hold(self, level: str, hold: int) -> str:
        if not self.level:
            self.level = level
        if level == self.level:
            self.pending, self.pending_count = '', 0
            return level
        self.pending_count = self.pending_count + 1 if level == self.pending else 1
        self.pending = level
        if self.pending_count >= hold:
            self.level, self.pending, self.pending_count = level, '', 0
        return self.level

    def values(self) -> dict[str, Any]:
        """Plain values for saving."""
        return asdict(self)

    @classmethod
    def of(cls, values: dict[str, Any]) -> Trend:
        """
        Trend of saved values.

        Raises
        ------
        BearingTwinError
            If they are not such values.

        """
        trend = cls()
        for name, default in vars(cls()).items():
            value = values.get(name) if isinstance(values, dict) else None
            if isinstance(value, dict) and isinstance(default, HealthyRecord | Rise):
                value = type(default).of(value)
            right = type(value) is type(default) or (type(default) is float and type(value) is int)
            if not right:
                msg = f'saved trend has {name}={value!r}; use what save() returned'
                raise BearingTwinError(msg)
            setattr(trend, name, value)
        known = ('', *LEVELS)
        sound = trend.level in known and trend.pending in known and math.isfinite(trend.mean)
        sound &= 0.0 <= trend.sample_rate < math.inf
        words = f'{trend.answer} {trend.other}'.split()
        sound &= set(words) <= {*RESULTS, *PLACES} and 0.0 <= trend.confidence <= 1.0
        sound &= bool(trend.level) == bool(trend.answer)
        readings = [*trend.first, *trend.minute]
        sound &= all(isinstance(row, list) and len(row) == 3 for row in readings)
        counts = (
            trend.count,
            trend.doubtful,
            trend.pending_count,
            trend.other_count,
            trend.temperature_count,
            trend.octaves_count,
        )
        if not sound or min(counts) < 0:
            msg = f'saved trend is out of range: {values}; use what save() returned'
            raise BearingTwinError(msg)
        return trend


def _spoken(answer: str) -> str:
    """Return an answer with its faults in words: 'outer and inner', 'ambiguous ball or cage'."""
    result, *faults = answer.split()
    if result in faults:
        return ' and '.join(faults)
    return f'{result} {" or ".join(faults)}'.rstrip()
