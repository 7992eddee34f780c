# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the twin does not explain: changes that no fault family has, and healthy data below."""

import math
import time
import zlib

from bearing_twin.calibration import residual as residual_module
from bearing_twin.calibration.residual import (
    DAY,
    LEAST,
    Residual,
    Residuals,
    spectral_levels,
    SPEEDS,
)
from bearing_twin.errors import BearingTwinError
from bearing_twin.packed import pack
from bearing_twin.studies.disturbances import with_memory
from bearing_twin.studies.residual import decisions_until, false_alarms, HEALTHY
from cases import in_proofs
import numpy as np
import pytest

SHOWS = {
    'imbalance': {'order 1', '25 Hz', 'line near 25 Hz'},
    'looseness': {
        'order 0.5', 'order 1.5', 'line near 13 Hz', 'line near 32 Hz', 'line near 40 Hz',
        'line near 63 Hz', 'line near 64 Hz', 'line near 80 Hz', 'line near 101 Hz',
    },
    'another machine': {'line near 80 Hz', 'line near 254 Hz', '80 Hz', '254 Hz'},
}  # fmt: skip


@pytest.mark.parametrize(
    ('change', 'day'),
    [
        ('imbalance', 200), ('another machine', 200),
        *in_proofs(*((change, DAY) for change in SHOWS)),
    ],
)  # fmt: skip
def test_a_change_is_seen_where_it_is(monkeypatch, change, day):
    monkeypatch.setattr('bearing_twin.studies.residual.DAY', day)
    monkeypatch.setattr('bearing_twin.studies.residual.TRIALS', 4)
    size = 6.0 if change == 'imbalance' else -6.0
    found = decisions_until(change, size, 200)
    assert max(decisions for decisions, _ in found) <= 10
    assert {where for _, where in found} <= SHOWS[change]


@pytest.mark.parametrize('day', [200, *in_proofs(DAY)])
def test_a_sensor_that_drifts_is_seen_and_health_is_not(monkeypatch, day):
    monkeypatch.setattr('bearing_twin.studies.residual.DAY', day)
    monkeypatch.setattr('bearing_twin.studies.residual.TRIALS', 4)
    assert {decisions for decisions, _ in decisions_until('', 0.0, 200)} == {math.inf}
    # 0.2 dB a decision; the level of the machine itself scatters by 0.3 dB.
    drifts = [n for n, _ in decisions_until('', 0.0, 200, drift=-0.2)]
    assert min(drifts) >= 5 and max(drifts) <= 40


@pytest.mark.parametrize('kind', HEALTHY)
@pytest.mark.parametrize('learnt', [30, 200])
def test_healthy_decisions_that_were_not_learnt_from_stay_below(kind, learnt):
    """One false alarm in 525 600 decisions: none in 2000, by far, but for one machine in 20."""
    numbers = false_alarms(kind, learnt, 2, seed=7)
    assert 0.0 < np.nanmax(numbers) < 1.0


def test_a_long_tail_needs_three_decisions():
    """The first decisions of a run were an alarm each where a tail was long."""
    residual, names = Residual(), ('10 Hz',)
    rng = np.random.default_rng(1)
    for _ in range(200):
        residual.learn(names, rng.standard_normal(1))
    early = [residual.judge(names, np.array([60.0])) for _ in range(3)]
    assert [found.reason for found in early[:2]] == [
        '1 decisions of 3 that an alarm needs', '2 decisions of 3 that an alarm needs',
    ]  # fmt: skip
    assert early[2].alarm


def test_what_sways_slowly_still_shows_a_step():
    rng = np.random.default_rng(3)
    drawn = rng.standard_normal((1640, 2))
    drawn[:, 0] += 2.0 * np.sin(2.0 * np.pi * np.arange(1640) / 1440.0)
    residual, names = Residual(), ('10 Hz', '20 Hz')
    for row in drawn[:1440]:
        residual.learn(names, row)
    assert np.nanmax([residual.judge(names, row).number for row in drawn[1440:1540]]) < 1.0
    found = [residual.judge(names, row + np.array([8.0, 0.0])) for row in drawn[1540:1560]]
    said = next(each.reason for each in found if each.alarm)
    assert said.startswith('10 Hz has risen by ') and said.endswith(' dB within the hour')


