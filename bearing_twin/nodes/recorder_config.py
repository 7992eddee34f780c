# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the recorder node and what they build."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
import re
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.spec import Spec
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.snapshot import SnapshotWriter
from bearing_twin.recording.writer import RecordingWriter, WriterOptions
from bearing_twin.ros.qos import CHECKPOINT, RESULT, STREAM

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rclpy.qos import QoSProfile

__all__ = ['EXPECTED', 'SPECS', 'TopicChoice', 'build_writer']

MIB = 1024 * 1024

EXPECTED: dict[str, tuple[str, QoSProfile]] = {
    'temperature': ('sensor_msgs/msg/Temperature', RESULT),
    'joint_states': ('sensor_msgs/msg/JointState', RESULT),
    'vibration': ('bearing_twin_msgs/msg/Vibration', STREAM),
    'twin_state': ('bearing_twin_msgs/msg/TwinState', STREAM),
    'twin_checkpoint': ('bearing_twin_msgs/msg/Checkpoint', CHECKPOINT),
    'diagnosis': ('bearing_twin_msgs/msg/Diagnosis', RESULT),
    'diagnosis_checkpoint': ('bearing_twin_msgs/msg/Checkpoint', CHECKPOINT),
    'envelope_spectrum': ('bearing_twin_msgs/msg/Spectrum', RESULT),
    'spectrum': ('bearing_twin_msgs/msg/Spectrum', RESULT),
    'features': ('std_msgs/msg/Float64MultiArray', RESULT),
}
"""Our own topics, subscribed to before anybody publishes them, so that no first block is lost.

A publisher that offers less than this is found at once and subscribed to as it offers.
"""

SPECS = (
    Spec(
        name='output',
        default='',
        description='Bag folder to make, or one file if it ends in .mcap; never overwritten. '
        "'': bearing_twin_DATE-TIME in the working directory.",
        running=False,
    ),
    Spec(
        name='topics',
        default=[''],
        description='Topics to record, relative names resolved; none given, and no regex: all.',
        running=False,
    ),
    Spec(
        name='regex',
        default='',
        description='Record the topics whose whole name matches, besides those of topics.',
        running=False,
    ),
    Spec(
        name='exclude',
        default='',
        description='Do not record topics whose whole name matches this regular expression.',
        running=False,
    ),
    Spec(
        name='include_hidden',
        default=False,
        description='Record hidden topics (a part of the name begins with _) too.',
        running=False,
    ),
    Spec(
        name='max_bag_size',
        default=0,
        description='Size after which a new file is begun; 0: never.',
        unit='MiB',
        low=0,
        high=1_000_000,
        running=False,
    ),
    Spec(
        name='max_bag_duration',
        default=0.0,
        description='Time after which a new file is begun; 0: never.',
        unit='s',
        low=0.0,
        high=1e7,
        running=False,
    ),
    Spec(
        name='compression',
        default='zstd',
        description='Compression of the chunks.',
        choices=('zstd', 'lz4', 'none'),
        running=False,
    ),
    Spec(
        name='max_cache_size',
        default=64,
        description='Memory for messages that wait while the disk takes none.',
        unit='MiB',
        low=1,
        high=100_000,
        running=False,
    ),
    Spec(
        name='flush_period',
        default=0.5,
        description='Most recorded time that a crash can lose.',
        unit='s',
        low=0.05,
        high=60.0,
        running=False,
    ),
    Spec(
        name='fsync',
        default=False,
        description='Wait for the disk at each flush, so that it holds for power loss too.',
        running=False,
    ),
    Spec(
        name='storage_limit',
        default=0,
        description='Most space the recording may take; 0: no limit. At the limit it stops.',
        unit='MiB',
        low=0,
        high=100_000_000,
        running=False,
    ),
    Spec(
        name='delete_oldest',
        default=False,
        description='At the limit delete the oldest file of this recording instead of stopping; '
        'needs max_bag_size or max_bag_duration.',
        running=False,
    ),
    Spec(
        name='snapshot',
        default=False,
        description='Keep the last seconds in memory and write them only when the diagnosis turns '
        'to fault or ~/snapshot is called.',
        running=False,
    ),
    Spec(
        name='snapshot_before',
        default=30.0,
        description='Time that a snapshot reaches back.',
        unit='s',
        low=0.0,
        high=3600.0,
        running=False,
    ),
    Spec(
        name='snapshot_after',
        default=10.0,
        description='Time that a snapshot goes on.',
        unit='s',
        low=0.0,
        high=3600.0,
        running=False,
    ),
    Spec(
        name='snapshot_memory',
        default=256,
        description='Most memory for the seconds before.',
        unit='MiB',
        low=1,
        high=100_000,
        running=False,
    ),
    Spec(
        name='rerun_file',
        default='',
        description="Rerun recording (.rrd) to write too; '': none.",
        running=False,
    ),
    Spec(
        name='rerun_port',
        default=0,
        description='Port of a Rerun server for live viewers; 0: none (usual: 9876).',
        low=0,
        high=65535,
        running=False,
    ),
    Spec(
        name='rerun_address',
        default='127.0.0.1',
        description='Address the Rerun server binds to; 0.0.0.0 lets other machines in.',
        running=False,
    ),
)


class TopicChoice:
    """
    Which topics are recorded.

    Parameters
    ----------
    values
        Parameters of the node.
    resolved
        The names of the parameter ``topics``, resolved.

    Raises
    ------
    BearingTwinError
        If a regular expression cannot be read.

    """

    def __init__(self, values: Mapping[str, Any], resolved: set[str]) -> None:
        self._named = resolved
        self._regex = _compiled('regex', values['regex'])
        self._exclude = _compiled('exclude', values['exclude'])
        self._hidden = bool(values['include_hidden'])

    def __contains__(self, topic: str) -> bool:
        """Whether ``topic`` is to be recorded."""
        if topic in self._named:
            return True
        if self._exclude is not None and self._exclude.fullmatch(topic):
            return False
        if not self._hidden and any(part.startswith('_') for part in topic.split('/')):
            return False
        if self._regex is not None:
            return bool(self._regex.fullmatch(topic))
        return not self._named


def build_writer(values: Mapping[str, Any]) -> RecordingWriter | SnapshotWriter:
    """
    Return the writer that the parameters describe, its file made.

    Raises
    ------
    BearingTwinError
        If it exists or cannot be made, or the parameters do not fit together.

    """
    path = Path(values['output'] or f'bearing_twin_{datetime.now():%Y%m%d-%H%M%S}')
    options = WriterOptions(
        compression=values['compression'],
        flush_period=values['flush_period'],
        split_size=values['max_bag_size'] * MIB,
        split_duration=values['max_bag_duration'],
        storage_limit=values['storage_limit'] * MIB,
        delete_oldest=values['delete_oldest'],
        cache_size=values['max_cache_size'] * MIB,
        fsync=values['fsync'],
    )
    if not values['snapshot']:
        return RecordingWriter(path, options)
    return SnapshotWriter(
        path,
        options,
        before=values['snapshot_before'],
        after=values['snapshot_after'],
        memory=values['snapshot_memory'] * MIB,
    )


def _compiled(name: str, text: str) -> re.Pattern[str] | None:
    try:
        return re.compile(text) if text else None
    except re.error as error:
        msg = f"{name}='{text}' is no regular expression: {error}"
        raise BearingTwinError(msg) from None
