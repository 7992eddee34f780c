# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Rules that keep one cause from being called by another's name."""

import re

from bearing_twin.bearing import fault_orders, find_bearing, own_bearing
from bearing_twin.diagnosis import (
    diagnose_record,
    DiagnosisSettings,
    record,
    StreamingDiagnoser,
)
from bearing_twin.diagnosis.chain import Analysis, Excerpt
from bearing_twin.diagnosis.rules.confidence import confidence, Trust
from bearing_twin.diagnosis.signal.impulsive_outliers import limit_impulsive_outliers
from bearing_twin.diagnosis.signal.shaft import shafts_instead_hz
from bearing_twin.diagnosis.thresholds import SLIP_COST
import numpy as np
import pytest
from scipy import signal

RATE = 25_600.0
SHAFT_HZ = 25.4
SECONDS = 4.0
N = int(RATE * SECONDS)
RING = np.exp(-600 * np.arange(400) / RATE) * np.sin(2 * np.pi * 4500 * np.arange(400) / RATE)


SEED = 8


def _strikes(times, heights):
    x = np.zeros(N)
    at = np.searchsorted(np.arange(N) / RATE, times)
    x[at[at < N]] = np.broadcast_to(heights, times.shape)[at < N]
    return np.convolve(x, RING)[:N]


def test_regular_strikes_pass_and_single_shocks_are_limited(rng):
    x = _strikes(np.arange(0.0, SECONDS, 0.01), 8.0) + rng.standard_normal(N)
    assert limit_impulsive_outliers(x, RATE, 10.0) is x
    shocked = x + _strikes(np.array([0.7, 2.9]), 100.0)
    limited = limit_impulsive_outliers(shocked, RATE, 10.0)
    assert np.abs(limited).max() < 2.5 * np.abs(x).max()
    same = np.abs(shocked) < np.abs(x).max()
    assert np.array_equal(limited[same], shocked[same])
    assert limit_impulsive_outliers(shocked[:2000], RATE, 10.0).max() == shocked[:2000].max()


def test_fault_shows_among_single_shocks(rng):
    bearing = find_bearing('6307')
    order = fault_orders(bearing, 0.01).bpfo
    gaps = (1.0 + 0.01 * rng.standard_normal(1000)) / (order * SHAFT_HZ)
    x = _strikes(np.cumsum(gaps), 6.0) + rng.standard_normal(N)
    shocks = _strikes(rng.uniform(0.0, SECONDS, 16), 300.0 * rng.standard_normal(16))
    said = diagnose_record(x + shocks, RATE, bearing, SHAFT_HZ)
    assert said.faults == ('outer',), said.reasons


@pytest.mark.parametrize('name', ['6312', '6203'])
@pytest.mark.parametrize('off', [-0.001, 0.0012])
def test_a_loose_shaft_beside_the_given_speed_is_no_fault(rng, name, off):
    """Strikes once a turn have lines at 3 and 5 turns, where races lie at the speed given."""
    turns = np.arange(1.0, SECONDS * SHAFT_HZ - 1.0)
    jitter, heights = rng.standard_normal((2, len(turns)))
    x = _strikes((turns + 0.01 * jitter) / SHAFT_HZ, 10.0 * (1.0 + 0.3 * heights))
    phase = 2.0 * np.pi * SHAFT_HZ * np.arange(N) / RATE
    x += sum(2.0 / k * np.cos(k * phase) for k in range(1, 11)) + rng.standard_normal(N)
    given_hz = SHAFT_HZ * (1.0 + off)
    said = diagnose_record(x, RATE, find_bearing(name), given_hz, speed_tolerance=0.002)
    assert said.level == 'suspect', said.reasons
    assert said.shaft_hz == pytest.approx(SHAFT_HZ, rel=5e-4)


@pytest.mark.parametrize('name', ['6312', '6203'])
@pytest.mark.parametrize('height', [0.85, 1.0])
def test_a_weak_outer_race_at_three_turns_of_a_nameplate_speed_is_no_health(rng, name, height):
    """Its lines are taken for those of the shaft, at a speed that is one per cent off."""
    bearing = find_bearing(name)
    outer_hz = fault_orders(bearing, 0.01).bpfo * SHAFT_HZ
    gaps = (1.0 + 0.003 * rng.standard_normal(1000)) / outer_hz
    x = _strikes(np.cumsum(gaps), height) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, bearing, outer_hz / 3.0)
    assert (said.rule, said.level) == ('masked_faintly', 'none'), said.reasons
    assert 'outer order and shaft order 3 coincide' in said.reasons[-1]


