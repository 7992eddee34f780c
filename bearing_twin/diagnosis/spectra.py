# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
From a record to squared envelope spectra: floor, whitening, band tree, demodulation.

Every function works on plain arrays and can be used alone. Spectra are one-sided.
"""

from __future__ import annotations

from dataclasses import dataclass
import functools
import math
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    'WHITENINGS',
    'BandTree',
    'EnvelopeSpectra',
    'band_tree',
    'envelope_spectra',
    'line_cap',
    'local_floor',
    'whiten',
]

WHITENINGS = ('flat', 'capped', 'cepstral')
"""Whitenings of :func:`whiten`, in the order of its output."""

_MEDIAN_OF_EXPONENTIAL = math.log(2.0)
_TINY = 1e-30
_CAP, _CAP_TURNS = 4.0, 50.0


def local_floor(power: NDArray[np.float32], width: int) -> NDArray[np.float32]:
    """
    Mean power of the noise around each bin, lines ignored.

    The median over half-overlapping blocks, joined linearly, divided by ln 2: the ratio of median
    and mean of the exponential distribution that the periodogram of stationary noise follows.
    This is the threshold of Borghesani and Antoni (2018) made local.

    Parameters
    ----------
    power
        Power spectra along the last axis, shape (..., K).
    width
        Bins in a block, at least 8.

    Returns
    -------
    Floor, same shape; at least 1e-30, so that dividing by it is safe.

    >>> noise = np.random.default_rng(0).exponential(size=4096).astype(np.float32)
    >>> noise[1000] = 500.0
    >>> bool(np.abs(local_floor(noise, 256) - 1.0).max() < 0.4)
    True

    """
    count = power.shape[-1]
    hop = max(width // 2, 4)
    blocks = count // hop
    if blocks < 3:
        floor = np.median(power, axis=-1, keepdims=True) / _MEDIAN_OF_EXPONENTIAL
        return np.broadcast_to(np.maximum(floor, _TINY), power.shape).astype(power.dtype)
    # Centred on the range, so that what the blocks leave over falls on both ends alike.
    offset = (count - blocks * hop) // 2
    tiles = power[..., offset : offset + blocks * hop].reshape(*power.shape[:-1], blocks, hop)
    pairs = np.concatenate((tiles[..., :-1, :], tiles[..., 1:, :]), axis=-1)
    pairs.partition(hop, axis=-1)
    levels = np.maximum(pairs[..., hop] / _MEDIAN_OF_EXPONENTIAL, _TINY)
    bins, weight = _between_blocks(count, offset, hop, blocks)
    floor = np.repeat(levels[..., :-1], bins, axis=-1)
    rise = np.repeat(np.diff(levels, axis=-1), bins, axis=-1)
    rise *= weight.astype(power.dtype)
    floor += rise
    return floor


@functools.lru_cache(maxsize=16)
def _between_blocks(
    count: int, offset: int, hop: int, blocks: int
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Bins between the centres of each block and the next, and how far on each bin is, 0 to 1."""
    position = (np.arange(count) - (offset + hop - 0.5)) / hop
    left = np.clip(np.floor(position).astype(np.intp), 0, blocks - 3)
    weight = np.clip(position - left, 0.0, 1.0)
    bins = np.bincount(left, minlength=blocks - 2)
    bins.flags.writeable = weight.flags.writeable = False
    return bins, weight


def line_cap(turns: float) -> float:
    """
    Power over the floor at which a line is capped, for a window of so many shaft turns.

    Twice the floor in amplitude at 50 turns. A line stands out of the floor by the length of the
    window, and so do the lines of a fault whose impacts keep time: the cap grows with the window,
    so that the modulation index of a fault does not fall with it.

    >>> line_cap(25.0), line_cap(50.0), line_cap(200.0)
    (4.0, 4.0, 16.0)

    """
    return _CAP * max(turns / _CAP_TURNS, 1.0)


