# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Nodes as processes that need not load anything.

They are forked from a process that has loaded libraries and kernels, which is most of what a start
costs, and then run the code of a real start. How a node starts is shown by the tests of arguments,
interrupts, launching and compiling, which start it as a user does.
"""

from __future__ import annotations

import multiprocessing
from multiprocessing import forkserver
import os
from pathlib import Path
import subprocess
import sys
from typing import TYPE_CHECKING

from bearing_twin.ros.processes.launching import NodeProcesses

if TYPE_CHECKING:
    from multiprocessing.context import ForkServerProcess
    from typing import BinaryIO

_FORKING = multiprocessing.get_context('forkserver')
_FORKING.set_forkserver_preload(['preloaded'])


class ForkedNodes(NodeProcesses):
    """The nodes of a test, forked; those that another command runs are started by it."""

    def _begin(self, words: list[str], log: BinaryIO) -> subprocess.Popen[bytes]:
        if words[0] != sys.executable:
            return super()._begin(words, log)
        _ensure_server()
        node = _FORKING.Process(target=_run, args=(words, log.name, self._environment))
        node.start()
        return _Forked(node)  # type: ignore[return-value]


class _Forked:
    """A forked process with the methods of `subprocess.Popen` that are used of one."""

    def __init__(self, process: ForkServerProcess) -> None:
        self._process = process
        self.pid = process.pid

    @property
    def returncode(self) -> int | None:
        return self._process.exitcode

    def poll(self) -> int | None:
        return self._process.exitcode

    def wait(self, timeout: float | None = None) -> int:
        self._process.join(timeout)
        if (status := self._process.exitcode) is None:
            raise subprocess.TimeoutExpired('a node', timeout or 0.0)
        return status

    def send_signal(self, number: int) -> None:
        if self.poll() is None:
            os.kill(self.pid, number)

    def kill(self) -> None:
        self._process.kill()


def _ensure_server() -> None:
    """Start the process to fork from, once; Python 3.11 does not tell it where modules are."""
    before = os.environ.get('PYTHONPATH')
    os.environ['PYTHONPATH'] = os.pathsep.join(filter(None, [str(Path(__file__).parent), before]))
    try:
        forkserver.ensure_running()
    finally:
        if before is None:
            del os.environ['PYTHONPATH']
        else:
            os.environ['PYTHONPATH'] = before


def _run(words: list[str], log: str, environment: dict[str, str]) -> None:
    """Run ``python -c CODE ARGUMENTS`` in this process."""
    with Path(log).open('ab') as out:
        for number in (1, 2):
            os.dup2(out.fileno(), number)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = ['-c', *words[3:]]
    exec(words[2], {'__name__': '__main__'})
