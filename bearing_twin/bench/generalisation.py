# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
What the diagnosis says on simulated machines that nobody tuned it for.

``python -m bearing_twin.bench.generalisation [CASES]`` draws machines at random: bearing of the
catalogue, speed, sample rate, load, slip, place and size of the defect, sensor gain without a
unit, a nameplate speed that is off, and what other machinery adds (shaft harmonics, gear mesh,
mains, amplitude modulation, impulses). It prints a table of the answers by the true condition.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
import sys
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import catalogue, find_bearing
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.dynamics.presets import preset
from bearing_twin.dynamics.simulator import Simulator
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.diagnosis import Diagnosis

__all__ = ['CONDITIONS', 'MACHINES', 'Case', 'draw', 'main', 'outcome', 'record', 'study']

CONDITIONS = ('none', 'inner', 'outer', 'ball', 'cage')
MACHINES = ('quiet', 'shaft', 'gear', 'mains', 'modulated', 'impulses')
RATES = (12800.0, 20000.0, 25600.0, 51200.0)
SETTLE_S = 0.5


@dataclass(frozen=True, kw_only=True)
class Case:
    """One machine, one bearing, one record."""

    bearing: str
    condition: str
    machine: str
    shaft_hz: float
    given_hz: float
    """Speed handed to the diagnosis: the nameplate's, off by up to 2 %."""
    sample_rate: float
    turns: float
    load: float
    slip: float
    temperature: float
    noise: float
    """Sensor noise, m/s^2."""
    width: float
    """Of the defect, m."""
    angle: float
    """Place of an outer race defect from the load direction, rad."""
    gain: float
    """Units of the record a m/s^2; the diagnosis is not told."""
    disturbance: float
    """RMS of what the machine adds over that of the bearing with its noise."""
    seed: int


def draw(number: int) -> Case:
    """Machine of a number; the same number is the same machine."""
    rng = np.random.default_rng([2026, number])
    bearing = str(rng.choice(sorted(catalogue())))
    geometry = find_bearing(bearing)
    rate = float(rng.choice(RATES))
    # Four harmonics of the ball's or the inner race's frequency must fit: see the record gate.
    fastest = min(60.0, rate / (8.0 * 0.62 * geometry.n_balls))
    shaft_hz = float(rng.uniform(10.0, fastest))
    return Case(
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
    )


def _disturb(case: Case, n: int, rng: np.random.Generator) -> np.ndarray[Any, Any]:
    """Return what else the machine does, before scaling, shape (n,)."""
    t = np.arange(n) / case.sample_rate
    shaft = 2.0 * np.pi * case.shaft_hz * t

    def tone(hertz: float, depth: float = 0.0) -> np.ndarray[Any, Any]:
        swing = 1.0 + depth * np.cos(shaft + rng.uniform(0.0, 6.3))
        wave = np.sin(2.0 * np.pi * hertz * t + rng.uniform(0.0, 6.3))
        return np.asarray(rng.exponential() * swing * wave)

    nyquist = 0.45 * case.sample_rate
    if case.machine == 'shaft':
        # Unbalance, misalignment and looseness: many harmonics, halves among them.
        step = case.shaft_hz * float(rng.choice((0.5, 1.0)))
        return np.asarray(np.sum([tone(step * k) / np.sqrt(k) for k in range(1, 40)], axis=0))
    if case.machine == 'gear':
        # Two meshes, one of them on another shaft whose turns are no multiple of this one's.
        meshes = (int(rng.integers(13, 60)), float(rng.uniform(13.0, 60.0)))
        lines = [(k * m * case.shaft_hz) for m in meshes for k in (1, 2, 3)]
        return np.asarray(np.sum([tone(hz, 0.7) for hz in lines if hz < nyquist], axis=0))
    if case.machine == 'mains':
        stray = rng.uniform(10.0, nyquist, 20)
        hum = float(rng.choice((50.0, 60.0)))
        return np.asarray(np.sum([tone(hz) for hz in (*(hum * np.arange(1, 20)), *stray)], axis=0))
    if case.machine == 'modulated':
        # Noise of a flow or a seal that swells once a turn.
        swell = 1.0 + 0.8 * np.cos(shaft + rng.uniform(0.0, 6.3))
        return np.asarray(swell * rng.standard_normal(n))
    if case.machine == 'impulses':
        # Knocks that come at random, each rings at a natural frequency.
        knocks = np.zeros(n)
        count = rng.poisson(4.0 * n / case.sample_rate) + 1
        knocks[rng.integers(0, n, count)] = rng.standard_normal(count)
        tail = t[: int(0.02 * case.sample_rate)]
        ring = np.exp(-400.0 * tail) * np.sin(2.0 * np.pi * 0.15 * case.sample_rate * tail)
        return np.asarray(np.convolve(knocks, ring)[:n])
    return np.zeros(n)


def record(case: Case) -> np.ndarray[Any, Any]:
    """Return the samples of a case, in no known unit."""
    options: dict[str, Any] = {'defect': case.condition}
    if case.condition in ('inner', 'outer', 'ball'):
        options |= {'width': case.width, 'depth': 50e-6}
    parameters = preset(
        'incipient',
        bearing=case.bearing,
        load=case.load,
        slip=case.slip,
        noise=case.noise,
        **options,
    )
    if case.condition == 'outer':
        place = replace(parameters.defects[0], angle=parameters.defects[0].angle + case.angle)
        parameters = replace(parameters, defects=(place,))
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
    other = _disturb(case, n, np.random.default_rng([case.seed, 1]))
    if case.machine != 'quiet':
        x = x + other * (case.disturbance * x.std() / other.std())
    return np.asarray(case.gain * x)


def outcome(case: Case, said: Diagnosis) -> str:
    """``right``, ``wrong`` (a fault that is not there), or the answer that was not one."""
    truth = () if case.condition == 'none' else (case.condition,)
    if said.result in ('healthy', 'suspect', 'ambiguous', 'insufficient'):
        return 'right' if said.result == 'healthy' and not truth else said.result
    return 'right' if said.faults == truth else 'wrong'


def study(cases: range) -> list[tuple[Case, Diagnosis]]:
    """Diagnose each case."""
    found = []
    for number in cases:
        case = draw(number)
        geometry = find_bearing(case.bearing)
        found.append(
            (case, diagnose_record(record(case), case.sample_rate, geometry, case.given_hz))
        )
    return found


def main() -> None:
    """Print the answers by condition and by machine."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 600
    found = study(range(count))
    answers = ('right', 'wrong', 'suspect', 'ambiguous', 'insufficient', 'healthy')
    for kind, names in (('condition', CONDITIONS), ('machine', MACHINES)):
        print(f'| {kind} | cases | {" | ".join(answers)} |')
        print('|---' * (2 + len(answers)) + '|')
        for name in names:
            told = Counter(outcome(c, said) for c, said in found if getattr(c, kind) == name)
            cells = ' | '.join(str(told[answer] or '') for answer in answers)
            print(f'| {name} | {told.total()} | {cells} |')
        print()
    for case, said in found:
        if outcome(case, said) == 'wrong':
            print(f'- {case}: {said.reasons}')


if __name__ == '__main__':
    main()
