# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether the integrator's step resolves the fastest motion of a set of parameters."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.dynamics import laws
from bearing_twin.dynamics.statics import contact, equilibrium
from bearing_twin.errors import BearingTwinError
from bearing_twin.thermal.gcr15 import TEMPERATURES
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters

__all__ = ['amplification', 'check_step', 'system_matrices']

FloatArray = npt.NDArray[np.float64]

_OVERLOAD = 2.0
"""An impact may press the balls in four times as deep as the load does: twice the stiffness."""
_LARGEST_STEP = 1.0
"""h |lambda| up to which a mode is resolved: the phase error of the scheme is then 0.1 % a rad."""


def system_matrices(
    p: TwinParameters, contact_stiffness: FloatArray, loaded: float
) -> tuple[FloatArray, FloatArray]:
    """
    Return K and C of ``q'' = -K q - C q'`` for q = (x_i, y_i, x_o, y_o), 1/s^2 and 1/s.

    ``contact_stiffness`` (2, 2), N/m, is that between the rings; ``loaded`` the balls whose
    damping acts, taken as the same in both directions.
    """
    coupling = np.array([[1.0, -1.0], [-1.0, 1.0]])
    stiffness = np.kron(coupling, contact_stiffness)
    stiffness += np.diag([p.inner_stiffness] * 2 + [p.outer_stiffness] * 2)
    damping = np.kron(coupling, p.contact_damping * loaded * np.eye(2))
    damping += np.diag([p.inner_damping] * 2 + [p.outer_damping] * 2)
    light = np.array([1.0 / p.inner_mass] * 2 + [1.0 / p.outer_mass] * 2)[:, None]
    return light * stiffness, light * damping


def amplification(stiffness: FloatArray, damping: FloatArray, h: float) -> FloatArray:
    """Matrix that one step of `kernel` applies to (q, v, a, j) of a linear system."""
    n = len(stiffness)
    one, none = np.eye(n), np.zeros((n, n))
    # Rows of the state; then predictor, evaluation and corrector as in `kernel`.
    q, v, a, j = (np.hstack([one if i == k else none for i in range(4)]) for k in range(4))
    ahead = a + h * j
    faster = v + h * (a + 0.5 * h * j)
    further = q + h * (v + 0.5 * h * (a + h / 3.0 * j))
    a1 = -stiffness @ further - damping @ faster
    j1 = -stiffness @ faster - damping @ ahead
    v1 = v + 0.5 * h * (a + a1) + h * h / 12.0 * (j - j1)
    q1 = q + 0.5 * h * (v + v1) + h * h / 12.0 * (a - a1)
    return np.vstack([q1, v1, a1, j1])


def check_step(p: TwinParameters, h: float) -> None:
    """
    Refuse parameters whose fastest motion a step of ``h`` seconds does not resolve.

    The equations are linearised at the load's equilibrium with the hottest contact stiffness, and
    without contact. The step has to resolve every mode, and to be stable even at `_OVERLOAD`
    times the contact stiffness.

    Raises
    ------
    BearingTwinError
        With the frequency of the fastest mode and what to change.

    """
    row, out = laws.law_table(p), np.empty(laws.CONDITION_SIZE)
    factors = []
    for temperature in TEMPERATURES:
        laws.evaluate(row, float(temperature), float(temperature), 25.0, out)
        factors.append((float(out[laws.K_B]), float(out[laws.CLEARANCE]), float(out[laws.SPRING])))
    k_b, clearance, spring = max(factors)
    compliance = 1.0 / p.inner_stiffness + 1.0 / p.outer_stiffness
    n = p.bearing.n_balls
    x, y, _, _ = equilibrium(-math.pi / 2, spring, k_b, clearance, compliance, n)
    _, _, kxx, kxy, kyy = contact(x, y, 0.0, -1.0, k_b, clearance, n)
    touching = np.array([[kxx, kxy], [kxy, kyy]])
    for scale, balls in ((0.0, 0.0), (1.0, 0.5 * n), (_OVERLOAD, 0.5 * n)):
        stiffness, damping = system_matrices(p, scale * touching, balls)
        whole = np.block([[np.zeros((4, 4)), np.eye(4)], [-stiffness, -damping]])
        fastest = float(np.abs(np.linalg.eigvals(whole)).max())
        radius = float(np.abs(np.linalg.eigvals(amplification(stiffness, damping, h))).max())
        if radius > 1.0 + 1e-9 or (scale <= 1.0 and fastest * h > _LARGEST_STEP):
            limit = _LARGEST_STEP / h / 2.0 / math.pi
            msg = (
                f'the fastest motion of these parameters is at {fastest / 2.0 / math.pi:.0f} Hz, '
                f'and steps of {h * 1e6:.3g} us resolve up to {limit:.0f} Hz: use larger masses, '
                'less stiffness or damping, or a higher sample rate'
            )
            raise BearingTwinError(msg)