@pytest.mark.parametrize(('shaft_hz', 'off'), [(25.0, -0.003), (20.0, -0.004)])
@pytest.mark.parametrize('seed', range(4))
def test_a_loose_shaft_farther_from_the_given_speed_is_no_fault(seed, shaft_hz, off):
    """Its lines are multiples of the shaft, and no inner race's with sidebands at another turn."""
    rng, rate, seconds = np.random.default_rng(seed), 12_800.0, 8.0
    turns = np.arange(1.0, seconds * shaft_hz - 1.0)
    jitter, heights = rng.standard_normal((2, len(turns)))
    x = np.zeros(int(rate * seconds))
    x[((turns + 0.002 * jitter) / shaft_hz * rate).astype(int)] = np.exp(0.3 * heights)
    pole = np.exp((-0.03 + 1.0j) * 2.0 * np.pi * 1000.0 / rate)
    x = signal.lfilter([1.0], [1.0, -2.0 * pole.real, abs(pole) ** 2], x)
    x = x / x.std() + rng.standard_normal(len(x))
    said = diagnose_record(x, rate, find_bearing('6307'), shaft_hz * (1.0 + off))
    assert said.level == 'suspect', said.reasons


@pytest.mark.parametrize('name', ['6312', '6203', '6308'])
@pytest.mark.parametrize('sway', [0.005, 0.01, 0.02])
def test_a_loose_shaft_whose_speed_moves_is_no_alarm(rng, name, sway):
    """Its lines smear, so that neither they nor the combs tell the speed."""
    times = np.arange(N) / RATE
    speed = 1.0 + sway * np.sin(2.0 * np.pi * 0.3 * times + rng.uniform(0.0, 6.3))
    turns = np.cumsum(SHAFT_HZ * speed) / RATE
    at = np.arange(1.0, turns[-1] - 1.0)
    jitter, heights = rng.standard_normal((2, len(at)))
    struck = np.interp(at + 0.01 * jitter, turns, times)
    x = _strikes(struck, 8.0 * (1.0 + 0.4 * heights)) + rng.standard_normal(N)
    x += sum(2.0 / k * np.cos(2.0 * np.pi * k * turns) for k in range(1, 11))
    said = diagnose_record(x, RATE, find_bearing(name), SHAFT_HZ)
    assert said.level != 'fault', said.reasons


@pytest.mark.parametrize('depth', [0.3, 0.45, 0.6])
@pytest.mark.parametrize('name', ['6205', '6206', '6310'])
def test_an_outer_race_whose_impacts_vary_once_a_turn_of_the_cage_stays_open(rng, name, depth):
    """An eccentric cage loads its balls in turn: the sidebands are the order over the balls."""
    bearing = find_bearing(name)
    order = fault_orders(bearing, 0.008).bpfo
    struck = np.arange(int(0.98 * SECONDS * SHAFT_HZ * order))
    jitter, scatter = rng.standard_normal((2, len(struck)))
    heights = 1.0 + depth * np.cos(2.0 * np.pi * struck / bearing.n_balls)
    times = np.cumsum(1.0 + 0.005 * jitter) / (order * SHAFT_HZ)
    x = _strikes(times, 6.0 * heights * np.exp(0.2 * scatter)) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, bearing, SHAFT_HZ)
    assert said.faults[0] == 'outer', said.reasons


@pytest.mark.parametrize(('own', 'given'), [('6321', '6218'), ('6410', '6208'), ('6205', '6236')])
def test_a_ball_of_another_bearing_is_no_outer_race_with_cage_sidebands(rng, own, given):
    """Its cage turns at another share of its order than the balls of the outer race ask for."""
    orders = fault_orders(find_bearing(own), 0.004)
    order = orders.impacts('ball')
    turns = np.cumsum(1.0 + 0.003 * rng.standard_normal(int(0.98 * SECONDS * SHAFT_HZ * order)))
    turns /= order
    load = np.cos(np.pi * orders.ftf * turns) ** 4
    x = _strikes(turns / SHAFT_HZ, 12.0 * load) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, find_bearing(given), SHAFT_HZ, speed_tolerance=0.002)
    assert 'outer' not in said.faults, said.reasons
    assert {'ball', 'cage'} <= set(said.faults), said.reasons


