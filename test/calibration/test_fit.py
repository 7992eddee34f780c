# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The twin fitted to machines whose truth is known: closed forms, twins, impacts, real slots."""

from dataclasses import replace
import json
import math
from pathlib import Path

from bearing_twin.bearing import Bearing, fault_frequencies, find_bearing
from bearing_twin.calibration import Calibration, cloud, fit
from bearing_twin.calibration.cloud import parameters, Situation, unknowns, vibrations
from bearing_twin.calibration.estimates import of_defect, taken_off
from bearing_twin.calibration.fit import fitted_vibration
from bearing_twin.calibration.healthy import comb, LOSS_DB, shown, smallest_shown
from bearing_twin.calibration.impacts import follows_speed, gear, Impacts, impacts_of
from bearing_twin.calibration.joint import compared, joined
from bearing_twin.calibration.passage import (
    contact_speed,
    impact_spacing,
    interference,
    load_range,
    path_curvature,
    widest,
)
from bearing_twin.calibration.path import identify, noise_floor, resonances
from bearing_twin.calibration.posterior import limit
from bearing_twin.calibration.refusals import Kind, no_impacts, unresolved
from bearing_twin.calibration.summaries import correlate, summarise
from bearing_twin.calibration.whatif import expect, features
from bearing_twin.cli import main
from bearing_twin.dynamics import preset, Simulator, TwinParameters
from bearing_twin.dynamics.coefficients import (
    CLEARANCE,
    CONDITION_SIZE,
    constants_of,
    evaluate,
    THERMAL_GAP,
)
from bearing_twin.dynamics.sensor_path import band_levels, distance, SensorPath
from bearing_twin.errors import BearingTwinError
from bearing_twin.thermal.network import ThermalNetwork
import numpy as np
import pytest
from scipy import signal

BEARING = find_bearing('6205')
RATE = 25600.0
NOISE = np.random.default_rng(0).standard_normal(51200)


def ring(x):
    """Let resonances at 3 and 7 kHz ring."""
    out = np.zeros_like(x)
    for hz, damping in ((3000.0, 0.03), (7000.0, 0.02)):
        pole = np.exp(2.0 * np.pi * hz / RATE * (-damping + 1j))
        out += signal.lfilter([1.0], np.poly([pole, pole.conjugate()]).real, x)
    return out


def impact_train(
    width, place, shaft_hz, seconds=4.0, seed=0, shortfall=0.0, noise=0.02, heights=(0.6, -1.0)
):
    """
    Machine that shares nothing with the twin: two impacts a passage that ring at 3 and 7 kHz.

    They are as far apart as the slot is wide, less ``shortfall``, both m.
    """
    rng = np.random.default_rng(seed)
    rate = fault_frequencies(BEARING, shaft_hz).impacts(place)
    gaps = (1.0 + 0.004 * rng.standard_normal(int(1.2 * rate * seconds))) / rate
    entries = np.cumsum(gaps)
    apart = (width - shortfall) / contact_speed(BEARING, place, shaft_hz)
    x = np.zeros(int(seconds * RATE))
    for times, height in zip((entries, entries + apart), heights, strict=True):
        at = np.round(times[times < seconds - 1.0 / RATE] * RATE).astype(int)
        np.add.at(x, at, height * (1.0 + 0.2 * rng.standard_normal(len(at))))
    ringing = ring(x)
    return ringing + noise * ringing.std() * rng.standard_normal(len(x))


def twin(seconds=2.0, shaft_hz=20.0, seed=3, **options):
    """Vibration of a twin that the fit is not told."""
    parameters = preset('incipient', bearing=BEARING, **options)
    simulator = Simulator(parameters, sample_rate=RATE, seed=seed, shaft_hz=shaft_hz)
    simulator.advance(int(0.3 * RATE), 30.0, shaft_hz)
    return simulator.advance(int(seconds * RATE), 30.0, shaft_hz).y.astype(float)


def test_sinking_is_the_path_of_a_ball_over_an_edge():
    """The centre of a ball on an edge moves on a circle about it; the law is its parabola."""
    for place, sign in (('inner', 1.0), ('outer', -1.0)):
        race = 0.5 * (BEARING.d_pitch - sign * BEARING.d_ball)
        radius = 0.5 * BEARING.d_ball
        s = 1e-4
        # Edge of the slot at angle zero of the race; the ball has rolled past it by s.
        angle = s / race
        centre = race + sign * radius
        # The distance from the edge stays the ball's radius.
        along = race * math.cos(angle)
        across = race * math.sin(angle)
        root = math.sqrt(radius**2 - across**2)
        now = along + sign * root
        assert abs(now - centre) == pytest.approx(path_curvature(BEARING, place) * s * s, rel=1e-3)


def test_spacing_is_short_of_the_slot_by_what_the_interference_asks_for():
    load, width = 200.0, 2e-3
    sinking = interference(BEARING, load)
    for place in ('inner', 'outer'):
        curvature = path_curvature(BEARING, place)
        apart = impact_spacing(width, sinking, curvature)
        edge = 0.5 * (width - apart)
        assert curvature * edge**2 == pytest.approx(sinking)
    assert impact_spacing(1e-4, sinking, path_curvature(BEARING, 'outer')) == 0.0


