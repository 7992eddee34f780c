# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The stream: a pure function of what was pushed, with a memory that survives a restart."""

from dataclasses import asdict, replace
import math

from bearing_twin.bearing import find_bearing
from bearing_twin.bench.diagnosis import fault_signal, RATE, SHAFT_HZ
from bearing_twin.diagnosis import diagnose_record, DiagnosisSettings, StreamingDiagnoser
from bearing_twin.diagnosis.machine.held import HeldLevel
from bearing_twin.diagnosis.machine.trend import HeldAnswer, Trend
from bearing_twin.diagnosis.series.monitor import SeriesMonitor
from bearing_twin.diagnosis.series.snapshots import SeriesDiagnoser
from bearing_twin.diagnosis.signal.demodulation import choose_layout, highest_order
from bearing_twin.diagnosis.signal.severity import MEASURES
from bearing_twin.diagnosis.streaming import _VERSION, Cut
from bearing_twin.errors import BearingTwinError
from bearing_twin.packed import pack, restored, unpack
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

BEARING = find_bearing('6307')
SHORT = DiagnosisSettings(window=2.0, memory=4.0, baseline_windows=3, hold_updates=2)


def _push(diagnoser, x, first=0, block=1024, shaft_hz=SHAFT_HZ, **kwargs):
    found = []
    for start in range(0, len(x), block):
        part = x[start : start + block]
        found += diagnoser.push(first + start, part, RATE, shaft_hz, **kwargs)
    return found


def _key(diagnosis):
    return (
        diagnosis.first_sample,
        diagnosis.result,
        diagnosis.level,
        tuple(diagnosis.score.values()),
        diagnosis.envelope_spectrum.values.tobytes(),
        diagnosis.reasons,
    )


def test_same_pushes_same_bits_and_blocks_do_not_matter():
    x = fault_signal(5.0)
    first, second, other = (
        [_key(d) for d in _push(StreamingDiagnoser(BEARING, SHORT), x, block=block)]
        for block in (1024, 1024, 3333)
    )
    assert first == second == other
    assert len(first) == 5


@pytest.mark.parametrize('window', [2.5, 8.0, 20.0])
@pytest.mark.parametrize('rate', [6667.0, 12_801.0, 25_601.2, 48_828.0, 97_657.0])
def test_a_rate_of_few_divisors_has_as_few_envelope_points_as_others(rate, window):
    cut = Cut.of(DiagnosisSettings(window=window), rate)
    assert cut.interval == pytest.approx(rate, rel=5e-4)
    assert cut.samples == pytest.approx(window * rate, rel=1e-3)
    layout = choose_layout(rate, cut.stretch, cut.window, BEARING, SHAFT_HZ)
    assert rate / layout.step < 2.0 * 2.2 * highest_order(BEARING) * SHAFT_HZ


def test_a_state_goes_on_within_the_window_before_it():
    # Off the beat of the updates, which come at each second.
    x, begin, cut = fault_signal(9.0), 3 * 1024, 107 * 1024
    whole = StreamingDiagnoser(BEARING, SHORT)
    before = len(_push(whole, x[:cut]))
    state = whole.save()
    rest = _push(whole, x[cut:], first=cut)
    again = StreamingDiagnoser(BEARING, SHORT)
    assert len(again.take(begin, x[begin:cut], RATE, SHAFT_HZ)) == before
    again.load(state)
    assert [_key(d) for d in _push(again, x[cut:], first=cut)] == [_key(d) for d in rest]
    assert len(rest) == 9 - before > 3


def test_a_loaded_state_knows_on_which_samples_a_window_rests():
    diagnoser, again = StreamingDiagnoser(BEARING, SHORT), StreamingDiagnoser(BEARING, SHORT)
    _push(diagnoser, fault_signal(5.0), first=1000)
    again.load(diagnoser.save())
    # On the second before it, where the run has one; behind a gap on none.
    end = 1000 + 5 * 25600
    assert again.first_needed_sample(end) == end + 25600 - round(SHORT.window * RATE) - 25600
    assert again.first_needed_sample(end + 10) == end + 10
    # Of windows that do not touch on the newest stretch alone, which tells when one is due; before
    # the first update on all.
    for interval, first in ((4.0, end - 25600), (20.0, 1000)):
        seldom = StreamingDiagnoser(BEARING, replace(SHORT, update_interval=interval))
        seldom.load(diagnoser.save())
        assert seldom.first_needed_sample(end) == first
    diagnoser.load(StreamingDiagnoser(BEARING, SHORT).save())
    assert diagnoser.first_needed_sample(0) == 0


