# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Static equilibrium, and the position of the shaft spring at which the bearing is loaded."""

from __future__ import annotations

import math

from bearing_twin.dynamics.compiled import compiled
from bearing_twin.dynamics.layout import COS, GAP, SIN
from bearing_twin.dynamics.model import contact_law
import numpy as np
import numpy.typing as npt

__all__ = ['contact', 'equilibrium', 'healthy_balls', 'spring_position']

FloatArray = npt.NDArray[np.float64]

_POSITIONS = 8
"""Cage positions over one ball spacing."""


@compiled()
def healthy_balls(angle: float, clearance: float, n_balls: int) -> FloatArray:
    """Return gaps and directions of balls without defects, ball 0 at ``angle``, rad."""
    balls = np.empty((4, n_balls))
    for k in range(n_balls):
        at = angle + 2.0 * math.pi * k / n_balls
        balls[GAP, k], balls[COS, k], balls[SIN, k] = clearance, math.cos(at), math.sin(at)
    return balls


@compiled()
def contact(
    x: float, y: float, k_b: float, balls: FloatArray
) -> tuple[float, float, float, float, float]:
    """
    Force on the outer ring (x, y), N, and its stiffness (xx, xy, yy), N/m.

    ``x, y`` is the displacement of the inner ring against the outer one, m; ``balls``, float64[4,
    n], have gaps and directions as one step in `layout`.

    Examples
    --------
    One ball of eight, pressed in by 2 um, carries it all:

    >>> force = contact(0.0, -7e-6, 1e10, healthy_balls(-math.pi / 2, 5e-6, 8))
    >>> [round(value, 3) for value in force[:2]]
    [0.0, -28.284]

    """
    fx = fy = kxx = kxy = kyy = 0.0
    for k in range(balls.shape[1]):
        c, s = balls[COS, k], balls[SIN, k]
        delta = x * c + y * s - balls[GAP, k]
        if delta > 0.0:
            force, slope = contact_law(delta, k_b)
            fx += force * c
            fy += force * s
            kxx += slope * c * c
            kxy += slope * c * s
            kyy += slope * s * s
    return fx, fy, kxx, kxy, kyy


@compiled()
def equilibrium(
    spring: float, k_b: float, compliance: float, balls: FloatArray
) -> tuple[float, float, float, float]:
    """
    Return displacement between the rings (x, y), m, and force on the outer ring (x, y), N.

    Solves ``x = -F_x C``, ``y = y_i0 - F_y C``, with the compliance C = 1/k_i + 1/k_o of shaft and
    housing in series, by Newton's method; ``balls`` as `contact` takes them.

    Examples
    --------
    With ball 0 under the load the shaft sinks by 14 um, and the bearing bears 502 N:

    >>> spring = spring_position(500.0, 1.2e10, 5e-6, 1e-8, 8)
    >>> _, y, _, force = equilibrium(spring, 1.2e10, 1e-8, healthy_balls(-math.pi / 2, 5e-6, 8))
    >>> round(1e6 * y), round(force)
    (-14, -502)

    """
    x, y = 0.0, spring
    fx = fy = 0.0
    for _ in range(60):
        fx, fy, kxx, kxy, kyy = contact(x, y, k_b, balls)
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
    balls = np.empty((_POSITIONS, 4, n_balls))
    for i in range(_POSITIONS):
        balls[i] = healthy_balls(
            spacing * (i + 0.5) / _POSITIONS - 0.5 * math.pi, clearance, n_balls
        )
    # Far from contact nothing pulls, and Newton's step has to be bounded.
    floor = -0.1 / (compliance + 1.0 / (kb * math.sqrt(sag)))
    for _ in range(100):
        mean = 0.0
        slope = 0.0
        moved = 0.0
        for i in range(_POSITIONS):
            x, y = xs[i], ys[i]
            fx, fy, kxx, kxy, kyy = contact(x, y, kb, balls[i])
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
