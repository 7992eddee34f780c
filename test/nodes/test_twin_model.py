# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The whole model is set by parameters, and what is set is what runs, is kept and is re-run."""

import dataclasses
from dataclasses import fields, replace
import math
import os

import pytest

pytest.importorskip('rclpy')

from bearing_twin.assets.fleet import read_assets
from bearing_twin.assets.parameters.spec import configuration
from bearing_twin.assets.parameters.twin import build_parameters, SPECS
from bearing_twin.cli import main
from bearing_twin.dynamics import Defect, preset, presets, TwinParameters
from bearing_twin.dynamics.defect_text import defect_places
from bearing_twin.errors import BearingTwinError
from bearing_twin.offline.run import run_offline
from bearing_twin.offline.verify import reproduce
from bearing_twin.quantity import quantities
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.temperature import paper_schedule, write_temperature_recording
from bearing_twin.recording.writer import RecordingWriter
from bearing_twin.thermal.gcr15 import Beta0
from bearing_twin.thermal.lubricant import Lubricant
from bearing_twin.thermal.network import ThermalNetwork
import numpy as np
import yaml

DEFAULTS = {spec.name: spec.default for spec in SPECS}
IMPLIED = {spec.name for spec in SPECS if spec.implied}
MODEL = sorted(IMPLIED - {'geometry', 'defect_profile'})

# A machine of somebody's own, in which no parameter has its default.
OWN = {
    'bearing': '',
    'geometry': '8,6.75,28.5,0',
    'defect': 'inner:width=0.0006,angle=2+outer:depth=2e-5+ball:ball=3,profile=smooth',
    'defect_profile': 'halfsine',
    'thermal_mode': 'physical',
    'slip_model': 'constant',
    'clearance': 8e-6,
    'hertz_stiffness': 6e9,
    'contact_damping': 250.0,
    'inner_mass': 3.0,
    'inner_stiffness': 5e7,
    'inner_damping': 1000.0,
    'outer_mass': 9.0,
    'outer_stiffness': 2e7,
    'outer_damping': 1500.0,
    'outer_stiffness_x': 1.2e7,
    'outer_damping_x': 1300.0,
    'load_angle': -1.2,
    'unbalance': 2e-4,
    'slip': 0.01,
    'start_angle': 0.3,
    'resonance_hz': 4500.0,
    'resonance_damping': 0.05,
    'friction_series': '62',
    'dynamic_rating': 9.5e3,
    'fatigue_limit': 200.0,
    'beta0.expansion': False,
    'beta0.hardness': False,
    'beta0.friction': False,
    'beta0.alpha_unit': 1e-6,
    'beta0.delta_h': 0.2,
    'beta0.delta_mu': 0.01,
    'beta0.reference_temperature': 40.0,
    'beta0.reference_hardness': 65.0,
    'beta0.reference_friction': 0.02,
    'lubricant.viscosity_40': 46e-6,
    'lubricant.viscosity_100': 6.8e-6,
    'lubricant.replenishment': 6e-8,
    'lubricant.boundary_friction': 0.15,
    'lubricant.film_friction': 0.04,
    'lubricant.contamination': 0.3,
    'network.inner_capacity': 40.0,
    'network.ring_to_ring': 1.5,
    'network.ring_to_shaft': 6.0,
    'network.ambient': 25.0,
    'network.shaft_ratio': 1.05,
}


def test_defaults_are_the_preset_and_take_no_room_in_a_checkpoint():
    for name in ('incipient', 'paper', 'mishra2017', 'sawalhi2008'):
        values = DEFAULTS | {'preset': name, 'defect': 'inner'}
        assert build_parameters(values) == preset(name, defect='inner')
        kept = configuration(SPECS, values)
        assert not IMPLIED & set(kept)
        assert build_parameters(kept) == build_parameters(values)
    kept = configuration(SPECS, DEFAULTS | OWN)
    assert kept == DEFAULTS | OWN
    assert build_parameters(kept) == build_parameters(DEFAULTS | OWN)


def test_every_field_of_the_model_is_a_parameter():
    assert set(OWN) >= IMPLIED
    named = set(DEFAULTS)
    # Bearing and defects are built of parameters of other names; the outer ring is measured.
    elsewhere = {'bearing', 'defects', 'beta0', 'lubricant', 'network'}
    assert {f.name for f in fields(TwinParameters)} - elsewhere <= named
    for group, owner in (('beta0', Beta0), ('lubricant', Lubricant), ('network', ThermalNetwork)):
        assert {f'{group}.{f.name}' for f in fields(owner)} <= named


