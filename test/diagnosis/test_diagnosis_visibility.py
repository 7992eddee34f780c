# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Faults that samples can show, and the answer where they cannot show one."""

from bearing_twin.bearing import fault_orders, find_bearing
from bearing_twin.diagnosis import diagnose_record, StreamingDiagnoser
from bearing_twin.diagnosis.signal.gate import fastest_impacts_hz
from bearing_twin.diagnosis.thresholds import INDEX_FAULT
import numpy as np
import pytest
from scipy import signal

BEARING = find_bearing('6205')
SHAFT_HZ = 25.0


def _ringing(rng, order, *, seconds, rate, resonance_hz, shaft_hz=SHAFT_HZ):
    """Impacts through one resonance with 4 % damping, RMS 1; they scatter by 1 % of their gap."""
    count, fault_hz = round(seconds * rate), order * shaft_hz
    numbers = np.arange(1, int(seconds * fault_hz))
    times = (numbers + 0.01 * rng.standard_normal(len(numbers))) / fault_hz
    impacts = np.zeros(count)
    impacts[(times * rate).astype(int)] = 1.0 + 0.1 * rng.standard_normal(len(times))
    turning = 2.0 * np.pi * resonance_hz
    t = np.arange(round(8.0 / (0.04 * turning) * rate)) / rate
    x = signal.fftconvolve(impacts, np.exp(-0.04 * turning * t) * np.sin(turning * t))[:count]
    return x / x.std()


@pytest.mark.parametrize(('rate', 'result'), [(12_800, 'insufficient'), (25_600, 'healthy')])
def test_healthy_is_said_where_a_fault_would_show(rate, result):
    # The inner race would strike 840 times a second. At 12.8 kHz the highest resonance is one of
    # 5 kHz, which rings for 0.8 ms.
    rng, shaft_hz = np.random.default_rng(5), 840.0 / fault_orders(BEARING).bpfi
    noise = rng.standard_normal(rate)
    assert diagnose_record(noise, rate, BEARING, shaft_hz).result == result


@pytest.mark.parametrize('off', [0.98, 1.02])
def test_the_fastest_impacts_have_the_index_of_a_fault(off):
    """Half of the power in impacts whose squared ringing decays, the other half in noise."""
    rate, fault_hz = 25_600.0, off * fastest_impacts_hz(25_600.0)
    t = np.arange(0.0, 0.01, 1e-7)
    squared = np.exp(-2.0 * 0.04 * 2.0 * np.pi * rate / 2.56 * t)
    lines = [
        abs((squared * np.exp(-2j * np.pi * k * fault_hz * t)).sum()) / squared.sum()
        for k in range(1, 5)
    ]
    assert (np.hypot.reduce(lines) > INDEX_FAULT) == (off < 1.0)


def _fast():
    """Order and speed at which an outer race strikes 1000 times a second, and 3 s of noise."""
    order = fault_orders(BEARING, 0.005).bpfo
    rng = np.random.default_rng(0)
    return rng, order, 1000.0 / order, rng.standard_normal(3 * 51_200)


@pytest.mark.parametrize(
    ('strength', 'result', 'faults'), [(1.0, 'insufficient', ()), (1.6, 'suspect', ('outer',))]
)
def test_impacts_whose_ringing_runs_together_are_not_healthy(strength, result, faults):
    """At 4 kHz and 4 % damping the envelope falls to 13 % between two impacts, not to nothing."""
    rng, order, shaft_hz, x = _fast()
    x += strength * _ringing(
        rng, order, seconds=3.0, rate=51_200, resonance_hz=4000.0, shaft_hz=shaft_hz
    )
    said = diagnose_record(x, 51_200, BEARING, shaft_hz)
    assert (said.result, said.faults) == (result, faults), said.reasons
    assert '1000 ' in said.reasons[-1]
    assert 'record at a lower speed' in said.reasons[-1]


@pytest.mark.parametrize('depth', [0.03, 0.05, 0.07])
def test_passing_balls_of_a_fast_bearing_are_healthy(depth):
    _, _, shaft_hz, x = _fast()
    x *= 1.0 + depth * np.cos(2.0 * np.pi * 1000.0 / 51_200 * np.arange(len(x)))
    said = diagnose_record(x, 51_200, BEARING, shaft_hz)
    assert (said.result, said.level) == ('healthy', 'ok'), said.reasons
    assert said.score['outer'] > 5.5


@pytest.mark.parametrize('name', ['6307', '6203'])
def test_an_outer_race_that_slips_on_to_a_multiple_of_the_shaft_is_not_healthy(name):
    rng, bearing = np.random.default_rng(3), find_bearing(name)
    assert 3.02 < fault_orders(bearing).bpfo < 3.06
    x = _ringing(rng, 3.0, seconds=8.0, rate=25_600, resonance_hz=4000.0)
    x += rng.standard_normal(len(x))
    said = diagnose_record(x, 25_600, bearing, SHAFT_HZ, speed_tolerance=0.002)
    assert said.level == 'suspect', said.reasons
    assert said.faults == ('outer',)
    assert 0.4 < said.confidence <= 0.5
    assert said.score['outer'] > 20.0


