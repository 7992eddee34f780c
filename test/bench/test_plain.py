# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The plain scheme that the kernel is compared with solves the same equations."""

from bearing_twin.bench.plain import solve_plainly, time_at
from bearing_twin.dynamics import preset
from bearing_twin.dynamics.reference import solve
import numpy as np


def test_the_plain_scheme_converges_to_the_adaptive_solver():
    p = preset('incipient', defect='inner', jitter=0.0, noise=0.0, waviness=0.0)
    reference = solve(p, 2560)
    expected = np.array([reference.x, reference.y])[:, 64:]
    errors = []
    for steps in (1, 2, 4):
        found, took = solve_plainly(p, reference.states[:, 0], 2560, steps, shaft_hz=25.4)
        assert took > 0.0
        off = np.linalg.norm(found[:, 64:] - expected) / np.linalg.norm(expected)
        errors.append(float(off))
    assert errors[0] < 1e-2
    assert errors[2] < 0.25 * errors[0]
    assert errors[2] < 5e-4
    assert time_at(p, reference, 1e-3, shaft_hz=25.4) > 0.0
