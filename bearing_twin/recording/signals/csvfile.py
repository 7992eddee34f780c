# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read columns of numbers from text files of data loggers and spreadsheets."""

from __future__ import annotations

from codecs import BOM_UTF16_BE, BOM_UTF16_LE
import re
from typing import Any, TYPE_CHECKING

from bearing_twin.diagnosis.signal.acceleration import acceleration_factor
from bearing_twin.errors import BearingTwinError
import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


HEAD = 100
"""The numbers must begin within this many lines."""
LONGEST_HEAD = 1_000_000
"""Characters of the lines among which the numbers must begin."""
MOST_COLUMNS = 1000
"""Longer lines of numbers are signals, one in each line."""
TIME = re.compile(
    r'(?:timestamp|time|uhrzeit|zeit|temps|tiempo|tempo|tijd|t)(?![a-z\d])', re.IGNORECASE
)
"""Begin of the heading of a time column."""
SECONDS = {
    **dict.fromkeys(('', 's', 'sec', 'secs', 'second', 'seconds', 'sekunden'), 1.0),
    **dict.fromkeys(('ms', 'msec', 'milliseconds'), 1e-3),
    # The micro sign and the Greek letter mu look the same.
    **dict.fromkeys(('us', 'usec', 'µs', 'μs', 'microseconds'), 1e-6),
    'ns': 1e-9,
}
"""Unit of a time column in s, by the last word of its heading."""
SAID = re.compile(
    r'(?<![a-z])(fs|sampl(?:e|ing)[ _]?(?:rate|frequency)|rpm|unit|label|bearing_name)'
    r'[\])]?(?: ?[\[(]hz[\])])?\s*[=:,;]\s*([^,;\s]+)(?![^,;\s]|,\d)(?: ?(k|M)(?:Hz|S/s))?',
    re.IGNORECASE,
)
"""A key and its value in the lines before the numbers, and the prefix of kHz or MHz."""
SINCE_1970 = ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3))
"""Least time since 1970 in ns, us and ms, if no unit is given, and the unit in s."""
CLOCK = re.compile(
    r'^ *(?:\d{1,4}([-./])\d{1,2}\1\d{1,4}[T ;,\t]+)?(\d{1,2}):(\d\d):'
    r'(\d\d(?:\.\d+|,\d+(?=[;\t]))?) ?(?:[AP]M|Z|[+-]\d\d:?\d\d)?(?=[;,\t ])',
    re.IGNORECASE | re.MULTILINE,
)
"""A time of day at the begin of a line; a date may stand before it."""
HALF_DAY = 43_200
"""Period of times that may have AM or PM, s."""
PREFIXES = {'': 1.0, 'k': 1e3, 'm': 1e6}
QUOTED = re.compile(r'"([^"\n]*)"')
AT_END = re.compile(r'[,;\t] *$', re.MULTILINE)
"""A separator at the end of a line."""
DIGITS = re.compile(r'(?<=\d),(?=\d)')
"""A comma between two digits."""
DECIMAL = re.compile(r'([+-]?\d+,\d+\s+)*[+-]?\d+,\d+')
PADDED = re.compile(r'(?=.*,0\d)[-+\d,]+')
"""Integers, one of them with a zero in front: the digits behind a decimal comma."""
UNIT = re.compile(r'[\[(]([^\])]{1,20})[\])]')


