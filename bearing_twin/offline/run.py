# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Offline replay: drive twin and diagnosis from the inputs in a recording, as fast as it goes."""

from __future__ import annotations

from collections import deque
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import chain
import math
import os
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.assets.parameters import diagnosis as diagnosis_parameters
from bearing_twin.assets.parameters import twin as twin_parameters
from bearing_twin.assets.parameters.spec import configuration, read_values
from bearing_twin.assets.twin import Twin
from bearing_twin.assets.twin_messages import REALTIME, TwinBlock, TwinBytes, vibration_block
from bearing_twin.dynamics.limits import Limit
from bearing_twin.errors import BearingTwinError
from bearing_twin.offline.diagnosis_run import DiagnosisRun
from bearing_twin.offline.output import Output, output
from bearing_twin.recording.mcap.catalogue import known_fields
from bearing_twin.recording.qos import sensor_qos
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.writer import RecordingWriter, whole_recording
from bearing_twin.stamps import NANO, samples_ns
from bearing_twin.streams.ahead import ahead
from bearing_twin.streams.pacer import Due
import yaml

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping
    from concurrent.futures import Future
    from pathlib import Path

    from bearing_twin.assets.diagnosis import DueVerdict
    from bearing_twin.assets.twin import TwinInputs
    from bearing_twin.diagnosis.chain import Analysis
    from bearing_twin.dynamics.single.condition import Condition
    from bearing_twin.recording.mcap.catalogue import RecordedMessage


VIBRATION = 'bearing_twin_msgs/msg/Vibration'
STATE = 'bearing_twin_msgs/msg/TwinState'
TEMPERATURE = 'sensor_msgs/msg/Temperature'
JOINTS = 'sensor_msgs/msg/JointState'
LONGEST_PAUSE = 86_400 * NANO
"""Time without an input that a run goes over, ns: a day; a stepped clock leaves years."""
AHEAD, BATCH = 200, 25
"""Blocks that the twin may be ahead of the diagnosis, and that it hands over at a time."""


def workers() -> int:
    """
    Threads that analyse windows: one a processor, at most 4, more than which wait for the twin.

    The twin's processor too: an analysis waits for the interpreter lock now and then, and the twin
    is done first.
    """
    return min(len(os.sched_getaffinity(0)), 4)


@dataclass
class OfflineReport:
    """What an offline run has made."""

    target: Path
    duration: float
    """Length of the source, s."""
    covered: float = 0.0
    """Time of the blocks made, s."""
    blocks: int = 0
    verdicts: dict[str, int] = field(default_factory=dict)
    inputs: int = 0
    """Messages of the source that were used."""
    problems: list[str] = field(default_factory=list)
    """Files of the source that were left out because they are broken."""
    warnings: list[str] = field(default_factory=list)
    """Where the twin passed a limit of its model or of its life for the first time."""
    stopped: bool = False
    """Whether it was asked to stop before the end."""


