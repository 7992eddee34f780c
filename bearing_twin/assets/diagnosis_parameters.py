# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the diagnosis node and what they build. A re-run builds from the same table."""

from __future__ import annotations

import math
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.shared_specs import (
    CHECKPOINT_PERIOD,
    GEOMETRY,
    HARDWARE_ID,
    JOINT,
    STATE_DIRECTORY,
)
from bearing_twin.assets.spec import Spec
from bearing_twin.bearing.catalogue import find_bearing, own_bearing
from bearing_twin.diagnosis import DiagnosisSettings, StreamingDiagnoser

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bearing_twin.bearing import Bearing

__all__ = ['SPECS', 'build_bearing', 'build_diagnoser', 'build_settings', 'nominal_speed']

SPECS = (
    Spec(
        name='bearing',
        default='6307',
        description="Bearing of the catalogue; '' to use the parameter geometry.",
    ),
    GEOMETRY,
    Spec(
        name='shaft_hz',
        default=0.0,
        description=(
            'Shaft speed where neither the vibration message nor a joint tells it; 0: unknown.'
        ),
        unit='Hz',
        low=0.0,
        high=1000.0,
    ),
    Spec(
        name='speed_tolerance',
        default=0.02,
        description='Uncertainty of the parameter shaft_hz, as a fraction of the speed.',
        low=0.0,
        high=0.1,
    ),
    Spec(
        name='measured_speed_tolerance',
        default=0.002,
        description='Uncertainty of a speed that comes with the samples or from a joint.',
        low=0.0,
        high=0.1,
    ),
    JOINT,
    Spec(
        name='axis',
        default='y',
        description='Axis of the vibration message to diagnose; the other one if it is empty.',
        choices=('x', 'y'),
        running=False,
    ),
    Spec(
        name='window',
        default=8.0,
        description='Length of the sliding window.',
        unit='s',
        low=1.0,
        high=60.0,
    ),
    Spec(
        name='update_interval',
        default=1.0,
        description='Time between verdicts.',
        unit='s',
        low=0.2,
        high=60.0,
    ),
    Spec(
        name='unit',
        default='',
        description="Unit of the samples, 'm/s^2' or 'g'; '' to believe the message.",
        choices=('', 'm/s^2', 'g'),
    ),
    Spec(
        name='memory',
        default=8.0,
        description='Span over which windows are averaged; at least the window.',
        unit='s',
        low=1.0,
        high=600.0,
    ),
    Spec(
        name='hold_updates',
        default=3,
        description='Equal verdicts in a row before the level rises or falls.',
        low=1,
        high=1000,
    ),
    Spec(
        name='baseline_windows',
        default=60,
        description='Healthy windows from which the baseline of the asset is learnt.',
        low=1,
        high=1000000,
    ),
    Spec(
        name='power_group',
        default=0,
        description='Group of ISO 20816-3: 1 above 300 kW, 2 for 15 to 300 kW; 0: no zone.',
        low=0,
        high=2,
    ),
    Spec(
        name='mounting',
        default='',
        description="Foundation of the machine for the zone of ISO 20816-3; '': no zone.",
        choices=('', 'rigid', 'flexible'),
    ),
    Spec(
        name='state_name',
        default='',
        description=(
            "File that keeps baseline and trend over restarts, in the state folder; '' for none."
        ),
        running=False,
    ),
    STATE_DIRECTORY,
    CHECKPOINT_PERIOD,
    HARDWARE_ID,
)


def build_bearing(values: Mapping[str, Any]) -> Bearing:
    """
    Return the bearing that the parameters name or describe.

    Raises
    ------
    BearingTwinError
        If the catalogue has no such bearing, or the geometry cannot be read or built.

    """
    if values['bearing']:
        return find_bearing(values['bearing'])
    return own_bearing(values['geometry'])


def build_settings(values: Mapping[str, Any]) -> DiagnosisSettings:
    """
    Return the settings of the chain.

    Raises
    ------
    BearingTwinError
        If they do not fit together.

    """
    return DiagnosisSettings(
        window=values['window'],
        update_interval=values['update_interval'],
        speed_tolerance=values['speed_tolerance'],
        measured_speed_tolerance=values['measured_speed_tolerance'],
        memory=values['memory'],
        unit=values['unit'],
        power_group=values['power_group'],
        mounting=values['mounting'],
        baseline_windows=values['baseline_windows'],
        hold_updates=values['hold_updates'],
    )


def build_diagnoser(values: Mapping[str, Any]) -> StreamingDiagnoser:
    """Return a diagnoser at its start."""
    return StreamingDiagnoser(build_bearing(values), build_settings(values))


def nominal_speed(values: Mapping[str, Any]) -> float:
    """Return the shaft speed given by parameter, Hz; NaN where it is unknown."""
    return values['shaft_hz'] or math.nan
