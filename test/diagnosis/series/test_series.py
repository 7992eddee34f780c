# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Many short snapshots of one machine: its level over what it did while it was healthy."""

from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import cache
import itertools
import json
import math
import re

from bearing_twin.bearing import fault_orders, find_bearing
from bearing_twin.diagnosis.machine.onset import rise_begins, slope
from bearing_twin.diagnosis.record import diagnose_record
from bearing_twin.diagnosis.series import monitor as series
from bearing_twin.diagnosis.series.monitor import SeriesMonitor
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.errors import BearingTwinError
from cases import in_proofs
from coupling import coupling_snapshot, GIVEN_HZ
import numpy as np
import pytest
from scipy.stats import theilslopes

RATE, SHAFT_HZ, CYCLE = 25600.0, 30.0, 10.0
COUNT = 1280
HOUR = round(3600.0 / CYCLE)


BEGIN = 700
"""Snapshots before anything is made of a life."""


@dataclass
class Life:
    """A machine, what listens to it, and what that has said of each snapshot."""

    rng: np.random.Generator
    scatter: float = 0.8
    warm: bool = True
    level: float = 0.0
    monitor: SeriesMonitor = field(default_factory=lambda: SeriesMonitor(None))
    points: list = field(default_factory=list)

    def go_on(self, snapshots, rise=None):
        """Live until there are so many snapshots; ``rise`` adds dB to each."""
        rng, wander = self.rng, self.scatter * np.sqrt(1.0 - 0.95**2)
        for number in range(len(self.points), snapshots):
            # Level as on a machine: it wanders, falls while the machine runs in, is disturbed.
            self.level = 0.95 * self.level + wander * rng.standard_normal()
            cold = np.exp(-number / 100.0) if self.warm else 0.0
            over = 0.0 if rise is None else rise(number)
            height = 10.0 ** ((self.level + 8.0 * cold + over) / 20.0)
            x = height * rng.standard_normal(COUNT)
            if rng.random() < 0.03:
                x[rng.integers(COUNT)] += 60.0 * height
            warmth = 70.0 - 45.0 * cold
            self.points.append(
                self.monitor.add(CYCLE * number, x, RATE, SHAFT_HZ, temperature=warmth)
            )
        return self.monitor, self.points


def life(seed, snapshots, rise=None, **machine):
    """Return a monitor and its points after a life; ``rise`` adds dB to each snapshot."""
    return Life(np.random.default_rng(seed), **machine).go_on(snapshots, rise)


@cache
def begun(seed):
    """Return a life after its healthy beginning, to be copied and gone on with."""
    whole = Life(np.random.default_rng(seed))
    whole.go_on(BEGIN)
    return whole


@pytest.mark.parametrize('seed', [0, 1, *in_proofs(*range(2, 8))])
def test_healthy_machine_that_wanders_and_warms_up_is_never_alarmed(seed):
    monitor, points = deepcopy(begun(seed)).go_on(1200)
    report = monitor.report()
    assert {point.level for point in points} == {'none', 'ok'}
    assert report.level == 'ok'
    assert np.isnan(report.first_alarm) and np.isnan(report.change)
    # The baseline is of the warm machine.
    assert report.baseline[0] > 100 * CYCLE
    assert abs(report.warmer) < 3.0


@pytest.mark.parametrize(
    ('hours', 'seed'),
    [(0.5, 0), (1.5, 1), *in_proofs(*((0.5, seed) for seed in range(1, 6)), (1.5, 0), (1.5, 2))],
)
def test_worn_out_machine_is_alarmed_after_the_damage_began(hours, seed):
    begin, end = BEGIN, BEGIN + round(hours * HOUR)
    monitor, points = deepcopy(begun(seed)).go_on(
        end, lambda n: (n - begin) / (end - begin) * 20.0
    )
    report = monitor.report()
    assert report.level == 'fault'
    assert all(point.level in ('none', 'ok') for point in points[:begin])
    # 6 dB are reached after 0.3 of the rise, 12 dB after 0.6.
    assert report.first_alarm == pytest.approx(CYCLE * (begin + 0.3 * (end - begin)),
                                               abs=0.2 * CYCLE * (end - begin))  # fmt: skip
    assert report.first_alarm < report.first_fault
    # The wandering level remembers twenty snapshots; twice as many may come before the rise.
    assert begin - 40 <= report.change / CYCLE
    assert report.change <= report.first_alarm
    assert report.changes == 2
    assert report.trend > 5.0


def test_level_changes_at_most_twice_an_hour():
    """A machine that is loud for four minutes in every half hour, six times."""
    monitor, points = deepcopy(begun(1)).go_on(
        BEGIN + 3 * HOUR, lambda n: 9.0 * ((n - BEGIN) % 180 < 24)
    )
    levels = [point.level for point in points]
    changed = np.flatnonzero([a != b for a, b in itertools.pairwise(levels)])
    changed = changed[changed >= BEGIN]
    assert all(np.sum((changed >= at) & (changed < at + HOUR)) <= 2 for at in changed)
    assert 'fault' not in levels
    assert monitor.report().level == 'suspect'


