# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What /diagnostics says of a twin beyond the limits of its model or of its life."""

from bearing_twin.dynamics import preset, Simulator
from bearing_twin.nodes.twin_topics import validity_status
from bearing_twin.ros.health import Level


def test_a_bearing_that_would_seize_is_a_warning_with_the_numbers():
    simulator = Simulator(preset('incipient', thermal_mode='physical'), temperature=110.0)
    assert validity_status(None).level == Level.OK
    assert validity_status(simulator.condition()).level == Level.OK
    quenched = simulator.advance(2560, 20.0, 25.4).condition
    said = validity_status(quenched)
    assert said.level == Level.WARN
    assert 'would seize' in said.message
    assert f'{quenched.thermal_clearance * 1e6:.1f} um' in said.message
    assert 'goes on with -5 um' in said.message


def test_a_load_without_a_life_is_a_warning_and_one_state_however_its_numbers_move():
    heavy = preset('incipient', bearing='6203', load=7000.0)
    warm, hot = (
        validity_status(Simulator(heavy, temperature=t).condition()) for t in (30.0, 90.0)
    )
    assert warm.level == hot.level == Level.WARN
    assert warm.kind == hot.kind
    assert 'no life' in warm.message
    assert warm.values['contact_pressure_pa'] > 4.2e9
