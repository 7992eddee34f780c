# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A stream of which each cycle gives one snapshot: cut, judged, saved."""

from dataclasses import asdict, replace
from itertools import pairwise
import math
import zlib

from bearing_twin.bearing import find_bearing
from bearing_twin.diagnosis.series.averaging import Comb
from bearing_twin.diagnosis.series.snapshots import _VERSION, SeriesDiagnoser
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.errors import BearingTwinError
from bearing_twin.packed import pack, unpack
from coupling import coupling_snapshot, GIVEN_HZ
import numpy as np
import pytest

RATE = 25600.0


def played(diagnoser, numbers, *, worn, index=None, height=5.0):
    """Half a second of noise each ten minutes, in blocks of 512 samples."""
    said = []
    for number in numbers:
        rng = np.random.default_rng(number)
        x = (height if number >= worn else 1.0) * rng.standard_normal(5 * 2560)
        first = round(600.0 * number * RATE) if index is None else index
        for start in range(0, len(x), 512):
            block = x[start : start + 512]
            due = diagnoser.take(first + start, block, RATE, 25.0, temperature=60.0, sensor='y')
            said += [diagnoser.judge(excerpt.analyse()) for excerpt in due]
    return said


def packed(values, arrays):
    return zlib.compress(pack(_VERSION, values, arrays))


CYCLE_SETTINGS = DiagnosisSettings(
    series_cycle=600.0, series_snapshot=0.5, baseline_windows=20, longest_hold=1200.0
)


@pytest.mark.parametrize('index', [None, 0])
def test_snapshots_of_a_stream_with_gaps_are_judged_as_one_series(index):
    """Whether the index goes on over the gap or starts anew with each snapshot."""
    diagnoser = SeriesDiagnoser(find_bearing('6307'), CYCLE_SETTINGS)
    said = played(diagnoser, range(66), worn=50, index=index)
    # What has no next block yet, is not whole: half a second is 25 blocks exactly.
    assert len(said) == 66
    assert {d.level for d in said[:24]} == {'none', 'ok'}
    assert {d.level for d in said[25:50]} == {'ok'}
    assert said[-1].level == 'fault' and said[-1].result == 'ambiguous'
    assert said[-1].severity.level_over_baseline == pytest.approx(14.0, abs=0.5)
    assert said[-1].window == ('insufficient', 'none')
    # No rule of a snapshot gave it.
    assert said[-1].rule == ''
    # 14 dB over the baseline, whatever the place.
    assert said[-1].severity.stage == 4
    # Each counts 3 dB, so 14 of them are a rise; sixteen snapshots are 160 minutes.
    assert [said[62].severity.rising, said[63].severity.rising] == [0, 140]
    assert said[-1].severity.rising == 160
    assert any(reason.startswith('series: ') for reason in said[-1].reasons)


@pytest.mark.parametrize(
    ('worn', 'before', 'level', 'result'),
    [(30, 'fault', 'fault', 'ambiguous'), (40, 'ok', 'none', 'insufficient')],
)
def test_a_machine_that_stops_keeps_its_alarm_and_is_not_ok(worn, before, level, result):
    diagnoser = SeriesDiagnoser(find_bearing('6307'), CYCLE_SETTINGS)
    assert played(diagnoser, range(40), worn=worn)[-1].level == before
    last = played(diagnoser, range(40, 65), worn=0, height=1e-3)[-1]
    assert (last.level, last.result) == (level, result)
    assert 'does the machine stand still' in ' '.join(last.reasons)


@pytest.mark.parametrize(('seconds', 'zone'), [(0.5, ''), (1.0, 'D')])
def test_half_a_second_raises_no_level_by_its_zone(seconds, zone):
    """30 mm/s are zone D, but a velocity from 10 Hz on takes a second to measure."""
    settings = replace(CYCLE_SETTINGS, power_group=2, mounting='rigid', series_snapshot=seconds)
    diagnoser = SeriesDiagnoser(find_bearing('6307'), settings)
    said = []
    for number in range(5):
        x = 8.0 * np.random.default_rng(number).standard_normal(round(seconds * RATE))
        (due,) = diagnoser.take(round(600.0 * number * RATE), x, RATE, 50.0, unit='g')
        said.append(diagnoser.judge(due.analyse()))
    assert {each.severity.iso_zone for each in said} == {zone}
    # One snapshot does not make a level.
    assert [each.level for each in said[:4]] == ['none'] * 4
    assert (said[4].level == 'fault') == (zone == 'D')


