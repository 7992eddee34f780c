# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recordings as Rerun files: one, or several side by side."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
import contextlib
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcap.schema import store_from_text
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.temperature import is_undated
from bearing_twin.recording.topics import CHECKPOINT, LOG, TEXT, VIBRATION
from bearing_twin.stamps import NANO
from bearing_twin.view.rerun.logger import RerunLogger
from bearing_twin.view.rerun.pictures.scales import Scales
from bearing_twin.view.rerun.scene import PICTURES
from bearing_twin.view.style import PAGES

if TYPE_CHECKING:
    from bearing_twin.recording.reader import RecordingInfo, TopicInfo


ARRIVAL = 'message_log_time'
"""Timeline that Rerun gives every message of an MCAP file."""
LATCHED_TYPES = frozenset({CHECKPOINT, LOG, TEXT})
"""Message types that stay valid: they are drawn even if sent before the vibration."""
OWN = frozenset(name for name in PICTURES if name.startswith('bearing_twin_msgs/'))
SERIES = frozenset(
    {
        *('Imu', 'JointState', 'Joy', 'FluidPressure', 'RelativeHumidity', 'Illuminance'),
        *('Range', 'BatteryState', 'Float64MultiArray', 'Temperature'),
    }
)
"""Message types that Rerun draws by itself as time series."""
NATIVE = SERIES | {
    *('Image', 'CompressedImage', 'CompressedVideo', 'CameraInfo', 'PointCloud2', 'NavSatFix'),
    *('MagneticField', 'TFMessage', 'PoseStamped', 'OccupancyGrid', 'String', 'Log'),
}
"""Message types that Rerun draws by itself."""
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
        If a recording cannot be read or holds no message, or if there is no such page.

    """
    infos = [recording_info(path) for path in paths]
    for info in infos:
        if not info.count:
            raise BearingTwinError(f'{info.path} holds no message')
    if len(paths) == 1 and not OWN & {topic.type_name for topic in infos[0].topics.values()}:
        _check_page(page, [])
        return _draw_foreign(infos[0], rrd, progress)
    types = {topic.type_name for info in infos for topic in info.topics.values() if topic.count}
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
        there = f'the pages are {", ".join(pages)}' if pages else 'there are no pages'
        raise BearingTwinError(f'nothing is there to show on the page {page}; {there}')


def _draw_foreign(
    info: RecordingInfo, rrd: Path, progress: Callable[[float], None] | None
) -> dict[str, str]:
    """Draw other recordings: Rerun draws the types it knows, we the numbers of all others."""
    readable = {name: topic for name, topic in info.topics.items() if _is_readable(topic)}
    # Rerun reads every protobuf message but draws only a few.
    tables = {n for n, t in readable.items() if {e for _, e, _ in t.schemas} == {'protobuf'}}
    known = {
        name: topic.type_name.split('/')[-1]
        for name, topic in readable.items()
        if all(encoding == 'ros2msg' for _, encoding, _ in topic.schemas)
    }
    natively = tables | {name for name, kind in known.items() if kind in NATIVE}
    lines = [name for name, kind in known.items() if kind in SERIES]
    problems: dict[str, str] = {}
    with RerunLogger(
        recording_id=info.path.resolve().stem, rrd=rrd, timeline=ARRIVAL, full_samples=True
    ) as logger:
        for path in info.files:
            reason = logger.import_mcap(path, readable, lines=lines, tables=tables)
            if reason:
                problems[str(path)] = reason
        ours = info.topics.keys() - natively
        problems |= _draw(logger, '', info, _part(progress, 0, 1), topics=ours)
    if progress is not None:
        progress(1.0)
    return problems | logger.problems


def _is_readable(topic: TopicInfo) -> bool:
    """Whether Rerun can read it: a .msg that contains itself ends Rerun with a stack overflow."""
    with contextlib.suppress(BearingTwinError):
        for type_name, encoding, text in topic.schemas:
            if encoding == 'ros2msg':
                store_from_text(type_name, text)
        return True
    return False


def _draw(
    logger: RerunLogger,
    side: str,
    info: RecordingInfo,
    progress: Callable[[float], None],
    *,
    topics: Collection[str] | None = None,
    begin: int = 0,
) -> dict[str, str]:
    unread = {str(info.path): '; '.join(info.problems)} if info.problems else {}
    span = max(1, info.end - info.start)
    if topics is not None and not topics:
        # Nothing is left to draw, and reading costs seconds for each GB of unpacked data.
        return unread
    messages = read_messages(info.path, topics=topics, recover=True, problems=[])
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
