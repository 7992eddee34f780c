# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Temperature recordings: from a table of a logger, or the schedule of the paper."""

from __future__ import annotations

import math
from pathlib import Path
import re
from typing import NamedTuple

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.dates import seconds_since_1970, with_iso_dates
from bearing_twin.recording.mcap.schema import standard_types
from bearing_twin.recording.qos import sensor_qos
from bearing_twin.recording.signals.csvfile import fields_of, HEAD, table_text, unit_in
from bearing_twin.recording.signals.npz import read_npz, temperature_readings
from bearing_twin.recording.signals.timecolumn import DATED, SECONDS, unit_of
from bearing_twin.recording.topics import TEMPERATURE
from bearing_twin.recording.writer import whole_recording
from bearing_twin.stamps import LATEST, NANO, split_ns
import numpy as np
from numpy.typing import NDArray

START = 1_577_836_800 * NANO
"""Stamp of undated data, 2020-01-01 00:00 UTC, so that a command always writes the same file."""
_UNITS = SECONDS | {'min': 60.0, 'h': 3600.0}
"""Units of times in s. A vibration is timed in the shorter ones only."""
_TEMPERATURE = re.compile(r'temp|.*(°|deg) ?C\b', re.IGNORECASE)
"""Begin of the heading of a temperature."""
_DATE = re.compile(r'\d+-\d+-\d+')
_CLOCK = re.compile(r'\d\d?:\d\d(:\d\d([.,]\d+)?)?')
_OTHER_UNIT = re.compile(r'(°|deg) ?F\b|fahrenheit|[(\[]K[)\]]|kelvin', re.IGNORECASE)


class Measured(NamedTuple):
    """A measured temperature."""

    times: NDArray[np.float64]
    """Time of each reading, s from the first one, shape (n,)."""
    temperatures: NDArray[np.float64]
    """Temperatures, degC, shape (n,); NaN where the logger has no number."""
    start: int
    """Time of the first reading, ns since 1970; ``START`` if it is not known."""


def is_undated(start: int) -> bool:
    """
    Return whether a recording that begins at ``start`` (ns) is undated: times count from START.

    Examples
    --------
    >>> is_undated(START), is_undated(START + 3600 * NANO)
    (True, False)

    """
    return START <= start < START + 60 * NANO


def paper_schedule(duration: float = 40.0) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """
    Return times (s) and temperatures (degC) of a linear rise from 20 to 110 degC.

    It takes ``duration`` s, with ten readings a second: shape ``(round(10 * duration) + 1,)``.

    Raises
    ------
    BearingTwinError
        If there would be fewer than two readings, or more than a million.

    """
    if not 0.1 <= duration <= 1e5:
        raise BearingTwinError(f'a schedule of {duration:g} s: give 0.1 to 100000 s')
    times = np.arange(round(duration * 10.0) + 1) / 10.0
    return times, 20.0 + 90.0 * times / times[-1]


def read_temperatures(path: Path, dates: str = '') -> Measured:
    """
    Return a measured temperature from a text file of a logger or from an ``.npz`` file.

    The first column of a text file, or the second one behind a count, has the times: dates (ISO
    8601, or day.month.year; UTC if they name no zone; the time of day may have its own column),
    seconds since 1970, or seconds, or what a heading says (ns to h). The temperatures, degC, are
    the column whose heading begins with ``temp`` or has the unit degC, or the only other one.
    Dates with slashes have the order ``dates``, one of `ORDERS`, unless a day above 12 tells it.
    An ``.npz`` file has the arrays ``temp_t_s`` (s) and ``temp_C`` (degC).

    Raises
    ------
    BearingTwinError
        If the file has no such columns or arrays, dates of unknown order, a time that is none or
        that falls, or fewer than two temperatures.

    """
    if path.suffix.lower() == '.npz':
        arrays = read_npz(path, ('temp_t_s', 'temp_C'))
        if missing := {'temp_t_s', 'temp_C'} - arrays.keys():
            raise BearingTwinError(
                f'{path} has no array {" and no ".join(sorted(missing))}; give both (s, degC)'
            )
        times, temperatures = temperature_readings(path, arrays)
    else:
        times, temperatures = _columns(path, dates)
    if np.count_nonzero(np.isfinite(temperatures)) < 2:
        raise BearingTwinError(f'{path} has fewer than two temperatures; record for longer')
    dated = times[0] >= DATED
    falls = np.flatnonzero(~(np.diff(times, prepend=times[0]) >= 0.0))
    if falls.size:
        zone = ', or, where summer time ends, give dates with their zone' if dated else ''
        msg = f'{path}: the time of reading {falls[0] + 1} falls; sort the file{zone}'
        raise BearingTwinError(msg)
    if (times[-1] if dated else START / NANO + times[-1] - times[0]) > LATEST / NANO:
        raise BearingTwinError(f'{path}: a time of {times[-1]:g} s; stamps of ROS end in 2038')
    start = round(times[0] * NANO) if dated else START
    return Measured(times - times[0], temperatures, start)