def test_a_snapshot_that_is_worse_than_the_series_changes_no_published_level():
    """One in four is in zone D: the level stays ok, and the message says what that one shows."""
    settings = replace(
        CYCLE_SETTINGS, series_snapshot=1.0, baseline_windows=10, power_group=2, mounting='rigid'
    )
    diagnoser = SeriesDiagnoser(find_bearing('6307'), settings)
    said = []
    for number in range(40):
        x = np.random.default_rng(number).standard_normal(round(RATE))
        if number % 4 == 2:
            x += 9.0 * np.sin(2.0 * np.pi * 20.0 * np.arange(len(x)) / RATE)
        (due,) = diagnoser.take(round(600.0 * number * RATE), x, RATE, 25.0, unit='m/s^2')
        said.append(diagnoser.judge(due.analyse()))
    worse = said[38]
    assert [each.level for each in said] == ['none'] * 9 + ['ok'] * 31
    # No snapshot of 25 turns shows a healthy bearing.
    assert (worse.result, worse.window[1]) == ('insufficient', 'fault')
    assert worse.severity.iso_zone == 'D' and worse.severity.stage == 0 and not worse.faults
    assert worse.reasons[-1] == 'series: ok held; this snapshot alone says ambiguous, fault'
    assert said[2].reasons[-1].startswith('series: level not known yet; this snapshot alone')
    assert (said[39].result, said[39].window) == ('insufficient', ('insufficient', 'none'))


def test_a_healthy_series_stays_so_while_most_snapshots_tell_something():
    """Snapshots of 60 turns tell; those that a gap cuts short, of 25 turns, do not."""
    settings = DiagnosisSettings(
        series_cycle=60.0, series_snapshot=2.4, baseline_windows=10, hold_updates=1
    )
    diagnoser = SeriesDiagnoser(find_bearing('6307'), settings)
    rng, said = np.random.default_rng(3), []
    tells = np.r_[np.ones(20), np.tile([1, 1, 0, 1], 10), np.zeros(20), np.ones(20)].astype(bool)
    for number, whole in enumerate(tells):
        x = rng.standard_normal(round((2.4 if whole else 1.0) * RATE))
        due = diagnoser.take(round(60.0 * number * RATE), x, RATE, 25.0)
        said += [diagnoser.judge(excerpt.analyse()) for excerpt in due]
        if number == 49:
            again = SeriesDiagnoser(find_bearing('6307'), settings)
            again.load(diagnoser.save())
            diagnoser = again
    assert {each.level for each in said[10:]} == {'ok'}
    results = [each.result for each in said[10:]]
    changes = [(n + 11, b) for n, (a, b) in enumerate(pairwise(results)) if a != b]
    # The balance is at most 465 s: eight snapshots.
    assert changes == [(67, 'insufficient'), (87, 'healthy')]
    assert said[62].reasons[-1].startswith('series: healthy held: of single snapshots ')
    assert said[62].window == ('insufficient', 'none') and said[62].confidence == 0.5


def test_held_answer_of_a_series_has_the_rule_of_the_snapshots_that_it_stands_on():
    settings = DiagnosisSettings(series_cycle=600.0, series_snapshot=2.0)
    diagnoser = SeriesDiagnoser(find_bearing('6203'), settings)
    rng, said = np.random.default_rng(9), []
    for number in range(6):
        x = coupling_snapshot(rng) if number < 5 else rng.standard_normal(round(2.0 * RATE))
        (due,) = diagnoser.take(round(600.0 * number * RATE), x, RATE, GIVEN_HZ)
        said.append(diagnoser.judge(due.analyse()))
    assert said[4].window is None
    held = said[5]
    assert held.window == ('insufficient', 'none')
    assert (held.result, held.level, held.rule) == ('ambiguous', 'fault', 'whole_turns')
    assert held.faults == ()


