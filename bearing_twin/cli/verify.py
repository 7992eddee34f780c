# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin verify``: re-run a recording and compare it byte by byte."""

from __future__ import annotations

from dataclasses import asdict
import json
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.nodes.reproduce import reproduce

if TYPE_CHECKING:
    import argparse

__all__ = ['configure', 'run']


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument('recording', type=Path, help='recording of twin and diagnosis')
    parser.add_argument('--json', action='store_true', help='print the result as JSON')


def run(args: argparse.Namespace) -> int:
    """Compare; status 0 if something was compared and all of it was identical."""
    result = reproduce(args.recording)
    if args.json:
        print(json.dumps({**asdict(result), 'identical': result.identical}, default=str))
        return 0 if result.identical else 1
    for topic, agreement in sorted(result.topics.items()):
        print(
            f'{topic:<16} {agreement.identical} identical, {agreement.different} different, '
            f'{agreement.skipped} not re-run'
        )
        if agreement.first_difference:
            print(f'{"":<16} first difference: {agreement.first_difference}')
    for note in result.notes:
        print(f'note             {note}')
    print('identical to the byte' if result.identical else 'NOT identical')
    return 0 if result.identical else 1
