# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A recorder as a process, and a source that publishes to it from the test."""

from __future__ import annotations

import array
import copy
from pathlib import Path
import shutil
import tempfile
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.messages import time_message
from bearing_twin.recording.reader import recording_info
from bearing_twin.recording.recover import recover
from bearing_twin.ros.qos import RESULT, STREAM
from bearing_twin_msgs.msg import Vibration
from diagnostic_msgs.msg import DiagnosticArray
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
import rclpy
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from std_srvs.srv import Trigger

if TYPE_CHECKING:
    from collections.abc import Callable

    from bearing_twin.recording.reader import RecordingInfo
    from rclpy.publisher import Publisher

BLOCK = 1024
PERIOD = BLOCK / 25600.0
TIMEOUT = 120.0
"""After it a test gives up; no bound on how long anything may take, s."""
KEPT = 1000
"""Blocks that a source keeps for whoever has not taken them, unless told otherwise."""


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


class Source:
    """
    Publishes blocks in real time, and listens to /diagnostics.

    It keeps every block that a test sends, so that one is missing in a recording only if the
    recorder has lost it.
    """

    def __init__(self, kept: int = KEPT) -> None:
        self._qos = copy.copy(STREAM)
        self._qos.depth = kept

    def __enter__(self) -> Source:
        self._context = rclpy.Context()
        self._context.init()
        self.node = rclpy.create_node('source', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._vibration = self.node.create_publisher(Vibration, 'vibration', self._qos)
        self.statuses: dict[str, Any] = {}
        self.clocks: dict[str, int] = {}
        """Time of each node by its own clock when it reported last, s."""
        self.node.create_subscription(DiagnosticArray, '/diagnostics', self._listen, RESULT)
        self.sent: list[tuple[int, int]] = []
        """Of each block: times right before and after it was sent, ns; the first is its stamp."""
        self._due = time.monotonic()
        return self

    def __exit__(self, *_: object) -> None:
        self._executor.shutdown()
        self.node.destroy_node()
        self._context.shutdown()

    def _listen(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.statuses[status.name] = status
            self.clocks[status.name.split(':')[0]] = message.header.stamp.sec

    def publish_for(self, seconds: float) -> None:
        """Publish a block each 40 ms, and listen meanwhile."""
        end = time.monotonic() + seconds
        while (now := time.monotonic()) < end:
            if now >= self._due:
                self._due = max(self._due + PERIOD, now - PERIOD)
                self._publish()
            self._executor.spin_once(timeout_sec=max(0.0, min(self._due, end) - now))

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
        self.wait_until(lambda: status in self.statuses, f'a report of {status}')

    def values(self, status: str) -> dict[str, str]:
        """Return the values that a part has reported last."""
        return {item.key: item.value for item in self.statuses[status].values}

    def settle(self) -> None:
        """Wait, without publishing, until what was sent has arrived at those who listen."""
        assert self._vibration.wait_for_all_acked(Duration(seconds=TIMEOUT))
        self._due = time.monotonic()

    def publish_until(self, ready: Callable[[], bool]) -> None:
        """Publish until something is so."""
        end = time.monotonic() + TIMEOUT
        while not ready():
            assert time.monotonic() < end, f'not so within {TIMEOUT} s'
            self.publish_for(0.2)

    def publish_until_told(self, status: str) -> dict[str, str]:
        """Publish until a part reports anew; return the values of that."""
        self.statuses.pop(status, None)
        self.publish_until(lambda: status in self.statuses)
        return self.values(status)

    def wait_for_recorder(self, *, recorders: int = 1) -> None:
        """Wait, without publishing, until so many listen."""
        self.wait_for_subscribers(self._vibration, recorders)
        self._due = time.monotonic()

    def wait_for_subscribers(self, publisher: Publisher[Any], count: int = 1) -> None:
        """Wait, without publishing blocks, until so many listen to a publisher."""
        self.wait_until(lambda: publisher.get_subscription_count() >= count, 'who listens')

    def wait_until(self, ready: Callable[[], bool], what: str = 'it') -> None:
        """Wait, without publishing blocks, until something is so."""
        end = time.monotonic() + TIMEOUT
        while not ready():
            assert time.monotonic() < end, f'{what} did not come within {TIMEOUT} s'
            self._executor.spin_once(timeout_sec=0.05)

    def change(self, node: str, transition: str) -> None:
        """Have a lifecycle node make a transition."""
        request = ChangeState.Request(transition=Transition(label=transition))
        assert self.call(f'{node}/change_state', ChangeState, request).success

    def call(self, service: str, kind: Any = Trigger, request: Any = None) -> Any:
        """Call a service."""
        client = self.node.create_client(kind, service)
        assert client.wait_for_service(TIMEOUT)
        future = client.call_async(request or kind.Request())
        self.wait_until(future.done, f'the answer of {service}')
        self.node.destroy_client(client)
        return future.result()
