# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Band tree of a spectrum, and squared envelopes of its bands."""

from __future__ import annotations

from dataclasses import dataclass
import functools
import math
from typing import Any

from bearing_twin.diagnosis.signal.stockham import (
    aligned,
    is_quick,
    put,
    radices,
    real_columns,
    ROW,
    transform_passes,
    twiddles,
)
from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.vector import L, load, store
import numpy as np
from numpy.typing import NDArray
from scipy import fft

_MOST_TILES = 8


@dataclass(frozen=True)
class BandTree:
    """Bands of a 1/2-band tree with 50 % overlap, as bins of a one-sided spectrum."""

    bin_hz: float
    levels: tuple[tuple[int, tuple[int, ...]], ...]
    """For each level, the width and the first bins of its bands."""

    @functools.cached_property
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
    Return a tree over ``bins`` bins: the whole range, then 3, 7, 15, ... half-overlapping bands.

    It ends after ``depth`` halvings, or before bands narrower than ``narrowest_hz``. No band ends
    above ``reach`` times its width: a resonance there fills wider bands.

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
) -> list[NDArray[np.float32]]:
    """
    Return the squared envelope of every band, sampled at equal steps.

    A slice of the one-sided spectrum, transformed back, is the analytic signal of an ideal band
    filter (Ho and Randall 2000). The spectrum of its squared envelope is the autocorrelation of
    the slice. It ends at half the rate of the points, so nothing is aliased.

    Parameters
    ----------
    whitened
        (2, K) whitened spectra.
    tree
        Bands.
    points
        Number of points over the length of the record, at least 16.

    Returns
    -------
    Arrays of shape (``points``, n) whose columns are the bands, whitening by whitening: sixteen
    columns each, 4 or 16 in the last one. Columns after the last band are zero.

    >>> from bearing_twin.diagnosis.signal.spectra import whiten
    >>> noise = np.random.default_rng(0).standard_normal(25600)
    >>> spectrum = np.fft.rfft(noise).astype(np.complex64)
    >>> tree = band_tree(12800, 1.0, depth=2, narrowest_hz=500.0)
    >>> [part.shape for part in squared_envelopes(whiten(spectrum, 256), tree, 1280)]
    [(1280, 16), (1280, 16)]

    """
    count = len(whitened) * len(tree.bands)
    lags = np.zeros((points // 2 + 1, 2, count + 2 * L), np.float32)
    add_to = _by_tile if _tiles_suit(tree, len(lags)) else _by_band
    add_to(whitened, tree, lags)
    envelopes = [
        np.ascontiguousarray(real_columns(lags, first, points)) for first in range(0, count, L)
    ]
    if count % L == 4:
        # Four columns are later transformed as sixteen columns of a quarter of the length.
        envelopes[-1] = np.ascontiguousarray(envelopes[-1][:, :4])
    return envelopes


def _tile(tree: BandTree) -> int:
    """Return the bins of a tile: at most half the narrowest band, and at least sixteen tiles."""
    return min(tree.levels[-1][0] // 2, tree.levels[0][0] // L)


def _tiles_suit(tree: BandTree, lags: int) -> bool:
    """Return whether all bands consist of tiles, and the lags reach few tiles."""
    bins, tile = tree.levels[0][0], _tile(tree)
    return (
        tile > 0
        and bins % (L * tile) == 0
        and all(width % (2 * tile) == 0 for width, _ in tree.levels)
        and lags - 1 <= _MOST_TILES * tile
        and is_quick(2 * tile)
    )


def _by_band(whitened: NDArray[np.complex64], tree: BandTree, lags: NDArray[np.float32]) -> None:
    """Write the autocorrelation of each band, conjugated, one level at a time."""
    column = 0
    for width, firsts in tree.levels:
        length = fft.next_fast_len(width + min(len(lags), width))
        bands = np.zeros((len(whitened), len(firsts), length), np.complex64)
        for i, first in enumerate(firsts):
            bands[:, i, :width] = whitened[:, first : first + width]
        envelope = np.abs(fft.ifft(bands, axis=-1, norm='forward', overwrite_x=True)) ** 2
        level = fft.rfft(envelope, axis=-1, norm='forward')[..., : len(lags)].T
        for whitening in range(len(whitened)):
            part = lags[: len(level), :, whitening * len(tree.bands) + column :]
            part[:, 0, : len(firsts)] = level[..., whitening].real
            part[:, 1, : len(firsts)] = -level[..., whitening].imag
        column += len(firsts)


def _by_tile(whitened: NDArray[np.complex64], tree: BandTree, lags: NDArray[np.float32]) -> None:
    """
    Write the autocorrelation of each band, conjugated, for a tree of equal tiles.

    Bands overlap, so their autocorrelations are sums of products within each tile and with the
    next tiles, as far as the lags reach. Every bin is transformed once for all levels, not once
    per band. Tiles are transformed in parts, as short as the lags allow, and the products of parts
    are summed before they are transformed back.
    """
    parts, part, members = _tiling(tree, len(lags) - 1)
    signals = aligned(len(whitened), members.shape[1] * parts, 2 * part + 1, ROW)
    # The row after the parts is read, so it must be finite.
    signals[:, :, -1] = 0.0
    rows, other = aligned(2, 2 * part, ROW)
    work = aligned(22, ROW)
    _add_tiles(
        whitened, parts, members, len(tree.bands), twiddles(2 * part), radices(2 * part), signals,
        rows, other, work, lags,
    )  # fmt: skip


@functools.lru_cache(maxsize=256)
def _tiling(tree: BandTree, reach: int) -> tuple[int, int, NDArray[np.float32]]:
    """
    Return the parts of a tile, the bins of a part, and the products of tiles in each band.

    A tile has as many parts as possible, each at least as long as the lags; else one part. The
    memberships are for tiles 0, 1, ... tiles apart, (A, groups, 16, 16 n), see `_add_lags`.
    """
    tile = _tile(tree)
    parts = max(
        (
            parts
            for parts in range(2, tile // reach + 1)
            if tile % parts == 0 and is_quick(2 * tile // parts)
        ),
        default=1,
    )
    part, groups = tile // parts, tree.levels[0][0] // (tile * L)
    bands = [(first, first + width) for width, firsts in tree.levels for first in firsts]
    members = np.zeros((-(-reach // part) + 1, groups, L, -(-len(bands) // L) * L), np.float32)
    for apart in range(len(members)):
        for band, (begin, end) in enumerate(bands):
            for number in range(begin // tile, end // tile - apart):
                members[apart, number % groups, number // groups, band] = 1.0
    members.flags.writeable = False
    return parts, part, members


@compiled(borrows=True)
def _add_tiles(
    whitened: NDArray[np.complex64],
    parts: int,
    members: NDArray[np.float32],
    bands: int,
    twiddles: NDArray[np.float32],
    radices: NDArray[np.intp],
    signals: NDArray[np.float32],
    rows: NDArray[np.float32],
    other: NDArray[np.float32],
    work: NDArray[np.float32],
    lags: NDArray[np.float32],
) -> None:
    """
    Add the autocorrelation of each band, conjugated, from the transforms of parts of its tiles.

    Parameters
    ----------
    whitened
        (2, K) spectra.
    parts, members
        See `_tiling`.
    bands
        Number of bands of a whitening.
    twiddles, radices
        Twiddle factors and factors of the length of a transform, which is twice that of a part.
    signals
        (2, groups parts, 2 part + 1, 32) scratch memory; the last row is finite.
    rows, other, work
        (2 part, 32), (2 part, 32) and (22, 32) scratch memory.
    lags
        (K, 2, >= 2 bands + 16) real and imaginary parts, added to.

    """
    part, groups = len(rows) // 2, members.shape[1]
    count, values = groups * parts, work[20:]
    # The passes of a transform go from one array into another and back.
    crosses = len(radices) % 2 == 1
    sums = other if crosses else rows
    for whitening in range(2):
        for number in range(count):
            signal = signals[whitening, number, :-1]
            source, out = (rows, signal) if crosses else (signal, rows)
            _parts_beside(whitened[whitening], part, count, number, source)
            transform_passes(source, 2 * part, twiddles, radices, work[:20], out)
    for group in range(groups):
        rows[:] = np.float32(0.0)
        for number in range(group * parts, (group + 1) * parts):
            _add_powers(signals[0, number], signals[1, number], rows)
        transform_passes(rows, 2 * part, twiddles, radices, work[:20], other)
        for whitening in range(2):
            _add_lags(sums, whitening, 0, members[0, group], whitening * bands, values, lags)
    for whitening in range(2):
        for apart in range(1, len(members)):
            for group in range(groups):
                first, last = group * parts, (group + 1) * parts - 1
                # The last part of a tile is multiplied with a part of another tile.
                for begin, end, beside in ((first, last, 0), (last, last + 1, apart)):
                    if begin == end:
                        continue
                    rows[:] = np.float32(0.0)
                    for number in range(begin, end):
                        shift, at = divmod(number + apart, count)
                        one, second = signals[whitening, number], signals[whitening, at]
                        _add_products(one, second, shift, rows)
                    transform_passes(rows, 2 * part, twiddles, radices, work[:20], other)
                    belong, column = members[beside, group], whitening * bands
                    _add_lags(sums, whitening, apart, belong, column, values, lags)


@compiled(borrows=True)
def _parts_beside(
    spectrum: NDArray[np.complex64], part: int, step: int, first: int, rows: NDArray[np.float32]
) -> None:
    """
    Write parts of a spectrum side by side, with zeros below.

    Parameters
    ----------
    spectrum
        (>= 16 step part,).
    part
        Bins.
    step, first
        Step from one part to the next, in parts, and first part.
    rows
        (2 part, 32), written.

    """
    for n in range(part):
        for k in range(L):
            value = spectrum[(k * step + first) * part + n]
            rows[n, k], rows[n, L + k] = value.real, value.imag
    rows[part:] = np.float32(0.0)


@compiled(fast=FAST, borrows=True)
def _add_powers(
    one: NDArray[np.float32], other: NDArray[np.float32], out: NDArray[np.float32]
) -> None:
    """Add the squared magnitudes of ``one`` to real, and of ``other`` to imaginary parts."""
    for n in range(len(out)):
        ar, ai, br, bi = load(one[n], 0), load(one[n], 1), load(other[n], 0), load(other[n], 1)
        store(out[n], 0, load(out[n], 0) + ar * ar + ai * ai)
        store(out[n], 1, load(out[n], 1) + br * br + bi * bi)


@compiled(fast=FAST, borrows=True)
def _add_products(
    one: NDArray[np.float32], other: NDArray[np.float32], shift: int, out: NDArray[np.float32]
) -> None:
    """
    Add the products of parts with the conjugates of the parts some columns further on.

    Parameters
    ----------
    one, other
        (N, 32) parts; ``shift`` finite numbers follow ``other``.
    shift
        Number of columns; as many products at the end are finite but meaningless.
    out
        (N, 32), added to.

    """
    flat = other.reshape(-1)
    for n in range(len(out)):
        at = 2 * L * n + shift
        ar, ai = load(one[n], 0), load(one[n], 1)
        br, bi = load(flat[at:], 0), load(flat[at + L :], 0)
        store(out[n], 0, load(out[n], 0) + ar * br + ai * bi)
        store(out[n], 1, load(out[n], 1) + ai * br - ar * bi)


@compiled(fast=FAST, borrows=True)
def _add_lags(
    products: NDArray[np.float32],
    whitening: int,
    apart: int,
    members: NDArray[np.float32],
    first: int,
    values: NDArray[np.float32],
    lags: NDArray[np.float32],
) -> None:
    """
    Add the products of parts of its tiles to the conjugated autocorrelation of each band.

    Parameters
    ----------
    products
        (2 part, 32) transforms of the squared magnitudes of both whitenings, or of the products of
        parts of one whitening that are ``apart`` parts apart. Both are sums over the parts of a
        tile.
    whitening, apart
        Index of the whitening, and distance of the parts.
    members
        (16, 16 n), one if a product of tiles belongs to a band, else zero.
    first
        Column of the first band.
    values
        (2, 32) scratch memory.
    lags
        (K, 2, >= first + 16 n) real and imaginary parts, added to.

    """
    part, count = len(products) // 2, len(lags)
    begin, end = max((apart - 1) * part + 1, 0), min((apart + 1) * part, count)
    for lag in range(begin, end, 2):
        # Two lags at once, because the additions of one lag wait for each other. A single last
        # lag is done twice.
        following = min(lag + 1, end - 1)
        real, imag = _product(products, whitening, apart, lag)
        put(values[0], 0, real, imag)
        real, imag = _product(products, whitening, apart, following)
        put(values[1], 0, real, imag)
        for column in range(first, first + members.shape[1], L):
            one, other = lags[lag, :, column:], lags[following, :, column:]
            one_real, one_imag = load(one[0], 0), load(one[1], 0)
            other_real, other_imag = load(other[0], 0), load(other[1], 0)
            for k in range(L):
                belongs = load(members[k, column - first :], 0)
                one_real = one_real + belongs * values[0, k]
                one_imag = one_imag + belongs * values[0, L + k]
                other_real = other_real + belongs * values[1, k]
                other_imag = other_imag + belongs * values[1, L + k]
            store(one[0], 0, one_real)
            store(one[1], 0, one_imag)
            store(other[0], 0, other_real)
            store(other[1], 0, other_imag)


@compiled(inline=True, fast=FAST)
def _product(
    products: NDArray[np.float32], whitening: int, apart: int, lag: int
) -> tuple[Any, Any]:
    """Return the products of all tiles at one lag, see `_add_lags`."""
    length = len(products)
    part, scale = length // 2, np.float32(1.0) / np.float32(length)
    at = lag - apart * part if lag >= apart * part else lag - apart * part + length
    row = products[at]
    real, imag = scale * load(row, 0), scale * load(row, 1)
    if apart == 0:
        other = products[length - at if at else 0]
        mirror_real, mirror_imag = scale * load(other, 0), scale * load(other, 1)
        if whitening == 0:
            real, imag = 0.5 * (real + mirror_real), 0.5 * (imag - mirror_imag)
        else:
            real, imag = 0.5 * (imag + mirror_imag), 0.5 * (mirror_real - real)
    return real, imag
