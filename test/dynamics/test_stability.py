# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
import dataclasses
import math

from bearing_twin.bearing import catalogue
from bearing_twin.dynamics import preset, PRESETS, Simulator, TwinParameters
from bearing_twin.dynamics.parameters import _RANGES
from bearing_twin.dynamics.stability import amplification, check_step
from bearing_twin.errors import BearingTwinError
from hypothesis import given, HealthCheck, settings
from hypothesis import strategies as st
import numpy as np
import pytest

H = 1.0 / 76800.0


@pytest.mark.parametrize(('damping', 'order'), [(0.0, 4), (60.0, 3)])
def test_one_step_is_that_of_an_oscillator(damping, order):
    """Against cosine and sine; order 4, and 3 in the small part that damping has."""
    omega, time = 2.0 * math.pi * 500.0, 1.25e-3
    fast = math.sqrt(omega**2 - 0.25 * damping**2)
    decay = math.exp(-0.5 * damping * time)
    c, s = math.cos(fast * time), math.sin(fast * time)
    exact = decay * (c + 0.5 * damping / fast * s), -decay * omega**2 / fast * s

    def error(steps):
        state = np.array([1.0, 0.0, -(omega**2), damping * omega**2])
        step = amplification(np.array([[omega**2]]), np.array([[damping]]), time / steps)
        for _ in range(steps):
            state = step @ state
        return math.hypot(state[0] - exact[0], (state[1] - exact[1]) / omega)

    assert error(96) < 1e-6  # the step of the kernel
    assert error(320) / error(640) == pytest.approx(2.0**order, rel=0.1)


@pytest.mark.parametrize('name', list(PRESETS))
def test_every_preset_is_resolved(name):
    check_step(preset(name), H)


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


def spread(low, high):
    """Floats over a range, by magnitude where it spans decades."""
    if low > 0.0 and high > 100.0 * low:
        powers = st.floats(math.log(low), math.log(high))
        return powers.map(lambda power: min(max(math.exp(power), low), high))
    return st.floats(low, high)


declared = st.fixed_dictionaries(
    {name: spread(low, high) for name, low, high, _ in _RANGES}
    | {
        'bearing': st.sampled_from(list(catalogue().values())),
        'hertz_stiffness': st.none() | spread(1e8, 1e12),
        'thermal_mode': st.sampled_from(['paper', 'physical']),
    }
)


@settings(
    max_examples=150,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)
@given(
    fields=declared,
    rate=st.sampled_from([2000.0, 12800.0, 25600.0, 51200.0, 204800.0]),
    temperature=st.floats(20.0, 110.0),
    hz=st.floats(0.0, 200.0),
)
def test_the_whole_declared_space_is_bounded_or_refused(fields, rate, temperature, hz):
    try:
        simulator = Simulator(
            TwinParameters(**fields), sample_rate=rate, temperature=temperature, shaft_hz=hz
        )
    except BearingTwinError:
        return
    samples = int(0.1 * rate)
    block = simulator.advance(samples, temperature, hz)
    assert np.isfinite([block.x, block.y]).all()
    # Nothing that holds its energy gets louder without end.
    later = simulator.advance(samples, temperature, hz)
    floor = fields['noise'] * 10.0 + 1e4
    assert np.abs([later.x, later.y]).max() < 20.0 * np.abs([block.x, block.y]).max() + floor
