# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A middleware that locks itself up is noticed, and keeps no process and no recording."""

from __future__ import annotations

from concurrent.futures import Future
import ctypes
import errno
import os
from pathlib import Path
import signal
import subprocess
import sys
from threading import Thread
import time
from typing import TYPE_CHECKING

from bearing_twin.recording.reader import recording_info
from bearing_twin.ros.processes.deadlock import _waiting, LEAVING
from commands import python
import pytest

if TYPE_CHECKING:
    from bearing_twin.ros.processes.launching import NodeProcesses
    from probe import Probe

ROOT = Path(__file__).parents[2]
PTRACE_SEIZE, PTRACE_INTERRUPT, WALL = 0x4206, 0x4207, 0x40000000
"""Of ``linux/ptrace.h`` and ``linux/wait.h``."""

LOCKED = """
import ctypes, os, sys, threading, time
libc = ctypes.CDLL(None)
mutex = ctypes.create_string_buffer(64)
libc.pthread_mutex_init(mutex, None)
libc.pthread_mutex_lock(mutex)

def lock():
    while len(sys.argv) > 1 and not os.path.exists(sys.argv[1]):
        time.sleep(0.05)
    libc.prctl(15, b'dds.locked', 0, 0, 0)
    libc.pthread_mutex_lock(mutex)

def wait():
    libc.prctl(15, b'dds.waiting', 0, 0, 0)
    threading.Event().wait()

for target in (lock, wait):
    threading.Thread(target=target, daemon=True).start()
from bearing_twin.ros.processes import deadlock
deadlock.LOOK = 0.2
"""
"""A thread that waits for a mutex for ever, beside one that waits for a condition.

The first begins when a file exists, if one is given.
"""


def test_a_call_that_keeps_the_lock_of_python_ends_in_time_with_the_status() -> None:
    code = (
        'import ctypes; from bearing_twin.ros.processes.deadlock import bounded\n'
        'with bounded(1, 7): ctypes.PyDLL(None).pause()'
    )
    began = time.monotonic()
    assert python('-c', code, cwd=ROOT).returncode == 7
    assert time.monotonic() - began < 30.0


def test_a_block_that_ends_in_time_leaves_no_timer() -> None:
    code = (
        'import sys, time; from bearing_twin.ros.processes.deadlock import bounded\n'
        'with bounded(1, 7): pass\n'
        'time.sleep(1.5); sys.exit(3)'
    )
    assert python('-c', code, cwd=ROOT).returncode == 3


def test_only_a_thread_that_waits_for_a_mutex_counts_as_locked() -> None:
    code = LOCKED + (
        'told = []; come = threading.Event()\n'
        'deadlock.watch(lambda threads: (told.append(threads), come.set()))\n'
        'assert come.wait(60.0); print(*told)'
    )
    ran = python('-c', code, cwd=ROOT)
    assert ran.stdout.startswith('dds.locked ('), ran.stderr
    assert 'waiting' not in ran.stdout


def stop_thread(thread: int) -> None:
    """Stop one thread of another process for ever, and that one only."""
    libc = ctypes.CDLL(None, use_errno=True)
    libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
    stopped: Future[None] = Future()

    def trace() -> None:
        for request in (PTRACE_SEIZE, PTRACE_INTERRUPT):
            if libc.ptrace(request, thread, None, None):
                stopped.set_exception(OSError(ctypes.get_errno(), 'ptrace'))
                return
        os.waitpid(thread, WALL)
        stopped.set_result(None)
        # Its process has not ended for its parent before the end of the thread is taken, too.
        os.waitpid(thread, WALL)

    Thread(target=trace, daemon=True).start()
    stopped.result(60.0)


def stop_timers(process: int) -> int:
    """Stop the threads of Fast DDS's timers, for which the end of a participant waits."""
    tasks = Path(f'/proc/{process}/task').iterdir()
    timers = [int(t.name) for t in tasks if (t / 'comm').read_text().startswith('dds.ev.')]
    for timer in timers:
        stop_thread(timer)
    return len(timers)


@pytest.mark.ros
def test_a_node_whose_middleware_is_locked_ends_with_an_error(
    ros_domain: int, tmp_path: Path
) -> None:
    bag = tmp_path / 'bag'
    code = LOCKED + (
        'from bearing_twin.cli import main\n'
        f"sys.exit(main(['run', 'recorder', '--ros-args', '-p', 'output:={bag}']))"
    )
    ran = python('-c', code, bag, cwd=ROOT)
    assert ran.returncode == 1
    assert 'the middleware has locked itself up (dds.locked (' in ran.stderr
    assert recording_info(bag).finished


@pytest.mark.ros
def test_a_node_ends_in_order_although_the_middleware_never_answers(
    nodes: NodeProcesses, probe: Probe, tmp_path: Path
) -> None:
    bag = tmp_path / 'bag'
    nodes.start('recorder', {'output': str(bag)})
    probe.until_active('recorder')
    assert stop_timers(nodes.pid('recorder'))
    began = time.monotonic()
    assert nodes.end('recorder', by=signal.SIGINT) == 0
    assert time.monotonic() - began >= LEAVING
    assert recording_info(bag).finished


@pytest.mark.ros
@pytest.mark.parametrize(
    'work',
    ['from bearing_twin.cli.demo.watch import Watcher\nwith Watcher(): input("joined\\n")',
     'from bearing_twin.ros.processes.domain import inhabitants\n'
     'inhabitants(int(os.environ["ROS_DOMAIN_ID"]), 10.0)'],
    ids=['demo', 'probe'],
)  # fmt: skip
def test_a_command_ends_although_the_middleware_never_answers(ros_domain: int, work: str) -> None:
    with subprocess.Popen(
        [sys.executable, '-c', f'import os\n{work}'], cwd=ROOT, stdin=subprocess.PIPE
    ) as command:
        try:
            deadline = time.monotonic() + 60.0
            while not stop_timers(command.pid) and time.monotonic() < deadline:
                time.sleep(3.0)
            command.communicate(b'\n', timeout=60.0)
        finally:
            command.kill()
    assert command.returncode == 1


def test_without_a_descriptor_no_thread_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_: Path) -> None:
        raise OSError(errno.EMFILE, 'Too many open files')

    monkeypatch.setattr(Path, 'iterdir', refuse)
    assert _waiting() == {}
