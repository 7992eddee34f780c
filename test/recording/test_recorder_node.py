# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The recorder as a process: what it writes, and what a crash or a bad disk costs."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
import os
from pathlib import Path
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

from bearing_twin.recording.health import examine, sent_before
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.recover import find_unfinished, recover
from bearing_twin.ros.topics.qos import STREAM
from bearing_twin_msgs.msg import Diagnosis
from builtin_interfaces.msg import Time
from forked import ForkedNodes
from mcap.reader import NonSeekingReader
import pytest
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.qos import QoSProfile, ReliabilityPolicy
from recorder_process import BLOCK, on_disk, Source
from recording_samples import write_blocks
from rerun.chunk import RrdReader
from rerun_bindings import check_for_rrd_footer
from rosbags.rosbag2 import Reader
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Temperature
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
import yaml

pytestmark = pytest.mark.ros

MOST_LOST = 1.1
"""Most recorded time that a crash may cost on a machine that does nothing else, s."""
RECORDING = 'recorder: recording'
NANO = 1_000_000_000


def numbers(path: Path) -> list[int]:
    return [
        m.decode().first_sample // BLOCK
        for m in read_messages(path, topics=['/vibration'], recover=True)
    ]


def test_what_arrives_is_what_is_written(ros_domain: int, tmp_path: Path) -> None:
    bag = tmp_path / 'bag'
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(bag), 'max_bag_duration': 1.0})
        source.wait_for_recorder()
        source.publish_until(lambda: len(list(bag.glob('*.mcap'))) >= 3)
        assert source.call(Trigger, '/recorder/split').success
        source.publish_for(0.5)
        source.settle()
        assert nodes.end('recorder', by=signal.SIGTERM) == 0
    # Subscribed before the first block came: not one is missing.
    assert numbers(bag) == list(range(len(source.sent)))
    assert examine(bag)[1].problems == []
    assert len(list(bag.glob('*.mcap'))) >= 4
    with Reader(bag) as reader:
        topics = {c.topic: c for c in reader.connections}
        qos = topics['/vibration'].ext.offered_qos_profiles[0]
        # DDS discovery tells reliability and durability, not history and depth.
        assert (qos.reliability.name, qos.durability.name) == ('RELIABLE', 'VOLATILE')
        assert {'/vibration', '/diagnostics', '/rosout'} <= topics.keys()
    info = recording_info(bag)
    assert info.metadata['bearing_twin.versions'].keys() >= {'bearing_twin', 'numpy', 'mcap'}
    messages = read_messages(bag, topics=['/vibration'])
    for message, (before, after) in zip(messages, source.sent, strict=True):
        assert before <= message.publish_time <= after
        # Received after it was sent.
        assert message.log_time >= message.publish_time


def test_a_picture_that_is_written_for_days_keeps_no_list_of_its_parts(
    ros_domain: int, tmp_path: Path
) -> None:
    rrd = tmp_path / 'live.rrd'
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(tmp_path / 'bag'), 'rerun_file': str(rrd)})
        source.wait_for_recorder()
        source.publish_for(1.0)
        source.settle()
        assert nodes.end('recorder') == 0
    assert 'footer' not in (tmp_path / 'logs' / 'recorder.log').read_text()
    # Rerun keeps a kilobyte of each part until it writes the list of them at the end.
    assert not check_for_rrd_footer(str(rrd))
    assert any('/vibration' in chunk.entity_path for chunk in RrdReader(rrd).stream())


@pytest.mark.skipif(
    not hasattr(_rclpy.Timer, 'call_timer_with_info'),
    reason='rclpy 7 (Jazzy) does not tell who sent a message',
)
def test_what_was_sent_before_it_was_heard_is_counted(ros_domain: int, tmp_path: Path) -> None:
    bag = tmp_path / 'bag'
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        source.publish_for(0.4)
        before = len(source.sent)
        nodes.start('recorder', {'output': str(bag)})
        source.wait_for_recorder()
        for _ in range(3):
            source.publish_until_told(RECORDING)
        source.settle()
        assert nodes.end('recorder') == 0
    told = [sent_before(m.decode()) for m in read_messages(bag, topics=['/diagnostics'])]
    assert before > 0
    assert told[-1] == {'/vibration': before}
    assert numbers(bag) == list(range(before, len(source.sent)))


