# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The numerical study: simulations that are run, and results that are kept of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
import functools
from itertools import product
import math
from typing import Any, NamedTuple

from bearing_twin.bearing import fault_frequencies
from bearing_twin.dynamics.trend import impact_amplitude
from bearing_twin.paper import measures, settings
from bearing_twin.paper.runs import in_parallel, RunSpec, simulate
from bearing_twin.paper.settings import COLD, HOT
from bearing_twin.paper.space import Grid, SPACE, Space, STATES
import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

STARTS = 8
"""Starts over one beat of f_in against 5 f_r: they show how the amplitude depends on the start."""
FREQUENCY_SECONDS = 12.0
"""Record length that separates f_in from 5 f_r, 0.66 Hz away without and 0.18 Hz with slip, s."""
FREQUENCY_RATE = 25600.0
WINDOW_WIDTH = 2.0e-3
"""Width of equation 8's own window at which the amplitude falls with beta0, m."""
SMALL_DELTA_MU = 0.001
"""A smaller weight of friction, which the paper allows as well as `settings.DELTA_MU`."""
LITERATURE_LOADS = (500.0, 2000.0)
LITERATURE_WIDTHS = (0.8e-3, 1.6e-3, 2.8e-3)
LITERATURE_DEPTHS = (15e-6, 40e-6)
_LITERATURE = tuple(product(LITERATURE_LOADS, LITERATURE_WIDTHS, LITERATURE_DEPTHS))


@dataclass(frozen=True, kw_only=True)
class TrendPoint:
    """Results for one preset, factor and temperature."""

    time: FloatArray
    """Time, 0 to 0.7 s, shape (n,)."""
    acceleration: npt.NDArray[np.float32]
    """Vertical acceleration of the housing, m/s^2, shape (n,)."""
    amplitude: float
    """Impact amplitude of the record from t = 0, m/s^2; see `impact_amplitude`."""
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
    """Results for one preset, slip model and temperature, with all three factors."""

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


class WarmPoint(NamedTuple):
    """Results for one preset in the physical mode at one temperature."""

    amplitude: float
    """Impact amplitude, m/s^2."""
    clearance: float
    """Radial clearance, m."""


class Warming(NamedTuple):
    """One preset at 20 and at 110 degC."""

    cold: WarmPoint
    hot: WarmPoint

    @property
    def change(self) -> float:
        """Relative change of the amplitude."""
        return self.hot.amplitude / self.cold.amplitude - 1.0


@dataclass(frozen=True, kw_only=True)
class Study:
    """Results of all simulations."""

    trends: Mapping[tuple[str, str], tuple[TrendPoint, ...]]
    """By preset and factor, one point per temperature."""
    frequencies: Mapping[tuple[str, str, float], FrequencyPoint]
    """By preset, slip model and temperature, degC."""
    faults: Mapping[str, Mapping[str, float]]
    """By place of the defect: heights of the lines f_in, f_out, f_b, 2 f_b and f_c over the floor
    of the envelope spectrum."""
    physical: Mapping[str, Warming]
    """By preset, in the twin's thermal mode ``'physical'``."""
    window: Mapping[settings.Factor, float]
    """Relative change of the amplitude from 20 to 110 degC by factor, in `paper` with equation
    8's own window, `WINDOW_WIDTH` wide."""
    formula_depths: Mapping[str, float]
    """Relative change of the amplitude from 20 to 110 degC, all factors, in `paper` with a spall
    as deep as in the static formula, by name of `settings.FORMULA_RATIOS`."""
    ramp: Mapping[str, FloatArray]
    """Amplitude in each tenth of a run with a linear temperature ramp from 20 to 110 degC over ten
    beats of f_in against 5 f_r, by preset, m/s^2, shape (10,)."""
    initial_state_effect: Mapping[str, float]
    """Relative change of the amplitude at 20 degC if the run was at 110 degC instead of 20 before
    t = 0, by preset."""
    literature: Mapping[str, FloatArray]
    """Relative change of the amplitude from 20 to 110 degC, all factors, by published preset; one
    for each combination of `LITERATURE_LOADS`, `LITERATURE_WIDTHS` and `LITERATURE_DEPTHS`."""
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


