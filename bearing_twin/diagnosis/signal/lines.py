# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Compiled functions on lines of spectra: the row of a line, and its height over noise.

Compiled code of other files calls these functions, so `compiled` lists the name of this file.
"""

from __future__ import annotations

from typing import Any

from bearing_twin.numerics.compiled import compiled, FAST
import numpy as np
from numpy.typing import NDArray

NEUTRAL = 0.5963474
"""Mean of log(1 + E) for E ~ Exp(1): e E1(1). It is the value of bins that are left out."""


@compiled(fast=FAST)
def nearest_row(bins: float, rows: int) -> int:
    """Return the row of an order in bins; outside the ends, the first or last row."""
    return min(max(int(np.rint(bins)) - 1, 0), rows - 1)


@compiled(fast=FAST, borrows=True)
def row_height(logs: NDArray[np.float32], at: int, columns: NDArray[np.intp]) -> Any:
    """Return the mean of some columns of a row, less that of noise."""
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
    Return the mean height over noise of some harmonics of a comb; 0 if none is known.

    Parameters
    ----------
    logs
        (K, C); row k belongs to order (k + 1) step.
    hidden
        (K,) mask of unknown rows. Rows beyond the end are unknown as well.
    order, harmonics
        Fundamental order; first and last harmonic.
    step
        Orders a bin.
    columns
        (B,) columns of the mean.

    """
    total, count = 0.0, 0
    for n in range(harmonics[0], harmonics[1] + 1):
        at = nearest_row(order * n * (1.0 / step), len(logs))
        if order * n <= len(logs) * step and not hidden[at]:
            total += row_height(logs, at, columns)
            count += 1
    return total / max(count, 1)


@compiled(borrows=True)
def count_shown(hidden: NDArray[np.bool_], order: float, step: float, harmonics: int) -> int:
    """
    Return the number of harmonics of a comb whose rows are not hidden.

    Parameters
    ----------
    hidden
        (K,) mask; row k belongs to order (k + 1) step, the last row also to higher orders.
    order, step, harmonics
        Fundamental order, orders a bin, and number of harmonics.

    """
    count = 0
    for n in range(1, harmonics + 1):
        count += not hidden[nearest_row(order * n * (1.0 / step), len(hidden))]
    return count


@compiled(borrows=True)
def without_two_highest(
    logs: NDArray[np.float32],
    hertz: NDArray[np.floating],
    bin_hz: float,
    first: int,
    count: int,
    sums: NDArray[np.float64],
) -> None:
    """
    Write the sum of the lines of each comb without the two highest.

    Parameters
    ----------
    logs
        (K,); row k belongs to (k + 1) bin_hz.
    hertz
        (G,) fundamentals.
    bin_hz
        Hz a bin.
    first, count
        First harmonic, and number of harmonics, at least two.
    sums
        (G,), written.

    """
    for g in range(len(hertz)):
        total, highest_line, second = 0.0, -np.inf, -np.inf
        for number in range(first, first + count):
            lowest: float = np.float64(logs[nearest_row(hertz[g] * number / bin_hz, len(logs))])
            if lowest > highest_line:
                lowest, second, highest_line = second, highest_line, lowest
            elif lowest > second:
                lowest, second = second, lowest
            if lowest > -np.inf:
                total += lowest
        sums[g] = total
