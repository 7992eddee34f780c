# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Measures of a simulated record: peaks, spectra and their lines."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.fft import next_fast_len
from scipy.signal import hilbert

FloatArray = npt.NDArray[np.float64]


def peak_near(
    time: FloatArray, acceleration: FloatArray, instant: float, reach: float
) -> tuple[float, float]:
    """Time (s) and height (m/s^2) of the largest |a - mean(a)| within ``instant +- reach``."""
    rows = np.flatnonzero(np.abs(time - instant) <= reach)
    deviation = np.abs(acceleration[rows] - acceleration.mean())
    top = int(deviation.argmax())
    return float(time[rows[top]]), float(deviation[top])


def spectrum(signal: FloatArray, rate: float) -> tuple[FloatArray, FloatArray]:
    """Frequencies (Hz) and amplitudes of a signal less its mean, Hann window."""
    window = np.hanning(len(signal))
    scale = 2.0 / window.sum()
    values = np.abs(np.fft.rfft((signal - signal.mean()) * window)) * scale
    return np.asarray(np.fft.rfftfreq(len(signal), 1.0 / rate)), np.asarray(values)


def envelope_spectrum(acceleration: FloatArray, rate: float) -> tuple[FloatArray, FloatArray]:
    """Amplitude spectrum of the Hilbert envelope, the demodulation of section 2 (5)."""
    return spectrum(np.abs(hilbert(acceleration - acceleration.mean())), rate)


def line_contrast(frequency: FloatArray, values: FloatArray, line: float) -> float:
    """Height of a line over the median of the spectrum from 5 to 300 Hz, dimensionless."""
    step = frequency[1]
    here = np.abs(frequency - line) <= 1.5 * step
    floor = np.median(values[(frequency >= 5.0) & (frequency <= 300.0)])
    return float(values[here].max() / floor)


def line_frequency(acceleration: FloatArray, rate: float, near: float) -> float:
    """
    Frequency of an envelope line, Hz, from its first three harmonics, interpolated between bins.

    The envelope is padded fourfold; the maximum within 2.5 Hz of each harmonic is refined by
    a parabola through the logarithms and weighted by (order x amplitude)^2. Notable: with a
    load zone the line has neighbours at 2 f_in - 5 f_r and 5 f_r, 0.66 Hz away for the paper's
    bearing. Records shorter than about 5 s do not separate them and are off by up to 0.1 Hz.
    """
    envelope = np.abs(hilbert(acceleration - acceleration.mean()))
    size = next_fast_len(4 * len(envelope), real=True)
    windowed = (envelope - envelope.mean()) * np.hanning(len(envelope))
    transform = np.fft.rfft(windowed, size)
    step = rate / size
    total = weighted = 0.0
    for order in (1, 2, 3):
        low, high = (int((order * near + side) / step) for side in (-2.5, 2.5))
        top = low + int(np.abs(transform[low:high]).argmax())
        heights = np.abs(transform[top - 1 : top + 2])
        left, middle, right = np.log(heights)
        offset = 0.5 * (left - right) / (left - 2.0 * middle + right)
        weight = (order * heights[1]) ** 2
        weighted += weight * (top + offset) * step / order
        total += weight
    return float(weighted / total)