def run_offline(
    source: Path,
    target: Path,
    *,
    twin: Mapping[str, Any] | None = None,
    diagnosis: Mapping[str, Any] | None = None,
    temperature: str = '',
    progress: Callable[[float], None] | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> OfflineReport:
    """
    Run twin and diagnosis on the temperature and speed of a recording.

    Blocks begin with the first input and follow its log time, as the live twin follows the clock;
    an input acts on the block that is due next. The new recording holds the inputs too, and
    checkpoints, so that ``verify`` can re-run it.

    The twin computes ahead in one thread and windows are analysed in others; what is written, and
    in which order, does not depend on how many there are.

    Parameters
    ----------
    source
        Recording with ``sensor_msgs/Temperature`` and, for a joint, ``sensor_msgs/JointState``.
    target
        Recording to make.
    twin, diagnosis
        Parameters of the nodes that differ from their defaults.
    temperature
        Topic of the temperature; '': the only one.
    progress
        Called with the part done, 0..1, about once per recorded second.
    stop
        Asked at every message and block; after True the recording ends in order where it is.

    Raises
    ------
    BearingTwinError
        If there is no temperature in the source, or more than one to choose from, its inputs pause
        for more than a day, or parameters or target do not fit.

    """
    info = recording_info(source)
    topics = [t for t, about in info.topics.items() if about.type_name in (TEMPERATURE, JOINTS)]
    heard = [t for t in topics if info.topics[t].type_name == TEMPERATURE and info.topics[t].count]
    chosen = [t for t in heard if temperature in ('', t)]
    if not heard:
        msg = f'{source} holds no {TEMPERATURE}; an offline run needs it'
        raise BearingTwinError(msg)
    if len(chosen) != 1:
        msg = f'{source} has temperatures on {", ".join(heard)}: choose one (--temperature TOPIC)'
        raise BearingTwinError(msg)
    topics = [t for t in topics if t in chosen or t not in heard]
    twin_values = read_values(twin_parameters.SPECS, twin or {})
    diagnosis_values = read_values(diagnosis_parameters.SPECS, diagnosis or {})
    report = OfflineReport(target, info.duration)
    threads = workers()
    with (
        whole_recording(target) as writer,
        ThreadPoolExecutor(threads, thread_name_prefix='analysis') as pool,
    ):
        writer.metadata('bearing_twin.source', {'source': source.name, 'mode': 'offline'})
        diagnosis_side = _DiagnosisSide(
            twin_values, diagnosis_values, writer, pool, threads + 1, report
        )
        messages = iter(read_messages(source, topics=topics, problems=report.problems))
        first = next(messages, None)
        if first is None:
            msg = f'{source} holds none of the messages that its summary counts'
            raise BearingTwinError(msg)
        reported = start = first.log_time
        twin_side = _TwinSide(twin_values, start)
        made = twin_side.run(chain([first], messages), info.end)
        for item in ahead(made, depth=AHEAD, batch=BATCH):
            if stop():
                report.stopped = True
                break
            diagnosis_side.take(item)
            if progress is not None and isinstance(item, _Block) and item.now - reported > NANO:
                reported = item.now
                progress((reported - start) / max(1, info.end - start))
        diagnosis_side.finish()
        if progress is not None and not report.stopped:
            progress(1.0)
    report.covered = report.blocks * twin_values['block_size'] / twin_values['sample_rate']
    return report


class _Block(NamedTuple):
    """One block of the twin, whose messages and condition are still to be worked out."""

    now: int
    due: Due
    made: TwinBlock
    temperature: float
    checkpoint: Output | None


class _Planned(NamedTuple):
    """One block that the twin is to make; the fields are those of `_Block`."""

    now: int
    due: Due
    inputs: TwinInputs
    temperature: float
    checkpoint: Output | None


class _TwinSide:
    """The inputs and the twin on one time line."""

    def __init__(self, twin: dict[str, Any], start: int) -> None:
        self._now = 0.0
        self._twin = Twin(twin, clock=lambda: self._now)
        self._text = yaml.safe_dump(configuration(twin_parameters.SPECS, twin))
        self._temperature = math.nan
        self._start = self._latest = start
        self._next_sample = 0
        # Blocks are made many at a time: after each, the twin would wait for the interpreter.
        self._waiting: list[RecordedMessage | _Planned] = []

    def run(
        self, messages: Iterable[RecordedMessage], end: int
    ) -> Iterator[RecordedMessage | _Block]:
        """Yield inputs and blocks in their order; the last block ends before ``end`` (ns)."""
        for message in messages:
            self._refuse_pause(message.log_time, f'the next message of {message.topic}')
            yield from self._blocks_until(message.log_time)
            if not self._twin.settled:
                # The first temperature may change the twin at once.
                yield from self._made()
            self._waiting.append(message)
            self._take(message)
        self._refuse_pause(end, 'the end of the recording')
        yield from self._blocks_until(end)
        yield from self._made()

    def _refuse_pause(self, time: int, what: str) -> None:
        if time - self._latest > LONGEST_PAUSE:
            msg = (
                f'{what} is {(time - self._latest) / NANO:.0f} s after the input before it; '
                f'an offline run goes over {LONGEST_PAUSE // NANO} s at most: was the clock set '
                'while it was recorded? Run the parts one by one'
            )
            raise BearingTwinError(msg)
        self._latest = time

    def _take(self, message: RecordedMessage) -> None:
        with known_fields(message.topic, message.type_name):
            self._offer(message)

    def _offer(self, message: RecordedMessage) -> None:
        decoded = message.decode()
        self._now = message.log_time / NANO
        if message.type_name == TEMPERATURE:
            self._twin.take_temperature(decoded)
            self._temperature = self._twin.temperature.taken
        else:
            self._twin.take_joints(decoded)

    def _blocks_until(self, time: int) -> Iterator[RecordedMessage | _Block]:
        """Let every block whose last sample has been taken before ``time`` (ns) be made."""
        length = self._twin.values['block_size']
        rate = self._twin.values['sample_rate']
        while True:
            now = self._start + samples_ns(self._next_sample + length, rate)
            if now > time:
                return
            due = Due(self._next_sample, self._start + samples_ns(self._next_sample, rate), 0.0)
            if self._twin.needs_checkpoint(due) or len(self._waiting) >= BATCH:
                yield from self._made()
            self._now = now / NANO
            checkpoint = self._twin.checkpoint(due, self._text)
            self._waiting.append(
                _Planned(
                    now, due, self._twin.inputs, self._temperature,
                    output('/twin_checkpoint', checkpoint) if checkpoint is not None else None,
                )
            )  # fmt: skip
            self._next_sample += length

    def _made(self) -> Iterator[RecordedMessage | _Block]:
        """Make the blocks that wait, in one go, and yield them and the inputs between them."""
        waiting, self._waiting = self._waiting, []
        inputs = [each.inputs for each in waiting if isinstance(each, _Planned)]
        made = iter(self._twin.advance_all(inputs, self._twin.values['block_size']))
        for each in waiting:
            if isinstance(each, _Planned):
                yield _Block(each.now, each.due, next(made), each.temperature, each.checkpoint)
            else:
                yield each


class _Analysed(NamedTuple):
    """A verdict whose window is being analysed."""

    due: DueVerdict
    analysis: Future[Analysis]


class _DiagnosisSide:
    """
    The diagnosis and the new recording; at most ``most`` analyses are under way.

    The messages of the twin's blocks are made here: the twin leaves the interpreter to that.
    """

    def __init__(
        self,
        twin: dict[str, Any],
        diagnosis: dict[str, Any],
        writer: RecordingWriter,
        pool: ThreadPoolExecutor,
        most: int,
        report: OfflineReport,
    ) -> None:
        self._twin = twin
        self._bytes = TwinBytes(lambda message: output('', message).cdr)
        self._passed = Limit(0)
        self._axis = diagnosis['axis']
        self._run = DiagnosisRun(diagnosis)
        self._writer = writer
        self._pool = pool
        self._most = most
        self._report = report
        self._qos = sensor_qos()
        self._waiting: deque[tuple[RecordedMessage | Output | _Analysed, int]] = deque()
        self._analyses = 0

    def take(self, item: RecordedMessage | _Block) -> None:
        """Copy an input, or work on a block."""
        if isinstance(item, _Block):
            self._work(item)
        else:
            self._waiting.append((item, item.log_time))
        self._settle(self._most)

    def finish(self) -> None:
        """Write everything that waits for its analysis or for one before it."""
        self._settle(0)

    def _settle(self, most: int) -> None:
        """Write what can be; wait until ``most`` analyses, at most, are under way."""
        while self._waiting:
            item, time = self._waiting[0]
            if isinstance(item, _Analysed):
                if self._analyses <= most and not item.analysis.done():
                    return
                for made in self._run.outputs(item.due.judge(item.analysis.result())):
                    self._write(made, time)
                self._analyses -= 1
                self._report.verdicts = dict(self._run.counts)
            elif isinstance(item, Output):
                self._write(item, time)
            else:
                self._copy(item)
            self._waiting.popleft()

    def _work(self, block: _Block) -> None:
        self._waiting.extend((made, block.now) for made in self._outputs(block))
        made, due, values = block.made, block.due, self._twin
        vibration = vibration_block(made, due, values, self._axis)
        if self._run.needs_checkpoint(vibration):
            # The state before this block is that after all verdicts before it.
            self._settle(0)
            self._write(self._run.checkpoint(vibration), block.now)
        for verdict in self._run.take(vibration, temperature=block.temperature):
            self._analyses += 1
            analysis = self._pool.submit(verdict.excerpt.analyse)
            self._waiting.append((_Analysed(verdict, analysis), block.now))
        self._report.blocks += 1
        self._report.warnings += self._new_warnings(made.block.condition, due)

    def _outputs(self, block: _Block) -> list[Output]:
        """Return what the twin publishes of a block."""
        made, due, values = block.made, block.due, self._twin
        # How late a block was says nothing here, and would differ each time.
        realtime = dict.fromkeys(REALTIME, 0)
        realtime['blocks_published'] = due.first_sample // made.block.y.size + 1
        vibration = self._bytes.vibration(made, due, values)
        return [
            *([block.checkpoint] if block.checkpoint is not None else []),
            Output('/vibration', VIBRATION, vibration),
            Output('/twin_state', STATE, self._bytes.state(made, due, values, realtime)),
        ]

    def _new_warnings(self, condition: Condition, due: Due) -> list[str]:
        """Sentences on limits that no block before has passed."""
        if condition.limits_passed in self._passed:
            return []
        passed = (limit for limit in Limit if limit in condition.limits_passed)
        new = [
            sentence
            for limit, sentence in zip(passed, condition.warnings, strict=True)
            if limit not in self._passed
        ]
        self._passed |= condition.limits_passed
        seconds = due.first_sample / self._twin['sample_rate']
        return [f'at {seconds:.1f} s {sentence}' for sentence in new]

    def _copy(self, message: RecordedMessage) -> None:
        self._writer.copy(message)
        self._report.inputs += 1

    def _write(self, made: Output, time: int) -> None:
        self._writer.write(
            made.topic, made.type_name, made.cdr, log_time=time, publish_time=time, qos=self._qos
        )
