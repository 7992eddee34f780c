# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What is compared of a record: spacings of impacts, whatever rings and wherever it ends."""

from bearing_twin.calibration.answer.refusals import COPY
from bearing_twin.calibration.candidates.passage import contact_speed
from bearing_twin.calibration.measured.path import identify
from bearing_twin.calibration.measured.summaries import fastest_resonance, likeness, summarise
from bearing_twin.dynamics.equations.sensor_path import band_levels, distance
from bearing_twin.dynamics.parameters import widest
from impact_trains import BEARING, impact_train, RATE
import numpy as np
import pytest
from scipy import signal


def swinging(rate):
    """Pairs of impacts 2 ms apart and a slow swing of a hundred times their height."""
    n = round(4.0 * rate)
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


def test_the_fastest_resonance_is_found_below_a_rotor_that_rings_forty_times_as_strong():
    """As a rotor does on its balls below 1 kHz: that is the strongest, and no path."""
    rate = 32000.0
    rng = np.random.default_rng(1)
    impacts = 1e-3 * rng.standard_normal(96000)
    entries = np.cumsum(rng.normal(356.0, 2.0, 260)).astype(int)
    impacts[entries] += 1.0
    impacts[entries + 34] -= 0.7
    rung = []
    for hz, height in ((590.0, 40.0), (2000.0, 1.0), (3500.0, 1.0)):
        pole = np.exp(2.0 * np.pi * hz / rate * (-0.03 + 1j))
        each = signal.lfilter([1.0], np.poly([pole, pole.conjugate()]).real, impacts)
        rung.append(height * each / each.std())
    noise = 0.1 * rng.standard_normal(96000)
    found = fastest_resonance(sum(rung) + noise, rate, 34 / rate)
    assert found == pytest.approx(3500.0, rel=0.05)


def test_the_comb_of_a_pair_of_impacts_does_not_pass_for_a_fast_resonance():
    """Two strikes 0.6 to 1 ms apart that ring at 1.5 kHz: their comb reaches to the highest."""
    rate = 51200.0
    pole = np.exp(2.0 * np.pi * 1500.0 / rate * (-0.03 + 1j))
    for seed, apart in enumerate((31, 41, 51)):
        rng = np.random.default_rng(seed)
        impacts = 1e-3 * rng.standard_normal(102400)
        entries = np.cumsum(rng.normal(560.0, 3.0, 180)).astype(int)
        impacts[entries] += 1.0
        impacts[entries + apart] -= 0.7
        x = signal.lfilter([1.0], np.poly([pole, pole.conjugate()]).real, impacts)
        x += 0.05 * x.std() * rng.standard_normal(len(x))
        assert fastest_resonance(x, rate, apart / rate) == pytest.approx(1500.0, rel=0.15)


def test_a_clearer_repetition_that_is_too_short_makes_a_longer_one_doubtful():
    """Impacts 0.3 ms apart, as close as one is long, and an echo of half their height later."""
    rate, rng = 20000.0, np.random.default_rng(1)
    x = 0.01 * rng.standard_normal(60000)
    entries = np.cumsum(rng.normal(330.0, 2.0, 170)).astype(int)
    x[entries] += 1.0
    x[entries + 6] += 0.8 * rng.standard_normal(170)
    x[entries + 28] += 0.4 * rng.standard_normal(170)
    found = summarise(signal.lfilter([1.0], [1.0, -0.5], x), rate, 5e-3)
    assert found.spacing == pytest.approx(1.4e-3, rel=0.01)
    assert found.rival > 1.0
    assert min(found.rivals) == pytest.approx(0.3e-3, rel=0.05)


@pytest.mark.parametrize('height', [1.0, 0.5, 0.2])
def test_a_copy_is_told_from_an_inverse_however_faint_it_is(height):
    """A faint second pit is as much a copy of the first as a strong one."""
    rate = 25600.0
    found = []
    for sign in (1.0, -1.0):
        x = 1e-3 * np.random.default_rng(1).standard_normal(51200)
        x[200:51000:700] += 1.0
        x[251:51051:700] += sign * height
        x = signal.lfilter([1.0], [1.0, -1.45, 0.96], x)
        found.append(likeness(x, rate, summarise(x, rate, 4e-3)))
    assert found[0] > 0.9 and found[1] < COPY


@pytest.mark.parametrize('place', ['inner', 'outer'])
def test_spacing_of_an_impact_train_is_read_whatever_rings(place):
    for width in (0.8e-3, 1.6e-3, 3.0e-3):
        x = impact_train(width, place, 12.0)
        speed = contact_speed(BEARING, place, 12.0)
        found = summarise(x, RATE, 1.1 * widest(BEARING) / speed)
        assert found.spacing * speed == pytest.approx(width, rel=0.05)
        louder = summarise(1e3 * x + 5.0, RATE, 1.1 * widest(BEARING) / speed)
        assert louder.spacing == pytest.approx(found.spacing, rel=1e-6)


def test_noise_shows_no_spacing():
    seen = 0
    for seed in range(20):
        x = np.random.default_rng(seed).standard_normal(51200)
        seen += summarise(x, RATE, 5e-3).shows_two_impacts
    assert seen <= 1
