# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Result of a re-run: numbers of identical, different, missing and skipped messages."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.recording.mcap.schema import canonical_cdr

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.catalogue import RecordedMessage


@dataclass
class Agreement:
    """Comparison of the recorded messages of one topic with those of the re-run."""

    identical: int = 0
    different: int = 0
    skipped: int = 0
    """Not re-run: recorded before the first usable checkpoint, or after lost messages."""
    missing: int = 0
    """Made by the re-run but missing in the recording, which continues after them."""
    first_difference: str = ''

    def compare(self, message: RecordedMessage, again: bytes, what: str) -> None:
        """Compare and count one message; padding between fields is ignored."""
        recorded = message.cdr if message.cdr == again else without_padding(message)
        if recorded == again:
            self.identical += 1
            return
        at = next(
            (i for i, (a, b) in enumerate(zip(recorded, again, strict=False)) if a != b),
            min(len(recorded), len(again)),
        )
        self.differ(f'{what}: byte {at} of {len(recorded)}')

    def differ(self, what: str) -> None:
        """Count a message that differs."""
        self.different += 1
        self.first_difference = self.first_difference or what


@dataclass
class Reproduction:
    """Result of the re-run of a recording."""

    path: Path
    topics: dict[str, Agreement] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    """Remarks on the recorded run: restarts, changed parameters, lost blocks."""

    @property
    def uncompared(self) -> list[str]:
        """Topics without any message that could be compared."""
        return sorted(n for n, a in self.topics.items() if not a.identical + a.different)

    @property
    def identical(self) -> bool:
        """Whether every topic had compared messages and all of them were byte-identical."""
        return (
            bool(self.topics)
            and not self.uncompared
            and not any(a.different for a in self.topics.values())
        )


def without_padding(message: RecordedMessage) -> bytes:
    """Return the bytes of a message with the padding between its fields set to zero."""
    channel = message.channel
    return canonical_cdr(channel.type_name, channel.schema, message.cdr)
