# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages and recordings for the tests of this folder."""

from __future__ import annotations

from functools import cache
from pathlib import Path
import struct
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.recording.mcap.schema import message_schema, store_from_text
from bearing_twin.recording.qos import qos_profile, qos_yaml
from bearing_twin.recording.writer import RecordingWriter, WriterOptions
import numpy as np

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

NANO = 1_000_000_000
START = 1_700_000_000 * NANO
VIBRATION = 'bearing_twin_msgs/msg/Vibration'
TEMPERATURE = 'sensor_msgs/msg/Temperature'
QOS = qos_yaml([qos_profile(depth=50)])
BLOCK = 1024
RATE = 25600.0
PERIOD = round(BLOCK / RATE * NANO)


@cache
def store(type_name: str) -> Typestore:
    """Type store of one message type."""
    return store_from_text(type_name, message_schema(type_name).text)


def header(types: Typestore, ns: int, frame_id: str = 'sensor') -> Any:
    """Return a std_msgs/Header."""
    stamp = types.types['builtin_interfaces/msg/Time'](sec=ns // NANO, nanosec=ns % NANO)
    return types.types['std_msgs/msg/Header'](stamp=stamp, frame_id=frame_id)


def vibration_cdr(index: int, *, length: int = BLOCK, hung: int = 0) -> bytes:
    """Return block ``index`` of a signal that is different in every sample, or one ``hung``."""
    types = store(VIBRATION)
    first = index * length
    samples = np.sin(0.01 * (first - hung * length + np.arange(length))).astype(np.float32)
    message = types.types[VIBRATION](
        header=header(types, START + index * PERIOD),
        sample_rate=RATE,
        first_sample=first,
        source=0,
        unit='m/s^2',
        shaft_hz=25.0,
        x=samples,
        y=2.0 * samples,
    )
    return bytes(types.serialize_cdr(message, VIBRATION))


def put_block(
    writer: RecordingWriter, index: int, time: int | None = None, *, hung: int = 0
) -> None:
    """Write block ``index``, received when it is due or at ``time`` ns."""
    time = START + index * PERIOD if time is None else time
    cdr = vibration_cdr(index, hung=hung)
    writer.write('/vibration', VIBRATION, cdr, log_time=time, qos=QOS)


def temperature_cdr(ns: int, value: float) -> bytes:
    """Return a sensor_msgs/Temperature."""
    types = store(TEMPERATURE)
    message = types.types[TEMPERATURE](header=header(types, ns), temperature=value, variance=0.0)
    return bytes(types.serialize_cdr(message, TEMPERATURE))


def write_blocks(
    path: Path, count: int, options: WriterOptions | None = None, *, flush_each: int = 10
) -> list[bytes]:
    """Write ``count`` blocks and a temperature each; a chunk each ``flush_each`` blocks."""
    written = []
    with RecordingWriter(path, options) as writer:
        writer.metadata('bearing_twin.test', {'key': 'value'})
        writer.attach('note.txt', b'attached', 'text/plain')
        for index in range(count):
            time = START + index * PERIOD
            cdr = vibration_cdr(index)
            written.append(cdr)
            writer.write(
                '/vibration', VIBRATION, cdr, log_time=time, publish_time=time - 5, qos=QOS
            )
            writer.write(
                '/temperature',
                TEMPERATURE,
                temperature_cdr(time, 20.0 + index),
                log_time=time + 1,
                publish_time=time,
                qos=QOS,
            )
            if (index + 1) % flush_each == 0:
                writer.flush()
    return written


def seconds_of_heads(content: bytes) -> float:
    """Return the processor time of a look at as many heads of records as the bytes could hold."""
    began = time.process_time()
    heads = {struct.unpack_from('<BQ', content, at)[0] for at in range(0, len(content) - 8, 9)}
    assert heads
    return time.process_time() - began
