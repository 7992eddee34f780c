# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Machines at two or three speeds: whether a passage is recognised, and with which width.

The machines are twins; trains of impacts and slots with a soft entry, which share nothing with the
twin; and echoes and gears, which are no passages.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.calibration.answer.impacts import follows_speed, gear_mesh, impacts_of
from bearing_twin.calibration.answer.refusals import no_impacts
from bearing_twin.calibration.candidates.cloud import unknowns, vibrations
from bearing_twin.calibration.candidates.passage import (
    impact_spacing,
    interference,
    load_range,
    path_curvature,
)
from bearing_twin.calibration.joint import passage_width
from bearing_twin.calibration.measured.summaries import correlate
from bearing_twin.dynamics.parameters import widest
from bearing_twin.studies.calibration_machines import (
    drawn_machine,
    drawn_modes,
    ring,
    SECONDS,
    train,
)
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.calibration.answer.impacts import Impacts
    from bearing_twin.calibration.candidates.cloud import Situation

    FloatArray = NDArray[np.float64]


KINDS = (
    'twins',
    "impacts of a ball's path",
    'impacts at the edges',
    'slots with a soft entry',
    'slots with a soft entry beside a gear',
    'echoes at fixed times',
    'echoes of changing heights',
    'gear',
)
FASTER = 1.3, 2.0
"""Ratio of the fastest speed to the slowest."""


@dataclass(frozen=True, kw_only=True)
class _Machine:
    """
    What is drawn once for all records of a machine: lengths in m, times in s.

    ``heights`` are those of entry and exit, ``faint_db`` is the attenuation of a soft entry, and
    ``mesh`` the height of the lines of a gear beside it. ``noise`` is over the RMS of a vibration.
    """

    kind: str
    number: int
    situation: Situation
    """At the slowest speed."""
    modes: list[tuple[float, ...]]
    truth: dict[str, FloatArray]
    """Unknowns of a twin."""
    width: float
    sinking: float
    """Sinking that unloads a ball."""
    heights: tuple[float, float]
    noise: float
    faint_db: float
    mesh: float
    teeth: int
    echoes_s: FloatArray
    echoed: FloatArray
    """Heights of the echoes."""

    def record(self, here: Situation, index: int, rng: np.random.Generator) -> FloatArray:
        """Return the sensor signal at one speed, the one of number ``index``."""
        if self.kind == 'twins':
            x = next(vibrations(here, self.truth, SECONDS, self.number + 100 * index))[0]
            return ring(x, here.sample_rate, self.modes)
        x = self._slot(here, rng) if 'soft' in self.kind else self._train(here, rng)
        return np.asarray(x + self.noise * x.std() * rng.standard_normal(len(x)))

    def _spacing_s(self, here: Situation) -> float:
        curvature = path_curvature(here.bearing, here.place)
        return impact_spacing(self.width, self.sinking, curvature) / here.speed

    def _slot(self, here: Situation, rng: np.random.Generator) -> FloatArray:
        """Return the vibration of a slot with a soft entry, maybe beside a gear."""
        apart = self._spacing_s(here)
        x = _soft(here, apart, self.sinking, self.modes, self.faint_db, rng)
        if self.kind.endswith('gear'):
            rate = here.sample_rate
            turns = 2.0 * np.pi * self.teeth * here.shaft_hz * np.arange(len(x)) / rate
            tones = [np.cos(k * turns + rng.uniform(0.0, 6.3)) / k for k in range(1, 6)]
            x += self.mesh * _force_response(np.sum(tones, axis=0), rate, self.modes)
        return x

    def _train(self, here: Situation, rng: np.random.Generator) -> FloatArray:
        """Return impacts, or the teeth of a gear, through the resonances of the path."""
        apart: list[float] = [self._spacing_s(here)]
        shares: tuple[float, ...] = self.heights
        if self.kind == 'impacts at the edges':
            apart = [self.width / here.speed]
        elif self.kind == 'echoes at fixed times':
            apart, shares = self.echoes_s.tolist(), (1.0, *self.echoed)
        elif self.kind == 'echoes of changing heights':
            apart = self.echoes_s.tolist()
            shares = (1.0, *self.echoed * rng.uniform(0.1, 1.0, 3))
        elif self.kind == 'gear':
            apart, shares = [], (1.0,)
        x = train(here, rng, apart, shares)
        if self.kind == 'gear':
            period = 1.0 / (self.teeth * here.shaft_hz)
            at = np.round(np.arange(0.0, SECONDS, period) * here.sample_rate)
            x[at[at < len(x)].astype(int)] += rng.uniform(0.2, 0.8)
        return ring(x, here.sample_rate, self.modes)


