# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Vibration severity: RMS, peak, kurtosis, velocity and ISO zone of a signal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
import math

from bearing_twin.diagnosis.signal.acceleration import acceleration_factor
from bearing_twin.numerics.compiled import compiled, FAST
import numpy as np
from numpy.typing import NDArray

BANDS_HZ = ((10.0, 1000.0), (1000.0, 5000.0), (5000.0, 20000.0))
"""Bands of ``band_rms``, Hz; a band above half the sample rate is empty."""

MEASURES = ('whole band', *(f'{low:g} to {high:g} Hz' for low, high in BANDS_HZ[1:]))
"""Names of the levels that are trended: from 10 Hz to 20 kHz, and in the bands in which bearings
ring. Below 10 Hz sway or drift of the sensor dominates; below 1 kHz the shaft, other machines and
the foundation do."""

ISO_LIMITS: dict[tuple[int, str], tuple[float, float, float]] = {
    (1, 'rigid'): (2.3, 4.5, 7.1),
    (1, 'flexible'): (3.5, 7.1, 11.0),
    (2, 'rigid'): (1.4, 2.8, 4.5),
    (2, 'flexible'): (2.3, 4.5, 7.1),
}
"""Zone boundaries A/B, B/C, C/D in mm/s of velocity RMS by (group, mounting), ISO 20816-3:2022."""

SLOW_HZ = 10.0
"""Shaft speed below which the velocity of ISO 20816-3 is from 2 Hz on, Hz."""

SHORTEST = 64
"""Least number of samples of a measurement."""

SHORTEST_VELOCITY = 1.0
"""Least length of a record with a velocity, s: ten periods of its lowest frequency. The velocity
of 0.1 s depends on the shaft angle at its start."""


def iso_zone(velocity_rms: float, power_group: int, mounting: str) -> str:
    """
    Return the zone ``'A'``..``'D'`` of ISO 20816-3; empty if it is not known.

    If only group or mounting is known, the machine is at least in the better of two zones: this
    one is returned if it is C or D.

    >>> iso_zone(3.0, 2, 'rigid'), iso_zone(3.0, 0, ''), iso_zone(3.0, 2, '')
    ('C', '', '')
    >>> iso_zone(5.0, 2, ''), iso_zone(8.0, 2, '')
    ('C', 'D')

    """
    if not (power_group or mounting) or not math.isfinite(velocity_rms):
        return ''
    limits = least_limits(power_group, mounting)
    zone = 'ABCD'[sum(velocity_rms > limit for limit in limits)]
    return zone if (power_group and mounting) or zone in 'CD' else ''


def least_limits(power_group: object, mounting: object) -> tuple[float, float, float]:
    """
    Return the velocities in mm/s above which a machine is at least in zone B, C and D.

    Group 0 and mounting '' are not known: then a limit is the highest of the possible ones.

    >>> least_limits(2, 'rigid'), least_limits(2, ''), least_limits(0, '')
    ((1.4, 2.8, 4.5), (2.3, 4.5, 7.1), (3.5, 7.1, 11.0))

    """
    possible = (
        limits
        for (group, stands), limits in ISO_LIMITS.items()
        if power_group in (0, group) and mounting in ('', stands)
    )
    b, c, d = (max(limits) for limits in zip(*possible, strict=True))
    return b, c, d


_, ZONE_C_OF_ALL, ZONE_D_OF_ALL = least_limits(0, '')
"""Velocity RMS above which a machine is in zone C or worse, and in zone D, in every group and
mounting, mm/s."""


@dataclass(frozen=True, kw_only=True)
class Severity:
    """Vibration severity; the fields say what each value can be compared with."""

    rms: float = math.nan
    """RMS of the signal, in ``unit``; comparable over time for a sensor at one speed and load."""
    peak: float = math.nan
    """Largest magnitude, in ``unit``; comparable like ``rms``."""
    crest_factor: float = math.nan
    """peak / rms; not comparable: rises early and falls again late."""
    kurtosis: float = math.nan
    """3 for Gaussian noise; not comparable: rises early and falls again late."""
    velocity_rms: float = math.nan
    """10..1000 Hz, mm/s; comparable between machines (ISO 20816-3); NaN if the unit is unknown."""
    level_over_baseline: float = math.nan
    """Level over the baseline of the machine, less ``correction``, dB; NaN until learnt."""
    iso_zone: str = ''
    """``'A'``..``'D'`` of ISO 20816-3; empty if it cannot be given."""
    unit: str
    band_rms: tuple[float, ...] = ()
    """RMS in the bands of :data:`BANDS_HZ`, in ``unit``."""
    stage: int = 0
    """1 to 4 (incipient, developing, advanced, severe) while the level is *fault*, else 0."""
    correction: float = 0.0
    """Change with temperature and speed, taken off the level, dB, from the healthy record of this
    machine; 0 if the record does not show it."""
    correction_sd: float = 0.0
    """Standard deviation of the correction, dB."""
    correction_basis: str = ''
    """Basis of the correction, or why there is none."""
    rising: int = 0
    """Minutes since a lasting rise over the baseline began; 0 without one."""


