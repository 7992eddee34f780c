# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the recorder subscribes to, and what it takes before it unsubscribes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
import errno
from pathlib import Path
import shutil
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.recording.reader import read_messages
import pytest

pytest.importorskip('rclpy')


from bearing_twin.nodes.recorder import RecorderNode
from bearing_twin.ros.topics import raw, rawsubscriptions
from bearing_twin.ros.topics.rawsubscriptions import TopicChoice
from commands import python
import geometry_msgs
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64, String

if TYPE_CHECKING:
    from rclpy.node import Node

    Maker = Callable[..., Any]

pytestmark = pytest.mark.ros

SENT = 20


def until(happened: Callable[[], bool]) -> None:
    end = time.monotonic() + 120.0
    while not happened():
        assert time.monotonic() < end
        time.sleep(0.02)


@pytest.fixture
def elsewhere(ros_domain: int) -> Iterator[Maker]:
    """Return a maker of nodes in contexts of their own: one context refuses a second type."""
    made = []

    def make(name: str) -> Node:
        context = rclpy.Context()
        context.init()
        made.append(rclpy.create_node(name, context=context))
        return made[-1]

    yield make
    for node in made:
        node.context.shutdown()


def test_a_changed_topic_costs_nothing_of_what_came_before(here: Maker, tmp_path: Path) -> None:
    bag = tmp_path / 'bag'
    recorder = here(RecorderNode, output=str(bag), topics=['level'])
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
    found = [m.decode().data for m in read_messages(bag, topics=['/level'])]
    assert found[:SENT] == list(range(SENT))


@pytest.mark.parametrize('namespace', ['/', '/fan_7', '/line3/fan.7'])
def test_the_regex_of_a_machine_follows_the_namespace_of_the_recorder(namespace: str) -> None:
    values = {'regex': '{namespace}/.*|/diagnostics', 'exclude': '', 'include_hidden': False}
    choice = TopicChoice(values, set(), namespace)
    assert f'{namespace.rstrip("/")}/vibration' in choice
    assert '/diagnostics' in choice
    assert ('/line3/fan_7/vibration' in choice) == (namespace == '/')