def test_simulated_time_is_the_time_of_the_recording(ros_domain: int, tmp_path: Path) -> None:
    bag = tmp_path / 'bag'
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(bag), 'use_sim_time': True})
        clock = source.node.create_publisher(Clock, '/clock', 1)
        source.wait_for_recorder()
        source.wait_for(RECORDING)
        # Before the first time is known messages wait.
        source.publish_for(0.5)
        source.publish_until(lambda: 'waiting for' in source.statuses[RECORDING].message)
        early = len(source.sent)

        def written_at(second: int) -> Callable[[], bool]:
            """Publish the time, which nobody asks for again, until messages are written at it."""
            first: list[int] = []

            def reached() -> bool:
                clock.publish(Clock(clock=Time(sec=second)))
                if source.clocks['recorder'] == second:
                    first.append(messages_written(source))
                # More than what it writes of itself.
                return bool(first) and messages_written(source) > first[0] + 10

            return reached

        for second in (1000, 1001, 1002, 500, 501):
            source.publish_until(written_at(second))
        source.settle()
        assert source.statuses[RECORDING].level == b'\x00'
        assert nodes.end('recorder') == 0
    # Time was set back while it recorded: in the file, messages stand as they came.
    with (bag / 'bag_0.mcap').open('rb') as file:
        raw = NonSeekingReader(file).iter_messages(['/vibration'], log_time_order=False)
        times = [message.log_time for _, _, message in raw]
    assert sorted(numbers(bag)) == list(range(len(source.sent)))
    assert len(set(times[:early])) == 1
    steps = [time // 10**9 for time, after in pairwise(times) if time != after]
    assert steps == [1000, 1001, 1002, 500]
    assert any('time runs backwards 1 times' in p for p in examine(bag)[1].problems)


def test_topics_regex_and_exclude(ros_domain: int, tmp_path: Path) -> None:
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(tmp_path / 'a'), 'topics': ['vibration']}, name='a')
        nodes.start(
            'recorder',
            {'output': str(tmp_path / 'b'), 'regex': '/(vib.*|dia.*)', 'exclude': '/diagnostics'},
            name='b',
            ros=('-r', '__node:=other'),
        )
        source.wait_for_recorder(recorders=2)
        source.publish_for(3.0)
        source.settle()
        for name in ('a', 'b'):
            assert nodes.end(name) == 0
    assert set(recording_info(tmp_path / 'a').topics) == {'/vibration'}
    assert set(recording_info(tmp_path / 'b').topics) == {'/vibration'}


def messages_written(source: Source) -> int:
    return int(source.statuses[RECORDING].values['messages_written'])


def longest_wait(source: Source) -> float:
    """Return how long a message lay with the recorder until its next report, s."""
    return float(source.publish_until_told(RECORDING)['longest_wait_s'])


def killed_recorder(folder: Path, moments: list[float]) -> list[float]:
    """
    Kill a recorder at each moment (s after the first block); return what each lost, s.

    Lost may be what came since the flush before the last one: the recorder may not have had the
    processor between the two for all that had come.
    """
    losses = []
    for number, moment in enumerate(moments):
        bag = folder / f'bag{number}'
        with ForkedNodes(folder / 'logs', os.environ) as nodes, Source() as source:
            nodes.start('recorder', {'output': str(bag)})
            source.wait_for_recorder()
            flushes = [(bag / f'{bag.name}_0.mcap').stat().st_mtime_ns]
            end = time.monotonic() + moment
            while time.monotonic() < end:
                source.publish_for(0.04)
                flushed = (bag / f'{bag.name}_0.mcap').stat().st_mtime_ns
                if flushed != flushes[-1]:
                    flushes.append(flushed)
            killed = time.time_ns()
            os.kill(nodes.pid('recorder'), signal.SIGKILL)
            nodes.end('recorder')
        assert find_unfinished(folder) == [bag]
        report = recover(bag, folder / f'saved{number}')
        found = numbers(folder / f'saved{number}') if report.kept else []
        # What is saved is in one piece, from the first block on.
        assert found == list(range(len(found)))
        first_lost = source.sent[len(found)][0] if len(found) < len(source.sent) else killed
        if len(flushes) > 1:
            assert first_lost >= flushes[-2]
        losses.append((killed - first_lost) / 1e9)
        shutil.rmtree(bag)
    return losses


