# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read channels of LabVIEW measurement files (``.lvm``), which are texts."""

from __future__ import annotations

from decimal import Decimal, InvalidOperation
from itertools import pairwise
from pathlib import Path
import re
from typing import Any, NamedTuple

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.signals.csvfile import fields_of, table_text
from bearing_twin.recording.signals.reading import clock_time, distinct, head_of, readable
from bearing_twin.recording.signals.timecolumn import is_even, nominal_rate, rate_of_times
import numpy as np
from numpy.typing import NDArray

BEGIN = 'LabVIEW Measurement'
END = '***End_of_Header***'
DAY = 86_400.0
NUMBERS = {
    'X0': 'the time of the first sample in s, e.g. 0.0',
    'Delta_X': 'the time from one sample to the next in s, e.g. 3.90625E-5',
}
"""Numbers of the header that are read, with what to write there."""
LARGEST = 1e12
"""Largest of these numbers."""


class _Part(NamedTuple):
    """What LabVIEW wrote at once, with a header of its own."""

    path: Path
    said: dict[str, list[str]]
    """Lines of the header by their keys; a field is above the column that it describes."""
    names: list[str]
    """Headings of the columns."""
    table: NDArray[np.float64]
    """Columns, shape (columns, samples); NaN where a field is empty."""

    def field(self, key: str, column: int) -> str:
        """Return what the header says of a column; '' if nothing."""
        return ''.join(self.said.get(key, [])[column : column + 1])

    def number(self, key: str, column: int, missing: str) -> Decimal:
        """Return what `field` says as a number; ``missing`` if it says nothing."""
        text = self.field(key, column).strip()
        try:
            value = Decimal(text or missing)
            if not text or abs(value) < LARGEST:
                return value
        except InvalidOperation:
            pass
        msg = f'{self.path}: its header has {text[:40]!r} as {key} of column {column}'
        raise BearingTwinError(f'{msg}; write {NUMBERS[key]}')

    def times(self, column: int) -> NDArray[np.float64]:
        """Return the times of a column, s; empty where the file has none."""
        before = [k for k in range(column) if self.names[k] == 'X_Value']
        times = self.table[before[-1]] if before else np.zeros(0)
        return times[np.isfinite(times)]

    def start(self) -> float:
        """Return the time of day of the first sample, s; NaN if it is not stated."""
        text = self.field('Time', 1) or 'nan'
        clock = text.replace(',', '.').split(':')
        try:
            seconds = sum(float(v) * 60.0**k for k, v in enumerate(reversed(clock)))
        except ValueError:
            msg = f'{self.path}: its header has {text[:40]!r} as Time of a part'
            raise BearingTwinError(
                f'{msg}; write hours, minutes and seconds: 10:32:39.5'
            ) from None
        return seconds + float(self.number('X0', 1, '0'))


def read_lvm(path: Path) -> dict[str, Any]:
    """
    Return the channels of a LabVIEW measurement by name, and in ``each`` rate and unit of each.

    The sample rate is that of ``Delta_X``, or of the times where ``Delta_X`` has too few digits.
    Of several parts, the longest run that continues by the stated times is taken.

    Raises
    ------
    BearingTwinError
        If the file is no such measurement, a field is no number, or nothing in it is over time.

    """
    text = table_text(path)
    if not text.startswith(BEGIN):
        msg = f'{path} begins with {text[:20]!r}, and not with {BEGIN!r}'
        raise BearingTwinError(f'{msg}: give a table of another program the ending .txt')
    found, each, over = {}, {}, []
    with readable(path, '.lvm', 'is it complete?'):
        head, *bodies = re.split(r'^Channels(?=[\t,])', text, flags=re.MULTILINE)
        separator = ',' if re.search('^Separator.Comma', head, re.MULTILINE) else '\t'
        # A comma at the end of a line is gone.
        if separator != ',' and re.search(r'^Decimal_Separator\t(?!\.)', head, re.MULTILINE):
            bodies = [body.replace(',', '.') for body in bodies]
        parts = [part for body in bodies if (part := _part(path, body, separator)).table.size]
        if not parts:
            raise BearingTwinError(f'{path} holds no samples below headings; write some with both')
        run = max(_runs(parts), key=lambda run: sum(part.table.shape[1] for part in run))
        first = run[0]
        for k, name in enumerate(distinct(first.names)):
            x = np.concatenate([part.table[k] for part in run])
            known = np.flatnonzero(np.isfinite(x))
            if first.names[k] == 'X_Value' or not known.size:
                continue
            over.append(first.field('X_Dimension', k) or 'Time')
            if over[-1] == 'Time':
                # A slower channel has fewer samples: its fields are empty from there on.
                found[name] = x[: known[-1] + 1]
                each[name] = {**_rate(first, k), 'unit': np.array(first.field('Y_Unit_Label', k))}
    if not found:
        msg = f'{path} is over {", ".join(over) or "nothing"}, and not over time'
        raise BearingTwinError(f'{msg}; write the time record')
    remark = f' (the longest of {len(parts)} parts without a gap)' if len(run) < len(parts) else ''
    return {**found, 'each': each, 'remark': remark}


