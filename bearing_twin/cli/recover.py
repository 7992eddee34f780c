# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin recover``: save the complete messages of a damaged recording."""

from __future__ import annotations

import argparse
from dataclasses import asdict
import json
from pathlib import Path

from bearing_twin.errors import shown
from bearing_twin.recording.recover import recover


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('recording', type=Path, help='MCAP file or bag folder; it is not changed')
    parser.add_argument(
        '-o',
        '--output',
        type=Path,
        help='recording to make; never overwritten (default: NAME_recovered beside it)',
    )
    parser.add_argument('--json', action='store_true', help='print the result as JSON')


def run(args: argparse.Namespace) -> int:
    """Recover; return 0 if anything was saved."""
    source: Path = args.recording
    if not source.name or source.name == '..':
        source = source.resolve()
    target = args.output or source.with_name(f'{source.stem}_recovered{source.suffix}')
    report = recover(source, target)
    if args.json:
        print(json.dumps({**asdict(report), 'duration': report.duration}, default=str))
        return 0 if report.kept else 1
    print(f'kept    {report.kept} messages over {report.duration:.3f} s in {target}')
    for topic, count in sorted(report.topics.items()):
        print(f'        {count:8d}  {shown(topic)}')
    if not report.losses:
        print('lost    nothing')
    for loss in report.losses:
        print(f'lost    {shown(loss)}')
    if report.lost_bytes:
        print(f'        {report.lost_bytes} of {report.size} bytes cannot be read')
    if report.unlisted_losses:
        print(f'        and {report.unlisted_losses} further losses')
    if report.lost_messages:
        print(f"        {report.lost_messages} messages are missing by the files' own count")
    return 0 if report.kept else 1
