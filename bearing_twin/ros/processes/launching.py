# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Start our nodes as real processes, where there is no ros2 launch. Knows no rclpy."""

from __future__ import annotations

import os
from pathlib import Path
import signal
import subprocess
import sys
import tempfile
from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError

if TYPE_CHECKING:
    from collections.abc import Mapping


COMPILING = 'compiling the kernel (first start only)'
"""What a twin logs when its start takes long for that reason."""
LOADING = 'loading the kernel'
"""The same where the kernel has been compiled before."""
REFUSED = 2
"""Exit status of a node that refuses its parameters or arguments, as it would the next time."""
PARENT = 'BEARING_TWIN_PARENT'
"""Variable in which our launch files tell their nodes the process with which they end."""
COMMAND = (
    'import sys; sys.path[:] = filter(None, sys.path); '
    'from bearing_twin.start import command; sys.exit(command())'
)
"""What ``bearing-twin`` runs, but nothing is imported from the working directory, whatever lies
there: the option for that, -P, is one of Python 3.11."""


def local_environment(domain_id: int) -> dict[str, str]:
    """Return an environment in which ROS talks to this machine only, in a domain of its own."""
    return {
        **os.environ,
        'ROS_DOMAIN_ID': str(domain_id),
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
    }


def ensure_log_folder() -> None:
    """
    Let ROS log to a temporary folder where it cannot write to its own.

    A container may have no HOME, or one that is read-only: rclpy does not start then. A folder
    named by the user (``ROS_LOG_DIR``) is left as it is, and rclpy says what is wrong with it.
    """
    if os.environ.get('ROS_LOG_DIR'):
        return
    home = os.environ.get('HOME')
    base = os.environ.get('ROS_HOME') or (f'{home}/.ros' if home else '')
    if base:
        folder = Path(base).expanduser() / 'log'
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            pass
        else:
            if os.access(folder, os.W_OK | os.X_OK):
                return
    os.environ['ROS_LOG_DIR'] = tempfile.mkdtemp(prefix='ros_log_')


class NodeProcesses:
    """Nodes of this package as processes; leaving the context ends those it started."""

    def __init__(self, logs: Path, environment: Mapping[str, str]) -> None:
        self._logs = logs
        self._environment = dict(environment)
        self._processes: dict[str, subprocess.Popen[bytes]] = {}

    def __enter__(self) -> NodeProcesses:
        """Return itself."""
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
        Start the node of a module with parameters, under a name of its own if one is given.

        ``ros`` are more ``--ros-args``; ``within`` is a command to run it, ``ip netns exec HOST``.
        """
        words = [*within, sys.executable, '-c', COMMAND]
        words += ['run', module, '--ros-args']
        for key, value in parameters.items():
            words += ['-p', f'{key}:={_yaml(value)}']
        name = name or module
        with (self._logs / f'{name}.log').open('wb') as log:
            self._processes[name] = subprocess.Popen(
                [*words, *ros],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                env=self._environment,
            )

    def running(self, name: str) -> bool:
        """Whether the process is still there."""
        return self._processes[name].poll() is None

    def check(self) -> None:
        """Raise BearingTwinError if a process has failed, with the end of what it printed."""
        for name, process in self._processes.items():
            if process.poll():
                text = (self._logs / f'{name}.log').read_text(errors='replace').strip()
                tail = '\n'.join(text.splitlines()[-8:])
                msg = f'{name} ended with status {process.returncode}:\n{tail}'
                raise BearingTwinError(msg)

    def wait(self, name: str, timeout: float) -> int:
        """Wait for a process to end by itself; return its exit status."""
        return self._processes[name].wait(timeout)

    def pid(self, name: str) -> int:
        """Return the process id."""
        return self._processes[name].pid

    def end(self, name: str, *, by: signal.Signals = signal.SIGINT) -> int:
        """
        End a process as a user would; return its exit status.

        One that has not ended after a minute is killed: a recorder writes the end of its
        recording, which a slow disk may take long for.
        """
        process = self._processes.pop(name)
        if process.poll() is None:
            process.send_signal(by)
            try:
                process.wait(60.0)
            except subprocess.TimeoutExpired:
                process.kill()
        return process.wait()


def _yaml(value: object) -> str:
    """Write a value as the YAML that --ros-args takes."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'"
    return repr(value)
