# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Nodes and commands as processes that need not load anything.

They are forked from a process that has loaded libraries and kernels, which is most of what a start
costs, and then run the code of a real start. How a node or a command starts is shown by the tests
of the terminal, of interrupts, launching and compiling, which start it as a user does.
"""

from __future__ import annotations

from collections.abc import Mapping
import multiprocessing
from multiprocessing import forkserver
import os
from pathlib import Path
import subprocess
import sys
from tempfile import TemporaryDirectory
from typing import BinaryIO, TYPE_CHECKING

from bearing_twin.ros.processes.launching import COMMAND, NodeProcesses
from bearing_twin.start import command

if TYPE_CHECKING:
    from multiprocessing.context import ForkServerProcess

_FORKING = multiprocessing.get_context('forkserver')
_FORKING.set_forkserver_preload(['preloaded'])


class ForkedNodes(NodeProcesses):
    """The nodes of a test, forked; those that another command runs are started by it."""

    def _begin(self, words: list[str], log: BinaryIO) -> subprocess.Popen[bytes]:
        given = words[len(COMMAND) :]
        if words != [*COMMAND, *given]:
            return super()._begin(words, log)
        return _fork(given, self._environment, log.name, log.name)  # type: ignore[return-value]


def start_command(*words: object, out: Path, **environment: str) -> Forked:
    """Start ``bearing-twin`` with some words; a file or a terminal gets all that it says."""
    return _fork(list(map(str, words)), os.environ | environment, str(out), str(out))


def run_command(*words: object, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run ``bearing-twin`` with some words to its end, as `commands.python` runs Python."""
    with TemporaryDirectory() as folder:
        said = [Path(folder) / name for name in ('out', 'err')]
        command = _fork(list(map(str, words)), os.environ | environment, *map(str, said))
        status = command.wait(600.0)
        return subprocess.CompletedProcess(words, status, *(file.read_text() for file in said))


class Forked:
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


def _fork(words: list[str], environment: Mapping[str, str], out: str, err: str) -> Forked:
    """Run ``bearing-twin`` with words in a forked process, whose output is added to files."""
    _ensure_server()
    process = _FORKING.Process(target=_run, args=(words, dict(environment), out, err))
    process.start()
    return Forked(process)


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


def _run(words: list[str], environment: dict[str, str], out: str, err: str) -> None:
    for number, name in ((1, out), (2, err)):
        with Path(name).open('ab') as file:
            os.dup2(file.fileno(), number)
    sys.stdout, sys.stderr = (os.fdopen(number, 'w', 1, closefd=False) for number in (1, 2))
    os.environ.clear()
    os.environ.update(environment)
    sys.argv[1:] = words
    sys.exit(command())
