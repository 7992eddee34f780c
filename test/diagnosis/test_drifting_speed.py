# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A shaft whose speed drifts within a record, and orders beside whole numbers of a turn."""

from dataclasses import replace
from itertools import product

from bearing_twin.bearing import fault_orders, find_bearing, PLACES
from bearing_twin.cli import main
from bearing_twin.diagnosis import (
    diagnose_record,
    DiagnosisSettings,
    streaming,
    StreamingDiagnoser,
)
from bearing_twin.diagnosis.chain import Excerpt
from bearing_twin.diagnosis.record import _smeared
from cases import in_proofs
import numpy as np
import pytest


def _drifting(place, drift, seed, order=None, shaft=0.3, strength=0.8, seconds=8):
    """
    Impacts of a 6206, or none, at 24.6 Hz that drift by a share of it.

    Longer signals than 8 s sway by it.
    """
    rng = np.random.default_rng(seed)
    rate, count = 20480.0, seconds * 20480
    times = np.arange(count) / rate
    moves = times / 8.0 - 0.5 if seconds == 8 else 0.5 * np.sin(np.pi * times / 12.0)
    turns = np.cumsum(24.6 * (1.0 + drift * moves)) / rate
    x = rng.standard_normal(count)
    for harmonic in (1, 2, 3, 4):
        x += shaft * np.sin(2.0 * np.pi * harmonic * turns + rng.uniform(0.0, 6.0))
    if place:
        if place == 'coupling':
            order = order or 3.0
        elif order is None:
            order = fault_orders(find_bearing('6206'), 0.01).impacts(place)
        strikes = int(turns[-1] * order) - 2
        gaps = 1.0 + 0.005 * rng.standard_normal(strikes)
        # A part of the shaft keeps time with it.
        turning = place in ('coupling', 'cutter')
        at = (gaps + np.arange(strikes) if turning else np.cumsum(gaps)) / order
        heights = 1.0 + 0.2 * rng.standard_normal(len(at))
        if place == 'cutter':
            heights *= np.resize(np.abs(1.0 + 0.4 * rng.standard_normal(round(order))), strikes)
        if place == 'inner':
            heights *= 1.0 + 0.7 * np.cos(2.0 * np.pi * at)
        impacts = np.zeros(count)
        index = np.searchsorted(turns, at)
        np.add.at(impacts, index[index < count], heights[index < count])
        angle = 2.0 * np.pi * 3500.0 * np.arange(300) / rate
        ringing = np.convolve(impacts, np.exp(-0.04 * angle) * np.sin(angle))[:count]
        x += strength * ringing / ringing.std()
    return x, rate


@pytest.mark.parametrize('place', ['inner', 'outer'])
@pytest.mark.parametrize('drift', [0.05, 0.15])
def test_a_fault_whose_speed_drifts_within_the_record_is_named(place, drift):
    """Its lines smear over the whole record, and not over its parts."""
    for seed in range(2):
        x, rate = _drifting(place, drift, seed)
        said = diagnose_record(x, rate, find_bearing('6206'), 24.6)
        assert (said.result, said.level) == (place, 'fault'), said.reasons
        assert said.sample_count == len(x)


def test_a_weak_fault_whose_speed_drifts_is_no_health():
    """Too weak for an alarm of two parts that agree; and one that begins within the record."""
    for seed in range(3):
        x, rate = _drifting('inner', 0.1, seed, strength=0.26)
        said = diagnose_record(x, rate, find_bearing('6206'), 24.6)
        assert (said.level, said.faults) == ('suspect', ('inner',)), said.reasons
        x, rate = _drifting('outer', 0.1, seed, strength=1.2)
        sound, _ = _drifting('', 0.1, seed)
        x[: int(6.0 * rate)] = sound[: int(6.0 * rate)]
        said = diagnose_record(x, rate, find_bearing('6206'), 24.6)
        assert (said.level, said.faults) == ('suspect', ('outer',)), said.reasons


def _stream(x, rate, **known):
    diagnoser = StreamingDiagnoser(find_bearing('6206'))
    return diagnoser.push(0, x, rate, 24.6, **known)


