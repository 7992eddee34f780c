# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Colours and progress for a person at a terminal; plain text for everything else."""

from __future__ import annotations

import os
import sys
from typing import TextIO

__all__ = ['by_level', 'coloured', 'progress']

_COLOURS = {'ok': '32', 'suspect': '33', 'fault': '1;31', 'none': '36', 'bold': '1'}


def coloured(stream: TextIO) -> bool:
    """Whether a stream takes colours: a terminal, unless NO_COLOR is set (no-color.org)."""
    return stream.isatty() and not os.environ.get('NO_COLOR') and os.environ.get('TERM') != 'dumb'


def by_level(text: str, level: str, stream: TextIO | None = None) -> str:
    """Return a text in the colour of a level, or in 'bold', where ``stream`` takes colours."""
    code = _COLOURS.get(level)
    if code is None or not coloured(sys.stdout if stream is None else stream):
        return text
    return f'\x1b[{code}m{text}\x1b[0m'


def progress(done: int, total: int, what: str = '') -> None:
    """Say on stderr how far a long job is, where that is a terminal."""
    if total > 1 and sys.stderr.isatty():
        end = '\n' if done >= total else ''
        print(f'\r{done} of {total} {what}\x1b[K', end=end, file=sys.stderr, flush=True)
