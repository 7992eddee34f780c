# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recordings as Rerun files: one, or several side by side."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.temperature import is_undated
from bearing_twin.recording.topics import CHECKPOINT, LOG, TEXT, VIBRATION
from bearing_twin.stamps import NANO
from bearing_twin.view.rerun.logger import RerunLogger
from bearing_twin.view.rerun.pictures.scales import Scales
from bearing_twin.view.rerun.scene import PICTURES
from bearing_twin.view.style import PAGES

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from bearing_twin.recording.reader import RecordingInfo


LATCHED_TYPES = frozenset({CHECKPOINT, LOG, TEXT})
"""Message types that stay valid: they are drawn even if sent before the vibration."""
LONG = 180.0
"""Recordings up to this length are drawn sample by sample, s."""


def draw_recordings(
    paths: Sequence[Path],
    rrd: Path,
    *,
    page: str = '',
    progress: Callable[[float], None] | None = None,
) -> dict[str, str]:
    """
    Draw a recording, or several side by side, to a Rerun file.

    The picture begins a second before the first vibration, not at the start of the nodes. Their
    parameters and log are shown at that beginning.

    Parameters
    ----------
    paths
        MCAP files or bag folders; unfinished ones are read up to where they break off.
    rrd
        File to write.
    page
        Name of the page in front; '': the first.
    progress
        Called with the fraction done, 0 to 1.

    Returns
    -------
    dict
        Reason why something is not drawn, by topic or file.

    Raises
    ------
    BearingTwinError
        If a recording cannot be read or holds nothing that is drawn, or if there is no such page.

    """
    infos = [recording_info(path) for path in paths]
    for info in infos:
        if not info.count:
            raise BearingTwinError(f'{info.path} holds no message')
        if not _drawn(info):
            raise BearingTwinError(
                f'{info.path} holds nothing of a bearing or a twin; Rerun draws other recordings: '
                "'rerun FILE.mcap'"
            )
    types = {info.topics[name].type_name for info in infos for name in _drawn(info)}
    possible = [name for name, needed in PAGES.items() if needed & types]
    _check_page(page, possible)
    names = [''] if len(paths) == 1 else _names(paths)
    begins = [_begin(info) for info in infos]
    counted = len(paths) > 1 or is_undated(infos[0].start)
    problems: dict[str, str] = {}
    with RerunLogger(
        recording_id=' '.join(names).strip() or paths[0].resolve().stem,
        rrd=rrd,
        full_samples=max(info.duration for info in infos) <= LONG,
        sides=dict(zip(names, begins, strict=True)) if counted else None,
        page=page,
        scales=_scales(infos) if len(paths) > 1 else None,
    ) as logger:
        for k, (name, info) in enumerate(zip(names, infos, strict=True)):
            part = _part(progress, k, len(infos))
            problems |= _draw(logger, name, info, part, begin=begins[k])
    if progress is not None:
        progress(1.0)
    _check_page(page, logger.pages)
    return problems | logger.problems


def _check_page(page: str, pages: Sequence[str]) -> None:
    if page and page not in pages:
        raise BearingTwinError(
            f'nothing is there to show on the page {page}; the pages are {", ".join(pages)}'
        )


def _drawn(info: RecordingInfo) -> set[str]:
    """Return the topics that are drawn."""
    return {n for n, topic in info.topics.items() if topic.count and topic.type_name in PICTURES}


def _draw(
    logger: RerunLogger,
    side: str,
    info: RecordingInfo,
    progress: Callable[[float], None],
    *,
    begin: int,
) -> dict[str, str]:
    unread = {str(info.path): '; '.join(info.problems)} if info.problems else {}
    span = max(1, info.end - info.start)
    messages = read_messages(info.path, topics=_drawn(info), recover=True, problems=[])
    for count, message in enumerate(messages):
        if message.log_time < begin and message.type_name not in LATCHED_TYPES:
            continue
        try:
            decoded = message.decode()
        except BearingTwinError as error:
            unread.setdefault(message.topic, str(error))
            continue
        time = max(message.log_time, begin)
        logger.log(message.topic, message.type_name, decoded, time, side=side)
        if count % 500 == 0:
            progress((message.log_time - info.start) / span)
    return unread


def _begin(info: RecordingInfo) -> int:
    """Return the time in ns at which the picture begins."""
    topics = {name for name, topic in info.topics.items() if topic.type_name == VIBRATION}
    messages = read_messages(info.path, topics=topics, recover=True, problems=[])
    first = next(messages, None) if topics else None
    return max(info.start, first.log_time - NANO) if first else info.start


def _scales(infos: Sequence[RecordingInfo]) -> Scales:
    scales = Scales()
    for info in infos:
        for message in read_messages(info.path, recover=True, problems=[]):
            # Messages that cannot be read are reported when they are drawn.
            with contextlib.suppress(BearingTwinError, AttributeError):
                scales.take(message.type_name, message.decode())
    return scales


def _part(progress: Callable[[float], None] | None, k: int, n: int) -> Callable[[float], None]:
    def report(part: float) -> None:
        if progress is not None:
            progress((k + min(part, 0.99)) / n)

    return report


def _names(paths: Sequence[Path]) -> list[str]:
    """Return a short name for each path, all different and valid in an entity path."""
    parts = [path.resolve().with_suffix('').parts for path in paths]
    # A folder called 'bag' adds nothing to the name of its run.
    parts = [part[:-1] if part[-1] == 'bag' else part for part in parts]
    for depth in range(1, max(map(len, parts)) + 1):
        names = ['_'.join(part[-depth:]) for part in parts]
        if len(set(names)) == len(names):
            break
    else:
        names = [f'{part[-1]}_{k + 1}' for k, part in enumerate(parts)]
    return [''.join(c if c.isalnum() or c in '-_.' else '_' for c in name) for name in names]
