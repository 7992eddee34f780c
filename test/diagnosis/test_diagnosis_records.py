# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Real recordings of four rigs. They judge; nothing in the chain was set by them."""

from pathlib import Path

from bearing_twin.cli.benchmark import judge, read_cases
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.recording.signals.signalfile import read_signal
import numpy as np
import pytest


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
