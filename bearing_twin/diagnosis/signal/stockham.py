# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Fourier transforms of sixteen columns at once, as many as a register of 512 bits holds.

The passes of Stockham's algorithm go from one array into another and back. Libraries for all
processors transform four columns at a time. A row has sixteen complex numbers: 32 numbers of
single precision, the real parts first.

Compiled code of other files calls these functions, so `compiled` lists the name of this file.
"""

from __future__ import annotations

import functools
import itertools
import math
from typing import Any

from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.vector import L, load, store
import numpy as np
from numpy.typing import NDArray
from scipy import fft

ROW = 2 * L
"""Numbers in a row."""

_TOGETHER = 20, 16, 9
"""Radices that combine two passes: four and five, four and four, three and three. Twenty is first:
a length has more twos than fives."""
_LARGEST = 13
"""Largest prime factor of a quick length: a butterfly of a prime radix costs its square."""


@functools.lru_cache(maxsize=256)
def twiddles(count: int) -> NDArray[np.float32]:
    """
    Return the twiddle factors exp(-2 pi i k / count) as cosine and sine, shape (count, 2).

    >>> twiddles(4)[1].round(6).tolist()
    [0.0, -1.0]

    """
    angles = -2.0 * np.pi / count * np.arange(count)
    found = np.stack((np.cos(angles), np.sin(angles)), axis=1).astype(np.float32)
    found.flags.writeable = False
    return found


def transform_rows(rows: NDArray[np.float32]) -> NDArray[np.float32]:
    """
    Return the discrete Fourier transform along the columns.

    Parameters
    ----------
    rows
        Shape (N, 32); overwritten.

    Returns
    -------
    Transform of the same shape.

    >>> rows = np.random.default_rng(0).standard_normal((42, 32)).astype(np.float32)
    >>> exact = np.fft.fft(rows[:, :16] + 1j * rows[:, 16:], axis=0)
    >>> found = transform_rows(rows)
    >>> bool(np.allclose(found[:, :16] + 1j * found[:, 16:], exact, atol=1e-4))
    True

    """
    count = len(rows)
    factors = radices(count)
    if not is_quick(count):
        found = fft.fft(rows[:, :L] + np.complex64(1j) * rows[:, L:], axis=0)
        return np.concatenate((found.real, found.imag), axis=1)
    room = aligned(count + 20, ROW)
    other = room[:count]
    transform_passes(rows, count, twiddles(count), factors, room[count:], other)
    return (rows, other)[len(factors) % 2]


def aligned(*shape: int) -> NDArray[np.float32]:
    """
    Return an uninitialised array that begins at a cache line.

    Sixteen numbers across two cache lines take twice the time.

    >>> aligned(4, 32).ctypes.data % 64
    0

    """
    size = math.prod(shape)
    room = np.empty(size + L, np.float32)
    begin = -address(room) % (4 * L) // room.itemsize
    return room[begin : begin + size].reshape(shape)


@compiled(borrows=True)
def address(room: NDArray[np.float32]) -> int:
    """Return the address of an array; numpy takes ten times as long."""
    return room.ctypes.data


@functools.lru_cache(maxsize=256)
def radices(count: int) -> NDArray[np.intp]:
    """
    Return the radices of a length: combined ones, four, then primes; at least one.

    >>> radices(5120).tolist(), radices(1).tolist()
    ([20, 16, 16], [1])

    """
    found = [] if count > 1 else [1]
    for radix in itertools.chain((*_TOGETHER, 4), itertools.count(2)):
        while count % radix == 0:
            found.append(radix)
            count //= radix
        if count == 1:
            break
    return np.array(found)


def is_quick(count: int) -> bool:
    """
    Return whether a length is quick to transform: it has no prime factor above 13.

    >>> is_quick(1638), is_quick(1700)
    (True, False)

    """
    last = radices(count)[-1]
    return bool(last <= _LARGEST or last in _TOGETHER)


@compiled(inline=True, fast=FAST)
def times(real: Any, imag: Any, twiddle: Any) -> tuple[Any, Any]:
    """Return the product with a twiddle factor."""
    return real * twiddle[0] - imag * twiddle[1], real * twiddle[1] + imag * twiddle[0]


@compiled(inline=True, fast=FAST, borrows=True)
def _four(
    rows: NDArray[np.float32],
    a: int,
    apart: int,
    twiddles: NDArray[np.float32],
    at: int,
    out: NDArray[np.float32],
    o: int,
    beside: int,
) -> None:
    """Write the butterfly of four rows with the twiddle factors ``at``, 2 ``at`` and 3 ``at``."""
    one, two, three = twiddles[at], twiddles[2 * at], twiddles[3 * at]
    b, c, d = a + apart, a + 2 * apart, a + 3 * apart
    ar, ai, br, bi = load(rows, a), load(rows, a + 1), load(rows, b), load(rows, b + 1)
    cr, ci, dr, di = load(rows, c), load(rows, c + 1), load(rows, d), load(rows, d + 1)
    er, ei, fr, fi = ar + cr, ai + ci, ar - cr, ai - ci
    # The difference of the other two, times -i.
    gr, gi, hr, hi = br + dr, bi + di, bi - di, dr - br
    put(out, o, er + gr, ei + gi)
    vr, vi = times(fr + hr, fi + hi, one)
    put(out, o + beside, vr, vi)
    vr, vi = times(er - gr, ei - gi, two)
    put(out, o + 2 * beside, vr, vi)
    vr, vi = times(fr - hr, fi - hi, three)
    put(out, o + 3 * beside, vr, vi)


@compiled(fast=FAST, borrows=True)
def _fours(
    rows: NDArray[np.float32],
    twiddles: NDArray[np.float32],
    left: int,
    done: int,
    out: NDArray[np.float32],
) -> None:
    """
    Do one pass of Stockham's transform, with butterflies of four rows.

    Parameters
    ----------
    rows
        (4 left done, 32).
    twiddles
        (N, 2) twiddle factors of the whole length.
    left, done
        Length that later passes transform, and length that earlier passes transformed.
    out
        As ``rows``, written.

    """
    for p in range(left):
        for q in range(done):
            a, o = 2 * (q + done * p), 2 * (q + 4 * done * p)
            _four(rows, a, 2 * left * done, twiddles, p * done, out, o, 2 * done)


@compiled(inline=True, fast=FAST, borrows=True)
def sixteen(
    rows: NDArray[np.float32],
    a: int,
    apart: int,
    twiddles: NDArray[np.float32],
    p: int,
    left: int,
    done: int,
    few: NDArray[np.float32],
    out: NDArray[np.float32],
    o: int,
) -> None:
    """Write the butterflies of two passes by fours, of sixteen equally spaced rows."""
    for k in range(4):
        at = (p + left * k) * done
        _four(rows, a + k * apart, 4 * apart, twiddles, at, few, 8 * k, 2)
    for k in range(4):
        _four(few, 2 * k, 8, twiddles, 4 * p * done, out, o + 2 * done * k, 8 * done)


@compiled(inline=True, fast=FAST, borrows=True)
def twenty(
    rows: NDArray[np.float32],
    a: int,
    apart: int,
    twiddles: NDArray[np.float32],
    p: int,
    left: int,
    done: int,
    few: NDArray[np.float32],
    out: NDArray[np.float32],
    o: int,
) -> None:
    """Write the butterflies of a pass by fours and one by fives."""
    for k in range(5):
        at = (p + left * k) * done
        _four(rows, a + k * apart, 5 * apart, twiddles, at, few, 8 * k, 2)
    for k in range(4):
        _prime(few, 2 * k, 8, twiddles, 4 * p * done, 5, out, o + 2 * done * k, 8 * done)


@compiled(fast=FAST, borrows=True)
def _sixteens(
    rows: NDArray[np.float32],
    twiddles: NDArray[np.float32],
    left: int,
    done: int,
    few: NDArray[np.float32],
    out: NDArray[np.float32],
) -> None:
    """
    Do two passes by fours at once: sixteen rows are read and written once.

    Parameters
    ----------
    rows
        (16 left done, 32).
    twiddles, left, done, out
        See :func:`_fours`; ``left`` is the length for the passes after both.
    few
        (16, 32) scratch memory.

    """
    for p in range(left):
        for q in range(done):
            a, o = 2 * (q + done * p), 2 * (q + 16 * done * p)
            sixteen(rows, a, 2 * left * done, twiddles, p, left, done, few, out, o)


@compiled(fast=FAST, borrows=True)
def _twenties(
    rows: NDArray[np.float32],
    twiddles: NDArray[np.float32],
    left: int,
    done: int,
    few: NDArray[np.float32],
    out: NDArray[np.float32],
) -> None:
    """Do a pass by fours and one by fives at once, as :func:`_sixteens` does two by fours."""
    for p in range(left):
        for q in range(done):
            a, o = 2 * (q + done * p), 2 * (q + 20 * done * p)
            twenty(rows, a, 2 * left * done, twiddles, p, left, done, few, out, o)


@compiled(fast=FAST, borrows=True)
def _nines(
    rows: NDArray[np.float32],
    twiddles: NDArray[np.float32],
    left: int,
    done: int,
    few: NDArray[np.float32],
    out: NDArray[np.float32],
) -> None:
    """Do two passes by threes at once, as :func:`_sixteens` does two by fours."""
    for p in range(left):
        for q in range(done):
            for k in range(3):
                at = p + left * k
                a = 2 * (q + done * at)
                _prime(rows, a, 6 * left * done, twiddles, at * done, 3, few, 6 * k, 2)
            for k in range(3):
                o = 2 * (q + done * (k + 9 * p))
                _prime(few, 2 * k, 6, twiddles, 3 * p * done, 3, out, o, 6 * done)


@compiled(inline=True, fast=FAST, borrows=True)
def _prime(
    rows: NDArray[np.float32],
    a: int,
    apart: int,
    twiddles: NDArray[np.float32],
    at: int,
    radix: int,
    out: NDArray[np.float32],
    o: int,
    beside: int,
) -> None:
    """Write the butterfly of a prime number of rows, as :func:`_four` does."""
    count = len(twiddles)
    for k in range(radix // 2 + 1):
        # Lines k and radix - k share sums and differences of rows.
        sr, si = load(rows, a), load(rows, a + 1)
        tr, ti = sr * 0.0, si * 0.0
        angle, b, c = 0, a, a + radix * apart
        for _ in range(radix // 2):
            angle += k * (count // radix)
            angle -= count if angle >= count else 0
            b, c, twiddle = b + apart, c - apart, twiddles[angle]
            br, bi = load(rows, b), load(rows, b + 1)
            cr, ci = load(rows, c), load(rows, c + 1)
            # With two rows the second is its own partner.
            half = twiddle[0] if b < c else np.float32(0.5) * twiddle[0]
            sr, si = sr + half * (br + cr), si + half * (bi + ci)
            tr, ti = tr - twiddle[1] * (bi - ci), ti + twiddle[1] * (br - cr)
        vr, vi = times(sr + tr, si + ti, twiddles[at * k])
        put(out, o + k * beside, vr, vi)
        if 0 < k < radix - k:
            vr, vi = times(sr - tr, si - ti, twiddles[at * (radix - k)])
            put(out, o + (radix - k) * beside, vr, vi)


@compiled(inline=True, fast=FAST, borrows=True)
def _butterflies(
    rows: NDArray[np.float32],
    twiddles: NDArray[np.float32],
    radix: int,
    left: int,
    done: int,
    out: NDArray[np.float32],
) -> None:
    """Do one pass with butterflies of a prime number of rows."""
    for p in range(left):
        for q in range(done):
            a, o = 2 * (q + done * p), 2 * (q + radix * done * p)
            _prime(rows, a, 2 * left * done, twiddles, p * done, radix, out, o, 2 * done)


@compiled(fast=FAST, borrows=True)
def _primes(
    rows: NDArray[np.float32],
    twiddles: NDArray[np.float32],
    radix: int,
    left: int,
    done: int,
    out: NDArray[np.float32],
) -> None:
    """Do one pass as :func:`_butterflies`, in half the time for radices known when compiling."""
    if radix == 2:
        _butterflies(rows, twiddles, 2, left, done, out)
    elif radix == 3:
        _butterflies(rows, twiddles, 3, left, done, out)
    elif radix == 5:
        _butterflies(rows, twiddles, 5, left, done, out)
    elif radix == 7:
        _butterflies(rows, twiddles, 7, left, done, out)
    else:
        _butterflies(rows, twiddles, radix, left, done, out)


@compiled(borrows=True)
def transform_passes(
    rows: NDArray[np.float32],
    left: int,
    twiddles: NDArray[np.float32],
    radices: NDArray[np.intp],
    few: NDArray[np.float32],
    other: NDArray[np.float32],
) -> None:
    """
    Do all passes of a transform, from one array into the other and back.

    Parameters
    ----------
    rows
        (N, 32), overwritten; it holds the result of an even number of passes.
    left
        Length that remains to transform, N before the first pass.
    twiddles, radices
        Twiddle factors of N, and radices of ``left``: see :func:`twiddles` and :func:`radices`.
    few
        (20, 32) scratch memory.
    other
        As ``rows``, written; it holds the result of an odd number of passes.

    """
    for number, radix in enumerate(radices):
        done = len(rows) // left
        left //= radix
        source, out = (rows, other) if number % 2 == 0 else (other, rows)
        if radix == 16:
            _sixteens(source, twiddles, left, done, few, out)
        elif radix == 20:
            _twenties(source, twiddles, left, done, few, out)
        elif radix == 9:
            _nines(source, twiddles, left, done, few, out)
        elif radix == 4:
            _fours(source, twiddles, left, done, out)
        else:
            _primes(source, twiddles, radix, left, done, out)


@compiled(inline=True, fast=FAST)
def put(out: NDArray[np.float32], at: int, real: Any, imag: Any) -> None:
    """Write sixteen complex numbers."""
    store(out, at, real)
    store(out, at + 1, imag)


def real_columns(lines: NDArray[np.float32], column: int, count: int) -> NDArray[np.float32]:
    """
    Return sixteen real columns from their lines, not divided by their length.

    Parameters
    ----------
    lines
        (count // 2 + 1, 2, >= column + 16) real and imaginary parts of the conjugates.
    column
        First column.
    count
        Length.

    Returns
    -------
    Shape (count, 16).

    >>> x = np.random.default_rng(0).standard_normal((42, 16)).astype(np.float32)
    >>> lines = np.conj(np.fft.rfft(x, axis=0))
    >>> parts = np.stack((lines.real, lines.imag), axis=1).astype(np.float32)
    >>> bool(np.allclose(real_columns(parts, 0, 42), 42.0 * x, atol=1e-3))
    True

    """
    rows = aligned(count // 2 if count % 2 == 0 else count, ROW)
    _join_lines(lines, column, twiddles(count), rows)
    found = transform_rows(rows)
    return found.reshape(-1, L) if count % 2 == 0 else found[:, :L]


@compiled(fast=FAST, borrows=True)
def _join_lines(
    lines: NDArray[np.float32],
    column: int,
    twiddles: NDArray[np.float32],
    rows: NDArray[np.float32],
) -> None:
    """Write rows whose transform has two real samples per complex number, or one if odd."""
    count, last = len(rows), len(lines) - 1
    if count == len(twiddles):
        for k in range(count):
            sign = np.float32(1.0 if k <= last else -1.0)
            at = k if k <= last else count - k
            real, imag = load(lines[at, 0, column:], 0), load(lines[at, 1, column:], 0)
            put(rows[k], 0, real, sign * imag if k else imag * np.float32(0.0))
        return
    for k in range(count):
        kept = np.float32(1.0 if k else 0.0)
        ar, ai = load(lines[k, 0, column:], 0), kept * load(lines[k, 1, column:], 0)
        br, bi = load(lines[last - k, 0, column:], 0), kept * load(lines[last - k, 1, column:], 0)
        dr, di = times(ar - br, ai + bi, twiddles[k])
        put(rows[k], 0, ar + br - di, ai - bi + dr)
