# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Bring files to the disk in a thread of its own, so that nobody waits for it."""

from __future__ import annotations

from collections import deque
from concurrent import futures
import functools
import os
import sys
import threading
import time
from typing import TYPE_CHECKING, TypeVar

from bearing_twin.errors import BearingTwinError
from bearing_twin.wholefile import sync_folder

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from pathlib import Path


LONGEST = 10.0
"""Longest time that anybody waits for an answer of the disk, s."""
SILENT = f'the disk has not answered for {LONGEST:g} s'

T = TypeVar('T')


class DiskSync:
    """
    Call fsync for files and their folders, and do what else waits for the disk, in turn.

    What the operating system has been given survives the death of the process, not that of the
    power. fsync takes milliseconds to seconds, whatever else the disk is doing.
    """

    def __init__(self) -> None:
        self.problem = ''
        """Why the disk did not take what it was given; '' if it did. It stays."""
        self.longest = 0.0
        """Longest time that it took, s."""
        self._jobs: deque[Callable[[], None]] = deque()
        self._began = 0.0
        # A thread ends with its last job.
        self._lock = threading.Lock()

    @property
    def busy(self) -> bool:
        """Whether a request is not yet done."""
        return bool(self._jobs)

    @property
    def patience(self) -> float:
        """Time for which it is still waited for, s; 0 where it has not answered for too long."""
        return max(0.0, self._began + LONGEST - time.monotonic()) if self.busy else LONGEST

    def request(self, fd: int, folder: Path) -> None:
        """Have an open file brought to the disk; the caller may close it meanwhile."""
        self.do(functools.partial(self._sync, os.dup(fd), folder))

    def do(self, work: Callable[[], T]) -> Job[T]:
        """Have ``work`` done."""
        job = Job[T](self)
        with self._lock:
            self._jobs.append(functools.partial(job.do, work))
            if len(self._jobs) == 1:
                self._began = time.monotonic()
                threading.Thread(target=self._work, name='fsync', daemon=True).start()
        return job

    def settle(self) -> bool:
        """Wait until all is done, as long as the disk answers; return whether it is."""
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
        # The name of a new file is content of its folder.
        sync_folder(folder)


class Job(futures.Future[T]):
    """What somebody may wait for, or await, as long as the disk answers."""

    def __init__(self, disk: DiskSync) -> None:
        super().__init__()
        self._disk = disk

    def do(self, work: Callable[[], T]) -> None:
        """Do it; what ``work`` raises is raised for who waits."""
        try:
            self.set_result(work())
        except Exception as error:
            if not isinstance(error, BearingTwinError):
                # Perhaps nobody waits: a defect of ours must be seen.
                sys.excepthook(type(error), error, error.__traceback__)
            self.set_exception(error)

    def wait(self) -> T:
        """
        Return what the work returned.

        Raises
        ------
        BearingTwinError
            If the disk does not answer.

        """
        while not self.done() and (patience := self._disk.patience):
            futures.wait([self], patience)
        return self._outcome()

    def __await__(self) -> Generator[None, None, T]:
        """Let others work meanwhile; else as :meth:`wait`."""
        while not self.done() and self._disk.patience:
            yield
        return self._outcome()

    def _outcome(self) -> T:
        if not self.done():
            msg = f'{SILENT}; what was asked of it may still be done'
            raise BearingTwinError(msg)
        return self.result()
