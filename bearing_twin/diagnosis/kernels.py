# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Compiled inner loops of the diagnosis: each bin and each comb is touched once."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

from bearing_twin.diagnosis.thresholds import SLIP_COST
from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.vector import any_of, chosen, highest, L, load, root, splat, store
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


NEUTRAL = 0.5963474
"""Mean of log(1 + E) for E ~ Exp(1): e E1(1). What a bin counts for that must not speak."""


@compiled(fast=FAST, borrows=True)
def over_floor(
    power: NDArray[np.float32],
    levels: NDArray[np.float32],
    first: float,
    hop: int,
    ratio: NDArray[np.float32],
    excess: NDArray[np.float32],
) -> None:
    """
    Write one plus power over floor, and power above the floor, bin by bin.

    Parameters
    ----------
    power
        (K, B).
    levels
        (L, B) floor at the bins ``first + n hop``; it is linear between them and flat outside.
    first, hop
        See ``levels``.
    ratio
        (K, B), written.
    excess
        (K, <= B), written: of as many bands.

    """
    count, bands = power.shape
    parts, wanted = len(levels), excess.shape[1]
    zero, one = np.float32(0.0), np.float32(1.0)
    for part in range(parts + 1):
        # From each level to the next; before the first and after the last it is flat.
        begin = 0 if part == 0 else min(max(int(np.ceil(first + (part - 1) * hop)), 0), count)
        end = count if part == parts else min(int(np.ceil(first + part * hop)), count)
        low, high = levels[max(part - 1, 0)], levels[min(part, parts - 1)]
        for k in range(begin, end):
            way = np.float32((k - (first + (part - 1) * hop)) / hop)
            values, over, above = power[k], ratio[k], excess[k]
            for band in range(bands):
                over[band] = one + values[band] / (low[band] + way * (high[band] - low[band]))
            for band in range(wanted):
                left = values[band] - (low[band] + way * (high[band] - low[band]))
                above[band] = left if left > zero else zero


@compiled(fast=FAST, borrows=True)
def join_quarters(
    quarters: NDArray[np.complex64], turns: NDArray[np.complex64], joined: NDArray[np.complex64]
) -> None:
    """
    Write the one-sided transform of a record from those of every fourth of its samples.

    Parameters
    ----------
    quarters
        (M // 2 + 1, 4) one-sided transforms of M samples each.
    turns
        (M // 2 + 1,) turn by which the second quarter is behind the first.
    joined
        (2 M + 1,), written.

    """
    each, last = len(joined) // 2, len(joined) - 1
    for k in range(len(turns)):
        one, turn = quarters[k, 0], turns[k]
        two, three = turn * quarters[k, 1], turn * turn * quarters[k, 2]
        four = turn * turn * turn * quarters[k, 3]
        even, odd = one + three, two + four
        away, across = one - three, two - four
        # Times i.
        across = np.complex64(complex(-across.imag, across.real))
        joined[k] = even + odd
        joined[each + k] = away - across
        joined[each - k] = np.conj(away + across)
        joined[last - k] = np.conj(even - odd)


@compiled(fast=FAST - {'nnan', 'ninf'}, borrows=True)
def moments(x: NDArray[np.float64], mean: float) -> tuple[float, float, float]:
    """
    Return the sums of the second, third and fourth power of the deviation from a mean.

    Parameters
    ----------
    x
        (n,).
    mean
        In the unit of x.

    """
    second = third = fourth = 0.0
    # By index: the compiler makes no vectors of an iterator.
    for n in range(len(x)):
        away = x[n] - mean
        square = away * away
        second += square
        third += square * away
        fourth += square * square
    return second, third, fourth


@compiled(borrows=True)
def mark_near(
    orders: NDArray[np.float64], half_width: float, step: float, mask: NDArray[np.bool_]
) -> None:
    """
    Mark the rows within ``half_width`` orders of any of some orders.

    Parameters
    ----------
    orders
        (N,).
    half_width, step
        Orders; row k belongs to order (k + 1) step.
    mask
        (K,), written where it is so.

    """
    count = len(mask)
    for order in orders:
        first = np.ceil((order - half_width) / step) - 1.0
        last = np.floor((order + half_width) / step)
        for k in range(int(min(max(first, 0.0), count)), int(min(last, count))):
            mask[k] = True


