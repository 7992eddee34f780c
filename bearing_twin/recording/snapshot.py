# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Record on demand: keep the last seconds in memory and write them when triggered."""

from __future__ import annotations

from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.errors import UsageError
from bearing_twin.recording.writer import RecordingWriter, WriterOptions
from bearing_twin.stamps import NANO
from bearing_twin.wholefile import free_path

if TYPE_CHECKING:
    from bearing_twin.recording.outfile import MessageToStore


class SnapshotWriter(RecordingWriter):
    """
    Keep the last seconds of all topics; :meth:`trigger` writes them and the following messages.

    The first trigger makes the bag folder, with the next free name if another recorder has taken
    its own meanwhile; later ones begin a new file in it.

    Messages from ``before`` seconds before a trigger to ``after`` seconds after it are written.
    The messages kept in memory take at most ``memory`` bytes.
    """

    def __init__(
        self,
        path: Path,
        options: WriterOptions | None = None,
        *,
        before: float,
        after: float,
        memory: int,
    ) -> None:
        super().__init__(path, options, begin=False)
        if not self.bag or path.exists():
            raise UsageError(
                f'{path}: snapshots need the name of a folder that does not exist yet'
            )
        self.snapshots = 0
        """Number of triggers."""
        self._before = round(before * NANO)
        self._after = round(after * NANO)
        self._memory = memory
        self._kept: deque[MessageToStore] = deque()
        self._kept_bytes = 0
        self._until = -1

    def take(self, message: MessageToStore) -> None:
        """Write one message or keep it in memory; callers use :meth:`write`, which checks it."""
        if self._begun and message.log_time <= self._until:
            super().take(message)
            return
        self._kept.append(message)
        self._kept_bytes += message.memory
        oldest = message.log_time - self._before
        while self._kept and (self._kept[0].log_time < oldest or self._kept_bytes > self._memory):
            self._kept_bytes -= self._kept.popleft().memory

    def _begin(self) -> None:
        # Another recorder may have taken the name since the start.
        self.path = self._finished.folder = free_path(self.path)
        super()._begin()

    def trigger(self, log_time: int) -> None:
        """Write the kept messages, and those up to ``after`` seconds after ``log_time`` (ns)."""
        if not self._begun:
            self._begin()
        elif log_time > self._until:
            self.split()
        self.snapshots += 1
        self._until = log_time + self._after
        while self._kept:
            super().take(self._kept.popleft())
        self._kept_bytes = 0
        self.flush()

    def flush(self) -> None:
        """Write all pending messages to the operating system, if there is a recording."""
        if self._begun:
            super().flush()

    def close(self) -> None:
        """Finish the recording, if there is one; messages kept in memory are discarded."""
        if self._begun:
            super().close()
