# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The headline of a recording, and what a verdict says to people."""

import math

from bearing_twin.bearing.vocabulary import PLACES, TITLES
from bearing_twin.view.style import FAMILIES, VERDICTS
from bearing_twin.view.trends import OVER_LIMITS
from bearing_twin.view.verdict import (
    facts,
    Headline,
    measured,
    next_step,
    number,
    rival,
    shaft_speed,
    title_of,
    urgency,
)
from drawn import header, message, SECOND
import pytest

LEVEL = {'healthy': 1, 'suspect': 2, 'insufficient': 0, 'ambiguous': 3}
LEVEL_CONSTANT = {0: 3, 1: 0, 2: 1, 3: 2}


def verdict(result, *, confidence=0.9, score=8.0, shaft=25.4, stage=0):
    """Return a Diagnosis."""
    answer, level = list(TITLES).index(result), LEVEL_CONSTANT[LEVEL.get(result, 3)]
    return message(
        'Diagnosis',
        result=answer,
        window_result=answer,
        stage=stage,
        faults=[result] if result in PLACES else [],
        result_name=result,
        level=level,
        window_level=level,
        confidence=confidence,
        score=[score, math.nan, 1.0, 0.0],
        shaft_hz=shaft if result != 'insufficient' else math.nan,
        shaft_hz_given=shaft,
        unit='m/s^2',
        modulation_index=[0.1, 0.1, 0.1, 0.1],
    )


def before_full(result, **values):
    """Return a Diagnosis of a window that is not full yet: no level is held."""
    made = verdict(result, **values)
    made.level = 3
    return made


def headline(*results):
    """Return the headline of windows of one second."""
    found = Headline()
    for time, result in enumerate(results):
        found.take(time + 1.0, result if not isinstance(result, str) else verdict(result))
    return found


def test_a_fault_before_the_stop_is_the_headline():
    stopped = [verdict('insufficient', confidence=0.0, shaft=0.0)] * 10
    found = headline(*['inner'] * 24, *stopped)
    assert found.worst.best.result_name == 'inner'
    assert found.span == (
        '24 of 34 windows, from 1 s to 24 s; in the last: insufficient, shaft standing'
    )


def test_a_fault_that_is_held_over_a_stop_says_so():
    held = verdict('inner', shaft=0.0)
    held.level, held.window_level, held.shaft_hz = 2, 3, math.nan
    found = headline(*['inner'] * 24, *[held] * 10)
    assert found.span == '34 of 34 windows, from 1 s to 34 s; in the last: held, shaft standing'
    assert headline(*['inner'] * 24).span.endswith('; the same in the last')


@pytest.mark.parametrize(
    ('result', 'level', 'name'), [(0, 0, 'healthy'), (5, 1, 'suspect'), (99, 0, 'unknown')]
)
def test_a_fault_that_is_held_over_windows_without_it_says_so(result, level, name):
    held = verdict('inner')
    held.level, held.window_level, held.window_result = 2, level, result
    found = headline(*['inner'] * 24, *[held] * 10)
    assert found.span.endswith(f'from 1 s to 34 s; in the last: held, newest window {name}')
    worse = headline(*['outer'] * 40, *[held] * 10)
    assert worse.span.endswith('from 1 s to 40 s; in the last: inner race fault, held')


def test_an_insufficient_verdict_that_is_held_over_healthy_windows_says_so():
    held = verdict('insufficient')
    held.level, held.window_level, held.window_result = 3, 0, 0
    found = headline(*['insufficient'] * 24, *[held] * 10)
    assert found.span.endswith('in the last: held, newest window healthy')


def test_long_spans_are_told_in_minutes_and_hours():
    found = Headline()
    for at in (3600.0, 5400.0, 9000.0):
        found.take(at, verdict('outer'))
    assert found.span == '3 of 3 windows, from 60.0 min to 150.0 min; the same in the last'
    found.take(86400.0, verdict('outer'))
    assert found.span == '4 of 4 windows, from 1.0 h to 24.0 h; the same in the last'


def test_a_passing_verdict_is_no_headline():
    found = headline(*['healthy'] * 20, 'outer', 'outer', *['healthy'] * 5)
    assert found.worst.best.result_name == 'healthy'
    assert headline('healthy', 'outer').worst.best.result_name in ('healthy', 'outer')


