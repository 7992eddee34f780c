# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Expected fault orders of one bearing as a function of cage slip."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_orders, PLACES
from bearing_twin.diagnosis.thresholds import (
    HARMONICS,
    JOINT_SLIP,
    SLIP,
    SLOW_CAGE,
    STEADY,
    UNLIKELY_SLIP,
)
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.combs.candidate import Candidate


_SIDEBANDS = 10
"""Sidebands of a line on each side: those of a ball's fault are multiples of the cage's lines."""


class ExpectedOrders:
    """
    Expected fault orders of one bearing as a function of cage slip.

    Parameters
    ----------
    bearing
        Geometry.
    uncertainty
        Relative uncertainty of the shaft speed.

    >>> from bearing_twin.bearing import find_bearing
    >>> expected = ExpectedOrders(find_bearing('6205'), 0.001)
    >>> order, change = expected.of('outer')
    >>> round(order, 3), round(change, 3), expected.speed_known
    (3.585, -3.585, True)

    """

    def __init__(self, bearing: Bearing, uncertainty: float) -> None:
        self.bearing, self.uncertainty = bearing, uncertainty
        self.without_slip = fault_orders(bearing)
        slipped = fault_orders(bearing, SLIP[1])
        both = (
            (place, self.without_slip.impacts(place), slipped.impacts(place)) for place in PLACES
        )
        self._of: dict[str, tuple[float, float]] = {
            place: (order, (other - order) / SLIP[1]) for place, order, other in both
        }

    @property
    def speed_known(self) -> bool:
        """Whether the shaft speed is known well enough to compare slips and place sidebands."""
        return self.uncertainty <= STEADY

    def of(self, place: str) -> tuple[float, float]:
        """Return the impact order of a place without slip, and its change with a slip of 1."""
        return self._of[place]

    def cage(self) -> tuple[float, float]:
        """Return the lowest and highest order of the cage."""
        order, slope = self.of('cage')
        return order + slope * SLOW_CAGE, order + slope * SLIP[0]

    def cage_beside(self, candidate: Candidate) -> tuple[float, float]:
        """Return the lowest and highest order of the cage, given the slip of another comb."""
        order, slope = self.of('cage')
        ends = order + slope * (candidate.slip + np.array([JOINT_SLIP, -JOINT_SLIP]))
        return float(ends[0]), float(ends[1])

    def joint_slips(self, primary: Candidate) -> tuple[float, float]:
        """Return the range of slip of another fault of the bearing, given the primary fault."""
        if not self.speed_known or primary.place == 'cage':
            return SLIP
        return primary.slip - JOINT_SLIP, primary.slip + JOINT_SLIP

    def other_speeds(self, comb: Candidate) -> dict[str, tuple[float, float]]:
        """Return the range of speed, relative to this, at which a comb is of each other place."""
        ranges = {}
        for place, (order, slope) in self._of.items():
            ends = (comb.order / (order + slope * slip) for slip in (SLIP[0], UNLIKELY_SLIP))
            low, high = sorted(ends)
            ranges[place] = low, high
        del ranges[comb.place]
        return ranges

    def lines(self, comb: Candidate) -> NDArray[np.float64]:
        """Return the orders of a comb's lines in the spectrum of the signal, with sidebands."""
        order, slope = self.of('cage')
        apart = 1.0 if comb.place == 'inner' else order + slope * comb.slip
        harmonics = comb.order * np.arange(1.0, HARMONICS + 1.0)
        return np.add.outer(harmonics, apart * np.arange(-_SIDEBANDS, _SIDEBANDS + 1.0)).ravel()
