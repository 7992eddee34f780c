# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Clocks that are set, and stamps that make no sense, end no node and fill no memory."""

import math
import random
import time
import tracemalloc
import weakref

from bearing_twin.assets.messages import time_message
from bearing_twin.errors import BearingTwinError
from bearing_twin.offline.run import run_offline
from bearing_twin.recording.temperature import write_temperature_recording
from bearing_twin.stamps import LATEST, NANO
from bearing_twin.streams.arrival import ArrivalTimes
from bearing_twin.streams.samplerate import RateMeter
from bearing_twin.streams.sampling import SequenceTracker, StampTracker
import numpy as np
import pytest

pytest.importorskip('rclpy')

from bearing_twin.assets.parameters import realtime as realtime_parameters
from bearing_twin.assets.parameters.spec import Spec
from bearing_twin.nodes.adapter import AdapterNode
from bearing_twin.nodes.calibration import CalibrationNode
from bearing_twin.nodes.diagnosis import DiagnosisNode
from bearing_twin.nodes.twin import TwinNode
from bearing_twin.ros.cycle import BlockCycle
from bearing_twin.ros.health import Level
from bearing_twin.ros.lifecycle import ManagedNode
from builtin_interfaces.msg import Time
from commands import python
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState, Temperature
from std_msgs.msg import Float32MultiArray

UPTIME, EPOCH = 1000 * NANO, 1_700_000_000 * NANO
PERIOD = NANO // 1000


def heard(tracker, stamps):
    """Return what is missing before each sample, and the most memory that it took, bytes."""
    tracemalloc.start()
    missing = [tracker.missing(stamp) for stamp in stamps]
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return missing, peak


@pytest.mark.parametrize('later', [UPTIME + 60 * NANO, EPOCH])
def test_a_step_of_the_stamps_while_the_rate_is_estimated_takes_no_memory(later):
    stamps = [start + k * PERIOD for start in (UPTIME, later) for k in range(200)]
    tracker = StampTracker(0.0)
    missing, peak = heard(tracker, [*stamps, *(later + k * PERIOD for k in range(200, 300))])
    assert peak < 100e6
    assert tracker.rate == pytest.approx(1000.0, rel=1e-3)
    assert not any(missing)


def test_a_step_from_uptime_to_the_epoch_is_a_restart_and_an_hour_is_a_gap():
    tracker = StampTracker(1000.0)
    stamps = [UPTIME + k * PERIOD for k in range(10)]
    assert not any(heard(tracker, stamps)[0])
    assert tracker.missing(stamps[-1] + PERIOD + 3000 * NANO) == 3_000_000
    assert tracker.missing(EPOCH) == -1
    assert tracker.missing(EPOCH + PERIOD) == 0


def test_a_message_number_out_of_all_reason_is_a_restart():
    tracker = SequenceTracker()
    tracker.missing('a', 1)
    assert tracker.missing('a', 2**63) == -1


def step_clocks(sequences, seed):
    """Run stamps of a clock that is set again and again through all that follows stamps."""
    for case in range(sequences):
        rng = random.Random(seed * 1_000_003 + case)
        now = rng.choice([0, UPTIME, EPOCH, LATEST])
        stamps, trackers = [], [StampTracker(rng.choice([0.0, 1000.0])), RateMeter()]
        for _ in range(rng.randint(1, 8)):
            now = rng.choice([now, UPTIME, EPOCH, 0, LATEST, now + rng.randrange(10**13)])
            period = rng.choice([0, 1, PERIOD, PERIOD, PERIOD, 10 * NANO])
            count = rng.choice([1, 2, 300, 700])
            stamps += [min(now + k * period, LATEST) for k in range(count)]
            now = stamps[-1]
        missing, peak = heard(trackers[0], stamps)
        assert peak < 100e6, (seed, case)
        assert max(missing) <= 3600 * max(trackers[0].rate, 1000.0), (seed, case)
        arrivals = ArrivalTimes()
        for index, stamp in enumerate(stamps):
            trackers[1].take(index, stamp)
            assert arrivals.of('a', stamp, now=stamp) == stamp, (seed, case)
        assert not trackers[1].rate < 0.0, (seed, case)


def test_clocks_that_are_set_again_and_again():
    step_clocks(30, 1)


@pytest.mark.fuzz
def test_clocks_that_are_set_in_two_thousand_ways():
    seed = random.SystemRandom().randrange(10**6)
    print(f'seed {seed}')
    step_clocks(2000, seed)


def test_two_temperatures_a_billion_seconds_apart_make_no_endless_run(tmp_path):
    source = tmp_path / 'source.mcap'
    write_temperature_recording(
        source, np.array([0.0, 1.0, 1e9]), np.array([20.0, 30.0, 40.0]), source='test'
    )
    with pytest.raises(BearingTwinError, match='999999999 s after the input before it'):
        run_offline(source, tmp_path / 'run')
    assert not (tmp_path / 'run').exists()


