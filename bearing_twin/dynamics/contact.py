# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Forces of the balls and what they do to both rings.

A ball is loaded while it is closer than its gap and its force presses; loaded balls are the bits
of an integer. Its force begins and ends with a singularity of the power 1.5, and with a step where
there is contact damping. How near that is, in time, is ``near``: the least of delta / |delta'|
over the loaded balls, at most `FAR`.
"""

from __future__ import annotations

import math

from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.layout import (
    CB,
    CI,
    CO,
    COS,
    FOOT,
    GAP,
    GAP_RATE,
    KI,
    KO,
    MI,
    MO,
    PULL,
    SIN,
    STIFF,
    TURNING,
)  # fmt: skip

__all__ = ['FAR', 'IN_ORDER', 'MASKED', 'motion', 'motion_of', 'press']

IN_ORDER = FAST - {'reassoc'}
"""Without reassociation the sum over the balls stays scalar and skips the unloaded ones, which for
one bearing is faster than vector lanes that have to be added up."""
FAR = 1.0
"""Upper limit of ``near``, s."""
MASKED = 52
"""Balls that have a bit of their own. More share the last one: their contact is then followed with
less accuracy. The state carries the bits as a float, which holds 53 of them."""


@compiled(inline=True, fast=IN_ORDER)
def _contact(table, gaps, i, x, y, vx, vy, ax, ay, cb):
    """Force of the balls on the outer ring, N, its rate, N/s, loaded balls, ``near``."""
    turning, kb = table[i, TURNING], table[i, STIFF]
    fx = 0.0
    fy = 0.0
    gx = 0.0
    gy = 0.0
    touching = 0
    near = FAR
    for k in range(gaps.shape[2]):
        c, s = gaps[i, COS, k], gaps[i, SIN, k]
        delta = x * c + y * s - gaps[i, GAP, k]
        if delta > 0.0:
            v = vx * c + vy * s
            stiff = kb * math.sqrt(delta)
            force = stiff * delta + cb * v
            if force > 0.0:
                closing = v + turning * (y * c - x * s) - gaps[i, GAP_RATE, k]
                rate = 1.5 * stiff * closing + cb * (ax * c + ay * s + turning * (vy * c - vx * s))
                fx += force * c
                fy += force * s
                gx += rate * c
                gy += rate * s
                touching |= 1 << min(k, MASKED)
                if delta < near * abs(closing):
                    near = delta / abs(closing)
    return fx, fy, gx - turning * fy, gy + turning * fx, touching, near


@compiled(inline=True, fast=IN_ORDER)
def _contact_of(table, gaps, i, x, y, vx, vy, ax, ay, cb, touching):
    """As `_contact` for balls that are known to be loaded."""
    turning, kb = table[i, TURNING], table[i, STIFF]
    fx = 0.0
    fy = 0.0
    gx = 0.0
    gy = 0.0
    near = FAR
    for k in range(gaps.shape[2]):
        c, s = gaps[i, COS, k], gaps[i, SIN, k]
        delta = x * c + y * s - gaps[i, GAP, k]
        if touching >> min(k, MASKED) & 1 and (k < MASKED or delta > 0.0):
            delta = max(delta, 0.0)
            v = vx * c + vy * s
            stiff = kb * math.sqrt(delta)
            force = stiff * delta + cb * v
            closing = v + turning * (y * c - x * s) - gaps[i, GAP_RATE, k]
            rate = 1.5 * stiff * closing + cb * (ax * c + ay * s + turning * (vy * c - vx * s))
            fx += force * c
            fy += force * s
            gx += rate * c
            gy += rate * s
            if delta < near * abs(closing):
                near = delta / abs(closing)
    return fx, fy, gx - turning * fy, gy + turning * fx, near


@compiled(inline=True, fast=FAST)
def _rings(table, i, fx, fy, gx, gy, q, v, a, const):
    """Acceleration and jerk of both rings under the balls' force and its rate."""
    ki, ci, ko, co = const[KI], const[CI], const[KO], const[CO]
    light, heavy = 1.0 / const[MI], 1.0 / const[MO]
    return (
        (
            (table[i, PULL] - fx - ki * q[0] - ci * v[0]) * light,
            (table[i, PULL + 1] - fy - ki * (q[1] - table[i, FOOT]) - ci * v[1]) * light,
            (fx - ko * q[2] - co * v[2]) * heavy,
            (fy - ko * q[3] - co * v[3]) * heavy,
        ),
        (
            (table[i, PULL + 2] - gx - ki * v[0] - ci * a[0]) * light,
            (table[i, PULL + 3] - gy - ki * v[1] - ci * a[1]) * light,
            (gx - ko * v[2] - co * a[2]) * heavy,
            (gy - ko * v[3] - co * a[3]) * heavy,
        ),
    )


@compiled(inline=True, fast=FAST)
def motion(table, gaps, i, q, v, a, const):
    """Acceleration and jerk of both rings, loaded balls and ``near``."""
    fx, fy, gx, gy, touching, near = _contact(
        table, gaps, i, q[0] - q[2], q[1] - q[3], v[0] - v[2], v[1] - v[3], a[0] - a[2],
        a[1] - a[3], const[CB],
    )  # fmt: skip
    a1, j1 = _rings(table, i, fx, fy, gx, gy, q, v, a, const)
    return a1, j1, touching, near


@compiled(fast=FAST, borrows=True)
def motion_of(table, gaps, i, q, v, a, const, touching):
    """As `motion` for balls that are known to be loaded: the limit on one side of an event."""
    fx, fy, gx, gy, near = _contact_of(
        table, gaps, i, q[0] - q[2], q[1] - q[3], v[0] - v[2], v[1] - v[3], a[0] - a[2],
        a[1] - a[3], const[CB], touching,
    )  # fmt: skip
    a1, j1 = _rings(table, i, fx, fy, gx, gy, q, v, a, const)
    return a1, j1, near


@compiled(inline=True, fast=IN_ORDER)
def press(table, gaps, i, k, x, y, vx, vy, cb):
    """
    Tell how firmly ball ``k`` is loaded: positive exactly where it is, continuous, zero between.

    The lesser of its force, N, and its approach, m, times a stiffness.
    """
    c, s = gaps[i, COS, k], gaps[i, SIN, k]
    delta = x * c + y * s - gaps[i, GAP, k]
    force = cb * (vx * c + vy * s)
    if delta > 0.0:
        force += table[i, STIFF] * delta * math.sqrt(delta)
    return min(force, _PER_METRE * delta)


_PER_METRE = 1e8
