# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Hermite's scheme of order 4 and the forces of the balls, for a group of a fleet.

All lanes take every branch, so the contact is written with selections.
"""

from __future__ import annotations

from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.fleet_layout import (
    A,
    AN,
    AP,
    BALL,
    BALL_ROWS,
    BX,
    BY,
    C,
    CB,
    CI,
    CO,
    CS,
    FOOT,
    FX,
    FY,
    GAP,
    GX,
    GY,
    HEAVY,
    J,
    JN,
    KB,
    KI,
    KO,
    L,
    LIGHT,
    MAX_SPALLS,
    OMEGA,
    PULL,
    Q,
    QP,
    S,
    SPALL_ROWS,
    SPALLS,
    SS,
    TAKEN,
    TAKEN_RATE,
    TURNING,
    UX,
    UY,
    V,
    VP,
    VX,
    VY,
    X,
    Y,
)
import numpy as np

__all__ = ['balls_alone', 'balls_over_a_spall', 'balls_over_spalls', 'correct', 'predict', 'react']

_F = np.float32
_ZERO, _HALF_, _ONE_HALF = _F(0.0), _F(0.5), _F(1.5)


@compiled(fast=FAST)
def predict(w, h):
    half, third = _F(0.5) * h, h / _F(3.0)
    for d in range(4):
        for i in range(L):
            a, j = w[(A + d) * L + i], w[(J + d) * L + i]
            v = w[(V + d) * L + i]
            w[(AP + d) * L + i] = a + h * j
            w[(VP + d) * L + i] = v + h * (a + half * j)
            w[(QP + d) * L + i] = w[(Q + d) * L + i] + h * (v + half * (a + third * j))
    for i in range(L):
        turning = w[TURNING * L + i]
        x = w[QP * L + i] - w[(QP + 2) * L + i]
        y = w[(QP + 1) * L + i] - w[(QP + 3) * L + i]
        vx = w[VP * L + i] - w[(VP + 2) * L + i]
        vy = w[(VP + 1) * L + i] - w[(VP + 3) * L + i]
        w[X * L + i], w[Y * L + i], w[VX * L + i], w[VY * L + i] = x, y, vx, vy
        w[UX * L + i], w[UY * L + i] = vx + turning * y, vy - turning * x
        ax = w[AP * L + i] - w[(AP + 2) * L + i]
        ay = w[(AP + 1) * L + i] - w[(AP + 3) * L + i]
        w[BX * L + i], w[BY * L + i] = ax + turning * vy, ay - turning * vx
        w[FX * L + i] = _ZERO
        w[FY * L + i] = _ZERO
        w[GX * L + i] = _ZERO
        w[GY * L + i] = _ZERO


@compiled(inline=True, fast=FAST)
def _contact(c, s, gap, gap_rate, x, y, vx, vy, ux, uy, bx, by, kb, cb):
    """Force of a ball along its direction (c, s) and the rate of that, or zeros."""
    delta = x * c + y * s - gap
    closed = delta if delta > _ZERO else _ZERO
    stiff = kb * np.sqrt(closed)
    force = stiff * closed + cb * (vx * c + vy * s)
    rate = _ONE_HALF * stiff * (ux * c + uy * s - gap_rate) + cb * (bx * c + by * s)
    loaded = (delta > _ZERO) & (force > _ZERO)
    return force if loaded else _ZERO, rate if loaded else _ZERO


@compiled(inline=True, fast=FAST)
def _two_balls(w, balls, j, spalls):
    """Add the forces of balls ``j`` and ``j + 1`` and their rates to the sums."""
    number, following = _F(j), _F(j + 1)
    two = balls[j * BALL_ROWS * L : (j + 2) * BALL_ROWS * L]
    first = SPALLS * L
    for i in range(L):
        c0, s0, gap = w[C * L + i], w[S * L + i], w[GAP * L + i]
        pc, ps = two[i], two[L + i]
        qc, qs = two[3 * L + i], two[4 * L + i]
        p_gap, q_gap = gap + two[2 * L + i], gap + two[5 * L + i]
        p_rate = q_rate = _ZERO
        if spalls > 0:
            ball = w[first + BALL * L + i]
            taken, taken_rate = w[first + TAKEN * L + i], w[first + TAKEN_RATE * L + i]
            p_gap += taken if ball == number else _ZERO
            p_rate += taken_rate if ball == number else _ZERO
            q_gap += taken if ball == following else _ZERO
            q_rate += taken_rate if ball == following else _ZERO
        if spalls > 1:
            for k in range(1, MAX_SPALLS):
                more = first + k * SPALL_ROWS * L
                ball = w[more + BALL * L + i]
                taken, taken_rate = w[more + TAKEN * L + i], w[more + TAKEN_RATE * L + i]
                p_gap += taken if ball == number else _ZERO
                p_rate += taken_rate if ball == number else _ZERO
                q_gap += taken if ball == following else _ZERO
                q_rate += taken_rate if ball == following else _ZERO
        x, y, vx, vy = w[X * L + i], w[Y * L + i], w[VX * L + i], w[VY * L + i]
        ux, uy, bx, by = w[UX * L + i], w[UY * L + i], w[BX * L + i], w[BY * L + i]
        kb, cb = w[KB * L + i], w[CB * L + i]
        c, s = c0 * pc - s0 * ps, s0 * pc + c0 * ps
        force, rate = _contact(c, s, p_gap, p_rate, x, y, vx, vy, ux, uy, bx, by, kb, cb)
        d, t = c0 * qc - s0 * qs, s0 * qc + c0 * qs
        other, change = _contact(d, t, q_gap, q_rate, x, y, vx, vy, ux, uy, bx, by, kb, cb)
        w[FX * L + i] += force * c + other * d
        w[FY * L + i] += force * s + other * t
        w[GX * L + i] += rate * c + change * d
        w[GY * L + i] += rate * s + change * t


@compiled(fast=FAST)
def balls_alone(w, balls, n_balls):
    """Add up all balls where there is no spall; ``n_balls`` is even."""
    for j in range(0, n_balls, 2):
        _two_balls(w, balls, j, 0)


@compiled(fast=FAST)
def balls_over_a_spall(w, balls, n_balls):
    """As `balls_alone` with one spall a bearing."""
    for j in range(0, n_balls, 2):
        _two_balls(w, balls, j, 1)


@compiled(fast=FAST)
def balls_over_spalls(w, balls, n_balls):
    """As `balls_alone` with up to `MAX_SPALLS` spalls a bearing."""
    for j in range(0, n_balls, 2):
        _two_balls(w, balls, j, 2)


@compiled(fast=FAST)
def react(w):
    """Accelerations and jerks at the predicted state. Small loops: large ones stay scalar."""
    for i in range(L):
        turning = w[TURNING * L + i]
        fx, fy = w[FX * L + i], w[FY * L + i]
        w[GX * L + i] = w[GX * L + i] - turning * fy
        w[GY * L + i] = w[GY * L + i] + turning * fx
    for i in range(L):
        omega, pull = w[OMEGA * L + i], w[PULL * L + i]
        px, py = pull * w[CS * L + i], pull * w[SS * L + i]
        ki, ci, light = w[KI * L + i], w[CI * L + i], w[LIGHT * L + i]
        x, y = w[QP * L + i], w[(QP + 1) * L + i] - w[FOOT * L + i]
        vx, vy = w[VP * L + i], w[(VP + 1) * L + i]
        ax, ay = w[AP * L + i], w[(AP + 1) * L + i]
        w[AN * L + i] = (px - w[FX * L + i] - ki * x - ci * vx) * light
        w[(AN + 1) * L + i] = (py - w[FY * L + i] - ki * y - ci * vy) * light
        w[JN * L + i] = (-omega * py - w[GX * L + i] - ki * vx - ci * ax) * light
        w[(JN + 1) * L + i] = (omega * px - w[GY * L + i] - ki * vy - ci * ay) * light
    for i in range(L):
        ko, co, heavy = w[KO * L + i], w[CO * L + i], w[HEAVY * L + i]
        vx, vy = w[(VP + 2) * L + i], w[(VP + 3) * L + i]
        ax, ay = w[(AP + 2) * L + i], w[(AP + 3) * L + i]
        w[(AN + 2) * L + i] = (w[FX * L + i] - ko * w[(QP + 2) * L + i] - co * vx) * heavy
        w[(AN + 3) * L + i] = (w[FY * L + i] - ko * w[(QP + 3) * L + i] - co * vy) * heavy
        w[(JN + 2) * L + i] = (w[GX * L + i] - ko * vx - co * ax) * heavy
        w[(JN + 3) * L + i] = (w[GY * L + i] - ko * vy - co * ay) * heavy


@compiled(fast=FAST)
def correct(w, h):
    """Hermite's corrector."""
    half, twelfth = _HALF_ * h, h * h / _F(12.0)
    for d in range(4):
        for i in range(L):
            a, b = w[(A + d) * L + i], w[(AN + d) * L + i]
            v, j = w[(V + d) * L + i], w[(JN + d) * L + i]
            faster = v + (half * (a + b) + twelfth * (w[(J + d) * L + i] - j))
            w[(Q + d) * L + i] += half * (v + faster) + twelfth * (a - b)
            w[(V + d) * L + i], w[(A + d) * L + i], w[(J + d) * L + i] = faster, b, j
