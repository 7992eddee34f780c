# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Settings of a process: memory that it keeps, search for garbage, its end by signal or parent."""

from __future__ import annotations

import ctypes
import gc
import os
import signal
import threading
import time

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3  # malloc.h of glibc
LARGEST = 32 * 1024 * 1024
"""Largest block that is kept, bytes; glibc takes no higher threshold."""


def keep_freed_memory() -> bool:
    """
    Let the C library keep freed blocks of up to 32 MiB for the next allocation.

    By default glibc returns arrays of megabytes to the system as soon as they are freed, and each
    page of the next array causes a page fault. That takes a third of the time of a diagnosis. With
    this setting the process never shrinks, as is required under ``mlockall``. Programs decide
    this, not libraries: nodes and commands call it when they start.

    Returns
    -------
    bool
        Whether the C library has accepted the setting; only glibc has it.

    """
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except AttributeError:
        return False
    return bool(mallopt(M_MMAP_THRESHOLD, LARGEST) and mallopt(M_TRIM_THRESHOLD, 2 * LARGEST))


def begin_collection() -> None:
    """
    Look for garbage from now on, where that has been switched off while the process loads.

    What the libraries have made stays, and is left out: to go through it again and again takes a
    third of a start.

    Examples
    --------
    >>> gc.disable()
    >>> begin_collection()
    >>> gc.isenabled()
    True

    """
    if not gc.isenabled():
        gc.freeze()
        gc.enable()


class Terminated(KeyboardInterrupt):
    """SIGTERM has come: as Ctrl-C, but the exit status is 143."""


def end_as_interrupted() -> None:
    """
    Let SIGTERM end this process as Ctrl-C does: what it has begun to write is removed.

    Python would end at once otherwise, and leave temporary files and folders behind. Processes of
    a pool end at once: at Ctrl-C the terminal interrupts them, too. Another handler of SIGTERM is
    kept, and only the main thread can set one.
    """
    owner = os.getpid()

    def end(number: int, _frame: object) -> None:
        if os.getpid() != owner:
            # A fork.
            signal.signal(number, signal.SIG_DFL)
            os.kill(os.getpid(), number)
            return
        from multiprocessing import active_children

        for child in active_children():
            child.terminate()
        raise Terminated

    main = threading.current_thread() is threading.main_thread()
    if main and signal.getsignal(signal.SIGTERM) == signal.SIG_DFL:
        signal.signal(signal.SIGTERM, end)


def end_with_parent() -> None:
    """
    Let a process of multiprocessing end, even in the middle of a task, when its parent has ended.

    The processes of a pool of the standard library would wait for tasks forever after their parent
    was killed: each of them holds the pipe open through which they come. The parent may have been
    killed while this process loaded.
    """
    from multiprocessing import parent_process

    owner = parent_process()
    parent = owner.pid if owner else os.getppid()

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(1.0)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
