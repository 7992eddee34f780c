# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin diagnose``: verdicts on vibration files; of one file all that it rests on."""

from __future__ import annotations

from collections import deque
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass, field, replace
import json
import math
from pathlib import Path
import sys
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.messages import diagnosis_message
from bearing_twin.bearing import Bearing, named_bearing
from bearing_twin.cli.diagnose_series import run_series
from bearing_twin.cli.diagnose_text import CARD, card, line, page
from bearing_twin.cli.signal_arguments import add_signal_arguments, given_bearing, given_speed
from bearing_twin.cli.terminal import (
    clear_progress,
    plain,
    processes,
    progress,
    refuse_given,
    shown_inside,
)
from bearing_twin.diagnosis import diagnose_record, Diagnosis, DiagnosisSettings
from bearing_twin.diagnosis.warming import warm_up
from bearing_twin.errors import BearingTwinError, shown
from bearing_twin.memory import keep_freed_memory
from bearing_twin.recording.dataset import chosen_signals, is_dataset
from bearing_twin.recording.finding import SIGNAL_FILES
from bearing_twin.recording.foreign import channels, read_signal
from bearing_twin.view.verdict import next_step

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator, Sequence


SINGLE = ('speed_tolerance', 'plot', 'jobs', 'dask')
SERIES = ('cycle', 'baseline', 'hold')
"""Options of single files and of series."""
DIGITS = 7
"""Of the numbers in an answer."""
MOST_AT_ONCE = 16
"""Most files of one task of Dask; answers come as often."""


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
    settings: DiagnosisSettings = field(default_factory=DiagnosisSettings)
    plot: str = ''
    """File for the picture; empty for none."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    add_reading(parser)
    parser.add_argument(
        '--speed-tolerance',
        type=float,
        metavar='FRACTION',
        help='how far the speed may be off (default 0.02: a nameplate)',
    )
    parser.add_argument(
        '--channels', action='store_true', help='list the channels of the files, and end'
    )
    series = parser.add_argument_group('many snapshots of one machine')
    series.add_argument(
        '--series',
        action='store_true',
        help='judge the files, or those in a folder, together and in order of time: baseline, '
        'trend, change, alarm',
    )
    series.add_argument(
        '--cycle',
        type=float,
        metavar='SECONDS',
        help='time from one snapshot to the next, for files that do not say theirs',
    )
    series.add_argument(
        '--baseline',
        type=int,
        default=60,
        metavar='N',
        help='snapshots that make the baseline (default 60)',
    )
    series.add_argument(
        '--hold',
        type=float,
        default=3600.0,
        metavar='SECONDS',
        help='how long the level must be low before an alarm ends (default 3600)',
    )
    parser.add_argument(
        '--power-group',
        type=int,
        choices=(1, 2),
        default=0,
        help='group of ISO 20816-3, for the zone (1: above 300 kW, 2: 15 to 300 kW)',
    )
    parser.add_argument(
        '--mounting',
        choices=('rigid', 'flexible'),
        default='',
        help='how the machine stands, for its zone',
    )
    parser.add_argument('--json', action='store_true', help='one JSON object a line')
    parser.add_argument('--jobs', type=int, help='processes (default: one a core)')
    parser.add_argument('--dask', metavar='ADDRESS', help='spread the work over a Dask cluster')
    parser.add_argument(
        '--plot', metavar='DIR', help='draw the spectra with fault cursors into this folder'
    )


def add_reading(parser: argparse.ArgumentParser) -> None:
    """Add the arguments that say which files are read, and how."""
    parser.add_argument(
        'files',
        nargs='+',
        metavar='FILE',
        help=f'{" ".join(SIGNAL_FILES)} .mcap, or a folder made by bearing-datasets',
    )
    add_signal_arguments(parser)


def run(args: argparse.Namespace) -> int:
    """Diagnose the files; 0 only if every file could be read."""
    if args.channels:
        return _list_channels(args)
    if args.series:
        refuse_given(args, SINGLE, 'not with --series, which judges all files together')
        return run_series(args, given_speed(args))
    refuse_given(args, SERIES, 'only with --series')
    tasks = _tasks(args)
    unread = 0
    for done, answer in enumerate(_answers(tasks, args), start=1):
        clear_progress(len(tasks))
        if 'error' in answer:
            unread += 1
            print(f'bearing-twin diagnose: {shown(answer["error"])}', file=sys.stderr, flush=True)
        if args.json:
            answer.pop(CARD, None)
            print(json.dumps(answer), flush=True)
        elif 'error' not in answer:
            answer = shown_inside(answer)
            print(page(answer) if len(tasks) == 1 else line(answer), flush=True)
        progress(done, len(tasks), 'files')
    return 1 if unread else 0


def _list_channels(args: argparse.Namespace) -> int:
    listed = {name: channels(Path(name)) for name in args.files}
    if args.json:
        print(json.dumps(listed))
        return 0
    for name, names in listed.items():
        print(f'{name}:', *map(shown, names), sep='\n    ')
    return 0


def _tasks(args: argparse.Namespace) -> list[Task]:
    """Return what is to be done; of a data set one task a signal."""
    bearing = given_bearing(args)
    settings = DiagnosisSettings(power_group=args.power_group, mounting=args.mounting)
    if args.speed_tolerance is not None:
        # Checks the range; each task carries the value, since a varying speed has another default.
        replace(settings, speed_tolerance=args.speed_tolerance)
    shaft_hz = given_speed(args)
    return [
        Task(
            path=name,
            bearing=bearing,
            shaft_hz=shaft_hz,
            speed_tolerance=args.speed_tolerance,
            sample_rate=args.sample_rate,
            channel=channel,
            unit=args.unit,
            settings=settings,
            plot=str(picture(Path(args.plot), name, channel)) if args.plot else '',
        )
        for name in args.files
        for channel in channels_of(name, args.channel)
    ]


def channels_of(name: str, channel: str | None) -> list[str | None]:
    """Channels to diagnose of a file: of a data set those of :func:`chosen_signals`."""
    if not is_dataset(Path(name)):
        return [channel]
    return [str(row['signal_id']) for row in chosen_signals(Path(name), channel)]


def _answers(tasks: Sequence[Task], args: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Answers in the order of the tasks."""
    if args.dask:
        return _on_dask(tasks, args.dask)
    jobs = processes(args.jobs, len(tasks))
    return map(diagnose_file, tasks) if jobs == 1 else _on_cores(tasks, jobs)


