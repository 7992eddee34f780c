# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Check the health of a recording: missing samples, times running backwards, damage."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcap.catalogue import known_fields
from bearing_twin.recording.reader import recording_info
from bearing_twin.recording.topics import VIBRATION
from bearing_twin.stamps import NANO, stamp_ns

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.catalogue import RecordedMessage
    from bearing_twin.recording.reader import RecordingInfo


SEVERAL_SOURCES = 3
"""Returns of the sample index from which on a topic counts as shared by several sources. A single
source whose blocks are out of order makes fewer."""
SENT_BEFORE = 'sent_before_by_topic'
"""Key in the recorder's /diagnostics: messages that were sent before it subscribed, by topic."""


@dataclass
class TopicHealth:
    """Health of one topic. Blocks and samples are counted for vibration topics only."""

    count: int = 0
    backwards: int = 0
    """Messages with an earlier log time than the message before."""
    longest_gap: float = 0.0
    """Longest time without a message, s."""
    blocks: int = 0
    gaps: int = 0
    """Times the running sample index jumped ahead."""
    samples_missing: int = 0
    restarts: int = 0
    """Times the running sample index went back: the source restarted, or there are two sources."""
    alternations: int = 0
    """Times the index continued from before the last jump: several sources alternate."""
    worst_stamp_error: float = 0.0
    """Largest difference between the step of the stamps and the step of the index, s."""
    undecodable: int = 0
    reason: str = ''
    """Why the first of these messages cannot be decoded."""


@dataclass
class RecordingHealth:
    """Health of a whole recording."""

    topics: dict[str, TopicHealth] = field(default_factory=dict)
    damage: list[str] = field(default_factory=list)
    """Places that cannot be read."""

    @property
    def problems(self) -> list[str]:
        """Return the problems as sentences; empty for a sound recording."""
        found = list(self.damage)
        for name, topic in sorted(self.topics.items()):
            if topic.backwards:
                found.append(f'{name}: time runs backwards {topic.backwards} times')
            if topic.gaps:
                found.append(
                    f'{name}: {topic.samples_missing} samples are missing in {topic.gaps} gaps'
                )
            if topic.restarts:
                times = f'{topic.restarts} times' if topic.restarts > 1 else 'once'
                found.append(f'{name}: the sample index goes back {times}')
            if topic.alternations:
                found.append(
                    f'{name}: several sources alternate {topic.alternations} times on this topic; '
                    'give each one of its own'
                )
            if topic.undecodable:
                count, reason = topic.undecodable, topic.reason
                found.append(f'{name}: {count} messages cannot be read ({reason})')
        return found


def examine(
    path: Path, see: Callable[[RecordedMessage], object] | None = None
) -> tuple[RecordingInfo, RecordingHealth]:
    """
    Read a recording once from front to back; return its contents and its health.

    ``see`` is called with every message.
    """
    health = RecordingHealth()
    checks: dict[str, _TopicCheck] = {}

    def look(message: RecordedMessage) -> None:
        topic = message.channel.topic
        check = checks.get(topic)
        if check is None:
            check = checks[topic] = _TopicCheck()
            health.topics[topic] = check.health
        check.look(message)
        if see is not None:
            see(message)

    info = recording_info(path, look, health.damage.append)
    return info, health


def sent_before(diagnostics: Any) -> dict[str, int]:
    """Return how many messages were sent before a recorder subscribed, by topic, if any were."""
    return {
        topic: int(count)
        for status in diagnostics.status
        for item in status.values
        if item.key == SENT_BEFORE
        for topic, _, count in (entry.rpartition(' ') for entry in item.value.split('; '))
        if count.isdecimal() and len(count) < 20 and int(count)
    }


class _TopicCheck:
    """Check the messages of one topic in file order."""

    def __init__(self) -> None:
        self.health = TopicHealth()
        self._last_time: int | None = None
        self._longest = 0
        self._next_sample: int | None = None
        self._left: int | None = None
        self._returns = 0
        self._jump = 0
        self._jumps = _Jumps()
        self._true_jumps = _Jumps()
        self._last_stamp = 0
        self._last_length = 0

    def look(self, message: RecordedMessage) -> None:
        self.health.count += 1
        log_time = message.log_time
        if self._last_time is not None:
            step = log_time - self._last_time
            if step < 0:
                self.health.backwards += 1
            elif step > self._longest:
                self._longest = step
                self.health.longest_gap = step / NANO
        self._last_time = log_time
        if message.channel.type_name == VIBRATION:
            self._look_at_block(message)

    def _look_at_block(self, message: RecordedMessage) -> None:
        try:
            with known_fields(message.topic, message.type_name):
                block = message.decode()
                first, length = int(block.first_sample), max(block.x.size, block.y.size)
                stamp = stamp_ns(block.header.stamp)
                self._count_block(first, length, stamp, float(block.sample_rate))
        except BearingTwinError as error:
            self.health.undecodable += 1
            self.health.reason = self.health.reason or str(error)

    def _count_block(self, first: int, length: int, stamp: int, sample_rate: float) -> None:
        health = self.health
        health.blocks += 1
        if self._next_sample is not None:
            missing = first - self._next_sample
            alternates = missing != 0 and first == self._left
            if missing:
                self._note_jump(missing, alternates=alternates)
                self._left = self._next_sample
            if missing >= 0 and not alternates and sample_rate > 0:
                expected = (missing + self._last_length) / sample_rate
                error = abs((stamp - self._last_stamp) / NANO - expected)
                health.worst_stamp_error = max(health.worst_stamp_error, error)
        self._next_sample = first + length
        self._last_stamp = stamp
        self._last_length = length

    def _note_jump(self, missing: int, *, alternates: bool) -> None:
        self._jumps.count(missing)
        if alternates:
            self._returns += 1
            # This is the return from a jump to another source: no samples were missing there.
            self._true_jumps.count(self._jump, -1)
            self._jump = 0
        else:
            self._true_jumps.count(missing)
            self._jump = missing
        health, several = self.health, self._returns >= SEVERAL_SOURCES
        jumps = self._true_jumps if several else self._jumps
        health.alternations = self._returns if several else 0
        health.gaps, health.samples_missing = jumps.gaps, jumps.missing
        health.restarts = jumps.restarts


@dataclass
class _Jumps:
    """Counts of the jumps of a sample index."""

    gaps: int = 0
    missing: int = 0
    restarts: int = 0

    def count(self, missing: int, times: int = 1) -> None:
        self.gaps += times * (missing > 0)
        self.missing += times * max(0, missing)
        self.restarts += times * (missing < 0)