def test_alarm_ends_an_hour_after_the_cause():
    end = BEGIN + 50
    monitor, _ = deepcopy(begun(0)).go_on(end + HOUR + 40, lambda n: 15.0 * (n < end))
    report = monitor.report()
    assert report.level == 'ok'
    assert report.first_fault == pytest.approx(BEGIN * CYCLE, abs=5 * CYCLE)
    assert report.change == pytest.approx(BEGIN * CYCLE, abs=5 * CYCLE)
    last = max(point.time for point in report.points if point.level == 'fault')
    assert last == pytest.approx(end * CYCLE + 3600.0, abs=10 * CYCLE)


@pytest.mark.parametrize(('seed', 'share', 'most'), [(0, 0.0, 4), (1, 0.25, 13), (2, 0.25, 13)])
def test_shocks_in_a_quarter_of_the_snapshots_are_no_alarm_and_hide_no_damage(seed, share, most):
    """Up to three shocks of 10 to 60 times the RMS in 0.1 s: 5 to 20 dB in all measures."""
    rng, monitor = np.random.default_rng(seed), SeriesMonitor(None)
    t = np.arange(300) / RATE
    ring = np.exp(-500.0 * t) * np.sin(2.0 * np.pi * 3000.0 * t)
    worn, levels = 300, []
    for number in range(worn + 30):
        x = (3.0 if number >= worn else 1.0) * rng.standard_normal(2560)
        if rng.random() < share:
            for start in rng.integers(0, len(x) - len(ring), rng.integers(1, 4)):
                x[start : start + len(ring)] += rng.uniform(10.0, 60.0) * ring
        levels.append(monitor.add(600.0 * number, x, RATE, SHAFT_HZ).level)
    assert set(levels[:worn]) == {'none', 'ok'}
    alarm = next(n for n, level in enumerate(levels) if level in ('suspect', 'fault'))
    assert 4 <= alarm - worn + 1 <= most


def test_an_alarm_of_rare_snapshots_does_not_end_with_two_of_them():
    """Six hours apart and 2 dB more for every six of twelve: beside the threshold."""
    rng, monitor = np.random.default_rng(9), SeriesMonitor(None)
    for number in range(200):
        height = 0.0 if number < 100 else 2.0 if number % 12 < 6 else 8.0
        x = 10.0 ** (height / 20.0) * rng.standard_normal(COUNT)
        monitor.add(6.0 * 3600.0 * number, x, RATE, SHAFT_HZ)
    assert monitor.report().changes == 1
    for number in range(200, 240):
        monitor.add(6.0 * 3600.0 * number, rng.standard_normal(COUNT), RATE, SHAFT_HZ)
    assert monitor.report().level == 'ok'


def test_a_fault_that_comes_and_goes_is_an_alarm_until_it_is_mended():
    """14 dB more in three of five snapshots, never in three together."""
    rng, monitor = np.random.default_rng(10), SeriesMonitor(None)
    levels = []
    for number in range(250):
        height = 14.0 if 120 <= number < 210 and number % 5 in (1, 3, 4) else 0.0
        x = 10.0 ** (height / 20.0) * rng.standard_normal(COUNT)
        levels.append(monitor.add(600.0 * number, x, RATE, SHAFT_HZ).level)
    assert set(levels[:120]) == {'none', 'ok'}
    assert set(levels[180:210]) == {'fault'}
    assert levels[-1] == 'ok'


def test_other_speeds_and_broken_snapshots_are_not_judged():
    rng = np.random.default_rng(0)
    monitor = SeriesMonitor(None, DiagnosisSettings(baseline_windows=10))
    for number in range(40):
        monitor.add(number, rng.standard_normal(COUNT), RATE, SHAFT_HZ)
    assert monitor.add(50.0, 9.0 * rng.standard_normal(COUNT), RATE, 2.0 * SHAFT_HZ) is None
    assert monitor.add(51.0, np.full(COUNT, np.nan), RATE, SHAFT_HZ) is None
    assert monitor.add(52.0, np.zeros(COUNT), RATE, SHAFT_HZ) is None
    report = monitor.report()
    assert report.level == 'ok'
    assert any('1 snapshots not judged: another speed than the 30 Hz' in r for r in report.reasons)
    # A clock that was set back, another sensor.
    assert monitor.add(3.0, 9.0 * rng.standard_normal(COUNT), RATE, SHAFT_HZ) is None
    assert monitor.add(53.0, 9.0 * rng.standard_normal(COUNT), 0.5 * RATE, SHAFT_HZ) is None
    assert monitor.add(54.0, 9.0 * rng.standard_normal(COUNT), RATE, SHAFT_HZ, unit='g') is None
    reasons = ' '.join(monitor.report().reasons)
    assert '1 snapshots not judged: not later than the one before; sort the files' in reasons
    assert "unit 'g' are not the 25600 Hz and ''" in reasons and '12800 Hz' in reasons
    assert monitor.report().level == 'ok'
    with pytest.raises(BearingTwinError, match='a baseline of 3 snapshots'):
        SeriesMonitor(None, DiagnosisSettings(baseline_windows=3))


