# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Work ahead in a thread: the results come in the same order, and errors where they belong."""

from __future__ import annotations

import queue
import threading
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

__all__ = ['ahead']

T = TypeVar('T')


def ahead(items: Iterable[T], *, depth: int) -> Iterator[T]:
    """
    Yield ``items`` while a thread computes up to ``depth`` of them in advance.

    An exception that ``items`` raises is raised here after what came before it. Leaving the
    iteration early ends the thread.
    """
    results: queue.Queue[tuple[bool, T | BaseException | None]] = queue.Queue(depth)
    left = threading.Event()

    def put(entry: tuple[bool, T | BaseException | None]) -> None:
        while not left.is_set():
            try:
                results.put(entry, timeout=0.1)
            except queue.Full:
                continue
            return

    def work() -> None:
        try:
            for item in items:
                put((True, item))
                if left.is_set():
                    return
        except BaseException as error:
            put((False, error))
        else:
            put((False, None))

    thread = threading.Thread(target=work, name='ahead', daemon=True)
    thread.start()
    try:
        while True:
            more, item = results.get()
            if more:
                yield item  # type: ignore[misc]
            elif item is None:
                return
            else:
                raise item  # type: ignore[misc]
    finally:
        left.set()
        thread.join()
