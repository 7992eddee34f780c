# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Dates and times of day as data loggers write them."""

from __future__ import annotations

from datetime import datetime, UTC
from pathlib import Path
import re

from bearing_twin.errors import BearingTwinError

ORDERS = ('day-first', 'month-first')
"""Orders of dates such as 04/03/2026."""
_YEAR_LAST = re.compile(r'\b(\d\d?)([./-])(\d\d?)\2(\d{4})\b')
"""A date with points, whose day is first everywhere, or with slashes, whose month may be."""
_YEAR_FIRST = re.compile(r'\b(\d{4})/(\d\d?)/(\d\d?)\b')
_HOURS = re.compile(r'(?<![\d:])(\d\d?)(:\d\d(?::\d\d(?:\.\d+)?)?)(?: ?([AP])M)?\b', re.IGNORECASE)


def with_iso_dates(path: Path, text: str, order: str = '') -> str:
    """
    Return a text in which dates are year-month-day, and times of day have 24 hours.

    Dates such as 04/03/2026 have the order ``order``, one of `ORDERS`, unless a day above 12 tells
    it. ``path`` is the file that errors name.

    Raises
    ------
    BearingTwinError
        If the order is not known, or dates contradict it.

    >>> from pathlib import Path
    >>> with_iso_dates(Path('a.csv'), '1.12.2026 1:00:00 PM')
    '2026-12-01 13:00:00'

    """
    slashed = [date for date in _YEAR_LAST.finditer(text) if date[2] != '.']
    told = {ORDERS[place // 2]: d[0] for d in slashed for place in (1, 3) if int(d[place]) > 12}
    if len(told) > 1 or (order and told and order not in told):
        listed = ' and '.join(f'{date} ({name})' for name, date in told.items())
        msg = f'{path} has the dates {listed}; give all in one order, that of --dates'
        raise BearingTwinError(msg)
    order = order or ''.join(told)
    if slashed and not order:
        raise BearingTwinError(
            f'{path}: {slashed[0][0]} may have the day or the month first; give --dates '
            f'{" or --dates ".join(ORDERS)}'
        )

    def iso(date: re.Match[str]) -> str:
        first, second = date[1], date[3]
        if date[2] == '.' or order == ORDERS[0]:
            first, second = second, first
        return f'{date[4]}-{first:0>2}-{second:0>2}'

    text = _YEAR_FIRST.sub(lambda d: f'{d[1]}-{d[2]:0>2}-{d[3]:0>2}', _YEAR_LAST.sub(iso, text))
    return _HOURS.sub(_of_24_hours, text)


def _of_24_hours(clock: re.Match[str]) -> str:
    hour = int(clock[1])
    if clock[3]:
        hour = hour % 12 + 12 * (clock[3] in 'pP')
    return f'{hour:02}{clock[2]}'


def seconds_since_1970(text: str) -> float | None:
    """
    Return a date of ISO 8601, s since 1970, in UTC if it names no zone; None if it is none.

    >>> seconds_since_1970('2026-11-30 10:00:00.5')
    1796032800.5
    >>> seconds_since_1970('2026-11-30T11:00:00+01:00')
    1796032800.0

    """
    try:
        date = datetime.fromisoformat(text.replace('Z', '+00:00'))
    except ValueError:
        return None
    return (date if date.tzinfo else date.replace(tzinfo=UTC)).timestamp()
