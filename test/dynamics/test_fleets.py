# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Many bearings in one call, against one at a time."""

import dataclasses
import math

from bearing_twin.dynamics import Fleet, preset, Simulator
from bearing_twin.dynamics.parameters import MAX_DEFECTS, PROFILES
from bearing_twin.dynamics.single.successor import successor
from bearing_twin.errors import BearingTwinError
from bearing_twin.numerics.compiled import compiled
from bearing_twin.numerics.random import NOISE, normal_pair, normal_pairs
from bearing_twin.numerics.vector import load, store
import numpy as np
import pytest

ERROR = {'ball': 1e-3, 'rect': 0.03, 'halfsine': 1e-3, 'smooth': 1e-3}
"""Of a fleet against single bearings at 51.2 kHz, relative, by profile: only a fleet steps over
the edges and kinks of a path, and its error there goes with the step."""


def relative(got, expected):
    return np.linalg.norm(got - expected) / np.linalg.norm(expected)


@compiled()
def drawn(index, keys, out):
    """Fill the first two rows of ``out`` lane by lane, the others at once."""
    for i in range(16):
        out[i], out[16 + i] = normal_pair(index, NOISE, keys[i])
    x, y = normal_pairs(index, NOISE, load(keys, 0))
    store(out, 2, x)
    store(out, 3, y)


@pytest.mark.parametrize('index', [0, 1, 123_456_789_012, 2**62 - 1])
def test_sixteen_numbers_at_once_are_those_of_each_seed(index):
    out = np.empty(64, np.float32)
    drawn(index, np.arange(16, dtype=np.uint64) * 0x1234567, out)
    np.testing.assert_allclose(out[32:], out[:32], rtol=0.0, atol=2e-6)


def test_fleet_is_many_simulators():
    parameters = [
        preset('incipient'),
        preset('incipient', defect='outer', load=2000.0, width=2.8e-3, depth=40e-6),
        preset('incipient', defect='inner+ball+cage', unbalance=1e-3),
        preset('incipient', bearing='6205', thermal_mode='physical'),
        # Where all balls are loaded, or the load turns, no ball may be passed over.
        preset('incipient', clearance=-5e-6),
        preset('incipient', unbalance=6e-3),
    ]
    parameters += [
        dataclasses.replace(
            parameters[0],
            defects=(dataclasses.replace(parameters[0].defects[0], profile=profile),),
        )
        for profile in PROFILES
    ]
    temperatures = np.linspace(30.0, 80.0, len(parameters))
    speeds = np.linspace(15.0, 30.0, len(parameters))
    rate = 51200.0
    fleet = Fleet(parameters, sample_rate=rate, temperatures=temperatures, shaft_hz=speeds)
    blocks = [fleet.advance(4096, temperatures + k, speeds) for k in range(3)]
    for index, single in enumerate(parameters):
        simulator = Simulator(
            single,
            sample_rate=rate,
            seed=index,
            temperature=temperatures[index],
            shaft_hz=speeds[index],
        )
        for k, block in enumerate(blocks):
            expected = simulator.advance(4096, temperatures[index] + k, speeds[index])
            profile = single.defects[0].profile
            wrong = relative(block.y[index], expected.y)
            assert wrong < ERROR[profile], f'bearing {index}, block {k}, profile {profile}'
        ours, theirs = fleet.condition(index), expected.condition
        assert ours.k_b == pytest.approx(theirs.k_b, rel=1e-9)
        assert ours.cage_angle == pytest.approx(theirs.cage_angle, abs=1e-5)
        assert ours.ball_force.sum() == pytest.approx(theirs.ball_force.sum(), rel=0.02)


@pytest.mark.parametrize('mode', ['paper', 'physical'])
def test_fleet_splitting_and_restoring_gives_the_same_bits(mode):
    def build():
        return Fleet(
            [preset('incipient', thermal_mode=mode), preset('paper', defect='ball+outer')] * 9
        )

    whole, cut = build(), build()
    for fleet in (whole, cut):
        fleet.advance(2500, 40.0, 26.0)
    expected = whole.advance(700, 40.0, 26.0)
    parts = []
    for n in (1, 300, 31, 368):
        parts.append(cut.advance(n, 40.0, 26.0).x)
        data = cut.save()
        cut = build()
        cut.load(data)
    assert np.array_equal(np.concatenate(parts, axis=1), expected.x)
    assert cut.save() == whole.save()
    with pytest.raises(BearingTwinError):
        cut.load(data[:-1])


