# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Studies write where they are told, and never into the package."""

from dataclasses import replace
import json
import math
from pathlib import Path

import bearing_twin.diagnosis
from bearing_twin.diagnosis.machine.level import with_required_level
from bearing_twin.diagnosis.rules.confidence import KINDS, share_right, Trust
from bearing_twin.diagnosis.rules.table import DOUBTED, RULES
from bearing_twin.errors import BearingTwinError
from bearing_twin.studies import (
    calibration,
    detection_power,
    disturbed_series,
    generalisation,
    impact_machines,
    low_ringing,
    reliability,
    twin_machines,
)
from bearing_twin.studies.generalisation import judge_case
import numpy as np
import pytest
from scipy import special

PACKAGE = Path(bearing_twin.diagnosis.__file__).parent


def test_false_alarms_of_a_disturbed_series_are_those_of_the_chain_of_runs():
    """All of the newest four, closed form: 1 / mean time = (1 - p) p^4 / (1 - p^4)."""
    rng, share = np.random.default_rng(0), 0.2
    disturbed = rng.random((2000, 1065)) < share
    rate = (1.0 - share) * share**4 / (1.0 - share**4)
    assert disturbed_series.alarmed(disturbed, (4, 4)) == pytest.approx(
        1.0 - math.exp(-1001 * rate), abs=0.04
    )
    # As many are judged as the earlier ones require: 3 of 100 series at most.
    assert disturbed_series.alarmed(disturbed) < 0.03
    assert disturbed_series.alarmed(rng.random((2000, 1065)) < 0.35) < 0.035


def test_detection_power_writes_the_file_that_is_named(tmp_path, monkeypatch, capsys):
    for name in ('SPEEDS', 'TEMPERATURES', 'NOISES', 'WIDTHS', 'SEEDS'):
        monkeypatch.setattr(detection_power, name, getattr(detection_power, name)[-1:])
    before = {path: path.read_bytes() for path in PACKAGE.rglob('*.json')}
    detection_power.main([str(tmp_path / 'power.json')])
    table = json.loads((tmp_path / 'power.json').read_text())
    assert set(table) == set(json.loads((PACKAGE / 'detection_power.json').read_text()))
    # A spall of 2 mm at 50 Hz shows in every window from 2 s on.
    assert table['smallest_mm']['outer'][0][0][0][1:] == [2.0, 2.0, 2.0]
    assert '| outer | 50 | 90 | 2, 2, 2, 2 |' in capsys.readouterr().out
    assert {path: path.read_bytes() for path in PACKAGE.rglob('*.json')} == before


@pytest.mark.parametrize('study', [calibration, detection_power, reliability])
def test_a_study_without_a_place_to_write_ends_before_it_begins(study, tmp_path, capsys):
    for words in ([], [str(tmp_path / 'no folder' / 'out.json')]):
        with pytest.raises(SystemExit) as ended:
            study.main(words)
        assert ended.value.code == 2
    assert 'is no folder' in capsys.readouterr().err


