# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin bench``: measure the performance on this machine against its targets."""

from __future__ import annotations

import argparse
from functools import partial
import importlib
import json
import os
import platform
import sys
from typing import NamedTuple

from bearing_twin import __version__
from bearing_twin.cli.terminal import by_level, wrapped
from bearing_twin.errors import BearingTwinError, UsageError

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


class Figure(NamedTuple):
    """Meaning of one figure."""

    unit: str
    meaning: str
    target: str = ''
    """Target; ratios apply to every machine, the others to one of today's cores."""


FIGURES = {
    'kernel_rtf': Figure('s/s', 'simulated seconds of one bearing in a second of a core', '> 1'),
    'kernel_error': Figure(
        '', 'relative L2 error over a second against DOP853, worst of four defects', '< 0.005'
    ),
    'kernel_error_harder': Figure('', 'the same at 50 and 100 Hz and under 5 kN', '< 0.02'),
    'fleet_error': Figure('', 'the same of a fleet', '< 0.01'),
    'fleet_error_harder': Figure('', 'the same of a fleet at 50 and 100 Hz and under 5 kN'),
    'ratio_to_lsoda': Figure('', 'time of LSODA at rtol 1e-6 over that of the kernel', '> 1'),
    'ratio_to_bdf': Figure('', 'time of BDF at rtol 1e-6 over that of the kernel', '> 1'),
    'ratio_to_plain': Figure(
        '', 'the same of equal steps of RK4 at the error of the kernel, without waviness', '> 1'
    ),
    'fleet_bearings_per_core': Figure('bearings', 'simulated in real time, all of them unlike'),
    'alike_bearings_per_core': Figure('bearings', 'the same with one defect and one speed'),
    'fleet_two_threads': Figure('', 'speed of a fleet with two threads over one', '> 1.8'),
    'diagnosis_ms': Figure('ms', 'verdict on one second at 25.6 kHz', '< 1000'),
    'stream_verdict_ms': Figure('ms', 'verdict a second on a window of 8 s of a stream', '< 1000'),
    'stream_verdict_ratio': Figure('', 'time of it over that of a whole record of 8 s', '< 1'),
    'kurtogram_ms': Figure('ms', 'fast kurtogram of PySDKit of the same second'),
    'kurtogram_ratio': Figure('', 'time of a verdict over that of a kurtogram', '< 1'),
    'dask_files_per_second': Figure('1/s', 'files of 10 s diagnosed by two workers of Dask'),
    'dask_ratio': Figure('', 'time of one process over that of the two, 1000 files', '> 1.7'),
    'dask_worker_growth_mb': Figure('MB', 'growth of a worker over the last 800 files', '< 10'),
    'offline_rtf': Figure('s/s', 'recorded seconds a second, twin, diagnosis and MCAP', '> 1'),
    'offline_ratio': Figure('', "time of the same twin's equations alone over that", '> 0.5'),
    'offline_kernel_ratio': Figure(
        '', 'time of the equations of the kernel_rtf twin at 20 degC over an offline run', '> 0.5'
    ),
    'verify_rtf': Figure('s/s', 'recorded seconds that are re-run and compared a second', '> 1'),
    'verify_ratio': Figure(
        '', "time of the same twin's equations alone over that of a re-run", '> 0.5'
    ),
    'verify_kernel_ratio': Figure(
        '', 'time of the equations of the kernel_rtf twin over a re-run', '> 0.5'
    ),
    'view_load': Figure('cores', 'share of a core that drawing for live viewers takes', '< 0.15'),
    'view_file_load': Figure('cores', 'share of a core that drawing to a file takes', '< 0.15'),
    'view_bytes_per_second': Figure('B/s', 'size of a Rerun file by recorded second'),
    'view_longest_ms': Figure('ms', 'longest that the recorder waited for drawing', '< 40'),
    'live_bearings_per_core': Figure(
        'bearings', 'twins published over DDS and recorded, twice those run at most'
    ),
    'live_bearings_run': Figure('bearings', 'largest fleet without a late or missing block'),
    'live_bearings_late': Figure('bearings', 'smallest fleet with one; 0: no fleet had', '0'),
    'live_bearings_per_core_with_diagnosis': Figure('bearings', 'the same with a diagnosis each'),
    'live_bearings_run_with_diagnosis': Figure('bearings', 'the same, verdicts too'),
    'live_bearings_late_with_diagnosis': Figure('bearings', 'smallest other fleet; 0: none', '0'),
    'live_bearings_per_core_without_dds': Figure('bearings', 'equations of motion alone'),
    'live_ratio': Figure('', 'bearings over DDS to those without', '> 0.5'),
    'live_ratio_with_diagnosis': Figure('', 'bearings with a diagnosis to equations alone'),
    'core_share': Figure('cores', 'twin, diagnosis and recorder together', '< 1'),
    'core_share_twin': Figure('cores', 'share of a core of the twin'),
    'core_share_diagnosis': Figure('cores', 'share of a core of the diagnosis'),
    'core_share_recorder': Figure('cores', 'share of a core of the recorder, with Rerun'),
    'blocks': Figure('', 'blocks published in the live run'),
    'fits': Figure('', 'calibrations in that time, in a process of their own', '> 0'),
    'fit_cost_s': Figure('s', 'greatest processor time of a calibration', '< 10'),
    'late_blocks': Figure('', 'blocks that came more than a period late', '0'),
    'dropped_blocks': Figure('', 'blocks never published', '0'),
    'lost_blocks': Figure('', 'blocks published and not recorded', '0'),
    'lateness_p50_ms': Figure('ms', 'median lateness of a block'),
    'lateness_p99_ms': Figure('ms', 'lateness that 99 % of the blocks keep'),
    'lateness_max_ms': Figure('ms', 'largest lateness of a block', '< 40'),
    'delivery_p99_ms': Figure('ms', 'time from last sample to recorder that 99 % of them keep'),
    'delivery_max_ms': Figure('ms', 'longest from a last sample to the recorder', '< 40'),
}


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
    print(f'{"figure":<{width}} {"value":>11} {"unit":<9}target')
    for name, value in figures.items():
        unit, meaning, target = FIGURES.get(name, Figure('', ''))
        row = f'{name:<{width}} {value:11.5g} {unit:<9}{target:<9}'
        # A meaning for which 80 columns leave no room is below.
        beside = len(row) + 1 + len(meaning) <= 80
        lines = [f'{row} {meaning}'] if beside else [row, *wrapped('   ', meaning)]
        print('\n'.join(line.rstrip() for line in lines))
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
