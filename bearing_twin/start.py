# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Where the command and the nodes start: Ctrl-C ends them without a traceback while they still load.

Their libraries take a second or more to load. Until a command or a node begins to work there is
nothing to lose, so that an interrupt ends the process at once.
"""

from __future__ import annotations

from functools import partial
import os
import signal
import sys

__all__ = ['adapter', 'calibration', 'command', 'diagnosis', 'fleet', 'recorder', 'replay', 'twin']


def command() -> int:
    """Run ``bearing-twin``; an interrupt makes the status 130, that of a node 0 as ever."""
    # Pools and what watches them are spawned by the library, and would look for modules in the
    # working directory first. Python 3.10 does not know this.
    os.environ.setdefault('PYTHONSAFEPATH', '1')
    status = 0 if sys.argv[1:2] == ['run'] else 130
    former = signal.getsignal(signal.SIGINT)
    # Ctrl-C is not for a command that a script has put into the background; rclpy's nodes hear it.
    if status == 0 or former is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, lambda *_: os._exit(status))
    # The scripts of 'ros2 run' have it held while the interpreter starts.
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
    from bearing_twin.cli import main

    return main(begin=partial(signal.signal, signal.SIGINT, former))


def _node(name: str) -> int:
    """Run a node: what ``bearing-twin run NAME`` does, for ``ros2 run`` and ``ros2 launch``."""
    sys.argv[1:1] = ['run', name]
    return command()


adapter, calibration, diagnosis, fleet, recorder, replay, twin = (
    partial(_node, name) for name in __all__ if name != 'command'
)
