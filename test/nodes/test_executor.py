# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The executor of the nodes: timers as before, services seldom looked at and yet answered."""

import time

import pytest

rclpy = pytest.importorskip('rclpy', reason='ROS 2 is not installed')
trigger = pytest.importorskip('std_srvs.srv', reason='std_srvs is not installed').Trigger

from bearing_twin.nodes.executor import LeanExecutor, RARE_PERIOD  # noqa: E402
import numpy as np  # noqa: E402
from rclpy.context import Context  # noqa: E402
from rclpy.service import Service  # noqa: E402


class Counting(LeanExecutor):
    """Count how often services are waited for."""

    looks = 0

    def can_execute(self, entity):
        allowed = super().can_execute(entity)
        self.looks += allowed and isinstance(entity, Service) and entity.srv_name.endswith('/ask')
        return allowed


def test_services_are_answered_between_the_beats_of_a_fast_timer():
    context = Context()
    rclpy.init(args=[], context=context)
    try:
        node = rclpy.create_node('beats', context=context)
        executor = Counting(context=context)
        executor.add_node(node)
        beats, answers = [], []
        node.create_timer(0.005, lambda: beats.append(time.monotonic()))
        node.create_service(trigger, '~/ask', lambda _, response: response)
        client = node.create_client(trigger, '~/ask')
        assert client.wait_for_service(10.0)
        began = time.monotonic()
        while time.monotonic() - began < 1.0:
            asked = time.monotonic()
            future = client.call_async(trigger.Request())
            while not future.done() and time.monotonic() - asked < 5.0:
                executor.spin_once()
            answers.append(time.monotonic() - asked)
        assert np.median(answers) < 2.0 * RARE_PERIOD
        assert max(answers) < 5.0
        assert len(beats) > 5 * executor.looks
        # Each wait for the timer would look at the service otherwise.
        assert executor.looks <= (time.monotonic() - began) / RARE_PERIOD + 2
        executor.shutdown()
        node.destroy_node()
    finally:
        rclpy.try_shutdown(context=context)
