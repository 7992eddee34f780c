# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Search for the combs of one bearing: the best of each fault place, and what surrounds it."""

from __future__ import annotations

from dataclasses import replace
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import fault_orders, PLACES
from bearing_twin.diagnosis.combs.candidate import Candidate, UNTESTED
from bearing_twin.diagnosis.combs.comb import comb_scores, OrderSpectra
from bearing_twin.diagnosis.combs.comb_sums import highest_off, likeliest
from bearing_twin.diagnosis.combs.harmonics import (
    denser_series,
    line_heights,
    masked_by_shaft,
    MISSING,
    missing_harmonics,
    spaced_by_shaft,
)
from bearing_twin.diagnosis.combs.sidebands import (
    comb_powers,
    modulation_index,
    sideband_ratio,
    sideband_ratios,
)
from bearing_twin.diagnosis.signal.gate import HEALTHY_TURNS
from bearing_twin.diagnosis.signal.lines import mean_height
from bearing_twin.diagnosis.signal.shaft import SHAFT_FOUND
from bearing_twin.diagnosis.signal.spectra import WHITENINGS
from bearing_twin.diagnosis.thresholds import (
    HARMONICS,
    INDEX_FAULT,
    INDEX_STRIKE,
    JOINT_SLIP,
    LOAD_ZONE,
    MAINS_HZ,
    RIVAL,
    SLIP,
    SLIP_COST,
    SLOW_CAGE,
    STEADY,
    SWAY,
    Z_ELSEWHERE,
    Z_FAULT,
)
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.signal.shaft import ShaftSpeed
    from numpy.typing import NDArray