def test_the_time_of_arrival_follows_a_clock_that_is_set_back():
    arrivals = ArrivalTimes()
    assert arrivals.of('a', EPOCH, now=EPOCH + 5) == EPOCH
    # Handed out in order, received late.
    assert arrivals.of('a', EPOCH - NANO, now=EPOCH + 6) == EPOCH
    back = EPOCH - 3600 * NANO
    times = [arrivals.of('a', back + k, now=back + k + 1) for k in range(0, 50, 10)]
    assert times == sorted(times)
    assert times[-1] <= back + 41


@pytest.mark.ros
@pytest.mark.parametrize(
    'absurd', [Time(sec=-1), Time(sec=2**31 - 1, nanosec=2**32 - 1), Time(sec=-(2**31))]
)
def test_an_absurd_time_ends_no_node(nodes, probe, tmp_path, absurd):
    nodes.start('diagnosis', {'use_sim_time': True})
    probe.watch_diagnostics()
    probe.until_active('diagnosis')
    log = tmp_path / 'logs' / 'diagnosis.log'
    probe.until(
        lambda: 'is outside 0..' in log.read_text(),
        'the refusal',
        every=lambda: probe.publish('/clock', Clock(clock=absurd)),
    )
    probe.until(
        lambda: probe.clocks.get('diagnosis') == 50.0,
        'a valid time',
        every=lambda: probe.publish('/clock', Clock(clock=time_message(50 * NANO))),
    )
    assert nodes.end('diagnosis') == 0


@pytest.mark.ros
def test_work_before_the_first_block_is_no_cycle(here):
    specs = (
        *realtime_parameters.SPECS,
        Spec(name='block_size', default=1024, description='Samples.'),
        Spec(name='sample_rate', default=25600.0, description='Rate.'),
    )
    node = here(lambda: ManagedNode('paced', specs))
    blocks = []
    cycle = BlockCycle(node, node.parameters, blocks.append, slots=4, between=lambda phase: None)
    node.active = True
    began = time.monotonic()
    cycle.start()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    while len(blocks) < 25:
        executor.spin_once(timeout_sec=0.05)
    values = cycle.status().values
    took = time.monotonic() - began
    cycle.stop()
    node.active = False
    assert values['periodicity_hz'] < 30.0
    # No cycle is longer than all of it: the first one would be, by the uptime of the machine.
    assert values['periodicity_min_hz'] > 1.0 / took


@pytest.mark.ros
def test_an_estimated_rate_follows_its_source(here):
    node = here(AdapterNode, source='imu')
    node.trigger_configure()
    now = EPOCH
    for source, rate, seconds in (('a', 200, 20), ('a', 400, 20), ('a', 100, 20)):
        for _ in range(rate * seconds):
            now += NANO // rate
            message = Imu()
            message.header.stamp = time_message(now)
            node._on_imu(message, {'publisher_gid': source})
        assert node._stamps.rate == pytest.approx(rate, rel=1e-3)
    # Another one takes over behind a silence of the first.
    node._intake.sources.timeout = -1.0
    for _ in range(400):
        now += NANO // 50
        message.header.stamp = time_message(now)
        node._on_imu(message, {'publisher_gid': 'b'})
    assert node._stamps.rate == pytest.approx(50.0, rel=1e-3)
    assert node._sent <= 20 * (200 + 400 + 100) + 400


