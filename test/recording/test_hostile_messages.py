# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Mutated ROS messages at the running nodes: they answer, or say why not, and stay up."""

from __future__ import annotations

import array
from collections.abc import Iterator
import math
import os
from pathlib import Path
import random
import time

from absurd import message
from bearing_twin.recording.reader import recording_info
from bearing_twin.ros.topics.qos import CHECKPOINT, STREAM
from bearing_twin_msgs.msg import Checkpoint, Diagnosis, Spectrum, TwinState, Vibration
from commands import resident
from forked import ForkedNodes
from fuzzing import SECONDS, until
import pytest
from rclpy.duration import Duration
from recorder_process import Source, TIMEOUT
from recording_samples import store
from sensor_msgs.msg import Imu, JointState, Temperature
from std_msgs.msg import Float32MultiArray

pytestmark = pytest.mark.ros

SHAFT = {'bearing': '6307', 'joint': 'shaft'}
Groups = dict[str, tuple[dict[str, object], tuple[str, ...], str]]
MACHINE: Groups = {
    'recorder': ({}, (), 'recorder: recording'),
    'diagnosis': ({**SHAFT, 'window': 1.0}, (), 'diagnosis: vibration input'),
    'twin': (SHAFT, ('vibration:=other',), 'twin: real time'),
}
"""Parameters, remappings and a status of each node."""
OTHERS: Groups = {
    'calibration': (SHAFT, (), 'calibration: calibration'),
    'fleet': ({'names': ['a', 'b']}, ('a/temperature:=temperature',), 'fleet: real time'),
    'imu': ({'source': 'imu'}, ('vibration:=of_imu',), 'imu: accelerometer input'),
    'array': ({'sample_rate': 25600.0}, ('vibration:=of_array',), 'array: accelerometer input'),
}
MODULES = {'imu': 'adapter', 'array': 'adapter'}
LARGE = 50_000_000
"""Size of a large array, bytes."""
MOST_KEPT = LARGE
"""Memory that a node may keep of many of them, bytes: heap that is not given back."""
MOST_MEMORY = 400_000_000
"""Memory that a node may gain by all of it, bytes: windows, queues and spectra of odd sizes."""
TYPES: dict[str, type] = {
    'vibration': Vibration,
    'temperature': Temperature,
    'joint_states': JointState,
    'twin_state': TwinState,
    'diagnosis': Diagnosis,
    'twin_checkpoint': Checkpoint,
    'diagnosis_checkpoint': Checkpoint,
    'envelope_spectrum': Spectrum,
    'imu': Imu,
    'samples': Float32MultiArray,
    'a/twin_checkpoint': Checkpoint,
}


def mutated_bytes(kind: type, rng: random.Random) -> bytes:
    """Return a message whose fields may hold anything, and sometimes damage its bytes."""
    if rng.random() < 0.02:
        # More padding than there is message, which Fast CDR by itself does not survive.
        return bytes([0, rng.randrange(2), 0, rng.randrange(4)]) + rng.randbytes(rng.randrange(4))
    name = f'{kind.__module__.partition(".")[0]}/msg/{kind.__name__}'
    types = store(name)
    data = bytearray(types.serialize_cdr(message(types, name, rng), name))
    if rng.random() < 0.3 and len(data) > 8:
        for _ in range(rng.choice([1, 4, 16])):
            data[rng.randrange(4, len(data))] = rng.randrange(256)
    if rng.random() < 0.1:
        del data[rng.randrange(4, len(data)) :]
    return bytes(data)


def publish_hostile(
    source: Source, count: int, rng: random.Random, seconds: float
) -> Iterator[int]:
    """Publish hostile messages for a time, among sound ones, and yield how many are out."""
    publishers = {
        topic: source.node.create_publisher(
            kind, topic, CHECKPOINT if kind is Checkpoint else STREAM
        )
        for topic, kind in TYPES.items()
    }
    for number in until(time.monotonic() + seconds, count):
        topic = rng.choice(['vibration', 'vibration', 'temperature', *TYPES])
        publishers[topic].publish(mutated_bytes(TYPES[topic], rng))
        if number % 20 == 0:
            source.publish_for(0.05)
            yield number


