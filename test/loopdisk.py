# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A disk of the test's own: a file system in a file, which is mounted, cut off, or hangs."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
import subprocess

import pytest


class Disk:
    """An ext4 whose journal is written each second."""

    def __init__(self, folder: Path, options: str) -> None:
        self.path = folder / 'disk'
        self._image, self._after = folder / 'image', folder / 'after'
        for made in (self.path, self._after):
            made.mkdir()
        with self._image.open('wb') as file:
            file.truncate(64 * 2**20)
        call('mkfs.ext4', '-q', self._image)
        call('mount', '-o', f'loop,commit=1,{options}', self._image, self.path)
        self._mounted = [self.path]

    def cut(self) -> Path:
        """Return what a cut at this moment leaves."""
        copy = self._image.with_suffix('.cut')
        call('cp', '--sparse=always', self._image, copy)
        call('mount', '-o', 'loop', copy, self._after)
        self._mounted.append(self._after)
        return self._after

    @contextmanager
    def hanging(self) -> Iterator[None]:
        """Let nothing be written meanwhile: who tries waits in the kernel."""
        call('fsfreeze', '-f', self.path)
        try:
            yield
        finally:
            call('fsfreeze', '-u', self.path)

    def close(self) -> None:
        for folder in self._mounted:
            subprocess.run(['umount', '-l', folder], check=False)


def call(*words: object) -> None:
    subprocess.run([str(word) for word in words], check=True, capture_output=True)


@contextmanager
def loop_disk(folder: Path, options: str = 'defaults') -> Iterator[Disk]:
    """Make a disk; skip the test where none can be made."""
    try:
        made = Disk(folder, options)
    except (OSError, subprocess.CalledProcessError) as error:
        pytest.skip(f'a file system cannot be made and mounted here: {error}')
    try:
        yield made
    finally:
        made.close()
