# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The level takes everything into account that is known, and the answer does not chatter."""

from dataclasses import replace
import math

from bearing_twin.bearing import fault_orders, find_bearing, next_step
from bearing_twin.diagnosis import diagnose_record, DiagnosisSettings, StreamingDiagnoser
from bearing_twin.diagnosis.machine.held import Pace
from bearing_twin.diagnosis.machine.level import with_fault_stage, with_required_level
from bearing_twin.diagnosis.machine.trend import Source, Trend
from bearing_twin.diagnosis.result import insufficient
from bearing_twin.diagnosis.rules.confidence import CLAIMS, kind_of
from bearing_twin.packed import restored
import numpy as np
import pytest
from scipy import signal
from scipy.special import ndtri

RATE = 25_600.0
BEARING = find_bearing('6307')
NOTHING = insufficient(['by hand'], BEARING)
MACHINE = Source('imu y', '6307', 'g', RATE)


def said(result, level, *faults, over=math.nan, zone='', rms=1.0, velocity=math.nan, unit=''):
    severity = replace(
        NOTHING.severity, level_over_baseline=over, iso_zone=zone, rms=rms, velocity_rms=velocity,
        band_rms=(rms, 0.0, 0.0), unit=unit,
    )  # fmt: skip
    index = dict.fromkeys(faults, 1.0)
    return replace(
        NOTHING,
        result=result,
        level=level,
        faults=faults,
        severity=severity,
        confidence=0.9,
        modulation_index=index,
        shaft_hz=25.0,
    )


@pytest.mark.parametrize(
    ('fresh', 'known', 'result', 'level'),
    [
        (('healthy', 'ok'), {'over': 5.9}, 'healthy', 'ok'),
        (('healthy', 'ok'), {'over': 6.0}, 'suspect', 'suspect'),
        (('healthy', 'ok'), {'over': 12.0}, 'ambiguous', 'fault'),
        (('healthy', 'ok'), {'zone': 'B'}, 'healthy', 'ok'),
        (('healthy', 'ok'), {'zone': 'C'}, 'suspect', 'suspect'),
        (('healthy', 'ok'), {'zone': 'D'}, 'ambiguous', 'fault'),
        # Neither group nor mounting are known: zone C or D in all is no alarm, but not ok.
        (('healthy', 'ok'), {'velocity': 7.2}, 'suspect', 'suspect'),
        (('healthy', 'ok'), {'velocity': 7.0}, 'healthy', 'ok'),
        (('healthy', 'ok'), {'velocity': 11.5, 'zone': 'B'}, 'healthy', 'ok'),
        # No sound bearing is so loud, whatever the machine; an unknown unit tells nothing.
        (('healthy', 'ok'), {'rms': 10.1, 'unit': 'g'}, 'suspect', 'suspect'),
        (('healthy', 'ok'), {'rms': 99.0, 'unit': 'm/s^2'}, 'suspect', 'suspect'),
        (('healthy', 'ok'), {'rms': 97.0, 'unit': 'm/s^2'}, 'healthy', 'ok'),
        (('healthy', 'ok'), {'rms': 99.0}, 'healthy', 'ok'),
        (('insufficient', 'none'), {'over': 26.0}, 'ambiguous', 'fault'),
        (('insufficient', 'none'), {'over': 5.0}, 'insufficient', 'none'),
        (('suspect', 'suspect', 'ball'), {'over': 15.0}, 'ambiguous', 'fault'),
        (('suspect', 'suspect', 'ball'), {'over': 7.0}, 'suspect', 'suspect'),
        (('ambiguous', 'suspect', 'ball', 'cage'), {'over': 6.5}, 'ambiguous', 'fault'),
        (('ambiguous', 'suspect', 'outer', 'ball', 'cage'), {'over': 6.5}, 'ambiguous', 'fault'),
        (('inner', 'fault', 'inner'), {'zone': 'A', 'over': -3.0}, 'inner', 'fault'),
        (('inner', 'suspect', 'inner'), {'zone': 'D'}, 'inner', 'fault'),
    ],
)
def test_the_level_is_what_combs_baseline_and_zone_ask_for(fresh, known, result, level):
    diagnosis = said(*fresh, **known)
    found = with_fault_stage(with_required_level(diagnosis))
    assert (found.result, found.level, found.faults) == (result, level, diagnosis.faults)
    assert (found.severity.stage > 0) == (level == 'fault')
    why = ' '.join(found.reasons[len(diagnosis.reasons) :])
    # Healthy without a zone or a baseline does not speak of wear, and says so.
    silent = result == 'healthy' and not {'zone', 'over'} & known.keys()
    assert why.startswith('not judged: wear') == silent
    assert bool(why) == (level != fresh[1] or silent)
    if level != fresh[1]:
        texts = (
            ('are unit and scale right?',) if 'unit' in known else ('ISO 20816-3', 'dB over the')
        )
        assert any(text in why for text in texts)
        assert ('place unknown' in why) == (not found.faults)