@pytest.mark.parametrize(
    ('height', 'hertz', 'why'),
    [
        (1e-3, SHAFT_HZ, 'does the machine stand still, is the sensor loose'),
        (3.0, 1.3 * SHAFT_HZ, 'another speed than the 30 Hz'),
    ],
)
def test_a_machine_that_is_not_judged_any_more_is_not_ok(height, hertz, why):
    rng = np.random.default_rng(1)
    monitor = SeriesMonitor(None, DiagnosisSettings(baseline_windows=20))
    for number in range(40):
        monitor.add(number, rng.standard_normal(COUNT), RATE, SHAFT_HZ)
    for number in range(40, 65):
        assert monitor.report().level == ('ok' if number < 60 else 'none')
        assert monitor.add(number, height * rng.standard_normal(COUNT), RATE, hertz) is None
    reasons = monitor.report().reasons
    assert any('not known: the last 25 snapshots were not judged' in reason for reason in reasons)
    assert any(why in reason for reason in reasons)
    # What was not judged is no baseline: the machine is what it was.
    assert monitor.add(65.0, rng.standard_normal(COUNT), RATE, SHAFT_HZ).level == 'ok'
    assert monitor.report().level == 'ok'


@pytest.mark.parametrize('hertz', [1e300, math.inf])
def test_a_shaft_speed_of_no_machine_is_not_judged(hertz):
    """In a short snapshot it was an index that no array has."""
    monitor = SeriesMonitor(None)
    assert monitor.add(0.0, np.random.default_rng(0).standard_normal(200), RATE, hertz) is None
    assert '1 snapshots not judged: a shaft speed above 1e+09 Hz' in monitor.report().reasons[-1]


def test_a_machine_that_stood_before_it_was_known_is_not_alarmed_when_it_runs_again():
    """Its speed is a nameplate's, so that it is not known to stand; it warms up all the time."""
    monitor, rng = SeriesMonitor(None), np.random.default_rng(5)
    for number in range(100):
        height = 0.02 if 20 <= number < 50 else 1.0
        x, heat = height * rng.standard_normal(COUNT), 40.0 + 0.2 * number
        point = monitor.add(600.0 * number, x, RATE, SHAFT_HZ, temperature=heat)
        assert (point is None) == (height < 1.0)
        assert point is None or point.level == 'none'
    assert any('30 snapshots not judged: 12 dB' in why for why in monitor.report().reasons)


@pytest.mark.parametrize('period', [48, 60])
def test_a_machine_whose_temperature_swings_with_the_window_has_a_baseline(period):
    """Its level falls by 0.12 dB/K; a swing as long as the baseline's window never settles."""
    monitor, rng, wander = SeriesMonitor(None), np.random.default_rng(1), 0.0
    levels = []
    for number in range(240):
        wander = 0.9 * wander + 0.25 * rng.standard_normal()
        swing = 12.0 * np.sin(2.0 * np.pi * number / period) + 0.3 * rng.standard_normal()
        level = wander - 0.12 * swing + 8.0 * (number >= 220)
        x = 10.0 ** (level / 20.0) * rng.standard_normal(COUNT)
        point = monitor.add(600.0 * number, x, RATE, SHAFT_HZ, temperature=40.0 + swing)
        levels.append(point.level)
    assert set(levels[150:220]) == {'ok'} and not {'suspect', 'fault'} & set(levels[:150])
    assert levels[-1] == 'suspect'


def test_two_machines_in_one_series_have_no_baseline():
    rng = np.random.default_rng(2)
    monitor = SeriesMonitor(None, DiagnosisSettings(baseline_windows=20))
    for number in range(100):
        height = 2.0 if number % 2 else 1.0
        point = monitor.add(number, height * rng.standard_normal(COUNT), RATE, SHAFT_HZ)
        assert point.level == 'none'
    assert 'in 20 snapshots the level scatters by ' in monitor.report().reasons[0]


def test_a_short_snapshot_has_no_velocity():
    """A line below 10 Hz, cut anywhere in 0.1 s, is no velocity in the band of the standard."""
    monitor = SeriesMonitor(
        None, DiagnosisSettings(baseline_windows=10, power_group=2, mounting='rigid')
    )
    for number in range(30):
        t = np.arange(2560) / RATE + 0.013 * number
        x = np.random.default_rng(number).standard_normal(2560) + 2.0 * np.sin(10.0 * np.pi * t)
        point = monitor.add(number, x, RATE, SHAFT_HZ, unit='m/s^2')
    assert (point.iso_zone, point.level) == ('', 'ok')


