# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
from bearing_twin.dynamics import preset, Simulator
from bearing_twin.nodes.twin_topics import clearance_problem, temperature_status
from bearing_twin.ros.health import Level
from bearing_twin.thermal.gate import TemperatureGate


def test_a_bearing_that_would_seize_is_a_warning_with_the_numbers():
    gate = TemperatureGate(timeout=5.0)
    gate.offer(20.0, stamp=1, now=0.0)
    simulator = Simulator(preset('incipient', thermal_mode='physical'), temperature=110.0)
    sound = temperature_status(gate.at(0.0), '', clearance_problem(simulator.condition()))
    assert sound.level == Level.OK
    quenched = simulator.advance(2560, 20.0, 25.4).condition
    said = temperature_status(gate.at(0.0), '', clearance_problem(quenched))
    assert said.level == Level.WARN
    assert 'would seize' in said.message
    assert f'{quenched.thermal_clearance * 1e6:.1f} um' in said.message
    assert 'goes on with -5 um' in said.message
