# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Equations of motion of the bearing, and their integration in time.

Each subpackage imports only those before it: ``equations`` (contacts, rings, waviness, sensor
path), ``single`` (integrator and `Simulator` of one bearing) and ``fleet`` (many bearings at
once). The modules beside them hold the parameters of a twin, presets, limits and the reference
solution.
"""

from bearing_twin.dynamics.compilation import warm_up
from bearing_twin.dynamics.fleet.fleet import Fleet, FleetBlock
from bearing_twin.dynamics.parameters import Defect, TwinParameters
from bearing_twin.dynamics.presets import preset, PRESETS
from bearing_twin.dynamics.single.condition import Condition
from bearing_twin.dynamics.single.simulator import Block, Simulator

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
