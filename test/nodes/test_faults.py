# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Nodes killed, subscribers stopped, sources doubled: what the others do."""

from __future__ import annotations

import array
from itertools import count
import math
import os
import re
import signal
import subprocess
import sys

from bearing_twin.diagnosis import streaming
from bearing_twin.packed import unpack
from bearing_twin.streams import statefile
from bearing_twin_msgs.msg import Checkpoint, Diagnosis, TwinState, Vibration
from builtin_interfaces.msg import Time
from commands import resident
from numpy.random import default_rng
from probe import check_complete, DEEP, TIMEOUT
import pytest
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import Temperature
from std_msgs.msg import Header
from std_srvs.srv import Trigger

pytestmark = pytest.mark.ros

OK, STALE = b'\x00', b'\x03'

LISTENER = """
import rclpy
from bearing_twin_msgs.msg import Vibration
rclpy.init()
node = rclpy.create_node('slow')
heard = []
node.create_subscription(Vibration, 'vibration', heard.append, 50)
while not heard:
    rclpy.spin_once(node)
print('hearing', flush=True)
rclpy.spin(node)
"""


def learnt_from(state):
    """Return whose windows a state was learnt from; '' if it was learnt from none."""
    _, held = unpack(state.read_bytes(), statefile._VERSION)
    values, _ = unpack(held['state'].tobytes(), streaming._VERSION)
    return values['trend']['source']['unit']


def kill(nodes, name):
    os.kill(nodes.pid(name), signal.SIGKILL)
    nodes.end(name)


def test_killed_twin_and_killed_diagnosis(nodes, probe, tmp_path):
    diagnosis = {'bearing': '6307', 'window': 2.0, 'state_name': 'line3', 'checkpoint_period': 1.0}
    diagnosis['state_directory'] = str(tmp_path / 'states')
    nodes.start('recorder', {'output': str(tmp_path / 'bag')})
    nodes.start('diagnosis', diagnosis)
    nodes.start('twin', {'defect': 'outer', **DEEP})
    probe.watch_diagnostics()
    verdicts = probe.collect(Diagnosis, 'diagnosis')
    states = probe.collect(TwinState, 'twin_state')
    blocks = probe.collect(Vibration, 'vibration')
    probe.until(lambda: len(verdicts) > 3, 'verdicts')

    kill(nodes, 'twin')
    vibration = 'diagnosis: vibration input'
    probe.until(lambda: probe.status(vibration)[0] not in (b'', OK), 'the silence on /diagnostics')
    assert nodes.running('diagnosis')
    assert nodes.running('recorder')
    nodes.start('twin', {'defect': 'outer', **DEEP})
    count = len(verdicts)
    probe.until(lambda: len(verdicts) > count + 3, 'verdicts on the new twin')
    probe.until(lambda: probe.status(vibration)[0] == OK, 'the input well again')
    # The verdict names the restart.
    assert any('window restarted' in r for v in verdicts[count:] for r in v.reasons)

    state = tmp_path / 'states' / 'line3'
    probe.until(state.exists, 'a saved state')
    kill(nodes, 'diagnosis')
    del blocks[:], states[:]
    probe.until(lambda: len(blocks) > 30 and states, 'blocks while there is no diagnosis')
    check_complete(states, blocks)
    nodes.start('diagnosis', diagnosis)
    log = tmp_path / 'logs' / 'diagnosis.log'
    probe.until(lambda: f'trend loaded from {state}' in log.read_text(), 'what was learnt')
    count = len(verdicts)
    probe.until(lambda: len(verdicts) > count, 'verdicts of the new diagnosis')

    # The state is of a 6307: another bearing neither uses nor changes it.
    assert nodes.end('diagnosis') == 0
    learnt = state.read_bytes()
    nodes.start('diagnosis', {**diagnosis, 'bearing': '6205'})
    probe.until(lambda: f'{state} stays as it is' in log.read_text(), 'the refusal by name')
    assert nodes.end('diagnosis') == 0
    assert state.read_bytes() == learnt

    # A second node and another kind of node leave it alone, and say so at once.
    assert learnt_from(state)
    nodes.start('diagnosis', diagnosis)
    probe.until(lambda: f'trend loaded from {state}' in log.read_text(), 'the first')
    nodes.start('diagnosis', diagnosis, name='second', ros=('-r', '__node:=second'))
    kept = {key: diagnosis[key] for key in ('bearing', 'state_name', 'state_directory')}
    nodes.start('calibration', kept)
    for name in ('second', 'calibration'):
        said = (tmp_path / 'logs' / f'{name}.log').read_text
        probe.until(lambda said=said: 'line3 is kept by another node' in said(), 'its refusal')
        assert nodes.end(name) == 0
    assert sorted(path.name for path in state.parent.iterdir()) == ['.line3.lock', 'line3']
    assert nodes.end('diagnosis') == 0
    assert nodes.end('twin') == 0

    # What a reset gives up stays given up, also where the machine stands still.
    nodes.start('diagnosis', diagnosis)
    reset = probe.node.create_client(Trigger, 'diagnosis/reset')
    probe.until(
        lambda: not learnt_from(state),
        'a state without a baseline',
        every=lambda: reset.call_async(Trigger.Request()),
    )
    assert nodes.end('diagnosis') == 0
    assert not learnt_from(state)
    del verdicts[:]
    nodes.start('diagnosis', diagnosis)
    nodes.start('twin', {'defect': 'outer', **DEEP})
    probe.until(lambda: verdicts, 'verdicts')
    assert math.isnan(verdicts[0].level_over_baseline)
    assert nodes.end('diagnosis') == 0
    assert nodes.end('twin') == 0
    assert nodes.end('recorder') == 0


