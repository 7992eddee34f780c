# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Harmonics of the combs of one bearing: whether something else of the machine makes each.

The searched range of slip of a fault may hold the fourth, fifth or tenth harmonic of a gear, a
belt or the shaft. Two signs show it: missing harmonics of the comb, and lines between them.
"""

from __future__ import annotations

from dataclasses import replace
import math
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.signal.lines import mean_height, nearest_row, row_height
from bearing_twin.diagnosis.signal.shaft import SHAFT_FOUND
from bearing_twin.diagnosis.thresholds import (
    HARMONICS,
    INDEX_STRIKE,
    LOAD_ZONE,
    MAINS_HZ,
    RIVAL,
    STEADY,
    SWAY,
    UNLIKELY_SLIP,
)
from bearing_twin.numerics.compiled import compiled, FAST
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.diagnosis.combs.candidate import Candidate
    from bearing_twin.diagnosis.combs.comb import CombScores, OrderSpectra
    from bearing_twin.diagnosis.combs.expected_orders import ExpectedOrders
    from bearing_twin.diagnosis.combs.sidebands import CombSidebands
    from bearing_twin.diagnosis.signal.shaft import ShaftSpeed


_SPREAD = 0.42
"""Standard deviation of log(1 + E) for E ~ Exp(1), one window."""

_CHANCE = 4.0
"""Standard deviations that noise between the harmonics of some fifty combs does not reach."""

_SHARE = 0.5
"""Threshold of the height of unexplained lines between the harmonics, over the height of the
harmonics: this ratio is 0 for an independent comb and 1 for a part of a denser series."""

_ALIKE = 0.69
"""Difference of mean log score up to which the lines between the harmonics are as high as the
harmonics: 3 dB of power. The sidebands of a load that varies as 1 + cos are 6 dB lower."""

MISSING = 0.25
"""Height of harmonics, relative to that of their multiples, below which they are missing: half of
``_SHARE``, because one or two harmonics of a faint comb are uncertain by half their height. Pulses
at a multiple of an order are below it, faults are not."""

_APART = 2.0
"""Least difference between sideband heights at two spacings, standard deviations."""

_WIDEST = 12
"""Bins to either side of a whole order in which the smeared lines of a shaft are looked for."""

_SLOWEST = 0.12
"""Lowest fundamental order of a denser series."""

_FEWEST = 4
"""Least number of lines between the harmonics."""

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
        self._measured = measured
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

    def _heights(self, lines: NDArray[np.floating], order: float) -> NDArray[np.float64]:
        """Return the mean log score of lines, less that of noise, where a comb is highest."""
        return _line_heights(self._whole, lines, self.columns(order))

    def multiple(self, order: float) -> int:
        """
        Return the multiple of an order that is the true fundamental of its comb.

        If only the second and fourth harmonic show, or only the third, or only the fourth, the
        comb belongs to the series of that multiple. This is tested in all bands in which that
        series is clear. In the bands in which the comb is highest, chance raises the missing
        harmonics: there they need only be less than half as high.
        """
        if order not in self._multiples:
            heights = self._unshared(order, self.columns(order))
            self._multiples[order] = next(
                (
                    multiple
                    for multiple in range(HARMONICS, 1, -1)
                    if heights[multiple - 1] < _SHARE
                    and self.unshared_height(order, multiple) < MISSING
                ),
                1,
            )
        return self._multiples[order]

    def unshared_height(self, order: float, multiple: int) -> float:
        """
        Return the height of the harmonics that the series of a multiple lacks, over the others'.

        It is 0 for pulses at the multiple, 1 for impacts at the order, and infinite if no harmonic
        is shared. The bands are those in which the series is about as high as in its best one.
        """
        scores, highest = self._scores.bands(self._whole, multiple * order)
        most, rows = scores[highest][:, None], scores.reshape(len(highest), -1)
        clear = np.flatnonzero(rows >= np.minimum(most, most / RIVAL))
        return float(self._unshared(order, clear)[multiple - 1])

    def _unshared(self, order: float, columns: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return the unshared heights for the multiples from 1 to ``HARMONICS``."""
        ratios, whole = np.empty(HARMONICS), self._whole
        _unshared_heights(whole.logs, whole.at_shaft, order, whole.step, columns, ratios)
        return ratios

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
        first, *others = self._heights(lines, candidate.order)
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
        """
        Return whether a comb lies on the lines of an impact once a turn, or on their skirts.

        The other multiples of the shaft are then as high as those at the harmonics of the comb.
        The first two multiples do not count: unbalance and misalignment make them in any machine.
        """
        order, turns = candidate.order, round(candidate.order)
        away = abs(order / max(turns, 1) - 1.0)
        if order < 1.5 or away > self._expected.uncertainty + self._whole.step / order:
            return False
        lines = np.arange(1.0, HARMONICS * turns + 1.0)
        harmonics = lines % turns == 0
        others = ~harmonics & (lines > 2.0)
        comb, shaft = self._heights(lines * order / turns, order), self._heights(lines, order)
        if away <= self._precision:
            comb = shaft = np.maximum(comb, shaft)
        higher = shaft[harmonics].mean() >= comb[harmonics].mean()
        return bool(higher and shaft[others].mean() > shaft[harmonics].mean() - _ALIKE)

    def half_turn(self, candidate: Candidate) -> bool:
        """Return whether a comb may lie on a multiple of half the order of the shaft."""
        slack = self._expected.uncertainty * candidate.order + 2.0 * self._spectra.step
        return abs(candidate.order - 0.5 * round(2.0 * candidate.order)) <= slack

    def whole_turns(self, candidate: Candidate) -> int:
        """
        Return the strikes a turn with which a part of the shaft would make a comb; 0 if none can.

        It can if the order is a whole number within the uncertainty of a speed that neither a
        measurement nor the lines of the shaft give, if the comb smears over a whole number, or if
        it is one of `unequal_strikes`. A comb with the sidebands of a load zone is otherwise an
        inner race, unless they are as high as its harmonics and fit the shaft as well.
        """
        order, turns = candidate.order, round(candidate.order)
        inner = candidate.place == 'inner'
        high_sidebands = self._sidebands.has_high_shaft_sidebands(candidate)
        strikes = high_sidebands and not inner
        if not turns or (candidate.place == 'ball' and not strikes):
            return 0
        # Strikes once a turn have equally high lines, which look sharp if the speed moves a
        # little.
        told = self._spread <= (0.0 if strikes else _SHARP * self._whole.step)
        if self.unequal_strikes(candidate) or (told and self.smears_over_whole(candidate)):
            return turns
        if inner and self._sidebands.turning_sideband(candidate)[1] * RIVAL >= LOAD_ZONE:
            fits = high_sidebands and not self._measured and self._spaced_by_shaft(candidate)
            return turns if fits else 0
        if told:
            return 0
        spread = self._spread if math.isfinite(self._spread) else 0.0
        uncertainty = self._expected.uncertainty
        slack = max(spread, uncertainty) if strikes else spread or uncertainty
        near = abs(order - turns) <= slack * order
        return turns if near or self._reaches(order, turns) else 0

    def unequal_strikes(self, candidate: Candidate) -> bool:
        """
        Return whether the comb of an inner race is as near to a whole order as its speed tells.

        It must have lines at the other multiples of the shaft, as strikes of unequal height have,
        such as those of the edges of a milling cutter. The sidebands of an inner race are a turn
        apart, which fits a multiple of the shaft at one slip only.
        """
        order, off = candidate.order, self._off(candidate)
        return (
            candidate.place == 'inner'
            and off <= _SHARP * self._whole.step
            and abs(order - round(order)) <= off * order
            and self._sidebands.turning_sideband(candidate)[1] >= SWAY
            and self._spaced_by_shaft(candidate)
        )

    def _off(self, candidate: Candidate) -> float:
        """Return how far the speed may be off where it is known; outer races are not asked."""
        inner = candidate.place == 'inner'
        return self._tolerance if self._measured and inner else self._spread

    def _spaced_by_shaft(self, candidate: Candidate) -> bool:
        columns = np.array([candidate.band])
        return spaced_by_shaft(self._whole, candidate.order, columns, self._tolerance)

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
                abs(order - turns) <= self._off(candidate) * order
                or self._height_beyond_whole(order) >= _BEYOND
            )
        return self._smears[order]

    def _height_beyond_whole(self, order: float) -> float:
        """
        Return the height of the lines beyond whole orders over that of the lines beside a comb.

        They are the lines within twelve bins to either side of the second to fourth multiple of
        the whole order next to the comb, each less two standard deviations of noise. Where the
        speed of a shaft moves its lines smear to both sides, and the ratio is 1 in the mean; a
        race lies on one.
        """
        turns, step = round(order), self._whole.step
        bins = np.arange(1, _WIDEST + 1) * (step if order > turns else -step)
        whole = turns * np.arange(2.0, HARMONICS + 1.0)[:, None]
        sides = (self._heights((whole + side * bins).ravel(), order) for side in (1.0, -1.0))
        noise = 2.0 * _SPREAD / math.sqrt(self._whole.weight)
        own, beyond = (float(np.maximum(heights - noise, 0.0).sum()) for heights in sides)
        return beyond / max(own, noise)

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

        It shows by missing harmonics of the comb, or by unexplained lines between them. A series
        within the uncertainty of the shaft is left to :meth:`masked_by_shaft`, as load-zone
        modulated impacts have sidebands as high as harmonics.
        """
        order, whole = candidate.order, self._whole
        multiple = self.multiple(order)
        if multiple > 1:
            return multiple * order
        # A ball that strikes one race only has lines at its spin order, as high as its harmonics.
        own = 0.5 * order if candidate.place == 'ball' else order
        lower = self._sidebands.explained(candidate)
        if candidate.place == 'outer':
            cage = order / self._expected.bearing.n_balls
            lower = np.concatenate((lower, np.arange(cage, whole.top, cage)))
        harmonics = order * np.arange(1, HARMONICS + 1)
        alive = ~whole.at_shaft[whole.rows(harmonics)]
        most = int(order / max(_SLOWEST, 4.0 * whole.step))
        if most < 2 or not alive.any():
            return 0.0
        height = self._heights(harmonics[alive], order).mean()
        # The lines of sharp impacts are equally high: half the height is no part of their series.
        sharp = candidate.index >= INDEX_STRIKE
        leasts = (height - _ALIKE if sharp else _SHARE * height), height - _ALIKE
        found = _denser_part(
            whole.logs, order, whole.step, HARMONICS, self.columns(order), whole.at_shaft,
            whole.near(np.arange(own, whole.top, own), 2.0 * whole.step),
            whole.near(lower, 2.0 * whole.step), most, leasts, _FEWEST,
            _CHANCE * _SPREAD / math.sqrt(whole.weight), self._expected.uncertainty + whole.step,
        )  # fmt: skip
        return order / found if found else 0.0


def _line_heights(
    spectra: OrderSpectra, lines: NDArray[np.floating], columns: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Return the mean log score of each line over some bands, less that of noise, (n,)."""
    heights = np.empty(len(lines))
    _write_heights(spectra.logs, np.asarray(lines, np.float64), spectra.step, columns, heights)
    return heights


