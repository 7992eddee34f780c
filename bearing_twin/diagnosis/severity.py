# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""How much: level, shape and zone of a signal, and the trend of its level over a baseline."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.result import Severity
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    'BANDS_HZ',
    'ISO_LIMITS',
    'acceleration_factor',
    'iso_zone',
    'measure_severity',
]

BANDS_HZ = ((10.0, 1000.0), (1000.0, 5000.0), (5000.0, 20000.0))
"""Standard bands of ``band_rms``, Hz; a band beyond half the sample rate counts as empty."""

ISO_LIMITS: dict[tuple[int, str], tuple[float, float, float]] = {
    (1, 'rigid'): (2.3, 4.5, 7.1),
    (1, 'flexible'): (3.5, 7.1, 11.0),
    (2, 'rigid'): (1.4, 2.8, 4.5),
    (2, 'flexible'): (2.3, 4.5, 7.1),
}
"""Zone boundaries A/B, B/C, C/D in mm/s of velocity RMS by (group, mounting), ISO 20816-3:2022."""

_FACTORS = {'m/s^2': 1.0, 'm/s2': 1.0, 'm/s²': 1.0, 'g': 9.80665, 'mm/s^2': 1e-3}


def acceleration_factor(unit: str) -> float:
    """
    Factor from ``unit`` to m/s^2; NaN where the unit is not known to be an acceleration.

    >>> acceleration_factor('g'), acceleration_factor('V')
    (9.80665, nan)

    """
    return _FACTORS.get(unit.strip(), math.nan)


def iso_zone(velocity_rms: float, power_group: int, mounting: str) -> str:
    """
    Zone ``'A'``..``'D'`` of ISO 20816-3, or empty where group, mounting or level is unknown.

    >>> iso_zone(3.0, 2, 'rigid'), iso_zone(3.0, 0, '')
    ('C', '')

    """
    limits = ISO_LIMITS.get((power_group, mounting))
    if limits is None or not math.isfinite(velocity_rms):
        return ''
    return 'ABCD'[sum(velocity_rms > limit for limit in limits)]


def measure_severity(
    x: NDArray[np.float64],
    spectrum: NDArray[np.complex64],
    sample_rate: float,
    *,
    unit: str = '',
    power_group: int = 0,
    mounting: str = '',
) -> Severity:
    """
    Numbers of one window; the baseline and the stage are the stream's to add.

    Parameters
    ----------
    x
        Samples without their mean, shape (n,), in ``unit``.
    spectrum
        Its one-sided transform, ``rfft(x) / n``, at least up to 20 kHz.
    sample_rate
        Hz.
    unit
        Unit of x.
    power_group, mounting
        See :func:`iso_zone`.

    >>> x = np.sin(2.0 * np.pi * 100.0 * np.arange(25600) / 25600.0)
    >>> found = measure_severity(x, np.fft.rfft(x) / len(x), 25600.0, unit='m/s^2')
    >>> round(found.rms, 4), round(found.crest_factor, 4), round(found.velocity_rms, 4)
    (0.7071, 1.4142, 1.1254)

    """
    square = x * x
    mean_square = float(square.mean())
    rms = math.sqrt(mean_square)
    peak = float(max(x.max(), -x.min()))
    kurtosis = float(np.square(square).mean()) / mean_square**2
    bin_hz = sample_rate / len(x)
    power = 2.0 * (spectrum.real.astype(np.float64) ** 2 + spectrum.imag.astype(np.float64) ** 2)

    def rows(low: float, high: float) -> slice:
        first = max(math.ceil(low / bin_hz), 1)
        return slice(first, max(min(math.floor(high / bin_hz) + 1, len(power)), first))

    band_rms = tuple(math.sqrt(float(power[rows(*band)].sum())) for band in BANDS_HZ)
    factor = acceleration_factor(unit)
    velocity = math.nan
    if math.isfinite(factor):
        part = rows(10.0, 1000.0)
        omega = 2.0 * math.pi * bin_hz * np.arange(part.start, part.stop)
        velocity = 1e3 * factor * math.sqrt(float((power[part] / (omega * omega)).sum()))
    return Severity(
        rms=rms,
        peak=peak,
        crest_factor=peak / rms,
        kurtosis=kurtosis,
        velocity_rms=velocity,
        level_over_baseline=math.nan,
        iso_zone=iso_zone(velocity, power_group, mounting),
        unit=unit,
        band_rms=band_rms,
    )
