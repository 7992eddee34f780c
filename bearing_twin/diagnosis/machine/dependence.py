# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Dependence of the level of one machine on temperature and speed, from its healthy record.

Physics does not give its sign: simulated bearings in the physical mode get louder or quieter with
temperature, depending on load, clearance and speed. They give a weak prior (:data:`PER_KELVIN`,
:data:`PER_OCTAVE`); the record of the machine decides. If it does not decide, nothing is
corrected.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
import math
from typing import NamedTuple

from bearing_twin.errors import BearingTwinError
from bearing_twin.numerics.compiled import compiled
from bearing_twin.quantity import signed
import numpy as np
from numpy.typing import NDArray

PER_KELVIN = (-0.016, 0.05)
"""Mean and standard deviation of the change of level with temperature, dB/K, over healthy bearings
with perfect surfaces simulated in the physical mode: from -0.095 to +0.112 (``python -m
bearing_twin.studies.temperature``). With the waviness of the presets it is -0.012 to -0.002 in
three such bearings, within the same standard deviation."""
PER_OCTAVE = (10.0, 4.0)
"""Mean and standard deviation of the change of level with speed, dB per doubling. The machine
around a bearing is not simulated, so the standard deviation is doubled."""
DRIFT_DB = 6.0
"""Prior standard deviation of a drift over the whole record that neither temperature nor speed
explains, dB: run-in. Without it a machine that runs in while it warms up would seem to depend on
temperature."""
HUBER = 1.345
"""Standard deviations up to which a deviation has full weight: 95 % efficient for a normal
distribution."""
CONVERGED, MOST_WEIGHINGS = 1e-9, 100
"""Step below which the robust regression ends, in prior standard deviations; most steps."""
KNOWN_DB = 1.0
"""Largest half width of the 90 % interval of the correction over the learnt range, dB, with which
a law is known."""
WIDENED = 1.2
"""Factor on the standard deviations: with it the 90 % intervals cover 90 to 94 % of the slopes of
simulated machines, whose autocorrelation is estimated as well."""
LEAST_ROWS = 30
MOST_ROWS = 256
"""Most rows that are kept; at this number every second one is dropped."""
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
REFIT = 1.1
"""Growth of the record after which a law is fitted anew."""
SAME_OCTAVES = math.log2(1.05)
"""Speeds within 5 % are compared without correction: 0.7 dB at 10 dB per doubling."""
Z90 = 1.645
"""Standard deviations of a 90 % interval."""


class Condition(NamedTuple):
    """Condition in which a level was measured."""

    temperature: float = math.nan
    """degC; NaN if unknown."""
    octaves: float = math.nan
    """Base-2 logarithm of the shaft speed in Hz; NaN if unknown."""

    @classmethod
    def at(cls, temperature: float, shaft_hz: float) -> Condition:
        """Return the condition at a temperature, degC, and a shaft speed, Hz."""
        octaves = math.log2(shaft_hz) if shaft_hz > 0.0 else math.nan
        return cls(float(temperature), octaves)


@dataclass(frozen=True)
class Slope:
    """Change of a level with one quantity, and the range in which it was learnt."""

    mean: float
    """dB per unit."""
    deviation: float
    """Standard deviation, dB per unit."""
    low: float
    """Quantile of 5 % of the quantity in the record."""
    high: float
    """Quantile of 95 %."""
    known: bool
    """Whether the record decides the slope."""

    def correct(self, value: float, reference: float) -> tuple[float, float]:
        """
        Return the change from ``reference`` to ``value`` and its standard deviation, dB.

        Both are limited to the learnt range: the change beyond it is not known, and the level of a
        bearing that runs hot because it fails must not be corrected for its temperature.
        """
        if not self.known or math.isnan(value) or math.isnan(reference):
            return 0.0, 0.0
        step = min(max(value, self.low), self.high) - min(max(reference, self.low), self.high)
        return self.mean * step, self.deviation * abs(step)


UNKNOWN_SLOPE = Slope(0.0, math.inf, math.nan, math.nan, False)


