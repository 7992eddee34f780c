# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Run twin and diagnosis offline from the inputs in a recording, as fast as possible."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import chain
import math
import os
from pathlib import Path
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.assets.parameters import diagnosis as diagnosis_parameters
from bearing_twin.assets.parameters import twin as twin_parameters
from bearing_twin.assets.parameters.spec import configuration, read_values
from bearing_twin.assets.twin import Twin
from bearing_twin.assets.twin_messages import REALTIME, TwinBlock, TwinBytes, vibration_block
from bearing_twin.dynamics.limits import Limit
from bearing_twin.errors import BearingTwinError, refused
from bearing_twin.offline.diagnosis_run import DiagnosisRun
from bearing_twin.offline.output import Output, output
from bearing_twin.recording.mcap.catalogue import known_fields
from bearing_twin.recording.qos import sensor_qos
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.topics import JOINT_STATE, TEMPERATURE, TWIN_STATE, VIBRATION
from bearing_twin.recording.writer import RecordingWriter, whole_recording
from bearing_twin.stamps import NANO, samples_ns
from bearing_twin.streams.ahead import ahead
from bearing_twin.streams.pacer import Due
import yaml

if TYPE_CHECKING:
    from concurrent.futures import Future

    from bearing_twin.assets.diagnosis import DueVerdict
    from bearing_twin.assets.twin import TwinInputs
    from bearing_twin.diagnosis.chain import Analysis
    from bearing_twin.dynamics.single.condition import Condition
    from bearing_twin.recording.mcap.catalogue import RecordedMessage


LONGEST_PAUSE = 86_400 * NANO
"""Longest time between two inputs of a run, ns: a day; a clock that was set makes years."""
AHEAD, BATCH = 200, 25
"""Blocks that the twin may be ahead of the diagnosis, and blocks passed on at a time."""


def workers() -> int:
    """
    Return the number of threads that analyse windows: one per processor, at most 4.

    More than 4 would wait for the twin. The processor of the twin counts too, because an analysis
    sometimes waits for the interpreter lock, and the twin finishes first.
    """
    return min(len(os.sched_getaffinity(0)), 4)


