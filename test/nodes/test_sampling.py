# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""From other people's samples to blocks: nothing is lost, shifted or invented unseen."""

from bearing_twin.errors import BearingTwinError
from bearing_twin.streams.samplerate import FEWEST, RateMeter
from bearing_twin.streams.sampling import (
    BlockBuilder,
    SequenceTracker,
    split_channels,
    StampTracker,
)
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

NANO = 1_000_000_000


def stamps(rate, count, jitter=0.0):
    """Stamps of a regular source whose clock reading jitters by a part of the period."""
    wobble = np.random.default_rng(0).uniform(-jitter, jitter, count)
    return np.round((np.arange(count) + wobble) * NANO / rate).astype(np.int64) + 5 * NANO


@given(st.lists(st.integers(1, 700), min_size=1, max_size=30), st.integers(64, 300))
def test_blocks_hold_every_sample_once_in_order(sizes, size):
    rate = 1000.0
    builder = BlockBuilder(size)
    signal = np.arange(2 * sum(sizes), dtype=np.float32).reshape(2, -1)
    blocks, done = [], 0
    for n in sizes:
        blocks += builder.push(
            signal[:, done : done + n], stamp=round(done * NANO / rate), rate=rate
        )
        done += n
    blocks += builder.gap(7)
    assert np.array_equal(np.concatenate([b.samples for b in blocks], axis=1), signal)
    assert all(b.samples.shape[1] == size for b in blocks[:-1])
    assert builder.next_sample == signal.shape[1] + 7
    for b in blocks:
        assert b.samples[0, 0] == b.first_sample
        assert abs(b.stamp - b.first_sample * NANO / rate) <= 1


def test_restarted_source_begins_at_sample_0():
    builder = BlockBuilder(4)
    builder.push(np.ones((1, 6), np.float32), stamp=0, rate=100.0)
    [rest] = builder.gap(-3)
    assert (rest.first_sample, rest.samples.shape) == (4, (1, 2))
    assert builder.next_sample == 0


@pytest.mark.parametrize('given', [1000.0, 1005.0, 0.0])
@pytest.mark.parametrize('jitter', [0.0, 0.4])
def test_stamps_show_what_is_missing(given, jitter):
    times = stamps(1000.0, 4000, jitter)
    keep = np.ones(4000, bool)
    keep[2000:2005] = False
    keep[3000:3500] = False
    tracker = StampTracker(given)
    gaps = {k: m for k in np.flatnonzero(keep) if (m := tracker.missing(int(times[k])))}
    assert [int(k) for k in gaps] == [2005, 3500]
    off = 0 if given != 1005.0 and not jitter else 1
    assert abs(gaps[2005] - 5) <= off
    assert abs(gaps[3500] - 500) <= (3 if given == 1005.0 else off)


def test_regular_stamps_show_a_single_missing_sample():
    times = np.delete(stamps(1000.0, 2000, 0.05), 1500)
    tracker = StampTracker(1000.0)
    gaps = {k: m for k, t in enumerate(times) if (m := tracker.missing(int(t)))}
    assert gaps == {1500: 1}


def test_unknown_rate_is_estimated_in_spite_of_losses():
    times = stamps(800.0, 600, 0.2)
    tracker = StampTracker(0.0)
    for k, t in enumerate(times):
        if k % 10 != 3:
            tracker.missing(int(t))
        if tracker.rate:
            break
    assert tracker.rate == pytest.approx(800.0, rel=2e-3)


def test_clock_set_back_is_a_restart():
    tracker = StampTracker(1000.0)
    for t in stamps(1000.0, 100):
        assert tracker.missing(int(t)) == 0
    assert tracker.missing(NANO) < 0
    assert tracker.missing(NANO + 1_000_000) == 0


