# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Twin node: temperature and shaft speed in, vibration and state out, in real time."""

from __future__ import annotations

import sys
import threading
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes import realtime
from bearing_twin.nodes.cycle import BlockCycle
from bearing_twin.nodes.health import Health
from bearing_twin.nodes.launching import COMPILING
from bearing_twin.nodes.lifecycle import ManagedNode, run
from bearing_twin.nodes.parameters import Spec
from bearing_twin.nodes.statefile import StateFolder
from bearing_twin.nodes.twin_asset import TwinAsset
from bearing_twin.nodes.twin_config import build_parameters, build_simulator, SPECS
from bearing_twin_msgs.srv import InjectDefect, LoadState, SaveState
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bearing_twin.nodes.pacer import Due

__all__ = ['TwinNode', 'main']


WAIT = Spec(
    name='wait_for_subscribers',
    default=0,
    description='Subscribers of vibration for which the first block waits, for 10 s at most.',
    low=0,
    high=100,
    running=False,
)
LONGEST_WAIT = 10.0
SLOW_START = 2.0
"""Time after which building the simulator must be compiling, s."""


class TwinNode(ManagedNode):
    """
    Advance the bearing's equations of motion in step with the clock.

    The simulator and the gates do the work; this node moves messages, keeps the deadlines and
    answers services.
    """

    def __init__(self) -> None:
        super().__init__('twin', (*SPECS, *realtime.SPECS, WAIT))

    def check(self, values: Mapping[str, Any]) -> None:
        """Refuse parameters that do not fit together."""
        build_parameters(values)
        realtime.check_thresholds(values)

    def setup(self) -> None:
        """Compile and warm the kernel; create publishers, subscriptions, services."""
        p = self.parameters
        note = threading.Timer(SLOW_START, self.get_logger().info, [COMPILING])
        note.daemon = True
        note.start()
        try:
            self._warm_up()
        finally:
            note.cancel()
        self._states = StateFolder(p['state_directory'])
        self._asset = TwinAsset(self, p)
        self._cycle = BlockCycle(self, p, self._publish_block)
        self._answers = [
            self.create_service(Trigger, '~/reset', self._on_reset),
            self.create_service(SaveState, '~/save_state', self._on_save),
            self.create_service(LoadState, '~/load_state', self._on_load),
            self.create_service(InjectDefect, '~/inject_defect', self._on_inject),
        ]
        self._health = Health(self, p['hardware_id'] or self.get_namespace())
        self._health.add('temperature input', self._asset.status)
        self._health.add('real time', self._cycle.status)

    def _warm_up(self) -> None:
        p = self.parameters
        self._simulator = build_simulator(p.values)
        # The first blocks compile and touch everything before the first deadline exists.
        self._simulator.advance(p['block_size'], p['start_temperature'], p['shaft_hz'])
        self._simulator.reset()

    def start(self) -> None:
        """Start the clock of the blocks."""
        p = self.parameters
        self._asset.await_subscribers(p['wait_for_subscribers'], LONGEST_WAIT)
        self._asset.ask_checkpoint()
        self._cycle.start()
        self.get_logger().info(
            f'twin of {p["bearing"]}, defect {p["defect"]}: '
            f'{p["sample_rate"]:g} Hz in blocks of {p["block_size"]}'
        )

    def stop(self) -> None:
        """Stop the clock of the blocks."""
        self._cycle.stop()

    def teardown(self) -> None:
        """Destroy what setup created."""
        self._health.destroy()
        self._asset.destroy()
        for service in self._answers:
            self.destroy_service(service)

    def apply(self, values: Mapping[str, Any]) -> None:
        """Take changed parameters; the motion goes on from where it is."""
        self._asset.apply(values)
        self._simulator.reconfigure(build_parameters(values))

    def _publish_block(self, due: Due) -> None:
        self._asset.checkpoint(due, self._simulator.save)
        temperature, shaft_hz = self._asset.inputs()
        block = self._simulator.advance(self.parameters['block_size'], temperature.used, shaft_hz)
        self._asset.publish_vibration(block, due)
        self._asset.publish_state(block, due, temperature, **self._cycle.fields(due))

    def _on_reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._simulator.reset()
        self._asset.ask_checkpoint()
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
        self._asset.ask_checkpoint()
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


def main(args: list[str] | None = None) -> int:
    """Run the node."""
    return run(TwinNode, args)


if __name__ == '__main__':
    sys.exit(main())
