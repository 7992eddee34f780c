# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Twin node: temperature and shaft speed in, vibration and state out, in real time."""

from __future__ import annotations

import sys
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.shared_specs import SUBSCRIBERS
from bearing_twin.assets.twin_parameters import build_parameters, build_simulator, SPECS
from bearing_twin.nodes.twin_asset import TwinAsset
from bearing_twin.nodes.twin_services import TwinServices
from bearing_twin.ros import realtime
from bearing_twin.ros.cycle import BlockCycle
from bearing_twin.ros.health import Health
from bearing_twin.ros.lifecycle import ManagedNode, run

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bearing_twin.dynamics.simulator import Simulator
    from bearing_twin.streams.pacer import Due

__all__ = ['TwinNode', 'main']


class TwinNode(ManagedNode):
    """
    Advance the bearing's equations of motion in step with the clock.

    The simulator and the gates do the work; this node moves messages, keeps the deadlines and
    answers services.
    """

    def __init__(self) -> None:
        super().__init__('twin', (*SPECS, *realtime.SPECS, SUBSCRIBERS))

    def check(self, values: Mapping[str, Any]) -> None:
        """Refuse parameters that do not fit together."""
        build_parameters(values)
        realtime.check_thresholds(values)

    def prepare(self) -> None:
        """Compile the kernel."""
        self._warm()

    def setup(self) -> None:
        """Warm the kernel; create publishers, subscriptions, services."""
        p = self.parameters
        self._simulator = self._warm()
        self._asset = TwinAsset(self, p)
        self._cycle = BlockCycle(self, p, self._publish_block)
        self._answers = TwinServices(
            self, p, reset=self._reset, save=self._simulator.save, load=self._load
        )
        self._health = Health(self, p['hardware_id'] or self.get_namespace())
        self._health.add('temperature input', self._asset.status)
        self._health.add('real time', self._cycle.status)

    def _warm(self) -> Simulator:
        """Return a simulator at its start, its code compiled: the first block has a deadline."""
        p = self.parameters
        simulator = build_simulator(p.values)
        simulator.advance(p['block_size'], p['start_temperature'], p['shaft_hz'])
        simulator.reset()
        return simulator

    def start(self) -> None:
        """Start the clock of the blocks."""
        p = self.parameters
        self._asset.await_subscribers(p['wait_for_subscribers'])
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
        self._answers.destroy()

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

    def _reset(self) -> None:
        self._simulator.reset()
        self._asset.ask_checkpoint()

    def _load(self, state: bytes) -> None:
        self._simulator.load(state)
        self._asset.ask_checkpoint()


def main(args: list[str] | None = None) -> int:
    """Run the node."""
    return run(TwinNode, args)


if __name__ == '__main__':
    sys.exit(main())