def test_a_second_type_for_a_moment_ends_no_recording(
    here: Maker, elsewhere: Maker, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    bag = tmp_path / 'bag'
    beside = 'std_msgs/msg/String beside std_msgs/msg/Float64'
    recorder = here(RecorderNode, output=str(bag), topics=['level', 'text'])
    recorder.trigger_configure()
    source, other = (elsewhere(name) for name in ('source', 'other'))
    level = source.create_publisher(Float64, 'level', 10)
    first = source.create_publisher(Float64, 'text', 10)
    other.create_publisher(String, 'text', 10)
    until(lambda: recorder.count_publishers('/level') == 1)
    until(lambda: recorder.count_publishers('/text') == 2)
    recorder.trigger_activate()
    topics = recorder._topics
    assert (len(topics), topics.left_out.keys()) == (1, {'/text'})
    stray = other.create_publisher(String, 'level', 10)
    until(lambda: recorder.count_publishers('/level') == 2)
    topics.discover()
    assert topics.left_out['/level'] == beside
    until(lambda: level.get_subscription_count() == 1)
    level.publish(Float64(data=1.0))
    assert level.wait_for_all_acked(rclpy.duration.Duration(seconds=60))
    other.destroy_publisher(stray)
    source.destroy_publisher(first)
    until(lambda: recorder.count_publishers('/level') == recorder.count_publishers('/text') == 1)
    topics.discover()
    assert (len(topics), topics.left_out) == (2, {})
    recorder.shut_down()
    assert [m.decode().data for m in read_messages(bag, topics=['/level'])] == [1.0]
    said = capfd.readouterr().err
    assert '/text is not recorded: ' in said
    assert f'/level is recorded in one type only: {beside}' in said
    assert all(f'{topic} is recorded, all of it' in said for topic in ('/level', '/text'))


def test_topics_that_nobody_publishes_any_more_are_let_go(
    here: Maker, elsewhere: Maker, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rawsubscriptions, 'MOST_SILENT', 3)
    bag = tmp_path / 'bag'
    recorder = here(RecorderNode, output=str(bag), regex='/(passing|odd).*')
    recorder.trigger_configure()
    recorder.trigger_activate()
    source, other = (elsewhere(name) for name in ('source', 'other'))
    topics = recorder._topics

    def pass_by(names: list[str]) -> None:
        """Publish on topics, and leave."""
        passing = [source.create_publisher(Float64, name, 10) for name in names]
        # A topic of two types is left out, and told.
        passing += [node.create_publisher(kind, 'odd_' + names[0], 10)
                    for node, kind in ((source, Float64), (other, String))]  # fmt: skip
        until(lambda: recorder.count_publishers('/odd_' + names[0]) == 2)
        until(lambda: all(recorder.count_publishers('/' + name) for name in names))
        topics.discover()
        for publisher in passing[: len(names)]:
            until(lambda publisher=publisher: publisher.get_subscription_count() == 1)
            publisher.publish(Float64(data=1.0))
            assert publisher.wait_for_all_acked(rclpy.duration.Duration(seconds=60))
        for publisher in passing:
            (other if publisher is passing[-1] else source).destroy_publisher(publisher)
        until(lambda: not any(recorder.count_publishers('/' + name) for name in names))
        until(lambda: not recorder.count_publishers('/odd_' + names[0]))
        topics.discover()

    for turn in range(3):
        pass_by([f'passing_{turn}_{k}' for k in range(4)])
        assert len(topics) + len(topics.left_out) == 3
    pass_by(['passing_0_0'])
    recorder.shut_down()
    found = [m.topic for m in read_messages(bag, topics=['/passing_0_0', '/passing_2_3'])]
    assert found == ['/passing_0_0', '/passing_2_3', '/passing_0_0']


def test_a_topic_that_is_remapped_away_is_left_out_and_told(
    elsewhere: Maker, tmp_path: Path
) -> None:
    bag = tmp_path / 'bag'
    rclpy.init(args=['--ros-args', '-p', f'output:={bag}', '-r', 'level:=/fan/level'])
    try:
        recorder = RecorderNode()
        recorder.trigger_configure()
        source = elsewhere('source')
        level = source.create_publisher(Float64, 'level', 10)
        fan = source.create_publisher(Float64, '/fan/level', 10)
        until(
            lambda: (
                {'/level', '/fan/level'} <= {t for t, _ in recorder.get_topic_names_and_types()}
            )
        )
        recorder.trigger_activate()
        until(lambda: fan.get_subscription_count() == 1)
        for k in range(SENT):
            level.publish(Float64(data=11.0))
            fan.publish(Float64(data=float(k)))
        assert fan.wait_for_all_acked(rclpy.duration.Duration(seconds=60))
        assert 'a remap rule' in recorder._topics.left_out['/level']
        time.sleep(0.5)
        recorder.shut_down()
    finally:
        rclpy.shutdown()
    found = [(m.topic, m.decode().data) for m in read_messages(bag) if 'level' in m.topic]
    assert found == [('/fan/level', float(k)) for k in range(SENT)]


def test_a_definition_that_the_system_does_not_give_is_read_again(
    here: Maker, elsewhere: Maker, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_: str) -> None:
        raise OSError(errno.EMFILE, 'Too many open files')

    recorder = here(RecorderNode, output=str(tmp_path / 'bag'))
    recorder.trigger_configure()
    level = elsewhere('source').create_publisher(Float64, 'level', 10)
    until(lambda: recorder.count_publishers('/level') == 1)
    with monkeypatch.context() as patched:
        patched.setattr(raw, 'message_schema', refuse)
        recorder.trigger_activate()
    topics = recorder._topics
    assert 'Too many open files' in topics.left_out['/level']
    topics.discover()
    assert topics.left_out == {}
    until(lambda: level.get_subscription_count() == 1)


def test_messages_built_for_another_python_are_refused(tmp_path: Path) -> None:
    built = Path(geometry_msgs.__file__).parent
    shutil.copytree(built, tmp_path / 'geometry_msgs', ignore=shutil.ignore_patterns('*.so'))
    ran = python(
        '-c',
        f"""import sys
sys.path.insert(0, {str(tmp_path)!r})
from bearing_twin.ros.topics.raw import message_class
message_class('geometry_msgs/msg/Point')
""",
    )
    assert 'BearingTwinError: message type geometry_msgs/msg/Point cannot be used' in ran.stderr
    assert 'build geometry_msgs for this Python' in ran.stderr


def test_what_waits_for_a_clock_is_bounded_by_memory(here: Maker, tmp_path: Path) -> None:
    recorder = here(
        RecorderNode, output=str(tmp_path / 'bag'), use_sim_time=True, max_cache_size=1
    )
    recorder.trigger_configure()
    info: dict = dict.fromkeys(
        ('received_timestamp', 'source_timestamp', 'publication_sequence_number'), 0
    )
    for _ in range(20):
        recorder._on_message('/x', 'std_msgs/msg/String', bytes(300_000), info)
    # Three of them are less than 1 MiB.
    assert (len(recorder._early), recorder._lost) == (3, 17)


def test_only_what_is_drawn_is_decoded(here: Maker, tmp_path: Path) -> None:
    recorder = here(
        RecorderNode, output=str(tmp_path / 'bag'), rerun_file=str(tmp_path / 'live.rrd')
    )
    recorder.trigger_configure()
    info: dict = {'publisher_gid': None} | dict.fromkeys(
        ('received_timestamp', 'source_timestamp', 'publication_sequence_number'), 0
    )
    broken = b'\x00\x01\x00\x00'
    for topic, name in (
        ('/tf', 'tf2_msgs/msg/TFMessage'),
        ('/features/rms', 'std_msgs/msg/Float64MultiArray'),
    ):
        recorder._on_message(topic, name, broken, info)
        assert recorder._watch.problem == ''
    recorder._on_message('/temperature', 'sensor_msgs/msg/Temperature', broken, info)
    assert recorder._watch.problem.startswith('/temperature could not be looked at')