@compiled(borrows=True)
def tiles_beside(
    spectrum: NDArray[np.complex64], tile: int, groups: int, group: int, rows: NDArray[np.float32]
) -> None:
    """
    Put tiles of a spectrum side by side, zeros below: every so many tiles, from one on.

    Parameters
    ----------
    spectrum
        (>= 16 groups tile,).
    tile
        Bins.
    groups, group
        Tiles from one to the next, and the first.
    rows
        (2 tile, 32), written.

    """
    for n in range(tile):
        for k in range(L):
            value = spectrum[(k * groups + group) * tile + n]
            rows[n, k], rows[n, L + k] = value.real, value.imag
    rows[tile:] = np.float32(0.0)


@compiled(fast=FAST, borrows=True)
def tile_powers(
    one: NDArray[np.float32], other: NDArray[np.float32], out: NDArray[np.float32]
) -> None:
    """Write squared magnitudes: of one (N, 32) as real, of the other as imaginary parts."""
    for n in range(len(out)):
        ar, ai, br, bi = load(one[n], 0), load(one[n], 1), load(other[n], 0), load(other[n], 1)
        store(out[n], 0, ar * ar + ai * ai)
        store(out[n], 1, br * br + bi * bi)


@compiled(fast=FAST, borrows=True)
def tile_products(
    one: NDArray[np.float32], other: NDArray[np.float32], shift: int, out: NDArray[np.float32]
) -> None:
    """
    Write the products of tiles with the conjugates of those some columns further on.

    Parameters
    ----------
    one, other
        (N, 32); behind the other there are ``shift`` finite numbers.
    shift
        Columns; as many products at the end mean nothing, but are finite.
    out
        (N, 32), written.

    """
    flat = other.reshape(-1)
    for n in range(len(out)):
        at = 2 * L * n + shift
        ar, ai = load(one[n], 0), load(one[n], 1)
        br, bi = load(flat[at:], 0), load(flat[at + L :], 0)
        store(out[n], 0, ar * br + ai * bi)
        store(out[n], 1, ai * br - ar * bi)


@compiled(fast=FAST, borrows=True)
def add_lags(
    products: NDArray[np.float32],
    whitening: int,
    apart: int,
    members: NDArray[np.float32],
    first: int,
    values: NDArray[np.float32],
    lags: NDArray[np.float32],
) -> None:
    """
    Add to the autocorrelation of each band, conjugated, the products of its tiles.

    Parameters
    ----------
    products
        (2 tile, 32) transforms: of the squared magnitudes of two whitenings, or of the products
        of tiles so far apart.
    whitening, apart
        See ``products``.
    members
        (16, 16 n) one where a product of tiles belongs to a band, else zero.
    first
        Column of the first band.
    values
        (32,) to work in.
    lags
        (K, 2, >= first + 16 n) real and imaginary parts, added to.

    """
    length = len(products)
    tile, count = length // 2, len(lags)
    scale = np.float32(1.0) / np.float32(length)
    for lag in range(max((apart - 1) * tile + 1, 0), min((apart + 1) * tile, count)):
        at = lag - apart * tile if lag >= apart * tile else lag - apart * tile + length
        row = products[at]
        real, imag = scale * load(row, 0), scale * load(row, 1)
        if apart == 0:
            other = products[length - at if at else 0]
            mirror_real, mirror_imag = scale * load(other, 0), scale * load(other, 1)
            if whitening == 0:
                real, imag = 0.5 * (real + mirror_real), 0.5 * (imag - mirror_imag)
            else:
                real, imag = 0.5 * (imag + mirror_imag), 0.5 * (mirror_real - real)
        store(values, 0, real)
        store(values, 1, imag)
        for column in range(0, members.shape[1], L):
            out = lags[lag, 0, first + column :], lags[lag, 1, first + column :]
            sums_real, sums_imag = load(out[0], 0), load(out[1], 0)
            for k in range(L):
                belongs = load(members[k, column:], 0)
                sums_real = sums_real + belongs * values[k]
                sums_imag = sums_imag + belongs * values[L + k]
            store(out[0], 0, sums_real)
            store(out[1], 0, sums_imag)


