# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Offline replay: twin, diagnosis and MCAP writing against real time."""

from __future__ import annotations

from pathlib import Path
import tempfile
import time
from typing import TYPE_CHECKING

from bearing_twin.dynamics import preset, Simulator
from bearing_twin.offline.run import run_offline
from bearing_twin.offline.verify import reproduce
from bearing_twin.recording.schedule import paper_schedule, write_temperature_recording
import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

_RUNS = 3
_BLOCK = 1024


def measure() -> dict[str, float]:
    """
    Run the paper's schedule offline, and verify the recording that comes out.

    The fastest of three runs counts, after one that loads and compiles; the ratios are to the
    equations of the same twin at the same temperatures in the same run.
    The meaning of each figure stands in :data:`bearing_twin.bench.figures.FIGURES`.

    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        source = folder / 'schedule.mcap'
        times, temperatures = paper_schedule()
        write_temperature_recording(source, times, temperatures, source='bench')
        took, verified, alone = [], [], []
        for run in range(_RUNS + 1):
            began = time.perf_counter()
            report = run_offline(source, folder / f'run{run}', twin={'defect': 'inner'})
            took.append(time.perf_counter() - began)
            began = time.perf_counter()
            reproduce(folder / f'run{run}')
            verified.append(time.perf_counter() - began)
            alone.append(_equations(report.duration, times, temperatures))
    offline, verify, equations = (min(each[1:]) for each in (took, verified, alone))
    return {
        'offline_rtf': report.duration / offline,
        'offline_ratio': equations / offline,
        'verify_rtf': report.duration / verify,
        'verify_ratio': equations / verify,
    }


def _equations(
    duration: float, times: npt.NDArray[np.float64], temperatures: npt.NDArray[np.float64]
) -> float:
    """Return the time that the equations of the twin alone take, s."""
    simulator = Simulator(preset('paper'))
    ends = np.arange(_BLOCK, duration * simulator.sample_rate, _BLOCK) / simulator.sample_rate
    course = np.interp(ends, times - times[0], temperatures)
    began = time.perf_counter()
    for temperature in course:
        simulator.advance(_BLOCK, temperature, 25.4)
    return time.perf_counter() - began
