# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Real recordings of four rigs. They judge; nothing in the chain was set by them."""

from pathlib import Path

from bearing_twin.cli.benchmark import judge, read_cases
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.recording.signals.signalfile import read_signal
from bearing_twin.repeats import repeated_span
import numpy as np
import pytest

RATE = 25600.0


@pytest.fixture(scope='module')
def outcomes(data_dir):
    """Outcome, label, grade and data set of every whole record at its measured speed."""
    found = {}
    for case in read_cases(data_dir):
        record = read_signal(Path(case.path))
        said = diagnose_record(record.x, record.sample_rate, case.bearing, case.speeds[0][1])
        found[case.name] = (judge(case.label, said), case, said)
    return found


def test_clear_records_of_cwru(outcomes):
    """Grade Y1 of Smith and Randall: clear in time and frequency."""
    clear = {name: o for name, (o, case, _) in outcomes.items() if case.grade == 'Y1'}
    assert len(clear) == 9
    assert set(clear.values()) == {'correct'}, clear


def test_diagnosable_records_of_cwru(outcomes):
    said = [o for o, case, _ in outcomes.values() if case.grade in ('Y1', 'Y2')]
    assert len(said) == 44
    assert said.count('wrong') == 0
    assert said.count('correct') >= 41


@pytest.mark.parametrize('dataset', ['mfpt', 'hitsm'])
def test_all_faults_of_a_rig(outcomes, dataset):
    said = {
        n: o for n, (o, c, _) in outcomes.items() if c.dataset == dataset and c.label != 'healthy'
    }
    assert set(said.values()) == {'correct'}, said


def test_slipping_outer_race_is_never_called_inner(outcomes):
    outcome, _, said = outcomes['uestc_O_1000']
    assert outcome == 'correct'
    assert said.slip == pytest.approx(0.03, abs=0.02)  # the cage slips, there is no load
    assert outcomes['uestc_I_1000'][0] == 'correct'


def test_no_alarm_on_a_healthy_record(outcomes):
    healthy = [said for _, case, said in outcomes.values() if case.label == 'healthy']
    assert len(healthy) >= 5
    assert all(said.level != 'fault' for said in healthy)


def test_amplitude_and_offset_do_not_matter(data_dir):
    case = next(c for c in read_cases(data_dir) if c.name == 'cwru_0169_DE')
    record = read_signal(Path(case.path))
    x = record.x[: int(4 * record.sample_rate)]
    plain, scaled = (
        diagnose_record(y, record.sample_rate, case.bearing, case.speeds[0][1])
        for y in (x, 1e-4 * x + 7.0)
    )
    assert plain.result == scaled.result == 'inner'
    assert scaled.score['inner'] == pytest.approx(plain.score['inner'], rel=1e-3)


def test_sample_rate_does_not_matter(data_dir):
    """Every other sample of a 48 kHz record after an ideal low-pass filter."""
    case = next(c for c in read_cases(data_dir) if c.name == 'hitsm_sq_OR5_900')
    record = read_signal(Path(case.path))
    spectrum = np.fft.rfft(record.x)
    half = np.fft.irfft(spectrum[: len(spectrum) // 2 + 1])
    said = diagnose_record(half, record.sample_rate / 2, case.bearing, case.speeds[0][1])
    assert said.result == 'outer'


@pytest.mark.parametrize(('length', 'sound'), [(1024, 0.01), (4096, 0.9), (300, 0.5)])
def test_a_record_of_a_driver_that_hung_is_no_record(data_dir, length, sound):
    """Its last buffer is written again and again, with the noise of a real sensor."""
    for case in read_cases(data_dir)[::6]:
        record = read_signal(Path(case.path))
        begin = max(int(sound * len(record.x)), length)
        copies = np.resize(record.x[begin - length : begin], len(record.x) - begin)
        x = np.concatenate((record.x[:begin], copies))
        said = diagnose_record(x, record.sample_rate, case.bearing, case.speeds[0][1])
        assert said.result == 'insufficient', case.name
        assert f'repeat those {length} samples before' in ' '.join(said.reasons), case.name


def test_blocks_that_were_written_twice_are_found(rng):
    twice = np.repeat(rng.standard_normal((40, 1024)), 2, axis=0).ravel()
    assert repeated_span(twice).startswith('50 % of the samples repeat those 1024')


@pytest.mark.parametrize('bits', [0, 24, 16, 12, 8])
@pytest.mark.parametrize('period', [128, 286, 1024, 3000])
def test_a_simulation_without_noise_may_repeat(rng, period, bits):
    """Lines of the shaft, and impacts that ring in up to five modes, in numbers or in counts."""
    time = np.arange(period) / RATE
    for modes in range(6):
        impacts = np.zeros(6 * period)
        impacts[::period] = 1.0
        ring = np.zeros(4 * period)
        for hertz, damping in rng.uniform((300.0, 0.01), (11000.0, 0.06), (modes, 2)):
            after = 2.0 * np.pi * hertz * np.arange(len(ring)) / RATE
            ring += np.exp(-damping * after) * np.sin(after)
        x = np.convolve(impacts, ring)[4 * period : 5 * period]
        x += 0.1 * np.sin(2.0 * np.pi * RATE / period * time)
        if bits:
            x = np.round(x / np.abs(x).max() * 2.0 ** (bits - 1))
        assert repeated_span(np.resize(x, 100_000)) == '', modes