@pytest.mark.parametrize(
    ('result', 'stage', 'step'),
    [
        ('healthy', 2, 'nothing'),
        ('suspect', 1, 'check bearing and speed'),
        ('ambiguous', 0, 'record longer'),
        ('ambiguous', 2, 'order a bearing; measure daily; record longer'),
        ('ambiguous', 4, 'stop the machine'),
        ('inner', 0, 'record again'),
        ('outer', 4, 'stop the machine'),
        ('cage', 1, 'plan to replace'),
        ('cage', 4, 'stop the machine'),
        ('of another version', 0, 'record again'),
    ],
)
def test_the_stage_decides_what_to_do_only_about_a_named_place(result, stage, step):
    assert next_step(result, stage).startswith(step)


@pytest.mark.parametrize('result', ['suspect', 'ambiguous', 'insufficient', 'healthy'])
def test_a_loud_machine_without_a_place_is_to_be_looked_at_now(result):
    assert next_step(result, urgent=True).startswith('find the cause of the high vibration now')
    assert next_step('insufficient', standing=True) == 'measure while the shaft turns'


@pytest.mark.parametrize(
    ('result', 'stage', 'step'),
    [('inner', 1, 'check the lub'), ('outer', 3, 'replace the'), ('cage', 2, 'plan to replace')],
)
def test_a_loud_machine_with_a_named_place_is_looked_at_now_until_it_is_stopped(
    result, stage, step
):
    now, later = next_step(result, stage, urgent=True).split('; ')[:2]
    assert now.startswith('find the cause of the high vibration now')
    assert later.startswith(step)
    assert next_step(result, 4, urgent=True).startswith('stop the machine')


def test_a_worn_out_machine_is_a_fault_of_unknown_place_over_its_own_baseline():
    """Healthy noise, then the same noise 13 dB higher: no comb, but no health either."""
    settings = DiagnosisSettings(window=2.0, memory=2.0, baseline_windows=3, hold_updates=2)
    diagnoser = StreamingDiagnoser(find_bearing('6307'), settings)
    quiet = np.random.default_rng(3).standard_normal(int(6 * RATE))
    first = diagnoser.push(0, quiet, RATE, 25.0)
    assert [d.level for d in first] == ['none'] + ['ok'] * 5
    worn = diagnoser.push(len(quiet) + 1, 4.5 * quiet, RATE, 25.0)[-1]
    assert (worn.result, worn.level, worn.faults) == ('ambiguous', 'fault', ())
    assert worn.severity.stage == 4
    assert 'place unknown' in ' '.join(worn.reasons)
    assert worn.confidence == 0.5
    # What is raised is not learnt from.
    assert worn.severity.level_over_baseline == pytest.approx(13.06, abs=0.2)


def test_the_zone_raises_the_level_of_a_record():
    t = np.arange(int(4 * RATE)) / RATE
    rng = np.random.default_rng(5)
    # 5 mm/s at 40 Hz: zone D of a rigid machine of group 2.
    x = 5e-3 * math.sqrt(2.0) * 2 * np.pi * 40.0 * np.sin(2 * np.pi * 40.0 * t)
    x += 0.1 * rng.standard_normal(len(t))
    machine = DiagnosisSettings(power_group=2, mounting='rigid')
    found = diagnose_record(x, RATE, find_bearing('6307'), 25.0, unit='m/s^2', settings=machine)
    assert (found.severity.iso_zone, found.level) == ('D', 'fault')
    plain = diagnose_record(x, RATE, find_bearing('6307'), 25.0, unit='m/s^2')
    assert (plain.severity.iso_zone, plain.level) == ('', 'ok')


def _answers(verdicts):
    trend = Trend()
    return [trend.update(v, MACHINE, wanted=60, pace=Pace(), full=True) for v in verdicts]


