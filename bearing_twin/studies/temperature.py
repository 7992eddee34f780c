# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Effect of temperature on the level of a healthy bearing, and benefit of its correction.

``python -m bearing_twin.studies.temperature prior`` simulates healthy bearings in the physical
mode and prints the change of their level: the prior of
:mod:`bearing_twin.diagnosis.machine.dependence`. ``coverage`` draws machines with that prior and
prints how often the learnt 90 % interval contains the true slope. ``runs DATA`` prints false
onsets and lead times of the FEMTO runs to failure in DATA without correction, with the prior
alone, and with the dependence learnt from each run.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product
import math
from pathlib import Path
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.diagnosis.machine.dependence import (
    Condition,
    fit_law,
    HealthyRecord,
    Law,
    PER_KELVIN,
    Slope,
    Z90,
)
from bearing_twin.diagnosis.machine.level import SUSPECT_DB
from bearing_twin.diagnosis.series.alone import CONFIRMING
from bearing_twin.diagnosis.series.monitor import SeriesMonitor
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.dynamics import preset, Simulator
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.signals.snapshots import read_snapshots
from bearing_twin.studies.disturbances import with_memory
from bearing_twin.studies.output import arguments, print_table
import numpy as np
from scipy.signal import lfilter

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from bearing_twin.dynamics.parameters import TwinParameters
    from bearing_twin.recording.signals.snapshots import Snapshot


RATE = 25600.0
SPEEDS = (15.0, 30.0)
HEATS = (30.0, 60.0, 90.0, 110.0)
LOADS = (500.0, 2000.0, 4000.0)
CLEARANCES = (0.0, 5e-6, 10e-6)

PHYSICAL = Law(Slope(PER_KELVIN[0], 0.0, -math.inf, math.inf, known=True))
"""The mean of the prior, applied as if it were known."""
LAWS = {'none': Law(), 'physical mode': PHYSICAL, 'learnt': None}


def simulated_slopes() -> tuple[np.ndarray, np.ndarray]:
    """
    Return change of level with temperature, dB/K, and with speed, dB per doubling, of each twin.

    Their surfaces are perfect. The vibration of wavy surfaces changes by about 0.01 dB/K or less,
    so that these are the largest changes of a healthy bearing in the physical mode.
    """
    slopes, octaves = [], []
    for load, clearance in product(LOADS, CLEARANCES):
        twin = replace(
            preset('incipient', bearing='6307-catalogue', defect='none', thermal_mode='physical'),
            load=load, clearance=clearance, noise=0.0, waviness=0.0,
        )  # fmt: skip
        levels = np.array([[_level(twin, hertz, heat) for heat in HEATS] for hertz in SPEEDS])
        slopes += [np.polyfit(HEATS, row, 1)[0] for row in levels]
        octaves += list((levels[1] - levels[0]) / math.log2(SPEEDS[1] / SPEEDS[0]))
    return np.array(slopes), np.array(octaves)


def _level(twin: TwinParameters, hertz: float, heat: float) -> float:
    simulator = Simulator(twin, sample_rate=RATE, seed=1, temperature=heat, shaft_hz=hertz)
    simulator.advance(int(0.5 * RATE), heat, hertz)
    y = simulator.advance(int(4.0 * RATE), heat, hertz).y.astype(float)
    return 20.0 * math.log10(float(y.std()))


def print_prior() -> None:
    """Print median and spread of the simulated slopes."""
    rows = zip(('dB/K', 'dB per doubling of speed'), simulated_slopes(), strict=True)
    print_table(
        ('change of level', 'median', 'half of 16 to 84 %', 'from', 'to'),
        (
            (name, f'{np.median(found):+.3f}',
             f'{0.5 * np.diff(np.quantile(found, (0.16, 0.84)))[0]:.3f}',
             f'{found.min():+.3f}', f'{found.max():+.3f}')
            for name, found in rows
        ),
    )  # fmt: skip


def print_coverage() -> None:
    """Print how often the interval of a learnt slope contains the true one."""
    rng = np.random.default_rng(0)
    print_table(
        ('temperature', 'memory, rows', 'interval holds', 'known', 'holds where known'),
        (_coverage(rng, shape, memory)
         for shape, memory in product(('one warm-up', 'days'), (1, 10, 40))),
    )  # fmt: skip


