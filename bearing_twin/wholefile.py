# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Write files atomically: a file is complete or absent; names that are free, and home folders."""

from __future__ import annotations

from collections.abc import Iterator
import contextlib
import itertools
import os
from pathlib import Path
import secrets
from typing import BinaryIO

from bearing_twin.errors import BearingTwinError, UsageError


@contextlib.contextmanager
def whole_file(path: Path, *, new: bool = False) -> Iterator[BinaryIO]:
    """
    Open a temporary file beside ``path``; rename it to ``path`` when all is written.

    After a full disk or another error, ``path`` is unchanged and no temporary file is left. A link
    is replaced, not followed. With ``new`` nothing is replaced; if the file system has no hard
    links, a crash between taking the name and renaming leaves an empty file.

    The content is synchronised with the disk before the renaming, and the name before this
    returns. So a power loss, too, leaves either the old file or the new one. The two fsync calls
    take milliseconds to seconds.

    Raises
    ------
    FileExistsError
        If ``path`` exists and ``new`` is set.
    OSError
        If the file cannot be written.

    """
    # A random name: two processes that write the same path must not share a temporary file.
    part = path.with_name(f'.{path.name}.{secrets.token_hex(4)}.part')
    try:
        with part.open('xb') as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        if new:
            _take_free_name(part, path)
        else:
            part.replace(path)
        sync_folder(path.parent)
    except BaseException:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        raise


@contextlib.contextmanager
def output_file(path: Path, *, folder: bool = False) -> Iterator[BinaryIO]:
    """
    Open an output file of a command as :func:`whole_file` does; with ``folder`` make its folder.

    Raises
    ------
    BearingTwinError
        If the file cannot be written.

    """
    if not path.name:
        raise BearingTwinError(f'{path} is a folder; name a file in it')
    made = folder and not path.parent.exists()
    try:
        if folder:
            path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as file:
            yield file
    except OSError as error:
        if made:
            with contextlib.suppress(OSError):
                path.parent.rmdir()
        # There is room for a file whose folder is missing.
        missing = isinstance(error, FileNotFoundError)
        remedy = 'make its folder' if missing else 'make room'
        msg = f'{path} cannot be written ({error.strerror}); {remedy}, or name another one'
        raise BearingTwinError(msg) from None


def _take_free_name(part: Path, path: Path) -> None:
    try:
        os.link(part, path)
    except FileExistsError:
        raise
    except OSError:
        # vfat, CIFS and the shared folders of virtual machines may not support hard links.
        path.open('xb').close()
        try:
            part.replace(path)
        except BaseException:
            path.unlink(missing_ok=True)
            raise
    else:
        part.unlink()


def sync_folder(folder: Path) -> None:
    """Synchronise the file names in a folder with the disk."""
    # The folder may be gone, or its file system may not support this; the files are written.
    with contextlib.suppress(OSError):
        fd = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            os.fsync(fd)
        finally:
            os.close(fd)


def given_path(text: str) -> Path:
    """
    Return the path in a parameter, where '~' is the home folder.

    A shell leaves it in ``output:=~/runs``, and so does a parameter file.

    Examples
    --------
    >>> str(given_path('runs/first'))
    'runs/first'

    """
    try:
        return Path(text).expanduser()
    except RuntimeError:
        raise UsageError(f'{text}: there is no such home folder; give the whole path') from None


def free_path(path: Path) -> Path:
    """Return ``path`` if it is free, else the first free one of NAME_2, NAME_3, ..."""
    numbered = (path.with_name(f'{path.stem}_{n}{path.suffix}') for n in itertools.count(2))
    return next(each for each in itertools.chain((path,), numbered) if not os.path.lexists(each))
