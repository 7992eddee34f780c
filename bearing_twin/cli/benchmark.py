# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
``bearing-twin benchmark``: score the diagnosis on a folder of labelled records.

The folder has an ``index.json`` with ``bearings`` and ``records``, or it is a data set in the
Parquet form of the PyPI package ``bearing-datasets``. Of each bearing the index gives, by name,
n_elements, element_d_mm, pitch_d_mm and contact_deg; if n_elements is null, the geometry of the
most similar name is assumed and reported separately. A record has id, dataset, file, label, rpm
and bearing_name, which is one of ``bearings`` or of the catalogue, and, where known, rpm_nominal,
fault_mm and a Smith & Randall grade. Records are judged whole and in pieces; no record is used to
set anything.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
import difflib
from itertools import product, repeat
import json
import math
from pathlib import Path
import sys
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import Bearing, catalogue, find_bearing, named_bearing, PLACES
from bearing_twin.cli.arguments import file_name, processes, refuse_given
from bearing_twin.cli.terminal import progress
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.diagnosis.compilation import warm_up
from bearing_twin.diagnosis.rules.confidence import KINDS
from bearing_twin.errors import BearingTwinError
from bearing_twin.process import end_with_parent
from bearing_twin.recording.signals.dataset import (
    dataset_bearing,
    dataset_signals,
    fault_label,
    is_dataset,
)
from bearing_twin.recording.signals.signalfile import read_signal
from bearing_twin.studies.impact_machines import is_another
from bearing_twin.studies.output import print_table
from bearing_twin.studies.reliability import calibration_error
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.diagnosis import Diagnosis


OUTCOMES = ('correct', 'wrong', 'suspect', 'ambiguous', 'insufficient', 'missed')
"""Outcomes of a piece. A healthy one is ``correct`` if called healthy, ``wrong`` on an alarm."""

WINDOWS = (0.0, 1.0, 2.0, 4.0)
"""Lengths of the pieces, s; 0: the whole record."""

PIECES = 3
"""Largest number of pieces taken from the beginning of a record, at each length."""

NOMINAL_TOLERANCE = 0.05
"""Tolerance of a nominal speed; a measured one has the default tolerance."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One labelled record."""

    name: str
    path: str
    dataset: str
    label: str
    grade: str
    unit: str
    """The physical bearing: records of one bearing are not independent."""
    bearing: Bearing
    speeds: tuple[tuple[str, float], ...]
    """``('measured', Hz)`` and, where known, ``('nominal', Hz)``."""
    channel: str | None = None


@dataclass(frozen=True, kw_only=True)
class Piece:
    """Outcome of one piece of a record."""

    name: str
    window: float
    speed: str
    outcome: str
    result: str
    faults: tuple[str, ...]
    kind: str
    """Kind of answer to which the confidence belongs; '' if there is none."""
    confidence: float
    groups: tuple[tuple[str, str], ...]
    """(kind of group, name), e.g. ``('grade', 'Y1')``."""


OFF = (-0.05, -0.03, 0.03, 0.05)
"""Relative errors of the given speed, without a stated tolerance."""

SECONDS = 10.0
"""Longest part of a record that is judged, s."""

ANSWERS = ('the damaged place', 'another place', 'suspect', 'ambiguous', 'insufficient', 'healthy')

Judged = tuple[str, bool, str, bool]
"""Trial, whether the machine is damaged, the answer, and whether it is an alarm."""


def score_misled(case: Case) -> list[Judged]:
    """Return the verdicts with each other bearing of the catalogue, and at other speeds."""
    signal = read_signal(Path(case.path), channel=case.channel)
    x, shaft_hz = signal.x[: int(SECONDS * signal.sample_rate)], case.speeds[0][1]
    others = (other for other in catalogue().values() if is_another(other, case.bearing))
    trials = [('wrong bearing', other, shaft_hz) for other in others]
    trials += [('speed 3 and 5 % off', case.bearing, shaft_hz * (1.0 + off)) for off in OFF]
    judged = []
    for trial, given, hertz in trials:
        said = diagnose_record(x, signal.sample_rate, given, hertz)
        answer = said.result
        if answer in PLACES:
            answer = ANSWERS[0] if said.faults == (case.label,) else ANSWERS[1]
        judged.append((trial, case.label in PLACES, answer, said.level == 'fault'))
    return judged


