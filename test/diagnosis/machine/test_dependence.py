# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a machine's own record says of temperature and speed; a rise that is small but stays."""

from dataclasses import asdict, replace
import math

from bearing_twin.bearing import find_bearing
from bearing_twin.diagnosis.machine.dependence import (
    Condition,
    fit_law,
    HealthyRecord,
    Law,
    PER_KELVIN,
    Slope,
    Z90,
)
from bearing_twin.diagnosis.machine.held import Pace
from bearing_twin.diagnosis.machine.level import with_required_level
from bearing_twin.diagnosis.machine.onset import DECISION_DB, Rise
from bearing_twin.diagnosis.machine.trend import Source, Trend
from bearing_twin.diagnosis.result import insufficient
from bearing_twin.errors import BearingTwinError
from bearing_twin.packed import restored
from bearing_twin.studies import rise, temperature
from bearing_twin.studies.disturbances import with_memory
import numpy as np
import pytest
from scipy.signal import lfilter

MACHINE = Source('imu y', '6307', 'g', 25600.0)


def wander(rng, count, memory, height=0.6):
    return height * with_memory(rng.standard_normal(count + 200), memory)[200:]


@pytest.mark.parametrize('memory', [1, 10, 40])
def test_interval_of_the_slope_holds_the_true_one_although_the_level_has_a_memory(memory):
    rng = np.random.default_rng(memory)
    held, known = [], 0
    for _ in range(60):
        heat = 70.0 + 12.0 * np.sin(np.arange(240) / 16.0) + wander(rng, 240, 20, 3.0)
        slope = rng.normal(*PER_KELVIN)
        level = slope * heat + wander(rng, 240, memory)
        level[rng.random(240) < 0.03] += 8.0
        found = fit_law(level, heat, np.full(240, 4.5)).temperature
        known += found.known
        held.append(abs(found.mean - slope) <= Z90 * found.deviation)
    # 90 % of 60, less three standard deviations of that count.
    assert sum(held) >= 47
    assert known >= 57


def test_run_in_while_it_warms_up_is_not_taken_for_temperature():
    """The level falls by 4 dB along with the rise of temperature: nobody can tell which it is."""
    rng = np.random.default_rng(2)
    known = 0
    for _ in range(40):
        time = np.arange(200)
        heat = 90.0 - 50.0 * np.exp(-time / 60.0)
        level = 4.0 * np.exp(-time / 60.0) + wander(rng, 200, 15)
        known += fit_law(level, heat, np.full(200, 4.5)).temperature.known
    assert known <= 4


def goes_with_temperature(kind, rng):
    """Return levels and temperatures of a machine, one an hour; the level need not follow."""
    count = 250
    hour = np.arange(count)
    heat = 55.0 + 10.0 * np.sin(2.0 * np.pi * hour / 24.0 + 6.0 * rng.random())
    heat += 4.0 * wander(rng, count, 10.0, 1.0)
    level = 0.05 * heat
    if kind == 'load':
        # It is heard at once and warms the bearing over two hours; temperature does nothing.
        load = wander(rng, count, 4.5, 1.0)
        level = 1.5 * load
        heat = 55.0 + 8.0 * lfilter([0.4], [1.0, -0.6], load)
    elif kind == 'lag':
        level = 0.15 * lfilter([0.25], [1.0, -0.75], heat - 55.0)
    elif kind == 'run-in':
        level = -4.0 * np.exp(-hour / 40.0)
        heat = 70.0 - 30.0 * np.exp(-hour / 60.0) + 2.0 * wander(rng, count, 10.0, 1.0)
    return level + wander(rng, count, 1.5, 0.5), heat


@pytest.mark.parametrize(
    'kind, least, most', [('follows', 19, 20), ('load', 0, 0), ('lag', 0, 4), ('run-in', 0, 0)]
)
def test_what_only_goes_with_the_temperature_is_not_called_known(kind, least, most):
    rng = np.random.default_rng(11)
    laws = [fit_law(*goes_with_temperature(kind, rng), np.full(250, 4.6)) for _ in range(20)]
    assert least <= sum(law.temperature.known for law in laws) <= most
    # Up to 1 dB would be known enough: another reason is given there.
    assert not any('leave 0.' in str(law) for law in laws)


