# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Arguments of commands on vibration files: files, bearing, speed, channel, unit."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
import itertools
import math
import os
from pathlib import Path
from typing import Any

from bearing_twin.bearing import Bearing, find_bearing, named_bearing, own_bearing
from bearing_twin.cli.arguments import file_name, refuse_given
from bearing_twin.errors import refused, UsageError
from bearing_twin.recording.finding import ending, find_recording, SIGNAL_FILES
from bearing_twin.recording.signals.dataset import chosen_signals, is_dataset

SIGNAL_OPTIONS = ('bearing', 'geometry', 'shaft_hz', 'rpm', 'sample_rate', 'channel', 'unit')
"""Options that describe vibration files."""
FASTEST = 1e5
"""Upper limit of the shaft speed, Hz."""
UNITS = ('m/s^2', 'g')


def add_signal_arguments(parser: argparse.ArgumentParser) -> None:
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument(
        '--bearing', metavar='NAME', help="bearing of the catalogue, e.g. 6205 (see 'bearings')"
    )
    kind.add_argument(
        '--geometry',
        metavar='Z,BALL,PITCH,ANGLE',
        help='number of balls, ball and pitch diameter in mm, contact angle in degrees; or the '
        "maker's fault orders, BPFO=5.97,BPFI=8.03,BSF=3.34",
    )
    speed = parser.add_mutually_exclusive_group()
    speed.add_argument('--shaft-hz', type=float, help='shaft speed, Hz; else what the file says')
    speed.add_argument('--rpm', type=float, help='shaft speed in turns a minute')
    parser.add_argument(
        '--sample-rate', type=float, help='sample rate, Hz; else what the file says'
    )
    parser.add_argument(
        '--channel',
        metavar='NAME',
        help='name, number or topic, or any part that only one has; words of ids in a data set',
    )
    parser.add_argument(
        '--unit', choices=UNITS, default='', help='unit of the samples; else what the file says'
    )


def add_reading(parser: argparse.ArgumentParser) -> None:
    """Add the arguments for the files and how they are read."""
    parser.add_argument(
        'files',
        nargs='+',
        type=file_name,
        metavar='FILE',
        help=f'{" ".join(SIGNAL_FILES)} .mcap, or a folder made by bearing-datasets',
    )
    add_signal_arguments(parser)


def given_bearing(args: argparse.Namespace) -> Bearing | None:
    """Return the bearing that was given; None if none was."""
    with refused():
        if args.geometry:
            return own_bearing(args.geometry)
        return find_bearing(args.bearing) if args.bearing else None


def given_speed(args: argparse.Namespace) -> float:
    """Return the speed that was given, Hz; NaN if none was."""
    name, given, factor = ('--rpm', args.rpm, 1.0 / 60.0)
    if given is None:
        name, given, factor = ('--shaft-hz', args.shaft_hz, 1.0)
    if given is None:
        return math.nan
    shaft_hz: float = factor * given
    if not 0.0 < shaft_hz < FASTEST:
        msg = f'{name} {given:g}: give a speed above 0 and below {FASTEST / factor:g}'
        raise UsageError(msg)
    return shaft_hz


def channels_of(name: str, channel: str | None) -> list[str | None]:
    """Return the channels of a file; of a data set those of :func:`chosen_signals`."""
    if not is_dataset(Path(name)):
        return [channel]
    return [str(row['signal_id']) for row in chosen_signals(Path(name), channel)]


def unread(path: str, reason: str) -> dict[str, Any]:
    """Return the answer for a file that cannot be read."""
    return {'file': path, 'error': reason if path in reason else f'{path}: {reason}'}


def pictures_of(
    folder: Path, signals: Sequence[tuple[str, str | None]], ending: str = '.png'
) -> list[Path]:
    """
    Return the path of a picture for each signal (its file, and its channel in a data set).

    The name has the whole path of the file. Where different signals would have the same name, such
    as ``a/b_c.npz`` and ``a_b/c.npz``, the later ones are numbered from 2 on.

    >>> signals = [('a/b_c.npz', None), ('a_b/c.npz', None), ('a/b_c.npz', None)]
    >>> [path.name for path in pictures_of(Path('plots'), signals)]
    ['a_b_c.npz.png', 'a_b_c.npz_2.png', 'a_b_c.npz.png']

    """
    pictures: dict[tuple[str, str | None], Path] = {}
    taken: set[str] = set()
    for name, channel in dict.fromkeys(signals):
        parts = f'{Path(name)}_{channel}' if is_dataset(Path(name)) else str(Path(name))
        flat = parts.strip('/').replace('/', '_')
        numbered = (f'{flat}_{n}{ending}' for n in itertools.count(2))
        names = itertools.chain((f'{flat}{ending}',), numbered)
        picture = next(each for each in names if each not in taken)
        taken.add(picture)
        pictures[name, channel] = folder / picture
    return [pictures[signal] for signal in signals]


def as_recordings(paths: Sequence[Path], args: argparse.Namespace, folder: Path) -> list[Path]:
    """
    Return a recording or Rerun file for each path.

    A vibration file becomes a recording in ``folder``, with the verdicts of the diagnosis. Options
    that describe such files raise an error if there is none.
    """
    if not any(map(_is_signal, paths)):
        kinds = f'{", ".join(SIGNAL_FILES)} and Parquet sets'
        refuse_given(args, SIGNAL_OPTIONS, f'for {kinds} only; a recording says it itself')
    # Each has a folder of its own, since files may have the same name.
    return [_as_recording(path, args, folder / str(k)) for k, path in enumerate(paths)]


def _is_signal(path: Path) -> bool:
    return ending(path) in SIGNAL_FILES or is_dataset(path)


def _as_recording(path: Path, args: argparse.Namespace, folder: Path) -> Path:
    if not _is_signal(path):
        return find_recording(path)
    # Loaded when needed: the messages and scipy take a second.
    from bearing_twin.offline.signal_run import record_signal
    from bearing_twin.recording.signals.signalfile import read_signal

    signal = read_signal(path, channel=args.channel, sample_rate=args.sample_rate)
    bearing = given_bearing(args) or signal.bearing or named_bearing(signal.bearing_name)
    folder.mkdir()
    # The name of a recording is UTF-8, and its ending may be longer than that of the file.
    stem = os.fsencode(path.stem)[:200].decode(errors='replace')
    target = folder / f'{stem}.mcap'
    record_signal(signal, target, bearing, given_speed(args), unit=args.unit)
    return target
