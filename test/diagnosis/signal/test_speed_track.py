# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Speed of a shaft from the lines in its vibration."""

from bearing_twin.diagnosis.signal.speed_track import track_speed
import numpy as np
import pytest

RATE = 20480.0
TIMES = np.arange(10 * 20480) / RATE


def _vibration(speeds, seed, height=0.1):
    rng = np.random.default_rng(seed)
    turns = np.cumsum(speeds) / RATE
    lines = (np.sin(2.0 * np.pi * k * turns + rng.uniform(0.0, 6.0)) for k in (1, 2, 3))
    return rng.standard_normal(len(speeds)) + height * sum(lines)


@pytest.mark.parametrize(
    'speeds',
    [
        30.0 * (0.3 + 0.7 * np.minimum(TIMES / 8.0, 1.0)),
        48.0 * (1.0 - 0.075 * TIMES),
        30.0 * (1.0 + 0.03 * np.sin(2.0 * np.pi * TIMES / 3.0)),
        20.0 * 1.07**TIMES,
    ],
    ids=['start', 'coast', 'sway', 'exponential'],
)
def test_the_speed_is_followed_within_half_a_per_cent(speeds):
    for seed in range(3):
        found = track_speed(_vibration(speeds, seed), RATE, 30.0)
        assert found is not None
        assert found.shape == speeds.shape
        assert np.median(np.abs(found / speeds - 1.0)) < 0.005


def test_a_steady_speed_and_noise_are_none():
    for seed in range(3):
        steady = np.full(len(TIMES), 30.0)
        assert track_speed(_vibration(steady, seed), RATE, 30.0) is None
        assert track_speed(_vibration(steady, seed, 0.0), RATE, 30.0) is None


def test_a_shaft_that_never_turns_as_given_is_another_one():
    speeds = 30.0 * (1.0 + 0.05 * (TIMES / 10.0 - 0.5))
    x = _vibration(speeds, 0)
    assert track_speed(x, RATE, 30.0) is not None
    assert track_speed(x, RATE, 36.0) is None


def test_a_short_record_is_none():
    assert track_speed(_vibration(np.full(20480, 30.0), 0)[:20480], RATE, 30.0) is None
