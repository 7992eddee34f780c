# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Live replay: what was recorded is on ROS again, at its pace, and can be held and stepped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
import os
from pathlib import Path
import time
from typing import Any

from bearing_twin.nodes.replay import ReplayNode
from bearing_twin.offline.output import output
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.writer import RecordingWriter
from bearing_twin_msgs.msg import Vibration
from copies import put
from forked import ForkedNodes, run_command
from lifecycle_msgs.msg import TransitionEvent
import pytest
import rclpy
from recorder_process import Source, TIMEOUT
from recording_samples import PERIOD, TEMPERATURE, temperature_cdr, write_blocks
from std_srvs.srv import Trigger

pytestmark = pytest.mark.ros

REPLAY = 'replay: replay'


def test_replayed_and_recorded_again_the_bytes_are_the_same(
    ros_domain: int, tmp_path: Path
) -> None:
    written = write_blocks(tmp_path / 'run', 75)
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(tmp_path / 'again')})
        source.wait_for_recorder()
        parameters = {
            'recording': str(tmp_path / 'run'),
            'rate': 0.5,
            'topics': ['/vibration'],
            'remap': ['/vibration:=/line3/vibration'],
            'clock_rate': 100.0,
            'subscriber_timeout': TIMEOUT,
            'start_paused': True,
        }
        nodes.start('replay', parameters)
        # It waits for those who listen to what it replays, and not for those of its clock.
        source.until(lambda: source.node.count_subscribers('/clock') > 0, 'who tells the time')
        assert source.call(Trigger, '/replay/resume').success
        assert nodes.wait('replay', TIMEOUT) == 0
        assert nodes.end('recorder') == 0
    again = list(read_messages(tmp_path / 'again', topics=['/line3/vibration']))
    assert [m.cdr for m in again] == written
    # At half the pace; a busy machine may stretch it, nothing may shorten it.
    took = again[-1].publish_time - again[0].publish_time
    assert took >= 0.95 * 74 * PERIOD / 0.5
    clock = [m.decode().clock for m in read_messages(tmp_path / 'again', topics=['/clock'])]
    times = [c.sec * 10**9 + c.nanosec for c in clock]
    recorded = [m.log_time for m in read_messages(tmp_path / 'run', topics=['/vibration'])]
    assert times == sorted(times)
    assert recorded[0] <= times[0] <= times[-1] <= recorded[-1] + PERIOD
    assert len(times) > 20


def test_paused_stepped_resumed(ros_domain: int, tmp_path: Path) -> None:
    write_blocks(tmp_path / 'run', 25)
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('replay', {'recording': str(tmp_path / 'run'), 'start_paused': True})
        step = source.call(Trigger, '/replay/step')
        assert step.success
        assert '/vibration' in step.message
        assert '/temperature' in source.call(Trigger, '/replay/step').message
        assert source.call(Trigger, '/replay/resume').success
        assert nodes.wait('replay', TIMEOUT) == 0
    log = (tmp_path / 'logs' / 'replay.log').read_text()
    assert '50 messages' in log
    assert 'the recording has ended' in log


def test_command_line(ros_domain: int, tmp_path: Path) -> None:
    write_blocks(tmp_path / 'run', 10)
    ran = run_command('replay', tmp_path / 'run', '--rate', '10', '--topics', '/temperature')
    assert ran.returncode == 0
    assert '10 messages' in ran.stderr + ran.stdout
    # What no recording could change has a status of its own: a supervisor need not try again.
    for wrong, text, status in (
        ([tmp_path / 'nothing'], 'does not exist', 1),
        ([tmp_path / 'run', '--topics', '/no'], 'has no topic /no', 1),
        ([tmp_path / 'run', '--remap', 'x'], "does not read 'recorded:=new'", 2),
        (
            [tmp_path / 'run', '--remap', '/no:=/x'],
            'remap names /no, which is not replayed; there',
            1,
        ),
        ([tmp_path / 'run', '--remap', '/vibration:=/a b'], "topic name '/a b' is invalid", 2),
        (
            [tmp_path / 'run', '--remap', '/vibration:=/temperature'],
            'on one topic, /temperature',
            1,
        ),
        ([tmp_path / 'run', '--offline'], 'name it with -o', 2),
    ):
        ran = run_command('replay', *wrong)
        assert ran.returncode == status
        assert text in ran.stderr + ran.stdout
        assert 'Traceback' not in ran.stderr


def test_recorded_time_stands_while_nothing_plays_and_a_pause_costs_nothing(
    here: Callable[..., Any], tmp_path: Path
) -> None:
    write_blocks(tmp_path / 'run', 5)
    replay = here(
        ReplayNode, recording=str(tmp_path / 'run'), clock_rate=100.0, start_paused=True,
        subscriber_timeout=0.0,
    )  # fmt: skip
    replay.trigger_configure()
    player = replay._player
    replay._set_paused(paused=False)
    for rate in (2.0, 3.0):
        replay.apply({'rate': rate})
        time.sleep(0.05)
    assert player.position == player.start
    replay._set_paused(paused=True)
    looked = []
    due = player.due
    player.due = lambda now: looked.append(now) or due(now)
    replay.trigger_activate()
    time.sleep(1.0)
    replay.shut_down()
    # Twice a second, and not whenever it can.
    assert len(looked) < 20


def test_a_topic_that_is_live_is_told(here: Callable[..., Any], tmp_path: Path) -> None:
    write_blocks(tmp_path / 'run', 5)
    with RecordingWriter(tmp_path / 'replayed') as writer:
        for message in read_messages(tmp_path / 'run'):
            put(writer, message)
        # Published by the node that was recorded, and by the one that replays it.
        event = output('/replay/transition_event', TransitionEvent())
        writer.write(event.topic, event.type_name, event.cdr, log_time=message.log_time)
    replay = here(
        ReplayNode, recording=str(tmp_path / 'replayed'), start_paused=True, subscriber_timeout=0.0
    )
    replay.trigger_configure()
    assert '/replay/transition_event' in {p.topic_name for p in replay._topics.values()}
    assert replay._status().message == 'paused'
    other = rclpy.create_node('sensor')
    live = other.create_publisher(Vibration, '/vibration', 10)
    end = time.monotonic() + TIMEOUT
    said = 'paused; /vibration is published by other nodes, too: end these'
    while not replay._status().message.startswith(said):
        assert time.monotonic() < end, replay._status()
        time.sleep(0.05)
    other.destroy_publisher(live)
    while replay._status().message != 'paused':
        assert time.monotonic() < end, replay._status()
        time.sleep(0.05)
    other.destroy_node()


def test_what_subscribers_would_misread_is_left_out(ros_domain: int, tmp_path: Path) -> None:
    write_blocks(tmp_path / 'run.mcap', 3)
    with RecordingWriter(tmp_path / 'other.mcap') as writer:
        for message in read_messages(tmp_path / 'run.mcap'):
            channel = replace(message.channel, type_hash='RIHS01_' + '0' * 64)
            writer.copy(message._replace(channel=channel))
        at = message.log_time
        writer.write('/t', TEMPERATURE, temperature_cdr(5, 20.0), log_time=at)
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes:
        recording = str(tmp_path / 'other.mcap')
        nodes.start('replay', {'recording': recording, 'subscriber_timeout': 0.0, 'rate': 1e6})
        assert nodes.wait('replay', TIMEOUT) == 1
    said = ''.join(path.read_text() for path in (tmp_path / 'logs').iterdir())
    assert '/vibration is left out: bearing_twin_msgs/msg/Vibration was recorded' in said
    assert 'the recording has ended' in said