# Infinite or huge times would warn.
@np.errstate(over='ignore', invalid='ignore')
def read_csv(path: Path) -> dict[str, Any]:
    """
    Return the columns of a text file by name, or by ``c0``, ``c1``, ... without a heading.

    Lines of more than 1000 numbers are not columns but a signal each: they are the rows of ``x``.

    A column of even times in s, ms, us or ns, or with a time of day first in each line, becomes
    ``fs``; ``fs = ...`` or ``Sampling rate: ...`` (Hz, kHz or MHz), ``rpm = ...`` before the
    numbers and a unit in brackets in a heading, or in a line below it, are read as well. Quotes
    around numbers, separators at line ends and, before the table, lines with another count of
    numbers are ignored.

    Raises
    ------
    BearingTwinError
        If there are no columns of numbers, or if commas may be decimal commas or separators.

    """
    text = table_text(path)
    raw = head = text[:LONGEST_HEAD].splitlines()[:HEAD]
    if any(map(CLOCK.match, raw)):
        text = CLOCK.sub(_seconds_of_day, text)
        head = text[:LONGEST_HEAD].splitlines()[:HEAD]
    start, separator = _first_numbers(head)
    if start < 0:
        seen = f'; line {len(raw)} is {raw[-1][:60]!r}' if raw else ''
        raise BearingTwinError(
            f'{path} has no line of numbers only among its first {HEAD} lines{seen}; export '
            'columns of numbers with a semicolon, comma or tab between them'
        )
    timed = start < len(raw) and CLOCK.match(raw[start]) is not None
    if separator == ',' and _has_decimal_commas(path, head, start):
        separator = ' '
    if separator != ',':
        # With another separator, a comma is a decimal comma.
        text = text.replace(',', '.')
        head = [DIGITS.sub('.', line) for line in head]
    elif DECIMAL.fullmatch(text.strip()):
        msg = f'{path} has commas that may be decimal ones or part two columns'
        raise BearingTwinError(f'{msg}: write a heading of two columns, or decimal points')
    table = _table(path, text, start, separator)
    if table.shape[1] > MOST_COLUMNS:
        return {**_description(head[:start]), 'x': table}
    before = fields_of(head[start - 1], separator) if start else []
    if table.shape[1] < len(before) and all(map(_is_number, before)):
        # Notes stand to the right of the first row, unless the line is no row at all.
        row = np.array(before[: table.shape[1]], np.float64)
        if np.all(np.abs(row - table[0]) <= np.ptp(table, axis=0)):
            start, table = start - 1, np.vstack((row, table))
    names = _names(head[:start], separator, table.shape[1], timed=timed)
    if timed:
        table[:, 0] = np.unwrap(table[:, 0], period=HALF_DAY)
    found = _description(head[:start])
    for name, column in zip(names, table.T, strict=True):
        if column.size > 1 and _is_time(name):
            scale = _seconds(name)
            if not unit_of(name):
                scale *= next((unit for least, unit in SINCE_1970 if column[0] >= least), 1.0)
            step = scale * _mean_step(column)
            if step > 0.0 and is_even(column):
                found.setdefault('fs', np.array(_nominal(1.0 / step)))
            elif scale > 0.0 and not step <= 0.0:
                found['no_rate'] = np.array(_gap(name, scale * np.diff(column)))
        else:
            found[name] = np.ascontiguousarray(column)
    return found


def table_text(path: Path) -> str:
    """Return the text of a file without quotes around numbers and separators at line ends."""
    try:
        with path.open('rb') as file:
            is_wide = file.read(2) in (BOM_UTF16_LE, BOM_UTF16_BE)
        try:
            text = path.read_text(encoding='utf-16' if is_wide else 'utf-8-sig')
        except UnicodeDecodeError:
            # Spreadsheets on Windows write its code page. A file may end within a character.
            text = path.read_text(encoding='utf-16' if is_wide else 'cp1252', errors='replace')
    except OSError as error:
        raise BearingTwinError(f'{path} cannot be read: {error.strerror}') from None
    # A comma in a quoted number is a decimal comma.
    text = QUOTED.sub(lambda field: field[1].replace(',', '.'), text)
    return AT_END.sub('', text) if AT_END.search(text[:100_000]) else text


def _description(lines: list[str]) -> dict[str, Any]:
    """Return what the lines before the numbers say: ``fs``, ``rpm``, ``unit``, ..."""
    found: dict[str, Any] = {}
    for line in lines:
        for key, value, prefix in SAID.findall(line):
            name = 'fs' if key[0] in 'sS' else key.lower()
            found[name] = _value(value, PREFIXES[prefix.lower()])
        if unit := unit_in(line):
            found['unit'] = np.array(unit)
    return found