def test_killed_at_random_moments(ros_domain: int, tmp_path: Path) -> None:
    rng = random.Random(ros_domain)
    killed_recorder(tmp_path, [rng.uniform(0.2, 4.0) for _ in range(3)])


@pytest.mark.soak
def test_killed_at_fifty_random_moments(ros_domain: int, tmp_path: Path) -> None:
    rng = random.SystemRandom()
    losses = killed_recorder(tmp_path, [rng.uniform(0.0, 8.0) for _ in range(50)])
    print(f'50 kills: lost at most {max(losses):.2f} s, {sum(losses) / 50:.2f} s on average')
    assert max(losses) <= MOST_LOST


def test_what_is_sent_while_it_is_not_active_is_not_lost(ros_domain: int, tmp_path: Path) -> None:
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(tmp_path / 'bag')})
        source.wait_for_recorder()
        source.publish_until_told(RECORDING)
        assert source.change_state('/recorder', 'deactivate')
        source.publish_for(1.0)
        assert source.change_state('/recorder', 'activate')
        source.wait_for_recorder()
        for _ in range(2):
            told = source.publish_until_told(RECORDING)
        assert told['messages_lost_on_the_way'] == '0'
        assert nodes.end('recorder') == 0


@pytest.mark.soak
def test_a_recorder_that_stood_still_counts_what_it_missed(
    ros_domain: int, tmp_path: Path
) -> None:
    bag = tmp_path / 'bag'
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(bag)})
        source.wait_for_recorder()
        source.publish_for(1.0)
        os.kill(nodes.pid('recorder'), signal.SIGSTOP)
        # Longer than DDS waits for a participant that says nothing.
        source.publish_for(30.0)
        os.kill(nodes.pid('recorder'), signal.SIGCONT)
        source.publish_until(
            lambda: source.statuses[RECORDING].values.get('messages_lost_on_the_way', '0') != '0'
        )
        source.settle()
        told = int(source.publish_until_told(RECORDING)['messages_lost_on_the_way'])
        source.settle()
        assert nodes.end('recorder') == 0
    assert 0 < len(source.sent) - len(numbers(bag)) <= told


def test_full_disk_is_said_and_recording_goes_on(ros_domain: int, tmp_path: Path) -> None:
    bag = tmp_path / 'bag'
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(bag)})
        source.wait_for_recorder()
        source.publish_until(lambda: RECORDING in source.statuses)
        size = (bag / 'bag_0.mcap').stat().st_size
        infinite = resource.RLIM_INFINITY
        resource.prlimit(nodes.pid('recorder'), resource.RLIMIT_FSIZE, (size + 20_000, infinite))
        source.publish_until(lambda: source.statuses[RECORDING].level == b'\x02')
        assert 'File too large' in source.statuses[RECORDING].message
        source.publish_for(1.0)
        assert nodes.running('recorder')
        resource.prlimit(nodes.pid('recorder'), resource.RLIMIT_FSIZE, (infinite, infinite))
        source.publish_until(lambda: source.statuses[RECORDING].level == b'\x00')
        source.publish_for(0.5)
        source.settle()
        assert nodes.end('recorder') == 0
    assert numbers(bag) == list(range(len(source.sent)))


def test_what_fails_at_the_end_is_said_in_a_sentence(ros_domain: int, tmp_path: Path) -> None:
    bag = tmp_path / 'bag'
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(bag)})
        source.wait_for_recorder()
        source.publish_until(lambda: (bag / 'bag_0.mcap').stat().st_size > 100_000)
        resource.prlimit(nodes.pid('recorder'), resource.RLIMIT_FSIZE, (100_000, 100_000))
        # The last flush finds the disk full.
        assert nodes.end('recorder') == 1
    said = (tmp_path / 'logs' / 'recorder.log').read_text().splitlines()
    assert f'{bag} could not be finished' in said[-1]
    assert [line for line in said if not line.startswith('[')] == []


