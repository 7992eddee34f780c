# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Residual: what the fitted twin does not explain of its machine, by band and order, as one number.

The diagnosis finds bearing faults by their harmonics. Imbalance, looseness, another machine or a
drifting sensor have none of these: they change the difference between the spectra of machine and
twin from its healthy value. A *decision* is one comparison of both, once a minute.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
import math
from typing import Any

from bearing_twin.calibration.measured.summaries import HIGH_SHARE
from bearing_twin.errors import BearingTwinError
import numpy as np
import numpy.typing as npt
import scipy

FloatArray = npt.NDArray[np.float64]
Row = npt.NDArray[np.float32]
"""Differences of one decision, in single precision because many are stored."""

ORDERS = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0)
"""Orders of the shaft that show imbalance, misalignment and looseness."""
ORDER_WIDTH = 0.01
LOWEST_HZ = 10.0
"""Centre of the lowest third octave. The highest ends below the anti-aliasing filter."""
LEAST_S = 2.0
"""Least length of a window, s: it resolves the lines of a shaft from 5 Hz on."""
DECISIONS_A_YEAR = 365 * 24 * 60
"""One decision a minute."""
LEAST, DAY = 30, 24 * 60
"""Fewest healthy decisions for a limit, and most that are learnt. After a day the daily changes
are known; learning for longer would hide a sensor that drifts slowly."""
LEAST_DB = 0.5
"""Least limit of a band, dB: no sensor is known to the tenth of a decibel."""
DAY_DB = 2.0
"""Addition to the limit until a day was learnt, dB: the change of a level by 20 K, at two standard
deviations of `diagnosis.machine.dependence.PER_KELVIN`."""
LEAST_RUN, MOST_RUN = 3, 10
"""Fewest and most decisions in a row that an alarm needs: two may be disturbed. A large change
needs fewer."""
_RUNS = np.arange(LEAST_RUN, MOST_RUN + 1)[:, np.newaxis]
"""Lengths of a run, shape (lengths, 1)."""
TAIL = 4.0
"""The probability of a decision beyond m times the highest healthy difference falls with m to this
power. It falls faster for normal differences and for Student's t with six degrees of freedom."""
MEMORY = 1.5
"""Decisions this many memories apart count as independent: see `_memory`. An exponential
correlation has then fallen to 0.05."""
ENOUGH_DECISIONS = 100
"""Healthy decisions, times the root of the memory, that show a slow part of a difference which is
as large as the random part. With fewer the limit is wider in proportion."""
STEP_MEAN, STEP_GAP = 30, 10
"""A step is the difference from a mean: of `STEP_MEAN` decisions that ended `STEP_GAP` ago."""
HISTORY = 128
"""Most decisions that a run may span; a band that varies too slowly for this is not judged."""
MOVED = 0.02
"""Largest relative change of the speed within a record (fastest minus slowest over the mean) and
between compared records. The lines of the shaft then stay within `ORDER_WIDTH`. On impact trains
with a ramp of 2 % the spacing of the impacts is within 0.1 % and keeps nine tenths of its
prominence; with 10 % it is up to 1.5 % too short."""
SPEEDS = 32
"""Most speeds that are stored: in steps of 4 % they cover a ratio of three and a half."""
LEVEL_REASONS = (
    '{} is {:.0f} dB over what the twin explains',
    '{} is {:.0f} dB under what the twin explains',
)
STEP_REASONS = (
    '{} has risen by {:.0f} dB within the hour',
    '{} has fallen by {:.0f} dB within the hour',
)
_NOT_SAVED = 'saved residual is invalid; use what save() returned'