@pytest.mark.ros
def test_lost_samples_are_no_other_rate(here):
    node = here(AdapterNode, source='imu')
    node.trigger_configure()
    rng = random.Random(3)
    lost, message = 0, Imu()
    for k in range(400 * 60):
        if rng.random() < 0.15:
            # What is lost while the rate is estimated is not counted.
            lost += node._stamps.rate > 0.0
            continue
        message.header.stamp = time_message(EPOCH + k * NANO // 400)
        node._on_imu(message, {'publisher_gid': 'a'})
    assert node._stamps.rate == pytest.approx(400.0, rel=1e-3)
    assert node._restarts == 0
    # A single loss may pass as jitter.
    assert node._lost == pytest.approx(lost, rel=0.01)
    assert 'of 400 samples a second arrive, others are lost' in node._input_status().message


@pytest.mark.ros
def test_a_pause_of_the_driver_is_a_gap_and_slow_messages_are_none(here):
    node = here(AdapterNode, sample_rate=1000.0, block_size=64)
    node.trigger_configure()
    now, number = EPOCH, 0

    def send(samples):
        nonlocal number
        number += 1
        info = {'source_timestamp': now, 'publication_sequence_number': number}
        node._on_array(Float32MultiArray(data=[0.0] * samples), {'publisher_gid': 'a', **info})

    # Messages of 5 s follow one another without a pause.
    for _ in range(3):
        now += 5 * NANO
        send(5000)
    assert (node._restarts, node._builder.next_sample) == (0, 15000 // 64 * 64)
    node._intake.arrived -= 6.9
    assert node._input_status().message == 'samples are fresh'
    node._intake.arrived -= 0.2
    assert node._input_status().level is Level.STALE
    # The driver sends nothing for 8 s, and numbers its messages as if nothing had been.
    now += 8 * NANO + NANO // 10
    send(100)
    assert node._restarts == 1
    assert node._builder.next_sample == 64
    # Messages that are lost on the way are counted, however long they lasted.
    now, number = now + 5 * NANO, number + 49
    send(100)
    assert (node._restarts, node._lost) == (1, 4900)


@pytest.mark.ros
def test_a_driver_without_samples_is_silent(here):
    """Its empty arrays are told, and neither end the node nor count as lost samples."""
    node = here(AdapterNode, sample_rate=1000.0, block_size=100)
    node.trigger_configure()
    noise = np.random.default_rng(0).standard_normal((100, 100)).astype(np.float32)
    # One array each 0.1 s: with empty ones between, then empty ones only, then as at first.
    for k in range(200):
        empty = 50 <= k < 150 or k % 10 == 9
        info = {
            'source_timestamp': EPOCH + k * NANO // 10,
            'publication_sequence_number': k + 1,
        }
        message = Float32MultiArray(data=[] if empty else noise[k % 50])
        node._on_array(message, {'publisher_gid': 'a', **info})
        if k == 149:
            node._intake.arrived -= 3.0
            status = node._input_status()
    assert status.level is Level.STALE
    assert 'no samples for 3.0 s: the arrays received are empty' in status.message
    assert status.values['samples_lost'] == status.values['source_restarts'] == 0
    status = node._input_status()
    assert (status.level, status.message) == (Level.OK, 'samples are fresh')
    assert (status.values['samples_lost'], status.values['source_restarts']) == (0, 1)
    assert status.values['samples_published'] == 9000


@pytest.mark.ros
@pytest.mark.parametrize('later', [0.0, 0.055, math.inf])
def test_messages_that_repeat_the_one_before_are_refused(later, here):
    node = here(AdapterNode, sample_rate=1000.0, block_size=100)
    node.trigger_configure()
    noise = np.random.default_rng(0).standard_normal((40, 100)).astype(np.float32)
    # The driver sends each of its messages twice, at once or later (s), or one for eleven periods.
    hangs = math.isinf(later)
    kept = [0, *(max(5, k - 10) for k in range(1, 40))] if hangs else range(40)
    numbers = iter(range(1, 100))
    for k, which in enumerate(kept):
        for after in (0.0,) if hangs else (0.0, later):
            info = {
                'source_timestamp': EPOCH + k * NANO // 10 + round(after * NANO),
                'publication_sequence_number': next(numbers),
            }
            message = Float32MultiArray(data=noise[which])
            node._on_array(message, {'publisher_gid': 'a', **info})
    status = node._input_status()
    assert status.level is Level.ERROR
    assert 'the driver sends each block twice, or hangs' in status.message
    assert status.values['messages_refused'] == (14 if hangs else 40)
    assert status.values['samples_lost'] == (1400 if hangs else 0)
    assert status.values['samples_published'] == (2600 if hangs else 4000)
    assert status.values['sample_rate_measured_hz'] == pytest.approx(1000.0)


@pytest.mark.ros
@pytest.mark.parametrize(
    ('period', 'level', 'text'),
    [
        (5.0, Level.OK, 'fresh'),
        (10.0, Level.ERROR, 'set sample_rate to 500'),
        # Snapshots of 5 s, once a minute.
        (60.0, Level.OK, 'fresh'),
    ],
)
def test_a_wrong_rate_of_long_messages_is_told(period, level, text, here):
    node = here(AdapterNode, sample_rate=1000.0)
    node.trigger_configure()
    message = Float32MultiArray(data=[0.0] * 5000)
    for k in range(20):
        at = EPOCH + round(k * period * NANO)
        info = {'source_timestamp': at, 'publication_sequence_number': k + 1}
        node._on_array(message, {'publisher_gid': 'a', **info})
    status = node._input_status()
    assert status.level is level
    assert text in status.message


@pytest.mark.ros
@pytest.mark.filterwarnings('error')
@pytest.mark.parametrize('source', ['imu', 'float32_multi_array'])
def test_what_is_too_large_for_single_precision_is_told_without_a_warning(source, here):
    node = here(AdapterNode, source=source, sample_rate=1000.0, block_size=64, scale=1e6)
    node.trigger_configure()
    for k in range(64):
        at = EPOCH + k * NANO // 1000
        info = {'source_timestamp': at + NANO, 'publication_sequence_number': k + 1}
        if source == 'imu':
            message = Imu()
            message.linear_acceleration.x = 1e300
            message.header.stamp = time_message(at)
            node._on_imu(message, {'publisher_gid': 'a', **info})
        else:
            node._on_array(Float32MultiArray(data=[1e38]), {'publisher_gid': 'a', **info})
    status = node._input_status()
    assert 'NaN or infinite' in status.message
    assert status.values['samples_not_finite'] == 64


@pytest.mark.ros
def test_an_imu_without_acceleration_is_refused(here):
    node = here(AdapterNode, source='imu')
    node.trigger_configure()
    message = Imu()
    message.linear_acceleration_covariance[0] = -1.0
    for k in range(400):
        message.header.stamp = time_message(EPOCH + k * NANO // 200)
        node._on_imu(message, {'publisher_gid': 'a'})
    status = node._input_status()
    assert status.level is Level.ERROR
    assert 'measures no acceleration' in status.message
    assert node._sent == 0


@pytest.mark.ros
@pytest.mark.parametrize('pace', [0.1, 1.0, 10.0])
def test_inputs_age_by_the_time_that_the_node_follows(pace, here):
    kinds = (TwinNode, DiagnosisNode, CalibrationNode)
    nodes = [here(kind, use_sim_time=True, joint='shaft') for kind in kinds]
    executor = SingleThreadedExecutor()
    for node in nodes:
        node.trigger_configure()
        executor.add_node(node)
    twin, diagnosis, calibration = nodes
    inputs = [twin._twin, diagnosis._topics._measured, calibration._inputs]
    clock = rclpy.create_node('clock').create_publisher(Clock, '/clock', 10)

    def go_on(seconds):
        clock.publish(Clock(clock=time_message(EPOCH + round(seconds * NANO))))
        end = time.monotonic() + 60.0
        for node in nodes:
            while abs(node.get_clock().now().nanoseconds - EPOCH - seconds * NANO) > 1e6:
                assert time.monotonic() < end
                executor.spin_once(timeout_sec=0.01)

    end = time.monotonic() + 60.0
    while clock.get_subscription_count() < len(nodes):
        assert time.monotonic() < end
        time.sleep(0.02)
    go_on(0.0)
    for each in inputs:
        each.take_temperature(Temperature(temperature=60.0))
        each.take_joints(JointState(name=['shaft'], velocity=[160.0]))
    go_on(4.0 * pace)
    old = f'no velocity for {4.0 * pace:.1f} s' if pace > 1.0 else ''
    for each in inputs:
        assert each.temperature.age == pytest.approx(4.0 * pace)
        assert each.problems()[0].split(':')[0] == old


@pytest.mark.ros
def test_a_former_life_of_a_node_is_freed(here):
    node = here(TwinNode)
    node.trigger_configure()
    former = weakref.ref(node._topics)
    node.trigger_cleanup()
    node.trigger_configure()
    assert former() is None


MUTE = """
import sys
from bearing_twin.nodes.adapter import AdapterNode
from bearing_twin.nodes.replay import ReplayNode
from bearing_twin.ros.processes import running
from bearing_twin.ros.health import Health
def fail(*_, **__):
    raise running.RCLError('Failed to publish: cannot publish data')
{where} = fail
sys.exit(running.run({node}, ['--ros-args', '-p', *sys.argv[1:]]))
"""


@pytest.mark.ros
@pytest.mark.parametrize(
    ('node', 'where'),
    [
        ('AdapterNode', 'Health.publish'),
        ('AdapterNode', 'AdapterNode.__init__'),
        ('ReplayNode', 'ReplayNode._publish'),
    ],
)
def test_a_node_that_can_send_nothing_says_so_and_ends(ros_domain, tmp_path, node, where):
    """As Fast DDS does beyond 2038, and for good: only a new process can work on."""
    recording = tmp_path / 'played.mcap'
    write_temperature_recording(recording, np.array([0.0, 9.0]), np.full(2, 20.0), source='test')
    name = node.removesuffix('Node').lower()
    given = {'adapter': 'sample_rate:=1000.0', 'replay': f'recording:={recording}'}
    ran = python('-c', MUTE.format(node=node, where=where), given[name])
    assert ran.returncode == 1
    assert f'{name}: nothing can be sent (Failed to publish' in ran.stderr
    assert 'is the system clock beyond 2038?' in ran.stderr
    assert 'Traceback' not in ran.stderr
