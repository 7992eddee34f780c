# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The same model for scipy's adaptive solvers: the yardstick of the kernels' error and speed.

Written from the equations and not from the kernels: angles are functions of time, the path over a
defect is looked up for every ball, and the sensor is two more states. Constant temperature and
speed, no jitter, no noise.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import fault_orders, PLACES
from bearing_twin.dynamics import filters, laws, layout
from bearing_twin.dynamics.compiled import compiled
from bearing_twin.dynamics.parameters import PROFILES
from bearing_twin.dynamics.simulator import Simulator
import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters

__all__ = ['Reference', 'solve']

FloatArray = npt.NDArray[np.float64]

_LARGEST_STEP = 1e-4
"""An adaptive solver that steps over a spall never sees it, s."""


class Reference(NamedTuple):
    """Result of an adaptive solver."""

    x: FloatArray
    """Horizontal, m/s^2, decimated like the twin's."""
    y: FloatArray
    """Vertical, m/s^2."""
    states: FloatArray
    """Positions and velocities of the rings, and the sensor, at the internal rate."""
    evaluations: int
    """Evaluations of the right-hand side."""


def solve(
    parameters: TwinParameters,
    samples: int,
    *,
    temperature: float = 20.0,
    shaft_hz: float = 25.4,
    sample_rate: float = 25600.0,
    method: str = 'DOP853',
    rtol: float = 1e-8,
) -> Reference:
    """Solve from the twin's starting point with ``scipy.integrate.solve_ivp``."""
    snapshot = Simulator(
        parameters, sample_rate=sample_rate, temperature=temperature, shaft_hz=shaft_hz
    ).snapshot()
    values = snapshot.values[: laws.INPUTS] + snapshot.drift[0]
    p, bearing = parameters, parameters.bearing
    orders = fault_orders(bearing, values[laws.SLIP])
    omega = 2.0 * math.pi * shaft_hz
    constants = np.array(
        [
            p.inner_mass, p.inner_stiffness, p.inner_damping, p.outer_mass, p.outer_stiffness,
            p.outer_damping, p.contact_damping, p.unbalance, omega, omega * orders.ftf,
            omega * orders.bsf, p.start_angle, bearing.d_ball, bearing.d_pitch,
            2.0 * math.pi * p.resonance_hz, p.resonance_damping, values[laws.K_B],
            values[laws.DEPTH], values[laws.CLEARANCE], values[laws.SPRING],
            math.cos(bearing.contact_angle),
        ]
    )  # fmt: skip
    defects = np.array(
        [
            (PLACES.index(d.place), PROFILES.index(d.profile), d.width, d.depth, d.angle, d.ball)
            for d in p.defects
        ]
    ).reshape(-1, 6)
    factor = filters.oversampling(sample_rate)
    times = np.arange(1, samples * factor + 1) / (sample_rate * factor)
    begin = np.zeros(12)
    begin[:8] = snapshot.state[layout.Q : layout.A]
    tolerance = rtol * np.repeat([1e-5, 1e-2, 1e2], 4)
    solution = solve_ivp(
        _rates, (0.0, times[-1]), begin, method, times, rtol=rtol, atol=tolerance,
        max_step=_LARGEST_STEP, args=(constants, defects, bearing.n_balls),
    )  # fmt: skip
    if p.resonance_hz:
        sensed = -solution.y[[8, 10]] - 2.0 * p.resonance_damping * solution.y[[9, 11]]
    else:
        sensed = np.array(
            [
                _rates(t, state, constants, defects, bearing.n_balls)[6:8]
                for t, state in zip(times, solution.y.T, strict=True)
            ]
        ).T
    taps = filters.decimator(factor)
    before = np.zeros((2, len(taps) - factor))
    windows = np.lib.stride_tricks.sliding_window_view(
        np.concatenate([before, sensed], axis=1), len(taps), axis=1
    )
    x, y = windows[:, ::factor] @ taps
    return Reference(x, y, solution.y, solution.nfev)


@compiled()
def _rates(
    t: float, state: FloatArray, constants: FloatArray, defects: FloatArray, n_balls: int
) -> FloatArray:
    """Time derivative of the 12 states: positions, velocities, sensor along x and y."""
    mi, ki, ci, mo, ko, co, cb, unbalance, omega, cage, spin = constants[:11]
    begin, d, pitch, resonance, damping, kb, factor, clearance, foot, cosine = constants[11:]
    # A spall opens a gap along the contact normal; measured along the radius it is larger.
    factor /= cosine
    inner, outer = 0.5 * (pitch - d * cosine), 0.5 * (pitch + d * cosine)
    path_inner, path_outer = 1.0 / d + 0.5 * cosine / inner, 1.0 / d - 0.5 * cosine / outer
    x, y = state[0] - state[2], state[1] - state[3]
    vx, vy = state[4] - state[6], state[5] - state[7]
    fx = fy = 0.0
    for j in range(n_balls):
        angle = begin + cage * t + 2.0 * math.pi * j / n_balls
        gap = clearance
        for i in range(defects.shape[0]):
            place, profile, width, depth, where = defects[i, :5]
            if place == 0.0:
                along = _wrap(angle - begin - omega * t - where) * inner
                gap += factor * _sag(profile, width, depth, path_inner, along)
            elif place == 1.0 or (place == 3.0 and defects[i, 5] == j):
                along = _wrap(angle - where) * outer
                gap += factor * _sag(profile, width, depth, path_outer, along)
            elif place == 2.0 and defects[i, 5] == j:
                along = _wrap(spin * t - where) * 0.5 * d
                gap += factor * _sag(profile, width, depth, path_inner, along)
                along = _wrap(spin * t - where - math.pi) * 0.5 * d
                gap += factor * _sag(profile, width, depth, path_outer, along)
        c, s = math.cos(angle), math.sin(angle)
        delta = x * c + y * s - gap
        if delta > 0.0:
            force = max(kb * delta**1.5 + cb * (vx * c + vy * s), 0.0)
            fx += force * c
            fy += force * s
    pull = unbalance * omega * omega
    turned = begin + omega * t
    rates = np.empty(12)
    rates[:4] = state[4:8]
    rates[4] = (pull * math.cos(turned) - fx - ki * state[0] - ci * state[4]) / mi
    rates[5] = (pull * math.sin(turned) - fy - ki * (state[1] - foot) - ci * state[5]) / mi
    rates[6] = (fx - ko * state[2] - co * state[6]) / mo
    rates[7] = (fy - ko * state[3] - co * state[7]) / mo
    for axis in range(2):
        z, w = state[8 + 2 * axis], state[9 + 2 * axis]
        rates[8 + 2 * axis] = resonance * w
        rates[9 + 2 * axis] = -resonance * (z + 2.0 * damping * w + rates[6 + axis])
    return rates


@compiled()
def _wrap(angle: float) -> float:
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


@compiled()
def _sag(profile: float, width: float, depth: float, curvature: float, along: float) -> float:
    """How far a ball sinks at a distance from the centre of a defect, m."""
    edge = 0.5 * width - abs(along)
    if edge <= 0.0:
        return 0.0
    if profile == 0.0:
        return min(depth, edge * edge * curvature)
    if profile == 1.0:
        return depth
    if profile == 2.0:
        return depth * math.cos(math.pi * along / width)
    if edge >= 0.25 * width:
        return depth
    return depth * math.sin(2.0 * math.pi * edge / width) ** 2
