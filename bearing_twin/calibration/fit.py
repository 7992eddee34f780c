# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The twin fitted to a record of its machine, or to a stream of records."""

from __future__ import annotations

from dataclasses import replace
import math
import time
from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_frequencies, PLACES
from bearing_twin.calibration import posterior
from bearing_twin.calibration.cloud import (
    HIGHEST_RATE,
    SETTLE_S,
    Situation,
    TEMPERATURE,
    unknowns,
    vibrations,
)
from bearing_twin.calibration.healthy import LOSS_DB, smallest_shown
from bearing_twin.calibration.passage import load_range, widest
from bearing_twin.calibration.path import identify, REACH_S, resonances, spectral_distance
from bearing_twin.calibration.result import Calibration, Estimate
from bearing_twin.calibration.summaries import summarise
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.diagnosis.severity import acceleration_factor
from bearing_twin.dynamics import warm_up
from bearing_twin.errors import BearingTwinError
import numpy as np
import numpy.typing as npt
from scipy import signal

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.calibration.path import Resonance, SensorPath
    from bearing_twin.calibration.posterior import Posterior
    from bearing_twin.calibration.summaries import Summary

__all__ = ['Fitter', 'fit', 'fitted_vibration', 'unresolved', 'untold']

FloatArray = npt.NDArray[np.float64]