def spectral_levels(
    x: npt.ArrayLike, sample_rate: float, shaft_hz: float
) -> tuple[tuple[str, ...], FloatArray]:
    """
    Return third-octave levels of a vibration, the tonality of each, and the lines of the shaft.

    The tonality is the highest line of a third octave over its median. A line of another machine
    shows in it long before it raises the whole band.

    Parameters
    ----------
    x
        Samples, shape (n,), at least 2 s.
    sample_rate
        Hz.
    shaft_hz
        Shaft speed, Hz; NaN: no lines of the shaft.

    Returns
    -------
    names, levels
        dB, shape (m,); NaN where a band or a line cannot be resolved.

    Examples
    --------
    >>> t = np.arange(51200) / 25600.0
    >>> noise = np.random.default_rng(0).standard_normal(51200)
    >>> names, quiet = spectral_levels(noise, 25600.0, 25.0)
    >>> _, loud = spectral_levels(noise + np.sin(2 * np.pi * 25.0 * t), 25600.0, 25.0)
    >>> names[int(np.nanargmax(loud - quiet))]
    'order 1'

    """
    values = np.asarray(x, dtype=np.float64)
    if values.ndim != 1 or len(values) < LEAST_S * sample_rate or not np.isfinite(values).all():
        raise BearingTwinError(
            f'{values.shape} samples at {sample_rate:g} Hz: a residual needs {LEAST_S:g} s of '
            'finite samples of one axis'
        )
    hertz, power = scipy.signal.welch(
        values, sample_rate, 'hann', nperseg=round(LEAST_S * sample_rate), detrend='constant'
    )
    power = np.maximum(power, 1e-30)
    step = float(hertz[1])
    names, levels = [], []
    centres = LOWEST_HZ * 2.0 ** (np.arange(40) / 3.0)
    for centre in centres[centres * 2.0 ** (1.0 / 6.0) < HIGH_SHARE * sample_rate / 2.0]:
        inside = (hertz >= centre * 2.0 ** (-1.0 / 6.0)) & (hertz < centre * 2.0 ** (1.0 / 6.0))
        band = power[inside]
        enough = len(band) >= 3
        names.append(f'{centre:.0f} Hz')
        levels.append(10.0 * math.log10(band.sum() * step) if enough else math.nan)
        names.append(f'line near {centre:.0f} Hz')
        tonality = 10.0 * math.log10(band.max() / np.median(band)) if enough else math.nan
        levels.append(tonality)
    for order in ORDERS:
        names.append(f'order {order:g}')
        width = max(ORDER_WIDTH * order * shaft_hz, 1.5 * step)
        near = power[np.abs(hertz - order * shaft_hz) <= width]
        there = order * shaft_hz > 3.0 * step and len(near) > 0
        levels.append(10.0 * math.log10(float(near.max()) * step) if there else math.nan)
    return tuple(names), np.array(levels)


@dataclass(frozen=True)
class ResidualDecision:
    """Residual of one decision."""

    number: float
    """Largest difference over its limit: 1 is an alarm. NaN until the limit is known."""
    where: str
    """Band or order of the largest difference."""
    over: float
    """Change of machine minus twin there since the machine was healthy, dB."""
    reason: str
    """Result in words, or why there is no number."""

    @property
    def alarm(self) -> bool:
        """Whether the twin does not explain its machine."""
        return self.number >= 1.0


