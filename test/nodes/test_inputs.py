# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The doors of the nodes: shaft speed, vibration blocks."""

from dataclasses import replace
from itertools import islice, product
import math
from pathlib import Path
import re
import time
import tracemalloc
from types import SimpleNamespace

from bearing_twin.errors import BearingTwinError
from bearing_twin.streams.arrival import MessageNumbers
from bearing_twin.streams.shaft import ShaftSpeed
from bearing_twin.streams.vibration_input import (
    GapCounter,
    Intake,
    read_vibration,
    SOURCE_MEASURED,
    SOURCE_SIMULATED,
    SourceLock,
)
import numpy as np
import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]


def test_shaft_speed_comes_from_the_named_joint_whatever_its_direction():
    shaft = ShaftSpeed(nominal=25.4, joint='motor', timeout=5.0)
    assert 'nominal' in shaft.problem(0.0)
    shaft.offer(['gear', 'motor'], [1.0, -2 * math.pi * 30.0], now=10.0)
    assert shaft.at(14.0) == pytest.approx(30.0)
    assert shaft.problem(14.0) == ''


@pytest.mark.parametrize(
    ('hold', 'speeds', 'text'),
    [(True, [30.0, 30.0, 30.0], 'held'), (False, [30.0, 25.4, 30.0], 'too old to be used')],
)
def test_only_a_twin_turns_on_at_a_speed_that_is_stale(hold, speeds, text):
    shaft = ShaftSpeed(nominal=25.4, joint='motor', timeout=5.0, hold=hold)
    assert shaft.at(9.0) == 25.4
    shaft.offer(['motor'], [2 * math.pi * 30.0], now=10.0)
    # It was told during a block of 10 s that arrives when it is over.
    found = [shaft.at(14.0), shaft.at(18.0), shaft.at(18.0, length=10.0)]
    assert found == pytest.approx(speeds)
    assert shaft.problem(18.0) == f'no velocity for 8.0 s: the last one is {text}'


@pytest.mark.parametrize(
    ('names', 'velocities', 'text'),
    [
        (['gear', 'motor'], [1.0], "joint 'motor'"),
        (['motor'], [math.nan], 'not within'),
        (['motor'], [math.inf], 'not within'),
        (['motor'], [1e9], 'not within'),
    ],
)
def test_unusable_joint_states_leave_the_speed(names, velocities, text):
    shaft = ShaftSpeed(nominal=25.4, joint='motor')
    shaft.offer(['motor'], [2 * math.pi * 10.0], now=0.0)
    shaft.offer(names, velocities, now=1.0)
    assert shaft.at(1.0) == pytest.approx(10.0)
    assert text in shaft.problem(1.0)


def test_a_joint_that_falls_silent_is_told_where_simulated_time_goes_back():
    shaft = ShaftSpeed(nominal=25.4, joint='motor', timeout=5.0)
    shaft.offer(['motor'], [2 * math.pi * 10.0], now=1000.0)
    assert shaft.problem(100.0) == ''
    assert 'no velocity for 6.0 s' in shaft.problem(106.0)


def test_joint_states_without_the_joint_say_nothing_of_it():
    shaft = ShaftSpeed(nominal=25.4, joint='motor', timeout=5.0)
    shaft.offer(['motor'], [2 * math.pi * 10.0], now=0.0)
    shaft.offer(['gear'], [1.0], now=1.0)
    assert shaft.problem(1.0) == ''
    shaft.offer(['gear', 'Motor'], [1.0, 1.0], now=6.0)
    assert 'no velocity for 6.0 s' in shaft.problem(6.0)
    assert shaft.problem(6.0).endswith('; joint_states has gear, Motor')


def message(**changes):
    fields = {
        'header': SimpleNamespace(stamp=SimpleNamespace(sec=0, nanosec=0), frame_id=''),
        'sample_rate': 25600.0,
        'first_sample': 1024,
        'source': 0,
        'unit': 'm/s^2',
        'shaft_hz': 25.4,
        'x': np.zeros(4, np.float32),
        'y': np.arange(4, dtype=np.float32),
    }
    return SimpleNamespace(**{**fields, **changes})