@dataclass(frozen=True)
class Levels:
    """
    Sums over a part of a record; the severity of the record follows from those of its parts.

    >>> x = np.sin(2.0 * np.pi * 100.0 * np.arange(25600) / 25600.0)
    >>> round(math.sqrt(Levels.of(x, np.fft.rfft(x) / len(x), 25600.0).powers[0]), 4)
    0.7071

    """

    count: int
    mean: float
    sums: tuple[float, float, float]
    """Sums of the second, third and fourth power of the deviation from the mean."""
    low: float
    high: float
    powers: tuple[float, ...]
    """Mean squares in the bands of :data:`BANDS_HZ`, and of the integral over time in the first
    of them."""

    @classmethod
    def of(
        cls, x: NDArray[np.float64], spectrum: NDArray[np.complex64], sample_rate: float
    ) -> Levels:
        """
        Return the levels of samples.

        Parameters
        ----------
        x
            Shape (n,).
        spectrum
            One-sided transform of x, ``rfft(x) / n``, at least up to 20 kHz.
        sample_rate
            Hz.

        """
        mean = float(x.mean())
        bin_hz = sample_rate / (2 * len(spectrum) - 2)
        bands = [_rows(*band, bin_hz, len(spectrum)) for band in BANDS_HZ]
        powers, (integrated, *_) = zip(*(_powers(spectrum, *band) for band in bands), strict=True)
        powers = (*powers, integrated / max((2.0 * math.pi * bin_hz) ** 2, 1e-300))
        return cls(len(x), mean, moments(x, mean), float(x.min()), float(x.max()), powers)

    @classmethod
    def together(cls, parts: Sequence[Levels]) -> Levels:
        """
        Return the levels of a record from those of its parts.

        >>> x = np.array([1.0, 2.0, 4.0, 9.0])
        >>> halves = [Levels.of(part, np.zeros(2, np.complex64), 2.0) for part in (x[:2], x[2:])]
        >>> whole = Levels.of(x, np.zeros(3, np.complex64), 2.0)
        >>> bool(np.allclose(Levels.together(halves).sums, whole.sums))
        True

        """
        count = sum(part.count for part in parts)
        mean = sum(part.count * part.mean for part in parts) / count
        second = third = fourth = 0.0
        for part in parts:
            off, n, (s2, s3, s4) = part.mean - mean, part.count, part.sums
            second += s2 + n * off**2
            third += s3 + 3.0 * off * s2 + n * off**3
            fourth += s4 + 4.0 * off * s3 + 6.0 * off**2 * s2 + n * off**4
        shares = zip(*(part.powers for part in parts), strict=True)
        return cls(
            count,
            mean,
            (second, third, fourth),
            min(part.low for part in parts),
            max(part.high for part in parts),
            tuple(
                sum(p.count * share for p, share in zip(parts, band, strict=True)) / count
                for band in shares
            ),
        )


def measure_severity(
    levels: Levels,
    *,
    unit: str = '',
    power_group: int = 0,
    mounting: str = '',
    shaft_hz: float = math.nan,
) -> Severity:
    """
    Return the severity of one window, without level over the baseline and stage.

    Parameters
    ----------
    levels
        Levels of the window.
    unit
        Unit of its samples.
    power_group, mounting
        See :func:`iso_zone`.
    shaft_hz
        Shaft speed, Hz. Below 600 1/min the velocity of the standard is from 2 Hz on, and no less
        than the velocity from 10 Hz on that is measured here. So zones C and D are given, but not
        A and B.

    >>> x = np.sin(2.0 * np.pi * 100.0 * np.arange(25600) / 25600.0)
    >>> found = measure_severity(Levels.of(x, np.fft.rfft(x) / len(x), 25600.0), unit='m/s^2')
    >>> round(found.rms, 4), round(found.crest_factor, 4), round(found.velocity_rms, 4)
    (0.7071, 1.4142, 1.1254)

    """
    mean_square = levels.sums[0] / levels.count
    rms = math.sqrt(mean_square)
    peak = max(levels.high - levels.mean, levels.mean - levels.low)
    factor = acceleration_factor(unit)
    velocity = 1e3 * factor * math.sqrt(levels.powers[-1])
    zone = iso_zone(velocity, power_group, mounting)
    if shaft_hz < SLOW_HZ and zone in ('A', 'B'):
        zone = ''
    return Severity(
        rms=rms,
        peak=peak,
        crest_factor=peak / rms,
        kurtosis=levels.sums[2] / levels.count / max(mean_square**2, 1e-300),
        velocity_rms=velocity,
        iso_zone=zone,
        unit=unit,
        band_rms=tuple(math.sqrt(power) for power in levels.powers[:-1]),
    )


