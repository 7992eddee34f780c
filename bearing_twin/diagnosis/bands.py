# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Squared envelopes of the bands of a spectrum: which bands there are, and their demodulation."""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.kernels import add_bands, running_sums
import numpy as np
from scipy import fft

if TYPE_CHECKING:
    from numpy.typing import NDArray


_MOST_TILES = 4


@dataclass(frozen=True)
class BandTree:
    """Bands of a 1/2-band tree with 50 % overlap, as bins of a one-sided spectrum."""

    bin_hz: float
    levels: tuple[tuple[int, tuple[int, ...]], ...]
    """Per level the width and the first bins of its bands."""

    @property
    def bands(self) -> list[tuple[float, float]]:
        """Lower and upper edge of every band, Hz, level by level."""
        return [
            (first * self.bin_hz, (first + width) * self.bin_hz)
            for width, firsts in self.levels
            for first in firsts
        ]


def band_tree(
    bins: int, bin_hz: float, *, depth: int, narrowest_hz: float, reach: float = math.inf
) -> BandTree:
    """
    Tree over ``bins`` bins: the whole range, then 3, 7, 15, ... half-overlapping bands.

    It ends at ``depth`` halvings or where a band would be narrower than ``narrowest_hz``. No
    band ends beyond ``reach`` times its width: what rings there fills wider ones.

    >>> band_tree(12800, 1.0, depth=3, narrowest_hz=500.0).bands[:2]
    [(0.0, 12800.0), (0.0, 6400.0)]
    >>> [len(firsts) for _, firsts in band_tree(102400, 1.0, depth=6, narrowest_hz=500.0).levels]
    [1, 3, 7, 15, 31, 63, 127]
    >>> tree = band_tree(102400, 1.0, depth=6, narrowest_hz=500.0, reach=12.5)
    >>> [len(firsts) for _, firsts in tree.levels]
    [1, 3, 7, 15, 24, 24, 24]

    """
    levels: list[tuple[int, tuple[int, ...]]] = [(bins, (0,))]
    for level in range(1, depth + 1):
        width = bins >> level
        if width * bin_hz < narrowest_hz:
            break
        most = min(2 ** (level + 1), int(2.0 * min(reach, 2.0**level)))
        levels.append((width, tuple(i * (width // 2) for i in range(most - 1))))
    return BandTree(bin_hz, tuple(levels))


def squared_envelopes(
    whitened: NDArray[np.complex64], tree: BandTree, points: int
) -> NDArray[np.float32]:
    """
    Demodulate every band and sample its squared envelope at equal steps.

    A slice of the one-sided spectrum, transformed back, is the analytic signal of an ideal band
    filter (Ho and Randall 2000). The spectrum of its squared envelope is the autocorrelation of
    the slice. It ends at half the rate of the points, so nothing is aliased.

    Parameters
    ----------
    whitened
        (W, K) whitened spectra.
    tree
        Bands.
    points
        Points over the length of the record, at least 16.

    Returns
    -------
    Array of shape (W, B, ``points``).

    >>> from bearing_twin.diagnosis.spectra import whiten
    >>> noise = np.random.default_rng(0).standard_normal(25600)
    >>> spectrum = np.fft.rfft(noise).astype(np.complex64)
    >>> tree = band_tree(12800, 1.0, depth=1, narrowest_hz=500.0)
    >>> squared_envelopes(whiten(spectrum, 256), tree, 1280).shape
    (2, 4, 1280)

    """
    lags = points // 2 + 1
    lags_of = _lags_by_tile if _tiles_suit(tree, lags) else _lags_by_band
    correlation = np.concatenate(lags_of(whitened, tree, lags), axis=1)
    return np.asarray(fft.irfft(correlation, n=points, axis=-1, norm='forward'))


def _tiles_suit(tree: BandTree, lags: int) -> bool:
    """Whether all bands are made of tiles half as wide as the narrowest, and lags reach few."""
    (bins, _), tile = tree.levels[0], tree.levels[-1][0] // 2
    depth = len(tree.levels) - 1
    return (
        depth > 1
        and bins == tile << (depth + 1)
        and lags <= _MOST_TILES * tile
        and fft.next_fast_len(2 * tile) == 2 * tile
    )


def _lags_by_band(
    whitened: NDArray[np.complex64], tree: BandTree, lags: int
) -> list[NDArray[np.complex64]]:
    """
    Autocorrelation of each band, one band at a time.

    Returns
    -------
    Per level an array of shape (W, B, ``lags``).

    """
    levels = []
    for width, firsts in tree.levels:
        length = fft.next_fast_len(width + min(lags, width))
        bands = np.zeros((len(whitened), len(firsts), length), np.complex64)
        for i, first in enumerate(firsts):
            bands[:, i, :width] = whitened[:, first : first + width]
        envelope = _squared(fft.ifft(bands, axis=-1, norm='forward', overwrite_x=True))
        level = fft.rfft(envelope, axis=-1, norm='forward')[..., :lags]
        missing = lags - level.shape[-1]
        levels.append(np.pad(level, ((0, 0), (0, 0), (0, missing))) if missing else level)
    return levels


def _lags_by_tile(
    whitened: NDArray[np.complex64], tree: BandTree, lags: int
) -> list[NDArray[np.complex64]]:
    """
    Give the same as :func:`_lags_by_band`, for a tree that is made of equal tiles.

    Bands overlap, so their autocorrelations are summed from the products within each tile and
    those of each tile with the next ones, as far as the lags reach: every bin is transformed once
    for all levels, not once per band.
    """
    tile = tree.levels[-1][0] // 2
    rows, bins = len(whitened), tree.levels[0][0]
    tiles, reach = bins // tile, -(-lags // tile)
    padded = np.zeros((rows, tiles, 2 * tile), np.complex64)
    padded[..., :tile] = whitened[:, :bins].reshape(rows, tiles, tile)
    signal = fft.ifft(padded, axis=-1, norm='forward', overwrite_x=True)
    within = fft.rfft(_squared(signal), axis=-1, norm='forward')[..., :tile]
    # Products of tiles so far apart, from a lag on: the first bins of two neighbours lie one tile
    # from one another, so theirs begin before and go on after that lag.
    sums = [(0, 0, within[..., :lags])]
    for apart in range(1, reach + 1):
        across, lag = _cross(signal, apart), apart * tile
        sums.append((apart, lag - tile, across[..., tile : lags - lag + 2 * tile]))
        if lags > lag:
            sums.append((apart, lag, across[..., : min(lags - lag, tile)]))
    levels = [np.zeros((rows, len(firsts), lags), np.complex64) for _, firsts in tree.levels]
    for apart, lag, products in sums:
        running = np.empty((rows, 1 + products.shape[1], products.shape[2]), np.complex64)
        running_sums(products, running)
        for (width, _), level in zip(tree.levels, levels, strict=True):
            add_bands(running, width // tile, apart, level[..., lag:])
    return levels


def _cross(signal: NDArray[np.complex64], apart: int) -> NDArray[np.complex64]:
    """Cross-correlation of each tile with the one so many further on, from their transforms."""
    product = np.conj(signal[:, :-apart])
    product *= signal[:, apart:]
    return np.asarray(fft.fft(product, axis=-1, norm='forward', overwrite_x=True))


def _squared(signal: NDArray[np.complex64]) -> NDArray[np.float32]:
    """Squared magnitude."""
    squared = signal.real**2
    squared += signal.imag**2
    return squared