@compiled(fast=FAST)
def _nearest_row(bins: float, rows: int) -> int:
    """Return the row of an order in bins; those beyond the ends are the first and the last."""
    return min(max(int(np.rint(bins)) - 1, 0), rows - 1)


@compiled(fast=FAST, borrows=True)
def _add_harmonics(
    logs: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    order: float,
    step: float,
    harmonics: int,
    out: NDArray[np.float32],
) -> None:
    """Write the sum of the logs over the harmonics of one comb."""
    rows, columns = logs.shape
    neutral = np.float32(NEUTRAL)
    out[:] = np.float32(0.0)
    for harmonic in range(1, harmonics + 1):
        at = _nearest_row(harmonic * order / step, rows)
        row = logs[at]
        if hidden[at]:
            for c in range(columns):
                out[c] += neutral
        else:
            for c in range(columns):
                out[c] += row[c]


@compiled(fast=FAST, borrows=True)
def comb_sums(
    logs: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    orders: NDArray[np.float64],
    step: float,
    harmonics: int,
    sums: NDArray[np.float32],
) -> None:
    """
    Write the sum of the logs over the harmonics of each comb.

    Parameters
    ----------
    logs
        (K, C); row k belongs to order (k + 1) step.
    hidden
        (K,) mask of the rows that say nothing.
    orders
        (G,) fundamental orders.
    step
        Orders a bin.
    harmonics
        Harmonics of a comb.
    sums
        (G, C), written.

    """
    for g in range(len(orders)):
        _add_harmonics(logs, hidden, orders[g], step, harmonics, sums[g])


@compiled(inline=True, fast=FAST)
def _beside(value: Any, guess: Any, below: Any, before: Any, after: Any) -> Any:
    """Count what is below a guess; keep the greatest of it, and the least of what is not."""
    less = guess > value
    return (
        chosen(less, below + 1.0, below),
        chosen(less, chosen(value > before, value, before), before),
        chosen(less, after, chosen(after > value, value, after)),
    )


@compiled(inline=True, fast=FAST)
def _first_guess(low: Any, high: Any, mean: Any, square: Any, away: float) -> Any:
    """Return a value so many standard deviations over the mean, between the least and greatest."""
    away_squared = square - mean * mean
    guess = mean + away * root(chosen(away_squared > 0.0 * mean, away_squared, 0.0 * mean))
    guess = chosen(guess > low, guess, high)
    return chosen(guess > high, high, guess)


@compiled(inline=True, fast=FAST)
def _narrowed(bounds: Any, rank: int, below: Any, before: Any, after: Any) -> Any:
    """Return closer bounds of the value of a rank, their counts, and the next guess."""
    low, high, under, until = bounds
    less = below > np.float32(rank)
    # What is right after the guess is the wanted value, or what is right before it.
    high = chosen(less, before, chosen(below == np.float32(rank), after, high))
    low = chosen(less, chosen(below == np.float32(rank + 1), before, low), after)
    under, until = chosen(less, under, below), chosen(less, below, until)
    guess = low + (np.float32(rank + 0.5) - under) / (until - under) * (high - low)
    guess = chosen(guess > low, guess, high)
    return (low, high, under, until), chosen(guess > high, high, guess)


