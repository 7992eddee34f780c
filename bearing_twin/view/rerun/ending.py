# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""End of a process that still waits for a viewer. Does not load Rerun."""

from __future__ import annotations

import os
import sys
import threading

SERVING = 'rerun'
"""Name of the threads that serve viewers."""


def leave(status: int) -> None:
    """
    End the process at once if a thread still waits for a viewer; else return.

    Call it last, when all files are finished. A viewer may be thawed or killed while Python ends.
    Up to Python 3.13 the thread that then returns from Rerun is torn down with Rerun's frames on
    its stack, and the process aborts (SIGABRT) instead of ending with its status.
    """
    if any(thread.name == SERVING for thread in threading.enumerate()):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