def test_a_sound_machine_that_shakes_once_a_turn_stays_healthy():
    rng, bearing = np.random.default_rng(3), find_bearing('6307')
    turns = np.arange(8 * 25_600) / 25_600 * SHAFT_HZ
    x = rng.standard_normal(len(turns)) * (1.0 + 0.4 * np.cos(2.0 * np.pi * turns))
    x += sum(np.cos(2.0 * np.pi * k * turns) / k for k in range(1, 6))
    said = diagnose_record(x, 25_600, bearing, SHAFT_HZ, speed_tolerance=0.002)
    assert said.result == 'healthy', said.reasons


def _outer_at_102400_hz(seconds):
    """Outer race that rings at 3 kHz, in white noise that is 1 within 12.8 kHz."""
    rng, rate = np.random.default_rng(4), 102_400
    order = fault_orders(BEARING, 0.005).bpfo
    x = 0.35 * _ringing(rng, order, seconds=seconds, rate=rate, resonance_hz=3000.0)
    return x + 2.0 * rng.standard_normal(len(x))


def test_faster_sampling_of_the_same_machine_says_the_same():
    x = _outer_at_102400_hz(6.0)
    slow = diagnose_record(signal.resample_poly(x, 1, 4), 25_600, BEARING, SHAFT_HZ)
    fast = diagnose_record(x, 102_400, BEARING, SHAFT_HZ)
    assert slow.faults == fast.faults == ('outer',)
    assert fast.level == 'fault'
    assert fast.modulation_index['outer'] == pytest.approx(slow.modulation_index['outer'], rel=0.1)


def test_a_fast_stream_names_what_the_record_does():
    x = _outer_at_102400_hz(4.0)
    diagnoser = StreamingDiagnoser(BEARING)
    said = [
        verdict
        for first in range(0, len(x), 10_000)
        for verdict in diagnoser.push(first, x[first : first + 10_000], 102_400.0, SHAFT_HZ)
    ]
    assert said[-1].faults == ('outer',), said[-1].reasons
    assert said[-1].score == diagnose_record(x, 102_400, BEARING, SHAFT_HZ).score


@pytest.mark.parametrize('steps', [0.12, 0.6, 1.5])
def test_what_may_be_the_rounding_of_a_converter_is_not_healthy(steps):
    noise = np.random.default_rng(7).standard_normal(8 * 25_600)
    said = diagnose_record(np.rint(steps * noise), 25_600, BEARING, SHAFT_HZ)
    assert (said.result, said.level) == ('insufficient', 'none')
    assert 'steps of the converter' in said.reasons[-1]


def test_a_converter_of_few_steps_hides_no_fault():
    rng = np.random.default_rng(8)
    bpfi = fault_orders(BEARING).bpfi
    x = _ringing(rng, bpfi, seconds=8.0, rate=25_600, resonance_hz=4000.0)
    x = np.rint(x + 0.7 * rng.standard_normal(len(x)))
    assert diagnose_record(x, 25_600, BEARING, SHAFT_HZ).result == 'inner'


def _turns():
    return SHAFT_HZ * np.arange(8 * 25_600) / 25_600


@pytest.mark.parametrize('loudness', [1.0, 3.0])
def test_the_steady_pulses_of_a_belt_are_lines_and_no_bursts(loudness):
    """Four pulses a turn, 15 harmonics in phase: kurtosis 7 and 16."""
    rng, turns = np.random.default_rng(2), _turns()
    pulses = sum(np.cos(2.0 * np.pi * 4.0 * k * turns) for k in range(1, 16))
    x = rng.standard_normal(len(turns)) + loudness * pulses / pulses.std()
    said = diagnose_record(x, 25_600, BEARING, SHAFT_HZ)
    assert said.severity.kurtosis > 6.0
    assert (said.result, said.level) == ('healthy', 'ok'), said.reasons


@pytest.mark.parametrize('blades', [3, 5])
def test_a_fan_on_a_multiple_of_the_shaft_that_a_place_may_slip_on_to_is_healthy(blades):
    rng, turns = np.random.default_rng(2), _turns()
    noise = rng.standard_normal(len(turns))
    x = noise * (1.0 + 0.4 * np.cos(2.0 * np.pi * blades * turns))
    said = diagnose_record(x, 25_600, find_bearing('6204'), SHAFT_HZ)
    assert (said.result, said.level) == ('healthy', 'ok'), said.reasons


@pytest.mark.parametrize('place', ['inner', 'ball'])
def test_a_spall_over_most_of_the_pitch_is_named_by_its_sidebands(place):
    """Noise swells like half a sine over 70 % of the time between two balls."""
    rng, turns, orders = np.random.default_rng(1), _turns(), fault_orders(BEARING)
    phase = (0.994 * orders.impacts(place) * turns) % 1.0
    swell = np.where(phase < 0.7, np.sin(np.pi * phase / 0.7), 0.0)
    load = 1.0 + np.cos(2.0 * np.pi * (orders.ftf if place == 'ball' else 1.0) * turns)
    spall = swell * load * rng.standard_normal(len(turns))
    x = rng.standard_normal(len(turns)) + spall / spall.std()
    assert diagnose_record(x, 25_600, BEARING, SHAFT_HZ).faults == (place,)
