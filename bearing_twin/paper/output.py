# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The output folder: nothing of anybody else's is overwritten."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError

if TYPE_CHECKING:
    from pathlib import Path


MARKER = '.bearing-twin-paper'
"""File by which a folder that this command wrote is known."""


def prepare_folder(folder: Path) -> None:
    """
    Create ``folder``, or accept it if it is empty or was written by this command.

    Raises
    ------
    BearingTwinError
        If it is a file, holds anything else, or cannot be written.

    """
    try:
        if folder.is_file():
            msg = f'{folder} is a file; give a folder with --out'
            raise BearingTwinError(msg)
        if folder.exists() and any(folder.iterdir()) and not (folder / MARKER).exists():
            msg = (
                f'{folder} is not empty and was not written by this command; give a new folder '
                'with --out, or empty it'
            )
            raise BearingTwinError(msg)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / MARKER).write_text('Files here are rewritten by bearing-twin paper.\n', 'utf-8')
    except OSError as error:
        msg = f'cannot write {folder}: {error.strerror}; give another folder with --out'
        raise BearingTwinError(msg) from error
