# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Static equilibrium, and the position of the shaft spring that loads the bearing.

In the load's frame the load acts along -y; the x axis is 90 degrees clockwise from the y axis. For
a load that acts downwards this frame equals that of the equations.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.dynamics.equations.layout import COS, GAP, SIN
from bearing_twin.dynamics.equations.model import Contact, contact_law
from bearing_twin.numerics.compiled import compiled
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters


FloatArray = npt.NDArray[np.float64]
Symmetric = tuple[float, float, float]
"""Elements xx, xy and yy of a matrix."""

_POSITIONS = 8
"""Cage positions over one ball spacing, for the mean force."""


class Supports(NamedTuple):
    """Shaft and housing in series, in the load's frame."""

    compliance: Symmetric
    """Compliance matrix, m/N."""
    aside: float
    """Position of the spring foot across the load, m. It compensates the lateral deflection under
    the load, so that the mean bearing force has the direction of the load."""


def against_load(p: TwinParameters) -> tuple[float, float]:
    """
    Return the direction (cos, sin) against the load; rounding errors at right angles are removed.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> against_load(preset('paper'))
    (0.0, 1.0)

    """
    return 0.0 - round(math.cos(p.load_angle), 15), 0.0 - round(math.sin(p.load_angle), 15)


def supports(p: TwinParameters) -> Supports:
    """
    Return the compliance of shaft and housing in the load's frame.

    Examples
    --------
    A housing that is soft horizontally deflects across a load that acts at 45 degrees:

    >>> from bearing_twin.dynamics import preset
    >>> soft = preset('paper', outer_stiffness_x=1e6, load_angle=-math.pi / 4)
    >>> round(1e3 * supports(soft).aside, 2)
    1.49

    """
    up_x, up_y = against_load(p)
    x, y = (1.0 / p.inner_stiffness + 1.0 / stiffness for stiffness in p.housing_stiffness)
    across = up_y * up_y * x + up_x * up_x * y
    skew = up_x * up_y * (x - y)
    along = up_x * up_x * x + up_y * up_y * y
    return Supports((across, skew, along), -skew * p.load)


@compiled()
def healthy_balls(angle: float, clearance: float, n_balls: int) -> FloatArray:
    """Return gaps and directions of balls without defects, ball 0 at ``angle``, rad."""
    balls = np.empty((4, n_balls))
    for k in range(n_balls):
        at = angle + 2.0 * math.pi * k / n_balls
        balls[GAP, k], balls[COS, k], balls[SIN, k] = clearance, math.cos(at), math.sin(at)
    return balls


@compiled()
def force_and_stiffness(
    x: float, y: float, contact: Contact, balls: FloatArray
) -> tuple[float, float, float, float, float]:
    """
    Return the force on the outer ring (x, y), N, and the stiffness (xx, xy, yy), N/m.

    ``x, y`` is the displacement of the inner ring relative to the outer ring, m. ``balls``,
    float64[4, n], has gaps and directions in the rows of `layout`.

    Examples
    --------
    One of eight balls, with an approach of 2 um, carries the whole load:

    >>> contact, balls = Contact(k_b=1e10, damping=0.0), healthy_balls(-math.pi / 2, 5e-6, 8)
    >>> force = force_and_stiffness(0.0, -7e-6, contact, balls)
    >>> [round(value, 3) for value in force[:2]]
    [0.0, -28.284]

    """
    fx = fy = kxx = kxy = kyy = 0.0
    for k in range(balls.shape[1]):
        c, s = balls[COS, k], balls[SIN, k]
        delta = x * c + y * s - balls[GAP, k]
        if delta > 0.0:
            force, slope = contact_law(delta, contact)
            fx += force * c
            fy += force * s
            kxx += slope * c * c
            kxy += slope * c * s
            kyy += slope * s * s
    return fx, fy, kxx, kxy, kyy