def _columns(path: Path, dates: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the times, s, and the temperatures, degC, of a text file."""
    lines = with_iso_dates(path, table_text(path), dates).splitlines()
    # Without any of these, blanks part the columns.
    separator = next((s for s in '\t;,' if any(s in line for line in lines[:HEAD])), ' ')
    rows = [[field.strip() for field in fields_of(line, separator)] for line in lines]
    timed = (n for n, row in enumerate(rows) if len(row) > 1 and _seconds(row[0]) is not None)
    begin = next(timed, None)
    if begin is None:
        raise BearingTwinError(
            f'{path} has no line of a time and a temperature; give times in s or as dates such as '
            '2026-03-04 12:00:00 or 04.03.2026 12:00:00'
        )
    heading = rows[begin - 1] if begin else []
    if math.isnan(_number(rows[begin][1])) and _seconds(rows[begin][1]) is not None:
        # A count of the readings stands before their dates.
        rows, heading = [row[1:] for row in rows], heading[1:]
    if _DATE.fullmatch(rows[begin][0]) and _CLOCK.fullmatch(''.join(rows[begin][1:2])):
        rows = [[' '.join(row[:2]), *row[2:]] for row in rows]
        heading = heading[1:]
    column = _temperature_column(path, heading, len(rows[begin]))
    if len(heading) > column and math.isfinite(_number(heading[column])):
        raise BearingTwinError(f'{path}: line {begin} has no time: {heading[0]:.20}')
    unit = _UNITS.get(unit_of(f'time {"".join(heading[:1])}'), 1.0)
    times, temperatures = [], []
    for number, row in enumerate(rows[begin:], start=begin + 1):
        if not any(row):
            continue
        seconds = _seconds(row[0], unit)
        if seconds is None:
            raise BearingTwinError(f'{path}: line {number} has no time: {row[0]:.20}')
        times.append(seconds)
        temperatures.append(_number(row[column]) if column < len(row) else math.nan)
    return np.array(times), np.array(temperatures)


def _temperature_column(path: Path, heading: list[str], count: int) -> int:
    """Return the index of the temperatures."""
    columns = [n for n in range(1, len(heading)) if _TEMPERATURE.match(heading[n])]
    if not columns and count == 2:
        columns = [1]
    if len(columns) != 1:
        named = ', '.join(heading[1:])[:200] or 'without heading'
        raise BearingTwinError(
            f'{path}: {len(columns)} of its columns {named} are temperatures; leave the times and '
            'one temperature'
        )
    # A line before the numbers may be a title, shorter than a heading.
    named = ''.join(heading[columns[0] : columns[0] + 1])
    if _OTHER_UNIT.search(named) or unit_in(named):
        raise BearingTwinError(f'{path}: {named!r} is not in degC; convert it')
    return columns[0]


def _number(field: str) -> float:
    """Return a number, with a decimal comma or point; NaN if it is none, or infinite."""
    try:
        number = float(field.replace(',', '.'))
    except ValueError:
        return math.nan
    return number if math.isfinite(number) else math.nan


def _seconds(field: str, unit: float = 1.0) -> float | None:
    """Return a time in a unit (s), or a date since 1970, in s; None if it is neither."""
    if not math.isnan(number := _number(field)):
        return number * unit
    return seconds_since_1970(field)


def write_temperature_recording(
    path: Path,
    times: NDArray[np.float64],
    temperatures: NDArray[np.float64],
    *,
    source: str,
    topic: str = '/temperature',
    start: int = START,
) -> None:
    """
    Write times (s from ``start``) and temperatures (degC) as ``sensor_msgs/Temperature``.

    ``start`` is in ns since 1970.
    """
    store = standard_types()
    temperature, header, time = (
        store.types[name]
        for name in (TEMPERATURE, 'std_msgs/msg/Header', 'builtin_interfaces/msg/Time')
    )
    qos = sensor_qos()
    with whole_recording(path) as writer:
        writer.metadata('bearing_twin.source', {'source': source, 'unit': 'degC'})
        for second, value in zip(times, temperatures, strict=True):
            ns = start + round(float(second) * NANO)
            sec, nanosec = split_ns(ns)
            message = temperature(
                header=header(stamp=time(sec=sec, nanosec=nanosec), frame_id='bearing_housing'),
                temperature=float(value),
                variance=0.0,
            )
            cdr = bytes(store.serialize_cdr(message, TEMPERATURE))
            writer.write(topic, TEMPERATURE, cdr, log_time=ns, qos=qos)
