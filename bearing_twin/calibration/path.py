# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The path from the bearing to the sensor's samples: its resonances, gain and noise floor.

Machine and twin are each described by a linear prediction (an autoregressive model: a resonance
is a pair of its poles). A filter that undoes the twin's prediction and applies the machine's makes
the twin's vibration pass for the machine's: same spectrum, same level, the impacts where they
were.
"""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import Any

from bearing_twin.calibration.summaries import levinson
from bearing_twin.errors import BearingTwinError
import numpy as np
import numpy.typing as npt
from scipy import fft, linalg, signal

__all__ = ['PathFilter', 'Resonance', 'SensorPath', 'identify', 'resonances', 'spectral_distance']

FloatArray = npt.NDArray[np.float64]

REACH_S = 5e-3
"""Reach of the linear predictions: resolves resonances 200 Hz apart."""
MODES_REACH_S = 2.5e-3
"""Half the reach of the autocorrelation whose decays are read."""
_STUDENT = 1.895
"""95 % of Student's distribution for a mean of eight."""
_MOST_POLES = 24
_LEAST_STRENGTH = 0.01
"""Of a singular value, over the greatest, that counts."""
SEGMENTS = 8
"""Parts of a record whose resonances are compared."""
MOST_MODES = 4
_DISTANCE_WINDOW_S = 0.01
_SHARE_OF_POWER = 0.05
"""Least share of a resonance in the power of the signal."""


@dataclass(frozen=True, kw_only=True)
class Resonance:
    """A resonance of the path: 5 %, median and 95 % of its frequency and damping ratio."""

    hz: tuple[float, float, float]
    damping: tuple[float, float, float]
    share: float
    """Of the power of the vibration."""
    found: float
    """Share of the parts of the record in which it is found."""


@dataclass(frozen=True, kw_only=True)
class SensorPath:
    """Filter from the twin's acceleration to the machine's samples."""

    sample_rate: float
    numerator: tuple[float, ...]
    """The twin's prediction error filter, times the gain."""
    denominator: tuple[float, ...]
    """The machine's prediction error filter: its poles are the resonances."""
    noise: float
    """White noise that is added to the twin's acceleration before the filter, m/s^2."""

    @property
    def gain(self) -> float:
        """Machine over twin after whitening both: units of the sensor a m/s^2."""
        return self.numerator[0]

    def filter(self, seed: int = 0) -> PathFilter:
        """Return a filter that goes on from block to block."""
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
        """Return the path that :meth:`to_dict` wrote."""
        return cls(
            sample_rate=float(values['sample_rate']),
            numerator=tuple(map(float, values['numerator'])),
            denominator=tuple(map(float, values['denominator'])),
            noise=float(values['noise']),
        )


class PathFilter:
    """
    Lets the vibration of a twin pass for its machine's, block by block.

    Examples
    --------
    A path that only has a gain of two:

    >>> path = SensorPath(sample_rate=25600.0, numerator=(2.0,), denominator=(1.0,), noise=0.0)
    >>> path.filter().apply(np.array([1.0, -1.0]))
    array([ 2., -2.])

    """

    def __init__(self, path: SensorPath, seed: int = 0) -> None:
        self._path = path
        self._rng = np.random.default_rng(seed)
        order = max(len(path.numerator), len(path.denominator)) - 1
        self._memory = np.zeros(order)

    def apply(self, x: FloatArray) -> FloatArray:
        """Filter the next block, shape (n,), m/s^2; the result is in the sensor's unit."""
        path = self._path
        driven = np.asarray(x, dtype=np.float64)
        if path.noise:
            driven = driven + path.noise * self._rng.standard_normal(driven.shape)
        if not len(self._memory):
            return np.asarray(path.numerator[0] * driven)
        y, self._memory = signal.lfilter(path.numerator, path.denominator, driven, zi=self._memory)
        return np.asarray(y)


def _power(x: FloatArray) -> FloatArray:
    """Power spectrum of a signal, zero padded to twice its length, over its number of samples."""
    size = fft.next_fast_len(2 * len(x), real=True)
    return np.asarray(np.abs(fft.rfft(x - x.mean(), size)) ** 2 / len(x))


def identify(
    measured: FloatArray, sample_rate: float, twin: FloatArray, noise: float
) -> SensorPath:
    """
    Return the path that makes a twin's vibration pass for the measured one.

    Parameters
    ----------
    measured
        Samples of the machine, shape (n,).
    sample_rate
        Hz, of both.
    twin
        Acceleration of the housing of the twin without noise and resonance, m/s^2, shape (m,).
    noise
        White noise to be added to it, m/s^2.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> twin, machine = rng.standard_normal((2, 25600))
    >>> machine = signal.lfilter([3.0], [1.0, -0.9], machine)
    >>> path = identify(machine, 25600.0, twin, 0.1)
    >>> y = path.filter().apply(twin)
    >>> bool(abs(y.std() / machine.std() - 1.0) < 0.05)
    True

    """
    order = max(8, round(REACH_S * sample_rate))
    if len(measured) < 4 * order:
        msg = (
            f'{len(measured)} samples are too few for a sensor path at {sample_rate:g} Hz; '
            f'give at least {4 * order}'
        )
        raise BearingTwinError(msg)
    machine, machine_error = levinson(_power(measured), order)
    power = _power(twin)
    # The spectrum of white noise is flat: its variance.
    power += noise * noise
    own, own_error = levinson(power, order)
    gain = math.sqrt(max(machine_error, 0.0) / max(own_error, 1e-300))
    return SensorPath(
        sample_rate=sample_rate,
        numerator=tuple(float(value) for value in gain * own),
        denominator=tuple(float(value) for value in machine),
        noise=noise,
    )