@dataclass(eq=False)
class Residual:
    """
    Learn the differences between a healthy machine and its twin, and judge new ones.

    The limit is a rank, so that no distribution of the differences is assumed. If n healthy
    decisions and k new ones are independent and alike, all k are beyond the highest of the n once
    in (n + k)! / (n! k!) cases. An alarm is a run so long that this happens once a year over all
    bands, both sides and all lengths of a run. A shorter run has to be beyond a multiple of the
    highest: see `TAIL`. If a difference is correlated in time, in its value or its size, only
    decisions that are independent count. Steps, differences from the mean of half an hour ago, are
    judged in the same way: they show a sudden change that slow variation hides.

    ``studies.residual`` counts false and true alarms (docs/calibration.md).

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> residual = Residual()
    >>> for _ in range(200):
    ...     residual.learn(('10 Hz', 'order 1'), rng.standard_normal(2))
    >>> for _ in range(3):
    ...     found = residual.judge(('10 Hz', 'order 1'), np.array([0.5, 1.0]))
    >>> found.alarm
    False
    >>> for _ in range(3):
    ...     found = residual.judge(('10 Hz', 'order 1'), np.array([0.5, 12.0]))
    >>> found.reason
    'order 1 is 12 dB over what the twin explains'

    """

    names: tuple[str, ...] = ()
    rows: list[Row] = field(default_factory=list)
    recent: list[Row] = field(default_factory=list)
    """The newest decisions, which are judged."""
    waiting: list[Row] = field(default_factory=list)
    """Healthy decisions that are learnt if no alarm follows."""
    number: int = 0
    """Number of its newest decision, counted over all speeds of the machine."""

    def __post_init__(self) -> None:
        self._limits: list[_Limits] = []

    def learn(self, names: tuple[str, ...], difference: FloatArray) -> None:
        """Learn a healthy decision: machine minus twin, dB, shape (m,)."""
        if names != self.names:
            self.names, self.rows, self.recent, self.waiting = tuple(names), [], [], []
        if len(self.rows) < DAY:
            self._limits = []
            self.rows.append(difference.astype(np.float32))

    def update(
        self, names: tuple[str, ...], difference: FloatArray, *, healthy: bool
    ) -> ResidualDecision:
        """
        Judge a decision, and learn earlier ones that have proved healthy.

        A decision is learnt after as many others as an alarm needs, so that the beginning of an
        alarm is not learnt.
        """
        found = self.judge(names, difference)
        if found.alarm or not healthy or names != self.names:
            self.waiting = []
        if healthy and not found.alarm:
            self.waiting.append(difference.astype(np.float32))
        wait = 1 + (MOST_RUN - 1) * int(np.median(self._limits[0].apart) if self._limits else 1)
        while len(self.waiting) > min(wait, HISTORY) or (self.waiting and not self.rows):
            self.learn(names, np.array(self.waiting.pop(0)))
        return found

    def judge(self, names: tuple[str, ...], difference: FloatArray) -> ResidualDecision:
        """Compare a decision with the healthy ones."""
        alike = names == self.names
        if alike:
            self.recent = [*self.recent, difference.astype(np.float32)][
                -HISTORY - STEP_MEAN - STEP_GAP :
            ]
        if not alike or len(self.rows) < LEAST:
            count = len(self.rows) if alike else 0
            return _nothing(f'{count} healthy decisions of {LEAST} that a limit needs')
        if len(self.recent) < LEAST_RUN:
            return _nothing(f'{len(self.recent)} decisions of {LEAST_RUN} that an alarm needs')
        self._learn_limits()
        deep = max(limits.deep for limits in self._limits)
        recent = np.array(self.recent[-deep - STEP_MEAN - STEP_GAP :], np.float64)
        tables = (recent[-deep:], LEVEL_REASONS), (_steps(recent), STEP_REASONS)
        found = max(
            (
                limits.decision(table, names, reasons)
                for limits, (table, reasons) in zip(self._limits, tables, strict=False)
                if len(table)
            ),
            key=lambda decision: decision.number,
        )
        if found.number == -math.inf:
            return _nothing('the healthy levels vary too slowly to judge any band')
        if found.alarm:
            return found
        return replace(
            found, number=max(found.number, 0.0), reason='the twin explains its machine'
        )

    def _learn_limits(self) -> None:
        if not self._limits:
            rows = np.array(self.rows, np.float64)
            steps = _steps(rows)
            allowed = DAY_DB if len(rows) < DAY else 0.0
            self._limits = [_limits(rows, allowed)]
            self._limits += [_limits(steps, 0.0)] if len(steps) >= LEAST else []

    def save(self) -> tuple[dict[str, Any], Row]:
        """Return plain values and all decisions, which :meth:`of` reads."""
        decisions = [*self.rows, *self.recent, *self.waiting]
        values = {
            'names': list(self.names), 'number': self.number, 'rows': len(self.rows),
            'recent': len(self.recent),
        }  # fmt: skip
        return values, np.array(decisions, np.float32).reshape(len(decisions), len(self.names))

    @classmethod
    def of(cls, values: dict[str, Any], decisions: Row) -> Residual:
        """Return the residual that :meth:`save` has written."""
        try:
            names, rows, recent = (
                tuple(map(str, values['names'])),
                values['rows'],
                values['recent'],
            )
            count, shape = len(decisions), (len(decisions), len(names))
            if decisions.shape != shape or not 0 <= rows <= rows + recent <= count:
                raise ValueError(decisions.shape)
            learnt, newest, waiting = np.split(decisions, [rows, rows + recent])
            return cls(names, list(learnt), list(newest), list(waiting), int(values['number']))
        except (KeyError, TypeError, ValueError, AttributeError):
            raise BearingTwinError(_NOT_SAVED) from None


