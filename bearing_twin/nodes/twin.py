# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Twin node: temperature and shaft speed in, vibration and state out, in real time."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any

import yaml
from bearing_twin_msgs.msg import Checkpoint, TwinState, Vibration
from bearing_twin_msgs.srv import InjectDefect, LoadState, SaveState
from rclpy.clock import Clock, ClockType
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState, Temperature
from std_srvs.srv import Trigger

from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes.convert import (
    checkpoint_message,
    stamp_ns,
    twin_state_message,
    vibration_message,
)
from bearing_twin.nodes.health import Health
from bearing_twin.nodes.lifecycle import ManagedNode, run
from bearing_twin.nodes.pacer import Pacer
from bearing_twin.nodes.qos import CHECKPOINT, MEASUREMENT, OVERRIDES, STREAM
from bearing_twin.nodes.shaft import ShaftSpeed
from bearing_twin.nodes.statefile import StateFolder
from bearing_twin.nodes.twin_config import SPECS, build_parameters, build_simulator
from bearing_twin.nodes.twin_health import realtime_status, temperature_status
from bearing_twin.thermal.gate import TemperatureGate

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bearing_twin.nodes.health import Status
    from bearing_twin.nodes.pacer import Due

__all__ = ['TwinNode', 'main']


class TwinNode(ManagedNode):
    """Advance the bearing's equations of motion in step with the clock.

    The simulator and the gates do the work; this node moves messages, keeps the deadlines and
    answers services.
    """

    def __init__(self) -> None:
        super().__init__('twin', SPECS)

    def check(self, values: Mapping[str, Any]) -> None:
        """Refuse parameters that do not fit together."""
        build_parameters(values)

    def setup(self) -> None:
        """Compile and warm the kernel; create publishers, subscriptions, services."""
        p = self.parameters
        self._simulator = build_simulator(p.values)
        # The first blocks compile and touch everything before the first deadline exists.
        self._simulator.advance(p['block_size'], p['start_temperature'], p['shaft_hz'])
        self._simulator.reset()
        self._states = StateFolder(p['state_directory'])
        self._gate = TemperatureGate(
            start=p['start_temperature'], timeout=p['temperature_timeout']
        )
        self._shaft = ShaftSpeed(nominal=p['shaft_hz'], joint=p['joint'], highest=100.0)
        self._pacer = Pacer(
            block=p['block_size'],
            rate=p['sample_rate'],
            catch_up=p['catch_up_blocks'],
            late_after=p['late_after'],
        )
        self._execution_time = 0.0
        self._vibration = self.create_lifecycle_publisher(
            Vibration, 'vibration', STREAM, qos_overriding_options=OVERRIDES
        )
        self._state = self.create_lifecycle_publisher(
            TwinState, 'twin_state', STREAM, qos_overriding_options=OVERRIDES
        )
        self._checkpoint = self.create_lifecycle_publisher(
            Checkpoint, 'twin_checkpoint', CHECKPOINT
        )
        self._inputs = [
            self.create_subscription(
                Temperature,
                'temperature',
                self._on_temperature,
                MEASUREMENT,
                qos_overriding_options=OVERRIDES,
            )
        ]
        if p['joint']:
            self._inputs.append(
                self.create_subscription(
                    JointState,
                    'joint_states',
                    self._on_joints,
                    MEASUREMENT,
                    qos_overriding_options=OVERRIDES,
                )
            )
        self._answers = [
            self.create_service(Trigger, '~/reset', self._on_reset),
            self.create_service(SaveState, '~/save_state', self._on_save),
            self.create_service(LoadState, '~/load_state', self._on_load),
            self.create_service(InjectDefect, '~/inject_defect', self._on_inject),
        ]
        self._health = Health(self, p['hardware_id'] or self.get_namespace())
        self._health.add('temperature input', self._temperature_status)
        self._health.add('real time', self._realtime_status)

    def start(self) -> None:
        """Start the clock of the blocks."""
        simulated = self.get_parameter('use_sim_time').value
        # Real time is paced by a clock that nobody sets; simulated time by /clock.
        self._ticks = self.get_clock() if simulated else Clock(clock_type=ClockType.STEADY_TIME)
        self._pacer.anchor(ticks=self._ticks.now().nanoseconds, time=self._now())
        self._checkpoint_due = self._pacer.next_sample
        self._timer = self.create_timer(self._pacer.period, self._on_timer, clock=self._ticks)
        self.get_logger().info(
            f'twin of {self.parameters["bearing"]}, defect {self.parameters["defect"]}: '
            f'{self.parameters["sample_rate"]:g} Hz in blocks of {self.parameters["block_size"]}'
        )

    def stop(self) -> None:
        """Stop the clock of the blocks."""
        self.destroy_timer(self._timer)

    def teardown(self) -> None:
        """Destroy what setup created."""
        self._health.destroy()
        for publisher in (self._vibration, self._state, self._checkpoint):
            self.destroy_publisher(publisher)
        for subscription in self._inputs:
            self.destroy_subscription(subscription)
        for service in self._answers:
            self.destroy_service(service)

    def apply(self, values: Mapping[str, Any]) -> None:
        """Take changed parameters; the motion goes on from where it is."""
        self._gate.timeout = values['temperature_timeout']
        self._shaft.set_nominal(values['shaft_hz'])
        self._simulator.reconfigure(build_parameters(values))
        self._checkpoint_due = self._pacer.next_sample

    def _now(self) -> int:
        return self.get_clock().now().nanoseconds

    def _on_temperature(self, message: Temperature) -> None:
        self._gate.offer(
            message.temperature, stamp=stamp_ns(message.header.stamp), now=time.monotonic()
        )

    def _on_joints(self, message: JointState) -> None:
        self._shaft.offer(message.name, message.velocity, now=time.monotonic())

    def _on_timer(self) -> None:
        for due in self._pacer.due(ticks=self._ticks.now().nanoseconds, time=self._now()):
            self._publish_block(due)

    def _publish_block(self, due: Due) -> None:
        began = time.perf_counter()
        p = self.parameters
        if due.first_sample >= self._checkpoint_due:
            self._publish_checkpoint(due)
        temperature = self._gate.at(time.monotonic())
        block = self._simulator.advance(p['block_size'], temperature.used, self._shaft.hz)
        self._vibration.publish(
            vibration_message(block, due=due, sample_rate=p['sample_rate'], frame_id=p['frame_id'])
        )
        state = twin_state_message(
            block,
            due=due,
            frame_id=p['frame_id'],
            temperature=temperature,
            bearing=p['bearing'],
            thermal_mode=p['thermal_mode'],
            defect=p['defect'],
        )
        self._execution_time = time.perf_counter() - began
        state.blocks_published = self._pacer.published
        state.blocks_late = self._pacer.late
        state.blocks_dropped = self._pacer.dropped
        state.lateness = due.lateness
        state.execution_time = self._execution_time
        self._state.publish(state)

    def _publish_checkpoint(self, due: Due) -> None:
        p = self.parameters
        self._checkpoint_due = due.first_sample + round(p['checkpoint_period'] * p['sample_rate'])
        self._checkpoint.publish(
            checkpoint_message(
                stamp=due.stamp,
                first_sample=due.first_sample,
                node=self.get_fully_qualified_name(),
                kind='twin',
                configuration=yaml.safe_dump(p.values),
                state=self._simulator.save(),
            )
        )

    def _on_reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._simulator.reset()
        self._checkpoint_due = self._pacer.next_sample
        response.success = True
        response.message = f'back at the start with seed {self.parameters["seed"]}'
        return response

    def _on_save(
        self, request: SaveState.Request, response: SaveState.Response
    ) -> SaveState.Response:
        try:
            path = self._states.save(request.path, self._simulator.save())
        except BearingTwinError as error:
            response.message = str(error)
            return response
        response.success = True
        response.message = str(path)
        return response

    def _on_load(
        self, request: LoadState.Request, response: LoadState.Response
    ) -> LoadState.Response:
        try:
            self._simulator.load(self._states.load(request.path))
        except BearingTwinError as error:
            response.message = str(error)
            return response
        self._checkpoint_due = self._pacer.next_sample
        response.success = True
        response.message = f'loaded {request.path}'
        return response

    def _on_inject(
        self, request: InjectDefect.Request, response: InjectDefect.Response
    ) -> InjectDefect.Response:
        # Through the parameters, so that they say what runs and the same checks hold.
        result = self.set_parameters_atomically(
            [
                Parameter('defect', value=request.place),
                Parameter('defect_width', value=request.width),
                Parameter('defect_depth', value=request.depth),
            ]
        )
        response.success = result.successful
        response.message = result.reason or f'defect: {request.place}'
        return response

    def _temperature_status(self) -> Status:
        now = time.monotonic()
        return temperature_status(self._gate.at(now), self._shaft.problem(now))

    def _realtime_status(self) -> Status:
        return realtime_status(
            self._pacer.report(), self._pacer.period, self._execution_time, active=self.active
        )


def main(args: list[str] | None = None) -> int:
    """Run the node."""
    return run(TwinNode, args)


if __name__ == '__main__':
    sys.exit(main())
