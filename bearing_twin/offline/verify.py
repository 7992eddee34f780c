# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Re-run a recording from its checkpoints, and compare the messages byte by byte.

Vibration depends on a checkpoint of the twin or its fleet, and on temperature and speed in each
``TwinState``. A diagnosis depends on a checkpoint, on the vibration blocks with their speed, and
on the temperature in the ``Diagnosis`` itself.
"""

from __future__ import annotations

from collections import Counter
import heapq
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.offline.agreement import Agreement, Reproduction
from bearing_twin.offline.diagnosis_check import DiagnosisCheck, HORIZON
from bearing_twin.offline.twin_check import FleetCheck, TwinCheck
from bearing_twin.recording.health import sent_before
from bearing_twin.recording.mcap.catalogue import known_fields
from bearing_twin.recording.mcap.schema import other_version
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.streams.ahead import ahead
from bearing_twin.streams.vibration_input import SOURCE_MEASURED

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from bearing_twin.recording.mcap.catalogue import RecordedMessage


CHECKPOINT = 'bearing_twin_msgs/msg/Checkpoint'
VIBRATION = 'bearing_twin_msgs/msg/Vibration'
DIAGNOSTICS = 'diagnostic_msgs/msg/DiagnosticArray'
TYPES = {
    CHECKPOINT,
    DIAGNOSTICS,
    VIBRATION,
    'bearing_twin_msgs/msg/TwinState',
    'bearing_twin_msgs/msg/Diagnosis',
}
MOST_HELD = 128 * 1024 * 1024
"""Most bytes of messages that wait to be sorted."""
AHEAD, BATCH = 200, 25
"""Messages that the twins may be ahead of the diagnoses, and messages passed on at a time."""
OVERHEAD = 500
"""Bytes of memory that a message takes in addition to its content."""


def reproduce(path: Path) -> Reproduction:
    """
    Re-run twins, fleets and diagnoses of a recording; return the comparison with their messages.

    Raises
    ------
    BearingTwinError
        If the recording cannot be read or holds no checkpoint.

    """
    info = recording_info(path)
    topics = [name for name, topic in info.topics.items() if topic.type_name in TYPES]
    if not any(info.topics[name].type_name == CHECKPOINT for name in topics):
        msg = f'{path} holds no checkpoint of a twin or a diagnosis: there is nothing to re-run'
        raise BearingTwinError(msg)
    result = Reproduction(path)
    early: dict[str, int] = {}
    twins: dict[str, TwinCheck] = {}
    sources: dict[str, TwinCheck] = {}
    fleets: dict[str, FleetCheck] = {}
    diagnoses: dict[str, DiagnosisCheck] = {}
    last: dict[str, bytes] = {}
    twice: Counter[str] = Counter()

    def twin_of(namespace: str) -> TwinCheck:
        return twins.setdefault(namespace, TwinCheck(f'{namespace}/vibration', result))

    def source_of(message: RecordedMessage) -> TwinCheck:
        if message.topic not in sources:
            namespace, _, name = message.topic.rpartition('/')
            own = name == 'vibration' and getattr(message.decode(), 'source', 0) != SOURCE_MEASURED
            sources[message.topic] = (
                twin_of(namespace) if own else TwinCheck(message.topic, result)
            )
        return sources[message.topic]

    def twin_of_state(namespace: str, state: Any) -> TwinCheck:
        twin = twin_of(namespace)
        if twin.has_block_of(state):
            return twin
        for topic, other in sources.items():
            former = topic.removesuffix('/vibration')
            if f'{former}/twin_state' not in info.topics and other.waits_for(state):
                if sources.get(twin.topic) is twin:
                    sources[twin.topic] = TwinCheck(twin.topic, result)
                twin.take_over(other)
                sources[topic] = twin
                twins.pop(former, None)
                break
        return twin

    def twins_again() -> Iterator[RecordedMessage]:
        """Re-run the twins; yield all messages for the re-run of the diagnoses."""
        messages = read_messages(path, topics=topics, problems=result.notes)
        for message in _in_order_of_sending(messages):
            if message.type_name == DIAGNOSTICS:
                early.update(sent_before(message.decode()))
                continue
            if last.get(message.topic) == message.cdr:
                # Each message has its own stamp, so an identical one is a duplicate.
                twice[message.topic] += 1
                continue
            if message.topic not in last and (
                other := other_version(message.type_name, message.channel.schema)
            ):
                result.notes.append(f'{message.topic}: {other}')
            last[message.topic] = message.cdr
            namespace, _, name = message.topic.rpartition('/')
            with known_fields(message.topic, message.type_name):
                if message.type_name == VIBRATION:
                    source_of(message).vibration(message)
                elif name == 'twin_state':
                    state = message.decode()
                    twin_of_state(namespace, state).state(state)
                elif name == 'twin_checkpoint':
                    twin_of(namespace).checkpoint(message.decode())
                elif name == 'checkpoint' and message.type_name == CHECKPOINT:
                    checkpoint = message.decode()
                    node = str(checkpoint.node)
                    fleet = fleets.setdefault(node, FleetCheck(node, result))
                    fleet.checkpoint(checkpoint, twin_of)
            yield message

    # Twins and diagnoses run in two threads: the compiled code of both releases the interpreter.
    for message in ahead(twins_again(), depth=AHEAD, batch=BATCH):
        namespace, _, name = message.topic.rpartition('/')
        diagnosis = diagnoses.setdefault(namespace, DiagnosisCheck(namespace, result))
        with known_fields(message.topic, message.type_name):
            if message.type_name == VIBRATION and name == 'vibration':
                diagnosis.vibration(message)
            elif name == 'diagnosis':
                diagnosis.verdict(message)
            elif name == 'diagnosis_checkpoint':
                diagnosis.checkpoint(message.decode())
    for topic, count in sorted(early.items()):
        result.notes.append(f'{topic}: {count} messages were sent before the recording')
    for topic, count in sorted(twice.items()):
        result.notes.append(f'{topic}: {count} messages are there twice')
    for fleet in fleets.values():
        fleet.finish()
    for twin in dict.fromkeys((*twins.values(), *sources.values())):
        twin.finish()
    for diagnosis in diagnoses.values():
        diagnosis.finish()
        result.notes += diagnosis.notes
    result.topics = {name: a for name, a in result.topics.items() if a != Agreement()}
    return result


def _in_order_of_sending(messages: Iterable[RecordedMessage]) -> Iterator[RecordedMessage]:
    heap: list[tuple[int, int, RecordedMessage]] = []
    held = 0
    for position, message in enumerate(messages):
        heapq.heappush(heap, (message.publish_time, position, message))
        held += len(message.cdr) + OVERHEAD
        while heap and (heap[0][0] < message.log_time - HORIZON or held > MOST_HELD):
            sent = heapq.heappop(heap)[2]
            held -= len(sent.cdr) + OVERHEAD
            yield sent
    while heap:
        yield heapq.heappop(heap)[2]
