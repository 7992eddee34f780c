# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the twin node, and the twin built from them, live or in a re-run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from bearing_twin.assets.parameters.shared import (
    CHECKPOINT_PERIOD,
    GEOMETRY,
    HARDWARE_ID,
    JOINT,
    STATE_DIRECTORY,
)
from bearing_twin.assets.parameters.spec import (
    field_spec,
    field_values,
    fixed,
    parameter,
    Spec,
    Value,
)
from bearing_twin.bearing import find_bearing, own_bearing
from bearing_twin.dynamics.parameters import Defect, TwinParameters
from bearing_twin.dynamics.presets import preset, PRESET_FIELDS, PRESETS
from bearing_twin.dynamics.single.simulator import Simulator
from bearing_twin.quantity import quantities
from bearing_twin.thermal.gcr15 import Beta0, TABLE_HIGH, TABLE_LOW
from bearing_twin.thermal.lubricant import Lubricant
from bearing_twin.thermal.network import ThermalNetwork

FASTEST_LIVE_SHAFT = 100.0
"""
Fastest shaft of a live twin, Hz.

The simulator accepts up to 500 Hz, but it has no centrifugal force of the balls. Its errors grow
from below 0.1 % to a few percent; those of a fleet from below 2 % to a third (docs/realtime.md).
"""


def _machine(name: str, *, implied: bool = True) -> Spec:
    """Return the parameter for a field of the twin; a preset or the geometry may set the field."""
    default, about = quantities(TwinParameters)[name]
    sources = ['from the preset'] if name in PRESET_FIELDS else []
    if default is None and about.special is not None:
        sources.append(about.special[1])
    absent: tuple[Value, str] | None = None
    if sources:
        # 0 means "not set", unless it is a valid value; then -1 does.
        nothing = '' if about.low is None else 0.0 if about.low > 0.0 else -1.0
        absent = (nothing, ' or '.join(sources))
    return field_spec(TwinParameters, name, absent=absent, implied=implied)


def _group(group: str, owner: type) -> tuple[Spec, ...]:
    return tuple(
        field_spec(
            owner,
            name,
            name=f'{group}.{name}',
            implied=True,
            absent=(0.0, about.special[1]) if default is None and about.special else None,
        )
        for name, (default, about) in quantities(owner).items()
    )


_NAMED = tuple(
    _machine(name, implied=False)
    for name in ('thermal_mode', 'load', 'slip_model', 'jitter', 'noise', 'waviness')
)
"""Parameters of the twin that every checkpoint contains."""
_IMPLIED = tuple(
    _machine(name)
    for name in quantities(TwinParameters)
    if name not in {spec.name for spec in _NAMED}
)
_BETA0 = _group('beta0', Beta0)
_LUBRICANT = _group('lubricant', Lubricant)
_NETWORK = _group('network', ThermalNetwork)

SPECS = (
    fixed('bearing', '6307', "Bearing of the catalogue (6307: the paper's); '' to use geometry."),
    replace(GEOMETRY, running=False, implied=True),
    parameter('preset', 'paper', 'Set of masses, dampings, load and defect size from the '
              'literature. In the thermal mode paper, at 22 to 29 Hz, heat weakens the impacts '
              'with the preset paper, as in the paper, and strengthens them with all others.',
              choices=tuple(PRESETS)),
    parameter('defect', 'none', 'Place of the defect: none, inner, outer, ball or cage. Several '
              'are joined by +, each with its own sizes if given: '
              "'inner:width=0.001,angle=1.57+ball:ball=3,profile=rect'."),
    field_spec(Defect, 'width', name='defect_width', absent=(0.0, 'from the preset')),
    field_spec(Defect, 'depth', name='defect_depth', absent=(0.0, 'from the preset')),
    field_spec(Defect, 'profile', name='defect_profile', implied=True),
    *_NAMED,
    fixed('seed', 0, 'Seed of jitter, noise and surfaces: the same seed gives the same samples.',
          '', 0, 2**31 - 1),
    fixed('sample_rate', 25600.0, 'Rate of the published samples.', 'Hz', 5000.0, 51200.0),
    fixed('block_size', 1024, 'Samples per published block.', '', 64, 8192),
    parameter('shaft_hz', 25.4, 'Shaft speed while no joint gives it. The limit holds for a joint '
              'too.', 'Hz', 0.0, FASTEST_LIVE_SHAFT),
    JOINT,
    fixed('start_temperature', 20.0, 'Temperature used until the first measurement. The thermal '
          'mode physical starts in the steady state of the first measurement.',
          'degC', TABLE_LOW, TABLE_HIGH),
    parameter('temperature_timeout', 5.0, 'Age above which a temperature is stale. The last valid '
              'one is then held.', 's', 0.1, 3600.0),
    fixed('frame_id', 'bearing_housing', 'Frame of the sensor, in every header.'),
    HARDWARE_ID,
    CHECKPOINT_PERIOD,
    STATE_DIRECTORY,
    *_IMPLIED,
    *_BETA0,
    *_LUBRICANT,
    *_NETWORK,
)  # fmt: skip

FITTED = (
    parameter('calibration', '', "File in the state folder, written by 'bearing-twin fit --json'. "
              'The twin takes sensor path, load, slip and defect from it. None: empty.',
              implied=True),
    fixed('follow_calibration', False, 'Take over each calibration of the topic calibration.',
          implied=True),
)  # fmt: skip
"""Parameters for calibrations of a twin node; the twins of a fleet have none."""

_DEFAULTS = {spec.name: spec.default for spec in SPECS if spec.implied}


def build_parameters(values: Mapping[str, Any]) -> TwinParameters:
    """Return the model parameters for given values of the node parameters."""
    values = {**_DEFAULTS, **values}
    bearing = values['bearing']
    return preset(
        values['preset'],
        bearing=find_bearing(bearing) if bearing else own_bearing(values['geometry']),
        defect=values['defect'],
        width=values['defect_width'] or None,
        depth=values['defect_depth'] or None,
        profile=values['defect_profile'],
        beta0=Beta0(**field_values(_BETA0, values)),
        lubricant=Lubricant(**field_values(_LUBRICANT, values)),
        network=ThermalNetwork(**field_values(_NETWORK, values)),
        **field_values((*_NAMED, *_IMPLIED), values),
    )


def build_simulator(
    values: Mapping[str, Any], parameters: TwinParameters | None = None
) -> Simulator:
    """Return a new simulator; ``parameters``, if given, replace those in ``values``."""
    return Simulator(
        parameters or build_parameters(values),
        sample_rate=values['sample_rate'],
        seed=values['seed'],
        temperature=values['start_temperature'],
        shaft_hz=values['shaft_hz'],
    )
