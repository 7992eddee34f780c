# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The executor of the nodes: timers as before, services seldom looked at and yet answered."""

import time

import pytest

rclpy = pytest.importorskip('rclpy', reason='ROS 2 is not installed')
trigger = pytest.importorskip('std_srvs.srv', reason='std_srvs is not installed').Trigger

from bearing_twin.ros.executor import LeanExecutor, RARE_PERIOD  # noqa: E402
from rclpy.context import Context  # noqa: E402
from rclpy.service import Service  # noqa: E402


class Counting(LeanExecutor):
    """Count how often services are waited for."""

    looks = 0

    def can_execute(self, entity):
        allowed = super().can_execute(entity)
        self.looks += allowed and isinstance(entity, Service) and entity.srv_name.endswith('/ask')
        return allowed


def by_single_steps(executor, future):
    while not future.done():
        executor.spin_once()


def by_the_loops_of_rclpy(executor, future):
    # Goes the way that spin() goes in newer rclpy: not through spin_once().
    executor.spin_until_future_complete(future)


@pytest.mark.ros
@pytest.mark.parametrize('spin', [by_single_steps, by_the_loops_of_rclpy])
def test_services_are_answered_between_the_beats_of_a_fast_timer(ros_domain, spin):
    context = Context()
    rclpy.init(args=[], context=context)
    try:
        node = rclpy.create_node('beats', context=context)
        executor = Counting(context=context)
        executor.add_node(node)
        beats = []
        node.create_timer(0.005, lambda: beats.append(executor.looks))
        node.create_service(trigger, '~/ask', lambda _, response: response)
        client = node.create_client(trigger, '~/ask')
        assert client.wait_for_service(60.0)
        began = time.monotonic()
        for _ in range(10):
            spin(executor, client.call_async(trigger.Request()))
        # As often as there is something to look at, each of the waits for the timer would look.
        assert 10 <= executor.looks <= (time.monotonic() - began) / RARE_PERIOD + 2
        # The timer goes on meanwhile: each time it is looked at, and between the looks.
        assert len(set(beats)) >= 9
        executor.shutdown()
        node.destroy_node()
    finally:
        rclpy.try_shutdown(context=context)
