# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One twin as a node, a fleet or an offline run hosts it: inputs and blocks."""

from __future__ import annotations

import time
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.assets.checkpoints import Checkpoints, parameters_of
from bearing_twin.assets.twin_messages import TwinBlock
from bearing_twin.assets.twin_parameters import (
    build_parameters,
    build_simulator,
    FASTEST_LIVE_SHAFT,
)
from bearing_twin.stamps import stamp_ns
from bearing_twin.streams.shaft import ShaftSpeed
from bearing_twin.thermal.gate import TemperatureGate

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from bearing_twin.streams.pacer import Due
    from bearing_twin.thermal.gate import GatedTemperature
    from bearing_twin_msgs.msg import Checkpoint

__all__ = ['Twin', 'TwinChannel', 'TwinInputs']


class TwinInputs(NamedTuple):
    """What a block is computed with."""

    temperature: GatedTemperature
    shaft_hz: float


class TwinChannel:
    """
    Validated inputs of one twin.

    Parameters
    ----------
    values
        Parameters of the twin node.
    clock
        The receiver's clock, s; it never runs backwards.

    """

    def __init__(
        self, values: Mapping[str, Any], *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.values = dict(values)
        self._clock = clock
        self._gate = TemperatureGate(
            start=values['start_temperature'], timeout=values['temperature_timeout']
        )
        self._shaft = ShaftSpeed(
            nominal=values['shaft_hz'], joint=values['joint'], highest=FASTEST_LIVE_SHAFT
        )

    def take_temperature(self, message: Any, _: object = None) -> None:
        """Take a ``sensor_msgs/Temperature``."""
        self._gate.offer(
            message.temperature, stamp=stamp_ns(message.header.stamp), now=self._clock()
        )

    def take_joints(self, message: Any, _: object = None) -> None:
        """Take a ``sensor_msgs/JointState``."""
        self._shaft.offer(message.name, message.velocity, now=self._clock())

    def inputs(self) -> TwinInputs:
        """Return temperature and shaft speed for the block to be computed now."""
        return TwinInputs(self._gate.at(self._clock()), self._shaft.hz)

    def shaft_problem(self) -> str:
        """Return what is wrong with the shaft speed; '' if nothing."""
        return self._shaft.problem(self._clock())

    def apply(self, values: Mapping[str, Any]) -> None:
        """Take changed parameters."""
        self.values = dict(values)
        self._gate.timeout = values['temperature_timeout']
        self._shaft.set_nominal(values['shaft_hz'])


class Twin(TwinChannel):
    """
    A twin with a simulator of its own.

    Parameters
    ----------
    values
        Parameters of the twin node.
    node
        Full name of the node, for its checkpoints.
    clock
        The receiver's clock, s.

    Raises
    ------
    BearingTwinError
        If the parameters do not fit together, or some are missing.

    """

    def __init__(
        self,
        values: Mapping[str, Any],
        *,
        node: str = '/twin',
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        with parameters_of('twin'):
            super().__init__(values, clock=clock)
            self.simulator = build_simulator(values)
            self._checkpoints = Checkpoints('twin', node, values['checkpoint_period'])

    def warm(self) -> None:
        """Compile what a block needs: the first one has a deadline."""
        v = self.values
        self.simulator.advance(v['block_size'], v['start_temperature'], v['shaft_hz'])
        self.simulator.reset()

    def apply(self, values: Mapping[str, Any]) -> None:
        """Take changed parameters; the motion goes on from where it is."""
        super().apply(values)
        self.simulator.reconfigure(build_parameters(values))
        self.ask_checkpoint()

    def reset(self) -> None:
        """Go back to the start."""
        self.simulator.reset()
        self.ask_checkpoint()

    def save(self) -> bytes:
        """Return the state before the next block."""
        return self.simulator.save()

    def load(self, state: bytes) -> None:
        """Go on from a saved state; an invalid one raises BearingTwinError."""
        self.simulator.load(state)
        self.ask_checkpoint()

    def ask_checkpoint(self) -> None:
        """Let a checkpoint precede the next block."""
        self._checkpoints.ask()

    def checkpoint(self, due: Due, configuration: str) -> Checkpoint | None:
        """Return the checkpoint before the block ``due``; None if it is not time for one."""
        if not self._checkpoints.is_due(due.first_sample):
            return None
        return self._checkpoints.make(
            due.first_sample,
            stamp=due.stamp,
            sample_rate=self.values['sample_rate'],
            configuration=configuration,
            state=self.save(),
        )

    def advance(self) -> TwinBlock:
        """Compute the next block with the inputs of now."""
        temperature, shaft_hz = self.inputs()
        block = self.simulator.advance(self.values['block_size'], temperature.used, shaft_hz)
        return TwinBlock(block, temperature, shaft_hz)
