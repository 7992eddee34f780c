# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Harmonic series of a comb: whether it is its own, or part of an extraneous series.

The searched range of slip of a fault may hold the fourth, fifth or tenth harmonic of a gear, a
belt or the shaft. Two signs show it: missing harmonics of the comb, and lines between them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.signal.lines import nearest_row, row_height
from bearing_twin.diagnosis.thresholds import HARMONICS
from bearing_twin.numerics.compiled import compiled, FAST
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from bearing_twin.diagnosis.combs.comb import OrderSpectra
    from numpy.typing import NDArray


_SPREAD = 0.42
"""Standard deviation of log(1 + E) for E ~ Exp(1), one window."""

_CHANCE = 4.0
"""Standard deviations that noise between the harmonics of some fifty combs does not reach."""

_SHARE = 0.5
"""Threshold of the height of unexplained lines between the harmonics, over the height of the
harmonics: this ratio is 0 for an independent comb and 1 for a part of a denser series."""

_ALIKE = 0.69
"""Difference of mean log score up to which the lines between the harmonics are as high as the
harmonics: 3 dB of power. The sidebands of a load that varies as 1 + cos are 6 dB lower."""

MISSING = 0.25
"""Height of harmonics, relative to that of their multiples, below which they are missing: half of
``_SHARE``, because one or two harmonics of a faint comb are uncertain by half their height. Pulses
at a multiple of an order are below it, faults are not (studies.half_pulses)."""

_APART = 2.0
"""Least difference between sideband heights at two spacings, standard deviations."""

_WIDEST = 12
"""Bins to either side of a whole order in which the smeared lines of a shaft are looked for."""

_SLOWEST = 0.12
"""Lowest fundamental order of a denser series."""

_FEWEST = 4
"""Least number of lines between the harmonics."""


def line_heights(
    spectra: OrderSpectra, lines: NDArray[np.floating], columns: NDArray[np.intp]
) -> NDArray[np.float64]:
    """
    Return the mean log score of each line over some bands, less that of noise.

    Parameters
    ----------
    spectra
        Envelope spectra.
    lines
        Orders, shape (n,).
    columns
        Bands.

    Examples
    --------
    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> from bearing_twin.diagnosis.signal.lines import NEUTRAL
    >>> logs = np.full((2000, 1), NEUTRAL, np.float32)
    >>> logs[613] = 3.0 + NEUTRAL
    >>> spectra = OrderSpectra(0.01, logs, 0.0 * logs, np.zeros(1, np.float32))
    >>> line_heights(spectra, np.array([6.14, 8.0]), np.array([0])).round(3)
    array([3., 0.])

    """
    heights = np.empty(len(lines))
    _line_heights(spectra.logs, np.asarray(lines, np.float64), spectra.step, columns, heights)
    return heights


def missing_harmonics(
    spectra: OrderSpectra,
    order: float,
    columns: NDArray[np.intp],
    clear: Callable[[float], NDArray[np.intp]],
    hidden: NDArray[np.bool_],
) -> int:
    """
    Return the multiple of ``order`` that is the true fundamental; 1 if it is ``order`` itself.

    If only the second and fourth harmonic show, or only the third, or only the fourth, the comb
    belongs to the series of that multiple. This is tested in all bands in which that series is
    clear. In the bands in which the comb is highest, chance raises the missing harmonics: there
    they need only be less than half as high.

    Parameters
    ----------
    spectra
        Envelope spectra.
    order
        Fundamental of the comb.
    columns
        Bands in which the comb is highest, one of each whitening.
    clear
        Function that returns the bands in which the comb at an order is clear.
    hidden
        (K,) mask of the bins that are left out.

    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> spectra = OrderSpectra.of_lines(6.14 * np.arange(1, 4))
    >>> nothing, band = np.zeros(2000, bool), np.array([0])
    >>> missing_harmonics(spectra, 3.07, band, lambda order: band, nothing)
    2
    >>> missing_harmonics(spectra, 6.14, band, lambda order: band, nothing)
    1

    """
    unshared = _unshared(spectra, order, columns, hidden)
    for multiple in range(HARMONICS, 1, -1):
        if (
            unshared[multiple - 1] < _SHARE
            and unshared_height(spectra, order, multiple, clear(multiple * order), hidden)
            < MISSING
        ):
            return multiple
    return 1