def test_speed_is_learnt_where_it_varies_and_levels_of_other_speeds_are_not_compared():
    rng = np.random.default_rng(3)
    octaves = np.log2(rng.choice([10.0, 20.0, 40.0], 200))
    level = 9.0 * octaves + 0.5 * rng.standard_normal(200)
    law = fit_law(level, np.full(200, math.nan), octaves)
    assert law.octaves.known and law.octaves.mean == pytest.approx(9.0, abs=0.3)
    assert not law.temperature.known
    slow, fast = Condition.at(math.nan, 10.0), Condition.at(math.nan, 40.0)
    change, deviation = law.correct(fast, slow)
    assert change == pytest.approx(18.0, abs=0.6) and 0.0 < deviation < 0.5
    assert law.comparable(fast, slow)
    assert not law.comparable(Condition.at(math.nan, 80.0), slow)
    assert not Law().comparable(fast, slow)
    assert Law().comparable(Condition(), slow)
    assert Law().correct(fast, slow) == (0.0, 0.0)


def test_a_bearing_hotter_than_ever_is_not_excused_by_its_temperature():
    law = Law(Slope(0.2, 0.01, 50.0, 70.0, known=True))
    base = Condition(60.0)
    assert law.correct(Condition(70.0), base) == law.correct(Condition(160.0), base)
    assert law.correct(Condition(160.0), base)[0] == pytest.approx(2.0)


def test_record_of_a_year_stays_small_and_is_resumed_to_the_bit():
    rng = np.random.default_rng(4)
    record = HealthyRecord()
    for hour in range(3000):
        record.add([0.1 * (hour % 24) + rng.normal()], Condition(50.0 + hour % 24, 4.6))
    assert len(record.rows) < 256
    law = record.laws()[0]
    assert law.temperature.mean == pytest.approx(0.1, abs=0.02)
    again = restored(HealthyRecord, asdict(record))
    assert again == record and again.laws()[0] == law
    for broken in (
        {'rows': [[1.0]]}, {'span': 0}, {'rows': [[60.0, 4.0, math.nan]]}, {'new': 1}, {'rows': 3},
    ):  # fmt: skip
        with pytest.raises(BearingTwinError, match=r'use what save|of another version'):
            restored(HealthyRecord, asdict(record) | broken)


def said(level, heat, *bands):
    """Verdict on a level below 1 kHz, and on those of the bands above, dB."""
    nothing = insufficient(['by hand'], find_bearing('6307'))
    rms, *above = 10.0 ** (np.array([level, *bands]) / 20.0)
    bands_rms = tuple(float(rms) for rms in (rms, *(above or (0.0, 0.0))))
    severity = replace(nothing.severity, rms=math.hypot(*bands_rms), band_rms=bands_rms)
    return replace(nothing, result='healthy', level='ok', confidence=0.9, severity=severity,
                   shaft_hz=25.0, temperature=heat)  # fmt: skip


def live(readings, trend=None):
    """Run verdicts, one a minute, through a trend."""
    trend = trend or Trend()
    return trend, [
        trend.update(
            said(*reading), MACHINE, wanted=5, pace=Pace(updates=1, interval=60.0), full=True
        )
        for reading in readings
    ]


def test_a_machine_that_is_louder_when_hot_teaches_it_and_is_then_compared_fairly():
    rng = np.random.default_rng(5)
    heats = 40.0 + 20.0 * np.sin(np.arange(400) / 20.0)
    readings = [(0.12 * heat + 0.3 * rng.standard_normal(), heat) for heat in heats]
    trend, found = live(readings)
    assert {d.level for d in found} == {'ok'}
    last = found[-1].severity
    assert '+0.12' in last.correction_basis
    assert last.level_over_baseline == pytest.approx(0.0, abs=1.5)
    # The baseline is of the windows over which the temperature stayed: near its highest.
    cold = live([(0.12 * 40.0, 40.0)] * 5, trend)[1][-1].severity
    assert trend.memory.at.temperature == pytest.approx(60.0, abs=2.0)
    assert cold.correction == pytest.approx(0.12 * (40.0 - 60.0), abs=0.3)
    assert 0.0 < cold.correction_sd < 0.3
    # Saved and resumed it says the same.
    again = restored(Trend, trend.values())
    resumed, straight = (live(readings[:50], one)[1] for one in (again, trend))
    assert [str(d.severity) for d in resumed] == [str(d.severity) for d in straight]
    assert again == trend