@pytest.mark.parametrize('place', ['inner', 'outer'])
def test_a_stream_at_a_nominal_speed_looks_at_the_speed_that_moves(place):
    """Without the look no place is named in 40 s."""
    x, rate = _drifting(place, 0.2, 3, strength=0.5, seconds=40)
    said = _stream(x, rate)
    assert (said[-1].level, said[-1].faults) == ('fault', (place,)), said[-1].reasons
    assert any('the speed moves from' in ' '.join(each.reasons) for each in said)
    x, rate = _drifting('', 0.2, 3, seconds=40)
    assert {each.level for each in _stream(x, rate)[8:]} == {'ok'}


def test_few_windows_of_a_stream_are_looked_at_for_a_moving_speed(monkeypatch):
    """None at a measured speed or where sharp lines of the shaft show it."""
    looked = []

    def looks(found, *_):
        looked.append(found)
        return found

    monkeypatch.setattr(streaming, 'at_other_speeds', looks)
    for drift, known in ((0.0, {}), (0.12, {'speed_measured': True})):
        _stream(*_drifting('', drift, 4, seconds=40), **known)
        assert not looked
    _stream(*_drifting('', 0.12, 4, seconds=40))
    assert 0 < len(looked) <= 40 // streaming.LOOK_EVERY


def test_looks_that_ask_for_nothing_become_rarer_and_a_saved_stream_goes_on_with_them():
    """Noise shows no lines of a shaft."""
    x, rate = np.random.default_rng(0).standard_normal(60 * 2560), 2560.0
    settings = DiagnosisSettings(window=4.0, update_interval=0.2)
    whole = StreamingDiagnoser(find_bearing('6206'), settings)
    assert not any(each.level == 'fault' for each in whole.push(0, x, rate, 24.6))
    assert whole._pause == streaming.LOOK_SELDOM
    assert whole._unseen > 2 * streaming.LOOK_EVERY
    other = StreamingDiagnoser(find_bearing('6206'), settings)
    other.load(whole.save())
    assert (other._pause, other._unseen) == (whole._pause, whole._unseen)


def test_windows_that_tell_nothing_are_not_each_looked_at(monkeypatch):
    """Neither after one that asked for a level and got none."""
    looked, rate = [], 2560.0
    settings = DiagnosisSettings(window=4.0, update_interval=0.2)
    diagnoser = StreamingDiagnoser(find_bearing('6206'), settings)

    def looks(found, *_):
        looked.append(found)
        return replace(found, level='fault' if len(looked) == 1 else 'none')

    monkeypatch.setattr(streaming, 'at_other_speeds', looks)
    noise = np.random.default_rng(0).standard_normal(14 * 2560)
    assert {each.level for each in diagnoser.push(0, noise, rate, 24.6)} == {'none', 'ok'}
    assert 1 < len(looked) <= 5


def test_a_sound_machine_whose_speed_drifts_has_no_alarm():
    for seed in range(4):
        x, rate = _drifting('', 0.15, seed)
        assert diagnose_record(x, rate, find_bearing('6206'), 24.6).level == 'ok'


@pytest.mark.parametrize('name', ['6307', '6203'])
def test_three_impacts_a_turn_of_a_shaft_that_drifts_are_no_fault_beside_order_three(name):
    for seed in range(3):
        x, rate = _drifting('coupling', 0.2, seed)
        said = diagnose_record(x, rate, find_bearing(name), 24.6)
        assert said.level == 'suspect', said.reasons


BESIDE = ((2, '6404'), (3, '6307'), (3, '6203'), (4, '6301'), (5, '6203'), (8, '6010'))
"""Whole numbers, and a bearing that has the order of a race within 2.5 % of each."""


@pytest.mark.parametrize('drift', [0.0, 0.03, *in_proofs(0.06)])
@pytest.mark.parametrize('shaft', [0.3, *in_proofs(0.0)])
def test_impacts_a_whole_number_of_times_a_turn_name_no_race_beside_it(drift, shaft):
    """At a nameplate speed that is off by up to 1 %, with and without lines of the shaft."""
    named = []
    for seed, ((turns, name), off) in enumerate(product(BESIDE, (-0.004, 0.002, 0.01))):
        x, rate = _drifting('coupling', drift, seed, float(turns), shaft)
        said = diagnose_record(x, rate, find_bearing(name), 24.6 * (1.0 + off))
        if said.level == 'fault' and said.result in PLACES:
            named.append((turns, name, off, said.reasons))
    assert len(named) <= 1, named


