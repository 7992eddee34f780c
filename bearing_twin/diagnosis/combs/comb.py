# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Comb scores of envelope spectra over shaft orders, against an empirical null."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
import math
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.diagnosis.combs.comb_sums import best_bands, comb_bands, comb_sums
from bearing_twin.diagnosis.signal.lines import nearest_row
from bearing_twin.diagnosis.signal.spectra import column_quantiles, quantiles
from bearing_twin.diagnosis.thresholds import HARMONICS
from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.vector import L
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.diagnosis.signal.spectra import EnvelopeSpectra


_LOWEST_ORDER = 0.3
_HANN_BINS = 1.5
"""Noise bandwidth of the Hann window, bins: a line spreads over three."""
_NUMBERS = np.arange(1.0, HARMONICS + 1)


@dataclass(frozen=True)
class OrderSpectra:
    """
    Envelope spectra over shaft orders, of one window or the mean of several.

    Row k belongs to order (k + 1) step. Columns are bands, whitening by whitening.
    """

    step: float
    """Orders a bin."""
    logs: NDArray[np.float32]
    """(K, W B) mean of log(1 + power / floor)."""
    excess: NDArray[np.float32]
    """(K, B) relative power above the floor, with lines capped."""
    carrier: NDArray[np.float32]
    """(B,) lower edge of each band, orders."""
    given: float = 1.0
    """Given shaft speed over the refined one, which the orders are multiples of."""
    weight: float = 1.0
    """Number of independent windows in the mean."""
    hidden: NDArray[np.bool_] | None = None
    """(K,) mask of bins that are left out; None: all bins count."""
    highest: float = math.inf
    """Half of the sample rate, orders."""

    @classmethod
    def of_lines(cls, orders: NDArray[np.floating]) -> OrderSpectra:
        """
        Return spectra of noise with lines at some orders, for the examples.

        They have one band and 2000 rows, 0.01 orders apart.

        >>> spectra = OrderSpectra.of_lines(3.07 * np.arange(1, 4))
        >>> spectra.excess[spectra.rows([3.07, 4.0]), 0].tolist()
        [1.0, 0.0]

        """
        excess = np.zeros((2000, 1), np.float32)
        excess[np.rint(orders / 0.01).astype(int) - 1] = 1.0
        return cls(
            0.01, np.float32(0.6) + np.float32(2.4) * excess, excess, np.zeros(1, np.float32)
        )

    def rows(self, orders: NDArray[np.floating] | Sequence[float]) -> NDArray[np.intp]:
        """Return the nearest row of each order; the last row for higher orders."""
        index = np.rint(np.asarray(orders) * (1.0 / self.step)).astype(np.intp)
        index -= 1
        np.maximum(index, 0, out=index)
        return np.minimum(index, len(self.logs) - 1, out=index)

    def silenced(self, orders: NDArray[np.float64], half_width: float) -> OrderSpectra:
        """Return the spectra without the bins within ``half_width`` orders of ``orders``."""
        return replace(self, hidden=self.quiet | self.near(orders, half_width))

    @cached_property
    def quiet(self) -> NDArray[np.bool_]:
        """(K,) mask of the bins that are left out."""
        return np.zeros(len(self.logs), np.bool_) if self.hidden is None else self.hidden

    @property
    def top(self) -> float:
        """Order of the last row."""
        return len(self.logs) * self.step

    @cached_property
    def at_shaft(self) -> NDArray[np.bool_]:
        """(K,) mask of the bins at multiples of the shaft."""
        return self.near(np.arange(1.0, self.top + 1.0), 1.25 * self.step)

    @cached_property
    def off_shaft(self) -> OrderSpectra:
        """Return the spectra without the bins at multiples of the shaft."""
        return replace(self, hidden=self.quiet | self.at_shaft)

    def line_power(self, orders: NDArray[np.float64], columns: slice) -> NDArray[np.float32]:
        """Return the power of lines above the floor, (..., C), each summed over three bins."""
        first, end, _ = columns.indices(self.excess.shape[1])
        power = np.zeros((orders.size, end - first), np.float32)
        _three_bins(self.excess, self.quiet, orders.ravel(), self.step, first, power)
        return power.reshape(*orders.shape, -1)

    def comb_powers(self, orders: NDArray[np.float64], band: int) -> NDArray[np.float32]:
        """
        Return the relative power of the lines of several combs in one band, (n,).

        >>> spectra = OrderSpectra.of_lines(3.07 * np.arange(1, 5))
        >>> spectra.comb_powers(np.array([3.07, 6.14]), 0).tolist()
        [4.0, 2.0]

        """
        lines = self.line_power(orders[:, None] * _NUMBERS, slice(band, band + 1))
        return np.asarray(lines.sum(axis=(1, 2)))

    def near(self, orders: NDArray[np.float64], half_width: float) -> NDArray[np.bool_]:
        """Return a (K,) mask of the bins within ``half_width`` orders of any of ``orders``."""
        mask = np.zeros(len(self.logs), np.bool_)
        _mark_near(orders, half_width, self.step, mask)
        return mask

    def at_given_speed(self) -> OrderSpectra:
        """Return the spectra over orders of the given speed."""
        return replace(
            self,
            step=self.step / self.given,
            carrier=self.carrier / self.given,
            highest=self.highest / self.given,
            given=1.0,
        )


