# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Static equilibrium against the balance of forces, written out here."""

import math

from bearing_twin.dynamics import preset, Simulator
from bearing_twin.dynamics.equations.model import Contact
from bearing_twin.dynamics.equations.statics import (
    equilibrium,
    healthy_balls,
    spring_position,
    Supports,
    supports,
)
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest


def spread(low, high):
    """Floats over decades."""
    return st.floats(math.log(low), math.log(high)).map(math.exp)


def force_between(x, y, k_b, clearance, angles):
    """Return force of the balls on the outer ring, N: the power 1.5 of the approach."""
    c, s = np.cos(angles), np.sin(angles)
    pressed = k_b * np.maximum(x * c + y * s - clearance, 0.0) ** 1.5
    return np.array([pressed @ c, pressed @ s])


@settings(max_examples=300, deadline=None, derandomize=True)
@given(
    load=spread(1.0, 1e5),
    k_b=spread(1e8, 1e12),
    clearance=st.floats(-20e-6, 100e-6),
    along=spread(1e-10, 1e-4),
    ratio=spread(0.1, 10.0),
    skew=st.floats(-0.9, 0.9),
    n=st.integers(3, 40),
)
def test_forces_balance_between_soft_supports_and_stiff_contacts(
    load, k_b, clearance, along, ratio, skew, n
):
    across = along * ratio
    compliance = np.array([[across, 0.0], [0.0, along]])
    compliance += skew * math.sqrt(across * along) * np.array([[0.0, 1.0], [1.0, 0.0]])
    held = Supports((across, compliance[0, 1], along), -compliance[0, 1] * load)
    contact = Contact(k_b, damping=0.0)
    foot = held.aside, spring_position(load, contact, clearance, held, n)
    loads = []
    for share in (np.arange(8) + 0.5) / 8:
        angle = 2.0 * math.pi / n * share - 0.5 * math.pi
        balls = healthy_balls(angle, clearance, n)
        x, y, fx, fy = equilibrium(foot, contact, held.compliance, balls, foot)
        force = force_between(x, y, k_b, clearance, angle + 2.0 * math.pi * np.arange(n) / n)
        gave = foot - compliance @ force
        assert np.array([x, y]) == pytest.approx(gave, rel=1e-6, abs=1e-11)
        assert np.array([fx, fy]) == pytest.approx(force, rel=1e-4, abs=1e-6 * load)
        loads.append(-force[1])
    assert np.mean(loads) == pytest.approx(load, rel=1e-3)


def test_a_machine_on_soft_springs_starts_where_its_forces_balance():
    p = preset(
        'paper', bearing='6418', load=158.3, load_angle=5.0, clearance=24.5e-6,
        hertz_stiffness=5e11, contact_damping=80.0, inner_mass=0.295, inner_stiffness=3.6e5,
        inner_damping=10.0, outer_mass=205.0, outer_stiffness=1e5, outer_damping=9e5,
    )  # fmt: skip
    block = Simulator(p, sample_rate=12800.0).advance(1280, 20.0, 25.4)
    assert max(supports(p).compliance) > 1e-5
    assert 0.0 < np.abs([block.x, block.y]).max() < 100.0
