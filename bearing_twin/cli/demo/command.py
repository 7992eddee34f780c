# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin demo``: the nodes as in production, from a temperature recording to a verdict."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from datetime import datetime
import json
import os
from pathlib import Path
import time
from typing import TYPE_CHECKING

from bearing_twin.cli.demo.hidden import find_hidden, HIDDEN
from bearing_twin.cli.demo.summary import summarise
from bearing_twin.dynamics.defect_text import defect_places
from bearing_twin.dynamics.presets import preset
from bearing_twin.errors import BearingTwinError, refused, UsageError
from bearing_twin.recording.mcap.schema import shared_folders
from bearing_twin.recording.reader import recording_info
from bearing_twin.ros.processes.launching import COMPILING, local_environment, NodeProcesses
from bearing_twin.wholefile import free_path

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from bearing_twin.recording.reader import RecordingInfo


PRESET = 'paper'
SLOWEST, FASTEST = 0.001, 1e6
START_TIMEOUT = 300.0
"""Time limit for the start, s: a slow machine that is busy compiles kernels for minutes."""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--recording',
        type=Path,
        help='temperature recording to replay (default: the schedule of the paper, 20..110 degC)',
    )
    parser.add_argument('--rate', type=float, default=1.0, help='pace of the replay (default 1)')
    parser.add_argument('--defect', default='inner', help='defect of the twin (default inner)')
    parser.add_argument(
        '--out', type=Path, default=Path('runs'), help='folder for the run (default ./runs)'
    )
    parser.add_argument('--no-rerun', action='store_true', help='write no Rerun recording')
    parser.add_argument('--json', action='store_true', help='print the result as JSON')


def run(args: argparse.Namespace) -> int:
    """Run the demo; return 0 if both faults were found and no block was lost."""
    recording = args.recording or shipped_schedule()
    info = recording_info(recording)
    if not SLOWEST <= args.rate <= FASTEST:
        raise UsageError(f'--rate {args.rate:g} is not within {SLOWEST:g}..{FASTEST:g}')
    with refused():
        preset(PRESET, defect=args.defect)
    say = (lambda *_: None) if args.json else print
    with _own_domain() as domain:
        folder = make_folder(args.out)
        say(f'recording  {recording} ({info.duration:.0f} s at pace {args.rate:g})')
        say(f'nodes      twin, diagnosis, recorder, replay in ROS domain {domain}')
        _run_nodes(args, recording, info, folder, domain)
        summary = summarise(folder, defect_places(args.defect), PRESET)
        say('\n' + summary.to_text() + '\n')
        hidden = find_hidden(folder / 'logs', local_environment(domain), say)
    say(f'{hidden.to_text()}\n\nopen with  {summary.open_with}')
    good = summary.good and hidden.place == HIDDEN['defect']
    if args.json:
        print(json.dumps({**asdict(summary), 'hidden': asdict(hidden), 'good': good}))
    return 0 if good else 1


def make_folder(out: Path) -> Path:
    """Make a new folder for a run."""
    folder = free_path(out / f'demo-{datetime.now():%Y%m%d-%H%M%S}')
    try:
        folder.mkdir(parents=True)
    except OSError as error:
        msg = f'{folder} cannot be made ({error.strerror}); choose another --out'
        raise BearingTwinError(msg) from None
    return folder


def _own_domain() -> AbstractContextManager[int]:
    os.environ.update(local_environment(0))
    from bearing_twin.ros.processes.domain import own_domain

    return own_domain(os.getpid())


def shipped_schedule() -> Path:
    """Return the path of the paper's schedule, in the working tree or where it is installed."""
    for folder in (Path(__file__).parents[3], *shared_folders('bearing_twin')):
        path = folder / 'recordings' / 'paper_schedule.mcap'
        if path.exists():
            return path
    msg = "paper_schedule.mcap is missing; write it with 'bearing-twin schedule -o FILE'"
    raise BearingTwinError(msg)


def _run_nodes(
    args: argparse.Namespace, recording: Path, info: RecordingInfo, folder: Path, domain: int
) -> None:
    environment = local_environment(domain)
    os.environ.update(environment)
    # rclpy reads the domain when it is first used.
    from bearing_twin.cli.demo.watch import Watcher

    with NodeProcesses(folder / 'logs', environment) as nodes, Watcher() as watcher:
        recorder = {'output': str(folder / 'bag')}
        if not args.no_rerun:
            recorder['rerun_file'] = str(folder / 'view.rrd')
        nodes.start('recorder', recorder)
        nodes.start('diagnosis', {'bearing': '6307'})
        watcher.wait_for_listeners(2, nodes.check, START_TIMEOUT)
        # Recorder and diagnosis: nothing is published before both listen.
        twin = {'bearing': '6307', 'preset': PRESET, 'defect': args.defect}
        twin['wait_for_subscribers'] = 2
        nodes.start('twin', twin)
        log, said = folder / 'logs' / 'twin.log', args.json

        def check() -> None:
            """Check that all nodes run; report once that the twin compiles, at its first start."""
            nonlocal said
            nodes.check()
            if not said and COMPILING in log.read_text(errors='replace'):
                print(f'twin       {COMPILING}', flush=True)
                said = True

        watcher.wait_for_vibration(check, START_TIMEOUT)
        replay = {'recording': str(recording), 'rate': args.rate}
        heard = {'wait_for_nodes': ['recorder', 'twin'], 'subscriber_timeout': 10.0}
        nodes.start('replay', {**replay, **heard})
        deadline = time.monotonic() + info.duration / args.rate + START_TIMEOUT
        while nodes.running('replay'):
            if time.monotonic() > deadline:
                raise BearingTwinError(f'the replay did not end in time; see {folder / "logs"}')
            watcher.show(1.0, quiet=args.json)
            nodes.check()
        # The twin ends first, so that the others get all that it has sent; the recorder last.
        for name in ('twin', 'diagnosis', 'recorder'):
            watcher.show(1.0, quiet=args.json)
            nodes.end(name)