def spaced_by_shaft(
    spectra: OrderSpectra, order: float, columns: NDArray[np.intp], reach: float
) -> bool:
    """
    Return whether the sidebands of a comb fit a shaft with a harmonic there as well as any other.

    Strikes a whole number of times a turn, equal or not, have lines at multiples of the shaft
    only. The sidebands of an inner race in the load zone are a turn apart as well, but its order
    is a whole number at one slip only.

    Parameters
    ----------
    spectra, order, columns
        Envelope spectra, fundamental of the comb, and bands in which it is looked at.
    reach
        Largest relative difference between the speed of the shaft and that of the spectra.

    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> loose = OrderSpectra.of_lines(1.006 * np.arange(1, 19))
    >>> spaced_by_shaft(loose, 5.03, np.array([0]), 0.02)
    True
    >>> race = (5.03 * np.arange(1, 4)[:, None] + np.arange(-2, 3)).ravel()
    >>> spaced_by_shaft(OrderSpectra.of_lines(race), 5.03, np.array([0]), 0.02)
    False

    """
    whole = order / max(round(order), 1)
    if abs(whole - 1.0) > reach:
        return False
    # Two gaps beside a harmonic: half a bin more moves the farther sidebands by one.
    gaps = np.arange(1.0 - reach, 1.0 + reach, 0.25 * spectra.step)
    gaps = np.append(whole, gaps)[:, None]
    sides = [order * np.arange(HARMONICS + 1) + side * gaps for side in (-2, -1, 1, 2)]
    # The multiples of the shaft below the comb count once.
    lines = np.concatenate((sides[0][:, 1:], sides[1][:, 1:], *sides[2:]), axis=1)
    heights = _line_heights(spectra, lines.ravel(), columns).reshape(lines.shape).mean(axis=1)
    scatter = _SPREAD / math.sqrt(lines.shape[1] * spectra.weight)
    return bool(heights[0] > heights.max() - _APART * scatter)