@compiled(fast=FAST, borrows=True)
def column_ranks(
    values: NDArray[np.float32],
    first: int,
    step: int,
    count: int,
    rank: int,
    away: float,
    found: NDArray[np.float32],
) -> None:
    """
    Write the value of a rank in each column: 0 for the least, half of the count for the median.

    Each pass counts what is below a guess, which is interpolated between the two values, closer
    each time, between which the wanted one lies. Two times sixteen columns go together, as one
    alone would wait for its own last comparison.

    Parameters
    ----------
    values
        (N, >= 16).
    first, step, count
        Rows that count: every so many from one on, and their number.
    rank
        Below the count.
    away
        Standard deviations over the mean of the first guess.
    found
        (C,), written.

    """
    last, each = len(found) - L, np.float32(1.0 / count)
    zero = splat(np.float32(0.0))
    for column in range(0, len(found), 2 * L):
        # The last sixteen lap over those before them.
        c, d = min(column, last), min(column + L, last)
        low_c = high_c = load(values[first, c:], 0)
        low_d = high_d = load(values[first, d:], 0)
        sum_c = sum_d = square_c = square_d = zero
        for n in range(count):
            row = values[first + n * step]
            value, other = load(row[c:], 0), load(row[d:], 0)
            low_c, high_c = (
                chosen(low_c > value, value, low_c),
                chosen(value > high_c, value, high_c),
            )
            low_d, high_d = (
                chosen(low_d > other, other, low_d),
                chosen(other > high_d, other, high_d),
            )
            sum_c, square_c = sum_c + value, square_c + value * value
            sum_d, square_d = sum_d + other, square_d + other * other
        bounds_c = low_c, high_c, zero, zero + np.float32(count)
        bounds_d = low_d, high_d, zero, zero + np.float32(count)
        guess_c = _first_guess(low_c, high_c, each * sum_c, each * square_c, away)
        guess_d = _first_guess(low_d, high_d, each * sum_d, each * square_d, away)
        while any_of(bounds_c[1] > bounds_c[0]) or any_of(bounds_d[1] > bounds_d[0]):
            below_c, before_c, after_c = zero, bounds_c[0], bounds_c[1]
            below_d, before_d, after_d = zero, bounds_d[0], bounds_d[1]
            for n in range(count):
                row = values[first + n * step]
                value, other = load(row[c:], 0), load(row[d:], 0)
                below_c, before_c, after_c = _beside(value, guess_c, below_c, before_c, after_c)
                below_d, before_d, after_d = _beside(other, guess_d, below_d, before_d, after_d)
            bounds_c, guess_c = _narrowed(bounds_c, rank, below_c, before_c, after_c)
            bounds_d, guess_d = _narrowed(bounds_d, rank, below_d, before_d, after_d)
        store(found[c:], 0, bounds_c[0])
        store(found[d:], 0, bounds_d[0])


@compiled(fast=FAST, borrows=True)
def comb_bands(
    logs: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    order: float,
    step: float,
    harmonics: int,
    center: NDArray[np.float32],
    inverse: NDArray[np.float32],
    scores: NDArray[np.float32],
    highest_columns: NDArray[np.intp],
) -> None:
    """
    Write the standardised sum over the harmonics of one comb, and where it is highest.

    Parameters
    ----------
    logs, hidden, step, harmonics
        See :func:`comb_sums`; columns are bands, whitening by whitening.
    order
        Fundamental order.
    center, inverse
        (C,) median, and one over the spread, of each column.
    scores
        (C,), written.
    highest_columns
        (W,), written: the column of the highest score of each whitening.

    """
    _add_harmonics(logs, hidden, order, step, harmonics, scores)
    for c in range(len(scores)):
        scores[c] = (scores[c] - center[c]) * inverse[c]
    bands = len(scores) // len(highest_columns)
    for whitening in range(len(highest_columns)):
        best = whitening * bands
        for c in range(best + 1, (whitening + 1) * bands):
            if scores[c] > scores[best]:
                best = c
        highest_columns[whitening] = best


@compiled(inline=True, fast=FAST, borrows=True)
def _sixteen(one: Any, two: Any, three: Any, four: Any, center: Any, inverse: Any, at: int) -> Any:
    """Standardised sums over four rows in the sixteen columns from ``at`` on."""
    total = load(one[at:], 0) + load(two[at:], 0) + load(three[at:], 0) + load(four[at:], 0)
    return (total - load(center[at:], 0)) * load(inverse[at:], 0)


