# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
From a record to squared envelope spectra: floor, whitening, band tree, demodulation.

Every function works on plain arrays and can be used alone. Spectra are one-sided.
"""

from __future__ import annotations

from dataclasses import dataclass
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
    position = (np.arange(count) - (offset + hop - 0.5)) / hop
    left = np.clip(np.floor(position).astype(np.intp), 0, blocks - 3)
    weight = np.clip(position - left, 0.0, 1.0).astype(power.dtype)
    below, above = levels[..., left], levels[..., left + 1]
    return np.asarray(below + (above - below) * weight)


def line_cap(turns: float) -> float:
    """
    Power over the floor at which a line is capped, for a window of so many shaft turns.

    Twice the floor in amplitude at 50 turns. A line stands out of the floor by the length of the
    window, and so do the lines of a fault whose impacts keep time: the cap grows with the window,
    so that the modulation index of a fault does not fall with it.
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

    """
    power = spectrum.real**2 + spectrum.imag**2
    floor = local_floor(power, width)
    gains = (
        floor,
        np.maximum(floor, power / np.float32(cap)),
        np.maximum(power, _TINY),
    )
    return np.asarray(spectrum / np.sqrt(np.stack(gains)))


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

    """
    count = max(int(max_hz / tree.bin_hz), 16)
    parts = []
    for width, firsts in tree.levels:
        length = fft.next_fast_len(width + min(count, width) + 1)
        bands = np.stack([whitened[:, first : first + width] for first in firsts], axis=1)
        signal = fft.ifft(bands, length, axis=-1)
        envelope = signal.real**2 + signal.imag**2
        mean = np.maximum(envelope.mean(axis=-1, keepdims=True), np.float32(_TINY))
        window = (1.0 - np.cos(2.0 * np.pi * np.arange(length) / length)).astype(np.float32)
        lines = fft.rfft((envelope - mean) * (window / (length * mean)), axis=-1)
        lines = lines[..., 1 : count + 1]
        power = lines.real**2 + lines.imag**2
        if power.shape[-1] < count:
            power = np.pad(power, ((0, 0), (0, 0), (0, count - power.shape[-1])))
        parts.append(power)
    power = np.concatenate(parts, axis=1)
    return EnvelopeSpectra(tree.bin_hz, power, local_floor(power, floor_width))
