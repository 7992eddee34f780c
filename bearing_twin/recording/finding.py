# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Which recording a path stands for."""

from __future__ import annotations

from collections import Counter
import re
import shlex
from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError

if TYPE_CHECKING:
    from pathlib import Path


SIGNAL_FILES = ('.npz', '.mat', '.wav', '.csv', '.txt', '.tsv')
"""Endings of vibration files of other people, each with its reader in `signals.foreign`."""


def natural(path: Path) -> list[tuple[int, str]]:
    """Return the key of an order of names in which 2 comes before 10."""
    words = re.split(r'(\d+)', path.name)
    return [(int(word), '') if word.isdecimal() else (-1, word) for word in words]


def read_instead(path: Path) -> str:
    """
    Return the end of a sentence that says what reads the vibration files at a path.

    It is empty where there are none.

    >>> from pathlib import Path
    >>> read_instead(Path('bearing.csv'))
    "; 'bearing-twin diagnose' reads vibration files"

    """
    if path.suffix.lower() in SIGNAL_FILES:
        return "; 'bearing-twin diagnose' reads vibration files"
    names = [item for item in path.glob('[!.]*') if item.is_file()]
    endings = Counter(item.suffix for item in names if item.suffix.lower() in SIGNAL_FILES)
    # One text file among others is more likely about them.
    endings -= Counter({'.txt': 1})
    if not endings:
        return ''
    (ending, _), folder = endings.most_common(1)[0], shlex.quote(str(path))
    return (
        f"; if the {ending} files in it are vibration, 'bearing-twin diagnose {folder}/*{ending}' "
        f"judges each, and 'bearing-twin diagnose --series {folder}' all of them as snapshots of "
        'one machine'
    )


def find_recording(path: Path) -> Path:
    """
    Return the MCAP file, bag folder or .rrd that a path stands for.

    A folder stands for the bag in it: that of ``bearing-twin demo`` holds ``bag`` and
    ``view.rrd``.

    Raises
    ------
    BearingTwinError
        If there is none, or more than one.

    """
    if not path.exists():
        msg = f'{path} does not exist'
        raise BearingTwinError(msg)
    if path.is_file() or any(path.glob('*.mcap')):
        return path
    bags = sorted({found.parent for found in path.glob('*/*.mcap')})
    if len(bags) == 1:
        return bags[0]
    if bags:
        msg = f'{path} holds {len(bags)} recordings; name one of them, e.g. {bags[0]}'
        raise BearingTwinError(msg)
    pictures = sorted(path.glob('*.rrd'))
    if len(pictures) == 1:
        return pictures[0]
    msg = f'{path} holds no recording: no .mcap file and no single .rrd file is in it'
    msg += read_instead(path)
    raise BearingTwinError(msg)