@compiled(fast=FAST, borrows=True)
def best_bands(
    logs: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    orders: NDArray[np.float64],
    step: float,
    center: NDArray[np.float32],
    inverse: NDArray[np.float32],
    whitenings: int,
    silent: NDArray[np.float32],
    best: NDArray[np.float64],
) -> None:
    """
    Write the mean over whitenings of each comb's best standardised band; combs have 4 harmonics.

    Parameters
    ----------
    logs, hidden, orders, step
        See :func:`comb_sums`; columns are bands, whitening by whitening.
    center, inverse
        (C,) median, and one over the spread, of each column.
    whitenings
        Number of whitenings.
    silent
        (C,) to work in.
    best
        (G,), written.

    """
    rows, bands = logs.shape[0], logs.shape[1] // whitenings
    silent[:] = np.float32(NEUTRAL)
    for g in range(len(orders)):
        order = orders[g] / step
        at1, at2 = _nearest_row(order, rows), _nearest_row(2.0 * order, rows)
        at3, at4 = _nearest_row(3.0 * order, rows), _nearest_row(4.0 * order, rows)
        row1 = silent if hidden[at1] else logs[at1]
        row2 = silent if hidden[at2] else logs[at2]
        row3 = silent if hidden[at3] else logs[at3]
        row4 = silent if hidden[at4] else logs[at4]
        total = np.float32(0.0)
        for first in range(0, whitenings * bands, bands):
            end = first + bands
            if bands < L:
                few = np.float32(-np.inf)
                for c in range(first, end):
                    score = row1[c] + row2[c] + row3[c] + row4[c] - center[c]
                    few = max(few, score * inverse[c])
                total += few
                continue
            # The last sixteen lap over those before them, which changes no maximum.
            high = _sixteen(row1, row2, row3, row4, center, inverse, end - L)
            for c in range(first, end - L, L):
                others = _sixteen(row1, row2, row3, row4, center, inverse, c)
                high = chosen(others > high, others, high)
            total += highest(high)
        best[g] = total / whitenings


@compiled(borrows=True)
def likeliest(
    z: NDArray[np.float64], orders: NDArray[np.float64], order: float, slack: float, slope: float
) -> tuple[float, float, float]:
    """
    Return order, slip and score of the best comb when its slip has cost it some of the score.

    Parameters
    ----------
    z, orders
        (G,) scores and fundamental orders.
    order, slope
        Order of the place without slip, and its change by a slip of 1.
    slack
        What the uncertainty of the speed may explain is no slip and costs nothing.

    """
    found, slip, best = orders[0], 0.0, -np.inf
    for g in range(len(orders)):
        away = orders[g] - order
        slid = max(abs(away) - slack, 0.0) * np.sign(away) / slope
        score = z[g] - (slid / SLIP_COST) ** 2
        if score > best:
            found, slip, best = orders[g], slid, score
    return found, slip, best


@compiled(borrows=True)
def highest_off(
    z: NDArray[np.float64],
    orders: NDArray[np.float64],
    uncertainty: float,
    width: float,
    low: float,
    high: float,
) -> int:
    """
    Return the place of the highest of some combs off the multiples of the shaft and off a range.

    Parameters
    ----------
    z, orders
        (G,) scores and fundamental orders.
    uncertainty, width
        Relative uncertainty of the orders, and the width of a line, orders.
    low, high
        The range, orders.

    """
    found, best = 0, -np.inf
    for g in range(len(orders)):
        order = orders[g]
        slack = uncertainty * order + width
        beside = order < low - slack or order > high + slack
        if z[g] > best and beside and abs(order - max(np.rint(order), 1.0)) > slack:
            found, best = g, z[g]
    return found


@compiled(borrows=True)
def without_highest(
    logs: NDArray[np.float32],
    hertz: NDArray[np.floating],
    bin_hz: float,
    first: int,
    count: int,
    sums: NDArray[np.float64],
) -> None:
    """
    Write the sum of the lines of each comb but for the two highest.

    Parameters
    ----------
    logs
        (K,); row k belongs to (k + 1) bin_hz.
    hertz
        (G,) fundamentals.
    bin_hz
        Hz a bin.
    first, count
        First harmonic that counts, and the number of harmonics, at least two.
    sums
        (G,), written.

    """
    for g in range(len(hertz)):
        total, highest_line, second = 0.0, -np.inf, -np.inf
        for number in range(first, first + count):
            lowest = np.float64(logs[_nearest_row(hertz[g] * number / bin_hz, len(logs))])
            if lowest > highest_line:
                lowest, second, highest_line = second, highest_line, lowest
            elif lowest > second:
                lowest, second = second, lowest
            if lowest > -np.inf:
                total += lowest
        sums[g] = total


