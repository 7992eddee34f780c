# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Re-run a recorded run from its checkpoints, and compare byte by byte.

Vibration is a function of a checkpoint of the twin and of the temperature and speed that each
``TwinState`` carries; a diagnosis is one of a checkpoint and of the vibration blocks, which carry
the speed, and of the temperature that it reports itself.
"""

from __future__ import annotations

from collections import deque
import contextlib
from dataclasses import dataclass, field
import heapq
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.offline.sides import configuration_values, DiagnosisRun, TwinRun
from bearing_twin.recording.reader import known_fields, read_messages, recording_info
from bearing_twin.recording.schema import canonical_cdr
from bearing_twin.stamps import NANO, stamp_ns
from bearing_twin.streams.pacer import Due
from bearing_twin.thermal.gate import GatedTemperature, TemperatureStatus

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from bearing_twin.recording.reader import RecordedMessage

__all__ = ['Agreement', 'Reproduction', 'reproduce']

HORIZON = 3 * NANO
"""Log time within which messages of several publishers are put into the order of sending, ns."""
LONGEST_WINDOW = 60.0
"""Longest window of a diagnosis, s."""
TYPES = {
    'bearing_twin_msgs/msg/Checkpoint',
    'bearing_twin_msgs/msg/Vibration',
    'bearing_twin_msgs/msg/TwinState',
    'bearing_twin_msgs/msg/Diagnosis',
}


@dataclass
class Agreement:
    """Messages of one topic, re-run against recorded."""

    identical: int = 0
    different: int = 0
    skipped: int = 0
    """Recorded before a checkpoint from which to re-run, or after a loss in the recording."""
    first_difference: str = ''

    def compare(self, message: RecordedMessage, again: bytes, what: str) -> None:
        """Count one message; padding between fields, which carries nothing, is left out."""
        channel = message.channel
        recorded = canonical_cdr(channel.type_name, channel.schema, message.cdr)
        if recorded == again:
            self.identical += 1
            return
        self.different += 1
        if not self.first_difference:
            at = next(
                (i for i, (a, b) in enumerate(zip(recorded, again, strict=False)) if a != b),
                min(len(recorded), len(again)),
            )
            self.first_difference = f'{what}: byte {at} of {len(recorded)}'


@dataclass
class Reproduction:
    """Result of a re-run."""

    path: Path
    topics: dict[str, Agreement] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    """What happened in the run besides: restarts, changed parameters."""

    @property
    def uncompared(self) -> list[str]:
        """Topics of which not one message could be compared."""
        return sorted(n for n, a in self.topics.items() if not a.identical + a.different)

    @property
    def identical(self) -> bool:
        """Whether something of each topic was compared and all of that was equal to the byte."""
        return (
            bool(self.topics)
            and not self.uncompared
            and not any(a.different for a in self.topics.values())
        )


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
    diagnoses: dict[str, _DiagnosisCheck] = {}
    for message in _in_order_of_sending(read_messages(path, topics=topics)):
        namespace, _, name = message.topic.rpartition('/')
        twin = twins.setdefault(namespace, _TwinCheck(namespace, result))
        diagnosis = diagnoses.setdefault(namespace, _DiagnosisCheck(namespace, result))
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
        first = int(state.first_sample)
        if first != int(recorded.first_sample):
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
            Due(first, stamp, 0.0), int(state.sample_count), used, float(state.shaft_hz)
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


class _DiagnosisCheck:
    """Blocks wait until what the node sent in answer to them is known."""

    def __init__(self, namespace: str, result: Reproduction) -> None:
        self._topic = f'{namespace}/diagnosis'
        self._result = result
        self._run: DiagnosisRun | None = None
        self._blocks: deque[RecordedMessage] = deque()
        self._checkpoints: deque[Any] = deque()
        self._verdicts: deque[tuple[RecordedMessage, Any]] = deque()
        self._past: deque[Any] = deque()

    def vibration(self, message: RecordedMessage) -> None:
        """Take a block; work on those that have waited long enough."""
        self._blocks.append(message)
        while self._blocks[0].publish_time < message.publish_time - HORIZON:
            self._push(self._blocks.popleft())

    def checkpoint(self, checkpoint: Any) -> None:
        """Take a checkpoint."""
        self._checkpoints.append(checkpoint)

    def verdict(self, message: RecordedMessage) -> None:
        """Take a recorded verdict."""
        self._verdicts.append((message, message.decode()))

    def finish(self) -> None:
        """Work on what still waits."""
        while self._blocks:
            self._push(self._blocks.popleft())
        if self._verdicts:
            agreement = self._result.topics.setdefault(self._topic, Agreement())
            agreement.skipped += len(self._verdicts)

    def _push(self, message: RecordedMessage) -> None:
        block = message.decode()
        while self._checkpoints and _before(self._checkpoints[0], block):
            # A late joiner gets the last checkpoint of a time before the recording.
            self._checkpoints.popleft()
        if self._checkpoints and int(self._checkpoints[0].first_sample) == int(block.first_sample):
            self._resume(self._checkpoints.popleft())
        if self._run is None:
            self._keep(block)
            return
        temperature, speed = math.nan, math.nan
        if self._verdicts:
            verdict = self._verdicts[0][1]
            temperature = float(verdict.temperature)
            speed = self._speed(self._run)
        agreement = self._result.topics.setdefault(self._topic, Agreement())
        try:
            outputs = list(
                self._run.push(
                    block,
                    temperature=temperature,
                    joint_hz=speed,
                    measured=not math.isnan(speed),
                )
            )
        except BearingTwinError:
            # The node refuses such a block as well.
            return
        for output in outputs:
            if output.topic != '/diagnosis':
                continue
            if not self._verdicts:
                # The recording ended before this verdict came.
                return
            recorded, verdict = self._verdicts.popleft()
            what = f'{self._topic} at sample {verdict.first_sample}'
            agreement.compare(recorded, output.cdr, what)

    def _resume(self, checkpoint: Any) -> None:
        values = configuration_values(str(checkpoint.configuration))
        state = bytes(checkpoint.state)
        at = f'at sample {checkpoint.first_sample}'
        if self._run is not None and self._run.values != values:
            self._run.reconfigure(values)
            self._result.notes.append(f'{self._topic}: parameters were changed {at}')
        if self._run is not None and self._run.state == state:
            return
        sample = int(checkpoint.first_sample)
        window: list[Any] = []
        if self._run is not None:
            self._result.notes.append(f'{self._topic}: the diagnosis was restarted {at}')
        else:
            found = self._window_before(sample)
            if found is None:
                return
            window = found
        self._run = self._opened(values, state, window)
        self._past.clear()
        # Verdicts on what came before cannot be re-run.
        while self._verdicts:
            verdict = self._verdicts[0][1]
            if (_end(verdict) if window else int(verdict.first_sample) + 1) > sample:
                break
            agreement = self._result.topics.setdefault(self._topic, Agreement())
            agreement.skipped += 1
            self._verdicts.popleft()

    def _opened(self, values: dict[str, Any], state: bytes, window: list[Any]) -> DiagnosisRun:
        """Diagnosis in a recorded state, with the blocks before it in its window."""
        if not window:
            return DiagnosisRun(values, state)
        run = DiagnosisRun(values)
        speed = self._speed(run)
        for block in window:
            with contextlib.suppress(BearingTwinError):
                # The node refuses such a block as well.
                run.take(
                    block, temperature=math.nan, joint_hz=speed, measured=not math.isnan(speed)
                )
        run.load(state)
        return run

    def _speed(self, run: DiagnosisRun) -> float:
        """Speed that the next verdict was given, Hz, where it may come from a joint; else NaN."""
        if not (self._verdicts and run.values['joint']):
            return math.nan
        return float(self._verdicts[0][1].shaft_hz_given)

    def _keep(self, block: Any) -> None:
        """Keep a block from before the first checkpoint that serves: windows reach back."""
        if self._past and int(block.first_sample) != _block_end(self._past[-1]):
            self._past.clear()
        self._past.append(block)
        while _block_end(block) - _block_end(self._past[0]) > LONGEST_WINDOW * block.sample_rate:
            self._past.popleft()

    def _window_before(self, sample: int) -> list[Any] | None:
        """Blocks before a checkpoint that the next verdict rests on; None if some are missing."""
        for _, verdict in self._verdicts:
            if _end(verdict) > sample:
                first = int(verdict.first_sample)
                window = [block for block in self._past if _block_end(block) > first]
                reaches_back = bool(window) and int(window[0].first_sample) <= first
                whole = reaches_back and _block_end(window[-1]) == sample
                return window if whole else [] if first >= sample else None
        return []


def _end(verdict: Any) -> int:
    """Index of the sample after the window of a verdict."""
    return int(verdict.first_sample) + int(verdict.sample_count)


def _block_end(block: Any) -> int:
    """Index of the sample after a block of vibration."""
    return int(block.first_sample) + max(len(block.x), len(block.y))


def _before(checkpoint: Any, block: Any) -> bool:
    """Whether a checkpoint lies before a block in index and in time: a new twin begins at 0."""
    return int(checkpoint.first_sample) < int(block.first_sample) and stamp_ns(
        checkpoint.header.stamp
    ) < stamp_ns(block.header.stamp)
