# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Fit the twin to a vibration record of its machine."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
import itertools
import math
import time
from typing import TYPE_CHECKING

from bearing_twin.bearing import PLACES
from bearing_twin.calibration.answer.estimates import (
    of_candidates,
    of_defect,
    of_path,
    of_slip,
    without_defect,
)
from bearing_twin.calibration.answer.impacts import gear_mesh, impacts_of
from bearing_twin.calibration.answer.refusals import (
    copied,
    half_frequency,
    Kind,
    no_impacts,
    Refusal,
    too_wide,
    unresolved,
    width_not_determined,
    with_longest_spacing,
)
from bearing_twin.calibration.answer.result import Calibration, in_words
from bearing_twin.calibration.candidates import posterior
from bearing_twin.calibration.candidates.cloud import (
    affordable,
    FASTEST_HZ,
    HIGHEST_RATE,
    LEAST_RATE,
    MOST_SLIP,
    SETTLE_S,
    Situation,
    TEMPERATURE,
    vibrations,
)
from bearing_twin.calibration.candidates.passage import load_range
from bearing_twin.calibration.measured.path import identify, REACH_S, resonances
from bearing_twin.calibration.measured.summaries import correlate, fastest_resonance
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.diagnosis.signal.acceleration import acceleration_factor
from bearing_twin.diagnosis.signal.demodulation import highest_fault_order
from bearing_twin.diagnosis.signal.gate import check_record, Extent
from bearing_twin.dynamics import warm_up
from bearing_twin.dynamics.equations.sensor_path import band_levels, distance
from bearing_twin.dynamics.parameters import check_bearing
from bearing_twin.errors import BearingTwinError
from bearing_twin.given import one_axis
from bearing_twin.repeats import repeated_span
import numpy as np
import numpy.typing as npt
import scipy

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.calibration.candidates.posterior import Posterior
    from bearing_twin.calibration.measured.summaries import Correlation, Summary
    from bearing_twin.dynamics.equations.sensor_path import SensorPath


FloatArray = npt.NDArray[np.float64]

LEAST_PASSAGES = 30.0
NOISE = 0.1
"""RMS of the white noise assumed in the acceleration of a healthy twin, m/s^2."""


def fit(
    samples: npt.ArrayLike,
    sample_rate: float,
    bearing: Bearing,
    shaft_hz: float,
    *,
    load: tuple[float, float] | None = None,
    temperature: float = math.nan,
    unit: str = '',
    place: str | None = None,
    candidates: int = 384,
    seed: int = 0,
) -> Calibration:
    """
    Fit the twin to a record of its machine.

    Parameters
    ----------
    samples
        Vibration, one axis, shape (n,), in any unit.
    sample_rate
        Hz.
    bearing
        Geometry, one row of balls.
    shaft_hz
        Shaft speed, Hz.
    load
        Range of the radial load, N; None: 0.003 to 0.1 of the dynamic rating.
    temperature
        Temperature of the outer ring, degC; NaN: 30.
    unit
        Unit of the samples, ``'m/s^2'`` or ``'g'``; '' if unknown.
    place
        Part with the defect, ``'none'`` for a healthy bearing; None: as the diagnosis finds.
    candidates
        Machines simulated in each of two rounds; fewer at a slow shaft.
    seed
        Seed of all draws; the same seed gives the same calibration.

    Raises
    ------
    BearingTwinError
        If the record is too short, not finite or constant, its rate is too low, or an argument is
        out of its range.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> healthy = 0.01 * np.random.default_rng(1).standard_normal(25600)
    >>> found = fit(healthy, 12800.0, find_bearing('6205'), 25.0, unit='m/s^2', place='none')
    >>> found.statement
    'no defect above 0.1 mm'
    >>> found.quantities['noise_floor'].identifiable
    True

    """
    x, situation = _checked(samples, sample_rate, bearing, shaft_hz, load, temperature)
    # The first fit of an installation compiles the kernels, which is not counted as its cost.
    warm_up(fleet=True)
    start = time.process_time()
    slip, refusal, named = math.nan, None, place is not None
    if place is None:
        said = diagnose_record(x, sample_rate, bearing, shaft_hz, unit=unit)
        place, slip = said.result if said.result in PLACES else 'none', said.slip
        if said.level == 'fault' and len(said.faults) == 1:
            # *Ambiguous* between this part and the shaft.
            place = said.faults[0]
        if place == 'none' and said.result != 'healthy':
            refusal = Refusal(
                Kind.NO_PART,
                f'the diagnosis says {said.result} and names no part: {said.reasons[-1]}',
            )
    elif place not in (*PLACES, 'none'):
        raise BearingTwinError(f"place={place!r}: choose 'none' or one of {', '.join(PLACES)}")
    if 0.0 <= slip <= MOST_SLIP:
        situation = replace(situation, slip=abs(slip))
    x, rate = decimated(x, sample_rate)
    situation = replace(situation, place=place, sample_rate=rate)
    if place in ('ball', 'cage'):
        refusal = Refusal(Kind.NOT_FITTED, f'the width of a {place} defect is not fitted')
    found = _fitted(x, situation, unit, candidates, seed, start, refusal, named=named)
    return replace(found, quantities=found.quantities | {'slip': of_slip(situation, slip)})


