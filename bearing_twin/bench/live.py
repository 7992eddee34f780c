# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""How many bearings at 25.6 kHz one core carries live, with DDS publishing and without."""

from __future__ import annotations

import os
from pathlib import Path
import tempfile
import time

from bearing_twin.bench.end_to_end import cpu_seconds, wait_for
from bearing_twin.dynamics import Fleet, preset
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.reader import read_messages
from bearing_twin.ros.domain import own_domain
from bearing_twin.ros.launching import local_environment, NodeProcesses

__all__ = ['measure']

FEW, MANY = 2, 16
"""Bearings of the two runs whose difference is the cost of one bearing."""
SETTLE, SETTLE_DIAGNOSIS = 4.0, 14.0
"""Time that is not measured, s; windows of 8 s grow until the last diagnosis has a full one."""
MEASURED = 20.0
BLOCK, BLOCKS = 1024, 60


def measure() -> dict[str, float]:
    """
    Measure what one bearing costs.

    Returns
    -------
    dict
        ``live_bearings_per_core``: twins of a fleet that one core carries with vibration and state
        published over DDS to a recorder in another process; ``..._with_diagnosis``: with a
        diagnosis each in the same process, all of them on full windows; ``..._without_dds``: the
        equations of motion alone, with the state that each block publishes.
        ``live_share_per_bearing`` and ``live_share_of_the_process`` are the two parts of the
        first: of a core, for each bearing and for the process as such.

    Raises
    ------
    BearingTwinError
        If a fleet dropped blocks meanwhile: it took less than what it costs.

    """
    per_twin, process = _cost(diagnosis=False)
    per_both, process_of_both = _cost(diagnosis=True)
    without = _advance_share()
    return {
        'live_bearings_per_core': (1.0 - process) / per_twin,
        'live_bearings_per_core_with_diagnosis': (1.0 - process_of_both) / per_both,
        'live_bearings_per_core_without_dds': 1.0 / without,
        'live_share_per_bearing': per_twin,
        'live_share_of_the_process': process,
    }


def _advance_share() -> float:
    """CPU time of one twin's equations of motion in a fleet, and of its state, over real time."""
    fleet = Fleet([preset('incipient', defect='inner')] * MANY)
    fleet.advance(BLOCK, 20.0, 25.4)
    fleet.condition(0)
    began = time.process_time()
    for _ in range(BLOCKS):
        fleet.advance(BLOCK, 20.0, 25.4)
        for index in range(MANY):
            fleet.condition(index)
    spent = time.process_time() - began
    return spent * fleet.sample_rate / (BLOCKS * BLOCK * MANY)


def _cost(*, diagnosis: bool) -> tuple[float, float]:
    """Share of a core for each bearing, and for the process as such."""
    few, many = (_fleet_share(count, diagnosis=diagnosis) for count in (FEW, MANY))
    per_bearing = (many - few) / (MANY - FEW)
    return per_bearing, few - FEW * per_bearing


def _fleet_share(count: int, *, diagnosis: bool) -> float:
    """Share of a core of a fleet of ``count``."""
    with tempfile.TemporaryDirectory() as name, own_domain(os.getpid()) as domain:
        folder = Path(name)
        parts = 'twin: {defect: inner}' + (', diagnosis: {}' if diagnosis else '')
        assets = '\n'.join(f'  bearing_{k}: {{{parts}}}' for k in range(count))
        (folder / 'assets.yaml').write_text(f'assets:\n{assets}\n')
        environment = local_environment(domain)
        with NodeProcesses(folder / 'logs', environment) as nodes:
            nodes.start('recorder', {'output': str(folder / 'bag')})
            nodes.start('fleet', {'assets_file': str(folder / 'assets.yaml')})
            wait_for(folder / 'bag', nodes)
            time.sleep(SETTLE_DIAGNOSIS if diagnosis else SETTLE)
            began, cpu = time.time_ns(), cpu_seconds(nodes.pid('fleet'))
            time.sleep(MEASURED)
            ended = time.time_ns()
            share = (cpu_seconds(nodes.pid('fleet')) - cpu) / (ended - began) * 1e9
            nodes.check()
            nodes.end('fleet')
            nodes.end('recorder')
        states = read_messages(folder / 'bag', topics=['/bearing_0/twin_state'])
        counts = [m.decode().blocks_dropped for m in states if began <= m.log_time <= ended]
        dropped = counts[-1] - counts[0]
        if dropped:
            msg = f'a fleet of {count} dropped {dropped} blocks; leave more of the machine to it'
            raise BearingTwinError(msg)
        return share
