# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""No alarm where there is no fault: noises, and the healthy twin, which has a line at BPFO."""

from bearing_twin.bearing import find_bearing
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.dynamics.presets import preset
from bearing_twin.dynamics.simulator import Simulator
import numpy as np
import pytest
from scipy import fft

BEARINGS = ('6205', '6307', 'ZA-2115', 'UER204')


def white(rng, n, rate, shaft_hz):
    return rng.standard_normal(n)


def pink(rng, n, rate, shaft_hz):
    spectrum = fft.rfft(rng.standard_normal(n))
    spectrum[1:] /= np.sqrt(np.arange(1, len(spectrum)))
    return fft.irfft(spectrum, n)


def lines(rng, n, rate, shaft_hz):
    """Noise with shaft and mains harmonics, stray lines and a modulated gear mesh."""
    t = np.arange(n) / rate
    x = rng.standard_normal(n)
    stray = rng.uniform(10.0, rate / 2, 30)
    for hz in (*(shaft_hz * np.arange(1, 30)), *(50.0 * np.arange(1, 12)), *stray):
        x += rng.exponential() * np.sin(2 * np.pi * (hz * t + rng.random()))
    mesh = rng.integers(15, 60) * shaft_hz
    for k in (1, 2, 3):
        wave = np.sin(2 * np.pi * (k * mesh * t + rng.random()))
        x += rng.exponential(2.0) * (1 + 0.5 * np.cos(2 * np.pi * shaft_hz * t)) * wave
    return x


@pytest.mark.parametrize('kind', [white, pink, lines])
def test_no_alarm_on_noise(kind):
    rng = np.random.default_rng(11)
    for number in range(60):
        bearing = find_bearing(BEARINGS[number % len(BEARINGS)])
        seconds = (1.0, 2.0, 4.0)[number % 3]
        rate = rng.choice((12000.0, 20000.0, 25600.0)) if bearing.n_balls < 16 else 25600.0
        shaft_hz = rng.uniform(21.0 if seconds == 1.0 else 12.0, 30.0)
        x = kind(rng, int(seconds * rate), rate, shaft_hz)
        said = diagnose_record(x, rate, bearing, shaft_hz * rng.uniform(0.99, 1.01))
        assert said.level != 'fault', (number, said.reasons)


@pytest.mark.parametrize('clearance', [5e-6, 15e-6])
@pytest.mark.parametrize('axis', ['x', 'y'])
def test_no_alarm_on_the_healthy_twin(clearance, axis):
    twin = Simulator(preset('incipient', defect='none', clearance=clearance), seed=5)
    twin.advance(12_800, 40.0, 25.4)
    block = twin.advance(8 * 25_600, 40.0, 25.4)
    said = diagnose_record(getattr(block, axis), 25600.0, find_bearing('6307'), 25.4)
    assert said.result == 'healthy'


@pytest.mark.parametrize('fault', ['inner', 'outer', 'ball', 'cage'])
@pytest.mark.parametrize('severity', ['incipient', 'paper'])
def test_faults_of_the_twin_are_named(fault, severity):
    twin = Simulator(preset(severity, defect=fault), seed=5)
    twin.advance(12_800, 40.0, 25.4)
    x = twin.advance(8 * 25_600, 40.0, 25.4).y
    said = diagnose_record(x, 25600.0, find_bearing('6307'), 25.4, unit='m/s^2')
    assert said.faults == (fault,), said.reasons
    assert said.level == 'fault'
    # The preset's slip is 0.1 %; the cage's comb is coarse in orders.
    assert said.fault_hz == pytest.approx(said.fault_hz_expected, rel=0.02)


def test_two_faults_are_both_named():
    twin = Simulator(preset('incipient', defect='outer+ball'), seed=5)
    twin.advance(12_800, 40.0, 25.4)
    x = twin.advance(8 * 25_600, 40.0, 25.4).y
    said = diagnose_record(x, 25600.0, find_bearing('6307'), 25.4, speed_tolerance=0.002)
    assert set(said.faults) == {'outer', 'ball'}, said.reasons