def test_a_band_that_remembers_longer_than_the_others_has_a_limit_of_its_own():
    """Few do on a real machine, as the level of a flow; with one memory for all, alarms came."""
    rng = np.random.default_rng(4)
    drawn = rng.standard_normal((3000, 64))
    drawn[:, :8] = 2.0 * with_memory(drawn[:, :8], 60.0)
    residual, names = Residual(), tuple(map(str, range(64)))
    for row in drawn[1000:1512]:
        residual.learn(names, row)
    assert sum(residual.judge(names, row).alarm for row in drawn[1512:]) == 0


def test_a_machine_is_known_at_the_speeds_at_which_it_was_healthy():
    """Unbalance of a drive with a converter, through third octaves that do not turn with it."""
    rng = np.random.default_rng(5)

    def levels(hz):
        t = np.arange(25600) / 12800.0
        return spectral_levels(
            rng.standard_normal(25600) + np.sin(2 * np.pi * hz * t), 12800.0, hz
        )

    residuals = Residuals()
    for _ in range(45):
        found = residuals.update(*levels(25.0 + 0.2 * rng.uniform(-1, 1)), 25.0, healthy=True)
    assert found.number < 1.0
    for _ in range(LEAST + 10):
        found = residuals.update(*levels(30.0), 30.0, healthy=True)
        assert math.isnan(found.number)
    assert found.reason.endswith('limit needs at 30 Hz; known at 25 Hz')
    for _ in range(8):
        found = residuals.update(*levels(30.0), 30.0, healthy=True)
        assert found.number < 1.0
        there = residuals.update(*levels(25.0), 25.0, healthy=True)
    assert there.number < 1.0
    values, arrays = residuals.save()
    again = Residuals.of(values, arrays).save()
    assert again[0] == values and all(map(np.array_equal, again[1].values(), arrays.values()))
    for broken in (None, [{}], [{'shaft_hz': 0.0}], {'shaft_hz': 1.0}, [{'shaft_hz': 25.0}]):
        with pytest.raises(BearingTwinError, match='use what save'):
            Residuals.of(broken, arrays)
    with pytest.raises(BearingTwinError, match='use what save'):
        Residuals.of([{**each, 'shaft_hz': 0.0} for each in values], arrays)
    # A speed that was only passed by is given up for a new one.
    for hz in range(40, 200, 4):
        residuals.update(*levels(0.5 * hz), float(hz), healthy=True)
    speeds = [round(hz) for hz, _ in residuals.known]
    assert {25, 30, 196} <= set(speeds) and 40 not in speeds and len(speeds) == 32


def test_a_speed_at_which_nothing_was_learnt_yet_is_kept_too():
    residuals, names = Residuals(), ('10 Hz', 'order 1')
    residuals.update(names, np.zeros(2), 25.0, healthy=False)
    again = Residuals.of(*residuals.save())
    assert [(hz, each.rows) for hz, each in again.known] == [(25.0, [])]
    assert again.update(names, np.zeros(2), 25.0, healthy=True).reason.startswith('0 healthy')


def test_what_was_decided_at_a_speed_long_ago_is_not_judged_with_today():
    rng = np.random.default_rng(6)
    residuals, names = Residuals(), ('10 Hz', 'order 1')

    def decide(count, hz, height=0.0):
        for _ in range(count):
            found = residuals.update(names, height + rng.standard_normal(2), hz, healthy=True)
        return found

    decide(60, 25.0)
    decide(60, 28.0)
    assert decide(5, 25.0, 30.0).alarm
    # Repaired, and run at another speed for less than half an hour, then for more.
    decide(20, 28.0)
    assert decide(1, 25.0, 30.0).alarm
    decide(40, 28.0)
    assert decide(1, 25.0, 30.0).reason.startswith('1 decisions of 3')


def test_a_machine_at_many_speeds_is_learnt_at_each():
    rng = np.random.default_rng(7)
    residuals = Residuals()
    for number in range(18 * 50):
        hz = 15.0 * 1.05 ** (number % 18)
        found = residuals.update(('10 Hz',), rng.standard_normal(1), hz, healthy=True)
    assert found.number < 1.0


