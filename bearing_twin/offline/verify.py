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
from collections.abc import Collection, Iterable, Iterator, Mapping
import heapq
from pathlib import Path
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.offline.agreement import Agreement, Reproduction
from bearing_twin.offline.diagnosis_check import DiagnosisCheck, HORIZON
from bearing_twin.offline.twin_check import FleetCheck, TwinCheck
from bearing_twin.recording.health import sent_before
from bearing_twin.recording.mcap.catalogue import known_fields
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.topics import CHECKPOINT, DIAGNOSIS, DIAGNOSTICS, TWIN_STATE, VIBRATION
from bearing_twin.streams.ahead import ahead
from bearing_twin.streams.vibration_input import SOURCE_MEASURED

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.catalogue import RecordedMessage
    from bearing_twin.recording.reader import TopicInfo


TYPES = {CHECKPOINT, DIAGNOSIS, DIAGNOSTICS, TWIN_STATE, VIBRATION}
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
    messages = _Messages(read_messages(path, topics=topics, problems=result.notes), result)
    twins = _Twins(info.topics, result)
    diagnoses: dict[str, DiagnosisCheck] = {}
    verdicts = _verdict_topics(info.topics)
    # Twins and diagnoses run in two threads: the compiled code of both releases the interpreter.
    for message in ahead(map(twins.take, messages), depth=AHEAD, batch=BATCH):
        namespace, _, name = message.topic.rpartition('/')
        with known_fields(message.topic, message.type_name):
            checkpoint = message.decode() if message.type_name == CHECKPOINT else None
            if checkpoint is not None:
                namespace = _namespace(message.topic, checkpoint, info.topics)
            topic = verdicts.get(namespace, f'{namespace}/diagnosis')
            diagnosis = diagnoses.setdefault(namespace, DiagnosisCheck(topic, result))
            if message.type_name == VIBRATION and name == 'vibration':
                diagnosis.vibration(message)
            elif message.topic == topic:
                diagnosis.verdict(message)
            elif message.type_name == DIAGNOSIS:
                result.topics.setdefault(message.topic, Agreement()).skipped += 1
            elif checkpoint is not None and checkpoint.kind == 'diagnosis':
                diagnosis.checkpoint(checkpoint)
    messages.finish()
    twins.finish()
    for diagnosis in diagnoses.values():
        diagnosis.finish()
        result.notes += diagnosis.notes
    result.topics = {name: a for name, a in result.topics.items() if a != Agreement()}
    return result


class _Messages:
    """The messages of a recording in the order of sending, each once."""

    def __init__(self, messages: Iterable[RecordedMessage], result: Reproduction) -> None:
        self._messages = messages
        self._result = result
        self._early: dict[str, int] = {}
        self._last: dict[str, bytes] = {}
        self._twice: Counter[str] = Counter()

    def __iter__(self) -> Iterator[RecordedMessage]:
        """Yield the messages of twins and diagnoses."""
        for message in _in_order_of_sending(self._messages):
            topic = message.topic
            if message.type_name == DIAGNOSTICS:
                self._early.update(sent_before(message.decode()))
                continue
            if self._last.get(topic) == message.cdr:
                # Each message has its own stamp, so an identical one is a duplicate.
                self._twice[topic] += 1
                continue
            self._last[topic] = message.cdr
            yield message

    def finish(self) -> None:
        """Note what the recording lacks, and what it has twice."""
        for topic, count in sorted(self._early.items()):
            self._result.notes.append(f'{topic}: {count} messages were sent before the recording')
        for topic, count in sorted(self._twice.items()):
            self._result.notes.append(f'{topic}: {count} messages are there twice')


class _Twins:
    """
    Re-runs of all twins and fleets of a recording.

    Vibration is assigned to the twin of its namespace; a topic with another name gets a re-run of
    its own until a state shows to which twin it was remapped.
    """

    def __init__(self, topics: Collection[str], result: Reproduction) -> None:
        self._topics = topics
        self._result = result
        self._twins: dict[str, TwinCheck] = {}
        """By namespace."""
        self._sources: dict[str, TwinCheck] = {}
        """By topic of vibration."""
        self._fleets: dict[str, FleetCheck] = {}
        """By name of the node."""

    def take(self, message: RecordedMessage) -> RecordedMessage:
        """Re-run what a message completes; return the message."""
        namespace, _, name = message.topic.rpartition('/')
        with known_fields(message.topic, message.type_name):
            if message.type_name == VIBRATION:
                self._source(message).vibration(message)
            elif name == 'twin_state':
                state = message.decode()
                self._twin_of_state(namespace, state).state(message, state)
            elif message.type_name == CHECKPOINT:
                self._checkpoint(message.topic, message.decode())
        return message

    def _checkpoint(self, topic: str, checkpoint: Any) -> None:
        if checkpoint.kind == 'twin':
            namespace = _namespace(topic, checkpoint, self._topics)
            self._twin(namespace).checkpoint(checkpoint)
        elif checkpoint.kind == 'fleet':
            node = str(checkpoint.node)
            fleet = self._fleets.setdefault(node, FleetCheck(node, self._result))
            fleet.checkpoint(checkpoint, self._twin)

    def finish(self) -> None:
        """Re-run the waiting blocks."""
        for fleet in self._fleets.values():
            fleet.finish()
        for twin in dict.fromkeys((*self._twins.values(), *self._sources.values())):
            twin.finish()

    def _twin(self, namespace: str) -> TwinCheck:
        return self._twins.setdefault(namespace, TwinCheck(f'{namespace}/vibration', self._result))

    def _source(self, message: RecordedMessage) -> TwinCheck:
        """Return the re-run of a topic of vibration."""
        topic = message.topic
        if topic not in self._sources:
            namespace, _, name = topic.rpartition('/')
            own = name == 'vibration' and message.decode().source != SOURCE_MEASURED
            self._sources[topic] = self._twin(namespace) if own else TwinCheck(topic, self._result)
        return self._sources[topic]

    def _twin_of_state(self, namespace: str, state: Any) -> TwinCheck:
        """Return the re-run of the twin of a namespace; find the topic of its vibration."""
        twin = self._twin(namespace)
        if twin.has_block_of(state):
            return twin
        for topic, other in self._sources.items():
            former = topic.removesuffix('/vibration')
            if f'{former}/twin_state' not in self._topics and other.waits_for(state):
                if self._sources.get(twin.topic) is twin:
                    self._sources[twin.topic] = TwinCheck(twin.topic, self._result)
                twin.take_over(other)
                self._sources[topic] = twin
                self._twins.pop(former, None)
                break
        return twin


def _namespace(topic: str, checkpoint: Any, topics: Collection[str]) -> str:
    """
    Return the namespace of the other topics of a checkpoint's node.

    It is that of its topic, or of the node if the topic is remapped. Beside another node that has
    not remapped its own it belongs to none: the topic itself is returned.
    """
    namespace, _, name = topic.rpartition('/')
    own = f'{checkpoint.kind}_checkpoint'
    if name == own:
        return namespace
    namespace = str(checkpoint.node).rpartition('/')[0]
    return topic if f'{namespace}/{own}' in topics else namespace


def _verdict_topics(topics: Mapping[str, TopicInfo]) -> dict[str, str]:
    """Return the only topic of verdicts of a namespace, by namespace, where it is remapped."""
    found: dict[str, list[str]] = {}
    for topic in sorted(topics):
        if topics[topic].type_name == DIAGNOSIS:
            found.setdefault(topic.rpartition('/')[0], []).append(topic)
    return {namespace: every[0] for namespace, every in found.items() if len(every) == 1}


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
