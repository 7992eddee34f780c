# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Sample rate from a column of printed times."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
SINCE_1970 = ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3))
"""Least time since 1970 in ns, us and ms, if no unit is given, and the unit in s."""
DATED = 1e9
"""Times from this one on, s, are dates, as seconds since 1970; smaller ones count from a start."""


def rate_of_times(name: str, times: NDArray[Any]) -> dict[str, Any]:
    """
    Return the sample rate of a column of times, Hz, as ``fs``, or why it has none as ``no_rate``.

    The heading ``name`` says the unit. Without a unit, times since 1970 are known by their size
    and others are in s. Neither is there if the heading has an unknown unit, or if the times fall.

    Examples
    --------
    >>> rate_of_times('t [ms]', np.arange(9.0)), rate_of_times('t [ms]', -np.arange(9.0))
    ({'fs': array(1000.)}, {})

    """
    if times.size < 2:
        return {}
    scale = _unit(name, times[0])
    step = scale * _mean_step(times)
    if step > 0.0 and is_even(times):
        return {'fs': np.array(nominal_rate(1.0 / step))}
    if scale > 0.0 and not step <= 0.0:
        return {'no_rate': np.array(_gap(name, scale * np.diff(times)))}
    return {}


def date_in(name: str, time: float) -> float | None:
    """
    Return the first of a column of times, s since 1970; None if they count from a start.

    >>> date_in('time', 1.7e9), date_in('t [ms]', 1.7e12), date_in('timestamp', 1.7e18)
    (1700000000.0, 1700000000.0, 1700000000.0)
    >>> date_in('t [ms]', 1.7e9)

    """
    seconds = _unit(name, time) * time
    return seconds if seconds >= DATED else None


def _unit(name: str, first: float) -> float:
    """Return the unit of a column of times in s, by its heading and its first time."""
    if unit_of(name):
        return _seconds(name)
    return next((unit for least, unit in SINCE_1970 if first >= least), 1.0)


def is_time(heading: str) -> bool:
    """Return whether a column is a time, by its heading."""
    time = TIME.match(heading)
    # A column T is a time only with a known unit and no digit: T or T_1 may be temperatures.
    known = _seconds(heading) > 0.0 and not re.search(r'\d', heading)
    return time is not None and (len(time[0]) > 1 or known)


def _seconds(heading: str) -> float:
    """Return the unit of a time column in s, by its heading; NaN if it is unknown."""
    return SECONDS.get(unit_of(heading), np.nan)


def unit_of(heading: str) -> str:
    """
    Return the unit of a time column, the last word of its heading; '' if it has only a name.

    >>> unit_of('Time [ms]'), unit_of('time_stamp')
    ('ms', '')

    """
    words = re.findall(r'[^\W\d_]+', heading.lower())[1:]
    return next((word for word in reversed(words) if word != 'stamp'), '')


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
        if steps[:1000].min(initial=0.0) < 0.0 < steps[:1000].max(initial=0.0):
            return False
        step = steps.mean()
        if not (step and np.all(steps * step >= 0.0)):
            return False
    # Differences of rounded values are multiples of the last digit, and both ends are rounded.
    digit = np.abs(steps[steps != 0.0]).min()
    away = np.abs(values - values[0] - step * np.arange(len(values))).max()
    return bool(away <= 1.5 * max(digit, abs(step)))


def nominal_rate(rate: float) -> float:
    """
    Return the whole rate within a millionth, Hz, or else the rate: printed times are rounded.

    >>> nominal_rate(11999.9992), nominal_rate(48828.125)
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