@dataclass(frozen=True)
class Law:
    """Dependence of a level on temperature and speed."""

    temperature: Slope = UNKNOWN_SLOPE
    octaves: Slope = UNKNOWN_SLOPE

    def correct(self, now: Condition, reference: Condition) -> tuple[float, float]:
        """Return the change from ``reference`` to ``now`` and its standard deviation, dB."""
        heat, heat_sd = self.temperature.correct(now.temperature, reference.temperature)
        speed, speed_sd = self.octaves.correct(now.octaves, reference.octaves)
        return heat + speed, math.hypot(heat_sd, speed_sd)

    def comparable(self, now: Condition, reference: Condition) -> bool:
        """Return whether levels at two speeds are comparable; an unknown speed is comparable."""
        if math.isnan(now.octaves) or math.isnan(reference.octaves):
            return True
        values = (now.octaves, reference.octaves)
        if self.octaves.known:
            low, high = self.octaves.low - SAME_OCTAVES, self.octaves.high + SAME_OCTAVES
            return low <= min(values) and max(values) <= high
        return max(values) - min(values) <= SAME_OCTAVES

    def __str__(self) -> str:
        """Return the known dependence on temperature in words."""
        heat = self.temperature
        if heat.known:
            interval = f'{signed(heat.mean, 3)} +- {Z90 * heat.deviation:.3f} dB/K'
            return f'{interval}, learnt from {heat.low:.0f} to {heat.high:.0f} degC'
        if math.isnan(heat.low):
            return 'temperature not corrected: its record is too short'
        unknown = Z90 * heat.deviation * (heat.high - heat.low)
        why = f'leave {unknown:.1f} dB unknown'
        if unknown <= KNOWN_DB:
            why = 'do not show what temperature alone does'
        return (
            f'temperature not corrected: {heat.low:.0f} to {heat.high:.0f} degC in the healthy '
            f'record {why}'
        )


def fit_law(
    levels: NDArray[np.float64], temperatures: NDArray[np.float64], octaves: NDArray[np.float64]
) -> Law:
    """
    Return the law of a healthy record, by robust regression with a prior.

    It is Huber's regression of the level on temperature, logarithm of the speed and a drift over
    the record, with normal priors. The deviations of a machine are autocorrelated, so the
    intervals of a plain regression would be too narrow. They are whitened with their lag-one
    correlation (Cochrane and Orcutt, JASA 1949, 44, 32), corrected for the bias of a fitted trend
    (Marriott and Pope, Biometrika 1954, 41, 390).

    A correlation with temperature can have other causes, and then the law is not known. A machine
    that runs in while it warms up has all its temperatures in the first half of its record. A load
    that is heard at once and warms the bearing later, and a film that follows the sensor late,
    also correlate with the change of the temperature.

    The levels, dB, are in order of time. Unknown temperatures, degC, and octaves, log2 Hz, are
    NaN.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> heat = 70.0 + 20.0 * np.sin(np.arange(200.0) / 9.0)
    >>> law = fit_law(0.1 * heat + 0.5 * rng.standard_normal(200), heat, np.full(200, 4.6))
    >>> law.temperature.known, round(law.temperature.mean, 2), law.octaves.known
    (True, 0.1, False)

    """
    whole = _law(levels, temperatures, octaves)
    halves = [
        _law(*part).temperature
        for part in zip(
            *(np.array_split(values, 2) for values in (levels, temperatures, octaves)), strict=True
        )
    ]
    heat = whole.temperature
    apart = abs(halves[1].mean - halves[0].mean)
    same = apart <= Z90 * (halves[0].deviation + halves[1].deviation)
    # One warm-up during one run-in decides nothing: each half must have half the temperature
    # range.
    same &= min(half.high - half.low for half in halves) >= 0.5 * (heat.high - heat.low)
    if heat.known and not (same and _at_once(levels, temperatures, octaves)):
        return replace(whole, temperature=replace(heat, known=False))
    return whole


