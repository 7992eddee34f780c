# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Entry points of the command and the nodes."""

from __future__ import annotations

from functools import partial
import gc
import os
import sys

__all__ = ['adapter', 'calibration', 'command', 'diagnosis', 'fleet', 'recorder', 'replay', 'twin']


def command() -> int:
    """Run ``bearing-twin``; return its exit status."""
    # Process pools and their resource tracker are started by the standard library. Without this
    # they would look for modules in the working directory first.
    os.environ.setdefault('PYTHONSAFEPATH', '1')
    # Until all is loaded: see `bearing_twin.process.begin_collection`.
    gc.disable()
    try:
        from bearing_twin.cli import main
        from bearing_twin.cli.terminal import end_output

        try:
            return main()
        finally:
            end_output()
    except KeyboardInterrupt:
        # While the libraries load, which takes a second or more.
        return 130


def _node(name: str) -> int:
    """Run a node as ``bearing-twin run NAME`` does, for ``ros2 run`` and ``ros2 launch``."""
    sys.argv[1:1] = ['run', name]
    return command()


adapter, calibration, diagnosis, fleet, recorder, replay, twin = (
    partial(_node, name) for name in __all__ if name != 'command'
)
