# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin fit``: estimate the twin's parameters from vibration files, with intervals."""

from __future__ import annotations

import argparse
import contextlib
from dataclasses import asdict
import json
import math
from pathlib import Path
import sys
from textwrap import wrap
from typing import TYPE_CHECKING

from bearing_twin.bearing import named_bearing
from bearing_twin.calibration import Calibration, fit
from bearing_twin.calibration.joint import common_width
from bearing_twin.calibration.residual import MOVED
from bearing_twin.cli.arguments import file_name
from bearing_twin.cli.signal_arguments import (
    add_reading,
    channels_of,
    given_bearing,
    given_speed,
    pictures_of,
    unread,
)
from bearing_twin.cli.terminal import clear_progress, progress, wrapped
from bearing_twin.errors import BearingTwinError, shown
from bearing_twin.quantity import signed
from bearing_twin.recording.signals.signalfile import read_signal
from bearing_twin.thermal.gcr15 import TABLE_HIGH, TABLE_LOW
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.recording.signals.signalfile import Signal


def configure(parser: argparse.ArgumentParser) -> None:
    add_reading(parser)
    parser.add_argument(
        '--load',
        type=load_range,
        metavar='LOW,HIGH',
        help='range of the radial load, N (default: 0.003 to 0.1 of the dynamic rating)',
    )
    parser.add_argument(
        '--temperature',
        type=outer_ring,
        help='of the outer ring, degC; else what the file says, or 30',
    )
    parser.add_argument(
        '--place',
        choices=('none', 'inner', 'outer'),
        help='part with the defect (default: what the diagnosis says)',
    )
    parser.add_argument(
        '--one-machine',
        action='store_true',
        help='the files are of one machine at several speeds: compare them, and give one width',
    )
    parser.add_argument('--seed', type=seed, default=0, help='of all draws (default 0)')
    parser.add_argument('--json', action='store_true', help='one JSON object a file')
    parser.add_argument(
        '--plot', type=file_name, metavar='DIR', help='draw machine against twin, and the width'
    )


def run(args: argparse.Namespace) -> int:
    """Fit the twin to each file; return 0 only if every file could be fitted."""
    bearing, speed = given_bearing(args), given_speed(args)
    tasks = [(name, channel) for name in args.files for channel in channels_of(name, args.channel)]
    # Beside the pictures that diagnose makes of the same files.
    plots = pictures_of(Path(args.plot or ''), tasks, '.fit.png')
    failed = 0
    fitted: list[tuple[str, str, Calibration]] = []
    for done, (name, channel) in enumerate(tasks, start=1):
        try:
            record = read_signal(Path(name), channel=channel, sample_rate=args.sample_rate)
            found = _fit(args, name, record, bearing, speed)
        except (BearingTwinError, MemoryError) as error:
            failed += 1
            clear_progress(len(tasks))
            answer = unread(name, str(error) or 'not enough memory')
            print(f'bearing-twin fit: {shown(answer["error"])}', file=sys.stderr, flush=True)
            if args.json:
                print(json.dumps(answer), flush=True)
            continue
        clear_progress(len(tasks))
        if args.one_machine:
            fitted.append((name, record.source, found))
        else:
            _print(name, record.source, found, as_json=args.json)
        if args.plot:
            from bearing_twin.cli.plots import draw_calibration

            try:
                draw_calibration(found, record.x, record.sample_rate, plots[done - 1])
            except BearingTwinError as error:
                # The fit took a minute: it is printed even if its picture fails.
                failed += 1
                print(f'bearing-twin fit: {error}', file=sys.stderr, flush=True)
        progress(done, len(tasks), 'files')
    if fitted:
        _print_joined(fitted, as_json=args.json)
    return 1 if failed else 0


def _fit(
    args: argparse.Namespace, name: str, record: Signal, bearing: Bearing | None, speed: float
) -> Calibration:
    """Return the fit to a record; bearing and speed (Hz; NaN: none) replace those of the file."""
    if not math.isfinite(speed):
        _check_steady(name, record)
        speed = record.shaft_hz
    return fit(
        record.x,
        record.sample_rate,
        bearing or record.bearing or named_bearing(record.bearing_name),
        speed,
        load=args.load,
        temperature=record.temperature if args.temperature is None else args.temperature,
        unit=args.unit or record.unit,
        place=args.place,
        seed=args.seed,
    )


