# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Coverage of the intervals of a calibration: all tables of docs/calibration.md.

``python -m bearing_twin.studies.calibration OUT.jsonl --data FOLDER`` fits the twin to machines of
known truth (:mod:`bearing_twin.studies.calibration_machines`) and adds a line to OUT.jsonl for
each. An interrupted run continues where it stopped, and longer runs add to shorter ones. Then it
prints the tables of all lines. These machines set no interval, except CWRU: see
`RESOLVED` and `RIVAL` of `measured.summaries`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import as_completed, ProcessPoolExecutor
import functools
from itertools import zip_longest
import json
import math
import os
from pathlib import Path
import sys
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.studies import calibration_machines as machines
from bearing_twin.studies.calibration_speeds import KINDS, look_at_speeds
from bearing_twin.studies.output import arguments, print_table, read_lines
import numpy as np
from scipy import stats

if TYPE_CHECKING:
    Row = dict[str, Any]
    Task = tuple[str, str, Callable[..., list[Row]], tuple[Any, ...]]
    Table = tuple[Sequence[str], Iterable[Sequence[object]]]


BINS = 10
"""Bins of the histogram of ranks."""
SPEEDS = 'at several speeds: '
SIMULATED: dict[str, Callable[[int], list[Row]]] = {
    'twins': machines.fit_twin,
    'impacts at the edges': functools.partial(machines.fit_impacts, kind='edges'),
    "impacts of a ball's path": functools.partial(machines.fit_impacts, kind='path'),
    'impacts of a defect too wide': functools.partial(machines.fit_impacts, kind='wide'),
    'paths': machines.fit_path,
    'healthy': machines.look_at_healthy,
    'what if, trains of impacts': machines.predict_train,
    **{SPEEDS + kind: functools.partial(look_at_speeds, kind) for kind in KINDS},
}


def tasks(count: int, data: Path | None) -> Iterator[Task]:
    """Yield group, name, function and arguments of each machine, the groups in turn."""
    groups: list[list[Task]] = [
        [(group, str(number), function, (number,)) for number in range(count)]
        for group, function in SIMULATED.items()
    ]
    if data:
        slots, spots = (list(machines.records(data, name)) for name in ('hitsm', 'cwru'))
        groups.append([('HIT-SM', each[0].stem, machines.fit_record, each) for each in slots])
        groups.append([('CWRU', each[0].stem, machines.fit_record, each) for each in spots])
        wide = [each[:2] for each in slots if each[2] > 1.0]
        groups.append([
            ('what if', path.stem, machines.fit_whatif, (path, rpm, [
                other for other in wide if other[0] != path
                and other[0].stem.rpartition('_')[0] == path.stem.rpartition('_')[0]
            ]))
            for path, rpm in wide
        ])  # fmt: skip
    for turn in zip_longest(*groups):
        yield from filter(None, turn)


def summary(rows: Sequence[Row]) -> Row:
    """
    Count how often intervals hold and how far medians are off.

    Parameters
    ----------
    rows
        ``width``, ``q05``, ``q25``, ``median``, ``q75``, ``q95``, ``own_q05``, ``own_q95``,
        ``rank``, ``identifiable`` and ``place`` of each machine.

    """
    faulty = [row for row in rows if math.isfinite(row['width']) and row['place'] != 'none']
    identifiable = [row for row in faulty if row['identifiable']]
    wide = [row for row in identifiable if row['width'] >= 0.5]
    counts = np.histogram([row['rank'] for row in identifiable], bins=BINS, range=(0.0, 1.0))[0]
    orders = [(row['width'], row['median']) for row in faulty]
    return {
        'faulty': len(faulty),
        'identifiable': len(identifiable),
        'within_90': _share(identifiable, 'q05', 'q95'),
        'within_90_own': _share(identifiable, 'own_q05', 'own_q95'),
        'within_50': _share(identifiable, 'q25', 'q75'),
        'within_90_all': _share(faulty, 'q05', 'q95'),
        'median_error': float(
            np.median([abs(row['median'] / row['width'] - 1.0) for row in wide] or [math.nan])
        ),
        'ranks': [int(count) for count in counts],
        'chi_square_p': float(stats.chisquare(counts).pvalue) if len(identifiable) else math.nan,
        'spearman': float(stats.spearmanr(orders).statistic) if len(orders) > 2 else math.nan,
    }


def _share(of: Sequence[Row], low: str, high: str, truth: str = 'width') -> float:
    return float(np.mean([row[low] <= row[truth] <= row[high] for row in of] or [math.nan]))


