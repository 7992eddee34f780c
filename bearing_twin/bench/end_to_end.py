# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Live run with the real processes: processor time of one bearing, lateness of its blocks."""

from __future__ import annotations

from collections.abc import Callable
import os
from pathlib import Path
import tempfile
import time

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.reader import read_messages
from bearing_twin.ros.processes.domain import own_domain, server_port
from bearing_twin.ros.processes.launching import local_environment, NodeProcesses
from bearing_twin.stamps import stamp_ns
import numpy as np
import psutil

START_TIMEOUT = 600.0
RECORDED = 100_000
"""Size from which on a recording has blocks, bytes per bearing."""
SETTLE = 3.0
"""Time after which discovery and the first, short windows are over, s."""
STEP = 30.0
"""Time between two checks that all processes still run, s."""
SHAFT_HZ = 25.4
NODES = ('twin', 'diagnosis', 'recorder')


def live_run(
    seconds: float, *, calibrate: bool, progress: Callable[[float], None]
) -> dict[str, float]:
    """
    Run twin, diagnosis and recorder (MCAP and Rerun, served and saved) for one bearing.

    Parameters
    ----------
    seconds
        Length of the measurement, s.
    calibrate
        Whether a calibration node fits the twin meanwhile.
    progress
        Called with the elapsed seconds, every half minute.

    """
    with tempfile.TemporaryDirectory() as name, own_domain(os.getpid()) as domain:
        folder = Path(name)
        environment = local_environment(domain)
        with NodeProcesses(folder / 'logs', environment) as nodes:
            nodes.start(
                'recorder',
                {
                    'output': str(folder / 'bag'),
                    'rerun_file': str(folder / 'view.rrd'),
                    'rerun_port': server_port(domain),
                },
            )
            nodes.start('diagnosis', {})
            nodes.start('twin', {'defect': 'inner'})
            if calibrate:
                nodes.start('calibration', {'shaft_hz': SHAFT_HZ})
            wait_for(folder / 'bag', nodes)
            time.sleep(SETTLE)
            began, cpu = time.time_ns(), {node: cpu_seconds(nodes.pid(node)) for node in NODES}
            _watch(nodes, seconds, progress)
            ended = time.time_ns()
            share = {
                node: (cpu_seconds(nodes.pid(node)) - cpu[node]) / (ended - began) * 1e9
                for node in NODES
            }
            nodes.check()
            for node in (*(['calibration'] if calibrate else []), 'twin', 'diagnosis', 'recorder'):
                nodes.end(node)
        return {
            'core_share': sum(share.values()),
            **{f'core_share_{node}': value for node, value in share.items()},
            **punctuality(folder / 'bag', began, ended, calibrate=calibrate),
        }


def _watch(nodes: NodeProcesses, seconds: float, progress: Callable[[float], None]) -> None:
    began = time.monotonic()
    while (passed := time.monotonic() - began) < seconds:
        time.sleep(min(STEP, seconds - passed))
        nodes.check()
        progress(time.monotonic() - began)


def wait_for(
    bag: Path, nodes: NodeProcesses, *, bearings: int = 1, within: float = START_TIMEOUT
) -> None:
    """
    Wait until a recording has blocks of each of ``bearings`` bearings.

    Raises
    ------
    BearingTwinError
        If a process ends, or there are no blocks after ``within`` seconds.

    """
    deadline = time.monotonic() + within
    while sum(path.stat().st_size for path in bag.glob('*.mcap')) < RECORDED * bearings:
        nodes.check()
        if time.monotonic() > deadline:
            msg = f'blocks of {bearings} bearings were not recorded within {within:g} s'
            raise BearingTwinError(msg)
        time.sleep(0.2)


def cpu_seconds(pid: int) -> float:
    """Return the processor time of a process with all its threads, s."""
    times = psutil.Process(pid).cpu_times()
    return times.user + times.system


def punctuality(bag: Path, began: int, ended: int, *, calibrate: bool) -> dict[str, float]:
    """
    Return the figures of the blocks in a recording from ``began`` to ``ended``, ns.

    Raises
    ------
    BearingTwinError
        If there is no block, or a second twin published on the same topics.

    """
    lateness, delivery, indices, drops = [], [], [], []
    period, costs = 0.0, []
    for message in read_messages(bag):
        if not began <= message.log_time <= ended:
            continue
        if message.topic == '/vibration':
            block = message.decode()
            period = block.y.size / block.sample_rate
            taken = stamp_ns(block.header.stamp) * 1e-9 + period
            delivery.append(message.log_time * 1e-9 - taken)
            indices.append(int(block.first_sample) // block.y.size)
        elif message.topic == '/twin_state':
            state = message.decode()
            lateness.append(state.lateness)
            drops.append(int(state.blocks_dropped))
        elif message.topic == '/calibration':
            costs.append(float(message.decode().cost))
    if not lateness or not delivery:
        raise BearingTwinError('the recording of the live run holds no block')
    if twice := len(indices) - len(set(indices)):
        raise BearingTwinError(
            f'{twice} blocks of the live run were recorded twice: another twin published in its '
            'ROS domain; end what else runs there and measure again'
        )
    late = np.array(lateness)
    dropped = drops[-1] - drops[0]
    return {
        **({'fits': float(len(costs))} if calibrate else {}),
        **({'fit_cost_s': max(costs)} if costs else {}),
        'blocks': float(len(late)),
        'late_blocks': float((late > period).sum()),
        'dropped_blocks': float(dropped),
        'lost_blocks': float(indices[-1] - indices[0] + 1 - len(indices) - dropped),
        'lateness_p50_ms': 1e3 * float(np.percentile(late, 50)),
        'lateness_p99_ms': 1e3 * float(np.percentile(late, 99)),
        'lateness_max_ms': 1e3 * float(late.max()),
        'delivery_p99_ms': 1e3 * float(np.percentile(delivery, 99)),
        'delivery_max_ms': 1e3 * float(np.max(delivery)),
    }
