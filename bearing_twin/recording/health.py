# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""How sound a recording is: samples missing, times running backwards, damage."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.catalogue import known_fields
from bearing_twin.recording.mcapfile import BrokenRecording, open_mcap
from bearing_twin.recording.messages import in_file_order, Selection
from bearing_twin.recording.reader import recording_files
from bearing_twin.stamps import NANO, stamp_ns

if TYPE_CHECKING:
    from pathlib import Path

    from bearing_twin.recording.catalogue import RecordedMessage

__all__ = ['SENT_BEFORE', 'RecordingHealth', 'TopicHealth', 'recording_health', 'sent_before']

VIBRATION = 'bearing_twin_msgs/msg/Vibration'
SENT_BEFORE = 'sent before the recording: '
"""What a recorder puts on /diagnostics before the name of a topic."""


@dataclass
class TopicHealth:
    """One topic. Blocks and samples are of vibration topics only."""

    count: int = 0
    backwards: int = 0
    """Messages whose log time is before that of the one before."""
    longest_gap: float = 0.0
    """Longest time without a message, s."""
    blocks: int = 0
    gaps: int = 0
    """Times the running sample index jumped ahead."""
    samples_missing: int = 0
    restarts: int = 0
    """Times the running sample index went back: the source was restarted, or there are two."""
    worst_stamp_error: float = 0.0
    """Largest difference between the step of the stamps and that of the index, s."""
    undecodable: int = 0


@dataclass
class RecordingHealth:
    """The whole recording."""

    topics: dict[str, TopicHealth] = field(default_factory=dict)
    damage: list[str] = field(default_factory=list)
    """Places that cannot be read."""

    @property
    def problems(self) -> list[str]:
        """Return what an engineer should know, in words; empty for a sound recording."""
        found = list(self.damage)
        for name, topic in sorted(self.topics.items()):
            if topic.backwards:
                found.append(f'{name}: time runs backwards {topic.backwards} times')
            if topic.gaps:
                found.append(
                    f'{name}: {topic.samples_missing} samples are missing in {topic.gaps} gaps'
                )
            if topic.restarts:
                found.append(f'{name}: the sample index goes back {topic.restarts} times')
            if topic.undecodable:
                found.append(f'{name}: {topic.undecodable} messages cannot be decoded')
        return found


def recording_health(path: Path) -> RecordingHealth:
    """
    Read a recording from front to back and check it.

    Raises
    ------
    BearingTwinError
        If there is no recording, or a file is no MCAP file.

    """
    health = RecordingHealth()
    checks: dict[str, _TopicCheck] = {}
    files = recording_files(path)
    for file_path in files:

        def damaged(error: BrokenRecording, name: str = file_path.name) -> None:
            health.damage.append(f'{name}: {error}')

        try:
            file = open_mcap(file_path)
        except BrokenRecording as error:
            if len(files) == 1:
                raise
            health.damage.append(str(error))
            continue
        with file:
            size = file_path.stat().st_size
            for message in in_file_order(file, size, Selection(), damaged):
                check = checks.get(message.topic)
                if check is None:
                    check = checks[message.topic] = _TopicCheck()
                    health.topics[message.topic] = check.health
                check.look(message)
    return health


def sent_before(diagnostics: Any) -> dict[str, int]:
    """Return how many messages of each topic a recorder says were sent before it heard them."""
    return {
        item.key.removeprefix(SENT_BEFORE): int(item.value)
        for status in diagnostics.status
        for item in status.values
        if item.key.startswith(SENT_BEFORE) and item.value.isdecimal()
    }


class _TopicCheck:
    """What has been seen of one topic."""

    def __init__(self) -> None:
        self.health = TopicHealth()
        self._last_time: int | None = None
        self._next_sample: int | None = None
        self._last_stamp = 0
        self._last_length = 0

    def look(self, message: RecordedMessage) -> None:
        self.health.count += 1
        if self._last_time is not None:
            step = (message.log_time - self._last_time) / NANO
            self.health.backwards += step < 0
            self.health.longest_gap = max(self.health.longest_gap, step)
        self._last_time = message.log_time
        if message.type_name == VIBRATION:
            self._look_at_block(message)

    def _look_at_block(self, message: RecordedMessage) -> None:
        try:
            with known_fields(message.topic, message.type_name):
                block = message.decode()
                first, length = int(block.first_sample), max(block.x.size, block.y.size)
                stamp = stamp_ns(block.header.stamp)
                self._count_block(first, length, stamp, float(block.sample_rate))
        except BearingTwinError:
            self.health.undecodable += 1

    def _count_block(self, first: int, length: int, stamp: int, sample_rate: float) -> None:
        health = self.health
        health.blocks += 1
        if self._next_sample is not None:
            missing = first - self._next_sample
            if missing > 0:
                health.gaps += 1
                health.samples_missing += missing
            elif missing < 0:
                health.restarts += 1
            if missing >= 0 and sample_rate > 0:
                expected = (missing + self._last_length) / sample_rate
                error = abs((stamp - self._last_stamp) / NANO - expected)
                health.worst_stamp_error = max(health.worst_stamp_error, error)
        self._next_sample = first + length
        self._last_stamp = stamp
        self._last_length = length
