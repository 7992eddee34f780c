# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Speed and error of the kernels, against scipy's stiff solvers in the same run.

Everything is included: defect, sensor resonance, decimation to 25.6 kHz, jitter and noise, and for
the fleet a temperature that changes with every block. Times are those of the processor, best of
several, on one core.
"""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from bearing_twin.dynamics.fleet import Fleet
from bearing_twin.dynamics.presets import preset
from bearing_twin.dynamics.reference import solve
from bearing_twin.dynamics.simulator import Simulator, warm_up

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ['measure']

_RATE = 25600.0
_BLOCK = 1024
_FLEET = 512
_SHORT = 0.2
"""Simulated time of the comparison with the adaptive solvers, s."""


def measure() -> dict[str, float]:
    """Measure; takes about 20 s.

    Returns
    -------
    dict
        ``kernel_rtf``: simulated over processor time of one bearing in blocks of 1024.
        ``kernel_error``, ``fleet_error``: relative L2 against DOP853 at rtol 1e-8.
        ``ratio_to_lsoda``, ``ratio_to_bdf``: their processor time over the kernel's, at rtol 1e-6.
        ``fleet_bearings_per_core``: bearings that one core runs in real time.
    """
    warm_up()
    simulator = Simulator(preset('incipient'))

    def one_second() -> None:
        for _ in range(25):
            simulator.advance(_BLOCK, 20.0, 25.4)

    one_second()
    per_second = _best(one_second, 10) / (25 * _BLOCK / _RATE)

    fleet = Fleet([preset('incipient')] * _FLEET)
    temperatures = np.linspace(20.0, 100.0, _FLEET)
    fleet.advance(_BLOCK, temperatures, 25.4)

    def one_block() -> None:
        nonlocal temperatures
        temperatures = 20.0 + (temperatures - 20.0 + 0.01) % 90.0
        fleet.advance(_BLOCK, temperatures, 25.4)

    fleet_time = _best(one_block, 10)

    clean = preset('incipient', jitter=0.0, noise=0.0)
    samples = int(_SHORT * _RATE)
    reference = solve(clean, samples)
    expected = np.array([reference.x, reference.y])
    single = Simulator(clean).advance(samples, 20.0, 25.4)
    group = Fleet([clean]).advance(samples, 20.0, 25.4)
    adaptive = {
        method: _best(partial(solve, clean, samples, method=method, rtol=1e-6), 1) / _SHORT
        for method in ('LSODA', 'BDF')
    }
    return {
        'kernel_rtf': 1.0 / per_second,
        'kernel_error': _error(np.array([single.x, single.y]), expected),
        'ratio_to_lsoda': adaptive['LSODA'] / per_second,
        'ratio_to_bdf': adaptive['BDF'] / per_second,
        'fleet_bearings_per_core': _FLEET * _BLOCK / _RATE / fleet_time,
        'fleet_error': _error(np.array([group.x[0], group.y[0]]), expected),
    }


def _best(run: Callable[[], object], times: int) -> float:
    """Least processor time of several runs, s."""
    best = float('inf')
    for _ in range(times):
        begin = time.process_time()
        run()
        best = min(best, time.process_time() - begin)
    return best


def _error(got: np.ndarray, expected: np.ndarray) -> float:
    return float(np.linalg.norm(got - expected) / np.linalg.norm(expected))
