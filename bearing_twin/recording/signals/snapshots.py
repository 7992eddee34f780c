# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Snapshots of one machine in order of time, out of many files or out of tables in few."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import datetime, timezone
import math
import re
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.finding import natural, SIGNAL_FILES
from bearing_twin.recording.reader import recording_info
from bearing_twin.recording.signals.dataset import chosen_signals, is_dataset
from bearing_twin.recording.signals.foreign import read_signal, Signal
from bearing_twin.recording.signals.npz import read_npz
from bearing_twin.stamps import NANO
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray


NAMED_TIME = re.compile(
    r'(?<!\d)((?:19|20)\d\d)[-_.]?(\d\d)[-_.]?(\d\d)[-_.T ]?(\d\d)[-_.]?(\d\d)[-_.]?(\d\d)(?!\d)'
)
"""Year to second in the name of a file."""


@dataclass(frozen=True)
class Snapshot:
    """One short signal and when it was taken."""

    time: float
    """s, from wherever the files count."""
    signal: Signal


@dataclass(frozen=True)
class _Temperatures:
    times: NDArray[np.float64]
    values: NDArray[np.float64]

    def at(self, time: float) -> float:
        """Temperature at a time within the recorded ones, degC; NaN outside or without any."""
        if not len(self.times) or not self.times[0] <= time <= self.times[-1]:
            return math.nan
        return float(np.interp(time, self.times, self.values))


def series_files(paths: Sequence[Path]) -> list[Path]:
    """Return the files of a series: those named, and those in named folders in natural order."""
    endings = (*SIGNAL_FILES, '.mcap')
    files: list[Path] = []
    for path in paths:
        if path.is_dir() and not is_dataset(path):
            inside = (item for item in path.iterdir() if item.suffix.lower() in endings)
            files += sorted(inside, key=natural)
        else:
            files.append(path)
    if not files:
        msg = f'{", ".join(map(str, paths))}: no file ends in {", ".join(endings)}'
        raise BearingTwinError(msg)
    return files


def read_snapshots(
    files: Sequence[Path],
    *,
    channel: str | None = None,
    sample_rate: float | None = None,
    cycle: float | None = None,
    unread: Callable[[BearingTwinError], object] | None = None,
) -> Iterator[Snapshot]:
    """
    Yield the snapshots of one machine, one file in memory at a time.

    An ``.npz`` file may hold many: ``x`` with one in each row, and their times ``t_s``. A file
    with ``temp_t_s`` and ``temp_C`` gives the temperature of all. A folder made by
    ``bearing-datasets`` holds many; ``time_s`` in its table is their time. Any other file is one
    snapshot; its time is ``time_s`` in it, or its place in the order times ``cycle``. Without a
    cycle it is that of the first message of an MCAP file, or date and time in the name. Where all
    files have times they may be in any order.

    Parameters
    ----------
    files
        In order of time; see :func:`series_files`.
    channel, sample_rate
        See :func:`bearing_twin.recording.signals.foreign.read_signal`.
    cycle
        Seconds from one snapshot to the next, where the files do not say their times.
    unread
        Called with what is wrong with a file, which is then left out; None: it is raised.

    Raises
    ------
    BearingTwinError
        If a file cannot be read, or no time of a snapshot is known.

    Examples
    --------
    >>> from datetime import datetime, timezone
    >>> time = _named_time('2004.02.12.10.32.39.csv')
    >>> str(datetime.fromtimestamp(time, tz=timezone.utc))
    '2004-02-12 10:32:39+00:00'

    """
    times, values = [], []
    tables: dict[Path, NDArray[np.float64]] = {}
    timed = True
    for path in files:
        said: dict[str, Any] = {}
        try:
            if path.suffix.lower() == '.npz':
                said = read_npz(path, ('temp_t_s', 'temp_C', 't_s', 'time_s'))
            elif path.suffix.lower() == '.mcap' and cycle is None:
                said = {'time_s': recording_info(path).start / NANO}
        except BearingTwinError:
            # It is told when it is its turn.
            continue
        if 'temp_t_s' in said and 'temp_C' in said:
            times.append(np.asarray(said['temp_t_s'], dtype=np.float64))
            values.append(np.asarray(said['temp_C'], dtype=np.float64))
        stamps = said.get('t_s', said.get('time_s'))
        if stamps is None and cycle is None:
            stamps = _named_time(path.name)
        if stamps is not None:
            tables[path] = np.atleast_1d(np.asarray(stamps, dtype=np.float64))
        elif 'temp_C' not in said:
            timed = False
    if timed:
        files = sorted(files, key=lambda path: min(tables.get(path, ()), default=-math.inf))
    heat = _Temperatures(*_merged(times, values))
    number = 0
    for path in files:
        signals = _of_file(path, tables.get(path), channel, sample_rate)
        while True:
            try:
                signal, stamp = next(signals)
            except StopIteration:
                break
            except BearingTwinError as error:
                if unread is None:
                    raise
                unread(error)
                number += 1
                break
            if stamp is None and cycle is None:
                msg = f'{path} does not say when it was taken; give --cycle SECONDS'
                raise BearingTwinError(msg)
            time = number * (cycle or 0.0) if stamp is None else stamp
            number += 1
            known = signal.temperature
            yield Snapshot(
                time,
                signal if math.isfinite(known) else replace(signal, temperature=heat.at(time)),
            )