def _on_cores(tasks: Sequence[Task], jobs: int) -> Iterator[dict[str, Any]]:
    # Compiled or loaded once, where it is told of; each process would do it anew.
    warm_up()
    with ProcessPoolExecutor(jobs) as pool:
        futures = [pool.submit(diagnose_file, task) for task in tasks]
        for task, future in zip(tasks, futures, strict=True):
            killed = isinstance(future.exception(), BrokenProcessPool)
            # Which file it was shows when each has a process of its own.
            yield _alone(task) if killed else future.result()


def _alone(task: Task) -> dict[str, Any]:
    with ProcessPoolExecutor(1) as pool:
        try:
            return pool.submit(diagnose_file, task).result()
        except BrokenProcessPool:
            return unread(
                task.path, 'the process that read it was killed; is there enough memory?'
            )


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
        parts = batches(tasks, max(1, sum(client.nthreads().values())))
        # A worker that dies takes no file with it: the scheduler gives its files to another.
        futures = deque(client.map(_diagnose_files, parts, pure=False, retries=3))
        for part in parts:
            # A worker keeps answers for as long as there is a future of them.
            future = futures.popleft()
            failure = future.exception()
            if failure is None:
                yield from future.result()
                continue
            # Which file it was shows when each is a task of its own.
            alone = client.map(diagnose_file, part, pure=False, retries=3)
            for task, single in zip(part, alone, strict=True):
                reason = single.exception()
                yield single.result() if reason is None else unread(task.path, str(reason))


