# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What would explain impacts that no part of a bearing makes: another bearing, another speed."""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import catalogue, fault_orders, PLACES
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from numpy.typing import NDArray


_SLIPS = (0.0, 0.015)
"""Slips of a loaded cage."""

_MOST = 4
_REACH = 0.1


@functools.cache
def _orders() -> NDArray[np.float64]:
    """Orders of the races and balls of the catalogue at either slip, ascending, (B, 3, 2)."""
    orders = [
        [[fault_orders(b, slip).impacts(place) for slip in _SLIPS] for place in PLACES[:3]]
        for b in catalogue().values()
    ]
    return np.sort(np.array(orders), axis=-1)


def fitting_bearings(order: float, step: float, bearing: Bearing) -> list[str]:
    """
    Parts of catalogue bearings that strike at an order, at most four.

    Bearings of the size of the given one come first.

    Parameters
    ----------
    order
        Of the impacts.
    step
        Its uncertainty.
    bearing
        The given bearing.

    >>> from bearing_twin.bearing import find_bearing
    >>> fitting_bearings(5.41, 0.01, find_bearing('6205'))[0]
    'inner of 6205'

    """
    orders = _orders()
    fits = (orders[..., 0] - step <= order) & (order <= orders[..., 1] + step)
    found = [
        (abs(math.log(other.d_pitch / bearing.d_pitch)), f'{place} of {name}')
        for (name, other), row in zip(catalogue().items(), fits, strict=True)
        for place, hit in zip(PLACES, row, strict=False)
        if hit
    ]
    return [text for _, text in sorted(found)[:_MOST]]


def fitting_speeds(order: float, shaft_hz: float, bearing: Bearing) -> list[str]:
    """
    Shaft speeds within 10 % at which impacts would be those of a part of the bearing.

    Parameters
    ----------
    order
        Of the impacts, multiples of ``shaft_hz``.
    shaft_hz
        Speed that was used, Hz.
    bearing
        Geometry.

    >>> from bearing_twin.bearing import find_bearing
    >>> fitting_speeds(3.76, 24.0, find_bearing('6205'))
    ['25.2 Hz (outer)']

    """
    orders = fault_orders(bearing)
    speeds = {place: shaft_hz * order / orders.impacts(place) for place in PLACES}
    return [
        f'{hertz:.3g} Hz ({place})'
        for place, hertz in speeds.items()
        if abs(hertz / shaft_hz - 1.0) <= _REACH
    ]


def what_fits(order: float, step: float, shaft_hz: float, bearing: Bearing) -> str:
    """
    Speeds and bearings that would explain impacts, to be added to a sentence.

    Parameters
    ----------
    order, step, shaft_hz, bearing
        As in :func:`fitting_bearings` and :func:`fitting_speeds`.

    >>> from bearing_twin.bearing import find_bearing
    >>> what_fits(3.76, 0.001, 24.0, find_bearing('6205')).split(';')[1]
    ' a speed of 25.2 Hz (outer) would fit'

    """
    speeds, bearings = (
        fitting_speeds(order, shaft_hz, bearing),
        fitting_bearings(order, step, bearing),
    )
    text = f'; a speed of {" or ".join(speeds)} would fit' if speeds else ''
    return text + (f'; in the catalogue {", ".join(bearings)} would fit' if bearings else '')
