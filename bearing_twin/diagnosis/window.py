# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Analysis of one window of vibration, before the rules are applied."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
import statistics
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.combs.comb import modulation_index, order_spectra, OrderSpectra
from bearing_twin.diagnosis.combs.passages import ball_passages
from bearing_twin.diagnosis.result import Spectrum
from bearing_twin.diagnosis.signal.demodulation import highest_order
from bearing_twin.diagnosis.signal.periodogram import OverlappingParts, power_of_lines
from bearing_twin.diagnosis.signal.severity import Levels, measure_severity
from bearing_twin.diagnosis.signal.shaft import refine_shaft_hz, resample, ShaftSpeed
from bearing_twin.diagnosis.signal.spectra import (
    envelope_spectra,
    line_powers,
    local_floor,
    transform,
)
from bearing_twin.numerics.vector import L
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.settings import DiagnosisSettings
    from bearing_twin.diagnosis.signal.demodulation import Layout, Segment
    from bearing_twin.diagnosis.signal.severity import Severity
    from bearing_twin.diagnosis.signal.shaft import SpeedProfile
    from bearing_twin.diagnosis.signal.spectra import EnvelopeSpectra


@dataclass(frozen=True)
class LowPassed:
    """Low-passed signal of a window; at an exact speed nothing needs its spectrum."""

    signal: OverlappingParts
    equal_angles: NDArray[np.float64] | None = None
    """Positions of equal shaft angles, points; None if the speed is steady."""

    @cached_property
    def power(self) -> NDArray[np.float32]:
        """
        Power spectrum, bin k at k over the length of the window in seconds.

        >>> LowPassed(OverlappingParts([np.ones(8, np.float32)])).power.tolist()
        [64.0, 0.0, 0.0, 0.0, 0.0]

        """
        joined = self.signal.joined()
        if self.equal_angles is not None:
            joined = resample(joined, self.equal_angles)
        return line_powers(transform(joined))


@dataclass(frozen=True, kw_only=True)
class Window:
    """Analysis of one window, before any decision."""

    bearing: Bearing
    orders: OrderSpectra
    speed: ShaftSpeed
    bands: list[tuple[float, float]]
    envelopes: EnvelopeSpectra
    amplitude: NDArray[np.float32]
    """One-sided amplitude spectrum in the signal's unit, bin k at k bin_hz."""
    bin_hz: float
    severity: Severity
    seconds: float
    low: LowPassed
    segments: Sequence[Segment]
    """Segments of the window, oldest first."""
    lap: int
    """Overlap of a segment with the next, envelope points."""
    equal_angles: NDArray[np.float64] | None
    """Positions of equal shaft angles, envelope points; None if the speed is steady."""

    @property
    def revolutions(self) -> float:
        """Return the turns of the shaft in the window."""
        return self.seconds * self.speed.shaft_hz

    def spectrum(self, sample_rate: float) -> Spectrum:
        """Return the spectrum for pictures; ``sample_rate`` in Hz."""
        values, first_hz, step_hz = coarse_spectrum(self.amplitude, self.bin_hz)
        return Spectrum(
            unit=self.severity.unit,
            start_hz=first_hz,
            bin_hz=step_hz,
            band=(0.0, 0.5 * sample_rate),
            values=values,
        )

    def envelope_spectrum(self, band: int) -> Spectrum:
        """Return the squared envelope spectrum of a band, with its floor."""
        return Spectrum(
            kind='squared_envelope_spectrum',
            unit='1',
            start_hz=self.envelopes.bin_hz,
            bin_hz=self.envelopes.bin_hz,
            band=self.bands[band],
            values=self.envelopes.power[band],
            floor=self.envelopes.floor(band),
        )

    def kurtosis(self) -> float:
        """Return the median kurtosis of the segments, single shocks limited."""
        return statistics.median_low(segment.kurtosis for segment in self.segments)

    @cached_property
    def ball_passages(self) -> float:
        """Significance of a ball's impacts in groups, in the narrow capped bands."""
        count = len(self.bands)
        first = count - (count + 1) // 2
        parts = [
            np.concatenate(
                [
                    group[:, max(first - before, 0) : count - before]
                    for before, group in zip(range(0, count, L), each.envelopes, strict=False)
                ],
                axis=1,
            )
            for each in self.segments
        ]
        joined = OverlappingParts(parts, self.lap).joined()
        if self.equal_angles is not None:
            joined = resample(joined, self.equal_angles)
        return ball_passages(joined, self.revolutions, self.bearing)

    def index_by_power(self, order: float, band: tuple[float, float]) -> float:
        """Return the modulation index of a comb in a band, Hz, with segments weighted by power."""
        first, end = (round(edge / self.bin_hz) for edge in band)
        powers = np.array([each.lines[first:end].sum() for each in self.segments])
        powers /= max(powers.mean(), 1e-30)
        group, column = divmod(self.bands.index(band), L)
        parts = (each.envelopes[group][:, column : column + 1] for each in self.segments)
        weighed = [part * power for part, power in zip(parts, powers, strict=True)]
        whole = OverlappingParts(weighed, self.lap)
        if self.equal_angles is not None:
            whole = OverlappingParts([resample(whole.joined(), self.equal_angles)])
        lines = np.empty((len(self.orders.excess), 1), np.float32)
        power_of_lines(whole, lines, 0)
        floor = local_floor(lines.T, 2 * self.envelopes.hop).T
        above = replace(self.orders, excess=np.maximum(lines - floor, np.float32(0.0)))
        return modulation_index(above.comb_powers(np.array([order]), 0)[0])


