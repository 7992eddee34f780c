# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Machines of known truth for the study of calibrations: simulated ones, and records of two rigs.

The simulated machines are twins with unknowns from the prior, and trains of impacts, which share
nothing with the twin. Bearing, sample rate, speed, place of the defect, gain and the resonances of
the path are drawn at random.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
import json
import math
from pathlib import Path
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import find_bearing
from bearing_twin.calibration import fit
from bearing_twin.calibration.answer.healthy import LOSS_DB, smallest_detectable_width, would_show
from bearing_twin.calibration.candidates.cloud import (
    LONGEST_BLOCK,
    parameters,
    SETTLE_S,
    Situation,
    TEMPERATURE,
    unknowns,
    vibrations,
)
from bearing_twin.calibration.candidates.passage import (
    impact_spacing,
    interference,
    load_range,
    path_curvature,
)
from bearing_twin.calibration.candidates.posterior import weighted_quantile
from bearing_twin.calibration.measured.path import noise_floor, resonances, STUDENT
from bearing_twin.calibration.whatif import expect, features
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.dynamics import Fleet
from bearing_twin.dynamics.parameters import widest
from bearing_twin.recording.signals.signalfile import read_signal
import numpy as np
from numpy.typing import NDArray
from scipy import signal, stats

if TYPE_CHECKING:
    from bearing_twin.calibration import Calibration


BEARINGS = ('6001', '6203', '6204', '6205', '6206', '6208', '6210', '6305', '6308', '6310', '6313',
            '6220')  # fmt: skip
RATES = (10e3, 12.8e3, 16e3, 20e3, 25.6e3, 32e3, 40e3, 48e3, 51.2e3, 64e3)
SPEEDS_HZ = 5.0, 60.0
RESONANCES_HZ = 1000.0, 12000.0
CLOSE_SHARE, CLOSE = 0.4, (0.02, 0.15)
"""Share of the machines with two resonances close to each other, and how close, relatively."""
LENGTHS_S, TURNS = (1.0, 2.0, 3.0, 5.0), 22.0
"""Lengths of records, s, and the fewest shaft turns of a record."""
SECONDS = 3.0
"""Length of each record if several are compared, s."""
HUM_SHARE = 0.5
"""Share of the records with mains hum, up to five times as strong as the vibration."""
WAVINESS = 1e-5, 2.5e-4
"""Range of the waviness of twins of known noise floor, m/s: see `dynamics.equations.waviness`."""
LONG = 20
"""Length of the record that gives the true noise floor, over that of the fitted one."""
ADDED = 8
"""Number of defects that are added to a healthy machine."""
RATIOS = 1.5, 2.0, 1.0 / 1.5
"""Ratios of the predicted speed to the fitted one."""
UNITS = {'hitsm': '', 'cwru': 'g'}
"""Units of the records; the files do not contain them."""
RACES_MM = {'inner': 15.55, 'outer': 23.5}
"""Radii of the races of HIT-SM, mm; its slots are given in degrees."""


def drawn_machine(number: int, key: int) -> tuple[np.random.Generator, Situation, float]:
    """Draw a machine; return the generator, its situation and the length of its record, s."""
    rng = np.random.default_rng([2711, key, number])
    low, high = SPEEDS_HZ
    situation = Situation(
        bearing=find_bearing(str(rng.choice(BEARINGS))),
        place=str(rng.choice(('inner', 'outer'))),
        shaft_hz=float(low * (high / low) ** rng.random()),
        sample_rate=float(rng.choice(RATES)),
    )
    return rng, situation, max(float(rng.choice(LENGTHS_S)), TURNS / situation.shaft_hz)


def drawn_modes(
    rate: float, rng: np.random.Generator, *, count: tuple[int, int] = (1, 3),
    lowest: float = RESONANCES_HZ[0], most_damped: float = 0.06,
) -> list[tuple[float, ...]]:  # fmt: skip
    """Draw resonances: frequency, Hz, damping ratio and height of each."""
    highest = min(RESONANCES_HZ[1], 0.4 * rate)
    hertz = [rng.uniform(lowest, highest) for _ in range(rng.integers(count[0], count[1] + 1))]
    if rng.random() < CLOSE_SHARE:
        hertz.append(
            min(hertz[0] * (1.0 + rng.choice((-1.0, 1.0)) * rng.uniform(*CLOSE)), highest)
        )
    return [(hz, rng.uniform(0.01, most_damped), rng.uniform(0.3, 1.0)) for hz in hertz]