@pytest.mark.parametrize(('share', 'level'), [(0.1, 'ok'), (1.0, 'fault')])
def test_a_zone_of_single_snapshots_is_no_alarm(share, level):
    """Blows at 40 Hz, of 3 to 10 m/s^2, are zone C or D for their snapshot only."""
    rng, t = np.random.default_rng(0), np.arange(6400) / 6400.0
    blow = np.exp(-8.0 * t) * np.sin(2.0 * np.pi * 40.0 * t)
    monitor = SeriesMonitor(None, DiagnosisSettings(power_group=2, mounting='rigid'))
    for number in range(150):
        height = rng.uniform(3.0, 10.0) * (rng.random() < share)
        x = 0.3 * rng.standard_normal(len(t)) + height * blow
        monitor.add(600.0 * number, x, 6400.0, SHAFT_HZ, unit='m/s^2')
    said = monitor.report()
    assert {point.iso_zone for point in said.points} >= {'C', 'D'}
    assert said.level == level and said.first_alarm == pytest.approx(
        math.nan if level == 'ok' else 4 * 600.0, nan_ok=True
    )


def test_a_machine_that_is_loud_from_the_first_snapshot_on_has_no_rise():
    monitor = SeriesMonitor(None, DiagnosisSettings(power_group=2, mounting='rigid'))
    rng = np.random.default_rng(6)
    for number in range(20):
        x = np.cumsum(rng.standard_normal(int(1.1 * RATE)))
        monitor.add(number, x, RATE, SHAFT_HZ, unit='m/s^2')
    said = monitor.report()
    assert said.level == 'fault' and np.isfinite(said.alarm) and np.isnan(said.change)
    assert not any('began to rise' in reason for reason in said.reasons), said.reasons


def test_a_new_bearing_ends_the_alarm_and_has_its_own_baseline():
    monitor, points = life(
        3, 700, lambda n: 16.0 * (150 <= n < 200) - 5.0 * (n >= 200), scatter=0.4, warm=False
    )
    assert points[199].level == 'fault' and points[-1].level == 'ok'
    assert monitor.report().baseline[0] >= 200 * CYCLE
    # 2 dB over the level of the old bearing are 7 dB over that of the new one.
    rng = np.random.default_rng(4)
    for number in range(700, 750):
        x = 10.0**0.1 * rng.standard_normal(COUNT)
        point = monitor.add(CYCLE * number, x, RATE, SHAFT_HZ, temperature=70.0)
    assert point.level == 'suspect'


@pytest.mark.parametrize(
    ('share', 'height', 'level'),
    # A third of the order has harmonics there, too; three times the order every third one.
    [
        (1.0, 6.0, 'suspect'),
        (1.0, 0.0, 'ok'),
        (1.0, 0.5, 'ok'),
        (3.0, 6.0, 'ok'),
        (1 / 3, 6.0, 'ok'),
    ],
)
def test_a_machine_that_is_damaged_from_the_first_short_snapshot_on(share, height, level):
    """Six turns tell nothing alone, and nothing rises: the averaged envelope tells."""
    bearing = find_bearing('6205')
    order = share * fault_orders(bearing).impacts('outer')
    rng = np.random.default_rng(11)
    t = np.arange(100) / RATE
    ring = np.exp(-1500.0 * t) * np.sin(2.0 * np.pi * 8e3 * t)
    monitor = SeriesMonitor(bearing, DiagnosisSettings(baseline_windows=20))
    for number in range(45):
        hits = np.zeros(5120)
        gap = RATE / (order * SHAFT_HZ)
        hits[np.arange(rng.uniform(0.0, gap), 5120.0, gap).astype(int)] = height
        x = rng.standard_normal(5120) + np.convolve(hits, ring)[:5120]
        point = monitor.add(CYCLE * number, x, RATE, SHAFT_HZ)
        if number == 30:
            saved = monitor.save()
    assert point.level == level
    report = monitor.report()
    assert report.place == ('outer' if level == 'suspect' else '')
    assert ('in the average of 20 snapshots' in ' '.join(report.reasons)) == (level == 'suspect')
    resumed = SeriesMonitor(bearing, DiagnosisSettings(baseline_windows=20))
    resumed.load(*saved)
    assert resumed.report().place == report.place


@pytest.mark.parametrize(('height', 'level'), [(0.0, 'ok'), (1.5, 'suspect')])
def test_a_race_that_rings_in_one_narrow_band_from_the_first_short_snapshot_on(height, level):
    """At 1.7 kHz, 13 turns each eight hours: noise hides it in a band that is 4 kHz wide."""
    bearing, rng, rate, hertz = find_bearing('6205'), np.random.default_rng(5), 12800.0, 26.0
    gap = rate / (fault_orders(bearing).bpfo * hertz)
    t = np.arange(200) / rate
    ring = np.exp(-300.0 * t) * np.sin(2.0 * np.pi * 1.7e3 * t)
    monitor = SeriesMonitor(bearing, DiagnosisSettings(baseline_windows=20))
    for number in range(45):
        at = np.cumsum(gap * (1.0 + 0.01 * rng.standard_normal(round(6400.0 / gap) - 1)))
        hits = np.zeros(6400)
        hits[at.astype(int)] = height
        x = rng.standard_normal(6400) + np.convolve(hits, ring)[:6400]
        point = monitor.add(8.0 * 3600.0 * number, x, rate, hertz)
    assert point.level == level
    assert monitor.report().place == ('outer' if height else '')


