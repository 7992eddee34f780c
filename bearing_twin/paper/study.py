# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The numerical study: which simulations are run, and what is kept of each."""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import fault_frequencies
from bearing_twin.dynamics.trend import impact_amplitude
from bearing_twin.paper import measures, settings
from bearing_twin.paper.runs import in_parallel, RunSpec, simulate
from bearing_twin.paper.space import Grid, SPACE, STATES
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping


__all__ = [
    'FaultPoint',
    'FrequencyPoint',
    'Study',
    'TrendPoint',
    'Warming',
    'run_study',
]

FloatArray = npt.NDArray[np.float64]

STARTS = 8
"""Starts over one beat of f_in against 5 f_r, to see how much the start decides the amplitude."""
FREQUENCY_SECONDS = 12.0
"""Long enough to separate f_in from 5 f_r, 0.66 Hz away without and 0.18 Hz with slip."""
FREQUENCY_RATE = 25600.0
WINDOW_WIDTH = 2.0e-3
"""Width of equation 8's own window at which the ball spends the falling flank in it, m."""
SMALL_DELTA_MU = 0.001
"""A weight of friction that the paper allows just as well as `settings.DELTA_MU`."""
LITERATURE_LOADS = (500.0, 2000.0)
LITERATURE_WIDTHS = (0.8e-3, 1.6e-3, 2.8e-3)
LITERATURE_DEPTHS = (15e-6, 40e-6)


@dataclass(frozen=True, kw_only=True)
class TrendPoint:
    """One preset, factor and temperature."""

    time: FloatArray
    """s, 0 to 0.7."""
    acceleration: npt.NDArray[np.float32]
    """m/s^2."""
    amplitude: float
    """Of the record from t = 0, m/s^2; see `impact_amplitude`."""
    by_start: FloatArray
    """Amplitude of records of 0.7 s from `STARTS` starts, m/s^2."""
    peak_times: FloatArray
    """Times of the peaks next to `settings.PEAK_TIMES`, s."""
    peak_heights: FloatArray
    """Heights of these peaks, m/s^2."""
    clearance: float
    """Radial clearance in the run, m."""


@dataclass(frozen=True, kw_only=True)
class FrequencyPoint:
    """One preset, slip model and temperature; all three factors act."""

    prescribed: float
    """Ball-pass frequency that the kinematics give, Hz."""
    line: float
    """Envelope line of a record of `FREQUENCY_SECONDS`, Hz."""
    line_short: float
    """Envelope line of its first 0.7 s, Hz."""
    envelope: tuple[FloatArray, FloatArray]
    """Envelope spectrum of the record up to 500 Hz: Hz, m/s^2."""
    acceleration: tuple[FloatArray, FloatArray]
    """Acceleration spectrum of its first 0.7 s up to 3 kHz: Hz, m/s^2."""
    contrast: float
    """Height of the f_in line over the floor of the envelope spectrum."""


@dataclass(frozen=True, kw_only=True)
class FaultPoint:
    """Envelope lines with a defect in one place."""

    contrasts: Mapping[str, float]
    """Height over the floor of the lines f_in, f_out, f_b, 2 f_b, f_c."""


@dataclass(frozen=True, kw_only=True)
class Warming:
    """Two amplitudes of one preset, m/s^2, and what went with them."""

    amplitudes: tuple[float, float]
    """At 20 and at 110 degC."""
    clearances: tuple[float, float]
    """Radial clearance, m."""

    @property
    def change(self) -> float:
        """Relative change of the amplitude."""
        return self.amplitudes[1] / self.amplitudes[0] - 1.0


@dataclass(frozen=True, kw_only=True)
class Study:
    """Everything that was simulated."""

    trends: Mapping[tuple[str, str], tuple[TrendPoint, ...]]
    """By preset and factor, one point a temperature."""
    frequencies: Mapping[tuple[str, str, float], FrequencyPoint]
    """By preset, slip model and temperature."""
    faults: Mapping[str, FaultPoint]
    """By place of the defect."""
    physical: Mapping[str, Warming]
    """In the twin's thermal mode ``'physical'``, by preset."""
    window: Mapping[settings.Factor, float]
    """Relative change of the amplitude from 20 to 110 degC by factor, in `paper` with equation
    8's own window, `WINDOW_WIDTH` wide."""
    ramp: Mapping[str, FloatArray]
    """Amplitude in each tenth of a run in which the temperature goes from 20 to 110 degC in
    proportion to time over ten beats of f_in against 5 f_r, by preset, m/s^2, shape (10,)."""
    forgotten: Mapping[str, float]
    """Relative difference of the amplitude at 20 degC between a run that was at 20 and one that
    was at 110 degC before t = 0, by preset."""
    literature: Mapping[str, FloatArray]
    """Relative change of the amplitude from 20 to 110 degC, all factors, by published preset; one
    for each of `LITERATURE_LOADS`, `LITERATURE_WIDTHS` and `LITERATURE_DEPTHS`."""
    small_mu: Mapping[tuple[str, str], float]
    """Relative change of the amplitude from 20 to 110 degC with `SMALL_DELTA_MU`, by preset and
    factor."""
    grid: Grid

    def amplitudes(self, preset: str, factor: str) -> FloatArray:
        """Amplitude at each temperature, m/s^2, shape (10,)."""
        return np.array([point.amplitude for point in self.trends[preset, factor]])

    def change(self, preset: str, factor: str) -> float:
        """Relative change of the amplitude from 20 to 110 degC."""
        first, *_, last = self.amplitudes(preset, factor)
        return float(last / first - 1.0)

    def changes_by_start(self, preset: str, factor: str) -> FloatArray:
        """Relative change of the amplitude by start of the record, shape (STARTS,)."""
        points = self.trends[preset, factor]
        return points[-1].by_start / points[0].by_start - 1.0

    def peak_change(self, preset: str, factor: str) -> float:
        """Relative change of the mean height of the four peaks from 20 to 110 degC."""
        points = self.trends[preset, factor]
        return float(points[-1].peak_heights.mean() / points[0].peak_heights.mean() - 1.0)


