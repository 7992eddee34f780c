# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Whatever arrives, the temperature given out is finite and inside the tables."""

import math

from bearing_twin.thermal.gate import TABLE_HIGH, TABLE_LOW, TemperatureGate, TemperatureStatus
from hypothesis import given
from hypothesis import strategies as st
import pytest

SECOND = 1_000_000_000


def test_waits_with_the_start_temperature():
    got = TemperatureGate(start=35.0).at(1000.0)
    assert got.status is TemperatureStatus.WAITING
    assert got.used == 35.0
    assert math.isnan(got.measured)
    assert math.isnan(got.age)


def test_stale_holds_the_last_value_and_recovers():
    gate = TemperatureGate(timeout=5.0)
    gate.offer(60.0, stamp=SECOND, now=100.0)
    assert gate.at(104.9).status is TemperatureStatus.OK
    late = gate.at(105.1)
    assert late.status is TemperatureStatus.STALE
    assert late.used == 60.0
    assert late.age == pytest.approx(5.1)
    gate.offer(61.0, stamp=2 * SECOND, now=106.0)
    assert gate.at(106.0).status is TemperatureStatus.OK


@pytest.mark.parametrize('bad', [math.nan, math.inf, -math.inf, -273.2, 1000.1])
def test_invalid_value_is_rejected_and_shown(bad):
    gate = TemperatureGate()
    gate.offer(60.0, stamp=SECOND, now=1.0)
    assert gate.offer(bad, stamp=2 * SECOND, now=2.0) is TemperatureStatus.INVALID
    got = gate.at(2.0)
    assert got.used == 60.0
    assert got.status is TemperatureStatus.INVALID
    assert got.age == 1.0


@pytest.mark.parametrize(('value', 'used'), [(-40.0, TABLE_LOW), (400.0, TABLE_HIGH)])
def test_outside_the_tables_is_clamped_and_flagged(value, used):
    gate = TemperatureGate()
    assert gate.offer(value, stamp=SECOND, now=1.0) is TemperatureStatus.CLAMPED
    assert gate.at(1.0).used == used
    assert gate.at(1.0).measured == value


@pytest.mark.parametrize(('value', 'stamp'), [(math.nan, 0), (400.0, 0), (90.0, SECOND)])
def test_stale_wins_over_what_the_latest_reading_was(value, stamp):
    gate = TemperatureGate(timeout=5.0)
    gate.offer(60.0, stamp=SECOND, now=100.0)
    gate.offer(value, stamp=stamp, now=100.1)
    assert gate.at(100.2).status is not TemperatureStatus.STALE
    assert gate.at(106.0).status is TemperatureStatus.STALE


def test_backward_stamp_is_rejected():
    gate = TemperatureGate()
    gate.offer(60.0, stamp=10 * SECOND, now=1.0)
    assert gate.offer(90.0, stamp=9 * SECOND, now=1.1) is TemperatureStatus.BACKWARDS
    assert gate.at(1.1).used == 60.0


def test_repeated_stamp_is_not_progress():
    gate = TemperatureGate()
    gate.offer(60.0, stamp=10 * SECOND, now=1.0)
    said = {gate.offer(90.0, stamp=10 * SECOND, now=1.0 + k) for k in range(10)}
    assert said == {TemperatureStatus.BACKWARDS}
    assert gate.at(10.0).used == 60.0


def test_restarted_source_is_believed_after_three_rising_stamps():
    gate = TemperatureGate()
    gate.offer(60.0, stamp=1000 * SECOND, now=1.0)
    seen = [gate.offer(30.0 + k, stamp=(1 + k) * SECOND, now=2.0 + k) for k in range(4)]
    assert seen == [
        TemperatureStatus.BACKWARDS,
        TemperatureStatus.BACKWARDS,
        TemperatureStatus.OK,
        TemperatureStatus.OK,
    ]
    assert gate.at(5.0).used == 33.0


def test_source_without_stamps_is_taken_in_order_of_arrival():
    gate = TemperatureGate()
    for k in range(3):
        assert gate.offer(50.0 - k, stamp=0, now=float(k)) is TemperatureStatus.OK
    assert gate.at(2.0).used == 48.0


@given(
    st.lists(
        st.tuples(
            st.floats(allow_nan=True, allow_infinity=True),
            st.integers(min_value=-(2**63), max_value=2**63),
            st.floats(min_value=0, max_value=1e9),
        )
    ),
    st.floats(min_value=0, max_value=1e9),
)
def test_any_input_gives_a_usable_temperature(readings, now):
    gate = TemperatureGate()
    for value, stamp, arrived in readings:
        gate.offer(value, stamp=stamp, now=arrived)
        got = gate.at(now)
        assert TABLE_LOW <= got.used <= TABLE_HIGH
        assert math.isnan(got.age) or got.age >= 0.0


def test_what_was_taken_is_the_last_valid_value_outside_the_tables_too() -> None:
    gate = TemperatureGate()
    assert math.isnan(gate.at(0.0).taken)
    for value, taken in ((-5.0, -5.0), (math.nan, -5.0), (150.0, 150.0), (1e308, 150.0)):
        gate.offer(value, stamp=0, now=0.0)
        assert gate.at(0.0).taken == taken
