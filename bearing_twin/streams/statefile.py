# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""State files of the nodes: plain files in one folder, saved on request or kept over restarts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
import errno
import fcntl
from functools import partial
import os
from pathlib import Path
import stat
import time
from typing import Any, BinaryIO, TYPE_CHECKING, TypeVar

from bearing_twin.disksync import DiskSync, SILENT
from bearing_twin.errors import BearingTwinError
from bearing_twin.packed import pack, unpack
from bearing_twin.wholefile import given_path, whole_file
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.disksync import Job


_VERSION = 3001

LARGEST = 64 * 1024 * 1024
_LONGEST_NAME = 200
"""Bytes. A file name may have 255; names of lock and temporary files are longer than the state's
own."""

RETRY = 10.0
"""Time after which a state that the disk has refused is written again, s."""

T = TypeVar('T')


class StateFolder:
    """
    Read and write states by name.

    Parameters
    ----------
    folder
        Folder of the states; '' for ``bearing_twin`` in ROS_HOME (``~/.ros`` if that is not set).

    """

    def __init__(self, folder: str) -> None:
        self._folder = folder

    @property
    def folder(self) -> Path:
        """
        Return the folder of the states.

        Raises
        ------
        BearingTwinError
            If it is in the home folder and there is none, as in some containers.

        """
        if self._folder:
            return given_path(self._folder)
        try:
            home = Path(os.environ.get('ROS_HOME', '') or Path.home() / '.ros')
        except RuntimeError:
            msg = 'there is no home folder to keep states in; set state_directory or ROS_HOME'
            raise BearingTwinError(msg) from None
        return home / 'bearing_twin'

    def path(self, name: str) -> Path:
        """
        Return the path of the state ``name``.

        Raises
        ------
        BearingTwinError
            If ``name`` is not a plain file name (services must not reach outside the folder), or
            is longer than 200 bytes.

        """
        if (length := len(os.fsencode(name))) > _LONGEST_NAME:
            msg = f'a name of {length} bytes is too long: {_LONGEST_NAME} at most'
            raise BearingTwinError(msg)
        if not name or name in ('.', '..') or Path(name).name != name or '\0' in name:
            msg = f'{name!r} is not a plain file name; states lie in {self.folder}'
            raise BearingTwinError(msg)
        return self.folder / name

    def save(self, name: str, state: bytes) -> Path:
        """
        Write a new state; existing files are never overwritten.

        Raises
        ------
        BearingTwinError
            If the name is not plain, or the file exists or cannot be written.

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
            raise BearingTwinError(_refusal(path, 'written', error)) from None
        return path

    def load(self, name: str) -> bytes:
        """
        Read a state.

        Raises
        ------
        BearingTwinError
            If the name is not plain, or the file cannot be read, is a link or not a plain file, or
            is too large for a state.

        """
        path = self.path(name)
        try:
            return _read(path)
        except OSError as error:
            raise BearingTwinError(_refusal(path, 'read', error)) from None


class NodeStates:
    """All states that one node keeps over restarts; one thread does the disk accesses in order."""

    def __init__(self, log: Callable[[str], object]) -> None:
        self._log = log
        self.disk = DiskSync()
        """The thread that accesses the disk."""
        self._kept: list[KeptState] = []

    def kept(self, values: Mapping[str, Any], node: str) -> KeptState:
        """
        Return the state that a node keeps over restarts.

        Parameters
        ----------
        values
            Parameters: ``state_directory``, ``state_name`` and ``state_owner``.
        node
            Full name of the node, or of the part of it, that learns the state.

        """
        folder, owner = StateFolder(values['state_directory']), values['state_owner']
        state = KeptState(folder, values['state_name'], (node, owner), self.disk, self._log)
        if values['state_name']:
            self._kept.append(state)
        return state

    def release(self) -> None:
        """Release the files for other nodes once the newest states are written."""
        for state in self._kept:
            state.retry(after=0.0)
            self.disk.do(state.release_lock)
        if self.disk.busy and not self.disk.settle():
            held = ', '.join(str(state.path) for state in self._kept if state.claimed)
            self._log(f'{SILENT}: not written and still locked: {held or "nothing"}')
        self._kept = []


class KeptState:
    """
    The learnt state of one node, kept in a file over restarts.

    The file is locked before it is read and contains the name of its node: a node never gets the
    state that another node learnt under the same state name. A file whose content cannot be used
    is renamed. Other failures, such as a disk that does not respond, are retried; nothing is
    written meanwhile.

    A thread does the disk accesses in the order of the requests, so the lock is released after the
    last write, however long that takes.

    Parameters
    ----------
    folder
        Folder of the file.
    name
        Name of the state; '' for none.
    nodes
        Full name of the node, and its former name if the state was learnt under another one.
    disk
        Thread that accesses the disk.
    log
        Called once with each reason why the state is not kept.

    """

    def __init__(
        self,
        folder: StateFolder,
        name: str,
        nodes: tuple[str, str],
        disk: DiskSync,
        log: Callable[[str], object],
    ) -> None:
        self._folder, self._name, self._nodes = folder, name, nodes
        self._disk, self._log = disk, log
        self._asked: Job[bytes | None] | None = None
        self._lock: BinaryIO | None = None
        # Whether the state in the file was loaded or given up. Nothing is written before.
        self._taken_up = self._given_up = False
        self._newest: bytes | None = None
        # The state that the disk has refused, and when it was tried last.
        self._refused: bytes | None = None
        self._tried = 0.0
        self._problem = ''

    @property
    def path(self) -> Path:
        """Path of the file."""
        return self._folder.path(self._name)

    @property
    def claimed(self) -> bool:
        """Whether this node holds the lock of the file."""
        return self._lock is not None

    @property
    def problem(self) -> str:
        """Reason why the state is not kept; '' if it is kept."""
        return self._problem or (SILENT if self._name and not self._disk.patience else '')

    def load(self, take: Callable[[bytes], None], *, wait: bool = False) -> bool:
        """
        Pass the kept state to ``take`` once; return whether this call did.

        If the file is not read yet, a later call passes it; with ``wait`` this call waits for it.
        """
        if self._taken_up or not self._name:
            return False
        self._asked = self._asked or self._do(self._claim)
        if wait and not self._disk.settle():
            self._tell(f'{self.path} is not read yet: {SILENT}')
        if not self._asked.done():
            return False
        found, self._asked = self._asked.result(), None
        if found is None:
            return False
        self._taken_up = True
        if self._given_up:
            return False
        try:
            take(found)
        except BearingTwinError as error:
            self.set_aside(str(error))
            return False
        return True

    def keep(self, state: Callable[[], bytes], other: str = '') -> None:
        """
        Write the state to the file; if the disk is slower than the calls, only the newest.

        Parameters
        ----------
        state
            Returns the state.
        other
            Reason not to keep this state; '' if there is none.

        """
        if not self._name or not (self._taken_up or self._given_up):
            return
        if other:
            self._tell(f'{self.path} stays as it is: {other}')
            return
        held = {'state': np.frombuffer(state(), np.uint8)}
        self._newest = pack(_VERSION, {'node': self._nodes[0]}, held)
        self._do(self._write)

    def retry(self, after: float = RETRY) -> None:
        """Write a state again that the disk has refused ``after`` seconds ago, or earlier."""
        late = time.monotonic() - self._tried >= after
        if self._refused is not None and late and not self._disk.busy:
            self._do(self._write)

    async def answer(self, said: str) -> str:
        """Wait for the disk, then return ``said`` with the reason if the state is not kept."""
        if self._name:
            with suppress(BearingTwinError):
                await self._disk.do(int)
        return f'{said}; not kept: {self.problem}' if self.problem else said

    def give_up(self) -> None:
        """Do not load the state in the file any more, if it has not been loaded yet."""
        self._given_up = True

    def set_aside(self, why: str) -> None:
        """Rename the file of this node, so that its content is preserved and not used."""
        if self._taken_up:
            self._do(partial(self._set_aside, why))

    def _do(self, work: Callable[[], T | None]) -> Job[T | None]:
        """Let the thread do ``work`` and log its errors."""

        def told() -> T | None:
            try:
                return work()
            except OSError as error:
                self._tell(_refusal(self.path, 'kept', error))
            except BearingTwinError as error:
                self._tell(str(error))
            return None

        return self._disk.do(told)

    def _claim(self) -> bytes | None:
        """Lock the file and return its state; None if there is none."""
        found = None
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._take_lock()
            with suppress(FileNotFoundError):
                found = self._learnt()
        except (BearingTwinError, OSError):
            # The file may belong to a node that starts next.
            self.release_lock()
            raise
        self._taken_up = found is None
        return found

    def _take_lock(self) -> None:
        if self._lock is not None:
            return
        lock = self.path.with_name(f'.{self._name}.lock')
        fd = os.open(lock, os.O_WRONLY | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o644)
        self._lock = os.fdopen(fd, 'wb')
        try:
            fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            msg = f'{self.path} is kept by another node; give each its own state_name'
            raise BearingTwinError(msg) from None

    def _learnt(self) -> bytes | None:
        found = _read(self.path)
        try:
            values, arrays = unpack(found, _VERSION)
            node, state = values['node'], arrays['state'].tobytes()
        except (BearingTwinError, KeyError, TypeError) as error:
            self._set_aside(str(error))
            return None
        if node in self._nodes:
            return state
        raise BearingTwinError(
            f'{self.path} was learnt by {node}, this is {self._nodes[0]}: choose another '
            f'state_name, or set state_owner to {node} if that is its former name'
        )

    def _write(self) -> None:
        state, self._newest = self._newest, None
        state = self._refused if state is None else state
        ours = self._lock is not None and (self._taken_up or self._given_up)
        if state is None or not ours:
            return
        self._refused, self._tried = state, time.monotonic()
        with whole_file(self.path) as file:
            file.write(state)
        self._refused, self._problem = None, ''

    def _set_aside(self, why: str) -> None:
        self._refused = None
        number = 1
        while (aside := self.path.with_name(f'{self._name}.unreadable-{number}')).exists():
            number += 1
        try:
            self.path.rename(aside)
        except FileNotFoundError:
            return
        except OSError:
            self._taken_up = False
            raise
        self._log(f'{why}; the file was renamed to {aside}; learning starts again')

    def release_lock(self) -> None:
        """Release the lock; called in the thread after the last write."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    def _tell(self, problem: str) -> None:
        if problem != self._problem:
            self._log(problem)
        self._problem = problem


def _refusal(path: Path, what: str, error: OSError) -> str:
    reason = 'it is a link' if error.errno == errno.ELOOP else error.strerror
    return f'{path} cannot be {what}: {reason}'


def _read(path: Path) -> bytes:
    # NONBLOCK: a pipe of this name must not hold the node up.
    fd = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    with os.fdopen(fd, 'rb') as file:
        about = os.fstat(fd)
        if not stat.S_ISREG(about.st_mode) or about.st_size > LARGEST:
            msg = f'{path} is no plain file of at most {LARGEST} bytes: not a saved state'
            raise BearingTwinError(msg)
        return file.read(LARGEST)
