# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Time at which a message is drawn: its stamp, shifted if it comes from another clock."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

from bearing_twin.stamps import NANO, stamp_ns
import rerun as rr

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


FAR = 10 * NANO
"""A stamp further than this from its arrival comes from another clock, ns."""


def stamp_of(message: Any) -> int | None:
    """Return the stamp of a message in ns; None if it has none."""
    header = getattr(message, 'header', None)
    stamp = getattr(header if header is not None else message, 'stamp', None)
    if not (hasattr(stamp, 'sec') and hasattr(stamp, 'nanosec')):
        return None
    return stamp_ns(stamp) or None


class Timebase:
    """
    Timeline of one picture.

    Parameters
    ----------
    timeline
        Name of the timeline. ``'ros_time'`` and ``'since_start'`` follow the stamps, any other the
        arrival.
    zero
        Time in ns that is drawn as 0, for recordings of different days side by side; None: times
        are dates.

    Notes
    -----
    A replayed sensor keeps the stamps of its own day, while its twin stamps today. To show both in
    one picture, a stamp that is more than 10 s from its arrival is shifted. All topics of that day
    share one offset, the shortest delay so far: distances between samples are kept, and nothing is
    drawn later than it arrived.

    """

    def __init__(self, timeline: str = 'ros_time', zero: int | None = None) -> None:
        self.timeline = timeline
        self.stamped = timeline in ('ros_time', 'since_start')
        self._zero = zero
        self._offsets: list[int] = []
        self._times: NDArray[np.int64] | None = None
        self._column: rr.TimeColumn | None = None

    def of(self, message: Any, received: int) -> int:
        """Return the time in ns at which a message is drawn."""
        stamp = stamp_of(message) if self.stamped else None
        if stamp is None:
            return received
        distance = received - stamp
        if abs(distance) <= FAR:
            return stamp
        for k, offset in enumerate(self._offsets):
            if abs(distance - offset) <= FAR:
                self._offsets[k] = min(offset, distance)
                return stamp + self._offsets[k]
        self._offsets.append(distance)
        return received

    def column(self, times: NDArray[np.int64]) -> rr.TimeColumn:
        """Return times in ns as a column; lines that share the array share the column."""
        if self._column is None or self._times is not times:
            if self._zero is None:
                shown = {'timestamp': times.astype('datetime64[ns]')}
            else:
                shown = {'duration': (times - self._zero).astype('timedelta64[ns]')}
            self._times, self._column = times, rr.TimeColumn(self.timeline, **shown)
        return self._column