def test_a_window_that_says_nothing_is_no_headline_beside_one_that_does():
    for windows in (['outer'] * 2, ['inner', 'suspect'] * 20, ['healthy']):
        named = headline(*['insufficient'] * 3, *windows).worst.best.result_name
        assert named == windows[0]


def test_spectra_are_of_the_window_of_the_headline_and_of_its_run():
    # The sample index begins again with each start of the sensor.
    windows = []
    for second, result in ((10, 'inner'), (50, 'insufficient')):
        diagnosis = verdict(result, confidence=0.9 if result == 'inner' else 0.0)
        diagnosis.header = header(second * SECOND)
        spectrum = message('Spectrum', second * SECOND, kind='spectrum')
        windows.append((diagnosis, spectrum))
    for early in (False, True):
        found = Headline()
        for diagnosis, spectrum in windows:
            if early:
                found.spectrum(spectrum)
            found.take(1.0, diagnosis)
            if not early:
                found.spectrum(spectrum)
        assert found.spectra == {'spectrum': windows[0][1]}


def test_every_place_is_in_the_title():
    several = verdict('outer')
    several.faults = ['outer', 'inner']
    assert title_of(several) == 'Outer race and inner race fault'
    unsure = verdict('ambiguous')
    unsure.faults = ['ball', 'cage']
    assert title_of(unsure) == 'Ambiguous: ball or cage'
    assert title_of(verdict('healthy')) == 'Healthy'


def test_a_high_level_without_a_place_is_headed_as_a_fault():
    assert title_of(verdict('ambiguous')) == 'Ambiguous: fault, place unknown'
    quiet = verdict('ambiguous')
    quiet.level = LEVEL_CONSTANT[LEVEL['suspect']]
    assert title_of(quiet) == 'Ambiguous'


def test_a_fault_has_the_colour_of_its_lines():
    colours = {state.key: state.colour for state in VERDICTS}
    assert all(colours[family.key] == family.colour for family in FAMILIES)
    assert len(set(colours.values())) == len(colours)


def test_a_machine_in_zone_d_is_not_only_recorded_again():
    loud = verdict('suspect')
    assert next_step(loud).startswith('Check bearing and speed')
    loud.velocity_rms = 56.0
    assert next_step(loud).startswith('Find the cause')
    named = verdict('outer', stage=2)
    named.velocity_rms = 17.7
    assert next_step(named).startswith('Find the cause')
    assert next_step(named).endswith('; order a bearing; measure daily.')
    # Of a stage that is not known only the velocity tells how loud it is.
    assert next_step(verdict('outer')).startswith('Record again')


def test_nothing_is_certain():
    inner, silent = verdict('inner', confidence=0.9999), verdict('insufficient', confidence=0.0)
    assert dict(facts(inner))['Confidence'] == '> 99 % that this place is damaged'
    assert 'Confidence' not in dict(facts(silent))


@pytest.mark.parametrize(
    ('result', 'faults', 'rule', 'sure', 'claim'),
    [
        ('suspect', [], 'elsewhere', 0.999, '> 99 % that something strikes, not which part'),
        ('suspect', ['outer'], 'extraneous', 0.9, '90 % that something strikes, not which part'),
        ('suspect', ['outer'], 'smooth', 0.9, '90 % that the bearing is damaged'),
        ('ambiguous', ['outer', 'ball'], '', 0.9, '90 % that one of these places is damaged'),
        # The level asks for it, and no comb does.
        ('ambiguous', [], 'healthy', 0.5, '50 % (not checked by simulation)'),
        ('healthy', [], '', 0.9, '90 % that no part is damaged'),
    ],
)
def test_the_confidence_says_what_it_is_about(result, faults, rule, sure, claim):
    said = verdict(result, confidence=sure)
    said.faults, said.rule = faults, rule
    assert dict(facts(said))['Confidence'] == claim


