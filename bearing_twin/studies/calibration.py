# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
How far the intervals of a calibration hold: the tables of docs/calibration.md.

``python -m bearing_twin.studies.calibration OUT.json [TWINS IMPACTS PATHS UNSEEN] --data FOLDER``
fits the twin to machines drawn at random: twins whose unknowns come from the prior, behind
resonances at random (TWINS groups of 40, on which the spread was fixed, and UNSEEN others, each by
`fit` itself), trains of impacts, which share nothing with the twin, and noise behind resonances.
With the folder of the real recordings it also fits those of slots and spots of known width. No
interval was set by them but for what `calibration.posterior.RESOLVED` and
`calibration.refusals.RIVAL` say of CWRU.
"""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
import json
import math
import os
from pathlib import Path
import sys
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import fault_frequencies, find_bearing
from bearing_twin.calibration import fit
from bearing_twin.calibration.cloud import simulate, Situation, unknowns, vibrations
from bearing_twin.calibration.estimates import FOUND, TOLD
from bearing_twin.calibration.passage import contact_speed, widest
from bearing_twin.calibration.path import resonances
from bearing_twin.calibration.posterior import features, keep, weighted_quantile
from bearing_twin.calibration.refusals import NARROWED, unresolved, untold
from bearing_twin.calibration.summaries import summarise
from bearing_twin.recording.foreign import read_signal
from bearing_twin.studies.output import arguments, print_table, write_table
import numpy as np
from scipy import signal, stats

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from bearing_twin.calibration import Calibration
    from numpy.typing import NDArray

__all__ = ['find_resonances', 'fit_impacts', 'fit_record', 'fit_twins', 'main']

BEARINGS = ('6203', '6205', '6206', '6305')
RATES = (12000.0, 25600.0, 51200.0)
SECONDS = 3.0
CANDIDATES = 640
TWINS = 40
PASSAGES = 60.0
BINS = 10
"""Of the histogram of ranks."""
UNITS = {'hitsm': '', 'cwru': 'g'}
"""Of the records, which do not say it."""
RACES_MM = {'inner': 15.55, 'outer': 23.5}
"""Radii of the races of HIT-SM, over which its slots are given in degrees."""


def _machine(number: int, key: int) -> tuple[np.random.Generator, Situation]:
    """Bearing, rate, speed and place of a number."""
    rng = np.random.default_rng([2028, key, number])
    bearing = find_bearing(str(rng.choice(BEARINGS)))
    situation = Situation(
        bearing=bearing,
        place=str(rng.choice(('inner', 'outer'))),
        shaft_hz=float(rng.uniform(8.0, 35.0)),
        sample_rate=float(rng.choice(RATES)),
    )
    return rng, situation


def _ring(
    x: NDArray[np.float64], rate: float, rng: np.random.Generator
) -> tuple[NDArray[np.float64], list[tuple[float, float]]]:
    """Let one to three resonances ring; also return their frequencies and damping ratios."""
    out = np.zeros_like(x)
    modes = []
    for _ in range(rng.integers(1, 4)):
        hz, damping = float(rng.uniform(0.1, 0.4)) * rate, float(rng.uniform(0.01, 0.06))
        pole = np.exp(2.0 * np.pi * hz / rate * (1j * math.sqrt(1.0 - damping**2) - damping))
        rung = signal.lfilter([1.0], np.poly([pole, pole.conjugate()]).real, x)
        out += rng.uniform(0.3, 1.0) * rung / rung.std()
        modes.append((hz, damping))
    return out, modes


def _row(found: Calibration, width: float) -> dict[str, Any]:
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
        'place': found.defect, 'distance_before': found.distance_before,
        'distance': found.distance, 'level': found.level, 'cost_s': found.cost_s,
    }  # fmt: skip


def fit_twins(number: int) -> list[dict[str, Any]]:
    """
    Fit `TWINS` twins of one bearing, rate, speed and place, each behind resonances of its own.

    They share the candidates, which `fit` draws anew for each record, and have no second round of
    them, so that hundreds of twins take minutes.
    """
    rng, situation = _machine(number, 0)
    prior = unknowns(situation)
    drawn = {name: u.place(rng.random(CANDIDATES)) for name, u in prior.items()}
    rows = features(simulate(situation, drawn, number), situation)
    truth = {name: u.place(rng.random(TWINS)) for name, u in prior.items()}
    rate = situation.sample_rate
    strikes = fault_frequencies(situation.bearing, situation.shaft_hz).impacts(situation.place)
    found = []
    twins = (
        x for batch in vibrations(situation, truth, PASSAGES / strikes, number + 1) for x in batch
    )
    for index, x in enumerate(twins):
        start = time.process_time()
        y, modes = _ring(x, rate, rng)
        measured = summarise(y, rate, situation.longest)
        left = keep(drawn, rows, features([measured], situation)[0], prior)
        why = unresolved(measured) or untold(measured, left, situation, max(modes)[0])
        q05, q25, median, q75, q95 = map(
            float, left.quantiles('defect_width_mm', (0.05, 0.25, 0.5, 0.75, 0.95))
        )
        values = {name: float(value[index]) for name, value in truth.items()}
        found.append({
            'width': values['defect_width_mm'], 'q05': q05, 'q25': q25, 'median': median,
            'q75': q75, 'q95': q95, 'identifiable': not why, 'why': why,
            'rank': left.rank('defect_width_mm', values['defect_width_mm']),
            'place': situation.place, 'cost_s': time.process_time() - start,
            'ranks': {
                name: left.rank(name, value) for name, value in values.items()
                if name in TOLD and not why and left.narrowed(name) <= NARROWED
            },
        })  # fmt: skip
    return found


def fit_unseen(number: int) -> dict[str, Any]:
    """Fit a record of a twin whose unknowns come from the prior, by `fit` as it is used."""
    rng, situation = _machine(number, 5)
    rate = situation.sample_rate
    truth = {name: u.place(rng.random(1)) for name, u in unknowns(situation).items()}
    x = next(vibrations(situation, truth, SECONDS, number + 1))[0]
    found = fit(
        _ring(x, rate, rng)[0], rate, situation.bearing, situation.shaft_hz,
        place=situation.place, seed=number + 2,
    )  # fmt: skip
    return _row(found, float(truth['defect_width_mm'][0]))


def find_resonances(number: int) -> list[dict[str, float]]:
    """Find the resonances through which the noise of a healthy machine passes."""
    rng, situation = _machine(number, 2)
    rate = situation.sample_rate
    y, modes = _ring(rng.standard_normal(int(SECONDS * rate)), rate, rng)
    found = []
    for mode in resonances(y, rate):
        near = min(modes, key=lambda each: abs(each[0] - mode.hz[1]))
        if mode.found >= FOUND:
            found.append({
                'hz': near[0], 'low_hz': mode.hz[0], 'found_hz': mode.hz[1], 'high_hz': mode.hz[2],
                'damping': near[1], 'low_damping': mode.damping[0],
                'found_damping': mode.damping[1], 'high_damping': mode.damping[2],
            })  # fmt: skip
    return found


def fit_impacts(number: int) -> dict[str, Any]:
    """Fit a train of pairs of impacts that are as far apart as the defect is wide."""
    rng, situation = _machine(number, 1)
    rate, bearing = situation.sample_rate, situation.bearing
    width = float(rng.uniform(0.2e-3, widest(bearing)))
    strikes = fault_frequencies(bearing, situation.shaft_hz).impacts(situation.place)
    count = int(1.2 * strikes * SECONDS)
    entries = np.cumsum(1.0 + 0.005 * rng.standard_normal(count)) / strikes
    apart = width / contact_speed(bearing, situation.place, situation.shaft_hz)
    heights = 1.0 + 0.3 * rng.standard_normal(count)
    if situation.place == 'inner':
        heights *= np.maximum(np.cos(2.0 * np.pi * situation.shaft_hz * entries), 0.0)
    x = np.zeros(int(SECONDS * rate))
    for times, share in ((entries, rng.uniform(0.4, 1.0)), (entries + apart, -1.0)):
        at = np.round(times * rate).astype(int)
        np.add.at(x, at[at < len(x)], share * heights[at < len(x)])
    y, _ = _ring(x, rate, rng)
    y += 10.0 ** rng.uniform(-2.0, -0.5) * y.std() * rng.standard_normal(len(y))
    found = fit(
        y, rate, bearing, situation.shaft_hz, place=situation.place, seed=number + 1
    )  # fmt: skip
    return _row(found, 1e3 * width)


def fit_record(path: Path, rpm: float, width: float) -> dict[str, Any]:
    """Fit a real record of a 6205 and say where its width lies, mm."""
    record = read_signal(path)
    found = fit(
        record.x, record.sample_rate, find_bearing('6205'), rpm / 60.0,
        unit=UNITS[path.stem.partition('_')[0]],
    )  # fmt: skip
    return {'name': path.stem, **_row(found, width)}


def records(folder: Path) -> Iterator[tuple[Path, float, float]]:
    """File, speed in 1/min and width in mm of the race faults and healthy records of two rigs."""
    for row in json.loads((folder / 'index.json').read_text())['records']:
        known = row['label'] in ('inner', 'outer', 'healthy') and 'NTN' not in row['bearing_name']
        if row['dataset'] in ('hitsm', 'cwru') and known:
            width = row.get('fault_mm') or math.nan
            if row.get('fault_arc_deg'):
                width = math.radians(row['fault_arc_deg']) * RACES_MM[row['label']]
            yield folder / row['file'], float(row['rpm']), width


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Count how often intervals hold and how far medians are off."""
    faulty = [row for row in rows if math.isfinite(row['width']) and row['place'] != 'none']
    told = [row for row in faulty if row['identifiable']]
    wide = [row for row in told if row['width'] >= 0.5]

    def share(of: list[dict[str, Any]], low: str, high: str) -> float:
        return float(np.mean([row[low] <= row['width'] <= row[high] for row in of] or [math.nan]))

    ranks = [row['rank'] for row in told]
    counts = np.histogram(ranks, bins=BINS, range=(0.0, 1.0))[0]
    orders = [(row['width'], row['median']) for row in faulty]
    return {
        'faulty': len(faulty),
        'told': len(told),
        'within_90': share(told, 'q05', 'q95'),
        'within_50': share(told, 'q25', 'q75'),
        'within_90_all': share(faulty, 'q05', 'q95'),
        'within_50_all': share(faulty, 'q25', 'q75'),
        'median_error': float(
            np.median([abs(row['median'] / row['width'] - 1.0) for row in wide] or [math.nan])
        ),
        'ranks': [int(count) for count in counts],
        'chi_square_p': float(stats.chisquare(counts).pvalue) if len(told) else math.nan,
        'spearman': float(stats.spearmanr(orders).statistic) if len(orders) > 2 else math.nan,
        'cost_s': float(np.median([row['cost_s'] for row in rows])),
    }


