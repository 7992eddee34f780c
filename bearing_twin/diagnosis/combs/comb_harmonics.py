# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Harmonics of the combs of one bearing: whether something else of the machine makes each."""

from __future__ import annotations

from dataclasses import replace
import math
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.combs.harmonics import (
    denser_series,
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
"""Bins within which a shaft at a steady speed is two thirds as clear. Simulated ones are within
1.1, and those whose speed drifts by 3 % in 8 s are not within 2.5."""


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
        Where the parts of the bearing show in the spectra.
    scores
        What the spectra are scored by.
    sidebands
        Those of the same combs.

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
        # Six harmonics of the shaft place its speed within a sixth of a bin of the first.
        found = whole.step / 6.0 if speed.score >= SHAFT_FOUND else math.inf
        measured = speed.tolerance <= STEADY
        self._spread = 0.0 if measured else speed.spread
        self._precision = 0.0 if measured else min(speed.uncertainty, found)
        self._columns: dict[float, NDArray[np.intp]] = {}
        self._multiples: dict[float, int] = {}

    def columns(self, order: float) -> NDArray[np.intp]:
        """Bands in which the comb at an order is highest, one of each whitening."""
        if order not in self._columns:
            _, self._columns[order] = self._scores.bands(self._whole, order)
        return self._columns[order]

    def clear_columns(self, order: float) -> NDArray[np.intp]:
        """Bands in which the comb at an order is about as high as in the highest."""
        scores, highest = self._scores.bands(self._whole, order)
        parts = np.split(scores, len(highest))
        shown = [part >= min(part.max(), part.max() / RIVAL) for part in parts]
        return np.flatnonzero(np.concatenate(shown))

    def multiple(self, order: float) -> int:
        """Multiple of an order at which the true fundamental of its comb lies."""
        if order not in self._multiples:
            columns, hidden = self.columns(order), self._whole.at_shaft
            found = missing_harmonics(self._whole, order, columns, self.clear_columns, hidden)
            self._multiples[order] = found
        return self._multiples[order]

    def impacts(self, candidate: Candidate) -> float:
        """Mean log score, noise taken off, of the second to fourth harmonic of a comb."""
        logs, hidden, step = self._whole.logs, self._whole.at_shaft, self._whole.step
        columns = self.columns(candidate.order)
        return mean_height(logs, hidden, candidate.order, step, (2, HARMONICS), columns)

    def high_harmonics_ratio(self, candidate: Candidate) -> float:
        """Power of the fifth to eighth harmonic of a comb over that of the first four."""
        lines = candidate.order * np.arange(1.0, 2.0 * HARMONICS + 1.0)
        power = self._spectra.line_power(lines, slice(candidate.band, candidate.band + 1))
        low, high = (half.sum() for half in np.split(power, 2))
        return float(high / max(low, 1e-30))

    def smooth(self, candidate: Candidate, *, masked: bool = False) -> bool:
        """
        Whether a comb has its first harmonic, and neither the third nor the fourth.

        Impacts have them. Noise times 1 + a cos has power of two harmonics only.
        Lines that are multiples of the shaft's speed count where the comb is ``masked`` by them.
        """
        spectra = self._whole if masked else self._spectra
        lines = candidate.order * np.array([1.0, 3.0, 4.0])
        shown = masked | ~self._whole.at_shaft[spectra.rows(lines)]
        shown &= lines <= spectra.top
        first, *others = line_heights(spectra, lines, self.columns(candidate.order))
        others = [height for height, known in zip(others, shown[1:], strict=True) if known]
        return bool(shown[0] and others) and float(np.mean(others)) < MISSING * float(first)

    def sound(self, candidate: Candidate, most: float) -> bool:
        """
        Whether a comb is a smooth modulation as sound parts make it, of an index up to ``most``.

        One that lacks harmonics is of a series at a multiple, which no part of the bearing makes.
        """
        order = candidate.order
        multiple = self.multiple(order)
        small = multiple > 1 or candidate.index <= most
        return small and self.smooth(replace(candidate, order=multiple * order))

    def masked_by_shaft(self, candidate: Candidate) -> bool:
        """Whether a comb may be a multiple of the shaft, no higher than the other multiples."""
        return masked_by_shaft(
            self._whole,
            candidate.order,
            self.columns(candidate.order),
            precision=self._precision,
            uncertainty=self._expected.uncertainty,
        )

    def half_turn(self, candidate: Candidate) -> bool:
        """Whether a comb may lie on a multiple of half a turn of the shaft."""
        slack = self._expected.uncertainty * candidate.order + 2.0 * self._spectra.step
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
        inner, alike = candidate.place == 'inner', self._sidebands.alike(candidate)
        if inner and self._sidebands.turning_sideband(candidate)[1] * RIVAL >= LOAD_ZONE:
            if not self._spread or not alike:
                return 0
            columns = np.array([candidate.band])
            return turns if spaced_by_shaft(self._whole, order, columns, self._tolerance) else 0
        # Strikes once a turn have all lines alike, and look sharp where the speed moves a little.
        strikes = alike and not inner
        if not turns or self._spread <= (0.0 if strikes else _SHARP * self._whole.step):
            return 0
        spread = self._spread if math.isfinite(self._spread) else 0.0
        uncertainty = self._expected.uncertainty
        slack = max(spread, uncertainty) if strikes else spread or uncertainty
        if abs(order - turns) > slack * order and not self._reaches(order, turns):
            return 0
        return turns if strikes or candidate.place != 'ball' else 0

    def _reaches(self, order: float, whole: float) -> bool:
        """Whether a comb is half as clear at all orders from its own to a whole one."""
        step = 0.25 * self._whole.step * (1.0 if whole > order else -1.0)
        z = self._scores.score(self._whole, np.arange(order, whole + 0.5 * step, step))
        return bool(len(z) == 0 or z.min() >= 0.5 * z[0])

    def mains_hz(self, candidate: Candidate) -> float:
        """
        Frequency of the mains, Hz, whose pulses may make a comb; 0 if none do.

        Rectifiers and converters pulse twice a period. Their series is then as high as its
        multiple. Where the comb is the series itself, nothing tells it from a fault.
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
        """Score of the best comb within two bins of an order."""
        reach = 2.0 * self._whole.step
        grid = np.arange(order - reach, order + reach, 0.25 * self._whole.step)
        return float(self._scores.score(self._spectra, grid).max())

    def extraneous_order(self, candidate: Candidate) -> float:
        """
        Order of the harmonic series that a comb merely shares lines with, 0 if it is its own.

        Harmonics of the comb are missing, or lines that it does not explain lie between them.
        """
        order = candidate.order
        multiple = self.multiple(order)
        if multiple > 1:
            return multiple * order
        # A ball that strikes one race only has lines at its spin, as high as its harmonics.
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
