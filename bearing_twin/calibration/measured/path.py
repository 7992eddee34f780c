# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The path from the bearing to the sensor's samples: its resonances, gain and noise floor.

Machine and twin are each described by a linear prediction (an autoregressive model: a resonance
is a pair of its poles). A filter undoes the twin's prediction and applies the machine's. It gives
the twin's vibration the spectrum and level of the machine's; the impacts keep their times.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

from bearing_twin.calibration.measured.summaries import HIGH_SHARE, levinson, TAPERED
from bearing_twin.dynamics.equations.sensor_path import SensorPath
from bearing_twin.errors import BearingTwinError
import numpy as np
import numpy.typing as npt
import scipy
from scipy import fft

FloatArray = npt.NDArray[np.float64]

REACH_S = 5e-3
"""Reach of the linear predictions, s: it resolves resonances 200 Hz apart."""
MODES_REACH_S = 2.5e-3
"""Half the reach of the autocorrelation that gives the resonances, s."""
STUDENT = 1.895
"""95 % quantile of Student's t distribution with seven degrees of freedom."""
_MOST_POLES = 24
_LEAST_STRENGTH = 0.01
"""Least singular value that counts, over the greatest."""
SEGMENTS = 8
"""Parts of a record whose noise floors are compared."""
MOST_MODES = 4
_SHARE_OF_POWER = 0.05
"""Least share of a resonance in the power of the signal."""
LINE_DAMPING = 0.002
"""Damping below which a pole is a line of the mains or of a drive, not a resonance."""
_QUIETEST = 0.05
_BAND_S = 5e-3
"""Length of the segments for the spectrum of the noise floor, s. Its bands of 200 Hz are so wide
that chance hardly decides which are the quietest."""


class Resonance(NamedTuple):
    """A resonance of a record."""

    hz: float
    damping: float
    """Damping ratio."""
    share: float
    """Share of the power of the vibration."""


def _power(x: FloatArray) -> FloatArray:
    """Return the power spectrum of a signal, tapered and zero padded to twice its length."""
    window = scipy.signal.windows.tukey(len(x), TAPERED)
    size = fft.next_fast_len(2 * len(x), real=True)
    return np.asarray(np.abs(fft.rfft(window * (x - x.mean()), size)) ** 2 / (window @ window))


def identify(
    measured: FloatArray, sample_rate: float, twin: FloatArray, noise: float
) -> SensorPath:
    """
    Return the path that gives a twin's vibration the spectrum and level of the measured one.

    Parameters
    ----------
    measured
        Samples of the machine, shape (n,).
    sample_rate
        Hz, of both.
    twin
        Acceleration of the twin's housing without noise and resonance, m/s^2, shape (m,).
    noise
        RMS of the white noise added to it, m/s^2.

    Examples
    --------
    >>> from scipy import signal
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
        raise BearingTwinError(
            f'{len(measured)} samples are too few for a sensor path at {sample_rate:g} Hz; '
            f'give at least {4 * order}'
        )
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


def noise_floor(x: FloatArray, sample_rate: float) -> tuple[float, float, float]:
    """
    Return 5 %, 50 % and 95 % of the noise floor, unit of the record per root Hz.

    It is the density in the quietest twentieth of the spectrum. Each part of the record is
    measured in the bands that are quietest in the other parts: its own quietest bands would be
    quiet by chance. The bias that remains is about twice as large in half of the record as in all
    of it; the difference is subtracted. The interval is from a jackknife over the parts.

    Examples
    --------
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> [round(value, 3) for value in noise_floor(noise, 12800.0)]
    [0.011, 0.012, 0.013]

    """
    length = max(64, int(_BAND_S * sample_rate))
    density = np.array(
        [
            scipy.signal.welch(part, sample_rate, nperseg=min(len(part), length))[1]
            for part in np.array_split(x, SEGMENTS)
        ]
    )
    # Removing the mean of each segment weakens the lowest lines too.
    density = density[:, 4 : int(HIGH_SHARE * density.shape[1])]
    halves = itertools.combinations(range(SEGMENTS), SEGMENTS // 2)
    by_chance = np.mean([_quietest(density[list(half)]) for half in halves]) - _quietest(density)
    middle = max(_quietest(density) - float(by_chance), 0.0)
    without = np.array([_quietest(np.delete(density, part, axis=0)) for part in range(SEGMENTS)])
    half = STUDENT * math.sqrt((SEGMENTS - 1.0) * without.var())
    low, high = max(middle - half, 0.0), middle + half
    return math.sqrt(low), math.sqrt(middle), math.sqrt(high)


def _quietest(density: FloatArray) -> float:
    """Mean over parts of the density, (parts, n), in the bands that are quietest in the others."""
    others = density.sum(axis=0) - density
    quiet = others <= np.quantile(others, _QUIETEST, axis=1, keepdims=True)
    return float(np.mean([part[where].mean() for part, where in zip(density, quiet, strict=True)]))


def resonances(x: FloatArray, sample_rate: float) -> list[Resonance]:
    """
    Return the resonances of a record, strongest first.

    Covariance-driven stochastic subspace identification (Peeters and De Roeck, Mech. Syst. Signal
    Process. 1999, 13, 855): the autocorrelation of resonances that noise excites is a sum of their
    free decays. Lag zero, which contains the noise of the sensor, is left out.

    Examples
    --------
    Noise through a resonance at 3 kHz with a damping ratio of 0.03:

    >>> from scipy import signal
    >>> rng = np.random.default_rng(1)
    >>> pole = np.exp(2 * np.pi * 3000 / 25600 * (-0.03 + 1j))
    >>> denominator = np.poly([pole, pole.conjugate()]).real
    >>> found = resonances(signal.lfilter([1.0], denominator, rng.standard_normal(102400)), 25600)
    >>> round(found[0].hz, -2), round(found[0].damping, 2)
    (3000.0, 0.03)

    """
    order = max(8, round(MODES_REACH_S * sample_rate))
    correlation = fft.irfft(_power(x))[: 2 * order + 1]
    hankel = scipy.linalg.hankel(correlation[1 : order + 1], correlation[order : 2 * order])
    left, strength, _ = scipy.linalg.svd(hankel)
    rank = min(_MOST_POLES, int((strength > _LEAST_STRENGTH * strength[0]).sum()))
    if strength[0] <= 0.0 or rank < 2:
        return []
    shift = scipy.linalg.lstsq(left[:-1, :rank], left[1:, :rank])[0]
    poles = scipy.linalg.eigvals(shift)
    lags = np.arange(1, 2 * order + 1)
    amplitudes = scipy.linalg.lstsq(poles[None, :] ** lags[:, None], correlation[1:])[0]
    upper = (poles.imag > 1e-9) & (np.abs(poles) < 1.0)
    poles, amplitudes = poles[upper], amplitudes[upper]
    log = np.log(poles)
    damping = -log.real / np.abs(log)
    hz = np.abs(log) * sample_rate / (2.0 * math.pi)
    share = 2.0 * amplitudes.real / correlation[0]
    keep = (
        (damping < 0.15) & (damping >= LINE_DAMPING) & (share > _SHARE_OF_POWER)
        & (hz < 0.43 * sample_rate)
    )  # fmt: skip
    strongest = [at for at in np.argsort(-share) if keep[at]][:MOST_MODES]
    return [Resonance(float(hz[i]), float(damping[i]), float(share[i])) for i in strongest]