def test_full_window_equals_the_record():
    x = fault_signal(4.0)
    streamed = _push(StreamingDiagnoser(BEARING, DiagnosisSettings(window=4.0, memory=4.0)), x)[-1]
    whole = diagnose_record(x, RATE, BEARING, SHAFT_HZ)
    assert streamed.result == whole.result == 'inner'
    assert streamed.score == whole.score


def test_gap_restart_rate_change_and_reconfigure_start_the_window_anew():
    diagnoser = StreamingDiagnoser(BEARING, SHORT)
    x = fault_signal(2.5)
    assert _push(diagnoser, x)[-1].sample_count == 2 * RATE
    (after_gap,) = _push(diagnoser, x[:25600], first=len(x) + 500)
    assert after_gap.sample_count == RATE
    assert '500 samples are missing' in after_gap.reasons[0]
    (again,) = _push(diagnoser, x[:25600], first=0)
    assert 'went back' in again.reasons[0]
    (slower,) = diagnoser.push(25600, x[:12800], 12800.0, SHAFT_HZ)
    assert 'sample rate' in slower.reasons[0]
    diagnoser.reconfigure(bearing=find_bearing('6205'))
    (other,) = diagnoser.push(25600 + 12800, x[:12800], 12800.0, SHAFT_HZ)
    assert 'settings were changed' in other.reasons[0]


def test_a_rate_that_moves_a_little_does_not_restart_the_window():
    """A driver that measures its rate: 25600 +- 0.01 Hz."""
    x, diagnoser = fault_signal(4.0), StreamingDiagnoser(BEARING, SHORT)
    steady = _push(StreamingDiagnoser(BEARING, SHORT), x)
    found = []
    for number, start in enumerate(range(0, len(x), 1024)):
        rate = RATE + 0.01 * (number % 3 - 1)
        found += diagnoser.push(start, x[start : start + 1024], rate, SHAFT_HZ)
    assert [d.sample_count for d in found] == [d.sample_count for d in steady]
    assert [d.result for d in found] == [d.result for d in steady]
    assert found[-1].sample_rate == RATE - 0.01


def test_a_window_that_never_fills_is_said_in_one_sentence():
    """One block of twenty is lost, more often than updates fall due: no verdict, no pile."""
    x, diagnoser = fault_signal(1.0)[:1024], StreamingDiagnoser(BEARING, SHORT)
    for number in range(60 * 25):
        if number % 20:
            assert not diagnoser.push(1024 * number, x, RATE, SHAFT_HZ)
        if number in (70, 80):
            assert bool(diagnoser.overdue) == (number == 80)
    assert diagnoser.overdue == (
        'no verdict in 60 s of vibration: window restarted: 1024 samples are missing before '
        'sample 1516544 (74 restarts since the last verdict)'
    )
    first = _push(diagnoser, fault_signal(2.0), first=1024 * number + 1024)[0]
    assert not diagnoser.overdue
    assert first.reasons[0].endswith('(74 restarts since the last verdict)')
    assert len(first.reasons) < 5


@pytest.mark.parametrize(
    ('samples', 'more'), [(0, ''), (9, ' (2 restarts since the last verdict)')]
)
def test_settings_changed_in_one_call_or_one_after_another_give_the_same_reason(samples, more):
    """A node changes them one by one, and a re-run all at once at the next checkpoint."""
    diagnoser = StreamingDiagnoser(BEARING, SHORT)
    _push(diagnoser, np.ones(100))
    diagnoser.reconfigure(settings=replace(SHORT, hold_updates=5))
    _push(diagnoser, np.ones(samples), first=100)
    diagnoser.reconfigure(settings=replace(SHORT, hold_updates=5, longest_hold=60.0))
    first = _push(diagnoser, np.ones(int(RATE)), first=100 + samples)[0]
    assert first.reasons[0] == f'window restarted: bearing or settings were changed{more}'


def test_unknown_speed_makes_no_statement():
    (said,) = StreamingDiagnoser(BEARING).push(0, fault_signal(), RATE, math.nan)
    assert (said.result, said.level) == ('insufficient', 'none')
    assert 'speed is unknown' in said.reasons[0]


