# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read the snapshots of one machine in order of time, from many files or a few tables."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
import math
from pathlib import Path
import re
from typing import Any

from bearing_twin.errors import BearingTwinError
from bearing_twin.given import real_numbers
from bearing_twin.recording.finding import ending, natural, SIGNAL_FILES
from bearing_twin.recording.mcap.mcapfile import refuse_special
from bearing_twin.recording.reader import recording_info
from bearing_twin.recording.signals.csvfile import csv_start
from bearing_twin.recording.signals.dataset import chosen_signals, is_dataset
from bearing_twin.recording.signals.lvmfile import lvm_start
from bearing_twin.recording.signals.npz import read_npz, temperature_readings
from bearing_twin.recording.signals.reading import clock_time
from bearing_twin.recording.signals.signalfile import read_signal, Signal
from bearing_twin.recording.signals.tdmsfile import tdms_start
from bearing_twin.recording.signals.ufffile import uff_start
from bearing_twin.stamps import NANO
import numpy as np
from numpy.typing import NDArray

NAMED_TIME = re.compile(
    r'(?<!\d)((?:19|20)\d\d)[-_.]?(\d\d)[-_.]?(\d\d)[-_.T ]?(\d\d)[-_.]?(\d\d)[-_.]?(\d\d)(?!\d)'
)
"""Date and time (year to second) in the name of a file."""
STARTS: dict[str, Callable[[Path], float | None]] = {
    '.mcap': lambda path: recording_info(path).start / NANO,
    '.tdms': tdms_start,
    '.uff': uff_start,
    '.unv': uff_start,
    '.lvm': lvm_start,
    **dict.fromkeys(('.csv', '.txt', '.tsv'), csv_start),
}
"""How the time at which a file begins is read, s since 1970, by its suffix; None if unknown."""


@dataclass(frozen=True)
class Snapshot:
    """One short signal and its time."""

    time: float
    """Time, s; the files define the origin."""
    signal: Signal


@dataclass(frozen=True)
class _Stated:
    """What the files of a series say of times and temperatures."""

    times: dict[Path, NDArray[np.float64]]
    """Times of the snapshots of a file, s."""
    complete: bool
    """Whether every file with snapshots has times."""
    heat_times: NDArray[np.float64]
    """Times of the temperatures, s, rising, shape (n,)."""
    heat: NDArray[np.float64]
    """Temperatures, degC, shape (n,)."""

    def temperature(self, time: float) -> float:
        """Return the temperature at a time, degC; NaN outside the recorded times."""
        known = len(self.heat) and self.heat_times[0] <= time <= self.heat_times[-1]
        return float(np.interp(time, self.heat_times, self.heat)) if known else math.nan


def series_files(paths: Sequence[Path]) -> list[Path]:
    """Return the files of a series: files as given, and those in folders in natural order."""
    endings = (*SIGNAL_FILES, '.mcap')
    files: list[Path] = []
    for path in paths:
        if path.is_dir() and not is_dataset(path):
            inside = (item for item in path.iterdir() if ending(item) in endings)
            files += sorted(inside, key=lambda item: natural(item.name))
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

    An ``.npz`` file may hold many snapshots: one in each row of ``x``, and their times in ``t_s``.
    A file with ``temp_t_s`` and ``temp_C`` gives the temperature for all snapshots. A folder of
    ``bearing-datasets`` holds many snapshots, with their times in ``time_s`` of its table. Any
    other file is one snapshot. Its time is ``time_s`` in the file, or else its position in the
    order times ``cycle``. Without a cycle it is the time of the first message of an MCAP file,
    ``wf_start_time`` of a .tdms file, date and time in the header of a .uff or .lvm file or in the
    first row of a .csv, .txt or .tsv file, or else the date and time in the file name. If all
    files have times, their order does not matter.

    Parameters
    ----------
    files
        Files in order of time; see :func:`series_files`.
    channel, sample_rate
        See :func:`bearing_twin.recording.signals.signalfile.read_signal`.
    cycle
        Interval of the snapshots, s, if the files do not state their times.
    unread
        Called with the error of a file, which is then skipped. With None the error is raised.

    Raises
    ------
    BearingTwinError
        If a file cannot be read, the time of a snapshot is unknown, or times and temperatures are
        no numbers or not as many.

    Examples
    --------
    >>> from datetime import datetime, timezone
    >>> time = _named_time('2004.02.12.10.32.39.csv')
    >>> str(datetime.fromtimestamp(time, tz=timezone.utc))
    '2004-02-12 10:32:39+00:00'

    """
    stated = _stated(files, cycle)
    if stated.complete:
        files = sorted(files, key=lambda path: min(stated.times.get(path, ()), default=-math.inf))
    number = 0
    for path in files:
        signals = _of_file(path, stated.times.get(path), channel, sample_rate)
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
            if not math.isfinite(signal.temperature):
                signal = replace(signal, temperature=stated.temperature(time))
            yield Snapshot(time, signal)


def _stated(files: Sequence[Path], cycle: float | None) -> _Stated:
    """Read the times and temperatures of a series, without its samples."""
    times: dict[Path, NDArray[np.float64]] = {}
    complete = True
    heat_times, heat = [np.zeros(0)], [np.zeros(0)]
    for path in files:
        said: dict[str, Any] = {}
        try:
            if path.suffix.lower() == '.npz':
                said = read_npz(path, ('temp_t_s', 'temp_C', 't_s', 'time_s'))
            elif cycle is None and path.suffix.lower() in STARTS:
                refuse_special(path)
                start = STARTS[path.suffix.lower()](path)
                said = {} if start is None else {'time_s': start}
        except BearingTwinError:
            # The error is reported when the file is read for its snapshots.
            continue
        if 'temp_t_s' in said and 'temp_C' in said:
            readings = temperature_readings(path, said)
            heat_times.append(readings[0])
            heat.append(readings[1])
        stamps = said.get('t_s', said.get('time_s'))
        if stamps is None and cycle is None:
            stamps = _named_time(path.name)
        if stamps is not None:
            times[path] = real_numbers(f'{path}: its time', stamps).ravel()
        elif 'temp_C' not in said:
            complete = False
    when = np.concatenate(heat_times)
    order = np.argsort(when, kind='stable')
    return _Stated(times, complete, when[order], np.concatenate(heat)[order])


def _named_time(name: str) -> float | None:
    """Return date and time in a file name, s since 1970 in UTC; None if there is none."""
    found = NAMED_TIME.search(name)
    return clock_time(' '.join(found.groups()), '%Y %m %d %H %M %S') if found else None


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
    """Return ids and times (s) of the signals of one sensor, in order of time."""
    rows = chosen_signals(path, channel)
    sensors = {f'{row.get("run_id", "")} {row.get("channel", "")}'.strip() for row in rows}
    if len(sensors) > 1:
        listed = ', '.join(sorted(sensors)[:10])
        msg = f'{path} holds {len(sensors)} sensors ({listed}); --channel WORDS of the ids of one'
        raise BearingTwinError(msg)
    signals = [(str(row['signal_id']), row.get('time_s')) for row in rows]
    return sorted(signals, key=lambda signal: signal[1] or 0.0)
