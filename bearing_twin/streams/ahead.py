# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Iteration with a thread that computes items in advance."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
import queue
import threading
from typing import TypeVar

T = TypeVar('T')


def ahead(items: Iterable[T], *, depth: int, batch: int) -> Iterator[T]:
    """
    Yield ``items`` while a thread computes up to ``depth`` of them in advance.

    The order stays the same. Items are handed over ``batch`` at a time, because at each handover
    the threads may wait for each other. An exception of ``items`` is raised here after the items
    before it. Leaving the iteration early ends the thread.
    """
    results: queue.Queue[tuple[list[T], bool, BaseException | None]]
    results = queue.Queue(max(depth // batch, 1))
    left = threading.Event()

    def put(part: list[T], *, last: bool, error: BaseException | None = None) -> None:
        while not left.is_set():
            try:
                results.put((part, last, error), timeout=0.1)
            except queue.Full:
                continue
            return

    def work() -> None:
        part: list[T] = []
        error = None
        try:
            for item in items:
                part.append(item)
                if len(part) == batch:
                    put(part, last=False)
                    part = []
                if left.is_set():
                    return
        except BaseException as raised:
            error = raised
        put(part, last=True, error=error)

    thread = threading.Thread(target=work, name='ahead', daemon=True)
    thread.start()
    try:
        last = False
        while not last:
            part, last, error = results.get()
            yield from part
            if error is not None:
                raise error
    finally:
        left.set()
        thread.join()
