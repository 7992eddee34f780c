# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Compiled inner loops of the diagnosis: each bin and each comb is touched once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.dynamics.compiled import compiled, FAST
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


NEUTRAL = 0.5963474
"""Mean of log(1 + E) for E ~ Exp(1): e E1(1). What a bin counts for that must not speak."""


@compiled(fast=FAST, borrows=True)
def line_power(lines: NDArray[np.complex64], power: NDArray[np.float32]) -> None:
    """
    Write the power of the lines under a Hann window relative to that of the mean.

    In the frequency domain the window takes half of both neighbours from each line.

    Parameters
    ----------
    lines
        (B, > K + 1) transforms of squared envelopes.
    power
        (B, K), written: line k + 1.

    """
    for band in range(len(power)):
        row, out = lines[band], power[band]
        mean = max(row[0].real, np.float32(1e-30))
        scale = np.float32(1.0) / mean
        half = np.float32(0.5)
        for k in range(len(out)):
            below, at, above = row[k], row[k + 1], row[k + 2]
            # The mean itself leaks into the first line.
            if k == 0:
                below = np.complex64(0.0)
            real = (at.real - half * (below.real + above.real)) * scale
            imag = (at.imag - half * (below.imag + above.imag)) * scale
            out[k] = real * real + imag * imag


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
        (B, K).
    levels
        (B, L) floor at the bins ``first + n hop``; it is linear between them and flat outside.
    first, hop
        See ``levels``.
    ratio, excess
        (B, K), written.

    """
    bands, count = power.shape
    parts = levels.shape[1]
    zero, one = np.float32(0.0), np.float32(1.0)
    for band in range(bands):
        for part in range(parts + 1):
            # From each level to the next; before the first and after the last it is flat.
            begin = 0 if part == 0 else min(max(int(np.ceil(first + (part - 1) * hop)), 0), count)
            end = count if part == parts else min(int(np.ceil(first + part * hop)), count)
            low = levels[band, max(part - 1, 0)]
            rise = (levels[band, min(part, parts - 1)] - low) / np.float32(hop)
            away = np.float32(begin - (first + (part - 1) * hop))
            values = power[band, begin:end]
            over, above = ratio[band, begin:end], excess[band, begin:end]
            for k in range(len(values)):
                floor = low + (away + np.float32(k)) * rise
                over[k] = one + values[k] / floor
                left = values[k] - floor
                above[k] = left if left > zero else zero


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


@compiled(fast=FAST, borrows=True)
def best_bands(
    logs: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    orders: NDArray[np.float64],
    step: float,
    center: NDArray[np.float32],
    inverse: NDArray[np.float32],
    whitenings: int,
    room: NDArray[np.float32],
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
    room
        (2, C) to work in.
    best
        (G,), written.

    """
    rows, columns = logs.shape
    bands = columns // whitenings
    scores, silent = room[0], room[1]
    silent[:] = np.float32(NEUTRAL)
    for g in range(len(orders)):
        order = orders[g] / step
        at1, at2 = _nearest_row(order, rows), _nearest_row(2.0 * order, rows)
        at3, at4 = _nearest_row(3.0 * order, rows), _nearest_row(4.0 * order, rows)
        row1 = silent if hidden[at1] else logs[at1]
        row2 = silent if hidden[at2] else logs[at2]
        row3 = silent if hidden[at3] else logs[at3]
        row4 = silent if hidden[at4] else logs[at4]
        for c in range(columns):
            scores[c] = (row1[c] + row2[c] + row3[c] + row4[c] - center[c]) * inverse[c]
        total = np.float32(0.0)
        for first in range(0, columns, bands):
            # Four at a time, which do not wait for one another.
            high1 = high2 = high3 = high4 = scores[first]
            end = first + bands
            for c in range(first, end - 3, 4):
                high1, high2 = max(high1, scores[c]), max(high2, scores[c + 1])
                high3, high4 = max(high3, scores[c + 2]), max(high4, scores[c + 3])
            for c in range(max(end - 3, first), end):
                high1 = max(high1, scores[c])
            total += max(max(high1, high2), max(high3, high4))
        best[g] = total / whitenings


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
        at = _nearest_row(orders[n] * (1.0 / step), len(logs))
        total = np.float32(0.0)
        for c in columns:
            total += logs[at, c]
        heights[n] = total / np.float32(len(columns)) - np.float32(NEUTRAL)


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
