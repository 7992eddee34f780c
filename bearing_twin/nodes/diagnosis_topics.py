# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Topics and statuses of one diagnosis, in a diagnosis node or a fleet node."""

from __future__ import annotations

from collections import deque
from collections.abc import Awaitable, Mapping
import math
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.diagnosis import DiagnosisCore
from bearing_twin.assets.messages import features_messages
from bearing_twin.bearing import PLACES, RESULTS
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.topics import FEATURES
from bearing_twin.ros.health import Level, Status
from bearing_twin.ros.topics.qos import advertise, CHECKPOINT, MEASUREMENT, RESULT, STREAM
from bearing_twin.ros.topics.subscribing import (
    receiver_clock,
    subscribe,
    unheard,
    with_mismatch_reasons,
)
from bearing_twin.streams.vibration_input import (
    Inputs,
    Intake,
    read_vibration,
    SEVERAL_SOURCES,
    SILENT_AFTER,
)
from bearing_twin_msgs.msg import Checkpoint, Diagnosis, Spectrum, Vibration
from sensor_msgs.msg import JointState, Temperature
from std_msgs.msg import Float64MultiArray

if TYPE_CHECKING:
    from bearing_twin.assets.diagnosis import DueVerdict, Verdict
    from bearing_twin.diagnosis import Diagnosis as DiagnosisResult
    from bearing_twin.ros.lifecycle import ManagedNode
    from bearing_twin.ros.parameters import ParameterSet
    from bearing_twin.streams.vibration_input import VibrationBlock
    from rclpy.qos import QoSProfile
    from rclpy.subscription import Subscription


_PAUSE = 0.5
"""Least gap that is a pause between two snapshots of a series, in cycles."""

VERDICT_LEVELS = {
    name: getattr(Diagnosis, f'LEVEL_{name.upper()}')
    for name in ('ok', 'suspect', 'fault', 'none')
}
LEVELS = {'ok': Level.OK, 'suspect': Level.WARN, 'fault': Level.ERROR, 'none': Level.WARN}


