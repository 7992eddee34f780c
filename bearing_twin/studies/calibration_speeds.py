# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Machines at two or three speeds: whether a passage is recognised, and with which width.

The machines are twins; trains of impacts and slots with a soft entry, which share nothing with the
twin; and echoes and gears, which are no passages.
"""

from __future__ import annotations

from dataclasses import replace
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
    widest,
)
from bearing_twin.calibration.joint import passage_width
from bearing_twin.calibration.measured.summaries import correlate
from bearing_twin.studies.calibration_machines import (
    drawn_machine,
    drawn_modes,
    ring,
    SECONDS,
    train,
)
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.calibration.answer.impacts import Impacts
    from bearing_twin.calibration.candidates.cloud import Situation
    from numpy.typing import NDArray

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


def look_at_speeds(kind: str, number: int) -> list[dict[str, Any]]:
    """Compare the impacts of a machine at two or three speeds; no record is fitted."""
    rng, machine, _ = drawn_machine(number, 30 + KINDS.index(kind))
    soft = 'soft' in kind
    if soft:
        machine = replace(machine, slip=rng.uniform(0.0, 0.02))
    ratio = rng.uniform(*FASTER)
    factors = (1.0, ratio) if number % 2 else (1.0, ratio, math.sqrt(ratio))
    modes = (
        drawn_modes(machine.sample_rate, rng, count=(2, 4), lowest=1500.0, most_damped=0.08)
        if soft
        else drawn_modes(machine.sample_rate, rng)
    )
    truth = {name: u.place(rng.random(1)) for name, u in unknowns(machine).items()}
    width = 1e-3 * float(truth['defect_width_mm'][0])
    if kind != 'twins':
        width = float(rng.uniform(0.2e-3, widest(machine.bearing)))
    low, high = load_range(machine.bearing)
    sinking = interference(machine.bearing, low * (high / low) ** rng.random())
    heights, noise = (rng.uniform(0.4, 1.0), -1.0), 10.0 ** rng.uniform(-2.0, -0.5)
    faint_db, mesh = rng.uniform(0.0, 14.0), rng.uniform(0.2, 1.0)
    teeth = int(rng.integers(13, 46))
    echoes = rng.uniform(0.3, 1.0) * width / machine.speed * rng.uniform(
        (1.0, 0.3, 1.1), (1.0, 0.9, 1.6)
    )  # fmt: skip
    echoed = rng.uniform(0.2, 1.0, 3)
    seen: list[Impacts] = []
    for index, factor in enumerate(factors):
        here = replace(machine, shaft_hz=machine.shaft_hz * factor)
        rate = here.sample_rate
        apart = impact_spacing(width, sinking, path_curvature(here.bearing, here.place))
        if kind == 'twins':
            x = next(vibrations(here, truth, SECONDS, number + 100 * index))[0]
        elif kind == "impacts of a ball's path":
            x = train(here, rng, [apart / here.speed], heights)
        elif kind == 'impacts at the edges':
            x = train(here, rng, [width / here.speed], heights)
        elif kind == 'echoes at fixed times':
            x = train(here, rng, list(echoes), (1.0, *echoed))
        elif kind == 'echoes of changing heights':
            x = train(here, rng, list(echoes), (1.0, *echoed * rng.uniform(0.1, 1.0, 3)))
        elif kind == 'gear':
            x = train(here, rng, [], (1.0,))
            at = np.round(np.arange(0.0, SECONDS, 1.0 / (teeth * here.shaft_hz)) * rate)
            x[at[at < len(x)].astype(int)] += rng.uniform(0.2, 0.8)
        if soft:
            x = _soft(here, apart / here.speed, sinking, modes, faint_db, rng)
            if kind.endswith('gear'):
                turns = 2.0 * np.pi * teeth * here.shaft_hz * np.arange(len(x)) / rate
                tones = [np.cos(k * turns + rng.uniform(0.0, 6.3)) / k for k in range(1, 6)]
                x += mesh * _force_response(np.sum(tones, axis=0), rate, modes)
        else:
            x = ring(x, rate, modes)
        if kind != 'twins':
            x += noise * x.std() * rng.standard_normal(len(x))
        # The comparison does not know the slip.
        here = replace(here, slip=0.0)
        whole = correlate(x, rate)
        measured = whole.summary(here.longest_spacing)
        impacts = impacts_of(whole, measured, here)
        gear = no_impacts(x, here) or gear_mesh(x, rate, measured)
        if impacts is not None and gear is None:
            seen.append(impacts)
    groups = [
        (each, *follows_speed(each, [other for other in seen if other is not each]))
        for each in seen
    ]
    proved = next((group for group in groups if len(group) > 1), ())
    row = {'width': 1e3 * width, 'compared': len(seen) > 1, 'proved': len(proved) > 0}
    if proved:
        told = passage_width(replace(machine, slip=0.0), proved)
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
