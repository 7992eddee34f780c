# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Segments: about a second of vibration, demodulated once for all windows that contain it.

A window consists of segments that overlap a little. Their ends fade as sine and cosine, so the
squared envelopes of neighbours add up to the envelope of the whole.
"""

from __future__ import annotations

from dataclasses import dataclass
import functools
import math
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import fault_orders, PLACES
from bearing_twin.diagnosis.signal.bands import band_tree, BandTree, squared_envelopes
from bearing_twin.diagnosis.signal.drift import without_drift
from bearing_twin.diagnosis.signal.gate import DAMPING, HIGHEST_RINGING_HZ, SHAFT_TURNS
from bearing_twin.diagnosis.signal.impulsive_outliers import limit_impulsive_outliers
from bearing_twin.diagnosis.signal.severity import Levels, moments
from bearing_twin.diagnosis.signal.spectra import line_cap, line_powers, transform, whiten
from bearing_twin.diagnosis.thresholds import HARMONICS, KURTOSIS
import numpy as np
from numpy.typing import NDArray
from scipy import fft

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


SECONDS = 1.0
"""Least length of a segment, s, if the window is as long."""

_REACH = 0.5 / DAMPING
"""Highest upper edge of a band, in its widths: there a resonance is as wide, at half power."""
_TREE_DEPTH, _NARROW_HZ = 3, HIGHEST_RINGING_HZ / _REACH
"""Halvings of the range down to the narrowest bands, and their width, Hz, above 25.6 kHz. Faster
sampling has more halvings to keep it: a wider band has more noise and no more ringing."""
_LAP, _LONGEST_LAP = 0.05, 0.25
"""Least and largest overlap with the previous segment, as a part of the hop."""
_CLASSES, _RATE_CLASSES = 4, 16
"""Speed classes in an octave: a layout belongs to a class, not to each speed. The classes for the
rate of the envelope are narrow, because a higher rate than needed costs time."""
_OVERSAMPLED, _ANGULAR = 1.03, 1.7
"""Rate of the envelope points over twice the highest frequency; larger for points that are
interpolated over angle."""


@functools.lru_cache(maxsize=64)
def highest_fault_order(bearing: Bearing) -> float:
    """
    Return the highest fault order.

    >>> from bearing_twin.bearing import find_bearing
    >>> round(highest_fault_order(find_bearing('6205')), 3)
    5.415

    """
    orders = fault_orders(bearing)
    return max(orders.impacts(name) for name in PLACES)


def highest_order(bearing: Bearing) -> float:
    """
    Return the highest order of the analysis: four harmonics of the highest fault, with slip.

    >>> from bearing_twin.bearing import find_bearing
    >>> round(highest_order(find_bearing('6205')), 2)
    23.83

    """
    return 1.1 * HARMONICS * highest_fault_order(bearing)


class Layout(NamedTuple):
    """Lengths and settings of the demodulation. Segments of one layout can be joined."""

    sample_rate: float
    hop: int
    """Samples from one segment to the next."""
    lap: int
    """Overlap with the previous segment, samples; the length of a segment is hop + lap."""
    step: int
    """Samples from one envelope point to the next; hop and lap are multiples of it."""
    floor_width: int
    """Bins in a block of the floor of the spectrum."""
    cap: float
    """Power over the floor at which lines are capped."""
    cage_hz: float
    tree: BandTree


class Flat(NamedTuple):
    """Samples of a segment with lines capped; few verdicts use them."""

    spectrum: NDArray[np.complex64]
    """One-sided."""
    length: int
    """Number of samples of the segment."""
    inside: slice
    """Samples that do not fade."""

    def kurtosis(self) -> float:
        """Return the kurtosis of the samples that do not fade."""
        return _kurtosis(fft.irfft(self.spectrum, n=self.length)[self.inside])


@dataclass(frozen=True, kw_only=True)
class Segment:
    """Results of the demodulation of a segment."""

    envelopes: tuple[NDArray[np.float32], ...]
    """Squared envelopes from :func:`squared_envelopes`, ((lap + hop) / step, n) each; their ends
    fade."""
    slow: NDArray[np.float32]
    """((lap + hop) / step,) low-passed signal over its RMS; its ends fade."""
    lines: NDArray[np.float32]
    """Squared one-sided amplitude spectrum, bin k at k sample_rate / (hop + lap)."""
    levels: Levels
    limited_kurtosis: float
    """Kurtosis of the samples with single shocks limited."""
    flat: Flat | None
    """Whitened samples, if ``limited_kurtosis`` is above ``KURTOSIS``."""

    @functools.cached_property
    def kurtosis(self) -> float:
        """
        Kurtosis with single shocks limited; above ``KURTOSIS``, at most that of whitened samples.

        Whitening caps lines, and so the steady pulses of belts and cams.
        """
        return min(self.limited_kurtosis, self.flat.kurtosis() if self.flat else math.inf)


@functools.lru_cache(maxsize=64)
def _speed_class(shaft_hz: float, classes: int = _CLASSES) -> int:
    """
    Return the class of a shaft speed, Hz; classes are a quarter of an octave wide by default.

    >>> _speed_class(25.0), _speed_class(25.4), _speed_class(50.0)
    (19, 19, 23)

    """
    return math.ceil(classes * math.log2(shaft_hz))


def choose_layout(
    sample_rate: float,
    stretch: int,
    count: int,
    bearing: Bearing,
    shaft_hz: float,
    fastest_hz: float = 0.0,
) -> Layout:
    """
    Return the layout of the segments of a window.

    Parameters
    ----------
    sample_rate
        Hz.
    stretch, count
        The window has ``count`` stretches of ``stretch`` samples; a segment has one or more of
        them.
    bearing
        Geometry.
    shaft_hz
        Mean speed, Hz.
    fastest_hz
        Highest speed if the speed varies, Hz, else 0.

    >>> from bearing_twin.bearing import find_bearing
    >>> layout = choose_layout(25600.0, 25600, 8, find_bearing('6307'), 25.0)
    >>> layout.hop, layout.step, layout.lap / layout.step
    (25600, 20, 64.0)

    """
    top = _speed_class(_ANGULAR * fastest_hz if fastest_hz else shaft_hz, _RATE_CLASSES)
    return _layout(sample_rate, stretch, count, bearing, _speed_class(shaft_hz), top)


@functools.lru_cache(maxsize=64)
def _layout(
    sample_rate: float, stretch: int, count: int, bearing: Bearing, turning: int, top: int
) -> Layout:
    shaft_hz = 2.0 ** ((turning - 0.5) / _CLASSES)
    narrowest_hz = highest_order(bearing) * 2.0 ** ((turning - 1) / _CLASSES)
    highest_hz = highest_order(bearing) * 2.0 ** (top / _RATE_CLASSES)
    least = max(SECONDS, SHAFT_TURNS / shaft_hz) * sample_rate
    parts = (k for k in range(1, count + 1) if count % k == 0)
    hop = stretch * next((k for k in parts if k * stretch >= 0.98 * least), count)
    most = max(int(sample_rate / (2.0 * _OVERSAMPLED * highest_hz)), 1)
    step = next(s for s in range(most, 0, -1) if stretch % s == 0)
    depth = max(_TREE_DEPTH, round(math.log2(0.5 * sample_rate / _NARROW_HZ)))
    lap = _lap(hop, step, 4 << depth)
    length = hop + lap
    bin_hz = sample_rate / length
    return Layout(
        sample_rate=sample_rate,
        hop=hop,
        lap=lap,
        step=step,
        floor_width=max(int(8.0 * shaft_hz / bin_hz), 64),
        cap=line_cap(hop / sample_rate * shaft_hz),
        cage_hz=fault_orders(bearing).ftf * shaft_hz,
        tree=band_tree(length // 2, bin_hz, depth=depth, narrowest_hz=narrowest_hz, reach=_REACH),
    )


def _lap(hop: int, step: int, tiles: int) -> int:
    """Return an overlap with a quick length of transform, if possible one that fits the tiles."""
    points = hop // step
    lengths = range(math.ceil((1.0 + _LAP) * points), int((1.0 + _LONGEST_LAP) * points) + 1)
    quick = [n for n in lengths if fft.next_fast_len(n) == n]
    tiled = (n for n in quick if n * step % tiles == 0)
    return step * (next(tiled, quick[0] if quick else lengths[0]) - points)


def demodulate(x: NDArray[np.float64], layout: Layout) -> Segment:
    """
    Return a segment, demodulated.

    Parameters
    ----------
    x
        Finite samples, shape (n,): those of the lap, as far as there are any, then ``hop``
        samples.
    layout
        Layout.

    >>> from bearing_twin.bearing import find_bearing
    >>> layout = choose_layout(25600.0, 25600, 8, find_bearing('6307'), 25.0)
    >>> segment = demodulate(np.random.default_rng(0).standard_normal(25600), layout)
    >>> [part.shape for part in segment.envelopes]
    [(1344, 16), (1344, 16), (1344, 16), (1344, 4)]

    """
    lap, length, step = layout.lap, layout.hop + layout.lap, layout.step
    fade = _fade(lap)
    plain = without_drift(x)
    spectrum = _spectrum(plain, fade, length)
    power = line_powers(spectrum)
    taper_sum, taper_power = len(x) - 2.0 * lap + 2.0 * fade.sum(), len(x) - lap
    of_noise = np.float32(math.sqrt(length / taper_power))
    levels = Levels.of(x[-layout.hop :], spectrum * of_noise, layout.sample_rate)
    limited = limit_impulsive_outliers(plain, layout.sample_rate, layout.cage_hz)
    scale = np.float32(1.0 / max(math.sqrt(float(power.sum())), 1e-30))
    scaled = (spectrum if limited is plain else _spectrum(limited, fade, length)) * scale
    points = length // step
    slow = fft.irfft(scaled[: points // 2 + 1], n=points, norm='forward')
    ends = fade[::step]
    slow[: len(ends)] *= ends
    slow[-len(ends) :] *= _fade(lap)[::-1][::step]
    white = whiten(scaled, layout.floor_width, cap=layout.cap)
    kurtosis, flat = _kurtosis(limited), None
    if kurtosis > KURTOSIS:
        flat = Flat(white[0].copy(), length, slice(length - len(x) + lap, length - lap))
    return Segment(
        envelopes=tuple(squared_envelopes(white, layout.tree, points)),
        slow=slow,
        lines=power * np.float32((2.0 * length / taper_sum) ** 2),
        levels=levels,
        limited_kurtosis=kurtosis,
        flat=flat,
    )


def _kurtosis(x: NDArray[np.floating]) -> float:
    second, _, fourth = moments(np.asarray(x, np.float64), 0.0)
    return fourth / len(x) / max((second / len(x)) ** 2, 1e-300)


def _spectrum(
    x: NDArray[np.float64], fade: NDArray[np.float32], length: int
) -> NDArray[np.complex64]:
    """Return the one-sided transform of samples with fading ends and zeros before them."""
    padded = np.zeros(length, np.float32)
    part = padded[length - len(x) :]
    part[:] = x
    part[: len(fade)] *= fade
    part[-len(fade) :] *= fade[::-1]
    padded *= np.float32(1.0 / length)
    return transform(padded)


@functools.lru_cache(maxsize=256)
def _fade(lap: int) -> NDArray[np.float32]:
    """Return the rise at the start of a segment; its square and its mirror image's add to one."""
    fade = np.sin(0.5 * np.pi * (np.arange(lap) + 0.5) / lap).astype(np.float32)
    fade.flags.writeable = False
    return fade