def attack(folder: Path, count: int, seed: int, group: Groups, seconds: float = math.inf) -> None:
    with ForkedNodes(folder / 'logs', os.environ) as nodes, Source() as source:
        for name, (parameters, remapped, _) in group.items():
            given = {'output': str(folder / 'bag')} if name == 'recorder' else {}
            ros = [word for rule in (f'__node:={name}', *remapped) for word in ('-r', rule)]
            module = MODULES.get(name, name)
            nodes.start(module, {**parameters, **given}, name=name, ros=tuple(ros))
        for _, _, status in group.values():
            source.wait_for(status)
        source.publish_for(3.0)
        before = {name: resident(nodes.pid(name)) for name in group}
        for sent in publish_hostile(source, count, random.Random(seed), seconds):
            for name in group:
                assert nodes.running(name), (name, sent)
        # They are not only there: each still reports each second, and the diagnosis answers a
        # sound signal again.
        for _ in range(2):
            # One of each may still have been on its way.
            source.statuses.clear()
            for _, _, status in group.values():
                source.wait_for(status)
        grown = {name: resident(nodes.pid(name)) - before[name] for name in group}
        print(f'{sent} messages: memory grew by {grown}')
        assert max(grown.values()) < MOST_MEMORY
        for name in reversed(group):
            assert nodes.end(name) == 0, name
    for name in group:
        assert 'Traceback' not in (folder / 'logs' / f'{name}.log').read_text(errors='replace')


@pytest.mark.parametrize('group', [MACHINE, OTHERS], ids=['machine', 'others'])
def test_hostile_messages(ros_domain: int, tmp_path: Path, group: Groups) -> None:
    attack(tmp_path, 600, ros_domain, group)
    assert group is OTHERS or recording_info(tmp_path / 'bag').finished


def test_the_memory_of_large_arrays_comes_back(ros_domain: int, tmp_path: Path) -> None:
    named = ('diagnosis', 'recorder')
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(tmp_path / 'bag')})
        nodes.start('diagnosis', {'bearing': '6307', 'window': 1.0})
        source.wait_for_recorder(recorders=2)
        source.publish_until(lambda: 'diagnosis: bearing' in source.statuses)
        for _ in range(3):
            source.publish_until_told('diagnosis: bearing')
        before = {name: resident(nodes.pid(name)) for name in named}
        large = source.node.create_publisher(Vibration, 'vibration', STREAM)
        other = source.node.create_publisher(Float32MultiArray, 'other', STREAM)
        source.wait_for_subscribers(large, 2)
        source.wait_for_subscribers(other)
        samples = array.array('f', bytes(LARGE))
        for publisher, hostile in (
            (large, Vibration(sample_rate=25600.0, y=samples)),
            (other, Float32MultiArray(data=samples)),
        ):
            for _ in range(3):
                publisher.publish(hostile)
                assert publisher.wait_for_all_acked(Duration(seconds=TIMEOUT))
                source.publish_for(0.05)
        for name in ('diagnosis: vibration input', 'recorder: recording') * 2:
            source.publish_until_told(name)
        kept = {name: resident(nodes.pid(name)) - before[name] for name in named}
        print(f'6 arrays of {LARGE / 1e6:.0f} MB: {kept} bytes are kept')
        for name in named:
            assert nodes.end(name) == 0, name
    assert max(kept.values()) < MOST_KEPT, kept
    assert 'too large a Vibration' in (tmp_path / 'logs' / 'diagnosis.log').read_text()
    topics = recording_info(tmp_path / 'bag').topics
    assert topics['/other'].count == 3


def test_parameters_of_nodes_that_there_are_not_fill_no_memory(
    ros_domain: int, tmp_path: Path
) -> None:
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(tmp_path / 'bag')})
        source.wait_for_recorder()
        source.publish_until_told('recorder: recording')
        before = resident(nodes.pid('recorder'))
        publisher = source.node.create_publisher(Checkpoint, 'twin_checkpoint', CHECKPOINT)
        source.wait_for_subscribers(publisher)

        def say(number: int) -> None:
            text = 'a: ' + 'x' * 1_000_000
            publisher.publish(Checkpoint(node=f'/none{number}', configuration=text))
            assert publisher.wait_for_all_acked(Duration(seconds=TIMEOUT))
            source.publish_for(0.04)

        for number in range(100):
            say(number)
        source.publish_until_told('recorder: recording')
        source.publish_until(
            lambda: 'bytes of parameters' in source.status('recorder: recording').message
        )
        grown = resident(nodes.pid('recorder')) - before
        say(0)
        source.publish_until(lambda: source.status('recorder: recording').message == 'recording')
        assert nodes.end('recorder') == 0
    assert grown < MOST_KEPT
    assert recording_info(tmp_path / 'bag').topics['/twin_checkpoint'].count == 101


@pytest.mark.fuzz
@pytest.mark.parametrize('group', [MACHINE, OTHERS], ids=['machine', 'others'])
def test_ten_thousand_hostile_messages(ros_domain: int, tmp_path: Path, group: Groups) -> None:
    attack(tmp_path, 10_000, random.SystemRandom().randrange(2**32), group, SECONDS)
