# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Speed of offline replay: twin, diagnosis and MCAP writing against real time."""

from __future__ import annotations

from pathlib import Path
import tempfile
import time
from typing import NamedTuple

from bearing_twin.dynamics import preset, Simulator
from bearing_twin.offline.run import run_offline
from bearing_twin.offline.verify import reproduce
from bearing_twin.recording.temperature import paper_schedule, write_temperature_recording
import numpy as np
from numpy.typing import NDArray

_RUNS = 3
_BLOCK = 1024
_HELD = 20.0
"""Temperature at which `kernel_rtf` is measured, degC."""


class _Times(NamedTuple):
    """Times of a run of one twin, s; the fastest of several runs."""

    offline: float
    verify: float
    equations: float
    """Equations of the twin alone, at the same temperatures."""
    held: float
    """Equations of the twin alone, for the same time at one temperature."""
    duration: float
    """Recorded duration, s."""


def measure() -> dict[str, float]:
    """
    Run the paper's schedule offline, and verify the resulting recording.

    The fastest of three runs counts, after one that loads and compiles. This is done with the
    default twin, and with the twin of `kernel_rtf`, whose equations are about twice as fast.

    """
    default, kernel = _run('paper'), _run('incipient')
    return {
        'offline_rtf': default.duration / default.offline,
        'offline_ratio': default.equations / default.offline,
        'offline_kernel_ratio': kernel.held / kernel.offline,
        'verify_rtf': default.duration / default.verify,
        'verify_ratio': default.equations / default.verify,
        'verify_kernel_ratio': kernel.held / kernel.verify,
    }


def _run(name: str) -> _Times:
    """Run and verify the twin of a preset."""
    times, temperatures = paper_schedule()
    took = []
    with tempfile.TemporaryDirectory() as where:
        folder = Path(where)
        source = folder / 'schedule.mcap'
        write_temperature_recording(source, times, temperatures, source='bench')
        for run in range(_RUNS + 1):
            twin = {'preset': name, 'defect': 'inner'}
            began = time.perf_counter()
            report = run_offline(source, folder / f'run{run}', twin=twin)
            offline = time.perf_counter() - began
            began = time.perf_counter()
            reproduce(folder / f'run{run}')
            verified = time.perf_counter() - began
            ends = np.arange(_BLOCK / 25600.0, report.duration, _BLOCK / 25600.0)
            course = np.interp(ends, times - times[0], temperatures)
            equations, held = (
                _equations(name, each) for each in (course, np.full(len(course), _HELD))
            )
            took.append(_Times(offline, verified, equations, held, report.duration))
    return _Times(*(min(each) for each in zip(*took[1:], strict=True)))


def _equations(name: str, course: NDArray[np.float64]) -> float:
    """Return the time of a twin's equations alone, s, with one block at each temperature."""
    simulator = Simulator(preset(name, defect='inner'))
    began = time.perf_counter()
    for temperature in course:
        simulator.advance(_BLOCK, temperature, 25.4)
    return time.perf_counter() - began