def test_one_other_window_does_not_undo_a_standing_answer_and_stays_visible():
    inner = said('inner', 'fault', 'inner')
    other = replace(said('ambiguous', 'fault', 'inner', 'outer'), confidence=0.4)
    published = _answers([inner, inner, other, inner, other, other, other])
    assert [d.result for d in published] == ['inner'] * 6 + ['ambiguous']
    assert published[2].fault_code == 'BEARING_INNER_RACE'
    assert published[2].confidence == 0.9
    text = 'inner, fault held: 1 of 3 verdicts say ambiguous inner or outer'
    assert published[2].reasons[-1] == text
    assert published[6].faults == ('inner', 'outer')


def test_a_held_level_says_for_how_long_and_why():
    healthy, inner = said('healthy', 'ok'), said('inner', 'fault', 'inner')
    burst = [*[inner] * 60, *[healthy] * 40]
    published = _answers([healthy, *burst, *burst])
    text = 'inner, fault held: 12 of 33 s without it; the newest verdict says healthy, ok'
    assert published[72].reasons[-1] == text
    assert [d.level for d in published[92:95]] == ['fault', 'ok', 'ok']
    text = (
        'inner, fault held: 40 of 3600 s without it, as it has come back; the newest verdict says '
        'healthy, ok; after a repair reset the diagnosis'
    )
    assert published[-1].reasons[-1] == text
    assert published[-1].window == ('healthy', 'ok')


@pytest.mark.parametrize(
    ('seen', 'longest', 'wait', 'reset'),
    [(3, 3600.0, '3593', True), (12, 1e6, '24170', True), (60, 1e6, '104', False),
     (60, 1.0, '3', False)],
)  # fmt: skip
def test_a_reset_is_recommended_where_a_level_is_held_for_long(seen, longest, wait, reset):
    trend, known = Trend(), {'wanted': 60, 'pace': Pace(longest=longest), 'full': True}
    healthy, inner = said('healthy', 'ok'), said('inner', 'fault', 'inner')
    for verdict in [healthy, *[inner] * seen, healthy]:
        reason = trend.update(verdict, MACHINE, **known).reasons[-1]
    text = f'inner, fault held: 1 of {wait} s without it; the newest verdict says healthy, ok'
    assert reason == text + '; after a repair reset the diagnosis' * reset


def test_windows_that_disagree_among_themselves_change_the_level_all_the_same():
    healthy, fault = said('healthy', 'ok'), said('inner', 'fault', 'inner')
    other = said('outer', 'fault', 'outer')
    published = _answers([healthy, fault, other, fault, other, fault])
    assert [d.level for d in published] == ['ok'] * 3 + ['fault'] * 3
    assert [d.result for d in published] == ['healthy'] * 3 + ['inner'] * 3


def test_no_level_is_known_before_the_first_full_window():
    trend, fault = Trend(), said('inner', 'fault', 'inner')
    early = trend.update(fault, MACHINE, wanted=60, pace=Pace(), full=False)
    assert (early.result, early.level) == ('inner', 'none')
    assert trend.update(fault, MACHINE, wanted=60, pace=Pace(), full=True).level == 'fault'
    assert repr(restored(Trend, trend.values())) == repr(trend)


def test_a_window_that_says_nothing_does_not_end_an_alarm():
    nothing = said('insufficient', 'none')
    # Broken samples have no level at all; those of a clipped or short window have one.
    for lost in (nothing, replace(nothing, severity=replace(nothing.severity, rms=math.nan))):
        assert _answers([lost] * 4)[-1].result == 'insufficient'
        inner = replace(said('inner', 'fault', 'inner'), modulation_index={'inner': 1.5})
        held = _answers([inner] * 4 + [lost] * 9)[-1]
        assert (held.result, held.level, held.window) == (
            'inner',
            'fault',
            ('insufficient', 'none'),
        )
        text = 'inner, fault held: this window tells nothing; after a repair reset the diagnosis'
        assert held.reasons[-1] == text
        assert held.severity.stage == 2


def test_a_suspicion_ends_after_windows_that_show_nothing():
    nothing = said('insufficient', 'none')
    shown = _answers([said('suspect', 'suspect'), nothing, nothing, nothing, nothing])
    levels = [(d.result, d.level) for d in shown]
    assert levels == [('suspect', 'suspect')] * 3 + [('insufficient', 'none')] * 2


UNCERTAIN = replace(said('insufficient', 'none'), rule='uncertain_health')