def fitted_vibration(found: Calibration, seconds: float) -> FloatArray:
    """
    Return the sensor signal of the fitted twin under the conditions of the fit, shape (n,).

    Its unit is that of the fitted samples, its rate ``situation.sample_rate``.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> healthy = 0.01 * np.random.default_rng(1).standard_normal(25600)
    >>> found = fit(healthy, 12800.0, find_bearing('6205'), 25.0, place='none')
    >>> bool(abs(fitted_vibration(found, 2.0).std() / 0.01 - 1.0) < 0.1)
    True

    """
    typical = {name: np.full(1, value) for name, value in found.typical().items()}
    return next(sensor_signals(found, found.twin_situation, typical, seconds, 0, (0,)))


def sensor_signals(
    found: Calibration,
    situation: Situation,
    values: dict[str, FloatArray],
    seconds: float,
    seed: int,
    noise_seeds: Iterable[int],
) -> Iterator[FloatArray]:
    """
    Yield the signal of the machine's sensor for each candidate, as if it were the machine.

    Parameters
    ----------
    found
        The calibration.
    situation
        Conditions of the simulation.
    values
        Values of each unknown, one per candidate; there is no other noise than that of the path.
    seconds
        Length of each signal, s; the vibration of its start has decayed.
    seed, noise_seeds
        Seed of the simulation, and of the noise of the path for each candidate.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> healthy = 0.01 * np.random.default_rng(1).standard_normal(25600)
    >>> found = fit(healthy, 12800.0, find_bearing('6205'), 25.0, place='none')
    >>> values = {name: v[:2] for name, v in found.candidates.items()}
    >>> [len(x) for x in sensor_signals(found, found.situation, values, 0.1, 0, (0, 1))]
    [1280, 1280]

    """
    values = values | {'noise_ratio': np.zeros(len(values['load']))}
    settle = SETTLE_S + REACH_S
    skipped = int(settle * situation.sample_rate)
    batches = vibrations(situation, values, seconds + settle, seed)
    for x, noise in zip(itertools.chain.from_iterable(batches), noise_seeds, strict=False):
        yield found.path.filter(noise).apply(x)[skipped:]


def _checked(
    samples: npt.ArrayLike,
    sample_rate: float,
    bearing: Bearing,
    shaft_hz: float,
    load: tuple[float, float] | None,
    temperature: float,
) -> tuple[FloatArray, Situation]:
    """Check the arguments of `fit`; return the record without its mean, and its situation."""
    x = one_axis(samples, 'samples')
    check_bearing(bearing)
    load_range(bearing, load)
    order = highest_fault_order(bearing)
    reasons = check_record([Extent.of(x)], sample_rate, shaft_hz, order)
    if not reasons and (copies := repeated_span(x)):
        reasons = [copies]
    if not reasons and sample_rate < LEAST_RATE:
        reasons = [f'sample rate {sample_rate:g} Hz: at least {LEAST_RATE:g} Hz are needed']
    if not reasons and shaft_hz > FASTEST_HZ:
        reasons = [f'the shaft speed is {shaft_hz:g} Hz: at most {FASTEST_HZ:g} Hz are simulated']
    if reasons:
        raise BearingTwinError('; '.join(reasons))
    return x - x.mean(), Situation(
        bearing=bearing,
        place='none',
        shaft_hz=shaft_hz,
        sample_rate=sample_rate,
        temperature=temperature if math.isfinite(temperature) else TEMPERATURE,
        load=load,
    )


def decimated(x: FloatArray, sample_rate: float) -> tuple[FloatArray, float]:
    """
    Decimate a record to at most `HIGHEST_RATE`; return it and its new rate, Hz.

    An anti-aliasing filter is applied first.

    Examples
    --------
    >>> x, rate = decimated(np.ones(1000), 102400.0)
    >>> len(x), rate
    (500, 51200.0)

    """
    factor = math.ceil(sample_rate / HIGHEST_RATE)
    if factor == 1:
        return x, sample_rate
    return np.asarray(scipy.signal.decimate(x, factor, ftype='fir')), sample_rate / factor


