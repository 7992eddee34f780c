# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Modulation index of a comb, and ratio of its sidebands to its harmonics."""

from __future__ import annotations

import math
from typing import Any, TYPE_CHECKING

from bearing_twin.diagnosis.signal.lines import nearest_row
from bearing_twin.diagnosis.thresholds import CARRIER, HARMONICS
from bearing_twin.numerics.compiled import compiled, FAST
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.diagnosis.combs.comb import OrderSpectra
    from numpy.typing import NDArray


HANN_BINS = 1.5
"""Noise bandwidth of the Hann window, bins: a line spreads over three."""

_HARMONICS = np.arange(1.0, HARMONICS + 1)


def modulation_index(
    spectra: OrderSpectra, order: float, band_scores: NDArray[np.float32], family: str
) -> tuple[float, int]:
    """
    Return the modulation index of a comb in the strongest band that shows it, and that band.

    It is the root of the sum over harmonics of the squared relative amplitudes of the squared
    envelope, less the noise floor: m for an envelope 1 + m cos. Lines are capped, so that beats of
    steady lines do not count. A healthy bearing excites its housing at the outer race's frequency
    and low multiples of it (variable compliance). So bands count for the outer race only if they
    begin above ``CARRIER`` multiples.

    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> spectra = OrderSpectra.of_lines(3.07 * np.arange(1, 5))
    >>> index, band = modulation_index(spectra, 3.07, np.ones(1, np.float32), 'inner')
    >>> round(index, 2), band
    (3.27, 0)

    """
    # Half of the bands remain in any case, for low sample rates.
    lowest = min(CARRIER * order, 0.5 * float(spectra.carrier.max())) if family == 'outer' else 0.0
    power = np.zeros(len(band_scores), np.float32)
    band = _strongest_band(
        spectra.excess, spectra.quiet, order, spectra.step, HARMONICS, band_scores,
        spectra.carrier, lowest, power,
    )  # fmt: skip
    return _index(power[band]), band


def comb_powers(
    spectra: OrderSpectra, orders: NDArray[np.float64], band: int
) -> NDArray[np.float32]:
    """
    Return the relative power of the lines of several combs in one band, (n,).

    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> spectra = OrderSpectra.of_lines(3.07 * np.arange(1, 5))
    >>> comb_powers(spectra, np.array([3.07, 6.14]), 0).tolist()
    [4.0, 2.0]

    """
    lines = spectra.line_power(orders[:, None] * _HARMONICS, slice(band, band + 1))
    return np.asarray(lines.sum(axis=(1, 2)))


def comb_index(spectra: OrderSpectra, order: float) -> float:
    """
    Return the modulation index of a comb in spectra of one band; see :func:`modulation_index`.

    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> round(comb_index(OrderSpectra.of_lines(3.07 * np.arange(1, 5)), 3.07), 2)
    3.27

    """
    return _index(comb_powers(spectra, np.array([order]), 0)[0])


def _index(power: np.float32) -> float:
    """Return the modulation index of lines with a total relative power."""
    return 2.0 * math.sqrt(float(power) / HANN_BINS)


def sideband_ratio(spectra: OrderSpectra, order: float, band: int, gap: float = 1.0) -> float:
    """
    Return the amplitude of the sidebands one and two gaps beside the harmonics, over theirs.

    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> spectra = OrderSpectra.of_lines(np.arange(1, 19))
    >>> sideband_ratio(spectra, 4.0, 0), sideband_ratio(spectra, 4.0, 0, 0.5)
    (1.0, 0.7071067690849304)

    """
    return float(sideband_ratios(spectra, order, band, np.array([gap]))[0])


def sideband_ratios(
    spectra: OrderSpectra, order: float, band: int, gaps: NDArray[np.float64]
) -> NDArray[np.float32]:
    """
    Return the sideband ratio of a comb at each of several gaps, (n,).

    >>> from bearing_twin.diagnosis.combs.comb import OrderSpectra
    >>> spectra = OrderSpectra.of_lines(np.arange(1, 19))
    >>> sideband_ratios(spectra, 4.0, 0, np.array([1.0, 0.25])).tolist()
    [1.0, 0.0]

    """
    ratios = np.empty(len(gaps), np.float32)
    _sideband_ratios(
        spectra.excess, spectra.quiet, order, spectra.step, HARMONICS, band, gaps, ratios
    )
    return ratios


@compiled(fast=FAST, borrows=True)
def _line_of_band(
    excess: NDArray[np.float32], hidden: NDArray[np.bool_], bins: float, band: int
) -> Any:
    """Return the power of a line in one band: its row and the two beside it."""
    last, total = len(excess) - 1, np.float32(0.0)
    middle = nearest_row(bins, len(excess))
    for beside in range(-1, 2):
        at = min(max(middle + beside, 0), last)
        if not hidden[at]:
            total += excess[at, band]
    return total


@compiled(fast=FAST, borrows=True)
def _sideband_ratios(
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
    Write the amplitude of the sidebands one and two gaps beside the harmonics, over theirs.

    ``excess`` is (K, C). ``hidden`` is a (K,) mask of left out rows. Gaps and ratios are (G,).
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
def _strongest_band(
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
    Return the band with the highest power of a comb, of the bands that show it.

    A band shows the comb if its score, (C,), is 3 or more, or the highest of all. The powers of
    the lines are added to ``power``, (C,). Bands with a carrier below ``lowest`` get no power.
    """
    last = len(excess) - 1
    for harmonic in range(1, harmonics + 1):
        middle = nearest_row(harmonic * order * (1.0 / step), len(excess))
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
