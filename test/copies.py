# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recordings that are others with a change, or that no recorder writes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, TYPE_CHECKING

from mcap.writer import Writer

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.catalogue import RecordedMessage
    from bearing_twin.recording.writer import RecordingWriter


def put(
    writer: RecordingWriter, message: RecordedMessage, topic: str = '', cdr: bytes | None = None
) -> None:
    """Write a recorded message again, on another topic or with other bytes."""
    channel = replace(message.channel, topic=topic or message.topic)
    writer.copy(message._replace(channel=channel, cdr=message.cdr if cdr is None else cdr))


@contextmanager
def raw_recording(path: Path, profile: str = 'ros2', **options: Any) -> Iterator[Writer]:
    """Give a writer of a recording in which anything may stand; it is finished at the end."""
    with path.open('wb') as file:
        writer = Writer(file, **options)
        writer.start(profile)
        yield writer
        writer.finish()