def test_threads_change_no_bit():
    modes = ('paper', 'physical')
    parameters = [preset('incipient', thermal_mode=modes[k % 2]) for k in range(40)]
    one, three = (Fleet(parameters, threads=count) for count in (1, 3))
    for temperatures in (np.linspace(20.0, 60.0, 40), 40.0):
        blocks = [fleet.advance(1500, temperatures, 25.0) for fleet in (one, three)]
        np.testing.assert_array_equal(blocks[0].x, blocks[1].x)
        np.testing.assert_array_equal(blocks[0].y, blocks[1].y)
    assert one.save() == three.save()


def test_fleet_carries_the_inner_ring_and_refuses_without_a_trace():
    parameters = preset('incipient', thermal_mode='physical')
    fleet, single = Fleet([parameters] * 2), Simulator(parameters)
    fleet.advance(5120, 90.0, 25.4)
    single.advance(5120, 90.0, 25.4)
    worn = preset('incipient', thermal_mode='physical', width=1.2e-3)
    fleet.reconfigure(1, worn)
    single.reconfigure(worn)
    for _ in range(2):
        ours, theirs = fleet.condition(1), single.condition()
        assert ours.inner_ring_temperature == pytest.approx(theirs.inner_ring_temperature)
        assert ours.radial_clearance == pytest.approx(theirs.radial_clearance)
        fleet.advance(5120, 90.0, 25.4)
        single.advance(5120, 90.0, 25.4)
    before = fleet.save(), fleet.parameters
    with pytest.raises(BearingTwinError, match='Hz'):
        fleet.reconfigure(0, dataclasses.replace(parameters, inner_mass=0.1, outer_mass=0.1))
    assert (fleet.save(), fleet.parameters) == before
    with pytest.raises(BearingTwinError, match='thermal modes'):
        Fleet([preset('incipient')] * 2).load(before[0])


def test_a_fleet_knows_the_state_of_its_bearings_to_the_bit_as_each_alone():
    parameters = preset('incipient', thermal_mode='physical')
    fleet, single = Fleet([parameters]), Simulator(parameters)
    known = 'k_b', 'radial_clearance', 'slip', 'bpfi', 'contact_pressure'
    # The rings warm: between the ticks every input drifts.
    for n in (2570, 700, 613, 2048, 31):
        fleet.advance(n, 90.0, 25.4)
        alone = single.advance(n, 90.0, 25.4).condition
        ours = fleet.condition(0)
        assert [getattr(ours, name) for name in known] == [getattr(alone, name) for name in known]


def test_a_ball_that_spins_fast_meets_both_races_by_turns():
    """At a low rate its spall passes several contacts between two points of the grid."""
    ball = preset('incipient', defect='ball', jitter=0.0, noise=0.0, waviness=0.0)
    fleet = Fleet([ball], sample_rate=5000.0, shaft_hz=60.0).advance(5000, 20.0, 60.0)
    alone = Simulator(ball, sample_rate=5000.0, shaft_hz=60.0).advance(5000, 20.0, 60.0)
    assert relative(fleet.y[0], alone.y) < 5e-3


def test_a_cage_that_turns_far_between_grid_points_loses_no_loaded_ball():
    sound = preset(
        'incipient', defect='none', clearance=20e-6, jitter=0.0, noise=0.0, waviness=0.0
    )
    fleet = Fleet([sound], sample_rate=2000.0, shaft_hz=80.0).advance(1200, 20.0, 80.0)
    alone = Simulator(sound, sample_rate=2000.0, shaft_hz=80.0).advance(1200, 20.0, 80.0)
    assert np.abs(fleet.y).max() == pytest.approx(np.abs(alone.y).max(), rel=0.02)


@pytest.mark.parametrize(('was', 'becomes'), [('paper', 'physical'), ('physical', 'paper')])
def test_a_successor_may_be_of_another_thermal_mode(was, becomes):
    old = Simulator(preset('incipient', thermal_mode=was), temperature=60.0)
    new, before = successor(old, preset('incipient', thermal_mode=becomes))
    assert np.isfinite(before.y).all()
    assert (new.condition().inner_ring_temperature > 60.0) == (becomes == 'physical')


