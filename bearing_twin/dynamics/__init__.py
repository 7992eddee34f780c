# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The bearing's equations of motion and the simulator that advances them."""

from bearing_twin.dynamics.condition import Condition
from bearing_twin.dynamics.fleet import Fleet, FleetBlock
from bearing_twin.dynamics.parameters import Defect, TwinParameters
from bearing_twin.dynamics.presets import preset, PRESETS
from bearing_twin.dynamics.simulator import Block, Simulator
from bearing_twin.dynamics.warming import warm_up

__all__ = [
    'PRESETS',
    'Block',
    'Condition',
    'Defect',
    'Fleet',
    'FleetBlock',
    'Simulator',
    'TwinParameters',
    'preset',
    'warm_up',
]
