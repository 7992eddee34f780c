# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin schedule``: write the temperature schedule of the paper as a recording."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.cli.arguments import refuse_topic
from bearing_twin.recording.schedule import paper_schedule, write_temperature_recording

if TYPE_CHECKING:
    import argparse


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '-o', '--output', type=Path, required=True, help='recording to make; never overwritten'
    )
    parser.add_argument(
        '--duration', type=float, default=40.0, help='time from 20 to 110 degC in s (default 40)'
    )
    parser.add_argument('--topic', default='/temperature', help='default /temperature')


def run(args: argparse.Namespace) -> int:
    """Write the recording."""
    refuse_topic(args.topic)
    times, temperatures = paper_schedule(args.duration)
    source = 'schedule of the paper: 20 to 110 degC in proportion to time'
    write_temperature_recording(args.output, times, temperatures, source=source, topic=args.topic)
    print(
        f'{args.output}: {times.size} readings over {times[-1]:.1f} s, '
        f'{temperatures.min():.1f}..{temperatures.max():.1f} degC'
    )
    return 0
