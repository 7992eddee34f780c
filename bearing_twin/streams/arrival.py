# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Times of arrival, and numbers, of the messages that are handed out. Knows no ROS."""

from __future__ import annotations

from collections import Counter
from typing import Any

MOST_HEARD = 10_000
"""Topics and publishers that are known: beyond, the one that is silent longest is forgotten."""


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
        # The topic that is silent longest is the first.
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
        latest = min(max(received, self._latest.pop(topic, 0)), now)
        self._latest[topic] = latest
        if len(self._latest) > MOST_HEARD:
            del self._latest[next(iter(self._latest))]
        return latest


class MessageNumbers:
    """
    Count what publishers sent before they were heard, and what is missing between their messages.

    Examples
    --------
    >>> numbers = MessageNumbers()
    >>> for number in (3, 4, 6):
    ...     numbers.see('/vibration', {'data': b'publisher'}, number)
    >>> numbers.sent_before['/vibration'], numbers.skipped
    (2, 1)

    """

    def __init__(self) -> None:
        self.sent_before: Counter[str] = Counter()
        """Messages by topic that were sent before their publisher was heard."""
        self.skipped = 0
        """Messages missing between others."""
        # By topic and publisher; the one that is silent longest is the first.
        self._heard: dict[tuple[str, object], int] = {}

    def see(self, topic: str, source: Any, number: int | None) -> None:
        """
        Take note of a message.

        Parameters
        ----------
        topic
            Its topic.
        source
            Identity of its publisher as rclpy tells it; None on Jazzy, which does not.
        number
            Its number; None where the middleware gives none.

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
        """Count nothing of what is sent from now to the next message."""
        self._heard = dict.fromkeys(self._heard, 0)