def _named_time(name: str) -> float | None:
    """Date and time in a name, s since 1970 in UTC; None where there is none."""
    found = NAMED_TIME.search(name)
    try:
        when = datetime.strptime(' '.join(found.groups()), '%Y %m %d %H %M %S') if found else None
    except ValueError:
        return None
    return when.replace(tzinfo=timezone.utc).timestamp() if when else None


def _of_file(
    path: Path, stamps: NDArray[np.float64] | None, channel: str | None, sample_rate: float | None
) -> Iterator[tuple[Signal, float | None]]:
    if is_dataset(path):
        for name, time in _of_dataset(path, channel):
            yield read_signal(path, channel=name, sample_rate=sample_rate), time
        return
    if path.suffix.lower() == '.npz':
        arrays = read_npz(path)
        table = arrays.get(channel or 'x')
        if table is None and 'temp_C' in arrays:
            return
        if table is not None and table.ndim == 2 and stamps is not None and len(stamps) > 1:
            if len(stamps) != len(table):
                msg = f'{path}: {len(table)} snapshots and {len(stamps)} times (t_s); one each'
                raise BearingTwinError(msg)
            first = read_signal(path, channel=f'{channel or "x"}:0', sample_rate=sample_rate)
            for row, stamp in zip(table, stamps, strict=True):
                yield replace(first, x=np.asarray(row, dtype=np.float64)), float(stamp)
            return
    signal = read_signal(path, channel=channel, sample_rate=sample_rate)
    yield signal, float(stamps[0]) if stamps is not None and len(stamps) == 1 else None


def _of_dataset(path: Path, channel: str | None) -> list[tuple[str, float | None]]:
    """Signals of one sensor and their times, in order of time."""
    rows = chosen_signals(path, channel)
    sensors = {f'{row.get("run_id", "")} {row.get("channel", "")}'.strip() for row in rows}
    if len(sensors) > 1:
        listed = ', '.join(sorted(sensors)[:10])
        msg = f'{path} holds {len(sensors)} sensors ({listed}); --channel WORDS of the ids of one'
        raise BearingTwinError(msg)
    signals = [(str(row['signal_id']), row.get('time_s')) for row in rows]
    return sorted(signals, key=lambda signal: signal[1] or 0.0)


def _merged(
    times: list[NDArray[np.float64]], values: list[NDArray[np.float64]]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if not times:
        return np.zeros(0), np.zeros(0)
    when, what = np.concatenate(times), np.concatenate(values)
    order = np.argsort(when, kind='stable')
    return when[order], what[order]
