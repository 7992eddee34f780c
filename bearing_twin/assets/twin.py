# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A twin for nodes, fleets and offline runs: inputs, blocks, calibration and saved state."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
import struct
import time
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.assets.calibration.fitted import read_fitted_model, Sensor
from bearing_twin.assets.checkpoints import Checkpoints, parameters_of
from bearing_twin.assets.parameters.twin import (
    build_parameters,
    build_simulator,
    FASTEST_LIVE_SHAFT,
)
from bearing_twin.assets.twin_messages import ACCELERATION, TwinBlock
from bearing_twin.dynamics.defect_text import defect_places
from bearing_twin.dynamics.saved import StateFormat
from bearing_twin.dynamics.single.successor import successor
from bearing_twin.streams.vibration_input import Inputs
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.assets.calibration.fitted import FittedModel
    from bearing_twin.dynamics.parameters import TwinParameters
    from bearing_twin.dynamics.single.simulator import Block
    from bearing_twin.streams.pacer import Due
    from bearing_twin.thermal.gate import GatedTemperature
    from bearing_twin_msgs.msg import Checkpoint


_SAVED = StateFormat(b'BTfit\x00\x01\x00', struct.Struct('<?4I'), 'one fitted twin')
"""Whether the calibration changes at the next block, and the sizes of simulator state,
calibration, sensor state and next calibration, bytes."""


class TwinInputs(NamedTuple):
    """Inputs of a block: temperature and shaft speed (Hz)."""

    temperature: GatedTemperature
    shaft_hz: float


class TwinChannel(Inputs):
    """
    Validated inputs of one twin.

    Parameters
    ----------
    values
        Parameters of the twin node.
    settle
        Called in the physical mode with the first measured temperature, degC, because the start
        temperature of the twin was not that of the machine.
    clock
        Clock of the receiver, s; simulated time may go back.

    """

    def __init__(
        self,
        values: Mapping[str, Any],
        *,
        settle: Callable[[float], None],
        clock: Callable[[], float],
    ) -> None:
        super().__init__(
            clock, start=values['start_temperature'], timeout=values['temperature_timeout'],
            nominal=values['shaft_hz'], joint=values['joint'], highest=FASTEST_LIVE_SHAFT,
            hold=True, first=self._settle_first,
        )  # fmt: skip
        self.values = dict(values)
        self._settle = settle

    def _settle_first(self, temperature: float) -> None:
        if self.values['thermal_mode'] == 'physical':
            self._settle(temperature)

    @property
    def inputs(self) -> TwinInputs:
        """Return the inputs of a block that ends now."""
        now = self.clock()
        return TwinInputs(self.gate.at(now), self.shaft.at(now))

    @property
    def start_temperature(self) -> float:
        """Temperature for a restart of the twin, degC; the measured one in the physical mode."""
        if self.values['thermal_mode'] == 'physical':
            return self.temperature.used
        return float(self.values['start_temperature'])

    def apply(self, values: Mapping[str, Any]) -> None:
        """Apply changed parameters."""
        self.values = dict(values)
        self.set_timeout(values['temperature_timeout'])
        self.shaft.nominal = values['shaft_hz']


