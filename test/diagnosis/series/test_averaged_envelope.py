# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Envelopes of many short snapshots, averaged: noise, unit, and the place that they show."""

from bearing_twin.bearing import Bearing, fault_orders, find_bearing, own_bearing
from bearing_twin.diagnosis.series.averaging import AveragedEnvelope, BANDS, LEAST_AVERAGED
from bearing_twin.studies import impact_machines
import numpy as np
import pytest

RATE, SHAFT_HZ = 25600.0, 30.0
TOLD = slice(20, 260)
"""From one order up to those that bands of 500 Hz tell at this speed."""


def test_noise_leaves_no_excess_and_a_single_snapshot_would():
    """The mean of N noise floors is taken off to 1/sqrt(N); each taken off alone is not."""
    rng = np.random.default_rng(0)
    average, alone = AveragedEnvelope(), []
    for _ in range(400):
        x = rng.standard_normal(2560)
        average.add(x, RATE, SHAFT_HZ)
        if len(alone) < 40:
            single = AveragedEnvelope()
            single.add(x, RATE, SHAFT_HZ)
            alone.append(single.excess()[:, TOLD].mean())
    excess = average.excess()[:, TOLD]
    assert abs(excess.mean()) < 0.02
    assert excess.std() < 3.0 / np.sqrt(400)
    # The median of a single exponential floor is log 2 of its mean; bins share lines.
    assert np.mean(alone) > 5.0 * 0.02


@pytest.mark.parametrize('unit', [1e-90, 1e-30, 1e90])
def test_an_averaged_envelope_is_the_same_in_any_unit(unit):
    x = np.random.default_rng(0).standard_normal(2560)
    average, other = AveragedEnvelope(), AveragedEnvelope()
    average.add(x, RATE, SHAFT_HZ)
    other.add(unit * x, RATE, SHAFT_HZ)
    np.testing.assert_allclose(other.power, average.power, rtol=1e-3)


@pytest.mark.parametrize(
    ('name', 'place', 'said'),
    # In three turns the inner race of the last cannot be told from the ball: BPFI 7.39, 7.18.
    [('6205', 'outer', 'outer'), ('6205', 'inner', 'inner'), ('PRONOSTIA', 'outer', 'outer'),
     ('PRONOSTIA', 'inner', None)],
)  # fmt: skip
def test_place_from_snapshots_that_show_nothing_alone(name, place, said):
    bearing = find_bearing(name)
    order = fault_orders(bearing).impacts(place)
    rng = np.random.default_rng(3)
    ring = np.exp(-1500.0 * np.arange(100) / RATE) * np.sin(
        2 * np.pi * 4e3 * np.arange(100) / RATE
    )
    averages = {False: AveragedEnvelope(), True: AveragedEnvelope()}
    found = []
    for number in range(300):
        damaged = number >= 150
        x = rng.standard_normal(2560)
        hits = np.zeros(2560)
        if damaged:
            step = RATE / (order * SHAFT_HZ)
            at = np.arange(rng.uniform(0.0, step), 2560.0, step).astype(int)
            hits[at] = 2.5
        x += np.convolve(hits, ring)[:2560]
        averages[damaged].add(x, RATE, SHAFT_HZ)
        single = AveragedEnvelope()
        single.add(x, RATE, SHAFT_HZ)
        found.append(single.place(bearing, AveragedEnvelope()))
    assert found == [None] * 300
    assert averages[False].place(bearing, AveragedEnvelope()) is None
    comb = averages[True].place(bearing, averages[False])
    if said is None:
        assert comb is None
        return
    assert comb.place == said
    assert comb.order == pytest.approx(order, rel=0.02)


@pytest.mark.parametrize(
    ('lines', 'place'),
    [((1, 2, 3), 'outer'), ((1,), None), ((3,), None), ((0.5, 1, 1.5, 2, 3), None)],
)
def test_a_comb_is_a_place_only_with_all_of_its_harmonics_and_none_between(lines, place):
    bearing = find_bearing('6205')
    power = 1.0 + 0.01 * np.random.default_rng(0).standard_normal((len(BANDS), 800))
    for line in lines:
        at = round(line * fault_orders(bearing).bpfo / 0.05) - 1
        power[:, at - 1 : at + 2] += 2.0
    average = AveragedEnvelope()
    average.load(30, 300.0, 30.0 * power)
    comb = average.place(bearing, AveragedEnvelope())
    assert (comb and comb.place) == place


