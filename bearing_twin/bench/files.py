# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Verdicts on many files: one process against two workers of Dask."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
import subprocess
import tempfile
import time
from typing import TYPE_CHECKING

from bearing_twin.dynamics import preset, Simulator
from bearing_twin.errors import BearingTwinError
from bearing_twin.ros.processes.launching import COMMAND
import numpy as np

if TYPE_CHECKING:
    from psutil import Process

FILES, SECONDS = 1000, 10
SHAFT_HZ = 25.4
WORKERS = 2
SETTLED = FILES // 5
"""Files after which a worker has loaded everything and allocated its largest arrays."""


def measure() -> dict[str, float]:
    """
    Diagnose the same files in one process and with two workers; measure the workers' growth.

    There are no figures without Dask.

    """
    try:
        import dask
        from distributed import LocalCluster
        from psutil import Process
    except ImportError:
        return {}
    with (
        tempfile.TemporaryDirectory() as name,
        dask.config.set({'distributed.worker.profile.enabled': False}),
        LocalCluster(
            n_workers=WORKERS, threads_per_worker=1, dashboard_address=':0', local_directory=name
        ) as cluster,
    ):
        names = _write(Path(name))
        workers = [Process(nanny.process.pid) for nanny in cluster.workers.values()]
        # A first run, in which the workers load their modules.
        _diagnose([*names[: 16 * WORKERS], '--dask', cluster.scheduler_address], workers)
        one, many = [*names, '--jobs', '1'], [*names, '--dask', cluster.scheduler_address]
        # In this order, as the speed of the machine varies.
        alone = _diagnose(one, [])[0]
        together, grown = _diagnose(many, workers)
        together += _diagnose(many, workers)[0]
        alone += _diagnose(one, [])[0]
    return {
        'dask_files_per_second': 2 * FILES / together,
        'dask_ratio': alone / together,
        'dask_worker_growth_mb': grown,
    }


def _write(folder: Path) -> list[str]:
    """Write the files of four machines; return ``FILES`` names that link to them."""
    for number, defect in enumerate(('none', 'inner', 'outer', 'ball')):
        twin = Simulator(preset('incipient', defect=defect))
        x = twin.advance(round(SECONDS * twin.sample_rate), 20.0, SHAFT_HZ).y
        np.savez(folder / f'{number}.npz', x=x, fs=twin.sample_rate, rpm=60.0 * SHAFT_HZ)
    paths = [folder / f'name{number}.npz' for number in range(FILES)]
    for number, path in enumerate(paths):
        path.symlink_to(folder / f'{number % 4}.npz')
    return list(map(str, paths))


def _diagnose(arguments: list[str], workers: Sequence[Process]) -> tuple[float, float]:
    """Return the elapsed time, s, and the largest growth of a worker, MB."""
    command = [*COMMAND, 'diagnose', '--json', '--bearing', '6307']
    began = time.perf_counter()
    sizes = []
    with subprocess.Popen([*command, *arguments], stdout=subprocess.PIPE, text=True) as process:
        for done, _ in enumerate(process.stdout or (), start=1):
            if done in (SETTLED, FILES):
                sizes.append([worker.memory_info().rss / 1e6 for worker in workers])
    took = time.perf_counter() - began
    if process.returncode:
        raise BearingTwinError(f'diagnose ended with status {process.returncode}')
    return took, max((after - before for before, after in zip(*sizes, strict=True)), default=0.0)