def test_a_healthy_answer_stands_while_most_windows_tell_something():
    healthy, faint = said('healthy', 'ok'), replace(UNCERTAIN, reasons=('a faint comb',))
    # The first healthy window counts as long as its samples last.
    shown = _answers([healthy] + [faint] * 9 + [healthy] * 171 + [faint] * 170)
    answers = [(d.result, d.level) for d in shown]
    ok, unknown = ('healthy', 'ok'), ('insufficient', 'none')
    assert answers == [ok] * 8 + [unknown] * 171 + [ok] * 171 + [unknown]
    assert shown[1].window == unknown
    assert shown[1].reasons[-1] == (
        'healthy, ok held: this window tells nothing; 1 of 2 s tell nothing; not known after 7 s '
        'more of them'
    )
    assert shown[9].reasons == (
        'a faint comb', '0 of 2 s tell something; known after 170 s more of them',
    )  # fmt: skip
    assert shown[9].window is None
    held = shown[11]
    assert (held.window, held.rule, held.confidence) == (ok, 'uncertain_health', 0.0)
    assert held.reasons[-1] == (
        'insufficient, none held: 2 of 4 s tell something; known after 168 s more of them; the '
        'newest verdict says healthy, ok; the last one that told nothing says a faint comb'
    )
    # One of eight that tells something does not keep it.
    few = _answers([healthy] + ([faint] * 7 + [healthy]) * 30)
    assert [d.level for d in few] == ['ok'] * 10 + ['none'] * 231
    # At first as many windows must tell something as told nothing.
    levels = [d.level for d in _answers([faint] * 20 + [healthy] * 30)]
    assert levels == ['none'] * 39 + ['ok'] * 11


def test_windows_that_tell_nothing_delay_no_alarm():
    """Neither where *ok* is held over them, nor where *insufficient* is."""
    healthy, fault = said('healthy', 'ok'), said('inner', 'fault', 'inner')
    for before in ([healthy] * 300, [healthy] * 300 + [UNCERTAIN] * 200, [UNCERTAIN] * 200):
        levels = [d.level for d in _answers([*before, fault, UNCERTAIN, fault, UNCERTAIN, fault])]
        assert levels[-1] == 'fault'
    levels = [d.level for d in _answers([healthy] + [UNCERTAIN] * 9 + [fault] * 3)]
    assert levels == ['ok'] * 8 + ['none'] * 4 + ['fault']


@pytest.mark.parametrize('share', [0.02, 0.1, 0.3, 0.5, 0.7])
@pytest.mark.parametrize('level', ['ok', 'suspect', 'fault'])
def test_windows_that_tell_nothing_change_the_level_at_most_twice_in_an_hour(share, level):
    """Each window shares seven of its eight seconds with the next one."""
    rng, answer = np.random.default_rng(2), said(level, level)
    answer = said('healthy', 'ok') if level == 'ok' else answer
    evidence = np.convolve(rng.standard_normal(2 * 3600), np.full(8, 8**-0.5), 'valid')
    tells = evidence > ndtri(share)
    levels = np.array([d.level for d in _answers(np.where(tells, answer, UNCERTAIN))])
    first = np.argmax(levels != 'none')
    at = first + np.flatnonzero(levels[first + 1 :] != levels[first:-1])
    assert max(np.searchsorted(at, at + 3600) - np.arange(len(at)), default=0) <= 2
    if level != 'ok' or share < 0.5:
        assert np.mean(levels == level) > 0.99
    elif share > 0.5:
        assert np.mean(levels == 'none') > 0.9


def test_an_input_that_is_unusable_is_told_at_once_and_one_that_is_so_now_and_then_is_chance():
    healthy, loose = said('healthy', 'ok'), replace(NOTHING, reasons=('clipped',))
    once = [loose] * 8 + [healthy] * 600
    shown = _answers([healthy] * 600 + once * 4 + [loose] * 180)
    levels = [d.level for d in shown]
    assert levels == ['ok'] * 600 + ['none'] * 8 + ['ok'] * (600 + 3 * 608 + 169) + ['none'] * 11
    assert shown[600].reasons == ('clipped',)
    assert shown[1208].reasons == (
        'clipped',
        'healthy, ok held: this window tells nothing; 1 of 601 s tell nothing; not known after '
        '169 s more of them',
    )
    # After an hour in which it was usable it is a fact again.
    levels = [d.level for d in _answers([healthy, *([loose] * 8 + [healthy] * 3600) * 2])]
    assert levels == ['ok', *(['none'] * 8 + ['ok'] * 3600) * 2]
    # What is done to a twin is no chance.
    trend, known = Trend(), {'wanted': 60, 'pace': Pace(simulated=True), 'full': True}
    levels = [trend.update(d, MACHINE, **known).level for d in [healthy, loose, healthy] * 3]
    assert levels == ['ok', 'none', 'ok'] * 3
    # Short windows after a gap are no fact of the input.
    trend = Trend()
    known = {'wanted': 60, 'pace': Pace()}
    for full in (True, False):
        now = trend.update(healthy if full else loose, MACHINE, full=full, **known)
        assert now.level == 'ok'


