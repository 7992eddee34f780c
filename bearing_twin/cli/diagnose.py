# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin diagnose``: verdicts on vibration files; of one file all that it rests on."""

from __future__ import annotations

from collections import deque
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
import json
from pathlib import Path
import sys
from typing import Any, TYPE_CHECKING

from bearing_twin.cli.diagnose_task import CARD, Task, unread
from bearing_twin.cli.signal_arguments import add_signal_arguments, given_bearing, given_speed
from bearing_twin.cli.terminal import (
    clear_progress,
    processes,
    progress,
    refuse_given,
    shown_inside,
)
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.errors import BearingTwinError, shown
from bearing_twin.memory import keep_freed_memory
from bearing_twin.recording.finding import SIGNAL_FILES
from bearing_twin.recording.signals.dataset import chosen_signals, is_dataset

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Iterator, Sequence

    _Diagnose = Callable[[Task], dict[str, Any]]


SINGLE = ('speed_tolerance', 'plot', 'jobs', 'dask')
SERIES = ('cycle', 'baseline', 'hold')
"""Options of single files and of series."""
MOST_AT_ONCE = 16
"""Most files of one task of Dask; answers come as often."""


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
        from bearing_twin.cli.diagnose_series import run_series

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
            from bearing_twin.cli.diagnose_text import line, page

            answer = shown_inside(answer)
            print(page(answer) if len(tasks) == 1 else line(answer), flush=True)
        progress(done, len(tasks), 'files')
    return 1 if unread else 0


def _list_channels(args: argparse.Namespace) -> int:
    from bearing_twin.recording.signals.foreign import channels

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
    # Imported after that: who gives files to a cluster diagnoses none.
    from bearing_twin.cli.diagnose_file import diagnose_file

    jobs = processes(args.jobs, len(tasks))
    if jobs == 1:
        return map(diagnose_file, tasks)
    return _on_cores(diagnose_file, tasks, jobs)


def _on_cores(diagnose: _Diagnose, tasks: Sequence[Task], jobs: int) -> Iterator[dict[str, Any]]:
    from bearing_twin.diagnosis.warming import warm_up

    # Compiled or loaded once, where it is told of; each process would do it anew.
    warm_up()
    with ProcessPoolExecutor(jobs) as pool:
        futures = [pool.submit(diagnose, task) for task in tasks]
        for task, future in zip(tasks, futures, strict=True):
            killed = isinstance(future.exception(), BrokenProcessPool)
            # Which file it was shows when each has a process of its own.
            yield _alone(diagnose, task) if killed else future.result()


def _alone(diagnose: _Diagnose, task: Task) -> dict[str, Any]:
    with ProcessPoolExecutor(1) as pool:
        try:
            return pool.submit(diagnose, task).result()
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
            alone = client.map(_diagnose_files, [[task] for task in part], pure=False, retries=3)
            for task, single in zip(part, alone, strict=True):
                reason = single.exception()
                yield from single.result() if reason is None else [unread(task.path, str(reason))]


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
    from bearing_twin.cli.diagnose_file import diagnose_file

    # Dask has its workers give all that they free back to the system at once.
    keep_freed_memory()
    return [diagnose_file(task) for task in tasks]


def picture(folder: Path, name: str, channel: str | None) -> Path:
    """Picture of a signal, its whole path in the name so that no two collide."""
    parts = f'{Path(name)}_{channel}' if is_dataset(Path(name)) else str(Path(name))
    return folder / f'{parts.strip("/").replace("/", "_")}.png'
