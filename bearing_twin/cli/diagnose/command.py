# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin diagnose``: verdicts on vibration files, on a single file with all evidence."""

from __future__ import annotations

import argparse
from dataclasses import replace
from itertools import repeat
import json
from pathlib import Path
import sys

from bearing_twin.cli.arguments import file_name, refuse_given
from bearing_twin.cli.diagnose.spread import answers
from bearing_twin.cli.diagnose.task import CARD, DRAWN, Task
from bearing_twin.cli.signal_arguments import (
    add_reading,
    channels_of,
    given_bearing,
    given_speed,
    pictures_of,
)
from bearing_twin.cli.terminal import clear_progress, progress, shown_inside
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.errors import BearingTwinError, refused, shown

SINGLE = ('speed_tolerance', 'plot', 'jobs', 'dask')
SERIES = ('cycle', 'baseline', 'hold')
"""Options of single files and of series."""


def configure(parser: argparse.ArgumentParser) -> None:
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
        '--plot',
        type=file_name,
        metavar='DIR',
        help='draw the spectra with fault cursors into this folder',
    )


def run(args: argparse.Namespace) -> int:
    """Diagnose the files; return 0 only if every file could be read and drawn."""
    if args.channels:
        return _list_channels(args)
    if args.series:
        from bearing_twin.cli.diagnose.series import run_series

        refuse_given(args, SINGLE, 'not with --series, which judges all files together')
        return run_series(args, given_speed(args))
    refuse_given(args, SERIES, 'only with --series')
    tasks = _tasks(args)
    failed = 0
    for done, answer in enumerate(answers(tasks, jobs=args.jobs, dask=args.dask), start=1):
        clear_progress(len(tasks))
        drawn, error, file = answer.pop(DRAWN, True), answer.get('error'), answer['file']
        if args.json:
            answer.pop(CARD, None)
            print(json.dumps(answer), flush=True)
        elif 'result' in answer:
            from bearing_twin.cli.diagnose.text import line, page

            answer = shown_inside(answer)
            print(page(answer) if len(tasks) == 1 else line(answer), flush=True)
        if error is not None:
            failed += 1
            print(f'bearing-twin diagnose: {shown(error)}', file=sys.stderr, flush=True)
        if not drawn:
            why = 'no picture, as it has no spectrum: see the reasons of its verdict'
            print(f'bearing-twin diagnose: {shown(file)}: {why}', file=sys.stderr)
        progress(done, len(tasks), 'files')
    return 1 if failed else 0


def _list_channels(args: argparse.Namespace) -> int:
    from bearing_twin.recording.signals.signalfile import channels

    listed: dict[str, list[str]] = {}
    for name in args.files:
        try:
            listed[name] = channels(Path(name))
        except BearingTwinError as error:
            print(f'bearing-twin diagnose: {shown(error)}', file=sys.stderr, flush=True)
            continue
        if not args.json:
            names = map(shown, listed[name] or ['(none)'])
            print(f'{shown(name)}:', *names, sep='\n    ', flush=True)
    if args.json:
        print(json.dumps(listed))
    return 0 if listed.keys() == set(args.files) else 1


def _tasks(args: argparse.Namespace) -> list[Task]:
    """Return a task for each file, or for each signal of a data set."""
    bearing = given_bearing(args)
    settings = DiagnosisSettings(power_group=args.power_group, mounting=args.mounting)
    if args.speed_tolerance is not None:
        # Checks the range; each task carries the value, since a varying speed has another default.
        with refused():
            replace(settings, speed_tolerance=args.speed_tolerance)
    shaft_hz = given_speed(args)
    signals = [
        (name, channel) for name in args.files for channel in channels_of(name, args.channel)
    ]
    plots = map(str, pictures_of(Path(args.plot), signals)) if args.plot else repeat('')
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
            plot=plot,
        )
        for (name, channel), plot in zip(signals, plots, strict=False)
    ]