@compiled(fast=FAST, borrows=True)
def _height(logs: NDArray[np.float32], at: int, columns: NDArray[np.intp]) -> Any:
    """Return the mean of some columns of a row, noise taken off."""
    total = np.float32(0.0)
    for c in columns:
        total += logs[at, c]
    return total / np.float32(len(columns)) - np.float32(NEUTRAL)


@compiled(fast=FAST, borrows=True)
def mean_height(
    logs: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    order: float,
    step: float,
    harmonics: tuple[int, int],
    columns: NDArray[np.intp],
) -> float:
    """
    Return the mean height over noise of some harmonics of a comb; 0 where none is known.

    Parameters
    ----------
    logs, hidden, step, columns
        See :func:`comb_sums` and :func:`line_heights`.
    order, harmonics
        Fundamental order; first and last harmonic. Those beyond the end are unknown.

    """
    total, count = 0.0, 0
    for n in range(harmonics[0], harmonics[1] + 1):
        at = _nearest_row(order * n * (1.0 / step), len(logs))
        if order * n <= len(logs) * step and not hidden[at]:
            total += _height(logs, at, columns)
            count += 1
    return total / max(count, 1)


@compiled(fast=FAST - {'ninf'}, borrows=True)
def unshared_heights(
    logs: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    order: float,
    step: float,
    columns: NDArray[np.intp],
    ratios: NDArray[np.float64],
) -> None:
    """
    Write the height of the harmonics that the series of each multiple lacks, over the others'.

    Parameters
    ----------
    logs, hidden, step, columns
        See :func:`comb_sums` and :func:`line_heights`.
    order
        Fundamental order of the comb; it has as many harmonics as there are multiples.
    ratios
        (M,), written: for the multiple m in place m - 1. Infinite where nothing is shared.

    """
    for multiple in range(1, len(ratios) + 1):
        shared = lacking = 0.0
        on = off = 0
        for n in range(1, len(ratios) + 1):
            at = _nearest_row(order * n * (1.0 / step), len(logs))
            if hidden[at]:
                continue
            height = _height(logs, at, columns)
            if n % multiple == 0:
                shared, on = shared + height, on + 1
            else:
                lacking, off = lacking + height, off + 1
        known = on > 0 and off > 0 and shared > 0.0
        ratios[multiple - 1] = lacking / off / (shared / on) if known else np.inf


@compiled(fast=FAST, borrows=True)
def line_heights(
    logs: NDArray[np.float32],
    orders: NDArray[np.float64],
    step: float,
    columns: NDArray[np.intp],
    heights: NDArray[np.float64],
) -> None:
    """
    Write the mean over some columns of the row nearest to each order, noise taken off.

    Parameters
    ----------
    logs, step
        See :func:`comb_sums`.
    orders
        (N,).
    columns
        (B,).
    heights
        (N,), written.

    """
    for n in range(len(orders)):
        heights[n] = _height(logs, _nearest_row(orders[n] * (1.0 / step), len(logs)), columns)


@compiled(fast=FAST, borrows=True)
def three_bins(
    excess: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    orders: NDArray[np.float64],
    step: float,
    first: int,
    power: NDArray[np.float32],
) -> None:
    """
    Add up each line's row and the two beside it: a line spreads over three bins.

    Parameters
    ----------
    excess
        (K, C).
    hidden
        (K,) mask of the rows that say nothing.
    orders
        (N,) of the lines.
    step
        Orders a bin.
    first
        First column wanted.
    power
        (N, B) sums over as many columns, added to.

    """
    lines, columns = power.shape
    last = len(excess) - 1
    for n in range(lines):
        out = power[n]
        middle = _nearest_row(orders[n] * (1.0 / step), len(excess))
        for beside in range(-1, 2):
            at = min(max(middle + beside, 0), last)
            if hidden[at]:
                continue
            row = excess[at, first : first + columns]
            for c in range(columns):
                out[c] += row[c]