@pytest.mark.parametrize('name', MODEL)
def test_a_parameter_sets_its_field_and_no_other(name):
    base = build_parameters(DEFAULTS)
    got = build_parameters(DEFAULTS | {name: OWN[name]})
    group, _, field = name.rpartition('.')
    if group:
        changed = {group: replace(getattr(base, group), **{field: OWN[name]})}
    else:
        changed = {field: OWN[name]}
    assert got == replace(base, **changed)
    assert got != base


def test_a_value_given_that_is_the_default_of_the_field_holds(monkeypatch):
    heavy = {'outer_mass': 30.0, 'clearance': 10e-6, 'noise': 0.0, 'resonance_hz': 4000.0}
    settings = {'load': 900.0, 'inner_mass': 50.0, 'unbalance': 2.5e-3, **heavy}
    made = dataclasses.replace(presets._PRESETS['incipient'], settings=settings)
    monkeypatch.setitem(presets._PRESETS, 'incipient', made)
    for name in settings:
        default = quantities(TwinParameters)[name][0]
        parameters = build_parameters(DEFAULTS | {'preset': 'incipient', name: default})
        assert getattr(parameters, name) == default, name


def test_what_a_preset_sets_can_be_left_to_it():
    specs = {spec.name: spec for spec in SPECS}
    for name in presets.PRESET_FIELDS:
        assert specs[name].optional, name
        assert 'from the preset' in specs[name].description


def test_defects_of_their_own_sizes_and_places():
    values = DEFAULTS | {'defect': OWN['defect'], 'defect_width': 0.001}
    assert build_parameters(values).defects == (
        Defect(place='inner', width=0.0006, depth=80e-6, angle=2.0),
        Defect(place='outer', width=0.001, depth=2e-5, angle=-math.pi / 2),
        Defect(place='ball', width=0.001, depth=80e-6, ball=3, profile='smooth'),
    )
    # A plus sign in a number joins nothing.
    [one] = build_parameters(DEFAULTS | {'defect': 'inner: width=1e-3, angle=+0.2e+1'}).defects
    assert (one.width, one.angle) == (0.001, 2.0)
    assert defect_places(OWN['defect']) == 'inner+outer+ball'
    assert defect_places('none') == 'none'


@pytest.mark.parametrize(
    ('given', 'said'),
    [
        ({'defect': 'moon:width=0.001'}, "'moon'; choose none or one of inner"),
        ({'defect': 'inner:size=0.001'}, "'size=0.001' is not one of width, depth"),
        ({'defect': 'inner:width=1e-3,width=2e-3'}, 'is not one of .* each once'),
        ({'defect': 'inner:width=1mm'}, r"width='1mm' is not a number \(in m"),
        ({'defect': 'ball:ball=1.5'}, "ball='1.5' is not a whole number"),
        ({'defect': 'ball:ball=8'}, 'balls 0..7'),
        ({'defect': 'inner:angle=nan'}, 'defect angle=nan is outside'),
        ({'defect': 'inner+inner:angle=0.01'}, 'overlap.*move one'),
        ({'defect': 'inner:width=0.02'}, r'width=0.02 is outside .*0.01'),
        ({'bearing': ''}, "geometry='' is not Z,D_BALL_MM"),
        ({'bearing': '', 'geometry': '8,30,28,0'}, 'balls of 30 mm.*need 0.1 mm <= d_ball'),
        ({'bearing': 'ZA-2115'}, 'choose a ball bearing'),
        ({'unbalance': -0.5}, 'unbalance=-0.5 is outside 0..0.025 kg m; choose'),
        ({'unbalance': 0.02}, 'unbalance over inner_mass'),
        ({'inner_mass': 0.05}, 'inner_mass=0.05 is outside 0.1..500 kg'),
        ({'resonance_hz': 100.0}, 'resonance_hz=100.0 is outside 500..11000 Hz'),
        ({'beta0.alpha_unit': 5e-6}, 'choose 1e-5 .* or 1e-6'),
        ({'beta0.delta_mu': 1.0}, 'beta0=.* outside 0.5..1.5.*reduce delta_mu=1.0'),
        ({'slip': 0.05}, 'slip at the highest friction of table 3=0.34'),
        ({'lubricant.viscosity_100': 70e-6}, 'need viscosity_100 < viscosity_40'),
        (
            {'thermal_mode': 'physical', 'network.shaft_ratio': 2.0},
            'change clearance.*shaft_ratio',
        ),
        ({'dynamic_rating': 1.0}, 'dynamic_rating=1.0 is outside 10..1e.08 N'),
    ],
)
def test_what_does_not_fit_is_refused_with_value_limit_and_remedy(given, said):
    with pytest.raises(BearingTwinError, match=said):
        build_parameters(DEFAULTS | given)


