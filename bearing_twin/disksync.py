# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Bring files to the disk in a thread of its own, so that nobody waits for it."""

from __future__ import annotations

import functools
import os
from queue import SimpleQueue
import threading
import time
from typing import TYPE_CHECKING

from bearing_twin.wholefile import sync_folder

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

__all__ = ['DiskSync']


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
        self._requests: SimpleQueue[Callable[[], None] | None] = SimpleQueue()
        # Each is written by one thread only.
        self._requested = self._done = 0
        self._thread: threading.Thread | None = None

    @property
    def busy(self) -> bool:
        """Whether a request is not yet done."""
        return self._requested > self._done

    def request(self, fd: int, folder: Path) -> None:
        """Have an open file brought to the disk; the caller may close it meanwhile."""
        self.do(functools.partial(_sync, os.dup(fd), folder))

    def do(self, work: Callable[[], None]) -> None:
        """Have ``work`` done; its OSError becomes :attr:`problem`."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._work, name='fsync', daemon=True)
            self._thread.start()
        self._requested += 1
        self._requests.put(work)

    def close(self, timeout: float) -> None:
        """Wait until everything is on the disk, at most ``timeout`` seconds."""
        if self._thread is not None:
            self._requests.put(None)
            self._thread.join(timeout)
            self._thread = None

    def _work(self) -> None:
        while (work := self._requests.get()) is not None:
            began = time.monotonic()
            try:
                work()
            except OSError as error:
                self.problem = f'{error.filename}: {error.strerror}'
            finally:
                self._done += 1
            self.longest = max(self.longest, time.monotonic() - began)


def _sync(fd: int, folder: Path) -> None:
    try:
        os.fsync(fd)
    except OSError as error:
        error.filename = folder
        raise
    finally:
        os.close(fd)
    # The name of a new file is content of its folder.
    sync_folder(folder)