class Twin(TwinChannel):
    """A twin with its own simulator, for the parameters of a twin node."""

    def __init__(
        self,
        values: Mapping[str, Any],
        *,
        node: str = '/twin',
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        with parameters_of('twin'):
            super().__init__(values, settle=self._begin_at, clock=clock)
            self.simulator = build_simulator(values)
            self.checkpoints = Checkpoints('twin', node, values['checkpoint_period'])
        self.sensor: Sensor | None = None
        """Sensor of the machine by the calibration in force; None without a calibration."""
        self._changing = False
        self._next: FittedModel | None = None

    @property
    def fitted_model(self) -> FittedModel | None:
        """Return the calibration in force; None without one."""
        return self.sensor.fitted_model if self.sensor is not None else None

    @property
    def calibrations(self) -> tuple[FittedModel | None, FittedModel | None]:
        """Return the calibration in force, and the one that begins with the next block."""
        return self.fitted_model, self._next

    @property
    def unit(self) -> str:
        """Return the unit of the vibration."""
        return ACCELERATION if self.fitted_model is None else self.fitted_model.unit

    def warm_up(self) -> None:
        """Compile the functions for a block beforehand, as the first block has a deadline."""
        v = self.values
        self.simulator.advance(v['block_size'], v['start_temperature'], v['shaft_hz'])
        self.simulator.condition()
        self.simulator.reset()

    def apply(self, values: Mapping[str, Any]) -> None:
        """Apply changed parameters; the motion continues from its current state."""
        super().apply(values)
        self.simulator.reconfigure(self._parameters(self.fitted_model))
        self.checkpoints.ask()

    def take(self, fitted: FittedModel | None) -> None:
        """
        Apply a calibration, or drop it (None), in the next block, which fades between both twins.

        Raises
        ------
        BearingTwinError
            If it belongs to another bearing or sample rate.

        """
        if fitted is not None:
            fitted.check(build_parameters(self.values), self.values['sample_rate'])
            # Compile or load the filter before a block needs it.
            fitted.path.filter().apply([0.0])
        differs = (fitted and fitted.text) != (self.fitted_model and self.fitted_model.text)
        # This replaces an earlier request that has not begun yet.
        if differs or self._changing:
            self._changing, self._next = differs, fitted if differs else None
            self.checkpoints.ask()

    def reset(self) -> None:
        """Return to the initial state, with the calibration in force."""
        self.simulator.start = self.start_temperature, self.simulator.shaft_hz
        self.simulator.reset()
        if self.sensor is not None:
            self.sensor = Sensor(self.sensor.fitted_model)
        self.checkpoints.ask()

    def _begin_at(self, temperature: float) -> None:
        """Begin in the steady state of the first measured temperature, degC."""
        self.simulator.settle(temperature)
        self.checkpoints.ask()

    def save(self) -> bytes:
        """Return the state before the next block, with the calibration in force."""
        state = self.simulator.save()
        if self.sensor is None and not self._changing:
            return state
        parts = [
            state,
            self.sensor.fitted_model.text.encode() if self.sensor else b'',
            self.sensor.save() if self.sensor else b'',
            self._next.text.encode() if self._next else b'',
        ]
        return _SAVED.pack((self._changing, *map(len, parts)), b''.join(parts))

    def load(self, state: bytes) -> None:
        """
        Continue from a saved state, with the calibration that was in force.

        Raises
        ------
        BearingTwinError
            If the state is invalid. The twin is then unchanged.

        """
        changing, parts = False, [bytes(state), b'', b'', b'']
        if parts[0].startswith(_SAVED.magic):
            (changing, *sizes), body = _SAVED.unpack(parts[0])
            ends = np.cumsum([0, *sizes])
            parts = [body[a:b] for a, b in pairwise(ends)]
        fitted, following = (
            read_fitted_model(text.decode(errors='replace')) if text else None
            for text in (parts[1], parts[3])
        )
        own = build_parameters(self.values)
        for each in filter(None, (fitted, following)):
            each.check(own, self.values['sample_rate'])
        sensor = Sensor(fitted) if fitted is not None else None
        if sensor is not None:
            sensor.load(parts[2])
        simulator = self.simulator
        if (fitted and fitted.text) != (self.fitted_model and self.fitted_model.text):
            simulator = build_simulator(self.values, self._parameters(fitted))
        simulator.load(parts[0])
        self.simulator, self.sensor, self.settled = simulator, sensor, True
        self._changing, self._next = bool(changing), following
        self.values = dict(self.values)
        self.checkpoints.ask()

    def checkpoint(self, due: Due, configuration: str) -> Checkpoint | None:
        """Return the checkpoint before the block ``due``; None if no checkpoint is due."""
        if not self.checkpoints.is_due(due.first_sample):
            return None
        return self.checkpoints.make(
            due.first_sample,
            stamp=due.stamp,
            sample_rate=self.values['sample_rate'],
            configuration=configuration,
            state=self.save(),
        )

    def advance(self, inputs: TwinInputs | None = None, n: int | None = None) -> TwinBlock:
        """Return the next block, of ``n`` samples; by default with current inputs and length."""
        return self.advance_all([inputs or self.inputs], n or self.values['block_size'])[0]

    def advance_all(self, inputs: Sequence[TwinInputs], n: int) -> list[TwinBlock]:
        """Return blocks of ``n`` samples as :meth:`advance` does, computed in one call."""
        if inputs and self._changing:
            first = self._fade(n, inputs[0].temperature.used, inputs[0].shaft_hz)
            return [self._made(first, inputs[0]), *self.advance_all(inputs[1:], n)]
        temperatures = [each.temperature.used for each in inputs]
        blocks = self.simulator.advance_all(n, temperatures, [each.shaft_hz for each in inputs])
        return [
            self._made(self._sensed(block), each)
            for block, each in zip(blocks, inputs, strict=True)
        ]

    def _sensed(self, block: Block) -> Block:
        """Return a block as the sensor of the machine would measure it."""
        return block if self.sensor is None else self.sensor.take(block)

    def _made(self, block: Block, inputs: TwinInputs) -> TwinBlock:
        fitted = self.fitted_model
        injected = defect_places(self.values['defect']) != 'none'
        defect = fitted.defect if fitted and not injected else ''
        return TwinBlock(block, *inputs, self.unit, defect)

    def _fade(self, n: int, temperature: float, shaft_hz: float) -> Block:
        """Return a block that fades from one calibration to the next."""
        following, before = successor(self.simulator, self._parameters(self._next))
        old = self.simulator.advance(n, temperature, shaft_hz)
        new = following.advance(n, temperature, shaft_hz)
        old = self._sensed(old)
        self.simulator, self.sensor = following, None
        if self._next is not None:
            self.sensor = Sensor(self._next)
            self.sensor.take(before)
            new = self.sensor.take(new)
        self._changing, self._next = False, None
        # A new object makes `TwinBytes` build its message templates anew.
        self.values = dict(self.values)
        share = (0.5 - 0.5 * np.cos(np.pi * (np.arange(n) + 0.5) / n)).astype(np.float32)
        return replace(new, x=old.x + share * (new.x - old.x), y=old.y + share * (new.y - old.y))

    def _parameters(self, fitted: FittedModel | None) -> TwinParameters:
        own = build_parameters(self.values)
        return own if fitted is None else fitted.parameters(own)
