# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A real accelerometer through the adapter, and many bearings in one process."""

import asyncio
from contextlib import contextmanager
import itertools
from itertools import pairwise
from pathlib import Path
import signal
import time

import numpy as np
from probe import block_end, check_complete
import pytest

pytest.importorskip('rclpy')

from bearing_twin.assets.messages import floats
from bearing_twin.dynamics import preset, Simulator
from bearing_twin.nodes.fleet import FleetNode
from bearing_twin.stamps import NANO
from bearing_twin.streams.pacer import Due
from bearing_twin.thermal.lubricant import Lubricant
from bearing_twin_msgs.msg import Diagnosis, TwinState, Vibration
from bearing_twin_msgs.srv import InjectDefect, LoadState, SaveState
from builtin_interfaces.msg import Time
import rclpy
from sensor_msgs.msg import Imu, Temperature
from std_msgs.msg import (
    Float32MultiArray,
    Float64MultiArray,
    Int16MultiArray,
    Int32MultiArray,
    MultiArrayDimension,
)
from std_srvs.srv import Trigger
import yaml

pytestmark = pytest.mark.ros

DEEP_ADAPTER = {
    'qos_overrides./samples.subscription.reliability': 'reliable',
    'qos_overrides./imu.subscription.reliability': 'reliable',
    'qos_overrides./vibration.publisher.depth': 1000,
    'qos_overrides./measured.publisher.depth': 1000,
}
"""Nothing is lost between test and adapter, and between adapter and who listens."""


def test_a_foreign_accelerometer_reaches_the_diagnosis(nodes, probe):
    deep = {'qos_overrides./vibration.subscription.depth': 1000}
    nodes.start('diagnosis', {'bearing': '6307', 'shaft_hz': 25.4, **deep})
    # The sensor gives g where the bearing moves in m/s^2.
    adapter = {'sample_rate': 25600.0, 'scale': 9.80665, 'block_size': 2048}
    nodes.start('adapter', {**adapter, **DEEP_ADAPTER})
    blocks = probe.collect(Vibration, 'vibration')
    verdicts = probe.collect(Diagnosis, 'diagnosis')
    probe.watch_diagnostics()
    probe.until_active('adapter')
    simulator = Simulator(preset('incipient', defect='outer'))
    name = 'adapter: accelerometer input'
    sent = []

    def feed():
        """Send what is due: in the time that the samples take, as another rate is refused."""
        while start + len(sent) * 1000 / 25600 < time.monotonic():
            block = simulator.advance(1000, 40.0, 25.4)
            sent.append(np.asarray(block.y / 9.80665, np.float32))
            probe.publish('samples', Float32MultiArray(data=floats(sent[-1])), depth=1000)

    def found():
        fresh = probe.status(name)[1] == 'samples are fresh'
        return fresh and any(v.faults == ['outer'] for v in verdicts)

    # Whenever those that listen to the adapter find it.
    start = time.monotonic()
    probe.until(found, 'the verdict', every=feed)
    total = 1000 * len(sent)
    last = total // 2048 * 2048
    probe.until(lambda: blocks[-1].first_sample + 2048 == last, 'the last block')
    assert all(a.first_sample + len(a.y) == b.first_sample for a, b in pairwise(blocks))
    assert blocks[0].unit == 'm/s^2'
    assert len(blocks[0].x) == 0
    samples = np.concatenate([block.y for block in blocks])
    scaled = np.concatenate(sent) * np.float32(9.80665)
    np.testing.assert_array_equal(samples, scaled[blocks[0].first_sample : last])
    probe.until(lambda: 'no samples for' in probe.status(name)[1], 'its silence')
    # 5 s of 16 channels in one message, or 3 minutes of one channel.
    long = Float32MultiArray(data=floats(np.zeros(2**22, np.float32)))
    probe.publish('samples', long, depth=1000)
    probe.until(lambda: 'at most are taken' in probe.status(name)[1], 'the refusal')
    assert probe.status(name)[0] == b'\x02'
    assert nodes.end('adapter', by=signal.SIGTERM) == 0
    assert nodes.end('diagnosis', by=signal.SIGTERM) == 0