def test_a_series_waits_while_another_bearing_is_set():
    """As the baseline of a stream does; snapshots of the other are judged alone and say so."""
    diagnoser = SeriesDiagnoser(find_bearing('6307'), CYCLE_SETTINGS)
    assert played(diagnoser, range(30), worn=30)[-1].level == 'ok'
    diagnoser.reconfigure(find_bearing('6205'))
    other = played(diagnoser, range(30, 33), worn=30)[-1]
    assert other.level == 'none' and diagnoser.other_source in other.reasons
    diagnoser.reconfigure(find_bearing('6307'))
    said = played(diagnoser, range(33, 38), worn=33)
    assert [each.level for each in said] == ['ok'] * 3 + ['fault'] * 2
    assert not diagnoser.other_source


def test_series_of_a_continuous_stream_takes_one_snapshot_a_cycle():
    settings = DiagnosisSettings(series_cycle=4.0, series_snapshot=1.0, baseline_windows=10)
    diagnoser = SeriesDiagnoser(find_bearing('6307'), settings)
    rng = np.random.default_rng(1)
    firsts = []
    for number in range(20 * 25):
        due = diagnoser.take(1024 * number, rng.standard_normal(1024), RATE, 25.0)
        firsts += [excerpt.first_sample / RATE for excerpt in due]
    assert len(firsts) == pytest.approx(20 / (0.75 * 4.0), abs=1)
    assert np.diff(firsts).min() >= 3.0


def test_a_series_of_a_rate_that_moves_a_little_has_whole_snapshots():
    settings = DiagnosisSettings(series_cycle=4.0, series_snapshot=1.0, baseline_windows=10)
    diagnoser = SeriesDiagnoser(find_bearing('6307'), settings)
    rng = np.random.default_rng(1)
    found = []
    for number in range(5 * 25):
        rate = RATE + 0.01 * (number % 3)
        found += diagnoser.take(1024 * number, rng.standard_normal(1024), rate, 25.0)
    assert len(found) == 2
    assert {excerpt.sample_count for excerpt in found} == {RATE}


def test_a_series_without_a_verdict_says_why():
    diagnoser = SeriesDiagnoser(find_bearing('6307'), CYCLE_SETTINGS)
    played(diagnoser, range(3), worn=0)
    assert not diagnoser.overdue
    for number in range(3, 8):
        first = round(number * 600.0 * RATE)
        assert not diagnoser.take(first, np.ones(20), RATE, 25.0)
        # The next block ends the snapshot.
        assert not diagnoser.take(first + 40, np.ones(20), RATE, 25.0)
    assert diagnoser.overdue == (
        'no verdict in 3000 s of the series: the last snapshot has 20 samples, and 64 are the '
        'least'
    )


def test_a_series_that_pauses_is_not_overdue_when_it_goes_on():
    """A burst each fifth cycle: no snapshot was due while no samples came."""
    diagnoser = SeriesDiagnoser(find_bearing('6307'), CYCLE_SETTINGS)
    for number in range(3):
        diagnoser.take(round(5 * number * 600.0 * RATE), np.ones(20), RATE, 25.0)
        assert not diagnoser.overdue


@pytest.mark.parametrize('share', [-0.01, -5e-5, 5e-5, 0.01])
@pytest.mark.parametrize('restarted', [False, True])
def test_a_series_goes_on_where_the_rate_changes_after_a_year(share, restarted):
    """A rate that is estimated from stamps differs from start to start."""
    diagnoser = SeriesDiagnoser(find_bearing('6307'), CYCLE_SETTINGS)
    rng, index = np.random.default_rng(0), round(365 * 24 * 3600 * RATE)
    for number in range(8):
        if number == 4 and restarted:
            state = diagnoser.save()
            diagnoser = SeriesDiagnoser(find_bearing('6307'), CYCLE_SETTINGS)
            diagnoser.load(state)
        rate = RATE * (1.0 + share) if number >= 4 else RATE
        (due,) = diagnoser.take(index, rng.standard_normal(round(0.6 * RATE)), rate, 25.0)
        diagnoser.judge(due.analyse())
        index += round(600.0 * rate)
    times = [point.time for point in diagnoser._monitor.report().points]
    assert np.diff(times) == pytest.approx(600.0, rel=0.011)
    assert len(times) == 8


