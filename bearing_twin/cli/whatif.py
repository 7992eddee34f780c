# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin whatif``: what a fitted machine would show under other conditions."""

from __future__ import annotations

import argparse
from contextlib import nullcontext
from dataclasses import asdict
import json
from pathlib import Path
import sys
from typing import TYPE_CHECKING

from bearing_twin.calibration import Calibration
from bearing_twin.calibration.whatif import expect
from bearing_twin.cli.arguments import file_name
from bearing_twin.cli.fit import load_range, outer_ring, seed
from bearing_twin.cli.terminal import wrapped
from bearing_twin.errors import BearingTwinError, shown

if TYPE_CHECKING:
    from bearing_twin.calibration.whatif import Interval


MOST_TEXT = 2**26
"""Most characters of a file of fits; a fit has some thousand."""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        'fit', type=file_name, metavar='FIT', help="what 'fit --json' wrote; '-' for stdin"
    )
    parser.add_argument('--speed', type=float, metavar='HZ', help='shaft speed, Hz')
    parser.add_argument('--load', type=load_range, metavar='N', help='one load or LOW,HIGH, N')
    parser.add_argument('--temperature', type=outer_ring, help='of the outer ring, degC')
    parser.add_argument('--width', type=float, metavar='MM', help='of the defect, mm')
    parser.add_argument('--seed', type=seed, default=0, help='of all draws (default 0)')
    parser.add_argument('--json', action='store_true', help='one JSON object a fitted file')


def run(args: argparse.Namespace) -> int:
    """Print the expected vibration and verdicts of each machine in the file."""
    for values in _fits(args.fit):
        try:
            found = Calibration.from_dict(values)
        except BearingTwinError as error:
            raise BearingTwinError(f'{args.fit}: {error}') from None
        expected = expect(
            found, shaft_hz=args.speed, load=args.load, temperature=args.temperature,
            width_mm=args.width, seed=args.seed,
        )  # fmt: skip
        if args.json:
            print(json.dumps({'file': values.get('file', ''), **asdict(expected)}), flush=True)
            continue
        machine = f'{shown(str(values.get("file", "")))}: {shown(found.statement)}'
        print(*wrapped('', machine), sep='\n')
        low, high = expected.load
        narrow, wide = expected.width_mm
        width = f'{narrow:.2f}' if narrow == wide else f'{narrow:.2f} to {wide:.2f}'
        defect = f', a defect of {width} mm' if wide else ''
        print(
            f'expected at {expected.shaft_hz:g} Hz, {expected.temperature:g} degC, '
            f'{low:.0f} to {high:.0f} N{defect}'
        )
        for name, figure in expected.vibration.items():
            _print(name, figure, figure.unit)
        for name, share in expected.verdicts.items():
            _print(f'verdict {name}', share, 'of the machines')
    return 0


def _print(name: str, figure: Interval, unit: str) -> None:
    interval = f'({figure.q05:.4g} to {figure.q95:.4g})'
    print(f'    {name:<22} {figure.median:>10.4g}  {interval} {unit}'.rstrip())


def _fits(name: str) -> list[dict[str, object]]:
    """Return the objects of a file of JSON lines."""
    remedy = "write one with 'bearing-twin fit FILE --json > FIT'"
    try:
        with nullcontext(sys.stdin) if name == '-' else Path(name).open(encoding='utf-8') as file:
            text = file.read(MOST_TEXT + 1)
        if len(text) > MOST_TEXT:
            raise ValueError(f'more than {MOST_TEXT} characters')
        rows = [json.loads(line) for line in text.splitlines() if line.strip()]
    except OSError as error:
        raise BearingTwinError(f'{name} cannot be read: {error.strerror}') from None
    except (ValueError, RecursionError) as error:
        raise BearingTwinError(f'{name} holds no fit ({error}); {remedy}') from None
    # The joint result of several records is not a machine to run.
    rows = [row for row in rows if not isinstance(row, dict) or 'files' not in row]
    if not rows or not all(isinstance(row, dict) for row in rows):
        raise BearingTwinError(f'{name} holds no fit; {remedy}')
    for row in rows:
        if 'error' in row:
            raise BearingTwinError(f'{name} holds no fit, but an error: {row["error"]}')
    return rows