@pytest.mark.parametrize(('rule', 'level'), [('run_together', 'fault'), ('few_steps', 'none')])
def test_windows_in_which_no_fault_could_show_teach_the_level(rule, level):
    trend, known = Trend(), {'wanted': 5, 'pace': Pace(), 'full': True}
    for _ in range(8):
        trend.update(replace(said('insufficient', 'none'), rule=rule), MACHINE, **known)
    shown = [
        trend.update(replace(said('insufficient', 'none', rms=10.0), rule=rule), MACHINE, **known)
        for _ in range(3)
    ]
    assert shown[-1].level == level


def test_a_named_fault_far_below_the_baseline_is_no_dead_sensor():
    trend, known = Trend(), {'wanted': 5, 'pace': Pace(updates=1), 'full': True}
    for _ in range(6):
        trend.update(said('healthy', 'ok'), MACHINE, **known)
    quiet = trend.update(said('inner', 'fault', 'inner', rms=0.2), MACHINE, **known)
    assert (quiet.result, quiet.level) == ('inner', 'fault')
    assert 'is the sensor loose or dead?' in quiet.reasons[-1]


def test_a_signal_far_below_its_baseline_is_not_ok():
    trend = Trend()
    known = {'wanted': 5, 'pace': Pace(), 'full': True}
    for _ in range(6):
        assert trend.update(said('healthy', 'ok'), MACHINE, **known).level == 'ok'
    # A dead sensor has noise of its own, and no combs.
    dead = trend.update(said('healthy', 'ok', rms=0.2), MACHINE, **known)
    assert (dead.result, dead.level, dead.confidence) == ('insufficient', 'none', 0.0)
    assert 'is the sensor loose or dead?' in dead.reasons[-1]
    assert trend.update(said('healthy', 'ok', rms=0.3), MACHINE, **known).level == 'ok'


@pytest.mark.parametrize(
    ('height', 'hertz', 'seconds', 'why'),
    [(3.0, 25.0, 4.0, 'clipped'), (9e9, math.nan, 4.0, 'speed'), (9e9, 16.0, 1.2, 'turns')],
)
def test_samples_that_show_no_place_show_how_loud_the_machine_is(height, hertz, seconds, why):
    """Zone D by far, clipped, at an unknown speed, or too short for a comb."""
    t = np.arange(seconds * RATE) / RATE
    x = 8.0 * np.sin(2.0 * np.pi * 25.0 * t) + np.random.default_rng(0).standard_normal(len(t))
    settings = DiagnosisSettings(power_group=2, mounting='rigid')
    known = {'unit': 'm/s^2', 'settings': settings}
    told = diagnose_record(np.clip(x, -height, height), RATE, BEARING, hertz, **known)
    assert (told.result, told.level, told.severity.iso_zone) == ('ambiguous', 'fault', 'D')
    assert told.severity.velocity_rms > 15.0
    assert told.severity.stage == 4
    assert any(why in reason for reason in told.reasons)
    quiet = diagnose_record(1e-3 * np.clip(x, -height, height), RATE, BEARING, hertz, **known)
    assert (quiet.result, quiet.level) == ('insufficient', 'none')


def _windows(diagnoser, impacts, count):
    """Diagnoses of windows of noise, those with impacts of the inner race where asked for."""
    rng, rate, found = np.random.default_rng(7), 25600, []
    gap = rate / (fault_orders(BEARING).bpfi * 25.0)
    for number in range(count):
        x = rng.standard_normal(rate)
        if impacts(number):
            x[np.arange(0.0, rate, gap).astype(int)] += 25.0
        found += diagnoser.push(number * rate, x, float(rate), 25.0)
    return found


def test_a_machine_that_is_faulty_from_the_start_is_not_its_own_baseline():
    settings = DiagnosisSettings(window=2.0, memory=2.0, baseline_windows=5, hold_updates=2)
    diagnoser = StreamingDiagnoser(BEARING, settings)
    # Two healthy windows now and then do not end the alarm for good, nor make a baseline.
    said = _windows(diagnoser, lambda n: n % 12 < 9, 60)
    assert {s.level for s in said[2:]} >= {'fault'}
    assert all(math.isnan(s.severity.level_over_baseline) for s in said)
    assert any(reason.startswith('no baseline: ') for reason in said[-1].reasons)


