# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Static equilibrium: where the shaft spring must stand so that the bearing carries its load."""

from __future__ import annotations

import math

from bearing_twin.dynamics.compiled import compiled
from bearing_twin.dynamics.model import contact_law
import numpy as np

__all__ = ['equilibrium', 'spring_position']

_POSITIONS = 8
"""Cage positions over one ball spacing."""


@compiled()
def contact(
    x: float, y: float, c0: float, s0: float, kb: float, clearance: float, n_balls: int
) -> tuple[float, float, float, float, float]:
    """
    Force on the outer ring (x, y), N, and its stiffness (xx, xy, yy), N/m; healthy balls.

    ``c0, s0`` are cosine and sine of the angle of ball 0.
    """
    fx = fy = kxx = kxy = kyy = 0.0
    turn = 2.0 * math.pi / n_balls
    ct, st = math.cos(turn), math.sin(turn)
    c, s = c0, s0
    for _ in range(n_balls):
        delta = x * c + y * s - clearance
        if delta > 0.0:
            force, slope = contact_law(delta, kb)
            fx += force * c
            fy += force * s
            kxx += slope * c * c
            kxy += slope * c * s
            kyy += slope * s * s
        c, s = c * ct - s * st, s * ct + c * st
    return fx, fy, kxx, kxy, kyy


@compiled()
def equilibrium(
    angle: float, spring: float, kb: float, clearance: float, compliance: float, n_balls: int
) -> tuple[float, float, float, float]:
    """
    Return displacement between the rings (x, y), m, and force on the outer ring (x, y), N.

    Solves ``x = -F_x C``, ``y = y_i0 - F_y C`` for one cage angle, with the compliance C = 1/k_i +
    1/k_o of shaft and housing in series, by Newton's method.

    Examples
    --------
    With ball 0 under the load the shaft sinks by 14 um, and the bearing bears 502 N:

    >>> spring = spring_position(500.0, 1.2e10, 5e-6, 1e-8, 8)
    >>> _, y, _, force = equilibrium(-math.pi / 2, spring, 1.2e10, 5e-6, 1e-8, 8)
    >>> round(1e6 * y), round(force)
    (-14, -502)

    """
    x, y = 0.0, spring
    fx = fy = 0.0
    for _ in range(60):
        fx, fy, kxx, kxy, kyy = contact(
            x, y, math.cos(angle), math.sin(angle), kb, clearance, n_balls
        )
        rx, ry = x + fx * compliance, y - spring + fy * compliance
        a, b, d = 1.0 + kxx * compliance, kxy * compliance, 1.0 + kyy * compliance
        determinant = a * d - b * b
        dx, dy = (d * rx - b * ry) / determinant, (a * ry - b * rx) / determinant
        x -= dx
        y -= dy
        if abs(dx) + abs(dy) < 1e-15:
            break
    return x, y, fx, fy


@compiled()
def spring_position(
    load: float, kb: float, clearance: float, compliance: float, n_balls: int
) -> float:
    """
    Position y_i0 of the shaft spring, m, at which the mean contact force is ``load``, N.

    The mean is over the cage positions of one ball spacing. The grounded shaft spring would carry
    most of an applied force; moving its foot instead leaves the load with the bearing. Newton's
    method for the spring and all positions at once.

    Examples
    --------
    >>> round(1e6 * spring_position(500.0, 1.2e10, 5e-6, 1e-8, 8))
    -19

    """
    # A start for Newton's method, from the power 1.5 of the contact law.
    sag = (4.4 * load / (n_balls * kb)) ** (2.0 / 3.0)
    spring = -(max(clearance, 0.0) + sag + load * compliance)
    spacing = 2.0 * math.pi / n_balls
    xs = np.zeros(_POSITIONS)
    ys = np.full(_POSITIONS, -(max(clearance, 0.0) + sag))
    # Far from contact nothing pulls, and Newton's step has to be bounded.
    floor = -0.1 / (compliance + 1.0 / (kb * math.sqrt(sag)))
    for _ in range(100):
        mean = 0.0
        slope = 0.0
        moved = 0.0
        for i in range(_POSITIONS):
            angle = spacing * (i + 0.5) / _POSITIONS
            x, y = xs[i], ys[i]
            fx, fy, kxx, kxy, kyy = contact(
                x, y, math.sin(angle), -math.cos(angle), kb, clearance, n_balls
            )
            rx, ry = x + fx * compliance, y - spring + fy * compliance
            a, b, d = 1.0 + kxx * compliance, kxy * compliance, 1.0 + kyy * compliance
            determinant = a * d - b * b
            dx, dy = (d * rx - b * ry) / determinant, (a * ry - b * rx) / determinant
            xs[i], ys[i] = x - dx, y - dy
            moved = max(moved, abs(dx) + abs(dy))
            # Force after this step, and how it follows the spring.
            mean -= (fy - kxy * dx - kyy * dy) / _POSITIONS
            slope -= (kyy * a - kxy * b) / determinant / _POSITIONS
        change = (load - mean) / min(slope, floor)
        spring += change
        if moved + abs(change) < 1e-14:
            break
    return float(spring)
