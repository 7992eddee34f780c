# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Saved states of the nodes: plain files in one folder, never outside it, never overwritten."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path
import stat
from typing import BinaryIO, TYPE_CHECKING

from bearing_twin.diagnosis.state import pack, unpack
from bearing_twin.disksync import DiskSync
from bearing_twin.errors import BearingTwinError
from bearing_twin.wholefile import whole_file
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ['KeptState', 'StateFolder']

_VERSION = 3001

LARGEST = 64 * 1024 * 1024
LONGEST_SYNC = 10.0
"""Longest time that letting go of a state waits for the disk, s."""


class StateFolder:
    """
    Read and write states by name.

    Parameters
    ----------
    folder
        Where they lie; '' for ``bearing_twin`` in ROS_HOME (``~/.ros`` where that is not set).

    """

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._locks: dict[str, BinaryIO] = {}
        self._disk = DiskSync()
        self._newest: dict[str, bytes] = {}
        self._problem = ''

    @property
    def folder(self) -> Path:
        """
        Return where the states lie.

        Raises
        ------
        BearingTwinError
            If that is in a home, and there is none, as in some containers.

        """
        if self._folder:
            return Path(self._folder)
        try:
            home = Path(os.environ.get('ROS_HOME', '') or Path.home() / '.ros')
        except RuntimeError:
            msg = 'there is no home folder to keep states in; set state_directory or ROS_HOME'
            raise BearingTwinError(msg) from None
        return home / 'bearing_twin'

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
            with whole_file(path, new=True) as file:
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

        The first call makes it this object's: no other one writes it while this one exists.

        Raises
        ------
        BearingTwinError
            If the name is not plain, another node keeps the state, it is a link, or the file
            cannot be written.

        """
        path = self.path(name)
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            self._claim(name)
            if path.is_symlink():
                msg = f'{path} is a link, through which no state is written; remove it'
                raise BearingTwinError(msg)
            with whole_file(path) as file:
                file.write(state)
        except OSError as error:
            msg = f'{path} cannot be written: {error.strerror}'
            raise BearingTwinError(msg) from None
        return path

    def keep(self, name: str, state: bytes, *, wait: bool = False) -> None:
        """
        Have a thread :meth:`replace` a state, so that nobody has to ``wait`` for the disk.

        Of states that come faster than the disk takes them, the newest is written.

        Raises
        ------
        BearingTwinError
            What was wrong the last time, or, after a ``wait``, this time.

        """
        self._newest[name] = state
        self._disk.do(self._replace_newest)
        if problem := self._settled() if wait else self._problem:
            raise BearingTwinError(problem)

    def load(self, name: str) -> bytes:
        """
        Read a state.

        Raises
        ------
        BearingTwinError
            If the name is not plain, or the file cannot be read, is a link or no plain file, or is
            too large to be a state.

        """
        path = self.path(name)
        try:
            return self._read(path)
        except OSError as error:
            raise BearingTwinError(_unreadable(path, error)) from None

    def claim(self, name: str) -> bytes | None:
        """
        Make a state this object's, as :meth:`replace` does, and read it; None where there is none.

        Raises
        ------
        BearingTwinError
            As :meth:`load`, or if another node keeps it.

        """
        path = self.path(name)
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            self._claim(name)
            return self._read(path)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise BearingTwinError(_unreadable(path, error)) from None

    def _read(self, path: Path) -> bytes:
        # NONBLOCK: a pipe of this name must not hold the node up.
        fd = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
        with os.fdopen(fd, 'rb') as file:
            about = os.fstat(fd)
            if not stat.S_ISREG(about.st_mode) or about.st_size > LARGEST:
                msg = f'{path} is no plain file of at most {LARGEST} bytes: not a saved state'
                raise BearingTwinError(msg)
            return file.read(LARGEST)

    def set_aside(self, name: str) -> str:
        """
        Give a state that cannot be used another name, so that it stays; say which.

        Raises
        ------
        BearingTwinError
            If it cannot be renamed.

        """
        path = self.path(name)
        # What is on its way to the disk is of it.
        self._disk.close(LONGEST_SYNC)
        number = 1
        while (aside := path.with_name(f'{name}.unreadable-{number}')).exists():
            number += 1
        try:
            path.rename(aside)
        except OSError as error:
            msg = f'{path} cannot be renamed: {error.strerror}'
            raise BearingTwinError(msg) from None
        return f'it is kept as {aside}'

    def release(self) -> str:
        """Let another node keep the states; return why the newest was not written, or ''."""
        problem = self._settled()
        for lock in self._locks.values():
            lock.close()
        self._locks.clear()
        return problem

    def _settled(self) -> str:
        """Wait for the disk; return why it has not taken the newest state, or ''."""
        self._disk.close(LONGEST_SYNC)
        return 'the disk did not take the newest state' if self._disk.busy else self._problem

    def _replace_newest(self) -> None:
        if not self._newest:
            return
        try:
            self.replace(*self._newest.popitem())
            self._problem = ''
        except BearingTwinError as error:
            self._problem = str(error)

    def _claim(self, name: str) -> None:
        if name in self._locks:
            return
        lock = self.folder / f'.{name}.lock'
        fd = os.open(lock, os.O_WRONLY | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o644)
        file = os.fdopen(fd, 'wb')
        try:
            fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.close()
            msg = f'{self.path(name)} is kept by another node; give each its own state_name'
            raise BearingTwinError(msg) from None
        self._locks[name] = file


class KeptState:
    """
    What one node has learnt, kept in a file over restarts.

    The file is claimed before it is read, and holds the name of its node: what a node has learnt
    is not given to another one that runs, or ran, under the same name of the state. Only content
    that cannot be used is set aside. All else, such as a disk that does not answer, is tried
    again, and nothing is written meanwhile.

    Parameters
    ----------
    folder
        Where it lies.
    name
        Name of the state; '' for none.
    node
        Full name of the node.
    former
        Full name under which it was learnt, where the node had another one; '' otherwise.
    log
        Told, once, why the state is not kept.

    """

    def __init__(
        self, folder: str, name: str, node: str, former: str, log: Callable[[str], object]
    ) -> None:
        self._folder, self._name, self._log = StateFolder(folder), name, log
        self._node, self._nodes = node, (node, former)
        self._ours = not name
        self._given_up = False
        self.problem = ''
        """Why it is not kept; '' if it is."""

    @property
    def path(self) -> Path:
        """Where it lies."""
        return self._folder.path(self._name)

    def load(self, take: Callable[[bytes], None]) -> bool:
        """Hand what was kept to ``take``, unless that has been done; return whether it was."""
        if self._ours:
            return False
        try:
            found = self._folder.claim(self._name)
            self._ours = True
            return found is not None and self._hand(found, take)
        except BearingTwinError as error:
            self._ours = False
            # It may be that of a node which starts next.
            self._folder.release()
            self._tell(str(error))
            return False

    def _hand(self, found: bytes, take: Callable[[bytes], None]) -> bool:
        try:
            values, arrays = unpack(found, _VERSION)
            node, state = values['node'], arrays['state'].tobytes()
            if node in self._nodes:
                if not self._given_up:
                    take(state)
                return not self._given_up
        except (BearingTwinError, KeyError, TypeError) as error:
            self.set_aside(str(error))
            return False
        msg = (
            f'{self.path} was learnt by {node}, this is {self._node}: choose another state_name, '
            f'or set state_owner to {node} if that is its former name'
        )
        raise BearingTwinError(msg)

    def keep(self, state: Callable[[], bytes], other: str = '', *, wait: bool = False) -> None:
        """
        Write what ``state`` returns.

        Parameters
        ----------
        state
            Returns it.
        other
            Why it is none to be kept; '' if it is one.
        wait
            Whether to wait for the disk, as a service does whose answer must be true.

        """
        if not self._name or not self._ours:
            return
        try:
            if other:
                msg = f'{self.path} stays as it is: {other}'
                raise BearingTwinError(msg)
            held = {'state': np.frombuffer(state(), np.uint8)}
            self._folder.keep(self._name, pack(_VERSION, {'node': self._node}, held), wait=wait)
        except BearingTwinError as error:
            self._tell(str(error))
        else:
            self.problem = ''

    def give_up(self) -> None:
        """Take up no more what the file holds, where that was not possible yet."""
        self._given_up = True

    def set_aside(self, why: str) -> None:
        """Let what the file holds stay under another name, where it is this node's."""
        if not (self._name and self._ours and os.path.lexists(self.path)):
            return
        try:
            self._log(f'{why}; {self._folder.set_aside(self._name)}; it is learnt anew')
        except BearingTwinError as error:
            self._ours = False
            self._tell(str(error))

    def release(self) -> None:
        """Let another node keep it."""
        if problem := self._folder.release():
            self._tell(problem)

    def _tell(self, problem: str) -> None:
        if problem != self.problem:
            self._log(problem)
        self.problem = problem


def _unreadable(path: Path, error: OSError) -> str:
    reason = 'it is a link' if path.is_symlink() else error.strerror
    return f'{path} cannot be read: {reason}'