SLOW_DISK = """
import os, sys, time
write = os.write
def slow(descriptor, data):
    while os.path.exists(sys.argv[1]):
        time.sleep(0.05)
    return write(descriptor, data)
os.write = slow
from bearing_twin.nodes.recorder import NODE
from bearing_twin.ros.processes.running import run
sys.exit(run(NODE, sys.argv[2:]))
"""


def test_a_disk_that_holds_the_recorder_up_costs_nothing(ros_domain: int, tmp_path: Path) -> None:
    bag, slow = tmp_path / 'bag', tmp_path / 'slow'
    words = [sys.executable, '-c', SLOW_DISK, str(slow), '--ros-args', '-p', f'output:={bag}']
    with subprocess.Popen(words, env=os.environ) as recorder, Source(STREAM.depth) as source:
        source.wait_for_recorder()
        source.publish_for(1.0)
        slow.touch()
        # More blocks than the source keeps for whoever has not taken them.
        for _ in range(4):
            source.publish_for(1.0)
            source.settle()
        slow.unlink()
        recorder.send_signal(signal.SIGINT)
    assert recorder.returncode == 0
    assert numbers(bag) == list(range(len(source.sent)))


def test_removed_folder_is_said_and_recording_goes_on(ros_domain: int, tmp_path: Path) -> None:
    bag = tmp_path / 'bag'
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(bag)})
        source.wait_for_recorder()
        source.wait_for(RECORDING)
        source.publish_until(lambda: messages_written(source) > 20)
        shutil.rmtree(bag)
        source.publish_until(lambda: bag.exists())
        # What was in the removed file is counted, on /diagnostics for good.
        source.publish_until(
            lambda: 'messages were lost by the disk' in source.statuses[RECORDING].message
        )
        for _ in range(2):
            source.publish_until_told(RECORDING)
        source.settle()
        status = source.statuses[RECORDING]
        assert nodes.end('recorder') == 0
    log = (tmp_path / 'logs' / 'recorder.log').read_text()
    assert 'was removed while it was written' in log
    found = numbers(bag)
    assert found == list(range(found[0], len(source.sent)))
    assert re.search(r'messages, [0-9.]+ MB, [1-9][0-9]* lost', log)
    assert 'messages were lost by the disk' in status.message


def test_a_definition_that_cannot_be_read_costs_its_topic_only(
    ros_domain: int, tmp_path: Path
) -> None:
    overlay = tmp_path / 'overlay' / 'share' / 'std_msgs' / 'msg'
    overlay.mkdir(parents=True)
    # An empty constant, which rosidl takes and rosbags does not.
    (overlay / 'Float64.msg').write_text('string NONE=\nfloat64 data\n')
    prefixes = [str(tmp_path / 'overlay'), os.environ.get('AMENT_PREFIX_PATH', '')]
    environment = os.environ | {'AMENT_PREFIX_PATH': os.pathsep.join(prefixes)}
    with ForkedNodes(tmp_path / 'logs', environment) as nodes, Source() as source:
        source.node.create_publisher(Float64, 'strange', 10)
        nodes.start('recorder', {'output': str(tmp_path / 'bag')})
        source.wait_for_recorder()
        source.publish_until(
            lambda: source.publish_until_told(RECORDING)['topics_left_out'] == '1'
        )
        assert 'cannot be read (TypesysError' in source.statuses[RECORDING].values['why_left_out']
        source.settle()
        assert nodes.end('recorder') == 0
    assert numbers(tmp_path / 'bag') == list(range(len(source.sent)))


