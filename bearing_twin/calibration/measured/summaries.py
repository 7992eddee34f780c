# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Summaries of the impacts in a vibration that do not depend on gain and resonances of the path.

A linear prediction over about a millisecond whitens the signal. This removes the ringing of the
path and leaves the impacts (Sawalhi and Randall, Mech. Syst. Signal Process. 2011, 25, 846). The
autocorrelation of its squared envelope has a peak at the time between the impacts of a passage.
"""

from __future__ import annotations

from dataclasses import dataclass
import math

import numpy as np
import numpy.typing as npt
import scipy
from scipy import fft

FloatArray = npt.NDArray[np.float64]

MEMORY_S = 1.2e-3
"""Reach of the linear prediction, s. Ringing at 2 kHz with a damping of 4 % falls to half in it,
and it is too short to predict the second of two impacts that are some mm apart."""
TAPERED = 0.1
"""Share of a record that is tapered at its ends for the spectrum of the prediction."""
LOW_SHARE, HIGH_SHARE = 0.04, 0.86
"""Band of the envelope over half the sample rate: above the lines of shaft and gears, below the
flank of the anti-aliasing filter."""
RINGS_DB = 6.0
"""Least prominence of a resonance in the spectrum of a prediction, dB."""
_FREQUENCIES = 8192
_WITHIN = 0.75
"""Reach of this prediction over the time between two impacts: see `fastest_resonance`."""
SIGNIFICANT = 10.0
"""Least prominence of a peak over the scatter of the autocorrelation where it has none. Noise
reaches 8 from trough to peak among some hundred lags."""
CLEAR = 3.6
"""Shortest lag of a peak over the half width of the peak at zero. At shorter lags, the sides of
that peak look like second impacts."""
FAINTEST = 0.015
"""Least prominence of a peak: a second impact of an eighth of the energy of the first."""
RESOLVED = 8.0
"""Shortest spacing that is distinguished from ringing or rebound of one impact, over the half
width of an impact after whitening. Set on one rig only, CWRU: its faults of 0.2 to 0.5 mm leave a
second impact 5 to 6 half widths after the first, at a time that does not follow the speed."""
RIVAL = 0.25
"""Largest prominence of a second spacing over that of the first. Set on CWRU, like
`RESOLVED`: spots of 0.18 mm leave a second impact after 2.0 ms at any speed, and another
one a third as prominent."""
ELSEWHERE = 1.25
"""Least ratio of two lags that count as different spacings: one peak may be double."""


@dataclass(frozen=True, kw_only=True)
class Correlation:
    """Autocorrelation of the squared envelope of a whole whitened record."""

    values: FloatArray
    """Autocorrelation, 1 at zero lag, circular, shape (n,)."""
    rate: float
    """Lags per second, Hz."""
    impulsiveness: float

    def highest(self, lag: float, reach: float) -> tuple[float, float]:
        """
        Return where the autocorrelation is highest near a lag, s, and its height over the median.

        Parameters
        ----------
        lag
            Centre of the search, s.
        reach
            Half width of the search, s. The median is over six times as much.

        """
        at, near = lag * self.rate, max(2.0, reach * self.rate)
        first = max(1, int(at - near))
        values = self.values[first : int(at + near) + 2]
        about = self.values[max(1, int(at - 6.0 * near)) : int(at + 6.0 * near) + 2]
        highest = int(np.argmax(values))
        return (first + highest) / self.rate, float(values[highest] - np.median(about))

    def summary(self, longest: float) -> Summary:
        """Summarise the lags up to ``longest``, s."""
        rate = self.rate
        last = min(int(longest * rate) + 1, len(self.values) // 4)
        near, beyond = self.values[:last], self.values[last : 2 * last]
        beyond = beyond - scipy.ndimage.uniform_filter1d(beyond, max(3, len(beyond) // 16))
        scatter = 1.4826 * float(np.median(np.abs(beyond)))
        half_at = int(np.argmax(near < 0.5)) or 1
        above, below = near[half_at - 1], near[half_at]
        lobe = (half_at - 1 + (above - 0.5) / max(above - below, 1e-9)) / rate
        spacing, prominence, rival, rivals = _peak(near, scatter, rate, CLEAR * lobe)
        return Summary(
            lag=np.arange(last) / rate,
            correlation=near,
            spacing=spacing,
            prominence=prominence,
            rival=rival,
            rivals=rivals,
            lobe=float(lobe),
            impulsiveness=self.impulsiveness,
            scatter=scatter,
        )


@dataclass(frozen=True, kw_only=True)
class Summary:
    """Autocorrelation of the squared envelope of the whitened signal, and its peaks."""

    lag: FloatArray
    """Lags, s, shape (n,)."""
    correlation: FloatArray
    """Autocorrelation, 1 at zero lag, shape (n,)."""
    spacing: float
    """Lag of the clearest peak beside zero, s; NaN if none is significant."""
    prominence: float
    """Prominence of that peak; 0 if there is none."""
    rival: float
    """Prominence of the clearest other peak, also at shorter lags, over that; 0 if none."""
    rivals: tuple[float, ...]
    """Other lags with a peak more than `RIVAL` as prominent, s."""
    lobe: float
    """Lag at which the peak at zero has fallen to half, s."""
    impulsiveness: float
    """log10 of the mean square of the squared envelope over the squared mean; 0.3 for noise."""
    scatter: float
    """Standard deviation of the autocorrelation where it has no peak."""

    @property
    def shows_two_impacts(self) -> bool:
        """Whether a passage shows two impacts."""
        return math.isfinite(self.spacing)

    @property
    def resolved(self) -> float:
        """
        Shortest spacing of two impacts that is distinguished from ringing of one, s.

        >>> noise = np.random.default_rng(1).standard_normal(25600)
        >>> summarise(noise, 12800.0, 5e-3).resolved < 1e-3
        True

        """
        return RESOLVED * self.lobe

    @property
    def longest_unresolved_spacing(self) -> float:
        """
        Longest spacing that a passage may have if none can be determined, s.

        >>> noise = np.random.default_rng(1).standard_normal(25600)
        >>> measured = summarise(noise, 12800.0, 5e-3)
        >>> measured.longest_unresolved_spacing >= measured.resolved
        True

        """
        seen = (self.spacing, *self.rivals) if self.shows_two_impacts else ()
        return max(self.resolved, *seen, 0.0)

    def repetitions(self) -> tuple[FloatArray, FloatArray]:
        """Return the lags of all peaks beside zero, s, and their prominences."""
        peaks, found = scipy.signal.find_peaks(self.correlation, prominence=FAINTEST / 4.0)
        return self.lag[peaks], found['prominences']

    def significant(self, prominence: float) -> bool:
        """Whether a peak is more than chance."""
        return prominence >= max(SIGNIFICANT * self.scatter, FAINTEST)


def levinson(power: FloatArray, order: int) -> tuple[FloatArray, float]:
    """
    Return the prediction error filter of a signal with a power spectrum, and the error's power.

    The Yule-Walker equations are solved by Levinson's recursion.

    Parameters
    ----------
    power
        One-sided spectrum of `scipy.fft.rfft`, shape (n,).
    order
        Number of coefficients after the first, which is 1.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> x = scipy.signal.lfilter([1.0], [1.0, -0.5], rng.standard_normal(20000))
    >>> levinson(np.abs(fft.rfft(x)) ** 2 / len(x), 2)[0].round(1) + 0.0
    array([ 1. , -0.5,  0. ])

    """
    correlation = fft.irfft(power)[: order + 1]
    # A millionth of white noise keeps the equations of a band-limited signal solvable.
    correlation[0] *= 1.0 + 1e-6
    if correlation[0] <= 0.0:
        return np.eye(1, order + 1)[0], 0.0
    solved = scipy.linalg.solve_toeplitz(correlation[:order], correlation[1 : order + 1])
    error = float(correlation[0] - solved @ correlation[1 : order + 1])
    return np.concatenate(([1.0], -solved)), error


def squared_envelope(x: FloatArray, sample_rate: float) -> tuple[FloatArray, float]:
    """
    Return the squared envelope of a signal after whitening, and its sample rate, Hz.

    Examples
    --------
    >>> envelope, rate = squared_envelope(np.random.default_rng(1).standard_normal(25600), 25600.0)
    >>> bool(abs(envelope.std() / envelope.mean() - 1.0) < 0.05)
    True

    """
    x = x - x.mean()
    # Not circular: the jump from the end of a record to its start would look like an impact.
    whitened = scipy.signal.oaconvolve(x, _prediction(x, sample_rate, MEMORY_S), 'valid')
    n = fft.prev_fast_len(len(whitened), real=True)
    spectrum = fft.rfft(whitened[:n])
    half = 0.5 * sample_rate
    low, high = (int(share * half * n / sample_rate) for share in (LOW_SHARE, HIGH_SHARE))
    # A one-sided band gives the analytic signal; room for twice the band holds its square.
    size = fft.next_fast_len(2 * (high - low))
    # The taper lowers the side lobes of an impact.
    taper = scipy.signal.windows.tukey(high - low, 0.5)
    envelope = np.abs(fft.ifft(taper * spectrum[low:high], size)) ** 2
    return envelope, size * sample_rate / n


def _prediction(x: FloatArray, sample_rate: float, reach: float) -> FloatArray:
    """Return the error filter of a linear prediction over ``reach``, s."""
    tapered = scipy.signal.windows.tukey(len(x), TAPERED) * x
    power = np.abs(fft.rfft(tapered, fft.next_fast_len(len(x), real=True))) ** 2
    return levinson(power, max(8, round(reach * sample_rate)))[0]


def fastest_resonance(x: FloatArray, sample_rate: float, spacing: float) -> float:
    """
    Return the highest resonance frequency that the impacts of a signal excite, Hz; NaN if none.

    The signal has zero mean. The resonances are peaks in the spectrum of a linear prediction of
    the jerk, in which the resonance of the rotor on its balls is weaker. The prediction is shorter
    than the time between two impacts, ``spacing``, s: otherwise the harmonics of the pair look
    like resonances. For 160 simulated pairs 0.3 to 2 ms apart, half of them beside a rotor that
    rings below 1 kHz, 142 frequencies are right within a tenth and one is too high.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> impacts = 1e-3 * rng.standard_normal(25600)
    >>> impacts[200:25000:700] += 1.0
    >>> impacts[230:25030:700] -= 0.7
    >>> pole = np.exp(2 * np.pi * 3000 / 25600 * (-0.03 + 1j))
    >>> denominator = np.poly([pole, pole.conjugate()]).real
    >>> rung = scipy.signal.lfilter([1.0], denominator, impacts)
    >>> round(fastest_resonance(rung, 25600.0, 30 / 25600), -2)
    3000.0

    """
    error = _prediction(np.diff(x), sample_rate, min(MEMORY_S, _WITHIN * spacing))
    decibels = -20.0 * np.log10(np.abs(fft.rfft(error, _FREQUENCIES)))
    hertz = sample_rate / _FREQUENCIES * scipy.signal.find_peaks(decibels, prominence=RINGS_DB)[0]
    low, high = 0.5 * LOW_SHARE * sample_rate, 0.5 * HIGH_SHARE * sample_rate
    return max((float(at) for at in hertz if low < at < high), default=math.nan)


def likeness(x: FloatArray, sample_rate: float, measured: Summary) -> float:
    """
    Return how alike two impacts are: 1 if the second is a copy of the first, 0.2 for an inverse.

    It is the greatest autocorrelation of the whitened signal near the time between the impacts,
    over the value for copies. If the second is a times as high, copies have a / (1 + a^2), and
    their squared envelope a^2 / (1 + a^4), the prominence p. The value for copies is therefore
    sqrt(p / (1 + 2 p)) for any a. Noise lowers it.

    The samples have zero mean, and ``measured`` has a second impact.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> for sign in (1.0, -1.0):
    ...     x = 1e-3 * rng.standard_normal(25600)
    ...     x[200:25000:700] += 1.0
    ...     x[251:25051:700] += 0.7 * sign
    ...     print(round(likeness(x, 25600.0, summarise(x, 25600.0, 4e-3)), 1))
    1.0
    0.2

    """
    whitened = scipy.signal.oaconvolve(x, _prediction(x, sample_rate, MEMORY_S), 'valid')
    power = np.abs(fft.rfft(whitened, 2 * len(whitened))) ** 2
    low, high = (int(share * len(whitened)) for share in (LOW_SHARE, HIGH_SHARE))
    power[:low] = power[high:] = 0.0
    first, last = (
        int((measured.spacing + side * measured.lobe) * sample_rate) for side in (-1.0, 1.0)
    )
    correlation = fft.irfft(power)[: last + 2]
    found = correlation[max(first, 1) :].max() / max(correlation[0], 1e-300)
    return float(found * math.sqrt(2.0 + 1.0 / measured.prominence))


def correlate(x: FloatArray, sample_rate: float) -> Correlation:
    """
    Return the autocorrelation of the squared envelope of a vibration.

    Examples
    --------
    >>> found = correlate(np.random.default_rng(1).standard_normal(25600), 25600.0)
    >>> round(float(found.values[0]), 6), round(found.impulsiveness, 1)
    (1.0, 0.3)

    """
    envelope, rate = squared_envelope(x, sample_rate)
    size = len(envelope)
    mean = envelope.mean()
    envelope -= mean
    square = float((envelope * envelope).mean())
    if square <= 0.0:
        square = math.inf
    # Circular: the jump at the ends affects one of many passages.
    values = fft.irfft(np.abs(fft.rfft(envelope)) ** 2, size) / (size * square)
    impulsiveness = math.log10(1.0 + square / max(mean * mean, 1e-300))
    return Correlation(values=values, rate=rate, impulsiveness=impulsiveness)


def summarise(x: FloatArray, sample_rate: float, longest: float) -> Summary:
    """
    Summarise a vibration: see `Correlation.summary`.

    Examples
    --------
    Pairs of impacts 2 ms apart that ring at 3 kHz:

    >>> rng = np.random.default_rng(1)
    >>> impacts = 1e-3 * rng.standard_normal(25600)
    >>> impacts[200:25000:700] += 1.0
    >>> impacts[251:25051:700] -= 0.7
    >>> ringing = scipy.signal.lfilter([1.0], [1.0, -1.45, 0.96], impacts)
    >>> round(1e3 * summarise(ringing, 25600.0, 4e-3).spacing, 2)
    1.99

    """
    return correlate(x, sample_rate).summary(longest)


def _peak(
    correlation: FloatArray, scatter: float, rate: float, shortest: float
) -> tuple[float, float, float, tuple[float, ...]]:
    """Return lag and prominence of the clearest peak, its rival over it, and all rivals."""
    peaks, found = scipy.signal.find_peaks(correlation, prominence=FAINTEST / 4.0)
    # A lag below the shortest is no spacing, but a clear peak there is a rival.
    prominences = found['prominences']
    if not len(peaks):
        return math.nan, 0.0, 0.0, ()
    best = int(np.argmax(np.where(peaks > shortest * rate, prominences, 0.0)))
    at = int(peaks[best])
    if at <= shortest * rate or prominences[best] < max(SIGNIFICANT * scatter, FAINTEST):
        return math.nan, 0.0, 0.0, ()
    before, top, after = correlation[at - 1 : at + 2]
    bend = before - 2.0 * top + after
    shift = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
    elsewhere = np.abs(np.log(peaks / at)) > math.log(ELSEWHERE)
    rival = float(np.max(prominences, initial=0.0, where=elsewhere) / prominences[best])
    rivals = tuple((peaks[elsewhere & (prominences > RIVAL * prominences[best])] / rate).tolist())
    return float(at + shift) / rate, float(prominences[best]), rival, rivals
