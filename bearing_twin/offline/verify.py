# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Re-run a recorded run from its checkpoints, and compare byte by byte.

Vibration is a function of a checkpoint of the twin and of the temperature and speed that each
``TwinState`` carries; a diagnosis is one of a checkpoint and of the vibration blocks, which carry
the speed, and of the temperature that it reports itself.
"""

from __future__ import annotations

import heapq
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.offline.agreement import Agreement, Reproduction
from bearing_twin.offline.diagnosis_check import DiagnosisCheck, HORIZON
from bearing_twin.offline.sides import configuration_values, TwinRun
from bearing_twin.recording.reader import known_fields, read_messages, recording_info
from bearing_twin.stamps import stamp_ns
from bearing_twin.streams.pacer import Due
from bearing_twin.thermal.gate import GatedTemperature, TemperatureStatus

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from bearing_twin.recording.reader import RecordedMessage

__all__ = ['reproduce']

TYPES = {
    'bearing_twin_msgs/msg/Checkpoint',
    'bearing_twin_msgs/msg/Vibration',
    'bearing_twin_msgs/msg/TwinState',
    'bearing_twin_msgs/msg/Diagnosis',
}


def reproduce(path: Path) -> Reproduction:
    """
    Re-run what twin and diagnosis published in a recording, and compare.

    Raises
    ------
    BearingTwinError
        If the recording cannot be read or holds no checkpoint to begin with.

    """
    info = recording_info(path)
    topics = [name for name, topic in info.topics.items() if topic.type_name in TYPES]
    if not any(name.endswith('_checkpoint') for name in topics):
        msg = f'{path} holds no checkpoint of a twin or a diagnosis: there is nothing to re-run'
        raise BearingTwinError(msg)
    result = Reproduction(path)
    twins: dict[str, _TwinCheck] = {}
    diagnoses: dict[str, DiagnosisCheck] = {}
    for message in _in_order_of_sending(read_messages(path, topics=topics)):
        namespace, _, name = message.topic.rpartition('/')
        twin = twins.setdefault(namespace, _TwinCheck(namespace, result))
        diagnosis = diagnoses.setdefault(namespace, DiagnosisCheck(namespace, result))
        with known_fields(message.topic, message.type_name):
            if name == 'vibration':
                twin.vibration(message)
                diagnosis.vibration(message)
            elif name == 'diagnosis':
                diagnosis.verdict(message)
            elif name == 'twin_state':
                twin.state(message.decode())
            elif name == 'twin_checkpoint':
                twin.checkpoint(message.decode())
            elif name == 'diagnosis_checkpoint':
                diagnosis.checkpoint(message.decode())
    for twin in twins.values():
        twin.finish()
    for diagnosis in diagnoses.values():
        diagnosis.finish()
    result.topics = {name: a for name, a in result.topics.items() if a != Agreement()}
    return result


def _in_order_of_sending(messages: Iterable[RecordedMessage]) -> Iterator[RecordedMessage]:
    heap: list[tuple[int, int, RecordedMessage]] = []
    for position, message in enumerate(messages):
        heapq.heappush(heap, (message.publish_time, position, message))
        while heap and heap[0][0] < message.log_time - HORIZON:
            yield heapq.heappop(heap)[2]
    while heap:
        yield heapq.heappop(heap)[2]


class _TwinCheck:
    """Re-run of one twin, block by block."""

    def __init__(self, namespace: str, result: Reproduction) -> None:
        self._topic = f'{namespace}/vibration'
        self._result = result
        self._run: TwinRun | None = None
        self._pending: Any = None
        self._recorded: RecordedMessage | None = None
        self._published = -1
        self._of_twin = False

    @property
    def _agreement(self) -> Agreement:
        return self._result.topics.setdefault(self._topic, Agreement())

    def checkpoint(self, checkpoint: Any) -> None:
        """Go on from here, unless that is where the re-run is anyway."""
        self._of_twin = True
        state = bytes(checkpoint.state)
        values = configuration_values(str(checkpoint.configuration))
        if self._run is not None and self._run.values == values and self._run.state == state:
            return
        if self._run is not None:
            what = 'went on from another state' if self._run.values == values else 'was changed'
            self._result.notes.append(
                f'{self._topic}: the twin {what} at sample {checkpoint.first_sample}'
            )
        self._pending = checkpoint

    def vibration(self, message: RecordedMessage) -> None:
        """Keep a recorded block until its state has come."""
        if self._recorded is not None:
            self._agreement.skipped += 1
        self._recorded = message

    def state(self, state: Any) -> None:
        """Re-run the block that this state belongs to."""
        self._of_twin = True
        message, self._recorded = self._recorded, None
        if message is None:
            self._lose()
            return
        recorded = message.decode()
        first, length = int(state.first_sample), int(state.sample_count)
        if first != int(recorded.first_sample) or length != len(recorded.y):
            self._agreement.skipped += 1
            self._lose()
            return
        if self._pending is not None and int(self._pending.first_sample) == first:
            self._run = TwinRun(
                configuration_values(str(self._pending.configuration)),
                bytes(self._pending.state),
            )
            self._pending = None
        elif int(state.blocks_published) != self._published + 1:
            self._lose()
        self._published = int(state.blocks_published)
        if self._run is None:
            self._agreement.skipped += 1
            return
        stamp = stamp_ns(recorded.header.stamp)
        used = GatedTemperature(
            float(state.temperature_used), math.nan, math.nan, TemperatureStatus.OK
        )
        _, (again, _) = self._run.block(
            Due(first, stamp, 0.0), length, used, float(state.shaft_hz)
        )
        self._agreement.compare(message, again.cdr, f'{self._topic} at sample {first}')

    def finish(self) -> None:
        """Count the last block, which waits for its state; a sensor's are nobody's to re-run."""
        if self._recorded is not None:
            self._agreement.skipped += 1
        if not self._of_twin and self._result.topics.pop(self._topic, None) is not None:
            self._result.notes.append(
                f'{self._topic}: no twin was recorded with it; it is taken as measured'
            )

    def _lose(self) -> None:
        """Wait for the next checkpoint: a block is missing in the recording."""
        if self._run is not None:
            self._result.notes.append(
                f'{self._topic}: blocks are missing after block {self._published}; '
                'the re-run goes on at the next checkpoint'
            )
        self._run = None