def test_change_point_is_that_of_the_definition():
    rng = np.random.default_rng(5)
    levels = rng.standard_normal(500)
    levels[400:] += 6.0
    total, expected = 0.0, 0
    for index, level in enumerate(levels):
        total = max(total + level - 1.5, 0.0)
        if total == 0.0:
            expected = index + 1
    assert rise_begins(levels, 0.0, 1.5) == expected
    assert expected == pytest.approx(400, abs=1)


@pytest.mark.parametrize('share', [0.0, 0.1, 0.25])
def test_shocks_before_a_change_are_not_its_beginning(share):
    """The machine is 12 dB louder from snapshot 120 on; shocks of four times that at random."""
    rng, monitor = np.random.default_rng(2), SeriesMonitor(None)
    for number in range(150):
        x = (4.0 if number >= 120 else 1.0) * rng.standard_normal(COUNT)
        if rng.random() < share:
            x[600:660] += 60.0 * rng.standard_normal(60)
        monitor.add(600.0 * number, x, RATE, SHAFT_HZ)
    report = monitor.report()
    assert report.first_alarm >= 120 * 600.0
    assert report.change == pytest.approx(120 * 600.0, abs=3 * 600.0)


@pytest.mark.parametrize(
    ('level', 'kelvin', 'why'),
    [
        (lambda n: 0.05 * n, 0.0, 'the level moves by 3.0 dB. Until'),
        (lambda n: 0.0, 0.2, 'the temperature moves by 12.0 K. Until'),
        (lambda n: (0.0, 5.0, -5.0)[n % 3], 0.0, 'the level scatters by 7.4 dB. Until'),
        (lambda n: 8.0 * (n > 30), 0.0, 'the level has settled 8.'),
    ],
)
def test_a_machine_without_a_baseline_says_what_has_not_settled(level, kelvin, why):
    rng, monitor = np.random.default_rng(0), SeriesMonitor(None)
    for number in range(100):
        x = 10.0 ** (level(number) / 20.0) * (-1.0) ** np.arange(COUNT)
        x += 1e-3 * rng.standard_normal(COUNT)
        heat = 50.0 + kelvin * number
        point = monitor.add(600.0 * number, x, RATE, SHAFT_HZ, temperature=heat)
    assert point.level == 'none'
    assert monitor.report().reasons[0].startswith(f'no baseline: in 60 snapshots {why}')
    # The worn end is an alarm all the same.
    for number in range(100, 116):
        monitor.add(600.0 * number, 20.0 * rng.standard_normal(COUNT), RATE, SHAFT_HZ)
    assert monitor.report().level == 'fault'


def rig(rng, gain=1.0, struck=0.0, blow=0.0):
    """Return a second of shaft, gear and noise, impacts at 4 kHz and a blow at 20 Hz, m/s^2."""
    t = np.arange(round(RATE)) / RATE
    x = rng.standard_normal(len(t)) + 0.5 * np.sin(2 * np.pi * SHAFT_HZ * t)
    x += np.sin(2 * np.pi * 31 * SHAFT_HZ * t + rng.uniform(0, 6))
    hits = np.zeros(len(t))
    hits[:: round(RATE / 97)] = struck
    x += np.convolve(hits, np.exp(-t[:200] * 1500) * np.sin(8000 * np.pi * t[:200]))[: len(t)]
    return gain * x + blow * np.sin(40 * np.pi * t)


@pytest.mark.parametrize(
    ('later', 'level', 'said'),
    [
        ({'gain': 10.0}, 'fault', 'all measures rose alike: was the gain or the sensor changed?'),
        ({'struck': 60.0}, 'fault', ''),
        ({'blow': 9.0}, 'fault', 'zone D of ISO 20816-3'),
    ],
)
def test_reasons_tell_a_gain_a_fault_and_a_zone_apart(rng, later, level, said):
    settings = DiagnosisSettings(baseline_windows=20, power_group=2, mounting='rigid')
    monitor = SeriesMonitor(None, settings)
    for number in range(45):
        kwargs = later if number >= 30 or (number == 25 and 'blow' in later) else {}
        x = rig(rng, **kwargs)
        monitor.add(600.0 * number, x, RATE, SHAFT_HZ, unit='m/s^2')
        if number == 25 and kwargs:
            alone = 'zone D of ISO 20816-3 in the last snapshot'
            assert monitor.report().level == 'ok' and alone in monitor.report().reasons
    report = monitor.report()
    hints = ('all measures rose alike: was the gain or the sensor changed?',)
    assert report.level == level and (not said or said in report.reasons)
    assert (hints[0] in report.reasons) == (said in hints)
    # After the end of the alarm the report speaks of it as past.
    for number in range(45, 70):
        monitor.add(600.0 * number, rig(rng), RATE, SHAFT_HZ, unit='m/s^2')
    report = monitor.report()
    assert report.level == 'ok' and not set(report.reasons) & {said, *hints}
    ended = [text for text in report.reasons if 'began to rise' in text]
    assert all(text.startswith('the last alarm has ended; its level') for text in ended)
    for number in range(70, 76):
        monitor.add(600.0 * number, np.zeros(COUNT), RATE, SHAFT_HZ, unit='m/s^2')
    assert 'the last 6 snapshots were not judged: what follows is older' in (
        monitor.report().reasons
    )


