# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The twin fitted to one record whose truth is known: trains of impacts, a real slot, noise."""

import json
import math
from pathlib import Path

from bearing_twin.bearing import find_bearing
from bearing_twin.calibration import Calibration, fit
from bearing_twin.calibration.answer.refusals import Kind
from bearing_twin.calibration.fit import fitted_vibration
from bearing_twin.cli import main
from bearing_twin.errors import BearingTwinError
from impact_trains import BEARING, impact_train, RATE
import numpy as np
import pytest

NOISE = np.random.default_rng(0).standard_normal(51200)


@pytest.mark.parametrize(
    ('change', 'text'),
    [
        ({'samples': np.full(51200, np.nan)}, 'NaN'),
        ({'samples': np.zeros((2, 51200))}, '1-D'),
        ({'samples': np.ones(51200)}, 'constant'),
        ({'samples': np.clip(NOISE, -0.5, 0.5), 'place': 'outer'}, 'is clipped'),
        ({'samples': NOISE[:5000]}, 'shaft turns'),
        ({'samples': NOISE[:1]}, 'has one sample: give at least a second'),
        ({'sample_rate': 0.0}, 'sample rate'),
        ({'sample_rate': 800.0}, 'sample rate'),
        ({'shaft_hz': math.nan}, 'shaft speed'),
        ({'load': (500.0, 100.0)}, 'in that order'),
        ({'bearing': find_bearing('ZA-2115')}, 'to fit, choose a ball bearing'),
        ({'place': 'shaft'}, 'place'),
    ],
)
def test_bad_input_is_refused_in_words(change, text):
    values = {'samples': NOISE, 'sample_rate': RATE, 'bearing': BEARING, 'shaft_hz': 20.0} | change
    with pytest.raises(BearingTwinError, match=text):
        fit(**values)


def test_a_real_slot_is_measured(slot_fit):
    """HIT-SM, inner race, 8 degrees of a radius of 15.55 mm: 2.17 mm."""
    found = slot_fit
    width = found.quantities['defect_width_mm']
    assert found.defect == 'inner'
    assert width.identifiable, width
    assert width.q05 < 2.17 < width.q95
    assert width.median == pytest.approx(2.17, rel=0.2)
    assert found.distance < 0.3 * found.distance_before
    assert abs(found.level) < 1.0
    assert found.refusal is None
    again = Calibration.from_dict(json.loads(json.dumps(found.to_dict())))
    assert again.to_dict() == found.to_dict()
    assert again.twin_parameters() == found.twin_parameters()


@pytest.mark.proof
def test_the_lower_bound_holds_where_the_impacts_are_those_of_the_edges():
    """The twin takes the path of a ball off, which a train of impacts does not have."""
    found = fit(impact_train(2e-3, 'inner', 12.0), RATE, BEARING, 12.0, place='inner')
    width = found.quantities['defect_width_mm']
    assert width.identifiable, width.why
    assert width.q05 < 2.0 < width.q95


def test_the_command_writes_what_it_found(tmp_path, capsys, data_dir):
    name = str(data_dir / 'hitsm' / 'hitsm_sq_Normal_600.npz')
    status = main(['fit', name, '--bearing', '6205', '--shaft-hz', '10', '--json',
                   '--load', '50,500', '--plot', str(tmp_path)])  # fmt: skip
    answer = json.loads(capsys.readouterr().out)
    assert status == 0
    assert answer['file'] == name
    assert answer['defect'] == 'none'
    assert answer['statement'] == 'a defect of any width may not show'
    width = answer['quantities']['defect_width_mm']
    assert set(width) == {'q05', 'median', 'q95', 'unit', 'identifiable', 'why'}
    # diagnose makes a picture of another name.
    (picture,) = tmp_path.iterdir()
    assert picture.name.endswith('hitsm_sq_Normal_600.npz.fit.png')
    assert not width['identifiable']
    assert answer['cost_s'] > 0.0
    assert [path.suffix for path in Path(tmp_path).iterdir()] == ['.png']


def test_a_file_that_cannot_be_fitted_is_named(tmp_path, capsys):
    path = tmp_path / 'short.npz'
    np.savez(path, x=np.random.default_rng(0).standard_normal(10), fs=RATE)
    status = main(['fit', str(path), '--bearing', '6205', '--shaft-hz', '15', '--json'])
    assert status == 1
    assert 'shaft turns' in json.loads(capsys.readouterr().out)['error']


@pytest.mark.parametrize(
    ('option', 'value', 'said'),
    [
        ('--load', 'a,b', 'LOW,HIGH'),
        ('--load', '1,2,3', 'LOW,HIGH'),
        ('--seed', '-1', 'from 0 on'),
        ('--temperature', 'nan', 'degC from 20 to 110'),
        ('--temperature', '-300', 'degC from 20 to 110'),
        ('--temperature', '900', 'of a bearing beyond, the nearer end'),
    ],
)
@pytest.mark.parametrize('command', ['fit', 'whatif'])
def test_an_option_that_is_none_is_refused_with_its_limits(command, option, value, said, capsys):
    with pytest.raises(SystemExit):
        main([command, 'none.npz', option, value])
    text = ' '.join(capsys.readouterr().err.split())
    assert repr(value) in text and said in text


def test_a_file_whose_speed_moves_is_refused_as_by_the_node(tmp_path, capsys):
    path = tmp_path / 'ramp.npz'
    np.savez(path, x=NOISE, fs=RATE, shaft_hz=np.linspace(20.0, 25.0, len(NOISE)))
    assert main(['fit', str(path), '--bearing', '6205']) == 1
    assert 'the speed moves from 20 to 25 Hz, more than 2 %' in capsys.readouterr().err


def test_a_picture_that_cannot_be_written_costs_no_fit(tmp_path, capsys):
    path = tmp_path / 'noise.npz'
    np.savez(path, x=0.01 * np.random.default_rng(1).standard_normal(25600), fs=12800.0)
    status = main(['fit', str(path), '--bearing', '6205', '--shaft-hz', '25', '--json',
                   '--place', 'none', '--plot', str(path / 'pictures')])  # fmt: skip
    said = capsys.readouterr()
    assert status == 1 and 'pictures' in said.err
    assert json.loads(said.out)['source'] == f'{path}, x'


def test_a_fit_is_read_on_a_terminal_of_80_columns(tmp_path, capsys):
    path = tmp_path / 'noise.npz'
    np.savez(path, x=0.01 * np.random.default_rng(1).standard_normal(25600), fs=12800.0)
    words = [str(path), '--bearing', '6205', '--shaft-hz', '25', '--place', 'none']
    assert main(['fit', *words]) == 0
    out = capsys.readouterr().out
    # A path has no place to be broken.
    assert max(len(line) for line in out.splitlines() if str(path) not in line) <= 80
    assert 'unit per m/s^2' in out and '-0.0 dB' not in out


@pytest.mark.parametrize('place', ['outer', 'ball'])
def test_a_twin_has_no_defect_of_which_nothing_is_seen(place):
    noise = np.random.default_rng(1).standard_normal(51200)
    found = fit(noise, RATE, BEARING, 20.0, place=place, candidates=64)
    assert found.refusal in (Kind.NO_IMPACTS, Kind.NOT_FITTED)
    assert found.defect == place and found.to_dict()['twin']['defects'] == []
    twin = fitted_vibration(found, 2.0)
    assert twin.std() == pytest.approx(1.0, rel=0.2)
    assert float(((twin - twin.mean()) ** 4).mean() / twin.var() ** 2) < 4.0
