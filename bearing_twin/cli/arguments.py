# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Arguments of all commands: how numbers and names are read, and what is refused."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
import difflib
import os
from pathlib import Path
import re

from bearing_twin.errors import shown, UsageError

TOPIC = re.compile(r'/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*', re.ASCII)
"""Valid ROS topic names."""


def refuse_given(args: argparse.Namespace, options: Iterable[str], why: str) -> None:
    """Raise if options are given that have no effect; ``why`` follows their names."""
    default = args.parser.get_default
    given = [name for name in options if getattr(args, name) != default(name)]
    if given:
        names = ', '.join(f'--{name.replace("_", "-")}' for name in given)
        raise UsageError(f'{names}: {why}')


def refuse_command(parser: argparse.ArgumentParser, word: str, names: Iterable[str]) -> None:
    """End with the usage of a parser if a word that is no command resembles one of ``names``."""
    if near := difflib.get_close_matches(word, names, n=1):
        parser.error(f'there is no command {shown(word)!r}; did you mean {near[0]}?')


def refuse_unknown(parser: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """End with the usage of a parser, the words that it does not know, and the nearest options."""
    options = sorted(set(re.findall(r'--[a-z][a-z-]*', parser.format_help())))
    meant = [
        near
        for word in words
        if word.startswith('--')
        for near in difflib.get_close_matches(word.partition('=')[0], options, n=1)
    ]
    hint = f'; did you mean {" and ".join(meant)}?' if meant else ''
    parser.error(f'unrecognized arguments: {shown(" ".join(words))}{hint}')


def take_as_meant(parser: argparse.ArgumentParser) -> None:
    """Let a parser read numbers, and names of files, with errors that say what to write."""
    for kind, read in ((float, _number), (int, _whole), (Path, _path)):
        parser.register('type', kind, read)


def file_name(text: str) -> str:
    """Return the name of a file; '' is none: it would be the working directory."""
    if not text:
        msg = 'the name is empty, as of a variable that is not set; name a file or folder'
        raise argparse.ArgumentTypeError(msg)
    return text


def _path(text: str) -> Path:
    return Path(file_name(text))


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        msg = f'{text!r} is not a number; write a decimal point and no unit, e.g. 1.5'
        raise argparse.ArgumentTypeError(msg) from None


def _whole(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        msg = f'{text!r} is not a whole number; write digits alone, e.g. 60'
        raise argparse.ArgumentTypeError(msg) from None


def refuse_topic(name: str) -> None:
    """Raise if a --topic is not a valid ROS name."""
    if not TOPIC.fullmatch(name):
        msg = f'--topic {name!r}: letters, digits, _, parts split by /, e.g. /temperature'
        raise UsageError(msg)


def processes(asked: int | None, tasks: int) -> int:
    """Return the number of processes for some tasks: as asked for, else one per core."""
    if asked is not None and asked < 1:
        raise UsageError(f'--jobs {asked}: at least one process is needed')
    return max(1, min(asked or len(os.sched_getaffinity(0)), tasks))
