# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Height of rare impacts, against noise, spikes, single shocks and tones."""

import itertools
import math

from bearing_twin.diagnosis.signal.impact_height import impact_height
import numpy as np
import pytest

CAGE = 0.4
"""Order of a cage."""


def struck(x, sample_rate, times, height):
    """Return samples with rings of a fifth of the sample rate, at most 3 kHz, at times in s."""
    hertz = min(0.2 * sample_rate, 3000.0)
    t = np.arange(round(5.0 / hertz * sample_rate)) / sample_rate
    ring = height * np.exp(-0.15 * hertz * t) * np.sin(2.0 * np.pi * hertz * t)
    found = x.copy()
    for start in np.rint(np.asarray(times) * sample_rate).astype(int):
        found[start : start + len(ring)] += ring[: max(len(x) - start, 0)]
    return found


def decibel(found, before):
    return 20.0 * math.log10(found / before)


MACHINES = [(25600.0, 35.0, 0.3), (25600.0, 25.0, 10.0), (12800.0, 5.0, 2.0), (5120.0, 1.0, 5.0),
            (51200.0, 500.0, 0.1), (100000.0, 25.0, 0.4), (2000.0, 10.0, 2.0)]  # fmt: skip
"""Sample rate, Hz; shaft speed, Hz; length, s."""


@pytest.mark.parametrize(('sample_rate', 'shaft_hz', 'seconds'), MACHINES)
def test_one_impact_a_turn_of_the_cage_is_measured_and_spikes_are_not(
    sample_rate, shaft_hz, seconds
):
    rng = np.random.default_rng(3)
    x = rng.standard_normal(round(sample_rate * seconds))
    sound = impact_height(x, sample_rate, shaft_hz)
    strikes = (np.arange(int(CAGE * shaft_hz * seconds)) + 0.4) / (CAGE * shaft_hz)
    worn = struck(x, sample_rate, strikes, 15.0)
    assert decibel(impact_height(worn, sample_rate, shaft_hz), sound) > 9.0
    spoilt = x.copy()
    spoilt[rng.integers(0, len(x), 3)] += 60.0
    assert abs(decibel(impact_height(spoilt, sample_rate, shaft_hz), sound)) < 2.0
    # The unit does not matter, nor do an offset and the tones of a shaft.
    assert impact_height(1e3 * x + 5e4, sample_rate, shaft_hz) == pytest.approx(1e3 * sound)
    swaying = x + 5.0 * np.sin(2.0 * np.pi * 0.002 * sample_rate * np.arange(len(x)) / sample_rate)
    assert abs(decibel(impact_height(swaying, sample_rate, shaft_hz), sound)) < 1.0


def test_a_shock_in_one_turn_of_the_cage_is_none():
    x = np.random.default_rng(4).standard_normal(10240)
    shaken = struck(x, 25600.0, [0.1], 60.0)
    assert decibel(shaken.std(), x.std()) > 6.0
    assert abs(decibel(*(impact_height(each, 25600.0, 25.0) for each in (shaken, x)))) < 1.0


@pytest.mark.parametrize('given_hz', [24.8, 25.0, 25.2])
def test_impacts_that_come_back_each_turn_of_the_shaft_are_left_out(given_hz):
    """A coupling that strikes twice a turn; the cage strikes once in two turns and a half."""
    rng = np.random.default_rng(7)
    x = rng.standard_normal(10240)
    heights = [
        impact_height(struck(x, 25600.0, np.arange(0.003, 0.39, apart), 15.0), 25600.0, given_hz)
        for apart in (0.02, 0.1)
    ]
    sound = impact_height(x, 25600.0, given_hz)
    assert decibel(heights[0], sound) < 2.0 and decibel(heights[1], sound) > 12.0


def test_at_an_unknown_speed_a_machine_of_300_turns_a_minute_is_measured():
    x = np.random.default_rng(5).standard_normal(51200)
    worn = struck(x, 25600.0, [0.2, 0.7, 1.2, 1.7], 15.0)
    assert decibel(*(impact_height(each, 25600.0, math.nan) for each in (worn, x))) > 9.0


def test_a_machine_as_loud_as_a_step_of_the_converter_does_not_jump():
    """Of a quarter of a step to two steps the height would be 0, 1, 2, 3 and 4 steps."""
    rng = np.random.default_rng(6)
    heights = []
    for loudness in np.geomspace(0.25, 2.0, 19):
        counts = np.round(loudness * rng.standard_normal(7680))
        heights.append(impact_height(0.01 * counts, 25600.0, 30.0))
    assert heights[0] == pytest.approx(0.02)
    assert max(decibel(b, a) for a, b in itertools.pairwise(heights)) < 3.6


def test_a_signal_without_high_frequencies_has_no_impacts():
    assert impact_height(np.arange(1000.0), 25600.0, 30.0) == 0.0
