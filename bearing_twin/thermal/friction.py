# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Friction moment of a radially loaded deep groove ball bearing: the SKF model.

SKF, Rolling bearings catalogue, "Bearing friction, power loss and starting torque". Plain
functions of floats, so that the simulator can compile them.
"""

from __future__ import annotations

import math

__all__ = ['SERIES', 'friction_moment', 'power_loss', 'sliding_friction']

SERIES = {
    '60': (4.1e-7, 3.73e-3),
    '62': (3.9e-7, 3.23e-3),
    '63': (3.7e-7, 2.84e-3),
    '64': (3.6e-7, 2.43e-3),
}
"""Geometry constants R1 and S1 of the bearing series."""

_K_Z = 3.1
"""Design constant of single row deep groove ball bearings."""
_SECTION = 3.3
"""(outside - bore) over ball diameter; 3.2 to 3.4 over the series 60, 62, 63."""


def sliding_friction(
    speed_rpm: float, nu: float, d_pitch: float, boundary: float, film: float
) -> float:
    """Sliding friction coefficient mu_sl between metallic contact and full film."""
    product = speed_rpm * nu * 1e6
    weight = math.exp(-2.6e-8 * product**1.4 * d_pitch * 1e3)
    return weight * boundary + (1.0 - weight) * film


def friction_moment(
    speed_rpm: float,
    nu: float,
    load: float,
    d_pitch: float,
    d_ball: float,
    rolling: float,
    sliding: float,
    replenishment: float,
    mu: float,
) -> float:
    """
    Friction moment without seals and drag, N m.

    Parameters
    ----------
    speed_rpm
        Shaft speed, 1/min.
    nu
        Kinematic viscosity, m^2/s.
    load
        Radial load, N.
    d_pitch, d_ball
        Pitch and ball diameter, m.
    rolling, sliding
        R1 and S1 of `SERIES`.
    replenishment
        K_rs.
    mu
        Sliding friction coefficient.

    """
    dm = d_pitch * 1e3
    product = nu * 1e6 * speed_rpm
    inlet = 1.0 / (1.0 + 1.84e-9 * (speed_rpm * dm) ** 1.28 * (nu * 1e6) ** 0.64)
    section = _SECTION * d_ball * 1e3
    starved = math.exp(-replenishment * product * 2.0 * dm * math.sqrt(_K_Z / (2.0 * section)))
    rolled = inlet * starved * rolling * dm**1.96 * load**0.54 * product**0.6
    slid = mu * sliding * dm**-0.26 * load ** (5.0 / 3.0)
    return float(1e-3 * (rolled + slid))


def power_loss(moment: float, speed_rpm: float) -> float:
    """Heat of friction, W; SKF's 1.05e-4 M n with M in N mm is this."""
    return moment * speed_rpm * math.pi / 30.0
