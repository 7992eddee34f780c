# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Find the recording that a path names: MCAP file, bag folder or .rrd."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
import re
import shlex

from bearing_twin.errors import BearingTwinError

SQLITE = '.db3'
"""Suffix of the files of a bag in the storage sqlite3, the default of ROS 2 before Iron."""
SIGNAL_FILES = (
    '.npz', '.npy', '.mat', '.wav', '.tdms', '.uff', '.unv', '.lvm', '.csv', '.txt', '.tsv',
)  # fmt: skip
"""Suffixes of vibration files of other formats, each with its reader in `signals.signalfile`."""


def ending(path: Path) -> str:
    """
    Return the suffix of a file in lower case; that of a text for a name that ends in a number.

    >>> from pathlib import Path
    >>> ending(Path('2004.02.12.10.32.39')), ending(Path('105.MAT'))
    ('.txt', '.mat')

    """
    suffix = path.suffix.lower()
    return '.txt' if suffix[1:].isdecimal() else suffix


def natural(name: str) -> list[tuple[int, str]]:
    """
    Return a sort key of a name in which number 2 comes before 10.

    >>> sorted(['pump_10', 'pump_9'], key=natural)
    ['pump_9', 'pump_10']

    """
    words = re.split(r'(\d+)', name)
    return [(int(word), '') if word.isdecimal() else (-1, word) for word in words]


def reading_hint(path: Path) -> str:
    """
    Return the end of an error message: the command that reads or converts the files at a path.

    It is empty if there is none.

    >>> from pathlib import Path
    >>> reading_hint(Path('bearing.csv'))
    "; 'bearing-twin diagnose' reads vibration files"

    """
    alone = SQLITE in path.suffixes
    if alone or any(path.glob(f'*{SQLITE}*')):
        bag = path.parent if alone else path
        words = ('--src', str(bag), '--dst', f'{bag.resolve().name}_mcap', '--dst-storage', 'mcap')
        return (
            '; bags in the storage sqlite3 are not read: make an MCAP bag of it with '
            f"'rosbags-convert {shlex.join(words)}'"
        )
    if ending(path) in SIGNAL_FILES and not path.is_dir():
        return "; 'bearing-twin diagnose' reads vibration files"
    names = [item for item in path.glob('[!.]*') if item.is_file()]
    endings = Counter(item.suffix for item in names if ending(item) in SIGNAL_FILES)
    # A single text file among others is more likely a description of them.
    endings -= Counter({'.txt': 1})
    if not endings:
        return ''
    (usual, _), folder = endings.most_common(1)[0], shlex.quote(str(path))
    return (
        f"; if the {usual} files in it are vibration, 'bearing-twin diagnose {folder}/*{usual}' "
        f"judges each, and 'bearing-twin diagnose --series {folder}' all of them as snapshots of "
        'one machine'
    )


def find_recording(path: Path) -> Path:
    """
    Return the MCAP file, bag folder or .rrd that a path names.

    A folder names the bag in it: ``bearing-twin demo`` makes a folder with ``bag`` and
    ``view.rrd``.

    Raises
    ------
    BearingTwinError
        If there is none, or more than one.

    """
    if not path.exists():
        raise BearingTwinError(f'{path} does not exist')
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
    msg += reading_hint(path)
    raise BearingTwinError(msg)
