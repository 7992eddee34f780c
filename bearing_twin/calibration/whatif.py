# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Predict the vibration of a fitted machine under other conditions: run its candidates again."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
import itertools
import math
from typing import TYPE_CHECKING

from bearing_twin.calibration.candidates.cloud import FASTEST_HZ, IMPACTS
from bearing_twin.calibration.candidates.passage import load_range
from bearing_twin.calibration.fit import sensor_signals
from bearing_twin.calibration.measured.summaries import summarise
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.diagnosis.machine.dependence import PER_KELVIN, PER_OCTAVE
from bearing_twin.dynamics.parameters import widest
from bearing_twin.errors import BearingTwinError
from bearing_twin.thermal.gcr15 import TABLE_HIGH, TABLE_LOW
import numpy as np
import numpy.typing as npt
from scipy import stats

if TYPE_CHECKING:
    from bearing_twin.calibration.answer.result import Calibration
    from bearing_twin.calibration.candidates.cloud import Situation


FloatArray = npt.NDArray[np.float64]

TURNS = 60.0
"""Shaft turns simulated of each candidate; enough for a diagnosis."""
SLOWEST_HZ = 0.5
"""Lowest shaft speed of a prediction, Hz."""
NARROWEST_MM = 0.05
"""Narrowest defect that the twin simulates."""
DIAGNOSED = 12
"""Candidates that are diagnosed."""
_DOUBT = {'crest_factor': 0.5, 'impulsiveness': 0.2}
"""Model error of a prediction, standard deviation of the logarithm. It comes from trains of
impacts at two speeds, which share nothing with the twin
(`studies.calibration_machines.predict_train`: 0.51 and 0.20), and from no real record."""


@dataclass(frozen=True, kw_only=True)
class Interval:
    """5 %, 50 % and 95 % quantiles of a prediction."""

    q05: float
    median: float
    q95: float
    unit: str


@dataclass(frozen=True, kw_only=True)
class Expectation:
    """Prediction for a machine under given conditions."""

    shaft_hz: float
    temperature: float
    load: tuple[float, float]
    """Range, N."""
    width_mm: tuple[float, float]
    """Range, mm."""
    vibration: dict[str, Interval]
    verdicts: dict[str, Interval]
    """Share of the machines with each result of the diagnosis."""


def features(x: FloatArray, sample_rate: float, longest: float) -> dict[str, float]:
    """
    Return the figures that are predicted: level, peak, crest factor, impulsiveness, spacing.

    Examples
    --------
    >>> x = np.random.default_rng(1).standard_normal(25600)
    >>> found = features(x, 25600.0, 5e-3)
    >>> round(found['rms'], 1), round(found['impulsiveness'], 1)
    (1.0, 0.3)

    """
    summary = summarise(x, sample_rate, longest)
    peak, rms = float(np.abs(x - x.mean()).max()), float(x.std())
    return {
        'rms': rms,
        'peak': peak,
        'crest_factor': peak / rms,
        'impulsiveness': summary.impulsiveness,
        'spacing_ms': 1e3 * summary.spacing,
    }


def expect(
    found: Calibration,
    *,
    shaft_hz: float | None = None,
    load: tuple[float, float] | None = None,
    temperature: float | None = None,
    width_mm: float | None = None,
    candidates: int = 64,
    seed: int = 0,
) -> Expectation:
    """
    Run the candidates of a calibration under other conditions.

    Parameters
    ----------
    found
        The calibration.
    shaft_hz, load, temperature, width_mm
        New conditions: Hz, a range in N, degC, mm; None: as fitted.
    candidates
        Number of candidates drawn from the calibration.
    seed
        Seed of all draws.

    Raises
    ------
    BearingTwinError
        If a value is outside what the twin can simulate, or a width is given without a defect.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.calibration import fit
    >>> healthy = 0.01 * np.random.default_rng(1).standard_normal(25600)
    >>> found = fit(healthy, 12800.0, find_bearing('6205'), 25.0, place='none')
    >>> verdicts = expect(found, shaft_hz=30.0, candidates=16).verdicts
    >>> list(verdicts), round(verdicts['healthy'].q05, 2)
    (['healthy'], 0.85)

    """
    situation = _situation(found, shaft_hz, temperature, width_mm)
    rng = np.random.default_rng([seed, 3])
    drawn = rng.choice(len(found.weights), size=candidates, p=found.weights)
    fitted = {name: v[drawn] for name, v in found.candidates.items()}
    values = dict(fitted)
    if load is not None:
        load = load_range(situation.bearing, load)
        values['load'] = load[0] * (load[1] / load[0]) ** rng.random(candidates)
    if width_mm is not None:
        values['defect_width_mm'] = np.full(candidates, width_mm)
    rows: list[dict[str, float]] = []
    verdicts: Counter[str] = Counter()
    seconds = TURNS / situation.shaft_hz
    for x in sensor_signals(found, situation, values, seconds, seed, itertools.count(seed)):
        rows.append(features(x, situation.sample_rate, situation.longest_spacing))
        if len(rows) <= DIAGNOSED:
            said = diagnose_record(x, situation.sample_rate, situation.bearing, situation.shaft_hz)
            verdicts[said.result] += 1
    gains = _changes(found, situation, candidates, rng)
    if situation.place != 'none':
        gains = gains * _gains(found, fitted, seed)
    doubt = rng.standard_normal(candidates)
    factors = {'rms': gains, 'peak': gains}
    factors |= {name: np.exp(scatter * doubt) for name, scatter in _DOUBT.items()}
    widths, loads = values['defect_width_mm'], values['load']
    healthy = situation.place == 'none'
    return Expectation(
        shaft_hz=situation.shaft_hz,
        temperature=situation.temperature,
        load=load or (float(loads.min()), float(loads.max())),
        width_mm=(0.0, 0.0) if healthy else (float(widths.min()), float(widths.max())),
        vibration=_intervals(rows, factors, found.sensor_unit or 'unit of the samples'),
        verdicts={name: _share(verdicts[name], verdicts.total()) for name in sorted(verdicts)},
    )