@pytest.mark.parametrize('kind', [Float64MultiArray, Int16MultiArray, Int32MultiArray])
def test_three_axes_of_numbers_of_any_type_become_vibration(kind, nodes, probe):
    source = kind.__name__.replace('MultiArray', '_multi_array').lower()
    nodes.start(
        'adapter',
        {'source': source, 'sample_rate': 51200.0, 'channels': 3, 'channel_x': 2, 'scale': 0.002}
        | DEEP_ADAPTER,
    )
    blocks = probe.collect(Vibration, 'vibration')
    probe.until_active('adapter')
    rng, sent = np.random.default_rng(0), []

    def feed():
        counts = rng.integers(-30000, 30000, (1024, 3))
        sent.append(counts.astype(np.float32) * np.float32(0.002))
        probe.publish('samples', kind(data=counts.ravel().tolist()), depth=1000)

    probe.until(lambda: len(blocks) > 3, 'blocks', every=feed)
    # What was sent before the probe was found is not in the blocks.
    place = [np.array_equal(blocks[0].x, each[:, 2]) for each in sent].index(True)
    for block, each in zip(blocks[:3], sent[place:], strict=False):
        np.testing.assert_array_equal(block.x, each[:, 2])
        np.testing.assert_array_equal(block.y, each[:, 0])
    assert nodes.end('adapter') == 0


def test_samples_that_are_no_numbers_or_contradict_their_layout_are_told(nodes, probe):
    nodes.start('adapter', {'sample_rate': 1000.0, 'block_size': 100, **DEEP_ADAPTER})
    probe.watch_diagnostics()
    blocks = probe.collect(Vibration, 'vibration')
    name = 'adapter: accelerometer input'
    sent, start = [], time.monotonic()

    def feed(size=100, value=0.0):
        def send():
            while start + len(sent) * 0.1 < time.monotonic():
                sent.append(np.array([value, len(sent), *range(98)], np.float32))
                message = Float32MultiArray(data=floats(sent[-1]))
                message.layout.dim = [MultiArrayDimension(size=size)]
                probe.publish('samples', message, depth=1000)

        return send

    def told(text):
        return lambda: text in probe.status(name)[1] and blocks

    probe.until(told('samples are fresh'), 'the samples', every=feed())
    # The message has no frame: the sensor is the topic.
    assert blocks[0].header.frame_id == 'samples'
    probe.until(told('samples are NaN or infinite'), 'the NaN', every=feed(value=np.nan))
    assert probe.status(name)[0] == b'\x01'
    # They are passed on: the diagnosis says what it cannot use, and nothing is lost unseen.
    probe.until(lambda: np.isnan(blocks[-1].y[0]), 'a block with NaN', every=feed(value=np.nan))
    said = 'message refused: the message says 99 values and has 100: correct its layout'
    probe.until(told(said), 'the refusal', every=feed(size=99))
    assert probe.status(name)[0] == b'\x02'
    assert int(probe.status(name)[2]['samples_not_finite']) > 0
    lost = int(probe.status(name)[2]['samples_lost'])
    # What was refused is missing in the index of the next block.
    probe.until(lambda: int(probe.status(name)[2]['samples_lost']) > lost, 'the gap', every=feed())
    assert nodes.end('adapter') == 0


