# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Periodograms of squared envelopes, whole or in overlapping segments.

The power of each line is taken with a Hann window, relative to the power of the mean.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from bearing_twin.diagnosis.signal.stockham import (
    address,
    aligned,
    is_quick,
    put,
    radices,
    ROW,
    sixteen,
    times,
    transform_passes,
    transform_rows,
    twenty,
    twiddles,
)
from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.vector import chosen, L, load, load_from, splat, store
import numpy as np
from numpy.typing import NDArray

_TINY = 1e-30
_FIRST = 20, 16
"""Possible factors of a first pass that takes its rows from segments."""


class OverlappingParts(NamedTuple):
    """
    A record in overlapping parts that fade into one another.

    >>> parts = [np.ones((6, 2), np.float32), np.full((6, 2), 2.0, np.float32)]
    >>> OverlappingParts(parts, 2).joined()[:, 0].tolist()
    [1.0, 1.0, 3.0, 3.0, 2.0, 2.0, 2.0, 2.0]

    """

    parts: Sequence[NDArray[np.float32]]
    """Parts of equal length, (hop + lap, ...)."""
    lap: int = 0
    """Overlap of each part with the previous one, points; that of the first part is left out."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the joined record."""
        points, *columns = self.parts[0].shape
        return (len(self.parts) * (points - self.lap), *columns)

    def joined(self) -> NDArray[np.float32]:
        """Return the joined record as a new array."""
        lap, whole = self.lap, aligned(*self.shape)
        hop = len(whole) // len(self.parts)
        np.concatenate([part[lap:] for part in self.parts], out=whole)
        for number, part in enumerate(self.parts[1:], start=1):
            end = whole[number * hop - lap : number * hop]
            end += part[:lap]
        return whole