def test_blades_beside_an_order_of_the_bearing_name_no_place():
    """Noise that pulses three times a turn in a 6312, whose outer race has 3.07."""
    rng, turns = np.random.default_rng(0), np.arange(5120) / RATE * 25.0
    quiet, loud = AveragedEnvelope(), AveragedEnvelope()
    for number in range(120):
        x = rng.standard_normal(len(turns))
        if number >= 60:
            phase = 2.0 * np.pi * (3.0 * turns + rng.random())
            x *= 2.5 * (0.5 + 0.5 * np.cos(phase)) ** 3
        (loud if number >= 60 else quiet).add(x, RATE, 25.0)
    assert loud.place(find_bearing('6312'), quiet) is None


def average_of_strikes(order, turns, given_hz, jitter=0.0):
    """Return the average of 25 snapshots of a shaft of 25 Hz, with impacts at an order."""
    rng, average = np.random.default_rng(1), AveragedEnvelope()
    t = np.arange(round(turns / 25.0 * RATE)) / RATE
    ring = (np.exp(-2500.0 * t) * np.sin(2.0 * np.pi * 4000.0 * t))[:500]
    for _ in range(25):
        steps = 1.0 + jitter * rng.standard_normal(round(turns * order))
        times = (rng.random() + np.cumsum(steps)) / (25.0 * order)
        train = np.zeros(len(t))
        train[(times[times < t[-1]] * RATE).astype(int)] = 5.0
        x = rng.standard_normal(len(t)) + np.convolve(train, ring)[: len(t)]
        average.add(x, RATE, given_hz)
    return average


@pytest.mark.parametrize('turns', [5.0, 12.5, 25.0, 50.0])
@pytest.mark.parametrize(('strikes', 'given_hz'), [(3, 24.875), (3, 24.75), (5, 25.25)])
def test_strikes_a_whole_number_of_times_a_turn_are_no_race_beside_it(strikes, given_hz, turns):
    """The wider a line, the more of it is in the bins of a 6203, at 3.05 and 4.95."""
    average = average_of_strikes(strikes, turns, given_hz)
    assert average.place(find_bearing('6203'), AveragedEnvelope()) is None


@pytest.mark.parametrize('turns', [10.0, 45.0])
def test_a_race_beside_whole_orders_shows_by_its_third_harmonic(turns):
    """A UER204 whose outer race strikes 3.083 times a turn without slip."""
    bearing = Bearing(
        name='UER204', n_balls=8, d_ball=7.92e-3, d_pitch=34.55e-3, contact_angle=0.0
    )
    order = 0.995 * fault_orders(bearing).bpfo
    comb = average_of_strikes(order, turns, 25.0, jitter=0.01).strong(bearing, 25.0)
    assert comb is not None
    assert comb.place == 'outer'
    assert comb.order == pytest.approx(order, abs=0.02)


@pytest.mark.parametrize(('place', 'turns'), [('outer', 6), ('inner', 8)])
def test_a_race_at_a_whole_order_is_strong_and_may_be_strikes_of_the_shaft(place, turns):
    """A 7210, whose races strike 6.03 and 7.97 times a turn, in snapshots of 12 turns."""
    bearing = own_bearing('14,12.7,70,40')
    order = fault_orders(bearing, 0.004).impacts(place)
    average = average_of_strikes(order, 12.0, 25.0, jitter=0.005)
    assert average.place(bearing, AveragedEnvelope()) is None
    comb = average.strong(bearing, 25.0)
    assert comb is not None
    assert (comb.place, comb.turns) == (place, turns)
    assert str(comb).startswith(f'{place} or {turns} strikes a turn: comb at ')


@pytest.mark.proof
def test_damaged_machines_are_suspect_from_the_first_short_snapshots_on_and_sound_ones_are_not():
    """Records of machines, each cut into as many snapshots as an average needs."""
    suspect = []
    for case in map(impact_machines.draw, range(50)):
        # Below 8 kHz a series has hardly a band.
        if case.sample_rate >= 8000.0:
            average = AveragedEnvelope()
            for x in np.array_split(impact_machines.record(case), LEAST_AVERAGED):
                average.add(x - x.mean(), case.sample_rate, case.given_hz)
            if comb := average.strong(case.geometry, case.given_hz):
                suspect.append((case.condition, comb.place))
    assert len(suspect) > 3
    assert all(condition == place != 'cage' for condition, place in suspect)
