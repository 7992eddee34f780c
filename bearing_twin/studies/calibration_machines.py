# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Machines of known truth to which the study of calibrations fits the twin.

Twins whose unknowns come from the prior, and trains of impacts, which share nothing with the twin.
Bearing, sample rate, speed, place of the defect, gain and the resonances of the path are drawn at
random. And the records of two real rigs.
"""

from __future__ import annotations

import json
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import find_bearing
from bearing_twin.calibration import fit
from bearing_twin.calibration.cloud import Situation, unknowns, vibrations
from bearing_twin.calibration.passage import (
    impact_spacing,
    interference,
    load_range,
    path_curvature,
    widest,
)
from bearing_twin.calibration.path import noise_floor, resonances
from bearing_twin.calibration.posterior import weighted_quantile
from bearing_twin.calibration.whatif import expect, features
from bearing_twin.recording.foreign import read_signal
import numpy as np
from scipy import signal

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from bearing_twin.calibration import Calibration
    from numpy.typing import NDArray


BEARINGS = ('6203', '6204', '6205', '6206', '6208', '6305', '6308', '6310', '6313', '6220')
RATES = (12000.0, 20000.0, 25600.0, 51200.0, 64000.0, 100000.0)
RESONANCES_HZ = 2000.0, 12000.0
SECONDS = 3.0
UNITS = {'hitsm': '', 'cwru': 'g'}
"""Of the records, which do not say it."""
RACES_MM = {'inner': 15.55, 'outer': 23.5}
"""Radii of the races of HIT-SM, over which its slots are given in degrees."""


def drawn_machine(number: int, key: int) -> tuple[np.random.Generator, Situation]:
    """Bearing, rate, speed and place of a number."""
    rng = np.random.default_rng([2030, key, number])
    situation = Situation(
        bearing=find_bearing(str(rng.choice(BEARINGS))),
        place=str(rng.choice(('inner', 'outer'))),
        shaft_hz=float(rng.uniform(8.0, 35.0)),
        sample_rate=float(rng.choice(RATES)),
    )
    return rng, situation


def drawn_modes(
    rate: float, rng: np.random.Generator, *, count: tuple[int, int] = (1, 3),
    lowest: float = RESONANCES_HZ[0], most_damped: float = 0.06,
) -> list[tuple[float, ...]]:  # fmt: skip
    """Draw resonances: frequency, Hz, damping ratio and height of each."""
    highest = min(RESONANCES_HZ[1], 0.4 * rate)
    modes = [
        (rng.uniform(lowest, highest), rng.uniform(0.01, most_damped))
        for _ in range(rng.integers(count[0], count[1] + 1))
    ]
    return [(*mode, rng.uniform(0.3, 1.0)) for mode in modes]


def ring(
    x: NDArray[np.float64], rate: float, modes: list[tuple[float, ...]]
) -> NDArray[np.float64]:
    """Let resonances ring."""
    out = np.zeros_like(x)
    for hz, damping, height in modes:
        pole = np.exp(2.0 * np.pi * hz / rate * (1j * math.sqrt(1.0 - damping**2) - damping))
        rung = signal.lfilter([1.0], np.poly([pole, pole.conjugate()]).real, x)
        out += height * rung / rung.std()
    return out


def _gain(rng: np.random.Generator) -> float:
    return float(10.0 ** rng.uniform(-3.0, 3.0))


def row_of(found: Calibration, width: float) -> dict[str, Any]:
    """Return what is told of the width of a defect, mm, and where the truth lies in it."""
    told = found.quantities['defect_width_mm']
    inner = (math.nan, math.nan)
    rank = math.nan
    if found.defect != 'none':
        values = found.candidates['defect_width_mm']
        low, high = weighted_quantile(values, found.weights, (0.25, 0.75))
        inner = float(low), float(high)
        rank = float(found.weights[values < width].sum())
    return {
        'width': width, 'q05': told.q05, 'q25': inner[0], 'median': told.median, 'q75': inner[1],
        'q95': told.q95, 'identifiable': told.identifiable, 'why': told.why, 'rank': rank,
        'place': found.defect, 'bearing': found.situation.bearing.name,
        'rate': found.situation.sample_rate, 'spacing_mm': math.nan if found.impacts is None
        else 1e3 * found.impacts.spacing_s * found.situation.speed,
        'distance_before': found.distance_before, 'distance': found.distance,
        'level': found.level, 'cost_s': found.cost_s,
    }  # fmt: skip


def fit_twin(number: int) -> list[dict[str, Any]]:
    """Fit a record of a twin whose unknowns come from the prior, by `fit` as it is used."""
    rng, situation = drawn_machine(number, 0)
    truth = {name: u.place(rng.random(1)) for name, u in unknowns(situation).items()}
    x = next(vibrations(situation, truth, SECONDS, number + 1))[0]
    x = ring(x, situation.sample_rate, drawn_modes(situation.sample_rate, rng)) * _gain(rng)
    found = fit(
        x, situation.sample_rate, situation.bearing, situation.shaft_hz, place=situation.place,
        seed=number + 2,
    )  # fmt: skip
    return [row_of(found, float(truth['defect_width_mm'][0]))]


def fit_impacts(number: int, *, on_path: bool) -> list[dict[str, Any]]:
    """Fit pairs of impacts as far apart as the defect is wide, or as the path of a ball makes."""
    rng, situation = drawn_machine(number, 2 if on_path else 1)
    rate, bearing, place = situation.sample_rate, situation.bearing, situation.place
    width = float(rng.uniform(0.2e-3, widest(bearing)))
    low, high = load_range(bearing)
    sinking = interference(bearing, low * (high / low) ** rng.random()) if on_path else 0.0
    apart = impact_spacing(width, sinking, path_curvature(bearing, place)) / situation.speed
    x = train(situation, rng, [apart], (rng.uniform(0.4, 1.0), -1.0))
    y = ring(x, rate, drawn_modes(rate, rng)) * _gain(rng)
    y += 10.0 ** rng.uniform(-2.0, -0.5) * y.std() * rng.standard_normal(len(y))
    found = fit(y, rate, bearing, situation.shaft_hz, place=place, seed=number + 1)
    return [row_of(found, 1e3 * width)]


def train(
    machine: Situation, rng: np.random.Generator, apart_s: Sequence[float],
    shares: Sequence[float],
) -> NDArray[np.float64]:  # fmt: skip
    """Impacts of passages, and others some time after each, with their shares of its height."""
    rate, strikes = machine.sample_rate, machine.strikes
    count = int(1.2 * strikes * SECONDS)
    entries = np.cumsum(1.0 + 0.005 * rng.standard_normal(count)) / strikes
    heights = 1.0 + 0.3 * rng.standard_normal(count)
    if machine.place == 'inner':
        heights *= np.maximum(np.cos(2.0 * np.pi * machine.shaft_hz * entries), 0.0)
    x = np.zeros(int(SECONDS * rate))
    for after, share in zip((0.0, *apart_s), shares, strict=True):
        at = np.round((entries + after) * rate).astype(int)
        np.add.at(x, at[at < len(x)], share * heights[at < len(x)])
    return x


def fit_path(number: int) -> list[dict[str, Any]]:
    """
    Find resonances and floor of the path of a healthy machine: noise that rings, and white noise.

    The true floor is that of a minute of the machine.
    """
    rng, situation = drawn_machine(number, 3)
    rate = situation.sample_rate
    n = int(SECONDS * rate)
    modes = drawn_modes(rate, rng)
    y = ring(rng.standard_normal(20 * n), rate, modes) * _gain(rng)
    y += 10.0 ** rng.uniform(-3.0, -1.0) * y.std() * rng.standard_normal(len(y))
    low, middle, high = noise_floor(y[:n], rate)
    found = [
        {
            'quantity': 'noise floor',
            'truth': noise_floor(y, rate)[1],
            'q05': low,
            'median': middle,
            'q95': high,
        }
    ]
    for mode in resonances(y[:n], rate):
        near = min(modes, key=lambda each: abs(each[0] - mode.hz[1]))
        if mode.told:
            for quantity, truth, told in (
                ('frequency of a resonance', near[0], mode.hz),
                ('damping of a resonance', near[1], mode.damping),
            ):
                found.append(
                    {'quantity': quantity, 'truth': truth,
                     'q05': told[0], 'median': told[1], 'q95': told[2]}
                )  # fmt: skip
    return found


def fit_record(path: Path, rpm: float, width: float) -> list[dict[str, Any]]:
    """Fit a real record of a 6205 and say where its width lies, mm."""
    return [{'name': path.stem, **row_of(_fitted(path, rpm), width)}]


def fit_whatif(path: Path, rpm: float, others: list[tuple[Path, float]]) -> list[dict[str, Any]]:
    """Fit a record at one speed and predict the same machine at others."""
    found = _fitted(path, rpm)
    rows = []
    for other, other_rpm in others:
        hz = other_rpm / 60.0
        expected = expect(found, shaft_hz=hz, candidates=32)
        record = read_signal(other)
        longest = found.situation.longest * found.situation.shaft_hz / hz
        seen = features(record.x, record.sample_rate, longest)
        rows += [
            {'name': path.stem, 'other': other.stem, 'quantity': name, 'truth': seen[name],
             'q05': said.q05, 'median': said.median, 'q95': said.q95}
            for name, said in expected.vibration.items() if math.isfinite(seen[name])
        ]  # fmt: skip
    return rows


def _fitted(path: Path, rpm: float) -> Calibration:
    record = read_signal(path)
    unit = UNITS[path.stem.partition('_')[0]]
    return fit(record.x, record.sample_rate, find_bearing('6205'), rpm / 60.0, unit=unit)


def records(folder: Path, dataset: str) -> Iterator[tuple[Path, float, float]]:
    """File, speed in 1/min and width in mm of the race faults and healthy records of a rig."""
    for row in json.loads((folder / 'index.json').read_text())['records']:
        known = row['label'] in ('inner', 'outer', 'healthy') and 'NTN' not in row['bearing_name']
        if row['dataset'] == dataset and known:
            width = row.get('fault_mm') or math.nan
            if row.get('fault_arc_deg'):
                width = math.radians(row['fault_arc_deg']) * RACES_MM[row['label']]
            yield folder / row['file'], float(row['rpm']), width
