# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
What the fitted twin does not explain of its machine, by band and by order, as one number.

The four fault families are looked for by their combs. Imbalance, looseness, another machine or a
drifting sensor have none: they show as a difference between the spectra of machine and twin that
was not there while the machine was healthy.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
import math
from typing import Any

from bearing_twin.calibration.summaries import HIGH_SHARE
from bearing_twin.diagnosis.dependence import lag_one
from bearing_twin.errors import BearingTwinError
import numpy as np
import numpy.typing as npt
import scipy

FloatArray = npt.NDArray[np.float64]

ORDERS = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0)
"""Of the shaft: imbalance, misalignment and looseness are there."""
ORDER_WIDTH = 0.01
LOWEST_HZ = 10.0
"""Third octaves begin there, and end where an anti-aliasing filter begins."""
LEAST_S = 2.0
"""Least length of a window: lines of a shaft from 5 Hz on are told from their neighbours."""
DECISIONS_A_YEAR = 365 * 24 * 60
"""One decision a minute."""
LEAST, MOST = 30, 512
"""Healthy decisions from which a limit is known, and after which no more are learnt: a sensor that
drifts slowly must not teach that it does."""
LEAST_DB = 0.25
"""Least standard deviation of a difference: no sensor is known to the hundredth of a decibel."""
CONFIRMING = 5
"""Decisions whose median is judged: two of five may be disturbed."""
BOOTSTRAPS = 200
TAIL = 0.95
"""Quantile at which the tails of the healthy record are looked at, and confidence of a limit."""
BLOCK = 5
"""Decisions in a row that are drawn together: what has a memory is drawn with it."""
MOVED = 0.02
"""Most that the speed may move within a record, from the slowest to the fastest over the mean, and
from one record to another that it is compared with. The lines of the shaft then stay where
`ORDER_WIDTH` looks for them. On impact trains with a ramp, 2 % leaves the spacing of the impacts
within 0.1 % and nine tenths of its prominence; 10 % makes it up to 1.5 % too short."""
SPEEDS = 32
"""Speeds at which a machine is known: in steps of 4 %, all from one to three and a half times."""
_NOT_SAVED = 'saved residual is invalid; use what save() returned'


