# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Machines that nobody tuned for, and conditions that change within a window."""

from collections import Counter

from bearing_twin.diagnosis import DiagnosisSettings, StreamingDiagnoser
from bearing_twin.dynamics.presets import preset
from bearing_twin.dynamics.single.simulator import Simulator
from bearing_twin.studies import generalisation
from cases import in_proofs
import pytest


@pytest.mark.parametrize('count', [12, *in_proofs(60)])
def test_machines_at_random(count):
    found = generalisation.study(range(count))
    for case, said in found:
        if case.condition == 'none':
            assert said.level != 'fault', (case, said.reasons)
    told = Counter(generalisation.outcome(case, said) for case, said in found)
    # One of 60 may be wrong: a ball that looks like a cage, or two races at once.
    assert told['wrong'] <= count // 60, told
    assert told['right'] >= 0.6 * count, told


@pytest.mark.parametrize(
    ('fault', 'severity'), [('inner', 'incipient'), ('inner', 'paper'), ('outer', 'paper')]
)
def test_no_other_race_is_named_while_temperature_and_slip_change(fault, severity):
    # BPFI of the 6307 less two shaft orders meets BPFO as the slip moves within the window.
    twin = Simulator(preset(severity, defect=fault), seed=0, temperature=20.0)
    diagnoser = StreamingDiagnoser(twin.parameters.bearing, DiagnosisSettings())
    told = Counter()
    for number in range(42 * 25):
        heat = 20.0 + 90.0 * min(number / 1000.0, 1.0)
        block = twin.advance(1024, heat, 25.4)
        for said in diagnoser.push(
            block.first_sample, block.y, 25600.0, 25.4, speed_measured=True, temperature=heat
        ):
            told[said.result] += 1
            assert said.faults == (fault,) or said.result == 'ambiguous', said.reasons
    assert told[fault] >= 0.9 * told.total()


def test_no_race_is_named_in_the_first_windows_of_a_cage_fault():
    for seed in (0, 1):
        twin = Simulator(preset('incipient', defect='cage'), seed=seed, temperature=20.0)
        diagnoser = StreamingDiagnoser(twin.parameters.bearing, DiagnosisSettings())
        found = []
        for _ in range(10):
            block = twin.advance(25600, 20.0, 25.4)
            found += diagnoser.push(
                block.first_sample, block.y, 25600.0, 25.4, speed_measured=True
            )
        assert {said.faults for said in found if said.level == 'fault'} == {('cage',)}
