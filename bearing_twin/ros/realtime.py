# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Real-time behaviour of a publishing node: pacer, scheduling, memory locking, status."""

from __future__ import annotations

from collections.abc import Mapping
import ctypes
import os
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.parameters.realtime import THRESHOLDS
from bearing_twin.errors import BearingTwinError
from bearing_twin.ros.health import Level, Status
from bearing_twin.streams.pacer import Pacer

if TYPE_CHECKING:
    from bearing_twin.streams.pacer import LatenessReport
    from bearing_twin.streams.timing import CycleStatistics


MCL_CURRENT, MCL_FUTURE = 1, 2


def check_thresholds(values: Mapping[str, Any]) -> None:
    """Refuse a warning threshold above its error threshold."""
    for name, *_ in THRESHOLDS:
        warn, error = values[f'{name}.warn'], values[f'{name}.error']
        if not warn <= error:
            msg = f'{name}.warn={warn:g} must not be above {name}.error={error:g}'
            raise BearingTwinError(msg)


def build_pacer(values: Mapping[str, Any], behind: float = 0.0) -> Pacer:
    """Return the pacer for the parameters, for a node that may lag by ``behind`` s."""
    block, rate = values['block_size'], values['sample_rate']
    return Pacer(
        block=block,
        rate=rate,
        catch_up=values['catch_up_blocks'],
        late_after=values['late_after'],
        behind=int(behind * rate / block),
    )


def raise_priority(priority: int) -> str:
    """
    Give the calling thread a real-time priority; 0 leaves it normal.

    The scheduling in force is returned, for /diagnostics.
    """
    if not priority:
        return 'normal'
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except OSError as error:
        raise BearingTwinError(
            f'priority={priority} refused ({error.strerror}): allow it with '
            "'@realtime - rtprio 98' in /etc/security/limits.conf, or set priority to 0"
        ) from None
    return f'SCHED_FIFO {priority}'


def lock_memory() -> None:
    """Prevent all present and future memory of the process from being swapped out."""
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.mlockall(MCL_CURRENT | MCL_FUTURE):
        reason = os.strerror(ctypes.get_errno())
        raise BearingTwinError(
            f"lock_memory refused ({reason}): allow it with '@realtime - memlock unlimited' "
            'in /etc/security/limits.conf, or set lock_memory to false'
        )


def status(
    report: LatenessReport,
    cycles: CycleStatistics,
    values: Mapping[str, Any],
    *,
    period: float,
    scheduling: str,
    active: bool,
    simulated: bool,
    still: bool,
    clocks: int,
) -> Status:
    """
    Return the status of the deadlines for /diagnostics.

    Parameters
    ----------
    report
        Lateness and counts of blocks.
    cycles
        Periodicity and execution time.
    values
        Parameters, with the thresholds.
    period
        Time between deadlines, s.
    scheduling
        Scheduling in force.
    active, simulated, still
        Whether the node publishes, whether /clock paces it, and whether /clock stands still. In
        simulated time the thresholds do not apply, because blocks follow the steps of /clock.
    clocks
        Number of publishers of /clock; 1 while it runs, and while there are more that have not
        jumped since the last status.

    """
    periodicity, execution = cycles.periodicity, cycles.execution_time
    measures = (
        report.p99,
        abs(periodicity.mean - 1.0 / period),
        periodicity.std,
        execution.mean / period,
        execution.std / period,
    )
    level, texts = Level.OK, []
    limits = () if simulated else zip(THRESHOLDS, measures, strict=True)
    for (name, *_, text), value in limits:
        for threshold, what in ((f'{name}.error', Level.ERROR), (f'{name}.warn', Level.WARN)):
            if value > values[threshold]:
                level = max(level, what, key=lambda x: x.value)
                texts.append(text.format(value))
                break
    if report.recently_dropped:
        level = Level.ERROR
        texts.insert(0, f'{report.recently_dropped} of the last blocks dropped')
    kind = ''
    if not active:
        level, texts = Level.OK, ['not active']
    elif still and not clocks:
        level = Level.WARN
        texts = [
            'nothing publishes /clock, so no blocks are published: start its source, or the node '
            'without use_sim_time'
        ]
    elif clocks > 1:
        level, texts = Level.ERROR, [f'{clocks} publishers of /clock, whose times differ: end one']
    elif still:
        level, texts = Level.OK, ['/clock stands still, so no blocks are published']
    elif texts:
        # Which of the limits are exceeded changes from second to second on a busy machine.
        kind = 'dropped' if report.recently_dropped else 'late'
    return Status(
        level,
        '; '.join(texts) or ('in step with /clock' if simulated else 'in time'),
        {
            **periodicity.named('periodicity', 'hz'),
            'desired_periodicity_hz': 1.0 / period,
            **execution.scaled(1e6).named('execution_time', 'us'),
            'load_percent': 100.0 * execution.mean / period,
            'lateness_p50_ms': report.p50 * 1e3,
            'lateness_p99_ms': report.p99 * 1e3,
            'lateness_max_ms': report.worst * 1e3,
            'blocks_published': report.published,
            'blocks_late': report.late,
            'blocks_dropped': report.dropped,
            'clock_steps': report.clock_steps,
            'scheduling': scheduling,
        },
        kind,
    )
