# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Files that are there as a whole or not at all, and never in the place of another."""

from __future__ import annotations

import contextlib
import itertools
import os
import secrets
from typing import BinaryIO, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@contextlib.contextmanager
def whole_file(path: Path, *, new: bool = False) -> Iterator[BinaryIO]:
    """
    Open a file to be written beside ``path``, which takes its place when all is written.

    A full disk, or an error in between, leaves what was at ``path`` before, and nothing else. A
    link is replaced, not followed. With ``new`` nothing is replaced; where the file system has no
    hard links, a crash between taking the name and renaming leaves an empty file.

    The content is on the disk before it gets its name, and the name when this returns: power loss
    too leaves the old file or the new one. That takes two fsync, milliseconds to seconds.

    Raises
    ------
    FileExistsError
        If there is something at ``path``, and it shall be ``new``.
    OSError
        If it cannot be written.

    """
    # A name of its own: two processes that write one path must not write one part.
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
    Open the file that a command was asked for, as :func:`whole_file`; make its ``folder`` too.

    Raises
    ------
    BearingTwinError
        If it cannot be written.

    """
    if not path.name:
        msg = f'{path} is a folder; name a file in it'
        raise BearingTwinError(msg)
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
        msg = f'{path} cannot be written ({error.strerror}); make room, or name another one'
        raise BearingTwinError(msg) from None


def _take_free_name(part: Path, path: Path) -> None:
    try:
        os.link(part, path)
    except FileExistsError:
        raise
    except OSError:
        # vfat, CIFS and shared folders of virtual machines may have no hard links.
        path.open('xb').close()
        try:
            part.replace(path)
        except BaseException:
            path.unlink(missing_ok=True)
            raise
    else:
        part.unlink()


def sync_folder(folder: Path) -> None:
    """Bring the names in a folder to the disk."""
    # Removed meanwhile, or of a file system that cannot: the files themselves have been written.
    with contextlib.suppress(OSError):
        fd = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            os.fsync(fd)
        finally:
            os.close(fd)


def free_path(path: Path) -> Path:
    """Return ``path``, or the first free one of NAME_2, NAME_3, ... where it is taken."""
    numbered = (path.with_name(f'{path.stem}_{n}{path.suffix}') for n in itertools.count(2))
    return next(each for each in itertools.chain((path,), numbered) if not os.path.lexists(each))