def spectral_distance(one: FloatArray, other: FloatArray, sample_rate: float) -> float:
    """
    Log-spectral distance of two signals, dB: root mean square of the difference of their spectra.

    In bands of 100 Hz, up to 0.86 of half the sample rate, where an anti-aliasing filter begins.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> x, y = rng.standard_normal((2, 51200))
    >>> round(spectral_distance(x, 10.0 * y, 25600.0))
    20

    """
    length = max(16, round(_DISTANCE_WINDOW_S * sample_rate))
    levels = [
        10.0 * np.log10(signal.welch(x, sample_rate, nperseg=min(length, len(x)))[1] + 1e-300)
        for x in (one, other)
    ]
    last = int(0.86 * len(levels[0]))
    return float(np.sqrt(np.mean((levels[0] - levels[1])[1:last] ** 2)))


def resonances(x: FloatArray, sample_rate: float) -> list[Resonance]:
    """
    Return the resonances of a path, strongest first: frequency, damping and their scatter.

    The resonances of the whole record are looked for again in each of `SEGMENTS` parts, whose
    scatter over the root of their number is the uncertainty.

    Parameters
    ----------
    x
        Samples, shape (n,).
    sample_rate
        Hz.

    Examples
    --------
    Noise through a resonance at 3 kHz with a damping ratio of 0.03:

    >>> rng = np.random.default_rng(1)
    >>> pole = np.exp(2 * np.pi * 3000 / 25600 * (-0.03 + 1j))
    >>> denominator = np.poly([pole, pole.conjugate()]).real
    >>> found = resonances(signal.lfilter([1.0], denominator, rng.standard_normal(102400)), 25600)
    >>> round(found[0].hz[1], -2), round(found[0].damping[1], 2)
    (3000.0, 0.03)

    """
    order = max(8, round(MODES_REACH_S * sample_rate))
    parts = np.array_split(x, SEGMENTS) if len(x) >= 8 * SEGMENTS * order else []
    whole = _modes(x, sample_rate, order)
    others = [_modes(part, sample_rate, order) for part in parts]
    found = []
    for hz, damping, share in whole[:MOST_MODES]:
        near = []
        for modes in others:
            close = [mode for mode in modes if abs(mode[0] - hz) < 0.1 * hz]
            if close:
                near.append(min(close, key=lambda mode: abs(mode[0] - hz)))
        spread = np.std([mode[:2] for mode in near], axis=0, ddof=1) if len(near) > 2 else None
        half = _STUDENT * spread / math.sqrt(len(near)) if spread is not None else (math.inf,) * 2
        found.append(
            Resonance(
                hz=(float(hz - half[0]), hz, float(hz + half[0])),
                damping=(max(float(damping - half[1]), 0.0), damping, float(damping + half[1])),
                share=share,
                found=len(near) / SEGMENTS,
            )
        )
    return found


def _modes(x: FloatArray, sample_rate: float, order: int) -> list[tuple[float, float, float]]:
    """
    Frequency, damping and share of the power of each resonance, strongest first.

    Covariance-driven stochastic subspace identification (Peeters and De Roeck, Mech. Syst. Signal
    Process. 1999, 13, 855): the autocorrelation of what resonances make of noise is a sum of their
    free decays. Lag zero, which has the noise of the sensor, is left out.
    """
    correlation = fft.irfft(_power(x))[: 2 * order + 1]
    hankel = linalg.hankel(correlation[1 : order + 1], correlation[order : 2 * order])
    left, strength, _ = linalg.svd(hankel)
    rank = min(_MOST_POLES, int((strength > _LEAST_STRENGTH * strength[0]).sum()))
    if strength[0] <= 0.0 or rank < 2:
        return []
    shift = linalg.lstsq(left[:-1, :rank], left[1:, :rank])[0]
    poles = linalg.eigvals(shift)
    lags = np.arange(1, 2 * order + 1)
    amplitudes = linalg.lstsq(poles[None, :] ** lags[:, None], correlation[1:])[0]
    upper = (poles.imag > 1e-9) & (np.abs(poles) < 1.0)
    poles, amplitudes = poles[upper], amplitudes[upper]
    log = np.log(poles)
    damping = -log.real / np.abs(log)
    hz = np.abs(log) * sample_rate / (2.0 * math.pi)
    share = 2.0 * amplitudes.real / correlation[0]
    keep = (damping < 0.15) & (share > _SHARE_OF_POWER) & (hz < 0.43 * sample_rate)
    by_share = np.argsort(-share)
    return [(float(hz[i]), float(damping[i]), float(share[i])) for i in by_share if keep[i]]