@dataclass(eq=False)
class Residuals:
    """
    Residuals of a machine, one for each speed, because its lines depend on the speed.

    Examples
    --------
    >>> residuals = Residuals()
    >>> for _ in range(50):
    ...     said = residuals.update(('10 Hz',), np.zeros(1), 25.0, healthy=True)
    >>> said.number, residuals.update(('10 Hz',), np.ones(1), 28.0, healthy=True).reason
    (0.0, '0 healthy decisions of 30 that a limit needs at 28 Hz; known at 25 Hz')

    """

    known: list[tuple[float, Residual]] = field(default_factory=list)
    """Speeds, Hz, and the residual of each, the last used one at the end."""

    def update(
        self, names: tuple[str, ...], difference: FloatArray, shaft_hz: float, *, healthy: bool
    ) -> ResidualDecision:
        """Judge a decision at a speed, Hz, and learn from it: see `Residual.update`."""
        near = [each for each in self.known if abs(each[0] / shaft_hz - 1.0) <= MOVED]
        if not near and len(self.known) >= SPEEDS:
            # Drop the oldest speed, if possible one with too few decisions for a limit.
            few = [each for each in self.known if len(each[1].rows) < LEAST]
            self.known.remove((few or self.known)[0])
        new = (shaft_hz, Residual())
        at = min(near, key=lambda each: abs(math.log(each[0] / shaft_hz)), default=new)
        residual = at[1]
        self.known = [*(each for each in self.known if each is not at), at]
        number = 1 + max(each.number for _, each in self.known)
        if number - residual.number > LEAST:
            # Decisions at this speed from hours or days ago do not form a run with new ones.
            residual.recent, residual.waiting = [], []
        residual.number = number
        speeds = [f'{hz:.3g}' for hz, each in self.known if len(each.rows) >= LEAST]
        found = residual.update(names, difference, healthy=healthy)
        if math.isfinite(found.number) or not speeds:
            return found
        said = f'{found.reason} at {shaft_hz:.3g} Hz; known at {", ".join(speeds)} Hz'
        return replace(found, reason=said)

    def save(self) -> tuple[list[dict[str, Any]], dict[str, Row]]:
        """Return plain values and arrays, which :meth:`of` reads."""
        saved = [each.save() for _, each in self.known]
        values = [
            {'shaft_hz': hz, **plain}
            for (hz, _), (plain, _) in zip(self.known, saved, strict=True)
        ]  # fmt: skip
        return values, {str(at): decisions for at, (_, decisions) in enumerate(saved)}

    @classmethod
    def of(cls, values: Any, arrays: dict[str, Row]) -> Residuals:
        """Return the residuals that :meth:`save` has written."""
        try:
            known = [
                (float(each['shaft_hz']), Residual.of(each, arrays[str(at)]))
                for at, each in enumerate(values)
            ]
        except (KeyError, TypeError, ValueError):
            raise BearingTwinError(_NOT_SAVED) from None
        if not all(0.0 < hz < math.inf for hz, _ in known):
            raise BearingTwinError(_NOT_SAVED)
        return cls(known)


def _nothing(reason: str) -> ResidualDecision:
    return ResidualDecision(math.nan, '', math.nan, reason)


def _steps(rows: FloatArray) -> FloatArray:
    """Return each decision less the mean of earlier ones: see `STEP_MEAN`; shape (n - 40, m)."""
    sums = np.cumsum(np.concatenate([np.zeros((1, rows.shape[1])), rows]), axis=0)
    means = (sums[STEP_MEAN:] - sums[:-STEP_MEAN]) / STEP_MEAN
    return np.asarray(
        rows[STEP_MEAN + STEP_GAP :] - means[: max(len(rows) - STEP_MEAN - STEP_GAP, 0)]
    )