def test_samples_missing_from_an_imu_are_seen_in_the_index(nodes, probe):
    nodes.start('adapter', {'source': 'imu', 'channel_y': 2, 'block_size': 64, **DEEP_ADAPTER})
    probe.until_active('adapter')
    blocks = probe.collect(Vibration, 'vibration')
    numbers = itertools.count()

    def sense():
        for k in itertools.islice(numbers, 20):
            ns = 1_000_000_000 * 100 + k * 2_000_000
            message = Imu()
            message.header.frame_id = 'housing'
            message.header.stamp = Time(sec=ns // 10**9, nanosec=ns % 10**9)
            message.linear_acceleration.z = float(k)
            probe.publish('imu', message, depth=1000)

    # The rate is known after 256 of them; until the adapter has found who listens to it.
    probe.until(lambda: blocks, 'the first block', every=sense)
    for _ in range(3):
        next(numbers)
    heard = len(blocks)
    probe.until(lambda: len(blocks) > heard + 5, 'blocks after the gap', every=sense)
    assert blocks[0].sample_rate == pytest.approx(500.0, rel=1e-3)
    assert blocks[0].header.frame_id == 'housing'
    # Each sample carries its own number: index and content tell the same story.
    offset = blocks[0].y[0] - blocks[0].first_sample
    for block in blocks:
        assert [v - block.first_sample - offset for v in (block.y[0], block.y[-1])] == [
            0,
            len(block.y) - 1,
        ]
    lost = sum(b.first_sample - a.first_sample - len(a.y) for a, b in pairwise(blocks))
    assert lost == 3


def test_one_process_hosts_many_bearings(nodes, probe, tmp_path):
    (tmp_path / 'assets.yaml').write_text(
        """
        assets:
          pump/left:
            twin: {defect: inner, start_temperature: 40}
            diagnosis: {}
          pump/right:
            twin: {seed: 1, lubricant: {viscosity_40: 4.6e-05}}
          fan:
            diagnosis: {bearing: '6205', shaft_hz: 29.9}
        """
    )
    deep = {
        f'qos_overrides./p1/pump/left/{topic}.publisher.depth': 1000
        for topic in ('vibration', 'twin_state')
    }
    assets = {'assets_file': str(tmp_path / 'assets.yaml'), 'block_size': 1024}
    nodes.start('fleet', {**assets, **deep}, ros=('-r', '__ns:=/p1'))
    left = probe.collect(TwinState, '/p1/pump/left/twin_state')
    right = probe.collect(TwinState, '/p1/pump/right/twin_state')
    samples = probe.collect(Vibration, '/p1/pump/left/vibration')
    verdicts = probe.collect(Diagnosis, '/p1/pump/left/diagnosis')
    probe.watch_diagnostics()
    probe.until(lambda: left and right and verdicts, 'both twins and the verdict')
    assert (left[-1].defect, left[-1].temperature_used) == ('inner', 40.0)
    assert (right[-1].defect, right[-1].temperature_used) == ('none', 20.0)
    assert right[-1].viscosity < 0.75 * Lubricant().viscosity(20.0)

    fleet = '/p1/fleet'
    assert probe.set_parameters(fleet, **{'pump.right.twin.defect': 'ball'}) == (True, '')
    probe.until(lambda: right[-1].defect == 'ball', 'the defect of the right one')
    assert left[-1].defect == 'inner'
    accepted, reason = probe.set_parameters(
        fleet, **{'pump.right.twin.defect': 'none', 'pump.left.twin.defect': 'moon'}
    )
    assert not accepted
    assert 'moon' in reason
    assert right[-1].defect == 'ball'
    saved = probe.call(SaveState, '/p1/pump/right/twin/save_state', path='right')
    assert saved.success, saved.message
    injected = probe.call(InjectDefect, '/p1/pump/right/twin/inject_defect', place='outer')
    assert injected.success, injected.message
    assert probe.get_parameters(fleet, 'pump.right.twin.defect') == ['outer']
    probe.until(lambda: right[-1].defect == 'outer', 'the injected defect')
    refused = probe.call(InjectDefect, '/p1/pump/right/twin/inject_defect', place='moon')
    assert not refused.success
    assert 'moon' in refused.message
    assert probe.call(LoadState, '/p1/pump/right/twin/load_state', path='right').success
    refused = probe.call(LoadState, '/p1/pump/left/twin/load_state', path='../right')
    assert not refused.success
    for part in ('twin', 'diagnosis'):
        assert probe.call(Trigger, f'/p1/pump/left/{part}/reset').success
    assert left[-1].defect == 'inner'
    count = len(samples)
    probe.until(lambda: len(samples) > count + 5, 'blocks after the services')
    # The index runs on over what was loaded.
    # Five states a second, of 25 blocks; those in between were held back, not lost.
    check_complete(left, samples, every=5)
    parts = {
        'pump/left temperature input',
        'pump/left vibration input',
        'pump/left bearing',
        'pump/right temperature input',
        'fan vibration input',
        'fan bearing',
        'real time',
    }
    probe.until(lambda: probe.statuses.keys() >= {f'p1/fleet: {p}' for p in parts}, 'statuses')
    probe.until(lambda: probe.node.count_subscribers('/p1/fan/vibration') == 1, 'its input')
    assert max(shared_memory(nodes.pid('fleet'))) >= 8 * 2**20
    assert nodes.end('fleet', by=signal.SIGTERM) == 0


def shared_memory(pid):
    """Return the sizes of the pieces that Fast DDS has mapped into a process."""
    maps = Path(f'/proc/{pid}/maps').read_text().splitlines()
    pieces = [line.split()[0].split('-') for line in maps if '/dev/shm/fast' in line]
    return [int(end, 16) - int(start, 16) for start, end in pieces]


@contextmanager
def fleet_here(assets, folder):
    """Bring up a fleet in this process; the context ends with it."""
    (folder / 'assets.yaml').write_text(yaml.safe_dump({'assets': assets}))
    rclpy.init(args=['--ros-args', '-p', f'assets_file:={folder}/assets.yaml'])
    try:
        node = FleetNode()
        node.bring_up()
        yield node
        node.shut_down()
    finally:
        rclpy.try_shutdown()


def test_an_interrupted_fleet_keeps_what_its_diagnoses_have_learnt(ros_domain, tmp_path):
    learnt = {'window': 1.0, 'update_interval': 0.5, 'state_directory': str(tmp_path)}
    assets = {name: {'twin': {}, 'diagnosis': learnt | {'state_name': name}} for name in 'ab'}
    with fleet_here(assets, tmp_path) as node:
        size = node.parameters['block_size']
        for first in range(0, 3 * 25600, size):
            node._compute(Due(first, NANO + first * NANO // 25600, 0.0))
        # The last blocks wait for their slots when rclpy hears the signal.
        assert len(node._pending) == 2
        rclpy.shutdown()
    assert {'a', 'b'} <= {path.name for path in tmp_path.iterdir()}


def test_a_hot_machine_of_a_fleet_has_been_hot_for_long(ros_domain, tmp_path):
    assets = {name: {'twin': {'thermal_mode': 'physical'}} for name in 'ab'}
    with fleet_here(assets, tmp_path) as node:
        size = node.parameters['block_size']

        def rings():
            return [node._fleet.condition(index).inner_ring_temperature for index in range(2)]

        for number in range(2):
            node._compute(Due(number * size, NANO, 0.0))
        assert max(rings()) < 25.0
        node._twins[0].channel.take_temperature(Temperature(temperature=70.0))
        node._compute(Due(2 * size, NANO, 0.0))
        # Between conductances of 2 and 8 W/K: 74 degC and what friction adds.
        assert rings()[0] == pytest.approx(74.0, abs=3.0)
        assert rings()[1] < 25.0
        asyncio.run(node._reset_all())
        assert rings()[0] == pytest.approx(74.0, abs=3.0)
        node._reset_twin(node._twins[0])
        assert rings()[0] == pytest.approx(74.0, abs=3.0)


def test_fleet_and_adapter_follow_simulated_time(nodes, probe):
    simulated = {'use_sim_time': True}
    nodes.start('fleet', {**simulated, 'names': ['a', 'b'], 'block_size': 1024})
    adapter = {**simulated, **DEEP_ADAPTER, 'sample_rate': 25600.0, 'block_size': 1024}
    nodes.start('adapter', adapter, ros=('-r', 'vibration:=measured'))
    twin = probe.collect(Vibration, '/b/vibration')
    measured = probe.collect(Vibration, '/measured')
    probe.watch_diagnostics()
    probe.until_active('fleet')
    probe.until_active('adapter')

    def untimed():
        *_, values = probe.status('adapter: accelerometer input')
        return float(values.get('samples_before_clock', 0)) == 3 * 1024

    for _ in range(3):
        probe.publish('samples', Float32MultiArray(data=[0.5] * 1024))
    probe.until(untimed, 'samples that come before the first /clock')
    assert twin == measured == []

    def sample():
        probe.publish('samples', Float32MultiArray(data=[0.5] * 256))

    streams = {'fleet': twin, 'adapter': measured}
    # Faster than real time, where the machine is.
    probe.run_clock(100.0, 103.0, streams, each=sample)
    probe.until(lambda: len(measured) == 301 * 256 // 1024, 'the last samples')
    probe.until_still('fleet')
    count, heard = len(twin), len(measured)
    assert 72 <= count <= 75
    for blocks in (twin, measured):
        assert 99.8 <= block_end(blocks[0]) - 0.04 <= block_end(blocks[-1]) <= 103.04
    probe.spin(0.5)
    assert (len(twin), len(measured)) == (count, heard)

    probe.run_clock(50.0, 52.0, streams, each=sample)
    for blocks, before in ((twin, count), (measured, heard)):
        assert len(blocks) > before + 40
        assert all(49.8 <= block_end(b) <= 52.04 for b in blocks[before + 1 :])
        assert all(a.first_sample + 1024 == b.first_sample for a, b in pairwise(blocks))
    assert nodes.end('fleet') == 0
    assert nodes.end('adapter') == 0
