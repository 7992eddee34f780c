# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Offline replay: twin, diagnosis and MCAP writing against real time."""

from __future__ import annotations

from pathlib import Path
import tempfile
import time

from bearing_twin.offline.run import run_offline
from bearing_twin.offline.verify import reproduce
from bearing_twin.recording.schedule import paper_schedule, write_temperature_recording

RUNS = 3


def measure() -> dict[str, float]:
    """
    Run the paper's schedule offline, and verify the recording that comes out.

    The fastest of three runs counts, after one that loads and compiles.
    The meaning of each figure stands in :data:`bearing_twin.bench.figures.FIGURES`.

    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        source = folder / 'schedule.mcap'
        times, temperatures = paper_schedule()
        write_temperature_recording(source, times, temperatures, source='bench')
        took = []
        for run in range(RUNS + 1):
            began = time.perf_counter()
            report = run_offline(source, folder / f'run{run}', twin={'defect': 'inner'})
            took.append(time.perf_counter() - began)
        began = time.perf_counter()
        reproduce(folder / 'run0')
        verified = time.perf_counter() - began
    return {
        'offline_rtf': report.duration / min(took[1:]),
        'verify_rtf': report.duration / verified,
    }
