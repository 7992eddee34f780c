# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recordings that are others with a change."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bearing_twin.recording.catalogue import RecordedMessage
    from bearing_twin.recording.sink import MessageSink


def put(
    writer: MessageSink, message: RecordedMessage, topic: str = '', cdr: bytes | None = None
) -> None:
    """Write a recorded message again, on another topic or with other bytes."""
    channel = replace(message.channel, topic=topic or message.topic)
    writer.copy(message._replace(channel=channel, cdr=message.cdr if cdr is None else cdr))