def test_what_is_said_of_two_measures_that_are_alike_stays():
    rng = np.random.default_rng(8)
    readings = [(0.0, 60.0, *rng.normal(10.0, 0.3, 2)) for _ in range(100)]
    trend, _ = live(readings)
    shown = [live([reading], trend)[1][0].reasons[-1].partition(':')[0] for reading in readings]
    assert len(set(shown[5:])) == 1
    # A measure that is clearly further over the baseline takes over, and so does one that alone
    # is far enough for an alarm.
    louder = [(0.0, 60.0, *heights) for heights in ((12.0, 10.0), (10.0, 12.0), (15.7, 16.3))]
    *shown, alarm = live(louder, trend)[1]
    names = [diagnosis.reasons[-1].partition(':')[0] for diagnosis in shown]
    assert names == ['1000 to 5000 Hz', '5000 to 20000 Hz']
    assert alarm.level == 'suspect'


def test_uncertain_correction_raises_no_alarm():
    severity = replace(said(0.0, 20.0).severity, level_over_baseline=6.5, correction_sd=0.5)
    verdict = replace(said(0.0, 20.0), severity=severity)
    assert with_required_level(verdict).level == 'ok'
    sure = replace(verdict, severity=replace(severity, correction_sd=0.1))
    assert with_required_level(sure).level == 'suspect'


def test_small_rise_that_stays_is_suspect_and_says_since_when():
    rng = np.random.default_rng(6)
    quiet = [(0.5 * rng.standard_normal(), math.nan) for _ in range(300)]
    trend, found = live(quiet)
    assert {d.level for d in found} == {'ok'}
    _, found = live([(4.5 + 0.5 * rng.standard_normal(), math.nan) for _ in range(60)], trend)
    assert found[20].level == 'ok'
    assert found[-1].level == 'suspect'
    assert found[-1].severity.rising == pytest.approx(60, abs=4)
    assert 'rising for' in found[-1].reasons[-1]
    # It ends with its cause.
    _, found = live([(0.0, math.nan)] * 60, trend)
    assert found[-1].level == 'ok'


def test_rise_finds_what_the_study_counts():
    rng = np.random.default_rng(7)
    assert max(rise.largest_sum(rng, 0.8, 20.0) for _ in range(3)) < DECISION_DB
    assert 10 < np.median([rise.minutes_until(rng, 6.0) for _ in range(9)]) < 20
    with pytest.raises(BearingTwinError, match='saved rise'):
        restored(Rise, {'total': -1.0, 'lasting': 0, 'found': False})


def test_simulated_bearings_get_louder_and_quieter_with_temperature(monkeypatch):
    """The prior holds what the physical mode says, which is not even the sign."""
    monkeypatch.setattr(temperature, 'LOADS', (500.0, 2000.0))
    monkeypatch.setattr(temperature, 'CLEARANCES', (0.0, 10e-6))
    slopes, octaves = temperature.simulated_slopes()
    assert slopes.min() < -0.02 < 0.02 < slopes.max()
    assert abs(np.median(slopes) - PER_KELVIN[0]) < PER_KELVIN[1]
    assert 4.0 < np.median(octaves) < 16.0


def test_a_record_that_is_thinned_out_keeps_both_speeds_of_a_machine_that_alternates():
    record = HealthyRecord()
    for number in range(5000):
        record.add([5.0 * (number % 2)], Condition(50.0, 5.0 + 0.5 * (number % 2)))
    assert record.span == 32
    assert 0.3 < np.mean([row[1] > 5.0 for row in record.rows]) < 0.7
    assert record.laws()[0].octaves.known
