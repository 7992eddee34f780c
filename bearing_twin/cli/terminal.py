# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Output of all commands: streams, colours, progress, rows of text, numbers for JSON."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from io import TextIOWrapper
import math
from numbers import Integral, Real
import os
from pathlib import Path
from shutil import get_terminal_size
import sys
import textwrap
from typing import Any

from bearing_twin.errors import shown

_COLOURS = {'ok': '32', 'suspect': '33', 'fault': '1;31', 'none': '36', 'bold': '1'}


def mend_streams() -> None:
    """
    Make standard output accept every name, and replace closed streams.

    Characters that the encoding (ASCII, Latin-1) does not have are written as escapes. If standard
    output is closed, printing fails as on a full disk. If standard error is closed, errors are
    discarded. A closed standard input is empty.
    """
    if sys.stderr is None:
        sys.stderr = Path(os.devnull).open('w')  # noqa: SIM115
    if sys.stdin is None:
        sys.stdin = Path(os.devnull).open()  # noqa: SIM115
    if sys.stdout is None:
        # Without a buffer, so that printing fails at once and not at the end.
        sys.stdout = TextIOWrapper(
            os.fdopen(os.open(os.devnull, os.O_RDONLY), 'wb', buffering=0), write_through=True
        )
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors='backslashreplace')


def end_output() -> None:
    """
    Write what was printed to standard output, or discard it if that takes no more.

    At its end Python would try again, and report it with a traceback.
    """
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def report_compiling(command: str) -> None:
    """
    Report on a terminal that this process is compiling kernels, if it is.

    Otherwise the first use of a command would print nothing for a minute.
    """
    # Most commands do not load numba; while it is being loaded the module is empty.
    compiled = sys.modules.get('bearing_twin.numerics.compiled')
    has_compiled = getattr(compiled, 'has_compiled', bool)
    if has_compiled() and sys.stderr.isatty():
        why = "compiling kernels, which takes a minute; 'bearing-twin compile' does it beforehand"
        print(f'bearing-twin {command}: {why}', file=sys.stderr, flush=True)


def fitted(text: str, first: str = '', indent: str = '', *, width: int = 80) -> list[str]:
    """
    Return the lines of a text, as wide as the terminal and ``width`` at most.

    The first one begins with ``first``, the others with ``indent``. No word is cut: it may be the
    name of a file.
    """
    return textwrap.wrap(
        text,
        min(width, get_terminal_size().columns),
        initial_indent=first,
        subsequent_indent=indent,
        break_long_words=False,
        break_on_hyphens=False,
    )


def wrapped(name: str, text: str) -> list[str]:
    """
    Return the fitted lines of a row: its name, if it has one, and its indented text.

    Examples
    --------
    >>> for line in wrapped('Why', 'a comb at the order of the inner race ' * 3):
    ...     print(line)
    Why  a comb at the order of the inner race a comb at the order of the inner race
         a comb at the order of the inner race

    """
    begin = f'{name}  ' if name else ''
    return fitted(text, begin, ' ' * len(begin)) or [name]


def lined_up(rows: Iterable[tuple[str, str]]) -> list[str]:
    """Return the lines of several rows with aligned texts."""
    rows = list(rows)
    width = max(len(name) for name, _ in rows)
    return [line for name, text in rows for line in wrapped(f'{name:<{width}}', text)]


def by_level(text: str, level: str) -> str:
    """
    Return a text in the colour of a level, or in 'bold', if standard output is a terminal.

    There are no colours if NO_COLOR is set (no-color.org).
    """
    code, refused = _COLOURS.get(level), os.environ.get('NO_COLOR')
    if code is None or refused or os.environ.get('TERM') == 'dumb' or not sys.stdout.isatty():
        return text
    return f'\x1b[{code}m{text}\x1b[0m'


def shown_inside(value: Any) -> Any:
    """Return an answer with :func:`shown` applied to each of its texts."""
    if isinstance(value, dict):
        return {key: shown_inside(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [shown_inside(inner) for inner in value]
    return shown(value) if isinstance(value, str) else value


def plain(value: Any, digits: int = 17) -> Any:
    """
    Return an answer for JSON: numbers with ``digits`` digits, None for those without a value.

    Examples
    --------
    >>> plain({'hz': 100.0 / 3.0, 'slip': float('nan'), 'lines': (1, -0.0)}, digits=4)
    {'hz': 33.33, 'slip': None, 'lines': [1, 0.0]}

    """
    if isinstance(value, Mapping):
        return {key: plain(inner, digits) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(inner, digits) for inner in value]
    if isinstance(value, Real) and not isinstance(value, Integral):
        # Adding zero turns -0.0 into 0.0.
        return float(f'{value:.{digits}g}') + 0.0 if math.isfinite(value) else None
    return value


def progress(done: int, total: int, what: str = '') -> None:
    """Print the progress of a long job on stderr, if that is a terminal."""
    if total > 1 and sys.stderr.isatty():
        end = '\n' if done >= total else ''
        print(f'\r{done} of {total} {what}\x1b[K', end=end, file=sys.stderr, flush=True)


def clear_progress(total: int) -> None:
    """Erase the line of :func:`progress` before an answer goes to the same terminal."""
    if total > 1 and sys.stderr.isatty():
        print('\r\x1b[K', end='', file=sys.stderr, flush=True)


def percent(part: float, what: str = '') -> None:
    """Print the fraction of a long job that is done, 0 to 1, on stderr."""
    print(f'\r{what}{part:4.0%} ', end='\n' if part >= 1.0 else '', file=sys.stderr, flush=True)
