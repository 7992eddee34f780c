# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Check that the integrator step resolves the fastest motion, and choice of the step."""

from __future__ import annotations

import contextlib
import math
from typing import TYPE_CHECKING

from bearing_twin.dynamics.equations import coefficients, filters
from bearing_twin.dynamics.equations.model import Contact
from bearing_twin.dynamics.equations.statics import (
    against_load,
    equilibrium,
    force_and_stiffness,
    healthy_balls,
    spring_position,
    supports,
)
from bearing_twin.dynamics.parameters import MAX_SHAFT_HZ
from bearing_twin.errors import BearingTwinError
from bearing_twin.thermal.gcr15 import TEMPERATURES
from bearing_twin.thermal.network import clearance_limits
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters


FloatArray = npt.NDArray[np.float64]
_Motions = list[tuple[float, FloatArray, FloatArray]]

_OVERLOAD = 2.0
"""Factor on the contact stiffness: an impact may press the balls in four times as deep as the load
does, which doubles the stiffness."""
_LARGEST_STEP = 1.0
"""Largest h |lambda| of a resolved mode; the phase error of the scheme is then 0.1 % per rad."""
_GOOD_STEP = 0.28
"""Largest h |lambda| for which a step is not divided into three."""
_COUPLING = np.kron([[1.0, -1.0], [-1.0, 1.0]], np.ones((2, 2)))