def test_contact_speed_times_passages_goes_round_the_race():
    rates = fault_frequencies(BEARING, 20.0)
    outer = math.pi * (BEARING.d_pitch + BEARING.d_ball)
    assert contact_speed(BEARING, 'outer', 20.0) == pytest.approx(
        outer * rates.bpfo / BEARING.n_balls
    )
    inner = math.pi * (BEARING.d_pitch - BEARING.d_ball)
    assert contact_speed(BEARING, 'inner', 20.0) == pytest.approx(
        inner * rates.bpfi / BEARING.n_balls
    )


@pytest.mark.parametrize('place', ['inner', 'outer'])
def test_spacing_of_an_impact_train_is_read_whatever_rings(place):
    for width in (0.8e-3, 1.6e-3, 3.0e-3):
        x = impact_train(width, place, 12.0)
        speed = contact_speed(BEARING, place, 12.0)
        found = summarise(x, RATE, 1.1 * widest(BEARING) / speed)
        assert found.spacing * speed == pytest.approx(width, rel=0.05)
        louder = summarise(1e3 * x + 5.0, RATE, 1.1 * widest(BEARING) / speed)
        assert louder.spacing == pytest.approx(found.spacing, rel=1e-6)


def test_noise_shows_no_spacing():
    seen = 0
    for seed in range(20):
        x = np.random.default_rng(seed).standard_normal(51200)
        seen += summarise(x, RATE, 5e-3).seen
    assert seen <= 1


def test_twin_through_its_path_passes_for_the_machine():
    machine = impact_train(1e-3, 'outer', 20.0, seed=5)
    model = twin(defect='outer', noise=0.0, resonance_hz=0.0)
    path = identify(machine, RATE, model, 0.05)
    fitted = path.filter().apply(model)[2560:]
    assert distance(band_levels(machine, RATE), band_levels(fitted, RATE)) < 2.0
    assert 20.0 * math.log10(fitted.std() / machine.std()) == pytest.approx(0.0, abs=0.5)


def test_a_path_in_blocks_is_the_path_in_one():
    path = identify(impact_train(1e-3, 'outer', 20.0), RATE, twin(noise=0.0), 0.05)
    again = SensorPath.from_dict(json.loads(json.dumps(path.to_dict())))
    x = np.random.default_rng(2).standard_normal(3000)
    whole = path.filter(seed=4).apply(x)
    running = again.filter(seed=4)
    parts = np.concatenate([running.apply(part) for part in np.split(x, [1000, 1700])])
    assert np.array_equal(whole, parts)


def test_resonances_are_found():
    found = resonances(ring(np.random.default_rng(1).standard_normal(102400)), RATE)
    near = {round(mode.hz, -2): mode for mode in found[:2]}
    for hz, damping in ((3000.0, 0.03), (7000.0, 0.02)):
        assert near[hz].damping == pytest.approx(damping, rel=0.15)


@pytest.mark.parametrize(
    ('change', 'text'),
    [
        ({'samples': np.full(51200, np.nan)}, 'NaN'),
        ({'samples': np.zeros((2, 51200))}, '1-D'),
        ({'samples': np.ones(51200)}, 'constant'),
        ({'samples': np.clip(NOISE, -0.5, 0.5), 'place': 'outer'}, 'is clipped'),
        ({'samples': NOISE[:5000]}, 'shaft turns'),
        ({'sample_rate': 0.0}, 'sample rate'),
        ({'sample_rate': 800.0}, 'sample rate'),
        ({'shaft_hz': math.nan}, 'shaft speed'),
        ({'load': (500.0, 100.0)}, 'in that order'),
        ({'bearing': find_bearing('ZA-2115')}, 'to fit, choose a ball bearing'),
        ({'place': 'shaft'}, 'place'),
    ],
)
def test_bad_input_is_refused_in_words(change, text):
    values = {
        'samples': NOISE,
        'sample_rate': RATE,
        'bearing': BEARING,
        'shaft_hz': 20.0,
    } | change
    with pytest.raises(BearingTwinError, match=text):
        fit(**values)


def test_loads_without_a_range_are_shares_of_the_rating():
    low, high = load_range(BEARING)
    assert (low, high) == pytest.approx((42.0, 1400.0), rel=0.01)
    assert load_range(BEARING, (100.0, 200.0)) == (100.0, 200.0)


@pytest.fixture(scope='module')
def slot(data_dir):
    with np.load(data_dir / 'hitsm' / 'hitsm_sq_IR8_900.npz') as file:
        return file['x'].astype(float), float(file['fs'])


def test_a_real_slot_is_measured(slot, data_dir):
    """HIT-SM, inner race, 8 degrees of a radius of 15.55 mm: 2.17 mm."""
    found = fit(*slot, BEARING, 15.0, candidates=192)
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


