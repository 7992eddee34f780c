# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The paper's model, written a second time: closed formulas and scipy, no code of the twin.

Everything is typed here from the paper and from docs/paper.md: geometry, tables, beta0, the four
equations of motion, the path of a ball over a spall. ``python test/dynamics/audit.py`` prints the
trends; ``test_audit.py`` holds the twin to them.
"""

from __future__ import annotations

import functools
import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

Z, BALL, PITCH = 8, 14e-3, 57.5e-3
K_B0 = 1.228e10
"""Hertz, 6307: ball of 13.494 mm, conformities 0.515 and 0.525, N/m^1.5; within 0.1 %."""
INNER, SHAFT_K, SHAFT_C = 6.2638, 7.42e7, 4000.0
OUTER, HOUSING_K, HOUSING_C = 12.638, 1.51e7, 2210.7
CONTACT_C, CLEARANCE, LOAD = 1200.0, 5e-6, 3200.0
WIDTH, DEPTH = 2.45e-3, 80e-6
DOWN = -0.5 * math.pi
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


def path(distance: float, race: str = 'inner') -> float:
    """Depth to which a ball sinks, m, at ``distance`` (m) from the middle of the spall."""
    edge = 0.5 * WIDTH - abs(distance)
    if edge <= 0.0:
        return 0.0
    bent = 1.0 / (PITCH - BALL) if race == 'inner' else -1.0 / (PITCH + BALL)
    return min(DEPTH, edge * edge * (1.0 / BALL + bent))


def sunk(place: str, ball: int, angles: tuple[float, float, float]) -> float:
    """
    Depth to which a ball has sunk into the spall of one place, m.

    ``angles`` are those of the ball, of the shaft since the start and of the balls' spin, rad.
    The spall of the inner race begins at the bottom, that of the outer one is there; the one of
    a ball is on ball 0, which meets the inner race with it at the start.
    """
    at, shaft, spin = angles

    def aside(angle: float, radius: float) -> float:
        return radius * math.remainder(angle, 2.0 * math.pi)

    if place == 'inner':
        return path(aside(at - shaft - DOWN, 0.5 * (PITCH - BALL)))
    if place == 'outer':
        return path(aside(at - DOWN, 0.5 * (PITCH + BALL)), 'outer')
    if ball:
        return 0.0
    met = path(aside(spin, 0.5 * BALL))
    return met + path(aside(spin - math.pi, 0.5 * BALL), 'outer')


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
    beta: float, shaft_hz: float, seconds: float, *, clearance: float = CLEARANCE,
    load: float = LOAD, rate: float = 25600.0, places: tuple[str, ...] = ('inner',),
    load_angle: float = DOWN, braked: float | None = None, axis: int = 1,
) -> np.ndarray:  # fmt: skip
    """
    Housing acceleration, m/s^2, along x (axis 0) or y, from t=0.

    From ``braked`` s on the shaft comes to rest with a constant deceleration within as many
    seconds, and goes up to its speed again within as many.
    """
    gamma = BALL / PITCH
    foot = spring_foot(beta, clearance, load)
    # The load's direction is that of the springs' foot, which is there at -y in `spring_foot`.
    foot_x, foot_y = -foot * math.cos(load_angle), -foot * math.sin(load_angle)
    spacing = 2.0 * math.pi / Z

    def turned(t: float) -> float:
        """Return the angle of the shaft since the start, rad."""
        omega = 2.0 * math.pi * shaft_hz
        if braked is None or t < braked:
            return omega * t
        if t < 2.0 * braked:
            return omega * (t - 0.5 * (t - braked) ** 2 / braked)
        return omega * (1.5 * braked + 0.5 * (t - 2.0 * braked) ** 2 / braked)

    def forces(t: float, q: np.ndarray) -> tuple[float, float]:
        x, y = q[0] - q[2], q[1] - q[3]
        vx, vy = q[4] - q[6], q[5] - q[7]
        fx = fy = 0.0
        shaft = turned(t)
        cage, spin = 0.5 * shaft * (1.0 - gamma), 0.5 * shaft * (1.0 - gamma**2) / gamma
        for k in range(Z):
            angle = cage + spacing * k + DOWN
            c, s = math.cos(angle), math.sin(angle)
            delta = x * c + y * s - clearance
            if delta > 0.0:
                delta -= beta * sum(sunk(place, k, (angle, shaft, spin)) for place in places)
            if delta > 0.0:
                force = beta * K_B0 * delta * math.sqrt(delta) + CONTACT_C * (vx * c + vy * s)
                if force > 0.0:
                    fx += force * c
                    fy += force * s
        return fx, fy

    def rates(t: float, q: np.ndarray) -> list[float]:
        fx, fy = forces(t, q)
        return [
            q[4], q[5], q[6], q[7],
            (-fx - SHAFT_K * (q[0] - foot_x) - SHAFT_C * q[4]) / INNER,
            (-fy - SHAFT_K * (q[1] - foot_y) - SHAFT_C * q[5]) / INNER,
            (fx - HOUSING_K * q[2] - HOUSING_C * q[6]) / OUTER,
            (fy - HOUSING_K * q[3] - HOUSING_C * q[7]) / OUTER,
        ]  # fmt: skip

    start = np.zeros(8)
    for i, towards in enumerate((math.cos(load_angle), math.sin(load_angle))):
        start[2 + i] = load * towards / HOUSING_K
        start[i] = -(foot + load / SHAFT_K) * towards
    times = np.arange(int(seconds * rate)) / rate
    solution = solve_ivp(
        rates, (0.0, times[-1]), start, 'RK45', times, rtol=1e-5, atol=1e-9, max_step=1e-4
    )
    return np.array([rates(t, q)[6 + axis] for t, q in zip(times, solution.y.T, strict=True)])


def amplitude(y: np.ndarray, shaft_hz: float, rate: float = 25600.0) -> float:
    """Mean of the largest fifth of the maxima of |a|, one a ball that passes the spall, m/s^2."""
    passing = 0.5 * shaft_hz * Z * (1.0 + BALL / PITCH)
    per_pass = round(rate / passing)
    whole = len(y) // per_pass * per_pass
    maxima = np.sort(np.abs(y[:whole] - y.mean()).reshape(-1, per_pass).max(axis=1))
    return float(maxima[-(len(maxima) // 5) :].mean())


def change(factors: str, shaft_hz: float, settle: float = 0.2, seconds: float = 0.5) -> float:
    """Relative change of the amplitude from 20 to 110 degC."""
    found = []
    for temperature in (20.0, 110.0):
        y = housing(beta0(temperature, factors), shaft_hz, settle + seconds)
        found.append(amplitude(y[int(settle * 25600.0) :], shaft_hz))
    return found[1] / found[0] - 1.0


if __name__ == '__main__':
    for hz in (22.0, 25.4, 29.0):
        print(hz, {factors: round(100.0 * change(factors, hz), 2) for factors in ('e', 'h', 'f')})
