# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulations behind the figures and claims, run in several processes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
import dataclasses
from dataclasses import dataclass, field
import functools
import math
import multiprocessing
import signal
from typing import TYPE_CHECKING, TypeVar

from bearing_twin.bearing import fault_frequencies
from bearing_twin.dynamics import preset, Simulator, warm_up
from bearing_twin.dynamics.equations import coefficients
from bearing_twin.dynamics.trend import impact_amplitude
from bearing_twin.paper import settings
from bearing_twin.process import end_with_parent
import numpy as np
import numpy.typing as npt
from tqdm import tqdm

if TYPE_CHECKING:
    from bearing_twin.dynamics import TwinParameters
    from bearing_twin.dynamics.parameters import Profile, ThermalMode


FloatArray = npt.NDArray[np.float64]
S = TypeVar('S')
R = TypeVar('R')

_SETTLING_IMPACTS = 50
"""Impacts before t = 0: 0.4 s, in which the transient of the start decays below 1e-5."""


@dataclass(frozen=True, kw_only=True)
class RunSpec:
    """One simulation, free of jitter, noise and waviness."""

    preset: str
    factor: settings.Factor | None
    """Terms of beta0 that are present; None: none, the model without temperature."""
    temperature: float
    """degC."""
    defect: str = 'inner'
    profile: Profile = 'ball'
    """Path of a ball over the defect: ``'ball'``, or ``'rect'``, equation 8 with b = 0 or 1."""
    slip_model: str = 'none'
    """``'none'`` as in the paper, or ``'mu_proportional'``."""
    thermal_mode: ThermalMode = 'paper'
    shaft_hz: float = settings.SHAFT_HZ
    was: float | None = None
    """Temperature before t = 0, degC; None: `temperature`."""
    ramp: bool = False
    """Whether the temperature changes linearly from `was` over the record; otherwise it changes at
    once, and the motion settles a second time before t = 0."""
    seconds: float = settings.DURATION
    rate: float = 51200.0
    """Samples a second."""
    delta_mu: float = settings.DELTA_MU
    """Weight of friction in beta0."""
    load: float | None = None
    """Load instead of the preset's, N; the next three likewise, m."""
    width: float | None = None
    depth: float | None = None
    clearance: float | None = None
    model: Mapping[str, float] = field(default_factory=dict)
    """Other fields of the twin's parameters, instead of the preset's."""

    def parameters(self) -> TwinParameters:
        """Return the twin's parameters; the sensor is ideal: no resonance, no noise."""
        changed = dict(self.model) | {
            name: getattr(self, name)
            for name in ('load', 'clearance')
            if getattr(self, name) is not None
        }
        return preset(
            self.preset,
            bearing=settings.BEARING,
            defect=self.defect,
            width=self.width,
            depth=self.depth,
            profile=self.profile,
            thermal_mode=self.thermal_mode,
            slip_model=self.slip_model,
            jitter=0.0,
            noise=0.0,
            waviness=0.0,
            resonance_hz=0.0,
            beta0=settings.factor_of(self.factor, delta_mu=self.delta_mu),
            **changed,
        )


@dataclass(frozen=True, kw_only=True)
class Record:
    """A simulated record; t = 0 is an impact on the defect in the load direction."""

    time: FloatArray
    """s, shape (n,)."""
    acceleration: FloatArray
    """Vertical acceleration of the housing, the direction of the load, m/s^2, shape (n,)."""
    rate: float
    """Hz."""
    bpfi: float
    """Prescribed ball-pass frequency of the inner race, slip included, Hz."""
    clearance: float
    """Radial clearance, m."""

    @property
    def amplitude(self) -> float:
        """Impact amplitude, m/s^2."""
        return impact_amplitude(self.acceleration, self.rate, self.bpfi)


def simulate(spec: RunSpec) -> Record:
    """
    Run one simulation.

    The paper sets t0 = 0 at an impact. The run starts 50 impacts earlier, at the shaft angle from
    which the defect is back in the load direction at t = 0, so that the transient is gone by then.
    """
    parameters = spec.parameters()
    cold = spec.temperature if spec.was is None else spec.was
    bpfi = _passing_hz(parameters, cold, spec.shaft_hz)
    settling = _SETTLING_IMPACTS / bpfi
    twice = spec.was is not None and not spec.ramp
    lead = 2.0 * settling if twice else settling
    turned = 2.0 * math.pi * spec.shaft_hz * lead
    start = math.remainder(parameters.start_angle - turned, 2.0 * math.pi)
    simulator = Simulator(
        dataclasses.replace(parameters, start_angle=start),
        sample_rate=spec.rate,
        temperature=cold,
        shaft_hz=spec.shaft_hz,
    )
    n = math.ceil((lead + simulator.delay + spec.seconds) * spec.rate) + 2
    settled = round(settling * spec.rate)
    begun = cold if spec.ramp else spec.temperature
    parts = [
        simulator.advance(count, degrees, spec.shaft_hz)
        for count, degrees in ((settled, cold), (1, begun), (n - settled - 1, spec.temperature))
    ]
    time = np.arange(n) / spec.rate - simulator.delay - lead
    kept = (time >= 0.0) & (time < spec.seconds)
    return Record(
        time=time[kept],
        acceleration=np.concatenate([part.y for part in parts])[kept].astype(float),
        rate=spec.rate,
        bpfi=bpfi,
        clearance=parts[-1].condition.radial_clearance,
    )


def _passing_hz(p: TwinParameters, temperature: float, shaft_hz: float) -> float:
    """Return the ball-pass frequency of the inner race, slip included, Hz."""
    values = np.empty(coefficients.CONDITION_SIZE)
    constants = coefficients.constants_of(p)
    coefficients.evaluate(constants, temperature, temperature, shaft_hz, values)
    return fault_frequencies(p.bearing, shaft_hz, float(values[coefficients.SLIP])).bpfi


def in_parallel(work: Callable[[S], R], items: Sequence[S], *, processes: int) -> list[R]:
    """
    Return ``work(item)`` of all items, in order, from several processes; on a terminal with a bar.

    ``processes`` = 1 stays in this process. The others are started afresh, not forked, because
    this one may have threads (a progress bar, a ROS context).
    """
    bar = functools.partial(
        tqdm,
        total=len(items),
        desc='simulations',
        unit='',
        mininterval=0.5,
        ncols=80,
        disable=None,
    )
    if processes == 1:
        return list(bar(map(work, items)))
    # Compiled once here; the workers find it in numba's cache.
    warm_up()
    context = multiprocessing.get_context('spawn')
    pool = ProcessPoolExecutor(processes, mp_context=context, initializer=_begin_process)
    try:
        return list(bar(pool.map(work, items)))
    finally:
        # After an interrupt or a failed run, the remaining simulations are cancelled.
        pool.shutdown(cancel_futures=True)


def _begin_process() -> None:
    """Leave Ctrl-C to the parent, and end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