def test_spots_of_half_a_millimetre_on_a_fast_shaft_are_not_measured(data_dir):
    """CWRU: the passage lasts one to five samples."""
    for name in ('cwru_0105_DE', 'cwru_0258_DE'):
        with np.load(data_dir / 'cwru' / f'{name}.npz') as file:
            x, rate, hz = file['x'].astype(float), float(file['fs']), float(file['rpm']) / 60.0
        found = fit(x, rate, BEARING, hz, candidates=64)
        width = found.quantities['defect_width_mm']
        assert found.defect in ('inner', 'outer')
        assert not width.identifiable
        assert width.q95 - width.q05 > width.median


def test_ringing_at_two_speeds_is_no_width():
    """The same time between impacts at another speed: not a passage."""
    apart = 2e-3 / contact_speed(BEARING, 'outer', 12.0)
    slow = impact_train(apart * contact_speed(BEARING, 'outer', 10.0), 'outer', 10.0)
    both = [
        fit(x, RATE, BEARING, hz, place='outer', candidates=64)
        for x, hz in ((impact_train(2e-3, 'outer', 12.0), 12.0), (slow, 10.0))
    ]
    assert both[0].impacts.spacing_s == pytest.approx(apart, rel=0.02)
    told = {'q05': 1.0, 'median': 2.0, 'q95': 3.0, 'identifiable': True}
    both = [
        replace(found, quantities={'defect_width_mm': replace(
            found.quantities['defect_width_mm'], **told)})
        for found in both
    ]  # fmt: skip
    alone = compared(both[1], [])
    assert alone is both[1]
    _, width, statement = joined(both)
    assert not width.identifiable and 'does not follow the speed' in width.why
    assert 'width not told: a second impact is ringing' in statement
    # The other edge may be anywhere: as far away as the next ball.
    assert width.q95 == pytest.approx(math.pi * (39.04 + 7.94) / 9, rel=1e-3)
    other = Impacts('outer', 12.0, apart, 1e-4)
    assert compared(both[1], [other]).refusal is Kind.SAME_AT_ANOTHER_SPEED
    # A time that follows the speed is a passage, and both records tell one width.
    seen = both[1].impacts
    moved = replace(both[1], impacts=seen._replace(spacing_s=seen.spacing_s * 1.2))
    found, width, _ = joined([both[0], moved])
    assert width.why == '2 of 2 records tell it' and len(found) == 2
    # No record alone says that it is wider than that.
    assert width.q05 <= told['q05'] < width.median < width.q95
    with pytest.raises(BearingTwinError, match='not of one defect'):
        joined([both[0], replace(moved, situation=replace(moved.situation, place='inner'))])


def test_two_pits_are_no_entry_and_exit():
    """Their impacts are alike; that they are as far apart at each speed proves no passage."""
    pits = [
        fit(impact_train(2e-3, 'outer', hz, heights=(0.6, 1.0)), RATE, BEARING, hz,
            place='outer', candidates=64)
        for hz in (10.0, 14.0)
    ]  # fmt: skip
    records, width, _ = joined(pits)
    assert {each.refusal for each in (*pits, *records)} == {Kind.ALIKE}
    assert not width.identifiable and 'second pit or an echo' in width.why
    assert width.q95 > 2.0


def seen_at(x, shaft_hz, place='outer'):
    """Return the two impacts of a passage that a record shows."""
    machine = Situation(bearing=BEARING, place=place, shaft_hz=shaft_hz, sample_rate=RATE)
    whole = correlate(x, RATE)
    return impacts_of(whole, whole.summary(machine.longest), machine)


def test_impacts_as_far_apart_on_the_race_at_two_speeds_are_a_passage():
    """Whatever made each record alone doubtful; ringing and the teeth of a gear are none."""
    speeds = (10.0, 14.0)
    both = [
        fit(impact_train(2e-3, 'outer', hz), RATE, BEARING, hz, place='outer', candidates=64)
        for hz in speeds
    ]
    doubtful = [
        replace(found, refusal=Kind.MANY_WIDTHS, quantities=found.quantities | {
            'defect_width_mm': replace(found.quantities['defect_width_mm'], identifiable=False)})
        for found in both
    ]  # fmt: skip
    records, width, statement = joined(doubtful)
    assert width.identifiable and all(each.refusal is None for each in records)
    assert statement.startswith('outer race defect, ')
    # The edges themselves strike here: the truth is near the lower bound.
    assert width.q05 < 2.0 < width.median < width.q95
    assert 'and as far at 14.0 Hz: a passage' in records[0].quantities['defect_width_mm'].why
    # Where the part that is named does not strike, no other record makes it.
    silent = replace(doubtful[0], refusal=Kind.NO_IMPACTS)
    assert compared(silent, [both[1].impacts]) is silent