def main(argv: Sequence[str] | None = None) -> None:
    """Fit the machines that are not in the file yet, and print the tables."""
    parser = arguments(__name__, writes=True)
    parser.add_argument('count', type=int, nargs='?', default=100, help='of each simulated group')
    parser.add_argument('--data', type=Path, help='folder of the real recordings')
    parser.add_argument('--jobs', type=int, default=len(os.sched_getaffinity(0)))
    args = parser.parse_args(argv)
    lines = read_lines(args.output)
    done = {(line['group'], line['name']) for line in lines}
    left = [task for task in tasks(args.count, args.data) if task[:2] not in done]
    with ProcessPoolExecutor(args.jobs) as pool, args.output.open('a', encoding='utf-8') as out:
        running = {pool.submit(task[2], *task[3]): task[:2] for task in left}
        for future in as_completed(running):
            group, name = running[future]
            try:
                lines.append({'group': group, 'name': name, 'rows': future.result()})
            except BearingTwinError as error:
                # Continue with the others; a later run tries this one again.
                print(f'{group}, {name}: {error}', file=sys.stderr, flush=True)
                continue
            print(json.dumps(lines[-1]), file=out, flush=True)
    print_tables(lines)


def print_tables(lines: Iterable[Row]) -> None:
    """Print the tables of docs/calibration.md."""
    groups: dict[str, list[Row]] = {}
    for line in sorted(lines, key=lambda line: line['name']):
        groups.setdefault(line['group'], []).extend(line['rows'])
    for number, (heading, rows) in enumerate(_tables(groups)):
        if number:
            print()
        print_table(heading, rows)


def _tables(groups: dict[str, list[Row]]) -> Iterator[Table]:
    """Yield the headings and rows of all tables."""
    fits = [
        name
        for name in ('HIT-SM', 'CWRU', *SIMULATED)
        if name in groups and not name.startswith(('paths', 'healthy', 'what if', SPEEDS))
    ]
    yield (
        ('width of a race defect', 'machines', 'identifiable', 'in 90 %, identifiable',
         'of the twin alone', 'in 90 %, all', 'in 50 %, identifiable',
         'median error from 0.5 mm', 'Spearman', 'ranks in ten bins', 'p of uniform ranks'),
        (_widths(name, groups[name]) for name in fits),
    )  # fmt: skip
    paths = groups.get('paths', [])
    yield (
        ('noise floor', 'compared', 'in 90 %', 'median error', 'ranks in ten bins',
         'p of uniform ranks'),
        _floors([row for row in paths if 'quantity' in row]),
    )  # fmt: skip
    yield (
        ('strongest resonance', 'found', 'within the width of one of the path'),
        _resonances([row for row in paths if 'resonance' in row]),
    )
    yield (
        ('confidence', 'healthy machines', 'limit, mm: median', 'most', 'wider defects added',
         'shown', 'named by the diagnosis', 'called healthy'),
        _healthy(groups.get('healthy', [])),
    )  # fmt: skip
    yield (
        ('predicted', 'compared', 'in 90 %', 'median error'),
        _quantities([row for name in groups if name.startswith('what') for row in groups[name]]),
    )
    yield (
        ('machines at two or three speeds', 'compared', 'passage proved', 'in 90 %',
         'median error'),
        _speeds(groups),
    )  # fmt: skip
    yield (
        ('sample rate, kHz', 'fits', 'processor time, s: median', 'most'),
        _costs([row for name in fits for row in groups[name]]),
    )
    slots = [row for row in groups.get('HIT-SM', []) if math.isfinite(row['width'])]
    speeds = sorted({row['name'].rpartition('_')[2] for row in slots}, key=int)
    heading = ('slot of HIT-SM, mm', *(f'{speed} 1/min' for speed in speeds))
    yield heading, _by_slot(slots, speeds)
    for name in ('HIT-SM', 'CWRU'):
        yield (
            ('record', 'width, mm', 'place', '5 %', '50 %', '95 %', 'identifiable',
             'distance before, after, dB', 'level after, dB', 'why'),
            map(_record, groups.get(name, [])),
        )  # fmt: skip


def _widths(name: str, rows: Sequence[Row]) -> tuple[object, ...]:
    """Return how often the intervals of a group's widths hold, in words."""
    s = summary(rows)
    return (
        name, s['faulty'], s['identifiable'], f'{s["within_90"]:.2f}',
        f'{s["within_90_own"]:.2f}', f'{s["within_90_all"]:.2f}', f'{s["within_50"]:.2f}',
        f'{100.0 * s["median_error"]:.1f} %', f'{s["spearman"]:.2f}',
        ', '.join(map(str, s['ranks'])), f'{s["chi_square_p"]:.3f}',
    )  # fmt: skip