def _coverage(rng: np.random.Generator, shape: str, memory: int) -> tuple[object, ...]:
    count, held = 240, []
    time = np.arange(count)
    for _ in range(200):
        noise = with_memory(rng.standard_normal(2 * count), memory)
        heat = 90.0 - 50.0 * np.exp(-time / 40.0)
        if shape == 'days':
            heat = 70.0 + 12.0 * np.sin(2.0 * np.pi * time / 100.0)
            heat += lfilter([0.6], [1.0, -0.95], rng.standard_normal(count))
        slope = rng.normal(*PER_KELVIN)
        level = slope * heat + 0.6 * noise[count:] + rng.normal(0.0, 2.0) * time / count
        # A few minutes are disturbed.
        level[rng.random(count) < 0.03] += 8.0
        found = fit_law(level, heat, np.full(count, 4.5)).temperature
        held.append((abs(found.mean - slope) <= Z90 * found.deviation, found.known))
    inside, known = np.array(held).T
    share = f'{inside[known].mean():.0%} of {known.sum()}' if known.any() else '-'
    return shape, memory, f'{inside.mean():.0%}', f'{known.mean():.0%}', share


class Onset(NamedTuple):
    """Result of a run with one correction."""

    early: int
    """Alarms that begin in the first half of the life."""
    lead: float
    """Hours from the start of the alarm that lasts to the end; NaN if none does."""
    correction: float
    """Largest correction, dB."""


def run_table(data: Path) -> Iterator[tuple[object, ...]]:
    """Yield a row per run and kind of baseline: onsets uncorrected, with prior, and learnt."""
    folder = data / 'femto'
    files = [path for path in sorted(folder.glob('femto_*.npz')) if 'trend' not in path.stem]
    if not files:
        raise BearingTwinError(f'{folder} holds no femto_*.npz; name the folder that holds femto/')
    for path in files:
        run = path.stem.removeprefix('femto_Bearing')
        trend = folder / f'{path.stem[:-1]}trend.npz'
        snapshots = list(read_snapshots([path, trend]))
        for way, judge in (('settled', _settled), ('first 10 min', _at_once)):
            found = [judge(snapshots, law) for law in LAWS.values()]
            yield (run.replace('_H', ' H').replace('_V', ' V'), way,
                   *(said.early for said in found), *(f'{said.lead:.2f}' for said in found),
                   f'{found[-1].correction:.1f}')  # fmt: skip


def _settled(snapshots: list[Snapshot], law: Law | None) -> Onset:
    """Judge like ``--series``: the baseline is that of the settled machine."""
    monitor = SeriesMonitor(None, law=law)
    for snap in snapshots:
        signal = snap.signal
        monitor.add(snap.time, signal.x, signal.sample_rate, signal.shaft_hz,
                    temperature=signal.temperature)  # fmt: skip
    points = monitor.report().points
    alarms = np.array([point.level in ('suspect', 'fault') for point in points])
    times = np.array([point.time for point in points])
    return _onset(times, alarms, max(abs(point.correction) for point in points))


def _at_once(snapshots: list[Snapshot], law: Law | None) -> Onset:
    """Judge like a stream: the baseline is that of the first snapshots, however cold."""
    wanted = DiagnosisSettings().baseline_windows
    record, levels, conditions = HealthyRecord(), [], []
    over, alarms, largest = [], [], 0.0
    for snap in snapshots:
        x = snap.signal.x
        levels.append(20.0 * math.log10(float(np.std(x))))
        conditions.append(Condition.at(snap.signal.temperature, snap.signal.shaft_hz))
        if len(levels) <= wanted:
            base = Condition(*np.median(conditions, axis=0))
            floor = float(np.median(levels))
        used = law or next(iter(record.laws()), Law())
        change, deviation = used.correct(conditions[-1], base)
        largest = max(largest, abs(change))
        over.append(levels[-1] - change - Z90 * deviation - floor)
        alarms.append(float(np.median(over[-CONFIRMING:])) >= SUSPECT_DB)
        if not alarms[-1]:
            record.add([levels[-1]], conditions[-1])
    return _onset(np.array([snap.time for snap in snapshots]), np.array(alarms), largest)


def _onset(times: np.ndarray, alarms: np.ndarray, correction: float) -> Onset:
    begins = np.flatnonzero(np.diff(alarms.astype(int), prepend=0) == 1)
    lead = (times[-1] - times[begins[-1]]) / 3600.0 if alarms[-1] else math.nan
    return Onset(int((times[begins] < 0.5 * times[-1]).sum()), lead, correction)


def main(argv: Sequence[str] | None = None) -> None:
    """Print the table that is asked for."""
    parser = arguments(__name__)
    parser.add_argument('what', choices=('prior', 'coverage', 'runs'))
    parser.add_argument('data', type=Path, nargs='?', help='folder that holds femto/, for runs')
    args = parser.parse_args(argv)
    if args.what == 'prior':
        print_prior()
    elif args.what == 'coverage':
        print_coverage()
    elif args.data is None:
        parser.error('runs needs the folder of the data')
    else:
        onsets = [f'false onsets, {law}' for law in LAWS] + [f'lead h, {law}' for law in LAWS]
        print_table(('run', 'baseline', *onsets, 'largest dB learnt'), run_table(args.data))


if __name__ == '__main__':
    main()