@compiled(fast=FAST, borrows=True)
def _write_heights(
    logs: NDArray[np.float32],
    orders: NDArray[np.float64],
    step: float,
    columns: NDArray[np.intp],
    heights: NDArray[np.float64],
) -> None:
    """
    Write the mean over some columns of the row nearest to each order, less that of noise.

    ``logs`` are (K, C); row k belongs to order (k + 1) step. Orders and heights are (N,).
    """
    for n in range(len(orders)):
        heights[n] = row_height(logs, nearest_row(orders[n] * (1.0 / step), len(logs)), columns)


@compiled(fast=FAST - {'ninf'}, borrows=True)
def _unshared_heights(
    logs: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    order: float,
    step: float,
    columns: NDArray[np.intp],
    ratios: NDArray[np.float64],
) -> None:
    """
    Write the height of the harmonics that each multiple's series lacks, over the shared ones'.

    The comb has as many harmonics as there are ``ratios``, (M,). The ratio of the multiple m is at
    index m - 1; it is infinite if no harmonic is shared.
    """
    for multiple in range(1, len(ratios) + 1):
        shared = lacking = 0.0
        on = off = 0
        for n in range(1, len(ratios) + 1):
            at = nearest_row(order * n * (1.0 / step), len(logs))
            if hidden[at]:
                continue
            height = row_height(logs, at, columns)
            if n % multiple == 0:
                shared, on = shared + height, on + 1
            else:
                lacking, off = lacking + height, off + 1
        known = on > 0 and off > 0 and shared > 0.0
        ratios[multiple - 1] = lacking / off / (shared / on) if known else np.inf


