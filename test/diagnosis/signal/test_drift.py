# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A sensor whose bias settles after it was powered: a drift is no vibration."""

import math

from bearing_twin.bearing import find_bearing
from bearing_twin.diagnosis import diagnose_record, DiagnosisSettings
from bearing_twin.diagnosis.series.monitor import SeriesMonitor
import numpy as np
import pytest

RATE = 12800.0
BEARING = find_bearing('6205')


def vibration(seconds, seed=0, drift=0.0, constant=1.0):
    """Return noise of 1 m/s^2 with a drift of some height, m/s^2, and time constant, s."""
    n = int(seconds * RATE)
    noise = np.random.default_rng(seed).standard_normal(n)
    return noise + drift * np.exp(-np.arange(n) / (RATE * constant))


@pytest.mark.parametrize('shaft_hz', [24.7, math.nan])
@pytest.mark.parametrize('constant', [1.0, 3.0, 10.0])
def test_a_settling_bias_is_no_velocity(shaft_hz, constant):
    settings = DiagnosisSettings(power_group=2, mounting='rigid')
    steady, settling = (
        diagnose_record(
            vibration(2.0, drift=drift, constant=constant), RATE, BEARING, shaft_hz,
            unit='m/s^2', settings=settings,
        )
        for drift in (0.0, 100.0)
    )  # fmt: skip
    assert settling.severity.velocity_rms == pytest.approx(steady.severity.velocity_rms, rel=0.05)
    assert settling.severity.iso_zone == steady.severity.iso_zone
    assert settling.level == steady.level


def test_snapshots_of_a_sensor_that_settles_each_time_are_learnt():
    monitor = SeriesMonitor(BEARING)
    heights = np.random.default_rng(1).uniform(30.0, 100.0, 80)
    for number, height in enumerate(heights):
        x = vibration(1.0, number, height)
        point = monitor.add(60.0 * number, x, RATE, 24.7, unit='m/s^2')
    assert point.level == 'ok'
    assert monitor.report().scatter < 0.2
