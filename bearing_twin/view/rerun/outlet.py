# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Outlets of drawings: a file, or a server for live viewers. Neither delays the caller."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
import contextlib
from pathlib import Path
import threading
from typing import Any

from bearing_twin.errors import BearingTwinError
from bearing_twin.view.rerun.ending import SERVING
from bearing_twin.view.style import APPLICATION
import rerun as rr
import rerun_bindings

Mark = Callable[[rr.RecordingStream], None]
"""A drawing that adds itself to a recording. It is made once for all outlets."""

WAITING = 500
"""Largest number of marks queued for the viewers: half a minute of a bearing, some 20 MB."""
LASTING = 10_000
"""Largest number of lasting marks queued: the styles, bodies and layouts of a fleet."""
FLUSH_TIMEOUT, FILE_TIMEOUT = 5.0, 30.0
"""Time limits for what is left of a server, and of a file, which a loaded machine may delay, s."""
CLOSE_TIMEOUT = 4.0
"""Time limit for closing, s; ROS 2 kills a node that takes more than 5 s."""


def release() -> None:
    """
    Free the threads and memory of closed outlets.

    Otherwise each recording of a process keeps them even though it is disconnected
    (rerun-io/rerun#2116), and one that failed makes all later ones fail. The call waits for all
    open outlets: do not call it while a viewer is frozen.
    """
    with contextlib.suppress(RuntimeError):  # of other outlets, which report it themselves
        rerun_bindings.flush_and_cleanup_orphaned_recordings()


class Outlet:
    """One sink of Rerun."""

    def __init__(self, recording_id: str, sink: Any, *, place: str | Path) -> None:
        self._patience = FILE_TIMEOUT if isinstance(place, Path) else FLUSH_TIMEOUT
        self.recording = rr.RecordingStream(APPLICATION, recording_id=recording_id)
        try:
            self.recording.set_sinks(sink)
        except Exception as error:
            msg = f'Rerun cannot write {place} ({error}); choose another place'
            raise BearingTwinError(msg) from None

    def put(self, mark: Mark) -> None:
        """Draw a mark."""
        mark(self.recording)

    def close(self) -> None:
        """
        Close the sink.

        Raises
        ------
        RuntimeError
            If the sink does not take the rest in time.

        """
        try:
            self.recording.flush(timeout_sec=self._patience)
        finally:
            self.recording.disconnect()
            # Objects that drew into it may survive in a reference cycle.
            del self.recording


class ServedOutlet:
    """
    Feed the outlet of live viewers from a bounded queue, in a thread of its own.

    A frozen viewer fills the buffers of Rerun, whose calls then wait until it resumes; other
    threads run on. Meanwhile new marks replace the oldest in the queue, since live viewers show
    the present. Lasting marks (styles, bodies, the layout) go first and are kept.
    """

    def __init__(self, outlet: Outlet) -> None:
        self.dropped = 0
        """Marks that were not drawn because the viewers did not keep up."""
        self._outlet = outlet
        self._lasting: deque[Mark] = deque()
        self._passing: deque[Mark] = deque()
        self._changed = threading.Condition()
        self._busy = False
        self._closing = False
        self._finished = False
        # A viewer that never reads again must not keep the process alive.
        self._thread = threading.Thread(target=self._work, name=SERVING, daemon=True)
        self._thread.start()

    def put(self, mark: Mark, *, lasting: bool = False) -> None:
        """Queue a mark; never wait for a viewer."""
        waiting, most = (self._lasting, LASTING) if lasting else (self._passing, WAITING)
        with self._changed:
            if len(waiting) >= most:
                waiting.popleft()
                self.dropped += 1
            waiting.append(mark)
            self._changed.notify_all()

    def drain(self, timeout: float) -> bool:
        """Wait until all queued marks are drawn; return False after ``timeout`` seconds."""
        with self._changed:
            return self._changed.wait_for(lambda: not self._waits and not self._busy, timeout)

    def close(self) -> bool:
        """Draw the queued marks and stop serving; return whether the viewers took them in time."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._thread.join(CLOSE_TIMEOUT)
        if self._finished:
            return True
        with self._changed:
            self.dropped += len(self._lasting) + len(self._passing)
            self._lasting.clear()
            self._passing.clear()
        # Rerun would wait for the same viewer once more when Python ends.
        rr.unregister_shutdown()
        return False

    @property
    def _waits(self) -> bool:
        return bool(self._lasting or self._passing)

    def _work(self) -> None:
        while True:
            with self._changed:
                self._busy = False
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._waits or self._closing)
                if not self._waits:
                    break
                mark = (self._lasting or self._passing).popleft()
                self._busy = True
            try:
                self._outlet.put(mark)
            except Exception:
                # No error of Rerun may end the thread.
                self.dropped += 1
        # Rerun raises if a viewer does not take the rest in time; `close` returns False then.
        with contextlib.suppress(RuntimeError):
            self._outlet.close()
            self._finished = True
