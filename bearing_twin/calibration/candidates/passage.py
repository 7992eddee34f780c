# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Passage of a ball over a defect: speed of the contact and spacing of the two impacts.

The centre of a ball that rolls into a slot sinks by ``k s^2`` at the distance s from the edge,
with ``k = 1/d + cos(alpha)/D`` on the inner race and ``1/d - cos(alpha)/D`` on the outer one (d
ball, D race, alpha contact angle). The ball is unloaded where it has sunk by the interference of
its loaded contacts, or it meets the bottom where it has sunk by the depth of the slot. All three
are along the contact normal. It is loaded again at the same distance from the other edge. The two
impacts are therefore closer than the slot is wide.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_frequencies, load_deflection_factor
from bearing_twin.errors import BearingTwinError
from bearing_twin.thermal.life import dynamic_rating

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


LOAD_SHARES = 0.003, 0.1
"""Range of the radial load over the dynamic rating if none is given: from a test rig without a
belt to a machine designed for 1000 million turns (ISO 281: L_10 = (C/P)^3 million turns)."""


def path_curvature(bearing: Bearing, place: str) -> float:
    """
    Sinking of a ball's centre over the squared distance from the edge of a slot, 1/m.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> [round(path_curvature(find_bearing('6205'), place)) for place in ('inner', 'outer')]
    [158, 105]

    """
    cosine = math.cos(bearing.contact_angle)
    across = bearing.gamma * bearing.d_pitch
    if place == 'inner':
        return 1.0 / bearing.d_ball + cosine / (bearing.d_pitch - across)
    return 1.0 / bearing.d_ball - cosine / (bearing.d_pitch + across)


def contact_speed(bearing: Bearing, place: str, shaft_hz: float, slip: float = 0.0) -> float:
    """
    Speed of the contact along the damaged surface, m/s.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> round(contact_speed(find_bearing('6205'), 'outer', 20.0), 2)
    1.18

    """
    rates = fault_frequencies(bearing, shaft_hz, slip)
    across = bearing.gamma * bearing.d_pitch
    if place == 'inner':
        return math.pi * (bearing.d_pitch - across) * (shaft_hz - rates.ftf)
    if place == 'outer':
        return math.pi * (bearing.d_pitch + across) * rates.ftf
    return math.pi * bearing.d_ball * rates.bsf


def interference(bearing: Bearing, load: float) -> float:
    """
    Deformation of the most loaded ball without clearance, m.

    It is ``(4.37 W / (Z K cos(alpha)))^(2/3)``: Stribeck's share of the load W on one of Z balls
    (Harris and Kotzalas, Essential Concepts of Bearing Technology, chapter 7), with the law
    F = K delta^1.5 along the contact normal.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> round(interference(find_bearing('6205'), 200.0) * 1e6, 1)
    4.7

    """
    radial = math.cos(bearing.contact_angle)
    share = 4.37 * load / (bearing.n_balls * load_deflection_factor(bearing) * radial)
    return float(share ** (2.0 / 3.0))


def impact_spacing(width: float, sinking: float, curvature: float) -> float:
    """
    Distance between unloading and loading of a ball over a slot, m; 0 where it is never unloaded.

    ``width`` is the width of the slot along the rolling direction, m. ``sinking`` is the sinking
    that unloads the ball, m: the interference or, if less, the depth of the slot. ``curvature``,
    1/m, is that of `path_curvature`.

    Examples
    --------
    A slot of 2 mm in the outer race of a 6205 under 200 N leaves impacts 1.6 mm apart:

    >>> round(impact_spacing(2e-3, 4.9e-6, 104.7) * 1e3, 2)
    1.57

    """
    return max(0.0, width - 2.0 * math.sqrt(sinking / curvature))


def load_range(bearing: Bearing, given: tuple[float, float] | None = None) -> tuple[float, float]:
    """
    Return the range of the radial load, N: the given one, or `LOAD_SHARES` of the rating.

    Raises
    ------
    BearingTwinError
        If the given range is not ascending or not within 10 N to 50 kN.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> [round(load) for load in load_range(find_bearing('6205'))]
    [42, 1400]

    """
    if given is None:
        low, high = (share * dynamic_rating(bearing) for share in LOAD_SHARES)
        return max(low, 10.0), min(max(high, 20.0), 50e3)
    low, high = given
    if not (10.0 <= low <= high <= 50e3):
        raise BearingTwinError(
            f'load from {low:g} to {high:g} N: give the least and the largest, in that order, '
            'from 10 to 50000 N'
        )
    return low, high
