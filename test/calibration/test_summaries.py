# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What is compared of a record: wherever it ends."""

from bearing_twin.calibration.summaries import summarise
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