def _drawn(kind: str, number: int) -> tuple[_Machine, tuple[float, ...], np.random.Generator]:
    """Draw a machine and the ratios of its speeds to the slowest; also return the generator."""
    rng, situation, _ = drawn_machine(number, 30 + KINDS.index(kind))
    options: dict[str, Any] = {}
    if 'soft' in kind:
        situation = replace(situation, slip=rng.uniform(0.0, 0.02))
        options = {'count': (2, 4), 'lowest': 1500.0, 'most_damped': 0.08}
    ratio = rng.uniform(*FASTER)
    modes = drawn_modes(situation.sample_rate, rng, **options)
    truth = {name: u.place(rng.random(1)) for name, u in unknowns(situation).items()}
    width = 1e-3 * float(truth['defect_width_mm'][0])
    if kind != 'twins':
        width = float(rng.uniform(0.2e-3, widest(situation.bearing)))
    low, high = load_range(situation.bearing)
    machine = _Machine(
        kind=kind,
        number=number,
        situation=situation,
        modes=modes,
        truth=truth,
        width=width,
        sinking=interference(situation.bearing, low * (high / low) ** rng.random()),
        heights=(rng.uniform(0.4, 1.0), -1.0),
        noise=10.0 ** rng.uniform(-2.0, -0.5),
        faint_db=rng.uniform(0.0, 14.0),
        mesh=rng.uniform(0.2, 1.0),
        teeth=int(rng.integers(13, 46)),
        echoes_s=rng.uniform(0.3, 1.0) * width / situation.speed
        * rng.uniform((1.0, 0.3, 1.1), (1.0, 0.9, 1.6)),
        echoed=rng.uniform(0.2, 1.0, 3),
    )  # fmt: skip
    return machine, (1.0, ratio) if number % 2 else (1.0, ratio, math.sqrt(ratio)), rng


def look_at_speeds(kind: str, number: int) -> list[dict[str, Any]]:
    """Compare the impacts of a machine at two or three speeds; no record is fitted."""
    machine, factors, rng = _drawn(kind, number)
    seen: list[Impacts] = []
    for index, factor in enumerate(factors):
        here = replace(machine.situation, shaft_hz=machine.situation.shaft_hz * factor)
        x = machine.record(here, index, rng)
        # The comparison does not know the slip.
        here = replace(here, slip=0.0)
        whole = correlate(x, here.sample_rate)
        measured = whole.summary(here.longest_spacing)
        impacts = impacts_of(whole, measured, here)
        gear = no_impacts(x, here) or gear_mesh(x, here.sample_rate, measured)
        if impacts is not None and gear is None:
            seen.append(impacts)
    groups = (
        (each, *follows_speed(each, [other for other in seen if other is not each]))
        for each in seen
    )
    proved = next((group for group in groups if len(group) > 1), ())
    row = {'width': 1e3 * machine.width, 'compared': len(seen) > 1, 'proved': len(proved) > 0}
    if proved:
        told = passage_width(replace(machine.situation, slip=0.0), proved)
        row |= {'q05': told.q05, 'median': told.median, 'q95': told.q95}
    return [row]


def _soft(
    machine: Situation, apart_s: float, sinking: float, modes: list[tuple[float, ...]],
    faint_db: float, rng: np.random.Generator,
) -> FloatArray:  # fmt: skip
    """
    Return the vibration of passages with a soft entry.

    The load falls over the distance in which the ball is unloaded. At the exit it returns, with an
    impact.
    """
    rate, strikes = machine.sample_rate, machine.impact_rate
    curvature = path_curvature(machine.bearing, machine.place)
    ramp = max(1, round(math.sqrt(sinking / curvature) / machine.speed * rate))
    count = int(1.3 * strikes * SECONDS)
    entries = np.cumsum(1.0 + 0.006 * rng.standard_normal(count)) / strikes
    heights = np.maximum(1.0 + 0.3 * rng.standard_normal(count), 0.05)
    if machine.place == 'inner':
        turned = np.cos(2.0 * np.pi * machine.shaft_hz * entries + rng.uniform(0.0, 6.3))
        heights *= np.maximum(turned, 0.0) ** 1.5
    impacts, change = np.zeros((2, int(SECONDS * rate)))
    for entry, height in zip(entries, heights, strict=True):
        first, last = round(entry * rate), round((entry + apart_s) * rate)
        if max(first + ramp, last) < len(impacts):
            change[first : first + ramp] -= height / ramp
            change[max(last, first + ramp - 1)] += height
            impacts[last] += height
    exits, loads = (_force_response(force, rate, modes) for force in (impacts, np.cumsum(change)))
    return np.asarray(exits + 10.0 ** (-faint_db / 20.0) * loads)


def _force_response(force: FloatArray, rate: float, modes: list[tuple[float, ...]]) -> FloatArray:
    """Return the acceleration by a force, standard deviation 1; a steady force causes none."""
    x = ring(np.diff(force, 2, prepend=(0.0, 0.0)), rate, modes)
    # A slot so narrow that no ball is unloaded causes none.
    return np.asarray(x / (x.std() or 1.0))