def _situation(
    found: Calibration, shaft_hz: float | None, temperature: float | None, width_mm: float | None
) -> Situation:
    """Return the new conditions, see :func:`expect`, if they can be simulated."""
    given, place = found.situation, found.defect
    if place not in ('inner', 'outer', 'none'):
        msg = f'a {place} defect is not fitted; what-if holds for races and healthy bearings'
        raise BearingTwinError(msg)
    if width_mm is not None:
        _check_width(width_mm, found)
    hertz = given.shaft_hz if shaft_hz is None else shaft_hz
    if not SLOWEST_HZ <= hertz <= FASTEST_HZ:
        msg = f'a shaft speed of {hertz:g} Hz is outside {SLOWEST_HZ:g}..{FASTEST_HZ:g} Hz'
        raise BearingTwinError(msg)
    if temperature is not None and not TABLE_LOW <= temperature <= TABLE_HIGH:
        raise BearingTwinError(
            f'a temperature of {temperature:g} degC is outside {TABLE_LOW:g}..{TABLE_HIGH:g} '
            'degC, in which the steel of the twin is known'
        )
    celsius = given.temperature if temperature is None else temperature
    return replace(found.twin_situation, shaft_hz=hertz, temperature=celsius)


def _check_width(width_mm: float, found: Calibration) -> None:
    """Refuse a width, mm, that is not simulated, or without a defect that a record shows."""
    most = 1e3 * widest(found.situation.bearing)
    if found.defect == 'none':
        msg = (
            'a width is given, and the fit found no defect; fit again with --place inner or outer'
        )
    elif not NARROWEST_MM <= width_mm <= most:
        msg = (
            f'a width of {width_mm:g} mm is outside {NARROWEST_MM:g}..{most:.3g} mm: '
            'narrower than is simulated, or wider than half a ball or two balls apart'
        )
    elif found.twin_situation.place == 'none':
        msg = (
            'a width is given, and nothing was seen of the defect that was looked for: how strong '
            'it would be is not known'
        )
    else:
        return
    raise BearingTwinError(msg)


def _intervals(
    rows: list[dict[str, float]], factors: dict[str, FloatArray], unit: str
) -> dict[str, Interval]:
    """Return the interval of each figure; figures that few candidates have are left out."""
    units = {'rms': unit, 'peak': unit, 'spacing_ms': 'ms'}
    found = {}
    for name in rows[0]:
        column = np.array([row[name] for row in rows]) * factors.get(name, 1.0)
        column = column[np.isfinite(column)]
        if len(column) > len(rows) // 4:
            low, median, high = np.quantile(column, (0.05, 0.5, 0.95))
            found[name] = Interval(
                q05=float(low), median=float(median), q95=float(high), unit=units.get(name, '')
            )
    return found


def _share(count: int, of: int) -> Interval:
    """Return the share of machines whose result ``count`` of a sample have (Jeffreys)."""
    low, median, high = stats.beta.ppf((0.05, 0.5, 0.95), count + 0.5, of - count + 0.5)
    return Interval(q05=float(low), median=float(median), q95=float(high), unit='')


def _gains(found: Calibration, values: dict[str, FloatArray], seed: int) -> FloatArray:
    """
    Return the gain of the sensor's path for each candidate, over that of the median candidate.

    Only the product of gain and strength of the impacts is known: the level of the record.
    """
    situation = found.twin_situation
    seconds, seeds = IMPACTS / situation.impact_rate, itertools.repeat(seed)
    signals = sensor_signals(found, situation, values, seconds, seed, seeds)
    return found.rms / np.array([x.std() for x in signals])


def _changes(
    found: Calibration, situation: Situation, candidates: int, rng: np.random.Generator
) -> FloatArray:
    """
    Return the change of level with speed and temperature that is not simulated, as a factor.

    Most of a healthy machine's level is noise of the machine around the bearing, which the twin
    lacks; an assumed dependence takes its place. With a defect the twin simulates the change, and
    only the scatter among machines is added.
    """
    octaves = math.log2(situation.shaft_hz / found.situation.shaft_hz)
    kelvins = situation.temperature - found.situation.temperature
    healthy = situation.place == 'none'
    decibels = sum(
        steps * (healthy * mean + deviation * rng.standard_normal(candidates))
        for steps, (mean, deviation) in ((octaves, PER_OCTAVE), (kelvins, PER_KELVIN))
    )
    return np.asarray(10.0 ** (np.asarray(decibels) / 20.0))