def test_neither_echoes_nor_gears_are_a_passage():
    time = 2e-3 / contact_speed(BEARING, 'outer', 12.0)
    echoes = [
        seen_at(impact_train(time * contact_speed(BEARING, 'outer', hz), 'outer', hz), hz)
        for hz in (9.0, 13.0)
    ]
    assert echoes[0].told_apart(echoes[1]) and not follows_speed(echoes[0], echoes[1:])
    gears = []
    for hz in (12.0, 18.0):
        # A narrow spot is hidden; a gear of 22 teeth strikes in step with the shaft.
        x = impact_train(0.2e-3, 'outer', hz, noise=0.0)
        teeth = np.zeros(len(x))
        teeth[np.round(np.arange(0.0, 3.9, 1.0 / (22.0 * hz)) * RATE).astype(int)] = 0.7
        gears.append(seen_at(x + ring(teeth), hz))
    assert all(gear.turn == pytest.approx(1.0 / 22.0, rel=0.02) for gear in gears)
    assert not follows_speed(gears[0], gears[1:])


@pytest.mark.parametrize(('name', 'degrees'), [('OR2', 2.0), ('OR5', 5.0), ('OR8', 8.0)])
def test_real_slots_on_the_outer_race_follow_the_speed(name, degrees, data_dir):
    """HIT-SM: what the ball's path takes off is between none and what 95 % of loads do."""
    seen, machines = [], []
    for rpm in (600, 1200):
        with np.load(data_dir / 'hitsm' / f'hitsm_sq_{name}_{rpm}.npz') as file:
            x, rate = file['x'].astype(float), float(file['fs'])
        machines.append(Situation(bearing=BEARING, place='outer', shaft_hz=rpm / 60.0,
                                  sample_rate=rate))  # fmt: skip
        whole = correlate(x - x.mean(), rate)
        seen.append(impacts_of(whole, whole.summary(machines[-1].longest), machines[-1]))
    assert follows_speed(seen[0], seen[1:]) == (seen[1],)
    apart = seen[0].spacing_s * machines[0].speed
    truth = math.radians(degrees) * 23.5e-3
    assert apart < truth < apart + taken_off(machines[0], 0.95)


def test_the_lower_bound_holds_where_the_impacts_are_those_of_the_edges():
    """The twin takes the path of a ball off, which a train of impacts does not have."""
    found = fit(impact_train(2e-3, 'inner', 12.0), RATE, BEARING, 12.0, place='inner')
    width = found.quantities['defect_width_mm']
    assert width.identifiable, width.why
    assert width.q05 < 2.0 < width.q95


def test_a_slot_wider_than_is_simulated_is_said_to_be():
    assert 1e3 * widest(BEARING) < 6.0
    found = fit(impact_train(6e-3, 'outer', 12.0), RATE, BEARING, 12.0, place='outer',
                candidates=64)  # fmt: skip
    width = found.quantities['defect_width_mm']
    assert found.refusal is Kind.TOO_WIDE and not width.identifiable
    assert 'are 6.0 mm apart' in width.why
    assert width.q95 == pytest.approx(math.pi * (39.04 + 7.94) / 9, rel=1e-3)
    # Two records together bound it no closer than each alone.
    assert joined([found, found])[1].q95 == width.q95


@pytest.mark.parametrize(('place', 'shaft_hz'), [('outer', 12.0), ('inner', 13.0)])
def test_impacts_of_another_part_or_speed_are_no_width(place, shaft_hz):
    x = impact_train(2e-3, 'inner', 12.0)
    found = fit(x, RATE, BEARING, shaft_hz, place=place, candidates=64)
    width = found.quantities['defect_width_mm']
    assert found.refusal is Kind.NO_IMPACTS and not width.identifiable
    assert f'of the {place} race stand out: check bearing, speed and place' in width.why
    assert found.statement.startswith('no width: no impacts at')
    # A part that does not strike says nothing of a width, nor that it is one that is simulated.
    machine = replace(cloud.example(place), shaft_hz=shaft_hz)
    assert width.q95 == pytest.approx(1e3 * machine.speed / machine.strikes)
    assert joined([found, found])[2] == found.statement


@pytest.mark.parametrize(('rate', 'shaft_hz'), [(0.5 * RATE, 12.0), (RATE, 24.0)])
@pytest.mark.parametrize('place', ['inner', 'outer'])
def test_a_rate_or_a_speed_that_is_twice_off_is_no_width(place, rate, shaft_hz):
    """The second harmonic lies where the part would strike, and the width would be too wide."""
    x = impact_train(2e-3, place, 12.0)
    found = fit(x, rate, BEARING, shaft_hz, place=place, candidates=64)
    assert (
        found.refusal is Kind.NO_IMPACTS and not found.quantities['defect_width_mm'].identifiable
    )
    assert found.statement.endswith('race: check speed and sample rate')


def test_a_record_that_may_have_a_defect_is_not_made_healthy_by_another():
    noise = 0.01 * np.random.default_rng(1).standard_normal(25600)
    healthy = fit(noise, 12800.0, BEARING, 25.0, unit='m/s^2', place='none')
    assert healthy.refusal is None and json.loads(json.dumps(healthy.to_dict()))['refusal'] is None
    width = healthy.quantities['defect_width_mm']
    suspect = replace(
        healthy,
        refusal=Kind.NO_PART,
        statement='no width: the diagnosis says suspect',
        quantities=healthy.quantities | {'defect_width_mm': replace(width, q95=4.0)},
    )
    assert Calibration.from_dict(suspect.to_dict()).refusal is Kind.NO_PART
    for both in ([healthy, suspect], [suspect, healthy]):
        assert joined(both)[1:] == (suspect.quantities['defect_width_mm'], suspect.statement)


