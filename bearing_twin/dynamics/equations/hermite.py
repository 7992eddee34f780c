# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Fourth-order Hermite scheme for both rings: Taylor predictor, corrector and resulting snap.

Positions, velocities, accelerations, jerks and snaps are tuples of four: x_i, y_i, x_o, y_o.
"""

from __future__ import annotations

from bearing_twin.numerics.compiled import compiled, FAST

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
def sum4(a, h, b, k, c, m, d):
    """Return ``a + h b + k c + m d``."""
    return (
        (a[0] + h * b[0]) + (k * c[0] + m * d[0]),
        (a[1] + h * b[1]) + (k * c[1] + m * d[1]),
        (a[2] + h * b[2]) + (k * c[2] + m * d[2]),
        (a[3] + h * b[3]) + (k * c[3] + m * d[3]),
    )


@compiled(inline=True, fast=FAST)
def taylor(h, q, v, a, j, s):
    """Return positions, velocities and accelerations after ``h`` s from their Taylor series."""
    ahead = sum2(h, a, sum2(0.5 * h, j, s))
    faster = sum2(h, v, sum2(0.5 * h, a, sum2(h / 3.0, j, s)))
    further = sum2(h, q, sum2(0.5 * h, v, sum2(h / 3.0, a, sum2(0.25 * h, j, s))))
    return further, faster, ahead


@compiled(inline=True, fast=FAST)
def correct(h, q, v, a, j, a1, j1):
    """Return positions and velocities at the end of a step from Hermite's corrector."""
    half, twelfth = 0.5 * h, h * h / 12.0
    v1 = sum3(v, half, sum2(1.0, a, a1), twelfth, sum2(-1.0, j, j1))
    return sum3(q, half, sum2(1.0, v, v1), twelfth, sum2(-1.0, a, a1)), v1


@compiled(inline=True, fast=FAST)
def snap(h, a, j, a1, j1):
    """Return the snap at the end: second derivative of the cubic through accelerations, jerks."""
    fallen = sum2(-1.0, a, a1)
    return sum3(sum2(6.0 / (h * h), ZERO, fallen), 2.0 / h, j, 4.0 / h, j1)