def misled_rows(judged: Iterable[Judged]) -> list[tuple[object, ...]]:
    """Return the rows of the table: trial, machine, verdicts, each answer as a share, alarms."""
    told: dict[tuple[str, bool], Counter[str]] = {}
    for trial, damaged, answer, alarm in judged:
        count = told.setdefault((trial, damaged), Counter())
        count[answer] += 1
        count['alarm'] += alarm
    rows: list[tuple[object, ...]] = []
    for (trial, damaged), count in sorted(told.items(), reverse=True):
        total = sum(count[answer] for answer in ANSWERS)
        shares = (f'{count[a]} ({100.0 * count[a] / total:.1f} %)' for a in ANSWERS)
        rows.append((trial, 'damaged' if damaged else 'sound', total, *shares, count['alarm']))
    return rows


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        'folder',
        type=file_name,
        metavar='DATA_DIR',
        help='folder with an index.json, or made by bearing-datasets',
    )
    parser.add_argument('--json', action='store_true', help='one JSON object a piece')
    parser.add_argument('--full', action='store_true', help='whole records at measured speed only')
    parser.add_argument(
        '--misled', action='store_true', help='with wrong bearings and speeds instead'
    )
    parser.add_argument('--jobs', type=int, help='processes (default: one a core)')


def read_cases(folder: Path) -> list[Case]:
    """Return the labelled records of a folder; those with other labels are left out."""
    if is_dataset(folder):
        return _cases_of_dataset(folder)
    try:
        index = json.loads((folder / 'index.json').read_text('utf-8'))
        bearings = {
            name: _bearing(name, entry)
            for name, entry in index['bearings'].items()
            if entry.get('n_elements')
        }
        unknown = {
            name for name, entry in index['bearings'].items() if not entry.get('n_elements')
        }
        records = [r for r in index['records'] if r.get('label') in (*PLACES, 'healthy')]
        return [_case(folder, record, bearings, unknown) for record in records]
    except (
        OSError,
        ValueError,
        KeyError,
        TypeError,
        AttributeError,
        OverflowError,
        RecursionError,
    ) as error:
        reason = getattr(error, 'strerror', None) or error
        raise BearingTwinError(
            f'{folder / "index.json"} cannot be used ({reason}); give a folder made by '
            'bearing-datasets, or with an index as bearing_twin.cli.benchmark describes it'
        ) from error


def _bearing(name: str, entry: dict[str, Any]) -> Bearing:
    return Bearing(
        name=name,
        n_balls=int(entry['n_elements']),
        d_ball=entry['element_d_mm'] / 1e3,
        d_pitch=entry['pitch_d_mm'] / 1e3,
        contact_angle=math.radians(entry.get('contact_deg') or 0.0),
    )


def _case(
    folder: Path, record: dict[str, Any], bearings: dict[str, Bearing], unknown: set[str]
) -> Case:
    name, dataset = record['bearing_name'], record['dataset']
    if name in unknown and bearings:
        # An unpublished geometry is replaced by that of a similar name, and reported separately.
        close = difflib.get_close_matches(name, bearings, n=1, cutoff=0.0)
        bearing = bearings[close[0]]
        dataset = f'{dataset} (geometry assumed)'
    else:
        bearing = bearings.get(name) or _of_catalogue(name, record['id'], bearings)
    parts = (record['label'], record.get('fault_mm'), record.get('or_position'))
    unit = ' '.join(str(part) for part in (dataset, *parts) if part not in (None, ''))
    speeds = [('measured', record['rpm'] / 60.0)]
    if record.get('rpm_nominal'):
        speeds.append(('nominal', record['rpm_nominal'] / 60.0))
    return Case(
        name=record['id'],
        path=str(folder / record['file']),
        dataset=dataset,
        label=record['label'],
        grade=record.get('sr2015_grade_12kDE') or '',
        unit=unit,
        bearing=bearing,
        speeds=tuple(speeds),
    )


def _of_catalogue(name: str, record: str, bearings: dict[str, Bearing]) -> Bearing:
    try:
        return find_bearing(name)
    except BearingTwinError as error:
        close = ', '.join(difflib.get_close_matches(name, bearings, n=3, cutoff=0.3)) or 'none'
        msg = f'record {record}: {error}; the closest of index.json: {close}'
        raise BearingTwinError(msg) from None