def _at_once(
    levels: NDArray[np.float64], temperatures: NDArray[np.float64], octaves: NDArray[np.float64]
) -> bool:
    """Return whether the level correlates with the temperature but not with its change."""
    known = np.isfinite(levels) & np.isfinite(temperatures)
    if np.isfinite(octaves).all():
        temperatures = np.column_stack([temperatures, octaves - np.median(octaves)])
    heat = np.atleast_2d(temperatures.T).T[known]
    change = np.diff(heat[:, 0], prepend=heat[0, 0])
    drift = np.linspace(-0.5, 0.5, len(heat))
    matrix = np.column_stack([np.ones(len(heat)), drift, heat - np.median(heat, axis=0), change])
    priors = [(0.0, 1e3), (0.0, DRIFT_DB), *[PER_KELVIN, PER_OCTAVE][: heat.shape[1]], (0.0, 1e3)]
    level = levels[known]
    found, covariance = _regression(matrix, level - np.median(level), np.array(priors))
    # One in a thousand good records is refused.
    return bool(abs(found[-1]) <= 2.0 * Z90 * math.sqrt(covariance[-1, -1]))


def _law(
    levels: NDArray[np.float64], temperatures: NDArray[np.float64], octaves: NDArray[np.float64]
) -> Law:
    known = np.isfinite(levels)
    rows: list[tuple[NDArray[np.float64], tuple[float, float]]] = []
    for values, prior in ((temperatures, PER_KELVIN), (octaves, PER_OCTAVE)):
        # A quantity that is mostly unknown is left out, and rows without it are kept.
        if np.isfinite(values).mean() > 0.5:
            known &= np.isfinite(values)
        rows.append((values, prior))
    count = int(known.sum())
    if count < LEAST_ROWS:
        return Law()
    drift = np.linspace(-0.5, 0.5, count)
    columns, priors = [np.ones(count), drift], [(0.0, 1e3), (0.0, DRIFT_DB)]
    ranges = []
    for values, prior in rows:
        kept = values[known]
        there = bool(np.isfinite(kept).all())
        ranges.append(np.quantile(kept, (0.05, 0.95)) if there else np.full(2, math.nan))
        columns.append(kept - np.median(kept) if there else np.zeros(count))
        priors.append(prior)
    level = levels[known]
    middle = float(np.median(level))
    found, covariance = _regression(np.column_stack(columns), level - middle, np.array(priors))
    slopes = []
    for index, (low, high), (_, width) in zip(
        (2, 3), ranges, (PER_KELVIN, PER_OCTAVE), strict=True
    ):
        sd = WIDENED * math.sqrt(covariance[index, index])
        # The record, not the prior, must decide the slope.
        sure = Z90 * sd * (high - low) <= KNOWN_DB and sd <= 0.5 * width
        slopes.append(Slope(float(found[index]), sd, float(low), float(high), bool(sure)))
    return Law(*slopes)


def _regression(
    matrix: NDArray[np.float64], y: NDArray[np.float64], priors: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.floating]]:
    """Return coefficients and covariance of a robust regression with autocorrelation."""
    means, widths = priors.T.copy()
    memory, beta = 0.0, means.copy()
    for _ in range(6):
        rows = matrix[1:] - memory * matrix[:-1]
        right = y[1:] - memory * y[:-1]
        left = right - rows @ beta
        sigma = max(1.4826 * _median(np.abs(left - _median(left))), 1e-3)

        # Rows of the data, then of the priors, all in standard deviations.
        whole = np.vstack([rows / sigma, np.diag(1.0 / widths)])
        target = np.concatenate([right / sigma, means / widths])
        weights = _weighed(whole, target, widths, beta)[: len(right)]
        raw = _lag_one(y - matrix @ beta)
        memory = min(max((raw * len(y) + 2.0) / max(len(y) - 4.0, 1.0), 0.0), 0.98)
    precision = (rows * weights[:, None]).T @ rows / sigma**2 + np.diag(widths**-2)
    return beta, np.linalg.inv(precision)