def _transform_lapping(x: OverlappingParts, each: int) -> NDArray[np.float32]:
    """
    Return the transform of parts, with ``each`` points a row, as `transform_rows` of the whole.

    The first pass reads its rows from the parts: joining them first takes as long as the pass.
    """
    points, count = len(x.parts[0]), x.shape[0] // each
    number, lap = len(x.parts), x.lap // each
    # The rows of a butterfly are taken from all parts in equal numbers.
    fits = (r for r in _FIRST if r % number == 0 and count % r == 0 and lap <= count // r)
    radix = next(fits, 0)
    if not radix or points % each or x.lap % each or not is_quick(count):
        return transform_rows(x.joined().reshape(-1, ROW))
    parts = [np.ascontiguousarray(part) for part in x.parts]
    places = np.array([address(part) for part in parts])
    left = count // radix
    factors, room = radices(left), aligned(2 * count + 40, ROW)
    rows, other, few = room[:count], room[count:-40], room[-40:]
    _transform_parts(places, lap, radix, twiddles(count), factors, few, rows, other)
    return (rows, other)[len(factors) % 2]


@compiled(fast=FAST, borrows=True)
def _transform_parts(
    places: NDArray[np.intp],
    lap: int,
    radix: int,
    twiddles: NDArray[np.float32],
    radices: NDArray[np.intp],
    few: NDArray[np.float32],
    rows: NDArray[np.float32],
    other: NDArray[np.float32],
) -> None:
    """
    Do all passes of a transform, the first one from overlapping parts of a record.

    Parameters
    ----------
    places
        (P,) addresses of the parts, (N / P + lap, 32) each.
    lap
        Overlap of the parts, rows.
    radix
        Radix of the first pass, 16 or 20: a multiple of P.
    twiddles, radices
        Twiddle factors of N, and factors of N / radix.
    few
        (40, 32) scratch memory.
    rows, other
        (N, 32), see :func:`transform_passes`.

    """
    left, hop, each = len(rows) // radix, len(rows) // len(places), radix // len(places)
    gathered, work = few[:20], few[20:]
    for p in range(left):
        for k in range(radix):
            number = k // each
            at = lap + p + left * (k - number * each)
            real, imag = load_from(places[number], 2 * at), load_from(places[number], 2 * at + 1)
            if at >= hop and number + 1 < len(places):
                beside, behind = places[number + 1], 2 * (at - hop)
                real = real + load_from(beside, behind)
                imag = imag + load_from(beside, behind + 1)
            put(gathered, 2 * k, real, imag)
        if radix == 16:
            sixteen(gathered, 0, 2, twiddles, p, left, 1, work, rows, 32 * p)
        else:
            twenty(gathered, 0, 2, twiddles, p, left, 1, work, rows, 40 * p)
    transform_passes(rows, left, twiddles, radices, work, other)


def power_of_lines(x: OverlappingParts, power: NDArray[np.float32], first: int) -> None:
    """
    Write the power of the lines of squared envelopes relative to the power of their mean.

    A Hann window is applied in the frequency domain: half of both neighbours is subtracted from
    each line.

    Parameters
    ----------
    x
        Up to sixteen columns, shape (N, n).
    power
        (K, B); row k is line k + 1. At most n of its columns are written.
    first
        First of these columns.

    >>> x = 1.0 + np.cos(2.0 * np.pi * 3.0 / 64.0 * np.arange(64.0))[:, np.newaxis]
    >>> power = np.empty((6, 1), np.float32)
    >>> power_of_lines(OverlappingParts([x.astype(np.float32)]), power, 0)
    >>> power[:, 0].round(4).tolist()
    [0.0, 0.0625, 0.25, 0.0625, 0.0, 0.0]

    """
    count, columns = x.shape
    if columns == 4 and count % 8 == 0:
        rows = _transform_lapping(x, 8)
        quarters, lines = aligned(count // 8 + 1, ROW), aligned(len(power) + 2, 8)
        _four_line_power(
            rows, twiddles(count // 4), twiddles(count), quarters, lines, power, first
        )
    else:
        whole = columns == L and count % 2 == 0
        rows = _transform_lapping(x, 2) if whole else transform_rows(_pairs(x.joined()))
        _line_power(rows, twiddles(count), power, first, np.empty(L, np.float32))


def _pairs(x: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return rows of up to sixteen columns; an even number of samples forms complex pairs."""
    count, columns = x.shape
    rows = np.zeros((count // 2, 2, L) if count % 2 == 0 else (count, 1, 2 * L), np.float32)
    rows[..., :columns] = x.reshape(len(rows), -1, columns)
    return rows.reshape(-1, ROW)


@compiled(inline=True, fast=FAST)
def _line(rows: NDArray[np.float32], twiddles: NDArray[np.float32], k: int) -> tuple[Any, Any]:
    """
    Return a line of sixteen real columns, transformed with two samples as one complex number.

    Parameters
    ----------
    rows
        (N / 2, 32) transforms; if N is odd, (N, 32) transforms of the columns themselves.
    twiddles
        (N, 2).
    k
        Number of the line, up to N / 2.

    """
    count = len(rows)
    if count == len(twiddles):
        return load(rows, 2 * k), load(rows, 2 * k + 1)
    a, b = 2 * (k if k < count else 0), 2 * (count - k if k else 0)
    ar, ai, br, bi = load(rows, a), load(rows, a + 1), load(rows, b), load(rows, b + 1)
    # The transforms of the even and of the odd samples; the odd ones are half a step later.
    er, ei, dr, di = 0.5 * (ar + br), 0.5 * (ai - bi), 0.5 * (ai + bi), 0.5 * (br - ar)
    real, imag = times(dr, di, twiddles[k])
    return er + real, ei + imag


@compiled(fast=FAST, borrows=True)
def _line_power(
    rows: NDArray[np.float32],
    twiddles: NDArray[np.float32],
    power: NDArray[np.float32],
    first: int,
    last: NDArray[np.float32],
) -> None:
    """
    Write the power of the lines with a Hann window relative to the power of the mean.

    In the frequency domain the window subtracts half of both neighbours from each line.

    Parameters
    ----------
    rows, twiddles
        Transforms of sixteen squared envelopes, see `_pairs`.
    power
        (K, B); row k is line k + 1. At most sixteen of its columns are written.
    first
        First of these columns.
    last
        (16,) scratch memory.

    """
    columns = power.shape[1] - first
    mean, _ = _line(rows, twiddles, 0)
    scale = 1.0 / chosen(mean > _TINY, mean, splat(np.float32(_TINY)))
    # The mean itself leaks into the first line.
    below_real = below_imag = splat(np.float32(0.0))
    real, imag = _line(rows, twiddles, 1)
    for k in range(len(power)):
        above_real, above_imag = _line(rows, twiddles, k + 2)
        at_real = (real - 0.5 * (below_real + above_real)) * scale
        at_imag = (imag - 0.5 * (below_imag + above_imag)) * scale
        at = at_real * at_real + at_imag * at_imag
        if columns >= L:
            store(power[k, first:], 0, at)
        else:
            store(last, 0, at)
            for column in range(columns):
                power[k, first + column] = last[column]
        below_real, below_imag, real, imag = real, imag, above_real, above_imag


@compiled(fast=FAST, borrows=True)
def _four_line_power(
    rows: NDArray[np.float32],
    twiddles: NDArray[np.float32],
    all_twiddles: NDArray[np.float32],
    quarters: NDArray[np.float32],
    lines: NDArray[np.float32],
    power: NDArray[np.float32],
    first: int,
) -> None:
    """
    Write the power of the lines of four columns, transformed as columns of every fourth sample.

    Parameters
    ----------
    rows, twiddles
        Transforms of sixteen columns of a quarter of the length: the first samples of each four,
        then the second ones, and so on; see :func:`_line_power`.
    all_twiddles
        (N, 2) twiddle factors of the whole length.
    quarters
        (N / 8 + 1, 32) scratch memory.
    lines
        (K + 2, 8) scratch memory.
    power, first
        (K, B), written from the first of four columns on; row k is line k + 1.

    """
    count, whole = len(twiddles), len(all_twiddles)
    for k in range(len(quarters)):
        real, imag = _line(rows, twiddles, k)
        put(quarters[k], 0, real, imag)
    at = first_twiddle = second_twiddle = third_twiddle = 0
    for k in range(len(lines)):
        mirrored = at >= len(quarters)
        sign = np.float32(-1.0 if mirrored else 1.0)
        row, line = quarters[count - at if mirrored else at], lines[k]
        one, two, three = (
            all_twiddles[first_twiddle],
            all_twiddles[second_twiddle],
            all_twiddles[third_twiddle],
        )
        for c in range(4):
            ar, ai = row[c], sign * row[L + c]
            br, bi = row[4 + c], sign * row[L + 4 + c]
            cr, ci = row[8 + c], sign * row[L + 8 + c]
            dr, di = row[12 + c], sign * row[L + 12 + c]
            br, bi = times(br, bi, one)
            cr, ci = times(cr, ci, two)
            dr, di = times(dr, di, three)
            line[c], line[4 + c] = ar + br + cr + dr, ai + bi + ci + di
        # Remainders of k, 2 k and 3 k without a division.
        at += 1 - count * (at + 1 == count)
        first_twiddle += 1 - whole * (first_twiddle + 1 == whole)
        second_twiddle += 2 - whole * (second_twiddle + 2 >= whole)
        third_twiddle += 3 - whole * (third_twiddle + 3 >= whole)
    means = quarters[0]
    for c in range(4):
        means[c] = np.float32(1.0) / max(lines[0, c], np.float32(_TINY))
    # The mean itself leaks into the first line.
    lines[0] = np.float32(0.0)
    half = np.float32(0.5)
    for k in range(len(power)):
        for c in range(4):
            real = (lines[k + 1, c] - half * (lines[k, c] + lines[k + 2, c])) * means[c]
            imag = lines[k + 1, 4 + c] - half * (lines[k, 4 + c] + lines[k + 2, 4 + c])
            imag *= means[c]
            power[k, first + c] = real * real + imag * imag