@pytest.mark.parametrize('cycle', [0.0, 2.0])
def test_a_measured_speed_is_refined_and_that_of_a_twin_is_exact(cycle, rng):
    t = np.arange(int(8.0 * RATE)) / RATE
    x = rng.standard_normal(t.size)
    for harmonic in range(1, 7):
        x += 0.3 * np.sin(2.0 * np.pi * 1.001 * SHAFT_HZ * harmonic * t)
    settings = DiagnosisSettings(series_cycle=cycle, series_snapshot=2.0)
    kind = SeriesDiagnoser if cycle else StreamingDiagnoser
    shaft_hz = {}
    for sensor in ('housing y', 'housing y simulated'):
        due = kind(BEARING, settings).take(
            0, x, RATE, SHAFT_HZ, speed_measured=True, sensor=sensor
        )
        shaft_hz[sensor] = due[-1].analyse().window.speed.shaft_hz
    assert shaft_hz['housing y'] == pytest.approx(1.001 * SHAFT_HZ, rel=3e-4)
    assert shaft_hz['housing y simulated'] == SHAFT_HZ


def test_fault_is_found_while_the_speed_varies():
    """Impulses at the angles of the inner race, the shaft running up by 12 % in four seconds."""
    rng = np.random.default_rng(2)
    n = int(4 * RATE)
    shaft = np.linspace(24.0, 27.0, n)
    turns = np.cumsum(shaft) / RATE
    order = 8 * (1 + 14.0 / 57.5) / 2
    hits = np.searchsorted(turns, np.arange(1.0, turns[-1] * order) / order)
    x = np.zeros(n)
    x[hits] = 8.0 * (1 + 0.8 * np.cos(2 * np.pi * turns[hits]))
    ring = np.exp(-600 * np.arange(400) / RATE) * np.sin(2 * np.pi * 4500 * np.arange(400) / RATE)
    x = np.convolve(x, ring)[:n] + rng.standard_normal(n)
    diagnoser = StreamingDiagnoser(BEARING, DiagnosisSettings(window=4.0))
    found = []
    for start in range(0, n, 512):
        hz = float(shaft[start : start + 512].mean())
        found += diagnoser.push(start, x[start : start + 512], RATE, hz, speed_measured=True)
    assert found[-1].result == 'inner'
    # Without order tracking the lines smear and nothing is left.
    assert diagnose_record(x, RATE, BEARING, 25.5).level != 'fault'


def test_baseline_is_learnt_kept_and_corrected():
    rng = np.random.default_rng(4)
    diagnoser = StreamingDiagnoser(BEARING, SHORT)
    quiet = rng.standard_normal(int(6 * RATE))
    healthy = _push(diagnoser, quiet, temperature=40.0)
    assert healthy[-1].level == 'ok'
    assert healthy[-1].severity.level_over_baseline == pytest.approx(0.0, abs=0.2)
    # The state survives a restart of the program.
    restarted = StreamingDiagnoser(BEARING, SHORT)
    restarted.load(diagnoser.save())
    louder = _push(restarted, 2.0 * quiet, first=len(quiet), temperature=40.0)
    assert louder[-1].severity.level_over_baseline == pytest.approx(20 * math.log10(2), abs=0.2)
    # At twice the speed a machine is louder, nobody knows by how much: not compared.
    diagnoser.push(len(quiet), quiet[:1], RATE, 50.0)
    faster = _push(diagnoser, 4.0 * quiet, first=len(quiet) + 1, shaft_hz=50.0)
    assert math.isnan(faster[-1].severity.level_over_baseline)
    assert faster[-1].level == 'ok'
    assert any('not compared at this speed' in reason for reason in faster[-1].reasons)
    # The temperature alone changes nothing as long as the machine has not shown that it does.
    warm = StreamingDiagnoser(BEARING, SHORT)
    _push(warm, quiet, temperature=20.0)
    hot = _push(warm, quiet, first=len(quiet), temperature=110.0)[-1]
    assert hot.severity.level_over_baseline == pytest.approx(0.0, abs=0.2)
    assert hot.severity.correction == 0.0


