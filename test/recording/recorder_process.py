# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A recorder as a process, and a source that publishes to it from the test."""

from __future__ import annotations

import array
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.nodes.convert import time_message
from bearing_twin.nodes.qos import RESULT, STREAM
from bearing_twin_msgs.msg import Vibration
from diagnostic_msgs.msg import DiagnosticArray
import rclpy
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from std_srvs.srv import Trigger

if TYPE_CHECKING:
    from collections.abc import Callable

BLOCK = 1024
PERIOD = BLOCK / 25600.0


class Source:
    """Publishes blocks in real time, and listens to /diagnostics."""

    def __enter__(self) -> Source:
        self._context = rclpy.Context()
        self._context.init()
        self.node = rclpy.create_node('source', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._vibration = self.node.create_publisher(Vibration, 'vibration', STREAM)
        self.statuses: dict[str, Any] = {}
        self.node.create_subscription(DiagnosticArray, '/diagnostics', self._listen, RESULT)
        self.sent: list[tuple[int, int]] = []
        """Running block number and time of sending, ns."""
        self._due = time.monotonic()
        return self

    def __exit__(self, *_: object) -> None:
        self._executor.shutdown()
        self.node.destroy_node()
        self._context.shutdown()

    def _listen(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.statuses[status.name] = status

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
        self.sent.append((index, stamp))

    def wait_for(self, status: str, timeout: float = 90.0) -> None:
        """Wait, without publishing, until a part of a node has reported."""
        end = time.monotonic() + timeout
        while status not in self.statuses:
            assert time.monotonic() < end, f'{status} did not report within {timeout} s'
            self._executor.spin_once(timeout_sec=0.05)

    def settle(self) -> None:
        """Wait, without publishing, until what was sent has arrived."""
        self._vibration.wait_for_all_acked(Duration(seconds=10))
        time.sleep(1.0)
        self._due = time.monotonic()

    def publish_until(self, ready: Callable[[], bool], timeout: float = 30.0) -> None:
        """Publish until something is so."""
        end = time.monotonic() + timeout
        while not ready():
            assert time.monotonic() < end, f'not so within {timeout} s'
            self.publish_for(0.2)

    def wait_for_recorder(self, *, recorders: int = 1) -> None:
        """Wait, without publishing, until so many listen."""
        end = time.monotonic() + 30.0
        while self._vibration.get_subscription_count() < recorders:
            assert time.monotonic() < end, f'{recorders} recorders did not come up within 30 s'
            self._executor.spin_once(timeout_sec=0.05)
        self._due = time.monotonic()

    def call(self, service: str) -> Any:
        """Call a Trigger service."""
        client = self.node.create_client(Trigger, service)
        assert client.wait_for_service(10.0)
        future = client.call_async(Trigger.Request())
        end = time.monotonic() + 10.0
        while not future.done() and time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.05)
        self.node.destroy_client(client)
        return future.result()