def run_study(*, processes: int = 2, quiet: bool = False) -> Study:
    """Run every simulation, with a progress bar unless ``quiet``."""
    nodes = settings.TEMPERATURE_NODES
    names, factors = settings.PRESET_NAMES, settings.FACTORS
    cold, hot = nodes[0], nodes[-1]
    trend_keys = [(p, f, t) for p in names for f in factors for t in nodes]
    trend_specs = [
        RunSpec(preset=p, factor=f, temperature=t, seconds=settings.DURATION + _beat())
        for p, f, t in trend_keys
    ]
    frequency_keys = [(p, s, t) for p in names for s in ('none', 'mu_proportional') for t in nodes]
    frequency_specs = [
        RunSpec(
            preset=p, factor='all', temperature=t, slip_model=s, seconds=FREQUENCY_SECONDS,
            rate=FREQUENCY_RATE,
        )
        for p, s, t in frequency_keys
    ]  # fmt: skip
    fault_keys = ['inner', 'outer', 'ball', 'cage']
    fault_specs = [
        RunSpec(
            preset='incipient', factor=None, temperature=cold, defect=place,
            seconds=FREQUENCY_SECONDS, rate=FREQUENCY_RATE,
        )
        for place in fault_keys
    ]  # fmt: skip
    physical_specs = [
        RunSpec(preset=p, factor=None, temperature=t, thermal_mode='physical')
        for p in names
        for t in (cold, hot)
    ]
    window_specs = [
        RunSpec(preset='paper', factor=f, temperature=t, profile='rect', width=WINDOW_WIDTH)
        for f in factors
        for t in (cold, hot)
    ]
    ramp_specs = [
        RunSpec(
            preset=p,
            factor='all',
            temperature=hot,
            was=cold,
            ramp=True,
            seconds=len(nodes) * _beat(),
        )
        for p in names
    ]
    other_specs = [
        RunSpec(preset=p, factor='all', temperature=cold, was=was)
        for p in names
        for was in (cold, hot)
    ]
    mu_keys = [(p, f) for p in names for f in factors[:3]]
    mu_specs = [
        RunSpec(preset=p, factor=f, temperature=t, delta_mu=SMALL_DELTA_MU)
        for p, f in mu_keys
        for t in (cold, hot)
    ]
    literature_specs = [
        RunSpec(
            preset=name, factor='all', temperature=t, load=w, width=b, depth=h, seconds=_beat(),
            rate=FREQUENCY_RATE,
        )
        for name in settings.LITERATURE_PRESETS
        for w in LITERATURE_LOADS for b in LITERATURE_WIDTHS for h in LITERATURE_DEPTHS
        for t in (cold, hot)
    ]  # fmt: skip
    groups: list[tuple[Callable[[RunSpec], object], list[RunSpec]]] = [
        (trend_point, trend_specs),
        (frequency_point, frequency_specs),
        (fault_point, fault_specs),
        (warm_point, physical_specs),
        (ramp_point, ramp_specs),
        (
            only_amplitude,
            window_specs + other_specs + mu_specs + literature_specs + SPACE.specs(),
        ),
    ]
    jobs = [(work, spec) for work, specs in groups for spec in specs]
    done = iter(in_parallel(_do, jobs, processes=processes, text='simulations', quiet=quiet))
    trend = {key: next(done) for key in trend_keys}
    frequency = {key: next(done) for key in frequency_keys}
    fault = {key: next(done) for key in fault_keys}
    warm = {name: (next(done), next(done)) for name in names}
    ramp = {name: next(done) for name in names}
    window = {factor: _change(done) for factor in factors}
    forgotten = {name: _change(done) for name in names}
    small: dict[tuple[str, str], float] = {key: _change(done) for key in mu_keys}
    literature = {}
    for name in settings.LITERATURE_PRESETS:
        size = 2 * len(LITERATURE_LOADS) * len(LITERATURE_WIDTHS) * len(LITERATURE_DEPTHS)
        cold_hot = np.array([float(next(done)) for _ in range(size)]).reshape(-1, 2)
        literature[name] = cold_hot[:, 1] / cold_hot[:, 0] - 1.0
    found = np.log(np.array(list(done)).reshape(*SPACE.shape, len(STATES)))
    rise = [math.log(settings.factor_of(factor).at(t)) for factor, t in STATES]
    slopes = (found[..., 1:] - found[..., :1]) / np.array(rise[1:])
    return Study(
        trends={(p, f): tuple(trend[p, f, t] for t in nodes) for p in names for f in factors},
        frequencies=frequency,
        faults=fault,
        physical={
            name: Warming(amplitudes=(first[0], last[0]), clearances=(first[1], last[1]))
            for name, (first, last) in warm.items()
        },
        window=window,
        ramp=ramp,
        forgotten=forgotten,
        literature=literature,
        small_mu=small,
        grid=Grid(small=slopes[..., 0], large=slopes[..., 1]),
    )