@compiled()
def equilibrium(
    foot: tuple[float, float],
    contact: Contact,
    compliance: Symmetric,
    balls: FloatArray,
    start: tuple[float, float],
) -> tuple[float, float, float, float]:
    """
    Return displacement between the rings (x, y), m, and force on the outer ring (x, y), N.

    Solves ``(x, y) = foot - C F``, with the ``compliance`` C of shaft and housing in series, by
    Newton's method from ``start``; ``balls`` as in `force_and_stiffness`. With soft supports and
    stiff contacts Newton's steps may oscillate forever. Therefore a step is halved while the slope
    of the energy, which is convex, at its end exceeds half the descent at its start.

    Examples
    --------
    With ball 0 under the load the shaft sinks by 14 um, and the bearing carries 502 N:

    >>> stiff = Supports((1e-8, 0.0, 1e-8), 0.0)
    >>> contact = Contact(k_b=1.2e10, damping=0.0)
    >>> foot = 0.0, spring_position(500.0, contact, 5e-6, stiff, 8)
    >>> balls = healthy_balls(-math.pi / 2, 5e-6, 8)
    >>> _, y, _, force = equilibrium(foot, contact, stiff.compliance, balls, start=foot)
    >>> round(1e6 * y), round(force)
    (-14, -502)

    """
    cxx, cxy, cyy = compliance
    both = cxx * cyy - cxy * cxy
    x, y = start
    fx = fy = dx = dy = fall = 0.0
    for _ in range(300):
        fx, fy, kxx, kxy, kyy = force_and_stiffness(x, y, contact, balls)
        rx, ry = x - foot[0] + fx * cxx + fy * cxy, y - foot[1] + fy * cyy + fx * cxy
        gx, gy = (cyy * rx - cxy * ry) / both, (cxx * ry - cxy * rx) / both
        if gx * dx + gy * dy < -0.5 * fall:
            dx, dy, fall = 0.5 * dx, 0.5 * dy, 0.5 * fall
            x += dx
            y += dy
            continue
        a, b = 1.0 + kxx * cxx + kxy * cxy, kxy * cxx + kyy * cxy
        c, d = kxy * cyy + kxx * cxy, 1.0 + kyy * cyy + kxy * cxy
        determinant = a * d - b * c
        dx, dy = (d * rx - b * ry) / determinant, (a * ry - c * rx) / determinant
        fall = gx * dx + gy * dy
        x -= dx
        y -= dy
        if abs(dx) + abs(dy) < 1e-15:
            break
    return x, y, fx, fy


@compiled()
def spring_position(
    load: float, contact: Contact, clearance: float, held: Supports, n_balls: int
) -> float:
    """
    Return the position y_i0 of the shaft spring, m, at which the mean contact force is ``load``.

    The position is in the load's frame; ``load`` is in N, ``held`` are the supports.

    The mean is over the cage positions of one ball spacing. The grounded shaft spring would carry
    most of an applied force; with a displaced foot the bearing carries the load. The solution is
    by Newton's method on the mean force, which is convex in the depth of the foot.

    Examples
    --------
    >>> stiff = Supports((1e-8, 0.0, 1e-8), 0.0)
    >>> round(1e6 * spring_position(500.0, Contact(1.2e10, 0.0), 5e-6, stiff, 8))
    -19

    """
    # Start of Newton's method from the power 1.5 of the contact law.
    sag = (4.4 * load / (n_balls * contact.k_b)) ** (2.0 / 3.0)
    cxx, cxy, cyy = held.compliance
    spring = -(max(clearance, 0.0) + sag + load * cyy)
    spacing = 2.0 * math.pi / n_balls
    at = [(0.0, -(max(clearance, 0.0) + sag)) for _ in range(_POSITIONS)]
    balls = [
        healthy_balls(spacing * (i + 0.5) / _POSITIONS - 0.5 * math.pi, clearance, n_balls)
        for i in range(_POSITIONS)
    ]
    # Without contact there is no slope, and Newton's step has to be limited.
    floor = -0.1 / (cyy + 1.0 / (contact.k_b * math.sqrt(sag)))
    for _ in range(100):
        mean = slope = 0.0
        for i in range(_POSITIONS):
            x, y, _, _ = equilibrium(
                (held.aside, spring), contact, held.compliance, balls[i], at[i]
            )
            _, fy, kxx, kxy, kyy = force_and_stiffness(x, y, contact, balls[i])
            a, b = 1.0 + kxx * cxx + kxy * cxy, kxy * cxx + kyy * cxy
            c, d = kxy * cyy + kxx * cxy, 1.0 + kyy * cyy + kxy * cxy
            # Derivative of the mean force with respect to the spring position.
            slope -= (kyy * a - kxy * b) / (a * d - b * c) / _POSITIONS
            mean -= fy / _POSITIONS
            at[i] = x, y
        change = (load - mean) / min(slope, floor)
        spring += change
        if abs(change) < 1e-14:
            break
    return float(spring)