@compiled()
def _weighed(
    whole: NDArray[np.float64],
    target: NDArray[np.float64],
    widths: NDArray[np.float64],
    beta: NDArray[np.float64],
) -> NDArray[np.float64]:
    """
    Move ``beta`` to Huber's estimate by modified weights, and return the weights, shape (rows,).

    See Huber and Ronchetti, 2009, section 7.8.
    """
    rows, size = whole.shape
    weights = np.empty(rows)
    normal, right = np.empty((size, size)), np.empty(size)
    for _ in range(MOST_WEIGHINGS):
        normal[:], right[:] = 0.0, 0.0
        for n in range(rows):
            left = -target[n]
            for i in range(size):
                left += whole[n, i] * beta[i]
            weights[n] = min(1.0, HUBER / max(abs(left), 1e-12))
            for i in range(size):
                weighted = weights[n] * whole[n, i]
                right[i] += weighted * target[n]
                for k in range(size):
                    normal[i, k] += weighted * whole[n, k]
        solved = np.linalg.solve(normal, right)
        moved = np.abs((solved - beta) / widths).max()
        beta[:] = solved
        if moved < CONVERGED:
            break
    return weights


def _lag_one(values: NDArray[np.float64]) -> float:
    """
    Return a lag-one correlation that is robust to outliers (Gnanadesikan and Kettenring, 1972).

    Examples
    --------
    >>> bool(abs(_lag_one(np.random.default_rng(0).standard_normal(1000))) < 0.1)
    True

    """
    sums, differences = values[1:] + values[:-1], np.diff(values)
    both, apart = (_median(np.abs(v - _median(v))) ** 2 for v in (sums, differences))
    return (both - apart) / max(both + apart, 1e-12)


def _median(values: NDArray[np.float64]) -> float:
    """Return the median of finite values, a fifth of the time of `numpy.median` for a record."""
    high = len(values) // 2
    low = high - 1 + len(values) % 2
    return 0.5 * float(np.partition(values, (low, high))[[low, high]].sum())


def _place(number: int, span: int) -> int:
    """Return which row of a group is kept: by the golden ratio, in phase with no duty cycle."""
    return int(span * (GOLDEN * number % 1.0))


@dataclass
class HealthyRecord:
    """
    Levels of a healthy machine with their conditions, thinned out as the record grows.

    One level in ``span`` is kept, so that a record of years has the size of one of hours. They are
    not averaged: a mean would remove days and nights, which show the effect of temperature. All
    fields are plain values that can be saved.

    Examples
    --------
    >>> record = HealthyRecord()
    >>> for hour in range(1000):
    ...     record.add([0.05 * (hour % 24)], Condition(60.0 + hour % 24, 4.6))
    >>> len(record.rows), record.span, record.laws()[0].temperature.known
    (249, 4, True)

    """

    span: int = 1
    rows: list[list[float]] = field(default_factory=list)
    """Temperature, octaves and levels of each kept row."""
    passed: int = 0
    """Number of levels since the last kept one."""
    fitted: int = 0
    """Number of levels from which the laws were fitted."""
    known: list[Law] = field(default_factory=list)
    """Laws of the measures: saved so that a resumed run gives the same bits."""

    def __post_init__(self) -> None:
        sound = self.span >= 1 and min(self.passed, self.fitted) >= 0
        sound &= len({len(row) for row in self.rows}) < 2
        if not (sound and all(row[2:] and np.isfinite(row[2:]).all() for row in self.rows)):
            msg = 'saved record of a healthy machine is invalid; use what save() returned'
            raise BearingTwinError(msg)

    @property
    def count(self) -> int:
        """Return the number of levels taken."""
        return self.span * len(self.rows)

    def add(self, levels: Sequence[float], condition: Condition) -> None:
        """Take the level of each measure of a healthy machine, dB."""
        self.passed += 1
        number = len(self.rows)
        if self.passed < self.span + _place(number, self.span) - _place(number - 1, self.span):
            return
        self.passed = 0
        self.rows.append([*condition, *levels])
        if len(self.rows) >= MOST_ROWS:
            pairs = range(len(self.rows) // 2)
            self.rows = [self.rows[2 * pair + _place(pair, 2)] for pair in pairs]
            self.span *= 2

    def laws(self) -> list[Law]:
        """Return the law of each measure, fitted anew as the record grows; empty at first."""
        if len(self.rows) >= LEAST_ROWS and self.count >= REFIT * self.fitted:
            self.fitted = self.count
            heat, octaves, *levels = np.array(self.rows).T
            self.known = [fit_law(level, heat, octaves) for level in levels]
        return self.known