def test_levels_are_those_of_the_signal():
    t = np.arange(51200) / 25600.0
    rng = np.random.default_rng(0)
    x = 3.0 * np.sin(2 * np.pi * 100.0 * t) + rng.standard_normal(len(t))
    names, levels = spectral_levels(x, 25600.0, 25.0)
    said = dict(zip(names, levels, strict=True))
    # A sine of amplitude 3 has the power 4.5; a line of a Hann window holds two thirds of it.
    assert said['101 Hz'] == pytest.approx(10 * math.log10(4.5), abs=0.1)
    assert said['order 4'] == pytest.approx(10 * math.log10(4.5 * 2 / 3), abs=0.1)
    # White noise of power 1 up to 12.8 kHz.
    band = 1024.0 * 10.0 * (2 ** (1 / 6) - 2 ** (-1 / 6)) / 10.0
    assert said['1016 Hz'] == pytest.approx(10 * math.log10(band / 12800.0), abs=0.8)
    assert said['line near 101 Hz'] > 25.0
    assert np.isnan(spectral_levels(x, 25600.0, math.nan)[1][-8:]).all()


def test_nothing_is_said_before_the_limit_is_known_and_what_was_learnt_is_kept():
    names = ('10 Hz', 'order 1')
    rng = np.random.default_rng(1)
    residual = Residual()
    for _ in range(LEAST - 1):
        residual.learn(names, rng.standard_normal(2))
    early = residual.judge(names, np.full(2, 50.0))
    assert math.isnan(early.number) and not early.alarm
    assert early.reason == f'{LEAST - 1} healthy decisions of {LEAST} that a limit needs'
    residual.learn(names, rng.standard_normal(2))
    for _ in range(2):
        found = residual.judge(names, np.array([3.0, math.nan]))
    assert found.where == '10 Hz'
    again = Residual.of(*residual.save())
    assert again.save()[0] == residual.save()[0]
    assert np.array_equal(again.save()[1], residual.save()[1], equal_nan=True)
    assert again.judge(names, np.array([9.0, 1.0])).number == pytest.approx(
        residual.judge(names, np.array([9.0, 1.0])).number
    )
    # Another sample rate has other bands: what was learnt is of no use.
    assert math.isnan(again.judge(('20 Hz',), np.zeros(1)).number)
    values, decisions = residual.save()
    for broken in (
        ({}, decisions), (values, None), (values, decisions[:, :1]), (values, decisions[0]),
        (values | {'rows': -1}, decisions), (values | {'rows': 'many'}, decisions),
        (values | {'recent': len(decisions)}, decisions),
    ):  # fmt: skip
        with pytest.raises(BearingTwinError, match='use what save'):
            Residual.of(*broken)
    with pytest.raises(BearingTwinError, match='2 s of finite samples'):
        spectral_levels(np.ones(100), 25600.0, 25.0)


def test_a_state_of_all_speeds_is_a_few_megabytes_and_packed_at_once():
    rng = np.random.default_rng(3)
    names = tuple(f'band {n}' for n in range(86))
    day = list(rng.standard_normal((DAY, 86)).astype(np.float32))
    known = [(10.0 * 1.04**k, Residual(names, list(day))) for k in range(SPEEDS)]
    values, arrays = Residuals(known).save()
    start = time.process_time()
    packed = pack(1, {'residuals': values}, arrays)
    took = time.process_time() - start
    assert len(packed) < 17e6
    # Up to 0.1 of what the quickest compression takes.
    start = time.process_time()
    zlib.compress(packed, 1)
    assert took < 0.5 * (time.process_time() - start)


def test_a_machine_whose_bands_swell_together_is_given_the_memory_of_all():
    """A band alone is too few to show for how long its scatter stays larger."""
    rng = np.random.default_rng(4)
    swelling = np.exp(0.5 * with_memory(rng.standard_normal((200, 1)), 10.0))
    rows = swelling * rng.standard_normal((200, 64))
    sizes = np.abs(rows - np.median(rows, axis=0))
    assert np.median(residual_module._memory(sizes)) < 5.0
    assert residual_module._limits(rows, 0.0).apart.min() > 10