@pytest.mark.parametrize(
    ('windows', 'worst'),
    [
        (['insufficient'] * 9 + ['healthy'] * 3, 'healthy'),
        (['healthy'] * 9 + ['suspect'] * 3, 'suspect'),
        (['suspect'] * 9 + ['outer'] * 3, 'outer'),
        (['outer'] * 3 + ['inner'] * 4, 'inner'),
    ],
)
def test_urgency_outranks_duration(windows, worst):
    assert headline(*windows).worst.best.result_name == worst


def test_the_headline_is_of_the_clearest_window():
    weak, clear = verdict('inner', score=6.0), verdict('inner', score=12.0)
    assert headline(weak, clear, weak).worst.best is clear
    assert headline(weak, clear, weak).worst.at == 2.0


def test_the_headline_is_of_a_full_window_with_its_stage():
    early, full = before_full('outer', confidence=0.99), verdict('outer', confidence=0.98, stage=2)
    found = headline(early, early, *[full] * 8)
    assert found.worst.best is full
    assert next_step(found.worst.best) == 'Order a bearing; measure daily.'
    assert found.span.startswith('10 of 10 windows')
    # A file shorter than a window has no others.
    assert headline(*[early] * 3).worst.best is early


def test_the_headline_is_of_the_latest_stage():
    begun, severe = verdict('inner', stage=1, confidence=0.99), verdict('inner', stage=4)
    assert headline(begun, begun, severe, begun).worst.best is severe
    other = verdict('outer', stage=2, confidence=0.99)
    assert headline(*[severe] * 3, *[other] * 9).worst.best is severe


@pytest.mark.parametrize('result', ['suspect', 'outer', 'ambiguous'])
def test_an_early_judgement_is_not_lost_behind_healthy_windows(result):
    found = headline(*[before_full(result)] * 5, before_full('healthy'), *['healthy'] * 4)
    assert found.worst.best.result_name == result
    assert found.span == '5 of 10 windows, from 1 s to 5 s; in the last: healthy'
    full = headline(*[before_full(result, confidence=0.99)] * 7, *[result] * 3, *['healthy'] * 3)
    assert full.worst.best.result_name == result


def test_a_machine_that_wears_out_is_headed_by_its_loudest_part():
    windows = [verdict('suspect', confidence=0.5, score=score) for score in (3.0, 7.0, 4.0, 5.0)]
    for window, velocity in zip(windows, (19.0, 20.0, 157.0, 150.0), strict=True):
        window.velocity_rms = velocity
    assert headline(*windows).worst.best is windows[2]


@pytest.mark.parametrize('early', [['healthy'] * 4, ['suspect', 'insufficient', 'suspect']])
def test_what_part_of_a_window_says_is_no_headline_beside_full_ones(early):
    early = [before_full(result) for result in early]
    assert headline(*early, *['insufficient'] * 5).worst.best.result_name == 'insufficient'
    assert headline(*early, 'ball', 'insufficient').worst.best.result_name == 'ball'
    # Where no window is full, the most frequent answer counts.
    assert headline(*early).worst.best is early[-1]


def test_the_level_of_a_window_alone_counts_only_with_its_own_answer():
    # Held: the answer is not that of the window.
    healthy, lost = verdict('healthy'), verdict('insufficient')
    healthy.window_result, healthy.window_level = 2, 2
    lost.window_result, lost.window_level = 0, 0
    assert urgency(healthy) == (1, 0)
    assert urgency(lost) == (0, 0)


def test_nothing_says_nan():
    for result in ('healthy', 'inner', 'insufficient'):
        assert 'nan' not in ' '.join(' '.join(row) for row in facts(verdict(result)))
    assert number(math.nan, 'Hz') == 'not known'
    assert number(2.5, 'Hz') == '2.5 Hz'
    assert number(0.0123456, 'g') == '0.0123 g'
    assert number(1234.4, 'N') == '1234 N'
    assert number(-999999.0) == '-999999'
    assert number(1e300, 'm/s²') == '1e+300 m/s²'


def test_significance_alone_is_no_evidence_over_its_limits():
    outer = OVER_LIMITS.trends[0]
    weak = message('Diagnosis', score=[11.0], modulation_index=[0.9])
    assert outer.value(weak) == pytest.approx(1.5)
    for lacking in ([math.nan], []):
        weak.modulation_index = lacking
        assert math.isnan(outer.value(weak))


