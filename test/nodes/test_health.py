# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What changes on /diagnostics is in the terminal too, once."""

from itertools import count, repeat
import math
import re
import time

from bearing_twin.bearing import find_bearing
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.diagnosis.result import insufficient
import numpy as np
import pytest

pytest.importorskip('rclpy')

from bearing_twin.assets.messages import time_message
from bearing_twin.nodes.diagnosis import DiagnosisNode
from bearing_twin.nodes.diagnosis_topics import verdict_status
from bearing_twin.ros.executor import LeanExecutor
from bearing_twin.ros.health import _text, Health, known, Level, PARTS, Status
from bearing_twin.stamps import NANO
from bearing_twin.thermal.gate import TemperatureStatus
from diagnostic_msgs.msg import DiagnosticArray
import rclpy
from rclpy.lifecycle import TransitionCallbackReturn
from sensor_msgs.msg import Temperature

pytestmark = pytest.mark.ros

INPUT = 'twin: temperature input'
VIBRATION = 'diagnosis: vibration input'
STALE = str(int(TemperatureStatus.STALE))


def test_trouble_with_the_temperature_is_logged_once_and_so_is_its_end(nodes, probe, tmp_path):
    nodes.start('twin', {'temperature_timeout': 3600.0})
    probe.watch_diagnostics()
    seconds = iter(range(1, 10**6))

    def expect(status, value, stamps=seconds, why=''):
        def send():
            message = Temperature(temperature=value)
            message.header.stamp = time_message(next(stamps) * NANO)
            probe.publish('temperature', message)

        code = str(int(TemperatureStatus[status]))
        probe.until(
            lambda: (
                probe.status(INPUT)[2].get('temperature_status') == code
                and why in probe.status(INPUT)[1]
            ),
            status,
            every=send,
        )

    expect('OK', 40.0)
    expect('INVALID', math.nan)
    began = probe.clocks['twin']
    probe.until(lambda: probe.clocks['twin'] > began + 2.5, 'the trouble to last')
    expect('CLAMPED', 150.0)
    expect('OK', 40.0)
    assert probe.set_parameters('twin', temperature_timeout=0.1) == (True, '')
    probe.until(lambda: probe.statuses[INPUT][2]['temperature_status'] == STALE, 'silence')
    path = tmp_path / 'logs' / 'twin.log'
    probe.until(lambda: 'temperature is stale' in path.read_text(), 'what is logged')
    # Readings come and none is used: that they are refused is why the last valid one is stale.
    still = 'the stamps of temperature stand still at 1.000 s: stamp each reading'
    expect('STALE', 40.0, repeat(1), still)
    expect('STALE', math.nan, seconds, 'the last temperature received is nan degC')
    assert nodes.end('twin') == 0
    log = path.read_text()
    found = re.findall(r'\[(\w+)\].*temperature input: (.*) \(before, for (\d+) s: ', log)
    assert [(level, text.split(':')[0]) for level, text, _ in found] == [
        ('WARN', 'temperature is NaN or impossible'),
        ('WARN', 'temperature 150 degC is outside 20..110 degC'),
        ('INFO', 'temperature is fresh'),
        *3 * [('WARN', 'temperature is stale')],
    ]
    # What the second one ended.
    assert int(found[1][2]) >= 2


@pytest.fixture
def node(ros_domain):
    """Return a node in this process."""
    rclpy.init()
    yield rclpy.create_node('diagnosis', namespace='/line1')
    rclpy.shutdown()


