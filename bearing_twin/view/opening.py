# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recordings as Rerun files: one, or two side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.view.logger import RerunLogger

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from bearing_twin.recording.reader import RecordingInfo

__all__ = ['draw_recordings', 'find_recording']

LONG = 180.0
"""Recordings up to this length are drawn sample by sample, s."""


def find_recording(path: Path) -> Path:
    """Return the MCAP file, bag folder or .rrd that a path stands for.

    A folder stands for the bag in it: that of ``bearing-twin demo`` holds ``bag`` and
    ``view.rrd``.

    Raises
    ------
    BearingTwinError
        If there is none, or more than one.
    """
    if not path.exists():
        msg = f'{path} does not exist'
        raise BearingTwinError(msg)
    if path.is_file() or any(path.glob('*.mcap')):
        return path
    bags = sorted({found.parent for found in path.glob('*/*.mcap')})
    if len(bags) == 1:
        return bags[0]
    if bags:
        msg = f'{path} holds {len(bags)} recordings; name one of them, e.g. {bags[0]}'
        raise BearingTwinError(msg)
    pictures = sorted(path.glob('*.rrd'))
    if len(pictures) == 1:
        return pictures[0]
    msg = f'{path} holds no recording: no .mcap file and no single .rrd file is in it'
    raise BearingTwinError(msg)


def draw_recordings(
    paths: Sequence[Path], rrd: Path, *, progress: Callable[[float], None] | None = None
) -> dict[str, str]:
    """Draw a recording, or several side by side, to a Rerun file.

    Parameters
    ----------
    paths
        MCAP files or bag folders; torn ones are read as far as they go.
    rrd
        File to write.
    progress
        Called with the part done, 0 to 1.

    Returns
    -------
    dict
        Why something is not drawn, by topic.

    Raises
    ------
    BearingTwinError
        If a recording cannot be read or holds no message.
    """
    infos = [recording_info(path) for path in paths]
    for info in infos:
        if not info.count:
            msg = f'{info.path} holds no message'
            raise BearingTwinError(msg)
    names = [''] if len(paths) == 1 else _names(paths)
    problems: dict[str, str] = {}
    with RerunLogger(
        recording_id=' '.join(names).strip() or paths[0].resolve().stem,
        rrd=rrd,
        full_samples=max(info.duration for info in infos) <= LONG,
        sides={n: i.start for n, i in zip(names, infos, strict=True)} if names[0] else None,
    ) as logger:
        for k, (name, info) in enumerate(zip(names, infos, strict=True)):
            problems |= _draw(logger, name, info, _part(progress, k, len(infos)))
    if progress is not None:
        progress(1.0)
    return problems | logger.problems


def _draw(
    logger: RerunLogger, side: str, info: RecordingInfo, progress: Callable[[float], None]
) -> dict[str, str]:
    unread: dict[str, str] = {}
    span = max(1, info.end - info.start)
    for count, message in enumerate(read_messages(info.path, recover=True)):
        if message.topic in unread:
            continue
        try:
            decoded = message.decode()
        except BearingTwinError as error:
            unread[message.topic] = str(error)
            continue
        logger.log(message.topic, message.type_name, decoded, message.log_time, side=side)
        if count % 500 == 0:
            progress((message.log_time - info.start) / span)
    return unread


def _part(progress: Callable[[float], None] | None, k: int, n: int) -> Callable[[float], None]:
    def report(part: float) -> None:
        if progress is not None:
            progress((k + min(part, 0.99)) / n)

    return report


def _names(paths: Sequence[Path]) -> list[str]:
    """Return a short name for each path, all different, fit for an entity path."""
    parts = [path.resolve().with_suffix('').parts for path in paths]
    # The bag folder of a run says nothing that the run's own does not.
    parts = [part[:-1] if part[-1] == 'bag' else part for part in parts]
    for depth in range(1, max(map(len, parts)) + 1):
        names = ['_'.join(part[-depth:]) for part in parts]
        if len(set(names)) == len(names):
            break
    else:
        names = [f'{part[-1]}_{k + 1}' for k, part in enumerate(parts)]
    return [''.join(c if c.isalnum() or c in '-_.' else '_' for c in name) for name in names]