@pytest.mark.parametrize('ringing_hz', [800.0, 1000.0, 1300.0])
def test_an_outer_race_that_rings_low_is_not_healthy(rng, ringing_hz):
    """Its impacts do not die away, so that they are lines of the plain spectrum and no comb."""
    bearing, rate, shaft_hz = find_bearing('6205'), 8000.0, 48.6
    count = int(4.0 * rate)
    hertz = fault_orders(bearing, 0.01).bpfo * shaft_hz
    x = np.zeros(count)
    at = np.cumsum(1.0 + 0.004 * rng.standard_normal(int(3.9 * hertz))) / hertz
    x[(at * rate).astype(int)] = 1.0 + 0.2 * rng.standard_normal(len(at))
    t = np.arange(2000) / rate
    ring = np.exp(-0.02 * 2.0 * np.pi * ringing_hz * t) * np.sin(2.0 * np.pi * ringing_hz * t)
    x = np.convolve(x, ring)[:count]
    noise = rng.standard_normal(count)
    said = diagnose_record(1.2 * x / x.std() + noise, rate, bearing, shaft_hz)
    assert said.level != 'ok', said.reasons
    assert diagnose_record(noise, rate, bearing, shaft_hz).result == 'healthy'


def test_pulses_of_the_mains_are_no_fault(rng):
    bearing = find_bearing('6307')
    # Twice the mains falls on the order of the inner race at this speed.
    shaft_hz = 100.0 / fault_orders(bearing, 0.01).bpfi
    x = _strikes(np.arange(0.0, SECONDS, 0.01), 8.0) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, bearing, shaft_hz)
    assert (said.result, said.level) == ('ambiguous', 'suspect')
    assert '100 Hz' in ' '.join(said.reasons)


def test_strikes_that_swell_once_a_turn_are_no_pulses_of_the_mains(rng):
    bearing = find_bearing('6205')
    shaft_hz = 100.0 / fault_orders(bearing, 0.01).bpfi
    times = np.cumsum(1.0 + 0.005 * rng.standard_normal(390)) / 100.0
    load = np.maximum(np.cos(2.0 * np.pi * shaft_hz * times), 0.0)
    said = diagnose_record(
        _strikes(times, 12.0 * load) + rng.standard_normal(N), RATE, bearing, shaft_hz
    )
    assert (said.result, said.level) == ('inner', 'fault'), said.reasons


def test_strikes_that_swell_with_the_cage_are_no_race_fault(rng):
    """A ball of a cage that slips so far that its strikes lie at the inner race's order."""
    bearing = find_bearing('NICE')
    orders = fault_orders(bearing, 0.068)
    assert 2.0 * orders.bsf == pytest.approx(fault_orders(bearing).bpfi, rel=0.005)
    times = np.arange(0.0, SECONDS, 0.5 / (orders.bsf * SHAFT_HZ))
    load = np.maximum(np.cos(2.0 * np.pi * orders.ftf * SHAFT_HZ * times), 0.0)
    x = _strikes(times, 8.0 * load) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, bearing, SHAFT_HZ, speed_tolerance=0.002)
    assert 'inner' not in said.faults, said.reasons
    assert said.level != 'ok'


def test_ball_that_strikes_unevenly_is_no_race_fault(rng):
    """Every other strike is weaker: the third half harmonic lies at the inner race."""
    bearing = find_bearing('ZA-2115')
    orders = fault_orders(bearing, 0.01)
    gaps = (1.0 + 0.005 * rng.standard_normal(2000)) * 0.5 / (orders.bsf * SHAFT_HZ)
    times = np.cumsum(gaps)
    load = 1.0 + 0.8 * np.cos(2.0 * np.pi * orders.ftf * SHAFT_HZ * times)
    heights = 8.0 * load * np.where(np.arange(len(times)) % 2, 0.5, 1.0)
    x = _strikes(times, heights) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, bearing, SHAFT_HZ)
    assert said.faults == ('ball',), said.reasons


@pytest.mark.parametrize('slip', [-0.005, 0.0, 0.01])
def test_ball_without_sidebands_is_no_outer_race_of_an_unlikely_slip(rng, slip):
    """Thirteen rollers: the outer race would have to slip by 5 % more to strike as often."""
    bearing = own_bearing('13,7.5,38.5')
    order = 2.0 * fault_orders(bearing, slip).bsf
    gaps = (1.0 + 0.002 * rng.standard_normal(2000)) / (order * SHAFT_HZ)
    x = _strikes(np.cumsum(gaps), 8.0) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, bearing, SHAFT_HZ, speed_tolerance=0.002)
    assert said.faults != ('outer',), said.reasons
    assert 'ball' in said.faults


@pytest.mark.parametrize('slip', [0.07, 0.085, 0.1])
def test_comb_with_sidebands_of_the_shaft_is_no_ball_fault(rng, slip):
    """Beyond the slip looked for, a sideband of the inner race lies at the order of the ball."""
    bearing = find_bearing('NICE')
    times = np.arange(0.0, SECONDS, 1.0 / (fault_orders(bearing, slip).bpfi * SHAFT_HZ))
    load = np.maximum(np.cos(2.0 * np.pi * SHAFT_HZ * times), 0.0)
    x = _strikes(times, 8.0 * load) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, bearing, SHAFT_HZ, speed_tolerance=0.002)
    assert (said.result, said.level) == ('ambiguous', 'suspect'), said.reasons
    assert 'inner' in said.faults


