# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the twin says of its inputs, and of what they do to it, on /diagnostics."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.ros.health import Level, Status
from bearing_twin.thermal.gate import TABLE_HIGH, TABLE_LOW, TemperatureStatus

if TYPE_CHECKING:
    from bearing_twin.dynamics.condition import Condition
    from bearing_twin.thermal.gate import GatedTemperature

__all__ = ['clearance_problem', 'temperature_status']

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


def clearance_problem(condition: Condition) -> str:
    """Say that the ring temperatures left the clearance that the model holds for, or ''."""
    left, used = condition.thermal_clearance, condition.radial_clearance
    if left == used:
        return ''
    apart = condition.inner_ring_temperature - condition.outer_ring_temperature
    return (
        f'the bearing {"would seize" if left < used else "hangs loose"}: an inner ring '
        f'{apart:+.0f} K from the outer one leaves a radial clearance of {left * 1e6:.1f} um, '
        f'the model goes on with {used * 1e6:g} um'
    )


def temperature_status(temperature: GatedTemperature, *problems: str) -> Status:
    """Status of the temperature and of ``problems``, of which an empty one is none."""
    ok = temperature.status is TemperatureStatus.OK and not any(problems)
    message = TEXTS[temperature.status]
    if temperature.status is TemperatureStatus.INVALID and math.isnan(temperature.age):
        message = 'temperature is no number or impossible: the start temperature is used'
    message = '; '.join([message, *filter(None, problems)])
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
