# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Synchronise files with the disk in a background thread, so that the caller does not wait."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator
from concurrent import futures
import functools
import os
from pathlib import Path
import sys
import threading
import time
from typing import TypeVar

from bearing_twin.errors import BearingTwinError
from bearing_twin.wholefile import sync_folder

LONGEST = 10.0
"""Longest time to wait for an answer of the disk, s."""
SILENT = f'the disk has not answered for {LONGEST:g} s'

T = TypeVar('T')


class DiskSync:
    """
    Call fsync for files and their folders, and do other work on the disk, one after the other.

    Data written to the operating system survives a crash of the process, but not a power loss.
    fsync takes milliseconds to seconds, depending on the load of the disk.
    """

    def __init__(self) -> None:
        self.problem = ''
        """Reason of the last failed fsync; '' if none failed. It is never cleared."""
        self.longest = 0.0
        """Longest time that one request took, s."""
        self._jobs: deque[Callable[[], None]] = deque()
        self._began = 0.0
        # The thread ends when no job is left; the next request starts a new one.
        self._lock = threading.Lock()

    @property
    def busy(self) -> bool:
        """Whether a request is still waiting or running."""
        return bool(self._jobs)

    @property
    def patience(self) -> float:
        """Time left to wait for the disk, s; 0 if it has not answered for ``LONGEST``."""
        return max(0.0, self._began + LONGEST - time.monotonic()) if self.busy else LONGEST

    def request(self, fd: int, folder: Path) -> None:
        """Request the fsync of an open file; the caller may close it meanwhile."""
        try:
            kept = os.dup(fd)
        except OSError as error:
            # No descriptor is left.
            self.problem = f'{folder}: {error.strerror}'
            return
        self.do(functools.partial(self._sync, kept, folder))

    def do(self, work: Callable[[], T]) -> Job[T]:
        """Queue ``work`` for the background thread; return a future of its result."""
        job = Job[T](self)
        with self._lock:
            self._jobs.append(functools.partial(job.do, work))
            idle = len(self._jobs) == 1
            if idle:
                self._began = time.monotonic()
        if idle:
            try:
                threading.Thread(target=self._work, name='fsync', daemon=True).start()
            except RuntimeError:
                # The system has no further thread: wait for the disk.
                self._work()
        return job

    def settle(self) -> bool:
        """Wait until all requests are done; return False if the disk does not answer."""
        try:
            self.do(int).wait()
        except BearingTwinError:
            return False
        return True

    def _work(self) -> None:
        while True:
            self._jobs[0]()
            now = time.monotonic()
            self.longest = max(self.longest, now - self._began)
            with self._lock:
                self._began = now
                self._jobs.popleft()
                if not self._jobs:
                    return

    def _sync(self, fd: int, folder: Path) -> None:
        try:
            os.fsync(fd)
        except OSError as error:
            self.problem = f'{folder}: {error.strerror}'
        finally:
            os.close(fd)
        # The name of a new file is stored in its folder.
        sync_folder(folder)


class Job(futures.Future[T]):
    """Future of one request: wait for it or await it, as long as the disk answers."""

    def __init__(self, disk: DiskSync) -> None:
        super().__init__()
        self._disk = disk

    def do(self, work: Callable[[], T]) -> None:
        """Run ``work``; its exception, if any, is raised again in :meth:`wait`."""
        try:
            self.set_result(work())
        except Exception as error:
            if not isinstance(error, BearingTwinError):
                # A programming error must be visible, even if nobody waits for the job.
                sys.excepthook(type(error), error, error.__traceback__)
            self.set_exception(error)

    def wait(self) -> T:
        """
        Return the result of the work.

        Raises
        ------
        BearingTwinError
            If the disk does not answer.

        """
        while not self.done() and (patience := self._disk.patience):
            futures.wait([self], patience)
        return self._outcome()

    def __await__(self) -> Generator[None, None, T]:
        """Wait as :meth:`wait` does, and let other coroutines run meanwhile."""
        while not self.done() and self._disk.patience:
            yield
        return self._outcome()

    def _outcome(self) -> T:
        if not self.done():
            raise BearingTwinError(f'{SILENT}; what was asked of it may still be done')
        return self.result()
