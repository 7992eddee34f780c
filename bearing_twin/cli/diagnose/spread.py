# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Many files, diagnosed on the cores of this machine or on a Dask cluster."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TYPE_CHECKING

from bearing_twin.cli.arguments import processes
from bearing_twin.cli.signal_arguments import unread
from bearing_twin.errors import BearingTwinError
from bearing_twin.process import end_with_parent, keep_freed_memory

if TYPE_CHECKING:
    from bearing_twin.cli.diagnose.task import Task

    _Diagnose = Callable[[Task], dict[str, Any]]


MOST_AT_ONCE = 16
"""Largest number of files in one task of Dask; their answers arrive together."""


def answers(
    tasks: Sequence[Task], *, jobs: int | None, dask: str | None
) -> Iterator[dict[str, Any]]:
    """
    Return the answers in the order of the tasks.

    Files are diagnosed by ``jobs`` processes (None: one per core), or by the workers of the Dask
    cluster whose scheduler has the address ``dask``. It is an error if Dask is not installed or
    does not answer.
    """
    if dask:
        return _on_dask(tasks, dask)
    # Imported only here: with a cluster, this process diagnoses no file.
    from bearing_twin.cli.diagnose.file import diagnose_file

    jobs = processes(jobs, len(tasks))
    if jobs == 1:
        return map(diagnose_file, tasks)
    return _on_cores(diagnose_file, tasks, jobs)


def _on_cores(diagnose: _Diagnose, tasks: Sequence[Task], jobs: int) -> Iterator[dict[str, Any]]:
    from bearing_twin.diagnosis.compilation import warm_up

    # Compiled or loaded once, where it is reported; else each process would do it again.
    warm_up()
    pool = ProcessPoolExecutor(jobs, initializer=end_with_parent)
    try:
        futures = [pool.submit(diagnose, task) for task in tasks]
        for task, future in zip(tasks, futures, strict=True):
            killed = isinstance(future.exception(), BrokenProcessPool)
            # A process for each file shows which one was the cause.
            yield _alone(diagnose, task) if killed else future.result()
    finally:
        # After an interrupt, or if nobody reads on, the other files are not diagnosed.
        pool.shutdown(cancel_futures=True)


def _alone(diagnose: _Diagnose, task: Task) -> dict[str, Any]:
    with ProcessPoolExecutor(1, initializer=end_with_parent) as pool:
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
        raise BearingTwinError("--dask needs Dask: pip install 'bearing_twin[dask]'") from None
    try:
        client = Client(address, timeout='10s')
    except (OSError, ValueError) as error:
        raise BearingTwinError(f'no Dask scheduler at {address}: {error}') from None
    with client:
        parts = batches(tasks, max(1, sum(client.nthreads().values())))
        # If a worker dies, the scheduler gives its files to another one.
        futures = deque(client.map(_diagnose_files, parts, pure=False, retries=3))
        for part in parts:
            # A worker keeps the answers as long as their future exists.
            future = futures.popleft()
            failure = future.exception()
            if failure is None:
                yield from future.result()
                continue
            # A task for each file shows which one was the cause.
            alone = client.map(_diagnose_files, [[task] for task in part], pure=False, retries=3)
            for task, single in zip(part, alone, strict=True):
                reason = single.exception()
                yield from single.result() if reason is None else [unread(task.path, str(reason))]


def batches(tasks: Sequence[Task], workers: int) -> list[Sequence[Task]]:
    """
    Return the tasks in parts that get smaller, so that no worker waits long at the end.

    Dask's overhead for a part is as long as a short file takes, so that a part has several files:
    half of a worker's share of the rest, rounded up (guided self-scheduling, Polychronopoulos and
    Kuck 1987), at most ``MOST_AT_ONCE``.

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

    # Dask makes its workers return freed memory to the system at once.
    keep_freed_memory()
    return [diagnose_file(task) for task in tasks]