def order_spectra(
    spectra: EnvelopeSpectra,
    bands: Sequence[tuple[float, float]],
    shaft_hz: float,
    given_hz: float,
) -> OrderSpectra:
    """
    Return the spectra of one window over orders of ``shaft_hz``.

    Parameters
    ----------
    spectra
        Squared envelope spectra.
    bands
        Lower and upper edge of each band, Hz; the first band is the whole range.
    shaft_hz, given_hz
        Refined and given shaft speed, Hz.

    >>> from bearing_twin.diagnosis.signal.spectra import EnvelopeSpectra
    >>> ones = np.ones((400, 3), np.float32)
    >>> spectra = EnvelopeSpectra(0.25, ones, ones[:, :1], ones[:, :1].T, ones.T, 0.0, 1)
    >>> found = order_spectra(spectra, [(0.0, 12800.0)], 25.0, 25.0)
    >>> found.step, found.logs.shape, found.highest
    (0.01, (400, 3), 512.0)

    """
    return OrderSpectra(
        spectra.bin_hz / shaft_hz,
        spectra.logs,
        spectra.excess,
        np.asarray([band[0] for band in bands], dtype=np.float32) / np.float32(shaft_hz),
        given_hz / shaft_hz,
        highest=bands[0][1] / shaft_hz,
    )


def accumulate(windows: Sequence[OrderSpectra]) -> OrderSpectra:
    """
    Return the mean of several windows on the order grid of the last one, the newest.

    >>> one = OrderSpectra(0.01, np.zeros((9, 1)), np.zeros((9, 1)), np.zeros(1))
    >>> mean = accumulate([one, replace(one, logs=np.ones((9, 1)))])
    >>> float(mean.logs.mean()), mean.weight
    (0.5, 2.0)

    """
    newest = windows[-1]
    if len(windows) == 1:
        return newest
    orders = newest.step * np.arange(1, len(newest.logs) + 1)
    share = np.float32(1.0 / len(windows))
    logs, excess = np.zeros_like(newest.logs), np.zeros_like(newest.excess)
    for window in windows:
        rows = window.rows(orders)
        logs += share * window.logs[rows]
        excess += share * window.excess[rows]
    return replace(newest, logs=logs, excess=excess, weight=float(len(windows)))


def modulation_index(power: float) -> float:
    """
    Return the modulation index of a comb by the relative power of its lines, less the noise floor.

    It is the root of the sum over harmonics of the squared relative amplitudes of the squared
    envelope: m for an envelope 1 + m cos.

    >>> round(modulation_index(4.0), 2)
    3.27

    """
    return 2.0 * math.sqrt(float(power) / _HANN_BINS)


