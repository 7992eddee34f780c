# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Hermite's scheme of order 4 for both rings: Taylor predictor, corrector and the snap they imply.

Positions, velocities, accelerations, jerks and snaps are tuples of four: x_i, y_i, x_o, y_o.
"""

from __future__ import annotations

from bearing_twin.dynamics.compiled import compiled, FAST

ZERO = (0.0, 0.0, 0.0, 0.0)


@compiled(inline=True, fast=FAST)
def sum2(h, a, b):
    """Return ``a + h b``."""
    return (a[0] + h * b[0], a[1] + h * b[1], a[2] + h * b[2], a[3] + h * b[3])


@compiled(inline=True, fast=FAST)
def sum3(a, h, b, k, c):
    """Return ``a + h b + k c``."""
    return (
        a[0] + h * b[0] + k * c[0],
        a[1] + h * b[1] + k * c[1],
        a[2] + h * b[2] + k * c[2],
        a[3] + h * b[3] + k * c[3],
    )


@compiled(inline=True, fast=FAST)
def sum4(g, a, h, b, k, c, m, d):
    """Return ``g a + h b + k c + m d``."""
    return (
        (g * a[0] + h * b[0]) + (k * c[0] + m * d[0]),
        (g * a[1] + h * b[1]) + (k * c[1] + m * d[1]),
        (g * a[2] + h * b[2]) + (k * c[2] + m * d[2]),
        (g * a[3] + h * b[3]) + (k * c[3] + m * d[3]),
    )


@compiled(inline=True, fast=FAST)
def taylor(h, q, v, a, j, s):
    """Taylor series of positions, velocities and accelerations."""
    ahead = sum2(h, a, sum2(0.5 * h, j, s))
    faster = sum2(h, v, sum2(0.5 * h, a, sum2(h / 3.0, j, s)))
    further = sum2(h, q, sum2(0.5 * h, v, sum2(h / 3.0, a, sum2(0.25 * h, j, s))))
    return further, faster, ahead


@compiled(inline=True, fast=FAST)
def correct(h, q, v, a, j, a1, j1):
    """Hermite's corrector: positions and velocities at the end."""
    half, twelfth = 0.5 * h, h * h / 12.0
    v1 = (
        v[0] + half * (a[0] + a1[0]) + twelfth * (j[0] - j1[0]),
        v[1] + half * (a[1] + a1[1]) + twelfth * (j[1] - j1[1]),
        v[2] + half * (a[2] + a1[2]) + twelfth * (j[2] - j1[2]),
        v[3] + half * (a[3] + a1[3]) + twelfth * (j[3] - j1[3]),
    )
    q1 = (
        q[0] + half * (v[0] + v1[0]) + twelfth * (a[0] - a1[0]),
        q[1] + half * (v[1] + v1[1]) + twelfth * (a[1] - a1[1]),
        q[2] + half * (v[2] + v1[2]) + twelfth * (a[2] - a1[2]),
        q[3] + half * (v[3] + v1[3]) + twelfth * (a[3] - a1[3]),
    )
    return q1, v1


@compiled(inline=True, fast=FAST)
def snap(h, a, j, a1, j1):
    """Second derivative, at the end, of the cubic through accelerations and jerks."""
    six, two, four = 6.0 / (h * h), 2.0 / h, 4.0 / h
    return (
        six * (a[0] - a1[0]) + two * j[0] + four * j1[0],
        six * (a[1] - a1[1]) + two * j[1] + four * j1[1],
        six * (a[2] - a1[2]) + two * j[2] + four * j1[2],
        six * (a[3] - a1[3]) + two * j[3] + four * j1[3],
    )
