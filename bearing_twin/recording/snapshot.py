# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Record on demand: keep the last seconds in memory and write them when triggered."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.sink import Attachment, MessageSink, MessageToStore
from bearing_twin.recording.writer import RecordingWriter, WriterOptions
from bearing_twin.stamps import NANO

if TYPE_CHECKING:
    from pathlib import Path


class SnapshotWriter(MessageSink):
    """
    Keep the last seconds of all topics; :meth:`trigger` writes them and the following messages.

    It is used like a RecordingWriter. The first trigger makes the bag folder; later ones begin a
    new file in it.

    Messages from ``before`` seconds before a trigger to ``after`` seconds after it are written.
    The messages kept in memory take at most ``memory`` bytes.

    Raises
    ------
    BearingTwinError
        If the path exists or is not a folder name.

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
        if path.suffix == '.mcap' or path.exists():
            msg = f'{path}: snapshots need the name of a folder that does not exist yet'
            raise BearingTwinError(msg)
        self.path = path
        self.snapshots = 0
        """Number of triggers."""
        self._options = options or WriterOptions()
        self._before = round(before * NANO)
        self._after = round(after * NANO)
        self._memory = memory
        self._kept: deque[MessageToStore] = deque()
        self._kept_bytes = 0
        self._writer: RecordingWriter | None = None
        self._attached: list[Attachment] = []
        self._until = -1

    @property
    def problem(self) -> str:
        """Return why messages cannot be written to the disk; '' if they can."""
        return self._writer.problem if self._writer else ''

    @property
    def stopped(self) -> str:
        """Why the recording has stopped by itself; '' if it has not."""
        return self._writer.stopped if self._writer else ''

    @property
    def written(self) -> int:
        """Messages written to the files."""
        return self._writer.written if self._writer else 0

    @property
    def lost(self) -> int:
        """Messages lost because the disk failed, or with files that were removed."""
        return self._writer.lost if self._writer else 0

    @property
    def sync_problem(self) -> str:
        """Return the reason of a failed synchronisation with the disk; '' if none failed."""
        return self._writer.sync_problem if self._writer else ''

    @property
    def size(self) -> int:
        """Bytes of the recording so far."""
        return self._writer.size if self._writer else 0

    def take(self, message: MessageToStore) -> None:
        """Write one message or keep it in memory; callers use :meth:`write`, which checks it."""
        if self._writer is not None and message.log_time <= self._until:
            self._writer.take(message)
            return
        self._kept.append(message)
        self._kept_bytes += message.memory
        oldest = message.log_time - self._before
        while self._kept and (self._kept[0].log_time < oldest or self._kept_bytes > self._memory):
            self._kept_bytes -= self._kept.popleft().memory

    def trigger(self, log_time: int) -> None:
        """Write the kept messages, and those up to ``after`` seconds after ``log_time`` (ns)."""
        if self._writer is None:
            self._writer = RecordingWriter(self.path, self._options)
            for attached in self._attached:
                self._writer.add(attached)
        elif log_time > self._until:
            self._writer.split()
        self.snapshots += 1
        self._until = log_time + self._after
        while self._kept:
            self._writer.take(self._kept.popleft())
        self._kept_bytes = 0
        self._writer.flush()

    def add(self, attached: Attachment) -> None:
        """Add an attachment or a metadata record to every file."""
        self._attached.append(attached)
        if self._writer is not None:
            self._writer.add(attached)

    def flush(self) -> None:
        """Write all pending messages to the operating system."""
        if self._writer is not None:
            self._writer.flush()

    def close(self) -> None:
        """Finish the recording, if there is one; messages kept in memory are discarded."""
        if self._writer is not None:
            self._writer.close()
