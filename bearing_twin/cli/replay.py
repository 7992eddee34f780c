# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin replay``: publish a recording, or run it offline through twin and diagnosis."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
import contextlib
from dataclasses import asdict
import json
from pathlib import Path
import signal
import sys
import threading
import time
from typing import Any

from bearing_twin.cli.arguments import refuse_given
from bearing_twin.cli.terminal import percent
from bearing_twin.errors import shown, UsageError
import yaml

LIVE = ('rate', 'loop', 'start_offset', 'duration', 'topics', 'remap', 'clock', 'start_paused')
OFFLINE = ('output', 'temperature', 'twin', 'diagnosis', 'json')


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('recording', type=Path, help='MCAP file or bag folder')
    live = parser.add_argument_group('live (the default): publish its topics')
    live.add_argument('-r', '--rate', type=float, default=1.0, help='pace (default 1)')
    live.add_argument('-l', '--loop', action='store_true', help='start again at the end')
    live.add_argument('--start-offset', type=float, default=0.0, help='skip this many seconds')
    live.add_argument('--duration', type=float, default=0.0, help='play this many seconds')
    live.add_argument('--topics', nargs='+', default=[], help='topics to play (default all)')
    live.add_argument(
        '--remap', nargs='+', default=[], metavar='A:=B', help='publish topic A under the name B'
    )
    live.add_argument('--clock', type=float, default=0.0, metavar='HZ', help='publish /clock')
    live.add_argument('-p', '--start-paused', action='store_true', help='wait for ~/resume')
    offline = parser.add_argument_group('offline: through twin and diagnosis without DDS')
    offline.add_argument('--offline', action='store_true', help='write a new recording')
    offline.add_argument('-o', '--output', type=Path, help='recording to make')
    offline.add_argument(
        '--temperature',
        default='',
        metavar='TOPIC',
        help='temperature to follow, where the recording has several',
    )
    for node in ('twin', 'diagnosis'):
        offline.add_argument(
            f'--{node}',
            action='append',
            default=[],
            metavar='NAME=VALUE',
            help=f'parameter of the {node}; may be given several times',
        )
    offline.add_argument('--json', action='store_true', help='print the result as JSON')


def run(args: argparse.Namespace) -> int:
    """Replay; return 0 if the whole recording was replayed."""
    if args.offline:
        refuse_given(args, LIVE, 'only a live replay has it; --offline runs all of the recording')
        return _offline(args)
    refuse_given(args, OFFLINE, 'only a replay with --offline has it')
    return _live(args)


def _live(args: argparse.Namespace) -> int:
    from bearing_twin.nodes.replay import NODE
    from bearing_twin.ros.processes.launching import parameter_words
    from bearing_twin.ros.processes.running import run as run_node

    parameters = {name: getattr(args, name) for name in LIVE}
    parameters |= {'recording': str(args.recording), 'clock_rate': parameters.pop('clock')}
    for name in ('topics', 'remap'):
        # ROS cannot tell the type of an empty list.
        parameters[name] = parameters[name] or ['']
    return run_node(NODE, ['--ros-args', *parameter_words(parameters)])


def _offline(args: argparse.Namespace) -> int:
    from bearing_twin.offline.run import run_offline

    if args.output is None:
        raise UsageError('an offline replay writes a new recording: name it with -o')
    began = time.perf_counter()
    with _interrupts() as interrupted:
        report = run_offline(
            args.recording,
            args.output,
            twin=_parameters(args.twin),
            diagnosis=_parameters(args.diagnosis),
            temperature=args.temperature,
            progress=percent if sys.stderr.isatty() else None,
            stop=interrupted.is_set,
        )
    took = time.perf_counter() - began
    status = 130 if report.stopped else 1 if report.problems else 0
    if args.json:
        print(json.dumps({**asdict(report), 'seconds': took}, default=str))
        return status
    for problem in report.problems:
        print(f'left out: {shown(problem)}', file=sys.stderr)
    for warning in report.warnings:
        print(f'warning: {warning}', file=sys.stderr)
    verdicts = ', '.join(f'{name} {count}' for name, count in report.verdicts.items())
    covered = f'{report.covered:.1f} s'
    if report.stopped:
        covered += f' of {report.duration:.1f} s, where it was stopped'
    print(f'{report.target}: {report.blocks} blocks over {covered}; {verdicts}')
    print(f'took {took:.2f} s, {report.covered / took:.0f} times real time')
    return status


@contextlib.contextmanager
def _interrupts() -> Iterator[threading.Event]:
    """Yield an event that SIGINT and SIGTERM set; a second signal interrupts at once."""
    asked = threading.Event()

    def ask(number: int, _frame: object) -> None:
        if asked.is_set():
            raise KeyboardInterrupt
        asked.set()
        print('\nstopping; again to stop at once', file=sys.stderr, flush=True)

    before = {number: signal.signal(number, ask) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield asked
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _parameters(words: list[str]) -> dict[str, Any]:
    values = {}
    for word in words:
        name, separator, text = word.partition('=')
        if not separator:
            raise UsageError(f'{word!r} does not read NAME=VALUE')
        try:
            # YAML reads nothing as null; here it is an empty text.
            values[name] = yaml.safe_load(text) if text else ''
        except (yaml.YAMLError, ValueError, RecursionError) as error:
            # A date that does not exist is a ValueError, and deep nesting a RecursionError.
            raise UsageError(f'{word[:80]!r} cannot be read: {error}') from None
    return values