@pytest.mark.parametrize(
    'change',
    [
        {'sensor': 'bearing_housing y'},
        {'unit': 'g'},
        {'rate': RATE / 2},
        {'bearing': find_bearing('6205')},
    ],
    ids=lambda change: next(iter(change)),
)
def test_a_baseline_takes_no_other_source(change):
    """Simulated windows, another unit, rate or bearing: the machine then reads as before."""
    machine = {'sensor': 'imu y', 'unit': 'm/s^2', 'rate': RATE}
    quiet = np.random.default_rng(4).standard_normal(int(6 * RATE))
    diagnoser = StreamingDiagnoser(BEARING, SHORT)

    def said(x, first, *, rate, bearing=BEARING, **source):
        if bearing is not diagnoser.bearing:
            diagnoser.reconfigure(bearing)
        return diagnoser.push(first, x, rate, SHAFT_HZ, **source)[-1]

    assert said(quiet, 0, **machine).severity.level_over_baseline == pytest.approx(0.0, abs=0.2)
    learnt = StreamingDiagnoser(BEARING, SHORT)
    learnt.load(diagnoser.save())
    other = {**machine, **change}
    stray = said(quiet / 7.0, 10**7, **other)
    assert [r for r in stray.reasons if r.startswith("baseline and trend are of sensor 'imu y'")]
    assert diagnoser.other_source
    # Not the machine's 17 dB less, and nothing of it is left behind.
    assert not stray.severity.level_over_baseline < -1.0
    back = said(quiet, 0, **machine)
    assert back.severity.level_over_baseline == pytest.approx(0.0, abs=0.2)
    assert not diagnoser.other_source
    # A state over a restart refuses the same.
    diagnoser = learnt
    assert said(quiet / 7.0, 10**7, **other).reasons[-1] == stray.reasons[-1]


@pytest.mark.parametrize('other', [{'sensor': 'gearbox'}, {'unit': 'g'}])
def test_samples_of_two_sources_are_in_no_window_together(other):
    machine = {'sensor': 'pump', 'unit': 'm/s^2'}
    fault, quiet = fault_signal(6.0), np.random.default_rng(4).standard_normal(int(6 * RATE))
    diagnoser = StreamingDiagnoser(BEARING, SHORT)
    found = diagnoser.push(0, fault, RATE, SHAFT_HZ, **machine)
    assert found[-1].level == 'fault'
    found = diagnoser.push(len(fault), quiet, RATE, SHAFT_HZ, **{**machine, **other})
    assert found[0].reasons[0] == 'window restarted: sensor or unit changed'
    assert {verdict.level for verdict in found} == {'none', 'ok'}


@pytest.mark.parametrize('hold', [1, 2, 4])
def test_the_level_follows_after_as_many_equal_verdicts_as_it_is_held(hold):
    quiet = np.random.default_rng(4).standard_normal(int(4 * RATE))
    # As loud as the noise, so that the combs alone decide.
    fault = fault_signal(9.0)
    fault *= quiet.std() / fault.std()
    published = {}
    for updates in (1, hold):
        settings = replace(SHORT, window=4.0, hold_updates=updates)
        diagnoser = StreamingDiagnoser(BEARING, settings)
        assert _push(diagnoser, quiet)[-1].level == 'ok'
        published[updates] = _push(diagnoser, fault, first=len(quiet) + 1)
    # Held for one update the answer is each window's own.
    begin = next(n for n, d in enumerate(published[1]) if d.result == 'inner')
    assert {(d.result, d.level) for d in published[1][begin:]} == {('inner', 'fault')}
    said = published[hold][begin:]
    waits = [('healthy', 'ok')] * (hold - 1)
    expected = waits + [('inner', 'fault')] * (len(said) - len(waits))
    assert [(d.result, d.level) for d in said] == expected
    text = f'healthy, ok held: 1 of {hold} verdicts say inner, fault'
    assert (said[0].reasons[-1] == text) == (hold > 1)


def test_windows_may_be_analysed_in_any_order_and_are_judged_in_theirs():
    """Restarts between them, as an offline run has them: each run has a memory of its own."""
    x = fault_signal(7.0)
    parts = [(0, x), (len(x) + 10, x[::-1]), (0, x[: int(5 * RATE)])]
    plain, late = StreamingDiagnoser(BEARING, SHORT), StreamingDiagnoser(BEARING, SHORT)
    expected = [_key(d) for first, part in parts for d in _push(plain, part, first)]
    due = [e for first, part in parts for e in late.take(first, part, RATE, SHAFT_HZ)]
    analysed = [excerpt.analyse() for excerpt in reversed(due)][::-1]
    assert [_key(late.judge(analysis)) for analysis in analysed] == expected
    assert late.save() == plain.save()
    # What a restart has cut off has no part in a state.
    late.take(3, x[:100], RATE, SHAFT_HZ)
    plain.push(3, x[:100], RATE, SHAFT_HZ)
    assert late.save() == plain.save()
    # Answers and levels are kept, no samples or spectra.
    assert b'"arrays": []' in late.save()


