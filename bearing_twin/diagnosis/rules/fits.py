# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Bearings and speeds that would explain impacts at an order of no part of the bearing."""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import catalogue, fault_orders, PLACES
from bearing_twin.diagnosis.thresholds import SLIP
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


_SLIPS = (SLIP[0], 0.015)
"""Range of slip of a loaded cage; negative slip is the effect of a contact angle."""

_MOST = 4
_REACH = 0.1


@functools.cache
def _orders() -> NDArray[np.float64]:
    """Return the orders of all races and balls of the catalogue at both slips, (B, 3, 2)."""
    orders = [
        [[fault_orders(b, slip).impacts(place) for slip in _SLIPS] for place in PLACES[:3]]
        for b in catalogue().values()
    ]
    return np.sort(np.array(orders), axis=-1)


def striking_parts(order: float, step: float) -> list[tuple[Bearing, str]]:
    """
    Return the bearings of the catalogue with a part that strikes at an order, and that part.

    A loaded cage slips by up to 1.5 %. It turns faster by up to 1.5 % if an axial load opens a
    contact angle that the catalogue does not contain.

    Parameters
    ----------
    order
        Order of the impacts, multiples of the shaft speed.
    step
        Uncertainty of the order.

    >>> parts = striking_parts(5.401, 0.01)
    >>> {bearing.name: place for bearing, place in parts}['6205']
    'inner'

    """
    orders = _orders()
    fits = (orders[..., 0] - step <= order) & (order <= orders[..., 1] + step)
    bearings = list(catalogue().values())
    return [(bearings[row], PLACES[part]) for row, part in np.argwhere(fits)]


def what_fits(
    order: float, step: float, shaft_hz: float, bearing: Bearing, sways: bool = False
) -> str:
    """
    Return the speeds and bearings that would explain impacts, as the end of a sentence.

    Parameters
    ----------
    order, step
        Order of the impacts and its uncertainty, as in :func:`striking_parts`.
    shaft_hz, bearing
        Speed that was used, Hz, and geometry. Speeds within 10 % of this one fit; bearings of the
        size of this one come first.
    sways
        Whether the impacts have shaft sidebands: inner races come first, else the others.

    >>> from bearing_twin.bearing import find_bearing
    >>> what_fits(3.76, 0.001, 24.0, find_bearing('6205')).split(';')[1]
    ' a speed of 25.2 Hz (outer) would fit'

    """
    orders = fault_orders(bearing)
    speeds = [
        f'{shaft_hz * ratio:.3g} Hz ({place})'
        for place in PLACES
        if abs((ratio := order / orders.impacts(place)) - 1.0) <= _REACH
    ]
    text = f'; a speed of {" or ".join(speeds)} would fit' if speeds else ''
    parts = sorted(
        striking_parts(order, step),
        key=lambda part: (
            (part[1] == 'inner') != sways,
            abs(math.log(part[0].d_pitch / bearing.d_pitch)),
        ),
    )
    if not parts:
        return text
    names = ', '.join(f'{place} of {other.name}' for other, place in parts[:_MOST])
    more = f' and {len(parts) - _MOST} more' if len(parts) > _MOST else ''
    return f'{text}; in the catalogue {names}{more} would fit'