def test_a_limit_above_that_of_all_machines_is_told_with_its_reason():
    """Twice the acceleration is 6 dB, but here it is less than six standard deviations."""
    rng, monitor = np.random.default_rng(4), SeriesMonitor(None)
    for number in range(90):
        height = 10.0 ** ((1.3 * rng.standard_normal() + 8.0 * (number >= 82)) / 20.0)
        point = monitor.add(600.0 * number, height * rng.standard_normal(COUNT), RATE, SHAFT_HZ)
    (text,) = [each for each in monitor.report().reasons if 'over the baseline' in each]
    told = re.fullmatch(r'.*: (.*) dB over .* by (.*) dB: suspect from (.*) dB', text)
    over, scatter, limit = map(float, told.groups())
    assert point.level == 'ok' and 6.0 < over < limit
    assert limit == pytest.approx(6.0 * scatter, abs=0.35)


def test_trend_is_the_median_of_the_slopes_between_all_points():
    rng = np.random.default_rng(3)
    times = np.sort(rng.choice(1000, 299)).astype(float)
    levels = 0.01 * times + rng.standard_normal(299)
    assert slope(times, levels) == theilslopes(levels, times)[0]


def test_a_long_series_is_kept_more_coarsely(monkeypatch):
    monkeypatch.setattr('bearing_twin.diagnosis.series.monitor.MOST', 200)
    monitor, _ = life(1, 600, lambda n: 12.0 * (n >= 500))
    report = monitor.report()
    assert len(report.points) < 200
    assert report.change == pytest.approx(500 * CYCLE, abs=20 * CYCLE)
    assert report.level in ('suspect', 'fault')


@pytest.mark.parametrize(
    ('rise', 'over', 'level', 'why'),
    [
        (24.0, 120, 'fault', 'no baseline: a machine at fault is not learnt'),
        (9.0, 60, 'none', 'no baseline: in 20 snapshots the level has settled 8.'),
    ],
)
def test_a_machine_that_gets_loud_while_it_is_learnt_is_not_its_own_baseline(
    rise, over, level, why
):
    rng = np.random.default_rng(3)
    monitor = SeriesMonitor(None, DiagnosisSettings(baseline_windows=20))
    for number in range(over + 60):
        height = 10.0 ** (rise * min(number / over, 1.0) / 20.0)
        monitor.add(600.0 * number, height * rng.standard_normal(COUNT), RATE, SHAFT_HZ)
    report = monitor.report()
    assert (report.level, report.baseline) == (level, None)
    assert report.reasons[0].startswith(why)


def test_a_machine_that_stands_still_teaches_nothing():
    rng = np.random.default_rng(4)
    monitor = SeriesMonitor(None, DiagnosisSettings(baseline_windows=20))
    for number in range(60):
        height, hertz = (1e-3, 0.0) if number < 30 else (1.0, SHAFT_HZ)
        monitor.add(number, height * rng.standard_normal(COUNT), RATE, hertz)
    assert monitor.report().level == 'ok'
    assert '30 snapshots not judged: the machine stands still' in monitor.report().reasons


def test_each_of_two_speeds_is_learnt_by_itself():
    """25 and 35 Hz in turn, 5 dB apart; then 10 dB more at both."""
    rng, monitor = np.random.default_rng(0), SeriesMonitor(None)
    for number in range(360):
        height = 5.0 * (number % 2) + 10.0 * (number >= 300)
        x = 10.0 ** (height / 20.0) * rng.standard_normal(COUNT)
        monitor.add(600.0 * number, x, RATE, 35.0 if number % 2 else 25.0)
        assert number != 299 or monitor.report().level == 'ok'
    assert monitor.report().level == 'suspect'


@pytest.mark.parametrize('worn', [False, True])
def test_a_machine_whose_speed_varies_is_learnt_at_all_of_its_speeds(worn):
    """25 Hz +- 20 %, 6 dB an octave: no class of speeds has 60 snapshots."""
    rng, monitor = np.random.default_rng(2), SeriesMonitor(None)
    levels = []
    for number in range(240):
        octaves = math.log2(rng.uniform(0.8, 1.2))
        height = 6.0 * octaves + 9.0 * (worn and number >= 180)
        x = 10.0 ** (height / 20.0) * rng.standard_normal(COUNT)
        levels.append(monitor.add(600.0 * number, x, RATE, 25.0 * 2.0**octaves).level)
    assert levels[:180] == ['none'] * levels.index('ok') + ['ok'] * (180 - levels.index('ok'))
    assert levels.index('ok') < 150
    assert levels[-1] == ('suspect' if worn else 'ok')


