# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Static equilibrium: where the shaft spring must stand so that the bearing carries its load."""

from __future__ import annotations

import math

import numba as nb
import numpy as np

__all__ = ['equilibrium', 'spring_position']

_POSITIONS = 16
"""Cage positions over one ball spacing."""


@nb.njit(cache=True)
def equilibrium(angle, spring, kb, clearance, compliance, n_balls, x, y):
    # type: ignore[no-untyped-def]
    """Static displacement between the rings for one cage angle, and the force on the outer ring.

    Solves ``x = -F_x C``, ``y = y_i0 - F_y C`` with the compliance C = 1/k_i + 1/k_o of shaft and
    housing in series, by Newton's method from ``(x, y)``.

    Returns
    -------
    x, y, fx, fy : float
        Displacement, m, and force, N.
    """
    fx = fy = 0.0
    for _ in range(60):
        fx = fy = kxx = kxy = kyy = 0.0
        for j in range(n_balls):
            theta = angle + 2.0 * math.pi * j / n_balls
            c, s = math.cos(theta), math.sin(theta)
            delta = x * c + y * s - clearance
            if delta > 0.0:
                root = math.sqrt(delta)
                force, slope = kb * delta * root, 1.5 * kb * root
                fx += force * c
                fy += force * s
                kxx += slope * c * c
                kxy += slope * c * s
                kyy += slope * s * s
        rx = x + fx * compliance
        ry = y - spring + fy * compliance
        a, b, d = 1.0 + kxx * compliance, kxy * compliance, 1.0 + kyy * compliance
        determinant = a * d - b * b
        dx, dy = (d * rx - b * ry) / determinant, (a * ry - b * rx) / determinant
        x -= dx
        y -= dy
        if abs(dx) + abs(dy) < 1e-15:
            break
    return x, y, fx, fy


@nb.njit(cache=True)
def spring_position(load, kb, clearance, compliance, n_balls):  # type: ignore[no-untyped-def]
    """Position y_i0 of the shaft spring, m, at which the mean contact force is ``load``, N.

    The mean is over the cage positions of one ball spacing. The grounded shaft spring would carry
    most of an applied force; moving its foot instead leaves the load with the bearing.
    """
    sag = (4.4 * load / (n_balls * kb)) ** (2.0 / 3.0)
    spring = -(max(clearance, 0.0) + sag + load * compliance)
    spacing = 2.0 * math.pi / n_balls
    xs = np.zeros(_POSITIONS)
    ys = np.full(_POSITIONS, -(clearance + sag))
    last_spring, last_mean = 0.0, 0.0
    for turn in range(40):
        mean = 0.0
        for i in range(_POSITIONS):
            angle = -0.5 * math.pi + spacing * i / _POSITIONS
            xs[i], ys[i], _, fy = equilibrium(
                angle, spring, kb, clearance, compliance, n_balls, xs[i], ys[i]
            )
            mean -= fy / _POSITIONS
        if abs(mean - load) < 1e-9 * load:
            break
        slope = (mean - last_mean) / (spring - last_spring) if turn else -1.0 / (2.0 * compliance)
        last_spring, last_mean = spring, mean
        spring -= (mean - load) / min(slope, -1e-3 / compliance)
    return spring