def test_a_removed_working_directory_ends_no_node(
    ros_domain: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here, replay = tmp_path / 'here', 'replay: replay'
    here.mkdir()
    write_blocks(here / 'run', 10)
    monkeypatch.chdir(here)
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': 'bag'})
        nodes.start('replay', {'recording': 'run', 'start_paused': True})
        for part in (RECORDING, replay):
            source.wait_for(part)
        monkeypatch.chdir(tmp_path)
        shutil.rmtree(here)
        for _ in range(2):
            told = [source.publish_until_told(part) for part in (RECORDING, replay)]
        assert (told[0]['output'], told[1]['recording']) == (str(here / 'bag'), str(here / 'run'))
        assert nodes.running('recorder') and nodes.running('replay')


def test_nothing_is_overwritten_and_unfinished_ones_are_offered(
    ros_domain: int, tmp_path: Path
) -> None:
    environment = os.environ | {'HOME': str(tmp_path)}
    with ForkedNodes(tmp_path / 'logs', environment) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(tmp_path / 'first')})
        source.wait_for_recorder()
        source.publish_for(1.0)
        os.kill(nodes.pid('recorder'), signal.SIGKILL)
        nodes.end('recorder')
        source.statuses.clear()
        # A service that is started again, and a lifecycle manager that configures it once more.
        nodes.start('recorder', {'output': '~/first'}, name='again')

        def records():
            # The killed one seems to listen for a while: what is written tells of the new one.
            return RECORDING in source.statuses and messages_written(source) > 40

        source.publish_until(records)
        for transition in ('deactivate', 'cleanup', 'configure', 'activate'):
            assert source.change_state('/recorder', transition)
        source.statuses.clear()
        source.publish_until(records)
        assert nodes.end('again') == 0
    log = (tmp_path / 'logs' / 'again.log').read_text()
    assert 'Traceback' not in log
    assert f"'bearing-twin recover {tmp_path / 'first'}'" in log
    first, second, third = (numbers(tmp_path / name) for name in ('first', 'first_2', 'first_3'))
    assert first
    assert first[-1] < second[0] <= second[-1] < third[0]


SNAPSHOT = {'snapshot': True, 'snapshot_before': 1.0, 'snapshot_after': 0.5}


def test_snapshot_on_request(ros_domain: int, tmp_path: Path) -> None:
    bag = tmp_path / 'bag'
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(bag), **SNAPSHOT})
        source.wait_for_recorder()
        fill(source)
        assert not bag.exists()
        asked = time.time_ns()
        assert source.call(Trigger, '/recorder/snapshot').success
        answered = time.time_ns()
        waits = [longest_wait(source) for _ in range(2)]
        source.settle()
        assert nodes.end('recorder') == 0
    check_snapshot(bag, source, asked, answered, max(waits))


def fill(source: Source) -> None:
    """Publish until the recorder, which may be held up, has had blocks to leave out."""
    source.publish_for(1.0)
    source.settle()
    for _ in range(3):
        source.publish_until_told(RECORDING)


def check_snapshot(bag: Path, source: Source, earliest: int, latest: int, wait: float) -> None:
    """
    Check that a snapshot holds the second before it was asked for and the half after it, whole.

    Parameters
    ----------
    bag, source
        The recording, and where its blocks come from.
    earliest, latest
        Times between which it was asked for, ns.
    wait
        Longest that a message lay with the recorder meanwhile, s: what it had not looked at yet
        does not count as before.

    """
    waited = round(wait * NANO)
    found = numbers(bag)
    assert found == list(range(found[0], found[-1] + 1))
    times = [message.log_time for message in read_messages(bag)]
    # The second is counted from the last message that came before.
    assert times[0] >= max(t for t in times if t <= earliest) - NANO - waited
    assert times[-1] <= latest + NANO // 2
    # What was left out was sent too early for it.
    assert found[0] > 0
    assert source.sent[found[0] - 1][0] < latest - NANO + waited
    assert source.sent[found[-1]][1] > earliest


