# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Filter from the twin's acceleration to the samples of a real sensor, and spectral distance.

`scipy.signal` has the same functions, and the tests compare with it, but its import would double
the time that a twin needs to start.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from bearing_twin.errors import BearingTwinError
from bearing_twin.numerics.compiled import compiled
import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

BAND_HZ = 100.0
"""Width of the bands in which two spectra are compared, Hz."""
MOST_COEFFICIENTS = 2048
MOST_GAIN = 1e12
"""Limit of the coefficients; those of a real sensor path are smaller, and results stay finite."""
_BELOW_FILTER = 0.86
"""Upper limit of the comparison, fraction of half the sample rate: an anti-aliasing filter begins
there."""


@dataclass(frozen=True, kw_only=True)
class SensorPath:
    """Filter from the twin's acceleration to the machine's samples."""

    sample_rate: float
    numerator: tuple[float, ...]
    """Prediction error filter of the twin, times the gain."""
    denominator: tuple[float, ...]
    """Prediction error filter of the machine; the poles of the path are the resonances."""
    noise: float
    """Standard deviation of white noise added to the twin's acceleration before the filter,
    m/s^2."""

    @property
    def gain(self) -> float:
        """Ratio of machine to twin after whitening both, sensor unit per m/s^2."""
        return self.numerator[0]

    def filter(self, seed: int = 0) -> PathFilter:
        """Return a filter that keeps its state from block to block."""
        return PathFilter(self, seed)

    def to_dict(self) -> dict[str, Any]:
        """Return the path as plain numbers."""
        return {
            'sample_rate': self.sample_rate,
            'numerator': list(self.numerator),
            'denominator': list(self.denominator),
            'noise': self.noise,
        }

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> SensorPath:
        """
        Return the path from the result of :meth:`to_dict`.

        Raises
        ------
        BearingTwinError
            If it is not a stable filter with finite coefficients.

        """
        path = cls(
            sample_rate=float(values['sample_rate']),
            numerator=tuple(map(float, values['numerator'])),
            denominator=tuple(map(float, values['denominator'])),
            noise=float(values['noise']),
        )
        numbers = np.array([*path.numerator, *path.denominator, path.noise, path.sample_rate])
        sizes = len(path.numerator), len(path.denominator)
        if not (
            np.abs(numbers).max() < MOST_GAIN and 0 < min(sizes) <= max(sizes) <= MOST_COEFFICIENTS
            and path.denominator[0] == 1.0 and path.noise >= 0.0 and stable(path.denominator)
        ):  # fmt: skip
            msg = 'the path of the sensor is no stable filter; fit again'
            raise BearingTwinError(msg)
        return path


def stable(denominator: tuple[float, ...]) -> bool:
    """
    Whether all poles lie inside the unit circle, by the inverse Levinson recursion.

    Examples
    --------
    >>> stable((1.0, -0.9)), stable((1.0, -1.1)), stable((1.0, -2.1, 1.1))
    (True, False, False)

    """
    rest = np.array(denominator, dtype=np.float64)
    while len(rest) > 1:
        reflection = rest[-1]
        if not abs(reflection) < 1.0:
            return False
        rest = ((rest - reflection * rest[::-1]) / (1.0 - reflection * reflection))[:-1]
    return True


@compiled()
def _filter(
    numerator: FloatArray,
    denominator: FloatArray,
    x: FloatArray,
    memory: FloatArray,
    out: FloatArray,
) -> None:
    """Filter ``x`` into ``out`` in transposed direct form II; arrays have equal order."""
    for k in range(len(x)):
        y = memory[0] + numerator[0] * x[k]
        for i in range(len(memory) - 1):
            memory[i] = memory[i + 1] + numerator[i + 1] * x[k] - denominator[i + 1] * y
        out[k] = y


class PathFilter:
    """
    Filter the vibration of a twin to that of its machine, block by block.

    Examples
    --------
    A path with a gain of two and nothing else:

    >>> path = SensorPath(sample_rate=25600.0, numerator=(2.0,), denominator=(1.0,), noise=0.0)
    >>> path.filter().apply(np.array([1.0, -1.0]))
    array([ 2., -2.])

    """

    def __init__(self, path: SensorPath, seed: int = 0) -> None:
        self._noise = path.noise
        self._rng = np.random.default_rng(seed)
        # One element more, always zero: the input of the last delay element.
        size = max(len(path.numerator), len(path.denominator)) + 1
        self._numerator, self._denominator, self.memory = np.zeros((3, size))
        self._numerator[: len(path.numerator)] = path.numerator
        self._denominator[: len(path.denominator)] = path.denominator

    def apply(self, x: npt.ArrayLike) -> FloatArray:
        """Filter the next block, shape (n,), m/s^2; the result is in the sensor's unit."""
        driven = np.array(x, dtype=np.float64)
        if self._noise:
            driven += self._noise * self._rng.standard_normal(driven.shape)
        out = np.empty_like(driven)
        _filter(self._numerator, self._denominator, driven, self.memory, out)
        return out


def window_length(sample_rate: float) -> int:
    """
    Return the samples per window of `band_levels`; it has half as many bands plus one.

    Examples
    --------
    >>> window_length(25600.0), len(band_levels(np.ones(512), 25600.0))
    (256, 129)

    """
    return max(16, round(sample_rate / BAND_HZ))


def band_levels(x: npt.ArrayLike, sample_rate: float) -> FloatArray:
    """
    Return the power spectral density of a signal in bands of `BAND_HZ`, dB.

    Welch's method is used, with Hann windows of the length 1/`BAND_HZ` and 50 % overlap.

    Parameters
    ----------
    x
        Samples, shape (n,), n at least one window.
    sample_rate
        Hz.

    Returns
    -------
    array
        dB re 1 unit^2/Hz; the centre of band k is at k `BAND_HZ`.

    Raises
    ------
    BearingTwinError
        If the signal is shorter than a window.

    Examples
    --------
    White noise with a standard deviation of 1 has a density of 1/12800 per Hz at 25.6 kHz:

    >>> levels = band_levels(np.random.default_rng(1).standard_normal(256000), 25600.0)
    >>> len(levels), abs(round(float(levels[1:128].mean() + 41.07), 1))
    (129, 0.0)

    """
    values = np.asarray(x, dtype=np.float64)
    length = window_length(sample_rate)
    if len(values) < length:
        msg = f'{len(values)} samples are less than a window of {length}; give more'
        raise BearingTwinError(msg)
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / length)
    parts = np.lib.stride_tricks.sliding_window_view(values, length)[:: length // 2]
    parts = (parts - parts.mean(axis=1, keepdims=True)) * window
    power = (np.abs(np.fft.rfft(parts, axis=1)) ** 2).mean(axis=0)
    power[1 : (length + 1) // 2] *= 2.0
    power /= sample_rate * float(window @ window)
    return np.asarray(10.0 * np.log10(power + 1e-300))


def distance(one: npt.ArrayLike, other: npt.ArrayLike) -> float:
    """
    Log-spectral distance of two `band_levels`, dB: root mean square of their difference.

    Bands up to 0.86 of half the sample rate count; there an anti-aliasing filter begins.

    Examples
    --------
    >>> distance(np.zeros(129), np.full(129, 20.0))
    20.0

    """
    difference = np.asarray(one, dtype=np.float64) - np.asarray(other, dtype=np.float64)
    return float(np.sqrt(np.mean(difference[1 : int(_BELOW_FILTER * len(difference))] ** 2)))
