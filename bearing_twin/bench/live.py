# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""How many bearings at 25.6 kHz one core carries live, with DDS publishing and without."""

from __future__ import annotations

import os
from pathlib import Path
import tempfile
import time
from typing import NamedTuple

from bearing_twin.bench.end_to_end import cpu_seconds, wait_for
from bearing_twin.dynamics import Fleet, preset
from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes.fleet import BLOCK
from bearing_twin.recording.reader import read_messages
from bearing_twin.ros.domain import own_domain
from bearing_twin.ros.launching import local_environment, NodeProcesses

FEW, MANY = 2, 16
"""Bearings of the two runs whose difference is the cost of one bearing."""
PROVED = 0.5
"""Part of the claimed bearings that is run to prove the claim."""
SETTLE, SETTLE_DIAGNOSIS = 4.0, 14.0
"""Time that is not measured, s; windows of 8 s grow until the last diagnosis has a full one."""
MEASURED = 20.0
BLOCKS = 15
"""Blocks of the equations alone."""


class FleetRun(NamedTuple):
    """What a live fleet took, and what became of its blocks."""

    share: float
    """Of a core."""
    late: int
    """Blocks published more than `late_after` behind their deadline."""
    missing: int
    """Blocks that were dropped, or that the recorder does not have."""


def measure() -> dict[str, float]:
    """
    Measure what one bearing costs, and run half as many as that allows.

    The meaning of each figure stands in :data:`bearing_twin.bench.figures.FIGURES`.

    Raises
    ------
    BearingTwinError
        If a fleet lost blocks while its cost was measured: it took less than what it costs.

    """
    per_twin, process = _cost(diagnosis=False)
    per_both, process_of_both = _cost(diagnosis=True)
    per_core, without = (1.0 - process) / per_twin, 1.0 / _advance_share()
    count = max(1, round(PROVED * per_core))
    proved = _run_fleet(count, diagnosis=False)
    return {
        'live_bearings_per_core': per_core,
        'live_bearings_run': float(count),
        'live_late_blocks': float(proved.late),
        'live_missing_blocks': float(proved.missing),
        'live_bearings_per_core_with_diagnosis': (1.0 - process_of_both) / per_both,
        'live_bearings_per_core_without_dds': without,
        'live_ratio': per_core / without,
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
    shares = []
    for count in (FEW, MANY):
        run = _run_fleet(count, diagnosis=diagnosis)
        if run.missing:
            msg = f'a fleet of {count} lost {run.missing} blocks; leave more of the machine to it'
            raise BearingTwinError(msg)
        shares.append(run.share)
    few, many = shares
    per_bearing = (many - few) / (MANY - FEW)
    return per_bearing, few - FEW * per_bearing


def _run_fleet(count: int, *, diagnosis: bool) -> FleetRun:
    """Run a fleet of ``count`` and a recorder."""
    with tempfile.TemporaryDirectory() as name, own_domain(os.getpid()) as domain:
        folder = Path(name)
        parts = 'twin: {defect: inner}' + (', diagnosis: {}' if diagnosis else '')
        assets = '\n'.join(f'  bearing_{k}: {{{parts}}}' for k in range(count))
        (folder / 'assets.yaml').write_text(f'assets:\n{assets}\n')
        environment = local_environment(domain)
        with NodeProcesses(folder / 'logs', environment) as nodes:
            nodes.start('recorder', {'output': str(folder / 'bag')})
            nodes.start('fleet', {'assets_file': str(folder / 'assets.yaml')})
            wait_for(folder / 'bag', nodes, bearings=count)
            time.sleep(SETTLE_DIAGNOSIS if diagnosis else SETTLE)
            began, cpu = time.time_ns(), cpu_seconds(nodes.pid('fleet'))
            time.sleep(MEASURED)
            ended = time.time_ns()
            share = (cpu_seconds(nodes.pid('fleet')) - cpu) / (ended - began) * 1e9
            nodes.check()
            nodes.end('fleet')
            nodes.end('recorder')
        return FleetRun(share, *_blocks(folder / 'bag', count, began, ended))


def _blocks(bag: Path, count: int, began: int, ended: int) -> tuple[int, int]:
    """Count late and missing blocks of all bearings between two times, ns."""
    late: dict[str, list[int]] = {}
    firsts: dict[str, list[int]] = {}
    topics = [f'/bearing_{k}/{name}' for k in range(count) for name in ('vibration', 'twin_state')]
    for message in read_messages(bag, topics=topics):
        if not began <= message.log_time <= ended:
            continue
        decoded = message.decode()
        if message.topic.endswith('/twin_state'):
            late.setdefault(message.topic, []).append(int(decoded.blocks_late))
        else:
            firsts.setdefault(message.topic, []).append(int(decoded.first_sample))
    if len(firsts) < count:
        msg = f'{count - len(firsts)} of {count} bearings were not recorded'
        raise BearingTwinError(msg)
    missing = sum((f[-1] - f[0]) // BLOCK + 1 - len(f) for f in firsts.values())
    # A block is late for all bearings at once.
    return max((counts[-1] - counts[0] for counts in late.values()), default=0), missing
