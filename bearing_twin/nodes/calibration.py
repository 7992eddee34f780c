# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Calibration node: the twin fitted to measured vibration, with intervals and a residual."""

from __future__ import annotations

from collections.abc import Awaitable, Mapping
import math
import time
import traceback
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.calibration.core import CalibrationCore
from bearing_twin.assets.calibration.task import fit_record
from bearing_twin.assets.parameters.calibration import SPECS
from bearing_twin.calibration.candidates.cloud import TEMPERATURE
from bearing_twin.errors import BearingTwinError
from bearing_twin.repeats import RepeatCheck, REPEATED
from bearing_twin.ros.health import Health, Level, Status
from bearing_twin.ros.lifecycle import ManagedNode
from bearing_twin.ros.topics.qos import advertise, MEASUREMENT, RESULT, STREAM
from bearing_twin.ros.topics.subscribing import (
    receiver_clock,
    subscribe,
    with_mismatch_reasons,
)
from bearing_twin.streams.statefile import StateFolder
from bearing_twin.streams.vibration_input import (
    Inputs,
    Intake,
    read_vibration,
    SEVERAL_SOURCES,
)
from bearing_twin.streams.worker import Worker
from bearing_twin.thermal.gate import TemperatureStatus
from bearing_twin_msgs.msg import Calibration, Diagnosis, Vibration
from rclpy.clock import Clock, ClockType
from sensor_msgs.msg import JointState, Temperature

if TYPE_CHECKING:
    from concurrent.futures import Future

    from bearing_twin.assets.calibration.task import Fit, Task
    from rclpy.subscription import MessageInfo


POLL = 0.2
"""Interval of checking the worker, s."""
GENTLE = 10
"""Niceness of the worker process: twin and recorder have priority."""