def impacts(rng, bearing, place, height, shaft_hz=30.0, seconds=1.0):
    """Return a second of noise with impacts of one place, 1 % of slip, through one resonance."""
    count = round(seconds * RATE)
    gap = RATE / (shaft_hz * fault_orders(bearing).impacts(place))
    at = np.cumsum(gap * (1.0 + 0.01 * rng.standard_normal(round(count / gap)))).astype(int)
    train = np.zeros(count)
    train[at[at < count]] = 1.0
    if place != 'outer':
        train *= 1.0 + 0.9 * np.cos(2.0 * np.pi * shaft_hz * np.arange(count) / RATE)
    t = np.arange(400) / RATE
    ring = np.convolve(train, np.exp(-2500.0 * t) * np.sin(2.0 * np.pi * 4000.0 * t))[:count]
    return rng.standard_normal(count) + height * ring


@pytest.mark.parametrize('place', ['outer', 'inner'])
def test_a_machine_that_is_damaged_from_the_first_snapshot_on_is_not_ok(place):
    rng, bearing = np.random.default_rng(3), find_bearing('6205')
    monitor = SeriesMonitor(bearing)
    points = [
        monitor.add(600.0 * n, impacts(rng, bearing, place, 6.0), RATE, 30.0) for n in range(70)
    ]
    report = monitor.report()
    assert [point.level for point in points] == ['none'] * 4 + ['fault'] * 66
    assert (report.level, report.place) == ('fault', place)
    # Its level never rose, and it is nobody's baseline.
    assert report.baseline is None and np.isnan(report.change)
    assert report.first_fault == report.alarm == 4 * 600.0
    assert f'9 of the last 9 snapshots alone say {place}, fault' in report.reasons


def test_what_no_snapshot_tells_from_a_coupling_is_no_place_of_the_series_either():
    """Nor does the averaged envelope of all snapshots since the alarm name a place."""
    rng, bearing = np.random.default_rng(9), find_bearing('6203')
    monitor = SeriesMonitor(bearing)
    alone = diagnose_record(coupling_snapshot(rng), RATE, bearing, GIVEN_HZ)
    assert (alone.level, alone.rule) == ('fault', 'whole_turns')
    for n in range(30):
        monitor.add(600.0 * n, coupling_snapshot(rng), RATE, GIVEN_HZ, answer=alone)
    report = monitor.report()
    assert (report.level, report.place) == ('fault', ''), report.reasons
    assert 'place unknown: no comb stands out of the averaged envelope' in report.reasons
    assert report.doubt == 'whole_turns'


def test_damage_that_does_not_double_the_level_is_named():
    rng, bearing = np.random.default_rng(4), find_bearing('6205')
    monitor = SeriesMonitor(bearing, DiagnosisSettings(baseline_windows=20))
    for n in range(60):
        point = monitor.add(600.0 * n, impacts(rng, bearing, 'outer', 4.0 * (n >= 40)), RATE, 30.0)
        assert point.level == ('none' if n < 19 else 'ok' if n < 44 else 'fault')
    report = monitor.report()
    assert point.over_baseline < 6.0 and report.place == 'outer'
    # The answers alone speak: there is no rise whose beginning could be told.
    assert report.alarm == 44 * 600.0 and np.isnan(report.change)


@pytest.mark.parametrize(
    ('place', 'peak', 'rate', 'shaft_hz', 'seconds', 'low'),
    [('cage', 15.0, 12800.0, 5.0, 2.0, 1000), ('ball', 8.0, 25600.0, 35.0, 0.3, 1000),
     ('cage', 15.0, 6400.0, 5.0, 2.0, 800)],
)  # fmt: skip
def test_rare_impacts_that_hardly_raise_the_level_are_an_alarm(
    place, peak, rate, shaft_hz, seconds, low
):
    """Few impacts a snapshot, at the end of ``peak`` times the RMS; spikes in one of four."""
    rng, monitor = np.random.default_rng(11), SeriesMonitor(None)
    order = fault_orders(find_bearing('6205')).impacts('cage')
    t = np.arange(round(0.004 * rate)) / rate
    ring = np.exp(-600.0 * t) * np.sin(2.0 * np.pi * min(3000.0, 0.3 * rate) * t)
    levels = []
    for number in range(160):
        x = rng.standard_normal(round(rate * seconds))
        # A ball is hit in the load zone only: here three times a turn of the cage.
        turns = np.arange(rng.random(), order * shaft_hz * seconds)
        strikes = turns if place == 'cage' else np.add.outer(turns, (0.0, 0.09, 0.18)).ravel()
        for start in (strikes / (order * shaft_hz) * rate).astype(int):
            part = x[start : start + len(ring)]
            part += peak * max(number - 100, 0) / 60.0 * ring[: len(part)]
        if rng.random() < 0.25:
            x[rng.integers(0, len(x), 3)] += 60.0
        levels.append(monitor.add(600.0 * number, x, rate, shaft_hz).level)
    report = monitor.report()
    assert set(levels[:100]) == {'none', 'ok'}
    assert report.level in ('suspect', 'fault')
    rms = np.array([point.rms for point in report.points])
    assert 20.0 * np.log10(np.median(rms[-5:]) / np.median(rms[:60])) < 4.0
    said = f'impacts in most turns of the cage, from {low} Hz on: +'
    assert any(why.startswith(said) for why in report.reasons)
    assert 100 * 600.0 <= report.change <= report.first_alarm


