# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Comb scores of envelope spectra over shaft orders, against their own empirical null."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bearing_twin.diagnosis.spectra import EnvelopeSpectra
    from numpy.typing import NDArray

__all__ = [
    'HARMONICS',
    'CombScores',
    'OrderSpectra',
    'accumulate',
    'comb_scores',
    'order_spectra',
]

HARMONICS = 4
"""Harmonics of a comb. Fault lines fade after a few, and each empty harmonic costs power."""

NEUTRAL = 0.5963474
"""Mean of log(1 + E) for E ~ Exp(1): e E1(1). What a bin is set to that must not speak."""

_STEPS_PER_BIN = 2
_LOWEST_ORDER = 0.3
_PART = 512


@dataclass(frozen=True)
class OrderSpectra:
    """
    Envelope spectra over shaft orders: one window's, or the mean of several.

    Row k belongs to order (k + 1) step. Columns are bands, whitening by whitening.
    """

    step: float
    """Orders a bin."""
    logs: NDArray[np.float32]
    """(K, W B): mean of log(1 + power / floor)."""
    excess: NDArray[np.float32]
    """(K, 2 B): relative power above the floor, lines kept and lines capped."""
    carrier: NDArray[np.float32]
    """(B,): lower edge of each band, orders."""
    given: float = 1.0
    """Shaft speed handed in over the refined one, on which the orders rest."""
    weight: float = 1.0
    """Number of independent windows in the mean."""

    def rows(self, orders: NDArray[np.floating] | Sequence[float]) -> NDArray[np.intp]:
        """Nearest row of each order; rows beyond the end are the last one."""
        index = np.rint(np.asarray(orders) * (1.0 / self.step)).astype(np.intp)
        index -= 1
        np.maximum(index, 0, out=index)
        return np.minimum(index, len(self.logs) - 1, out=index)

    def silenced(self, orders: NDArray[np.float64], half_width: float) -> OrderSpectra:
        """Copy in which the bins within ``half_width`` orders of ``orders`` say nothing."""
        logs, excess = self.logs.copy(), self.excess.copy()
        hidden = self.near(orders, half_width)
        logs[hidden], excess[hidden] = NEUTRAL, 0.0
        return replace(self, logs=logs, excess=excess)

    def near(self, orders: NDArray[np.float64], half_width: float) -> NDArray[np.bool_]:
        """(K,) mask of the bins within ``half_width`` orders of any of ``orders``."""
        count = len(self.logs)
        first = np.ceil((orders - half_width) / self.step) - 1.0
        last = np.floor((orders + half_width) / self.step)
        # How many ranges have begun by each bin, less those that have ended.
        begun, ended = (
            np.bincount(np.clip(edge, 0, count).astype(np.intp), minlength=count + 1)
            for edge in (first, np.maximum(last, first))
        )
        return np.asarray(np.cumsum(begun - ended)[:count] > 0)

    def at_given_speed(self) -> OrderSpectra:
        """Return the same over orders of the speed handed in."""
        return replace(
            self,
            step=self.step / self.given,
            carrier=self.carrier / self.given,
            given=1.0,
        )


def order_spectra(
    spectra: EnvelopeSpectra,
    edges: Sequence[float],
    shaft_hz: float,
    given_hz: float,
) -> OrderSpectra:
    """
    Put the spectra of one window over orders of ``shaft_hz``.

    Parameters
    ----------
    spectra
        Squared envelope spectra.
    edges
        Lower edge of each band, Hz.
    shaft_hz, given_hz
        Shaft speed refined and handed in, Hz.

    >>> from bearing_twin.diagnosis.spectra import EnvelopeSpectra
    >>> power = np.ones((3, 1, 400), np.float32)
    >>> spectra = EnvelopeSpectra(0.25, power, power)
    >>> found = order_spectra(spectra, [0.0], 25.0, 25.0)
    >>> found.step, found.logs.shape
    (0.01, (400, 3))

    """
    whitenings, bands, count = spectra.power.shape
    logs = spectra.logs.reshape(whitenings * bands, count)
    excess = np.maximum(spectra.power[:2] - spectra.floor[:2], 0.0).reshape(2 * bands, count)
    return OrderSpectra(
        spectra.bin_hz / shaft_hz,
        np.ascontiguousarray(logs.T),
        np.ascontiguousarray(excess.T),
        np.asarray(edges, dtype=np.float32) / np.float32(shaft_hz),
        given_hz / shaft_hz,
    )


def accumulate(windows: Sequence[OrderSpectra]) -> OrderSpectra:
    """
    Mean of several windows on the order grid of the last, which is the newest.

    >>> one = OrderSpectra(0.01, np.zeros((9, 1)), np.zeros((9, 2)), np.zeros(1))
    >>> mean = accumulate([one, replace(one, logs=np.ones((9, 1)))])
    >>> float(mean.logs.mean()), mean.weight
    (0.5, 2.0)

    """
    newest = windows[-1]
    if len(windows) == 1:
        return newest
    orders = newest.step * np.arange(1, len(newest.logs) + 1)
    total = sum(window.weight for window in windows)
    logs, excess = np.zeros_like(newest.logs), np.zeros_like(newest.excess)
    for window in windows:
        rows = window.rows(orders)
        share = np.float32(window.weight / total)
        logs += share * window.logs[rows]
        excess += share * window.excess[rows]
    return replace(newest, logs=logs, excess=excess, weight=total)