def test_a_shaft_at_rest_is_standing():
    assert shaft_speed(verdict('insufficient', shaft=0.0)) == 'standing'
    assert shaft_speed(verdict('healthy', shaft=25.0)) == '25.00 Hz (1500 rpm)'
    assert shaft_speed(verdict('healthy', shaft=math.nan)) == 'not known'


def test_a_rival_is_named_with_the_reason_it_lost():
    inner = verdict('inner')
    inner.score, inner.modulation_index = [18.0, 15.0, 1.0, 0.5], [3.0, 2.5, 0.1, 0.1]
    inner.bpfo, inner.bpfi, inner.bsf, inner.ftf = 76.86, 126.34, 49.07, 9.61
    inner.fault_hz = 126.42
    # BPFI less two turns of the shaft is 75.62 Hz, 1.6 % from BPFO.
    assert 'outer race is significant too' in rival(inner)
    assert 'within 1.6 % of a shaft sideband of the inner race' in rival(inner)
    for bpfo in (90.0, 0.0):
        inner.bpfo = bpfo
        assert rival(inner).endswith('modulation index 2.50 against 3.00.')
    # Far below what was found, but over both limits of a fault by itself.
    inner.score[1] = 6.0
    assert 'outer race is significant too (6.0 against 18.0)' in rival(inner)
    inner.modulation_index[1] = 0.5
    assert rival(inner) == ''
    healthy = verdict('healthy')
    healthy.score, healthy.modulation_index = [1.0, 13.0, 2.0, 1.0], [0.0, 0.13, 0.0, 0.0]
    assert 'modulation index of 0.13 is below the 0.3 from which' in rival(healthy)
    # Above that it is not the index that speaks against it.
    healthy.modulation_index[1] = 0.45
    assert rival(healthy) == ''
    # The cage is a rival though the outer race is farther over its own limit.
    inner.score = [12.0, 7.0, 1.0, 9.0]
    assert 'cage is significant too' in rival(inner)
    # A cage needs more, and one with the index of a fault is not denied by it.
    for cage, index in ((6.0, 0.3), (9.0, 0.7)):
        healthy.score, healthy.modulation_index = [1.0, 2.0, 2.0, cage], [0.0, 0.0, 0.0, index]
        assert rival(healthy) == ''
    assert rival(verdict('insufficient')) == ''


def test_a_level_that_is_corrected_says_by_how_much_and_on_what_it_rests():
    made = verdict('healthy')
    made.rms, made.level_over_baseline = 1.0, 0.4
    made.level_correction, made.level_correction_sd = 1.9, 0.3
    made.correction_basis = '+0.086 +- 0.021 dB/K, learnt from 43 to 75 degC'
    said = dict(facts(made))['Corrected']
    assert said == (
        'by -1.9 ± 0.5 dB for temperature and speed: +0.086 ± 0.021 dB/K, learnt from 43 to 75 °C'
    )
    made.level_correction = made.level_correction_sd = 0.0
    made.correction_basis = 'temperature not corrected: its record is too short'
    made.peak = made.crest_factor = made.kurtosis = 1.0
    assert 'Corrected' not in dict(facts(made))
    assert dict(measured(made))['Correction'] == made.correction_basis


@pytest.mark.parametrize(
    ('unit', 'velocity', 'shaft', 'why'),
    [
        ('', math.nan, 25.0, ': needs a unit of acceleration, g or m/s^2'),
        ('V', math.nan, 25.0, ': needs a unit of acceleration, g or m/s^2'),
        ('g', math.nan, 25.0, ': needs at least 1 s'),
        ('g', 1.0, 5.0, ' below 600 1/min'),
        ('m/s^2', 1.0, 25.0, ': needs machine group and mounting'),
        ('m/s^2', 1.0, math.nan, ': needs machine group, mounting and speed'),
    ],
)
def test_why_there_is_no_zone_names_what_is_missing(unit, velocity, shaft, why):
    made = verdict('healthy', shaft=shaft)
    made.peak = made.crest_factor = made.kurtosis = 1.0
    made.unit, made.velocity_rms = unit, velocity
    assert dict(measured(made))['Zone'] == f'none of ISO 20816-3{why}'
