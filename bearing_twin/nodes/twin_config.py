# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the twin node and what they build. A re-run builds from the same table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bearing_twin.bearing.catalogue import find_bearing
from bearing_twin.dynamics.parameters import PRESETS, preset
from bearing_twin.dynamics.simulator import Simulator
from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes.parameters import Spec

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bearing_twin.dynamics.parameters import TwinParameters

__all__ = ['SPECS', 'build_parameters', 'build_simulator', 'defect_places']

PLACES = ('inner', 'outer', 'ball', 'cage')

SPECS = (
    Spec(
        name='bearing',
        default='6307',
        description='Bearing of the catalogue (6307 has the geometry of the paper).',
        running=False,
    ),
    Spec(
        name='preset',
        default='incipient',
        description='Named and cited set of masses, load, clearance and defect size.',
        choices=tuple(PRESETS),
    ),
    Spec(
        name='defect',
        default='none',
        description="Place of the defect: none, inner, outer, ball, cage; several: 'inner+ball'.",
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
        high=0.001,
    ),
    Spec(
        name='thermal_mode',
        default='paper',
        description='Temperature law: beta0 of tables 1-3, or ring temperatures and clearance.',
        choices=('paper', 'physical'),
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
        description='Shaft speed while no joint tells it.',
        unit='Hz',
        low=0.0,
        high=100.0,
    ),
    Spec(
        name='joint',
        default='',
        description="Joint of joint_states that turns with the shaft; '' for none.",
        running=False,
    ),
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
    Spec(
        name='hardware_id',
        default='',
        description="Asset that /diagnostics speaks of; '' for the node's namespace.",
        running=False,
    ),
    Spec(
        name='catch_up_blocks',
        default=5,
        description='Most blocks published at once after being late; older ones are dropped.',
        low=1,
        high=100,
        running=False,
    ),
    Spec(
        name='late_after',
        default=0.02,
        description='Lateness above which a block counts as late.',
        unit='s',
        low=0.001,
        high=10.0,
        running=False,
    ),
    Spec(
        name='checkpoint_period',
        default=10.0,
        description='Time between checkpoints, from which a recording can be re-run.',
        unit='s',
        low=1.0,
        high=3600.0,
        running=False,
    ),
    Spec(
        name='state_directory',
        default='',
        description="Folder of saved states; '' for bearing_twin in ROS_HOME (~/.ros).",
        running=False,
    ),
)


def defect_places(text: str) -> tuple[str, ...]:
    """Return the places named by the parameter ``defect``.

    Raises
    ------
    BearingTwinError
        If a place is unknown or stands twice.
    """
    if text == 'none':
        return ()
    places = tuple(text.split('+'))
    if set(places) - set(PLACES) or len(set(places)) != len(places):
        msg = f"defect='{text}': give none, or different ones of {', '.join(PLACES)} joined by '+'"
        raise BearingTwinError(msg)
    return places


def build_parameters(values: Mapping[str, Any]) -> TwinParameters:
    """Return the model that the parameters describe.

    Raises
    ------
    BearingTwinError
        If they do not fit together or leave the model's validity.
    """
    return preset(
        values['preset'],
        bearing=find_bearing(values['bearing']),
        defects=defect_places(values['defect']),
        width=values['defect_width'] or None,
        depth=values['defect_depth'] or None,
        thermal_mode=values['thermal_mode'],
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