def band_name(measure: int, sample_rate: float) -> str:
    """
    Return the name of one of the :data:`MEASURES` at a sample rate, which bounds its band, Hz.

    >>> band_name(2, 25600.0), band_name(1, 25600.0), band_name(0, 25600.0)
    ('5000 to 12800 Hz', '1000 to 5000 Hz', 'whole band')

    """
    low, high = BANDS_HZ[measure]
    if not measure or not low < 0.5 * sample_rate < high:
        return MEASURES[measure]
    return f'{low:g} to {0.5 * sample_rate:g} Hz'


def monitored_levels(severity: Severity) -> list[float]:
    """
    Return the levels of the :data:`MEASURES`, dB.

    >>> turns = 2.0 * np.pi * np.arange(25600) / 25600.0
    >>> x = 2.0 * np.sin(100.0 * turns) + 2.0 * np.sin(5.0 * turns)
    >>> found = measure_severity(Levels.of(x, np.fft.rfft(x) / len(x), 25600.0))
    >>> round(found.rms, 2), round(monitored_levels(found)[0], 1)
    (2.0, 3.0)

    """
    powers = [rms**2 for rms in severity.band_rms]
    # The level of an empty band, such as one above half the sample rate, follows the whole.
    whole = sum(powers) + 1e-300
    heights = (whole, *(max(power, 1e-18 * whole) for power in powers[1:]))
    return [round(10.0 * math.log10(height), 6) for height in heights]


def valid_for_length(severity: Severity, count: int, sample_rate: float) -> Severity:
    """
    Return the severity of ``count`` samples at ``sample_rate`` Hz: too few have no velocity.

    >>> x = np.sin(2.0 * np.pi * 100.0 * np.arange(25600) / 25600.0)
    >>> parts = Levels.of(x, np.fft.rfft(x) / len(x), 25600.0)
    >>> measured = measure_severity(
    ...     parts, unit='m/s^2', power_group=1, mounting='rigid', shaft_hz=25.0
    ... )
    >>> [valid_for_length(measured, n, 25600.4).iso_zone for n in (25600, 12800)]
    ['A', '']

    """
    # At a measured rate a second is no whole number of samples.
    if count >= round(SHORTEST_VELOCITY * sample_rate):
        return severity
    return replace(severity, velocity_rms=math.nan, iso_zone='')


def _rows(low: float, high: float, bin_hz: float, count: int) -> tuple[int, int]:
    """Return the first bin of a band, and the bin after the last."""
    first = max(math.ceil(min(low / bin_hz, count)), 1)
    return first, max(min(math.floor(min(high / bin_hz, count)) + 1, count), first)


@compiled(fast=FAST - {'nnan', 'ninf'}, borrows=True)
def _powers(spectrum: NDArray[np.complex64], first: int, end: int) -> tuple[float, float]:
    """Return the mean square of some bins k, and the sum of their powers over k^2."""
    total = integrated = 0.0
    for k in range(first, end):
        real, imag = np.float64(spectrum[k].real), np.float64(spectrum[k].imag)
        power, number = 2.0 * (real * real + imag * imag), np.float64(k)
        total += power
        integrated += power / (number * number)
    return total, integrated


@compiled(fast=FAST - {'nnan', 'ninf'}, borrows=True)
def moments(x: NDArray[np.float64], mean: float) -> tuple[float, float, float]:
    """
    Return the sums of the second, third and fourth power of the deviation from a mean.

    Parameters
    ----------
    x
        (n,).
    mean
        Mean, in the unit of x.

    """
    second = third = fourth = 0.0
    # By index: the compiler does not vectorize an iterator.
    for n in range(len(x)):
        away = x[n] - mean
        square = away * away
        second += square
        third += square * away
        fourth += square * square
    return second, third, fourth