@dataclass(frozen=True)
class _Limits:
    """Limits of the bands: distance from the healthy centre for each length of a run."""

    centre: FloatArray
    """dB, shape (m,)."""
    reach: FloatArray
    """Highest healthy difference over and under the centre, dB, shape (2, m)."""
    apart: npt.NDArray[np.int64]
    """Decisions from one that counts to the next, shape (m,)."""
    raised: FloatArray
    """Multiple of the reach that a run of each length has to exceed, shape (lengths, m)."""

    @property
    def windows(self) -> npt.NDArray[np.int64]:
        """Decisions that a run of each length spans, shape (lengths, m)."""
        return 1 + (_RUNS - 1) * self.apart

    @property
    def deep(self) -> int:
        """Decisions that the longest run spans."""
        return min(int(self.windows.max()), HISTORY)

    def decision(
        self, table: FloatArray, names: tuple[str, ...], reasons: tuple[str, str]
    ) -> ResidualDecision:
        """Judge the last of the decisions; the number is -inf if no band can be judged."""
        shares = self._shares(table)
        side, band = np.unravel_index(int(np.argmax(shares)), shares.shape)
        over = float(np.median(table[-LEAST_RUN:, band]) - self.centre[band])
        reason = reasons[side].format(names[band], abs(over))
        return ResidualDecision(float(shares[side, band]), names[band], over, reason)

    def _shares(self, table: FloatArray) -> FloatArray:
        """Return the share of a limit over and under, shape (2, m); -inf: not judged."""
        if len(table) < LEAST_RUN:
            return np.full(self.reach.shape, -math.inf)
        held = np.minimum.accumulate(self._beyond(table)[::-1], axis=0)
        windows = self.windows[:, np.newaxis]
        of_runs = np.take_along_axis(held, np.minimum(windows, len(held)) - 1, axis=0)
        shares = np.where(windows <= len(held), of_runs / self.raised[:, np.newaxis], 0.0)
        # Without a run, tell how far the band is on the other side.
        newest = held[LEAST_RUN - 1]
        found: FloatArray = np.where(newest < 0.0, newest, shares.max(axis=0, initial=0.0))
        return found

    def _beyond(self, table: FloatArray) -> FloatArray:
        """Return differences over and under the centre, in reaches, shape (n, 2, m)."""
        over = table - self.centre
        return np.nan_to_num(np.stack([over, -over], axis=1) / self.reach, nan=-math.inf)


def _limits(rows: FloatArray, allowed: float) -> _Limits:
    """Return the limits from healthy decisions, dB, shape (n, m); ``allowed``, dB, is added."""
    count, bands = rows.shape
    centre = np.median(rows, axis=0)
    sizes = np.abs(rows - centre)
    # The scatter of all bands changes together; a single band shows this too weakly.
    together = (sizes / np.maximum(sizes.mean(axis=0), 1e-9)).mean(axis=1)
    size_memory = _memory(np.column_stack([sizes, together]))
    memory = np.maximum(_memory(rows), np.maximum(size_memory[:-1], size_memory[-1]))
    apart = np.ceil(1.0 + MEMORY * (memory - 1.0) - 1e-9)
    centre[(LEAST_RUN - 1) * apart >= HISTORY] = math.nan
    reach = np.stack([rows.max(axis=0) - centre, centre - rows.min(axis=0)])
    wider = np.maximum(ENOUGH_DECISIONS * np.sqrt(apart) / count, 1.0)
    reach = np.maximum(reach, LEAST_DB) * wider + allowed
    # Two sides times differences and steps, and every length of a run.
    cases = 4 * bands * len(_RUNS) * DECISIONS_A_YEAR
    independent = np.maximum(count / apart, 1.0)
    ln = scipy.special.gammaln
    ranks = ln(independent + _RUNS + 1.0) - ln(independent + 1.0) - ln(_RUNS + 1.0)
    raised = np.maximum(np.exp((math.log(cases) - ranks) / (TAIL * _RUNS)), 1.0)
    return _Limits(centre, reach, apart.astype(np.int64), raised)


def _memory(rows: FloatArray) -> FloatArray:
    """
    Return the integrated autocorrelation time of each band, decisions, shape (m,); 1: white.

    Ranks are correlated, so that single outliers do not hide it. The median correlation over the
    bands counts for all; the correlation of a single band counts if it exceeds chance.
    """
    count = len(rows)
    ranks = scipy.stats.rankdata(rows, axis=0) - (count + 1) / 2.0
    size = scipy.fft.next_fast_len(2 * count)
    power = np.abs(np.fft.rfft(ranks, size, axis=0)) ** 2
    sums = np.fft.irfft(power, size, axis=0)[: count // 2]
    # Removing the mean of the record itself lowers its correlation.
    alike = sums[1:] / np.maximum(sums[0], 1e-9) + 1.0 / count
    chance = 1.0 / math.sqrt(count)
    own = alike * (alike[0] > 2.0 * chance)
    both = np.stack([own, np.broadcast_to(np.nanmedian(alike, axis=1)[:, None], own.shape)])
    told = np.cumprod(both > chance, axis=1)
    return np.asarray((1.0 + 2.0 * np.where(told, both, 0.0).sum(axis=1)).max(axis=0))
