# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""No alarm where there is no fault: noises, and the healthy twin, which has a line at BPFO."""

from bearing_twin.bearing import find_bearing
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.dynamics.presets import preset
from bearing_twin.dynamics.single.simulator import Simulator
from bearing_twin.studies.load_sidebands import expected, measured
from bearing_twin.studies.noise_windows import draw, main
from cases import in_proofs
import numpy as np
import pytest


@pytest.mark.parametrize('first', [0, *in_proofs(60, 120)])
def test_no_alarm_on_noise(first):
    """Some of the windows of the study."""
    for number in range(first, first + 60):
        window = draw(number)
        said = diagnose_record(window.x, window.sample_rate, window.bearing, window.given_hz)
        assert said.level != 'fault', (number, said.reasons)


def test_the_study_of_noise_counts_every_window(capsys):
    main(['18'])
    verdicts, passed, reached = capsys.readouterr().out.strip().split('\n\n')
    assert sum(int(row.split('|')[2]) for row in verdicts.splitlines()[2:]) == 18
    assert [row.split('|')[1].strip() for row in passed.splitlines()[2:]] == [
        'Z_FAULT',
        'Z_CAGE',
        'Z_ELSEWHERE',
        'Z_SECOND_LOOK',
        'Z_PASSAGES',
    ]
    assert 'any order' in reached


@pytest.mark.parametrize('spread', [2.2, 1.0])
def test_sidebands_of_a_load_are_those_of_the_closed_form(spread):
    """The threshold SWAY rests on it."""
    found = np.median([measured(spread, seed) for seed in range(5)])
    assert found == pytest.approx(expected(spread), rel=0.1)


@pytest.mark.parametrize('clearance', [5e-6, 15e-6])
@pytest.mark.parametrize('axis', ['x', 'y'])
def test_no_alarm_on_the_healthy_twin(clearance, axis):
    twin = Simulator(preset('incipient', defect='none', clearance=clearance), seed=5)
    twin.advance(12_800, 40.0, 25.4)
    block = twin.advance(8 * 25_600, 40.0, 25.4)
    said = diagnose_record(getattr(block, axis), 25600.0, find_bearing('6307'), 25.4)
    assert said.result == 'healthy'


@pytest.mark.parametrize('degrees', [60.0, *in_proofs(20.0, 100.0)])
def test_the_sound_twin_of_a_first_run_is_healthy(degrees):
    """The default machine without a defect, at the temperatures of the default schedule."""
    twin = Simulator(preset('paper', defect='none'), seed=0, temperature=degrees)
    twin.advance(12_800, degrees, 25.4)
    x = twin.advance(8 * 25_600, degrees, 25.4).y
    said = diagnose_record(x, 25600.0, find_bearing('6307'), 25.4, unit='m/s^2')
    assert said.result == 'healthy', said.reasons


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