def test_a_baseline_learnt_beside_doubtful_windows_says_so():
    settings = DiagnosisSettings(window=2.0, memory=2.0, baseline_windows=5, hold_updates=2)
    diagnoser = StreamingDiagnoser(BEARING, settings)
    said = _windows(diagnoser, lambda n: n < 10, 25)
    assert math.isfinite(said[-1].severity.level_over_baseline)
    assert any('that were suspect or faulty' in reason for reason in said[-1].reasons)
    sound = _windows(StreamingDiagnoser(BEARING, settings), lambda n: False, 25)
    assert math.isfinite(sound[-1].severity.level_over_baseline)
    assert not any('suspect or faulty' in reason for reason in sound[-1].reasons)


@pytest.mark.parametrize('at', [25_590, 20_000, 25_599])
def test_a_broken_sample_spoils_its_own_windows_only(at):
    """The first segment of a window laps over the samples before it, which may be broken."""
    diagnoser = StreamingDiagnoser(BEARING, DiagnosisSettings(window=2.0, memory=2.0))
    x = np.random.default_rng(5).standard_normal(int(5 * RATE))
    x[at] = math.nan
    told = [d.result for d in diagnoser.push(0, x, RATE, 25.0)]
    assert told[:2] == ['insufficient'] * 2
    assert set(told[2:]) <= {'healthy', 'insufficient'}
    assert told[-1] == 'healthy'


def test_a_slow_shaft_has_no_zone_and_the_reason_says_why():
    settings = DiagnosisSettings(power_group=2, mounting='rigid')
    x = np.random.default_rng(6).standard_normal(int(8 * RATE))
    (slow, fast), (worn, _) = (
        [
            diagnose_record(factor * x, RATE, BEARING, hertz, unit='g', settings=settings)
            for hertz in (9.0, 11.0)
        ]
        for factor in (0.3, 3.0)
    )
    assert (slow.severity.iso_zone, fast.severity.iso_zone) == ('', 'A')
    # More than the limit from 10 Hz on is more than it from 2 Hz on.
    assert (worn.severity.iso_zone, worn.level) == ('D', 'fault')
    assert 'below 600 1/min' not in ' '.join(worn.reasons)
    assert 'below 600 1/min' in ' '.join(slow.reasons)
    assert 'below 600 1/min' not in ' '.join(fast.reasons)


def test_the_baseline_is_of_the_temperatures_that_were_known():
    trend = Trend()
    for number in range(100):
        heat = math.nan if number < 50 else 20.0 + 4.0 * (number % 10)
        window = replace(said('healthy', 'ok'), temperature=heat)
        trend.update(window, MACHINE, wanted=100, pace=Pace(), full=True)
    assert trend.memory.at == pytest.approx((38.0, math.log2(25.0)))


@pytest.mark.parametrize('interval', [0.25, 1.0, 20.0])
def test_a_temperature_that_creeps_is_waited_for_half_an_hour_at_any_rate_of_updates(interval):
    trend, updates = Trend(), 0
    while trend.memory.base is None:
        updates += 1
        window = replace(said('healthy', 'ok'), temperature=40.0 + 0.1 * updates)
        trend.update(window, MACHINE, wanted=60, pace=Pace(interval=interval), full=True)
    assert (updates - 1) * interval == pytest.approx(1800.0, abs=interval)


def test_a_sway_below_the_vibration_is_no_level_of_the_machine():
    """2 m/s^2 at 0.5 Hz beside a vibration of 0.2 m/s^2: a vessel, a vehicle, a drift."""
    settings = DiagnosisSettings(window=2.0, memory=2.0, baseline_windows=5, hold_updates=2)
    t = np.arange(int(20 * RATE)) / RATE
    x = 0.2 * np.random.default_rng(8).standard_normal(len(t))
    x += 2.0 * np.sin(np.pi * t) * (t >= 10.0)
    told = StreamingDiagnoser(BEARING, settings).push(0, x, RATE, 25.0)
    assert (told[9].level, told[-1].level) == ('ok', 'ok')
    assert told[-1].severity.rms > 5.0 * told[9].severity.rms
    assert abs(told[-1].severity.level_over_baseline) < 1.0


