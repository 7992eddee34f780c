# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Local floor and whitening of spectra, and squared envelope spectra.

All functions take plain arrays and can be used alone. Spectra are one-sided.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
import functools

from bearing_twin.diagnosis.signal.periodogram import OverlappingParts, power_of_lines
from bearing_twin.diagnosis.signal.ranks import column_ranks
from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.vector import L, load, logarithm, split, store
import numpy as np
from numpy.typing import NDArray
from scipy import fft

WHITENINGS = ('capped', 'cepstral')
"""Whitenings of :func:`whiten`, in the order of its output."""

_TINY = 1e-30
_UPPER = 0.8413
"""Probability of a normal distribution up to one standard deviation over its mean."""
_CAP, _CAP_TURNS = 4.0, 50.0


def transform(x: NDArray[np.float32]) -> NDArray[np.complex64]:
    """
    Return the one-sided transform of a record, as four transforms of every fourth sample.

    Parameters
    ----------
    x
        Shape (n,).

    >>> x = np.random.default_rng(0).standard_normal(4096).astype(np.float32)
    >>> bool(np.allclose(transform(x), np.fft.rfft(x), atol=1e-3))
    True

    """
    if len(x) % 4:
        return np.asarray(fft.rfft(x))
    joined = np.empty(len(x) // 2 + 1, np.complex64)
    _join_quarters(fft.rfft(x.reshape(-1, 4), axis=0), _twiddles(len(x)), joined)
    return joined


@functools.lru_cache(maxsize=256)
def _twiddles(count: int) -> NDArray[np.complex64]:
    """Return the twiddle factors that join transforms of every fourth of ``count`` samples."""
    twiddles = np.exp(-2j * np.pi / count * np.arange(count // 8 + 1))
    return np.asarray(twiddles, np.complex64)


def local_floor(power: NDArray[np.float32], width: int) -> NDArray[np.float32]:
    """
    Return the mean power of the noise around each bin, without lines.

    It is the median over blocks, interpolated linearly, over the median of the exponential
    distribution with mean 1, which the periodogram of stationary noise has: ln 2 for many bins.
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
    levels, first, hop = floor_levels(power, width)
    floor = np.empty(power.shape, levels.dtype)
    spectra = floor.reshape(-1, power.shape[-1])
    _interpolate(levels.reshape(len(spectra), -1), first, hop, spectra)
    return floor


def floor_levels(power: NDArray[np.float32], width: int) -> tuple[NDArray[np.float32], float, int]:
    """
    Return the levels of :func:`local_floor`, the bin of the first one, and the bins between them.

    Each level is the mean of two neighbouring blocks of half the width.

    >>> levels, first, hop = floor_levels(np.ones(4096, np.float32), 256)
    >>> levels.shape, first, hop
    ((31,), 127.5, 128)

    """
    hop, blocks, offset = _blocks(power.shape[-1], width)
    tiles = np.array(power[..., offset : offset + blocks * hop], order='C')
    tiles = tiles.reshape(*power.shape[:-1], blocks, hop)
    middle = hop // 2
    tiles.partition(middle, axis=-1)
    return _levels(tiles[..., middle].T, hop).T, offset + hop - 0.5, hop


def _column_levels(
    power: NDArray[np.float32], width: int
) -> tuple[NDArray[np.float32], float, int]:
    """
    Return the levels (L, B) of the floor along the columns of (K, B), from every other row.

    With a Hann window the rows between add no information. Width and bins count all rows; see
    :func:`floor_levels`.

    >>> levels, first, hop = _column_levels(np.ones((8192, 3), np.float32), 512)
    >>> levels.shape, first, hop
    ((31, 3), 255.0, 256)

    """
    hop, blocks, offset = _blocks(-(-len(power) // 2), width // 2)
    medians = _ranked(power, 2 * offset, 2, hop, hop // 2, blocks=blocks)
    return _levels(medians, hop), 2.0 * (offset + hop - 0.5), 2 * hop


def _blocks(count: int, width: int) -> tuple[int, int, int]:
    """Return the bins of a half-width block, the number of blocks, and their first bin."""
    hop = max(width // 2, 4)
    blocks = count // hop
    if blocks < 3:
        hop, blocks = count, 1
    # Centred, so that the blocks leave over equal numbers of bins at both ends.
    return hop, blocks, (count - blocks * hop) // 2


def _levels(medians: NDArray[np.float32], hop: int) -> NDArray[np.float32]:
    """Return levels from the medians of blocks along the first axis."""
    medians = medians * np.float32(_over_middle(hop))
    levels = 0.5 * (medians[1:] + medians[:-1]) if len(medians) > 1 else medians
    return np.asarray(np.maximum(levels, np.float32(_TINY)))


def _ranked(
    values: NDArray[np.float32],
    first: int,
    step: int,
    count: int,
    rank: int,
    away: float = 0.0,
    blocks: int = 1,
) -> NDArray[np.float32]:
    """Return the value of a rank in each column of each block, see `column_ranks`."""
    columns = values.shape[1]
    found = np.empty((blocks, max(columns, L)), np.float32)
    if columns < L:
        values = np.pad(values, ((0, 0), (0, L - columns)))
    column_ranks(values, first, step, count, rank, away, found)
    return found[:, :columns]


@functools.lru_cache(maxsize=256)
def _over_middle(count: int) -> float:
    """Return one over the mean of the median of ``count`` exponential variables, near 1 / ln 2."""
    return 1.0 / float((1.0 / np.arange(count - count // 2, count + 1)).sum())


def quantiles(
    values: NDArray[np.floating],
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """
    Return the median and the 84 % quantile along the last axis.

    >>> [float(found) for found in quantiles(np.arange(100.0))]
    [50.0, 84.0]

    """
    middle, upper = values.shape[-1] // 2, int(_UPPER * values.shape[-1])
    ordered = np.array(values, order='C')
    # One after the other: numpy is slow for two at once.
    ordered.partition(middle, axis=-1)
    center = ordered[..., middle].copy()
    above = ordered[..., middle:]
    above.partition(upper - middle, axis=-1)
    return center, above[..., upper - middle]


def column_quantiles(
    values: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """
    Return the median and the 84 % quantile of each column.

    >>> center, upper = column_quantiles(np.arange(100.0, dtype=np.float32)[:, None])
    >>> float(center[0]), float(upper[0])
    (50.0, 84.0)

    """
    count = len(values)
    return (
        _ranked(values, 0, 1, count, count // 2)[0],
        _ranked(values, 0, 1, count, int(_UPPER * count), 1.0)[0],
    )


def line_cap(turns: float) -> float:
    """
    Return the power over the floor at which a line is capped, for a window of some shaft turns.

    It is twice the floor in amplitude at 50 turns. Lines rise over the floor with the length of
    the window, also those of a fault with regular impacts. So the cap grows with the window, and
    the modulation index of a fault does not fall.

    >>> line_cap(25.0), line_cap(50.0), line_cap(200.0)
    (4.0, 4.0, 16.0)

    """
    return _CAP * max(turns / _CAP_TURNS, 1.0)


def whiten(
    spectrum: NDArray[np.complex64], width: int, *, cap: float = 4.0
) -> NDArray[np.complex64]:
    """
    Return a spectrum whitened in two ways, which have different weaknesses.

    ``capped`` divides by the local floor and limits each line to a few times the floor, so that
    gear and mains lines lose their weight. ``cepstral`` keeps the phase only (cepstrum
    pre-whitening, Borghesani et al. 2013): it ranks best but destroys effect size. Division by the
    floor without a cap finds no additional fault.

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
    Array of shape (2, K) in the order of :data:`WHITENINGS`.

    >>> spectrum = np.fft.rfft(np.random.default_rng(0).standard_normal(4096)).astype(np.complex64)
    >>> capped, cepstral = whiten(spectrum, 256)
    >>> bool(np.allclose(np.abs(cepstral), 1.0, atol=1e-3))
    True

    """
    floor = local_floor(line_powers(spectrum), width)
    white = np.empty((len(WHITENINGS), len(spectrum)), np.complex64)
    _whiten(spectrum, floor, np.float32(1.0 / cap), *white)
    return white


def line_powers(spectrum: NDArray[np.complex64]) -> NDArray[np.float32]:
    """
    Return the squared magnitude of each line of a spectrum, shape (K,).

    >>> line_powers(np.array([3.0 + 4.0j, 1.0j], np.complex64)).tolist()
    [25.0, 1.0]

    """
    power = np.empty(len(spectrum), spectrum.real.dtype)
    _square(spectrum, power)
    return power


@dataclass(frozen=True)
class EnvelopeSpectra:
    """
    Squared envelope spectra of all bands.

    Power is relative to that of the mean: a sinusoidal modulation has 1/4 of its squared
    modulation index. Row k belongs to (k + 1) bin_hz; columns are bands, whitening by whitening.
    """

    bin_hz: float
    logs: NDArray[np.float32]
    """(K, W B) log(1 + power / floor)."""
    excess: NDArray[np.float32]
    """(K, B) power above the floor, with lines capped."""
    power: NDArray[np.float32]
    """(B, K) power, with lines capped."""
    levels: NDArray[np.float32]
    """(B, L) local floor of ``power`` at L bins."""
    first: float
    """First of these bins."""
    hop: int
    """Bins from one of these bins to the next."""

    def floor(self, band: int) -> NDArray[np.float32]:
        """Return the local floor of the power of a band, (K,)."""
        floor = np.empty((1, self.power.shape[1]), np.float32)
        _interpolate(self.levels[band : band + 1], self.first, self.hop, floor)
        return np.asarray(floor[0])


def envelope_spectra(
    envelopes: Iterable[OverlappingParts],
    rate: float,
    *,
    bands: int,
    max_hz: float,
    floor_width: int,
) -> EnvelopeSpectra:
    """
    Return the spectra of squared envelopes up to ``max_hz``.

    A Hann window keeps the leakage of strong lines low. Up to sixteen bands at a time stay in the
    cache from one step to the next.

    Parameters
    ----------
    envelopes
        Squared envelopes, (N, n), of up to sixteen bands at a time, whitening by whitening.
        Columns after the last band do not count.
    rate
        Points a second.
    bands
        Number of bands of a whitening, B.
    max_hz
        Highest envelope frequency, Hz.
    floor_width
        Bins in a block of the floor.

    >>> noise = np.random.default_rng(0).exponential(size=(2, 1280, 4)).astype(np.float32)
    >>> envelopes = [OverlappingParts([part]) for part in noise]
    >>> found = envelope_spectra(envelopes, 1280.0, bands=4, max_hz=500.0, floor_width=64)
    >>> found.logs.shape, found.power.shape, found.bin_hz
    ((500, 8), (4, 500), 1.0)

    """
    begin = 0
    for part in envelopes:
        points, columns = part.shape
        if not begin:
            bin_hz = rate / points
            count = min(max(int(max_hz / bin_hz), 16), points // 2 - 1)
            power = np.empty((count, len(WHITENINGS) * bands), np.float32)
        power_of_lines(part, power, begin)
        begin += columns
    levels, first, hop = _column_levels(power, floor_width)
    room, excess = np.empty(power.size + L, np.float32), np.empty((count, bands), np.float32)
    _over_floor(power, levels, first, hop, room, excess)
    logs = room[: power.size].reshape(power.shape)
    return EnvelopeSpectra(bin_hz, logs, excess, power[:, :bands].T, levels.T[:bands], first, hop)


@compiled(inline=True)
def _bins_between(part: int, parts: int, first: float, hop: int, count: int) -> tuple[int, int]:
    """Return the first bin between two levels of a floor, and the bin after the last."""
    # Before the first level and after the last the floor is flat.
    begin = 0 if part == 0 else min(max(int(np.ceil(first + (part - 1) * hop)), 0), count)
    end = count if part == parts else min(int(np.ceil(first + part * hop)), count)
    return begin, end


@compiled(fast=FAST, borrows=True)
def _interpolate(
    levels: NDArray[np.float32], first: float, hop: int, floor: NDArray[np.float32]
) -> None:
    """
    Write the floor of each spectrum, (n, K), interpolated between its levels, (n, L).

    The levels are at the bins ``first + l hop``.
    """
    parts, count = levels.shape[1], floor.shape[1]
    for n in range(len(floor)):
        row = floor[n]
        for part in range(parts + 1):
            begin, end = _bins_between(part, parts, first, hop, count)
            low, high = levels[n, max(part - 1, 0)], levels[n, min(part, parts - 1)]
            rise = (high - low) / np.float32(hop)
            low += np.float32(begin - (first + (part - 1) * hop)) * rise
            for k in range(end - begin):
                row[begin + k] = low + np.float32(k) * rise


@compiled(fast=FAST, borrows=True)
def _square(spectrum: NDArray[np.complex64], power: NDArray[np.float32]) -> None:
    """Write the squared magnitudes of a spectrum."""
    for k in range(len(power)):
        power[k] = spectrum[k].real * spectrum[k].real + spectrum[k].imag * spectrum[k].imag


@compiled(fast=FAST, borrows=True)
def _whiten(
    spectrum: NDArray[np.complex64],
    floor: NDArray[np.float32],
    share: np.float32,
    capped: NDArray[np.complex64],
    cepstral: NDArray[np.complex64],
) -> None:
    """Write both whitenings, (K,); lines with ``share`` times power over floor are capped."""
    one, tiny = np.float32(1.0), np.float32(_TINY)
    for k in range(len(spectrum)):
        power = spectrum[k].real * spectrum[k].real + spectrum[k].imag * spectrum[k].imag
        capped[k] = spectrum[k] * (one / np.sqrt(max(floor[k], power * share)))
        cepstral[k] = spectrum[k] * (one / np.sqrt(max(power, tiny)))


@compiled(fast=FAST, borrows=True)
def _over_floor(
    power: NDArray[np.float32],
    levels: NDArray[np.float32],
    first: float,
    hop: int,
    logs: NDArray[np.float32],
    excess: NDArray[np.float32],
) -> None:
    """
    Write the log of one plus power over floor, and the power above the floor, of each bin.

    Parameters
    ----------
    power
        (K, B).
    levels
        (L, B) floor at the bins ``first + n hop``; it is linear between them and flat outside.
    first, hop
        See ``levels``.
    logs
        (K B + 16,), written bin after bin; the last sixteen numbers do not count.
    excess
        (K, <= B), written for as many bands.

    """
    count, bands = power.shape
    parts, wanted = len(levels), excess.shape[1]
    zero, one = np.float32(0.0), np.float32(1.0)
    ratio = logs[: count * bands].reshape(count, bands)
    logged = 0
    for part in range(parts + 1):
        begin, end = _bins_between(part, parts, first, hop, count)
        low, high = levels[max(part - 1, 0)], levels[min(part, parts - 1)]
        for k in range(begin, end):
            way = np.float32((k - (first + (part - 1) * hop)) / hop)
            values, over, above = power[k], ratio[k], excess[k]
            for band in range(bands):
                over[band] = one + values[band] / (low[band] + way * (high[band] - low[band]))
            for band in range(wanted):
                left = values[band] - (low[band] + way * (high[band] - low[band]))
                above[band] = left if left > zero else zero
        # In lanes, because numpy's logarithm takes twice as long, and while they are in the cache.
        ready = len(logs) // L if part == parts else end * bands // L
        for n in range(logged, ready):
            exponent, rest = split(load(logs, n))
            store(logs, n, logarithm(exponent, rest))
        logged = ready


@compiled(fast=FAST, borrows=True)
def _join_quarters(
    quarters: NDArray[np.complex64], twiddles: NDArray[np.complex64], joined: NDArray[np.complex64]
) -> None:
    """
    Write the one-sided transform of a record from the transforms of every fourth sample.

    Parameters
    ----------
    quarters
        (M // 2 + 1, 4) one-sided transforms of M samples each.
    twiddles
        (M // 2 + 1,) twiddle factors of the second quarter.
    joined
        (2 M + 1,), written.

    """
    each, last = len(joined) // 2, len(joined) - 1
    for k in range(len(twiddles)):
        one, twiddle = quarters[k, 0], twiddles[k]
        two, three = twiddle * quarters[k, 1], twiddle * twiddle * quarters[k, 2]
        four = twiddle * twiddle * twiddle * quarters[k, 3]
        even, odd = one + three, two + four
        away, across = one - three, two - four
        # Times i.
        across = np.complex64(complex(-across.imag, across.real))
        joined[k] = even + odd
        joined[each + k] = away - across
        joined[each - k] = np.conj(away + across)
        joined[last - k] = np.conj(even - odd)
