# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Saved states of the nodes: plain files in one folder, never outside it, never overwritten."""

from __future__ import annotations

import os
from pathlib import Path

from bearing_twin.errors import BearingTwinError

__all__ = ['StateFolder']

LARGEST = 64 * 1024 * 1024


class StateFolder:
    """
    Read and write states by name.

    Parameters
    ----------
    folder
        Where they lie; '' for ``bearing_twin`` in ROS_HOME (``~/.ros`` where that is not set).

    """

    def __init__(self, folder: str) -> None:
        home = Path(os.environ.get('ROS_HOME', '') or Path.home() / '.ros')
        self.folder = Path(folder) if folder else home / 'bearing_twin'

    def path(self, name: str) -> Path:
        """
        Return where ``name`` lies.

        Raises
        ------
        BearingTwinError
            If ``name`` is not a plain file name: services must not reach outside the folder.

        """
        if not name or name in ('.', '..') or Path(name).name != name or '\0' in name:
            msg = f'{name!r} is not a plain file name; states lie in {self.folder}'
            raise BearingTwinError(msg)
        return self.folder / name

    def save(self, name: str, state: bytes) -> Path:
        """
        Write a new state.

        Raises
        ------
        BearingTwinError
            If the name is not plain, the file exists or cannot be written.

        """
        path = self.path(name)
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with path.open('xb') as file:
                file.write(state)
        except FileExistsError:
            msg = f'{path} exists and is not overwritten; choose another name'
            raise BearingTwinError(msg) from None
        except OSError as error:
            msg = f'{path} cannot be written: {error.strerror}'
            raise BearingTwinError(msg) from None
        return path

    def replace(self, name: str, state: bytes) -> Path:
        """
        Write a state that the node itself keeps up to date, atomically.

        Raises
        ------
        BearingTwinError
            If the name is not plain or the file cannot be written.

        """
        path = self.path(name)
        part = path.with_name(f'.{name}.part')
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            part.write_bytes(state)
            part.replace(path)
        except OSError as error:
            msg = f'{path} cannot be written: {error.strerror}'
            raise BearingTwinError(msg) from None
        return path

    def load(self, name: str) -> bytes:
        """
        Read a state.

        Raises
        ------
        BearingTwinError
            If the name is not plain, or the file cannot be read or is too large to be a state.

        """
        path = self.path(name)
        try:
            if path.stat().st_size > LARGEST:
                msg = f'{path} is larger than {LARGEST} bytes: not a saved state'
                raise BearingTwinError(msg)
            return path.read_bytes()
        except OSError as error:
            msg = f'{path} cannot be read: {error.strerror}'
            raise BearingTwinError(msg) from None