def main(argv: Sequence[str] | None = None) -> None:
    """Write what was found and print the tables."""
    parser = arguments(sys.modules[__name__], writes=True)
    parser.add_argument('twins', type=int, nargs='?', default=12)
    parser.add_argument('impacts', type=int, nargs='?', default=60)
    parser.add_argument('paths', type=int, nargs='?', default=60)
    parser.add_argument('unseen', type=int, nargs='?', default=120)
    parser.add_argument('--data', type=Path, help='folder of the real recordings')
    parser.add_argument('--jobs', type=int, default=len(os.sched_getaffinity(0)))
    args = parser.parse_args(argv)
    real = list(records(args.data)) if args.data else []
    with ProcessPoolExecutor(args.jobs) as pool:
        found = {
            'HIT-SM': list(pool.map(fit_record, *zip(*_of('hitsm', real), strict=True)))
            if real
            else [],
            'CWRU': list(pool.map(fit_record, *zip(*_of('cwru', real), strict=True)))
            if real
            else [],
            'impact trains': list(pool.map(fit_impacts, range(args.impacts))),
            'twins, by fit': list(pool.map(fit_unseen, range(args.unseen))),
            'twins': [row for rows in pool.map(fit_twins, range(args.twins)) for row in rows],
        }
        modes = [row for rows in pool.map(find_resonances, range(args.paths)) for row in rows]
    tables: dict[str, Any] = {
        name: {**summary(rows), 'rows': rows} for name, rows in found.items() if rows
    }
    write_table(args.output, json.loads(json.dumps(tables).replace('NaN', 'null')))
    print_table(
        ('machines', 'faulty', 'told', 'in 90 %', 'in 50 %', 'error', 'p of ranks', 'Spearman',
         'cost, s'),
        (
            (name, t['faulty'], t['told'], f'{t["within_90"]:.2f}', f'{t["within_50"]:.2f}',
             f'{t["median_error"]:.3f}', f'{t["chi_square_p"]:.3f}', f'{t["spearman"]:.2f}',
             f'{t["cost_s"]:.1f}')
            for name, t in tables.items()
        ),
    )  # fmt: skip
    print()
    print_table(('quantity', 'machines', 'in 90 %', 'p of ranks'), _others(found['twins'], modes))
    for name in ('HIT-SM', 'CWRU') if real else ():
        print()
        print_table(
            ('record', 'width, mm', 'place', '5 %', '50 %', '95 %', 'told', 'why'),
            (
                (row['name'], f'{row["width"]:.2f}', row['place'], f'{row["q05"]:.2f}',
                 f'{row["median"]:.2f}', f'{row["q95"]:.2f}', row['identifiable'], row['why'])
                for row in found[name]
            ),
        )  # fmt: skip


