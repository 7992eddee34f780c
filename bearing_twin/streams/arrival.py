# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Times of arrival in the order in which messages are handed out. Knows no ROS."""

from __future__ import annotations

__all__ = ['ArrivalTimes']


class ArrivalTimes:
    """
    Give each message of a topic a time of arrival that is not before that of the one before.

    A message that is sent again after a loss arrives late and holds back those behind it, which
    arrived earlier. All of them get the time of the late one. Where the system clock is set back,
    the times follow it at once.

    Examples
    --------
    >>> times = ArrivalTimes()
    >>> [times.of('/vibration', received, now=40) for received in (10, 30, 20)]
    [10, 30, 30]
    >>> times.of('/vibration', 5, now=6)
    6

    """

    def __init__(self) -> None:
        self._latest: dict[str, int] = {}

    def of(self, topic: str, received: int, *, now: int) -> int:
        """
        Return the time of arrival of the next message of a topic, ns.

        Parameters
        ----------
        topic
            Its topic.
        received
            Time at which the middleware received it, ns.
        now
            The same clock now, ns: nothing was received later.

        """
        latest = min(max(received, self._latest.get(topic, 0)), now)
        self._latest[topic] = latest
        return latest