@pytest.mark.parametrize('seed', [0, 3])
def test_a_cage_whose_turns_differ_by_one_per_cent_is_named(seed):
    """Its harmonic at the outer race's order is smeared, those below it are not of a load."""
    rng, bearing = np.random.default_rng(seed), find_bearing('6205')
    gaps = (1.0 + 0.01 * rng.standard_normal(100)) / (fault_orders(bearing, 0.005).ftf * 29.0)
    impacts = np.zeros(2 * N)
    at = (np.cumsum(gaps) * RATE).astype(int)
    impacts[at[at < 2 * N]] = np.exp(0.3 * rng.standard_normal(np.count_nonzero(at < 2 * N)))
    x = 20.0 * np.convolve(impacts, RING)[: 2 * N] + rng.standard_normal(2 * N)
    said = diagnose_record(x, RATE, bearing, 29.0)
    assert (said.result, said.level) == ('cage', 'fault'), said.reasons
    assert said.score['outer'] < 5.5


@pytest.mark.parametrize(('name', 'slip'), [('6203', 0.01), ('UER204', 0.01)])
def test_lines_of_a_cage_that_do_not_fade_are_no_ball_fault(rng, name, slip):
    """Eleven turns of a cage that slips far lie at the order of a ball that slips little."""
    order = 2.0 * fault_orders(find_bearing(name), slip).bsf / 11.0
    x = _strikes(np.arange(0.0, SECONDS, 1.0 / (order * SHAFT_HZ)), 12.0)
    x += rng.standard_normal(N)
    said = diagnose_record(x, RATE, find_bearing(name), SHAFT_HZ, speed_tolerance=0.002)
    assert (said.result, said.level) == ('ambiguous', 'suspect'), said.reasons
    assert 'cage' in said.faults


def test_confidence_is_a_share_and_moves_with_what_it_rests_on():
    """
    Significance and effect make a fault surer and health less sure, slip makes doubt.

    Combs of other places make a suspicion less sure.
    """
    scores = np.arange(-2.0, 40.0, 0.25)
    for kind, sign in (('fault', 1), ('healthy', -1)):
        shares = np.array([confidence(kind, Trust(z=z, index=0.8, elsewhere_z=z)) for z in scores])
        assert (shares >= 0.0).all()
        assert (shares <= 1.0).all()
        assert (sign * np.diff(shares) >= 0.0).all(), kind
    at = {'z': 8.0, 'index': 0.8}
    assert confidence('fault', Trust(**at, slip=0.05)) < confidence('fault', Trust(**at))
    assert confidence('suspect', Trust(**at, others=1.5)) < confidence('suspect', Trust(**at))
    quiet, struck = Trust(elsewhere_z=4.0), Trust(elsewhere_z=12.0, elsewhere_index=0.9)
    assert confidence('healthy', struck) < confidence('healthy', quiet)
    # Beyond what the machines had that the weights are fitted to, a term says no more.
    known = {'z': 8.0, 'elsewhere_z': 12.0}
    for name, end, beyond in (
        ('index', 2.0, 9.0),
        ('elsewhere_index', 1.0, 9.0),
        ('impacts', 3.0, 9.0),
        ('impacts', 0.0, -9.0),
        ('slip', 3.0 * SLIP_COST, 9.0),
    ):
        at_end, past = (Trust(**known, **{name: value}) for value in (end, beyond))
        assert at_end.terms() == past.terms() != Trust(**known, **{name: 0.5 * end + 0.01}).terms()


def test_another_bearing_is_said_and_no_fault_is_named(rng):
    """The inner race of a 6205, diagnosed with the geometry of a 6307."""
    order = fault_orders(find_bearing('6205')).bpfi
    times = np.arange(0.0, SECONDS, 1.0 / (order * SHAFT_HZ))
    x = _strikes(times, 8.0 * (1.0 + 0.6 * np.cos(2.0 * np.pi * SHAFT_HZ * times)))
    x += rng.standard_normal(N)
    assert diagnose_record(x, RATE, find_bearing('6205'), SHAFT_HZ).faults == ('inner',)
    said = diagnose_record(x, RATE, find_bearing('6307'), SHAFT_HZ)
    assert said.rule in ('impacts_elsewhere', 'elsewhere_explains')
    assert (said.level, said.faults) == ('suspect', ())
    assert f'periodic impacts at {order:.1f}' in said.reasons[-1]


