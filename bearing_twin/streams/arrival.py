# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Times of arrival of received messages, and counts of lost ones."""

from __future__ import annotations

from collections import Counter
from typing import Any

MOST_HEARD = 10_000
"""Most topics or publishers to remember; above, the one that was silent longest is dropped."""


class ArrivalTimes:
    """
    Give the messages of a topic times of arrival that never decrease.

    A message that is sent again after a loss arrives late, and the middleware holds back the
    messages behind it, which arrived earlier. They all get the time of the late one. If the system
    clock is set back, the times follow it at once.

    Examples
    --------
    >>> times = ArrivalTimes()
    >>> [times.of('/vibration', received, now=40) for received in (10, 30, 20)]
    [10, 30, 30]
    >>> times.of('/vibration', 5, now=6)
    6

    """

    def __init__(self) -> None:
        # The topic that has been silent longest comes first.
        self._latest: dict[str, int] = {}

    def of(self, topic: str, received: int, *, now: int) -> int:
        """
        Return the time of arrival of the next message of a topic, ns.

        Parameters
        ----------
        topic
            Topic of the message.
        received
            Time at which the middleware received the message, ns.
        now
            Present time of the same clock, ns; the upper limit of the result.

        """
        latest = min(max(received, self._latest.pop(topic, 0)), now)
        self._latest[topic] = latest
        if len(self._latest) > MOST_HEARD:
            del self._latest[next(iter(self._latest))]
        return latest


class MessageNumbers:
    """
    Count messages sent before a publisher was first heard, and messages lost after that.

    Examples
    --------
    >>> numbers = MessageNumbers()
    >>> for number in (3, 4, 6):
    ...     numbers.count('/vibration', {'data': b'publisher'}, number)
    >>> numbers.sent_before['/vibration'], numbers.skipped
    (2, 1)

    """

    def __init__(self) -> None:
        self.sent_before: Counter[str] = Counter()
        """Messages per topic that were sent before their publisher was first heard."""
        self.skipped = 0
        """Messages missing between received ones."""
        # By topic and publisher; the pair that has been silent longest comes first.
        self._heard: dict[tuple[str, object], int] = {}

    def count(self, topic: str, source: Any, number: int | None) -> None:
        """
        Count a message.

        Parameters
        ----------
        topic
            Topic of the message.
        source
            Identity of its publisher from rclpy; None on Jazzy, which gives none.
        number
            Sequence number of the message; None if the middleware gives none.

        """
        if source is None or number is None:
            return
        last = self._heard.pop(key := (topic, source['data']), None)
        self._heard[key] = max(number, last or 0)
        if len(self._heard) > MOST_HEARD:
            del self._heard[next(iter(self._heard))]
        if last is None and number > 1:
            self.sent_before[topic] += number - 1
        elif last:
            self.skipped += max(0, number - last - 1)

    def pause(self) -> None:
        """Do not count messages sent between now and the next received one."""
        self._heard = dict.fromkeys(self._heard, 0)