def _check_steady(name: str, record: Signal) -> None:
    """Raise if the speed in the file of a record varies too much."""
    if len(record.speeds) and np.ptp(record.speeds) > MOVED * record.shaft_hz:
        slowest, fastest = record.speeds.min(), record.speeds.max()
        raise BearingTwinError(
            f'{name}: the speed moves from {slowest:.3g} to {fastest:.3g} Hz, more than '
            f'{100.0 * MOVED:g} %: give a part at a steady speed'
        )


def _print(name: str, source: str, found: Calibration, *, as_json: bool) -> None:
    if as_json:
        answer = {'file': name, 'source': source, **found.to_dict()}
        print(json.dumps(answer, allow_nan=False), flush=True)
    else:
        print(_page(source, found), flush=True)


def _print_joined(fitted: list[tuple[str, str, Calibration]], *, as_json: bool) -> None:
    """Print the fit of each record given the others, and the joint result."""
    names = [name for name, _, _ in fitted]
    try:
        records, width, statement = common_width([found for _, _, found in fitted])
    except BearingTwinError:
        # The fits took minutes: they are printed even if they cannot be joined.
        for name, source, found in fitted:
            _print(name, source, found, as_json=as_json)
        raise
    for (name, source, _), found in zip(fitted, records, strict=True):
        _print(name, source, found, as_json=as_json)
    if as_json:
        together = {
            'files': names,
            'statement': statement,
            'quantities': {'defect_width_mm': asdict(width)},
        }
        print(json.dumps(together), flush=True)
    else:
        print(f'together  {statement}: {width.why}')


def load_range(text: str) -> tuple[float, float]:
    """Return a range from ``LOW,HIGH``, or from one number."""
    low, _, high = text.partition(',')
    try:
        return float(low), float(high or low)
    except ValueError:
        msg = f'{text!r}: give a load in N, or the least and the largest as LOW,HIGH'
        raise argparse.ArgumentTypeError(msg) from None


def outer_ring(text: str) -> float:
    """Return the temperature of an outer ring, degC."""
    with contextlib.suppress(ValueError):
        if TABLE_LOW <= (value := float(text)) <= TABLE_HIGH:
            return value
    raise argparse.ArgumentTypeError(
        f'{text!r}: give degC from {TABLE_LOW:g} to {TABLE_HIGH:g}, in which the steel of the '
        'twin is known; of a bearing beyond, the nearer end'
    )


def seed(text: str) -> int:
    """Return the seed of all draws."""
    with contextlib.suppress(ValueError):
        if (value := int(text)) >= 0:
            return value
    raise argparse.ArgumentTypeError(f'{text!r}: give a whole number from 0 on')


def _page(source: str, found: Calibration) -> str:
    """Return the calibration as text."""
    before = '' if math.isnan(found.level_before) else f'{signed(found.level_before)} -> '
    lines = [
        *wrapped('', f'{shown(source)}: {found.statement}'),
        f'spectrum  log-spectral distance {found.distance_before:.1f} -> {found.distance:.1f} dB, '
        f'level {before}{signed(found.level)} dB',
        f'cost      {found.cost_s:.1f} s of one core',
        '',
        f'{"quantity":<20} {"5 %":>10} {"median":>10} {"95 %":>10}  identifiable, unit',
    ]
    reasons: dict[str, list[str]] = {}
    for quantity, value in found.quantities.items():
        lines.append(
            f'{quantity:<20} {value.q05:>10.4g} {value.median:>10.4g} {value.q95:>10.4g}  '
            f'{"yes" if value.identifiable else "no":<3} '
            f'{value.unit.replace("unit of the samples", "unit")}'.rstrip()
        )
        reasons.setdefault(value.why, []).append(quantity)
    # Many quantities share a reason, and a row with its own would be too wide.
    for reason, quantities in reasons.items():
        lines += ['', *wrap(f'{", ".join(quantities)}: {reason}', 78)]
    return '\n'.join(lines)
