# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Read columns of numbers from text files of data loggers and spreadsheets.

Such a file does not say how it is to be read. Each step relies on the steps before it:

======================  ===========================================================================
`table_text`            the encoding; quotes and separators at line ends carry no meaning
`_seconds_of_day`       a time of day becomes a number, so that its line is one of numbers only
`_first_numbers`        the table begins where lines have the same count of numbers
`_has_decimal_commas`   a comma is a decimal one, or it separates columns; never both
`_table`                every further line is a row
`_with_first_row`       notes to the right of the first row made it look like a heading
`_names`                the line before the rows is a heading if it has as many fields
`_description`          other lines before the rows may state rate, speed and unit
`rate_of_times`         an even column of times is replaced by its sample rate
======================  ===========================================================================
"""

from __future__ import annotations

from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from pathlib import Path
import re
from typing import Any

from bearing_twin.diagnosis.signal.acceleration import acceleration_factor
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.dates import seconds_since_1970, with_iso_dates
from bearing_twin.recording.signals.timecolumn import (
    date_in,
    is_time,
    rate_of_times,
    SECONDS,
)
import numpy as np
from numpy.typing import NDArray

HEAD = 100
"""The numbers must begin within this many lines."""
LONGEST_HEAD = 1_000_000
"""Characters of the lines among which the numbers must begin."""
MOST_COLUMNS = 1000
"""Longer lines of numbers are signals, one in each line."""
SAID = re.compile(
    r'(?<![a-z])(fs|sampl(?:e|ing)[ _]?(?:rate|frequency)|rpm|unit|label|bearing_name)'
    r'[\])]?(?: ?[\[(]hz[\])])?\s*[=:,;]\s*([^,;\s]+)(?![^,;\s]|,\d)(?: ?(k|M)(?:Hz|S/s))?',
    re.IGNORECASE,
)
"""A key and its value in the lines before the numbers, and the prefix of kHz or MHz."""
CLOCK = re.compile(
    r'^ *(?:\d{1,4}([-./])\d{1,2}\1\d{1,4}[T ;,\t]+)?(\d{1,2}):(\d\d):'
    r'(\d\d(?:\.\d+|,\d+(?=[;\t]))?) ?(?:[AP]M|Z|[+-]\d\d:?\d\d)?(?=[;,\t ])',
    re.IGNORECASE | re.MULTILINE,
)
"""A time of day at the begin of a line; a date may stand before it."""
STAMP = re.compile(
    r' *(\d{4}-\d\d-\d\d)[T ;,\t]+(\d\d:\d\d:\d\d(?:\.\d+|,\d+(?=[;\t]))?) ?(Z|[+-]\d\d:?\d\d)?'
)
"""Date, time of day and zone at the begin of a line."""
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
    lines = _head(text)
    clocks = [CLOCK.match(line) is not None for line in lines]
    if any(clocks):
        text = CLOCK.sub(_seconds_of_day, text)
    head = _head(text)
    start, separator = _first_numbers(head)
    if start < 0:
        seen = f'; line {len(lines)} is {lines[-1][:60]!r}' if lines else ''
        raise BearingTwinError(
            f'{path} has no line of numbers only among its first {HEAD} lines{seen}; export '
            'columns of numbers with a semicolon, comma or tab between them'
        )
    if separator == ',' and _has_decimal_commas(path, text, head, start):
        separator = ' '
    if separator != ',':
        # With another separator, a comma is a decimal comma.
        text = text.replace(',', '.')
        head = [DIGITS.sub('.', line) for line in head]
    before, table = head[:start], _table(path, text, start, separator)
    if table.shape[1] > MOST_COLUMNS:
        return {**_description(before), 'x': table}
    before, table = _with_first_row(before, table, separator)
    timed = any(clocks[start : start + 1])
    if timed:
        table[:, 0] = np.unwrap(table[:, 0], period=HALF_DAY)
    found = _description(before)
    names = _names(before, separator, table.shape[1], timed=timed)
    for name, column in zip(names, table.T, strict=True):
        if column.size < 2 or not is_time(name):
            found[name] = np.ascontiguousarray(column)
            continue
        # A rate that is stated before the numbers goes before one of rounded times.
        found = {**rate_of_times(name, column), **found}
    return found


def csv_start(path: Path) -> float | None:
    """
    Return the time of the first row, s since 1970, UTC if it names no zone; None if unknown.

    It is a date and time at the begin of the line, or a column of times since 1970. A date such as
    04/03/2026 may have the day or the month first, and is not taken.
    """
    head = _head(table_text(path, LONGEST_HEAD))
    plain = [CLOCK.sub(_seconds_of_day, line) for line in head]
    start, separator = _first_numbers(plain)
    if start < 0:
        return None
    if plain[start] != head[start]:
        try:
            found = STAMP.match(with_iso_dates(path, head[start]))
        except BearingTwinError:
            return None
        return seconds_since_1970(f'{found[1]} {found[2]}{found[3] or ""}') if found else None
    row = fields_of(head[start], separator)
    names = _names(head[:start], separator, len(row), timed=False)
    times = [(name, text) for name, text in zip(names, row, strict=True) if is_time(name)]
    dates = (date_in(name, float(text.replace(',', '.'))) for name, text in times)
    return next(filter(None, dates), None)


def table_text(path: Path, most: int = -1) -> str:
    """
    Return the text of a file without quotes around numbers and separators at line ends.

    ``most`` limits it to the first characters.
    """
    try:
        with path.open('rb') as file:
            is_wide = file.read(2) in (BOM_UTF16_LE, BOM_UTF16_BE)
        try:
            with path.open(encoding='utf-16' if is_wide else 'utf-8-sig') as file:
                text = file.read(most)
        except UnicodeDecodeError:
            # Spreadsheets on Windows write its code page. A file may end within a character.
            encoding = 'utf-16' if is_wide else 'cp1252'
            with path.open(encoding=encoding, errors='replace') as file:
                text = file.read(most)
    except OSError as error:
        raise BearingTwinError(f'{path} cannot be read: {error.strerror}') from None
    # A comma in a quoted number is a decimal comma.
    text = QUOTED.sub(lambda field: field[1].replace(',', '.'), text)
    return AT_END.sub('', text) if AT_END.search(text[:100_000]) else text


def _head(text: str) -> list[str]:
    """Return the lines among which the numbers must begin."""
    return text[:LONGEST_HEAD].splitlines()[:HEAD]


def _seconds_of_day(clock: re.Match[str]) -> str:
    """Return the seconds since noon or midnight; the date does not matter."""
    hours, minutes, seconds = clock.group(2, 3, 4)
    return f'{int(hours) % 12 * 3600 + int(minutes) * 60 + float(seconds.replace(",", ".")):.9f}'


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


def fields_of(line: str, separator: str) -> list[str]:
    """Return the fields of a line; ' ' stands for any blanks."""
    return line.split() if separator == ' ' else line.rstrip('\r\n').split(separator)


def _is_number(field: str) -> bool:
    try:
        float(field)
    except ValueError:
        return False
    return True


def _has_decimal_commas(path: Path, text: str, head: list[str], start: int) -> bool:
    """
    Return whether commas part no columns but are decimal ones; raise if they are both.

    Only decimals begin with a zero, and only columns have a heading with as many commas.
    """
    count = len(fields_of(head[start], ','))
    if not any(map(PADDED.fullmatch, head[start:])) or (
        start and len(fields_of(head[start - 1], ',')) == count
    ):
        if DECIMAL.fullmatch(text.strip()):
            msg = f'{path} has commas that may be decimal ones or part two columns'
            raise BearingTwinError(f'{msg}: write a heading of two columns, or decimal points')
        return False
    if count != 2:
        raise BearingTwinError(
            f'{path} has commas that are decimal ones and also part columns; export it with '
            'semicolons or decimal points'
        )
    return True


def _table(path: Path, text: str, start: int, separator: str) -> NDArray[Any]:
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


def _with_first_row(
    before: list[str], table: NDArray[Any], separator: str
) -> tuple[list[str], NDArray[Any]]:
    """
    Return the lines before the rows, and all rows, with the last line if it is the first row.

    Its further fields are notes, unless its numbers do not fit those below: it is no row then.
    """
    fields = fields_of(before[-1], separator) if before else []
    count = table.shape[1]
    if count < len(fields) and all(map(_is_number, fields)):
        row = np.array(fields[:count], np.float64)
        if np.all(np.abs(row - table[0]) <= np.ptp(table, axis=0)):
            return before[:-1], np.vstack((row, table))
    return before, table


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


def _value(text: str, factor: float) -> Any:
    return np.array(factor * float(text)) if _is_number(text) else np.array(text)


def unit_in(heading: str) -> str:
    """
    Return the first unit of acceleration in brackets of a heading; '' if it has none.

    >>> unit_in('Time [s];Motor DE (m/s²)'), unit_in('Speed [rpm]')
    ('m/s²', '')

    """
    return next(filter(lambda unit: acceleration_factor(unit) > 0.0, UNIT.findall(heading)), '')