def test_each_snapshot_at_another_speed_is_judged_alone():
    rng, bearing = np.random.default_rng(5), find_bearing('6205')
    monitor = SeriesMonitor(bearing, DiagnosisSettings(baseline_windows=20))
    for n in range(30):
        hertz = rng.uniform(20.0, 40.0)
        monitor.add(600.0 * n, impacts(rng, bearing, 'outer', 6.0, hertz), RATE, hertz)
    report = monitor.report()
    assert (report.level, report.place, report.baseline) == ('fault', 'outer', None)
    assert 'no baseline: a machine at fault is not learnt' in report.reasons


def test_answers_of_short_snapshots_say_that_they_are_none():
    assert not any('alone' in reason for reason in begun(0).monitor.report().reasons)
    rng = np.random.default_rng(6)
    monitor = SeriesMonitor(find_bearing('6205'), DiagnosisSettings(baseline_windows=20))
    for n in range(30):
        point = monitor.add(600.0 * n, rng.standard_normal(COUNT), RATE, SHAFT_HZ)
    assert point.level == 'ok'
    assert any('snapshots alone say nothing' in reason for reason in monitor.report().reasons)


def test_a_second_alarm_has_its_own_onset_and_the_repaired_machine_its_own_baseline():
    """Worn from 100 to 160, repaired, worn again from 300 on."""
    rng = np.random.default_rng(7)
    monitor = SeriesMonitor(None)
    for n in range(340):
        worn = 100 <= n < 160 or n >= 300
        level = 15.0 * worn * min(1.0, (n - (300 if n >= 300 else 100)) / 20.0)
        level -= 3.0 * (n >= 160)
        x = 10.0 ** ((level + 0.3 * rng.standard_normal()) / 20.0) * rng.standard_normal(COUNT)
        monitor.add(600.0 * n, x, RATE, SHAFT_HZ)
    report = monitor.report()
    assert report.baseline[0] >= 160 * 600.0
    assert report.first_alarm < 160 * 600.0
    assert report.alarm > 300 * 600.0
    assert 290 * 600.0 <= report.change <= report.alarm


@pytest.mark.parametrize('back, level', [(16.0, 'suspect'), (24.0, 'fault')])
def test_a_machine_that_is_as_loud_as_when_it_was_settled_before_is_no_fault(back, level):
    """A hundred snapshots each at a load, at 8 and 16 dB less, then the load again, or more."""
    rng = np.random.default_rng(8)
    monitor = SeriesMonitor(None)
    for n in range(340):
        height = (16.0, 8.0, 0.0, back)[min(n // 100, 3)]
        x = 10.0 ** ((height + 0.3 * rng.standard_normal()) / 20.0) * rng.standard_normal(COUNT)
        point = monitor.add(600.0 * n, x, RATE, SHAFT_HZ)
        assert n >= 300 or point.level in ('none', 'ok')
    assert point.level == level
    assert any('settled too' in text for text in monitor.report().reasons) == (level == 'suspect')
    values, arrays = monitor.save()
    again = SeriesMonitor(None)
    again.load(json.loads(json.dumps(values)), arrays)
    assert again.report().reasons == monitor.report().reasons


def test_a_level_that_rises_beside_a_doubt_is_not_learnt_and_has_its_place(monkeypatch):
    """Each snapshot alone is suspect; from 40 on the machine is 9 dB louder and strikes."""
    monkeypatch.setattr(series, 'answer_alone', lambda _: doubt)
    doubt = replace(
        diagnose_record(np.random.default_rng(0).standard_normal(2560), RATE,
                        find_bearing('6205'), 30.0),
        level='suspect',
    )  # fmt: skip
    rng, bearing = np.random.default_rng(9), find_bearing('6205')
    monitor = SeriesMonitor(bearing, DiagnosisSettings(baseline_windows=20))
    for n in range(100):
        x = impacts(rng, bearing, 'outer', 3.0 * (n >= 40), seconds=0.5)
        point = monitor.add(600.0 * n, x * (2.8 if n >= 40 else 1.0), RATE, 30.0)
    report = monitor.report()
    assert point.level == 'suspect' and report.place == 'outer'
    assert report.baseline[1] < 40 * 600.0 <= report.change


def test_a_fault_that_is_held_keeps_its_place(rng):
    """An outer race strikes in five snapshots; the level is held until nine say less."""
    bearing = find_bearing('6205')
    monitor, said = SeriesMonitor(bearing), []
    for n in range(19):
        x = impacts(rng, bearing, 'outer', 6.0 * (n < 5))
        monitor.add(600.0 * n, x, RATE, 30.0)
        said.append(monitor.report())
    assert [report.level for report in said] == ['none'] * 4 + ['fault'] * 13 + ['none'] * 2
    assert [said[n].place for n in (4, 8, 12, 18)] == ['outer'] * 3 + ['']
    assert said[12].result == 'outer'
    assert 'fault held: earlier snapshots say outer' in said[12].reasons