def test_a_lost_input_and_a_changed_level_are_logged_once_with_the_time(node, capfd):
    def inner(level):
        return Status(level, 'inner', {})

    silent = [Status(Level.WARN, f'no vibration for {s:.1f} s', {}) for s in (2.1, 3.1, 4.1)]
    fresh = Status(Level.OK, 'vibration is fresh', {})
    turns = iter([fresh, *silent, fresh, inner(Level.WARN), *2 * [inner(Level.ERROR)], fresh])
    health = Health(node, '')
    health.add('bearing', lambda: next(turns))
    for _ in range(9):
        health.publish()
    text = capfd.readouterr().err
    logged = re.findall(r'\[(\w+)\] \[[\d.]+\] \[line1.diagnosis\]: (.*)', text)
    # How long each lasts hangs on what else the machine does.
    assert [(level, re.sub(r'for \d+ s', 'for a while', said)) for level, said in logged] == [
        ('WARN', 'bearing: no vibration for 2.1 s (before, for a while: vibration is fresh)'),
        ('INFO', 'bearing: vibration is fresh (before, for a while: no vibration for 2.1 s)'),
        ('WARN', 'bearing: inner (before, for a while: vibration is fresh)'),
        ('ERROR', 'bearing: inner (before, for a while: WARN)'),
        ('INFO', 'bearing: vibration is fresh (before, for a while: inner)'),
    ]


