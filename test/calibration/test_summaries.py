# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What is compared of a record: wherever it ends."""

from bearing_twin.calibration.path import identify
from bearing_twin.calibration.summaries import summarise
from bearing_twin.dynamics.sensor_path import band_levels, distance
import numpy as np
import pytest
from scipy import signal


def swinging(rate, seconds=4.0):
    """Pairs of impacts 2 ms apart and a slow swing of a hundred times their height."""
    n = round(rate * seconds)
    x = 1e-3 * np.random.default_rng(1).standard_normal(n)
    every, apart = round(rate / 70.0), round(2e-3 * rate)
    x[100:-apart:every] += 1.0
    x[100 + apart :: every] -= 0.7
    return signal.lfilter([1.0], [1.0, -1.45, 0.96], x) + 100.0 * np.sin(
        2.0 * np.pi * 40.0 * np.arange(n) / rate
    )


def test_no_place_at_which_a_record_ends_makes_an_impact_of_its_own():
    """The jump from the end of a swing to its start is up to two hundred times an impact."""
    rate = 25600.0
    x = swinging(rate)
    found = [summarise(x[: len(x) - cut], rate, 4e-3) for cut in range(0, 640, 80)]
    for name in ('spacing', 'lobe', 'prominence', 'impulsiveness'):
        values = np.array([getattr(each, name) for each in found])
        assert np.ptp(values) < 0.02 * values.mean(), name
    assert found[0].spacing == pytest.approx(2e-3, rel=0.01)


def test_no_place_at_which_a_twin_ends_spoils_its_spectrum():
    """A twin of slow swings and a floor 54 dB below: its jump would pass for that floor."""
    rate = 25600.0
    slow_band = signal.butter(4, 300.0, fs=rate, output='sos')
    for seed in range(4):
        machine, slow, floor = np.random.default_rng(seed).standard_normal((3, 51200))
        machine = signal.lfilter([1.0], [1.0, -0.9], machine)
        slow = signal.sosfilt(slow_band, slow)
        twin = slow / slow.std() + 2e-3 * floor
        path = identify(machine, rate, twin, 1e-4)
        found = path.filter().apply(twin)[len(path.denominator) :]
        assert distance(band_levels(machine, rate), band_levels(found, rate)) < 1.0