def whiten(
    spectrum: NDArray[np.complex64], width: int, *, cap: float = 4.0
) -> NDArray[np.complex64]:
    """
    Remove the colour of a record in three ways that fail differently.

    ``flat`` divides by the local floor; ``capped`` also limits each line to a few times the
    floor, so that gear and mains lines lose their weight; ``cepstral`` keeps the phase alone
    (cepstrum pre-whitening, Borghesani et al. 2013), which ranks best but destroys effect size.

    Parameters
    ----------
    spectrum
        One-sided spectrum of a real record, shape (K,).
    width
        Bins in a block of the floor, see :func:`local_floor`.
    cap
        Largest power of a capped line over the floor, see :func:`line_cap`.

    Returns
    -------
    Array of shape (3, K) in the order of :data:`WHITENINGS`.

    >>> spectrum = np.fft.rfft(np.random.default_rng(0).standard_normal(4096)).astype(np.complex64)
    >>> flat, capped, cepstral = whiten(spectrum, 256)
    >>> bool(np.allclose(np.abs(cepstral), 1.0, atol=1e-3))
    True

    """
    power = spectrum.real**2 + spectrum.imag**2
    floor = local_floor(power, width)
    gains = (
        floor,
        np.maximum(floor, power / np.float32(cap)),
        np.maximum(power, _TINY),
    )
    white = np.empty((len(gains), len(spectrum)), np.complex64)
    for row, gain in zip(white, gains, strict=True):
        np.multiply(spectrum, np.float32(1.0) / np.sqrt(gain), out=row)
    return white


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


