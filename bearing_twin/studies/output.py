# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Shared functions of the studies: arguments, output files, and tables in Markdown."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping, Sequence
import inspect
import json
from pathlib import Path
import sys
from typing import Any

from bearing_twin.errors import BearingTwinError
from bearing_twin.process import keep_freed_memory
from bearing_twin.wholefile import output_file


def arguments(name: str, *, writes: bool = False, **counts: int) -> argparse.ArgumentParser:
    """
    Return the argument parser of a study that begins; from here on, freed memory is kept.

    Its help is the docstring of the module ``name``. If the study ``writes``, the first argument
    is its output file. ``counts`` are optional numbers after it, in this order, with their
    defaults.
    """
    keep_freed_memory()
    module = sys.modules[name]
    parser = argparse.ArgumentParser(
        prog=f'python -m {module.__spec__.name if module.__spec__ else module.__name__}',
        description=inspect.cleandoc(module.__doc__ or ''),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    if writes:
        parser.add_argument('output', type=_new_file, help='JSON file to write')
    for count, default in counts.items():
        parser.add_argument(count, type=int, nargs='?', default=default)
    return parser


def _new_file(name: str) -> Path:
    """Return a path whose folder exists, so that a study of an hour does not fail at its end."""
    path = Path(name)
    if not path.absolute().parent.is_dir():
        raise argparse.ArgumentTypeError(f'{path.absolute().parent} is no folder; make it first')
    return path


def write_table(path: Path, values: Mapping[str, Any]) -> None:
    """Write the results of a study as JSON."""
    with output_file(path) as file:
        file.write(f'{json.dumps(values, indent=1)}\n'.encode())


def read_lines(path: Path) -> list[Any]:
    """
    Return the lines of JSON that an earlier run has written; none if there is no file.

    An incomplete last line, as after a kill, is removed from the file, so that a run can go on.
    """
    try:
        text = path.read_text(encoding='utf-8')
        if whole := text[: text.rfind('\n') + 1]:
            text = whole
            path.write_text(text, encoding='utf-8')
        return [json.loads(line) for line in text.splitlines()]
    except FileNotFoundError:
        return []
    except (OSError, ValueError) as error:
        msg = f'{path} is no file of this study ({error}); name another file'
        raise BearingTwinError(msg) from None


def print_table(heading: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Print a table in Markdown."""
    print(f'| {" | ".join(heading)} |')
    print('|---' * len(heading) + '|')
    for row in rows:
        print(f'| {" | ".join(map(str, row))} |')