@given(data=st.binary(max_size=200))
@settings(max_examples=200, deadline=None)
def test_bytes_of_something_else_are_refused(data):
    with pytest.raises(BearingTwinError):
        StreamingDiagnoser(BEARING).load(data)


def test_the_name_of_a_bearing_is_no_bearing():
    diagnoser, said = StreamingDiagnoser(BEARING), "bearing='6205' is not a Bearing"
    with pytest.raises(BearingTwinError, match=said):
        StreamingDiagnoser('6205')
    with pytest.raises(BearingTwinError, match=said):
        diagnoser.reconfigure('6205')
    with pytest.raises(BearingTwinError, match=said):
        diagnose_record(np.zeros(4), RATE, '6205', SHAFT_HZ)
    assert diagnoser.bearing is BEARING


def test_damaged_states_are_refused_and_leave_the_state_alone():
    diagnoser = StreamingDiagnoser(BEARING, SHORT)
    _push(diagnoser, fault_signal(4.0))
    state = diagnoser.save()
    rng = np.random.default_rng(0)
    for position in rng.integers(0, len(state), 200):
        damaged = bytearray(state)
        damaged[position] ^= 0x41
        with pytest.raises(BearingTwinError):
            diagnoser.load(bytes(damaged))
    for length in (0, 3, 21, len(state) // 2, len(state) - 1):
        with pytest.raises(BearingTwinError):
            diagnoser.load(state[:length])
    assert diagnoser.save() == state


@pytest.mark.parametrize(
    'wrong',
    [
        {'measure': len(MEASURES)},
        {'measure': -1},
        {'held': asdict(HeldLevel('fault')), 'answer': asdict(HeldAnswer('broken'))},
        {'held': asdict(HeldLevel('fault')), 'answer': asdict(HeldAnswer('outer', ['broken']))},
        {'held': asdict(HeldLevel('fault'))},
        {'answer': asdict(HeldAnswer('outer', ['outer']))},
    ],
)
def test_a_trend_that_holds_what_there_is_not_is_refused(wrong):
    with pytest.raises(BearingTwinError, match='there is not'):
        restored(Trend, Trend().values() | wrong)


@pytest.mark.parametrize(
    ('change', 'differs'),
    [
        (lambda trend: trend.pop('measure'), 'whose Trend lacks measure; start afresh'),
        (lambda trend: trend.update(zone='A'), 'whose Trend has zone; start afresh'),
        (lambda trend: trend['rise'].pop('found'), 'whose Rise lacks found; start afresh'),
    ],
)
def test_a_state_of_another_version_is_refused_with_what_differs_and_changes_nothing(
    change, differs
):
    diagnoser = StreamingDiagnoser(BEARING, SHORT)
    _push(diagnoser, fault_signal(4.0))
    before = diagnoser.save()
    values, arrays = unpack(before, _VERSION)
    change(values['trend'])
    with pytest.raises(BearingTwinError, match=f'another version of this program, {differs}'):
        diagnoser.load(pack(_VERSION, values, arrays))
    assert diagnoser.save() == before


@pytest.mark.parametrize(
    'wrong', [{'window': 0.0}, {'memory': 0.5}, {'speed_tolerance': 0.5}, {'mounting': 'soft'}]
)
def test_settings_are_checked(wrong):
    with pytest.raises(BearingTwinError):
        DiagnosisSettings(**wrong)


@pytest.mark.parametrize('size', [1e-308, 1e-200, 1e200, 1e308])
def test_samples_whose_powers_are_no_numbers_are_refused(size):
    x = size * np.random.default_rng(0).uniform(-1.0, 1.0, 3 * 25_600)
    verdicts = StreamingDiagnoser(find_bearing('6307')).push(0, x, 25_600.0, 25.0)
    assert len(verdicts) == 3
    for verdict in verdicts:
        assert verdict.result == 'insufficient'
        assert any('constant' in text or 'any sensor' in text for text in verdict.reasons)
    series = SeriesMonitor(find_bearing('6307'), DiagnosisSettings(series_cycle=1.0))
    assert series.add(0.0, x, 25_600.0, 25.0) is None


@pytest.mark.parametrize('rate', [math.nan, 0.0, 1e-9, 1e308])
def test_rates_at_which_no_window_ends_are_refused(rate):
    with pytest.raises(BearingTwinError, match='is outside'):
        StreamingDiagnoser(find_bearing('6307')).push(0, np.ones(1024), rate, 25.0)
