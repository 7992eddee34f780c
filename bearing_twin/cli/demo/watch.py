# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Progress of the demo: one line a second, from the topics of the nodes."""

from __future__ import annotations

from collections.abc import Callable
import sys
import time
from typing import Any

from bearing_twin.errors import BearingTwinError
from bearing_twin.ros.processes.deadlock import bounded, LEAVING
from bearing_twin.ros.topics.qos import RESULT, STREAM
from bearing_twin_msgs.msg import Diagnosis, TwinState
import rclpy
from rclpy.executors import SingleThreadedExecutor


class Watcher:
    """Listen to the twin and to the diagnosis."""

    def __enter__(self) -> Watcher:
        """Join the ROS domain of the environment."""
        self._context = rclpy.Context()
        self._context.init()
        self._node = rclpy.create_node('demo', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._state: TwinState | None = None
        self._verdict: Diagnosis | None = None
        self._node.create_subscription(TwinState, 'twin_state', self._on_state, STREAM)
        self._node.create_subscription(Diagnosis, 'diagnosis', self._on_verdict, RESULT)
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the ROS domain."""
        sys.stdout.flush()
        with bounded(LEAVING, 1):
            self._executor.shutdown()
            self._node.destroy_node()
            self._context.shutdown()

    def _on_state(self, message: TwinState) -> None:
        self._state = message

    def _on_verdict(self, message: Diagnosis) -> None:
        self._verdict = message

    def listen(self, kind: Any, topic: str, take: Callable[[Any], None]) -> None:
        """Call ``take`` with each message of a topic of results."""
        self._node.create_subscription(kind, topic, take, RESULT)

    def wait_for_listeners(
        self, count: int, check: Callable[[], None], timeout: float, topic: str = 'vibration'
    ) -> None:
        """Wait until ``count`` nodes listen to a topic."""
        self.wait(lambda: self._node.count_subscribers(topic) >= count, check, timeout)

    def wait_for_vibration(self, check: Callable[[], None], timeout: float) -> None:
        """Wait until the twin publishes."""
        self.wait(lambda: self._state is not None, check, timeout)

    def wait(
        self,
        ready: Callable[[], object],
        check: Callable[[], None],
        timeout: float,
        what: str = 'the nodes did not come up',
    ) -> None:
        """Listen until ``ready`` returns something true; ``what`` is the error at a timeout."""
        deadline = time.monotonic() + timeout
        while not ready():
            check()
            if time.monotonic() > deadline:
                raise BearingTwinError(f'{what} within {timeout:.0f} s; see their logs')
            self._executor.spin_once(timeout_sec=0.1)

    def show(self, seconds: float, *, quiet: bool) -> None:
        """Listen for a while, then print one line about the latest state and verdict."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self._executor.spin_once(timeout_sec=left)
        if self._node.count_publishers('twin_state') > 1:
            msg = 'another twin has come into the ROS domain of the demo: end it, and start again'
            raise BearingTwinError(msg)
        state, verdict = self._state, self._verdict
        if quiet or state is None:
            return
        line = f'{state.temperature_used:6.1f} degC  beta0 {state.beta0:.4f}'
        if verdict is not None:
            line += f'  |  {verdict.result_name:<12} confidence {verdict.confidence:.2f}'
        # The rest of a longer line before is erased.
        end_of_line = '\x1b[K\r' if sys.stdout.isatty() else '\n'
        print(line, end=end_of_line, flush=True)
