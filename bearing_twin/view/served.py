# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Draw for live viewers in a thread of its own, so that none of them holds the caller up."""

from __future__ import annotations

from collections import deque
import contextlib
import threading
from typing import Any, TYPE_CHECKING

import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.drawing import Drawing

__all__ = ['WAITING', 'ServedDrawing']

WAITING = 2000
"""Most messages that wait to be drawn: half a minute of a bearing, some 50 MB."""
CLOSE_TIMEOUT = 4.0
"""Longest that closing waits for the viewers, s; ROS 2 kills a node that takes more than 5."""


class ServedDrawing:
    """
    Feed a drawing from a bounded queue.

    A viewer that is connected and frozen fills the buffers of Rerun, whose calls then wait for as
    long as it is; they let other threads run. What comes meanwhile replaces the oldest that waits:
    live viewers are about the present, and a picture that was never begun leaves no lane or
    layout half drawn.
    """

    def __init__(self, drawing: Drawing) -> None:
        self.dropped = 0
        """Messages that were not drawn because the viewers did not keep up."""
        self._drawing = drawing
        self._waiting: deque[tuple[str, str, Any, int, str]] = deque()
        self._changed = threading.Condition()
        self._busy = False
        self._closing = False
        self._finished = False
        # A viewer that never reads again must not keep the process alive.
        self._thread = threading.Thread(target=self._work, name='rerun', daemon=True)
        self._thread.start()

    def put(self, topic: str, type_name: str, message: Any, time_ns: int, side: str) -> None:
        """Have a message drawn; never waits for a viewer."""
        with self._changed:
            if len(self._waiting) >= WAITING:
                self._waiting.popleft()
                self.dropped += 1
            self._waiting.append((topic, type_name, message, time_ns, side))
            self._changed.notify_all()

    def drain(self, timeout: float) -> bool:
        """Wait until nothing waits any more, at most ``timeout`` seconds; return whether so."""
        with self._changed:
            return self._changed.wait_for(lambda: not self._waiting and not self._busy, timeout)

    def close(self) -> bool:
        """Draw what waits and stop serving; return whether the viewers took it in time."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._thread.join(CLOSE_TIMEOUT)
        if self._finished:
            return True
        with self._changed:
            self.dropped += len(self._waiting)
            self._waiting.clear()
        # Rerun would wait for the same viewer once more when Python ends.
        rr.unregister_shutdown()
        return False

    def _work(self) -> None:
        while True:
            with self._changed:
                self._busy = False
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._waiting or self._closing)
                if not self._waiting:
                    break
                item = self._waiting.popleft()
                self._busy = True
            self._drawing.draw(*item)
        # Rerun raises when a viewer does not take the rest in time; closing says so.
        with contextlib.suppress(RuntimeError):
            self._drawing.finish()
            self._finished = True