def test_what_is_wrong_from_the_start_is_logged_once_when_it_lasts(node, capfd, monkeypatch):
    now_is = [Status(Level.STALE, 'no samples yet: set source to imu', {})]
    now_is_of_fan, now = now_is[0], count()
    monkeypatch.setattr(time, 'monotonic', lambda: float(next(now) // 3))
    health = Health(node, '')
    health.add('input', lambda: now_is[0])
    # Another bearing of a fleet, which stays so.
    health.add('fan input', lambda: now_is_of_fan)
    health.add('bearing', lambda: Status(Level.OK, 'fine', {}))
    for _ in range(40):
        health.publish()
    now_is[0] = Status(Level.OK, 'fresh', {})
    health.publish()
    logged = [line.partition(']: ')[2] for line in capfd.readouterr().err.splitlines()]
    begun = 'input: no samples yet: set source to imu (since the start)'
    ended = 'input: fresh (before, for a while: no samples yet: set source to imu)'
    assert [re.sub(r'for \d+ s', 'for a while', said) for said in logged] == [begun, ended]


@pytest.mark.parametrize(
    ('given', 'named'), [('/', 'diagnosis'), ('', 'diagnosis'), ('/line1/fan_7', 'line1/fan_7')]
)
def test_what_a_status_speaks_of_is_never_the_root(node, given, named):
    heard = []
    node.create_subscription(DiagnosticArray, '/diagnostics', heard.append, 10)
    health = Health(node, given)
    health.add('bearing', lambda: Status(Level.OK, 'fine', {}))
    health.add('pump bearing', lambda: Status(Level.OK, 'fine', {}), hardware_id='/')
    while not heard:
        rclpy.spin_once(node, timeout_sec=0.1)
    assert [status.hardware_id for status in heard[0].status] == [named, named]
    assert heard[0].status[0].name == 'line1/diagnosis: bearing'


def test_a_second_node_of_one_name_is_told(node, nodes, monkeypatch):
    monkeypatch.setattr('bearing_twin.ros.health.RIVAL_AFTER', 0.5)
    heard = []
    node.create_subscription(DiagnosticArray, '/diagnostics', heard.append, 100)
    health = Health(node, '')
    for part in ('vibration input', 'bearing'):
        health.add(part, lambda: Status(Level.OK, 'fine', {}))

    def until_first(level):
        """Wait for a level of the first part; return its message and the level of the second."""
        while True:
            rclpy.spin_once(node, timeout_sec=0.1)
            for first, second in (m.status for m in heard if len(m.status) == 2):
                if first.level == level:
                    return first.message, second.level
            heard.clear()

    ok, error = Level.OK.value, Level.ERROR.value
    assert until_first(ok) == ('fine', ok)
    named = ('-r', '__ns:=/line1', '-r', '__node:=diagnosis')
    nodes.start('recorder', {'autostart': False}, ros=named)
    message, of_second = until_first(error)
    assert message.startswith('another node is called /line1/diagnosis, too: end it')
    assert of_second == ok
    assert nodes.end('recorder') == 0
    assert until_first(ok) == ('fine', ok)


def test_a_second_publisher_of_a_topic_is_told(here, nodes, probe, monkeypatch):
    monkeypatch.setattr('bearing_twin.ros.health.RIVAL_AFTER', 0.5)
    node = here(DiagnosisNode)
    for trigger in (node.trigger_configure, node.trigger_activate):
        assert trigger() is TransitionCallbackReturn.SUCCESS
    executor = LeanExecutor()
    executor.add_node(node)
    probe.watch_diagnostics()

    def report():
        executor.spin_once(timeout_sec=0.01)
        node.health.publish()

    def until_told(what):
        status = probe.until(
            lambda: (status := probe.status(VIBRATION)).message.startswith(what) and status,
            what,
            every=report,
        )
        return status.level, status.message

    assert until_told('no vibration') == (Level.STALE.value, 'no vibration yet on /vibration')
    # Its own topics are not those of the first one, but the verdicts.
    second = ('-r', '__ns:=/line2', '-r', 'diagnosis:=/diagnosis')
    nodes.start('diagnosis', {}, ros=second)
    _, message = until_told('/line2/diagnosis publishes on /diagnosis, too: end it')
    assert message.endswith('namespace; no vibration yet on /vibration')
    nodes.start('diagnosis', {}, name='third', ros=('-r', '__node:=third'))
    until_told('/line2/diagnosis, /third publishes on /diagnosis and ')
    assert probe.change_state('third', 'deactivate')
    until_told('/line2/diagnosis publishes on /diagnosis, too: end it')
    assert probe.change_state('line2/diagnosis', 'deactivate')
    until_told('no vibration')
    assert probe.change_state('third', 'activate')
    until_told('/third publishes on /diagnosis and ')
    for name in ('diagnosis', 'third'):
        assert nodes.end(name) == 0
    until_told('no vibration')


def test_statuses_of_a_large_fleet_are_spread_over_the_second(node):
    heard = []
    node.create_subscription(DiagnosticArray, '/diagnostics', heard.append, 100)
    health, parts = Health(node, ''), [f'pump_{k} bearing' for k in range(3 * PARTS + 1)]
    for part in parts:
        health.add(part, lambda: Status(Level.OK, 'fine', {}))
    began = time.monotonic()
    while len(heard) < 8:
        rclpy.spin_once(node, timeout_sec=0.1)
    assert time.monotonic() - began > 1.5
    assert [len(message.status) for message in heard[:8]] == 2 * [PARTS, PARTS, PARTS, 1]
    names = [status.name for message in heard[4:8] for status in message.status]
    assert names == [f'line1/diagnosis: {part}' for part in parts]


def test_values_are_sent_so_that_a_database_keeps_their_types():
    values = {'rms': 1.25, 'age_s': math.nan, 'peak': math.inf, 'paused': True, 'text': 'a "b"\n'}
    sent = {key: _text(value) for key, value in known(values)}
    assert sent == {'rms': '1.25', 'paused': '1', 'text': "a 'b' "}


def test_a_machine_without_a_number_for_a_value_sends_no_text_in_its_place():
    """Keys that are numbers with one verdict are numbers with any other, or left out."""
    verdicts = [insufficient(['the record is empty'], find_bearing('6307'))]
    noise = np.random.default_rng(0).standard_normal(4 * 25600)
    verdicts.append(diagnose_record(noise, 25600.0, find_bearing('6307'), 25.0))
    texts = [
        {k for k, v in verdict_status(verdict, '6205', 0.0).values.items() if type(v) is str}
        for verdict in verdicts
    ]
    words = {'fault_code', 'bearing', 'faults', 'unit', 'correction', 'reasons'}
    assert texts[0] == texts[1] == words
    for verdict in verdicts:
        for key, value in known(verdict_status(verdict, '6205', 0.0).values):
            if key in texts[0]:
                assert not re.fullmatch(r'[-+.\d]+', str(value)), key
            else:
                assert math.isfinite(float(_text(value))), key
