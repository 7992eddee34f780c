# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Worker process that does tasks in order and can be ended at any time."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
import contextlib
from multiprocessing import get_context
import os
import signal
import threading
import traceback
from typing import Any, Generic, TYPE_CHECKING, TypeVar

from bearing_twin.process import end_with_parent

if TYPE_CHECKING:
    from multiprocessing.connection import Connection


Task = TypeVar('Task')
Answer = TypeVar('Answer')


class Worker(Generic[Task, Answer]):
    """
    Do tasks in order in a process of low priority.

    The process starts with the first task, and again with the next task if it was killed. It ends
    with its owner, even if that is killed. The pool of the standard library can block its owner
    forever if it ends before its process has read a large task (python/cpython#94777; the Python
    of Debian 12 and Ubuntu 22.04 has this bug).

    Parameters
    ----------
    work
        Module-level function that does a task. The function, tasks and results must be picklable.
    niceness
        Nice value of the process, 0 to 19; higher values yield to other processes.

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
        Queue a task behind those submitted before.

        The future has the result, or the exception that ``work`` raised; ChildProcessError if the
        process was killed.

        Raises
        ------
        OSError
            If the process cannot be started.

        """
        if self._process is None or not self._process.is_alive():
            context = get_context('spawn')
            self._pipe, theirs = context.Pipe()
            self._turn = threading.Lock()
            with theirs:
                process = context.Process(
                    target=_serve, args=(theirs, *self._made_of), daemon=True
                )
                process.start()
            self._process = process
        future: Future[Answer] = Future()
        # The thread cannot wait forever: a process that ends closes its end of the pipe.
        arguments = (self._pipe, self._turn, task, future)
        threading.Thread(target=_hand_over, args=arguments, daemon=True).start()
        return future

    def end(self) -> None:
        """End the process and its present task."""
        if self._process is not None:
            self._process.terminate()
            self._process = None


def _hand_over(pipe: Connection, turn: threading.Lock, task: Any, future: Future[Any]) -> None:
    try:
        with turn:
            pipe.send(task)
            answer, error, told = pipe.recv()
        if told:
            # Pickling loses the traceback; attach it as text.
            error.__cause__ = RuntimeError(told)
    except (EOFError, OSError):
        answer, error = None, ChildProcessError('the process of the work was killed')
    except Exception as unsent:
        # An object that cannot be pickled may raise any type of exception.
        answer, error = None, unsent
    if error is None:
        future.set_result(answer)
    else:
        future.set_exception(error)


def _serve(pipe: Connection, work: Callable[[Any], Any], niceness: int) -> None:
    os.nice(niceness)
    # The owner handles Ctrl-C.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    # The pipe is closed when the owner has ended.
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
        # When pickling fails, nothing has been sent yet.
        unsent = TypeError(f'{done[1] or done[0]!r:.200} cannot be sent: {error}')
        pipe.send((None, unsent, done[2]))
