# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a fitted machine would do at another speed, load or width; and what is no fit."""

import json
import math

from bearing_twin.calibration import fit
from bearing_twin.calibration.whatif import expect, features
from bearing_twin.cli import main
from bearing_twin.errors import BearingTwinError
from impact_trains import BEARING, impact_train, RATE
import numpy as np
import pytest


def test_one_speed_predicts_another(slot_fit, data_dir, tmp_path, capsys):
    """HIT-SM, fitted at 900, predicted at 1200 1/min: the impacts come closer in time."""
    found = slot_fit
    expected = expect(found, shaft_hz=20.0, candidates=32)
    with np.load(data_dir / 'hitsm' / 'hitsm_sq_IR8_1200.npz') as file:
        x, rate = file['x'].astype(float), float(file['fs'])
    there = found.at(shaft_hz=20.0).situation
    measured = features(x, rate, there.longest_spacing)
    spacing = expected.vibration['spacing_ms']
    assert spacing.q05 < measured['spacing_ms'] < spacing.q95
    level = expected.vibration['rms']
    assert level.q05 < measured['rms'] < level.q95
    for name in ('crest_factor', 'impulsiveness'):
        said = expected.vibration[name]
        assert said.q05 < measured[name] < said.q95, name
    inner = expected.verdicts['inner']
    assert 0.5 < inner.q05 < inner.median < inner.q95 <= 1.0
    saved = tmp_path / 'fit.json'
    saved.write_text(json.dumps({'file': 'slot', **found.to_dict()}))
    assert main(['whatif', str(saved), '--speed', '20', '--width', '1.0', '--json']) == 0
    answer = json.loads(capsys.readouterr().out)
    narrower = answer['vibration']['spacing_ms']
    assert narrower['median'] < spacing.median
    assert answer['width_mm'] == [1.0, 1.0]


@pytest.mark.parametrize(
    ('text', 'why'),
    [
        ('', 'holds no fit'),
        ('[1, 2]', 'holds no fit'),
        ('not json', 'holds no fit'),
        ('[' * 100_000, 'holds no fit'),
        ('{"quantities": {}}', "'machine' is missing"),
        ('{"file": "a.npz", "error": "too short"}', 'holds no fit, but an error: too short'),
    ],
)
def test_what_is_no_fit_is_refused_in_words(text, why, tmp_path, capsys):
    path = tmp_path / 'fit.json'
    path.write_text(text)
    assert main(['whatif', str(path)]) != 0
    assert str(path) in (said := capsys.readouterr().err) and why in said


def test_a_forged_fit_is_refused_in_words(tmp_path, capsys):
    """What does not fit together was met while drawing."""
    noise = 0.01 * np.random.default_rng(1).standard_normal(25600)
    good = fit(noise, 12800.0, BEARING, 25.0, candidates=16, place='none').to_dict()
    saved = tmp_path / 'fit.json'
    for changed in (
        {'weights': math.nan}, {'weights': 1.0}, {'weights': good['weights'][:-1]},
        {'quantities': None}, {'candidates': [1]}, {'candidates': {}},
        {'machine': {**good['machine'], 'load': {}}}, {'quantities': {}}, {'defect': 'shaft'},
        *({'machine': {**good['machine'], name: value}} for name, value in (
            ('shaft_hz', -25.0), ('shaft_hz', math.nan), ('shaft_hz', '25'), ('slip', 0.2),
            ('sample_rate', 1e9), ('temperature', -300.0), ('load', [5.0, 1.0]), ('unit', None),
            ('bearing', {**good['machine']['bearing'], 'name': [6205]}),
        )),
        *({'quantities': good['quantities'] | {'load': {**good['quantities']['load'], **wrong}}}
          for wrong in ({'median': 'x'}, {'q05': 1e9}, {'identifiable': 1}, {'why': None})),
        {'candidates': good['candidates'] | {'load': [1e9] * len(good['weights'])}},
        *({'spectrum': {**good['spectrum'], **wrong}} for wrong in (
            {'machine_rms': 0.0}, {'machine_db': []}, {'level_after_db': math.inf},
        )),
        {'path': {**good['path'], 'sample_rate': 25600.0}},
        {'impacts': {'place': 'none', 'shaft_hz': 25.0, 'spacing_s': -1.0, 'lobe_s': 1.0,
                     'rivals_s': []}},
    ):  # fmt: skip
        saved.write_text(json.dumps(good | changed))
        assert main(['whatif', str(saved)]) == 1
        said = capsys.readouterr().err
        assert str(saved) in said and 'not a calibration of this version' in said


def test_a_width_no_ball_fits_is_refused(slot_fit):
    for width in (6.0, 0.01, math.nan):
        with pytest.raises(BearingTwinError, match=r'mm is outside .* half a ball'):
            expect(slot_fit, width_mm=width, candidates=16)


def test_a_width_of_which_nothing_was_seen_is_refused():
    noise = np.random.default_rng(1).standard_normal(51200)
    found = fit(noise, RATE, BEARING, 20.0, place='outer', candidates=64)
    with pytest.raises(BearingTwinError, match='nothing was seen of the defect'):
        expect(found, width_mm=3.0, candidates=16)


def test_a_hall_in_winter_is_fitted_and_what_if_keeps_to_its_limits():
    noise = 0.01 * np.random.default_rng(1).standard_normal(51200)
    cold = fit(noise, RATE, BEARING, 20.0, place='none', temperature=-5.0, candidates=64)
    assert cold.situation.temperature == -5.0
    assert expect(cold, load=(50.0, 50.0), candidates=16).load == pytest.approx((50.0, 50.0))
    for load in ((0.0, 100.0), (100.0, 50.0)):
        with pytest.raises(BearingTwinError, match='give the least and the largest'):
            expect(cold, load=load)
    with pytest.raises(BearingTwinError, match=r'temperature of 5 degC is outside 20\.\.110'):
        expect(cold, temperature=5.0)


def test_what_if_of_a_healthy_machine_changes_its_level_as_machines_do_with_speed():
    """10 +- 4 dB a doubling; a faulty one has the level of its record where nothing changes."""
    noise = np.random.default_rng(1).standard_normal(51200)
    healthy = fit(noise, RATE, BEARING, 20.0, unit='m/s^2', place='none', candidates=64)
    same, twice = (expect(healthy, shaft_hz=hz).vibration['rms'] for hz in (20.0, 40.0))
    assert same.q95 / same.q05 < 1.2
    assert 20.0 * math.log10(twice.median / same.median) == pytest.approx(10.0, abs=3.0)
    assert 20.0 * math.log10(twice.q95 / twice.q05) == pytest.approx(2 * 1.645 * 4.0, rel=0.3)
    x = impact_train(2e-3, 'outer', 12.0)
    faulty = fit(x, RATE, BEARING, 12.0, place='outer', candidates=64)
    level = expect(faulty, candidates=24).vibration['rms']
    assert level.q05 < x.std() < level.q95 < 1.6 * level.q05
