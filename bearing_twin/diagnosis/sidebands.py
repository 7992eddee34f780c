# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Modulation: heights of the harmonics of a comb, and of their sidebands."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.diagnosis import kernels
from bearing_twin.diagnosis.comb import HARMONICS
from bearing_twin.diagnosis.thresholds import CARRIER
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.diagnosis.comb import OrderSpectra
    from numpy.typing import NDArray


HANN_BINS = 1.5
"""Noise bandwidth of the Hann window, bins: a line spreads over three."""

_HARMONICS = np.arange(1.0, HARMONICS + 1)


def modulation_index(
    spectra: OrderSpectra, order: float, band_scores: NDArray[np.float32], family: str
) -> tuple[float, int]:
    """
    Modulation index of a comb, the largest of the bands that show it, and that band.

    Root of the sum over harmonics of the squared relative amplitudes of the squared envelope,
    noise floor taken off: m for an envelope 1 + m cos. Lines are capped, so that
    steady ones beating with one another do not count. A healthy bearing forces its housing at the
    outer race's frequency and its low multiples (variable compliance); for that family the index
    counts only in bands that begin above ``CARRIER`` multiples.

    >>> import numpy as np
    >>> from bearing_twin.diagnosis.comb import OrderSpectra
    >>> spectra = OrderSpectra.of_lines(3.07 * np.arange(1, 5))
    >>> index, band = modulation_index(spectra, 3.07, np.ones(1, np.float32), 'inner')
    >>> round(index, 2), band
    (3.27, 0)

    """
    # Half of the range stays in any case, for low sample rates.
    lowest = min(CARRIER * order, 0.5 * float(spectra.carrier.max())) if family == 'outer' else 0.0
    power = np.zeros(len(band_scores), np.float32)
    band = kernels.strongest_band(
        spectra.excess, spectra.quiet, order, spectra.step, HARMONICS, band_scores,
        spectra.carrier, lowest, power,
    )  # fmt: skip
    # A line spreads over three bins of the Hann window, whose noise bandwidth is 1.5 bins.
    return 2.0 * math.sqrt(float(power[band]) / HANN_BINS), band


def comb_powers(
    spectra: OrderSpectra, orders: NDArray[np.float64], band: int
) -> NDArray[np.float32]:
    """
    Relative power of the lines of several combs in one band.

    >>> import numpy as np
    >>> from bearing_twin.diagnosis.comb import OrderSpectra
    >>> spectra = OrderSpectra.of_lines(3.07 * np.arange(1, 5))
    >>> comb_powers(spectra, np.array([3.07, 6.14]), 0).tolist()
    [4.0, 2.0]

    """
    lines = spectra.line_power(orders[:, None] * _HARMONICS, slice(band, band + 1))
    return np.asarray(lines.sum(axis=(1, 2)))


def sideband_ratio(spectra: OrderSpectra, order: float, band: int, gap: float = 1.0) -> float:
    """
    Amplitude of the lines one and two gaps beside the harmonics of a comb, over theirs.

    >>> import numpy as np
    >>> from bearing_twin.diagnosis.comb import OrderSpectra
    >>> spectra = OrderSpectra.of_lines(np.arange(1, 19))
    >>> sideband_ratio(spectra, 4.0, 0), sideband_ratio(spectra, 4.0, 0, 0.5)
    (1.0, 0.7071067690849304)

    """
    return float(sideband_ratios(spectra, order, band, np.array([gap]))[0])


def sideband_ratios(
    spectra: OrderSpectra, order: float, band: int, gaps: NDArray[np.float64]
) -> NDArray[np.float32]:
    """
    Sideband ratio at each of several gaps.

    >>> import numpy as np
    >>> from bearing_twin.diagnosis.comb import OrderSpectra
    >>> spectra = OrderSpectra.of_lines(np.arange(1, 19))
    >>> sideband_ratios(spectra, 4.0, 0, np.array([1.0, 0.25])).tolist()
    [1.0, 0.0]

    """
    ratios = np.empty(len(gaps), np.float32)
    kernels.sideband_ratios(
        spectra.excess, spectra.quiet, order, spectra.step, HARMONICS, band, gaps, ratios
    )
    return ratios
