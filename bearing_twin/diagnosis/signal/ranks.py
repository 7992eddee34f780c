# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Compiled order statistics, such as the median, of many columns at once."""

from __future__ import annotations

from typing import Any

from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.vector import any_of, chosen, L, load, root, splat, store
import numpy as np
from numpy.typing import NDArray

_COUNTED = 5
"""Number of first passes that only count. Later ones also find the neighbours of the guess, which
end the search where few values are left between the bounds."""


@compiled(inline=True, fast=FAST)
def _counted(value: Any, guess: Any, below: Any) -> Any:
    """Count values below a guess."""
    return chosen(guess > value, below + 1.0, below)


@compiled(inline=True, fast=FAST)
def _beside(value: Any, guess: Any, below: Any, before: Any, after: Any) -> Any:
    """Count values below a guess; keep the greatest of them, and the least of the others."""
    less = guess > value
    return (
        chosen(less, below + 1.0, below),
        chosen(less, chosen(value > before, value, before), before),
        chosen(less, after, chosen(after > value, value, after)),
    )


@compiled(inline=True, fast=FAST)
def _first_guess(low: Any, high: Any, mean: Any, square: Any, away: float) -> Any:
    """Return a value ``away`` standard deviations over the mean, limited to the range."""
    away_squared = square - mean * mean
    guess = mean + away * root(chosen(away_squared > 0.0 * mean, away_squared, 0.0 * mean))
    guess = chosen(guess > low, guess, high)
    return chosen(guess > high, high, guess)


@compiled(inline=True, fast=FAST)
def _narrowed(bounds: Any, rank: int, below: Any, before: Any, after: Any) -> Any:
    """Return closer bounds of the value of a rank with their counts, and the next guess."""
    low, high, under, until = bounds
    less = below > np.float32(rank)
    high, low = chosen(less, before, high), chosen(less, low, after)
    under, until = chosen(less, under, below), chosen(less, below, until)
    guess = low + (np.float32(rank + 0.5) - under) / (until - under) * (high - low)
    guess = chosen(guess > low, guess, high)
    return (low, high, under, until), chosen(guess > high, high, guess)


@compiled(inline=True, fast=FAST)
def _found(bounds: Any, rank: int, below: Any, before: Any, after: Any) -> Any:
    """Return bounds that both are the wanted value where it is a neighbour of the guess."""
    low, high, under, until = bounds
    # If the counts match, the next value above or below the guess is the wanted one.
    low = chosen(below == np.float32(rank + 1), before, low)
    return low, chosen(below == np.float32(rank), after, high), under, until


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
    Write the value of a rank in each column: 0 for the least, half the count for the median.

    Several blocks of rows follow one another, and each has its own values.

    Each pass counts the values below a guess. The guess is interpolated between two bounds of the
    wanted value, which get closer with each pass. Two times sixteen columns are processed
    together: sixteen alone would wait for their last comparison.

    Parameters
    ----------
    values
        (N, >= 16).
    first, step, count
        First row, step from row to row, and number of rows in a block.
    rank
        Rank, below ``count``.
    away
        Distance of the first guess from the mean, standard deviations.
    found
        (blocks, C), written.

    """
    for block in range(len(found)):
        _block_ranks(values, first + block * count * step, step, count, rank, away, found[block])


@compiled(fast=FAST, borrows=True)
def _block_ranks(
    values: NDArray[np.float32],
    first: int,
    step: int,
    count: int,
    rank: int,
    away: float,
    found: NDArray[np.float32],
) -> None:
    """Write the value of a rank in each column of one block, (C,)."""
    last, each = len(found) - L, np.float32(1.0 / count)
    zero = splat(np.float32(0.0))
    for column in range(0, len(found), 2 * L):
        # The last sixteen overlap those before them.
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
        for _ in range(_COUNTED):
            below_c = below_d = zero
            for n in range(count):
                row = values[first + n * step]
                below_c = _counted(load(row[c:], 0), guess_c, below_c)
                below_d = _counted(load(row[d:], 0), guess_d, below_d)
            bounds_c, guess_c = _narrowed(bounds_c, rank, below_c, guess_c, guess_c)
            bounds_d, guess_d = _narrowed(bounds_d, rank, below_d, guess_d, guess_d)
        while any_of(bounds_c[1] > bounds_c[0]) or any_of(bounds_d[1] > bounds_d[0]):
            below_c, before_c, after_c = zero, bounds_c[0], bounds_c[1]
            below_d, before_d, after_d = zero, bounds_d[0], bounds_d[1]
            for n in range(count):
                row = values[first + n * step]
                value, other = load(row[c:], 0), load(row[d:], 0)
                below_c, before_c, after_c = _beside(value, guess_c, below_c, before_c, after_c)
                below_d, before_d, after_d = _beside(other, guess_d, below_d, before_d, after_d)
            bounds_c = _found(bounds_c, rank, below_c, before_c, after_c)
            bounds_d = _found(bounds_d, rank, below_d, before_d, after_d)
            bounds_c, guess_c = _narrowed(bounds_c, rank, below_c, before_c, after_c)
            bounds_d, guess_d = _narrowed(bounds_d, rank, below_d, before_d, after_d)
        store(found[c:], 0, bounds_c[0])
        store(found[d:], 0, bounds_d[0])