LEAST_TURNS = 20.0
"""Least shaft turns of a record: as many as the diagnosis asks for."""
LEAST_PASSAGES = 30.0
NARROWED = 0.5
"""A quantity is identifiable where its 90 % interval is at most this share of the prior's."""
ALIKE = 2.0
"""Most that the candidates kept may be farther from the machine than from each other."""
RIVAL = 0.4
"""Most that a second spacing may be as clear as the first. Fixed on CWRU, as is `RESOLVED`."""
MANY_WIDTHS = 'defects of many widths give impacts like these'
PERIODS = 2.0
"""Least periods of the resonance it excites that a passage has to last."""
TOLD = ('defect_width_mm',)
"""Quantities of the bearing that a vibration may tell; intervals of the others held too seldom."""
FOUND = 0.75
"""Least share of the parts of a record in which a resonance has to be found."""
NOISE = 0.1
"""White noise that is supposed in the acceleration of a healthy twin, m/s^2."""
LINE_DAMPING = 0.002
"""Damping below which a pole is a line of the mains or of a drive, not a resonance."""
SAME_TIME, OTHER_SPEED = 0.03, 1.08
"""Two impacts at the same time within this share at speeds this far apart are ringing."""


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
        Of the outer ring, degC; NaN: 30.
    unit
        Of the samples, ``'m/s^2'`` or ``'g'``; '' if unknown.
    place
        Part with the defect, ``'none'`` for a healthy bearing; None: what the diagnosis says.
    candidates
        Machines simulated in each of two rounds.
    seed
        Of all draws; the same seed gives the same calibration.

    Raises
    ------
    BearingTwinError
        If the record is too short, not finite, constant or of too low a rate, or an argument is
        out of its range.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> healthy = 0.01 * np.random.default_rng(1).standard_normal(25600)
    >>> found = fit(healthy, 12800.0, find_bearing('6205'), 25.0, unit='m/s^2', place='none')
    >>> found.statement
    'no defect above 0.2 mm'
    >>> found.quantities['noise_floor'].identifiable
    True

    """
    start = time.process_time()
    x, situation = _checked(samples, sample_rate, bearing, shaft_hz, load, temperature)
    warm_up(fleet=True)
    slip, verdict = math.nan, ''
    if place is None:
        said = diagnose_record(x, sample_rate, bearing, shaft_hz, unit=unit)
        place, slip = said.result if said.result in PLACES else 'none', said.slip
        if place == 'none' and said.result != 'healthy':
            verdict = f'; the diagnosis says {said.result}'
    elif place not in (*PLACES, 'none'):
        msg = f"place={place!r}: choose 'none' or one of {', '.join(PLACES)}"
        raise BearingTwinError(msg)
    if math.isfinite(slip) and 0.0 <= slip <= 0.05:
        situation = replace(situation, slip=slip)
    x, rate = _decimated(x, sample_rate)
    situation = replace(situation, place=place, sample_rate=rate)
    return _fitted(x, situation, unit, candidates, seed, start, verdict)


def fitted_vibration(found: Calibration, seconds: float, seed: int = 0) -> FloatArray:
    """
    Return what the fitted twin's sensor gives at the conditions of a calibration, shape (n,).

    In the unit of the samples that it was fitted to, at ``situation.sample_rate``.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> healthy = 0.01 * np.random.default_rng(1).standard_normal(25600)
    >>> found = fit(healthy, 12800.0, find_bearing('6205'), 25.0, place='none')
    >>> bool(abs(fitted_vibration(found, 2.0).std() / 0.01 - 1.0) < 0.1)
    True

    """
    typical = {name: np.full(1, value) for name, value in found.typical().items()}
    typical['noise_ratio'] = np.zeros(1)
    path = found.path
    settle = REACH_S + SETTLE_S
    twin = next(vibrations(found.situation, typical, seconds + settle, seed))[0]
    settled = int(settle * found.situation.sample_rate)
    return path.filter(seed).apply(twin)[settled:]


class Fitter:
    """
    Fits the twin to one machine again and again, and remembers at which speeds it did.

    Impacts that stay as far apart in time while the speed changes are ringing, not a passage.

    Parameters
    ----------
    bearing
        Geometry.
    sample_rate
        Hz.
    load, unit, candidates, seed
        As for :func:`fit`.

    """

    def __init__(
        self,
        bearing: Bearing,
        sample_rate: float,
        *,
        load: tuple[float, float] | None = None,
        unit: str = '',
        candidates: int = 256,
        seed: int = 0,
    ) -> None:
        self._bearing, self._sample_rate = bearing, sample_rate
        self._load, self._unit, self._candidates, self._seed = load, unit, candidates, seed
        self._seen: list[tuple[str, float, float]] = []
        """Place, shaft speed in Hz and time between the impacts in s."""

    def update(
        self,
        samples: npt.ArrayLike,
        shaft_hz: float,
        *,
        temperature: float = math.nan,
        place: str | None = None,
    ) -> Calibration:
        """
        Fit the newest record; some seconds of it are enough.

        Parameters and errors as for :func:`fit`.
        """
        found = fit(
            samples, self._sample_rate, self._bearing, shaft_hz, load=self._load,
            temperature=temperature, unit=self._unit, place=place, candidates=self._candidates,
            seed=self._seed,
        )  # fmt: skip
        width = found.quantities['defect_width_mm']
        if found.spacing_s is None:
            return found
        # A spacing tells ringing from a passage whether or not a width was told from it.
        seen, self._seen = (
            self._seen,
            [
                *self._seen[-99:],
                (found.defect, shaft_hz, found.spacing_s),
            ],
        )
        for other, hz, spacing in seen:
            apart = max(hz, shaft_hz) / min(hz, shaft_hz)
            same = abs(spacing / found.spacing_s - 1.0) < SAME_TIME
            if width.identifiable and other == found.defect and apart > OTHER_SPEED and same:
                why = (
                    f'the impacts are {1e3 * spacing:.2f} ms apart at {hz:.1f} and at '
                    f'{shaft_hz:.1f} Hz: ringing, which does not follow the speed'
                )
                limited = replace(width, q05=0.0, identifiable=False, why=why)
                return replace(found, quantities=found.quantities | {'defect_width_mm': limited})
        return found


def _checked(
    samples: npt.ArrayLike,
    sample_rate: float,
    bearing: Bearing,
    shaft_hz: float,
    load: tuple[float, float] | None,
    temperature: float,
) -> tuple[FloatArray, Situation]:
    """Check what comes from outside."""
    x = np.asarray(samples, dtype=np.float64)
    if x.ndim != 1:
        msg = f'samples have shape {x.shape}; give one axis as a 1-D array'
        raise BearingTwinError(msg)
    bad = len(x) - int(np.isfinite(x).sum())
    if bad:
        msg = f'{bad} of {len(x)} samples are NaN or infinite: repair or leave out that part'
        raise BearingTwinError(msg)
    if not (math.isfinite(sample_rate) and sample_rate > 0.0):
        msg = f'sample rate {sample_rate} Hz: give a positive number'
        raise BearingTwinError(msg)
    if not (math.isfinite(shaft_hz) and 0.0 < shaft_hz <= 500.0):
        msg = f'the shaft speed is {shaft_hz:g} Hz: give it, from above 0 to 500 Hz (--shaft-hz)'
        raise BearingTwinError(msg)
    if bearing.element != 'ball' or bearing.rows != 1:
        msg = f'{bearing.name} is not one row of balls, which is what the twin simulates'
        raise BearingTwinError(msg)
    load_range(bearing, load)
    turns = len(x) / sample_rate * shaft_hz
    if turns < LEAST_TURNS:
        msg = (
            f'{turns:.1f} shaft turns in {len(x) / sample_rate:.3g} s: give at least '
            f'{LEAST_TURNS:g}, {LEAST_TURNS / shaft_hz:.3g} s at this speed'
        )
        raise BearingTwinError(msg)
    wanted = 8.0 * fault_frequencies(bearing, shaft_hz).bpfi
    if sample_rate < max(wanted, 2000.0):
        msg = f'sample rate {sample_rate:g} Hz: at least {max(wanted, 2000.0):.0f} Hz are needed'
        raise BearingTwinError(msg)
    if np.ptp(x) <= 1e-12 * max(float(np.abs(x).max()), 1e-300):
        msg = f'the signal is constant at {x[0]:g}: check sensor and cable'
        raise BearingTwinError(msg)
    return x - x.mean(), Situation(
        bearing=bearing,
        place='none',
        shaft_hz=shaft_hz,
        sample_rate=sample_rate,
        temperature=temperature if math.isfinite(temperature) else TEMPERATURE,
        load=load,
    )


def _decimated(x: FloatArray, sample_rate: float) -> tuple[FloatArray, float]:
    """Bring a record to a rate at which candidates are simulated."""
    factor = math.ceil(sample_rate / HIGHEST_RATE)
    if factor == 1:
        return x, sample_rate
    return np.asarray(signal.decimate(x, factor, ftype='fir')), sample_rate / factor


def _fitted(
    x: FloatArray,
    situation: Situation,
    unit: str,
    candidates: int,
    seed: int,
    start: float,
    verdict: str,
) -> Calibration:
    measured = summarise(x, situation.sample_rate, situation.longest)
    modes = resonances(x, situation.sample_rate)
    defective = situation.place in ('inner', 'outer')
    if defective:
        left, refusal = _defect(measured, situation, modes, candidates, seed)
        values, weights = left.values, left.weights
    else:
        prior = unknowns(situation)
        shares = np.random.default_rng([seed, 0]).random((64, len(prior)))
        values = {name: u.place(shares[:, i]) for i, (name, u) in enumerate(prior.items())}
        weights = np.full(64, 1.0 / 64)
    path, twin = _path(x, situation, values, weights, seed)
    factor = acceleration_factor(unit)
    before = twin + NOISE * np.random.default_rng(seed).standard_normal(len(twin))
    scale = factor if math.isfinite(factor) else float(before.std() / x.std())
    quantities = _of_path(x, path, modes, situation, unit)
    if defective:
        quantities |= _of_defect(left, refusal)
        width = quantities['defect_width_mm']
        if width.identifiable:
            statement = (
                f'{situation.place} race defect, {width.median:.2f} mm wide '
                f'({width.q05:.2f} to {width.q95:.2f})'
            )
        else:
            statement = f'{situation.place} race defect, at most {width.q95:.2f} mm wide'
    else:
        width, statement = _without(x, situation, scale, unit, seed)
        statement += verdict
        quantities |= {'defect_width_mm': width}
        for name in values:
            if name != 'defect_width_mm':
                at = posterior.weighted_quantile(values[name], weights, (0.05, 0.5, 0.95))
                quantities[name] = Estimate(
                    q05=float(at[0]), median=float(at[1]), q95=float(at[2]),
                    unit=unknowns(situation)[name].unit, identifiable=False,
                    why='the vibration of a bearing without a race defect does not tell it',
                )  # fmt: skip
    fitted = path.filter(seed).apply(twin)[len(path.denominator) :]
    return Calibration(
        situation=situation,
        quantities=quantities,
        statement=statement,
        path=path,
        distance_before=spectral_distance(x * scale, before, situation.sample_rate),
        distance=spectral_distance(x, fitted, situation.sample_rate),
        level_before=20.0 * math.log10(before.std() / (x.std() * factor))
        if math.isfinite(factor)
        else math.nan,
        level=20.0 * math.log10(fitted.std() / x.std()),
        candidates=values,
        weights=weights,
        sensor_unit=unit,
        spacing_s=measured.spacing if defective and measured.seen else None,
        cost_s=time.process_time() - start,
    )


def _defect(
    measured: Summary, situation: Situation, modes: list[Resonance], candidates: int, seed: int
) -> tuple[Posterior, str]:
    """Return what is left possible of a defect, and why its width is not told, or ''."""
    refusal = unresolved(measured)
    if not refusal:
        left = posterior.sample(measured, situation, candidates=candidates, seed=seed)
        strongest = next((m.hz[1] for m in modes if m.damping[1] >= LINE_DAMPING), math.nan)
        refusal = untold(left, situation, strongest)
        if not refusal or refusal == MANY_WIDTHS:
            return left, refusal
    return posterior.limit(measured, situation, candidates=candidates, seed=seed), refusal


def unresolved(measured: Summary) -> str:
    """
    Why a record tells no spacing of the impacts of a passage; '' if it does.

    Examples
    --------
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> bool(unresolved(summarise(noise, 12800.0, 5e-4)))
    True

    """
    shortest = posterior.resolved(measured)
    if not measured.seen or measured.spacing < shortest:
        seen = f'{1e3 * measured.spacing:.2f} ms apart' if measured.seen else 'not told apart'
        return (
            f'the impacts of a passage are {seen}; the ringing of one hides a second up to '
            f'{1e3 * shortest:.2f} ms'
        )
    if measured.rival > RIVAL:
        return 'the impacts repeat after several times that are about as clear: ringing'
    return ''


def untold(left: Posterior, situation: Situation, strongest: float) -> str:
    """
    Why the candidates that were kept tell no width; '' if they do.

    Parameters
    ----------
    left
        The candidates.
    situation
        Of the machine.
    strongest
        Frequency of the strongest resonance, Hz; NaN if none was found.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> machine = Situation(
    ...     bearing=find_bearing('6205'), place='outer', shaft_hz=25.0, sample_rate=12800.0
    ... )
    >>> left = posterior.limit(
    ...     summarise(np.random.default_rng(1).standard_normal(25600), 12800.0, machine.longest),
    ...     machine, candidates=32,
    ... )
    >>> untold(left, machine, 10.0).startswith('the passage lasts')
    True

    """
    median = 1e-3 * float(left.quantiles('defect_width_mm', (0.5,))[0])
    periods = median / situation.speed * strongest
    if periods < PERIODS:
        return (
            f'the passage lasts {periods:.1f} periods of the resonance at {strongest:.0f} Hz '
            f'that it excites; {PERIODS:g} are needed'
        )
    if left.distance > ALIKE * left.typical:
        return 'no candidate of the twin gives impacts like these'
    return MANY_WIDTHS if left.narrowed('defect_width_mm') > NARROWED else ''


def _of_defect(left: Posterior, refusal: str) -> dict[str, Estimate]:
    """Return the quantities of the bearing."""
    quantities = {}
    for name, about in left.prior.items():
        low, median, high = (float(v) for v in left.quantiles(name))
        narrowed = left.narrowed(name)
        if name == 'defect_width_mm':
            told = not refusal
            why = refusal or 'from the spacing of the impacts of a passage'
            if refusal:
                why = f'at most {high:.2f} mm: {refusal}'
        else:
            told = name in TOLD and not refusal and narrowed <= NARROWED
            why = f'the interval is {100.0 * narrowed:.0f} % of what was supposed'
        quantities[name] = Estimate(
            q05=low, median=median, q95=high, unit=about.unit, identifiable=told, why=why
        )
    return quantities


def _path(
    x: FloatArray,
    situation: Situation,
    values: dict[str, FloatArray],
    weights: FloatArray,
    seed: int,
) -> tuple[SensorPath, FloatArray]:
    """Identify the path of a typical candidate; also return its acceleration without noise."""
    typical = {
        name: np.full(1, float(posterior.weighted_quantile(v, weights, (0.5,))[0]))
        for name, v in values.items()
    }
    ratio = float(typical['noise_ratio'][0])
    typical['noise_ratio'] = np.zeros(1)
    seconds = min(len(x) / situation.sample_rate, max(2.0, LEAST_PASSAGES / situation.shaft_hz))
    twin = next(vibrations(situation, typical, seconds, seed))[0]
    noise = ratio * float(twin.std()) if situation.place in ('inner', 'outer') else NOISE
    return identify(x, situation.sample_rate, twin, noise), twin


def _of_path(
    x: FloatArray, path: SensorPath, modes: list[Resonance], situation: Situation, unit: str
) -> dict[str, Estimate]:
    """Return the quantities of the sensor's path."""
    rate = situation.sample_rate
    parts = np.array_split(x, 8)
    floors = []
    for part in parts:
        density = signal.welch(part, rate, nperseg=min(len(part), max(64, int(0.02 * rate))))[1]
        floors.append(math.sqrt(float(np.quantile(density[: int(0.86 * len(density))], 0.05))))
    middle, half = float(np.mean(floors)), 1.645 * float(np.std(floors)) / math.sqrt(7.0)
    unit = unit or 'unit of the samples'
    quantities = {
        'gain': Estimate(
            q05=0.1 * path.gain, median=path.gain, q95=10.0 * path.gain,
            unit=f'{unit} per m/s^2', identifiable=False,
            why='only its product with the strength of the impacts is seen; a factor of 10 is '
            'supposed',
        ),
        'noise_floor': Estimate(
            q05=middle - half, median=middle, q95=middle + half, unit=f'{unit}/sqrt(Hz)',
            identifiable=True, why='from the quietest twentieth of the spectrum in eight parts',
        ),
    }  # fmt: skip
    told = [mode for mode in modes if mode.damping[1] >= LINE_DAMPING]
    for number, mode in enumerate(told, start=1):
        known = mode.found >= FOUND and math.isfinite(mode.hz[2])
        why = (
            f'found in {100.0 * mode.found:.0f} % of the parts of the record, '
            f'{100.0 * mode.share:.0f} % of the power'
        )
        for name, at, of in (
            (f'resonance_{number}_hz', mode.hz, 'Hz'),
            (f'resonance_{number}_damping', mode.damping, ''),
        ):
            low, high = (at[0], at[2]) if known else (0.0, rate / 2.0 if of else 1.0)
            quantities[name] = Estimate(
                q05=low, median=at[1], q95=high, unit=of, identifiable=known, why=why
            )
    return quantities


def _without(
    x: FloatArray, situation: Situation, scale: float, unit: str, seed: int
) -> tuple[Estimate, str]:
    """Return the width of a defect that the record would have shown, and that in words."""
    highest = 1e3 * widest(situation.bearing)
    if situation.place in ('ball', 'cage'):
        why = f'the width of a {situation.place} defect is not fitted'
        width = Estimate(
            q05=0.0, median=0.5 * highest, q95=highest, unit='mm', identifiable=False, why=why
        )
        return width, f'{situation.place} defect, at most {highest:.1f} mm wide'
    found = smallest_shown(x, situation, scale, LOSS_DB if unit else 0.0, seed)
    largest = found.width_mm if math.isfinite(found.width_mm) else highest
    statement = f'no defect above {largest:.2g} mm'
    why = f'{statement}: wider ones, added to this record, show in 80 of 100 simulated machines'
    if not math.isfinite(found.width_mm):
        why = f'{statement}: none of any width, added to this record, is sure to show'
    if not unit:
        why += '; the unit is not known, so the healthy twin sets the scale'
    width = Estimate(q05=0.0, median=0.0, q95=largest, unit='mm', identifiable=False, why=why)
    return width, statement
