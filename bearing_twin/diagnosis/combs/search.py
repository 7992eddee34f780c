# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Search for the combs of one bearing: the best one of each fault place, and at any order."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import PLACES
from bearing_twin.diagnosis.combs.candidate import Candidate, RACES, UNTESTED
from bearing_twin.diagnosis.combs.comb import comb_scores, modulation_index, OrderSpectra
from bearing_twin.diagnosis.combs.comb_sums import best_with_slip_cost, highest_elsewhere
from bearing_twin.diagnosis.combs.expected_orders import ExpectedOrders
from bearing_twin.diagnosis.combs.harmonics import CombHarmonics
from bearing_twin.diagnosis.combs.sidebands import CombSidebands, sideband_ratio, SIDEBANDS
from bearing_twin.diagnosis.signal.lines import count_shown, nearest_row
from bearing_twin.diagnosis.signal.spectra import WHITENINGS
from bearing_twin.diagnosis.thresholds import (
    CARRIER,
    HARMONICS,
    INDEX_SUSPECT,
    SLIP,
    SLIP_COST,
    Z_ELSEWHERE,
    Z_FAULT,
)
from bearing_twin.numerics.compiled import compiled, FAST
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.signal.shaft import ShaftSpeed


class CombSearch:
    """
    Combs of one bearing in the envelope spectra of a window, or in the mean of several.

    Parameters
    ----------
    spectra
        Envelope spectra over orders of ``speed``.
    bearing
        Geometry.
    speed
        Refined shaft speed.

    """

    def __init__(self, spectra: OrderSpectra, bearing: Bearing, speed: ShaftSpeed) -> None:
        self._whole, self.spectra = spectra, spectra.off_shaft
        self.shaft_hz = speed.shaft_hz
        self.expected = ExpectedOrders(bearing, speed.uncertainty)
        self._highest = 1.08 * max(self.expected.of(place)[0] for place in PLACES)
        self._scores = comb_scores(self.spectra, self._highest, len(WHITENINGS))
        self.sidebands = CombSidebands(spectra, self.expected)
        self.harmonics = CombHarmonics(spectra, speed, self.expected, self._scores, self.sidebands)

    def best(
        self, place: str, spectra: OrderSpectra | None = None, slips: tuple[float, float] = SLIP
    ) -> Candidate:
        """Return the best comb of a place in a range of slip, by default in ``self.spectra``."""
        spectra = spectra or self.spectra
        found, slip, z = self._peak(place, spectra, slips)
        index, band = self._index(spectra, found, place)
        alive = count_shown(self._whole.at_shaft, found, spectra.step, HARMONICS)
        tested = place in RACES and z >= Z_FAULT
        sidebands = sideband_ratio(spectra, found, band) if tested else UNTESTED
        return Candidate(place, found, slip, z, index, band, alive, sidebands)

    def _peak(
        self, place: str, spectra: OrderSpectra, slips: tuple[float, float] = SLIP
    ) -> tuple[float, float, float]:
        """Return order, slip and score of the best comb of a place in a range of slip."""
        order, slope = self.expected.of(place)
        grid = self._between(place, slips)
        z = self._scores.score(spectra, grid)
        return best_with_slip_cost(
            z, grid, order, self.expected.uncertainty * order, slope, SLIP_COST
        )

    def _between(self, place: str, slips: tuple[float, float]) -> NDArray[np.float64]:
        """Return the orders of a place in a range of slip, 1/8 bin apart; at least one."""
        order, slope = self.expected.of(place)
        ends = sorted(order + slope * slip for slip in slips)
        slack = self.expected.uncertainty * order
        grid = np.arange(ends[0] - slack, ends[1] + slack, 0.5 * self.spectra.step / HARMONICS)
        return grid if len(grid) else np.array([order])

    def strongest_anywhere(self, *, beyond: bool = False) -> Candidate:
        """
        Return the best comb at any order off the multiples of the shaft and off the cage's orders.

        Parameters
        ----------
        beyond
            Whether to search beyond the orders of this bearing as well, as far as three harmonics
            reach. If a comb is significant, the search ends one order beyond it in any case.

        """
        scores = self._scores
        found = self._off_shaft(scores.grid, scores.z, self.spectra)
        if hertz := self.harmonics.mains_hz(found):
            # Pulses of the mains are no impacts, and may hide impacts.
            pulses = np.arange(1.0, self._whole.top) * 2.0 * hertz / self.shaft_hz
            rest = self.spectra.silenced(pulses, 1.25 * self.spectra.step)
            found = self._off_shaft(scores.grid, scores.score(rest, scores.grid), rest)
        end = self._whole.top / 3.0 if beyond else 0.0
        if found.z >= Z_ELSEWHERE:
            # The comb may be a shaft sideband of a comb one order above.
            end = min(found.order + 1.1, self._whole.top / 3.0)
        if end > scores.grid[-1]:
            grid = np.arange(scores.grid[-1], end, scores.grid[1] - scores.grid[0])
            further = self._off_shaft(grid, scores.score(self.spectra, grid), self.spectra)
            found = max(found, further, key=lambda c: c.z)
        # Impacts beyond the searched orders show at a fraction of their order, without its first
        # harmonics.
        multiple = self.harmonics.multiple(found.order)
        return replace(found, order=multiple * found.order) if multiple > 1 else found

    def _off_shaft(
        self, grid: NDArray[np.float64], z: NDArray[np.float64], spectra: OrderSpectra
    ) -> Candidate:
        """Return the best comb of a grid off the shaft's multiples and off the cage's orders."""
        # A ball in and out of the load zone makes lines of the cage: they belong to the bearing.
        cage = self.expected.cage()
        at = highest_elsewhere(z, grid, self.expected.uncertainty, 1.25 * self.spectra.step, *cage)
        return self._of_no_place(spectra, float(grid[at]), float(z[at]))

    def _of_no_place(self, spectra: OrderSpectra, order: float, z: float) -> Candidate:
        """Return the comb at an order, with the place 'elsewhere'."""
        return Candidate('elsewhere', order, 0.0, z, *self._index(spectra, order, 'inner'))

    def deepest_whole(self) -> Candidate | None:
        """Return the significant comb of the largest index at a multiple of the shaft, or None."""
        orders = np.arange(1.0, max(self._whole.top // 3.0, 1.0) + 1.0)
        z = self._scores.score(self._whole, orders)
        found = (
            self._of_no_place(self._whole, float(order), float(at))
            for order, at in zip(orders, z, strict=True)
            if at >= Z_ELSEWHERE
        )
        return max(found, key=lambda c: c.index, default=None)

    def masked_candidate(self, place: str) -> Candidate | None:
        """
        Return a significant comb of a place on harmonics of the shaft; None without one.

        All slips of the place are searched: slip can move its order to a whole number. Smooth
        combs are excluded: impacts have all harmonics; blades, vanes and lobes pulse smoothly.
        """
        grid = self._between(place, SLIP)
        whole = grid[self._is_whole(grid)]
        # Usually there is no whole order in reach, or no comb at it: then nothing else is
        # searched.
        if not len(whole) or self._scores.score(self._whole, whole).max() < Z_FAULT:
            return None
        found = self.best(place, self._whole)
        shown = found.z >= Z_FAULT and found.index >= INDEX_SUSPECT and self._is_whole(found.order)
        return found if shown and not self.harmonics.smooth(found, masked=True) else None

    def _is_whole(self, orders: Any) -> Any:
        """Return whether orders coincide with multiples of the shaft."""
        reach = self.expected.uncertainty * orders + 1.25 * self._whole.step
        return abs(orders - np.rint(orders)) <= reach

    def second_look(self, candidate: Candidate) -> Candidate:
        """
        Return a comb scored against the null without the lines that it explains.

        The sidebands of a strong comb widen the null.
        """
        scores = comb_scores(self.without(candidate), self._highest, len(WHITENINGS))
        z = scores.score(self.spectra, np.array([candidate.order]))
        found = replace(candidate, z=float(z[0]) - (candidate.slip / SLIP_COST) ** 2)
        if found.place not in RACES:
            return found
        return replace(found, shaft_sideband_ratio=self.sidebands.shaft_sideband_ratio(found))

    def score_without(self, cause: Candidate, *orders: float) -> float:
        """Return the highest score of combs at orders without the lines that a fault explains."""
        return float(self._scores.score(self.without(cause), np.array(orders)).max())

    def left_without(self, cause: Candidate, other: Candidate) -> float:
        """Return the score of a place's comb without harmonics and sidebands of another."""
        gap = self.sidebands.turning_sideband(cause)[0]
        sides = np.concatenate([g * np.arange(-SIDEBANDS, SIDEBANDS + 1) for g in (1.0, gap)])
        lines = cause.order * np.arange(1, int(self._whole.top / cause.order) + 2)[:, None] + sides
        rest = self.spectra.silenced(lines.ravel(), 2.0 * self.spectra.step)
        return self._peak(other.place, rest)[2]

    def without(self, candidate: Candidate) -> OrderSpectra:
        """
        Return the spectra without the lines that a fault explains: harmonics and sidebands.

        A race fault is modulated with the shaft, a ball fault with the cage. The two impacts of a
        ball in each spin differ, so odd multiples of half its order show as well.
        """
        return self.spectra.silenced(self.sidebands.explained(candidate), 2.0 * self.spectra.step)

    def index_in_all_bands(self, candidate: Candidate) -> float:
        """Return the modulation index of a comb, with the bands of the variable compliance."""
        return self._index(self.spectra, candidate.order, 'any')[0]

    def _index(self, spectra: OrderSpectra, order: float, family: str) -> tuple[float, int]:
        """
        Return the modulation index of a comb in the strongest band that shows it, and that band.

        The first whitening has the bands. Lines are capped, so that beats of steady lines do not
        count. A healthy bearing excites its housing at the outer race's frequency and low
        multiples of it (variable compliance). So bands count for the outer race only if they begin
        above ``CARRIER`` multiples.
        """
        scores, _ = self._scores.bands(spectra, order)
        # Half of the bands remain in any case, for low sample rates.
        half, lowest = 0.5 * float(spectra.carrier.max()), 0.0
        if family == 'outer':
            lowest = min(CARRIER * order, half)
        power = np.zeros(spectra.excess.shape[1], np.float32)
        band = _strongest_band(
            spectra.excess, spectra.quiet, order, spectra.step, HARMONICS, scores[: len(power)],
            spectra.carrier, lowest, power,
        )  # fmt: skip
        return modulation_index(power[band]), band


@compiled(fast=FAST, borrows=True)
def _strongest_band(
    excess: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    order: float,
    step: float,
    harmonics: int,
    scores: NDArray[np.float32],
    carrier: NDArray[np.float32],
    lowest: float,
    power: NDArray[np.float32],
) -> int:
    """
    Return the band with the highest power of a comb, of the bands that show it.

    A band shows the comb if its score, (C,), is 3 or more, or the highest of all. The powers of
    the lines are added to ``power``, (C,). Bands with a carrier below ``lowest`` get no power.
    """
    last = len(excess) - 1
    for harmonic in range(1, harmonics + 1):
        middle = nearest_row(harmonic * order * (1.0 / step), len(excess))
        for beside in range(-1, 2):
            at = min(max(middle + beside, 0), last)
            if not hidden[at]:
                for c in range(len(power)):
                    power[c] += excess[at, c]
    highest_score, best = scores[0], -1
    for score in scores:
        highest_score = max(highest_score, score)
    least = min(highest_score, np.float32(3.0))
    for c in range(len(power)):
        if carrier[c] < lowest:
            power[c] = np.float32(0.0)
        if scores[c] >= least and (best < 0 or power[c] > power[best]):
            best = c
    return best
