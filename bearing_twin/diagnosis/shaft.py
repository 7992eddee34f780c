# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Shaft speed: refinement of the given value, and angular resampling where it varies."""

from __future__ import annotations

from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.diagnosis.spectra import local_floor
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.diagnosis.spectra import EnvelopeSpectra
    from numpy.typing import NDArray

__all__ = ['SHAFT_FOUND', 'ShaftSpeed', 'refine_shaft_hz', 'resample_to_angle', 'varies']

SHAFT_FOUND = 5.0
"""Score from which the harmonics of the shaft are believed."""

_HARMONICS = 6
_MARGIN = 3.0
_STEADY = 0.005


class ShaftSpeed(NamedTuple):
    """Shaft speed used, and how far it may still be off."""

    shaft_hz: float
    uncertainty: float
    """Relative."""
    score: float
    """Standard deviations of its harmonic comb over the combs beside it."""
    tolerance: float
    """Relative tolerance of the speed handed in."""


def refine_shaft_hz(
    power: NDArray[np.float32],
    bin_hz: float,
    envelopes: EnvelopeSpectra,
    given_hz: float,
    tolerance: float,
    *,
    threshold: float = SHAFT_FOUND,
) -> ShaftSpeed:
    """
    Look for the shaft's harmonics within the tolerance of the given speed.

    Parameters
    ----------
    power
        Power spectrum of the signal, bin k at k bin_hz, shape (>= 8 given_hz / bin_hz,).
    bin_hz
        Its spacing, Hz.
    envelopes
        Squared envelope spectra of the same window.
    given_hz
        Speed handed in, Hz.
    tolerance
        Its relative tolerance, e.g. 0.02.
    threshold
        Score from which the harmonics are believed.

    Returns
    -------
    The refined speed, or the given one with its tolerance where no harmonics stand out.

    >>> from bearing_twin.diagnosis.spectra import EnvelopeSpectra
    >>> power = np.ones(2001, np.float32)
    >>> power[1010 * np.arange(1, 7) // 10] = 1e4
    >>> flat = np.ones((3, 1, 2000), np.float32)
    >>> envelopes = EnvelopeSpectra(0.25, flat, flat)
    >>> round(refine_shaft_hz(power, 0.25, envelopes, 25.0, 0.02).shaft_hz, 1)
    25.2

    """
    step = bin_hz / (2.0 * _HARMONICS)
    reach = max(tolerance * given_hz, step)
    near = given_hz + np.arange(-int(reach / step), int(reach / step) + 1) * step
    # The null: combs well away from the shaft and from its simple fractions.
    beside = given_hz * np.concatenate((np.linspace(0.68, 0.73, 64), np.linspace(1.18, 1.23, 64)))
    last = min(int(np.ceil(8.0 * given_hz / bin_hz)), len(power) - 1)
    low = power[1 : last + 1]
    direct = np.log1p(low / local_floor(low, max(int(4.0 * given_hz / bin_hz), 32)))
    indirect = envelopes.logs[..., :last].mean(axis=(0, 1))

    def comb(hertz: NDArray[np.floating]) -> NDArray[np.float64]:
        lines = np.empty((_HARMONICS, len(hertz)))
        for harmonic in range(1, _HARMONICS + 1):
            index = np.rint(harmonic * hertz / bin_hz).astype(np.intp) - 1
            lines[harmonic - 1] = direct[np.clip(index, 0, len(direct) - 1)]
            lines[harmonic - 1] += 2.0 * indirect[np.clip(index, 0, len(indirect) - 1)]
        # A fault order near an integer fakes one harmonic and its double; the shaft has more.
        lines.sort(axis=0)
        return np.asarray(lines[:-2].sum(axis=0))

    null = comb(beside)
    center = float(np.median(null))
    spread = max(float(np.quantile(null, 0.8413)) - center, 1e-3)
    scores = (comb(near) - center) / spread
    best = float(scores.max())
    if best < threshold:
        return ShaftSpeed(given_hz, tolerance, best, tolerance)
    # Fault lines and their sidebands beside an integer order look like a shaft a little off: the
    # given speed is left only for harmonics that are clearly better.
    if best < scores[len(near) // 2] + _MARGIN:
        shaft_hz = given_hz
    else:
        # The harmonics are bins: a run of equal scores has its middle as the best estimate.
        ties = near[scores >= best - 1e-9]
        shaft_hz = float(ties[np.argmin(np.abs(ties - np.median(ties)))])
    uncertainty = bin_hz / (2.0 * shaft_hz)
    return ShaftSpeed(shaft_hz, min(uncertainty, tolerance), best, tolerance)


def varies(shaft_hz: NDArray[np.float64]) -> bool:
    """
    Whether a speed moves so far within a window that its lines smear.

    >>> varies(np.array([25.0, 25.1])), varies(np.array([25.0, 26.0]))
    (False, True)

    """
    return bool(np.ptp(shaft_hz) > _STEADY * shaft_hz.mean())


def resample_to_angle(
    x: NDArray[np.float64], sample_rate: float, shaft_hz: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """
    Resample a record of varying speed to equal steps of shaft angle.

    Parameters
    ----------
    x
        Record, shape (n,).
    sample_rate
        Hz.
    shaft_hz
        Shaft speed at each sample, Hz, shape (n,), positive.

    Returns
    -------
    The record over angle, and the mean speed, Hz, at which it would have its old sample rate.

    >>> hertz = np.linspace(20.0, 30.0, 25600)
    >>> x = np.cos(2.0 * np.pi * np.cumsum(hertz) / 25600.0)
    >>> even, mean_hz = resample_to_angle(x, 25600.0, hertz)
    >>> round(mean_hz, 3), int(np.abs(np.fft.rfft(even)).argmax())
    (25.0, 25)

    """
    angle = np.concatenate(([0.0], np.cumsum(0.5 * (shaft_hz[1:] + shaft_hz[:-1])))) / sample_rate
    mean_hz = float(angle[-1] / (len(x) - 1) * sample_rate)
    even = np.linspace(0.0, angle[-1], len(x))
    time = np.interp(even, angle, np.arange(len(x), dtype=np.float64))
    # Four-point Lagrange interpolation: third order, local, exact where the speed is constant.
    base = np.clip(np.floor(time).astype(np.intp), 1, len(x) - 3)
    t = time - base
    resampled = (
        x[base - 1] * (-t * (t - 1.0) * (t - 2.0) / 6.0)
        + x[base] * ((t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0)
        + x[base + 1] * (-(t + 1.0) * t * (t - 2.0) / 2.0)
        + x[base + 2] * ((t + 1.0) * t * (t - 1.0) / 6.0)
    )
    return resampled, mean_hz
