# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The twin as a process over DDS: temperature, parameters, services, time."""

import itertools
from itertools import pairwise
import math
import signal
import time

import numpy as np
from probe import block_end, check_complete, DEEP
import pytest

pytest.importorskip('rclpy')

from bearing_twin.ros.cycle import REST_PERIOD
from bearing_twin_msgs.msg import TwinState, Vibration
from bearing_twin_msgs.srv import InjectDefect, LoadState, SaveState
from builtin_interfaces.msg import Time
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Temperature
from std_srvs.srv import Trigger

pytestmark = pytest.mark.ros

OK, WARN, ERROR = b'\x00', b'\x01', b'\x02'
INPUT = 'twin: temperature input'


def reading(value, second):
    message = Temperature(temperature=value)
    message.header.stamp = Time(sec=second)
    return message


def test_every_state_of_the_temperature_is_seen_and_answered(nodes, probe):
    patient = {'temperature_timeout': 3600.0, 'start_temperature': 30.0}
    nodes.start('twin', {**patient, **DEEP})
    states = probe.collect(TwinState, 'twin_state')
    blocks = probe.collect(Vibration, 'vibration')
    probe.watch_diagnostics()

    def expect(status, used, every=None):
        """Wait for a status on both topics; return the first state that shows it."""
        found = len(states)

        def shown():
            return [s for s in states[found:] if s.temperature_status == status]

        probe.until(shown, f'temperature status {status}', every=every)
        name = next(k[len('TEMPERATURE_') :] for k, v in CONSTANTS.items() if v == status)
        probe.until(
            lambda: probe.status(INPUT)[2].get('temperature_status') == str(status),
            f'{name} on /diagnostics',
            every=every,
        )
        assert probe.statuses[INPUT][0] == (OK if name == 'OK' else WARN)
        assert states[-1].temperature_used == used
        return shown()[0]

    waiting = expect(TwinState.TEMPERATURE_WAITING, 30.0)
    assert math.isnan(waiting.temperature_measured)

    clock = iter(range(1000, 100000))

    def send(value):
        return lambda: probe.publish('temperature', reading(value, next(clock)))

    warm = expect(TwinState.TEMPERATURE_OK, 60.0, every=send(60.0))
    assert warm.temperature_measured == 60.0
    # beta0 of tables 1-3 rises with the temperature, and the stiffness with it.
    assert warm.beta0 > waiting.beta0
    assert warm.k_b == pytest.approx(waiting.k_b * warm.beta0 / waiting.beta0, rel=1e-9)
    expect(TwinState.TEMPERATURE_INVALID, 60.0, every=send(math.nan))
    # A source that sends nothing usable is no better than a silent one.
    assert probe.set_parameters('twin', temperature_timeout=0.5) == (True, '')
    stale = expect(TwinState.TEMPERATURE_STALE, 60.0, every=send(math.nan))
    assert stale.temperature_age > 0.5
    assert probe.set_parameters('twin', temperature_timeout=3600.0) == (True, '')
    expect(TwinState.TEMPERATURE_CLAMPED, 110.0, every=send(150.0))

    def older():
        probe.publish('temperature', reading(40.0, 3))

    expect(TwinState.TEMPERATURE_BACKWARDS, 110.0, every=older)

    # Through all of it the motion never started anew and never became NaN.
    check_complete(states, blocks)
    assert all(np.isfinite(b.y).all() and np.isfinite(b.x).all() for b in blocks)
    assert nodes.end('twin', by=signal.SIGTERM) == 0


CONSTANTS = {
    name: getattr(TwinState, name)
    for name in (
        'TEMPERATURE_OK',
        'TEMPERATURE_WAITING',
        'TEMPERATURE_STALE',
        'TEMPERATURE_INVALID',
        'TEMPERATURE_CLAMPED',
        'TEMPERATURE_BACKWARDS',
    )
}


