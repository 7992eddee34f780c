# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Targets of guided fuzzing that are no files: sequences of messages, and saved states."""

from __future__ import annotations

import contextlib
import math
import struct
from typing import Any, TYPE_CHECKING
import zlib

from bearing_twin.assets.diagnosis_parameters import build_diagnoser, SPECS
from bearing_twin.dynamics import preset, Simulator
from bearing_twin.errors import BearingTwinError
from bearing_twin.ros.subscribing import read_message
from bearing_twin.stamps import stamp_ns
from bearing_twin.streams.shaft import ShaftSpeed
from bearing_twin.streams.vibration_input import GapCounter, read_vibration
from bearing_twin.thermal.gate import TemperatureGate
from bearing_twin.thermal.gcr15 import TABLE_HIGH, TABLE_LOW
from bearing_twin_msgs.msg import Vibration
import numpy as np
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState, Temperature

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from bearing_twin.diagnosis import StreamingDiagnoser

TYPES = (Vibration, Temperature, JointState)
RATE = 128.0
"""So low that a window of one second is a short input, Hz."""


def _diagnoser() -> StreamingDiagnoser:
    values = {spec.name: spec.default for spec in SPECS}
    return build_diagnoser({**values, 'window': 1.0, 'memory': 1.0, 'update_interval': 0.5})


def _packed(messages: list[Any]) -> bytes:
    parts = []
    for message in messages:
        cdr = serialize_message(message)
        parts.append(struct.pack('<BH', TYPES.index(type(message)), len(cdr)) + cdr)
    return b''.join(parts)


def _unpacked(data: bytes) -> Iterator[tuple[int, bytes]]:
    at = 0
    while at + 3 <= len(data):
        kind, length = struct.unpack_from('<BH', data, at)
        yield kind % len(TYPES), data[at + 3 : at + 3 + length]
        at += 3 + length


def _block(index: int, **changed: Any) -> Vibration:
    samples = np.sin(np.arange(index * 64, index * 64 + 64) * 0.3).astype(np.float32)
    fields = {
        'sample_rate': RATE, 'first_sample': index * 64, 'unit': 'm/s^2', 'shaft_hz': 2.0,
        'y': samples.tolist(),
    }  # fmt: skip
    return Vibration(**{**fields, **changed})


class _Node:
    """The path from the subscriptions to the publishers of twin and diagnosis."""

    def __init__(self) -> None:
        self.diagnoser = _diagnoser()
        self.gate = TemperatureGate(start=20.0, timeout=5.0)
        self.shaft = ShaftSpeed(nominal=2.0, joint='shaft', hold=True)
        self.gaps = GapCounter()
        self.now = 0.0

    def take(self, message: Any) -> None:
        self.now += 1.0
        if isinstance(message, Temperature):
            self.gate.offer(
                message.temperature, stamp=stamp_ns(message.header.stamp), now=self.now
            )
        elif isinstance(message, JointState):
            self.shaft.offer(message.name, message.velocity, now=self.now)
        else:
            self._diagnose(message)
        # Whatever has come, the equations of motion see numbers that they can be given.
        assert TABLE_LOW <= self.gate.at(self.now).used <= TABLE_HIGH
        assert 0.0 <= self.shaft.at(self.now) <= self.shaft.highest
        assert self.gaps.lost >= 0

    def _diagnose(self, message: Vibration) -> None:
        block = read_vibration(message, 'y')
        self.gaps.count(block.first_sample, block.samples.size)
        for result in self.diagnoser.push(
            block.first_sample,
            block.samples,
            block.sample_rate,
            self.shaft.at(self.now) if math.isnan(block.shaft_hz) else block.shaft_hz,
            speed_measured=True,
            temperature=self.gate.at(self.now).used,
            unit=block.unit,
        ):
            assert 0.0 <= result.confidence <= 1.0
            assert result.reasons


def message() -> tuple[list[bytes], Callable[[bytes], None]]:
    """Return sequences of sound messages, and what is done with a damaged one."""
    joint = JointState(name=['shaft'], velocity=[12.0])
    seeds = [
        _packed([Temperature(temperature=40.0), joint, *(_block(k) for k in range(6))]),
        _packed([_block(0), _block(1), _block(5), _block(0), _block(1), _block(2)]),
        _packed([_block(k, shaft_hz=math.nan, unit='g') for k in range(4)]),
        _packed([_block(k, x=[1.0] * 64, sample_rate=100.0 + 50.0 * (k > 2)) for k in range(5)]),
    ]

    def target(data: bytes) -> None:
        node = _Node()
        for kind, cdr in _unpacked(data):
            with contextlib.suppress(BearingTwinError):
                node.take(read_message(cdr, TYPES[kind]))

    return seeds, target


def state() -> tuple[list[bytes], Callable[[bytes], None]]:
    """Return saved states, and what is done with a damaged one whose checksum is right."""
    simulator = Simulator(preset('incipient', defect='outer'))
    simulator.advance(1024, 40.0, 25.4)
    diagnoser = _diagnoser()
    for k in range(6):
        block = _block(k)
        list(diagnoser.push(64 * k, block.y, RATE, 2.0, temperature=40.0, unit='m/s^2'))
    magic = 8
    """Bytes before the checksum of a simulator's state."""

    def resealed(data: bytes) -> bytes:
        if data[:4] == b'BTDX' and len(data) > 22:
            body = data[22:]
            length = int.from_bytes(data[10:14], 'little')
            head = struct.pack('<IIQ', zlib.crc32(body), length, len(body))
            return data[:6] + head + body
        return data[:magic] + struct.pack('<I', zlib.crc32(data[magic + 4 :])) + data[magic + 4 :]

    def target(data: bytes) -> None:
        data = resealed(data)
        with contextlib.suppress(BearingTwinError):
            simulator.load(data)
            block = simulator.advance(64, 40.0, 25.4)
            assert np.all(np.isfinite(block.y))
        other = _diagnoser()
        with contextlib.suppress(BearingTwinError):
            other.load(data)
            for k in range(4):
                list(other.push(64 * k, _block(k).y, RATE, 2.0, temperature=40.0, unit='m/s^2'))

    return [simulator.save(), diagnoser.save()], target
