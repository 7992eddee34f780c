# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the diagnosis node, and the diagnosis built from them, live or in a re-run."""

from __future__ import annotations

from collections.abc import Mapping
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.parameters.shared import (
    CHECKPOINT_PERIOD,
    GEOMETRY,
    HARDWARE_ID,
    JOINT,
    STATE_DIRECTORY,
    STATE_OWNER,
)
from bearing_twin.assets.parameters.spec import field_spec, field_values, fixed, parameter
from bearing_twin.bearing.catalogue import find_bearing, own_bearing
from bearing_twin.diagnosis import DiagnosisSettings, StreamingDiagnoser
from bearing_twin.diagnosis.series.snapshots import SeriesDiagnoser
from bearing_twin.quantity import quantities
from bearing_twin.streams.shaft import FASTEST_SHAFT
from bearing_twin.streams.statefile import StateFolder

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


_SETTINGS = tuple(field_spec(DiagnosisSettings, name) for name in quantities(DiagnosisSettings))

SPECS = (
    parameter('bearing', '6307', "Bearing of the catalogue; '' to use the parameter geometry."),
    GEOMETRY,
    parameter('shaft_hz', 0.0, 'Shaft speed where neither the vibration message nor a joint tells '
              'it; 0: unknown.', 'Hz', 0.0, FASTEST_SHAFT),
    JOINT,
    fixed('axis', 'y', 'Axis of the vibration message to diagnose; the other one if it is empty.',
          choices=('x', 'y')),
    *_SETTINGS,
    fixed('state_name', '', 'File that keeps baseline and trend over restarts, in the state '
          "folder; '' for none."),
    STATE_DIRECTORY,
    STATE_OWNER,
    CHECKPOINT_PERIOD,
    HARDWARE_ID,
)  # fmt: skip


def build_bearing(values: Mapping[str, Any]) -> Bearing:
    """Return the bearing that the parameters name or describe."""
    if values['bearing']:
        return find_bearing(values['bearing'])
    return own_bearing(values['geometry'])


def build_settings(values: Mapping[str, Any]) -> DiagnosisSettings:
    """Return the settings of the diagnosis."""
    return DiagnosisSettings(**field_values(_SETTINGS, values))


def check_diagnosis(values: Mapping[str, Any]) -> None:
    """Refuse parameters that contradict each other."""
    build_diagnoser(values)
    if values['state_name']:
        StateFolder(values['state_directory']).path(values['state_name'])


def build_diagnoser(values: Mapping[str, Any]) -> StreamingDiagnoser | SeriesDiagnoser:
    """Return a new diagnoser of a stream or of a series of snapshots."""
    settings = build_settings(values)
    kind = SeriesDiagnoser if settings.series_cycle else StreamingDiagnoser
    return kind(build_bearing(values), settings)


def nominal_speed(values: Mapping[str, Any]) -> float:
    """Return the shaft speed given by parameter, Hz; NaN if unknown."""
    return values['shaft_hz'] or math.nan
