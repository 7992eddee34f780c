# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Sidebands of the combs of one bearing: whether shaft or cage modulates each."""

from __future__ import annotations

import math
from typing import Any, TYPE_CHECKING

from bearing_twin.diagnosis.combs.candidate import RACES
from bearing_twin.diagnosis.signal.gate import HEALTHY_TURNS
from bearing_twin.diagnosis.signal.lines import nearest_row
from bearing_twin.diagnosis.thresholds import (
    HARMONICS,
    LOAD_ZONE,
    RIVAL,
    SLIP,
    SLIP_COST,
    SWAY,
)
from bearing_twin.numerics.compiled import compiled, FAST
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.diagnosis.combs.candidate import Candidate
    from bearing_twin.diagnosis.combs.comb import OrderSpectra
    from bearing_twin.diagnosis.combs.expected_orders import ExpectedOrders


SIDEBANDS = 4
"""Number of sidebands on each side of a harmonic that a fault explains."""
_CAGES = (0.33, 0.47)
"""Range of the cage orders of all bearings of the catalogue."""
_CHANCE = (0.52, 0.62)
"""Range of orders at which no part turns, nor at half of them; about as wide as ``_CAGES``."""


class CombSidebands:
    """
    Sidebands of the combs of one bearing: whether shaft or cage modulates each.

    Parameters
    ----------
    whole
        Envelope spectra over orders of the shaft.
    expected
        Expected orders of the parts of the bearing.

    """

    def __init__(self, whole: OrderSpectra, expected: ExpectedOrders) -> None:
        self._whole, self._spectra, self._expected = whole, whole.off_shaft, expected
        self._found: dict[tuple[float, int, float, float], tuple[float, float]] = {}

    def shaft_sideband_ratio(self, candidate: Candidate) -> float:
        """Return the mean amplitude of a comb's shaft sidebands over that of its harmonics."""
        return sideband_ratio(self._spectra, candidate.order, candidate.band)

    def turning_sideband(self, candidate: Candidate) -> tuple[float, float]:
        """Return the spacing near one order with the highest sidebands, and their ratio."""
        return self._highest_sideband(candidate, 0.9, 1.1)

    def cage_sideband(self, candidate: Candidate) -> tuple[float, float]:
        """Return the cage order with the highest sidebands of a comb, and their ratio."""
        return self._highest_sideband(candidate, *self._expected.cage_beside(candidate))

    def _highest_sideband(
        self, candidate: Candidate, low: float, high: float
    ) -> tuple[float, float]:
        """Return the spacing in a range with the highest sidebands, and their ratio."""
        key = candidate.order, candidate.band, low, high
        if key not in self._found:
            slack = self._expected.uncertainty * high
            # Two gaps beside a harmonic: half a bin more moves the farther sidebands by one.
            gaps = np.arange(low - slack, high + slack + self._whole.step, 0.5 * self._whole.step)
            ratios = _ratios(self._spectra, candidate.order, candidate.band, gaps)
            best = int(np.argmax(ratios))
            self._found[key] = float(gaps[best]), float(ratios[best])
        return self._found[key]

    def has_high_shaft_sidebands(self, candidate: Candidate) -> bool:
        """Return whether shaft sidebands are as high as the harmonics, as with a loose shaft."""
        return self.turning_sideband(candidate)[1] * RIVAL >= 1.0

    def inner_race_ratio(self, other: Candidate) -> float:
        """
        Return the amplitude of the inner race's comb over that of another; 0 if unrelated.

        The other comb may be a shaft sideband of the inner race's comb if that one can be a whole
        number of orders beside it, at a slip that is about as likely.
        """
        order, slope = self._expected.of('inner')
        # Not much less likely than the slip of the other comb, which it would replace.
        likely = math.hypot(other.slip, SLIP_COST)
        slack = self._expected.uncertainty * order + 2.0 * self._whole.step
        first = math.ceil(order + slope * max(SLIP[0], -likely) - slack - other.order)
        last = math.floor(order + slope * min(SLIP[1], likely) + slack - other.order)
        sides = [side for side in range(first, last + 1) if side]
        if not sides:
            return 0.0
        # Inner race harmonics masked by the shaft count here.
        near = np.arange(-2.0, 2.25, 0.25) * self._whole.step
        beside = np.array(sides, np.float64)[:, None] + near
        combs = self._whole.comb_powers(other.order + np.append(0.0, beside), other.band)
        own, *powers = combs.tolist()
        return math.sqrt(max(powers) / max(own, 1e-30))

    def sideband_owner(self, one: Candidate, other: Candidate) -> Candidate | None:
        """
        Return which of two candidates for one comb its sidebands fit; None if they fit neither.

        An inner race is modulated by the shaft, a ball by the cage, an outer race by neither.
        """
        shaft = sideband_ratio(self._spectra, one.order, one.band)
        claims = {c.place: c for c in (one, other)}
        cage = self.cage_sideband(claims.get('ball', one))[1]
        heights = {'inner': shaft, 'ball': cage, 'outer': LOAD_ZONE / RIVAL}
        low, high = sorted(claims, key=lambda place: heights.get(place, 0.0))
        return claims[high] if heights.get(high, 0.0) > RIVAL * heights.get(low, 0.0) else None

    def cage_sideband_order(self, candidate: Candidate) -> float:
        """
        Return the cage order that is the spacing of the sidebands of a race's comb; 0 without any.

        A race does not move with the cage. Such a comb belongs to a ball or to the cage, at an
        unexpected slip, or to an outer race: see `passing_balls_ratio`.
        """
        return self._beside_race(candidate, *self._expected.cage())

    def passing_balls_ratio(self, candidate: Candidate) -> float:
        """
        Return the ratio of an outer race's cage sidebands if passing balls may make them, else 0.

        Balls of different sizes, or an eccentric cage, let the impacts vary once a turn of the
        cage. The cage then turns at the order of the comb over the number of balls, at any slip
        and contact angle. So they fit if no other spacing has clearly higher sidebands.
        """
        if candidate.place != 'outer':
            return 0.0
        spacing = candidate.order / self._expected.bearing.n_balls
        ratio = sideband_ratio(self._spectra, candidate.order, candidate.band, spacing)
        highest = self._highest_sideband(candidate, *self._expected.cage())[1]
        return highest if ratio * RIVAL >= highest else 0.0

    def another_cage_order(self, candidate: Candidate) -> float:
        """Return `cage_sideband_order` for the cages of all bearings of the catalogue."""
        return self._beside_race(candidate, *_CAGES)

    def _beside_race(self, candidate: Candidate, low: float, high: float) -> float:
        """
        Return the spacing of a race's sidebands in a range; 0 if shaft sidebands are higher.

        Faint sidebands count if the window resolves them, and if those of the shaft and of noise
        at other spacings are lower by a factor 2: balls of different sizes modulate an outer race
        with the cage as well, beside the unbalance.
        """
        if candidate.place not in RACES:
            return 0.0
        gap, ratio = self._highest_sideband(candidate, low, high)
        least = max(LOAD_ZONE, candidate.shaft_sideband_ratio)
        if SWAY < ratio <= least and self._spectra.step * HEALTHY_TURNS <= 1.0:
            chance = self._highest_sideband(candidate, *_CHANCE)[1]
            # The given shaft speed may be wrong.
            least = RIVAL * RIVAL * max(self.turning_sideband(candidate)[1], chance)
        return gap if ratio > least else 0.0

    def shaft_sidebands_dominate(self, candidate: Candidate) -> bool:
        """
        Return whether a ball's comb has shaft sidebands higher than its cage sidebands.

        A ball moves with the cage. Such a comb may belong to the inner race, at an unexpected
        slip.
        """
        if candidate.place != 'ball':
            return False
        shaft = self.shaft_sideband_ratio(candidate)
        return shaft > max(LOAD_ZONE, RIVAL * self.cage_sideband(candidate)[1])

    def explained(self, candidate: Candidate) -> NDArray[np.float64]:
        """Return the orders of the lines that a fault explains."""
        order, reach, gap = candidate.order, SIDEBANDS, 1.0
        if candidate.place == 'ball':
            order, gap = 0.5 * order, self.cage_sideband(candidate)[0]
        elif candidate.place == 'cage':
            reach = 0
        elif not self._expected.speed_known:
            gap = self._highest_sideband(candidate, 1.0, 1.0)[0]
        sides = gap * np.arange(-reach, reach + 1)
        lines = order * np.arange(1, int(self._whole.top / order) + 2)[:, None] + sides
        return np.asarray(lines.ravel())