@pytest.mark.parametrize('turns', [3, 5])
def test_impacts_a_whole_number_of_times_a_turn_are_no_alarm_at_a_speed_that_moves_a_little(turns):
    """The lines of the shaft are sharp, or its speed is measured; line five smears farther."""
    given = (1.0, {'speed_tolerance': 0.002}), (0.995, {})
    for seed, (drift, (off, known)) in enumerate(product((0.003, 0.006, 0.01), given)):
        x, rate = _drifting('coupling', drift, seed, float(turns))
        said = diagnose_record(x, rate, find_bearing('6203'), 24.6 * off, **known)
        assert said.level == 'suspect', (drift, off, said.reasons)


@pytest.mark.parametrize('place', ['inner', 'outer'])
def test_a_race_beside_a_whole_order_keeps_its_name_at_a_speed_that_moves_a_little(place):
    order = fault_orders(find_bearing('6203'), 0.005).impacts(place)
    for seed, drift in enumerate((0.003, 0.006, 0.01)):
        x, rate = _drifting(place, drift, seed, order)
        known = {'speed_tolerance': 0.002}
        said = diagnose_record(x, rate, find_bearing('6203'), 24.6, **known)
        assert (said.result, said.level) == (place, 'fault'), (drift, said.reasons)


def test_a_short_window_that_parts_no_slip_from_a_whole_order_keeps_the_alarm():
    """In 49 turns each outer race of a 6203 is within some bins of order three."""
    for seed, slip in enumerate((0.01, 0.015, 0.02)):
        order = fault_orders(find_bearing('6203'), slip).bpfo
        x, rate = _drifting('outer', 0.0, seed, order)
        known = {'speed_tolerance': 0.002}
        said = diagnose_record(x[: 2 * int(rate)], rate, find_bearing('6203'), 24.6, **known)
        assert (said.level, said.faults) == ('fault', ('outer',)), (slip, said.reasons)


@pytest.mark.parametrize('name', ['6307', '6203'])
def test_a_race_beside_a_whole_order_is_named_where_the_shaft_shows(name):
    """The lines of the shaft tell the speed, and with it that the order is no whole number."""
    for seed, off in enumerate((-0.004, 0.0, 0.002, 0.01)):
        for place in ('inner', 'outer'):
            order = fault_orders(find_bearing(name)).impacts(place)
            x, rate = _drifting(place, 0.0, seed, order)
            said = diagnose_record(x, rate, find_bearing(name), 24.6 * (1.0 + off))
            assert (said.result, said.level) == (place, 'fault'), said.reasons


def test_only_records_whose_lines_may_have_smeared_are_looked_at_in_parts():
    """So a steady sound machine costs no more than one look."""
    bearing = find_bearing('6206')

    def asked(place, drift, seed):
        x, rate = _drifting(place, drift, seed)
        return _smeared(Excerpt.of(x, 24.6, rate, bearing, DiagnosisSettings()).analyse())

    assert not any(asked('', 0.0, seed) for seed in range(4))
    assert all(asked(place, 0.05, seed) for place in ('inner', 'outer') for seed in range(2))


@pytest.mark.parametrize('name', ['6203', '6312'])
@pytest.mark.parametrize('drift', [0.0, 0.002])
def test_edges_of_a_cutter_are_no_inner_race_at_a_speed_that_is_measured_within_its_tolerance(
    name, drift
):
    """Five edges of unequal height strike at 5 turns, where the inner races of eight balls lie."""
    named = []
    for seed, off in product(range(3), (-0.001, 0.0, 0.001)):
        x, rate = _drifting('cutter', drift, seed, 5.0, 0.0, 1.0)
        known = {'speed_tolerance': 0.002}
        said = diagnose_record(x, rate, find_bearing(name), 24.6 * (1.0 + off), **known)
        if said.level == 'fault':
            named.append((seed, off, said.reasons))
    # Edges of nearly equal height have no lines that tell.
    assert len(named) <= 3, named