def test_the_ball_of_another_bearing_is_no_race_of_this_one(rng):
    """The ball of a bearing of 40 degrees strikes as often as the inner race of a 6407."""
    struck = own_bearing('9,10,46,40')
    orders = fault_orders(struck)
    inner = fault_orders(find_bearing('6407')).bpfi
    assert orders.impacts('ball') == pytest.approx(inner, rel=0.01)
    gaps = (1.0 + 0.004 * rng.standard_normal(600)) / (orders.impacts('ball') * SHAFT_HZ)
    times = np.cumsum(gaps)
    through = 2.0 * np.pi * orders.ftf * SHAFT_HZ * times
    x = _strikes(times, 10.0 * np.maximum(0.2 + np.cos(through), 0.0)) + rng.standard_normal(N)
    assert diagnose_record(x, RATE, struck, SHAFT_HZ).faults == ('ball',)
    said = diagnose_record(x, RATE, find_bearing('6407'), SHAFT_HZ)
    assert (said.rule, said.level) == ('another_cage', 'suspect'), said.reasons
    apart = float(re.findall(r'[\d.]+', said.reasons[-1])[0])
    assert apart == pytest.approx(orders.ftf, rel=0.01)


@pytest.mark.parametrize('swell', [0.4, 0.6, 0.8])
@pytest.mark.parametrize(('struck', 'given'), [('6318', '6214'), ('6009', '16014')])
def test_a_ball_that_swells_a_little_with_the_cage_is_no_race(rng, swell, struck, given):
    """The ball of one bearing strikes as often as a race of the other."""
    orders = fault_orders(find_bearing(struck), 0.01)
    gaps = (1.0 + 0.004 * rng.standard_normal(900)) / (orders.impacts('ball') * SHAFT_HZ)
    times = np.cumsum(gaps)
    load = 1.0 + swell * np.cos(2.0 * np.pi * orders.ftf * SHAFT_HZ * times)
    x = _strikes(times, 8.0 * load) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, find_bearing(given), SHAFT_HZ)
    assert (said.result, said.level) == ('ambiguous', 'suspect'), said.reasons
    assert set(said.faults) == {'ball', 'cage'}


@pytest.mark.parametrize('off', [1.0, 1.03])
def test_an_outer_race_whose_balls_are_not_alike_is_named(rng, off):
    """It swells with the cage as well, and with the unbalance of a shaft of unsure speed."""
    orders = fault_orders(find_bearing('6205'), 0.01)
    times = np.cumsum((1.0 + 0.004 * rng.standard_normal(360)) / (orders.bpfo * SHAFT_HZ))
    turns = SHAFT_HZ * times
    load = 1.0 + 0.25 * np.cos(2.0 * np.pi * orders.ftf * turns) + 0.15 * np.cos(2 * np.pi * turns)
    x = _strikes(times, 8.0 * load) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, find_bearing('6205'), off * SHAFT_HZ)
    assert (said.result, said.level) == ('outer', 'fault'), said.reasons


@pytest.mark.parametrize(
    ('off', 'faults', 'why'),
    [(0.95, (), '25.3 Hz (outer) would fit'), (1.05, ('outer',), 'it needs a slip of 3.2 %')],
)
def test_another_speed_is_said_and_no_other_fault_is_named(rng, off, faults, why):
    bearing = find_bearing('6205')
    times = np.arange(0.0, SECONDS, 1.0 / (fault_orders(bearing, 0.005).bpfo * SHAFT_HZ))
    x = _strikes(times, 8.0) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, bearing, SHAFT_HZ * off)
    assert (said.level, said.faults) == ('suspect', faults), said.reasons
    assert why in said.reasons[-1]


@pytest.mark.parametrize('turns', [1, 2, 3])
def test_strong_strikes_in_time_with_the_shaft_are_not_ok(rng, turns):
    x = _strikes(np.arange(0.0, SECONDS, 1.0 / (turns * SHAFT_HZ)), 10.0)
    said = diagnose_record(x + rng.standard_normal(N), RATE, find_bearing('6205'), SHAFT_HZ)
    assert (said.level, said.faults) == ('suspect', ()), said.reasons
    assert f': {turns} a turn' in said.reasons[0], said.reasons


def test_a_load_that_turns_with_the_shaft_is_sound_however_deep(rng):
    """A rotating force modulates by 1 + cos at most."""
    load = 1.0 + np.cos(2.0 * np.pi * SHAFT_HZ * np.arange(N) / RATE)
    said = diagnose_record(load * rng.standard_normal(N), RATE, find_bearing('6205'), SHAFT_HZ)
    assert said.level == 'ok', said.reasons