class DiagnosisTopics:
    """
    Feed a diagnosis from its topics and publish its verdicts.

    The number of samples triggers verdicts, not a clock: the same blocks give the same verdicts.
    """

    def __init__(self, node: ManagedNode, parameters: ParameterSet, *, prefix: str = '') -> None:
        p = parameters
        self.parameters = p
        self._node = node
        self._prefix = prefix
        self._path = node.get_fully_qualified_name()
        if prefix:
            self._path = f'{node.get_namespace().rstrip("/")}/{prefix}diagnosis'
        self._core = DiagnosisCore(p.values, self._path)
        self._due: deque[DueVerdict] = deque()
        self._measured = Inputs(receiver_clock(node), joint=p['joint'])
        # One snapshot of a series may be left out.
        self._intake = Intake(pause=2.0 * p['series_cycle'])
        self._latest: DiagnosisResult | None = None
        # Whether there was a verdict since baseline and trend were saved.
        self._learnt = False
        self._verdict = advertise(node, Diagnosis, f'{prefix}diagnosis', RESULT)
        self._spectrum = advertise(node, Spectrum, f'{prefix}spectrum', RESULT)
        self._envelope = advertise(node, Spectrum, f'{prefix}envelope_spectrum', RESULT)
        # A fleet publishes no features: they would need further publishers for each asset, and
        # the Diagnosis contains them anyway.
        self._features = {
            name: node.create_lifecycle_publisher(Float64MultiArray, f'features/{name}', RESULT)
            for name in (() if prefix else FEATURES)
        }
        self._checkpoint = node.create_lifecycle_publisher(
            Checkpoint, f'{prefix}diagnosis_checkpoint', CHECKPOINT
        )
        self._state = node.states.kept(p.values, self._path)
        self._load_state(wait=True)

    @property
    def bearing(self) -> str:
        """Name of the bearing."""
        return self._core.bearing.name

    def listen(self, *, sensors: bool = True) -> None:
        """Subscribe; without ``sensors`` the caller passes blocks and temperature to `hold`."""
        self._inputs: list[Subscription[Any]] = []
        if sensors:
            self._subscribe(Vibration, 'vibration', self.take, STREAM)
            self._subscribe(
                Temperature, 'temperature', self._measured.take_temperature, MEASUREMENT
            )
        if self.parameters['joint']:
            self._subscribe(JointState, 'joint_states', self._measured.take_joints, MEASUREMENT)

    def _subscribe(self, kind: Any, topic: str, callback: Any, qos: QoSProfile) -> None:
        # A fleet has many subscriptions: waiting on each would cost more than its messages.
        polled = self._prefix or kind is not Vibration
        self._inputs.append(
            subscribe(
                self._node,
                kind,
                f'{self._prefix}{topic}',
                callback,
                qos,
                group=self._node.polled if polled else None,
            )
        )

    def reset(self) -> Awaitable[str]:
        """Restart window, baseline and trend; return the answer of the service, to await."""
        self._due.clear()
        self._core = DiagnosisCore(self.parameters.values, self._path)
        self._latest, self._learnt = None, False
        self._state.give_up()
        self._load_state()
        self._keep()
        return self._state.answer('window, baseline and trend start anew')

    def apply(self, values: Mapping[str, Any]) -> None:
        """Apply changed parameters; a change of the bearing restarts the window."""
        self.judge()
        self._core.reconfigure(values)

    def take(self, message: Vibration, info: Mapping[str, Any] | None = None) -> None:
        """Diagnose one block; publish the verdict if due."""
        intake, now = self._intake, time.monotonic()
        # In ROS 2 Jazzy the publisher is unknown: all messages count as one source.
        if not intake.sources.accept((info or {}).get('publisher_gid'), now):
            return
        intake.arrived = now
        try:
            block = read_vibration(message, self.parameters['axis'])
        except BearingTwinError as error:
            self._refuse(error)
            return
        if self.hold(block, temperature=self._measured.temperature.taken):
            self.judge()

    def hold(self, block: VibrationBlock, *, temperature: float) -> bool:
        """
        Take one block; return whether a verdict is due. :meth:`judge` then makes it.

        ``temperature`` is in degC; NaN if unknown.
        """
        intake = self._intake
        intake.arrived = time.monotonic()
        try:
            self._core.admit(block)
        except BearingTwinError as error:
            self._refuse(error)
            return False
        intake.use(block.length)
        cycle = self.parameters['series_cycle'] * block.sample_rate
        pause = _PAUSE * cycle if cycle else math.inf
        intake.gaps.count(block.first_sample, block.samples.size, pause=pause)
        if self._core.needs_checkpoint(block):
            # A saved state is complete only if no verdict waits.
            self.judge()
            self._load_state()
            if self._core.checkpoints.is_due(block.first_sample):
                # Not after each gap: a sensor with many of them would wear out a memory card.
                self.keep_state()
            self._checkpoint.publish(self._core.checkpoint(block, self.parameters.text))
        joint_hz = self._measured.shaft_hz(block.length)
        due = self._core.take(block, temperature=temperature, joint_hz=joint_hz)
        if due:
            # At most one verdict waits, however busy the process is.
            self.judge()
        self._due.extend(due)
        return bool(due)

    def _refuse(self, error: BearingTwinError) -> None:
        self._intake.refuse(str(error))
        self._node.get_logger().warning(f'block refused: {error}', throttle_duration_sec=10.0)

    def judge(self) -> None:
        """Compute and publish the verdicts that are due."""
        while self._due:
            due = self._due.popleft()
            self._publish_verdict(due.judge(due.excerpt.analyse()))
            if self.parameters['series_cycle']:
                # Save now: the next block may come one cycle later.
                self._keep()

    def _publish_verdict(self, verdict: Verdict) -> None:
        result = verdict.result
        if self._latest is None or self._latest.fault_code != result.fault_code:
            self._node.get_logger().info(
                f'{self._prefix.rstrip("/")}{": " if self._prefix else ""}'
                f'{result.result} (confidence {result.confidence:.2f}, {result.fault_code})'
            )
        self._latest, self._learnt = result, True
        self._verdict.publish(verdict.diagnosis)
        if self._features:
            for name, message in features_messages(verdict.diagnosis).items():
                self._features[name].publish(message)
        self._spectrum.publish(verdict.spectrum)
        self._envelope.publish(verdict.envelope_spectrum)

    def _load_state(self, *, wait: bool = False) -> None:
        if self._state.load(self._core.diagnoser.load, wait=wait):
            self._node.get_logger().info(f'baseline and trend loaded from {self._state.path}')

    def keep_state(self) -> None:
        """Save baseline and trend, if the parameters ask for it and verdicts have changed them."""
        if self._learnt:
            self._learnt = False
            self._keep()

    def _keep(self) -> None:
        other = self._core.diagnoser.other_source
        self._state.keep(
            self._core.diagnoser.save,
            other and f'{other}; choose another state_name, or call ~/reset to learn anew',
        )

    def input_status(self) -> Status:
        """Return the status of the vibration stream for /diagnostics."""
        self._state.retry()
        unkept = self._state.problem
        unkept = unkept and f'baseline and trend are not kept: {unkept}'
        core = self._core
        problems = [core.rate_problem, core.unit_problem, core.speed_problem]
        problems += [*self._measured.problems(), unkept]
        if self._node.active and not self._prefix:
            problems += [
                unheard(self._node, each)
                for each in self._inputs
                if each.msg_type is not Vibration
            ]
        status = input_status(self._intake, time.monotonic(), *problems)
        if self._intake.blocks or self._intake.problem or not self._node.active:
            return status
        text = status.message
        for each in self._inputs:
            if each.msg_type is Vibration:
                text = with_mismatch_reasons(self._node, each, text)
        return status._replace(message=text)

    def verdict_status(self) -> Status:
        """Return the status of the bearing for /diagnostics."""
        age, overdue = time.monotonic() - self._intake.used, self._core.diagnoser.overdue
        silent_after = self._intake.silent_after
        return verdict_status(self._latest, self.bearing, age, overdue, silent_after)