def unit_in(heading: str) -> str:
    """
    Return the first unit of acceleration in brackets of a heading; '' if it has none.

    >>> unit_in('Time [s];Motor DE (m/s²)'), unit_in('Speed [rpm]')
    ('m/s²', '')

    """
    return next(filter(lambda unit: acceleration_factor(unit) > 0.0, UNIT.findall(heading)), '')


def _seconds_of_day(clock: re.Match[str]) -> str:
    """Return the seconds since noon or midnight; the date does not matter."""
    hours, minutes, seconds = clock.group(2, 3, 4)
    return f'{int(hours) % 12 * 3600 + int(minutes) * 60 + float(seconds.replace(",", ".")):.9f}'


def _has_decimal_commas(path: Path, head: list[str], start: int) -> bool:
    """Return whether commas part no columns but are decimal ones; raise if they are both."""
    count = len(fields_of(head[start], ','))
    if not any(map(PADDED.fullmatch, head[start:])) or (
        start and len(fields_of(head[start - 1], ',')) == count
    ):
        return False
    if count != 2:
        raise BearingTwinError(
            f'{path} has commas that are decimal ones and also part columns; export it with '
            'semicolons or decimal points'
        )
    return True


def _nominal(rate: float) -> float:
    """
    Return the whole rate within a millionth, Hz, or else the rate: printed times are rounded.

    >>> _nominal(11999.9992), _nominal(48828.125)
    (12000.0, 48828.125)

    """
    whole = float(np.rint(rate))
    return whole if abs(rate - whole) < 1e-6 * rate else rate


def _gap(name: str, steps: NDArray[Any]) -> str:
    """Return why a column of times with these steps, s, gives no sample rate, and the remedy."""
    at = int(np.argmax(np.abs(steps)))
    return (
        f'the times of its column {name[:40]!r} have gaps, or too few digits (longest step: '
        f'{steps[at]:.4g} s after {at + 1} values); keep a part without gaps, or'
    )


def _is_time(heading: str) -> bool:
    """Return whether a column is a time, by its heading."""
    time = TIME.match(heading)
    # A column T is a time only with a known unit and no digit: T or T_1 may be temperatures.
    known = _seconds(heading) > 0.0 and not re.search(r'\d', heading)
    return time is not None and (len(time[0]) > 1 or known)


def _mean_step(column: NDArray[Any]) -> float:
    """
    Return the mean step of printed times; NaN if they change too rarely to determine it.

    Most single steps are rounded. If several rows have the same time, the first and the last group
    of equal times may be incomplete and are left out.

    >>> times = np.floor(np.arange(29000) / 12000.0)
    >>> round(1.0 / _mean_step(times), 3), _mean_step(times[:20000])
    (12000.0, nan)

    """
    changes = np.flatnonzero(np.diff(column)) + 1
    if len(changes) == len(column) - 1:
        return float(column[-1] - column[0]) / (len(column) - 1)
    # The begin of a group is known to one row: over 1000 rows the error is 0.1 %.
    if len(changes) < 2 or changes[-1] - changes[0] < 1000:
        return np.nan
    first, last = changes[[0, -1]]
    return float(column[last] - column[first]) / float(last - first)


def is_even(column: NDArray[Any]) -> bool:
    """
    Return whether an array rises or falls evenly, apart from the rounding of its values.

    Examples
    --------
    >>> times = np.round(np.arange(1000) / 12000.0, 4)
    >>> is_even(times), is_even(np.delete(times, slice(500, 510)))
    (True, False)

    """
    # Infinite or huge values and signalling NaN are not times: suppress the warnings of NumPy.
    with np.errstate(over='ignore', invalid='ignore'):
        values = column.ravel().astype(np.float64)
        steps = np.diff(values)
        step = steps.mean()
        if not (step and np.all(steps * step >= 0.0)):
            return False
    # Differences of rounded values are multiples of the last digit, and both ends are rounded.
    digit = np.abs(steps[steps != 0.0]).min()
    away = np.abs(values - values[0] - step * np.arange(len(values))).max()
    return bool(away <= 1.5 * max(digit, abs(step)))