def test_a_snapshot_that_is_not_judged_shifts_the_time_of_no_other():
    diagnoser = SeriesDiagnoser(find_bearing('6307'), CYCLE_SETTINGS)
    rng = np.random.default_rng(0)
    taken = [
        diagnoser.take(round(600.0 * number * RATE), rng.standard_normal(12_800), RATE, 25.0)
        for number in range(3)
    ]
    for (excerpt,) in taken[1:]:
        diagnoser.judge(excerpt.analyse())
    assert [point.time for point in diagnoser._monitor.report().points] == [600.0, 1200.0]


def test_series_is_saved_and_resumed_to_the_bit():
    bearing = find_bearing('6307')
    straight = SeriesDiagnoser(bearing, CYCLE_SETTINGS)
    played(straight, range(40), worn=35)
    resumed = SeriesDiagnoser(bearing, CYCLE_SETTINGS)
    resumed.load(straight.save())
    assert resumed.save() == straight.save()
    later = [played(one, range(40, 60), worn=0) for one in (straight, resumed)]
    assert [str(d.severity) + d.level for d in later[0]] == [
        str(d.severity) + d.level for d in later[1]
    ]
    assert resumed.save() == straight.save()
    assert later[0][-1].level == 'fault'
    # Another source is judged alone, with a note.
    other = straight.take(10**12, np.ones(20_000), RATE, 25.0, sensor='x')
    assert 'the series is of' in straight.judge(other[0].analyse()).reasons[-1]
    before = straight.save()
    assert len(before) < 250_000
    for broken in (b'', before[:-9], before[:40] + b'x' + before[41:]):
        with pytest.raises(BearingTwinError):
            straight.load(broken)
    values, arrays = unpack(zlib.decompress(before), _VERSION)
    kept = values['series']['kept']
    for changed, levels in (
        (
            {'points': [*kept['points'][:-1], {**kept['points'][-1], 'time': 'x'}]},
            arrays['levels'],
        ),
        ({'rise': {**kept['rise'], 'total': -1.0}}, arrays['levels']),
        ({'held': 'x'}, arrays['levels']),
        ({'doubt': 'x'}, arrays['levels']),
        ({'memory': {**kept['memory'], 'windows': {'at ': []}}}, arrays['levels']),
        ({'strong': asdict(Comb('x', 3.0, 6.0, 20, 0))}, arrays['levels']),
        ({}, arrays['levels'][:, :1]),
    ):
        forged = {**values, 'series': {**values['series'], 'kept': {**kept, **changed}}}
        with pytest.raises(BearingTwinError, match='use what save'):
            straight.load(packed(forged, {**arrays, 'levels': levels}))
    # What does not fit together was met in the next snapshot only, and ended the node.
    averaged = values['series']['averaged']
    forgeries = [
        ({}, {'averaged': [averaged[0], average, averaged[2]]}, {})
        for average in ([-1, 1.0], [2, -1.0], [3, 0.0], [math.inf, 1.0], [3, math.nan])
    ]
    forgeries += [
        ({}, {}, {'loud': loud})
        for loud in (
            arrays['loud'][:, :1],
            arrays['loud'].astype(np.int64),
            np.full_like(arrays['loud'], np.inf),
        )
    ]
    forgeries += [({'next': math.inf}, {}, {})]
    forgeries += [({}, {'kept': {**kept, 'risen': 1e300, 'began': 0.0}}, {})]
    for own, of_series, other_arrays in forgeries:
        forged = {**values, **own, 'series': {**values['series'], **of_series}}
        with pytest.raises(BearingTwinError, match='use what save'):
            straight.load(packed(forged, {**arrays, **other_arrays}))
    # Snapshots of next to no turn resolve nothing, and say so.
    absurd = [averaged[0], [99, 1e-300], [19, 1e-300]]
    forged = {**values, 'series': {**values['series'], 'averaged': absurd}}
    resumed.load(packed(forged, arrays))
    assert played(resumed, range(60, 62), worn=0)[-1].level == 'fault'
    assert straight.save() == before
