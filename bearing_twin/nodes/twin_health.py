# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the twin says of its inputs and of its deadlines on /diagnostics."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.nodes.health import Level, Status
from bearing_twin.thermal.gate import TABLE_HIGH, TABLE_LOW, TemperatureStatus

if TYPE_CHECKING:
    from bearing_twin.nodes.pacer import LatenessReport
    from bearing_twin.thermal.gate import GatedTemperature

__all__ = ['realtime_status', 'temperature_status']

TEXTS = {
    TemperatureStatus.OK: 'temperature is fresh',
    TemperatureStatus.WAITING: 'no temperature yet: the start temperature is used',
    TemperatureStatus.STALE: 'temperature is stale: the last valid one is held',
    TemperatureStatus.INVALID: 'temperature is NaN or infinite: the last valid one is held',
    TemperatureStatus.CLAMPED: (
        f'temperature is outside {TABLE_LOW:g}..{TABLE_HIGH:g} degC: the nearest end is used'
    ),
    TemperatureStatus.BACKWARDS: 'stamps run backwards: the last valid temperature is held',
}


def temperature_status(temperature: GatedTemperature, shaft_problem: str) -> Status:
    """Status of the inputs: temperature and, where a joint is named, shaft speed."""
    ok = temperature.status is TemperatureStatus.OK and not shaft_problem
    message = TEXTS[temperature.status]
    if shaft_problem:
        message = f'{message}; {shaft_problem}'
    return Status(
        Level.OK if ok else Level.WARN,
        message,
        {
            'temperature used [degC]': temperature.used,
            'temperature measured [degC]': temperature.measured,
            'age of the last valid one [s]': temperature.age,
            'status': temperature.status.name,
        },
    )


def realtime_status(
    report: LatenessReport, period: float, execution_time: float, *, active: bool
) -> Status:
    """Status of the deadlines: lateness over the last minute, late and dropped blocks."""
    if not active:
        level, message = Level.OK, 'not active'
    elif report.dropped:
        level, message = Level.ERROR, f'{report.dropped} blocks dropped: the machine is too slow'
    elif report.p99 > period:
        level, message = Level.WARN, 'blocks are late by more than one block'
    else:
        level, message = Level.OK, 'in time'
    return Status(
        level,
        message,
        {
            'blocks published': report.published,
            'blocks late': report.late,
            'blocks dropped': report.dropped,
            'clock steps': report.clock_steps,
            'lateness p50 [ms]': report.p50 * 1e3,
            'lateness p99 [ms]': report.p99 * 1e3,
            'lateness max [ms]': report.worst * 1e3,
            'execution time [ms]': execution_time * 1e3,
            'load [%]': 100.0 * execution_time / period,
        },
    )