def test_weights_in_use_are_not_fitted_anew(tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        reliability.main([str(tmp_path / 'answers.jsonl'), '--shipped', '--rules', 'whole_turns'])
    assert ended.value.code == 2
    assert '--shipped fits no weights' in capsys.readouterr().err


def test_low_lines_hold_more_of_an_outer_race_that_rings_low(capsys):
    x, rate, bearing, shaft_hz = low_ringing.record(3, damaged=True)
    again = low_ringing.record(3, damaged=True)
    assert np.array_equal(x, again[0])
    assert (rate, bearing, shaft_hz) == again[1:]
    low_ringing.main(['8'])
    sound, damaged = (line.split('|') for line in capsys.readouterr().out.splitlines()[2:])
    least = 4 + low_ringing.SHARES.index(0.2)
    assert int(sound[least]) / int(sound[3]) < int(damaged[least]) / int(damaged[3])


def test_the_weights_in_use_can_be_checked_without_a_fit(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(reliability, 'fit', None)
    answers = tmp_path / 'answers.jsonl'
    reliability.main([str(answers), '--shipped', '--fresh', '0', '8', '--jobs', '1'])
    assert '| all |' in capsys.readouterr().out


def test_what_is_not_rated_are_rules():
    assert set(reliability.UNRATED) - {rule.name for rule in RULES} == {'record_gate'}


def test_an_answer_from_the_level_alone_is_not_rated():
    case, said = judge_case('impacts', 4_800_171, misled=True)
    worn = replace(said, result='healthy', level='ok', faults=())
    worn = replace(worn, severity=replace(worn.severity, iso_zone='D'))
    raised = with_required_level(worn)
    assert (raised.result, raised.level, raised.kind) == ('ambiguous', 'fault', '')
    assert reliability.rate_answer(case, said)
    assert reliability.rate_answer(case, raised) is None


def test_a_name_at_an_unlikely_slip_counts_like_any_other():
    """Its speed is 3 to 5 % off, and the bearing is damaged all the same."""
    case, said = judge_case('impacts', 4_800_171, misled=True)
    assert (said.faults, said.level) == ((case.condition,), 'suspect')
    assert 0.5 < said.confidence <= DOUBTED
    told = reliability.rate_answer(case, said)
    assert (told.kind, told.right) == ('suspect', True)


def test_a_comb_of_a_ball_without_the_sidebands_of_its_cage_is_sure_of_strikes_only():
    """A sound bearing beside something that strikes as often as its balls do."""
    case, said = judge_case('impacts', 6_406_783)
    assert (case.condition, case.machine) == ('none', 'impacts')
    assert (said.rule, said.faults) == ('ball_without_cage_sidebands', ('ball',))
    told = reliability.rate_answer(case, said)
    assert (told.kind, told.right) == ('elsewhere', True)
    assert said.confidence > 0.9


def test_half_of_the_machines_are_sound_whatever_the_diagnosis_is_given():
    draw = {'twin': twin_machines.draw, 'impacts': impact_machines.draw}
    sound = {}
    for model, number, misled in reliability.tasks(4, 16, 0):
        sound.setdefault((model, misled), []).append(draw[model](number).condition == 'none')
    assert {part: (sum(among), len(among)) for part, among in sound.items()} == {
        ('twin', False): (2, 4),
        ('impacts', False): (8, 16),
        ('impacts', True): (2, 4),
    }


def test_weights_of_the_confidence_are_those_of_the_answers():
    """Answers that are right more often with more significance, whatever else they have."""
    rng = np.random.default_rng(0)
    told = []
    for kind in KINDS:
        for z in rng.uniform(3.0, 20.0, 400):
            sound = rng.random() < special.expit(2.0 * (2.0 - np.log(z)))
            told.append(reliability.RatedAnswer(kind, Trust(z=z), sound == (kind == 'healthy')))
    weights = reliability.fit(told)
    for kind in KINDS:
        # The odds of a sound bearing fall about as fast as the significance rises.
        name = 'sound' if kind == 'healthy' else 'significance'
        assert weights[kind][name] == pytest.approx(2.0, abs=0.7), kind
    with pytest.raises(BearingTwinError, match='draw more machines'):
        reliability.fit(told[:10])


def test_two_rules_of_one_answer_are_not_right_equally_often():
    """A rule that is right in 3 of 10 answers beside one that is in 9 of 10, at the same combs."""
    told = [
        reliability.RatedAnswer(kind, Trust(z=8.0, rule=rule), number % 10 < right)
        for kind in KINDS
        for rule, right in (('sure', 9), ('unsure', 3))
        for number in range(400)
    ]
    weights = reliability.fit(told)
    for kind in set(KINDS) - {'healthy'}:
        shares = [
            share_right(weights[kind], Trust(z=8.0, rule=rule)) for rule in ('sure', 'unsure')
        ]
        assert shares == pytest.approx([0.9, 0.3], abs=0.02), kind
    # What a rule may claim at most holds whatever the answers say.
    capped = Trust(z=8.0, rule='sure', at_most=0.5)
    assert share_right(weights['fault'], capped) == 0.5
    # A rule calls a bearing healthy by its odds, so its confidence rests on these alone.
    assert set(weights['healthy']) == {'constant', 'sound'}


def test_generalisation_prints_tables(capsys):
    generalisation.main(['4', 'impacts', '300000'])
    out = capsys.readouterr().out
    assert '| condition | cases | right | wrong | suspect | ambiguous |' in out
    rows = [line.split('|')[1:] for line in out.splitlines() if line.startswith('| ')]
    counts = [int(cases) for _, cases, *_ in rows if cases.strip().isdigit()]
    # Each case is one of the first table and one of the second.
    assert sum(counts) == 2 * 4


def test_calibration_goes_on_where_it_was_and_prints_its_tables(tmp_path, monkeypatch, capsys):
    out = tmp_path / 'out.jsonl'
    every = dict(calibration.SIMULATED)
    for name in ('twins', 'paths', 'paths'):
        monkeypatch.setattr(calibration, 'SIMULATED', {name: every[name]})
        calibration.main([str(out), '1', '--jobs', '1'])
    lines = [json.loads(line) for line in out.read_text().splitlines()]
    assert [(line['group'], line['name']) for line in lines] == [('twins', '0'), ('paths', '0')]
    calibration.print_tables(lines)
    said = capsys.readouterr().out
    assert '| all | 1 |' in said and '| strongest resonance |' in said
    out.write_text('{')
    with pytest.raises(BearingTwinError, match='no file of this study'):
        calibration.main([str(out), '0'])


def refusing(number):
    """Stand for a machine that cannot be fitted, every second time."""
    if number % 2:
        raise BearingTwinError('too few shaft turns')
    return []


def test_calibration_goes_on_after_a_machine_that_is_not_fitted(tmp_path, monkeypatch, capsys):
    out = tmp_path / 'out.jsonl'
    monkeypatch.setattr(calibration, 'SIMULATED', {'paths': refusing})
    for count in (2, 5):
        calibration.main([str(out), str(count), '--jobs', '1'])
    lines = [json.loads(line) for line in out.read_text().splitlines()]
    assert [line['name'] for line in lines] == ['0', '2', '4']
    assert capsys.readouterr().err.splitlines() == [
        f'paths, {number}: too few shaft turns' for number in (1, 1, 3)
    ]


def test_a_count_of_intervals_that_hold():
    """Three of four identifiable widths hold, one narrowly; those that are not count apart."""
    row = {
        'place': 'inner', 'q25': 0.9, 'q75': 1.1, 'own_q05': 0.85, 'own_q95': 1.2,
        'identifiable': True, 'rank': 0.5,
    }  # fmt: skip
    rows = [
        row | {'width': width, 'q05': 0.8, 'median': 1.0, 'q95': 1.25}
        for width in (0.8, 1.0, 1.25, 2.0)
    ]
    rows.append(rows[1] | {'identifiable': False})
    rows.append(rows[1] | {'width': math.nan})
    said = calibration.summary(rows)
    assert (said['faulty'], said['identifiable']) == (5, 4)
    assert (said['within_90'], said['within_50'], said['within_90_all']) == (0.75, 0.25, 0.8)
    assert said['within_90_own'] == 0.25
    assert said['median_error'] == pytest.approx(0.225)