def test_a_verdict_does_not_stand_where_losses_allow_no_other(nodes, probe, tmp_path):
    """Each twentieth block is lost: no window reaches an update, and nobody may take it for OK."""
    nodes.start('diagnosis', {'bearing': '6307', 'window': 2.0})
    verdicts, rng, numbers = probe.collect(Diagnosis, 'diagnosis'), default_rng(0), count()
    probe.watch_diagnostics()

    def send(lost):
        """Send 40 ms in 40 ms, but for each twentieth block where some are lost."""
        number = next(numbers)
        stamp = Time(sec=number // 25, nanosec=number % 25 * 40_000_000)
        block = Vibration(
            header=Header(stamp=stamp), first_sample=1024 * number, sample_rate=25600.0,
            shaft_hz=25.0, y=array.array('f', rng.standard_normal(1024).astype('f')),
        )  # fmt: skip
        if number % 20 or not lost:
            probe.publish('vibration', block)

    def status():
        return probe.status('diagnosis: bearing')

    probe.until(lambda: status()[1:2] == ('healthy',), 'a verdict', every=lambda: send(False))
    probe.until(lambda: status()[0] == STALE, 'its end', every=lambda: send(True))
    made = len(verdicts)
    assert re.match(
        r'no verdict in \d+ s of vibration: window restarted: \d+ samples', status()[1]
    )
    assert status()[1].endswith('; the last verdict was healthy')
    probe.until(lambda: status()[0] == OK, 'another one', every=lambda: send(False))
    assert len(verdicts) > made
    log = (tmp_path / 'logs' / 'diagnosis.log').read_text()
    assert log.count('bearing: no verdict in') == 1


def test_subscribers_that_stop_come_late_or_are_not_alone(nodes, probe, tmp_path):
    nodes.start('diagnosis', {'bearing': '6307', 'window': 2.0})
    nodes.start('twin', {'checkpoint_period': 2.0, **DEEP})
    probe.watch_diagnostics()
    probe.until_active('twin')

    # A subscriber that is stopped for as long as several times the depth of the queues.
    slow = subprocess.Popen(
        [sys.executable, '-c', LISTENER], stdout=subprocess.PIPE, text=True, env=os.environ
    )
    try:
        assert slow.stdout.readline() == 'hearing\n'
        slow.send_signal(signal.SIGSTOP)
        before = resident(nodes.pid('twin'))
        blocks = probe.collect(Vibration, 'vibration')
        states = probe.collect(TwinState, 'twin_state')
        # Meanwhile a temperature at 1 kHz, and one that joins late.
        for k in range(3000):
            message = Temperature(temperature=20.0 + 0.03 * k)
            message.header.stamp.sec = 1000 + k // 1000
            message.header.stamp.nanosec = k % 1000 * 1_000_000
            probe.publish('temperature', message)
            probe.spin(0.001)
        probe.until(lambda: len(blocks) > 150, 'blocks while one subscriber stands still')
        late = []
        probe.node.create_subscription(
            Checkpoint,
            'twin_checkpoint',
            late.append,
            QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL),
        )
        probe.until(lambda: late, 'the checkpoint published before')
        assert resident(nodes.pid('twin')) - before < 30_000_000
        check_complete(states, blocks)
    finally:
        slow.send_signal(signal.SIGCONT)
        slow.terminate()
        slow.wait(TIMEOUT)

    if not hasattr(_rclpy.Timer, 'call_timer_with_info'):
        # rclpy 7 (Jazzy) does not tell who sent a message.
        return
    # A second twin on the same topic: one of them is diagnosed, the other is ignored and counted.
    nodes.start('twin', {'defect': 'outer'}, name='second', ros=('-r', '__node:=second'))
    name = 'diagnosis: vibration input'
    probe.until(lambda: 'several sources' in probe.status(name)[1], 'the second source')
    assert int(probe.statuses[name][2]['blocks_of_other_sources']) > 0
    verdicts = probe.collect(Diagnosis, 'diagnosis')
    probe.until(lambda: len(verdicts) > 2, 'verdicts on one of the two')
    if any(v.result == Diagnosis.OUTER for v in verdicts):
        # The first was held up for so long that it counted as silent; the status counts it.
        assert int(probe.statuses[name][2]['source_restarts']) > 0
    assert nodes.end('second') == 0
    assert nodes.end('twin') == 0
    assert nodes.end('diagnosis') == 0
