# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recordings as Rerun files: one, or two side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.view.logger import RerunLogger

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

__all__ = ['draw_recording']

LONG = 180.0
"""Recordings up to this length are drawn sample by sample, s."""


def draw_recording(
    path: Path, rrd: Path, *, progress: Callable[[float], None] | None = None
) -> dict[str, str]:
    """Draw a recording to a Rerun file.

    Parameters
    ----------
    path
        MCAP file or bag folder; torn ones are read as far as they go.
    rrd
        File to write.
    progress
        Called with the part done, 0 to 1.

    Returns
    -------
    dict
        What could not be drawn, by topic.

    Raises
    ------
    BearingTwinError
        If the recording cannot be read or holds nothing to draw.
    """
    info = recording_info(path)
    if not info.count:
        msg = f'{path} holds no message'
        raise BearingTwinError(msg)
    unread: dict[str, str] = {}
    span = max(1, info.end - info.start)
    with RerunLogger(
        recording_id=path.resolve().name, rrd=rrd, full_samples=info.duration <= LONG
    ) as logger:
        for count, message in enumerate(read_messages(path, recover=True)):
            if message.topic in unread:
                continue
            try:
                decoded = message.decode()
            except BearingTwinError as error:
                unread[message.topic] = str(error)
                continue
            logger.log(message.topic, message.type_name, decoded, message.log_time)
            if progress is not None and count % 500 == 0:
                progress((message.log_time - info.start) / span)
    return {**unread, **logger.problems}
