# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the recorder subscribes to, and what it takes before it unsubscribes."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from bearing_twin.recording.reader import read_messages
import pytest

pytest.importorskip('rclpy')

from bearing_twin.nodes.recorder import RecorderNode
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

pytestmark = pytest.mark.ros

SENT = 20


def until(happened: Callable[[], bool]) -> None:
    end = time.monotonic() + 120.0
    while not happened():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_a_changed_topic_costs_nothing_of_what_came_before(
    ros_domain: int, tmp_path: Path
) -> None:
    bag = tmp_path / 'bag'
    rclpy.init(args=['--ros-args', '-p', f'output:={bag}', '-p', 'topics:=[level]'])
    try:
        recorder = RecorderNode()
        recorder.trigger_configure()
        source = rclpy.create_node('source')
        depth = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        latched = source.create_publisher(Float64, 'level', depth)
        until(lambda: recorder.count_publishers('/level') == 1)
        recorder.trigger_activate()
        until(lambda: latched.get_subscription_count() == 1)
        for k in range(SENT):
            latched.publish(Float64(data=float(k)))
        # All of it is with the recorder's middleware, and nobody has looked.
        assert latched.wait_for_all_acked(rclpy.duration.Duration(seconds=60))
        time.sleep(0.5)
        best_effort = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
        source.create_publisher(Float64, 'level', best_effort)
        until(lambda: recorder.count_publishers('/level') == 2)
        recorder._topics.discover()
        recorder.shut_down()
    finally:
        rclpy.shutdown()
    found = [m.decode().data for m in read_messages(bag, topics=['/level'])]
    assert found[:SENT] == list(range(SENT))