_SIDEBANDS = 4
_RACES = ('inner', 'outer')
_CAGES = (0.33, 0.47)
"""Orders between which the cages of all bearings of the catalogue turn."""
_CHANCE = (0.52, 0.62)
"""Orders that no part turns at, nor at half of them, as wide as ``_CAGES``."""
_SHARP = 1.5
"""Bins within which a shaft at a steady speed is two thirds as clear. Simulated ones are within
1.1, and those whose speed drifts by 3 % in 8 s are not within 2.5."""


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
        self.bearing = bearing
        self.orders = fault_orders(bearing)
        self._slipped = fault_orders(bearing, SLIP[1])
        self._n_balls = bearing.n_balls
        self._uncertainty, self._tolerance = speed.uncertainty, speed.tolerance
        # Six harmonics of the shaft place its speed within a sixth of a bin of the first.
        found = spectra.step / 6.0 if speed.score >= SHAFT_FOUND else math.inf
        measured = speed.tolerance <= STEADY
        self._spread = 0.0 if measured else speed.spread
        self._precision = 0.0 if measured else min(speed.uncertainty, found)
        self.shaft_hz = speed.shaft_hz
        self.sample_rate = 2.0 * spectra.highest * speed.shaft_hz
        self.top = len(spectra.logs) * spectra.step
        shaft = np.arange(1.0, self.top + 1.0)
        self._silent = spectra.near(shaft, 1.25 * spectra.step)
        self.spectra = replace(spectra, hidden=spectra.quiet | self._silent)
        self._all = spectra
        self._columns: dict[float, NDArray[np.intp]] = {}
        self._multiples: dict[float, int] = {}
        self._sidebands: dict[tuple[float, int, float, float], tuple[float, float]] = {}
        self._highest = 1.08 * max(self.orders.impacts(name) for name in PLACES)
        self._scores = comb_scores(self.spectra, self._highest, len(WHITENINGS))

    def best(
        self, place: str, spectra: OrderSpectra | None = None, slips: tuple[float, float] = SLIP
    ) -> Candidate:
        """Best comb of a place within a range of slip; in other spectra where they are given."""
        spectra = spectra or self.spectra
        found, slip, z = self._peak(place, spectra, slips)
        index, band = self._index(spectra, found, place)
        harmonics = found * np.arange(1, HARMONICS + 1)
        alive = int((~self._silent[spectra.rows(harmonics)]).sum())
        tested = place in _RACES and z >= Z_FAULT
        sidebands = sideband_ratio(spectra, found, band) if tested else UNTESTED
        return Candidate(place, found, slip, z, index, band, alive, sidebands)

    def _peak(
        self, place: str, spectra: OrderSpectra, slips: tuple[float, float] = SLIP
    ) -> tuple[float, float, float]:
        """Order, slip and score of the best comb of a place within a range of slip."""
        order, slope, grid = self._slipping(place, slips)
        z = self._scores.score(spectra, grid)
        return likeliest(z, grid, order, self._uncertainty * order, slope, SLIP_COST)

    def _slipping(
        self, place: str, slips: tuple[float, float]
    ) -> tuple[float, float, NDArray[np.float64]]:
        """Order of a place, its change by a slip of 1, and the orders in a range of slip."""
        order = self.orders.impacts(place)
        slope = (self._slipped.impacts(place) - order) / SLIP[1]
        ends = sorted(order + slope * slip for slip in slips)
        slack = self._uncertainty * order
        # Half a bin of the highest harmonic apart, and at least one.
        grid = np.arange(ends[0] - slack, ends[1] + slack, 0.5 * self.spectra.step / HARMONICS)
        return order, slope, grid if len(grid) else np.array([order])

    def strongest_anywhere(self, *, beyond: bool = False) -> Candidate:
        """
        Best comb at any order off the multiples of shaft and cage, whatever makes it.

        Parameters
        ----------
        beyond
            Whether to look beyond the orders of this bearing as well, where none below them is
            significant: as far as three harmonics reach.

        """
        scores = self._scores
        found = self._off_shaft(scores.grid, scores.z, self.spectra)
        if hertz := self.mains_hz(found):
            # What the mains make is no impact, and may hide one.
            pulses = np.arange(1.0, self.top) * 2.0 * hertz / self.shaft_hz
            rest = self.spectra.silenced(pulses, 1.25 * self.spectra.step)
            found = self._off_shaft(scores.grid, scores.score(rest, scores.grid), rest)
        if beyond and found.z < Z_ELSEWHERE:
            step = scores.grid[1] - scores.grid[0]
            grid = np.arange(scores.grid[-1], self.top / 3.0, step)
            further = self._off_shaft(grid, scores.score(self.spectra, grid), self.spectra)
            found = max(found, further, key=lambda c: c.z)
        # Of impacts beyond the orders looked at a fraction shows, without its first harmonics.
        multiple = self._multiple(found.order)
        return replace(found, order=multiple * found.order) if multiple > 1 else found

    def _off_shaft(
        self, grid: NDArray[np.float64], z: NDArray[np.float64], spectra: OrderSpectra
    ) -> Candidate:
        """Best comb of a grid off the multiples of the shaft and off the turns of the cage."""
        # A ball in and out of the load has the lines of the cage, so that they are of the bearing.
        cage = self._cage_orders()
        at = highest_off(z, grid, self._uncertainty, 1.25 * self.spectra.step, *cage)
        order = float(grid[at])
        index, band = self._index(spectra, order, 'inner')
        return Candidate('elsewhere', order, 0.0, float(z[at]), index, band)

    def index_in_all_bands(self, candidate: Candidate) -> float:
        """Modulation index of a comb, also in the bands of the variable compliance."""
        return self._index(self.spectra, candidate.order, 'any')[0]

    def _index(self, spectra: OrderSpectra, order: float, family: str) -> tuple[float, int]:
        """Modulation index of a comb, and the band that it is of, from the first whitening."""
        scores, _ = self._scores.bands(spectra, order)
        return modulation_index(spectra, order, scores[: spectra.excess.shape[1]], family)

    def second_look(self, candidate: Candidate) -> Candidate:
        """
        Score a comb against the null without the lines that it explains.

        The sidebands of a strong comb are part of the null, and widen it.
        """
        scores = comb_scores(self.without(candidate), self._highest, len(WHITENINGS))
        z = scores.score(self.spectra, np.array([candidate.order]))
        found = replace(candidate, z=float(z[0]) - (candidate.slip / SLIP_COST) ** 2)
        if found.place not in _RACES:
            return found
        return replace(found, shaft_sideband_ratio=self.shaft_sideband_ratio(found))

    def left_without(self, cause: Candidate, other: Candidate) -> float:
        """Score of a comb of a place without the lines of another, whatever makes that one."""
        gap = self.turning_sideband(cause)[0]
        sides = np.concatenate([g * np.arange(-_SIDEBANDS, _SIDEBANDS + 1) for g in (1.0, gap)])
        lines = cause.order * np.arange(1, int(self.top / cause.order) + 2)[:, None] + sides
        rest = self.spectra.silenced(lines.ravel(), 2.0 * self.spectra.step)
        return self._peak(other.place, rest)[2]

    def high_harmonics_ratio(self, candidate: Candidate) -> float:
        """Power of the fifth to eighth harmonic of a comb over that of the first four."""
        lines = candidate.order * np.arange(1.0, 2.0 * HARMONICS + 1.0)
        power = self.spectra.line_power(lines, slice(candidate.band, candidate.band + 1))
        low, high = (half.sum() for half in np.split(power, 2))
        return float(high / max(low, 1e-30))

    def score_without(self, cause: Candidate, other: Candidate) -> float:
        """Score of a comb at its order without the lines that a fault of the bearing explains."""
        return float(self._scores.score(self.without(cause), np.array([other.order]))[0])

    def impacts(self, candidate: Candidate) -> float:
        """Mean log score, noise taken off, of the second to fourth harmonic of a comb."""
        logs, step, columns = self._all.logs, self._all.step, self.columns(candidate.order)
        return mean_height(logs, self._silent, candidate.order, step, (2, HARMONICS), columns)

    def smooth(self, candidate: Candidate, *, masked: bool = False) -> bool:
        """
        Whether a comb has its first harmonic, and neither the third nor the fourth.

        Impacts have them. Noise times 1 + a cos has power of two harmonics only.
        Lines that are multiples of the shaft's speed count where the comb is ``masked`` by them.
        """
        spectra = self._all if masked else self.spectra
        lines = candidate.order * np.array([1.0, 3.0, 4.0])
        shown = (masked | ~self._silent[self.spectra.rows(lines)]) & (lines <= self.top)
        first, *others = line_heights(spectra, lines, self.columns(candidate.order))
        others = [height for height, known in zip(others, shown[1:], strict=True) if known]
        return bool(shown[0] and others) and float(np.mean(others)) < MISSING * float(first)

    def sound(self, candidate: Candidate, most: float) -> bool:
        """
        Whether a comb is a smooth modulation as sound parts make it, of an index up to ``most``.

        One that lacks harmonics is of a series at a multiple, which no part of the bearing makes.
        """
        order = candidate.order
        multiple = self._multiple(order)
        small = multiple > 1 or candidate.index <= most
        return small and self.smooth(replace(candidate, order=multiple * order))

    def half_turn(self, candidate: Candidate) -> bool:
        """Whether a comb may lie on a multiple of half a turn of the shaft."""
        slack = self._uncertainty * candidate.order + 2.0 * self.spectra.step
        return abs(candidate.order - 0.5 * round(2.0 * candidate.order)) <= slack

    def whole_turns(self, candidate: Candidate) -> int:
        """
        How often a part of the shaft would strike in a turn to make a comb; 0 if none can.

        It can at a whole number within the uncertainty of a speed that neither a measurement nor
        the lines of the shaft tell, and where the speed moves so that the comb smears over it.
        What passes a load zone is an inner race, unless its sidebands are as high as its own lines
        and fit the shaft as well.
        """
        order, turns = candidate.order, round(candidate.order)
        if candidate.place == 'inner' and self.turning_sideband(candidate)[1] * RIVAL >= LOAD_ZONE:
            if not self._spread or not self.alike(candidate):
                return 0
            columns = np.array([candidate.band])
            return turns if spaced_by_shaft(self._all, order, columns, self._tolerance) else 0
        # Strikes once a turn have all lines alike, and look sharp where the speed moves a little.
        strikes = candidate.place != 'inner' and self.alike(candidate)
        if not turns or self._spread <= (0.0 if strikes else _SHARP * self._all.step):
            return 0
        spread = self._spread if math.isfinite(self._spread) else 0.0
        slack = max(spread, self._uncertainty) if strikes else spread or self._uncertainty
        if abs(order - turns) > slack * order and not self._reaches(order, turns):
            return 0
        return turns if strikes or candidate.place != 'ball' else 0

    def alike(self, candidate: Candidate) -> bool:
        """Whether the lines a turn beside a comb are as high as its own, as of a loose shaft."""
        return self.turning_sideband(candidate)[1] * RIVAL >= 1.0

    def _reaches(self, order: float, whole: float) -> bool:
        """Whether a comb is half as clear at all orders from its own to a whole one."""
        step = 0.25 * self._all.step * (1.0 if whole > order else -1.0)
        z = self._scores.score(self._all, np.arange(order, whole + 0.5 * step, step))
        return bool(len(z) == 0 or z.min() >= 0.5 * z[0])

    def shaft_sideband_ratio(self, candidate: Candidate) -> float:
        """Mean amplitude of the shaft sidebands of a comb over that of its harmonics."""
        return sideband_ratio(self.spectra, candidate.order, candidate.band)

    def inner_race_ratio(self, other: Candidate) -> float:
        """
        Amplitude of the inner race's comb over that of another comb; 0 where they are unrelated.

        The other comb may be a shaft sideband of the inner race's if that one, an integer of
        orders beside it, lies where a slip about as likely may put it.
        """
        order = self.orders.bpfi
        slope = (self._slipped.bpfi - order) / SLIP[1]
        # Not much less likely than the slip of the outer race that it would replace.
        likely = math.hypot(other.slip, SLIP_COST)
        slack = self._uncertainty * order + 2.0 * self._all.step
        first = math.ceil(order + slope * max(SLIP[0], -likely) - slack - other.order)
        last = math.floor(order + slope * min(SLIP[1], likely) + slack - other.order)
        sides = [side for side in range(first, last + 1) if side]
        if not sides:
            return 0.0
        # Harmonics of the inner race that the shaft masks count here.
        near = np.arange(-2.0, 2.25, 0.25) * self._all.step
        beside = np.array(sides, np.float64)[:, None] + near
        own, *powers = comb_powers(
            self._all, other.order + np.append(0.0, beside), other.band
        ).tolist()
        return math.sqrt(max(powers) / max(own, 1e-30))

    @property
    def speed_known(self) -> bool:
        """Whether the shaft speed is known well enough to compare slips and place sidebands."""
        return self._uncertainty <= STEADY

    def masked_candidate(self, place: str) -> Candidate | None:
        """
        Comb of a place that shows, but coincides with harmonics of the shaft.

        It does at any slip that the place may have: an order that is not a whole number slips on
        to one. Impacts have all harmonics there; blades, vanes and lobes pulse smoothly.
        """
        _, _, grid = self._slipping(place, SLIP)
        whole = grid[self._is_whole(grid)]
        # Most have no such order in reach, or nothing there: the others need not be looked at.
        if not len(whole) or self._scores.score(self._all, whole).max() < Z_FAULT:
            return None
        found = self.best(place, self._all)
        shown = found.z >= Z_FAULT and found.index >= INDEX_FAULT and self._is_whole(found.order)
        return found if shown and not self.smooth(found, masked=True) else None

    def _is_whole(self, orders: Any) -> Any:
        """Whether orders coincide with multiples of the shaft."""
        return abs(orders - np.rint(orders)) <= self._uncertainty * orders + 1.25 * self._all.step

    def without(self, candidate: Candidate) -> OrderSpectra:
        """
        Spectra without the lines that a fault explains: its harmonics and their sidebands.

        A race fault is modulated at the shaft's speed, a ball fault at the cage's. The two
        impacts of a ball in each spin differ, so odd multiples of half its order show as well.
        """
        return self.spectra.silenced(self._explained(candidate), 2.0 * self.spectra.step)

    def _explained(self, candidate: Candidate) -> NDArray[np.float64]:
        """Orders of the lines that a fault explains."""
        order, reach, gap = candidate.order, _SIDEBANDS, 1.0
        if candidate.place == 'ball':
            order, gap = 0.5 * order, self.cage_sideband(candidate)[0]
        elif candidate.place == 'cage':
            reach = 0
        elif not self.speed_known:
            gap = self._highest_sideband(candidate, 1.0, 1.0)[0]
        sides = gap * np.arange(-reach, reach + 1)
        lines = order * np.arange(1, int(self.top / order) + 2)[:, None] + sides
        return np.asarray(lines.ravel())

    def cage_sideband(self, candidate: Candidate) -> tuple[float, float]:
        """Order of the cage at which a comb has its highest sidebands, and their ratio."""
        slope = (self._slipped.ftf - self.orders.ftf) / SLIP[1]
        ends = self.orders.ftf + slope * (candidate.slip + np.array([JOINT_SLIP, -JOINT_SLIP]))
        return self._highest_sideband(candidate, ends[0], ends[1])

    def turning_sideband(self, candidate: Candidate) -> tuple[float, float]:
        """Order near one turn of the shaft with the highest sidebands, and their ratio."""
        return self._highest_sideband(candidate, 0.9, 1.1)

    def _highest_sideband(
        self, candidate: Candidate, low: float, high: float
    ) -> tuple[float, float]:
        """Gap between two orders at which a comb has its highest sidebands, and their ratio."""
        key = candidate.order, candidate.band, low, high
        if key not in self._sidebands:
            slack = self._uncertainty * high
            # Two gaps beside a harmonic: half a bin more moves the farther sidebands by one.
            gaps = np.arange(low - slack, high + slack + self._all.step, 0.5 * self._all.step)
            ratios = sideband_ratios(self.spectra, candidate.order, candidate.band, gaps)
            best = int(np.argmax(ratios))
            self._sidebands[key] = float(gaps[best]), float(ratios[best])
        return self._sidebands[key]

    def cage_sideband_order(self, candidate: Candidate) -> float:
        """
        Order of the cage by which the sidebands of a race's comb are spaced, 0 if they are not.

        A race does not move with the cage. Such a comb belongs to a ball or to the cage, at a
        slip that was not expected.
        """
        return self._beside_race(candidate, *self._cage_orders())

    def another_cage_order(self, candidate: Candidate) -> float:
        """Order of any bearing's cage by which the sidebands of a race are spaced, 0 if none."""
        return self._beside_race(candidate, *_CAGES)

    def _beside_race(self, candidate: Candidate, low: float, high: float) -> float:
        """
        Gap between two orders of the sidebands of a race, 0 if those of its load are higher.

        Faint ones count where a window resolves them, and where those of the shaft and what noise
        reaches at other gaps are lower by a factor 2: balls of several sizes modulate an outer
        race with the cage as well, beside the unbalance.
        """
        if candidate.place not in _RACES:
            return 0.0
        gap, ratio = self._highest_sideband(candidate, low, high)
        least = max(LOAD_ZONE, candidate.shaft_sideband_ratio)
        if SWAY < ratio <= least and self.spectra.step * HEALTHY_TURNS <= 1.0:
            chance = self._highest_sideband(candidate, *_CHANCE)[1]
            # The given shaft speed may be wrong.
            least = RIVAL * RIVAL * max(self.turning_sideband(candidate)[1], chance)
        return gap if ratio > least else 0.0

    def cage_series_order(self, candidate: Candidate) -> float:
        """
        Order of the cage whose harmonic series makes the comb of a ball, 0 if none does.

        An impact once a cage turn has all harmonics equally high. The sidebands of a ball under a
        load that is spread over some balls fade. The lines three and six, five and ten cage
        orders beside the comb tell.
        """
        if candidate.place != 'ball':
            return 0.0
        gap, near = self._any_cage_sideband(candidate)
        far = (
            sideband_ratio(self.spectra, candidate.order, candidate.band, k * gap) for k in (3, 5)
        )
        return gap if min(near, *far) * RIVAL > 1.0 else 0.0

    def _any_cage_sideband(self, candidate: Candidate) -> tuple[float, float]:
        """Highest sidebands at any speed that a cage may have: their gap and their ratio."""
        return self._highest_sideband(candidate, *self._cage_orders())

    def _cage_orders(self) -> tuple[float, float]:
        """Lowest and highest order at which the cage may turn."""
        slope = (self._slipped.ftf - self.orders.ftf) / SLIP[1]
        return self.orders.ftf + slope * SLOW_CAGE, self.orders.ftf + slope * SLIP[0]

    def shaft_sidebands_dominate(self, candidate: Candidate) -> bool:
        """
        Whether a ball's comb has sidebands of the shaft that are higher than those of the cage.

        A ball moves with the cage. Such a comb may belong to the inner race, at a slip that was
        not expected.
        """
        if candidate.place != 'ball':
            return False
        shaft = self.shaft_sideband_ratio(candidate)
        return shaft > max(LOAD_ZONE, RIVAL * self.cage_sideband(candidate)[1])

    def extraneous_order(self, candidate: Candidate) -> float:
        """
        Order of the harmonic series that a comb merely shares lines with, 0 if it is its own.

        Harmonics of the comb are missing, or lines that it does not explain lie between them.
        """
        order = candidate.order
        multiple = self._multiple(order)
        if multiple > 1:
            return multiple * order
        # A ball that strikes one race only has lines at its spin, as high as its harmonics.
        own = 0.5 * order if candidate.place == 'ball' else order
        lower = self._explained(candidate)
        if candidate.place == 'outer':
            cage = order / self._n_balls
            lower = np.concatenate((lower, np.arange(cage, self.top, cage)))
        width = 2.0 * self._all.step
        mine = self._all.near(np.arange(own, self.top, own), width)
        sidebands = self._all.near(lower, width)
        return denser_series(
            self._all,
            order,
            self.columns(order),
            self._silent,
            mine,
            sidebands,
            self._uncertainty,
            sharp=candidate.index >= INDEX_STRIKE,
        )

    def masked_by_shaft(self, candidate: Candidate) -> bool:
        """Whether a comb may be a multiple of the shaft, no higher than the other multiples."""
        return masked_by_shaft(
            self._all,
            candidate.order,
            self.columns(candidate.order),
            precision=self._precision,
            uncertainty=self._uncertainty,
        )

    def columns(self, order: float) -> NDArray[np.intp]:
        """Bands in which the comb at an order is highest, one of each whitening."""
        if order not in self._columns:
            _, self._columns[order] = self._scores.bands(self._all, order)
        return self._columns[order]

    def clear_columns(self, order: float) -> NDArray[np.intp]:
        """Bands in which the comb at an order is about as high as in the highest."""
        scores, highest = self._scores.bands(self._all, order)
        parts = np.split(scores, len(highest))
        shown = [part >= min(part.max(), part.max() / RIVAL) for part in parts]
        return np.flatnonzero(np.concatenate(shown))

    def _multiple(self, order: float) -> int:
        """Multiple of an order at which the true fundamental of its comb lies."""
        if order not in self._multiples:
            columns = self.columns(order)
            found = missing_harmonics(self._all, order, columns, self.clear_columns, self._silent)
            self._multiples[order] = found
        return self._multiples[order]

    def mains_hz(self, candidate: Candidate) -> float:
        """
        Frequency of the mains, Hz, whose pulses may make a comb; 0 if none do.

        Rectifiers and converters pulse twice a period. Their series is then as high as its
        multiple. Where the comb is the series itself, nothing tells it from a fault.
        """
        for hertz in MAINS_HZ:
            pulses = 2.0 * hertz / self.shaft_hz
            multiple = max(round(candidate.order / pulses), 1)
            if abs(candidate.order - multiple * pulses) > self._all.step:
                continue
            z = candidate.z if multiple == 1 else self._score_near(pulses)
            if z * RIVAL > candidate.z:
                return hertz
        return 0.0

    def _score_near(self, order: float) -> float:
        """Score of the best comb within two bins of an order."""
        reach = 2.0 * self._all.step
        grid = np.arange(order - reach, order + reach, 0.25 * self._all.step)
        return float(self._scores.score(self.spectra, grid).max())

    def sideband_owner(self, one: Candidate, other: Candidate) -> Candidate | None:
        """
        Which of two candidates that claim one comb its sidebands fit; None where they fit neither.

        An inner race is modulated by the shaft, a ball by the cage, an outer race by neither.
        """
        shaft = sideband_ratio(self.spectra, one.order, one.band)
        claims = {c.place: c for c in (one, other)}
        cage = self.cage_sideband(claims.get('ball', one))[1]
        heights = {'inner': shaft, 'ball': cage, 'outer': LOAD_ZONE / RIVAL}
        low, high = sorted(claims, key=lambda place: heights.get(place, 0.0))
        return claims[high] if heights.get(high, 0.0) > RIVAL * heights.get(low, 0.0) else None

    def joint_slips(self, primary: Candidate) -> tuple[float, float]:
        """Slip that another fault of the same bearing may have, given the primary one's."""
        if not self.speed_known or primary.place == 'cage':
            return SLIP
        return primary.slip - JOINT_SLIP, primary.slip + JOINT_SLIP
