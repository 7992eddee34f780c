# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Harmonics of the combs of one bearing: whether something else of the machine makes each."""

from __future__ import annotations

from dataclasses import replace
import math
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.combs.harmonics import (
    denser_series,
    height_beyond_whole,
    line_heights,
    masked_by_shaft,
    MISSING,
    missing_harmonics,
    spaced_by_shaft,
)
from bearing_twin.diagnosis.signal.lines import mean_height
from bearing_twin.diagnosis.signal.shaft import SHAFT_FOUND
from bearing_twin.diagnosis.thresholds import (
    HARMONICS,
    INDEX_STRIKE,
    LOAD_ZONE,
    MAINS_HZ,
    RIVAL,
    STEADY,
    UNLIKELY_SLIP,
)
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.diagnosis.combs.candidate import Candidate
    from bearing_twin.diagnosis.combs.comb import CombScores, OrderSpectra
    from bearing_twin.diagnosis.combs.comb_sidebands import CombSidebands
    from bearing_twin.diagnosis.combs.expected_orders import ExpectedOrders
    from bearing_twin.diagnosis.signal.shaft import ShaftSpeed
    from numpy.typing import NDArray


_SHARP = 1.5
"""Bins within which the lines of a shaft at a steady speed fall to two thirds of their score. They
do so within 1.1 bins in simulations, and not within 2.5 if the speed drifts by 3 % in 8 s."""
_SLIP_BINS = 12.0
"""Bins that the slips of a bearing under load spread over where a window tells a race from a whole
order: a line is as wide as 1.5 bins to either side, a quarter of these."""
_BEYOND = 1.0 / 3.0
"""Least height of the lines beyond a whole order over that on the side of a comb that is the skirt
of lines there. It is 1 in the mean for a part of a shaft whose speed moves, 0 for a race beside
the order; in windows of 8 s simulated ones have 0.37 and more, and up to 0.27."""


