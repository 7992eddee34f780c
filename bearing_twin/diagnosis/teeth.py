# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Whether a comb stands for itself, or only shares teeth with one that comes from elsewhere.

A fault window holds the orders of a family at every slip that is looked for; the fourth, fifth or
tenth harmonic of a gear, a belt or the shaft itself may lie there. What tells is what the
candidate leaves out: teeth of its own that are missing, or lines between its teeth.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.comb import HARMONICS, NEUTRAL
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.diagnosis.comb import OrderSpectra
    from numpy.typing import NDArray

__all__ = ['beside_shaft', 'denser_comb', 'missing_teeth']

_SPREAD = 0.42
"""Standard deviation of log(1 + E) for E ~ Exp(1), one window."""

_CHANCE = 4.0
"""Standard deviations that noise between the teeth does not reach in some fifty combs."""

_SHARE = 0.5
"""Height of the lines between the teeth that the candidate does not explain over that of its
teeth: 0 for a comb of its own, 1 for one that is part of a denser comb."""

_ALIKE = 0.69
"""Mean log score by which the lines between the teeth may fall short of the teeth and still be
as high: 3 dB of power. The sidebands of a swayed load are 6 dB below its teeth, and fade."""

_MISSING = 0.25
"""Height of teeth over that of their multiples below which they are missing: half of ``_SHARE``,
for one or two teeth are uncertain by half the height of a faint comb."""

_SLOWEST = 0.12
"""Lowest fundamental order of a denser comb."""

_FEWEST = 4
"""Lines between the teeth that are needed to tell."""


def _heights(
    spectra: OrderSpectra, lines: NDArray[np.floating], columns: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Mean log score of each line over some bands, noise taken off."""
    rows = spectra.rows(lines)
    return np.asarray(spectra.logs[rows[:, None], columns].mean(axis=1) - NEUTRAL, np.float64)


def missing_teeth(
    spectra: OrderSpectra, order: float, columns: NDArray[np.intp], hidden: NDArray[np.bool_]
) -> int:
    """
    Multiple of ``order`` at which the true fundamental lies, 1 if that is ``order`` itself.

    A comb whose second and fourth teeth, or third, or fourth alone, stand while the others are
    missing is one of that multiple, or of a fraction of it.

    Parameters
    ----------
    spectra
        Envelope spectra.
    order
        Fundamental of the comb.
    columns
        Bands in which it stands highest, one of each whitening.
    hidden
        (K,) mask of the bins that cannot tell.

    """
    teeth = np.arange(1, HARMONICS + 1)
    heights = _heights(spectra, teeth * order, columns)
    alive = ~hidden[spectra.rows(teeth * order)]
    for multiple in range(HARMONICS, 1, -1):
        shared = teeth % multiple == 0
        on, off = heights[shared & alive], heights[~shared & alive]
        if len(on) and len(off) and off.mean() < _MISSING * on.mean():
            return multiple
    return 1


def denser_comb(
    spectra: OrderSpectra,
    order: float,
    columns: NDArray[np.intp],
    hidden: NDArray[np.bool_],
    mine: NDArray[np.bool_],
    sidebands: NDArray[np.bool_],
    uncertainty: float,
) -> float:
    """
    Fundamental order of a denser comb of which the comb at ``order`` is a part, 0 if of none.

    Parameters
    ----------
    spectra, order, columns, hidden
        As in :func:`missing_teeth`.
    mine
        (K,) mask of the bins in which the candidate has teeth, or lines that may be as high.
    sidebands
        (K,) mask of the bins of its sidebands and of the cage, which are lower.
    uncertainty
        Largest relative error of the shaft speed. The sidebands of a race that is gated by the
        load are as high as its teeth: a comb as near to the shaft's is left to
        :func:`beside_shaft`.

    """
    teeth = order * np.arange(1, HARMONICS + 1)
    alive = ~hidden[spectra.rows(teeth)]
    if not alive.any():
        return 0.0
    own = _heights(spectra, teeth[alive], columns).mean()
    most = int(order / max(_SLOWEST, 4.0 * spectra.step))
    if most < 2:
        return 0.0
    parts, lines = _between(most)
    rows = spectra.rows(order * lines)
    heights = _heights(spectra, order * lines, columns)
    best, found = 0.0, 0
    hidden = hidden | mine
    away = np.abs(order / np.maximum(np.arange(most + 1), 1) - 1.0)
    shaft = away <= uncertainty + spectra.step
    for mask, least in ((hidden | sidebands, _SHARE * own), (hidden, own - _ALIKE)):
        tells = ~mask[rows]
        counts = np.bincount(parts[tells], minlength=most + 1)
        sums = np.bincount(parts[tells], heights[tells], minlength=most + 1)
        means = np.asarray(sums, np.float64) / np.maximum(counts, 1)
        sure = means * np.sqrt(counts * spectra.weight) / _SPREAD
        sure[(counts < _FEWEST) | (means < least) | (sure < _CHANCE) | shaft] = 0.0
        part = int(np.argmax(sure))
        if sure[part] > best:
            best, found = float(sure[part]), part
    return order / found if found else 0.0


@functools.lru_cache(maxsize=64)
def _between(most: int) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Lines of combs 2 to ``most`` times as dense as one of order 1: which comb's, and where."""
    parts = np.concatenate([np.full(HARMONICS * m, m, np.intp) for m in range(2, most + 1)])
    lines = np.concatenate([np.arange(1.0, HARMONICS * m + 1) for m in range(2, most + 1)])
    between = lines % parts != 0
    parts, lines = parts[between], lines[between]
    return parts, lines / parts


def beside_shaft(
    spectra: OrderSpectra,
    order: float,
    columns: NDArray[np.intp],
    *,
    precision: float,
    uncertainty: float,
) -> bool:
    """
    Whether a comb is one of the many lines of a knock once a turn, or stands on their skirts.

    The other multiples of the shaft are then as high as those at or beside its teeth. Unbalance
    and misalignment make the first two in any machine: these do not tell.

    Parameters
    ----------
    spectra, order, columns
        As in :func:`missing_teeth`.
    precision
        Relative error of the shaft speed that is expected.
    uncertainty
        The same, at most: as far as lines may smear.

    """
    turns = round(order)
    away = abs(order / max(turns, 1) - 1.0)
    if order < 1.5 or away > uncertainty + spectra.step / order:
        return False
    lines = np.arange(1.0, HARMONICS * turns + 1.0)
    teeth = lines % turns == 0
    others = ~teeth & (lines > 2.0)
    comb = _heights(spectra, lines * order / turns, columns)
    shaft = _heights(spectra, lines, columns)
    if away <= precision:
        comb = shaft = np.maximum(comb, shaft)
    higher = shaft[teeth].mean() >= comb[teeth].mean()
    return bool(higher and shaft[others].mean() > shaft[teeth].mean() - _ALIKE)
