# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A process beside the own one that does one task after the other, and can be left at any time."""

from __future__ import annotations

from concurrent.futures import Future
import contextlib
from multiprocessing import get_context
import os
import signal
import threading
import time
import traceback
from typing import Any, Generic, TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable
    from multiprocessing.connection import Connection


Task = TypeVar('Task')
Answer = TypeVar('Answer')


class Worker(Generic[Task, Answer]):
    """
    Do one task after the other in a process of low priority.

    The process is made for the first task, and anew for the next one if it was killed; it ends
    with its owner, whatever ends that. The pool of the standard library would keep its owner for
    ever if it is left before its process has read a large task (python/cpython#94777; Debian 12
    and Ubuntu 22.04 have such a Python).

    Parameters
    ----------
    work
        Function of a module that does a task; it, its tasks and answers can be pickled.
    niceness
        How much the process stands back behind others, 0 to 19.

    Examples
    --------
    >>> import math
    >>> worker = Worker(math.factorial)
    >>> worker.submit(5).result()
    120
    >>> worker.end()

    """

    def __init__(self, work: Callable[[Task], Answer], *, niceness: int = 0) -> None:
        self._made_of = (work, niceness)
        self._process: Any = None

    def submit(self, task: Task) -> Future[Answer]:
        """
        Have a task done when those before it are.

        Returns
        -------
        concurrent.futures.Future
            Of the answer, or of what the work raised; ChildProcessError if the process was killed.

        Raises
        ------
        OSError
            If there is no room for a process.

        """
        if self._process is None or not self._process.is_alive():
            context = get_context('spawn')
            self._pipe, theirs = context.Pipe()
            self._turn = threading.Lock()
            with theirs:
                self._process = context.Process(
                    target=_serve, args=(theirs, os.getpid(), *self._made_of), daemon=True
                )
                self._process.start()
        future: Future[Answer] = Future()
        # What it waits for ends with the process, which closes the other end.
        arguments = (self._pipe, self._turn, task, future)
        threading.Thread(target=_hand_over, args=arguments, daemon=True).start()
        return future

    def end(self) -> None:
        """End the process, and the task that it does."""
        if self._process is not None:
            self._process.terminate()
            self._process = None


def _hand_over(pipe: Connection, turn: threading.Lock, task: Any, future: Future[Any]) -> None:
    try:
        with turn:
            pipe.send(task)
            answer, error, told = pipe.recv()
        if told:
            # Where an error was raised is lost on the way.
            error.__cause__ = RuntimeError(told)
    except (EOFError, OSError):
        answer, error = None, ChildProcessError('the process of the work was killed')
    except Exception as unsent:
        # What cannot be pickled raises one of many kinds.
        answer, error = None, unsent
    if error is None:
        future.set_result(answer)
    else:
        future.set_exception(error)


def _serve(pipe: Connection, owner: int, work: Callable[[Any], Any], niceness: int) -> None:
    os.nice(niceness)
    # Ctrl-C is the owner's to hear.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(owner,), daemon=True).start()
    # The owner has gone where nothing more can be received or sent.
    with contextlib.suppress(EOFError, BrokenPipeError):
        while True:
            _answer(pipe, work, pipe.recv())


def _answer(pipe: Connection, work: Callable[[Any], Any], task: Any) -> None:
    done: tuple[Any, Exception | None, str]
    try:
        done = work(task), None, ''
    except Exception as error:
        done = None, error, traceback.format_exc()
    try:
        pipe.send(done)
    except BrokenPipeError:
        raise
    except Exception as error:
        # What cannot be pickled has not been sent in part.
        unsent = TypeError(f'{done[1] or done[0]!r:.200} cannot be sent: {error}')
        pipe.send((None, unsent, done[2]))


def _end_with(owner: int) -> None:
    """End this process in the middle of a task where its owner has been killed."""
    while os.getppid() == owner:
        time.sleep(1.0)
    os._exit(1)