def _fitted(
    x: FloatArray,
    situation: Situation,
    unit: str,
    candidates: int,
    seed: int,
    start: float,
    refusal: Refusal | None,
    *,
    named: bool,
) -> Calibration:
    """
    Return the calibration of a checked record at a known part.

    ``start`` is the processor time at which the fit began, s. ``refusal`` tells why the width of a
    part other than a race is not fitted; ``named`` whether the part is given, not diagnosed.
    """
    whole = correlate(x, situation.sample_rate)
    measured = whole.summary(situation.longest_spacing)
    defective = situation.place in ('inner', 'outer')
    if defective:
        gear = gear_mesh(x, situation.sample_rate, measured)
        refusal = _refusal(x, whole, measured, situation, gear, named=named)
        count = affordable(situation, candidates)
        left, refusal = _defect(x, measured, situation, count, seed, refusal)
        seen = None if gear else impacts_of(whole, measured, situation)
    else:
        left, seen = posterior.from_prior(situation, seed), None
    kind = None if refusal is None else refusal.kind
    defect_unknown = kind is not None and kind.defect_unknown
    twin_of = replace(situation, place='none') if defect_unknown else situation
    path, twin = _path(x, twin_of, left, seed)
    factor = acceleration_factor(unit)
    before = twin + NOISE * np.random.default_rng(seed).standard_normal(len(twin))
    scale = factor if math.isfinite(factor) else float(before.std() / x.std())
    quantities = of_path(x, path, resonances(x, situation.sample_rate), situation, unit)
    if defective:
        quantities |= of_defect(left, situation, measured, refusal)
        statement = in_words(situation.place, quantities['defect_width_mm'], kind)
        if refusal is not None and kind is Kind.NO_IMPACTS:
            statement = f'no width: {refusal.why}'
    else:
        width, statement = without_defect(x, situation, scale, unit, seed, refusal)
        why = 'the vibration of a bearing without a race defect does not tell it'
        quantities |= of_candidates(left, why) | {'defect_width_mm': width}
    fitted = path.filter(seed).apply(twin)[len(path.denominator) :]
    machine, own, other = (
        band_levels(y, situation.sample_rate) for y in (x, fitted, before / scale)
    )
    return Calibration(
        situation=situation,
        quantities=quantities,
        statement=statement,
        refusal=kind,
        path=path,
        distance_before=distance(machine, other),
        distance=distance(machine, own),
        level_before=20.0 * math.log10(before.std() / (x.std() * factor))
        if math.isfinite(factor)
        else math.nan,
        level=20.0 * math.log10(fitted.std() / x.std()),
        spectrum=machine,
        rms=float(x.std()),
        candidates=left.values,
        weights=left.weights,
        sensor_unit=unit,
        impacts=seen,
        cost_s=time.process_time() - start,
    )


def _refusal(
    x: FloatArray,
    whole: Correlation,
    measured: Summary,
    situation: Situation,
    gear: Refusal | None,
    *,
    named: bool,
) -> Refusal | None:
    """Return why a record of a race defect tells no width, before any simulation; else None."""
    # A part that the diagnosis names has impacts.
    found = no_impacts(x, situation) if named else None
    found = found or half_frequency(x, situation)
    # A defect beside a gear may be wider than the distance of the gear's impacts.
    found = found or (gear and with_longest_spacing(gear, whole, measured, situation))
    found = found or too_wide(whole, situation, measured)
    found = found or unresolved(whole, measured, situation)
    return found or copied(x, situation, measured)


def _defect(
    x: FloatArray,
    measured: Summary,
    situation: Situation,
    candidates: int,
    seed: int,
    refusal: Refusal | None,
) -> tuple[Posterior, Refusal | None]:
    """Return the posterior of a defect, and why its width is not identifiable; None if it is."""
    if refusal is not None and refusal.kind is Kind.NO_IMPACTS:
        return posterior.from_prior(situation, seed), refusal
    if refusal:
        return posterior.without_spacing(
            measured, situation, candidates=candidates, seed=seed
        ), refusal
    left = posterior.sample(measured, situation, candidates=candidates, seed=seed)
    # Two impacts are separate if a resonance that they excite oscillates between them.
    fastest = fastest_resonance(x, situation.sample_rate, measured.spacing)
    refusal = width_not_determined(left, situation, fastest)
    # Either the impacts are those of a passage or they hide it: both cases are equally likely.
    if refusal is not None and refusal.kind is not Kind.MANY_WIDTHS:
        left = left.mixed_with(
            posterior.without_spacing(measured, situation, candidates=candidates, seed=seed)
        )
    return left, refusal


def _path(
    x: FloatArray, situation: Situation, left: Posterior, seed: int
) -> tuple[SensorPath, FloatArray]:
    """Identify the path of the median candidate; also return its acceleration without noise."""
    typical = {name: left.quantiles(name, (0.5,)) for name in left.values}
    ratio = float(typical['noise_ratio'][0])
    typical['noise_ratio'] = np.zeros(1)
    seconds = min(len(x) / situation.sample_rate, max(2.0, LEAST_PASSAGES / situation.shaft_hz))
    twin = next(vibrations(situation, typical, seconds, seed))[0]
    noise = ratio * float(twin.std()) if situation.place in ('inner', 'outer') else NOISE
    return identify(x, situation.sample_rate, twin, noise), twin
