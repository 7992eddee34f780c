# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The executor of the nodes: timers as before, services seldom looked at and yet answered."""

import time

import pytest

rclpy = pytest.importorskip('rclpy', reason='ROS 2 is not installed')
trigger = pytest.importorskip('std_srvs.srv', reason='std_srvs is not installed').Trigger

from bearing_twin.ros.executor import (  # noqa: E402
    EVENTS,
    LeanExecutor,
    PolledGroup,
    RARE_PERIOD,
    SERVICES,
)
from rclpy.context import Context  # noqa: E402
from rclpy.service import Service  # noqa: E402
from std_msgs.msg import String  # noqa: E402


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


@pytest.fixture
def context(ros_domain):
    """Return a context of the test's own, which ends with it."""
    made = Context()
    rclpy.init(args=[], context=made)
    yield made
    rclpy.try_shutdown(context=made)


@pytest.mark.ros
@pytest.mark.parametrize('spin', [by_single_steps, by_the_loops_of_rclpy])
def test_services_are_answered_between_the_beats_of_a_fast_timer(context, spin):
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


@pytest.mark.ros
def test_a_wait_is_for_few_things_however_many_the_node_has(context):
    node = rclpy.create_node('many', context=context)
    executor = LeanExecutor(context=context)
    executor.add_node(node)
    group, heard = PolledGroup(0.02), []
    for k in range(60):
        node.create_subscription(
            String, f'topic_{k}', lambda m: heard.append(m.data), 10, callback_group=group
        )
    for k in range(3 * SERVICES):
        node.create_service(trigger, f'ask_{k}', lambda _, response: response)
    publishers = [node.create_publisher(String, f'topic_{k}', 10) for k in (0, 59)]
    clients = [node.create_client(trigger, f'ask_{k}') for k in (0, 1, 3 * SERVICES - 1)]
    assert all(client.wait_for_service(60.0) for client in clients)
    executor.spin_once(timeout_sec=0.0)
    (seen,) = executor.get_nodes()
    assert len(seen.services) <= SERVICES
    assert len(seen.waitables) <= EVENTS
    while any(publisher.get_subscription_count() == 0 for publisher in publishers):
        time.sleep(0.02)
    for client in clients:
        executor.spin_until_future_complete(client.call_async(trigger.Request()))
    for publisher in publishers:
        for number in range(3):
            publisher.publish(String(data=f'{publisher.topic_name} {number}'))
    deadline = time.monotonic() + 60.0
    while len(heard) < 6 and time.monotonic() < deadline:
        executor.spin_once(timeout_sec=0.1)
    assert heard == [f'/topic_{k} {number}' for k in (0, 59) for number in range(3)]
    for subscription in list(node.subscriptions):
        node.destroy_subscription(subscription)
    executor.spin_once(timeout_sec=0.05)
    executor.shutdown()
    node.destroy_node()
