# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Re-run one recorded diagnosis from its checkpoints and the vibration blocks."""

from __future__ import annotations

from collections import deque
import contextlib
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.checkpoints import configuration_values
from bearing_twin.assets.parameters.diagnosis import nominal_speed
from bearing_twin.diagnosis.settings import LONGEST_WINDOW
from bearing_twin.errors import BearingTwinError
from bearing_twin.offline.agreement import Agreement, without_padding
from bearing_twin.offline.diagnosis_run import DiagnosisRun
from bearing_twin.offline.output import decode
from bearing_twin.stamps import NANO, stamp_ns
from bearing_twin.streams.vibration_input import read_vibration

if TYPE_CHECKING:
    from bearing_twin.offline.agreement import Reproduction
    from bearing_twin.offline.output import Output
    from bearing_twin.recording.mcap.catalogue import RecordedMessage


_REACH = 2.0 * LONGEST_WINDOW
"""Time for which blocks are kept: a window and the signal before it, s."""

HORIZON = 3 * NANO
"""Log time within which messages of several publishers are sorted by time of sending, ns."""

_LATEST = 10 * NANO
"""Time for which a block waits for a busy diagnosis, ns."""


class DiagnosisCheck:
    """
    Re-run of one diagnosis.

    Blocks wait until the node's verdicts on them have been read. Verdicts are matched by their
    window, so a verdict that is missing in the recording does not shift the later ones.
    """

    def __init__(self, topic: str, result: Reproduction) -> None:
        self._topic = topic
        self._result = result
        self.notes: list[str] = []
        """Remarks on this diagnosis; a list of its own, as twins are re-run in another thread."""
        self._run: DiagnosisRun | None = None
        self._blocks: deque[RecordedMessage] = deque()
        # With the number of verdicts that were published before each.
        self._checkpoints: deque[tuple[Any, int]] = deque()
        self._verdicts: deque[tuple[RecordedMessage, Any]] = deque()
        self._published = 0
        # Time of the newest sample that the diagnosis is known to have used, ns.
        self._reached: float = math.inf
        self._past: deque[Any] = deque()
        # Where the re-run began, and whether with the blocks before it.
        self._begun = (0, 0, False)
        # Windows of verdicts of the re-run without a recorded verdict to compare with.
        self._unanswered: list[tuple[int, int]] = []
        # Those that the diagnosis made, as a later checkpoint tells, and those it did not make or
        # publish before that.
        self._lost: list[tuple[int, int]] = []
        self._forgotten: list[tuple[int, int]] = []
        # Whether unrecorded inputs may matter: temperature of a missing verdict, joint speeds.
        self._uncertain = False

    @property
    def _agreement(self) -> Agreement:
        return self._result.topics.setdefault(self._topic, Agreement())

    def vibration(self, message: RecordedMessage) -> None:
        """Take a block; process the blocks that have waited long enough."""
        self._blocks.append(message)
        while (waited := message.publish_time - self._blocks[0].publish_time) > HORIZON:
            if self._blocks[0].publish_time >= self._reached and waited <= _LATEST:
                break
            self._push(self._blocks.popleft())

    def checkpoint(self, checkpoint: Any) -> None:
        """Take a checkpoint."""
        self._checkpoints.append((checkpoint, self._published))
        self._reached = stamp_ns(checkpoint.header.stamp)

    def verdict(self, message: RecordedMessage) -> None:
        """Take a recorded verdict."""
        verdict = message.decode()
        self._verdicts.append((message, verdict))
        self._published += 1
        rate = float(verdict.sample_rate)
        # A file may hold any rate.
        length = int(verdict.sample_count) * NANO / rate if rate > 0.0 else 0.0
        self._reached = stamp_ns(verdict.header.stamp) + length

    def finish(self) -> None:
        """Process the waiting blocks; the recording may end before the last verdicts."""
        due = self._unanswered[:]
        while self._blocks:
            self._push(self._blocks.popleft())
        if self._verdicts:
            self._agreement.skipped += len(self._verdicts)
        unmade = [window for window in due if window in self._unanswered]
        missing = sum(window in self._lost for window in unmade)
        if missing:
            self._agreement.missing += missing
        if len(unmade) > missing:
            self._note(
                f'no verdict on the samples from {unmade[missing][0]} on is in the recording: the '
                'diagnosis ended before, or its verdicts are lost'
            )

    def _push(self, message: RecordedMessage) -> None:
        block = message.decode()
        try:
            read_vibration(block, 'y')
        except BearingTwinError as error:
            # The node refuses such a block as well.
            self._note(f'a block is refused: {error}')
            return
        first = int(block.first_sample)
        if (checkpoint := self._checkpoint_before(block)) is not None:
            self._resume(*checkpoint)
        if self._run is None:
            self._keep(block)
            return
        run, ended = self._run, self._run.diagnoser.next_sample
        try:
            taken = read_vibration(block, run.values['axis'])
            run.admit(taken)
        except BearingTwinError as error:
            self._note(f'a block is refused: {error}')
            return
        if checkpoint is None and run.diagnoser.has_gap(first, block.sample_rate):
            # The diagnosis would have made one: it did not receive this block, or had others.
            self._stop()
            self._keep(block)
            return
        if first < ended:
            # By their index alone, all verdicts may now be earlier.
            self._begun = (0, self._begun[1], False)
        # A snapshot that a pause cuts short is judged with the block after the pause.
        waits = first > ended and not run.diagnoser.may_pause
        self._drop_unmade(ended - 1 if waits else first, message.publish_time)
        temperature, speed = math.nan, math.nan
        if self._verdicts:
            temperature = float(self._verdicts[0][1].temperature)
            speed = self._speed(run)
            self._uncertain |= bool(run.values['joint']) and math.isnan(block.shaft_hz)
        for due in run.take(taken, temperature=temperature, joint_hz=speed):
            # The first output is the Diagnosis; features and spectra are not compared.
            self._pair(next(run.outputs(due.judge(due.excerpt.analyse()))))

    def _checkpoint_before(self, block: Any) -> tuple[Any, int] | None:
        """Return the checkpoint before a block, if there is one, and drop those before it."""
        for number, (checkpoint, _) in enumerate(self._checkpoints):
            if _place(checkpoint) == _place(block):
                for _ in range(number):
                    self._checkpoints.popleft()
                return self._checkpoints.popleft()
        while self._checkpoints and _before(self._checkpoints[0][0], block):
            # A late-joining subscriber receives a checkpoint from before the recording.
            self._checkpoints.popleft()
        return None

    def _drop_unmade(self, sample: int, time: int) -> None:
        """
        Count recorded verdicts on windows that ended by ``sample`` and were not made again.

        Those sent after ``time`` (ns) may be on samples of a source that is restarted soon.
        """
        while self._verdicts:
            message, verdict = self._verdicts[0]
            if _end(verdict) > sample or message.publish_time > time:
                break
            self._verdicts.popleft()
            window = _window(verdict)
            late = next((w for w in (self._unanswered, self._forgotten) if window in w), None)
            if late is not None:
                # It was published after the horizon, so its inputs were not known in time.
                late.remove(window)
                self._agreement.skipped += 1
            elif self._is_earlier(verdict):
                # It was published after a pause, and the checkpoint is within its snapshot.
                self._agreement.skipped += 1
            else:
                self._agreement.differ(f'{self._topic} at sample {window[0]}: not made again')

    def _pair(self, output: Output) -> None:
        """Compare a verdict with the recorded one on the same window."""
        window = _window(decode(output))
        if not self._verdicts or _window(self._verdicts[0][1]) != window:
            self._unanswered.append(window)
            self._uncertain = True
            return
        self._agreement.missing += len(self._unanswered)
        self._unanswered.clear()
        message, _ = self._verdicts.popleft()
        if self._uncertain and without_padding(message) != output.cdr:
            self._agreement.skipped += 1
            if self._run is not None and self._run.values['joint']:
                self._note('the speeds of the joint are not all known: a verdict is not compared')
            return
        self._agreement.compare(message, output.cdr, f'{self._topic} at sample {window[0]}')

    def _note(self, text: str) -> None:
        note = f'{self._topic}: {text}'
        if note not in self.notes:
            self.notes.append(note)

    def _resume(self, checkpoint: Any, published: int) -> None:
        """Go on or begin at a checkpoint that came after a number of published verdicts."""
        values = configuration_values(checkpoint)
        state = bytes(checkpoint.state)
        at = f'at sample {checkpoint.first_sample}'
        if self._run is not None and self._run.values != values:
            self._run.reconfigure(values)
            self._note(f'parameters were changed {at}')
        if self._run is not None:
            self._go_on(self._run, checkpoint)
            return
        sample = int(checkpoint.first_sample)
        window = self._window_before(sample, DiagnosisRun(values, state))
        if window is None:
            return
        self._run = self._opened(values, state, window)
        self._forget_unmade(self._run.diagnoser.next_sample, sample)
        self._past.clear()
        self._uncertain = False
        self._begun = (*_place(checkpoint), bool(window))
        # Not by their index: that of a source that is restarted soon is earlier, too.
        while len(self._verdicts) > self._published - published:
            self._agreement.skipped += 1
            self._verdicts.popleft()

    def _go_on(self, run: DiagnosisRun, checkpoint: Any) -> None:
        """Go on from a recorded state, if the re-run has another one."""
        uncertain, self._uncertain = self._uncertain, False
        if run.diagnoser.save() == bytes(checkpoint.state):
            self._lost = self._unanswered[:]
            return
        had = run.diagnoser.next_sample
        run.diagnoser.load(bytes(checkpoint.state))
        sample, ended = int(checkpoint.first_sample), run.diagnoser.next_sample
        if ended == sample != had and not run.diagnoser.may_pause:
            self._stop()
            return
        self._begun = (*_place(checkpoint), run.first_needed_sample(sample) < sample)
        if not 0 < ended <= sample:
            self._note(f'the diagnosis was restarted at sample {sample}')
            self._run = DiagnosisRun(run.values, bytes(checkpoint.state))
        elif ended < sample:
            self._note(f'the diagnosis has not received the samples {ended} to {sample}')
        elif not uncertain:
            self._note(f'the diagnosis went on from another state at sample {sample}')
        self._forget_unmade(ended, sample)

    def _stop(self) -> None:
        """Stop until a checkpoint whose window is whole: the recording lacks blocks."""
        self._note('blocks are missing; the re-run goes on at a checkpoint with its window')
        self._run = None

    def _forget_unmade(self, ended: int, sample: int) -> None:
        """Forget verdicts on samples that the diagnosis, which goes on at a sample, had not."""
        self._lost = [w for w in self._unanswered if sum(w) <= ended <= sample]
        self._forgotten = [w for w in self._unanswered if w not in self._lost]
        self._unanswered = self._lost[:]

    def _is_earlier(self, verdict: Any) -> bool:
        """Return whether a verdict is on a window from before the re-run began."""
        sample, time, with_window = self._begun
        if with_window:
            return _end(verdict) <= sample
        # By time too, as the index of a source that is restarted begins anew.
        first, stamp = _place(verdict)
        return first < sample or stamp < time

    def _opened(self, values: dict[str, Any], state: bytes, window: list[Any]) -> DiagnosisRun:
        """Return a diagnosis in a recorded state, with the blocks before it in its window."""
        if not window:
            return DiagnosisRun(values, state)
        run = DiagnosisRun(values)
        speed = self._speed(run)
        for block in window:
            with contextlib.suppress(BearingTwinError):
                # The node refuses such a block as well.
                taken = read_vibration(block, values['axis'])
                run.admit(taken)
                run.take(taken, temperature=math.nan, joint_hz=speed)
        run.diagnoser.load(state)
        return run

    def _speed(self, run: DiagnosisRun) -> float:
        """Return the shaft speed given to the next verdict by a joint, Hz; NaN if by none."""
        if not (self._verdicts and run.values['joint']):
            return math.nan
        given = float(self._verdicts[0][1].shaft_hz_given)
        return math.nan if given == nominal_speed(run.values) else given

    def _keep(self, block: Any) -> None:
        """Keep a block before the first usable checkpoint: windows reach back to it."""
        if self._past and int(block.first_sample) != _block_end(self._past[-1]):
            self._past.clear()
        self._past.append(block)
        while _block_end(block) - _block_end(self._past[0]) > _REACH * block.sample_rate:
            self._past.popleft()

    def _window_before(self, sample: int, run: DiagnosisRun) -> list[Any] | None:
        """Return the blocks before a checkpoint that the next verdict needs; None if not all."""
        first = run.first_needed_sample(sample)
        window = [block for block in self._past if _block_end(block) > first]
        reaches_back = bool(window) and int(window[0].first_sample) <= first
        whole = reaches_back and _block_end(window[-1]) == sample
        return window if whole else [] if first >= sample else None


def _window(verdict: Any) -> tuple[int, int]:
    """Return first sample and number of samples of the window of a verdict."""
    return int(verdict.first_sample), int(verdict.sample_count)


def _end(verdict: Any) -> int:
    """Return the index of the sample after the window of a verdict."""
    return int(verdict.first_sample) + int(verdict.sample_count)


def _block_end(block: Any) -> int:
    """Return the index of the sample after a block of vibration."""
    return int(block.first_sample) + max(len(block.x), len(block.y))


def _place(message: Any) -> tuple[int, int]:
    """Return sample index and time (ns) of a block, or of the checkpoint before it."""
    return int(message.first_sample), stamp_ns(message.header.stamp)


def _before(checkpoint: Any, block: Any) -> bool:
    """Return whether a checkpoint is earlier by sample index and by time; new twins begin at 0."""
    return all(a < b for a, b in zip(_place(checkpoint), _place(block), strict=True))