def system_matrices(
    p: TwinParameters, contact_stiffness: FloatArray, contact_damping: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """
    Return K and C of ``q'' = -K q - C q'`` for q = (x_i, y_i, x_o, y_o), 1/s^2 and 1/s.

    ``contact_stiffness``, N/m, and ``contact_damping``, N s/m, both (2, 2), are the sums over the
    loaded balls between the rings.

    Examples
    --------
    Natural frequency of the inner ring on its shaft without contact, Hz:

    >>> from bearing_twin.dynamics import preset
    >>> stiffness, _ = system_matrices(preset('paper'), np.zeros((2, 2)), np.zeros((2, 2)))
    >>> round(math.sqrt(stiffness[0, 0]) / (2.0 * math.pi))
    548

    """
    springs = [p.inner_stiffness] * 2 + [*p.housing_stiffness]
    dampers = [p.inner_damping] * 2 + [*p.housing_damping]
    stiffness = np.tile(contact_stiffness, (2, 2)) * _COUPLING + np.diag(springs)
    damping = np.tile(contact_damping, (2, 2)) * _COUPLING + np.diag(dampers)
    light = np.array([1.0 / p.inner_mass] * 2 + [1.0 / p.outer_mass] * 2)[:, None]
    return light * stiffness, light * damping


def amplification(
    stiffness: FloatArray, damping: FloatArray, h: float, *, snaps: bool = True
) -> FloatArray:
    """
    Return the matrix of one step of `integrator` for (q, v, a, j, snap) of a linear system.

    With ``snaps`` the predictor uses the snap.

    Examples
    --------
    A mass on a spring with 1 krad/s and a damping ratio of 0.5 % decays as exp(-5 t):

    >>> step = amplification(np.array([[1e6]]), np.array([[10.0]]), 1e-4)
    >>> bool(abs(abs(np.linalg.eigvals(step)).max() - math.exp(-5.0 * 1e-4)) < 1e-8)
    True

    """
    n = len(stiffness)
    # Rows of the state, then predictor, evaluation and corrector of `integrator`.
    q, v, a, j, s = np.eye(5 * n).reshape(5, n, 5 * n)
    ahead = a + h * (j + 0.5 * h * s)
    faster = v + h * (a + 0.5 * h * (j + h / 3.0 * s))
    further = q + h * (v + 0.5 * h * (a + h / 3.0 * (j + 0.25 * h * s)))
    a1 = -stiffness @ further - damping @ faster
    j1 = -stiffness @ faster - damping @ ahead
    v1 = v + 0.5 * h * (a + a1) + h * h / 12.0 * (j - j1)
    q1 = q + 0.5 * h * (v + v1) + h * h / 12.0 * (a - a1)
    s1 = (6.0 / h**2 * (a - a1) + (2.0 * j + 4.0 * j1) / h) * snaps
    return np.vstack([q1, v1, a1, j1, s1])


def steps(p: TwinParameters, sample_rate: float) -> int:
    """
    Return the steps per output sample that resolve the fastest motion.

    This is `filters.least_steps`, or three times as many for stiff or light rings. The equations
    are linearised without contact, and in equilibrium under the load at the temperature with the
    highest contact stiffness. The step must resolve every mode. It must also be stable at
    `_OVERLOAD` times the contact stiffness, and at the stiffness under the unbalance at the
    highest shaft speed. That stiffness is proportional to the cube root of the force, since the
    contact force is proportional to the power 1.5 of the approach.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> steps(preset('incipient', inner_mass=50.0), 25600.0), steps(preset('paper'), 25600.0)
    (1, 3)

    """
    least = filters.least_steps(sample_rate)
    motions = _motions(p, preloaded=False)
    fastest = max(mode for mode, _, _ in motions[:2])
    if p.thermal_mode == 'physical':
        # In the paper's mode both are the same.
        motions = _motions(p, preloaded=True)
    if fastest / (sample_rate * least) <= _GOOD_STEP:
        with contextlib.suppress(BearingTwinError):
            _check(motions, 1.0 / (sample_rate * least))
            return least
    _check(motions, 1.0 / (sample_rate * 3 * least), snaps=False)
    return 3 * least


def _check(motions: _Motions, h: float, *, snaps: bool = True) -> None:
    """Raise an error with frequency and remedy if a step of ``h`` s does not resolve motions."""
    matrices = np.array([amplification(k, c, h, snaps=snaps) for _, k, c in motions])
    radii = np.abs(np.linalg.eigvals(matrices)).max(axis=1)
    for index, (radius, (fastest, _, _)) in enumerate(zip(radii, motions, strict=True)):
        resolved = index >= 2 or fastest * h <= _LARGEST_STEP
        if radius > 1.0 + 1e-9 or not resolved:
            limit = _LARGEST_STEP / h / 2.0 / math.pi
            grows = ', but make it grow' if resolved else ''
            msg = (
                f'the fastest motion of these parameters is at {fastest / 2.0 / math.pi:.0f} Hz, '
                f'and steps of {h * 1e6:.3g} us resolve up to {limit:.0f} Hz{grows}: use larger '
                'masses, less stiffness or damping, or a higher sample rate'
            )
            raise BearingTwinError(msg)


def _motions(p: TwinParameters, *, preloaded: bool) -> _Motions:
    """
    Return fastest mode, rad/s, K and C without contact, in equilibrium and under overload.

    With ``preloaded``, the clearance of the physical mode is at its lower limit.
    """
    constants, out = coefficients.constants_of(p), np.empty(coefficients.CONDITION_SIZE)
    factors = []
    for temperature in TEMPERATURES:
        coefficients.evaluate(constants, float(temperature), float(temperature), 25.0, out)
        factors.append(
            (
                float(out[coefficients.K_B]),
                float(out[coefficients.CLEARANCE]),
                float(out[[coefficients.FOOT_X, coefficients.FOOT_Y]] @ against_load(p)),
            )
        )
    k_b, clearance, spring = max(factors)
    contact, held = Contact(k_b, 0.0), supports(p)
    if preloaded and p.thermal_mode == 'physical':
        clearance, _ = clearance_limits(p.bearing.d_pitch)
        spring = spring_position(p.load, contact, clearance, held, p.bearing.n_balls)
    n = p.bearing.n_balls
    balls = healthy_balls(-math.pi / 2, clearance, n)
    foot = held.aside, spring
    x, y, _, _ = equilibrium(foot, contact, held.compliance, balls, foot)
    _, _, kxx, kxy, kyy = force_and_stiffness(x, y, contact, balls)
    up_x, up_y = against_load(p)
    axes = np.array([[up_y, up_x], [-up_x, up_y]])
    touching = axes @ np.array([[kxx, kxy], [kxy, kyy]]) @ axes.T
    # Half of the balls in contact, equally in all directions: more than in equilibrium.
    damped = 0.5 * n * p.contact_damping * np.eye(2)
    thrown = p.unbalance * (2.0 * math.pi * MAX_SHAFT_HZ) ** 2
    overload = max(_OVERLOAD, (1.0 + thrown / p.load) ** (1.0 / 3.0))
    pairs = [
        system_matrices(p, scale * touching, min(scale, 1.0) * damped)
        for scale in (0.0, 1.0, overload)
    ]
    whole = np.zeros((3, 8, 8))
    whole[:, :4, 4:] = np.eye(4)
    for block, (stiffness, damping) in zip(whole, pairs, strict=True):
        block[4:, :4], block[4:, 4:] = -stiffness, -damping
    fastest = np.abs(np.linalg.eigvals(whole)).max(axis=1)
    return [(float(mode), *pair) for mode, pair in zip(fastest, pairs, strict=True)]