def test_stamps_of_a_source_that_was_held_up_are_told_from_losses_and_restarts():
    held_up = stamps(1000.0, 2000)
    held_up[1000:1006] = held_up[1006] - np.arange(6, 0, -1) * 10_000
    lost = np.delete(stamps(1000.0, 2000), slice(1000, 1006))
    restarted = np.concatenate([stamps(1000.0, 1000), stamps(1000.0, 1000)])
    for times, some in ((held_up, True), (lost, False), (restarted, False)):
        tracker = StampTracker(1000.0)
        crowded = []
        for t in times:
            tracker.missing(int(t))
            crowded.append(tracker.crowded)
        assert any(crowded) == some


def test_message_numbers_show_missing_messages_and_new_sources():
    tracker = SequenceTracker()
    answers = [tracker.missing('a', n) for n in (7, 8, 11)]
    assert answers == [0, 0, 2]
    assert tracker.missing('b', 1) < 0
    assert tracker.missing('b', None) == 0
    assert tracker.missing('b', 5) == 0


def test_channels_are_taken_apart():
    assert split_channels(np.arange(6), 2, interleaved=True).tolist() == [[0, 2, 4], [1, 3, 5]]
    assert split_channels(np.arange(6), 2, interleaved=False).tolist() == [[0, 1, 2], [3, 4, 5]]
    with pytest.raises(BearingTwinError, match='7 values do not divide into 2 channels'):
        split_channels(np.arange(7), 2, interleaved=True)


def metered(rate, seconds, *, late=0.0, pause=0.0, seed=0):
    """Meter after blocks of a source; ``late`` is the jitter of their stamps, s."""
    rng = np.random.default_rng(seed)
    meter, block = RateMeter(), 512
    for k in range(round(seconds * rate / block)):
        time = k * block / rate + rng.exponential(late) + (pause if k * block / rate > 5 else 0.0)
        meter.take(k * block, 10**18 + round(time * NANO))
    return meter


def test_a_rate_that_is_declared_wrong_is_told_with_the_one_that_fits():
    problem = metered(12000.0, 5, late=0.005).problem(25600.0)
    assert problem.refused
    said = int(problem.text.rsplit(' ', 1)[1])
    assert said == pytest.approx(12000, rel=0.01)


def test_a_source_that_changes_its_rate_is_told_the_new_one_and_none_between():
    meter, said = RateMeter(), set()
    for second in range(40):
        # A pause of half a second is no other rate.
        index = 2000 * second - (1000 if 10 <= second < 20 else 0)
        index = index if second < 20 else 40_000 + 4000 * (second - 20)
        meter.take(index, second * NANO)
        if problem := meter.problem(2000.0):
            said.add(problem.text)
    assert said == {
        '4000 samples a second arrive, sample_rate says 2000 (+100.0 %): set sample_rate to 4000'
    }


@pytest.mark.parametrize(('rate', 'warned'), [(25600.0, False), (25200.0, False), (24900.0, True)])
@pytest.mark.parametrize('seed', range(5))
def test_late_stamps_and_pauses_are_no_wrong_rate(rate, warned, seed):
    problem = metered(rate, 40, late=0.002, pause=0.7, seed=seed).problem(25600.0)
    assert (problem is not None) == warned
    assert not (problem and problem.refused)


def test_undated_samples_and_restarts_have_no_measured_rate():
    meter = RateMeter()
    for k in range(50):
        meter.take(25600 * k, 0)
    assert meter.problem(25600.0) is None
    assert metered(12000.0, FEWEST).problem(25600.0) is None
    meter = metered(12000.0, FEWEST + 2)
    assert meter.problem(25600.0) is not None
    meter.take(0, 2 * 10**18)
    assert meter.problem(25600.0) is None
    # Snapshots whose samples are all counted from 0.
    for k in range(20):
        meter.take(0, 3 * 10**18 + k * 10**10)
        assert meter.problem(25600.0) is None
        assert not meter.doubts(25600.0)


def test_a_single_loss_among_the_first_samples_is_counted():
    times = np.delete(stamps(1000.0, 300, 0.05), [3, 200])
    tracker = StampTracker(1000.0)
    gaps = {index: gap for index, stamp in enumerate(times) if (gap := tracker.missing(stamp))}
    assert gaps == {3: 1, 199: 1}
