# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The diagnosis node judges short snapshots hours apart as one series, over DDS."""

import array
from itertools import count

import numpy as np
import pytest

pytest.importorskip('rclpy')

from bearing_twin_msgs.msg import Checkpoint, Diagnosis, Vibration
from builtin_interfaces.msg import Time
from std_msgs.msg import Header

pytestmark = pytest.mark.ros

RATE, HOURS, SECONDS = 25600, 6, 0.25


def snapshot(number, level):
    """Return a quarter of a second of noise, taken ``number`` times six hours after the first."""
    x = level * np.random.default_rng(number).standard_normal(int(SECONDS * RATE))
    stamp = Time(sec=1_700_000_000 + 3600 * HOURS * number)
    return Vibration(
        header=Header(stamp=stamp, frame_id='pump'), sample_rate=float(RATE),
        first_sample=3600 * HOURS * number * RATE, source=Vibration.SOURCE_MEASURED,
        unit='m/s^2', shaft_hz=25.0, y=array.array('f', x.astype(np.float32)),
    )  # fmt: skip


def test_snapshots_hours_apart_are_one_series(nodes, probe):
    probe.watch_diagnostics()
    verdicts = probe.collect(Diagnosis, 'diagnosis')
    nodes.start(
        'diagnosis',
        {
            'bearing': '6307', 'series_cycle': 3600.0 * HOURS, 'series_snapshot': SECONDS,
            'baseline_windows': 10, 'longest_hold': 3600.0 * HOURS,
        },
    )  # fmt: skip
    numbers = count()

    def send(level):
        """Send the next one; what is lost on the way is a snapshot that was not taken."""
        return lambda: probe.publish('vibration', snapshot(next(numbers), level))

    probe.until(
        lambda: len([v for v in verdicts if v.level == v.LEVEL_OK]) > 5,
        'a baseline',
        every=send(1.0),
    )
    assert verdicts[-1].window_result == Diagnosis.INSUFFICIENT
    [worn] = probe.until(
        lambda: [v for v in verdicts if v.level == v.LEVEL_FAULT][:1],
        'the change',
        every=send(6.0),
    )
    assert worn.level_over_baseline == pytest.approx(15.6, abs=1.0)
    assert any(reason.startswith('series: ') for reason in worn.reasons)
    # Each verdict is of one snapshot, at its own time.
    assert {v.sample_count for v in verdicts} == {int(SECONDS * RATE)}
    assert all((v.header.stamp.sec - 1_700_000_000) % (3600 * HOURS) == 0 for v in verdicts)
    # The pauses between them are meant.
    name = 'diagnosis: vibration input'
    probe.until(lambda: int(probe.status(name)[2].get('blocks_used', 0)) > 10, 'a status')
    assert probe.status(name)[2]['samples_lost'] == '0'


def test_a_series_is_saved_once_a_verdict(nodes, probe):
    """Its state is a megabyte in the end: ten minutes of a stream do not write it sixty times."""
    verdicts = probe.collect(Diagnosis, 'diagnosis')
    saved = probe.collect(Checkpoint, 'diagnosis_checkpoint')
    nodes.start(
        'diagnosis',
        {
            'bearing': '6307', 'series_cycle': 600.0, 'series_snapshot': SECONDS,
            'checkpoint_period': 10.0,
        },
    )  # fmt: skip
    noise, numbers = np.random.default_rng(0).standard_normal(10 * RATE), count()

    def send():
        """Send ten seconds in one block."""
        number = next(numbers)
        block = snapshot(0, 1.0)
        block.first_sample = 10 * RATE * number
        block.header.stamp.sec += 10 * number
        block.y = array.array('f', np.roll(noise, number).astype(np.float32))
        probe.publish('vibration', block)

    probe.until(lambda: len(verdicts) > 3, 'verdicts', every=send)
    # One more at the start, and after each loss on the way.
    lost = next(numbers) - len(verdicts)
    assert len(saved) < 20 < lost