@pytest.mark.parametrize('slip', [0.0, 0.01])
@pytest.mark.parametrize(
    ('marked', 'faults', 'rule'),
    [
        (('outer', 'inner'), {'inner', 'outer', 'ball'}, 'both_races'),
        # The orders of both are as 2 to 3: the third line of the outer is the second of the inner.
        (('outer',), {'outer'}, 'weak_modulation'),
        (('inner',), {'inner'}, 'weak_modulation'),
    ],
)
def test_faint_marks_on_both_races_are_of_no_race_alone(rng, slip, marked, faults, rule):
    """A ball that is damaged marks both; nine balls pass both together nine times a turn."""
    bearing = find_bearing('6205')
    orders = fault_orders(bearing, slip)
    x = rng.standard_normal(N)
    for place in marked:
        x += _strikes(np.arange(0.0, SECONDS, 1.0 / (orders.impacts(place) * SHAFT_HZ)), 2.7)
    said = diagnose_record(x, RATE, bearing, SHAFT_HZ)
    assert (said.rule, said.level, set(said.faults)) == (rule, 'suspect', faults), said.reasons


@pytest.mark.parametrize('off', [-0.001, 0.001])
def test_both_races_are_found_where_the_given_speed_is_a_little_off(rng, off):
    """No line of the shaft tells it, and the orders of the races add up to 9 (1 - off)."""
    bearing = find_bearing('6205')
    orders = fault_orders(bearing)
    x = rng.standard_normal(N)
    for place in ('outer', 'inner'):
        x += _strikes(np.arange(0.0, SECONDS, 1.0 / (orders.impacts(place) * SHAFT_HZ)), 2.7)
    said = diagnose_record(x, RATE, bearing, SHAFT_HZ * (1.0 + off))
    assert said.shaft_hz == pytest.approx(SHAFT_HZ * (1.0 + off)), said.reasons
    assert said.rule == 'both_races', said.reasons


@pytest.mark.parametrize('given', ['6307', '6304'])
def test_an_inner_race_beyond_the_orders_of_the_given_bearing_is_no_sideband(rng, given):
    """That of a 6205 has a sideband one order below, where an inner race of a 6304 strikes."""
    order = fault_orders(find_bearing('6205'), 0.003).bpfi
    gaps = (1.0 + 0.005 * rng.standard_normal(1050)) / (order * SHAFT_HZ)
    times = np.cumsum(gaps)
    height = np.maximum(np.cos(2.0 * np.pi * SHAFT_HZ * times), 0.0) ** 2
    x = _strikes(times, 8.0 * height) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, find_bearing(given), SHAFT_HZ)
    assert (said.level, said.faults) == ('suspect', ()), said.reasons
    assert re.search(r'at 5\.4[123]\d orders', said.reasons[-1]), said.reasons


def test_impacts_in_bursts_of_seconds_are_an_alarm(rng):
    """Two loud seconds of eight modulate their noise; relative to each second that is little."""
    bearing, t = find_bearing('6205'), np.arange(2 * N) / RATE
    passed = (t * fault_orders(bearing).bpfo * SHAFT_HZ) % 1.0
    burst = 3.0 * (0.6 + 0.9 * np.exp(-passed / 0.15))
    x = rng.standard_normal(2 * N) * np.where((t >= 3.0) & (t < 5.0), burst, 1.0)
    known = SHAFT_HZ, RATE, bearing, DiagnosisSettings()
    assert Excerpt.of(x, *known).analyse().alone.rule == 'weak_modulation'
    said = diagnose_record(x, RATE, bearing, SHAFT_HZ)
    assert (said.level, said.faults) == ('fault', ('outer',))
    assert 'bursts' in said.reasons[-1]


@pytest.mark.parametrize('timed', [True, False])
def test_groups_of_impacts_once_a_cage_turn_are_a_ball_where_they_keep_its_time(rng, timed):
    """From group to group the spin loses its phase: no comb of the ball is there."""
    bearing = find_bearing('6205')
    orders = fault_orders(bearing, 0.01)
    gap, turn = 1.0 / (orders.impacts('ball') * SHAFT_HZ), 1.0 / (orders.ftf * SHAFT_HZ)
    each = np.arange(0.0, 0.3 * turn, gap)
    groups = np.arange(0.0, SECONDS - turn, turn)[:, np.newaxis]
    if timed:
        times = groups + gap * rng.uniform(size=groups.shape) + each
    else:
        times = groups + rng.uniform(0.0, 0.3 * turn, (len(groups), len(each)))
    x = _strikes(np.sort(times.ravel()), 6.0) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, bearing, SHAFT_HZ)
    assert said.score['ball'] < 5.5
    expected = ('ball', 'fault') if timed else ('ambiguous', 'suspect')
    assert (said.result, said.level) == expected, said.reasons


