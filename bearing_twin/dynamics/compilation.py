# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Compilation of the simulator before its first use."""

from __future__ import annotations

from bearing_twin.dynamics.equations.load_zone import contact_forces
from bearing_twin.dynamics.equations.sensor_path import SensorPath
from bearing_twin.dynamics.fleet.fleet import Fleet
from bearing_twin.dynamics.presets import preset
from bearing_twin.dynamics.single.simulator import Simulator
import numpy as np


def warm_up(*, fleet: bool = False) -> None:
    """
    Compile all functions of a running simulator, or load them from the cache.

    With ``fleet`` this includes the functions of a :class:`Fleet`.

    Examples
    --------
    >>> warm_up()

    """
    parameters = preset('incipient', thermal_mode='physical')
    simulator = Simulator(parameters)
    simulator.advance(16, 30.0, 25.0)
    simulator.condition()
    path = SensorPath(sample_rate=25600.0, numerator=(1.0,), denominator=(1.0,), noise=0.0)
    path.filter().apply([0.0])
    # Called where a picture of the bearing is drawn.
    contact_forces(np.zeros(2), 0.0, 0.0, 0.0, 1.0)
    if fleet:
        bearings = Fleet([parameters])
        bearings.advance(16, 30.0, 25.0)
        bearings.condition(0)
        bearings.extract(0)
