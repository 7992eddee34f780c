# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read a vibration signal from a topic of a recording: Vibration, or other suitable types."""

from __future__ import annotations

from array import array
from collections.abc import Callable
import math
from pathlib import Path
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcap.catalogue import known_fields
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.topics import VIBRATION
from bearing_twin.repeats import RepeatCheck
from bearing_twin.stamps import NANO, stamp_ns
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.catalogue import RecordedMessage
    from bearing_twin.recording.reader import TopicInfo


SINGLE: dict[str, Callable[[Any], Any]] = {
    'sensor_msgs/msg/Imu': lambda m: m.linear_acceleration,
    'geometry_msgs/msg/AccelStamped': lambda m: m.accel.linear,
    'geometry_msgs/msg/AccelWithCovarianceStamped': lambda m: m.accel.accel.linear,
    'geometry_msgs/msg/Vector3Stamped': lambda m: m.vector,
}
"""Types with one stamped sample per message, and the access to its three axes."""
ARRAYS = (
    'std_msgs/msg/Float32MultiArray',
    'std_msgs/msg/Float64MultiArray',
    'std_msgs/msg/Int16MultiArray',
    'std_msgs/msg/Int32MultiArray',
)
"""Types with a block of samples and without sample rate."""
AXES = ('x', 'y', 'z')
SETTLED = 0.05
"""Largest interquartile range of the steps between single samples, as a fraction of the median."""


def vibration_topics(path: Path) -> list[str]:
    """Return the topics of a recording that can be vibration."""
    return _fitting(recording_info(path).topics)


def read_vibration_topic(path: Path, channel: str | None, *, most: int) -> dict[str, Any]:
    """
    Return the longest part of one topic without a gap, with its description.

    Parameters
    ----------
    path
        File or bag folder.
    channel
        ``TOPIC``, ``TOPIC:AXIS`` or ``AXIS``. None: the only topic that can be vibration; in
        Vibration messages the axis y (the direction of the load).
    most
        Most samples to read.

    """
    info = recording_info(path)
    topic, axis = _topic(path, info.topics, channel)
    type_name = info.topics[topic].type_name
    blocks = _Blocks(path, most)
    problems: list[str] = []
    messages = read_messages(path, topics=(topic,), problems=problems)
    with known_fields(topic, type_name), np.errstate(invalid='ignore'):
        # A damaged block may contain a signalling NaN, which would cause a warning.
        if type_name == VIBRATION:
            found = _from_vibration(messages, axis, blocks, _Blocks(path, most), problems)
        elif type_name in SINGLE:
            found = _from_single(messages, axis, blocks, SINGLE[type_name], most)
        else:
            found = {}
            for message in messages:
                blocks.add(np.asarray(message.decode().data, dtype=np.float64).ravel())
    where = f', {topic}{":" + axis if axis else ""}'
    if problems:
        where += f' (left out: {"; ".join(problems)})'
    return {**found, 'x': blocks.longest(), 'where': where}


class _Blocks:
    """Collect blocks of samples; keep the longest run without a gap."""

    def __init__(self, path: Path, most: int) -> None:
        self._path = path
        self._most = most
        self._runs: list[list[NDArray[np.float64]]] = [[]]
        self._sizes = [0]

    def add(self, samples: NDArray[np.float64]) -> None:
        self._runs[-1].append(samples)
        self._sizes[-1] += samples.size
        if sum(self._sizes) > self._most:
            msg = f'{self._path} holds more than {self._most} samples; read a section of it'
            raise BearingTwinError(msg)

    def gap(self) -> None:
        """Begin a new run; only the longest finished one is kept."""
        longest = max(range(len(self._sizes)), key=self._sizes.__getitem__)
        self._runs = [self._runs[longest], []]
        self._sizes = [self._sizes[longest], 0]

    def longest(self) -> NDArray[np.float64]:
        """Return the longest run."""
        self.gap()
        if not self._sizes[0]:
            raise BearingTwinError(f'{self._path} holds no samples on this channel')
        return np.concatenate(self._runs[0])


