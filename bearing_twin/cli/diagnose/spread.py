# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Many files, diagnosed on the cores of this machine or on a Dask cluster."""

from __future__ import annotations

from collections import deque
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TYPE_CHECKING

from bearing_twin.cli.signal_arguments import unread
from bearing_twin.cli.terminal import processes
from bearing_twin.errors import BearingTwinError
from bearing_twin.memory import keep_freed_memory

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from bearing_twin.cli.diagnose.task import Task

    _Diagnose = Callable[[Task], dict[str, Any]]


MOST_AT_ONCE = 16
"""Most files of one task of Dask; answers come as often."""


def answers(
    tasks: Sequence[Task], *, jobs: int | None = None, dask: str = ''
) -> Iterator[dict[str, Any]]:
    """
    Return the answers in the order of the tasks, whoever has worked them out.

    These are ``jobs`` processes, or the workers of the Dask cluster whose scheduler has the
    address ``dask``. One that is not installed or does not answer is an error.
    """
    if dask:
        return _on_dask(tasks, dask)
    # Imported after that: who gives files to a cluster diagnoses none.
    from bearing_twin.cli.diagnose.file import diagnose_file

    jobs = processes(jobs, len(tasks))
    if jobs == 1:
        return map(diagnose_file, tasks)
    return _on_cores(diagnose_file, tasks, jobs)


def _on_cores(diagnose: _Diagnose, tasks: Sequence[Task], jobs: int) -> Iterator[dict[str, Any]]:
    from bearing_twin.diagnosis.warming import warm_up

    # Compiled or loaded once, where it is told of; each process would do it anew.
    warm_up()
    with ProcessPoolExecutor(jobs) as pool:
        futures = [pool.submit(diagnose, task) for task in tasks]
        for task, future in zip(tasks, futures, strict=True):
            killed = isinstance(future.exception(), BrokenProcessPool)
            # Which file it was shows when each has a process of its own.
            yield _alone(diagnose, task) if killed else future.result()


def _alone(diagnose: _Diagnose, task: Task) -> dict[str, Any]:
    with ProcessPoolExecutor(1) as pool:
        try:
            return pool.submit(diagnose, task).result()
        except BrokenProcessPool:
            return unread(
                task.path, 'the process that read it was killed; is there enough memory?'
            )


def _on_dask(tasks: Sequence[Task], address: str) -> Iterator[dict[str, Any]]:
    try:
        from dask.distributed import Client
    except ImportError:
        msg = "--dask needs Dask: pip install 'bearing_twin[dask]'"
        raise BearingTwinError(msg) from None
    try:
        client = Client(address, timeout='10s')
    except (OSError, ValueError) as error:
        msg = f'no Dask scheduler at {address}: {error}'
        raise BearingTwinError(msg) from None
    with client:
        parts = batches(tasks, max(1, sum(client.nthreads().values())))
        # A worker that dies takes no file with it: the scheduler gives its files to another.
        futures = deque(client.map(_diagnose_files, parts, pure=False, retries=3))
        for part in parts:
            # A worker keeps answers for as long as there is a future of them.
            future = futures.popleft()
            failure = future.exception()
            if failure is None:
                yield from future.result()
                continue
            # Which file it was shows when each is a task of its own.
            alone = client.map(_diagnose_files, [[task] for task in part], pure=False, retries=3)
            for task, single in zip(part, alone, strict=True):
                reason = single.exception()
                yield from single.result() if reason is None else [unread(task.path, str(reason))]


def batches(tasks: Sequence[Task], workers: int) -> list[Sequence[Task]]:
    """
    Return the tasks in parts that get smaller, so that no worker waits long at the end.

    Dask spends as long on a part as a short file takes, so that several files are one. A part is
    half of a worker's share of what is left, rounded up (guided self-scheduling, Polychronopoulos
    and Kuck 1987).

    >>> [len(part) for part in batches(range(50), 2)]
    [13, 10, 7, 5, 4, 3, 2, 2, 1, 1, 1, 1]

    """
    parts: list[Sequence[Task]] = []
    start = 0
    while left := len(tasks) - start:
        size = min(MOST_AT_ONCE, -(-left // (2 * workers)))
        parts.append(tasks[start : start + size])
        start += size
    return parts


def _diagnose_files(tasks: Sequence[Task]) -> list[dict[str, Any]]:
    from bearing_twin.cli.diagnose.file import diagnose_file

    # Dask has its workers give all that they free back to the system at once.
    keep_freed_memory()
    return [diagnose_file(task) for task in tasks]
