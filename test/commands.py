# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Programs that a test runs to their end, what a command has printed, memory."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import psutil


def python(*words: object, **options: Any) -> subprocess.CompletedProcess[str]:
    """Run Python with some words; return its status, and what it has said as text."""
    command = [sys.executable, *map(str, words)]
    kept = {'capture_output': True, 'text': True, 'check': False, 'timeout': 600.0}
    return subprocess.run(command, **{**kept, **options})


def json_lines(capsys: Any) -> list[Any]:
    """Return what a command has printed since the last call, as JSON line by line."""
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def resident(pid: int | None = None) -> int:
    """Memory of a process, else of this one, bytes."""
    return int(psutil.Process(pid).memory_info().rss)
