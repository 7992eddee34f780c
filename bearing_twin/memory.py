# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Memory that a program has freed stays with it: fetching it anew costs more than computing."""

from __future__ import annotations

import ctypes

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3  # malloc.h of glibc
LARGEST = 32 * 1024 * 1024
"""Largest block that is kept, bytes; glibc takes no higher threshold."""


def keep_freed_memory() -> bool:
    """
    Let the C library keep freed blocks of up to 32 MiB for the next that is asked for.

    By default glibc gives arrays of megabytes back to the system as soon as they are freed, and
    each page of the next one is a fault: a third of the time of a diagnosis. The process stays
    as large as it once was, as it should under ``mlockall``. It is the choice of a program, not of
    a library: nodes and commands make it when they begin.

    Returns
    -------
    bool
        Whether the C library has taken it; others than glibc know no such choice.

    """
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except AttributeError:
        return False
    return bool(mallopt(M_MMAP_THRESHOLD, LARGEST) and mallopt(M_TRIM_THRESHOLD, 2 * LARGEST))
