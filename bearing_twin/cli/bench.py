# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin bench``: measure the performance on this machine against its targets."""

from __future__ import annotations

from functools import partial
import importlib
import json
import os
import platform
import sys
from typing import TYPE_CHECKING

from bearing_twin import __version__
from bearing_twin.bench.figures import Figure, FIGURES
from bearing_twin.cli.terminal import by_level
from bearing_twin.errors import BearingTwinError, UsageError

if TYPE_CHECKING:
    import argparse


BENCHES = {
    'kernel': 'bearing seconds per core second of the equations of motion',
    'diagnosis': 'time per verdict and per record',
    'files': 'many recordings over Dask against one process',
    'offline': 'recordings and sweeps faster than real time',
    'view': 'Rerun recordings',
    'live': 'bearings that one core carries live, with and without DDS',
}
"""Modules of ``bearing_twin.bench``; each has ``measure() -> dict[str, float]``."""
LONGEST = 86400.0
"""Longest live run, s."""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        'names',
        nargs='*',
        metavar='NAME',
        help='what to measure (default: all but --live): '
        + '; '.join(f'{name}: {text}' for name, text in BENCHES.items()),
    )
    parser.add_argument(
        '--live',
        action='store_true',
        help='run twin, diagnosis, recorder and Rerun as processes: core share and lateness',
    )
    parser.add_argument(
        '--calibrate',
        action='store_true',
        help='the same with a calibration beside them, each 30 s',
    )
    parser.add_argument(
        '--seconds', type=float, default=60.0, help='length of the live run (default 60)'
    )
    parser.add_argument('--json', action='store_true', help='print the figures as JSON')


def run(args: argparse.Namespace) -> int:
    """Measure and print; other load on the machine changes the figures."""
    unknown = [name for name in args.names if name not in BENCHES]
    if unknown:
        msg = f'there is no bench {", ".join(unknown)}; there are {", ".join(BENCHES)}'
        raise UsageError(msg)
    live = args.live or args.calibrate
    if live and not 5.0 <= args.seconds <= LONGEST:
        raise UsageError(f'--seconds {args.seconds:g}: a live run takes 5 to {LONGEST:g} s')
    figures: dict[str, float] = {}
    failed = 0
    names = args.names or ([] if live else list(BENCHES))
    for done, name in enumerate(names, start=1):
        _say(args, f'{by_level(name, "bold")} ({done} of {len(names)}): {BENCHES[name]} ...')
        try:
            # The longest benchmark reports its progress.
            known = {'say': partial(_say, args)} if name == 'live' else {}
            figures |= importlib.import_module(f'bearing_twin.bench.{name}').measure(**known)
        except BearingTwinError as error:
            # The figures of the others are kept.
            failed = 1
            print(f'bearing-twin bench {name}: {error}', file=sys.stderr, flush=True)
    if live:
        _say(args, f'live run of {args.seconds:g} s ...')
        from bearing_twin.bench.end_to_end import live_run

        figures |= live_run(
            args.seconds,
            calibrate=args.calibrate,
            progress=lambda passed: _say(args, f'{passed:.0f} of {args.seconds:g} s'),
        )
    if args.json:
        print(json.dumps({**figures, **_machine()}))
        return failed
    width = max(map(len, figures), default=0)
    print(f'{"figure":<{width}} {"value":>11} {"unit":<9}{"target":<9} meaning')
    for name, value in figures.items():
        unit, meaning, target = FIGURES.get(name, Figure('', ''))
        print(f'{name:<{width}} {value:11.5g} {unit:<9}{target:<9} {meaning}'.rstrip())
    print(', '.join(f'{key} {value}' for key, value in _machine().items()))
    return failed


def _say(args: argparse.Namespace, text: str) -> None:
    print(text, file=sys.stderr if args.json else sys.stdout, flush=True)


def _machine() -> dict[str, object]:
    """Return versions, cores and load, on which the figures depend."""
    return {
        'bearing_twin': __version__,
        'python': platform.python_version(),
        'cores': os.cpu_count() or 0,
        'load_average': round(os.getloadavg()[0], 2),
    }
