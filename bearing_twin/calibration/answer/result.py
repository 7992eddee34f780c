# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Result of a calibration: quantities with their intervals, and the fitted twin."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import Bearing, PLACES
from bearing_twin.calibration.answer.impacts import Impacts
from bearing_twin.calibration.answer.refusals import Kind
from bearing_twin.calibration.candidates.cloud import (
    FASTEST_HZ,
    HIGHEST_RATE,
    LEAST_RATE,
    MOST_SLIP,
    parameters,
    Situation,
    unknowns,
)
from bearing_twin.calibration.candidates.passage import load_range
from bearing_twin.calibration.candidates.posterior import weighted_quantile
from bearing_twin.dynamics.equations.sensor_path import SensorPath, window_length
from bearing_twin.dynamics.parameters import check_bearing, FITTED
from bearing_twin.errors import BearingTwinError
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.dynamics import TwinParameters


_POSITIVE = math.ulp(0.0)
UNBOUNDED_REASONS = {
    Kind.ONE_IMPACT: 'only one impact per passage is heard',
    Kind.SAME_AT_ANOTHER_SPEED: 'a second impact is ringing, which does not follow the speed',
}
"""Refusals where a race has impacts but nothing bounds the width, in words."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """Estimate of one quantity: 5 %, 50 % and 95 % quantiles."""

    q05: float
    median: float
    q95: float
    unit: str
    identifiable: bool
    """Whether the vibration determines it; otherwise the interval is assumed, or a limit."""
    why: str


def in_words(place: str, width: Estimate, refusal: Kind | None = None) -> str:
    """
    Return place and width of a race defect in words.

    Examples
    --------
    >>> width = Estimate(q05=0.9, median=1.0, q95=1.2, unit='mm', identifiable=True, why='')
    >>> in_words('inner', width)
    'inner race defect, 1.00 mm wide (0.90 to 1.20)'
    >>> in_words('inner', replace(width, identifiable=False))
    'inner race defect, at most 1.20 mm wide'

    """
    if width.identifiable:
        between = f'{width.q05:.2f} to {width.q95:.2f}'
        return f'{place} race defect, {width.median:.2f} mm wide ({between})'
    if refusal in UNBOUNDED_REASONS:
        return f'{place} race defect, width not identifiable: {UNBOUNDED_REASONS[refusal]}'
    return f'{place} race defect, at most {width.q95:.2f} mm wide'


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """A twin fitted to a machine."""

    situation: Situation
    """Bearing, place of the defect, speed, temperature and load at which it was measured."""
    quantities: dict[str, Estimate]
    statement: str
    """Place and width of the defect, or its absence, in words."""
    refusal: Kind | None
    """Why the width is not identifiable; None if it is, or the bearing is healthy."""
    path: SensorPath
    distance_before: float
    """Log-spectral distance of an unfitted twin from the machine, dB."""
    distance: float
    """The same for the fitted twin."""
    level_before: float
    """Level of an unfitted twin over the machine's, dB; NaN if the unit is not known."""
    level: float
    """The same for the fitted twin."""
    spectrum: NDArray[np.float64] = field(repr=False)
    """`dynamics.equations.sensor_path.band_levels` of the machine."""
    rms: float
    """RMS of the machine's vibration."""
    candidates: dict[str, NDArray[np.float64]] = field(repr=False)
    """Values of each of `cloud.unknowns`, one per candidate, shape (n,)."""
    weights: NDArray[np.float64] = field(repr=False)
    """Weights of the candidates, sum 1, shape (n,)."""
    sensor_unit: str
    """Unit of the vibration; '' if unknown."""
    impacts: Impacts | None
    """The two impacts of a passage of a ball; None if they are not seen."""
    cost_s: float
    """Processor time of the fit without compilation, s."""

    @property
    def defect(self) -> str:
        """Part with the defect, or 'none'."""
        return self.situation.place

    @property
    def bounds_width(self) -> bool:
        """Whether a race has a defect whose width is bounded."""
        return self.defect in ('inner', 'outer') and self.refusal not in UNBOUNDED_REASONS

    @property
    def twin_situation(self) -> Situation:
        """Situation of the twin: without the defect if the record shows no impact of it."""
        defect_unknown = self.refusal is not None and self.refusal.defect_unknown
        return replace(self.situation, place='none') if defect_unknown else self.situation

    def typical(self) -> dict[str, float]:
        """Return the weighted median of each unknown of the candidates."""
        return {
            name: float(weighted_quantile(values, self.weights, (0.5,))[0])
            for name, values in self.candidates.items()
        }

    def twin_parameters(self) -> TwinParameters:
        """
        Return the parameters of a twin that runs beside the machine.

        Its sensor has neither noise nor resonance: both are in `path`, whose filter turns its
        acceleration into the signal of the machine's sensor.
        """
        return parameters(self.twin_situation, self.typical())

    def to_dict(self) -> dict[str, Any]:
        """Return the calibration as plain values, which :meth:`from_dict` reads."""
        bearing = {
            name: value for name, value in asdict(self.situation.bearing).items() if value != ''
        }
        twin = self.twin_parameters()
        return {
            'quantities': {name: asdict(value) for name, value in self.quantities.items()},
            'defect': self.defect,
            'statement': self.statement,
            'refusal': self.refusal and self.refusal.value,
            'residual': self.distance,
            'cost_s': round(self.cost_s, 3),
            'spectrum': {
                'distance_before_db': self.distance_before,
                'distance_after_db': self.distance,
                'level_before_db': None if math.isnan(self.level_before) else self.level_before,
                'level_after_db': self.level,
                'machine_db': self.spectrum.tolist(),
                'machine_rms': self.rms,
            },
            # The values that a running twin takes from a calibration.
            'twin': {
                'defects': [asdict(defect) for defect in twin.defects],
                **{name: getattr(twin, name) for name in FITTED},
            },
            'machine': {
                'bearing': bearing,
                'shaft_hz': self.situation.shaft_hz,
                'sample_rate': self.situation.sample_rate,
                'temperature': self.situation.temperature,
                'load': self.situation.load,
                'slip': self.situation.slip,
                'unit': self.sensor_unit,
            },
            'path': self.path.to_dict(),
            'candidates': {name: v.tolist() for name, v in self.candidates.items()},
            'weights': self.weights.tolist(),
            'impacts': self.impacts and self.impacts._asdict(),
        }

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Calibration:
        """Return the calibration that :meth:`to_dict` wrote."""
        try:
            machine, spectrum = values['machine'], values['spectrum']
            situation = _situation(machine, values['defect'])
            candidates, weights = _cloud(values['candidates'], values['weights'], situation)
            path = SensorPath.from_dict(values['path'])
            rate = situation.sample_rate
            _number(values['path'], 'sample_rate', rate, rate)
            levels = np.array(spectrum['machine_db'], float)
            if levels.shape != (window_length(rate) // 2 + 1,) or not np.isfinite(levels).all():
                raise ValueError(f'machine_db is not of {window_length(rate) // 2 + 1} numbers')
            quantities = {k: _estimate(v) for k, v in values['quantities'].items()}
            if 'defect_width_mm' not in quantities:
                raise KeyError('defect_width_mm')
            refusal, impacts = values['refusal'], values['impacts']
            return cls(
                situation=situation,
                quantities=quantities,
                statement=_text(values, 'statement'),
                refusal=None if refusal is None else Kind(refusal),
                path=path,
                distance_before=_number(spectrum, 'distance_before_db', 0.0),
                distance=_number(spectrum, 'distance_after_db', 0.0),
                level_before=math.nan
                if spectrum['level_before_db'] is None
                else _number(spectrum, 'level_before_db'),
                level=_number(spectrum, 'level_after_db'),
                spectrum=levels,
                rms=_number(spectrum, 'machine_rms', _POSITIVE),
                candidates=candidates,
                weights=weights,
                sensor_unit=_text(machine, 'unit'),
                impacts=None if impacts is None else _impacts(impacts, situation),
                cost_s=_number(values, 'cost_s', 0.0),
            )
        except (
            KeyError,
            TypeError,
            ValueError,
            IndexError,
            AttributeError,
            OverflowError,
            BearingTwinError,
        ) as error:
            what = f'{error} is missing' if isinstance(error, KeyError) else f'{error!r:.200}'
            msg = f'not a calibration of this version ({what:.200}); fit the machine again'
            raise BearingTwinError(msg) from None

    def at(self, **changes: Any) -> Calibration:
        """Return the same machine under other conditions, given as fields of `Situation`."""
        return replace(self, situation=replace(self.situation, **changes))


def _number(
    of: dict[str, Any], name: str, low: float = -math.inf, high: float = math.inf
) -> float:
    """Return a finite number within a range; raises a ValueError."""
    value = of[name]
    finite = type(value) in (int, float) and math.isfinite(value)
    if not (finite and low <= value <= high):
        raise ValueError(f'{name} is {value!r:.40}, no number from {low:g} to {high:g}')
    return float(value)


def _text(of: dict[str, Any], name: str) -> str:
    if not isinstance(of[name], str):
        raise ValueError(f'{name} is {of[name]!r:.40}, no text')
    return str(of[name])


def _estimate(of: dict[str, Any]) -> Estimate:
    estimate = Estimate(**of)
    low, high = _number(of, 'q05'), _number(of, 'q95')
    _number(of, 'median', low, high)
    if not isinstance(estimate.identifiable, bool):
        raise ValueError(f'identifiable is {estimate.identifiable!r:.40}, not true or false')
    _text(of, 'unit')
    _text(of, 'why')
    return estimate


def _impacts(of: dict[str, Any], situation: Situation) -> Impacts:
    """Return the impacts if they belong to the situation; raises a ValueError."""
    spacing, lobe = (_number(of, name, _POSITIVE) for name in ('spacing_s', 'lobe_s'))
    rivals = tuple(map(float, of['rivals_s']))
    seen = Impacts(str(of['place']), float(of['shaft_hz']), spacing, lobe, rivals)
    alike = (seen.place, seen.shaft_hz) == (situation.place, situation.shaft_hz)
    if not (alike and all(0.0 < time < math.inf for time in seen.rivals_s)):
        raise ValueError('the impacts are not those of this machine')
    return seen


def _situation(machine: dict[str, Any], place: str) -> Situation:
    if place not in (*PLACES, 'none'):
        raise ValueError(f'defect {place!r:.40} is none of {", ".join(PLACES)}, none')
    load = machine['load']
    for value in machine['bearing'].values():
        if isinstance(value, (dict, list)):
            raise ValueError(f'the bearing has {value!r:.40}')
    bearing = Bearing(**machine['bearing'])
    check_bearing(bearing)
    if load is not None:
        low, high = load
        load = load_range(bearing, (float(low), float(high)))
    return Situation(
        bearing=bearing,
        place=place,
        shaft_hz=_number(machine, 'shaft_hz', _POSITIVE, FASTEST_HZ),
        sample_rate=_number(machine, 'sample_rate', LEAST_RATE, HIGHEST_RATE),
        temperature=_number(machine, 'temperature', -273.15),
        load=load,
        slip=_number(machine, 'slip', 0.0, MOST_SLIP),
    )


def _cloud(
    candidates: dict[str, Any], weights: list[float], situation: Situation
) -> tuple[dict[str, NDArray[np.float64]], NDArray[np.float64]]:
    """Return candidates and weights as arrays; raises a ValueError if they are invalid."""
    arrays, shares = {k: np.array(v, float) for k, v in candidates.items()}, np.array(weights)
    each = np.stack([*arrays.values(), shares.astype(float)])
    fits = each.ndim == 2 and np.isfinite(each).all() and (each[-1] >= 0.0).all()
    if not (fits and math.isclose(each[-1].sum(), 1.0, rel_tol=1e-6)):
        raise ValueError('candidates without finite values or weights of sum 1')
    for name, about in unknowns(situation).items():
        # A missing angle is zero.
        values = arrays.get(name, np.zeros(1)) if name == 'defect_angle' else arrays[name]
        if (np.abs(values - np.clip(values, about.low, about.high)) > 1e-9 * about.high).any():
            said = f'{about.low:g} to {about.high:g} {about.unit}'.rstrip()
            raise ValueError(f'candidates whose {name} is not from {said}')
    return arrays, each[-1]