def test_a_path_that_jumps_is_met_at_every_place():
    """A fleet's steps do not end at the edges of 'rect': the force there is a mean."""
    parameters = [
        preset(name, defect=defect, profile='rect', noise=0.0)
        for name in ('paper', 'incipient')
        for defect in ('inner', 'outer', 'ball', 'cage')
    ]
    fleet = Fleet(parameters, temperatures=40.0, shaft_hz=40.0).advance(7680, 40.0, 40.0)
    for index, each in enumerate(parameters):
        alone = Simulator(each, seed=index, temperature=40.0, shaft_hz=40.0)
        expected = alone.advance(7680, 40.0, 40.0)
        got = np.array([fleet.x[index], fleet.y[index]])
        assert relative(got, np.array([expected.x, expected.y])) < ERROR['rect']
        assert np.abs(got[1]).max() == pytest.approx(np.abs(expected.y).max(), rel=ERROR['rect'])


def test_a_fleet_takes_as_many_defects_as_a_single_bearing():
    base = preset('incipient')
    spalls = tuple(
        dataclasses.replace(base.defects[0], place=place, angle=0.9 * k, ball=k)
        for k, place in enumerate(['inner', 'outer', 'ball', 'inner', 'outer', 'cage', 'ball'])
    )
    spalls += (dataclasses.replace(spalls[0], angle=5.4, profile='smooth'),)
    assert len(spalls) == MAX_DEFECTS
    worn = dataclasses.replace(base, defects=spalls)
    fleet = Fleet([base, worn], temperatures=40.0).advance(5120, 40.0, 25.4)
    alone = Simulator(worn, seed=1, temperature=40.0).advance(5120, 40.0, 25.4)
    assert relative(fleet.y[1], alone.y) < 5e-3


@pytest.mark.parametrize('mode', ['paper', 'physical'])
def test_one_bearing_of_a_fleet_is_saved_and_set_back(mode):
    parameters = [preset('incipient', thermal_mode=mode)] * 3
    fleet, other = Fleet(parameters), Fleet(parameters)
    for each in (fleet, other):
        each.advance(3000, 60.0, 27.0)
    saved = fleet.extract(1).save()
    before = fleet.condition(1)
    for each in (fleet, other):
        each.advance(3000, 90.0, 30.0)
    simulator = Simulator(parameters[1])
    simulator.load(saved)
    fleet.place(1, simulator)
    after = fleet.condition(1)
    for name in ('outer_ring_temperature', 'inner_ring_temperature', 'shaft_hz', 'inner_y'):
        assert getattr(after, name) == pytest.approx(
            getattr(before, name), rel=1e-6, nan_ok=True
        ), name
    assert fleet.next_sample == 6000
    ours, theirs = fleet.advance(4096, 60.0, 27.0), other.advance(4096, 60.0, 27.0)
    np.testing.assert_array_equal(ours.y[[0, 2]], theirs.y[[0, 2]])
    alone = simulator.advance(4096, 60.0, 27.0)
    # The noise is another one, and the filters begin anew.
    assert ours.y[1, 500:].std() == pytest.approx(alone.y[500:].std(), rel=0.3)
    with pytest.raises(BearingTwinError, match='other parameters'):
        fleet.place(0, Simulator(preset('paper')))


def test_fleet_reconfigures_one_bearing_and_leaves_the_others():
    healthy = preset('incipient', defect='none')
    fleet, other = Fleet([healthy] * 3), Fleet([healthy] * 3)
    for each in (fleet, other):
        each.advance(2048, 20.0, 25.4)
    fleet.reconfigure(1, preset('incipient'))
    changed, same = fleet.advance(4096, 20.0, 25.4), other.advance(4096, 20.0, 25.4)
    assert np.array_equal(changed.y[[0, 2]], same.y[[0, 2]])
    assert changed.y[1].std() > 5.0 * same.y[1].std()


@pytest.mark.parametrize('bad', [120.0, 10.0, math.nan])
def test_a_refused_input_names_its_bearing(bad):
    fleet = Fleet([preset('incipient')] * 3)
    before = fleet.save()
    with pytest.raises(BearingTwinError, match=f'^bearing 1: temperature {bad} degC is outside'):
        fleet.advance(256, [40.0, bad, 50.0], 25.0)
    with pytest.raises(BearingTwinError, match=r'^temperature'):
        fleet.advance(256, bad, 25.0)
    assert fleet.save() == before