def spectral_levels(
    x: npt.ArrayLike, sample_rate: float, shaft_hz: float
) -> tuple[tuple[str, ...], FloatArray]:
    """
    Levels of a vibration by third octave, tonality of each, and lines of the shaft.

    The tonality is the highest line of a third octave over its median: a line of another machine
    shows there long before it raises the whole band.

    Parameters
    ----------
    x
        Samples, shape (n,), at least 2 s.
    sample_rate
        Hz.
    shaft_hz
        Hz; NaN: no lines of the shaft.

    Returns
    -------
    names, levels
        dB, shape (m,); NaN where a band or a line cannot be resolved.

    Raises
    ------
    BearingTwinError
        If the samples are too few or not finite.

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
        msg = (
            f'{values.shape} samples at {sample_rate:g} Hz: a residual needs {LEAST_S:g} s of '
            'finite samples of one axis'
        )
        raise BearingTwinError(msg)
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
class Unexplained:
    """What a window shows beyond its twin."""

    number: float
    """Largest difference over its limit: 1 is an alarm. NaN until the limit is known."""
    where: str
    """Band or order of the largest."""
    over: float
    """How far machine minus twin is from what it was in the healthy record there, dB."""
    reason: str
    """In words; why there is no number, if there is none."""
    names: tuple[str, ...] = ()
    differences: FloatArray = field(default_factory=lambda: np.zeros(0))
    """Machine minus twin less its healthy mean, dB, median of the last five; by name."""

    @property
    def alarm(self) -> bool:
        """Whether the twin does not explain its machine."""
        return self.number >= 1.0


@dataclass
class Residual:
    """
    Differences between a machine and its twin while it was healthy; plain values, to be saved.

    The median of the last five differences is compared with their healthy mean and standard
    deviation, at one false alarm a year of one decision a minute over all bands and orders
    together (Bonferroni). The limit is a tolerance limit: the standard deviation is taken as large
    as it may be (95 %) by the effective number of healthy decisions; in a band with a memory they
    count less. Where the healthy record itself has longer tails than the normal distribution, by a
    bootstrap in blocks, the limit is raised by as much. What the machine has not done in that
    record, as a change of load or of the season, is not allowed for.

    One a year is what the limit is derived for. `studies.residual` counts: no alarm in 500 000
    decisions of simulated machines whose differences are normal and independent, none with a
    memory of 5, none with one of 20 decisions (a year has 525 600). With long tails (Student's t,
    6 degrees of freedom) 1 came in 2 500 000, and about three a year in an earlier run of 500
    machines: with long tails expect up to three a year. No real machine was watched for a year.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> residual = Residual()
    >>> for _ in range(60):
    ...     residual.learn(('10 Hz', 'order 1'), rng.standard_normal(2))
    >>> residual.judge(('10 Hz', 'order 1'), np.array([0.5, 1.0])).alarm
    False
    >>> for _ in range(5):
    ...     found = residual.judge(('10 Hz', 'order 1'), np.array([0.5, 12.0]))
    >>> found.reason
    'order 1 is 12 dB over what the twin explains'

    """

    names: tuple[str, ...] = ()
    rows: list[list[float]] = field(default_factory=list)
    recent: list[list[float]] = field(default_factory=list)
    """The newest decisions; their median is judged."""
    waiting: list[list[float]] = field(default_factory=list)
    """Decisions that are learnt from if no alarm follows."""
    number: int = 0
    """Of its newest decision, counted over all speeds of the machine."""

    def __post_init__(self) -> None:
        self._limits: tuple[FloatArray, FloatArray] | None = None

    def learn(self, names: tuple[str, ...], difference: FloatArray) -> None:
        """Take the difference, machine minus twin, dB, of a healthy decision."""
        if names != self.names:
            self.names, self.rows, self.recent, self.waiting = tuple(names), [], [], []
        if len(self.rows) < MOST:
            self._limits = None
            self.rows.append([float(value) for value in difference])

    def update(
        self, names: tuple[str, ...], difference: FloatArray, *, healthy: bool
    ) -> Unexplained:
        """
        Judge a decision, and learn from those before it that have proved healthy.

        A decision waits for as many as an alarm needs: what an alarm begins with is not learnt.
        """
        found = self.judge(names, difference)
        if found.alarm or not healthy or names != self.names:
            self.waiting = []
        if healthy and not found.alarm:
            self.waiting.append([float(value) for value in difference])
        if len(self.waiting) > CONFIRMING or not self.rows:
            for row in self.waiting[:1]:
                self.learn(names, np.array(row))
            self.waiting = self.waiting[1:]
        return found

    def judge(self, names: tuple[str, ...], difference: FloatArray) -> Unexplained:
        """Compare a decision with the healthy ones."""
        if names != self.names or len(self.rows) < LEAST:
            count = len(self.rows) if names == self.names else 0
            return Unexplained(
                math.nan, '', math.nan,
                f'{count} healthy decisions of {LEAST} that a limit needs',
            )  # fmt: skip
        self.recent = [*self.recent, [float(value) for value in difference]][-CONFIRMING:]
        self._limits = self._limits or _limits(np.array(self.rows))
        mean, limits = self._limits
        apart = np.median(self.recent, axis=0) - mean
        shares = np.abs(apart) / limits
        if not np.isfinite(shares).any():
            return Unexplained(math.nan, '', math.nan, 'no band could be compared', names, apart)
        worst = int(np.nanargmax(shares))
        number, over = float(shares[worst]), float(apart[worst])
        side = 'over' if over > 0.0 else 'under'
        said = f'{names[worst]} is {abs(over):.0f} dB {side} what the twin explains'
        reason = said if number >= 1.0 else 'the twin explains its machine'
        return Unexplained(number, names[worst], over, reason, names, apart)

    @classmethod
    def of(cls, values: dict[str, Any]) -> Residual:
        """
        Residual of saved values.

        Raises
        ------
        BearingTwinError
            If they are not such values.

        """
        try:
            found = cls(tuple(map(str, values['names'])), values['rows'], values['recent'])
            found.waiting, found.number = list(values['waiting']), int(values['number'])
            rows = [*found.rows, *found.recent, *found.waiting]
            sound = all(len(row) == len(found.names) for row in rows)
            sound &= np.array(rows, dtype=np.float64).ndim < 3
        except (KeyError, TypeError, ValueError):
            sound = False
        if not sound:
            raise BearingTwinError(_NOT_SAVED)
        return found


@dataclass
class Residuals:
    """
    Residuals of a machine at the speeds at which it was healthy: at another, its lines are others.

    Examples
    --------
    >>> residuals = Residuals()
    >>> for _ in range(40):
    ...     said = residuals.update(('10 Hz',), np.zeros(1), 25.0, healthy=True)
    >>> said.number, residuals.update(('10 Hz',), np.ones(1), 28.0, healthy=True).reason
    (0.0, '0 healthy decisions of 30 that a limit needs at 28 Hz; known at 25 Hz')

    """

    known: list[tuple[float, Residual]] = field(default_factory=list)
    """Speeds, Hz, and what is known at each, the newest last."""

    def update(
        self, names: tuple[str, ...], difference: FloatArray, shaft_hz: float, *, healthy: bool
    ) -> Unexplained:
        """Judge a decision at a speed, Hz, and learn from it: see `Residual.update`."""
        near = [each for each in self.known if abs(each[0] / shaft_hz - 1.0) <= MOVED]
        if not near and len(self.known) >= SPEEDS:
            # A speed that the machine only passed by is given up for this one: the oldest.
            few = [each for each in self.known if len(each[1].rows) < LEAST]
            self.known.remove((few or self.known)[0])
        new = (shaft_hz, Residual())
        at = min(near, key=lambda each: abs(math.log(each[0] / shaft_hz)), default=new)
        residual = at[1]
        self.known = [*(each for each in self.known if each is not at), at]
        number = 1 + max(each.number for _, each in self.known)
        if number - residual.number > LEAST:
            # What it did at this speed hours or days ago is not judged together with today.
            residual.recent, residual.waiting = [], []
        residual.number = number
        speeds = [f'{hz:.3g}' for hz, each in self.known if len(each.rows) >= LEAST]
        found = residual.update(names, difference, healthy=healthy)
        if math.isfinite(found.number) or not speeds:
            return found
        said = f'{found.reason} at {shaft_hz:.3g} Hz; known at {", ".join(speeds)} Hz'
        return replace(found, reason=said)

    def save(self) -> list[dict[str, Any]]:
        """Return plain values, from which :meth:`of` makes it again."""
        return [{'shaft_hz': hz, **asdict(each)} for hz, each in self.known]

    @classmethod
    def of(cls, values: Any) -> Residuals:
        """
        Residuals of saved values.

        Raises
        ------
        BearingTwinError
            If they are not such values.

        """
        try:
            speeds = [float(each['shaft_hz']) for each in values]
        except (KeyError, TypeError, ValueError):
            speeds = [math.nan]
        if not all(0.0 < hz < math.inf for hz in speeds):
            raise BearingTwinError(_NOT_SAVED)
        return cls([(hz, Residual.of(each)) for hz, each in zip(speeds, values, strict=True)])


def _limits(table: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Healthy mean, and greatest difference of a new decision from it, dB, by band."""
    # Loaded when needed: half a second.
    from scipy.stats import chi2, norm

    count = len(table)
    told = np.isfinite(table).all(axis=0)
    known = table[:, told]
    # A band may remember longer than most do; the lag of one that seems not to is chance.
    lags = np.array([lag_one(column) for column in known.T])
    lags = np.maximum(lags, np.median(lags)) if told.any() else lags
    memory = np.clip((lags * count + 1.0) / (count - 3.0), 0.0, 1.0)
    effective = np.full(table.shape[1], float(count))
    effective[told] = np.maximum(count * (1.0 - memory) / (1.0 + memory), 3.0)
    # A mean of its own makes a record look quieter than the machine.
    deviation = table.std(axis=0, ddof=1) / np.sqrt(1.0 - 1.0 / effective)
    scale = np.maximum(deviation, LEAST_DB) * np.sqrt(1.0 + 1.0 / effective)
    freedom = effective - 1.0
    doubt = np.sqrt(freedom / chi2.ppf(1.0 - TAIL, freedom))
    chances = 2.0 * max(int(told.sum()), 1)
    limits = doubt * scale * float(norm.isf(1.0 / (chances * DECISIONS_A_YEAR)))
    # Largest difference of each decision from the others, beside that of normal ones.
    others = (known.sum(axis=0) - known) / (count - 1.0)
    largest = (np.abs(known - others) / scale[told]).max(axis=1, initial=0.0)
    expected = float(norm.isf((1.0 - TAIL ** (2.0 / chances)) / 2.0))
    blocks = np.arange(count)[:, None] + np.arange(BLOCK)
    starts = np.random.default_rng(0).integers(count, size=(BOOTSTRAPS, -(-count // BLOCK)))
    drawn = largest[blocks[starts].reshape(BOOTSTRAPS, -1) % count]
    longer = float(np.quantile(np.quantile(drawn, TAIL, axis=1), TAIL)) / expected
    return table.mean(axis=0), limits * max(1.0, longer)