def test_snapshot_when_the_diagnosis_turns_to_fault(ros_domain: int, tmp_path: Path) -> None:
    bag = tmp_path / 'bag'
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(bag), **SNAPSHOT})
        verdicts = source.node.create_publisher(Diagnosis, 'diagnosis', 10)
        source.wait_for_recorder()
        source.wait_for_subscribers(verdicts)
        fill(source)
        verdicts.publish(Diagnosis(level=Diagnosis.LEVEL_SUSPECT))
        source.publish_for(0.5)
        assert not bag.exists()
        waits = []
        for _ in range(3):
            # That it stays a fault is no news.
            verdicts.publish(Diagnosis(level=Diagnosis.LEVEL_FAULT, fault_code='BEARING_X'))
            waits.append(longest_wait(source))
        source.settle()
        assert nodes.end('recorder') == 0
    turned = [
        message.log_time
        for message in read_messages(bag, topics=['/diagnosis'])
        if message.decode().level == Diagnosis.LEVEL_FAULT
    ]
    check_snapshot(bag, source, turned[0], turned[0], max(waits))
    assert len(list(bag.glob('*.mcap'))) == 1
    assert 'BEARING_X' in (tmp_path / 'logs' / 'recorder.log').read_text()


def test_parameters_are_kept_with_the_recording(ros_domain: int, tmp_path: Path) -> None:
    bag = tmp_path / 'bag'
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(bag)})
        source.wait_for_recorder()
        nodes.start('diagnosis', {'bearing': '6307', 'window': 2.0})
        # Attached while it runs, so that a crash keeps them.
        source.publish_until(lambda: '/diagnosis_checkpoint' in on_disk(bag).topics)
        os.kill(nodes.pid('recorder'), signal.SIGKILL)
        nodes.end('recorder')
        nodes.end('diagnosis')
    recover(bag, tmp_path / 'saved')
    info = recording_info(tmp_path / 'saved')
    parameters = info.metadata['bearing_twin.parameters.diagnosis']
    assert parameters['window'] == '2.0'
    assert parameters['bearing'] == '6307'
    assert {'diagnosis.yaml', 'bearing_6307.yaml'} <= info.attachments.keys()
    checkpoint = next(
        iter(read_messages(tmp_path / 'saved', topics=['/diagnosis_checkpoint']))
    ).decode()
    assert yaml.safe_load(checkpoint.configuration)['window'] == 2.0


def test_topics_of_other_kinds_are_recorded_as_they_are_offered(
    ros_domain: int, tmp_path: Path
) -> None:
    bag = tmp_path / 'bag'
    best_effort = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    with (
        ForkedNodes(tmp_path / 'logs', os.environ) as nodes,
        Source() as source,
        Source() as other,
    ):
        nodes.start('recorder', {'output': str(bag)})
        source.wait_for('recorder: recording')
        # Best effort where reliable was expected, another type under one of our names, two types.
        temperature = source.node.create_publisher(Temperature, 'temperature', best_effort)
        spectrum = source.node.create_publisher(Float64, 'spectrum', 10)
        two = source.node.create_publisher(Float64, 'two', 10)
        other.node.create_publisher(Temperature, 'two', 10)

        def recorded() -> bool:
            """Publish what is sent but once until it has come."""
            temperature.publish(Temperature(temperature=44.0))
            spectrum.publish(Float64(data=3.0))
            two.publish(Float64(data=4.0))
            said = source.statuses[RECORDING].values
            return '/two: ' in said.get('why_left_out', '') and on_disk(bag).topics.keys() >= {
                '/temperature',
                '/spectrum',
            }

        source.publish_until(recorded)
        assert nodes.end('recorder') == 0
        status = source.statuses[RECORDING]
    assert status.level == b'\x01'
    why = status.values['why_left_out']
    assert 'std_msgs/msg/Float64' in why
    assert 'sensor_msgs/msg/Temperature' in why
    found = {m.topic: m for m in read_messages(bag)}
    assert found['/temperature'].decode().temperature == 44.0
    assert 'best_effort' in found['/temperature'].channel.qos
    assert found['/spectrum'].type_name == 'std_msgs/msg/Float64'
    # The recorder finds both types at once and takes neither, or keeps the one it found first.
    _, _, why_two = why.partition('/two: ')
    _, _, kept = why_two.partition(';')[0].partition(' beside ')
    assert {m.type_name for m in read_messages(bag, topics=['/two'])} <= {kept}