def input_status(intake: Intake, now: float, *problems: str) -> Status:
    """Return the status of the vibration stream at ``now`` (s); empty problems are ignored."""
    age = now - intake.arrived
    if not intake.blocks and not intake.problem:
        level, message = Level.STALE, 'no vibration yet'
    elif age > intake.silent_after:
        level, message = Level.STALE, f'no vibration for {age:.1f} s'
    elif trouble := intake.trouble(now):
        level, message = Level.ERROR, f'block refused: {trouble}'
    elif intake.sources.contested(now):
        level, message = Level.ERROR, SEVERAL_SOURCES
    elif any(problems):
        level, message = Level.WARN, '; '.join(filter(None, problems))
    else:
        level, message = Level.OK, 'vibration is fresh'
    return Status(
        level,
        message,
        {
            'age_s': age,
            'blocks_used': intake.blocks,
            'blocks_refused': intake.refused,
            'blocks_of_other_sources': intake.sources.ignored,
            'samples_lost': intake.gaps.lost,
            'source_restarts': intake.gaps.restarts,
        },
    )


def verdict_status(
    result: DiagnosisResult | None,
    bearing: str,
    age: float,
    overdue: str = '',
    silent_after: float = SILENT_AFTER,
) -> Status:
    """
    Return the status of the bearing.

    Without vibration a verdict becomes stale: ``age`` is the time since the last used block, s,
    ``silent_after`` the longest at which the source is not silent. ``overdue`` is the reason why
    vibration gives no verdict; '' if it gives one.
    """
    if result is None:
        known, kind = {'bearing': f'bearing {bearing}'}, 'overdue' if overdue else ''
        return Status(Level.STALE, overdue or 'no verdict yet', known, kind)
    values: dict[str, object] = {
        'fault_code': result.fault_code,
        # The prefix keeps it a text: a name of digits only would be read as a number.
        'bearing': f'bearing {bearing}',
        'age_s': age,
        'result': RESULTS.index(result.result),
        'verdict_level': VERDICT_LEVELS[result.level],
        'stage': result.severity.stage,
        'faults': ', '.join(result.faults),
        'confidence': result.confidence,
        'shaft_hz': result.shaft_hz,
        'fault_hz': result.fault_hz,
        'fault_expected_hz': result.fault_hz_expected,
        'slip': result.slip,
        **{f'score_{place}': float(result.score[place]) for place in PLACES},
        'rms': result.severity.rms,
        'unit': result.severity.unit,
        'velocity_rms_mm_s': result.severity.velocity_rms,
        'level_over_baseline_db': result.severity.level_over_baseline,
        'correction_db': result.severity.correction,
        'correction': result.severity.correction_basis,
        'rising_min': result.severity.rising,
        'temperature_degc': result.temperature,
        'reasons': '; '.join(result.reasons),
    }
    if age > silent_after:
        text = f'no vibration used for {age:.1f} s; the last verdict was {result.result}'
        return Status(Level.STALE, text, values)
    if overdue:
        text = f'{overdue}; the last verdict was {result.result}'
        return Status(Level.STALE, text, values, kind='overdue')
    text = result.result
    if result.window is not None and result.window[1] == 'none':
        text = f'{text}; the last window alone tells nothing: {result.reasons[0]}'
    # A changed verdict is logged when it is published; only a changed level is logged as status.
    return Status(LEVELS[result.level], text, values, kind='verdict')