def _cases_of_dataset(folder: Path) -> list[Case]:
    """Return the signals that have a known fault or none, a speed and a known bearing."""
    cases, without = [], Counter[str]()
    for row in dataset_signals(folder):
        label, name = fault_label(row), str(row['signal_id'])
        speed = row.get('speed_rpm')
        if not label or not isinstance(speed, (int, float)) or not speed > 0.0:
            without['a fault of ours or a constant speed'] += 1
            continue
        try:
            bearing = dataset_bearing(row) or named_bearing(str(row.get('bearing_model', '')))
        except BearingTwinError:
            without['a known bearing'] += 1
            continue
        dataset = str(row.get('dataset', folder.name))
        unit = str(row.get('bearing_id', f'{label} {row.get("fault_size_mm", "")}'.strip()))
        cases.append(
            Case(
                name=name,
                path=str(folder),
                channel=name,
                dataset=dataset,
                label=label,
                grade='',
                unit=f'{dataset} {unit}',
                bearing=bearing,
                speeds=(('measured', speed / 60.0),),
            )
        )
    for what, count in without.items():
        print(f'{count} signals are left out: they are without {what}', file=sys.stderr)
    if not cases:
        msg = f'{folder} has no signal with one fault of ours or none, a speed and a known bearing'
        raise BearingTwinError(msg)
    return cases


def judge(label: str, diagnosis: Diagnosis) -> str:
    """Return the outcome of a diagnosis; ``wrong`` if it names a fault that is not there."""
    if diagnosis.result == 'insufficient':
        return 'insufficient'
    if label == 'healthy':
        quiet = 'correct' if diagnosis.result == 'healthy' else diagnosis.result
        return 'wrong' if diagnosis.level == 'fault' else quiet
    if diagnosis.result == 'healthy':
        return 'missed'
    if diagnosis.result in ('suspect', 'ambiguous'):
        return diagnosis.result
    return 'correct' if diagnosis.faults == (label,) else 'wrong'