def test_an_own_machine_offline_twice_gives_the_same_bytes_and_is_re_run(tmp_path):
    source = tmp_path / 'schedule.mcap'
    write_temperature_recording(source, *paper_schedule(5.0), source='test')
    diagnosis = {'bearing': '', 'geometry': OWN['geometry'], 'window': 2.0}
    for name in ('once', 'again'):
        twin = OWN | {'checkpoint_period': 1.0}
        run_offline(source, tmp_path / name, twin=twin, diagnosis=diagnosis)
    once, again = (
        [(m.topic, m.cdr) for m in read_messages(tmp_path / name)] for name in ('once', 'again')
    )
    assert once == again
    [state, *_] = [m.decode() for m in read_messages(tmp_path / 'once', topics=['/twin_state'])]
    # What is stated has the place that a turned load gives the outer defect.
    placed = OWN['defect'].replace('depth=2e-5', 'depth=2e-5,angle=-1.2')
    assert (state.bearing, state.defect) == (OWN['geometry'], placed)
    checkpoints = list(read_messages(tmp_path / 'once', topics=['/twin_checkpoint']))
    assert len(checkpoints) == 5
    assert OWN.items() <= yaml.safe_load(checkpoints[-1].decode().configuration).items()
    result = reproduce(tmp_path / 'once')
    assert result.identical, result
    assert result.topics['/vibration'].identical == 5 * 25


def test_offline_takes_numbers_as_ros_does_and_refuses_the_rest(tmp_path):
    source = tmp_path / 'schedule.mcap'
    write_temperature_recording(source, [0.0, 0.1], [20.0, 20.0], source='test')
    for given, said in (
        ({'defect_profile': 'square'}, "'square' is not one of ball, rect"),
        ({'lubricant.viscosity_40': '68 cSt'}, 'must be of type float'),
        ({'lubricant.viscosity_40': 68.0}, r'outside 2e-06..0.005 m\^2/s'),
        ({'temperature_timeout': math.nan}, 'outside 0.1..3600 s'),
        ({'load': 5.0}, r'load=5.0 is outside 10..50000 N; choose a value inside \(0: from the'),
        ({'lod': 500.0}, "no parameter 'lod'; the nearest are load,"),
        ({'viscosity_40': 46e-6}, "'viscosity_40'; the nearest are lubricant.viscosity_40,"),
        ({'seed': 1.5}, 'seed=1.5 must be of type int'),
        ({'bearing': 6307.5}, 'bearing=6307.5 must be of type str; quote'),
    ):
        with pytest.raises(BearingTwinError, match=said):
            run_offline(source, tmp_path / 'refused', twin=given)
    taken = {'lubricant.viscosity_40': '46e-6', 'bearing': 6307, 'load': 500}
    run_offline(source, tmp_path / 'text', twin=taken)


def test_a_file_of_assets_takes_nested_tables(tmp_path):
    path = tmp_path / 'fleet.yaml'
    path.write_text("""
        assets:
          pump:
            twin: {defect: inner, beta0: {delta_h: 0.2}, lubricant: {viscosity_40: 4.6e-05}}
        """)
    [pump] = read_assets(str(path), [])
    assert pump.twin == {'defect': 'inner', 'beta0.delta_h': 0.2, 'lubricant.viscosity_40': 46e-6}