def band_tree(bins: int, bin_hz: float, *, depth: int, narrowest_hz: float) -> BandTree:
    """
    Tree over ``bins`` bins: the whole range, then 3, 7, 15, ... half-overlapping bands.

    It ends at ``depth`` halvings or where a band would be narrower than ``narrowest_hz``.

    >>> band_tree(12800, 1.0, depth=3, narrowest_hz=500.0).bands[:2]
    [(0.0, 12800.0), (0.0, 6400.0)]

    """
    levels: list[tuple[int, tuple[int, ...]]] = [(bins, (0,))]
    for level in range(1, depth + 1):
        width = bins >> level
        if width * bin_hz < narrowest_hz:
            break
        firsts = (i * (width // 2) for i in range(2 ** (level + 1) - 1))
        levels.append((width, tuple(firsts)))
    return BandTree(bin_hz, tuple(levels))


@dataclass(frozen=True)
class EnvelopeSpectra:
    """Squared envelope spectra of all bands: relative power per bin and the floor of it."""

    bin_hz: float
    power: NDArray[np.float32]
    """(W, B, K): power of the squared envelope relative to its mean's; bin k is (k + 1) bin_hz."""
    floor: NDArray[np.float32]
    """(W, B, K): its local floor."""

    @functools.cached_property
    def logs(self) -> NDArray[np.float32]:
        """(W, B, K): log(1 + power / floor)."""
        return np.asarray(np.log1p(self.power / self.floor))


def envelope_spectra(
    whitened: NDArray[np.complex64], tree: BandTree, *, max_hz: float, floor_width: int
) -> EnvelopeSpectra:
    """
    Demodulate every band and return the spectrum of its squared envelope up to ``max_hz``.

    A slice of the one-sided spectrum, transformed back, is the analytic signal of an ideal band
    filter, decimated to its bandwidth (Ho and Randall 2000). The slice is padded so that the
    aliases of the squared envelope fall above ``max_hz``. A Hann window keeps the leakage of
    strong lines off the floor.

    Parameters
    ----------
    whitened
        (W, K) whitened spectra.
    tree
        Bands.
    max_hz
        Highest envelope frequency wanted.
    floor_width
        Bins in a block of the floor.

    Returns
    -------
    Relative power: 1/4 of the squared modulation index of a sinusoidal modulation.

    >>> noise = np.random.default_rng(0).standard_normal(25600)
    >>> spectrum = np.fft.rfft(noise).astype(np.complex64)
    >>> tree = band_tree(12800, 1.0, depth=1, narrowest_hz=500.0)
    >>> found = envelope_spectra(whiten(spectrum, 256), tree, max_hz=500.0, floor_width=64)
    >>> found.power.shape, found.bin_hz
    ((3, 4, 500), 1.0)

    """
    count = max(int(max_hz / tree.bin_hz), 16)
    power_of = _power_by_tile if _tiles_suit(tree, count) else _power_by_band
    power = np.concatenate(power_of(whitened, tree, count), axis=1)
    return EnvelopeSpectra(tree.bin_hz, power, local_floor(power, floor_width))


def _tiles_suit(tree: BandTree, count: int) -> bool:
    """Whether all bands are made of tiles half as wide as the narrowest, and lines reach two."""
    (bins, _), tile = tree.levels[0], tree.levels[-1][0] // 2
    depth = len(tree.levels) - 1
    return (
        depth > 1
        and bins == tile << (depth + 1)
        and count + 2 <= 2 * tile
        and fft.next_fast_len(2 * tile) == 2 * tile
    )


def _power_by_band(
    whitened: NDArray[np.complex64], tree: BandTree, count: int
) -> list[NDArray[np.float32]]:
    """
    Power of lines 1 to ``count`` of each squared envelope over its mean's, one band at a time.

    Returns
    -------
    Per level an array of shape (W, B, ``count``).

    """
    levels = []
    for width, firsts in tree.levels:
        length = fft.next_fast_len(width + min(count, width) + 1)
        bands = np.zeros((len(whitened), len(firsts), length), np.complex64)
        for i, first in enumerate(firsts):
            bands[:, i, :width] = whitened[:, first : first + width]
        envelope = _squared(fft.ifft(bands, axis=-1, overwrite_x=True))
        mean = np.maximum(envelope.mean(axis=-1, keepdims=True), np.float32(_TINY))
        envelope -= mean
        envelope *= (1.0 - np.cos(2.0 * np.pi * np.arange(length) / length)).astype(np.float32)
        lines = fft.rfft(envelope, axis=-1)[..., 1 : count + 1] / (length * mean)
        power = _squared(lines)
        missing = count - power.shape[-1]
        levels.append(np.pad(power, ((0, 0), (0, 0), (0, missing))) if missing else power)
    return levels


def _power_by_tile(
    whitened: NDArray[np.complex64], tree: BandTree, count: int
) -> list[NDArray[np.float32]]:
    """
    Give the same as :func:`_power_by_band`, for a tree that is made of equal tiles.

    The spectrum of a squared envelope is the autocorrelation of its band. Bands overlap, so it is
    summed from the products within each tile and those of each tile with the next two: every bin
    is transformed once for all levels, not once per band.
    """
    tile = tree.levels[-1][0] // 2
    bins = tree.levels[0][0]
    tiles, lags = bins // tile, count + 2
    # What ends with the tile, what it gives to a band that goes on by one, and by two more.
    last = np.zeros((len(whitened), tiles, lags), np.complex64)
    inner = np.empty((len(whitened), tiles - 1, lags), np.complex64)
    far = np.empty((len(whitened), tiles - 2, max(lags - tile, 0)), np.complex64)
    within = min(lags, tile)
    for row, spectrum in enumerate(whitened):
        padded = np.zeros((tiles, 2 * tile), np.complex64)
        padded[:, :tile] = spectrum[:bins].reshape(tiles, tile)
        signal = fft.ifft(padded, axis=-1, norm='forward', overwrite_x=True)
        squared = _squared(signal)
        # Lag 0 apart: its rounding would drown the others beside a strong carrier.
        mean = squared.mean(axis=-1)
        squared -= mean[:, np.newaxis]
        last[row, :, :within] = fft.rfft(squared, axis=-1)[:, :within]
        last[row, :, 0] = mean * np.float32(2 * tile)
        # Lag 0 between the first bins of two tiles is lag ``tile`` of the whole spectrum.
        beside = _cross(signal, 1)
        np.add(
            last[row, :-1, :within], beside[:, tile : tile + within], out=inner[row, :, :within]
        )
        if far.shape[-1]:
            inner[row, :, tile:] = beside[:, : lags - tile]
            far[row] = _cross(signal, 2)[:, tile:lags]
    levels = []
    for _ in tree.levels:
        levels.append(_line_power(inner + last[:, 1:]))
        last = inner[:, 0::2] + last[:, 1::2]
        if len(levels) == 1:
            inner[:, :-1, tile:] += far
        inner = inner[:, 0:-1:2] + inner[:, 1::2]
    return levels[::-1]


def _cross(signal: NDArray[np.complex64], apart: int) -> NDArray[np.complex64]:
    """Cross-correlation of each tile with the one so many further on, from their transforms."""
    product = np.conj(signal)
    product[:-apart] *= signal[apart:]
    # Transforms go four at a time: those of the last tiles, which have no partner, are free.
    return np.asarray(fft.fft(product, axis=-1, overwrite_x=True))[:-apart]


def _line_power(correlation: NDArray[np.complex64]) -> NDArray[np.float32]:
    """Power of the lines over lag 0's, without the mean, under a Hann window: 1 - cos is three."""
    mean = np.maximum(correlation[..., :1].real, np.float32(_TINY))
    correlation[..., 0] = 0.0
    # Real and imaginary parts side by side: half the work of complex products with real factors.
    parts = correlation.view(np.float32)
    lines = parts[..., :-4] + parts[..., 4:]
    lines *= np.float32(-0.5)
    lines += parts[..., 2:-2]
    lines *= 1.0 / mean
    lines *= lines
    return np.asarray(lines[..., 0::2] + lines[..., 1::2])


def _squared(signal: NDArray[np.complex64]) -> NDArray[np.float32]:
    """Squared magnitude."""
    squared = signal.real**2
    squared += signal.imag**2
    return squared
