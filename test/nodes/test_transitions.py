# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Transitions that fail leave a node as it was before."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from bearing_twin.errors import BearingTwinError
from copies import raw_recording
import pytest

pytest.importorskip('rclpy')

from bearing_twin.nodes.replay import ReplayNode
from bearing_twin.ros.health import Health
from bearing_twin.ros.lifecycle import entities, ManagedNode
from rclpy.lifecycle import TransitionCallbackReturn
from std_msgs.msg import String

pytestmark = pytest.mark.ros

SUCCESS, FAILURE = TransitionCallbackReturn.SUCCESS, TransitionCallbackReturn.FAILURE


class Failing(ManagedNode):
    """A node whose steps fail as often as it is told."""

    def __init__(self, error: Exception, *steps: str) -> None:
        super().__init__('failing', ())
        self.error = error
        self.steps = list(steps)
        self.torn_down = 0

    def setup(self) -> None:
        """Make what a node has."""
        Health(self, '')
        self.out = self.create_lifecycle_publisher(String, 'out', 10)
        self.offer('~/reset', str)
        self.fail('setup')

    def start(self) -> None:
        """Listen, and fail."""
        self.create_subscription(String, 'in', print, 10)
        self.fail('start')

    def fail(self, step: str) -> None:
        """Raise where this step is to fail once more."""
        if step in self.steps:
            self.steps.remove(step)
            raise self.error

    def teardown(self) -> None:
        """Count."""
        self.torn_down += 1


def test_a_refused_configure_leaves_nothing_beside_the_next(here: Callable[..., Any]) -> None:
    node = here(lambda: Failing(BearingTwinError('no'), 'setup', 'setup'))
    before = entities(node)
    for _ in range(2):
        assert node.trigger_configure() == FAILURE
        assert entities(node) == before
    assert node.trigger_configure() == SUCCESS
    assert node.count_publishers('/diagnostics') == 1


def test_what_a_step_made_ends_with_it(here: Callable[..., Any]) -> None:
    node = here(lambda: Failing(BearingTwinError('no')))
    before = entities(node)
    node.trigger_configure()
    inactive = entities(node)
    node.trigger_activate()
    assert before < inactive < entities(node)
    node.trigger_deactivate()
    assert entities(node) == inactive
    node.trigger_cleanup()
    assert entities(node) == before


def test_a_refused_activate_listens_to_nothing(here: Callable[..., Any]) -> None:
    node = here(lambda: Failing(BearingTwinError('no'), 'start'))
    node.trigger_configure()
    before = entities(node)
    assert node.trigger_activate() == FAILURE
    assert entities(node) == before
    assert not node.out.is_activated
    assert node.trigger_activate() == SUCCESS
    assert node.count_subscribers('/in') == 1


def test_a_defect_leaves_a_node_that_can_be_configured_anew(here: Callable[..., Any]) -> None:
    node = here(lambda: Failing(KeyError('a defect'), 'start'))
    before = entities(node)
    node.trigger_configure()
    node.trigger_activate()
    assert (node.configured, node.active, node.torn_down) == (False, False, 1)
    assert entities(node) == before
    assert node.trigger_configure() == SUCCESS
    assert node.trigger_activate() == SUCCESS


def test_a_topic_whose_name_ros_does_not_have_costs_only_itself(
    here: Callable[..., Any], tmp_path: Path
) -> None:
    path = tmp_path / 'a.mcap'
    with raw_recording(path) as writer:
        schema = writer.register_schema('std_msgs/msg/String', 'ros2msg', b'string data')
        for topic in ('/ok', '/bad name', '/1x', '/a//b', '/end/'):
            channel = writer.register_channel(topic, 'cdr', schema)
            writer.add_message(channel, 1, b'\0\1\0\0\2\0\0\0a\0', 1)
    node = here(ReplayNode, recording=str(path))
    assert node.trigger_configure() == SUCCESS
    assert list(node._topics) == ['/ok']
    assert len(node._left_out) == 4
