# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The bearing's equations of motion and what advances them.

Each room rests on those before it: ``equations`` (contacts, rings, waves, sensor path), ``single``
(the steps of one bearing and its `Simulator`) and ``fleet`` (many bearings at once). Beside them
are the parameters of a twin, their presets and limits, and the reference solution.
"""

from bearing_twin.dynamics.fleet.fleet import Fleet, FleetBlock
from bearing_twin.dynamics.parameters import Defect, TwinParameters
from bearing_twin.dynamics.presets import preset, PRESETS
from bearing_twin.dynamics.single.condition import Condition
from bearing_twin.dynamics.single.simulator import Block, Simulator
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