def _fitting(topics: dict[str, TopicInfo]) -> list[str]:
    return [
        name
        for name, topic in topics.items()
        if topic.count and topic.type_name in (VIBRATION, *SINGLE, *ARRAYS)
    ]


def _topic(path: Path, topics: dict[str, TopicInfo], channel: str | None) -> tuple[str, str]:
    fitting = _fitting(topics)
    topic, axis = channel or '', ''
    if topic not in fitting:
        topic, _, axis = topic.rpartition(':')
        if axis and axis not in AXES:
            topic, axis = channel or '', ''
    if not topic and len(fitting) > 1:
        # Recordings of this package also hold arrays of features; prefer Vibration messages.
        fitting = [name for name in fitting if topics[name].type_name == VIBRATION] or fitting
    if topic in fitting:
        return topic, axis
    if not topic and len(fitting) == 1:
        return fitting[0], axis
    if not fitting:
        raise BearingTwinError(f'{path} has no topic that could be a vibration')
    asked = f' ({channel!r} was asked for)' if channel else ''
    raise BearingTwinError(f'{path}: name the vibration topic{asked}; it has {", ".join(fitting)}')


def _from_vibration(
    messages: Any, axis: str, blocks: _Blocks, speeds: _Blocks, problems: list[str]
) -> dict[str, Any]:
    expected: int | None = None
    found: dict[str, Any] = {}
    repeat, repeated = RepeatCheck(), 0
    for message in messages:
        block = message.decode()
        x, y = np.asarray(block.x), np.asarray(block.y)
        samples = {'x': x, 'y': y, '': y if y.size else x}.get(axis, x[:0])
        rate = float(block.sample_rate)
        if found and rate != found['fs']:
            raise BearingTwinError(f'the sample rate changes from {found["fs"]:g} to {rate:g} Hz')
        found = {'fs': rate, 'unit': np.array(str(block.unit))}
        if repeat.repeats(samples):
            # As the node does: of a driver that hangs the samples are missing in the index.
            repeated += 1
            continue
        if expected is not None and int(block.first_sample) != expected:
            blocks.gap()
            speeds.gap()
        expected = int(block.first_sample) + samples.size
        blocks.add(samples.astype(np.float64))
        speeds.add(np.full(samples.size, float(block.shaft_hz)))
    if repeated:
        problems.append(f'{repeated} blocks with the samples of the block before')
    return {
        **found,
        'shaft_hz': speeds.longest() if found else math.nan,
        'speed_measured': np.array(True),
    }


def _from_single(
    messages: Any, axis: str, blocks: _Blocks, vector: Callable[[Any], Any], most: int
) -> dict[str, Any]:
    # An array takes 8 bytes per number, a list of Python numbers four times as many.
    times, samples = array('q'), array('d')
    message: RecordedMessage
    for message in messages:
        decoded = message.decode()
        stamp = decoded.header.stamp
        times.append(stamp_ns(stamp))
        samples.append(float(getattr(vector(decoded), axis or 'z')))
        if len(samples) > most:
            msg = f'{message.topic} holds more than {most} samples; read a section of it'
            raise BearingTwinError(msg)
    steps = np.diff(np.array(times, dtype=np.int64)) / NANO
    if steps.size < 2:
        raise BearingTwinError('fewer than three samples: no sample rate can be told')
    low, middle, high = np.percentile(steps, [25, 50, 75])
    if middle <= 0.0 or high - low > SETTLED * middle:
        msg = f'the samples are not equally spaced ({low:g}..{high:g} s): this is no waveform'
        raise BearingTwinError(msg)
    begin = 0
    values = np.array(samples)
    for gap in np.flatnonzero(np.abs(steps - middle) > 0.5 * middle):
        blocks.add(values[begin : gap + 1])
        blocks.gap()
        begin = int(gap) + 1
    blocks.add(values[begin:])
    return {'fs': 1.0 / middle, 'unit': np.array('m/s^2')}