@dataclass(frozen=True)
class CombScores:
    """Scores of all combs of a grid of fundamental orders, and the null they are judged by."""

    grid: NDArray[np.float64]
    """(G,) fundamental orders."""
    z: NDArray[np.float64]
    """(G,): best band, mean over whitenings, in standard deviations over the null."""
    center: NDArray[np.float32]
    """(W B,) median score of each band."""
    spread: NDArray[np.float32]
    """(W B,) upper standard deviation of each band's score."""
    best_center: float
    """Median over the grid of the best-band score."""
    best_spread: float
    """Its upper standard deviation."""
    whitenings: int

    def judge(
        self, spectra: OrderSpectra, grid: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
        """Score other spectra against this null: z (G,) and the band scores (G, W, B)."""
        bands, best = _best_bands(_teeth(spectra, grid), self.center, self.spread, self.whitenings)
        return (best - self.best_center) / self.best_spread, np.moveaxis(bands, -1, 0)


def _teeth(spectra: OrderSpectra, grid: NDArray[np.float64]) -> NDArray[np.float32]:
    """Sum over the harmonics of each comb, (W B, G)."""
    first, *others = (spectra.rows(harmonic * grid) for harmonic in range(1, HARMONICS + 1))
    sums = np.empty((spectra.logs.shape[1], len(grid)), np.float32)
    # In parts that stay in the cache until they are turned over.
    for begin in range(0, len(grid), _PART):
        part = slice(begin, begin + _PART)
        total = np.take(spectra.logs, first[part], axis=0)
        line = np.empty_like(total)
        for rows in others:
            # The rows are within bounds; the other modes would buffer what they write.
            total += np.take(spectra.logs, rows[part], axis=0, out=line, mode='clip')
        sums[:, part] = total.T
    return sums


def _best_bands(
    scores: NDArray[np.float32],
    center: NDArray[np.float32],
    spread: NDArray[np.float32],
    whitenings: int,
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Standardised scores, (W, B, G), and per comb the mean over whitenings of its best band."""
    bands = scores - center[:, np.newaxis]
    bands /= spread[:, np.newaxis]
    bands = bands.reshape(whitenings, -1, scores.shape[-1])
    return bands, bands.max(axis=1).mean(axis=0, dtype=np.float64)


def comb_scores(spectra: OrderSpectra, highest_order: float, whitenings: int) -> CombScores:
    """
    Score every comb whose fundamental lies between 0.3 orders and ``highest_order``.

    The score of a comb is the sum of log(1 + power / floor) over its harmonics. Each band is
    standardised over the whole grid, the best band is taken at each order, the whitenings are
    averaged, and the result is standardised again: the gain from choosing the best band is thus
    part of the null. Median and upper quantile (84 %) stand for mean and standard deviation, so
    that the orders of a fault itself, few of the grid, do not widen the null.

    >>> rng = np.random.default_rng(0)
    >>> power = rng.exponential(size=(2000, 3))
    >>> power[np.rint(3.07 * np.arange(1, 5) / 0.01).astype(int) - 1] *= 20.0
    >>> spectra = OrderSpectra(0.01, np.log1p(power), np.zeros((2000, 2)), np.zeros(1))
    >>> scores = comb_scores(spectra, 5.0, 3)
    >>> round(float(scores.grid[scores.z.argmax()]), 2), bool(scores.z.max() > 5.5)
    (3.07, True)

    """
    step = spectra.step / (HARMONICS * _STEPS_PER_BIN)
    grid = np.arange(_LOWEST_ORDER, highest_order, step)
    scores = _teeth(spectra, grid)
    # Neighbours are one bin's fraction apart: every fourth tells the distribution as well.
    center, upper = _quantiles(scores[:, ::4])
    spread = np.maximum(upper - center, 1e-3)
    _, best = _best_bands(scores, center, spread, whitenings)
    best_center, best_upper = (float(q) for q in _quantiles(best))
    best_spread = max(best_upper - best_center, 1e-3)
    z = (best - best_center) / best_spread
    return CombScores(grid, z, center, spread, best_center, best_spread, whitenings)


def _quantiles(
    values: NDArray[np.floating],
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Median and 84 % quantile along the last axis."""
    middle, upper = values.shape[-1] // 2, int(0.8413 * values.shape[-1])
    ordered = values.copy()
    # One at a time: numpy has no fast way for two.
    ordered.partition(middle, axis=-1)
    center = ordered[..., middle].copy()
    above = ordered[..., middle:]
    above.partition(upper - middle, axis=-1)
    return center, above[..., upper - middle]
