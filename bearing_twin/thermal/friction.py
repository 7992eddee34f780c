# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Friction moment of a radially loaded deep groove ball bearing (SKF model).

SKF, Rolling bearings, PUB BU/P1 10000/1 EN (2013), chapter "Friction": equations of the frictional
moment, table 2a (deep groove ball bearings without axial load: G_rr = R1 d_m^1.96 F_r^0.54,
G_sl = S1 d_m^-0.26 F_r^(5/3)), table 3 (R1, S1) and table 4 (K_Z). Plain functions of floats, so
that the simulator can compile them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


SERIES = {
    '60': (4.1e-7, 3.73e-3),
    '62': (3.9e-7, 3.23e-3),
    '63': (3.7e-7, 2.84e-3),
    '64': (3.6e-7, 2.43e-3),
    '160': (4.3e-7, 4.63e-3),
    '618': (4.7e-7, 6.50e-3),
    '619': (4.3e-7, 4.75e-3),
}
"""Geometry constants R1 and S1 of a bearing series."""
UNKNOWN_SERIES = '62'
"""Series assumed for a bearing without one: a geometry given by the user, or angular contact, for
which SKF has other equations. Its R1 differs by 5 % and its S1 by 15 % from '60' and '63'."""

_K_Z = 3.1
"""Geometry constant of single row deep groove ball bearings."""
_SECTION = 3.3
"""(outside - bore) over ball diameter; it is 3.2 to 3.4 in the series 60, 62 and 63."""


def section_height(bearing: Bearing) -> float:
    """
    Outside minus bore diameter, m; estimated from the ball diameter if they are not published.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> round(section_height(find_bearing('6307')), 4)
    0.045

    """
    if bearing.bore is None or bearing.outside is None:
        return _SECTION * bearing.d_ball
    return bearing.outside - bearing.bore


def metallic_share(speed_rpm: float, nu: float, mean_diameter: float) -> float:
    """
    Share phi_bl of metallic contact in the sliding friction: 0 with a full film, 1 without film.

    ``speed_rpm`` is in 1/min, the kinematic viscosity ``nu`` in m^2/s, ``mean_diameter`` in m.

    Examples
    --------
    >>> round(metallic_share(1500.0, 20e-6, 57.5e-3), 3)
    0.063

    """
    product = speed_rpm * nu * 1e6
    return math.exp(-2.6e-8 * product**1.4 * mean_diameter * 1e3)


def sliding_friction(metallic: float, boundary: float, film: float) -> float:
    """
    Sliding friction coefficient mu_sl for a share ``metallic`` of metallic contact.

    ``boundary`` and ``film`` are the coefficients of metallic contact and of a full film.

    Examples
    --------
    >>> round(sliding_friction(metallic_share(1500.0, 20e-6, 57.5e-3), 0.12, 0.05), 4)
    0.0544

    """
    return metallic * boundary + (1.0 - metallic) * film


def friction_moment(
    speed_rpm: float,
    nu: float,
    load: float,
    mean_diameter: float,
    section: float,
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
    mean_diameter, section
        (bore + outside)/2 and outside - bore, m.
    rolling, sliding
        R1 and S1 of `SERIES`.
    replenishment
        Replenishment constant K_rs.
    mu
        Sliding friction coefficient.

    Examples
    --------
    A 6307 under 500 N at 1500 1/min in an oil of 20 mm^2/s:

    >>> rolling, sliding = SERIES['63']
    >>> moment = friction_moment(
    ...     1500.0, 20e-6, 500.0, 57.5e-3, 45e-3, rolling, sliding, 3e-8, 0.05
    ... )
    >>> round(moment, 4)
    0.0154

    """
    dm = mean_diameter * 1e3
    product = nu * 1e6 * speed_rpm
    inlet = 1.0 / (1.0 + 1.84e-9 * (speed_rpm * dm) ** 1.28 * (nu * 1e6) ** 0.64)
    starved = math.exp(-replenishment * product * 2.0 * dm * math.sqrt(_K_Z / (2e3 * section)))
    rolled = inlet * starved * rolling * dm**1.96 * load**0.54 * product**0.6
    slid = mu * sliding * dm**-0.26 * load ** (5.0 / 3.0)
    return float(1e-3 * (rolled + slid))


def power_loss(moment: float, speed_rpm: float) -> float:
    """
    Friction power, W; equal to SKF's 1.05e-4 M n with M in N mm.

    Examples
    --------
    >>> round(power_loss(0.03, 1500.0), 2)
    4.71

    """
    return moment * speed_rpm * math.pi / 30.0