def _others(
    twins: list[dict[str, Any]], modes: list[dict[str, float]]
) -> Iterator[tuple[object, ...]]:
    """Yield how often the intervals of the other quantities hold, where they are told."""
    for name in sorted({name for row in twins for name in row['ranks']}):
        yield name, *_held(np.array([row['ranks'][name] for row in twins if name in row['ranks']]))
    for name in ('hz', 'damping'):
        truth, low, high = (
            np.array([mode[prefix + name] for mode in modes]) for prefix in ('', 'low_', 'high_')
        )
        # Student's distribution of seven degrees of freedom has 90 % within 1.895 spreads.
        spread = np.maximum((high - low) / (2.0 * 1.895), 1e-12)
        yield f'resonance {name}', *_held(stats.t.cdf((truth - 0.5 * (low + high)) / spread, 7))


def _held(ranks: NDArray[np.float64]) -> tuple[object, ...]:
    """Return how many ranks there are, the share within 90 %, and whether they are uniform."""
    if not len(ranks):
        return 0, '', ''
    counts = np.histogram(ranks, bins=BINS, range=(0.0, 1.0))[0]
    inside = float(((ranks >= 0.05) & (ranks <= 0.95)).mean())
    return len(ranks), f'{inside:.2f}', f'{stats.chisquare(counts).pvalue:.3f}'


def _of(dataset: str, real: list[tuple[Path, float, float]]) -> list[tuple[Path, float, float]]:
    return [task for task in real if task[0].stem.startswith(dataset)]


if __name__ == '__main__':
    main()