def test_changes_while_running_are_taken_as_a_whole_or_refused_with_a_reason(
    nodes, probe, tmp_path
):
    nodes.start('twin', {'state_directory': str(tmp_path / 'states'), **DEEP})
    states = probe.collect(TwinState, 'twin_state')
    blocks = probe.collect(Vibration, 'vibration')
    probe.until(lambda: states and blocks, 'a block and its state')

    assert probe.set_parameters('twin', defect='outer', defect_width=0.001) == (True, '')
    probe.until(lambda: states[-1].defect == 'outer', 'the defect')
    refused = {
        'there is no place': {'defect': 'shaft', 'load': 500.0},
        'outside its range': {'jitter': 7.0, 'load': 500.0},
        'not a number': {'load': math.nan, 'defect': 'none'},
        'locked while running': {'block_size': 512, 'load': 500.0},
        'warning above the error': {'lateness.warn': 5.0, 'load': 500.0},
        'of another type': {'shaft_hz': 'fast', 'load': 500.0},
        'beyond the law': {'beta0.delta_mu': 1.0, 'resonance_hz': 4500.0},
        'an oil that is none': {'lubricant.viscosity_100': 1e-4, 'unbalance': 1e-4},
    }
    for why, change in refused.items():
        accepted, reason = probe.set_parameters('twin', **change)
        assert not accepted, why
        assert len(reason) > 20, why
    assert probe.get_parameters('twin', 'defect', 'load', 'block_size') == ['outer', 0.0, 1024]
    assert probe.get_parameters('twin', 'resonance_hz', 'unbalance') == [6000.0, 0.0]
    stiffness = states[-1].k_b
    together = {'hertz_stiffness': 2e10, 'unbalance': 1e-4, 'beta0.hardness': False}
    assert probe.set_parameters('twin', **together) == (True, '')
    probe.until(lambda: states[-1].k_b > 1.5 * stiffness, 'the stiffer contact')

    injected = probe.call(InjectDefect, 'twin/inject_defect', place='ball', width=0.0, depth=0.0)
    assert injected.success, injected.message
    probe.until(lambda: states[-1].defect == 'ball', 'the injected defect')
    assert probe.get_parameters('twin', 'defect', 'defect_width') == ['ball', 0.0]
    wrong = probe.call(InjectDefect, 'twin/inject_defect', place='moon', width=0.0, depth=0.0)
    assert not wrong.success
    assert 'moon' in wrong.message

    saved = probe.call(SaveState, 'twin/save_state', path='a')
    assert saved.success, saved.message
    assert not probe.call(SaveState, 'twin/save_state', path='a').success
    assert not probe.call(SaveState, 'twin/save_state', path='../a').success
    for name in ('b', 'a' * 5000):
        assert not probe.call(LoadState, 'twin/load_state', path=name).success
    assert not probe.set_parameters('twin', calibration='a' * 256)[0]
    (tmp_path / 'states' / 'junk').write_bytes(b'no state')
    assert not probe.call(LoadState, 'twin/load_state', path='junk').success
    assert probe.call(LoadState, 'twin/load_state', path='a').success
    assert probe.call(Trigger, 'twin/reset').success
    count = len(states)
    probe.until(lambda: len(states) > count + 3, 'blocks after the reset')
    check_complete(states, blocks)


def test_lifecycle_through_the_services(nodes, probe):
    nodes.start('twin', {'autostart': False})
    blocks = probe.collect(Vibration, 'vibration')
    assert probe.state('twin') == 'unconfigured'
    assert probe.change_state('twin', 'configure')
    assert probe.state('twin') == 'inactive'
    probe.spin(0.5)
    assert blocks == []
    assert probe.change_state('twin', 'activate')
    probe.until(lambda: len(blocks) > 3, 'blocks while active')
    assert probe.change_state('twin', 'deactivate')
    inactive = time.time()
    probe.spin(1.0)
    # By their stamps: what came before may be late on its way.
    assert all(block_end(block) <= inactive for block in blocks)
    count = len(blocks)
    assert probe.change_state('twin', 'cleanup')
    assert probe.set_parameters('twin', block_size=512) == (True, '')
    assert probe.change_state('twin', 'configure')
    assert probe.change_state('twin', 'activate')
    probe.until(lambda: len(blocks) > count + 3, 'blocks after a second start')
    assert len(blocks[-1].y) == 512
    assert nodes.end('twin', by=signal.SIGTERM) == 0


def test_names_and_quality_of_service_can_be_changed_from_outside(nodes, probe):
    nodes.start(
        'twin',
        {
            'qos_overrides./line3/bearing_7/accel.publisher.reliability': 'best_effort',
            'qos_overrides./line3/bearing_7/accel.publisher.depth': 7,
        },
        ros=('-r', '__ns:=/line3/bearing_7', '-r', '__node:=model', '-r', 'vibration:=accel'),
    )
    states = probe.collect(TwinState, '/line3/bearing_7/twin_state')
    probe.watch_diagnostics()
    probe.until(lambda: states, 'a state')

    def publisher():
        found = probe.node.get_publishers_info_by_topic('/line3/bearing_7/accel')
        return [info for info in found if info.node_name == 'model']

    [info] = probe.until(publisher, 'the publisher under its new names')
    assert info.qos_profile.reliability.name == 'BEST_EFFORT'
    name = 'line3/bearing_7/model: real time'
    probe.until_active('/line3/bearing_7/model')

    def at_work():
        """Return the status of the deadlines; while it comes up the node says that it does."""
        status = probe.statuses.get(name)
        return status if status and 'periodicity_hz' in status[2] else None

    _, message, values = probe.until(at_work, 'the status of real time')
    assert message
    assert {'lateness_p99_ms', 'execution_time_us', 'blocks_published'} <= values.keys()
    assert nodes.end('twin', by=signal.SIGINT) == 0


