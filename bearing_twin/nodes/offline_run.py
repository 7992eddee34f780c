# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Offline replay: drive twin and diagnosis from the inputs in a recording, as fast as it goes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from bearing_twin_msgs.msg import Vibration
from rclpy.serialization import deserialize_message

from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes import diagnosis_config, twin_config
from bearing_twin.nodes.offline import DiagnosisRun, Output, TwinRun
from bearing_twin.nodes.pacer import Due
from bearing_twin.nodes.shaft import ShaftSpeed
from bearing_twin.recording.qos import sensor_qos
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.schema import MessageSchema
from bearing_twin.recording.writer import RecordingWriter
from bearing_twin.thermal.gate import TemperatureGate

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from bearing_twin.nodes.parameters import Spec
    from bearing_twin.recording.reader import RecordedMessage

__all__ = ['OfflineReport', 'run_offline']

NANO = 1_000_000_000
TEMPERATURE = 'sensor_msgs/msg/Temperature'
JOINTS = 'sensor_msgs/msg/JointState'


@dataclass
class OfflineReport:
    """What an offline run has made."""

    target: Path
    duration: float = 0.0
    """Recorded time covered, s."""
    blocks: int = 0
    verdicts: dict[str, int] = field(default_factory=dict)
    inputs: int = 0
    """Messages of the source that were used."""


def run_offline(
    source: Path,
    target: Path,
    *,
    twin: Mapping[str, Any] | None = None,
    diagnosis: Mapping[str, Any] | None = None,
    progress: Callable[[float], None] | None = None,
) -> OfflineReport:
    """Run twin and diagnosis on the temperature and speed of a recording.

    Blocks begin with the first input and follow its log time, as the live twin follows the clock;
    an input acts on the block that is due next. The new recording holds the inputs too, and
    checkpoints, so that ``verify`` can re-run it.

    Parameters
    ----------
    source
        Recording with ``sensor_msgs/Temperature`` and, for a joint, ``sensor_msgs/JointState``.
    target
        Recording to make.
    twin, diagnosis
        Parameters of the nodes that differ from their defaults.
    progress
        Called with the part done, 0..1, about once per recorded second.

    Raises
    ------
    BearingTwinError
        If there is no temperature in the source, or parameters or target do not fit.
    """
    info = recording_info(source)
    topics = [t for t, about in info.topics.items() if about.type_name in (TEMPERATURE, JOINTS)]
    if not any(info.topics[t].type_name == TEMPERATURE and info.topics[t].count for t in topics):
        msg = f'{source} holds no {TEMPERATURE}; an offline run needs it'
        raise BearingTwinError(msg)
    run = _Run(_values(twin_config.SPECS, twin), _values(diagnosis_config.SPECS, diagnosis))
    run.report.target = target
    with RecordingWriter(target) as writer:
        writer.metadata('bearing_twin.source', {'source': source.name, 'mode': 'offline'})
        run.begin(writer, info.start)
        reported = info.start
        for message in read_messages(source, topics=topics):
            run.blocks_until(message.log_time)
            run.take(message)
            if progress is not None and message.log_time - reported > NANO:
                reported = message.log_time
                progress((reported - info.start) / max(1, info.end - info.start))
        run.blocks_until(info.end)
    run.report.duration = info.duration
    return run.report


def _values(specs: tuple[Spec, ...], given: Mapping[str, Any] | None) -> dict[str, Any]:
    values: dict[str, Any] = {spec.name: spec.default for spec in specs}
    for name, value in (given or {}).items():
        if name not in values:
            msg = f'there is no parameter {name!r}; there are {", ".join(values)}'
            raise BearingTwinError(msg)
        kind = type(values[name])
        if kind is float and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        elif kind is str and isinstance(value, (int, float)) and not isinstance(value, bool):
            # A bearing called 6307 is a name.
            value = str(value)
        if not isinstance(value, kind):
            msg = f'parameter {name}={value!r} must be of type {kind.__name__}'
            raise BearingTwinError(msg)
        values[name] = value
    return values


