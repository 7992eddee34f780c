# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Notice that the middleware has locked itself up, and end a process that it would keep for ever.

Fast DDS, the default middleware of ROS 2, can lock up when another node leaves: the thread that
takes note of it holds the mutex of the discovery and waits for the thread of the timers, which
waits for that mutex (eProsima/Fast-DDS issue 6502, open in September 2026; of 3700 participants
that came and went beside each other, three did not end). From then on the node hears nothing and
others count it as dead, but it works on and reports no error. If it is told to end, it never does:
rclpy holds Python's lock while it waits for the middleware, so no Python code can run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
import ctypes
from pathlib import Path
import platform
import threading
import time

LEAVING = 8
"""Longest time for telling the other nodes of the end, s: launch kills after 10 s."""
LOOK = 10.0
"""Interval of looking at the threads of the middleware, s."""
LOOKS = 3
"""Number of looks at which a thread has not moved, after which it never will."""
PREFIX = 'dds.'
"""Begin of the names of Fast DDS's threads."""
_FUTEX = {'x86_64': '202', 'aarch64': '98'}
"""Number of the system call ``futex``, by processor (``asm/unistd.h``)."""
_WAIT = '0x80'
"""``FUTEX_WAIT_PRIVATE`` (``linux/futex.h``): glibc waits for a mutex so, and for a condition or
a semaphore by ``FUTEX_WAIT_BITSET``."""
_SIGEV_THREAD = 2
"""Option in ``asm-generic/siginfo.h``: a timer that calls a function in a thread of its own."""


class _Sigevent(ctypes.Structure):
    """``struct sigevent`` (``sigevent(3type)``)."""

    _fields_ = (
        ('value', ctypes.c_void_p),
        ('signal', ctypes.c_int),
        ('notify', ctypes.c_int),
        ('function', ctypes.c_void_p),
        ('rest', ctypes.c_byte * 40),
    )


class _Itimerspec(ctypes.Structure):
    """``struct itimerspec`` (``itimerspec(3type)``)."""

    _fields_ = (
        ('interval_s', ctypes.c_long),
        ('interval_ns', ctypes.c_long),
        ('value_s', ctypes.c_long),
        ('value_ns', ctypes.c_long),
    )


@contextmanager
def bounded(seconds: int, status: int) -> Iterator[None]:
    """
    End the process with ``status`` if the block takes longer than ``seconds``.

    The kernel's timer calls ``_exit`` in a thread that needs no Python: what Python has not
    written yet is lost.
    """
    libc = ctypes.CDLL(None, use_errno=True)
    leave = ctypes.cast(libc._exit, ctypes.c_void_p)
    event = _Sigevent(value=status, notify=_SIGEV_THREAD, function=leave)
    timer, when = ctypes.c_void_p(), _Itimerspec(value_s=seconds)
    if libc.timer_create(time.CLOCK_MONOTONIC, ctypes.byref(event), ctypes.byref(timer)):
        # No timers left: rather an end without a limit than none.
        yield
        return
    libc.timer_settime(timer, 0, ctypes.byref(when), None)
    try:
        yield
    finally:
        libc.timer_delete(timer)


def watch(report: Callable[[str], None]) -> None:
    """
    Look at the threads of the middleware from now on, in a thread.

    Parameters
    ----------
    report
        Function that is called once, in that thread, with the names of the threads that have not
        moved while they waited for a mutex.

    """

    def work() -> None:
        seen: dict[str, str] = {}
        looks: dict[str, int] = {}
        while not (stuck := [thread for thread, count in looks.items() if count >= LOOKS]):
            time.sleep(LOOK)
            now = _waiting()
            looks = {t: looks.get(t, 0) + 1 for t, where in now.items() if seen.get(t) == where}
            seen = now
        report(', '.join(sorted(stuck)))

    threading.Thread(target=work, name='middleware', daemon=True).start()


def _waiting() -> dict[str, str]:
    """Return the middleware's threads that wait for a mutex, and where and since when."""
    found: dict[str, str] = {}
    try:
        tasks = [*Path('/proc/self/task').iterdir()]
    except OSError:
        # No descriptor is left.
        return found
    for task in tasks:
        # A thread may end meanwhile; some sandboxes do not tell the system call.
        with suppress(OSError):
            name = (task / 'comm').read_text().strip()
            if name.startswith(PREFIX):
                call = (task / 'syscall').read_text()
                if call.split()[:3:2] == [_FUTEX.get(platform.machine()), _WAIT]:
                    switches = (task / 'status').read_text().rpartition('\nvoluntary')[2]
                    found[f'{name} ({task.name})'] = call + switches
    return found
