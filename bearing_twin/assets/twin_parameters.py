# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the twin node and what they build. A re-run builds from the same table."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.model_parameters import fields
from bearing_twin.assets.model_parameters import SPECS as MODEL_SPECS
from bearing_twin.assets.shared_specs import (
    CHECKPOINT_PERIOD,
    GEOMETRY,
    HARDWARE_ID,
    JOINT,
    STATE_DIRECTORY,
)
from bearing_twin.assets.spec import Spec
from bearing_twin.bearing import find_bearing, own_bearing
from bearing_twin.dynamics.parameters import PROFILES
from bearing_twin.dynamics.presets import preset, PRESETS
from bearing_twin.dynamics.simulator import Simulator

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bearing_twin.dynamics.parameters import TwinParameters

__all__ = ['FASTEST_SHAFT', 'SPECS', 'build_parameters', 'build_simulator']

FASTEST_SHAFT = 100.0
"""
Fastest shaft of a twin that runs live, Hz.

The simulator goes on to 500 Hz, but knows no centrifugal force of the balls, and its errors grow
from below 0.1 % to some percent, a fleet's from below 2 % to a third (docs/realtime.md).
"""

SPECS = (
    Spec(
        name='bearing',
        default='6307',
        description="Bearing of the catalogue (6307: the paper's); '' to use geometry.",
        running=False,
    ),
    replace(GEOMETRY, running=False, implied=True),
    Spec(
        name='preset',
        default='incipient',
        description='Named and cited set of masses, load, clearance and defect size.',
        choices=tuple(PRESETS),
    ),
    Spec(
        name='defect',
        default='none',
        description=(
            "none, inner, outer, ball, cage; several: 'inner+ball'; with sizes and places of "
            "their own: 'inner:width=0.001,angle=1.57+ball:ball=3,profile=rect'."
        ),
    ),
    Spec(
        name='defect_width',
        default=0.0,
        description='Width of the defect along the rolling direction; 0: from the preset.',
        unit='m',
        low=0.0,
        high=0.01,
    ),
    Spec(
        name='defect_depth',
        default=0.0,
        description="Depth of the defect (the paper's C_d0); 0: from the preset.",
        unit='m',
        low=0.0,
        high=0.0005,
    ),
    Spec(
        name='defect_profile',
        default='ball',
        description='Path of a ball over the defect: geometric, or one of the literature.',
        choices=PROFILES,
        implied=True,
    ),
    Spec(
        name='thermal_mode',
        default='paper',
        description='Temperature law: beta0 of tables 1-3, or ring temperatures and clearance.',
        choices=('paper', 'physical'),
    ),
    Spec(
        name='load',
        default=0.0,
        description='Radial load that the bearing carries; 0: from the preset.',
        unit='N',
        low=0.0,
        high=50000.0,
    ),
    Spec(
        name='slip_model',
        default='mu_proportional',
        description='Cage slip: none, constant, or in proportion to the friction of table 3.',
        choices=('none', 'constant', 'mu_proportional'),
    ),
    Spec(
        name='jitter',
        default=0.005,
        description='Standard deviation of the angle between two impacts over the ball spacing.',
        low=0.0,
        high=0.05,
    ),
    Spec(
        name='noise',
        default=0.1,
        description='White noise of the sensor, standard deviation.',
        unit='m/s^2',
        low=0.0,
        high=100.0,
    ),
    Spec(
        name='seed',
        default=0,
        description='Seed of jitter and noise: the same seed gives the same samples.',
        low=0,
        high=2**31 - 1,
        running=False,
    ),
    Spec(
        name='sample_rate',
        default=25600.0,
        description='Rate of the published samples.',
        unit='Hz',
        low=12800.0,
        high=51200.0,
        running=False,
    ),
    Spec(
        name='block_size',
        default=1024,
        description='Samples per published block.',
        low=64,
        high=8192,
        running=False,
    ),
    Spec(
        name='shaft_hz',
        default=25.4,
        description='Shaft speed while no joint tells it. A joint is taken up to the same limit.',
        unit='Hz',
        low=0.0,
        high=FASTEST_SHAFT,
    ),
    JOINT,
    Spec(
        name='start_temperature',
        default=20.0,
        description='Temperature used until the first measurement.',
        unit='degC',
        low=20.0,
        high=110.0,
        running=False,
    ),
    Spec(
        name='temperature_timeout',
        default=5.0,
        description='Age above which a temperature is stale: the last valid one is then held.',
        unit='s',
        low=0.1,
        high=3600.0,
    ),
    Spec(
        name='frame_id',
        default='bearing_housing',
        description='Frame of the sensor, in every header.',
        running=False,
    ),
    HARDWARE_ID,
    CHECKPOINT_PERIOD,
    STATE_DIRECTORY,
    *MODEL_SPECS,
)

_IMPLIED = {spec.name: spec.default for spec in SPECS if spec.implied}


def build_parameters(values: Mapping[str, Any]) -> TwinParameters:
    """
    Return the model that the parameters describe.

    Raises
    ------
    BearingTwinError
        If they do not fit together or leave the model's validity.

    """
    values = {**_IMPLIED, **values}
    bearing = values['bearing']
    return preset(
        values['preset'],
        bearing=find_bearing(bearing) if bearing else own_bearing(values['geometry']),
        defect=values['defect'],
        width=values['defect_width'] or None,
        depth=values['defect_depth'] or None,
        profile=values['defect_profile'],
        thermal_mode=values['thermal_mode'],
        slip_model=values['slip_model'],
        jitter=values['jitter'],
        noise=values['noise'],
        **({'load': values['load']} if values['load'] else {}),
        **fields(values),
    )


def build_simulator(values: Mapping[str, Any]) -> Simulator:
    """Return a simulator at its start."""
    return Simulator(
        build_parameters(values),
        sample_rate=values['sample_rate'],
        seed=values['seed'],
        temperature=values['start_temperature'],
        shaft_hz=values['shaft_hz'],
    )
