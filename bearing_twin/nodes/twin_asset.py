# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One twin as a node sees it: its topics, its inputs, its messages. A node hosts one or many."""

from __future__ import annotations

import math
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.messages import (
    checkpoint_message,
    twin_state_message,
    vibration_message,
)
from bearing_twin.assets.twin_parameters import FASTEST_LIVE_SHAFT
from bearing_twin.nodes.twin_health import clearance_problem, temperature_status
from bearing_twin.ros.qos import CHECKPOINT, MEASUREMENT, OVERRIDES, own, STREAM
from bearing_twin.ros.subscribing import subscribe
from bearing_twin.stamps import stamp_ns
from bearing_twin.streams.shaft import ShaftSpeed
from bearing_twin.thermal.gate import TemperatureGate
from bearing_twin_msgs.msg import Checkpoint, TwinState, Vibration
from sensor_msgs.msg import JointState, Temperature

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from bearing_twin.dynamics.simulator import Block
    from bearing_twin.ros.health import Status
    from bearing_twin.ros.lifecycle import ManagedNode
    from bearing_twin.ros.parameters import ParameterSet
    from bearing_twin.streams.pacer import Due
    from bearing_twin.thermal.gate import GatedTemperature
    from rclpy.subscription import MessageInfo

__all__ = ['TwinAsset']

LONGEST_WAIT = 10.0


class TwinAsset:
    """
    Topics, inputs and messages of one twin.

    Parameters
    ----------
    node
        The node that hosts it.
    parameters : ParameterSet
        Its parameters.
    prefix
        Put before its topics: '' or ``NAMESPACE/``.
    checkpoints
        Whether it publishes checkpoints of its own.

    """

    def __init__(
        self,
        node: ManagedNode,
        parameters: ParameterSet,
        *,
        prefix: str = '',
        checkpoints: bool = True,
    ) -> None:
        p = parameters
        self.parameters = p
        self._node = node
        self._clearance_problem = ''
        self._gate = TemperatureGate(
            start=p['start_temperature'], timeout=p['temperature_timeout']
        )
        self._shaft = ShaftSpeed(
            nominal=p['shaft_hz'], joint=p['joint'], highest=FASTEST_LIVE_SHAFT
        )
        self._checkpoint_due = 0
        self._vibration = node.create_lifecycle_publisher(
            Vibration, f'{prefix}vibration', own(STREAM), qos_overriding_options=OVERRIDES
        )
        self._state = node.create_lifecycle_publisher(
            TwinState, f'{prefix}twin_state', own(STREAM), qos_overriding_options=OVERRIDES
        )
        self._publishers = [self._vibration, self._state]
        if checkpoints:
            self._checkpoint = node.create_lifecycle_publisher(
                Checkpoint, f'{prefix}twin_checkpoint', CHECKPOINT
            )
            self._publishers.append(self._checkpoint)
        self._inputs = [
            subscribe(node, Temperature, f'{prefix}temperature', self._on_temperature, MEASUREMENT)
        ]
        if p['joint']:
            self._inputs.append(
                subscribe(node, JointState, f'{prefix}joint_states', self._on_joints, MEASUREMENT)
            )

    def destroy(self) -> None:
        """Give up the topics."""
        for publisher in self._publishers:
            self._node.destroy_lifecycle_publisher(publisher)
        for subscription in self._inputs:
            self._node.destroy_subscription(subscription)

    def apply(self, values: Mapping[str, Any]) -> None:
        """Take changed parameters."""
        self._gate.timeout = values['temperature_timeout']
        self._shaft.set_nominal(values['shaft_hz'])
        self.ask_checkpoint()

    def ask_checkpoint(self) -> None:
        """Let a checkpoint precede the next block, since the state does not follow from before."""
        self._checkpoint_due = 0

    def await_subscribers(self, count: int, deadline: float = math.inf) -> None:
        """Wait until ``count`` subscribers hear the vibration; 10 s, or until ``deadline``."""
        deadline = min(deadline, time.monotonic() + LONGEST_WAIT)
        while self._vibration.get_subscription_count() < count:
            if time.monotonic() > deadline or not self._node.context.ok():
                return
            time.sleep(0.02)

    def inputs(self) -> tuple[GatedTemperature, float]:
        """Return temperature and shaft speed (Hz) for the block to be computed now."""
        return self._gate.at(time.monotonic()), self._shaft.hz

    def checkpoint(self, due: Due, save: Callable[[], bytes]) -> None:
        """Publish a checkpoint if it is time; call before computing the block ``due``."""
        if due.first_sample < self._checkpoint_due:
            return
        p = self.parameters
        self._checkpoint_due = due.first_sample + round(p['checkpoint_period'] * p['sample_rate'])
        self._checkpoint.publish(
            checkpoint_message(
                stamp=due.stamp,
                first_sample=due.first_sample,
                node=self._node.get_fully_qualified_name(),
                kind='twin',
                configuration=p.text,
                state=save(),
            )
        )

    def publish_vibration(self, block: Block, due: Due) -> Vibration:
        """Publish the samples of a block and return the message."""
        message = vibration_message(block, due=due, values=self.parameters.values)
        self._vibration.publish(message)
        return message

    def publish_state(
        self, block: Block, due: Due, temperature: GatedTemperature, **realtime: float
    ) -> None:
        """Publish the state after a block; ``realtime`` are the message's fields of that name."""
        self._clearance_problem = clearance_problem(block.condition)
        message = twin_state_message(
            block, due=due, values=self.parameters.values, temperature=temperature
        )
        for name, value in realtime.items():
            setattr(message, name, value)
        self._state.publish(message)

    def status(self) -> Status:
        """Status of the inputs for /diagnostics."""
        now = time.monotonic()
        return temperature_status(
            self._gate.at(now), self._shaft.problem(now), self._clearance_problem
        )

    def _on_temperature(self, message: Temperature, _: MessageInfo) -> None:
        self._gate.offer(
            message.temperature, stamp=stamp_ns(message.header.stamp), now=time.monotonic()
        )

    def _on_joints(self, message: JointState, _: MessageInfo) -> None:
        self._shaft.offer(message.name, message.velocity, now=time.monotonic())
