# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Convert times: ROS stamps, seconds, numbers of samples, display units."""

from __future__ import annotations

from typing import Any

NANO = 1_000_000_000
"""Nanoseconds in a second."""

LATEST = 2**31 * NANO - 1
"""Latest time that ``builtin_interfaces/Time`` can hold, ns: in the year 2038."""


def stamp_ns(stamp: Any) -> int:
    """
    Return the time of a stamp, ns.

    ``stamp`` is any object with the fields of ``builtin_interfaces/Time``.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> stamp_ns(SimpleNamespace(sec=1, nanosec=500_000_000))
    1500000000

    """
    return int(stamp.sec) * NANO + int(stamp.nanosec)


def split_ns(ns: int) -> tuple[int, int]:
    """
    Return the fields ``sec`` and ``nanosec`` of a time in ns, clamped to the range of a stamp.

    Examples
    --------
    >>> split_ns(1_500_000_000)
    (1, 500000000)
    >>> split_ns(-1)
    (0, 0)

    """
    return divmod(min(max(ns, 0), LATEST), NANO)


def time_unit(seconds: float) -> tuple[str, float]:
    """
    Return the unit in which to show a duration, and the length of this unit in s.

    Examples
    --------
    >>> time_unit(40.0), time_unit(900.0), time_unit(86400.0), time_unit(604800.0)
    (('s', 1.0), ('min', 60.0), ('h', 3600.0), ('d', 86400.0))

    """
    if seconds < 600.0:
        return 's', 1.0
    if seconds < 3.0 * 3600.0:
        return 'min', 60.0
    return ('h', 3600.0) if seconds < 3.0 * 86400.0 else ('d', 86400.0)


def samples_ns(count: int, rate: float) -> int:
    """
    Return the duration of ``count`` samples at ``rate`` Hz, ns, rounded once.

    Examples
    --------
    >>> samples_ns(1024, 25600.0)
    40000000

    """
    return round(count * NANO / rate)