def _record(row: Row) -> tuple[object, ...]:
    """Return the estimated width of a record, in words."""
    return (
        row['name'], f'{row["width"]:.2f}', row['place'], f'{row["q05"]:.2f}',
        f'{row["median"]:.2f}', f'{row["q95"]:.2f}', row['identifiable'],
        f'{row["distance_before"]:.1f}, {row["distance"]:.1f}', f'{row["level"]:.1f}', row['why'],
    )  # fmt: skip


def _by_slot(rows: Iterable[Row], speeds: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """Yield the estimated widths of each slot, from the slowest speed to the fastest."""
    named = {row['name']: row for row in rows}
    for slot in sorted({name.rpartition('_')[0] for name in named}):
        of = [named[f'{slot}_{speed}'] for speed in speeds if f'{slot}_{speed}' in named]
        said = (f'{row["median"]:.2f} ({row["q05"]:.2f} to {row["q95"]:.2f})' for row in of)
        yield (
            f'{of[0]["place"]} {of[0]["width"]:.2f}',
            *(each if row['identifiable'] else f'not identifiable, {each}'
              for row, each in zip(of, said, strict=True)),
        )  # fmt: skip


def _floors(rows: list[Row]) -> Iterator[tuple[object, ...]]:
    """Yield how often the intervals of noise floors hold, and the ranks of the true floors."""
    for name, compared, held, error in _quantities(
        rows + [row | {'quantity': 'all'} for row in rows]
    ):
        ranks = [row['rank'] for row in rows if name in ('all', row['quantity'])]
        counts = np.histogram(ranks, bins=BINS, range=(0.0, 1.0))[0]
        yield (name, compared, held, error, ', '.join(map(str, counts)),
               f'{stats.chisquare(counts).pvalue:.3f}')  # fmt: skip


def _resonances(rows: Sequence[Row]) -> Iterator[tuple[object, ...]]:
    for kind in sorted({row['resonance'] for row in rows}):
        own = [row['own'] for row in rows if row['resonance'] == kind]
        yield kind, len(own), sum(own)


def _healthy(rows: Sequence[Row]) -> Iterator[tuple[object, ...]]:
    """Yield how many defects wider than the limit of a healthy machine show."""
    records = [row for row in rows if 'limit' in row]
    limited = [row for row in records if math.isfinite(row['limit'])]
    for confidence in sorted({row['confidence'] for row in limited}, reverse=True):
        limits = [row['limit'] for row in limited if row['confidence'] == confidence]
        for kind in ('twins', 'trains of impacts'):
            of = [
                row for row in rows
                if row.get('added') == kind and row['confidence'] == confidence
            ]  # fmt: skip
            counts = (sum(row[name] for row in of) for name in ('shown', 'told', 'healthy'))
            yield (
                f'{confidence:.0%}', len(limits), f'{np.median(limits):.2f}',
                f'{max(limits):.1f}', f'{len(of)} {kind}', *counts,
            )  # fmt: skip
    yield 'no limit', len(records) - len(limited), *[''] * 6


def _quantities(rows: Sequence[Row]) -> Iterator[tuple[object, ...]]:
    """Yield how often the intervals of quantities hold, and how far their medians are off."""
    for name in sorted({row['quantity'] for row in rows}):
        of = [row for row in rows if row['quantity'] == name]
        errors = [abs(row['median'] / row['truth'] - 1.0) for row in of]
        held = _share(of, 'q05', 'q95', 'truth')
        yield name, len(of), f'{held:.2f}', f'{100.0 * np.median(errors):.1f} %'


def _speeds(groups: dict[str, list[Row]]) -> Iterator[tuple[object, ...]]:
    """Yield how often a passage was proved, and coverage and error of its width."""
    for kind in KINDS:
        rows = groups.get(SPEEDS + kind, [])
        proved = [row for row in rows if row['proved']]
        errors = [abs(row['median'] / row['width'] - 1.0) for row in proved]
        passage = proved and not kind.startswith(('echoes', 'gear'))
        yield (
            kind, f'{sum(row["compared"] for row in rows)} of {len(rows)}', len(proved),
            f'{_share(proved, "q05", "q95"):.2f}' if passage else '',
            f'{100.0 * np.median(errors):.0f} %' if passage else '',
        )  # fmt: skip


def _costs(rows: Sequence[Row]) -> Iterator[tuple[object, ...]]:
    for rate in sorted({row['rate'] for row in rows}):
        costs = [row['cost_s'] for row in rows if row['rate'] == rate]
        yield f'{rate / 1e3:.1f}', len(costs), f'{np.median(costs):.1f}', f'{max(costs):.1f}'


if __name__ == '__main__':
    main()