def test_an_alarm_stands_where_the_machine_becomes_too_loud_for_its_sensor():
    """Healthy, an inner race fault, then ten times as loud, so that it is clipped."""
    settings = DiagnosisSettings(window=2.0, memory=2.0, baseline_windows=5, hold_updates=2)
    x = np.random.default_rng(7).standard_normal(int(24 * RATE))
    gap = RATE / (fault_orders(BEARING).bpfi * 25.0)
    x[np.arange(10.0 * RATE, len(x), gap).astype(int)] += 15.0
    late = x[int(16 * RATE) :]
    late *= 10.0
    limit = np.quantile(np.abs(late), 0.6)
    np.clip(late, -limit, limit, out=late)
    told = StreamingDiagnoser(BEARING, settings).push(0, x, RATE, 25.0, speed_measured=True)
    assert [told[n].result for n in (9, 15)] == ['healthy', 'inner']
    assert {d.level for d in told[14:]} == {'fault'}
    assert 'is clipped' in ' '.join(told[-1].reasons)
    assert told[-1].severity.level_over_baseline > 12.0


def test_a_band_in_which_bearings_ring_counts_below_a_high_line():
    settings = DiagnosisSettings(window=2.0, memory=2.0, baseline_windows=5, hold_updates=2)
    t = np.arange(int(20 * RATE)) / RATE
    rng = np.random.default_rng(8)
    sections = signal.butter(4, (2000.0, 4000.0), 'bandpass', fs=RATE, output='sos')
    band = signal.sosfilt(sections, rng.standard_normal(len(t)))
    x = 8.0 * np.sin(50.0 * np.pi * t) + 0.2 * rng.standard_normal(len(t))
    told = StreamingDiagnoser(BEARING, settings).push(0, x + 2.0 * band * (t >= 10.0), RATE, 25.0)
    assert (told[9].level, told[-1].level) == ('ok', 'fault')
    assert told[-1].severity.level_over_baseline > 12.0
    assert any(reason.startswith('1000 to 5000 Hz: +') for reason in told[-1].reasons)
    assert 20.0 * math.log10(told[-1].severity.rms / told[9].severity.rms) < 1.0


def _minutes(seed, rises):
    """Trend and diagnoses of windows that rise by so many dB; the load wanders by 1 dB."""
    rng, load, trend, found = np.random.default_rng(seed), 0.0, Trend(), []
    memory = math.exp(-1.0 / 8.0)
    for rise in rises:
        load = memory * load + math.sqrt(1.0 - memory**2) * rng.standard_normal()
        levels = rise + load + 0.3 * rng.standard_normal(3)
        window = said('healthy', 'ok')
        bands = tuple(10.0 ** (levels / 20.0))
        window = replace(window, severity=replace(window.severity, band_rms=bands))
        found.append(trend.update(window, MACHINE, wanted=60, pace=Pace(), full=True))
    return trend, found


def test_healthy_streams_under_a_load_that_wanders_are_ok():
    for seed in range(20):
        trend, found = _minutes(seed, np.zeros(600))
        assert trend.memory.base is not None
        assert not trend.memory.windows
        assert {diagnosis.level for diagnosis in found} == {'ok'}


@pytest.mark.parametrize('minutes', [1, 2, 5, 30])
def test_a_stream_that_climbs_while_it_is_learnt_is_not_its_own_baseline(minutes):
    climb = np.r_[np.linspace(0.0, 10.0, 60 * minutes), np.full(120, 10.0)]
    trend, found = _minutes(minutes, climb)
    assert found[-1].level in ('suspect', 'fault')
    early = 'over the lowest level so far' in ' '.join(found[-1].reasons)
    assert early == (trend.memory.base is None)
    assert repr(restored(Trend, trend.values())) == repr(trend)


def test_a_machine_that_starts_up_at_a_nominal_speed_is_no_alarm():
    """It gets 24 dB louder, and the lines of its shaft show at the given speed from then on."""
    loud = 10.0 ** (np.r_[np.linspace(-24.0, 0.0, 60), np.zeros(240)] / 20.0)
    shows = np.arange(300) >= 60
    said_at = [said('healthy', 'ok', rms=rms) for rms in loud]
    for starts in (True, False):
        trend, known = Trend(), {'wanted': 60, 'pace': Pace(), 'full': True}
        found = [
            trend.update(each, MACHINE, speed_known=not starts or bool(known_now), **known)
            for each, known_now in zip(said_at, shows, strict=True)
        ]
        assert ({each.level for each in found} == {'ok'}) == starts
        if starts:
            assert any('start up?' in ' '.join(each.reasons) for each in found)
            assert trend.memory.base.levels[0] == pytest.approx(0.0, abs=0.1)
        assert repr(restored(Trend, trend.values())) == repr(trend)