class _Run:
    """Twin and diagnosis on one time line."""

    def __init__(self, twin: dict[str, Any], diagnosis: dict[str, Any]) -> None:
        self.report = OfflineReport(None)  # type: ignore[arg-type]
        self._twin = TwinRun(twin)
        self._diagnosis = DiagnosisRun(diagnosis)
        self._gate = TemperatureGate(
            start=twin['start_temperature'], timeout=twin['temperature_timeout']
        )
        self._shaft = ShaftSpeed(nominal=twin['shaft_hz'], joint=twin['joint'], highest=100.0)
        self._speed = ShaftSpeed(nominal=math.nan, joint=diagnosis['joint'])
        self._temperature = math.nan
        self._next_sample = 0
        self._twin_checkpoint = 0
        self._diagnosis_checkpoint = 0

    def begin(self, writer: RecordingWriter, start: int) -> None:
        """Let sample 0 be taken at ``start`` (ns)."""
        self._writer = writer
        self._start = start
        self._qos = sensor_qos()

    def take(self, message: RecordedMessage) -> None:
        """Take one input, and copy it."""
        channel = message.channel
        schema = MessageSchema(channel.type_name, channel.schema, channel.type_hash)
        self._writer.write(
            channel.topic,
            channel.type_name,
            message.cdr,
            log_time=message.log_time,
            publish_time=message.publish_time,
            qos=channel.qos,
            schema=schema,
        )
        self.report.inputs += 1
        decoded = message.decode()
        now = message.log_time / NANO
        if channel.type_name == TEMPERATURE:
            stamp = decoded.header.stamp.sec * NANO + decoded.header.stamp.nanosec
            self._gate.offer(decoded.temperature, stamp=stamp, now=now)
            self._temperature = decoded.temperature
        else:
            self._shaft.offer(decoded.name, decoded.velocity, now=now)
            self._speed.offer(decoded.name, decoded.velocity, now=now)

    def blocks_until(self, time: int) -> None:
        """Compute every block whose last sample has been taken before ``time`` (ns)."""
        length = self._twin.values['block_size']
        rate = self._twin.values['sample_rate']
        while True:
            due = self._start + round((self._next_sample + length) * NANO / rate)
            if due > time:
                return
            stamp = self._start + round(self._next_sample * NANO / rate)
            self._block(Due(self._next_sample, stamp, 0.0), length, due)
            self._next_sample += length

    def _block(self, due: Due, length: int, now: int) -> None:
        twin, diagnosis = self._twin, self._diagnosis
        if due.first_sample >= self._twin_checkpoint:
            period = twin.values['checkpoint_period'] * twin.values['sample_rate']
            self._twin_checkpoint = due.first_sample + round(period)
            self._write(twin.checkpoint(due), now)
        self.report.blocks += 1
        temperature = self._gate.at(now / NANO)
        vibration, state = twin.block(due, length, temperature, self._shaft.hz)
        self._write(vibration, now)
        self._write(state, now)
        message = deserialize_message(vibration.cdr, Vibration)
        if due.first_sample >= self._diagnosis_checkpoint:
            period = diagnosis.values['checkpoint_period'] * twin.values['sample_rate']
            self._diagnosis_checkpoint = due.first_sample + round(period)
            self._write(diagnosis.checkpoint(message), now)
        for output in diagnosis.push(
            message,
            temperature=self._temperature,
            joint_hz=self._speed.hz,
            measured=self._speed.measured,
        ):
            self._write(output, now)
        self.report.verdicts = dict(diagnosis.counts)

    def _write(self, output: Output, time: int) -> None:
        self._writer.write(
            output.topic,
            output.type_name,
            output.cdr,
            log_time=time,
            publish_time=time,
            qos=self._qos,
        )
