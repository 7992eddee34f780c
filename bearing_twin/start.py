# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Entry points of the command and the nodes. Ctrl-C while they load ends them without a traceback.

The libraries take a second or more to load. Before a command or a node begins its work there is
nothing to save, so an interrupt ends the process at once.
"""

from __future__ import annotations

from functools import partial
import gc
import os
import signal
import sys

__all__ = ['adapter', 'calibration', 'command', 'diagnosis', 'fleet', 'recorder', 'replay', 'twin']


def command() -> int:
    """Run ``bearing-twin``; return 130 after an interrupt, or 0 if a node was interrupted."""
    # Process pools and their resource tracker are started by the standard library. Without this
    # they would look for modules in the working directory first. Python 3.10 ignores it.
    os.environ.setdefault('PYTHONSAFEPATH', '1')
    status = 0 if sys.argv[1:2] == ['run'] else 130
    former = signal.getsignal(signal.SIGINT)
    # A command in the background of a script ignores Ctrl-C; nodes of rclpy always react to it.
    if status == 0 or former is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, lambda *_: os._exit(status))
    # The start scripts for 'ros2 run' block the signal while the interpreter starts.
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
    # Until all is loaded: see `bearing_twin.memory.begin_collection`.
    gc.disable()
    from bearing_twin.cli import main
    from bearing_twin.cli.terminal import end_output

    try:
        return main(begin=partial(signal.signal, signal.SIGINT, former))
    finally:
        end_output()


def _node(name: str) -> int:
    """Run a node as ``bearing-twin run NAME`` does, for ``ros2 run`` and ``ros2 launch``."""
    sys.argv[1:1] = ['run', name]
    return command()


adapter, calibration, diagnosis, fleet, recorder, replay, twin = (
    partial(_node, name) for name in __all__ if name != 'command'
)
