# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin schedule``: write a temperature as a recording to replay."""

from __future__ import annotations

import argparse
from pathlib import Path

from bearing_twin.cli.arguments import refuse_given, refuse_topic
from bearing_twin.errors import refused
from bearing_twin.recording.dates import ORDERS
from bearing_twin.recording.temperature import (
    paper_schedule,
    read_temperatures,
    START,
    write_temperature_recording,
)
import numpy as np


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '-o', '--output', type=Path, required=True, help='recording to make; never overwritten'
    )
    parser.add_argument(
        '--from', type=Path, metavar='FILE', dest='measured',
        help="a measured temperature instead of the paper's: .csv with a column of times (s, or "
             'dates) and one in degC, or .npz with temp_t_s and temp_C',
    )  # fmt: skip
    parser.add_argument(
        '--dates', choices=ORDERS, default='', help='order of dates such as 04/03/2026 in --from'
    )
    parser.add_argument(
        '--duration', type=float, default=40.0, help='time from 20 to 110 degC in s (default 40)'
    )
    parser.add_argument('--topic', default='/temperature', help='default /temperature')


def run(args: argparse.Namespace) -> int:
    """Write the recording."""
    refuse_topic(args.topic)
    if args.measured:
        refuse_given(args, ('duration',), 'not with --from, which has its own')
        times, temperatures, start = read_temperatures(args.measured, args.dates)
        source = f'measured, {args.measured.name}'
    else:
        refuse_given(args, ('dates',), 'only with --from')
        with refused():
            (times, temperatures), start = paper_schedule(args.duration), START
        source = 'schedule of the paper: 20 to 110 degC in proportion to time'
    write_temperature_recording(
        args.output, times, temperatures, source=source, topic=args.topic, start=start
    )
    print(
        f'{args.output}: {times.size} readings over {times[-1]:.1f} s, '
        f'{np.nanmin(temperatures):.1f}..{np.nanmax(temperatures):.1f} degC'
    )
    return 0
