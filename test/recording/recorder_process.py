# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A recorder as a process, and a source that publishes to it from the test."""

from __future__ import annotations

import array
from collections.abc import Callable
import copy
from pathlib import Path
import shutil
import tempfile
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.messages import time_message
from bearing_twin.recording.reader import recording_info
from bearing_twin.recording.recover import recover
from bearing_twin.ros.topics.qos import STREAM
from bearing_twin_msgs.msg import Vibration
from probe import KEPT, Probe, TIMEOUT
from rclpy.duration import Duration

if TYPE_CHECKING:
    from bearing_twin.recording.reader import RecordingInfo
    from rclpy.publisher import Publisher

BLOCK = 1024
PERIOD = BLOCK / 25600.0


def on_disk(bag: Path) -> RecordingInfo:
    """Return what a crash would leave now of a bag that is being written."""
    with tempfile.TemporaryDirectory() as folder:
        copy_of_now, saved = Path(folder) / 'now', Path(folder) / 'saved'
        copy_of_now.mkdir()
        # Not what is about to be renamed.
        for file in bag.glob('*.mcap'):
            shutil.copy(file, copy_of_now)
        recover(copy_of_now, saved)
        return recording_info(saved)


class Source(Probe):
    """
    A probe that publishes blocks in real time.

    It keeps every block that a test sends, so that one is missing in a recording only if the
    recorder has lost it.
    """

    def __init__(self, kept: int = KEPT) -> None:
        super().__init__()
        self.watch_diagnostics()
        qos = copy.copy(STREAM)
        qos.depth = kept
        self._vibration = self.node.create_publisher(Vibration, 'vibration', qos)
        self.sent: list[tuple[int, int]] = []
        """Of each block: times right before and after it was sent, ns; the first is its stamp."""
        self._due = time.monotonic()

    def publish_for(self, seconds: float) -> None:
        """Publish a block each 40 ms, and listen meanwhile."""
        end = time.monotonic() + seconds
        while (now := time.monotonic()) < end:
            if now >= self._due:
                self._due = max(self._due + PERIOD, now - PERIOD)
                self._publish()
            self.executor.spin_once(timeout_sec=max(0.0, min(self._due, end) - now))

    def _publish(self) -> None:
        index = len(self.sent)
        stamp = time.time_ns()
        samples = array.array('f', [float(index)] * BLOCK)
        message = Vibration(
            sample_rate=25600.0, first_sample=index * BLOCK, unit='m/s^2', shaft_hz=25.0, y=samples
        )
        message.header.stamp = time_message(stamp)
        self._vibration.publish(message)
        self.sent.append((stamp, time.time_ns()))

    def wait_for(self, status: str) -> None:
        """Wait, without publishing, until a part of a node has reported."""
        self.until(lambda: status in self.statuses, f'a report of {status}')

    def settle(self) -> None:
        """Wait, without publishing, until what was sent has arrived at those who listen."""
        assert self._vibration.wait_for_all_acked(Duration(seconds=TIMEOUT))
        self._due = time.monotonic()

    def publish_until(self, ready: Callable[[], bool]) -> None:
        """Publish until something is so."""
        self.until(ready, 'it', every=lambda: self.publish_for(0.2))

    def publish_until_told(self, status: str) -> dict[str, str]:
        """Publish until a part reports anew; return the values of that."""
        self.statuses.pop(status, None)
        self.publish_until(lambda: status in self.statuses)
        return self.statuses[status].values

    def wait_for_recorder(self, *, recorders: int = 1) -> None:
        """Wait, without publishing, until so many listen."""
        self.wait_for_subscribers(self._vibration, recorders)
        self._due = time.monotonic()

    def wait_for_subscribers(self, publisher: Publisher[Any], count: int = 1) -> None:
        """Wait, without publishing blocks, until so many listen to a publisher."""
        self.until(lambda: publisher.get_subscription_count() >= count, 'who listens')