def sideband_ratio(spectra: OrderSpectra, order: float, band: int, gap: float = 1.0) -> float:
    """
    Return the amplitude of the sidebands one and two gaps beside the harmonics, over theirs.

    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> spectra = OrderSpectra.of_lines(np.arange(1, 19))
    >>> sideband_ratio(spectra, 4.0, 0), sideband_ratio(spectra, 4.0, 0, 0.5)
    (1.0, 0.7071067690849304)

    """
    return float(_ratios(spectra, order, band, np.array([gap]))[0])


def _ratios(
    spectra: OrderSpectra, order: float, band: int, gaps: NDArray[np.float64]
) -> NDArray[np.float32]:
    """Return the sideband ratio of a comb at each of several gaps, (n,)."""
    ratios = np.empty(len(gaps), np.float32)
    _sideband_ratios(
        spectra.excess, spectra.quiet, order, spectra.step, HARMONICS, band, gaps, ratios
    )
    return ratios


@compiled(fast=FAST, borrows=True)
def _line_of_band(
    excess: NDArray[np.float32], hidden: NDArray[np.bool_], bins: float, band: int
) -> Any:
    """Return the power of a line in one band: its row and the two beside it."""
    last, total = len(excess) - 1, np.float32(0.0)
    middle = nearest_row(bins, len(excess))
    for beside in range(-1, 2):
        at = min(max(middle + beside, 0), last)
        if not hidden[at]:
            total += excess[at, band]
    return total


@compiled(fast=FAST, borrows=True)
def _sideband_ratios(
    excess: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    order: float,
    step: float,
    harmonics: int,
    band: int,
    gaps: NDArray[np.float64],
    ratios: NDArray[np.float32],
) -> None:
    """
    Write the amplitude of the sidebands one and two gaps beside the harmonics, over theirs.

    ``excess`` is (K, C). ``hidden`` is a (K,) mask of left out rows. Gaps and ratios are (G,).
    """
    inverse, own = 1.0 / step, np.float32(0.0)
    for harmonic in range(1, harmonics + 1):
        own += _line_of_band(excess, hidden, harmonic * order * inverse, band)
    own = max(own, np.float32(1e-30))
    for g in range(len(gaps)):
        total = np.float32(0.0)
        for harmonic in range(1, harmonics + 1):
            for side in range(1, 3):
                away = side * gaps[g]
                line = harmonic * order
                total += _line_of_band(excess, hidden, (line - away) * inverse, band)
                total += _line_of_band(excess, hidden, (line + away) * inverse, band)
        ratios[g] = np.sqrt(np.float32(0.25) * total / own)
