# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages of a twin for a block, as objects and serialised."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from operator import attrgetter
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.assets.message_template import MessageTemplate
from bearing_twin.assets.messages import floats, message_header
from bearing_twin.dynamics.defect_text import placed_defects
from bearing_twin.dynamics.single.condition import Condition
from bearing_twin.stamps import split_ns
from bearing_twin.streams.vibration_input import VibrationBlock
from bearing_twin_msgs.msg import TwinState, Vibration

if TYPE_CHECKING:
    from bearing_twin.dynamics.single.simulator import Block
    from bearing_twin.streams.pacer import Due
    from bearing_twin.thermal.gate import GatedTemperature


OF_CONDITION = tuple(
    name
    for name, kind in TwinState.get_fields_and_field_types().items()
    if name in Condition._fields and not kind.startswith('sequence')
)
"""Number fields of a `TwinState` with the same name in `Condition`."""
STAMP = ('header.stamp.sec', 'header.stamp.nanosec')
TEMPERATURE = ('status', 'measured', 'used', 'age')
REALTIME = ('blocks_published', 'blocks_late', 'blocks_dropped', 'lateness', 'execution_time')
ACCELERATION = 'm/s^2'
"""Unit of the vibration of a twin without calibration."""
_condition = attrgetter(*OF_CONDITION)


class TwinBlock(NamedTuple):
    """A computed block and its inputs; shaft speed in Hz."""

    block: Block
    temperature: GatedTemperature
    shaft_hz: float
    unit: str = ACCELERATION
    defect: str = ''
    """Defects by a calibration, as text; '': defects by the parameters."""


def vibration_message(made: TwinBlock, due: Due, values: Mapping[str, Any]) -> Vibration:
    """Return the vibration message of a block at the time of ``due``."""
    return Vibration(
        header=message_header(due.stamp, values['frame_id']),
        sample_rate=values['sample_rate'],
        first_sample=due.first_sample,
        source=Vibration.SOURCE_SIMULATED,
        unit=made.unit,
        shaft_hz=made.shaft_hz,
        x=floats(made.block.x),
        y=floats(made.block.y),
    )


def vibration_block(
    made: TwinBlock, due: Due, values: Mapping[str, Any], axis: str
) -> VibrationBlock:
    """Return one axis of a block as a diagnosis would read it from the message."""
    return VibrationBlock(
        due.first_sample, getattr(made.block, axis), values['sample_rate'], made.shaft_hz,
        made.unit, simulated=True, stamp=due.stamp, frame_id=values['frame_id'],
    )  # fmt: skip


def state_message(made: TwinBlock, due: Due, values: Mapping[str, Any]) -> TwinState:
    """Return the state message of a block; the node fills in the real-time fields."""
    condition, temperature = made.block.condition, made.temperature
    return TwinState(
        header=message_header(due.stamp, values['frame_id']),
        first_sample=due.first_sample,
        sample_count=made.block.x.size,
        bearing=values['bearing'] or values['geometry'],
        thermal_mode=values['thermal_mode'],
        defect=made.defect or placed_defects(values['defect'], values['load_angle']),
        temperature_status=int(temperature.status),
        temperature_measured=temperature.measured,
        temperature_used=temperature.used,
        temperature_age=temperature.age,
        ball_force=floats(condition.ball_force),
        **dict(zip(OF_CONDITION, _condition(condition), strict=True)),
    )


class TwinBytes:
    """Serialise the messages of one twin, for blocks of one length."""

    def __init__(self, serialize: Callable[[Any], bytes]) -> None:
        self._serialize = serialize
        self._values: Mapping[str, Any] | None = None
        self._vibration: MessageTemplate | None = None
        self._state: MessageTemplate | None = None

    def vibration(self, made: TwinBlock, due: Due, values: Mapping[str, Any]) -> bytes:
        """Return a `Vibration`; pass a new object as ``values`` if parameters have changed."""
        self._renew(values)
        if self._vibration is None:
            self._vibration = MessageTemplate(
                vibration_message(made, due, values),
                (*STAMP, 'first_sample', 'shaft_hz'),
                ('x', 'y'),
                self._serialize,
            )
        numbers = *split_ns(due.stamp), due.first_sample, made.shaft_hz
        return self._vibration.fill(numbers, made.block.x, made.block.y)

    def state(
        self, made: TwinBlock, due: Due, values: Mapping[str, Any], realtime: Mapping[str, float]
    ) -> bytes:
        """Return a `TwinState` with these real-time fields; ``values`` as for a `Vibration`."""
        self._renew(values)
        condition, temperature = made.block.condition, made.temperature
        if self._state is None:
            self._state = MessageTemplate(
                state_message(made, due, values),
                (
                    *(*STAMP, 'first_sample', 'sample_count'),
                    *(f'temperature_{name}' for name in TEMPERATURE),
                    *OF_CONDITION,
                    *REALTIME,
                ),
                ('ball_force',),
                self._serialize,
            )
        numbers = (
            *split_ns(due.stamp),
            due.first_sample,
            made.block.x.size,
            *(int(temperature.status), temperature.measured, temperature.used, temperature.age),
            *_condition(condition),
            *(realtime[name] for name in REALTIME),
        )
        return self._state.fill(numbers, condition.ball_force)

    def _renew(self, values: Mapping[str, Any]) -> None:
        if self._values is not values:
            self._values, self._vibration, self._state = values, None, None


class StateSchedule:
    """
    Choose the blocks whose state is published.

    ``rate`` is the number of states per second (0: one per block), ``period`` the duration of a
    block in s, and ``turn`` the number of the twin, so that a fleet does not publish all states at
    the same time.
    """

    def __init__(self, rate: float, period: float, turn: int = 0) -> None:
        self.period = period
        self._every = max(1.0, 1.0 / (rate * period)) if rate else 1.0
        self._turn = turn
        self._seen: object = None

    def wants(self, due: Due, *inputs: object) -> bool:
        """Return whether the state of a block is due, or ``inputs`` have changed."""
        changed, self._seen = self._seen != inputs, inputs
        place = due.number + self._turn
        return changed or place // self._every > (place - 1) // self._every
