# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Periodicity and execution time of the cycles, and when /diagnostics warns of them."""

import numpy as np
import pytest

pytest.importorskip('rclpy', reason='ROS 2 is not installed')

from bearing_twin.assets.parameters import realtime as realtime_parameters
from bearing_twin.errors import BearingTwinError
from bearing_twin.ros import realtime
from bearing_twin.ros.health import Level
from bearing_twin.streams.timing import CycleStatistics

PERIOD = 0.04
VALUES = {spec.name: spec.default for spec in realtime_parameters.SPECS} | {
    'block_size': 1024,
    'sample_rate': 25600.0,
}


def status_of(began, durations, *, simulated=False):
    """Return the status after cycles that began at these times and took so long, s."""
    cycles = CycleStatistics()
    for at, duration in zip(began, durations, strict=True):
        cycles.add(at, duration)
    pacer = realtime.build_pacer(VALUES)
    return realtime.status(
        pacer.report(),
        cycles,
        VALUES,
        period=PERIOD,
        scheduling='normal',
        active=True,
        simulated=simulated,
        still=False,
        clocks=1,
    )


def test_the_spread_of_the_rate_is_that_of_the_intervals():
    intervals = np.random.default_rng(3).normal(PERIOD, 0.001, 1000)
    cycles = CycleStatistics()
    for at in np.cumsum(intervals):
        cycles.add(at, 0.002)
    rate = cycles.periodicity
    assert rate.mean == pytest.approx(25.0, rel=0.01)
    assert rate.std == pytest.approx(0.001 / PERIOD**2, rel=0.1)
    assert rate.low == pytest.approx(1.0 / intervals[1:].max())
    assert rate.high == pytest.approx(1.0 / intervals[1:].min())
    assert cycles.execution_time.mean == pytest.approx(0.002)


def test_a_pause_is_no_interval():
    cycles = CycleStatistics()
    for at in np.arange(100) * PERIOD:
        cycles.add(at, 0.001)
    cycles.pause()
    for at in 60.0 + np.arange(100) * PERIOD:
        cycles.add(at, 0.001)
    assert cycles.periodicity.mean == pytest.approx(25.0)
    assert cycles.periodicity.std == pytest.approx(0.0, abs=1e-6)


def test_punctual_cycles_are_in_time():
    found = status_of(np.arange(100) * PERIOD, np.full(100, 0.001))
    assert (found.level, found.message) == (Level.OK, 'in time')
    assert found.values['load_percent'] == pytest.approx(2.5)


def test_one_cycle_that_waits_and_one_at_once_after_it_are_no_alarm():
    began = np.arange(1500) * PERIOD
    began[700] += 0.999 * PERIOD
    assert status_of(began, np.full(1500, 0.001)).level == Level.OK


@pytest.mark.parametrize(
    ('jitter', 'level'), [(0.004, Level.OK), (0.01, Level.WARN), (0.018, Level.ERROR)]
)
def test_a_rate_that_varies_is_reported(jitter, level):
    # Longer and shorter by the jitter in turn: the mean is right.
    began = np.arange(1000) * PERIOD + jitter * (np.arange(1000) % 2)
    found = status_of(began, np.full(1000, 0.001))
    assert found.level == level
    assert ('varies' in found.message) == (level != Level.OK)


@pytest.mark.parametrize(('longest', 'level'), [(0.015, Level.OK), (0.03, Level.WARN)])
def test_an_execution_time_that_varies_is_reported(longest, level):
    durations = np.where(np.arange(1000) % 2, 0.001, longest)
    found = status_of(np.arange(1000) * PERIOD, durations)
    assert found.level == level
    assert ('what a cycle takes varies' in found.message) == (level != Level.OK)


def test_another_limit_that_is_exceeded_at_the_same_level_is_no_news():
    shaken = np.arange(1000) * PERIOD + 0.01 * (np.arange(1000) % 2)
    durations = np.where(np.arange(1000) % 2, 0.001, 0.03)
    one, two = (status_of(shaken, taken) for taken in (np.full(1000, 0.001), durations))
    assert one.message != two.message
    assert (one.level, one.kind) == (two.level, two.kind)
    assert one.kind


@pytest.mark.parametrize('name', [each.name for each in realtime_parameters.THRESHOLDS])
def test_a_warning_above_the_error_is_refused(name):
    with pytest.raises(BearingTwinError, match=f'{name}.warn=9 must not be above'):
        realtime.check_thresholds(VALUES | {f'{name}.warn': 9.0, f'{name}.error': 8.0})


def test_the_steps_of_a_fast_clock_are_no_lateness():
    """At ten times the pace a /clock of 100 readings a second goes on by 2.5 blocks each time."""
    blocks = np.arange(1, 501) * PERIOD
    began = np.ceil(blocks / 0.1) * 0.1
    level, text, values, _ = status_of(began, np.full(500, 0.001), simulated=True)
    assert (level, text) == (Level.OK, 'in step with /clock')
    assert values['periodicity_hz'] != pytest.approx(25.0, abs=10.0)
    assert status_of(began, np.full(500, 0.001)).level is Level.ERROR