def unit_of(heading: str) -> str:
    """
    Return the unit of a time column, the last word of its heading; '' if it has only a name.

    >>> unit_of('Time [ms]'), unit_of('time_stamp')
    ('ms', '')

    """
    words = re.findall(r'[^\W\d_]+', heading.lower())[1:]
    return next((word for word in reversed(words) if word != 'stamp'), '')


def _seconds(heading: str) -> float:
    """Return the unit of a time column in s, by its heading; NaN if it is unknown."""
    return SECONDS.get(unit_of(heading), np.nan)


def fields_of(line: str, separator: str) -> list[str]:
    """Return the fields of a line; ' ' stands for any blanks."""
    return line.split() if separator == ' ' else line.rstrip('\r\n').split(separator)


def _first_numbers(head: list[str]) -> tuple[int, str]:
    """
    Return the index of the first line of numbers only, and its separator; -1, '' if none.

    A line of numbers before one with another count of them is not of the table: a logger wrote
    the number of samples there, for instance.
    """
    index, kind = -1, ('', 0)
    for line_index, line in enumerate(head):
        found = _numbers(line)
        if index >= 0 and found in (kind, ('', 0)):
            break
        if found[1]:
            index, kind = line_index, found
    return index, kind[0]


def _numbers(line: str) -> tuple[str, int]:
    """Return separator and count of the numbers of a line of numbers only; '', 0 for another."""
    for separator in ('\t', ';', ',', ' '):
        fields = [field.strip() for field in fields_of(line, separator)]
        if separator in ('\t', ';') and len(fields) < 2:
            continue
        if separator != ',':
            fields = [field.replace(',', '.') for field in fields]
        if fields and all(map(_is_number, fields)):
            return separator, len(fields)
    return '', 0


def _is_number(field: str) -> bool:
    try:
        float(field)
    except ValueError:
        return False
    return True


def _table(path: Path, text: str, start: int, separator: str) -> Any:
    lines = text.splitlines()[start:]
    delimiter = None if separator == ' ' else separator
    try:
        table = np.loadtxt(lines, delimiter=delimiter, ndmin=2, comments='#')
    except (ValueError, MemoryError) as error:
        raise BearingTwinError(
            f'{path}: after line {start} not every line has the same columns of numbers '
            f'({_odd_line(lines, start, separator) or error}); fill or remove fields that are no '
            'numbers, and write numbers with a decimal sign only, not with one for thousands'
        ) from None
    return table


def _odd_line(lines: list[str], start: int, separator: str) -> str:
    """Return number and text of the first line that is no row; '' if there is none."""
    usual = _numbers(lines[0])[1]
    for number, line in enumerate(lines, start=start + 1):
        fields = fields_of(line.partition('#')[0], separator)
        if any(fields) and not (len(fields) == usual and all(map(_is_number, fields))):
            return f'line {number} is {line[:60]!r}'
    return ''


def _names(before: list[str], separator: str, count: int, *, timed: bool) -> list[str]:
    """Return the names of the columns; the first is a time of day if ``timed``."""
    names = [f'c{index}' for index in range(count)]
    rows = [
        [field.strip().strip('"\'') for field in fields_of(line.lstrip('# '), separator)]
        for line in before[-2:]
    ]
    if timed:
        # A date may have a heading of its own.
        rows = [row[-count:] for row in rows]
    units = [field.strip('[]()') for field in rows[-1]] if rows else []
    if [len(row) for row in rows] == [count, count] and SECONDS.get(units[0] or '-'):
        rows.append([f'{name} [{unit}]' for name, unit in zip(rows[0], units, strict=True)])
    if rows and len(rows[-1]) == count == len(set(rows[-1])):
        names = [field or name for field, name in zip(rows[-1], names, strict=True)]
    if timed:
        names[0] = 'time'
    return names


def _value(text: str, factor: float) -> Any:
    return np.array(factor * float(text)) if _is_number(text) else np.array(text)