def score_case(case: Case, full: bool = False) -> list[Piece]:
    """Return the outcomes of all pieces of a record."""
    signal = read_signal(Path(case.path), channel=case.channel)
    groups = [('data set', case.dataset), ('class', f'{case.dataset} {case.label}')]
    # The record's own grade comes last, since JSON keeps the last group of a kind.
    if case.grade in ('Y1', 'Y2'):
        groups.append(('grade', 'Y1 and Y2 together'))
    groups += [('grade', f'{case.dataset} {case.grade}')] if case.grade else []
    groups += [('bearing', case.unit)]
    pieces = []
    for window in WINDOWS[:1] if full else WINDOWS:
        length = round(window * signal.sample_rate) or len(signal.x)
        for speed, shaft_hz in case.speeds[:1] if full else case.speeds:
            for number in range(min(len(signal.x) // length, PIECES)):
                diagnosis = diagnose_record(
                    signal.x[number * length : (number + 1) * length],
                    signal.sample_rate,
                    case.bearing,
                    shaft_hz,
                    speed_tolerance=NOMINAL_TOLERANCE if speed == 'nominal' else None,
                )
                pieces.append(
                    Piece(
                        name=case.name,
                        window=window,
                        speed=speed,
                        outcome=judge(case.label, diagnosis),
                        result=diagnosis.result,
                        faults=diagnosis.faults,
                        kind=diagnosis.kind,
                        confidence=diagnosis.confidence,
                        groups=tuple(groups),
                    )
                )
    return pieces


def run(args: argparse.Namespace) -> int:
    """Score all records and print tables in Markdown."""
    cases = read_cases(Path(args.folder))
    if not cases:
        msg = f'{args.folder} has no record with a label of {", ".join(PLACES)} or healthy'
        raise BearingTwinError(msg)
    if args.misled:
        refuse_given(args, ('json', 'full'), 'not with --misled, which has one table')
    # Compiled or loaded once, where it is reported; else each process would do it again.
    warm_up()
    jobs = processes(args.jobs, len(cases))
    with ProcessPoolExecutor(jobs, initializer=end_with_parent) as pool:
        if args.misled:
            judged: list[Judged] = []
            for done, of_record in enumerate(pool.map(score_misled, cases), start=1):
                judged += of_record
                progress(done, len(cases), 'records')
            heading = ('given', 'machine', 'verdicts', *ANSWERS, 'alarms')
            print_table(heading, misled_rows(judged))
            return 0
        scored = pool.map(score_case, cases, repeat(args.full))
        pieces = []
        for done, found in enumerate(scored, start=1):
            pieces += found
            progress(done, len(cases), 'records')
    if args.json:
        for piece in pieces:
            print(json.dumps({**vars(piece), 'groups': dict(piece.groups)}))
        return 0
    _summary(pieces)
    for kind in ('data set', 'class', 'grade', 'bearing'):
        whole = [p for p in pieces if p.window == 0.0 and p.speed == 'measured']
        _table(f'Whole records, measured speed, by {kind}', kind, whole)
    for speed in ('measured', 'nominal'):
        for window in WINDOWS:
            part = [p for p in pieces if p.window == window and p.speed == speed]
            if part and (window or speed != 'measured'):
                _table(f'{_length(window)}, {speed} speed, by class', 'class', part)
                _table(f'{_length(window)}, {speed} speed, by grade', 'grade', part)
    print('## Whole records, measured speed, not correct\n')
    for piece in pieces:
        if piece.window == 0.0 and piece.speed == 'measured' and piece.outcome != 'correct':
            said = '+'.join(piece.faults) or piece.result
            print(f'- {piece.name}, {_label(piece)}: {piece.outcome} ({piece.result}: {said})')
    return 0


def _length(window: float) -> str:
    return f'{window:g} s windows' if window else 'Whole records'


def _summary(pieces: list[Piece]) -> None:
    """Print the outcomes by length of the pieces, and the calibration of the confidence."""
    rows = []
    for speed, window in product(('measured', 'nominal'), WINDOWS):
        part = [p for p in pieces if p.window == window and p.speed == speed]
        sound = [p for p in part if _label(p) == 'healthy']
        graded = [p for p in part if ('grade', 'Y1 and Y2 together') in p.groups]
        groups = (
            ('Y1 and Y2', graded),
            ('damaged', [p for p in part if _label(p) != 'healthy']),
            ('healthy', sound),
        )
        for name, some in groups:
            count = Counter(piece.outcome for piece in some)
            cells = (count[outcome] or '' for outcome in OUTCOMES)
            if some:
                rows.append((f'{_length(window)}, {speed} speed', name, len(some), *cells))
    print('## Summary\n')
    print_table(('pieces of', 'machines', 'pieces', *OUTCOMES), rows)
    print('\n## Confidence, measured speed\n')
    print_table(
        ('answer', 'answers', 'mean confidence', 'share right', 'expected calibration error'),
        _confidence_rows([p for p in pieces if p.speed == 'measured']),
    )
    print()


def _label(piece: Piece) -> str:
    return dict(piece.groups)['class'].rsplit(' ', 1)[-1]


def _confidence_rows(pieces: list[Piece]) -> Iterator[tuple[object, ...]]:
    """Yield the calibration of the confidence by kind of answer; all answers have one weight."""
    told = [(p, _right(p)) for p in pieces if p.kind]
    for kind in (*KINDS, 'all'):
        part = [(p.confidence, right) for p, right in told if kind in (p.kind, 'all')]
        if part:
            said, right = np.array(part, dtype=float).T
            error = calibration_error(said, right)
            yield kind, len(part), f'{said.mean():.2f}', f'{right.mean():.2f}', f'{error:.3f}'


def _right(piece: Piece) -> bool:
    """Whether an answer is right in the sense of its confidence."""
    label = _label(piece)
    if piece.kind in ('healthy', 'elsewhere'):
        return (label == 'healthy') == (piece.kind == 'healthy')
    if piece.kind == 'suspect':
        return label != 'healthy'
    return piece.faults == (label,) if piece.kind == 'fault' else label in piece.faults


def _table(title: str, kind: str, pieces: Iterable[Piece]) -> None:
    counts: dict[str, Counter[str]] = {}
    for piece in pieces:
        for group, name in piece.groups:
            if group == kind:
                counts.setdefault(name, Counter())[piece.outcome] += 1
    print(f'## {title}\n')
    rows = (
        (name, count.total(), *(count[outcome] or '' for outcome in OUTCOMES))
        for name, count in sorted(counts.items())
    )
    print_table((kind, 'pieces', *OUTCOMES), rows)
    print()