def _do(job):  # type: ignore[no-untyped-def]
    work, spec = job
    return work(spec)


def _change(done: Iterator[Any]) -> float:
    """Relative change between the next two amplitudes."""
    first, last = float(next(done)), float(next(done))
    return last / first - 1.0


def _beat() -> float:
    """Period of f_in against 5 f_r, over which impacts fall on every shaft angle, s."""
    bpfi = fault_frequencies(settings.BEARING, settings.SHAFT_HZ).bpfi
    return 1.0 / (5.0 * settings.SHAFT_HZ - bpfi)


def trend_point(spec: RunSpec) -> TrendPoint:
    """Simulate one temperature of a trend."""
    record = simulate(spec)
    size = round(settings.DURATION * record.rate)
    offsets = np.linspace(0, len(record.time) - size, STARTS).astype(int)
    by_start = np.array(
        [
            impact_amplitude(record.acceleration[k : k + size], record.rate, record.bpfi)
            for k in offsets
        ]
    )
    time, acceleration = record.time[:size], record.acceleration[:size]
    peaks = [
        measures.peak_near(time, acceleration, instant, 0.4 / record.bpfi)
        for instant in settings.PEAK_TIMES
    ]
    times, heights = np.array(peaks).T
    return TrendPoint(
        time=time,
        acceleration=acceleration.astype(np.float32),
        amplitude=float(by_start[0]),
        by_start=by_start,
        peak_times=times,
        peak_heights=heights,
        clearance=record.clearance,
    )


def frequency_point(spec: RunSpec) -> FrequencyPoint:
    """Simulate one temperature of the frequency shift."""
    record = simulate(spec)
    short = record.acceleration[: round(settings.DURATION * record.rate)]
    frequency, envelope = measures.envelope_spectrum(record.acceleration, record.rate)
    low = frequency <= 500.0
    wide, acceleration = measures.spectrum(short, record.rate)
    return FrequencyPoint(
        prescribed=record.bpfi,
        line=measures.line_frequency(record.acceleration, record.rate, record.bpfi),
        line_short=measures.line_frequency(short, record.rate, record.bpfi),
        envelope=(frequency[low], envelope[low]),
        acceleration=(wide[wide <= 3000.0], acceleration[wide <= 3000.0]),
        contrast=measures.line_contrast(frequency, envelope, record.bpfi),
    )


def fault_point(spec: RunSpec) -> FaultPoint:
    """Simulate a defect in one place and measure the candidate lines."""
    record = simulate(spec)
    bpfo, bpfi, bsf, ftf = fault_frequencies(settings.BEARING, settings.SHAFT_HZ)
    lines = {'f_in': bpfi, 'f_out': bpfo, 'f_b': bsf, '2 f_b': 2.0 * bsf, 'f_c': ftf}
    frequency, envelope = measures.envelope_spectrum(record.acceleration, record.rate)
    return FaultPoint(
        contrasts={
            name: measures.line_contrast(frequency, envelope, line) for name, line in lines.items()
        }
    )


def only_amplitude(spec: RunSpec) -> float:
    """Simulate and return the impact amplitude, m/s^2."""
    record = simulate(spec)
    return impact_amplitude(record.acceleration, record.rate, record.bpfi)


def warm_point(spec: RunSpec) -> tuple[float, float]:
    """Simulate and return impact amplitude, m/s^2, and radial clearance, m."""
    record = simulate(spec)
    amplitude = impact_amplitude(record.acceleration, record.rate, record.bpfi)
    return amplitude, record.clearance


def ramp_point(spec: RunSpec) -> FloatArray:
    """Simulate and return the impact amplitude of each tenth of the record, m/s^2."""
    record = simulate(spec)
    tenths = np.array_split(record.acceleration, len(settings.TEMPERATURE_NODES))
    return np.array([impact_amplitude(part, record.rate, record.bpfi) for part in tenths])
