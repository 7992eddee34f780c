# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin diagnose``: verdicts on vibration files, one line a file."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass
import json
import math
import os
from pathlib import Path
import sys
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import Bearing, find_bearing, own_bearing
from bearing_twin.diagnosis import diagnose_record, Diagnosis, DiagnosisSettings
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.foreign import read_signal

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator, Sequence

__all__ = ['Task', 'configure', 'diagnose_file', 'evidence', 'run']


@dataclass(frozen=True, kw_only=True)
class Task:
    """One file and how to read it; small and picklable, so that it can be sent anywhere."""

    path: str
    bearing: Bearing | None = None
    shaft_hz: float = math.nan
    speed_tolerance: float | None = None
    sample_rate: float | None = None
    channel: str | None = None
    unit: str = ''
    plot: str = ''
    """File for the picture; empty for none."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument('files', nargs='+', metavar='FILE', help='.npz .mat .wav .csv .mcap')
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument('--bearing', metavar='NAME', help='bearing of the catalogue, e.g. 6205')
    kind.add_argument(
        '--geometry',
        metavar='Z,D_BALL_MM,D_PITCH_MM,ANGLE_DEG',
        help='number of balls, ball and pitch diameter in mm, contact angle in degrees',
    )
    parser.add_argument('--shaft-hz', type=float, help='shaft speed, Hz; else what the file says')
    parser.add_argument(
        '--speed-tolerance',
        type=float,
        metavar='FRACTION',
        help='how far the speed may be off (default 0.02: a nameplate)',
    )
    parser.add_argument('--sample-rate', type=float, help='Hz, for files that do not say it')
    parser.add_argument('--channel', help='which channel of a file: name, number, topic')
    parser.add_argument('--unit', default='', help="'m/s^2' or 'g', for files that do not say it")
    parser.add_argument('--json', action='store_true', help='one JSON object a line')
    parser.add_argument('--jobs', type=int, help='processes (default: one a core)')
    parser.add_argument('--dask', metavar='ADDRESS', help='spread the work over a Dask cluster')
    parser.add_argument('--plot', metavar='DIR', help='draw the spectra with fault cursors')


def run(args: argparse.Namespace) -> int:
    """Diagnose the files; 0 only if every file could be read."""
    bearing = None
    if args.geometry:
        bearing = own_bearing(args.geometry)
    elif args.bearing:
        bearing = find_bearing(args.bearing)
    if args.speed_tolerance is not None:
        DiagnosisSettings(speed_tolerance=args.speed_tolerance)
    if args.jobs is not None and args.jobs < 1:
        msg = f'--jobs {args.jobs}: at least one process is needed'
        raise BearingTwinError(msg)
    if args.shaft_hz is not None and not 0.0 < args.shaft_hz < 1e5:
        msg = f'--shaft-hz {args.shaft_hz}: give a positive speed in Hz (rpm / 60)'
        raise BearingTwinError(msg)
    if args.plot:
        Path(args.plot).mkdir(parents=True, exist_ok=True)
    tasks = [
        Task(
            path=name,
            bearing=bearing,
            shaft_hz=math.nan if args.shaft_hz is None else args.shaft_hz,
            speed_tolerance=args.speed_tolerance,
            sample_rate=args.sample_rate,
            channel=args.channel,
            unit=args.unit,
            plot=str(_picture(Path(args.plot), name)) if args.plot else '',
        )
        for name in args.files
    ]
    unread = 0
    for done, answer in enumerate(_answers(tasks, args), start=1):
        unread += not answer.pop('read')
        print(json.dumps(answer) if args.json else _line(answer), flush=True)
        if len(tasks) > 1 and sys.stderr.isatty():
            print(f'\r{done} of {len(tasks)} ', end='', file=sys.stderr, flush=True)
    return 1 if unread else 0


def _answers(tasks: Sequence[Task], args: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Answers in the order of the tasks."""
    if args.dask:
        return _on_dask(tasks, args.dask)
    jobs = min(args.jobs or len(os.sched_getaffinity(0)), len(tasks))
    return map(diagnose_file, tasks) if jobs == 1 else _on_cores(tasks, jobs)


def _on_cores(tasks: Sequence[Task], jobs: int) -> Iterator[dict[str, Any]]:
    with ProcessPoolExecutor(jobs) as pool:
        futures = [pool.submit(diagnose_file, task) for task in tasks]
        for task, future in zip(tasks, futures, strict=True):
            failure = future.exception()
            if isinstance(failure, BrokenProcessPool):
                text = 'the process that read it was killed; is there enough memory? try --jobs 1'
                yield _unread(task.path, text)
            else:
                yield future.result()


