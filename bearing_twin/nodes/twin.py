# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Twin node: temperature and shaft speed in, vibration and state out, in real time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.parameters.realtime import PUBLISHING
from bearing_twin.assets.parameters.twin import build_parameters, SPECS
from bearing_twin.assets.twin import Twin
from bearing_twin.assets.twin_messages import StateSchedule
from bearing_twin.dynamics.equations.stability import steps
from bearing_twin.dynamics.presets import PRESETS
from bearing_twin.dynamics.trend import trend_sentence
from bearing_twin.nodes.twin_calibration import named_model, TwinCalibration
from bearing_twin.nodes.twin_services import TwinServices
from bearing_twin.nodes.twin_topics import TwinTopics
from bearing_twin.ros import realtime
from bearing_twin.ros.cycle import BlockCycle
from bearing_twin.ros.health import Health
from bearing_twin.ros.lifecycle import ManagedNode
from bearing_twin.ros.topics.subscribing import receiver_clock

if TYPE_CHECKING:
    from bearing_twin.assets.calibration.fitted import FittedModel
    from bearing_twin.streams.pacer import Due


class TwinNode(ManagedNode):
    """
    Advance the bearing's equations of motion in step with the clock.

    The twin computes; this node passes messages, keeps the deadlines and answers services.
    """

    def __init__(self) -> None:
        super().__init__('twin', (*SPECS, *PUBLISHING))

    def check(self, values: Mapping[str, Any]) -> None:
        """Refuse parameters that contradict each other or a calibration of the twin."""
        own, rate = build_parameters(values), values['sample_rate']
        steps(own, rate)
        # Check the calibrations in force and for the next block, which may come from the topic,
        # and the one that the parameters name.
        taken: list[FittedModel | None] = list(self._twin.calibrations) if self.configured else []
        taken.append(
            self._calibration.requested_model(values)[1]
            if self.configured
            else named_model(values)
        )
        for fitted in filter(None, taken):
            fitted.check(own, rate)
        realtime.check_thresholds(values)

    def prepare(self) -> None:
        """Compile the numerical functions."""
        Twin(self.parameters.values).warm_up()

    def setup(self) -> None:
        """Build and warm the twin; create publishers, subscriptions, services and statuses."""
        p = self.parameters
        self._twin = Twin(
            p.values, node=self.get_fully_qualified_name(), clock=receiver_clock(self)
        )
        self._twin.warm_up()
        self.get_logger().info(
            f'preset {p["preset"]} ({PRESETS[p["preset"]]}): '
            f'{trend_sentence(build_parameters(p.values), p["shaft_hz"])}'
        )
        self._cycle = BlockCycle(self, p, self._publish_block)
        self._topics = TwinTopics(
            self, self._twin, schedule=StateSchedule(p['state_rate'], self._cycle.period)
        )
        TwinServices(self, p, reset=self._twin.reset, save=self._twin.save, load=self._twin.load)
        self.health = Health(self, p['hardware_id'] or self.get_namespace())
        self.health.add('temperature input', self._topics.status)
        self.health.add('validity', self._topics.validity)
        self.health.add('real time', self._cycle.status)
        self._calibration = TwinCalibration(self, self._twin, p.values, self.health)

    def start(self) -> None:
        """Start the block cycle."""
        p = self.parameters
        self._topics.await_subscribers(p['wait_for_subscribers'])
        self._twin.checkpoints.ask()
        self._cycle.start()
        self.get_logger().info(
            f'twin of {p["bearing"]}, defect {p["defect"] or "none"}: '
            f'{p["sample_rate"]:g} Hz in blocks of {p["block_size"]}'
        )

    def stop(self) -> None:
        """Stop the block cycle."""
        self._cycle.stop()

    def apply(self, values: Mapping[str, Any]) -> None:
        """Apply changed parameters; the motion continues from its current state."""
        self._twin.apply(values)
        self._calibration.apply(values)

    def _publish_block(self, due: Due) -> None:
        topics, twin = self._topics, self._twin
        topics.publish_checkpoint(twin.checkpoint(due, self.parameters.text))
        made = twin.advance()
        topics.vibration.publish(topics.bytes.vibration(made, due, twin.values))
        topics.publish_state(made, due, self._cycle.fields(due))


NODE = TwinNode
