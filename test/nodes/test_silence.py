# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Sources that fall silent, pause, change or start anew, as the nodes that hear them take it."""

import array
from dataclasses import replace
import math

from bearing_twin.dynamics import preset, Simulator
import numpy as np
import pytest

pytest.importorskip('rclpy')

from bearing_twin.nodes.diagnosis import DiagnosisNode
from bearing_twin.ros.health import Level
from bearing_twin.stamps import NANO
from bearing_twin.streams.vibration_input import read_vibration
from bearing_twin_msgs.msg import Vibration
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.time import Time
from sensor_msgs.msg import JointState

pytestmark = pytest.mark.ros

RATE = 25600
EPOCH = 1_700_000_000


def set_clock(node, seconds):
    """Let simulated time be so many seconds."""
    node.get_clock().set_ros_time_override(Time(nanoseconds=round((EPOCH + seconds) * NANO)))


def block(begin, samples, **fields):
    """Return a second of a sensor that knows no speed."""
    return Vibration(
        **{'sample_rate': float(RATE), 'unit': 'm/s^2', 'shaft_hz': math.nan} | fields,
        first_sample=begin * RATE,
        y=array.array('f', samples.astype(np.float32)),
    )


def test_a_speed_that_is_not_told_any_more_names_no_place(here):
    """At 20 Hz the inner race strikes as often as a ball does at 25.4 Hz."""
    worn = preset('paper', defect='inner', width=1e-3, load=400.0)
    node = here(DiagnosisNode, joint='shaft', use_sim_time=True)
    for trigger in (node.trigger_configure, node.trigger_activate):
        assert trigger() is TransitionCallbackReturn.SUCCESS
    topics, verdicts = node._topics, []
    for second in range(24):
        set_clock(node, second)
        hertz = 25.4 if second < 10 else 20.0
        if second < 10:
            told = JointState(name=['shaft'], velocity=[2.0 * math.pi * hertz])
            topics._measured.take_joints(told)
        if second in (0, 10):
            machine = Simulator(worn, seed=1, shaft_hz=hertz, temperature=40.0)
        samples = machine.advance(RATE, 40.0, hertz).y
        topics.take(block(second, samples))
        verdicts.append(topics._latest)
    assert {each.result for each in verdicts} == {'inner'}
    assert verdicts[9].shaft_hz == pytest.approx(25.4, rel=2e-3)
    assert math.isnan(verdicts[-1].shaft_hz)
    assert 'no velocity for 14.0 s: the last one is too old' in topics.input_status().message


@pytest.mark.parametrize(
    ('seconds', 'fields', 'ages'),
    [(1, {}, (2.0, 3.1)), (30, {}, (30.0, 32.1)), (1, {'series_cycle': 600.0}, (1202.0, 1203.1))],
)
def test_a_source_of_long_blocks_or_of_snapshots_is_not_silent_between_them(
    here, seconds, fields, ages
):
    node = here(DiagnosisNode, shaft_hz=25.4, **fields)
    for trigger in (node.trigger_configure, node.trigger_activate):
        assert trigger() is TransitionCallbackReturn.SUCCESS
    topics, stale = node._topics, []
    noise = np.random.default_rng(0).standard_normal(seconds * RATE)
    topics.take(block(0, noise), {'publisher_gid': 'a'})
    # Another source is heard meanwhile, and does not take over.
    topics.take(block(0, 2.0 * noise), {'publisher_gid': 'b'})
    assert 'several sources' in topics.input_status().message
    topics._intake.sources.remember = 0.0
    arrived = topics._intake.arrived
    for age in ages:
        topics._intake.arrived = topics._intake.used = arrived - age
        said = [topics.input_status(), topics.verdict_status()]
        stale.append([each.level is Level.STALE for each in said])
    assert stale == [[False, False], [True, True]]
    lock = topics._intake.sources
    assert not lock.accept('b', arrived + seconds + 1.9)
    assert lock.accept('b', arrived + seconds + 2.1)


def test_a_verdict_that_waits_is_published_before_the_next_one_and_before_a_change(here):
    node = here(DiagnosisNode, shaft_hz=25.4)
    for trigger in (node.trigger_configure, node.trigger_activate):
        assert trigger() is TransitionCallbackReturn.SUCCESS
    topics, published = node._topics, []
    topics._verdict.publish = lambda message: published.append(message.first_sample)
    noise = np.random.default_rng(0).standard_normal((4, RATE))
    half = RATE // 2
    for second, samples in enumerate(noise):
        held = read_vibration(block(second, samples), 'y')
        middle = held.first_sample + half
        first = replace(held, samples=held.samples[:half])
        last = replace(held, first_sample=middle, samples=held.samples[half:])
        assert not topics.hold(first, temperature=math.nan)
        assert len(published) == max(second - 1, 0)
        assert topics.hold(last, temperature=math.nan)
        assert len(published) == second
    topics.apply(node.parameters.values)
    assert published == [0, 0, 0, 0]
    topics.judge()
    assert len(published) == 4


def test_a_sensor_that_is_set_to_another_rate_is_diagnosed_on(here):
    """
    Neither is it refused for a while, nor is a rate told that it does not have any more.

    It states the rate that it measures, which is never quite the same.
    """
    node = here(DiagnosisNode, shaft_hz=25.4, window=2.0)
    for trigger in (node.trigger_configure, node.trigger_activate):
        assert trigger() is TransitionCallbackReturn.SUCCESS
    topics, rng = node._topics, np.random.default_rng(0)
    index, stamp = 0, EPOCH * NANO
    for second in range(48):
        rate = RATE // 2 if 20 <= second < 40 else RATE
        # After 40 s the sensor sends half as many samples as it says.
        sent = rate // 2 if second >= 40 else rate
        stated = rate * (1.0 + 1e-6 * (second % 2))
        message = block(0, rng.standard_normal(sent), sample_rate=stated)
        message.first_sample, message.header.stamp = index, Time(nanoseconds=stamp).to_msg()
        index, stamp = index + sent, stamp + NANO
        topics.take(message)
        assert topics._intake.refused == 0 or second >= 40
    assert f'{RATE // 2} samples a second arrive' in topics.input_status().message
