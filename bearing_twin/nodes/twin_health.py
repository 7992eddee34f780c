# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the twin says of its inputs on /diagnostics."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.nodes.health import Level, Status
from bearing_twin.thermal.gate import TABLE_HIGH, TABLE_LOW, TemperatureStatus

if TYPE_CHECKING:
    from bearing_twin.thermal.gate import GatedTemperature

__all__ = ['temperature_status']

TEXTS = {
    TemperatureStatus.OK: 'temperature is fresh',
    TemperatureStatus.WAITING: 'no temperature yet: the start temperature is used',
    TemperatureStatus.STALE: 'temperature is stale: the last valid one is held',
    TemperatureStatus.INVALID: 'temperature is no number or impossible: the last valid is held',
    TemperatureStatus.CLAMPED: (
        f'temperature is outside {TABLE_LOW:g}..{TABLE_HIGH:g} degC: the nearest end is used'
    ),
    TemperatureStatus.BACKWARDS: 'stamps run backwards: the last valid temperature is held',
}


def temperature_status(temperature: GatedTemperature, shaft_problem: str) -> Status:
    """Status of the inputs: temperature and, where a joint is named, shaft speed."""
    ok = temperature.status is TemperatureStatus.OK and not shaft_problem
    message = TEXTS[temperature.status]
    if temperature.status is TemperatureStatus.INVALID and math.isnan(temperature.age):
        message = 'temperature is no number or impossible: the start temperature is used'
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
