# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The paper's numbered equations, as printed and as read.

The numbers are those of the paper: 1 to 8 of section 2, 9 to 12 the fault frequencies, 13 to 19
section 3.1, 20 and 21 hardness, 22 and 23 friction, 24 and 25 all factors together.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING

from bearing_twin.paper import settings
from bearing_twin.thermal import gcr15
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


FloatArray = npt.NDArray[np.float64]


def cage_speed(shaft_speed: float, d: float, D: float) -> float:
    """Equation 1, ``omega_c = omega_s/2 (1 - d/D)``, rad/s."""
    return 0.5 * shaft_speed * (1.0 - d / D)


def ball_angles(n_balls: int, cage_angle: float) -> FloatArray:
    """Equation 2, ``theta_i = 2 pi (i - 1)/Z + omega_c t + phi_0``, rad, shape (n_balls,)."""
    return np.asarray(2.0 * math.pi * np.arange(n_balls) / n_balls + cage_angle)


def deformation_eq5(x: float, y: float, theta: FloatArray, clearance: float) -> FloatArray:
    """Equation 5, m: angles counted from the vertical, ``x sin + y cos - c_r``."""
    return np.asarray(x * np.sin(theta) + y * np.cos(theta) - clearance)


def deformation_eq8(
    x: float, y: float, theta: FloatArray, clearance: float, depth: FloatArray | float = 0.0
) -> FloatArray:
    """
    Bracket of equation 8, m: angles from the horizontal, ``x cos + y sin - c_r - b C_d``.

    ``depth`` is b C_d per ball; equations 3 and 4 define x and y as inner minus outer ring.
    """
    return np.asarray(x * np.cos(theta) + y * np.sin(theta) - clearance - depth)


def ball_forces(deformation: FloatArray, k_b: float) -> FloatArray:
    """
    Equation 6 as read, N: ``K max(delta, 0)^1.5``, since a ball cannot pull.

    As printed there is no ``max``: NaN for every ball that is not loaded.
    """
    return np.asarray(k_b * np.maximum(deformation, 0.0) ** 1.5)


def total_force(
    x: float, y: float, theta: FloatArray, clearance: float, k_b: float,
    depth: FloatArray | float = 0.0,
) -> tuple[float, float]:  # fmt: skip
    """Equation 8 as read: (F_X, F_Y), N, one deformation per ball used in both components."""
    force = ball_forces(deformation_eq8(x, y, theta, clearance, depth), k_b)
    return float(force @ np.cos(theta)), float(force @ np.sin(theta))


def forces_as_printed(
    x: float, y: float, theta: FloatArray, clearance: float, k_b: float
) -> tuple[float, float]:
    """
    Equation 7 as printed, N, but with ``max(., 0)``.

    F_X takes the deformation of equation 8 and projects with sin; F_Y takes that of equation 5
    and projects with cos.
    """
    f_x = ball_forces(deformation_eq8(x, y, theta, clearance), k_b) @ np.sin(theta)
    f_y = ball_forces(deformation_eq5(x, y, theta, clearance), k_b) @ np.cos(theta)
    return float(f_x), float(f_y)


def inner_frequency(bearing: Bearing, shaft_hz: float) -> float:
    """Equation 9, ``f_in = f_r/2 N_b (1 + d/D cos alpha)``, Hz."""
    return 0.5 * shaft_hz * bearing.n_balls * (1.0 + bearing.gamma)


def outer_frequency(bearing: Bearing, shaft_hz: float) -> float:
    """Equation 10, ``f_out = f_r/2 N_b (1 - d/D cos alpha)``, Hz."""
    return 0.5 * shaft_hz * bearing.n_balls * (1.0 - bearing.gamma)


def ball_frequency(bearing: Bearing, shaft_hz: float) -> float:
    """Equation 11, Hz, with the parenthesis ``1 - (d cos alpha / D)^2`` that was lost in print."""
    return shaft_hz * bearing.d_pitch / (2.0 * bearing.d_ball) * (1.0 - bearing.gamma**2)


def cage_frequency(bearing: Bearing, shaft_hz: float) -> float:
    """Equation 12, ``f_c = f_r/2 (1 - d/D cos alpha)``, Hz."""
    return 0.5 * shaft_hz * (1.0 - bearing.gamma)


def expansion_term(temperature: float) -> float:
    """``alpha(T) (T - T0)`` of equation 14, literally, with table 1 in 10^-5/K."""
    return gcr15.alpha(temperature) * (temperature - 20.0)


def alpha_strain(temperature: float) -> float:
    """
    Strain from equation 13 with an instantaneous coefficient: integral of alpha.

    The trapezoid rule over table 1 is exact, because the table is interpolated linearly.
    """
    nodes = gcr15.TEMPERATURES[temperature > gcr15.TEMPERATURES]
    t = np.append(nodes, temperature)
    values = np.interp(t, gcr15.TEMPERATURES, gcr15.EXPANSION_TABLE)
    return float(0.5 * (values[1:] + values[:-1]) @ np.diff(t)) * 1e-5


@functools.cache
def beta0(
    factor: settings.Factor, temperature: float, delta_mu: float = settings.DELTA_MU
) -> float:
    """Equations 14, 20, 22 and 24: the common factor on K_b and C_d."""
    return settings.factor_of(factor, delta_mu=delta_mu).at(temperature)


def static_force(
    beta_stiffness: FloatArray | float, beta_depth: FloatArray | float, ratio: float
) -> FloatArray:
    """
    Force of one ball, equations 15, 21, 23 and 25, over ``K_b0 approach^1.5``.

    It is ``beta_K (1 - beta_C ratio)^1.5`` with ``ratio = b C_d0 / approach``, and 0 if contact is
    lost. The approach ``x cos + y sin - c_r`` is held constant, as in the paper. With
    ``beta_depth`` = 1 it is the paper's 'single stiffness' curve, with ``beta_stiffness`` = 1 its
    'single damping' curve. F_X and F_Y are this times cos(theta) and sin(theta).
    """
    stiffness, depth = np.broadcast_arrays(
        np.asarray(beta_stiffness, dtype=float), np.asarray(beta_depth, dtype=float)
    )
    return np.asarray(stiffness * np.maximum(1.0 - depth * ratio, 0.0) ** 1.5)


def friction_force_as_printed(temperature: float, ratio: float) -> float:
    """Equation 23 as printed: friction scales K_b, but C_d carries the *hardness* factor."""
    return float(
        static_force(beta0('friction', temperature), beta0('hardness', temperature), ratio)
    )


def resultant_as_printed(f_x: float, f_y: float, angle: float) -> float:
    """
    Equation 17, ``sqrt(F_x^2 + F_y^2 + 2 F_x F_y cos(angle))``, N.

    F_x and F_y are at right angles, so ``angle`` can only be pi/2.
    """
    return math.sqrt(f_x * f_x + f_y * f_y + 2.0 * f_x * f_y * math.cos(angle))