def test_takes_the_asked_axis_or_the_one_that_is_there():
    assert read_vibration(message(), 'y').samples.tolist() == [0, 1, 2, 3]
    assert read_vibration(message(), 'x').samples.tolist() == [0, 0, 0, 0]
    assert read_vibration(message(x=[]), 'x').samples.tolist() == [0, 1, 2, 3]


@pytest.mark.parametrize(
    ('changes', 'text'),
    [
        ({'sample_rate': math.nan}, 'sample_rate=nan'),
        ({'sample_rate': -25600.0}, 'sample_rate=-25600'),
        ({'x': [], 'y': []}, '0 samples'),
        ({'x': np.zeros(3)}, 'x has 3 samples and y has 4'),
        ({'x': [], 'y': np.zeros(1_000_001, np.float32)}, '1000001 samples'),
        ({'first_sample': 2**64 - 1}, 'first_sample='),
    ],
)
def test_refuses_blocks_that_cannot_be_diagnosed(changes, text):
    with pytest.raises(BearingTwinError, match=text):
        read_vibration(message(**changes), 'y')


@pytest.mark.parametrize('speed', [math.nan, math.inf, -1.0, 1e12])
def test_unknown_shaft_speed_is_nan(speed):
    assert math.isnan(read_vibration(message(shaft_hz=speed), 'y').shaft_hz)


def test_second_source_is_ignored_until_the_first_falls_silent():
    lock = SourceLock(timeout=2.0)
    assert lock.accept('a', 0.0)
    assert not lock.accept('b', 0.02)
    assert lock.accept('a', 0.04)
    assert lock.ignored == 1
    assert lock.contested(1.0)
    assert not lock.contested(5.1)
    assert lock.accept('b', 2.1)
    assert not lock.accept('a', 2.2)


def test_a_source_of_a_new_run_of_simulated_time_is_heard_at_once():
    lock = SourceLock(timeout=2.0)
    assert lock.accept('first run', 1000.0)
    assert not lock.accept('another', 1000.5)
    assert not lock.contested(100.0)
    assert lock.accept('second run', 100.0)
    assert not lock.accept('another', 100.5)
    assert lock.contested(101.0)
    assert lock.accept('second run', 101.0)


@pytest.mark.ros
@pytest.mark.parametrize(
    ('age', 'problem', 'contested', 'level', 'text'),
    [
        (0.1, 'sample_rate=0', False, 'ERROR', 'sample_rate=0'),
        (3.0, 'sample_rate=0', False, 'STALE', 'no vibration for'),
        (math.nan, '', False, 'STALE', 'no vibration yet'),
        (0.1, '', True, 'ERROR', 'several sources'),
        (0.1, '', False, 'OK', 'fresh'),
    ],
)
def test_the_reason_of_a_refusal_is_not_hidden(age, problem, contested, level, text):
    from bearing_twin.nodes.diagnosis_topics import input_status

    came = 10.0 - age
    intake = Intake(0 if math.isnan(age) else 5, 1, problem, came, came)
    for source in 'ab' if contested else 'a':
        intake.sources.accept(source, 9.0)
    status = input_status(intake, 10.0)
    assert status.level.name == level
    assert text in status.message