def test_simulated_time_stands_still_runs_faster_and_jumps_back(nodes, probe):
    nodes.start('twin', {'use_sim_time': True})
    blocks = probe.collect(Vibration, 'vibration')
    states = probe.collect(TwinState, 'twin_state')
    probe.watch_diagnostics()

    name = 'twin: real time'
    probe.until_active('twin')
    missing = 'nothing publishes /clock, so no blocks are published'
    probe.until(lambda: missing in probe.status(name).message, 'a status without /clock')
    assert probe.status(name).level == WARN
    probe.until(
        lambda: probe.status('twin: temperature input').message == 'temperature is fresh',
        'a temperature without /clock',
        every=lambda: probe.publish('temperature', Temperature(temperature=60.0)),
    )
    assert blocks == []
    # At ten times real time, where the machine is fast enough.
    probe.run_clock(100.0, 104.0, {'twin': blocks})
    probe.until_still('twin')
    assert probe.status(name).level == OK
    # Its temperature is as old as simulated time is.
    assert {state.temperature_status for state in states} == {TwinState.TEMPERATURE_OK}
    count = len(blocks)
    # Up to two of the hundred may wait for the next reading of /clock.
    assert 98 <= count <= 100
    stamps = [block_end(b) - 0.04 for b in blocks]
    assert 99.9 <= stamps[0] <= stamps[-1] <= 104.0
    assert np.diff(stamps) == pytest.approx(0.04, abs=1e-6)
    probe.spin(0.5)
    assert len(blocks) == count

    probe.run_clock(50.0, 52.0, {'twin': blocks})
    after = blocks[count:]
    assert len(after) > 20
    assert all(49.9 <= block_end(block) <= 52.04 for block in after)
    assert all(a.first_sample + 1024 == b.first_sample for a, b in pairwise(blocks))
    probe.until(
        lambda: probe.status(name)[2].get('clock_steps') == '2',
        'the start of /clock and its jump counted',
    )
    assert probe.statuses[name][2]['blocks_dropped'] == '0'

    # A replay with /clock beside the simulation: neither time lasts until a block ends.
    other = probe.node.create_publisher(Clock, '/clock', 10)

    def tell():
        probe.publish('/clock', Clock(clock=Time(sec=60)))
        other.publish(Clock(clock=Time(sec=200)))

    said = '2 publishers of /clock, whose times differ'
    probe.until(lambda: said in probe.status(name).message, said, every=tell)
    assert probe.status(name).level == ERROR
    probe.node.destroy_publisher(other)
    probe.until_still('twin')
    assert nodes.end('twin') == 0


def run_half_a_second(nodes, probe):
    """Start a twin in simulated time, from 100 s on; return its blocks, which go on."""
    nodes.start('twin', {'use_sim_time': True})
    blocks = probe.collect(Vibration, 'vibration')
    probe.watch_diagnostics()
    probe.until_active('twin')
    probe.run_clock(100.0, 100.5, {'twin': blocks})
    return blocks


def test_a_clock_that_goes_on_by_seconds_at_once_costs_no_block(nodes, probe):
    """As /clock does in the eyes of a node that was held up while it ran at ten times the pace."""
    blocks = run_half_a_second(nodes, probe)
    for seconds in (104, 109):
        told = Clock(clock=Time(sec=seconds))
        probe.until(
            lambda now=seconds: block_end(blocks[-1]) > now - 0.04,
            f'the blocks until {seconds} s',
            every=lambda told=told: probe.publish('/clock', told),
        )
    probe.until_still('twin')
    assert all(a.first_sample + 1024 == b.first_sample for a, b in pairwise(blocks))
    assert probe.statuses['twin: real time'][2]['blocks_dropped'] == '0'
    assert nodes.end('twin') == 0


def test_overdue_blocks_come_no_faster_than_their_readers_follow(nodes, probe):
    """Also while /clock goes on, which wakes the timer of the blocks."""
    blocks = run_half_a_second(nodes, probe)
    ticks = itertools.count(10900)

    def tell():
        tick = next(ticks)
        probe.publish('/clock', Clock(clock=Time(sec=tick // 100, nanosec=tick % 100 * 10**7)))

    began = time.monotonic()
    probe.until(
        lambda: block_end(blocks[-1]) >= 109.0 - 0.04, 'the blocks until 109 s', every=tell
    )
    # 211 of them, 25 at a time: nine groups. The first comes with the clock, at any phase of the
    # timer of the others, so that seven whole periods lie between; the timer may be late.
    assert time.monotonic() - began > 6.5 * REST_PERIOD
    assert nodes.end('twin') == 0
