# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Several records of one machine: what they tell together, and what none of them makes."""

from dataclasses import replace
import json
import math

from bearing_twin.calibration import Calibration, fit
from bearing_twin.calibration.answer.estimates import spacing_shortfall
from bearing_twin.calibration.answer.impacts import follows_speed, Impacts, impacts_of
from bearing_twin.calibration.answer.refusals import Kind
from bearing_twin.calibration.candidates.cloud import Situation
from bearing_twin.calibration.candidates.passage import contact_speed
from bearing_twin.calibration.joint import common_width, corrected_by_speeds
from bearing_twin.calibration.measured.summaries import correlate
from bearing_twin.cli import main
from bearing_twin.errors import BearingTwinError
from impact_trains import BEARING, impact_train, RATE, ring
import numpy as np
import pytest


def test_ringing_at_two_speeds_is_no_width():
    """The same time between impacts at another speed: not a passage."""
    apart = 2e-3 / contact_speed(BEARING, 'outer', 12.0)
    slow = impact_train(apart * contact_speed(BEARING, 'outer', 10.0), 'outer', 10.0)
    both = [
        fit(x, RATE, BEARING, hz, place='outer', candidates=64)
        for x, hz in ((impact_train(2e-3, 'outer', 12.0), 12.0), (slow, 10.0))
    ]
    assert both[0].impacts.spacing_s == pytest.approx(apart, rel=0.02)
    estimate = {'q05': 1.0, 'median': 2.0, 'q95': 3.0, 'identifiable': True}
    both = [
        replace(found, quantities={'defect_width_mm': replace(
            found.quantities['defect_width_mm'], **estimate)})
        for found in both
    ]  # fmt: skip
    alone = corrected_by_speeds(both[1], [])
    assert alone is both[1]
    _, width, statement = common_width(both)
    assert not width.identifiable and 'does not follow the speed' in width.why
    assert 'width not identifiable: a second impact is ringing' in statement
    # The other edge may be anywhere: as far away as the next ball.
    assert width.q95 == pytest.approx(math.pi * (39.04 + 7.94) / 9, rel=1e-3)
    other = Impacts('outer', 12.0, apart, 1e-4)
    assert corrected_by_speeds(both[1], [other]).refusal is Kind.SAME_AT_ANOTHER_SPEED
    # A time that follows the speed is a passage, and both records tell one width.
    seen = both[1].impacts
    moved = replace(both[1], impacts=seen._replace(spacing_s=seen.spacing_s * 1.2))
    found, width, _ = common_width([both[0], moved])
    assert width.why == '2 of 2 records tell it' and len(found) == 2
    # No record alone says that it is wider than that.
    assert width.q05 <= estimate['q05'] < width.median < width.q95
    with pytest.raises(BearingTwinError, match='not of one defect'):
        common_width([both[0], replace(moved, situation=replace(moved.situation, place='inner'))])


def test_two_pits_are_no_entry_and_exit():
    """Their impacts are alike; that they are as far apart at each speed proves no passage."""
    pits = [
        fit(impact_train(2e-3, 'outer', hz, heights=(0.6, 1.0)), RATE, BEARING, hz,
            place='outer', candidates=64)
        for hz in (10.0, 14.0)
    ]  # fmt: skip
    records, width, _ = common_width(pits)
    assert {each.refusal for each in (*pits, *records)} == {Kind.ALIKE}
    assert not width.identifiable and 'second pit or an echo' in width.why
    assert width.q95 > 2.0


def seen_at(x, shaft_hz):
    """Return the two impacts of a passage over an outer race that a record shows."""
    machine = Situation(bearing=BEARING, place='outer', shaft_hz=shaft_hz, sample_rate=RATE)
    whole = correlate(x, RATE)
    return impacts_of(whole, whole.summary(machine.longest_spacing), machine)


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
    records, width, statement = common_width(doubtful)
    assert width.identifiable and all(each.refusal is None for each in records)
    assert statement.startswith('outer race defect, ')
    # The edges themselves strike here: the truth is near the lower bound.
    assert width.q05 < 2.0 < width.median < width.q95
    assert 'and as far at 14.0 Hz: a passage' in records[0].quantities['defect_width_mm'].why
    # Where the part that is named does not strike, no other record makes it.
    silent = replace(doubtful[0], refusal=Kind.NO_IMPACTS)
    assert corrected_by_speeds(silent, [both[1].impacts]) is silent


def test_neither_echoes_nor_gears_are_a_passage():
    time = 2e-3 / contact_speed(BEARING, 'outer', 12.0)
    echoes = [
        seen_at(impact_train(time * contact_speed(BEARING, 'outer', hz), 'outer', hz), hz)
        for hz in (9.0, 13.0)
    ]
    assert echoes[0].speeds_differ(echoes[1]) and not follows_speed(echoes[0], echoes[1:])
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
        seen.append(impacts_of(whole, whole.summary(machines[-1].longest_spacing), machines[-1]))
    assert follows_speed(seen[0], seen[1:]) == (seen[1],)
    apart = seen[0].spacing_s * machines[0].speed
    truth = math.radians(degrees) * 23.5e-3
    assert apart < truth < apart + spacing_shortfall(machines[0], 0.95)


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
        assert common_width(both)[1:] == (suspect.quantities['defect_width_mm'], suspect.statement)


@pytest.mark.proof
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