class CombScores(NamedTuple):
    """Scores of the combs at a grid of fundamental orders, and their null distribution."""

    grid: NDArray[np.float64]
    """(G,) fundamental orders."""
    z: NDArray[np.float64]
    """(G,) score: best band, mean over whitenings, in standard deviations over the null."""
    center: NDArray[np.float32]
    """(W B,) median score of each band."""
    inverse: NDArray[np.float32]
    """(W B,) one over the upper standard deviation of each band's score."""
    best_center: float
    """Median over the grid of the best-band score."""
    best_spread: float
    """Upper standard deviation of the best-band score over the grid."""
    whitenings: int

    def score(self, spectra: OrderSpectra, grid: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the scores of other spectra against this null, (G,)."""
        best = np.empty(len(grid))
        best_bands(
            spectra.logs,
            spectra.quiet,
            grid,
            spectra.step,
            self.center,
            self.inverse,
            self.whitenings,
            self.best_center,
            self.best_spread,
            np.empty(len(self.center) + L * self.whitenings, np.float32),
            best,
        )
        return best

    def bands(
        self, spectra: OrderSpectra, order: float
    ) -> tuple[NDArray[np.float32], NDArray[np.intp]]:
        """Return the score of one comb in each band, (W B,), and the highest columns, (W,)."""
        scores, columns = np.empty_like(self.center), np.empty(self.whitenings, np.intp)
        comb_bands(
            spectra.logs, spectra.quiet, order, spectra.step, HARMONICS, self.center, self.inverse,
            scores, columns,
        )  # fmt: skip
        return scores, columns


def _sums(spectra: OrderSpectra, grid: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return the sum over the harmonics of each comb, (G, W B)."""
    sums = np.empty((len(grid), spectra.logs.shape[1]), np.float32)
    comb_sums(spectra.logs, spectra.quiet, grid, spectra.step, HARMONICS, sums)
    return sums


def comb_scores(spectra: OrderSpectra, highest_order: float, whitenings: int) -> CombScores:
    """
    Return the scores of all combs with a fundamental from 0.3 orders to ``highest_order``.

    The score of a comb is the sum of log(1 + power / floor) over its harmonics. Each band is
    standardised over the whole grid, the best band is taken at each order, and the whitenings are
    averaged. The result is standardised again, so that the gain from choosing the best band is
    part of the null. Median and upper quantile (84 %) replace mean and standard deviation, so that
    the few orders of a fault do not widen the null.

    >>> rng = np.random.default_rng(0)
    >>> power = rng.exponential(size=(2000, 3))
    >>> power[np.rint(3.07 * np.arange(1, 5) / 0.01).astype(int) - 1] *= 20.0
    >>> logs = np.log1p(power).astype(np.float32)
    >>> spectra = OrderSpectra(0.01, logs, np.zeros((2000, 1)), np.zeros(1))
    >>> scores = comb_scores(spectra, 5.0, 3)
    >>> round(float(scores.grid[scores.z.argmax()]), 2), bool(scores.z.max() > 5.5)
    (3.07, True)

    """
    step = spectra.step / HARMONICS
    grid = np.arange(_LOWEST_ORDER, highest_order, step)
    # Neighbours share bins: every fourth gives the same distribution.
    center, upper = column_quantiles(_sums(spectra, grid[::4]))
    inverse = np.float32(1.0) / np.maximum(upper - center, np.float32(1e-3))
    plain = CombScores(grid, grid, center, inverse, 0.0, 1.0, whitenings)
    best = plain.score(spectra, grid)
    best_center, best_upper = (float(q) for q in quantiles(best))
    best_spread = max(best_upper - best_center, 1e-3)
    z = (best - best_center) / best_spread
    return plain._replace(z=z, best_center=best_center, best_spread=best_spread)


@compiled(borrows=True)
def _mark_near(
    orders: NDArray[np.float64], half_width: float, step: float, mask: NDArray[np.bool_]
) -> None:
    """Mark in ``mask``, (K,), the rows within ``half_width`` orders of any of ``orders``."""
    count = len(mask)
    for order in orders:
        first = np.ceil((order - half_width) / step) - 1.0
        last = np.floor((order + half_width) / step)
        for k in range(int(min(max(first, 0.0), count)), int(min(last, count))):
            mask[k] = True


@compiled(fast=FAST, borrows=True)
def _three_bins(
    excess: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    orders: NDArray[np.float64],
    step: float,
    first: int,
    power: NDArray[np.float32],
) -> None:
    """
    Add the row of each line and the two beside it: a line spreads over three bins.

    B columns of ``excess``, (K, C), from ``first`` on, are added to ``power``, (N, B).
    """
    lines, columns = power.shape
    last = len(excess) - 1
    for n in range(lines):
        out = power[n]
        middle = nearest_row(orders[n] * (1.0 / step), len(excess))
        for beside in range(-1, 2):
            at = min(max(middle + beside, 0), last)
            if hidden[at]:
                continue
            row = excess[at, first : first + columns]
            for c in range(columns):
                out[c] += row[c]