@pytest.mark.parametrize('shaft_hz', [10.0, 25.4])
def test_a_part_that_strikes_at_a_multiple_of_the_shaft_is_seen(shaft_hz):
    """The outer race of a 6307 strikes 3.026 times a turn, where the shaft has a line."""
    machine = Situation(
        bearing=find_bearing('6307'), place='outer', shaft_hz=shaft_hz, sample_rate=12800.0
    )
    x = np.random.default_rng(1).standard_normal(38400)
    times = np.arange(0.0, 3.0, 1.008 / machine.strikes)
    x[np.round(12800.0 * times).astype(int)] += 12.0
    assert not no_impacts(x, machine)


def swelling(seed, rate=12800.0, seconds=6.0, shaft_hz=25.0, depth=0.15):
    """Noise that swells with orders 1 to 6 of the shaft: a healthy machine."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(seconds * rate)) / rate
    turning = [np.cos(2.0 * np.pi * (k * shaft_hz * t + rng.random())) for k in range(1, 7)]
    return (1.0 + depth * sum(turning)) * rng.standard_normal(len(t))


def test_orders_of_the_shaft_are_no_impacts_of_an_outer_race():
    """That of a 6307 strikes 3.026 times a turn."""
    machine = Situation(
        bearing=find_bearing('6307'), place='outer', shaft_hz=25.0, sample_rate=12800.0
    )
    for seed in range(10):
        x = swelling(seed)
        refusal = no_impacts(x, machine)
        assert refusal.kind is Kind.NO_IMPACTS
        assert refusal.why.endswith(
            'the line there is order 3 of the shaft, and the orders beside it are about as high'
        )
        # A speed that is known to a few thousandths only changes nothing.
        assert no_impacts(swelling(seed, shaft_hz=25.08), machine)
        # A part that strikes between them is seen.
        rate = machine.strikes
        gaps = (1.0 + 0.002 * np.random.default_rng(seed).standard_normal(400)) / rate
        x[np.round(12800.0 * np.cumsum(gaps)).astype(int)] += 8.0
        assert no_impacts(x, machine) is None
    found = fit(swelling(0), 12800.0, machine.bearing, 25.0, place='outer', candidates=64)
    assert found.statement.startswith('no width: no impacts at the')


@pytest.mark.parametrize('name', ['6203', '6313', '6220', '7218B'])
def test_every_candidate_of_a_bearing_can_be_simulated(name):
    """Large bearings lose more clearance when hot; half of their balls is over 10 mm."""
    bearing = find_bearing(name)
    for place in ('inner', 'outer', 'none'):
        machine = Situation(bearing=bearing, place=place, shaft_hz=10.0, sample_rate=12800.0)
        prior = unknowns(machine)
        for share in (0.0, 0.5, 1.0):
            parameters(machine, {name: float(about.place(share)) for name, about in prior.items()})


def test_the_contact_angle_is_that_of_the_twin():
    """A ball of 40 degrees rolls where the fault frequencies have it."""
    bearing = find_bearing('7218B')
    rates = fault_frequencies(bearing, 10.0)
    track = bearing.d_pitch + bearing.d_ball * math.cos(bearing.contact_angle)
    assert contact_speed(bearing, 'outer', 10.0) == pytest.approx(math.pi * track * rates.ftf)


def test_volts_are_no_known_acceleration():
    noise = np.random.default_rng(1).standard_normal(25600)
    for unit, known in (('V', False), ('g', True)):
        width = fit(noise, 12800.0, BEARING, 25.0, unit=unit, place='none').quantities[
            'defect_width_mm'
        ]
        assert ('the unit is not known' in width.why) is not known


def test_the_floor_of_a_sensor_is_found():
    """The quietest frequencies of the same samples would be the luckiest."""
    held, medians = 0, []
    for seed in range(60):
        noise = np.random.default_rng(seed).standard_normal(51200)
        low, median, high = noise_floor(noise, RATE)
        held += low < math.sqrt(2.0 / RATE) < high
        medians.append(median)
    assert held >= 48
    assert np.mean(medians) == pytest.approx(math.sqrt(2.0 / RATE), rel=1e-2)


def test_the_command_writes_what_it_found(slot, tmp_path, capsys, data_dir):
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
    assert not width['identifiable']
    assert answer['cost_s'] > 0.0
    assert [path.suffix for path in Path(tmp_path).iterdir()] == ['.png']


def test_files_of_one_machine_at_two_speeds_give_one_width(data_dir, capsys):
    names = [str(data_dir / 'hitsm' / f'hitsm_sq_IR8_{rpm}.npz') for rpm in (600, 900)]
    words = ['fit', *names, '--bearing', '6205', '--place', 'inner', '--one-machine']
    assert main([*words, '--json']) == 0
    *records, together = map(json.loads, capsys.readouterr().out.splitlines())
    assert [row['file'] for row in records] == together['files'] == names
    widths = [row['quantities']['defect_width_mm'] for row in [*records, together]]
    # An arc of 8 degrees on the race.
    truth = math.radians(8.0) * 15.55
    assert all(width['identifiable'] for width in widths)
    assert all(width['q05'] < truth < width['q95'] for width in widths)
    assert widths[-1]['why'] == '2 of 2 records tell it'


def test_a_file_that_cannot_be_fitted_is_named(tmp_path, capsys):
    path = tmp_path / 'short.npz'
    np.savez(path, x=np.random.default_rng(0).standard_normal(10), fs=RATE)
    status = main(['fit', str(path), '--bearing', '6205', '--shaft-hz', '15', '--json'])
    assert status == 1
    assert 'shaft turns' in json.loads(capsys.readouterr().out)['error']


def test_one_speed_predicts_another(slot, data_dir, tmp_path, capsys):
    """HIT-SM, fitted at 900, predicted at 1200 1/min: the impacts come closer in time."""
    found = fit(*slot, BEARING, 15.0, candidates=192)
    expected = expect(found, shaft_hz=20.0, candidates=32)
    with np.load(data_dir / 'hitsm' / 'hitsm_sq_IR8_1200.npz') as file:
        x, rate = file['x'].astype(float), float(file['fs'])
    there = found.at(shaft_hz=20.0).situation
    measured = features(x, rate, there.longest)
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


@pytest.mark.parametrize('text', ['', '[1, 2]', '{"quantities": {}}', 'not json', '[' * 100_000])
def test_what_is_no_fit_is_refused_in_words(text, tmp_path, capsys):
    path = tmp_path / 'fit.json'
    path.write_text(text)
    assert main(['whatif', str(path)]) != 0
    assert str(path) in (said := capsys.readouterr().err) or 'no calibration' in said


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
        assert 'no calibration of this version' in capsys.readouterr().err


def test_a_width_no_ball_fits_is_refused(slot):
    found = fit(*slot, BEARING, 15.0, candidates=64, place='inner')
    for width in (6.0, 0.01, math.nan):
        with pytest.raises(BearingTwinError, match=r'mm is outside .* half a ball'):
            expect(found, width_mm=width, candidates=16)


@pytest.mark.parametrize(
    ('option', 'value', 'said'),
    [
        ('--load', 'a,b', 'LOW,HIGH'),
        ('--load', '1,2,3', 'LOW,HIGH'),
        ('--seed', '-1', 'from 0 on'),
        ('--temperature', 'nan', 'degC from -273.15'),
        ('--temperature', '-300', 'degC from -273.15'),
    ],
)
def test_an_option_that_is_none_is_refused_with_its_limits(option, value, said, capsys):
    with pytest.raises(SystemExit):
        main(['fit', 'none.npz', option, value])
    assert repr(value) in (text := capsys.readouterr().err) and said in text


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


@pytest.mark.parametrize('place', ['outer', 'ball'])
def test_a_twin_has_no_defect_of_which_nothing_is_seen(place):
    noise = np.random.default_rng(1).standard_normal(51200)
    found = fit(noise, RATE, BEARING, 20.0, place=place, candidates=64)
    assert found.refusal in (Kind.NO_IMPACTS, Kind.NOT_FITTED)
    assert found.defect == place and found.to_dict()['twin']['defects'] == []
    twin = fitted_vibration(found, 2.0)
    assert twin.std() == pytest.approx(1.0, rel=0.2)
    assert float(((twin - twin.mean()) ** 4).mean() / twin.var() ** 2) < 4.0


def test_a_second_impact_that_is_not_heard_is_no_limit_of_the_width():
    """The other edge is faint, or it is farther away than two balls are: nothing says which."""
    rng = np.random.default_rng(3)
    train = np.zeros(4 * int(RATE))
    strikes = fault_frequencies(BEARING, 20.0).impacts('outer')
    times = np.cumsum(1.0 + 0.004 * rng.standard_normal(int(4 * strikes) - 4)) / strikes
    train[np.round(times[times < 3.99] * RATE).astype(int)] = 1.0
    x = ring(train)
    x += 0.3 * x.std() * rng.standard_normal(len(x))
    found = fit(x, RATE, BEARING, 20.0, place='outer', candidates=64)
    width = found.quantities['defect_width_mm']
    assert found.refusal is Kind.ONE_IMPACT and not width.identifiable
    assert found.statement == 'outer race defect, width not told: one impact a passage is heard'
    assert (width.q05, width.q95) == (0.0, pytest.approx(math.pi * (39.04 + 7.94) / 9, rel=1e-3))
    assert joined([found, found])[2] == found.statement
    # Between impacts a resonance is found, and its interval is not believed.
    modes = [q for name, q in found.quantities.items() if name.startswith('resonance')]
    assert modes and not any(mode.identifiable for mode in modes)


def test_impacts_that_go_on_after_twice_the_time_are_no_passage():
    """Three impacts at equal distances are the teeth of a gear: no defect is twice as wide."""
    machine = Situation(bearing=BEARING, place='outer', shaft_hz=20.0, sample_rate=RATE)
    apart = round(0.7 * machine.longest * RATE)
    rng = np.random.default_rng(1)
    for teeth, kind in ((2, None), (3, Kind.SEVERAL_SPACINGS)):
        train = np.zeros(4 * int(RATE))
        steps = np.cumsum(1.0 + 0.004 * rng.standard_normal(240)) / machine.strikes * RATE
        for tooth in range(teeth):
            train[np.round(steps).astype(int) + tooth * apart] += 1.0
        x = ring(train)
        whole = correlate(x + 0.02 * x.std() * rng.standard_normal(len(x)), RATE)
        refusal = unresolved(whole, whole.summary(machine.longest), machine)
        assert (refusal and refusal.kind) is kind


def test_the_echo_of_a_gear_in_the_whitening_is_no_passage():
    """Teeth closer than its reach: each impact of the bearing leaves another after their time."""
    rng = np.random.default_rng(2)
    machine = Situation(bearing=BEARING, place='outer', shaft_hz=24.0, sample_rate=RATE)
    train = np.zeros(4 * int(RATE))
    at = np.cumsum(1.0 + 0.005 * rng.standard_normal(300)) / machine.strikes * RATE
    train[np.round(at).astype(int)] = 1.0
    teeth = np.round(np.arange(0.0, 4.0, 1.0 / (41 * 24.0)) * RATE).astype(int)
    for mesh, turns in ((0.0, False), (0.5, True)):
        x = train.copy()
        x[teeth] += mesh
        x = ring(x)
        x += 0.02 * x.std() * rng.standard_normal(len(x))
        assert (gear(x, RATE, summarise(x, RATE, machine.longest)) is not None) is turns
    found = fit(x, RATE, BEARING, 24.0, place='outer', candidates=64)
    assert found.refusal is Kind.SEVERAL_SPACINGS and found.impacts is None
    assert 'the teeth of a gear' in found.quantities['defect_width_mm'].why


@pytest.mark.parametrize(
    ('place', 'width'), [('outer', 13.5e-3), ('inner', 8.5e-3), ('outer', 9e-3)]
)
def test_a_defect_wider_than_half_way_to_the_next_ball_is_not_told_as_the_rest_of_the_way(
    place, width
):
    found = fit(impact_train(width, place, 12.0), RATE, BEARING, 12.0, place=place, candidates=64)
    told = found.quantities['defect_width_mm']
    assert found.refusal is Kind.TOO_WIDE and not told.identifiable
    assert f'{1e3 * width:.1f} mm apart' in told.why and told.q95 > 1e3 * width


@pytest.mark.parametrize(('width', 'farther'), [(0.3e-3, 0.0), (9e-3, 9e-3)])
def test_a_limit_allows_for_impacts_beside_an_echo_that_are_no_rest_of_the_way_to_the_next_ball(
    width, farther
):
    """Each impact has an echo that makes the spacing doubtful."""
    x = impact_train(width, 'outer', 12.0, noise=0.0)
    late = round(0.25e-3 * RATE)
    x[late:] += 0.8 * np.diff(x, prepend=x[0])[:-late]
    machine = replace(cloud.example(), shaft_hz=12.0, sample_rate=RATE)
    whole = correlate(x, RATE)
    measured = whole.summary(machine.longest)
    refusal = unresolved(whole, measured, machine)
    assert refusal.farther * machine.speed == pytest.approx(farther, rel=0.01)
    left = limit(measured, machine, candidates=32)
    told = of_defect(left, machine, measured, refusal)['defect_width_mm']
    assert 1e3 * width < told.q95 < 1e3 * width + 4.0


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


def test_a_long_simulation_in_blocks_is_the_one_in_a_piece(monkeypatch):
    machine = Situation(bearing=BEARING, place='outer', shaft_hz=20.0, sample_rate=RATE)
    values = {name: about.place(np.full(2, 0.5)) for name, about in unknowns(machine).items()}
    whole = next(vibrations(machine, values, 0.2, 1))
    monkeypatch.setattr(cloud, 'LONGEST_BLOCK', 1000)
    assert np.array_equal(next(vibrations(machine, values, 0.2, 1)), whole)


@pytest.mark.parametrize('d_pitch', [0.01, 0.02, 0.9, 2.0])
def test_the_clearances_supposed_are_those_of_a_twin_of_any_size_hot_and_cold(d_pitch):
    sized = Bearing(
        name='sized', n_balls=8, d_ball=0.2 * d_pitch, d_pitch=d_pitch, contact_angle=0.0
    )
    machine = Situation(bearing=sized, place='outer', shaft_hz=10.0, sample_rate=RATE)
    supposed = unknowns(machine)['clearance_um']
    for clearance in (supposed.low, supposed.high):
        p = TwinParameters(bearing=sized, clearance=1e-6 * clearance, thermal_mode='physical')
        constants, values = constants_of(p), np.empty(CONDITION_SIZE)
        hot = ThermalNetwork().scaled(d_pitch).inner_excess(110.0)
        evaluate(constants, 110.0, 110.0 + hot, 10.0, values)
        assert values[CLEARANCE] == values[THERMAL_GAP]


def test_a_limit_of_a_healthy_record_says_how_sure_it_is():
    """The louder the record, the less; at last no defect of any width is sure to show."""
    noise = np.random.default_rng(1).standard_normal(51200)
    for rms, sure in ((0.05, 95), (0.4, 70), (100.0, None)):
        found = fit(rms * noise, RATE, BEARING, 25.0, unit='m/s^2', place='none')
        width = found.quantities['defect_width_mm']
        if sure is None:
            assert found.statement == 'a defect of any width may not show'
            assert width.q95 == pytest.approx(math.pi * (39.04 + 7.94) / 9, rel=1e-3)
            assert '0 % show. Measure closer' in width.why
            continue
        said = f'no defect above {width.q95:.2g} mm'
        said += '' if sure == 95 else f', with a confidence of {sure} %'
        assert found.statement == said and f'{sure} % show' in width.why
        assert width.q95 < 3.0


@pytest.mark.parametrize('rms', [0.1, 0.5])
def test_wider_defects_than_the_limit_of_a_healthy_record_show(rms):
    """On 80 machines whose loads, depths and losses are drawn anew, as many as it says."""
    machine = cloud.example('none')
    limit = smallest_shown(rms * NOISE[:25600], machine, 1.0, 0.0, seed=1)
    outer = replace(machine, place='outer')
    rng = np.random.default_rng(7)
    drawn = {name: about.place(rng.random(80)) for name, about in unknowns(outer).items()}
    drawn['defect_width_mm'] = rng.uniform(limit.width_mm, 3.9, 80)
    losses = 10.0 ** (-LOSS_DB * rng.random(80) / 20.0)
    defects = np.concatenate(list(vibrations(outer, drawn, 2.0, 3)))
    later = rms * NOISE[25600:51200]
    seen = [
        shown(later, loss * x, machine.sample_rate, outer.strikes, outer.shaft_hz)
        for loss, x in zip(losses, defects, strict=True)
    ]
    assert np.mean(seen) > limit.confidence - 2.0 * math.sqrt(0.05 / 80)


def test_orders_of_the_shaft_near_a_part_do_not_hide_its_defects():
    """Order 7 lies within 3 % of twice what the outer race of a 6205 strikes."""
    machine = cloud.example('none')
    order = 2.0 * np.pi * 7.0 * machine.shaft_hz * np.arange(25600) / machine.sample_rate
    x = 0.1 * NOISE[:25600]
    swelling = (1.0 + 0.2 * np.cos(order)) * x
    quiet, swells = (smallest_shown(y, machine, 1.0, 0.0, seed=1) for y in (x, swelling))
    assert swells.confidence == quiet.confidence
    assert swells.width_mm < 1.5 * quiet.width_mm


def test_lines_where_a_part_strikes_are_not_taken_for_what_a_defect_would_show():
    """A defect then has to be as clear as a suspect, or to be louder than all of the record."""
    machine = cloud.example('none')
    strikes = replace(machine, place='outer').strikes
    swelling = np.cos(2.0 * np.pi * strikes * np.arange(25600) / machine.sample_rate)
    widths = [smallest_shown(0.1 * NOISE[:25600], machine, 1.0, 0.0, seed=1).width_mm]
    for depth, suspect in ((0.1, False), (0.5, True)):
        x = 0.1 * (1.0 + depth * swelling) * NOISE[:25600]
        own = comb(x, machine.sample_rate, strikes)
        assert own.over_floor > own.chance and own.suspect is suspect
        widths.append(smallest_shown(x, machine, 1.0, 0.0, seed=1).width_mm)
    assert widths[0] < widths[1] < 0.5 * widths[2]


def test_candidates_that_rebound_leave_the_width_of_the_bare_passage_possible():
    """All kept candidates are narrower than the impacts are apart; the ball's path is not."""
    machine = cloud.example()
    x = 1e-3 * NOISE[:25600]
    x[200:25000:143] += 1.0
    x[220:25020:143] -= 0.7
    measured = summarise(x, machine.sample_rate, machine.longest)
    left = limit(measured, machine, candidates=32)
    narrow = np.full(len(left.weights), 1.0)
    left = replace(left, values=left.values | {'defect_width_mm': narrow})
    told = of_defect(left, machine, measured, None)['defect_width_mm']
    apart, half = (1e3 * seconds * machine.speed for seconds in (measured.spacing, measured.lobe))
    assert apart > 1.5 and told.median == pytest.approx(1.0)
    assert told.q95 == pytest.approx(apart + 1e3 * taken_off(machine, 0.5))
    assert told.q05 <= apart - half