def _on_dask(tasks: Sequence[Task], address: str) -> Iterator[dict[str, Any]]:
    try:
        from dask.distributed import Client
    except ImportError:
        msg = "--dask needs Dask: pip install 'bearing_twin[dask]'"
        raise BearingTwinError(msg) from None
    try:
        client = Client(address, timeout='10s')
    except (OSError, ValueError) as error:
        msg = f'no Dask scheduler at {address}: {error}'
        raise BearingTwinError(msg) from None
    with client:
        # A worker that dies takes no file with it: the scheduler gives its files to another.
        futures = client.map(diagnose_file, tasks, pure=False, retries=3)
        for task, future in zip(tasks, futures, strict=True):
            failure = future.exception()
            yield future.result() if failure is None else _unread(task.path, str(failure))


def diagnose_file(task: Task) -> dict[str, Any]:
    """Answer for one file; never raises for what is in the file."""
    try:
        signal = read_signal(Path(task.path), channel=task.channel, sample_rate=task.sample_rate)
        bearing = task.bearing or _known_bearing(signal.bearing_name)
        shaft_hz = signal.speeds if len(signal.speeds) else signal.shaft_hz
        if math.isfinite(task.shaft_hz):
            shaft_hz = task.shaft_hz
        diagnosis = diagnose_record(
            signal.x,
            signal.sample_rate,
            bearing,
            shaft_hz,
            speed_tolerance=task.speed_tolerance,
            unit=task.unit or signal.unit,
            temperature=signal.temperature,
        )
    except (BearingTwinError, MemoryError) as error:
        return _unread(task.path, str(error) or 'not enough memory')
    if task.plot and diagnosis.spectrum.values.size:
        from bearing_twin.cli.diagnose_plot import draw

        draw(diagnosis, Path(task.plot), title=f'{Path(task.path).name}, {bearing.name}')
    return {
        'file': task.path,
        'result': diagnosis.result,
        'faults': list(diagnosis.faults),
        'level': diagnosis.level,
        'confidence': round(diagnosis.confidence, 4),
        'shaft_hz': _number(diagnosis.shaft_hz),
        'slip': _number(diagnosis.slip),
        'evidence': evidence(diagnosis),
        'reasons': list(diagnosis.reasons),
        'read': True,
    }


def evidence(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return what a verdict rests on, as plain numbers; unknown ones are None."""
    severity = asdict(diagnosis.severity)
    severity['band_rms'] = [_number(value) for value in severity['band_rms']]
    return {
        'fault_code': diagnosis.fault_code,
        'shaft_hz_given': _number(diagnosis.shaft_hz_given),
        'fault_hz': _number(diagnosis.fault_hz),
        'fault_hz_expected': _number(diagnosis.fault_hz_expected),
        'expected_hz': {
            name: _number(value) for name, value in diagnosis.expected._asdict().items()
        },
        'score': {name: _number(value) for name, value in diagnosis.score.items()},
        'modulation_index': {
            name: _number(value) for name, value in diagnosis.modulation_index.items()
        },
        'band_hz': [_number(edge) for edge in diagnosis.band],
        'line_hz': [_number(float(value)) for value in diagnosis.line_hz],
        'line_level': [_number(float(value)) for value in diagnosis.line_level],
        'smallest_detectable_mm': _number(diagnosis.smallest_detectable),
        'severity': {
            name: _number(value) if isinstance(value, float) else value
            for name, value in severity.items()
        },
    }


def _known_bearing(name: str) -> Bearing:
    """Bearing of the catalogue that a file names, e.g. ``'SKF 6205-2RS JEM'``."""
    for word in name.split()[:2]:
        for candidate in (word, word.split('-')[0]):
            try:
                found = find_bearing(candidate)
            except BearingTwinError:
                continue
            if found.name.casefold() == candidate.casefold():
                return found
    said = f'the file says {name!r}, which is not in the catalogue' if name else 'unknown bearing'
    msg = f'{said}; give --bearing NAME or --geometry Z,D_BALL_MM,D_PITCH_MM,ANGLE_DEG'
    raise BearingTwinError(msg)


def _unread(path: str, reason: str) -> dict[str, Any]:
    return {
        'file': path,
        'result': 'insufficient',
        'faults': [],
        'level': 'none',
        'confidence': 0.0,
        'shaft_hz': None,
        'slip': None,
        'evidence': {},
        'reasons': [reason],
        'read': False,
    }


def _number(value: float) -> float | None:
    # Zero is added lest -0.0 be printed.
    return float(f'{value:.7g}') + 0.0 if math.isfinite(value) else None


def _picture(folder: Path, name: str) -> Path:
    """Picture of a file, its whole path in the name so that no two collide."""
    flat = str(Path(name)).strip('/').replace('/', '_')
    return folder / f'{flat}.png'


def _line(answer: dict[str, Any]) -> str:
    names = '+'.join(answer['faults']) or answer['result']
    text = f'{answer["file"]}: {answer["result"]} [{answer["level"]}]'
    if names != answer['result']:
        text += f' {names}'
    text += f', confidence {answer["confidence"]:.3f}'
    if answer['shaft_hz'] is not None:
        text += f', shaft {answer["shaft_hz"]:.3f} Hz'
    return '\n    '.join([text, *answer['reasons']])