def lvm_start(path: Path) -> float | None:
    """Return date and time of the first part, s since 1970; None if they are not stated."""
    head, _, rest = head_of(path).partition('\nChannels')
    # What the header of the part says goes before what that of the file says.
    for text in (rest.partition(END)[0], head):
        stated = []
        for key, form in (('Date', r'\d+/\d+/\d+'), ('Time', r'\d+:\d+:\d+(?:[.,]\d{1,6})?')):
            found = re.search(rf'^{key}[\t,]({form})', text, re.MULTILINE)
            stated.append(found[1].replace(',', '.') if found else '')
        decimals = '.%f' if '.' in stated[1] else ''
        start = clock_time(' '.join(stated), f'%Y/%m/%d %H:%M:%S{decimals}')
        # One that was never set is the begin of the year 1904.
        if start is not None and start > 0.0:
            return start
    return None


def _part(path: Path, body: str, separator: str) -> _Part:
    header, _, rows = body.partition(END)
    said = {line[0]: line for line in (fields_of(v, separator) for v in header.splitlines()[1:])}
    heading, *lines = [line for line in rows.splitlines() if line.strip(f'{separator} ')]
    names = fields_of(heading, separator)
    table = np.full((len(names), len(lines)), np.nan)
    # Fields are empty for times that are not written, and from the end of a slower channel on.
    written = fields_of(lines[0], separator) if lines else []
    used = [k for k, v in enumerate(written[: len(names)]) if v.strip() and names[k] != 'Comment']
    try:
        table[used] = np.loadtxt(
            lines, delimiter=separator, usecols=used, ndmin=2, comments=None
        ).T
    except ValueError:
        for row, line in enumerate(lines):
            fields = fields_of(line, separator)
            try:
                table[used, row] = [
                    float(''.join(fields[k : k + 1]).strip() or 'nan') for k in used
                ]
            except ValueError:
                msg = f'{path}: row {row + 1} below its headings is {line[:60]!r}'
                raise BearingTwinError(
                    f'{msg}; fill or remove fields that are no numbers'
                ) from None
    return _Part(path, said, names, table)


def _runs(parts: list[_Part]) -> list[list[_Part]]:
    """Return the parts in runs without a gap: each begins where the one before it ends."""
    runs = [parts[:1]]
    for before, part in pairwise(parts):
        step = float(part.number('Delta_X', 1, 'nan'))
        gap = part.start() - before.start() - step * before.table.shape[1]
        if part.names == before.names and abs((gap + DAY / 2.0) % DAY - DAY / 2.0) < step:
            runs[-1].append(part)
        else:
            runs.append([part])
    return runs


def _rate(part: _Part, column: int) -> dict[str, Any]:
    """Return the sample rate; LabVIEW may print Delta_X with six decimals: 0.000039 s."""
    times = part.times(column)
    told = rate_of_times('time [s]', times)
    step = part.number('Delta_X', column, '0')
    decimals = -int(step.as_tuple().exponent)
    if not float(step) > 0.0 or (times.size > 1 and not is_even(times)):
        return told
    if decimals < 6 or 0.5 * 0.1**decimals < 1e-3 * float(step):
        return {'fs': np.array(nominal_rate(1.0 / float(step)))}
    return told or {'no_rate': np.array(f'its Delta_X {step} has too few digits;')}