@compiled(fast=FAST, borrows=True)
def _denser_part(
    logs: NDArray[np.float32],
    order: float,
    step: float,
    harmonics: int,
    columns: NDArray[np.intp],
    hidden: NDArray[np.bool_],
    mine: NDArray[np.bool_],
    sidebands: NDArray[np.bool_],
    most: int,
    leasts: tuple[float, float],
    fewest: int,
    surest: float,
    slack: float,
) -> int:
    """
    Return the divisor of an order whose series has lines between the harmonics of a comb; 0: none.

    Of all divisors it is the one whose lines are farthest from chance.

    Parameters
    ----------
    logs, step, columns
        As in `_write_heights`.
    order, harmonics
        Fundamental of the comb, and number of its harmonics.
    hidden, mine, sidebands
        (K,) masks. ``hidden`` and ``mine`` rows do not count, ``sidebands`` rows only if all lines
        of the series are as high.
    most
        Largest divisor.
    leasts
        Least mean height of the lines without the sidebands, and with them.
    fewest, surest
        Least number of lines, and least product of their mean height and the root of their number.
    slack
        Relative distance from the shaft within which series are ignored.

    """
    inverse, best, found = 1.0 / step, 0.0, 0
    for part in range(2, most + 1):
        few = all_lines = 0
        low = height_sum = 0.0
        for n in range(1, harmonics * part + 1):
            at = nearest_row(order * (n / part) * inverse, len(logs))
            if n % part == 0 or hidden[at] or mine[at]:
                continue
            height = np.float64(row_height(logs, at, columns))
            all_lines, height_sum = all_lines + 1, height_sum + height
            if not sidebands[at]:
                few, low = few + 1, low + height
        if abs(order / part - 1.0) <= slack:
            continue
        for count, total, least in ((few, low, leasts[0]), (all_lines, height_sum, leasts[1])):
            if count < fewest or total < least * count:
                continue
            sure = total / np.sqrt(np.float64(count))
            if sure >= surest and sure > best:
                best, found = sure, part
    return found