@dataclass
class OfflineReport:
    """Results of an offline run."""

    target: Path
    duration: float
    """Length of the source, s."""
    covered: float = 0.0
    """Duration of the computed blocks, s."""
    blocks: int = 0
    verdicts: dict[str, int] = field(default_factory=dict)
    """Number of verdicts, by result."""
    inputs: int = 0
    """Messages of the source that were used."""
    problems: list[str] = field(default_factory=list)
    """Errors of files of the source that were skipped because they are broken."""
    warnings: list[str] = field(default_factory=list)
    """For each violated limit of model or bearing life, a sentence with the time it began."""
    stopped: bool = False
    """Whether the run was stopped before the end."""


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
    Run twin and diagnosis on the temperature and speed of a recording; write a new recording.

    Blocks begin at the log time of the first input, as those of the live twin follow the clock. An
    input acts on the next block. The new recording also contains the inputs, and checkpoints from
    which ``verify`` can re-run it.

    The twin computes ahead in one thread, and other threads analyse windows. Content and order of
    the recording do not depend on the number of threads.

    Parameters
    ----------
    source
        Recording with ``sensor_msgs/Temperature`` and, for a joint, ``sensor_msgs/JointState``.
    target
        Recording to write.
    twin, diagnosis
        Parameters of the nodes that differ from their defaults.
    temperature
        Topic of the temperature; '': the only one.
    progress
        Called with the fraction done, 0..1, about once per recorded second.
    stop
        Called at every message and block; if it returns True, the recording is finished there.

    Raises
    ------
    BearingTwinError
        If the source has no temperature or several to choose from, if its inputs pause for more
        than a day, or if a parameter or the target is invalid.

    """
    info = recording_info(source)
    inputs = TEMPERATURE, JOINT_STATE
    topics = [name for name, topic in info.topics.items() if topic.type_name in inputs]
    heard = [t for t in topics if info.topics[t].type_name == TEMPERATURE and info.topics[t].count]
    chosen = [t for t in heard if temperature in ('', t)]
    if not heard:
        raise BearingTwinError(f'{source} holds no {TEMPERATURE}; an offline run needs it')
    if len(chosen) != 1:
        msg = f'{source} has temperatures on {", ".join(heard)}: choose one (--temperature TOPIC)'
        raise BearingTwinError(msg)
    topics = [t for t in topics if t in chosen or t not in heard]
    with refused():
        twin_values = read_values(twin_parameters.SPECS, twin or {})
        diagnosis_values = read_values(diagnosis_parameters.SPECS, diagnosis or {})
        twin_parameters.build_parameters(twin_values)
        diagnosis_parameters.check_diagnosis(diagnosis_values)
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
            raise BearingTwinError(f'{source} holds none of the messages that its summary counts')
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
        diagnosis_side.settle(0)
        if progress is not None and not report.stopped:
            progress(1.0)
    report.covered = report.blocks * twin_values['block_size'] / twin_values['sample_rate']
    return report


class _Block(NamedTuple):
    """One computed block of the twin; its messages and condition are not computed yet."""

    now: int
    due: Due
    made: TwinBlock
    temperature: float
    checkpoint: Output | None


class _Planned(NamedTuple):
    """One block that the twin has to compute; the fields are those of `_Block`."""

    now: int
    due: Due
    inputs: TwinInputs
    temperature: float
    checkpoint: Output | None


class _TwinSide:
    """Compute the blocks of the twin from the inputs in order of time."""

    def __init__(self, twin: dict[str, Any], start: int) -> None:
        self._now = 0.0
        self._twin = Twin(twin, clock=lambda: self._now)
        self._text = yaml.safe_dump(configuration(twin_parameters.SPECS, twin))
        self._temperature = math.nan
        self._start = self._latest = start
        self._next_sample = 0
        # Many blocks are computed in one call: the twin waits for the interpreter after each call.
        self._waiting: list[RecordedMessage | _Planned] = []

    def run(
        self, messages: Iterable[RecordedMessage], end: int
    ) -> Iterator[RecordedMessage | _Block]:
        """Yield inputs and blocks in order of time; the last block ends by ``end`` (ns)."""
        for message in messages:
            self._refuse_pause(message.log_time, f'the next message of {message.topic}')
            yield from self._blocks_until(message.log_time)
            if not self._twin.settled:
                # The first temperature may change the twin: compute the blocks before it first.
                yield from self._made()
            self._waiting.append(message)
            self._take(message)
        self._refuse_pause(end, 'the end of the recording')
        yield from self._blocks_until(end)
        yield from self._made()

    def _refuse_pause(self, time: int, what: str) -> None:
        if time - self._latest > LONGEST_PAUSE:
            raise BearingTwinError(
                f'{what} is {(time - self._latest) / NANO:.0f} s after the input before it; '
                f'an offline run goes over {LONGEST_PAUSE // NANO} s at most: was the clock set '
                'while it was recorded? Run the parts one by one'
            )
        self._latest = time

    def _take(self, message: RecordedMessage) -> None:
        self._now = message.log_time / NANO
        with known_fields(message.topic, message.type_name):
            if message.type_name == TEMPERATURE:
                self._twin.take_temperature(message.decode())
                self._temperature = self._twin.temperature.taken
            else:
                self._twin.take_joints(message.decode())

    def _blocks_until(self, time: int) -> Iterator[RecordedMessage | _Block]:
        """Queue every block that ends by ``time`` (ns); yield the blocks that get computed."""
        length = self._twin.values['block_size']
        rate = self._twin.values['sample_rate']
        while True:
            now = self._start + samples_ns(self._next_sample + length, rate)
            if now > time:
                return
            due = Due(self._next_sample, self._start + samples_ns(self._next_sample, rate), 0.0)
            if self._twin.checkpoints.is_due(due.first_sample) or len(self._waiting) >= BATCH:
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
        """Compute the waiting blocks in one call; yield them and the inputs between them."""
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
    Diagnose the blocks and write the new recording; at most ``most`` analyses run at a time.

    The messages of the twin's blocks are made here, because the twin does not need the interpreter
    while it computes.
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
        """Copy an input or process a block."""
        if isinstance(item, _Block):
            self._work(item)
        else:
            self._waiting.append((item, item.log_time))
        self.settle(self._most)

    def settle(self, most: int) -> None:
        """Write all messages that are ready; wait until at most ``most`` analyses are running."""
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
                self._writer.copy(item)
                self._report.inputs += 1
            self._waiting.popleft()

    def _work(self, block: _Block) -> None:
        self._waiting.extend((made, block.now) for made in self._outputs(block))
        made, due, values = block.made, block.due, self._twin
        vibration = vibration_block(made, due, values, self._axis)
        self._run.admit(vibration)
        if self._run.needs_checkpoint(vibration):
            # The checkpoint needs the state after all earlier verdicts.
            self.settle(0)
            self._write(self._run.checkpoint_output(vibration), block.now)
        for verdict in self._run.take(vibration, temperature=block.temperature, joint_hz=math.nan):
            self._analyses += 1
            analysis = self._pool.submit(verdict.excerpt.analyse)
            self._waiting.append((_Analysed(verdict, analysis), block.now))
        self._report.blocks += 1
        self._report.warnings += self._new_warnings(made.block.condition, due)

    def _outputs(self, block: _Block) -> list[Output]:
        """Return the messages that the twin publishes for a block."""
        made, due, values = block.made, block.due, self._twin
        # Lateness has no meaning offline, and would make each run different.
        realtime = dict.fromkeys(REALTIME, 0)
        realtime['blocks_published'] = due.first_sample // made.block.y.size + 1
        vibration = self._bytes.vibration(made, due, values)
        return [
            *([block.checkpoint] if block.checkpoint is not None else []),
            Output('/vibration', VIBRATION, vibration),
            Output('/twin_state', TWIN_STATE, self._bytes.state(made, due, values, realtime)),
        ]

    def _new_warnings(self, condition: Condition, due: Due) -> list[str]:
        """Return a sentence for each limit that is violated for the first time."""
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

    def _write(self, made: Output, time: int) -> None:
        self._writer.write(made.topic, made.type_name, made.cdr, log_time=time, qos=self._qos)
