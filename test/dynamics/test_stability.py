# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
import dataclasses
import math

from bearing_twin.dynamics import preset, PRESETS, Simulator
from bearing_twin.dynamics.equations.stability import _check, _motions, amplification
from bearing_twin.errors import BearingTwinError
import numpy as np
import pytest

H = 1.0 / 25600.0


@pytest.mark.parametrize('damping', [0.0, 60.0])
def test_one_step_is_that_of_an_oscillator(damping):
    """Against cosine and sine: order 4, with damping as without."""
    omega, time = 2.0 * math.pi * 500.0, 1.25e-3
    fast = math.sqrt(omega**2 - 0.25 * damping**2)
    decay = math.exp(-0.5 * damping * time)
    c, s = math.cos(fast * time), math.sin(fast * time)
    exact = decay * (c + 0.5 * damping / fast * s), -decay * omega**2 / fast * s

    def error(steps):
        state = np.array([1.0, 0.0, -(omega**2), damping * omega**2, 0.0])
        state[4] = -(omega**2) * state[2] - damping * state[3]
        step = amplification(np.array([[omega**2]]), np.array([[damping]]), time / steps)
        for _ in range(steps):
            state = step @ state
        return math.hypot(state[0] - exact[0], (state[1] - exact[1]) / omega)

    assert error(96) < 1e-6
    assert error(320) / error(640) == pytest.approx(2.0**4, rel=0.1)


def test_a_motion_that_grows_is_not_only_said_to_be_resolved():
    with pytest.raises(BearingTwinError, match=r'at 7978 Hz, .* up to 12223 Hz, but make it grow'):
        Simulator(preset('paper', outer_mass=0.1))


@pytest.mark.parametrize('name', list(PRESETS))
def test_every_preset_is_resolved(name):
    _check(_motions(preset(name), preloaded=True), H)


@pytest.mark.parametrize(
    'changes',
    [
        {'inner_damping': 1e6},
        {'outer_damping': 1e6},
        {'inner_mass': 0.1, 'inner_stiffness': 1e10},
        {'inner_mass': 0.1, 'contact_damping': 1500.0},
        {'inner_mass': 0.1, 'outer_mass': 0.1},
    ],
)
def test_what_the_step_cannot_resolve_is_refused_and_changes_nothing(changes):
    parameters = preset('incipient')
    stiff = dataclasses.replace(parameters, **changes)
    with pytest.raises(BearingTwinError, match='use larger masses'):
        Simulator(stiff)
    simulator = Simulator(parameters)
    before = simulator.save()
    with pytest.raises(BearingTwinError):
        simulator.reconfigure(stiff)
    assert simulator.parameters is parameters
    assert simulator.save() == before
