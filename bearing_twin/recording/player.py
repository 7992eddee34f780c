# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Schedule the messages of a recording: rate, loop, section, pause, step."""

from __future__ import annotations

from collections.abc import Collection, Iterator
import math
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.stamps import NANO

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.catalogue import RecordedMessage
    from bearing_twin.recording.reader import TopicInfo


class Player:
    """
    Return the messages of a recording when they are due.

    The caller passes the time of its clock (s, any origin, monotonic). Recorded time runs ``rate``
    times as fast while playing and stops while paused.

    Parameters
    ----------
    path
        File or bag folder.
    start_offset, duration
        Recorded time to skip at the start, and to play, s.
    topics
        Topics to play; None: all.
    rate
        Recorded seconds per second of the caller's clock; it may be changed.
    loop
        Start again at the end.
    paused
        Start paused.

    """

    def __init__(
        self,
        path: Path,
        *,
        start_offset: float = 0.0,
        duration: float = math.inf,
        topics: Collection[str] | None = None,
        rate: float = 1.0,
        loop: bool = False,
        paused: bool = False,
    ) -> None:
        self.path = path
        self.info = recording_info(path)
        if not self.info.count:
            raise BearingTwinError(f'{path} holds no messages to play')
        unknown = set(topics or ()) - self.info.topics.keys()
        if unknown:
            raise BearingTwinError(
                f'{path} has no topic {", ".join(sorted(unknown))}; it has '
                f'{", ".join(sorted(self.info.topics))}'
            )
        self.loop = loop
        self.paused = paused
        self.loops = 0
        """Number of times that playing restarted at the end."""
        self.played = 0
        """Messages returned so far."""
        self._topics = topics
        self.start = self.info.start + round(start_offset * NANO)
        """Log time at which playing starts, ns."""
        length = min(duration * NANO, self.info.end + 1 - self.start)
        if length <= 0:
            raise BearingTwinError(
                f'start offset {start_offset:g} s is not inside the recording of '
                f'{self.info.duration:g} s'
            )
        self.end = self.start + math.ceil(length)
        """Log time at which playing ends (excluded), ns."""
        self.rate = rate
        self._clock: float | None = None
        self._elapsed = 0.0
        self._messages: Iterator[RecordedMessage] = iter(())
        self._next: RecordedMessage | None = None
        self._rewind()
        if self._next is None:
            msg = f'{path} holds no messages of these topics in the section to play'
            raise BearingTwinError(msg)

    @property
    def finished(self) -> bool:
        """Whether all messages have been returned."""
        return self._next is None

    @property
    def position(self) -> int:
        """Return the recorded time reached, ns."""
        return self.start + int(self._reached())

    @property
    def fraction(self) -> float:
        """Fraction of the section that has been played, 0..1."""
        return min(1.0, self._reached() / (self.end - self.start))

    def _reached(self) -> float:
        """Return the time from the start up to which all messages have been returned, ns."""
        if self._next is None:
            return self._elapsed
        return min(self._elapsed, float(self._next.log_time - self.start))

    def topics(self) -> dict[str, TopicInfo]:
        """Return the topics that are played, by name."""
        return {
            name: topic
            for name, topic in self.info.topics.items()
            if self._topics is None or name in self._topics
        }

    def resync(self, now: float) -> None:
        """Continue from the current position at ``now`` (s); the time in between is ignored."""
        self._clock = now

    def due(self, now: float) -> Iterator[RecordedMessage]:
        """Yield the messages that are due at ``now`` (s), in order of time."""
        self._advance(now)
        while not self.paused and self._next is not None:
            message = self._next
            if message.log_time - self.start > self._elapsed:
                return
            self._fetch()
            self.played += 1
            ended = self._next is None and self.loop
            if ended:
                self._rewind()
            yield message
            if ended:
                # One loop per call: a recording of a single instant would never end.
                return

    def wait(self, now: float) -> float:
        """Return the time from ``now`` until the next message is due, s; inf while paused."""
        self._advance(now)
        if self.paused or self._next is None:
            return math.inf
        return max(0.0, (self._next.log_time - self.start - self._elapsed) / NANO / self.rate)

    def step(self) -> RecordedMessage | None:
        """Return the next message, independent of the clock; None at the end."""
        message = self._next
        if message is not None:
            self._elapsed = max(self._elapsed, float(message.log_time - self.start))
            self._fetch()
            self.played += 1
            if self._next is None and self.loop:
                self._rewind()
        return message

    def _advance(self, now: float) -> None:
        if self._clock is not None and not self.paused:
            self._elapsed += max(0.0, now - self._clock) * self.rate * NANO
            if not self.loop:
                self._elapsed = min(self._elapsed, float(self.end - self.start))
        self._clock = now

    def _fetch(self) -> None:
        self._next = next(self._messages, None)

    def _rewind(self) -> None:
        if self._next is None and self.played:
            self.loops += 1
        self._elapsed = 0.0
        self._messages = read_messages(
            self.path,
            topics=self._topics,
            start=self.start,
            end=self.end,
            problems=self.info.problems,
        )
        self._fetch()
