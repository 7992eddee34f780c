# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Topics and statuses of one twin, in a twin node or a fleet node."""

from __future__ import annotations

from collections.abc import Mapping
import math
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.twin_messages import TwinBytes
from bearing_twin.ros.health import Level, Status
from bearing_twin.ros.topics.qos import advertise, CHECKPOINT, MEASUREMENT, stream
from bearing_twin.ros.topics.subscribing import subscribe, unheard
from bearing_twin.thermal.gate import TemperatureStatus
from bearing_twin.thermal.gcr15 import TABLE_HIGH, TABLE_LOW
from bearing_twin_msgs.msg import Checkpoint, TwinState, Vibration
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState, Temperature

if TYPE_CHECKING:
    from bearing_twin.assets.twin import TwinChannel
    from bearing_twin.assets.twin_messages import StateSchedule, TwinBlock
    from bearing_twin.dynamics.single.condition import Condition
    from bearing_twin.ros.lifecycle import ManagedNode
    from bearing_twin.streams.pacer import Due
    from bearing_twin.thermal.gate import GatedTemperature


LONGEST_WAIT = 10.0

TEXTS = {
    TemperatureStatus.OK: 'temperature is fresh',
    TemperatureStatus.WAITING: 'no temperature yet: the start temperature is used',
    TemperatureStatus.STALE: 'temperature is stale: the last valid one is held',
    TemperatureStatus.INVALID: 'temperature is NaN or impossible: the last valid one is held',
    TemperatureStatus.CLAMPED: (
        'temperature {:.5g} degC is outside '
        f'{TABLE_LOW:g}..{TABLE_HIGH:g} degC: the nearest end is used'
    ),
    TemperatureStatus.BACKWARDS: 'stamps do not rise: the last valid temperature is held',
}


class TwinTopics:
    """Feed a twin from its topics and publish its messages."""

    def __init__(
        self,
        node: ManagedNode,
        twin: TwinChannel,
        *,
        schedule: StateSchedule,
        prefix: str = '',
        checkpoints: bool = True,
    ) -> None:
        self._node = node
        self._twin = twin
        self._schedule = schedule
        self.bytes = TwinBytes(serialize_message)
        self._condition: Condition | None = None
        qos = stream(schedule.period)
        self.vibration = advertise(node, Vibration, f'{prefix}vibration', qos)
        self._state = advertise(node, TwinState, f'{prefix}twin_state', qos)
        if checkpoints:
            self._checkpoint = node.create_lifecycle_publisher(
                Checkpoint, f'{prefix}twin_checkpoint', CHECKPOINT
            )
        inputs: list[tuple[Any, str, Any]] = [(Temperature, 'temperature', twin.take_temperature)]
        if twin.values['joint']:
            inputs.append((JointState, 'joint_states', twin.take_joints))
        subscriptions = [
            subscribe(node, kind, f'{prefix}{topic}', take, MEASUREMENT, group=node.polled)
            for kind, topic, take in inputs
        ]
        # A fleet has many inputs: asking the middleware about each would take too long.
        self._asked = [] if prefix else subscriptions

    def await_subscribers(self, count: int, deadline: float = math.inf) -> None:
        """Wait for ``count`` subscribers to the vibration, at most 10 s or until ``deadline``."""
        deadline = min(deadline, time.monotonic() + LONGEST_WAIT)
        # rclpy prints an error if it is asked after a shutdown.
        while self._node.context.ok() and self.vibration.get_subscription_count() < count:
            if time.monotonic() > deadline:
                return
            time.sleep(0.02)

    def publish_checkpoint(self, checkpoint: Checkpoint | None) -> None:
        """Publish a checkpoint, if there is one."""
        if checkpoint is not None:
            self._checkpoint.publish(checkpoint)

    def warm_up(self, made: TwinBlock, due: Due, fields: Mapping[str, float]) -> None:
        """Serialise a block without publishing it, as the first published one has a deadline."""
        self.bytes.vibration(made, due, self._twin.values)
        self.bytes.state(made, due, self._twin.values, fields)

    def publish_state(self, made: TwinBlock, due: Due, fields: Mapping[str, float]) -> None:
        """Publish the state after a block, with its real-time fields, if it is due."""
        values = self._twin.values
        inputs = made.temperature.used, made.temperature.status, made.shaft_hz
        counters = fields['blocks_late'], fields['blocks_dropped']
        if self._schedule.wants(due, values, *inputs, *counters):
            self._condition = made.block.condition
            self._state.publish(self.bytes.state(made, due, values, fields))

    def status(self) -> Status:
        """Return the status of the inputs for /diagnostics."""
        asked = self._asked if self._node.active else []
        unheard_of = (unheard(self._node, each) for each in asked)
        return temperature_status(self._twin.temperature, *self._twin.problems(), *unheard_of)

    def validity(self) -> Status:
        """Return the status of violated limits of model and bearing life, for /diagnostics."""
        return validity_status(self._condition)


def validity_status(condition: Condition | None) -> Status:
    """Return the status of violated limits; ``condition`` is None before the first block."""
    passed, warnings, text = 0, '', 'no block yet'
    numbers = (math.nan,) * 4
    if condition is not None:
        c = condition
        passed, warnings = int(c.limits_passed), '; '.join(c.warnings)
        text = 'the model and the life of ISO 281 hold'
        numbers = c.contact_pressure, c.kappa, c.thermal_clearance, c.life_hours
    names = 'contact_pressure_pa', 'kappa', 'radial_clearance_m', 'life_h'
    return Status(
        Level.WARN if passed else Level.OK,
        warnings or text,
        {'limits_passed': passed, **dict(zip(names, numbers, strict=True))},
        f'limits {passed}',
    )


def temperature_status(temperature: GatedTemperature, *problems: str) -> Status:
    """Return the status of the temperature and of ``problems``; empty strings are ignored."""
    ok = temperature.status is TemperatureStatus.OK and not any(problems)
    message = TEXTS[temperature.status].format(temperature.measured)
    if temperature.status is TemperatureStatus.INVALID and math.isnan(temperature.age):
        message = 'temperature is NaN or impossible: the start temperature is used'
    message = '; '.join([message, *filter(None, problems)])
    return Status(
        Level.OK if ok else Level.WARN,
        message,
        {
            'temperature_used_degc': temperature.used,
            'temperature_measured_degc': temperature.measured,
            'age_s': temperature.age,
            'temperature_status': int(temperature.status),
        },
    )
