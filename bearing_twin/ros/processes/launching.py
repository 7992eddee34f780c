# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Start nodes of this package as processes without ros2 launch. Imports no rclpy."""

from __future__ import annotations

from collections.abc import Mapping
import contextlib
import json
import os
from pathlib import Path
import signal
import subprocess
import sys
import tempfile
from typing import BinaryIO

from bearing_twin.errors import BearingTwinError

COMPILING = 'compiling the kernel (first start only)'
"""Log message of a node whose start takes long because it compiles."""
LOADING = 'loading the kernel'
"""Log message of a node whose start takes long because it loads compiled code."""
PARENT = 'BEARING_TWIN_PARENT'
"""Environment variable with the process id of the launch with which a node ends."""
COMMAND = (sys.executable, '-P', '-m', 'bearing_twin')
"""The command ``bearing-twin``, without imports from the working directory."""


def local_environment(domain_id: int) -> dict[str, str]:
    """Return an environment that limits ROS to this machine and to the given domain."""
    return {
        **os.environ,
        'ROS_DOMAIN_ID': str(domain_id),
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
    }


def ensure_log_folder() -> None:
    """
    Make ROS log to a temporary folder if it cannot write to its default one.

    In a container HOME may be missing or read-only, and then rclpy does not start. A folder given
    by the user (``ROS_LOG_DIR``) is not changed; rclpy reports problems with it.
    """
    if os.environ.get('ROS_LOG_DIR'):
        return
    home = os.environ.get('HOME')
    base = os.environ.get('ROS_HOME') or (f'{home}/.ros' if home else '')
    if base:
        folder = Path(base).expanduser() / 'log'
        with contextlib.suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            if os.access(folder, os.W_OK | os.X_OK):
                return
    os.environ['ROS_LOG_DIR'] = tempfile.mkdtemp(prefix='ros_log_')


def parameter_words(parameters: Mapping[str, object]) -> list[str]:
    """
    Return the words of ``--ros-args`` that give a node its parameters.

    Examples
    --------
    >>> parameter_words({'recording': 'Lüfter 🌀', 'rate': 2.0})
    ['-p', 'recording:="Lüfter 🌀"', '-p', 'rate:=2.0']

    """
    words = []
    for name, value in parameters.items():
        # JSON is YAML, and quotes every string; ROS reads no escaped pair of surrogates.
        words += ['-p', f'{name}:={json.dumps(value, ensure_ascii=False)}']
    return words


class NodeProcesses:
    """
    Nodes of this package as processes; leaving the context ends all that it started.

    They also end if this process is killed (Linux).
    """

    def __init__(self, logs: Path, environment: Mapping[str, str]) -> None:
        self._logs = logs
        self._environment = {**environment, PARENT: str(os.getpid())}
        self._processes: dict[str, subprocess.Popen[bytes]] = {}

    def __enter__(self) -> NodeProcesses:
        """Make the folder of the logs; return the object itself."""
        self._logs.mkdir(parents=True, exist_ok=True)
        return self

    def __exit__(self, *_: object) -> None:
        """End every process."""
        for name in list(self._processes):
            self.end(name)

    def start(
        self,
        module: str,
        parameters: Mapping[str, object],
        *,
        name: str = '',
        ros: tuple[str, ...] = (),
        within: tuple[str, ...] = (),
    ) -> None:
        """
        Start the node of a module with parameters; ``name`` is its key, by default ``module``.

        ``ros`` holds further ``--ros-args``. ``within`` is a command that runs the node, such as
        ``ip netns exec HOST``.
        """
        words = [*within, *COMMAND, 'run', module, '--ros-args', *parameter_words(parameters)]
        name = name or module
        with (self._logs / f'{name}.log').open('wb') as log:
            self._processes[name] = self._begin([*words, *ros], log)

    def _begin(self, words: list[str], log: BinaryIO) -> subprocess.Popen[bytes]:
        """Begin a process that writes to a log."""
        return subprocess.Popen(
            words,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            env=self._environment,
        )

    def running(self, name: str) -> bool:
        """Return whether the process is still running."""
        return self._processes[name].poll() is None

    def check(self) -> None:
        """Raise BearingTwinError with the last lines of its log if a process has failed."""
        for name, process in self._processes.items():
            if process.poll():
                text = (self._logs / f'{name}.log').read_text(errors='replace').strip()
                tail = '\n'.join(text.splitlines()[-8:])
                raise BearingTwinError(f'{name} ended with status {process.returncode}:\n{tail}')

    def wait(self, name: str, timeout: float) -> int:
        """Wait for a process to end by itself; return its exit status."""
        return self._processes[name].wait(timeout)

    def pid(self, name: str) -> int:
        """Return the process id."""
        return self._processes[name].pid

    def end(self, name: str, *, by: signal.Signals = signal.SIGINT) -> int:
        """
        End a process by a signal, as a user would; return its exit status.

        A process that has not ended after a minute is killed. A recorder needs time to write the
        end of its recording to a slow disk.
        """
        process = self._processes.pop(name)
        if process.poll() is None:
            process.send_signal(by)
            try:
                process.wait(60.0)
            except subprocess.TimeoutExpired:
                process.kill()
        return process.wait()