def dated(seconds, rate, **fields):
    """Blocks of a source that declares 25600 Hz and sends samples at ``rate``."""
    signal = np.random.default_rng(0).standard_normal(round(seconds * rate)).astype(np.float32)
    for first in range(0, signal.size - 1000, 1000):
        ns = 10**18 + round(first / rate * 1e9)
        stamp = SimpleNamespace(sec=ns // 10**9, nanosec=ns % 10**9)
        header = SimpleNamespace(stamp=stamp, frame_id='')
        block = signal[first : first + 1000]
        sent = message(first_sample=first, x=[], y=block, header=header, **fields)
        yield read_vibration(sent, 'y')


def received(run, block):
    """Return the verdicts that are due when a node receives a block."""
    run.admit(block)
    return run.take(block, temperature=math.nan, joint_hz=math.nan)


@pytest.mark.ros
def test_a_block_that_repeats_the_one_before_gives_no_verdict():
    from bearing_twin.assets.parameters.diagnosis import SPECS
    from bearing_twin.offline.diagnosis_run import DiagnosisRun

    values = {spec.name: spec.default for spec in SPECS} | {'shaft_hz': 25.4}
    once, twice = DiagnosisRun(values), DiagnosisRun(values)
    hung = 0
    for block in dated(12.0, 25600.0):
        dues = received(once, block)
        assert len(received(twice, block)) == len(dues)
        # The same block again, and its samples as those of the time behind it.
        for again in (block, replace(block, first_sample=block.first_sample + 1000)):
            with pytest.raises(BearingTwinError, match='sends each block twice, or hangs'):
                received(twice, again)
            hung += 1
    assert hung > 500
    assert twice.diagnoser.save() == once.diagnoser.save()
    # What is too short, constant, or noise below the last bit of counts, may be equal by chance.
    counts = np.where(np.arange(1000) == 500, 1.0, 0.0).astype(np.float32)
    for samples in (block.samples[:20], np.zeros(1000, np.float32), counts):
        for _ in range(3):
            once.admit(replace(block, samples=samples))


@pytest.mark.ros
@pytest.mark.parametrize('rate', [12000.0, 25600.0, 51200.0])
def test_no_verdict_comes_of_samples_whose_rate_is_declared_wrong(rate):
    from bearing_twin.assets.parameters.diagnosis import SPECS
    from bearing_twin.offline.diagnosis_run import DiagnosisRun

    run = DiagnosisRun({spec.name: spec.default for spec in SPECS})
    blocks = dated(12.0, rate)
    # Before the rate is measured nothing is refused.
    verdicts = sum(len(received(run, block)) for block in islice(blocks, int(rate * 0.0029)))
    assert verdicts == (2 if rate == 25600.0 else 0)
    if rate == 25600.0:
        assert sum(len(received(run, block)) for block in blocks) == 9
        return
    list(islice(blocks, 200))
    for block in blocks:
        with pytest.raises(BearingTwinError, match=f'set sample_rate to {rate:.0f}'):
            received(run, block)


@pytest.mark.ros
def test_simulated_vibration_is_not_learnt_by_the_machine_of_the_same_frame():
    from bearing_twin.assets.parameters.diagnosis import SPECS
    from bearing_twin.offline.diagnosis_run import DiagnosisRun

    run = DiagnosisRun({spec.name: spec.default for spec in SPECS})
    said = [
        due.judge(due.excerpt.analyse()).result.reasons
        for source in (SOURCE_MEASURED, SOURCE_SIMULATED)
        for block in dated(12.0, 25600.0, source=source)
        for due in received(run, block)
    ]
    refused = [any(r.startswith('baseline and trend are of') for r in rs) for rs in said]
    assert refused[0] is False and refused[-1] is True, said[-1]


@pytest.mark.ros
def test_before_the_first_valid_temperature_the_start_temperature_is_named():
    from bearing_twin.nodes.twin_topics import temperature_status
    from bearing_twin.thermal.gate import TemperatureGate

    gate = TemperatureGate(start=30.0)
    gate.offer(math.nan, stamp=0, now=1.0)
    assert 'start temperature' in temperature_status(gate.at(1.0), '').message
    gate.offer(40.0, stamp=0, now=2.0)
    gate.offer(math.nan, stamp=0, now=3.0)
    assert 'last valid' in temperature_status(gate.at(3.0), '').message


@pytest.mark.ros
@pytest.mark.parametrize(
    ('value', 'unit'),
    [
        (323.15, '50 degC in kelvin'),
        (278.0, '5 degC in kelvin'),
        (150.0, '66 degC in fahrenheit'),
        (300.0, '27 degC in kelvin'),
        (60.0, ''),
        (-40.0, ''),
        (500.0, ''),
    ],
)
def test_a_temperature_in_another_unit_is_recognised(value, unit):
    from bearing_twin.nodes.diagnosis_topics import input_status
    from bearing_twin.nodes.twin_topics import temperature_status
    from bearing_twin.streams.vibration_input import Inputs, Intake

    inputs, stamp = Inputs(), SimpleNamespace(sec=0, nanosec=0)
    header = SimpleNamespace(stamp=stamp, frame_id='')
    inputs.take_temperature(SimpleNamespace(header=header, temperature=value))
    text = temperature_status(inputs.temperature, *inputs.problems()).message
    outside = f'temperature {value:g} degC is outside 20..110 degC' in text
    assert outside == (value != 60.0)
    intake = Intake(blocks=1, arrived=0.0)
    for told in text, input_status(intake, 0.0, *inputs.problems()).message:
        assert (f'would be {unit}' in told) == bool(unit)
    # With the right unit there is no problem to tell.
    inputs.take_temperature(SimpleNamespace(header=header, temperature=60.0))
    assert inputs.problems()[2] == ''


@pytest.mark.ros
@pytest.mark.parametrize(
    ('unit', 'factor', 'velocity', 'told'),
    [
        ('m/s^2', 1000.0, 2 * math.pi * 25.0, 'whole numbers, as counts of a converter are'),
        ('g', 1000.0, 2 * math.pi * 25.0, 'scale them to g'),
        # Some sensors give whole mg; a sensor may say that its unit is not known.
        ('mg', 1000.0, 2 * math.pi * 25.0, ''),
        ('', 1000.0, 2 * math.pi * 25.0, ''),
        # A machine at rest, on the last bit of its sensor.
        ('g', 0.5, 2 * math.pi * 25.0, ''),
        ('mg', 1.0, 24.6, 'a velocity of 24.6 rad/s would be near shaft_hz=25 in Hz'),
        ('mg', 1.0, 1480.0, 'near shaft_hz=25 in 1/min: if it is, publish rad/s'),
        ('mg', 1.0, 2 * math.pi * 10.0, ''),
    ],
)
def test_counts_and_a_speed_in_another_unit_are_told(here, unit, factor, velocity, told):
    from bearing_twin.nodes.diagnosis import DiagnosisNode
    from bearing_twin_msgs.msg import Vibration
    from sensor_msgs.msg import JointState

    node = here(DiagnosisNode, shaft_hz=25.0, joint='shaft')
    node.bring_up()
    topics, rng = node._topics, np.random.default_rng(0)
    topics._measured.take_joints(JointState(name=['shaft'], velocity=[velocity]))
    samples = np.rint(factor * rng.standard_normal(1024)).astype(np.float32)
    message = Vibration(sample_rate=25600.0, y=samples, unit=unit, source=SOURCE_MEASURED)
    topics.take(message)
    status = topics.input_status()
    assert status.level.name == ('WARN' if told else 'OK')
    assert told in status.message
    # With the right unit there is no problem to tell.
    topics._measured.take_joints(JointState(name=['shaft'], velocity=[2 * math.pi * 24.8]))
    message.first_sample, message.y = 1024, samples * np.float32(9.81 / 4096)
    topics.take(message)
    assert topics.input_status().message == 'vibration is fresh'
    # A machine that coasts down is no other unit at a speed below by a factor of 6.28.
    topics._measured.take_joints(JointState(name=['shaft'], velocity=[24.6]))
    message.first_sample, message.y = 2048, message.y[::-1]
    topics.take(message)
    assert topics.input_status().message == 'vibration is fresh'


def test_publishers_that_come_and_go_take_bounded_memory():
    numbers = MessageNumbers()
    tracemalloc.start()
    for publisher in range(100_000):
        numbers.count('/alarm', {'data': b'%016d' % publisher}, 2)
        # One that stays.
        numbers.count('/vibration', {'data': b'stays'}, 1 + 2 * publisher)
    taken, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert taken < 5e6
    assert numbers.sent_before == {'/alarm': 100_000}
    assert numbers.skipped == 99_999


@pytest.mark.ros
@pytest.mark.parametrize(('age', 'level'), [(0.5, 'OK'), (3.0, 'STALE')])
def test_a_verdict_does_not_stand_without_vibration(age, level):
    from bearing_twin.bearing import find_bearing
    from bearing_twin.diagnosis import diagnose_record
    from bearing_twin.nodes.diagnosis_topics import verdict_status

    noise = np.random.default_rng(0).standard_normal(8 * 25600)
    verdict = diagnose_record(noise, 25600.0, find_bearing('6307'), 25.0)
    status = verdict_status(verdict, '6307', age)
    assert status.level.name == level
    assert ('last verdict was healthy' in status.message) == (level == 'STALE')
    # An alarm that is held while the sensor is dead says that it is.
    held = replace(
        verdict, result='inner', level='fault', reasons=['dead'], window=('insufficient', 'none')
    )
    text = verdict_status(held, '6307', 0.5).message
    assert text == 'inner; the last window alone tells nothing: dead'


def aggregator():
    """Return the analyzers of the shipped file for diagnostic_aggregator."""
    file = yaml.safe_load((ROOT / 'config' / 'diagnostic_aggregator.yaml').read_text())
    return [a for a in file['/**']['ros__parameters'].values() if isinstance(a, dict)]


def test_the_shipped_aggregator_file_names_every_status():
    page = (ROOT / 'docs' / 'nodes.md').read_text()
    tables = re.findall(r'(?m)^\| status .*\n\| ---.*\n((?:\|.*\n)+)', page)
    parts = {part for table in tables for part in re.findall(r'(?m)^\| `([^`]+)`', table)}
    assert len(parts) > 12
    for part, asset in product(parts, ('pump/left', 'bearing_1')):
        name = f'plant/renamed: {part.replace("ASSET", asset)}'
        groups = [
            a['path'] for a in aggregator() if any(re.fullmatch(r, name) for r in a['regex'])
        ]
        assert len(groups) == 1, (name, groups)


def test_a_node_that_never_ran_is_no_error_of_the_aggregator():
    """
    Without statuses its GenericAnalyzer is stale, which makes the groups together an error.

    With num_items 0 it is OK until a first status comes, and stale once that has gone silent.
    """
    assert [a['num_items'] for a in aggregator()] == [0] * 7
    assert all(a['timeout'] > 1.0 for a in aggregator()), 'nodes report once a second'


def test_one_of_two_thermometers_is_heard_and_the_other_is_told():
    from bearing_twin.assets.parameters.twin import SPECS
    from bearing_twin.assets.twin import TwinChannel
    from sensor_msgs.msg import Temperature

    now = 0.0
    values = {spec.name: spec.default for spec in SPECS} | {'temperature_timeout': 5.0}
    twin = TwinChannel(values, settle=lambda _: None, clock=lambda: now)
    for _ in range(10):
        now += 0.2
        twin.take_temperature(Temperature(temperature=25.0), {'publisher_gid': 'a'})
        twin.take_temperature(Temperature(temperature=95.0), {'publisher_gid': 'b'})
        assert twin.temperature.used == 25.0
    assert 'several sources of temperature: only the first is used' in twin.problems()
    # The first falls silent: the other is heard when the last temperature is stale.
    now += 5.1
    twin.take_temperature(Temperature(temperature=95.0), {'publisher_gid': 'b'})
    assert twin.temperature.used == 95.0
    assert not any(twin.problems())


@pytest.mark.parametrize(
    ('given', 'why'),
    [
        ({'state_name': 'line2/fan'}, 'is not a plain file name'),
        ({'state_name': '..'}, 'is not a plain file name'),
        ({'state_name': 'a\0b'}, 'is not a plain file name'),
        ({'series_cycle': 600.0, 'baseline_windows': 5}, 'a baseline of 5 snapshots'),
    ],
)
def test_what_no_diagnosis_can_do_is_refused_with_the_parameters(given, why):
    from bearing_twin.assets.parameters.diagnosis import check_diagnosis, SPECS

    values = {spec.name: spec.default for spec in SPECS} | given
    with pytest.raises(BearingTwinError, match=why):
        check_diagnosis(values)


@pytest.mark.parametrize('folder', ['', ", state_directory: ''"])
def test_two_assets_do_not_share_a_state(tmp_path, folder):
    from bearing_twin.assets.fleet import read_assets

    path = tmp_path / 'assets.yaml'
    parts = (
        f'a: {{diagnosis: {{state_name: fan}}}}\n  b: {{diagnosis: {{state_name: fan{folder}}}}}'
    )
    path.write_text(f'assets:\n  {parts}\n')
    with pytest.raises(BearingTwinError, match='a and b have one state_name'):
        read_assets(str(path), [])


@pytest.mark.parametrize(
    ('sizes', 'channels', 'interleaved', 'text'),
    [
        ((1000,), 1, True, 'says 1000 values and has 3000: correct its layout'),
        ((1000, 4), 3, True, 'says 1000 x 4 values and has 3000'),
        ((0, 3), 3, True, 'says 0 x 3 values'),
        ((3, 1000, 1), 1, False, 'set channels to 3'),
        ((2, 500, 3), 3, True, ''),
        ((1000, 3), 1, True, 'set channels to 3'),
        ((3, 1000), 3, True, 'set interleaved to false'),
        ((1000, 3), 3, False, 'set interleaved to true'),
        ((1000, 3), 3, True, ''),
        ((3, 1000), 3, False, ''),
        ((3000,), 1, True, ''),
        ((), 2, True, ''),
    ],
)
def test_an_array_that_is_arranged_in_another_way_is_refused(sizes, channels, interleaved, text):
    from bearing_twin.nodes.adapter import check_layout
    from std_msgs.msg import MultiArrayDimension, MultiArrayLayout

    layout = MultiArrayLayout(dim=[MultiArrayDimension(size=size) for size in sizes])
    if not text:
        check_layout(layout, 3000, channels, interleaved=interleaved)
        layout.data_offset, text = 8, 'begin at 0'
    with pytest.raises(BearingTwinError, match=text):
        check_layout(layout, 3000, channels, interleaved=interleaved)


@pytest.mark.ros
def test_why_a_publisher_is_not_heard_is_told(here):
    from bearing_twin.nodes.adapter import AdapterNode
    from bearing_twin.nodes.diagnosis import DiagnosisNode
    from bearing_twin.nodes.twin import TwinNode
    from bearing_twin_msgs.msg import Vibration
    import rclpy
    from rclpy.qos import QoSProfile, ReliabilityPolicy
    from std_msgs.msg import Float32, Float32MultiArray, Int16MultiArray

    adapter, node = here(AdapterNode, sample_rate=25600.0), here(DiagnosisNode)
    twin = here(TwinNode)
    for each in (node, adapter, twin):
        each.trigger_configure()
        each.trigger_activate()
    vibration, samples = node._topics.input_status, adapter._input_status
    assert vibration().message == 'no vibration yet on /vibration'
    assert samples().message == 'no samples yet on /samples'
    other = rclpy.Context()
    other.init()

    def with_a_block():
        node._topics.take(Vibration(sample_rate=25600.0, y=[0.0] * 1024))
        return vibration()

    best_effort = 'set qos_overrides./vibration.subscription.reliability to best_effort'
    unheard = 'not heard on /temperature: it is published as std_msgs/msg/Float32'
    for kind, topic, status, said in (
        (Vibration, 'vibration', vibration, best_effort),
        (Float32MultiArray, 'vibration', vibration, 'published as std_msgs/msg/Float32MultiArray'),
        (Int16MultiArray, 'samples', samples, 'set source to int16_multi_array'),
        (Float32, 'temperature', twin._topics.status, unheard),
        (Float32, 'temperature', with_a_block, unheard),
    ):
        # Within one context, the middleware refuses a second type.
        source = rclpy.create_node('source', context=other)
        qos = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
        publisher = source.create_publisher(kind, topic, qos)
        end = time.monotonic() + 60.0
        while said not in status().message:
            assert time.monotonic() < end, status().message
            time.sleep(0.05)
        source.destroy_publisher(publisher)
        source.destroy_node()
    for each in (node, adapter, twin):
        each.shut_down()
    rclpy.shutdown(context=other)


def test_a_gap_that_is_a_pause_is_not_lost():
    """The pauses between the snapshots of a series are meant, and a gap within one is not."""
    gaps = GapCounter()
    for first in (0, 1000, 1500, 90_000):
        gaps.count(first, 400, pause=50_000)
    assert (gaps.lost, gaps.restarts) == (600 + 100, 0)
    gaps.count(0, 400, pause=50_000)
    gaps.count(90_000, 400)
    assert (gaps.lost, gaps.restarts) == (700 + 89_600, 1)