def _ringing(rng, times, natural_hz, height=1.0):
    """Impacts that ring at a natural frequency, and noise; the ratio of their RMS."""
    shocks = np.zeros(N)
    shocks[(times[times < SECONDS] * RATE).astype(int)] = 1.0
    t = np.arange(int(0.02 * RATE)) / RATE
    omega = 2.0 * np.pi * natural_hz
    ring = np.exp(-0.04 * omega * t) * np.sin(omega * t)
    x = np.convolve(shocks, ring)[: len(shocks)]
    return height * x / x.std() + rng.standard_normal(len(x))


@pytest.mark.parametrize('rate', [30.0, 100.0])
def test_impacts_without_a_period_are_no_health(rng, rate):
    """Worn surfaces, dirt, discharges, cavitation: no comb, and nothing that a load does."""
    x = _ringing(rng, np.cumsum(rng.exponential(1.0 / rate, int(8.0 * rate))), 4000.0, 3.0)
    said = diagnose_record(x, RATE, find_bearing('6205'), 25.0)
    assert (said.result, said.level, said.rule) == ('suspect', 'suspect', 'bursts')
    # Noise that swells with a load that turns is none.
    swell = 1.0 + 0.9 * np.cos(2.0 * np.pi * SHAFT_HZ * np.arange(len(x)) / RATE)
    noise = diagnose_record(swell * rng.standard_normal(len(x)), RATE, find_bearing('6205'), 25.0)
    assert noise.rule != 'bursts'


@pytest.mark.parametrize('natural_hz', [2000.0, 2500.0])
def test_an_outer_race_that_rings_where_the_compliance_shows_is_no_health(rng, natural_hz):
    """Twelve times its frequency is 4.3 kHz: all that rings lies below."""
    bearing = find_bearing('6205')
    gap = 1.0 / (100.0 * fault_orders(bearing, 0.005).bpfo)
    times = gap * (np.arange(1, int(4.0 / gap)) + 0.01 * rng.standard_normal(int(4.0 / gap) - 1))
    said = diagnose_record(_ringing(rng, times, natural_hz), RATE, bearing, 100.0)
    assert said.result != 'healthy'
    assert not any('fit no part of' in reason for reason in said.reasons)


@pytest.mark.parametrize(
    ('factor', 'result', 'level'),
    [(0.75, 'suspect', 'suspect'), (1.2, 'suspect', 'suspect'), (1.5, 'ambiguous', 'fault')],
)
def test_a_shaft_that_shows_at_another_speed_is_said(rng, factor, result, level):
    """At a speed 1.5 times too high an inner race of a 6205 strikes as its outer race would."""
    bearing, t = find_bearing('6205'), np.arange(N) / RATE
    times = np.arange(0.0, SECONDS, 1.0 / (fault_orders(bearing, 0.005).bpfi * SHAFT_HZ))
    lines = sum(np.cos(2.0 * np.pi * k * SHAFT_HZ * t + k) / k for k in range(1, 5))
    x = _ringing(rng, times, 3000.0, 1.5) + lines
    said = diagnose_record(x, RATE, bearing, factor * SHAFT_HZ)
    assert (said.result, said.level) == (result, level)
    found = re.search(
        r'but at (.*) Hz, and at that speed it is a fault of the inner', said.reasons[-1]
    )
    assert found and float(found[1]) == pytest.approx(SHAFT_HZ, rel=0.002)
    # Lines of the given speed leave nothing to ask.
    assert diagnose_record(x, RATE, bearing, SHAFT_HZ).faults == ('inner',)


@pytest.mark.parametrize('even', [False, True])
def test_a_place_is_not_named_where_the_shaft_shows_at_the_speed_of_another_place(rng, even):
    """Also in a stream; even harmonics of a bent shaft show at twice its speed more clearly."""
    bearing, t = find_bearing('6205'), np.arange(N) / RATE
    times = np.arange(0.0, SECONDS, 1.0 / (fault_orders(bearing, 0.005).bpfi * SHAFT_HZ))
    heights = {k: (4.0 if even and k % 2 == 0 else 1.0) / k for k in range(1, 9)}
    lines = sum(a * np.cos(2.0 * np.pi * k * SHAFT_HZ * t + k) for k, a in heights.items())
    x = _ringing(rng, times, 3000.0, 1.5) + lines
    settings = DiagnosisSettings(window=SECONDS)
    stream = StreamingDiagnoser(bearing, settings).push(0, x, RATE, 1.5 * SHAFT_HZ)
    for said in (stream[-1], diagnose_record(x, RATE, bearing, 1.5 * SHAFT_HZ)):
        assert (said.result, said.level) == ('ambiguous', 'fault')
        assert sorted(said.faults) == ['inner', 'outer']
        assert any('but at 25.4 Hz' in reason for reason in said.reasons), said.reasons
    assert diagnose_record(x, RATE, bearing, SHAFT_HZ).faults == ('inner',)
    # A measured speed is believed.
    measured = StreamingDiagnoser(bearing, settings)
    [*_, said] = measured.push(0, x, RATE, 1.5 * SHAFT_HZ, speed_measured=True)
    assert said.faults == ('outer',)


