# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin demo``: the nodes as in production, from a temperature recording to a verdict."""

from __future__ import annotations

import os
import sys
import time
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.cli.demo_summary import summarise
from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes.launching import NodeProcesses, local_environment
from bearing_twin.recording.reader import recording_info

if TYPE_CHECKING:
    import argparse

    from bearing_twin.recording.reader import RecordingInfo

__all__ = ['configure', 'run']

START_TIMEOUT = 90.0
"""Time for four processes to come up, the kernel's first compilation included, s."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
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
    parser.add_argument(
        '--domain-id', type=int, help='ROS domain (default: one derived from the process id)'
    )
    parser.add_argument('--no-rerun', action='store_true', help='write no Rerun recording')
    parser.add_argument('--json', action='store_true', help='print the result as JSON')


def run(args: argparse.Namespace) -> int:
    """Run the demo; return 0 if the fault was found and no block was lost."""
    recording = args.recording or _shipped_schedule()
    info = recording_info(recording)
    folder = args.out / f'demo-{datetime.now():%Y%m%d-%H%M%S}'
    folder.mkdir(parents=True)
    domain = args.domain_id if args.domain_id is not None else 1 + os.getpid() % 100
    say = (lambda *_: None) if args.json else print
    say(f'recording  {recording} ({info.duration:.0f} s at pace {args.rate:g})')
    say(f'nodes      twin, diagnosis, recorder, replay in ROS domain {domain}')
    _run_nodes(args, recording, info, folder, domain)
    summary = summarise(folder, args.defect)
    say()
    print(summary.to_json() if args.json else summary.to_text())
    return 0 if summary.good else 1


def _shipped_schedule() -> Path:
    """Return the paper's schedule, from the working tree or from where it is installed."""
    here = Path(__file__).parents[2]
    for folder in (here, Path(sys.prefix) / 'share' / 'bearing_twin'):
        path = folder / 'recordings' / 'paper_schedule.mcap'
        if path.exists():
            return path
    msg = "paper_schedule.mcap is missing; write it with 'bearing-twin schedule'"
    raise BearingTwinError(msg)


def _run_nodes(
    args: argparse.Namespace, recording: Path, info: RecordingInfo, folder: Path, domain: int
) -> None:
    environment = local_environment(domain)
    os.environ.update(environment)
    # rclpy reads the domain when it is first used.
    from bearing_twin.cli.demo_watch import Watcher

    with NodeProcesses(folder / 'logs', environment) as nodes, Watcher() as watcher:
        recorder = {'output': str(folder / 'bag')}
        if not args.no_rerun:
            recorder['rerun_file'] = str(folder / 'view.rrd')
        nodes.start('recorder', recorder)
        nodes.start('diagnosis', {'bearing': '6307'})
        watcher.wait_for_listeners(2, nodes.check, START_TIMEOUT)
        nodes.start('twin', {'bearing': '6307', 'defect': args.defect})
        watcher.wait_for_vibration(nodes.check, START_TIMEOUT)
        nodes.start('replay', {'recording': str(recording), 'rate': args.rate})
        deadline = time.monotonic() + info.duration / args.rate + START_TIMEOUT
        while nodes.running('replay'):
            if time.monotonic() > deadline:
                msg = f'the replay did not end in time; see {folder / "logs"}'
                raise BearingTwinError(msg)
            watcher.show(1.0, quiet=args.json)
            nodes.check()
        # The twin first, so that the others get all it sent; the recorder last.
        for name in ('twin', 'diagnosis', 'recorder'):
            watcher.show(1.0, quiet=args.json)
            nodes.end(name)