def with_hum(x: NDArray[np.float64], rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Add mains hum with seven harmonics to half of the records."""
    if rng.random() > HUM_SHARE:
        return x
    order = np.arange(1, 9)
    turns = np.outer(order, rng.choice((50.0, 60.0)) * np.arange(len(x)) / rate)
    heights = rng.uniform(0.0, 1.0, len(order)) / np.sqrt(order)
    hum = heights @ np.cos(2.0 * np.pi * (turns + rng.random((len(order), 1))))
    return np.asarray(x + 10.0 ** rng.uniform(-1.0, 0.7) * x.std() / hum.std() * hum)


def ring(
    x: NDArray[np.float64], rate: float, modes: list[tuple[float, ...]]
) -> NDArray[np.float64]:
    """Return the sum of the responses of resonances to a signal; modes as in `drawn_modes`."""
    out = np.zeros_like(x)
    for hz, damping, height in modes:
        pole = np.exp(2.0 * np.pi * hz / rate * (1j * math.sqrt(1.0 - damping**2) - damping))
        rung = signal.lfilter([1.0], np.poly([pole, pole.conjugate()]).real, x)
        # A slot so narrow that no ball is unloaded excites nothing.
        out += height * rung / (rung.std() or 1.0)
    return out


def _gain(rng: np.random.Generator) -> float:
    return float(10.0 ** rng.uniform(-3.0, 3.0))


def row_of(found: Calibration, width: float) -> dict[str, Any]:
    """Return the estimated width of a defect, mm, and the rank of its true ``width``, mm."""
    told = found.quantities['defect_width_mm']
    own = [math.nan] * 4
    rank = math.nan
    if found.defect != 'none':
        values = found.candidates['defect_width_mm']
        # Quantiles without the allowance of `estimates.of_defect` for the model.
        own = weighted_quantile(values, found.weights, (0.05, 0.25, 0.75, 0.95)).tolist()
        rank = float(found.weights[values < width].sum())
    return {
        'width': width, 'q05': told.q05, 'q25': own[1], 'median': told.median, 'q75': own[2],
        'q95': told.q95, 'own_q05': own[0], 'own_q95': own[3],
        'identifiable': told.identifiable, 'why': told.why, 'rank': rank,
        'place': found.defect, 'bearing': found.situation.bearing.name,
        'rate': found.situation.sample_rate, 'spacing_mm': math.nan if found.impacts is None
        else 1e3 * found.impacts.spacing_s * found.situation.speed,
        'distance_before': found.distance_before, 'distance': found.distance,
        'level': found.level, 'cost_s': found.cost_s,
    }  # fmt: skip


def fit_twin(number: int) -> list[dict[str, Any]]:
    """Fit a record of a twin whose unknowns come from the prior."""
    rng, situation, seconds = drawn_machine(number, 0)
    truth = {name: u.place(rng.random(1)) for name, u in unknowns(situation).items()}
    x = next(vibrations(situation, truth, seconds, number + 1))[0]
    return [_fitted_row(x, situation, rng, number, float(truth['defect_width_mm'][0]))]


def fit_impacts(number: int, kind: str) -> list[dict[str, Any]]:
    """
    Fit a train of pairs of impacts.

    Their distance is the width of the defect (kind 'edges'), less for the path of a ball ('path'),
    or more than half of the way to the next ball ('wide').
    """
    kinds = ('edges', 'path', 'wide')
    rng, situation, seconds = drawn_machine(number, 1 + kinds.index(kind))
    bearing, place = situation.bearing, situation.place
    width = float(rng.uniform(0.2e-3, widest(bearing)))
    if kind == 'wide':
        width = float(rng.uniform(0.55, 0.93)) * situation.speed / situation.impact_rate
    low, high = load_range(bearing)
    sinking = interference(bearing, low * (high / low) ** rng.random()) if kind == 'path' else 0.0
    apart = impact_spacing(width, sinking, path_curvature(bearing, place)) / situation.speed
    x = train(situation, rng, [apart], (rng.uniform(0.4, 1.0), -1.0), seconds)
    noise = 10.0 ** rng.uniform(-2.0, -0.5)
    return [_fitted_row(x, situation, rng, number, 1e3 * width, noise)]


def _fitted_row(
    x: NDArray[np.float64], machine: Situation, rng: np.random.Generator, seed: int, width: float,
    noise: float = 0.0,
) -> dict[str, Any]:  # fmt: skip
    """Fit the sensor signal of a vibration; ``noise`` is over its RMS, ``width`` in mm."""
    rate = machine.sample_rate
    y = ring(x, rate, drawn_modes(rate, rng)) * _gain(rng)
    y += noise * y.std() * rng.standard_normal(len(y))
    y = with_hum(y, rate, rng)
    found = fit(y, rate, machine.bearing, machine.shaft_hz, place=machine.place, seed=seed + 2)
    return row_of(found, width)


def train(
    machine: Situation, rng: np.random.Generator, apart_s: Sequence[float],
    shares: Sequence[float], seconds: float = SECONDS,
) -> NDArray[np.float64]:  # fmt: skip
    """Return one impact per passage, and others ``apart_s`` after it; ``shares``: all heights."""
    rate, strikes = machine.sample_rate, machine.impact_rate
    count = int(1.2 * strikes * seconds) + 2
    entries = np.cumsum(1.0 + 0.005 * rng.standard_normal(count)) / strikes
    heights = 1.0 + 0.3 * rng.standard_normal(count)
    if machine.place == 'inner':
        heights *= np.maximum(np.cos(2.0 * np.pi * machine.shaft_hz * entries), 0.0)
    x = np.zeros(int(seconds * rate))
    for after, share in zip((0.0, *apart_s), shares, strict=True):
        at = np.round((entries + after) * rate).astype(int)
        np.add.at(x, at[at < len(x)], share * heights[at < len(x)])
    return x


def _wavy_twin(
    machine: Situation, rng: np.random.Generator, n: int, seed: int
) -> NDArray[np.float64]:
    """Return the acceleration of a twin with wavy surfaces, m/s^2, shape (n,)."""
    values = {name: float(u.place(rng.random())) for name, u in unknowns(machine).items()}
    low, high = WAVINESS
    twin = replace(parameters(machine, values), waviness=low * (high / low) ** rng.random())
    rate, hz = machine.sample_rate, machine.shaft_hz
    fleet = Fleet([twin], sample_rate=rate, seeds=[seed], temperatures=TEMPERATURE, shaft_hz=hz)
    parts = [int(SETTLE_S * rate), *np.diff([*range(0, n, LONGEST_BLOCK), n])]
    x = [fleet.advance(int(part), TEMPERATURE, hz).y[0].astype(np.float64) for part in parts]
    vibration = np.concatenate(x[1:])
    return np.asarray(vibration - vibration.mean())


def fit_path(number: int) -> list[dict[str, Any]]:
    """
    Measure the noise floor of a machine, and whether its strongest resonance is one of the path.

    The machines are, in turn, noise through resonances, a healthy twin with wavy surfaces, and
    such a twin with a defect. The true floor is that of a record twenty times as long.
    """
    rng, machine, seconds = drawn_machine(number, 4)
    kind = ('noise', 'healthy twin', 'twin with a defect')[number % 3]
    rate, n = machine.sample_rate, int(seconds * machine.sample_rate)
    modes = drawn_modes(rate, rng)
    if kind == 'noise':
        x = rng.standard_normal(LONG * n)
    else:
        place = machine.place if kind.endswith('defect') else 'none'
        x = _wavy_twin(replace(machine, place=place), rng, LONG * n, number + 1)
    y = ring(x, rate, modes) * _gain(rng)
    y += 10.0 ** rng.uniform(-3.0, -1.0) * y.std() * rng.standard_normal(len(y))
    y = with_hum(y, rate, rng)
    low, middle, high = noise_floor(y[:n], rate)
    truth = noise_floor(y, rate)[1]
    z = STUDENT * (truth**2 - middle**2) / (high**2 - middle**2)
    rows: list[dict[str, Any]] = [
        {'quantity': f'noise floor, {kind}', 'truth': truth, 'q05': low, 'median': middle,
         'q95': high, 'rank': float(stats.t.cdf(z, 7))}
    ]  # fmt: skip
    rows += [
        {
            'resonance': kind,
            'own': any(abs(mode.hz / hz - 1.0) < damping for hz, damping, _ in modes),
        }
        for mode in resonances(y[:n], rate)[:1]
    ]
    return rows


def look_at_healthy(number: int) -> list[dict[str, Any]]:
    """
    Find the smallest defect that a healthy twin would have shown, and add wider ones to it.

    They are added to a later record of the same machine and searched by the rule of the limit and
    by the diagnosis. Half are passages of the twin, half are equally strong trains of impacts.
    """
    rng, machine, seconds = drawn_machine(number, 6)
    machine = replace(machine, place='none')
    rate, n = machine.sample_rate, int(seconds * machine.sample_rate)
    y = _wavy_twin(machine, rng, 2 * n, number + 1)
    y += 10.0 ** rng.uniform(-1.5, 0.5) * y.std() * rng.standard_normal(len(y))
    y = with_hum(y, rate, rng)
    limit, confidence = smallest_detectable_width(y[:n], machine, 1.0, 0.0, number)
    rows: list[dict[str, Any]] = [{'limit': limit, 'confidence': confidence}]
    for at in range(ADDED if math.isfinite(limit) else 0):
        there = replace(machine, place=('inner', 'outer')[at % 2])
        prior = unknowns(there)
        drawn = {name: u.place(rng.random(1)) for name, u in prior.items()}
        width = replace(prior['defect_width_mm'], low=limit).place(rng.random(1))
        drawn |= {'defect_width_mm': width, 'noise_ratio': np.zeros(1)}
        x = next(vibrations(there, drawn, seconds, number + at))[0][:n]
        trains = at >= ADDED // 2
        if trains:
            apart = 1e-3 * float(width[0]) / there.speed
            impacts = train(there, rng, [apart], (rng.uniform(0.4, 1.0), -1.0), seconds)[: len(x)]
            x = impacts * (x.std() / impacts.std())
        x = 10.0 ** (-LOSS_DB * rng.random() / 20.0) * x
        later = y[n : n + len(x)]
        said = diagnose_record(later + x, rate, machine.bearing, machine.shaft_hz, unit='m/s^2')
        rows.append(
            {
                'added': 'trains of impacts' if trains else 'twins',
                'confidence': confidence,
                'shown': would_show(later, x, rate, there.impact_rate, there.shaft_hz),
                'told': said.result == there.place or there.place in said.faults,
                'healthy': said.result == 'healthy',
            }
        )
    return rows


def fit_record(path: Path, rpm: float, width: float) -> list[dict[str, Any]]:
    """Fit a real record of a 6205 with a defect of known width, mm."""
    return [{'name': path.stem, **row_of(_fitted(path, rpm), width)}]


def fit_whatif(path: Path, rpm: float, others: list[tuple[Path, float]]) -> list[dict[str, Any]]:
    """Fit a record at one speed and predict the same machine at others."""
    found = _fitted(path, rpm)
    rows = []
    for other, other_rpm in others:
        record = read_signal(other)
        rows += [
            {'name': path.stem, 'other': other.stem, **row}
            for row in _predicted(found, record.x, record.sample_rate, other_rpm / 60.0)
        ]
    return rows


def predict_train(number: int) -> list[dict[str, Any]]:
    """Fit a train of impacts at one speed and predict its shape at another."""
    rng, machine, _ = drawn_machine(number, 60)
    bearing = machine.bearing
    if machine.shaft_hz * SECONDS < TURNS:
        return []
    ratio = float(rng.choice(RATIOS))
    modes = drawn_modes(machine.sample_rate, rng)
    width = float(rng.uniform(1e-3, max(1.2e-3, widest(bearing))))
    low, high = load_range(bearing)
    sinking = interference(bearing, low * (high / low) ** rng.random())
    apart = impact_spacing(width, sinking, path_curvature(bearing, machine.place))
    heights, noise = (float(rng.uniform(0.4, 1.0)), -1.0), 10.0 ** rng.uniform(-2.0, -0.5)
    there = replace(machine, shaft_hz=machine.shaft_hz * ratio)
    records, level = [], 0.0
    for each in (machine, there):
        clean = ring(train(each, rng, [apart / each.speed], heights), each.sample_rate, modes)
        level = level or noise * float(clean.std())
        records.append(clean + level * rng.standard_normal(len(clean)))
    x, y = records
    found = fit(x, machine.sample_rate, bearing, machine.shaft_hz, place=machine.place)
    if found.twin_situation.place == 'none':
        return []
    # The impacts of a train do not change with its speed, so its level does not either.
    return [
        row | {'quantity': f'{row["quantity"]}, trains of impacts'}
        for row in _predicted(found, y, there.sample_rate, there.shaft_hz)
        if row['quantity'] not in ('rms', 'peak')
    ]


def _predicted(
    found: Calibration, x: NDArray[np.float64], rate: float, shaft_hz: float
) -> list[dict[str, Any]]:
    """Predict a machine at another speed, and measure its record ``x`` there."""
    expected = expect(found, shaft_hz=shaft_hz, candidates=32)
    longest = found.situation.longest_spacing * found.situation.shaft_hz / shaft_hz
    seen = features(x, rate, longest)
    return [
        {'quantity': name, 'truth': seen[name], 'q05': said.q05, 'median': said.median,
         'q95': said.q95}
        for name, said in expected.vibration.items() if math.isfinite(seen[name])
    ]  # fmt: skip


def _fitted(path: Path, rpm: float) -> Calibration:
    record = read_signal(path)
    unit = UNITS[path.stem.partition('_')[0]]
    return fit(record.x, record.sample_rate, find_bearing('6205'), rpm / 60.0, unit=unit)


def records(folder: Path, dataset: str) -> Iterator[tuple[Path, float, float]]:
    """Yield file, speed, 1/min, and width, mm, of the race faults and healthy records of a rig."""
    for row in json.loads((folder / 'index.json').read_text())['records']:
        known = row['label'] in ('inner', 'outer', 'healthy') and 'NTN' not in row['bearing_name']
        if row['dataset'] == dataset and known:
            width = row.get('fault_mm') or math.nan
            if row.get('fault_arc_deg'):
                width = math.radians(row['fault_arc_deg']) * RACES_MM[row['label']]
            yield folder / row['file'], float(row['rpm']), width
