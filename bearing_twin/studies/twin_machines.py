# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Random machines whose bearings are simulated by the twin."""

from __future__ import annotations

from dataclasses import dataclass, replace
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import find_bearing
from bearing_twin.dynamics.presets import preset
from bearing_twin.dynamics.single.simulator import Simulator
from bearing_twin.studies.disturbances import CONDITIONS, disturbance, MACHINES
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


RATES = (12800.0, 20000.0, 25600.0, 51200.0)
SETTLE_S = 0.5
WORN, WORN_SHARE = 4, 0.2
"""Defects of a worn bearing, and share of worn bearings among the damaged ones."""


BEARINGS = (
    '6203', '6205', '6307', '6307-catalogue', 'NICE', 'PRONOSTIA', 'UER204', 'ZA-2115',
)  # fmt: skip
"""Bearings to draw from. The list is fixed, so that a number stays the same machine."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One machine, one bearing, one record."""

    bearing: str
    condition: str
    machine: str
    shaft_hz: float
    given_hz: float
    """Speed given to the diagnosis, Hz: that of the nameplate, off by up to 2 %."""
    sample_rate: float
    turns: float
    load: float
    slip: float
    temperature: float
    noise: float
    """Sensor noise, m/s^2."""
    width: float
    """Width of the defect, m, or of each of the ``WORN`` defects of a worn bearing."""
    worn: bool
    """Whether the part has several large defects instead of one."""
    waviness: float
    """Waviness, m/s: see `bearing_twin.dynamics.equations.waviness`."""
    angle: float
    """Place of an outer race defect from the load direction, rad."""
    gain: float
    """Units of the record per m/s^2; unknown to the diagnosis."""
    disturbance: float
    """RMS of the machine's own vibration over that of the bearing with its noise."""
    seed: int

    @property
    def geometry(self) -> Bearing:
        """Geometry of the bearing."""
        return find_bearing(self.bearing)


def draw(number: int) -> Case:
    """Draw a machine; a number is always the same machine."""
    rng = np.random.default_rng([2026, number])
    bearing = str(rng.choice(BEARINGS))
    geometry = find_bearing(bearing)
    rate = float(rng.choice(RATES))
    # Four harmonics of the ball's or the inner race's frequency must fit: see the record gate.
    fastest = min(60.0, rate / (8.0 * 0.62 * geometry.n_balls))
    shaft_hz = float(rng.uniform(10.0, fastest))
    case = Case(
        bearing=bearing,
        condition=CONDITIONS[number % len(CONDITIONS)],
        machine=str(rng.choice(MACHINES)),
        shaft_hz=shaft_hz,
        given_hz=shaft_hz * float(rng.uniform(0.98, 1.02)),
        sample_rate=rate,
        turns=float(rng.uniform(120.0, 250.0)),
        load=float(10.0 ** rng.uniform(2.0, 3.5)),
        slip=float(rng.uniform(0.0, 0.02)),
        temperature=float(rng.uniform(20.0, 100.0)),
        noise=float(10.0 ** rng.uniform(-1.0, 0.5)),
        width=float(geometry.d_ball * rng.uniform(0.03, 0.15)),
        angle=float(rng.uniform(-1.0, 1.0)),
        gain=float(10.0 ** rng.uniform(-4.0, 4.0)),
        disturbance=float(10.0 ** rng.uniform(-1.0, 0.3)),
        seed=number,
        worn=bool(rng.random() < WORN_SHARE),
        # From a fifth of the default to five times as much.
        waviness=float(10.0 ** rng.uniform(-5.0, -3.6)),
    )
    return replace(case, width=3.0 * case.width) if case.worn else case


def record(case: Case) -> np.ndarray[Any, Any]:
    """Return the samples of a case, in an unknown unit."""
    options: dict[str, Any] = {'defect': case.condition}
    if case.condition in ('inner', 'outer', 'ball'):
        options |= {'width': case.width, 'depth': 50e-6}
    parameters = preset(
        'incipient',
        # The twin simulates one row of balls; only the geometry is tried here.
        bearing=replace(find_bearing(case.bearing), element='ball', rows=1),
        load=case.load,
        slip=case.slip,
        noise=case.noise,
        waviness=case.waviness,
        **options,
    )
    if case.condition in ('inner', 'outer', 'ball'):
        first = parameters.defects[0]
        away = case.angle * (case.condition == 'outer')
        # Spread over the circumference, at no multiple of the ball spacing.
        angles = (away + first.angle + 1.7 * k for k in range(WORN if case.worn else 1))
        spalls = tuple(replace(first, angle=math.remainder(a, 2.0 * math.pi)) for a in angles)
        parameters = replace(parameters, defects=spalls)
    twin = Simulator(
        parameters,
        sample_rate=case.sample_rate,
        seed=case.seed,
        temperature=case.temperature,
        shaft_hz=case.shaft_hz,
    )
    twin.advance(int(SETTLE_S * case.sample_rate), case.temperature, case.shaft_hz)
    n = int(case.turns / case.shaft_hz * case.sample_rate)
    x = twin.advance(n, case.temperature, case.shaft_hz).y.astype(float)
    x = x - x.mean()
    turns = np.asarray(case.shaft_hz / case.sample_rate * np.arange(n), dtype=np.float64)
    rng = np.random.default_rng([case.seed, 1])
    other = disturbance(case.machine, turns, case.sample_rate, rng)
    if case.machine != 'quiet':
        x = x + other * (case.disturbance * x.std() / other.std())
    return np.asarray(case.gain * x)