@pytest.mark.parametrize(
    ('text', 'said'),
    [
        ('pump: {}\n  fan: {}\n  pump: {}', r'duplicate key pump \(lines 2 and 4\)'),
        ('pump: {twin: {defect: inner, defect: outer}}', r'key defect \(lines 2 and 2\)'),
        ('pümp: {twin: {}}', 'no ROS namespace'),
        ('on: {twin: {}}', 'takes the name of an asset for true: quote it'),
        ('pump: {twin: {sample_rate: 5e3}}', 'sample_rate is one for all twins: give it to the'),
        ('pump: {1: 2, twin: {}}', 'may have twin and diagnosis, not 1'),
        ('pump: {}', 'may have twin and diagnosis, not no table'),
        ('pump: {twin: {note: 2026-13-45}}', 'month must be in 1..12'),
        ('pump: ' + '[' * 3000, 'is no YAML'),
        ('pump: {twin: &twin {beta0: *twin}}', 'a table in twin holds itself'),
    ],
)
def test_no_asset_is_lost_or_taken_by_half(tmp_path, text, said):
    path = tmp_path / 'fleet.yaml'
    path.write_text(f'assets:\n  {text}\n', encoding='utf-8')
    with pytest.raises(BearingTwinError, match=said):
        read_assets(str(path), [])


@pytest.mark.parametrize('name', ['pipe', 'x' * 300, '.', '/dev/zero'])
def test_a_file_of_assets_is_a_file(name, tmp_path):
    os.mkfifo(tmp_path / 'pipe')
    with pytest.raises(BearingTwinError, match=r'no file but a pipe|cannot be read: (Is a|File)'):
        read_assets(str(tmp_path / name), [])


@pytest.mark.parametrize(
    ('given', 'status', 'said'),
    [
        ('load=2026-13-45', 2, "'load=2026-13-45' cannot be read: month must be in 1..12"),
        ('load=' + '[' * 3000, 2, "'load=[[["),
        ('load=1,5', 2, "load='1,5' must be of type float; write a decimal point and no unit"),
        ('seed=5 ', 1, 'is not overwritten'),
        ('defect=', 1, 'is not overwritten'),
    ],
)
def test_a_parameter_of_an_offline_run_is_read_or_refused(given, status, said, tmp_path, capsys):
    source, target = tmp_path / 'schedule.mcap', tmp_path / 'run'
    write_temperature_recording(source, [0.0, 0.1], [20.0, 20.0], source='test')
    target.touch()
    words = ['replay', '--offline', str(source), '-o', str(target), '--twin', given]
    assert main(words) == status
    assert said in capsys.readouterr().err


def test_an_offline_run_takes_one_of_several_temperatures(tmp_path):
    source, times = tmp_path / 'two.mcap', range(3)
    values = {'/bearing/temperature': 80.0, '/ambient/temperature': 22.0}
    for name, degrees in values.items():
        alone = tmp_path / f'{degrees}.mcap'
        write_temperature_recording(
            alone, np.array(times), np.full(3, degrees), source='test', topic=name
        )
    with RecordingWriter(source) as writer:
        messages = [m for d in values.values() for m in read_messages(tmp_path / f'{d}.mcap')]
        for message in sorted(messages, key=lambda m: m.log_time):
            writer.copy(message)
    with pytest.raises(BearingTwinError, match='/ambient/temperature: choose one'):
        run_offline(source, tmp_path / 'both')
    run_offline(source, tmp_path / 'one', temperature='/bearing/temperature')
    states = [m.decode() for m in read_messages(tmp_path / 'one', topics=['/twin_state'])]
    assert {state.temperature_used for state in states[1:]} == {80.0}


def test_an_offline_run_says_once_where_a_limit_is_passed_and_records_it(tmp_path):
    source = tmp_path / 'schedule.mcap'
    write_temperature_recording(source, *paper_schedule(5.0), source='test')
    report = run_offline(source, tmp_path / 'out', twin={'bearing': '6203', 'load': 5000.0})
    assert [text for text in report.warnings if 'half the dynamic rating' in text]
    assert [text for text in report.warnings if 'static rating of 4.8 kN' in text]
    assert len(report.warnings) == len(set(report.warnings)) <= 3
    assert report.warnings[0].startswith('at 0.0 s no life')
    *_, state = [m.decode() for m in read_messages(tmp_path / 'out', topics=['/twin_state'])]
    assert state.limits_passed & state.LIMIT_LIFE_LOAD
    assert state.limits_passed & state.LIMIT_STATIC_LOAD
    assert math.isnan(state.life_hours)
    assert 3e9 < state.contact_pressure < 6e9