class CombHarmonics:
    """
    Harmonics of the combs of one bearing: whether something else of the machine makes each.

    Parameters
    ----------
    whole
        Envelope spectra over orders of the shaft.
    speed
        Refined shaft speed.
    expected
        Expected orders of the parts of the bearing.
    scores
        Scores of the spectra, with their null.
    sidebands
        Sidebands of the same combs.

    """

    def __init__(
        self,
        whole: OrderSpectra,
        speed: ShaftSpeed,
        expected: ExpectedOrders,
        scores: CombScores,
        sidebands: CombSidebands,
    ) -> None:
        self._whole, self._spectra = whole, whole.off_shaft
        self._expected, self._scores, self._sidebands = expected, scores, sidebands
        self._shaft_hz, self._tolerance = speed.shaft_hz, speed.tolerance
        # Six harmonics of the shaft give its speed within a sixth of a bin of the first.
        found = whole.step / 6.0 if speed.score >= SHAFT_FOUND else math.inf
        measured = speed.tolerance <= STEADY
        self._spread = 0.0 if measured else speed.spread
        self._precision = 0.0 if measured else min(speed.uncertainty, found)
        self._columns: dict[float, NDArray[np.intp]] = {}
        self._multiples: dict[float, int] = {}
        self._smears: dict[float, bool] = {}

    def columns(self, order: float) -> NDArray[np.intp]:
        """Return the bands in which the comb at an order is highest, one of each whitening."""
        if order not in self._columns:
            _, self._columns[order] = self._scores.bands(self._whole, order)
        return self._columns[order]

    def clear_columns(self, order: float) -> NDArray[np.intp]:
        """Return the bands in which the comb at an order is about as high as in the best one."""
        scores, highest = self._scores.bands(self._whole, order)
        most, rows = scores[highest][:, None], scores.reshape(len(highest), -1)
        return np.flatnonzero(rows >= np.minimum(most, most / RIVAL))

    def multiple(self, order: float) -> int:
        """Return the multiple of an order that is the true fundamental of its comb."""
        if order not in self._multiples:
            columns, hidden = self.columns(order), self._whole.at_shaft
            found = missing_harmonics(self._whole, order, columns, self.clear_columns, hidden)
            self._multiples[order] = found
        return self._multiples[order]

    def impacts(self, candidate: Candidate, first: int = 2, last: int = HARMONICS) -> float:
        """Return the mean log score, less noise, of some harmonics of a comb."""
        logs, hidden, step = self._whole.logs, self._whole.at_shaft, self._whole.step
        columns = self.columns(candidate.order)
        return mean_height(logs, hidden, candidate.order, step, (first, last), columns)

    def high_harmonics_ratio(self, candidate: Candidate) -> float:
        """Return the power of harmonics 5 to 8 of a comb over that of the first four."""
        lines = candidate.order * np.arange(1.0, 2.0 * HARMONICS + 1.0)
        power = self._spectra.line_power(lines, slice(candidate.band, candidate.band + 1))
        low, high = (half.sum() for half in np.split(power, 2))
        return float(high / max(low, 1e-30))

    def smooth(self, candidate: Candidate, *, masked: bool = False) -> bool:
        """
        Return whether a comb has the first harmonic, but neither the third nor the fourth.

        Impacts have all of them. The power of noise times 1 + a cos has two harmonics only. Lines
        at multiples of the shaft count only if they mask the comb (``masked``).
        """
        spectra = self._whole if masked else self._spectra
        lines = candidate.order * np.array([1.0, 3.0, 4.0])
        shown = masked | ~self._whole.at_shaft[spectra.rows(lines)]
        shown &= lines <= spectra.top
        first, *others = line_heights(spectra, lines, self.columns(candidate.order))
        others = [height for height, known in zip(others, shown[1:], strict=True) if known]
        return bool(shown[0] and others) and float(np.mean(others)) < MISSING * float(first)

    def is_healthy_modulation(self, candidate: Candidate, most: float) -> bool:
        """
        Return whether a comb is a smooth modulation by healthy parts, of an index up to ``most``.

        A comb that lacks harmonics belongs to a series at a multiple, which no part of the bearing
        makes. It is tested there, with any index.
        """
        order = candidate.order
        multiple = self.multiple(order)
        small = multiple > 1 or candidate.index <= most
        return small and self.smooth(replace(candidate, order=multiple * order))

    def masked_by_shaft(self, candidate: Candidate) -> bool:
        """Return whether a comb may be a multiple of the shaft, no higher than the others."""
        return masked_by_shaft(
            self._whole,
            candidate.order,
            self.columns(candidate.order),
            precision=self._precision,
            uncertainty=self._expected.uncertainty,
        )

    def half_turn(self, candidate: Candidate) -> bool:
        """Return whether a comb may lie on a multiple of half the order of the shaft."""
        slack = self._expected.uncertainty * candidate.order + 2.0 * self._spectra.step
        return abs(candidate.order - 0.5 * round(2.0 * candidate.order)) <= slack

    def whole_turns(self, candidate: Candidate) -> int:
        """
        Return the strikes a turn with which a part of the shaft would make a comb; 0 if none can.

        It can if the order is a whole number within the uncertainty of a speed that neither a
        measurement nor the lines of the shaft give, or if the comb smears over a whole number. A
        comb with the sidebands of a load zone is an inner race, unless they are as high as its
        harmonics and fit the shaft as well.
        """
        order, turns = candidate.order, round(candidate.order)
        inner = candidate.place == 'inner'
        high_sidebands = self._sidebands.has_high_shaft_sidebands(candidate)
        if inner and self._sidebands.turning_sideband(candidate)[1] * RIVAL >= LOAD_ZONE:
            if not self._spread or not high_sidebands:
                return 0
            columns = np.array([candidate.band])
            return turns if spaced_by_shaft(self._whole, order, columns, self._tolerance) else 0
        strikes = high_sidebands and not inner
        if not turns or (candidate.place == 'ball' and not strikes):
            return 0
        # Strikes once a turn have equally high lines, which look sharp if the speed moves a
        # little.
        told = self._spread <= (0.0 if strikes else _SHARP * self._whole.step)
        spread = self._spread if math.isfinite(self._spread) else 0.0
        uncertainty = self._expected.uncertainty
        slack = max(spread, uncertainty) if strikes else spread or uncertainty
        if told:
            return turns if self.smears_over_whole(candidate) else 0
        near = abs(order - turns) <= slack * order
        return turns if near or self._reaches(order, turns) else 0

    def smears_over_whole(self, candidate: Candidate) -> bool:
        """
        Return whether a comb is the skirt of lines at a whole order, at a speed that is known.

        A speed that moves smears the line n of a shaft n times as far as its first, so that the
        skirt passes the bins that are left out at multiples of the shaft. It smears to both sides.
        A race lies beside a whole order, and reaches it if its slip changes, but not as far beyond
        it. A short window does not tell.
        """
        order, turns = candidate.order, round(candidate.order)
        if order not in self._smears:
            parted = _SLIP_BINS * self._whole.step <= UNLIKELY_SLIP * order
            known = turns and parted and math.isfinite(self._spread)
            self._smears[order] = bool(known and self._reaches(order, turns)) and (
                # A speed that is not measured is as uncertain as its lines are wide.
                abs(order - turns) <= self._spread * order
                or height_beyond_whole(self._whole, order, self.columns(order)) >= _BEYOND
            )
        return self._smears[order]

    def _reaches(self, order: float, whole: float) -> bool:
        """Return whether a comb has half its score at all orders from its own to a whole one."""
        step = 0.25 * self._whole.step * (1.0 if whole > order else -1.0)
        z = self._scores.score(self._whole, np.arange(order, whole + 0.5 * step, step))
        return bool(len(z) == 0 or z.min() >= 0.5 * z[0])

    def mains_hz(self, candidate: Candidate) -> float:
        """
        Return the frequency of the mains, Hz, whose pulses may make a comb; 0 if none do.

        Rectifiers and converters pulse twice a period. A comb on a multiple of their series is
        theirs if the series is as high. A comb on the series itself cannot be told from a fault.
        """
        for hertz in MAINS_HZ:
            pulses = 2.0 * hertz / self._shaft_hz
            multiple = max(round(candidate.order / pulses), 1)
            if abs(candidate.order - multiple * pulses) > self._whole.step:
                continue
            z = candidate.z if multiple == 1 else self._score_near(pulses)
            if z * RIVAL > candidate.z:
                return hertz
        return 0.0

    def _score_near(self, order: float) -> float:
        """Return the score of the best comb within two bins of an order."""
        reach = 2.0 * self._whole.step
        grid = np.arange(order - reach, order + reach, 0.25 * self._whole.step)
        return float(self._scores.score(self._spectra, grid).max())

    def extraneous_order(self, candidate: Candidate) -> float:
        """
        Return the order of an extraneous series that shares lines with a comb; 0 without one.

        It shows by missing harmonics of the comb, or by unexplained lines between them.
        """
        order = candidate.order
        multiple = self.multiple(order)
        if multiple > 1:
            return multiple * order
        # A ball that strikes one race only has lines at its spin order, as high as its harmonics.
        own = 0.5 * order if candidate.place == 'ball' else order
        lower = self._sidebands.explained(candidate)
        if candidate.place == 'outer':
            cage = order / self._expected.bearing.n_balls
            lower = np.concatenate((lower, np.arange(cage, self._whole.top, cage)))
        width = 2.0 * self._whole.step
        mine = self._whole.near(np.arange(own, self._whole.top, own), width)
        sidebands = self._whole.near(lower, width)
        return denser_series(
            self._whole,
            order,
            self.columns(order),
            self._whole.at_shaft,
            mine,
            sidebands,
            self._expected.uncertainty,
            sharp=candidate.index >= INDEX_STRIKE,
        )