def unshared_height(
    spectra: OrderSpectra,
    order: float,
    multiple: int,
    columns: NDArray[np.intp],
    hidden: NDArray[np.bool_],
) -> float:
    """
    Return the height of the harmonics that the series of a multiple lacks, over the shared ones'.

    Parameters
    ----------
    spectra, order, hidden
        As in :func:`missing_harmonics`.
    multiple
        Fundamental of the series, as a multiple of the order.
    columns
        Bands.

    Returns
    -------
    0 for pulses at the multiple, 1 for impacts at the order; infinite if no harmonic is shared.

    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> from bearing_twin.diagnosis.signal.lines import NEUTRAL
    >>> logs = np.full((2000, 1), NEUTRAL, np.float32)
    >>> logs[[306, 613, 920, 1227]] += np.array([[0.3], [3.0], [0.3], [3.0]], np.float32)
    >>> spectra = OrderSpectra(0.01, logs, 0.0 * logs, np.zeros(1, np.float32))
    >>> nothing = np.zeros(2000, bool)
    >>> round(unshared_height(spectra, 3.07, 2, np.array([0]), nothing), 2)
    0.1

    """
    return float(_unshared(spectra, order, columns, hidden)[multiple - 1])


def _unshared(
    spectra: OrderSpectra, order: float, columns: NDArray[np.intp], hidden: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Return the unshared heights for the multiples from 1 to ``HARMONICS``."""
    ratios = np.empty(HARMONICS)
    _unshared_heights(spectra.logs, hidden, order, spectra.step, columns, ratios)
    return ratios


def denser_series(
    spectra: OrderSpectra,
    order: float,
    columns: NDArray[np.intp],
    hidden: NDArray[np.bool_],
    mine: NDArray[np.bool_],
    sidebands: NDArray[np.bool_],
    uncertainty: float,
    *,
    sharp: bool = False,
) -> float:
    """
    Return the fundamental of the denser series that holds the comb at ``order``; 0 if none does.

    Parameters
    ----------
    spectra, order, hidden
        As in :func:`missing_harmonics`.
    columns
        Bands in which the comb is highest, one of each whitening.
    mine
        (K,) mask of the bins of the candidate's harmonics, and of lines that may be as high.
    sidebands
        (K,) mask of the bins of its sidebands and of the cage's lines, which are lower.
    uncertainty
        Largest relative error of the shaft speed. A series within it of the shaft is left to
        :func:`masked_by_shaft`, as load-zone modulated impacts have sidebands as high as
        harmonics.
    sharp
        Whether the impacts are so sharp that all lines of their series are equally high. Lines of
        half the height between the harmonics are then no part of it.

    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> spectra = OrderSpectra.of_lines(1.02 * np.arange(1, 19))
    >>> nothing = np.zeros(2000, bool)
    >>> round(denser_series(spectra, 3.06, np.array([0]), nothing, nothing, nothing, 0.002), 2)
    1.02

    """
    harmonics = order * np.arange(1, HARMONICS + 1)
    alive = ~hidden[spectra.rows(harmonics)]
    if not alive.any():
        return 0.0
    own = line_heights(spectra, harmonics[alive], columns).mean()
    most = int(order / max(_SLOWEST, 4.0 * spectra.step))
    if most < 2:
        return 0.0
    alike = own - _ALIKE
    leasts = (alike if sharp else _SHARE * own), alike
    found = _denser_part(
        spectra.logs, order, spectra.step, HARMONICS, columns, hidden, mine, sidebands, most,
        leasts, _FEWEST, _CHANCE * _SPREAD / math.sqrt(spectra.weight), uncertainty + spectra.step,
    )  # fmt: skip
    return order / found if found else 0.0


def masked_by_shaft(
    spectra: OrderSpectra,
    order: float,
    columns: NDArray[np.intp],
    *,
    precision: float,
    uncertainty: float,
) -> bool:
    """
    Return whether a comb lies on the lines of an impact once a turn, or on their skirts.

    The other multiples of the shaft are then as high as those at the harmonics of the comb. The
    first two multiples do not count: unbalance and misalignment make them in any machine.

    Parameters
    ----------
    spectra, order, columns
        As in :func:`denser_series`.
    precision
        Expected relative error of the shaft speed.
    uncertainty
        Largest relative error of the shaft speed: lines may smear as far.

    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> spectra = OrderSpectra.of_lines(np.arange(1, 20))
    >>> known = {'precision': 0.0005, 'uncertainty': 0.002}
    >>> masked_by_shaft(spectra, 3.0, np.array([0]), **known)
    True
    >>> masked_by_shaft(spectra, 3.07, np.array([0]), **known)
    False

    """
    turns = round(order)
    away = abs(order / max(turns, 1) - 1.0)
    if order < 1.5 or away > uncertainty + spectra.step / order:
        return False
    lines = np.arange(1.0, HARMONICS * turns + 1.0)
    harmonics = lines % turns == 0
    others = ~harmonics & (lines > 2.0)
    comb = line_heights(spectra, lines * order / turns, columns)
    shaft = line_heights(spectra, lines, columns)
    if away <= precision:
        comb = shaft = np.maximum(comb, shaft)
    higher = shaft[harmonics].mean() >= comb[harmonics].mean()
    return bool(higher and shaft[others].mean() > shaft[harmonics].mean() - _ALIKE)


def spaced_by_shaft(
    spectra: OrderSpectra, order: float, columns: NDArray[np.intp], reach: float
) -> bool:
    """
    Return whether the sidebands of a comb fit a shaft with a harmonic there as well as any other.

    Strikes a whole number of times a turn, equal or not, have lines at multiples of the shaft
    only. The sidebands of an inner race in the load zone are a turn apart as well, but its order
    is a whole number at one slip only.

    Parameters
    ----------
    spectra, order, columns
        As in :func:`denser_series`.
    reach
        Largest relative difference between the speed of the shaft and that of the spectra.

    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> loose = OrderSpectra.of_lines(1.006 * np.arange(1, 19))
    >>> spaced_by_shaft(loose, 5.03, np.array([0]), 0.02)
    True
    >>> race = (5.03 * np.arange(1, 4)[:, None] + np.arange(-2, 3)).ravel()
    >>> spaced_by_shaft(OrderSpectra.of_lines(race), 5.03, np.array([0]), 0.02)
    False

    """
    whole = order / max(round(order), 1)
    if abs(whole - 1.0) > reach:
        return False
    # Two gaps beside a harmonic: half a bin more moves the farther sidebands by one.
    gaps = np.arange(1.0 - reach, 1.0 + reach, 0.25 * spectra.step)
    gaps = np.append(whole, gaps)[:, None]
    sides = [order * np.arange(HARMONICS + 1) + side * gaps for side in (-2, -1, 1, 2)]
    # The multiples of the shaft below the comb count once.
    lines = np.concatenate((sides[0][:, 1:], sides[1][:, 1:], *sides[2:]), axis=1)
    heights = line_heights(spectra, lines.ravel(), columns).reshape(lines.shape).mean(axis=1)
    scatter = _SPREAD / math.sqrt(lines.shape[1] * spectra.weight)
    return bool(heights[0] > heights.max() - _APART * scatter)


def height_beyond_whole(spectra: OrderSpectra, order: float, columns: NDArray[np.intp]) -> float:
    """
    Return the height of the lines beyond whole orders over that of the lines beside a comb.

    They are the lines within twelve bins to either side of the second to fourth multiple of the
    whole order next to the comb, each less two standard deviations of noise. Where the speed of a
    shaft moves its lines smear to both sides, and the ratio is 1 in the mean; a race lies on one.

    Parameters
    ----------
    spectra, order, columns
        As in :func:`denser_series`.

    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> race = OrderSpectra.of_lines(3.03 * np.arange(1, 5))
    >>> height_beyond_whole(race, 3.03, np.array([0]))
    0.0
    >>> smeared = OrderSpectra.of_lines((3.0 + np.array([[-0.02], [0.02]])) * np.arange(1, 5))
    >>> height_beyond_whole(smeared, 3.02, np.array([0]))
    1.0

    """
    turns = round(order)
    bins = np.arange(1, _WIDEST + 1) * (spectra.step if order > turns else -spectra.step)
    whole = turns * np.arange(2.0, HARMONICS + 1.0)[:, None]
    sides = (line_heights(spectra, (whole + side * bins).ravel(), columns) for side in (1.0, -1.0))
    noise = 2.0 * _SPREAD / math.sqrt(spectra.weight)
    own, beyond = (float(np.maximum(heights - noise, 0.0).sum()) for heights in sides)
    return beyond / max(own, noise)


@compiled(fast=FAST, borrows=True)
def _line_heights(
    logs: NDArray[np.float32],
    orders: NDArray[np.float64],
    step: float,
    columns: NDArray[np.intp],
    heights: NDArray[np.float64],
) -> None:
    """
    Write the mean over some columns of the row nearest to each order, less that of noise.

    ``logs`` are (K, C); row k belongs to order (k + 1) step. Orders and heights are (N,).
    """
    for n in range(len(orders)):
        heights[n] = row_height(logs, nearest_row(orders[n] * (1.0 / step), len(logs)), columns)


@compiled(fast=FAST - {'ninf'}, borrows=True)
def _unshared_heights(
    logs: NDArray[np.float32],
    hidden: NDArray[np.bool_],
    order: float,
    step: float,
    columns: NDArray[np.intp],
    ratios: NDArray[np.float64],
) -> None:
    """
    Write the height of the harmonics that each multiple's series lacks, over the shared ones'.

    The comb has as many harmonics as there are ``ratios``, (M,). The ratio of the multiple m is at
    index m - 1; it is infinite if no harmonic is shared.
    """
    for multiple in range(1, len(ratios) + 1):
        shared = lacking = 0.0
        on = off = 0
        for n in range(1, len(ratios) + 1):
            at = nearest_row(order * n * (1.0 / step), len(logs))
            if hidden[at]:
                continue
            height = row_height(logs, at, columns)
            if n % multiple == 0:
                shared, on = shared + height, on + 1
            else:
                lacking, off = lacking + height, off + 1
        known = on > 0 and off > 0 and shared > 0.0
        ratios[multiple - 1] = lacking / off / (shared / on) if known else np.inf


@compiled(fast=FAST, borrows=True)
def _denser_part(
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
    Return the divisor of an order whose series has lines between the harmonics of a comb; 0: none.

    Of all divisors it is the one whose lines are farthest from chance.

    Parameters
    ----------
    logs, step, columns
        As in `_line_heights`.
    order, harmonics
        Fundamental of the comb, and number of its harmonics.
    hidden, mine, sidebands
        (K,) masks. ``hidden`` and ``mine`` rows do not count, ``sidebands`` rows only if all lines
        of the series are as high.
    most
        Largest divisor.
    leasts
        Least mean height of the lines without the sidebands, and with them.
    fewest, surest
        Least number of lines, and least product of their mean height and the root of their number.
    slack
        Relative distance from the shaft within which series are ignored.

    """
    inverse, best, found = 1.0 / step, 0.0, 0
    for part in range(2, most + 1):
        few = all_lines = 0
        low = height_sum = 0.0
        for n in range(1, harmonics * part + 1):
            at = nearest_row(order * (n / part) * inverse, len(logs))
            if n % part == 0 or hidden[at] or mine[at]:
                continue
            height = np.float64(row_height(logs, at, columns))
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