@pytest.mark.parametrize(
    ('given_hz', 'found'), [(25.0, {}), (37.5, {'one': 25.0, 'two': 50.0}), (50.0, {})]
)
def test_a_shaft_that_shares_lines_with_one_as_clear_is_no_other_shaft(given_hz, found):
    power = np.ones(8001, np.float32)
    power[100 * np.arange(1, 13)] = 1e4
    ranges = {'one': (24.0, 26.0), 'half': (36.5, 38.5), 'two': (49.0, 51.0)}
    known = power, 0.25, given_hz, 0.01, ranges
    assert shafts_instead_hz(*known, np.empty(0)) == pytest.approx(found, abs=0.05)
    # Lines of a fault are no shaft's.
    assert shafts_instead_hz(*known, 25.0 * np.arange(1.0, 13.0)) == {}


def test_lines_of_a_named_fault_are_no_other_shaft(rng, monkeypatch):
    bearing, asked = find_bearing('6205'), []
    order = fault_orders(bearing, 0.005).bpfo
    times = np.arange(0.0, SECONDS, 1.0 / (order * SHAFT_HZ))
    at = order * SHAFT_HZ
    monkeypatch.setattr(Analysis, 'may_show', lambda _, hertz, clearest: asked.append(hertz))
    monkeypatch.setattr(record, 'other_shafts_hz', lambda *_: [at + 0.1, at + 1.0])
    said = diagnose_record(_ringing(rng, times, 3000.0, 1.5), RATE, bearing, SHAFT_HZ)
    assert said.faults == ('outer',) and said.fault_hz == pytest.approx(at, abs=0.1)
    assert asked == [at + 1.0]


def test_pulsation_of_blades_is_no_alarm(rng):
    """Noise that swells five times a turn, smoothly; the inner race of a 6203 is at 4.95."""
    t = np.arange(int(8.0 * RATE)) / RATE
    swell = 1.0 + 0.4 * np.cos(2.0 * np.pi * 5.0 * 24.75 * t)
    said = diagnose_record(swell * rng.standard_normal(len(t)), RATE, find_bearing('6203'), 25.0)
    assert (said.result, said.level) == ('suspect', 'suspect')
    assert any('blades' in reason for reason in said.reasons)


def test_a_smooth_swell_of_sound_parts_in_a_short_window_is_no_remark():
    """Passing balls modulate the noise of a sound bearing by up to 16 %; impacts are else."""
    bearing, seconds = find_bearing('6205'), 60.0 / SHAFT_HZ
    n = int(seconds * RATE)
    said = {'swell': [], 'impacts': []}
    for seed in range(6):
        rng = np.random.default_rng(seed)
        hertz = fault_orders(bearing, 0.01 * rng.random()).bpfo * SHAFT_HZ
        noise, phase = rng.standard_normal((2, n)), hertz * np.arange(n) / RATE
        records = {
            'swell': noise[0] * (1.0 + 0.14 * np.cos(2.0 * np.pi * phase)),
            'impacts': noise[0] + noise[1] * (phase % 1.0 < 0.15),
        }
        for name, x in records.items():
            found = diagnose_record(x, RATE, bearing, SHAFT_HZ, speed_tolerance=0.002)
            said[name].append(found.result)
    assert said['swell'].count('suspect') <= 1, said
    assert said['impacts'] == 6 * ['suspect'], said


def test_pulses_of_the_mains_are_no_impacts_of_another_machine():
    """Rectifiers pulse at 100 Hz; other impacts are still heard among them."""
    bearing = find_bearing('6307')
    rng = np.random.default_rng(0)
    noise = signal.lfilter([1.0], [1.0, -0.9], rng.standard_normal(N))
    pulses = noise / noise.std() + _strikes(np.arange(0.0, SECONDS, 0.01), 4.0)
    both = pulses + _strikes(np.arange(0.0, SECONDS, 1.0 / (3.4 * SHAFT_HZ)), 8.0)
    found = [
        diagnose_record(x, RATE, bearing, SHAFT_HZ, speed_tolerance=0.002) for x in (pulses, both)
    ]
    assert found[0].result == 'healthy', found[0].reasons
    assert found[1].kind == 'elsewhere', found[1].reasons
    assert 'at 3.40' in found[1].reasons[0]
