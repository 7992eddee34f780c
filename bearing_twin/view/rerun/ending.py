# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""How a process ends that still waits for a viewer. Does not load Rerun."""

from __future__ import annotations

import os
import sys
import threading

SERVING = 'rerun'
"""Name of the threads that serve viewers."""


def leave(status: int) -> None:
    """
    End the process at once if a thread still waits for a viewer; else return.

    To be called last, when all files are finished. Up to Python 3.13 a thread that comes back
    from Rerun while Python ends, because the viewer has just been thawed or killed, is torn down
    with Rerun's frames on its stack, and the process aborts (SIGABRT) instead of ending with its
    status.
    """
    if any(thread.name == SERVING for thread in threading.enumerate()):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