class CalibrationNode(ManagedNode):
    """
    Fit the twin to measured vibration repeatedly, and report what the fit does not explain.

    The fit runs in a separate process of low priority, and takes at most a third of one core.
    """

    def __init__(self) -> None:
        super().__init__('calibration', SPECS)

    def check(self, values: Mapping[str, Any]) -> None:
        """Refuse parameters that contradict each other."""
        CalibrationCore(values)
        if values['state_name']:
            StateFolder(values['state_directory']).path(values['state_name'])

    def setup(self) -> None:
        """Create the publisher, the statuses and the worker."""
        p = self.parameters
        self._core = CalibrationCore(p.values)
        nominal = p['shaft_hz'] or math.nan
        self._inputs = Inputs(receiver_clock(self), nominal=nominal, joint=p['joint'])
        self._intake, self._repeat = Intake(), RepeatCheck()
        # Why the newest fit failed, and the newest result.
        self._problem, self._latest = '', None
        self._running: tuple[Task, Future[Fit]] | None = None
        self._began = 0.0
        self._state = self.states.kept(p.values, self.get_fully_qualified_name())
        self._state.load(self._core.load, wait=True)
        self._worker = Worker(fit_record, niceness=GENTLE)
        self._out = advertise(self, Calibration, 'calibration', RESULT)
        self.offer('~/reset', self._forget)
        self.health = Health(self, p['hardware_id'] or self.get_namespace())
        self.health.add('calibration', self.status)
        self.health.add('residual', self.residual_status)

    def start(self) -> None:
        """Subscribe to the inputs; start the timer that checks the worker."""
        topics = [
            (Vibration, 'vibration', self._on_vibration, STREAM),
            (Temperature, 'temperature', self._inputs.take_temperature, MEASUREMENT),
            (Diagnosis, 'diagnosis', self._on_diagnosis, RESULT),
        ]
        if self.parameters['joint']:
            topics.append((JointState, 'joint_states', self._inputs.take_joints, MEASUREMENT))
        for topic in topics:
            subscribe(self, *topic)
        self.create_timer(POLL, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def stop(self) -> None:
        """Save the healthy twin."""
        self._keep_state()

    def teardown(self) -> None:
        """Stop the worker process."""
        self._worker.end()

    def apply(self, values: Mapping[str, Any]) -> None:
        """Apply changed parameters; a new bearing discards the fits of the former one."""
        core = CalibrationCore(values)
        if core.bearing != self._core.bearing:
            # A running fit belongs to the former bearing: its result is ignored.
            self._core, self._running, self._latest = core, None, None
            self._state.set_aside(f'the bearing is now {core.bearing.name}')
        self._inputs.shaft.nominal = values['shaft_hz'] or math.nan

    def _forget(self) -> Awaitable[str]:
        # A running fit would be compared with the discarded healthy twin: ignore its result.
        self._running = None
        said = self._core.forget()
        self._state.give_up()
        self._keep_state()
        return self._state.answer(said)

    def _on_diagnosis(self, message: Diagnosis, _: MessageInfo) -> None:
        self._core.verdict(message)

    def _on_vibration(self, message: Vibration, info: MessageInfo) -> None:
        now = time.monotonic()
        if not self._intake.sources.accept(info.get('publisher_gid'), now):
            return
        self._intake.arrived = now
        try:
            block = read_vibration(message, self.parameters['axis'])
            if self._repeat.repeats(block.samples):
                raise BearingTwinError(REPEATED)
        except BearingTwinError as error:
            self._intake.refuse(str(error))
            return
        self._intake.use(block.length)
        task = self._core.take(
            block,
            temperature=self._temperature(),
            shaft_hz=self._inputs.shaft_hz(block.length),
            now=now,
        )
        if task is not None and self._running is None:
            self._begin(task)

    def _temperature(self) -> float:
        """Return the temperature of the bearing, degC; NaN if none is received."""
        heat = self._inputs.temperature
        return math.nan if heat.status is TemperatureStatus.STALE else heat.taken

    def _begin(self, task: Task) -> None:
        try:
            self._running = (task, self._worker.submit(task))
            self._began = time.monotonic()
        except (OSError, RuntimeError):
            # The process starts here: the machine may lack resources for a process or thread.
            self._say_killed()

    def _say_killed(self) -> None:
        self._problem = 'its process was killed (out of memory?) and is started again'
        self.get_logger().error(f'not fitted: {self._problem}', throttle_duration_sec=60.0)

    def _look(self) -> None:
        """Publish the result of a finished fit."""
        if self._running is None or not self._running[1].done():
            return
        (task, future), self._running = self._running, None
        try:
            self._latest = self._core.conclude(task, future.result(), time.monotonic())
        except ChildProcessError:
            self._say_killed()
            return
        except (BearingTwinError, OSError, MemoryError) as error:
            self._problem = str(error) or 'not enough memory'
            self.get_logger().warning(f'not fitted: {self._problem}', throttle_duration_sec=60.0)
            return
        except Exception as error:
            # An unexpected error of the fit on this record; the next record may succeed.
            self._problem = f'{type(error).__name__}: {error}'
            told = ''.join(traceback.format_exception(error))
            self.get_logger().error(
                f'not fitted: {self._problem}\n{told}', throttle_duration_sec=60.0
            )
            return
        self._problem = ''
        self._out.publish(self._latest)
        self._keep_state()

    def _keep_state(self) -> None:
        self._state.load(self._core.load)
        self._state.keep(self._core.save)

    def status(self) -> Status:
        """Return the status of the calibration for /diagnostics."""
        self._state.retry()
        found = self._latest
        heat = self._temperature()
        values: dict[str, object] = {
            'bearing': f'bearing {self._core.bearing.name}',
            'temperature': f'none received, {TEMPERATURE:g} degC are assumed'
            if math.isnan(heat)
            else f'{heat:.1f} degC',
            'statement': found.statement if found else '',
            'distance_db': found.distance if found else math.nan,
            'level_over_machine_db': found.level if found else math.nan,
            'cost_s': found.cost if found else math.nan,
        }
        now, intake = time.monotonic(), self._intake
        age = now - intake.arrived
        if not age <= intake.silent_after:
            return Status(Level.STALE, self._silence(age), values)
        if problem := intake.trouble(now) or self._problem or self._core.waiting:
            return Status(Level.WARN, f'not fitted: {problem}', values)
        if intake.sources.contested(now):
            return Status(Level.ERROR, SEVERAL_SOURCES, values)
        if problem := next(filter(None, self._inputs.problems()), ''):
            return Status(Level.WARN, problem, values)
        if problem := self._state.problem:
            return Status(Level.WARN, f'the healthy twin is not kept: {problem}', values)
        if found is None:
            return Status(Level.STALE, f'no calibration yet: {self._pending()}', values)
        if stale := self._core.stale_reason(now):
            return Status(Level.STALE, f'stale, {found.statement}: {stale}', values, kind='stale')
        return Status(Level.OK, found.statement, values, kind='calibration')

    def _silence(self, age: float) -> str:
        """Return the text on vibration that is not there, or not for ``age`` s."""
        if not math.isnan(age):
            return f'no vibration for {age:.1f} s'
        text = 'no vibration yet'
        for each in self.subscriptions:
            if each.msg_type is Vibration:
                text = with_mismatch_reasons(self, each, text)
        return text

    def _pending(self) -> str:
        """Return the text that explains why there is no calibration yet."""
        if self._running is None:
            return self._core.progress
        return (
            f'the first fit has run for {time.monotonic() - self._began:.0f} s; that of a new '
            'installation compiles the twin, which takes a minute'
        )

    def residual_status(self) -> Status:
        """Return the status of the residual (what the twin does not explain) for /diagnostics."""
        said = self._core.unexplained
        values = {'residual': said.number, 'where': said.where, 'over_twin_db': said.over}
        if math.isnan(said.number):
            return Status(Level.STALE, said.reason, values, kind='residual')
        return Status(Level.WARN if said.alarm else Level.OK, said.reason, values)


NODE = CalibrationNode
