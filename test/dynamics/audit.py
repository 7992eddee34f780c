# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The paper's model, written a second time: closed formulas and RK4, no code of the twin.

Everything is typed here from the paper and from docs/paper.md: geometry, tables, beta0, the four
equations of motion, the path of a ball over a spall. ``python test/dynamics/audit.py`` prints the
trends; ``test_audit.py`` holds the twin to them.
"""

from __future__ import annotations

import functools
import math

from numba import njit
import numpy as np
from scipy.optimize import brentq

Z, BALL, PITCH = 8, 14e-3, 57.5e-3
K_B0 = 1.228e10
"""Hertz, 6307: ball of 13.494 mm, conformities 0.515 and 0.525, N/m^1.5; within 0.1 %."""
INNER, SHAFT_K, SHAFT_C = 6.2638, 7.42e7, 4000.0
OUTER, HOUSING_K, HOUSING_C = 12.638, 1.51e7, 2210.7
CONTACT_C, CLEARANCE, LOAD = 1200.0, 5e-6, 3200.0
RATE = 25600.0
WIDTH, DEPTH = 2.45e-3, 80e-6
DOWN = -0.5 * math.pi
PLACES = ('inner', 'outer', 'ball')
STEPS = 4
"""Steps a sample: twelve times as many change the signal by up to 3e-4 at 25.6 kHz."""
TABLES = {20.0: (5.0, 67.1, 0.0150), 110.0: (16.0, 62.4, 0.1030)}
"""Tables 1 to 3 at the ends of the range."""


def beta0(temperature: float, factors: str) -> float:
    """Equation 24 with weights 0.10 and 0.02; ``factors`` of 'e', 'h', 'f'."""
    alpha, hardness, friction = TABLES[temperature]
    value = 1.0
    if 'e' in factors:
        value += alpha * 1e-5 * (temperature - 20.0)
    if 'h' in factors:
        value += 0.10 * (hardness - 63.6) / 63.6
    if 'f' in factors:
        value += 0.02 * (friction - 0.0150) / 0.0150
    return value


@njit
def path(distance: float, bent: float) -> float:
    """
    Depth to which a ball sinks, m, at ``distance`` (m) from the middle of the spall.

    ``bent`` is the curvature of the race, 1/m, above zero where it bends away from the ball.
    """
    edge = 0.5 * WIDTH - abs(distance)
    if edge <= 0.0:
        return 0.0
    return min(DEPTH, edge * edge * (1.0 / BALL + bent))


@njit
def aside(angle: float, radius: float) -> float:
    """Length of the shorter arc from zero to ``angle``, m."""
    return radius * (angle - 2.0 * math.pi * round(angle / (2.0 * math.pi)))


@njit
def sunk(places: np.ndarray, ball: int, at: float, shaft: float, spin: float) -> float:
    """
    Depth to which a ball has sunk into the spalls of the places of `PLACES` that are true, m.

    The angles are those of the ball, of the shaft since the start and of the balls' spin, rad.
    The spall of the inner race begins at the bottom, that of the outer one is there; the one of
    a ball is on ball 0, which meets the inner race with it at the start.
    """
    inner, outer = 1.0 / (PITCH - BALL), -1.0 / (PITCH + BALL)
    depth = 0.0
    if places[0]:
        depth += path(aside(at - shaft - DOWN, 0.5 * (PITCH - BALL)), inner)
    if places[1]:
        depth += path(aside(at - DOWN, 0.5 * (PITCH + BALL)), outer)
    if places[2] and ball == 0:
        depth += path(aside(spin, 0.5 * BALL), inner)
        depth += path(aside(spin - math.pi, 0.5 * BALL), outer)
    return depth


@njit
def turned(t: float, omega: float, braked: float) -> float:
    """Return the angle of the shaft since the start, rad."""
    if t < braked:
        return omega * t
    if t < 2.0 * braked:
        return omega * (t - 0.5 * (t - braked) ** 2 / braked)
    return omega * (1.5 * braked + 0.5 * (t - 2.0 * braked) ** 2 / braked)


@njit
def rates(t, q, foot, beta, clearance, omega, braked, places):  # type: ignore[no-untyped-def]
    """Time derivative of positions and velocities of inner ring and housing, along x and y."""
    gamma = BALL / PITCH
    x, y = q[0] - q[2], q[1] - q[3]
    vx, vy = q[4] - q[6], q[5] - q[7]
    fx = fy = 0.0
    shaft = turned(t, omega, braked)
    cage, spin = 0.5 * shaft * (1.0 - gamma), 0.5 * shaft * (1.0 - gamma**2) / gamma
    for k in range(Z):
        angle = cage + 2.0 * math.pi / Z * k + DOWN
        c, s = math.cos(angle), math.sin(angle)
        delta = x * c + y * s - clearance
        if delta > 0.0:
            delta -= beta * sunk(places, k, angle, shaft, spin)
        if delta > 0.0:
            force = beta * K_B0 * delta * math.sqrt(delta) + CONTACT_C * (vx * c + vy * s)
            if force > 0.0:
                fx += force * c
                fy += force * s
    return np.array([
        q[4], q[5], q[6], q[7],
        (-fx - SHAFT_K * (q[0] - foot[0]) - SHAFT_C * q[4]) / INNER,
        (-fy - SHAFT_K * (q[1] - foot[1]) - SHAFT_C * q[5]) / INNER,
        (fx - HOUSING_K * q[2] - HOUSING_C * q[6]) / OUTER,
        (fy - HOUSING_K * q[3] - HOUSING_C * q[7]) / OUTER,
    ])  # fmt: skip


@njit
def moved(q, h, rate):  # type: ignore[no-untyped-def]
    """State after ``h`` s at a constant rate."""
    return q + h * rate


@njit
def integrated(samples, rate, q, *given):  # type: ignore[no-untyped-def]
    """Acceleration of the housing from the start on, with the classical Runge-Kutta scheme."""
    out, h = np.empty((2, samples)), 1.0 / (rate * STEPS)
    for step in range(samples * STEPS):
        t = step * h
        one = rates(t, q, *given)
        if step % STEPS == 0:
            out[0, step // STEPS], out[1, step // STEPS] = one[6], one[7]
        two = rates(t + 0.5 * h, moved(q, 0.5 * h, one), *given)
        three = rates(t + 0.5 * h, moved(q, 0.5 * h, two), *given)
        four = rates(t + h, moved(q, h, three), *given)
        for slope, weight in ((one, 1.0), (two, 2.0), (three, 2.0), (four, 1.0)):
            q = moved(q, weight * h / 6.0, slope)
    return out


def spring_foot(beta: float, clearance: float, load: float) -> float:
    """Where the shaft spring has to be held so that healthy balls carry ``load``, m."""
    angles = 2.0 * math.pi * np.arange(Z) / Z - 0.5 * math.pi

    def carried(y: float) -> float:
        delta = np.maximum(y * np.sin(angles) - clearance, 0.0)
        return float(-(beta * K_B0 * delta**1.5 * np.sin(angles)).sum())

    relative = brentq(lambda y: carried(y) - load, -5e-4, 0.0)
    return relative - load * (1.0 / SHAFT_K + 1.0 / HOUSING_K)


@functools.cache
def housing(
    beta: float, shaft_hz: float, seconds: float, *, places: tuple[str, ...] = ('inner',),
    load_angle: float = DOWN, braked: float = math.inf, axis: int = 1,
) -> np.ndarray:  # fmt: skip
    """
    Housing acceleration, m/s^2, along x (axis 0) or y, from t=0.

    From ``braked`` s on the shaft comes to rest with a constant deceleration within as many
    seconds, and goes up to its speed again within as many.
    """
    foot = spring_foot(beta, CLEARANCE, LOAD)
    start, feet = np.zeros(8), np.zeros(2)
    for i, towards in enumerate((math.cos(load_angle), math.sin(load_angle))):
        # The load's direction is that of the springs' foot, which is there at -y in `spring_foot`.
        feet[i] = -foot * towards
        start[2 + i] = LOAD * towards / HOUSING_K
        start[i] = -(foot + LOAD / SHAFT_K) * towards
    damaged = np.array([place in places for place in PLACES])
    omega = 2.0 * math.pi * shaft_hz
    given = feet, beta, CLEARANCE, omega, braked, damaged
    return integrated(int(seconds * RATE), RATE, start, *given)[axis]


def amplitude(y: np.ndarray, shaft_hz: float) -> float:
    """Mean of the largest fifth of the maxima of |a|, one a ball that passes the spall, m/s^2."""
    passing = 0.5 * shaft_hz * Z * (1.0 + BALL / PITCH)
    per_pass = round(RATE / passing)
    whole = len(y) // per_pass * per_pass
    maxima = np.sort(np.abs(y[:whole] - y.mean()).reshape(-1, per_pass).max(axis=1))
    return float(maxima[-(len(maxima) // 5) :].mean())


def change(factors: str, shaft_hz: float) -> float:
    """Relative change of the amplitude from 20 to 110 degC; 0.2 s settle, 0.5 s count."""
    cold, hot = (
        amplitude(housing(beta0(heat, factors), shaft_hz, 0.7)[int(0.2 * RATE) :], shaft_hz)
        for heat in (20.0, 110.0)
    )
    return hot / cold - 1.0


if __name__ == '__main__':
    for hz in (22.0, 25.4, 29.0):
        print(hz, {factors: round(100.0 * change(factors, hz), 2) for factors in ('e', 'h', 'f')})