def coarse_spectrum(
    amplitude: NDArray[np.float32], bin_hz: float
) -> tuple[NDArray[np.float32], float, float]:
    """
    Return the largest amplitude in each group of bins about 1 Hz wide: lines keep their height.

    For pictures and trends; the decision uses the full resolution.

    Parameters
    ----------
    amplitude
        One-sided amplitude spectrum, bin k at k bin_hz, shape (K,).
    bin_hz
        Hz.

    Returns
    -------
    Amplitudes, the middle of the first group and the spacing of the groups, Hz. Bins wider than
    2/3 Hz are returned as they are.

    >>> amplitude = np.array([1.0, 0.0, 5.0, 0.0, 2.0, 0.0, 0.0, 3.0], np.float32)
    >>> values, first_hz, step_hz = coarse_spectrum(amplitude, 0.25)
    >>> values.tolist(), first_hz, step_hz
    ([5.0, 3.0], 0.375, 1.0)

    """
    group = max(round(1.0 / bin_hz), 1)
    count = -(-len(amplitude) // group)
    padded = np.zeros(count * group, dtype=np.float32)
    padded[: len(amplitude)] = amplitude
    # Along columns: numpy is slow at the maximum of a few neighbours.
    highest = np.ascontiguousarray(padded.reshape(count, group).T).max(axis=0)
    return highest, 0.5 * (group - 1) * bin_hz, group * bin_hz


def analyse_window(
    segments: Sequence[Segment],
    layout: Layout,
    bearing: Bearing,
    speed_profile: SpeedProfile,
    settings: DiagnosisSettings,
    *,
    unit: str = '',
) -> Window:
    """
    Return the analysis of one window, before windows are averaged and judged.

    The segments are in order of time, oldest first; ``speed_profile`` is the shaft's speed.

    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.diagnosis.signal.demodulation import choose_layout, demodulate
    >>> from bearing_twin.diagnosis.settings import DiagnosisSettings
    >>> from bearing_twin.diagnosis.signal.shaft import SpeedProfile
    >>> noise, bearing = np.random.default_rng(0).standard_normal(51200), find_bearing('6307')
    >>> layout = choose_layout(25600.0, 51200, 1, bearing, 25.0)
    >>> profile = SpeedProfile(np.array([25.0]), np.array([51200]))
    >>> segments = [demodulate(noise, layout)]
    >>> window = analyse_window(segments, layout, bearing, profile, DiagnosisSettings())
    >>> window.revolutions, round(window.severity.rms, 1)
    (50.0, 1.0)
    """
    lap, bands = layout.lap // layout.step, layout.tree.bands
    slow = OverlappingParts([segment.slow for segment in segments], lap)
    points = slow.shape[0]
    parts = zip(*(segment.envelopes for segment in segments), strict=True)
    envelopes = (OverlappingParts(part, lap) for part in parts)
    shaft_hz, at = speed_profile.mean_hz, None
    if speed_profile.varies:
        at = speed_profile.equal_angles(points) / layout.step
        envelopes = (OverlappingParts([resample(part.joined(), at)]) for part in envelopes)
    rate = layout.sample_rate / layout.step
    bin_hz = rate / points
    spectra = envelope_spectra(
        envelopes,
        rate,
        bands=len(bands),
        max_hz=highest_order(bearing) * shaft_hz,
        floor_width=max(int(4.0 * shaft_hz / bin_hz), 32),
    )
    low = LowPassed(slow, at)
    speed = ShaftSpeed(shaft_hz)
    if settings.speed_tolerance:
        speed = refine_shaft_hz(low.power, bin_hz, spectra, shaft_hz, settings.speed_tolerance)
    power_sum = segments[0].lines.copy()
    for segment in segments[1:]:
        power_sum += segment.lines
    return Window(
        bearing=bearing,
        orders=order_spectra(spectra, bands, speed.shaft_hz, shaft_hz),
        speed=speed,
        bands=bands,
        envelopes=spectra,
        amplitude=np.sqrt(power_sum / np.float32(len(segments))),
        bin_hz=layout.sample_rate / (layout.hop + layout.lap),
        severity=measure_severity(
            Levels.together([segment.levels for segment in segments]),
            unit=unit or settings.unit,
            power_group=settings.power_group,
            mounting=settings.mounting,
            shaft_hz=shaft_hz,
        ),
        seconds=1.0 / bin_hz,
        low=low,
        segments=segments,
        lap=lap,
        equal_angles=at,
    )