def test_one_part_of_a_record_whose_speed_moves_far_names_no_place():
    """At a speed 11 % lower the order of an inner race is that of a ball."""
    for seed in range(2):
        x, rate = _drifting('inner', 0.3, seed, shaft=0.0)
        said = diagnose_record(x, rate, find_bearing('6206'), 24.6)
        assert (said.result, said.level) == ('suspect', 'suspect'), said.reasons
        assert 'place is not sure' in said.reasons[-1]


def _run(place, profile, seed, shaft=0.1, strength=0.7):
    """10 s of a 6206 whose speed starts up, coasts down or sways about 30 Hz."""
    rng = np.random.default_rng(seed)
    rate, count = 20480.0, 10 * 20480
    times = np.arange(count) / rate
    speeds = {
        'start': 30.0 * (0.3 + 0.7 * np.minimum(times / 8.0, 1.0)),
        'coast': 48.0 * (1.0 - 0.075 * times),
        'sway': 30.0 * (1.0 + 0.03 * np.sin(2.0 * np.pi * times / 3.0)),
    }[profile]
    turns = np.cumsum(speeds) / rate
    x = rng.standard_normal(count)
    for harmonic in (1, 2, 3):
        x += shaft * np.sin(2.0 * np.pi * harmonic * turns + rng.uniform(0.0, 6.0))
    order = {'': 0.0, 'coupling': 3.0}.get(place)
    if order is None:
        order = fault_orders(find_bearing('6206'), 0.01).impacts(place)
    if order:
        at = np.searchsorted(turns, np.arange(1, int(turns[-1] * order)) / order)
        impacts = np.zeros(count)
        load = 1.0 + 0.7 * np.cos(2.0 * np.pi * turns[at]) if place == 'inner' else 1.0
        impacts[at] = load * (speeds[at] / 30.0) * (1.0 + 0.2 * rng.standard_normal(len(at)))
        angle = 2.0 * np.pi * 3500.0 * np.arange(300) / rate
        ringing = np.convolve(impacts, np.exp(-0.04 * angle) * np.sin(angle))[:count]
        x += strength * ringing / ringing.std()
    return x, rate


@pytest.mark.parametrize('place', ['inner', 'outer'])
@pytest.mark.parametrize('profile', ['start', 'coast', 'sway'])
def test_a_fault_is_named_while_the_shaft_starts_coasts_or_sways(profile, place):
    """One speed is given, that of the nameplate or the mean; the lines of the shaft tell it."""
    for seed in range(2):
        x, rate = _run(place, profile, seed)
        said = diagnose_record(x, rate, find_bearing('6206'), 30.0)
        assert (said.result, said.level) == (place, 'fault'), said.reasons
        assert 'the speed moves' in said.reasons[-1]
        assert said.shaft_hz_given == 30.0
        assert said.sample_count == len(x)


def test_the_mean_of_a_speed_that_moves_is_not_called_refined(tmp_path, capsys):
    x, rate = _run('inner', 'start', 0)
    np.savez(tmp_path / 'start.npz', x=x, fs=rate, rpm=1800.0)
    main(['diagnose', str(tmp_path / 'start.npz'), '--bearing', '6206'])
    assert 'Speed given  30 Hz; used: -27.94 %, by lines of the shaft' in capsys.readouterr().out


@pytest.mark.parametrize('profile', ['start', 'coast', 'sway'])
def test_a_sound_machine_that_starts_coasts_or_sways_is_no_alarm(profile):
    for seed in range(4):
        x, rate = _run('', profile, seed)
        assert diagnose_record(x, rate, find_bearing('6206'), 30.0).level == 'ok'


@pytest.mark.parametrize('profile', ['start', 'coast'])
@pytest.mark.parametrize('name', ['6307', '6203'])
def test_a_coupling_that_starts_or_coasts_is_no_race_beside_its_order(profile, name):
    for seed in range(3):
        x, rate = _run('coupling', profile, seed)
        said = diagnose_record(x, rate, find_bearing(name), 30.0)
        assert said.level == 'suspect' or said.result == 'ambiguous', said.reasons