@compiled(fast=FAST, borrows=True)
def _line_of_band(
    excess: NDArray[np.float32], hidden: NDArray[np.bool_], bins: float, band: int
) -> Any:
    """Return the power of a line in one band: its row and the two beside it."""
    last, total = len(excess) - 1, np.float32(0.0)
    middle = _nearest_row(bins, len(excess))
    for beside in range(-1, 2):
        at = min(max(middle + beside, 0), last)
        if not hidden[at]:
            total += excess[at, band]
    return total


@compiled(fast=FAST, borrows=True)
def sideband_ratios(
    excess: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    order: float,
    step: float,
    harmonics: int,
    band: int,
    gaps: NDArray[np.float64],
    ratios: NDArray[np.float32],
) -> None:
    """
    Write the amplitude of the lines one and two gaps beside the harmonics of a comb, over theirs.

    Parameters
    ----------
    excess, hidden, step
        See :func:`three_bins`.
    order, harmonics, band
        Fundamental of the comb, number of its harmonics, and the column.
    gaps
        (G,) orders.
    ratios
        (G,), written.

    """
    inverse, own = 1.0 / step, np.float32(0.0)
    for harmonic in range(1, harmonics + 1):
        own += _line_of_band(excess, hidden, harmonic * order * inverse, band)
    own = max(own, np.float32(1e-30))
    for g in range(len(gaps)):
        total = np.float32(0.0)
        for harmonic in range(1, harmonics + 1):
            for side in range(1, 3):
                away = side * gaps[g]
                line = harmonic * order
                total += _line_of_band(excess, hidden, (line - away) * inverse, band)
                total += _line_of_band(excess, hidden, (line + away) * inverse, band)
        ratios[g] = np.sqrt(np.float32(0.25) * total / own)


@compiled(fast=FAST, borrows=True)
def strongest_band(
    excess: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    order: float,
    step: float,
    harmonics: int,
    scores: NDArray[np.float32],
    carrier: NDArray[np.float32],
    lowest: float,
    power: NDArray[np.float32],
) -> int:
    """
    Return the band in which a comb has most power, of those that show it.

    Parameters
    ----------
    excess, hidden, order, step, harmonics
        See :func:`sideband_ratios`.
    scores
        (C,) of the comb; it shows from 3 on, and in the band of the highest score.
    carrier, lowest
        (C,) lower edge of each band, and the one below which a band has no power, orders.
    power
        (C,) of the comb's lines, added to.

    """
    last = len(excess) - 1
    for harmonic in range(1, harmonics + 1):
        middle = _nearest_row(harmonic * order * (1.0 / step), len(excess))
        for beside in range(-1, 2):
            at = min(max(middle + beside, 0), last)
            if not hidden[at]:
                for c in range(len(power)):
                    power[c] += excess[at, c]
    highest_score, best = scores[0], -1
    for score in scores:
        highest_score = max(highest_score, score)
    least = min(highest_score, np.float32(3.0))
    for c in range(len(power)):
        if carrier[c] < lowest:
            power[c] = np.float32(0.0)
        if scores[c] >= least and (best < 0 or power[c] > power[best]):
            best = c
    return best


@compiled(fast=FAST, borrows=True)
def denser_part(
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
    Return the part of an order whose series has lines between the harmonics of a comb, 0 if none.

    Of all parts it is the one whose lines are farthest from chance.

    Parameters
    ----------
    logs, step, columns
        See :func:`line_heights`.
    order, harmonics
        Fundamental of the comb, and number of its harmonics.
    hidden, mine, sidebands
        (K,) rows that do not count, or only where all lines of the series are as high.
    most
        Largest part.
    leasts
        Least mean height of the lines without the sidebands, and with them.
    fewest, surest
        Fewest lines, and the least product of their mean height and the root of their number.
    slack
        Relative distance from the shaft within which a series is not looked for.

    """
    inverse, best, found = 1.0 / step, 0.0, 0
    for part in range(2, most + 1):
        few = all_lines = 0
        low = height_sum = 0.0
        for n in range(1, harmonics * part + 1):
            at = _nearest_row(order * (n / part) * inverse, len(logs))
            if n % part == 0 or hidden[at] or mine[at]:
                continue
            height = np.float64(_height(logs, at, columns))
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
