# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Predict the vibration of a fitted machine under other conditions: run its candidates again."""

from __future__ import annotations

from dataclasses import dataclass, replace
import math
from typing import TYPE_CHECKING

from bearing_twin.calibration.candidates.cloud import IMPACTS, SETTLE_S, vibrations
from bearing_twin.calibration.candidates.passage import load_range, widest
from bearing_twin.calibration.measured.path import REACH_S
from bearing_twin.calibration.measured.summaries import summarise
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.diagnosis.machine.dependence import PER_KELVIN, PER_OCTAVE
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
    place = found.defect
    if place not in ('inner', 'outer', 'none'):
        msg = f'a {place} defect is not fitted; what-if holds for races and healthy bearings'
        raise BearingTwinError(msg)
    if width_mm is not None and place == 'none':
        msg = (
            'a width is given, and the fit found no defect; fit again with --place inner or outer'
        )
        raise BearingTwinError(msg)
    known = found.twin_situation
    most = 1e3 * widest(known.bearing)
    if width_mm is not None and not NARROWEST_MM <= width_mm <= most:
        msg = (
            f'a width of {width_mm:g} mm is outside {NARROWEST_MM:g}..{most:.3g} mm: '
            'narrower than is simulated, or wider than half a ball or two balls apart'
        )
        raise BearingTwinError(msg)
    if width_mm is not None and known.place == 'none':
        msg = (
            'a width is given, and nothing was seen of the defect that was looked for: how strong '
            'it would be is not known'
        )
        raise BearingTwinError(msg)
    place = known.place
    situation = replace(
        known,
        shaft_hz=found.situation.shaft_hz if shaft_hz is None else shaft_hz,
        temperature=found.situation.temperature if temperature is None else temperature,
    )
    if not 0.5 <= situation.shaft_hz <= 500.0:
        msg = f'a shaft speed of {situation.shaft_hz:g} Hz is outside 0.5..500 Hz'
        raise BearingTwinError(msg)
    if temperature is not None and not TABLE_LOW <= temperature <= TABLE_HIGH:
        msg = (
            f'a temperature of {temperature:g} degC is outside {TABLE_LOW:g}..{TABLE_HIGH:g} '
            'degC, in which the steel of the twin is known'
        )
        raise BearingTwinError(msg)
    rng = np.random.default_rng([seed, 3])
    drawn = rng.choice(len(found.weights), size=candidates, p=found.weights)
    values = {name: v[drawn] for name, v in found.candidates.items()}
    if load is not None:
        load = load_range(situation.bearing, load)
        values['load'] = load[0] * (load[1] / load[0]) ** rng.random(candidates)
    if width_mm is not None:
        values['defect_width_mm'] = np.full(candidates, width_mm)
    values['noise_ratio'] = np.zeros(candidates)
    rate, settle = situation.sample_rate, SETTLE_S + REACH_S
    unit = found.sensor_unit or 'unit of the samples'
    rows: list[dict[str, float]] = []
    verdicts: list[str] = []
    seconds = TURNS / situation.shaft_hz + settle
    for batch in vibrations(situation, values, seconds, seed):
        for x in batch:
            y = found.path.filter(seed + len(rows)).apply(x)[int(settle * rate) :]
            rows.append(features(y, rate, situation.longest_spacing))
            if len(verdicts) < DIAGNOSED:
                said = diagnose_record(y, rate, situation.bearing, situation.shaft_hz)
                verdicts.append(said.result)
    gains = _changes(found, situation, candidates, rng)
    if place != 'none':
        strengths = {name: v[drawn] for name, v in found.candidates.items()}
        gains = gains * _gains(found, known, strengths, seed)
    units = {'rms': unit, 'peak': unit, 'spacing_ms': 'ms'}
    doubt = rng.standard_normal(candidates)
    factors = {'rms': gains, 'peak': gains}
    factors |= {name: np.exp(scatter * doubt) for name, scatter in _DOUBT.items()}
    vibration = {}
    for name in rows[0]:
        column = np.array([row[name] for row in rows]) * factors.get(name, 1.0)
        column = column[np.isfinite(column)]
        if len(column) > len(rows) // 4:
            low, median, high = np.quantile(column, (0.05, 0.5, 0.95))
            vibration[name] = Interval(
                q05=float(low), median=float(median), q95=float(high), unit=units.get(name, '')
            )
    widths, loads = values['defect_width_mm'], values['load']
    return Expectation(
        shaft_hz=situation.shaft_hz,
        temperature=situation.temperature,
        load=load or (float(loads.min()), float(loads.max())),
        width_mm=(0.0, 0.0) if place == 'none' else (float(widths.min()), float(widths.max())),
        vibration=vibration,
        verdicts={
            name: _share(verdicts.count(name), len(verdicts)) for name in sorted(set(verdicts))
        },
    )


def _share(count: int, of: int) -> Interval:
    """Return the share of machines whose result ``count`` of a sample have (Jeffreys)."""
    low, median, high = stats.beta.ppf((0.05, 0.5, 0.95), count + 0.5, of - count + 0.5)
    return Interval(q05=float(low), median=float(median), q95=float(high), unit='')


def _gains(
    found: Calibration, situation: Situation, values: dict[str, FloatArray], seed: int
) -> FloatArray:
    """
    Return the gain of the sensor's path for each candidate, over that of the median candidate.

    Only the product of gain and strength of the impacts is known: the level of the record.
    """
    values = values | {'noise_ratio': np.zeros(len(values['load']))}
    settle = SETTLE_S + REACH_S
    skipped = int(settle * situation.sample_rate)
    levels = [
        found.path.filter(seed).apply(x)[skipped:].std()
        for batch in vibrations(situation, values, IMPACTS / situation.impact_rate + settle, seed)
        for x in batch
    ]
    return found.rms / np.array(levels)


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
