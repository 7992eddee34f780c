# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the readers of files of other programs share: libraries, errors, bounds, names."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime, UTC
from importlib import import_module
from pathlib import Path
from typing import Any

from bearing_twin.errors import BearingTwinError

MOST_UNPACKED = 1024 * 1024 * 1024
"""Most unpacked bytes that are read from a file."""
DEEPEST = 32
"""Most levels of structs in a file."""
TORN = ' (the file ends before its header says)'
"""Remark on the source of a signal."""


def library(name: str, path: Path) -> Any:
    """Return a library of the extra ``files``, which is imported when such a file is read."""
    try:
        return import_module(name)
    except ImportError:
        msg = f"{path}: reading it needs {name}: pip install {name}, or 'bearing_twin[files]'"
        raise BearingTwinError(msg) from None


@contextmanager
def readable(path: Path, kind: str, remedy: str) -> Iterator[None]:
    """
    Turn any exception into a `BearingTwinError` that names the file and what to check.

    Libraries raise exceptions of many types if bytes are damaged. Some of them hold the bytes.
    """
    try:
        yield
    except BearingTwinError:
        raise
    except MemoryError:
        raise BearingTwinError(f'{path} needs more memory than there is; cut it') from None
    except Exception as error:
        if reason := getattr(error, 'strerror', None):
            raise BearingTwinError(f'{path} cannot be read: {reason}') from None
        msg = f'{path} cannot be read as {kind} ({type(error).__name__}: {error!s:.200})'
        raise BearingTwinError(f'{msg}; {remedy}') from None


def refuse_large(path: Path, values: int) -> None:
    """Raise an error for more values than are read of a file, before they take memory."""
    most = MOST_UNPACKED // 8
    if not 0 <= values <= most:
        msg = f'{path} holds {values} values; at most {most} are read: cut it into pieces'
        raise BearingTwinError(msg)


def head_of(path: Path) -> str:
    """Return the first megabyte of a file as text."""
    with readable(path, 'text', 'is it complete?'), path.open('rb') as opened:
        return opened.read(1_000_000).decode('latin-1')


def clock_time(text: str, form: str) -> float | None:
    """
    Return a date and time, s since 1970 as if in UTC; None if the text has another form.

    >>> clock_time('30-NOV-26 10:00:00', '%d-%b-%y %H:%M:%S')
    1796032800.0

    """
    try:
        return datetime.strptime(text, form).replace(tzinfo=UTC).timestamp()
    except ValueError:
        return None


def distinct(names: Sequence[str]) -> list[str]:
    """
    Return names in which those that occur several times have their number.

    >>> distinct(['DE', 'FE', 'DE'])
    ['DE (1)', 'FE', 'DE (2)']

    """
    counts, seen = Counter(names), Counter[str]()
    found = []
    for name in names:
        seen[name] += 1
        found.append(f'{name} ({seen[name]})' if counts[name] > 1 else name)
    return found