def _plan(
    space: Space, temperatures: Sequence[float]
) -> dict[str, tuple[Callable[[RunSpec], Any], dict[Any, RunSpec]]]:
    """Return what is done with each run, and all runs by what tells them apart, of each part."""
    nodes, names, factors = settings.TEMPERATURE_NODES, settings.PRESET_NAMES, settings.FACTORS
    long = functools.partial(RunSpec, seconds=FREQUENCY_SECONDS, rate=FREQUENCY_RATE)
    return {
        'trends': (trend_point, {
            (p, f, t): RunSpec(
                preset=p, factor=f, temperature=t, seconds=settings.DURATION + _beat()
            )
            for p, f, t in product(names, factors, nodes)
        }),
        'frequencies': (frequency_point, {
            (p, s, t): long(preset=p, factor='all', temperature=t, slip_model=s)
            for p, s, t in product(names, ('none', 'mu_proportional'), temperatures)
        }),
        'faults': (fault_point, {
            place: long(preset='incipient', factor=None, temperature=COLD, defect=place)
            for place in ('inner', 'outer', 'ball', 'cage')
        }),
        'physical': (warm_point, {
            (p, t): RunSpec(preset=p, factor=None, temperature=t, thermal_mode='physical')
            for p, t in product(names, (COLD, HOT))
        }),
        'ramp': (ramp_point, {
            p: RunSpec(
                preset=p, factor='all', temperature=HOT, was=COLD, ramp=True,
                seconds=len(nodes) * _beat(),
            )
            for p in names
        }),
        'window': (only_amplitude, {
            (f, t): RunSpec(
                preset='paper', factor=f, temperature=t, profile='rect', width=WINDOW_WIDTH
            )
            for f, t in product(factors, (COLD, HOT))
        }),
        'formula_depths': (only_amplitude, {
            (name, t): RunSpec(
                preset='paper', factor='all', temperature=t, depth=ratio * settings.APPROACH
            )
            for name, ratio in settings.FORMULA_RATIOS.items()
            for t in (COLD, HOT)
        }),
        'initial_state_effect': (only_amplitude, {
            (p, was): RunSpec(preset=p, factor='all', temperature=COLD, was=was)
            for p, was in product(names, (COLD, HOT))
        }),
        'small_mu': (only_amplitude, {
            (p, f, t): RunSpec(preset=p, factor=f, temperature=t, delta_mu=SMALL_DELTA_MU)
            for p, f, t in product(names, factors[:3], (COLD, HOT))
        }),
        'literature': (only_amplitude, {
            (name, load, width, depth, t): RunSpec(
                preset=chosen, factor='all', temperature=t, load=load, width=width, depth=depth,
                seconds=_beat(), rate=FREQUENCY_RATE, model=model,
            )
            for name, (chosen, model) in settings.PUBLISHED_MODELS.items()
            for load, width, depth in _LITERATURE
            for t in (COLD, HOT)
        }),
        'space': (only_amplitude, dict(enumerate(space.specs()))),
    }  # fmt: skip


def run_study(
    *,
    processes: int,
    space: Space = SPACE,
    temperatures: Sequence[float] = settings.TEMPERATURE_NODES,
) -> Study:
    """
    Run every simulation, with a progress bar.

    Parameters
    ----------
    processes
        Processes that simulate.
    space
        Settings in which the generality of the trends is judged.
    temperatures
        Temperatures of the frequency shift, degC; 20, 100 and 110 have to be among them.

    """
    names, factors, plan = settings.PRESET_NAMES, settings.FACTORS, _plan(space, temperatures)
    jobs = [(work, spec) for work, specs in plan.values() for spec in specs.values()]
    done = iter(in_parallel(_do, jobs, processes=processes))
    found = {name: {key: next(done) for key in specs} for name, (_, specs) in plan.items()}

    def change(name: str, *key: Any) -> float:
        """Relative change of an amplitude from the cold to the hot one."""
        before, after = (float(found[name][each]) for each in ((*key, COLD), (*key, HOT)))
        return after / before - 1.0

    logs = np.log(np.array(list(found['space'].values())).reshape(*space.shape, len(STATES)))
    rise = [math.log(settings.factor_of(factor).at(t)) for factor, t in STATES]
    slopes = (logs[..., 1:] - logs[..., :1]) / np.array(rise[1:])
    return Study(
        trends={
            (p, f): tuple(found['trends'][p, f, t] for t in settings.TEMPERATURE_NODES)
            for p, f in product(names, factors)
        },
        frequencies=found['frequencies'],
        faults=found['faults'],
        physical={
            p: Warming(found['physical'][p, COLD], found['physical'][p, HOT]) for p in names
        },
        window={f: change('window', f) for f in factors},
        formula_depths={name: change('formula_depths', name) for name in settings.FORMULA_RATIOS},
        ramp=found['ramp'],
        initial_state_effect={p: change('initial_state_effect', p) for p in names},
        literature={
            name: np.array([change('literature', name, *each) for each in _LITERATURE])
            for name in settings.PUBLISHED_MODELS
        },
        small_mu={(p, f): change('small_mu', p, f) for p, f in product(names, factors[:3])},
        grid=Grid(space=space, small=slopes[..., 0], large=slopes[..., 1]),
    )


def _do(job):  # type: ignore[no-untyped-def]
    work, spec = job
    return work(spec)


def _beat() -> float:
    """Return the beat period of f_in and 5 f_r, s: over it impacts fall on every shaft angle."""
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


def fault_point(spec: RunSpec) -> dict[str, float]:
    """Simulate a defect in one place and measure the candidate lines."""
    record = simulate(spec)
    bpfo, bpfi, bsf, ftf = fault_frequencies(settings.BEARING, settings.SHAFT_HZ)
    lines = {'f_in': bpfi, 'f_out': bpfo, 'f_b': bsf, '2 f_b': 2.0 * bsf, 'f_c': ftf}
    spectrum = measures.envelope_spectrum(record.acceleration, record.rate)
    return {name: measures.line_contrast(*spectrum, line) for name, line in lines.items()}


def only_amplitude(spec: RunSpec) -> float:
    """Simulate and return the impact amplitude, m/s^2."""
    return simulate(spec).amplitude


def warm_point(spec: RunSpec) -> WarmPoint:
    """Simulate one temperature of the physical mode."""
    record = simulate(spec)
    return WarmPoint(record.amplitude, record.clearance)


def ramp_point(spec: RunSpec) -> FloatArray:
    """Simulate and return the impact amplitude of each tenth of the record, m/s^2."""
    record = simulate(spec)
    tenths = np.array_split(record.acceleration, len(settings.TEMPERATURE_NODES))
    return np.array([impact_amplitude(part, record.rate, record.bpfi) for part in tenths])