def test_a_fault_does_not_end_while_its_speed_is_not_known():
    """A machine that coasts down shows its combs at no given speed."""
    worn, silent = said('inner', 'fault', 'inner'), said('healthy', 'ok')
    for lost, level in ((True, 'fault'), (False, 'ok')):
        trend, known = Trend(), {'wanted': 600, 'pace': Pace(), 'full': True}
        for _ in range(120):
            trend.update(worn, MACHINE, **known)
        found = [trend.update(silent, MACHINE, speed_known=not lost, **known) for _ in range(120)]
        assert found[-1].level == level
        assert ('no lines of a shaft show' in found[9].reasons[-1]) == lost
    # It lasts if such a window asks for it, and keeps its place.
    trend, other = Trend(), said('outer', 'fault', 'outer')
    for verdicts, it in (([worn] * 60, True), ([silent] * 20, True), ([other] * 60, False)):
        found = [trend.update(each, MACHINE, speed_known=it, **known) for each in verdicts]
    assert {each.result for each in found} == {'inner'}
    found = [trend.update(silent, MACHINE, **known).level for _ in range(60)]
    assert found.index('ok') > 20
    # At a known speed it is told as soon as before, also one that was never known.
    for known_then in (True, False):
        trend = Trend()
        for each, it in ((worn, known_then), (silent, True)):
            found = [trend.update(each, MACHINE, speed_known=it, **known) for _ in range(120)]
        assert found[-1].level == 'ok'


@pytest.mark.parametrize('known_at_first', [False, True])
def test_a_baseline_is_kept_after_half_an_hour_whatever_shows_then(known_at_first):
    """Damage may show the lines of the shaft; and `hold_updates` may change."""
    trend, known = Trend(), {'wanted': 60, 'full': True}
    for number in range(2100):
        late = number >= 2000
        window = said('healthy', 'ok', rms=5.0 if late else 1.0)
        pace = Pace(updates=10 if number >= 1900 else 3)
        found = trend.update(
            window, MACHINE, speed_known=known_at_first or late, pace=pace, **known
        )
    assert found.level == 'fault'
    assert found.severity.level_over_baseline == pytest.approx(14.0, abs=0.1)


def test_a_standing_shaft_has_no_zone_and_c_is_a_lower_bound():
    """Zone C from 10 Hz on is at least zone C from 2 Hz on, also where the speed is not known."""
    settings = DiagnosisSettings(power_group=2, mounting='rigid')
    t = np.arange(int(8 * RATE)) / RATE
    x = np.sin(80.0 * np.pi * t) + 0.01 * np.random.default_rng(6).standard_normal(len(t))
    zones = {
        hertz: diagnose_record(1.3 * x, RATE, BEARING, hertz, unit='m/s^2', settings=settings)
        for hertz in (9.0, math.nan, 0.0)
    }
    told = [(d.severity.iso_zone, d.level) for d in zones.values()]
    assert told == [('C', 'suspect'), ('C', 'suspect'), ('', 'none')]


def test_a_held_answer_keeps_its_rule_and_what_its_confidence_is_about():
    shaft = replace(said('ambiguous', 'fault', 'outer'), rule='whole_turns', confidence=0.97)
    race = replace(said('ambiguous', 'fault', 'outer', 'inner'), rule='same_lines')
    for held, window, kind in ((shaft, race, 'elsewhere'), (race, shaft, 'ambiguous')):
        *_, last = _answers([held] * 3 + [window])
        assert (last.faults, last.window[0]) == (held.faults, 'ambiguous')
        assert (last.rule, last.confidence, last.kind) == (held.rule, held.confidence, kind)
    # Where the windows go on to another answer, so does its rule.
    assert _answers([shaft] * 3 + [race] * 3)[-1].rule == 'same_lines'


def test_bursts_that_the_level_makes_a_fault_claim_no_place():
    loud = replace(said('suspect', 'suspect', over=13.0), rule='bursts', confidence=0.97)
    found = with_required_level(loud)
    assert (found.result, found.level, found.faults) == ('ambiguous', 'fault', ())
    kind = kind_of(found.result, '', found.faults, found.rule)
    assert CLAIMS[kind] == 'that something strikes, not which part'
