# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Speed and error of the kernels, against scipy's stiff solvers in the same run.

Everything is included: defect, sensor resonance, decimation to 25.6 kHz, jitter and noise, and for
the fleet a temperature that changes with every block. Times are processor times on one core, the
best of several runs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
import time
from typing import TYPE_CHECKING

from bearing_twin.dynamics.compilation import warm_up
from bearing_twin.dynamics.fleet.fleet import Fleet
from bearing_twin.dynamics.presets import preset
from bearing_twin.dynamics.reference import Reference, solve
from bearing_twin.dynamics.single.simulator import Simulator
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters


_RATE = 25600.0
_BLOCK = 1024
_FLEET = 512
_SHORT = 0.2
"""Simulated time over which the adaptive solvers are timed, s."""
_LONG = 1.0
"""Simulated time over which errors are calculated, s."""
_JUDGED = (
    ('incipient', 'inner'),
    ('incipient', 'outer'),
    ('incipient', 'ball'),
    ('paper', 'inner'),
)
"""Presets and defects, all at 25.4 Hz and 20 degC; the worst error counts."""
_STEPS = (1, 2, 3, 4, 6)
"""Numbers of equal steps per internal sample that are tried."""
_HARDER = (('inner', 50.0, 500.0), ('outer', 100.0, 500.0), ('inner', 25.4, 5000.0))
"""Defects, shaft speeds in Hz and loads in N at which the error is calculated too."""


def measure() -> dict[str, float]:
    """Measure speed and error of the kernels; takes about 30 s."""
    warm_up(fleet=True)
    simulator = Simulator(preset('incipient'))

    def one_second() -> None:
        for _ in range(25):
            simulator.advance(_BLOCK, 20.0, 25.4)

    one_second()
    per_second = _best(one_second) / (25 * _BLOCK / _RATE)

    mixed = [preset('incipient', defect=('inner', 'outer', 'ball')[i % 3]) for i in range(_FLEET)]
    for i, each in enumerate(mixed):
        defect = replace(each.defects[0], angle=each.defects[0].angle + 0.001 * i)
        mixed[i] = replace(each, defects=(defect,))
    fleet_time = _fleet_time(mixed, np.linspace(15.0, 35.0, _FLEET))
    alike_time = _fleet_time([preset('incipient')] * _FLEET, np.full(_FLEET, 25.4))

    alike = (Fleet([preset('incipient')] * _FLEET, threads=threads) for threads in (1, 2))
    one, two = (
        _best(partial(fleet.advance, _BLOCK, 20.0, 25.4), time.perf_counter) for fleet in alike
    )

    quiet = [preset(name, defect=place, jitter=0.0, noise=0.0) for name, place in _JUDGED]
    errors = np.array([_errors(each, int(_LONG * _RATE), 25.4) for each in quiet])
    harder = np.array(
        [
            _errors(
                preset('incipient', defect=place, load=load, jitter=0.0, noise=0.0),
                int(0.5 * _LONG * _RATE),
                hz,
            )
            for place, hz, load in _HARDER
        ]
    )
    clean, samples = quiet[0], int(_SHORT * _RATE)
    adaptive = {
        method: solve(clean, samples, method=method, rtol=1e-6).cost for method in ('LSODA', 'BDF')
    }
    return {
        'kernel_rtf': 1.0 / per_second,
        'kernel_error': float(errors[:, 0].max()),
        'kernel_error_harder': float(harder[:, 0].max()),
        'ratio_to_lsoda': adaptive['LSODA'] / per_second,
        'ratio_to_bdf': adaptive['BDF'] / per_second,
        'ratio_to_plain': _ratio_to_plain(replace(clean, waviness=0.0)),
        'fleet_bearings_per_core': _FLEET * _BLOCK / _RATE / fleet_time,
        'alike_bearings_per_core': _FLEET * _BLOCK / _RATE / alike_time,
        'fleet_two_threads': one / two,
        'fleet_error': float(errors[:, 1].max()),
        'fleet_error_harder': float(harder[:, 1].max()),
    }


def _fleet_time(parameters: list[TwinParameters], shaft_hz: np.ndarray) -> float:
    """Return the least processor time of a block whose temperatures all change, s."""
    fleet = Fleet(parameters, shaft_hz=shaft_hz)
    temperatures = np.linspace(20.0, 100.0, len(parameters))
    fleet.advance(_BLOCK, temperatures, shaft_hz)

    def one_block() -> None:
        nonlocal temperatures
        temperatures = 20.0 + (temperatures - 20.0 + 0.01) % 90.0
        fleet.advance(_BLOCK, temperatures, shaft_hz)

    return _best(one_block)


def _best(run: Callable[[], object], clock: Callable[[], float] = time.process_time) -> float:
    """Return the least time of ten runs, s; ``clock`` is the processor time by default."""

    def once() -> float:
        begin = clock()
        run()
        return clock() - begin

    return min(once() for _ in range(10))


def _ratio_to_plain(parameters: TwinParameters) -> float:
    """Return the time of fixed-step Runge-Kutta over the kernel's, at the kernel's error."""
    samples, hz = int(_SHORT * _RATE), 25.4
    reference, simulator = solve(parameters, samples, shaft_hz=hz), Simulator(parameters)
    block = simulator.advance(samples, 20.0, hz)
    error = _error(block.x, block.y, reference)
    ours = _best(partial(simulator.advance, samples, 20.0, hz)) / _SHORT
    errors, costs = [], []
    for steps in _STEPS:
        runs = [solve(parameters, samples, shaft_hz=hz, steps=steps) for _ in range(3)]
        errors.append(_error(runs[0].x, runs[0].y, reference))
        costs.append(min(run.cost for run in runs))
    logs = np.log(errors[::-1]), np.log(costs[::-1])
    return float(np.exp(np.interp(np.log(error), *logs))) / ours


def _errors(parameters: TwinParameters, samples: int, hz: float) -> tuple[float, float]:
    """Return the errors of kernel and fleet against an adaptive solver."""
    reference = solve(parameters, samples, shaft_hz=hz)
    single = Simulator(parameters, shaft_hz=hz).advance(samples, 20.0, hz)
    group = Fleet([parameters], shaft_hz=hz).advance(samples, 20.0, hz)
    return _error(single.x, single.y, reference), _error(group.x[0], group.y[0], reference)


def _error(x: np.ndarray, y: np.ndarray, reference: Reference) -> float:
    """Return the relative L2 error."""
    expected = np.array([reference.x, reference.y])
    return float(np.linalg.norm([x, y] - expected) / np.linalg.norm(expected))
