# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The held level: a machine at the edge of a rule keeps it, a machine that changes is told."""

from dataclasses import asdict, replace
from itertools import pairwise
import math

from bearing_twin.diagnosis.machine.held import HeldLevel, Pace
from bearing_twin.errors import BearingTwinError
from bearing_twin.packed import restored
import numpy as np
import pytest
from scipy.special import ndtri

PACE = Pace()


def _held(levels, held=None, pace=PACE):
    held = held or HeldLevel()
    return [held.take(level, pace) for level in levels]


@pytest.mark.parametrize('share', [0.005, 0.03, 0.3, 0.7, 0.97])
def test_a_steady_machine_at_the_edge_changes_its_level_at_most_twice_in_any_hour(share):
    """Each window shares seven of its eight seconds with the next one."""
    rng, most, plain = np.random.default_rng(0), [], []
    for _ in range(3):
        evidence = np.convolve(rng.standard_normal(3 * 3600), np.full(8, 8**-0.5), 'valid')
        own = np.where(evidence > ndtri(1.0 - share), 'fault', 'suspect').tolist()
        for levels, found in ((_held(own), most), (own, plain)):
            at = np.flatnonzero(np.array(levels[1:]) != np.array(levels[:-1]))
            found.append(max(np.searchsorted(at, at + 3600) - np.arange(len(at)), default=0))
    assert max(most) <= 2 < min(plain)


@pytest.mark.parametrize(('asked', 'longest'), [(3, 3600), (16, 230), (60, 33), (600, 12)])
def test_the_longer_a_fault_was_seen_the_sooner_its_end_is_told(asked, longest):
    levels = _held(['ok'] * 5 + ['fault'] * asked + ['ok'] * 3600)
    assert (levels[6], levels[7]) == ('ok', 'fault')
    assert levels.count('fault') == pytest.approx(asked - 2 + longest, abs=1 + 0.02 * longest)


def test_the_pause_is_that_of_the_rule_of_succession():
    """Share p uniform, nine windows of ten asked besides the one that raised the level."""
    p = (np.arange(1_000_000) + 0.5) / 1_000_000
    weight = p**9 * (1.0 - p)
    held = HeldLevel('fault', ['fault'] * 3, times=[0.0, 0.0, 8.0, 80.0])
    pause = held.wait(PACE)
    for seconds, unlikely in ((pause, True), (pause - 1.0, False)):
        chance = (weight * (1.0 - p) ** (seconds / 8.0)).sum() / weight.sum()
        assert (chance <= 8.0 / 3600.0) == unlikely


def test_an_alarm_that_comes_back_stays_for_an_hour_without_it():
    once = ['fault'] * 60 + ['ok'] * 60
    held = HeldLevel()
    levels = _held(['ok', *once, *once, *once], held)
    changes = [(a, b) for a, b in pairwise(levels) if a != b]
    assert changes == [('ok', 'fault'), ('fault', 'ok'), ('ok', 'fault')]
    assert held.wait(PACE) == 3600.0
    assert _held(['ok'] * 3600, held).index('ok') == 3600 - 60 - 1
    # After an hour without it, it is a new one.
    _held(['ok'] * 3600 + ['fault'] * 60, held)
    assert held.wait(PACE) == pytest.approx(33.0, abs=2.0)


def test_the_alarm_of_a_twin_ends_as_soon_however_often_its_defect_is_put_in():
    once = ['fault'] * 60 + ['ok'] * 60
    levels = _held(['ok', *once * 3], pace=Pace(simulated=True))
    falls = [n for n, (a, b) in enumerate(pairwise(levels)) if (a, b) == ('fault', 'ok')]
    assert np.diff(falls).tolist() == [120, 120]


def test_the_highest_of_the_newest_levels_is_what_a_level_falls_to():
    held = HeldLevel()
    levels = _held(['fault'] * 120 + ['suspect', 'ok'] * 60, held)
    assert set(levels[:120]) == {'fault'}
    assert levels[-1] == 'suspect'
    assert 'ok' not in levels


@pytest.mark.parametrize('between', [15, 60, 600])
def test_a_fault_that_fades_away_over_suspect_ends_as_soon_as_one_that_goes_at_once(between):
    """Verdicts that ask for a fault ask for a suspicion as well."""
    levels = _held(['ok'] * 5 + ['fault'] * 600 + ['suspect'] * between + ['ok'] * 3600)
    assert levels[605:].index('suspect') == 11
    assert levels[605 + between :].index('ok') <= 11


def test_verdicts_that_ask_for_different_higher_levels_raise_it_to_the_lower_one():
    assert _held(['ok'] + ['suspect', 'fault'] * 2 + ['fault'] * 2) == (
        ['ok'] * 3 + ['suspect'] * 3 + ['fault']
    )


def test_a_first_verdict_that_no_other_one_confirms_does_not_last():
    assert _held(['suspect', 'none', 'none', 'none', 'ok', 'ok', 'ok']) == (
        ['suspect'] * 3 + ['none'] * 3 + ['ok']
    )


def test_without_a_longest_hold_a_level_falls_after_as_many_verdicts_as_it_rises():
    own = ['ok'] * 3 + ['fault', 'fault', 'fault', 'ok', 'ok', 'ok'] * 2
    levels = _held(own, pace=Pace(longest=0.0))
    assert levels == (own[:1] * 2 + own)[: len(own)]


def test_a_saved_level_goes_on_to_the_bit_and_another_one_is_refused():
    own = ['ok', *['fault'] * 20, *['suspect'] * 30, *['fault'] * 7, 'ok', 'ok']
    held = HeldLevel()
    _held(own, held)
    again = restored(HeldLevel, asdict(held))
    assert again == held
    assert _held(own, held) == _held(own, again)
    assert again == held
    wrong = {'level': 'broken', 'newest': ['broken'], 'quiet': math.nan, 'times': [-1.0] * 4}
    for name, value in [*wrong.items(), ('times', [1.0])]:
        with pytest.raises(BearingTwinError, match='saved level'):
            replace(held, **{name: value})
