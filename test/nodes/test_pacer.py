# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Deadlines are absolute, lateness is counted, gaps are seen."""

from fractions import Fraction
from itertools import pairwise
import math

from bearing_twin.errors import BearingTwinError
from bearing_twin.streams.pacer import Pacer
from hypothesis import given
from hypothesis import strategies as st
import pytest

SECOND = 1_000_000_000
PERIOD = 40_000_000


def pacer(**changes):
    made = Pacer(**{'block': 1024, 'rate': 25600.0, 'catch_up': 5, 'late_after': 0.02, **changes})
    made.anchor(ticks=0, time=7 * SECOND)
    return made


def run(p, ticks, offset=7 * SECOND):
    return p.due(ticks=ticks, time=ticks + offset)


def test_one_block_a_period_and_stamps_follow_the_index():
    p = pacer()
    assert run(p, PERIOD - 1) == []
    blocks = [block for k in range(1, 1001) for block in run(p, k * PERIOD + 1000)]
    assert [b.first_sample for b in blocks] == [1024 * k for k in range(1000)]
    assert [b.stamp for b in blocks] == [7 * SECOND + k * PERIOD for k in range(1000)]
    assert p.report().late == 0
    assert p.report().p99 == pytest.approx(1e-6)


def test_catches_up_then_skips_and_counts():
    p = pacer()
    assert len(run(p, 4 * PERIOD)) == 4
    late = run(p, 24 * PERIOD)
    assert [b.first_sample // 1024 for b in late] == [19, 20, 21, 22, 23]
    assert [b.number for b in late] == [5, 6, 7, 8, 9]
    assert [b.dropped for b in late] == [15] * 5
    assert p.report().dropped == 15
    assert late[0].lateness == pytest.approx(4 * 0.04)
    assert p.report().published == 9


def test_what_waits_is_known_until_the_clock_is_set():
    p = pacer(behind=20)
    assert [len(run(p, 12 * PERIOD)) for _ in range(2)] == [5, 5]
    assert p.waiting == 2
    assert len(run(p, 99 * PERIOD)) == 5
    assert p.waiting == 15
    p.step(ticks=0, time=0)
    assert p.waiting == 0


def test_the_time_since_the_last_late_block_is_that_of_the_blocks_since():
    p = pacer()
    run(p, PERIOD)
    assert p.punctual == math.inf
    run(p, 2 * PERIOD + 20_000_001)
    assert p.punctual == 0.0
    for k in range(3, 103):
        run(p, k * PERIOD + 20_000_000)
    assert p.punctual == pytest.approx(4.0)
    assert p.report().late == 1


def test_the_phase_is_the_elapsed_part_of_the_period():
    p = pacer()
    run(p, 3 * PERIOD)
    parts = [p.phase(round((3.0 + part) * PERIOD)) for part in (-1.0, 0.0, 0.25, 0.75, 2.0)]
    assert parts == pytest.approx([0.0, 0.0, 0.25, 0.75, 1.0])
    p.release()
    assert p.phase(4 * PERIOD) == 0.0


def test_what_may_wait_is_given_out_by_the_next_calls():
    p = pacer(behind=12)
    times = [24 * PERIOD, 24 * PERIOD, 25 * PERIOD, 25 * PERIOD]
    given_out = [[b.first_sample // 1024 for b in run(p, ticks)] for ticks in times]
    assert given_out == [[12, 13, 14, 15, 16], [17, 18, 19, 20, 21], [22, 23, 24], []]
    assert p.report().dropped == 12


def test_clock_set_back_goes_on_without_a_gap_in_the_index():
    p = pacer()
    run(p, 3 * PERIOD)
    assert run(p, 0) == []
    [block] = run(p, PERIOD)
    assert block.first_sample == 3 * 1024
    assert block.stamp == 7 * SECOND
    assert p.report().clock_steps == 1


def test_stepped_wall_clock_moves_the_stamps_only():
    p = pacer()
    run(p, 3 * PERIOD)
    [block] = run(p, 4 * PERIOD, offset=8 * SECOND)
    assert block.stamp == 8 * SECOND + 3 * PERIOD
    assert block.first_sample == 3 * 1024
    assert p.report().clock_steps == 1


@given(
    st.lists(st.integers(min_value=0, max_value=3 * SECOND), min_size=1, max_size=60),
    st.sampled_from([12800.0, 25600.0, 44100.0, 51200.0]),
)
def test_blocks_are_never_early_and_index_and_counts_agree(gaps, rate):
    p = pacer(rate=rate)
    ticks = 0
    blocks = []
    for gap in gaps:
        ticks += gap
        new = run(p, ticks)
        assert len(new) <= 5
        for block in new:
            assert block.lateness >= -1e-9
            assert abs(block.stamp - 7 * SECOND - block.first_sample * SECOND / rate) <= 1.0
        blocks += new
    report = p.report()
    assert len(blocks) == report.published
    assert p.next_sample == 1024 * (report.published + report.dropped)
    assert all(b.first_sample > a.first_sample for a, b in pairwise(blocks))


WEEK = 7 * 24 * 3600 * SECOND


@pytest.mark.parametrize('begun', [0, WEEK, 10 * WEEK])
@pytest.mark.parametrize('rate', [12000.0, 24000.0, 25600.0, 44100.0, 48000.0])
def test_a_timer_of_whole_nanoseconds_keeps_the_deadlines_for_weeks(rate, begun):
    """The timer does as rcl's: it moves its next call by its period and calls."""
    p = pacer(rate=rate)
    first = round(begun * rate / SECOND / p.block)
    p.next_sample = first * p.block
    period = round(p.period * SECOND)
    # Off by a part of a period, as after a stall: the second wake-up is in time again.
    at = p.wake_up(p._offset(p.next_sample)) + period // 3
    numbers = []
    for n in range(2000):
        ticks = at + 1000
        at += period
        period = p.wake_up(at) - at
        for block in run(p, ticks):
            numbers.append(block.first_sample // p.block)
            assert block.lateness <= (2e-6 if n > 1 else p.period / 2.0)
    assert numbers == list(range(first, first + 2000))


@given(
    st.integers(0, 10**9),
    st.sampled_from([12000.0, 12800.0, 25600.0, 44100.0, 48000.0]),
    st.integers(1, 40),
    st.floats(-0.49, 0.49),
)
def test_wake_ups_are_exact_for_a_year(number, rate, slots, off):
    p = pacer(rate=rate)
    spacing = Fraction(p.block * SECOND) / (Fraction(rate) * slots)
    found = p.wake_up(math.ceil(number * spacing + Fraction(off) * spacing), slots)
    # A rounding of a double or two, and never before the deadline that the block has.
    assert abs(found - math.ceil((number + 1) * spacing)) <= 16
    if slots == 1:
        p.next_sample = number * p.block
        assert found >= p._offset(p.next_sample + p.block)


def test_a_pacer_that_is_released_begins_anew_with_the_next_call():
    p = pacer()
    run(p, 3 * PERIOD)
    p.release()
    # Three seconds have passed meanwhile: nothing of them is late or dropped.
    assert run(p, 3 * SECOND) == []
    [block] = run(p, 3 * SECOND + PERIOD)
    assert (block.first_sample, block.lateness, block.dropped) == (3 * 1024, 0.0, 0)


def test_refuses_nonsense():
    with pytest.raises(BearingTwinError, match='must be positive'):
        Pacer(block=0, rate=25600.0, catch_up=5, late_after=0.02)
