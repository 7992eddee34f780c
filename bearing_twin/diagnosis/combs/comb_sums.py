# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Compiled sums over the harmonics of many combs, and the search for the best comb."""

from __future__ import annotations

from typing import Any

from bearing_twin.diagnosis.signal.lines import nearest_row, NEUTRAL
from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.vector import chosen, highest, L, load
import numpy as np
from numpy.typing import NDArray


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
        at = nearest_row(harmonic * order / step, rows)
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
        (K,) mask of the rows that are left out.
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
    Write the standardised sum over the harmonics of one comb, and its highest columns.

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
    """Return the standardised sums over four rows in the sixteen columns from ``at`` on."""
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
    best_center: float,
    best_spread: float,
    work: NDArray[np.float32],
    best: NDArray[np.float64],
) -> None:
    """
    Write the standardised mean over whitenings of each comb's best standardised band.

    Combs have four harmonics.

    Parameters
    ----------
    logs, hidden, orders, step
        See :func:`comb_sums`; columns are bands, whitening by whitening.
    center, inverse
        (C,) median, and one over the spread, of each column.
    whitenings
        Number of whitenings.
    best_center, best_spread
        Median and spread of the mean.
    work
        (C + 16 W,), scratch memory.
    best
        (G,), written.

    """
    rows, columns = logs.shape
    bands, silent = columns // whitenings, work[:columns]
    silent[:] = np.float32(NEUTRAL)
    # A whitening with fewer than sixteen bands is taken with columns of others, which are masked.
    others = work[columns:]
    for whitening in range(whitenings):
        at = min(whitening * bands, columns - L)
        for c in range(L):
            own = whitening * bands <= at + c < (whitening + 1) * bands
            others[whitening * L + c] = np.float32(0.0 if own else 1e30)
    for g in range(len(orders)):
        order = orders[g] / step
        at1, at2 = nearest_row(order, rows), nearest_row(2.0 * order, rows)
        at3, at4 = nearest_row(3.0 * order, rows), nearest_row(4.0 * order, rows)
        row1 = silent if hidden[at1] else logs[at1]
        row2 = silent if hidden[at2] else logs[at2]
        row3 = silent if hidden[at3] else logs[at3]
        row4 = silent if hidden[at4] else logs[at4]
        total = np.float32(0.0)
        for whitening in range(whitenings):
            first, end = whitening * bands, (whitening + 1) * bands
            if columns < L:
                few = np.float32(-np.inf)
                for c in range(first, end):
                    score = row1[c] + row2[c] + row3[c] + row4[c] - center[c]
                    few = max(few, score * inverse[c])
                total += few
                continue
            if bands < L:
                at = min(first, columns - L)
                high = _sixteen(row1, row2, row3, row4, center, inverse, at)
                total += highest(high - load(others, whitening))
                continue
            # The last sixteen overlap those before them, which changes no maximum.
            high = _sixteen(row1, row2, row3, row4, center, inverse, end - L)
            for c in range(first, end - L, L):
                more = _sixteen(row1, row2, row3, row4, center, inverse, c)
                high = chosen(more > high, more, high)
            total += highest(high)
        best[g] = (total / whitenings - best_center) / best_spread


@compiled(borrows=True)
def best_with_slip_cost(
    z: NDArray[np.float64],
    orders: NDArray[np.float64],
    order: float,
    slack: float,
    slope: float,
    cost: float,
) -> tuple[float, float, float]:
    """
    Return order, slip and score of the best comb, with the cost of its slip taken off the score.

    Parameters
    ----------
    z, orders
        (G,) scores and fundamental orders.
    order, slope
        Order of the place without slip, and the change of the order with a slip of 1.
    slack
        Difference of orders that the uncertainty of the speed explains: it counts as no slip.
    cost
        Slip that costs one standard deviation.

    """
    found, slip, best = orders[0], 0.0, -np.inf
    for g in range(len(orders)):
        away = orders[g] - order
        slid = max(abs(away) - slack, 0.0) * np.sign(away) / slope
        score = z[g] - (slid / cost) ** 2
        if score > best:
            found, slip, best = orders[g], slid, score
    return found, slip, best


@compiled(borrows=True)
def highest_elsewhere(
    z: NDArray[np.float64],
    orders: NDArray[np.float64],
    uncertainty: float,
    width: float,
    low: float,
    high: float,
) -> int:
    """
    Return the index of the highest comb off the multiples of the shaft and outside a range.

    Parameters
    ----------
    z, orders
        (G,) scores and fundamental orders.
    uncertainty, width
        Relative uncertainty of the orders, and the width of a line, orders.
    low, high
        Ends of the range, orders.

    """
    found, best = 0, -np.inf
    for g in range(len(orders)):
        order = orders[g]
        slack = uncertainty * order + width
        beside = order < low - slack or order > high + slack
        if z[g] > best and beside and abs(order - max(np.rint(order), 1.0)) > slack:
            found, best = g, z[g]
    return found