def batches(tasks: Sequence[Task], workers: int) -> list[Sequence[Task]]:
    """
    Return the tasks in parts that get smaller, so that no worker waits long at the end.

    Dask spends as long on a part as a short file takes, so that several files are one. A part is
    half of a worker's share of what is left, rounded up (guided self-scheduling, Polychronopoulos
    and Kuck 1987).

    >>> [len(part) for part in batches(range(50), 2)]
    [13, 10, 7, 5, 4, 3, 2, 2, 1, 1, 1, 1]

    """
    parts: list[Sequence[Task]] = []
    start = 0
    while left := len(tasks) - start:
        size = min(MOST_AT_ONCE, -(-left // (2 * workers)))
        parts.append(tasks[start : start + size])
        start += size
    return parts


def _diagnose_files(tasks: Sequence[Task]) -> list[dict[str, Any]]:
    # Dask has its workers give all that they free back to the system at once.
    keep_freed_memory()
    return [diagnose_file(task) for task in tasks]


def diagnose_file(task: Task) -> dict[str, Any]:
    """
    Answer for one file; never raises for what is in the file.

    What cannot be read has no verdict: its answer is ``file`` and ``error``.
    """
    try:
        signal = read_signal(Path(task.path), channel=task.channel, sample_rate=task.sample_rate)
        bearing = task.bearing or signal.bearing or named_bearing(signal.bearing_name)
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
            settings=task.settings,
        )
        if task.plot and diagnosis.spectrum.values.size:
            from bearing_twin.cli.plots import draw_diagnosis

            title = f'{Path(task.path).name}, {bearing.name}'
            draw_diagnosis(diagnosis, Path(task.plot), title=title)
    except (BearingTwinError, MemoryError) as error:
        reason = str(error) or 'not enough memory'
        if task.channel and task.path not in reason:
            reason = f'{task.path}, {task.channel}: {reason}'
        return unread(task.path, reason)
    length = len(signal.x) / signal.sample_rate
    message = diagnosis_message(diagnosis, stamp=0, frame_id='', bearing=bearing.name)
    return {
        'file': task.path,
        'channel': task.channel or '',
        'source': f'{signal.source}: {length:.4g} s at {signal.sample_rate:g} Hz',
        'bearing': f'{bearing.name}: {bearing.n_balls} {bearing.element}s of '
        f'{1e3 * bearing.d_ball:.5g} mm on {1e3 * bearing.d_pitch:.5g} mm, {bearing.basis}',
        'result': diagnosis.result,
        'faults': list(diagnosis.faults),
        'level': diagnosis.level,
        'confidence': round(diagnosis.confidence, 4),
        'shaft_hz': plain(diagnosis.shaft_hz, DIGITS),
        'slip': plain(diagnosis.slip, DIGITS),
        'evidence': evidence(diagnosis),
        'reasons': list(diagnosis.reasons),
        'next_step': next_step(message),
        CARD: card(message),
    }


def evidence(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return what a verdict rests on, as plain numbers; unknown ones are None."""
    found: dict[str, Any] = plain(
        {
            'fault_code': diagnosis.fault_code,
            'shaft_hz_given': diagnosis.shaft_hz_given,
            'fault_hz': diagnosis.fault_hz,
            'fault_hz_expected': diagnosis.fault_hz_expected,
            'expected_hz': diagnosis.expected._asdict(),
            'found_hz': diagnosis.found_hz,
            'score': diagnosis.score,
            'modulation_index': diagnosis.modulation_index,
            'band_hz': diagnosis.band,
            'line_hz': diagnosis.line_hz.tolist(),
            'line_level': diagnosis.line_level.tolist(),
            'smallest_detectable_mm': diagnosis.smallest_detectable,
            'severity': asdict(diagnosis.severity),
        },
        DIGITS,
    )
    return found


def unread(path: str, reason: str) -> dict[str, Any]:
    """Answer for a file that cannot be read."""
    return {'file': path, 'error': reason if path in reason else f'{path}: {reason}'}


def picture(folder: Path, name: str, channel: str | None) -> Path:
    """Picture of a signal, its whole path in the name so that no two collide."""
    parts = f'{Path(name)}_{channel}' if is_dataset(Path(name)) else str(Path(name))
    return folder / f'{parts.strip("/").replace("/", "_")}.png'
