# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Twin and diagnosis without nodes, DDS or clocks: the same core, the same messages, bytes out.

What the live nodes publish is a function of what is handed in here; ``verify`` and the offline
replay rest on that.
"""

from __future__ import annotations

from collections import Counter
import math
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes.convert import (
    checkpoint_message,
    diagnosis_message,
    features_message,
    spectrum_message,
    stamp_ns,
    twin_state_message,
    vibration_message,
)
from bearing_twin.nodes.diagnosis_config import (
    build_bearing,
    build_diagnoser,
    build_settings,
    nominal_speed,
)
from bearing_twin.nodes.twin_config import build_simulator
from bearing_twin.nodes.vibration_input import read_vibration
from bearing_twin.recording.schema import canonical_cdr, message_schema
from rclpy.serialization import serialize_message
import yaml

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from bearing_twin.nodes.pacer import Due
    from bearing_twin.thermal.gate import GatedTemperature

__all__ = ['DiagnosisRun', 'Output', 'TwinRun', 'configuration_values']

NANO = 1_000_000_000
TWIN = '/twin'
DIAGNOSIS = '/diagnosis'


class Output(NamedTuple):
    """One message to be published or recorded."""

    topic: str
    type_name: str
    cdr: bytes


def _output(topic: str, message: Any) -> Output:
    kind = type(message)
    type_name = f'{kind.__module__.split(".")[0]}/msg/{kind.__name__}'
    schema = message_schema(type_name)
    return Output(
        topic, type_name, canonical_cdr(type_name, schema.text, serialize_message(message))
    )


def configuration_values(text: str) -> dict[str, Any]:
    """
    Read the configuration of a checkpoint.

    Raises
    ------
    BearingTwinError
        If it is no table of parameters.

    """
    try:
        values = yaml.safe_load(text)
    except yaml.YAMLError as error:
        msg = f'the configuration of a checkpoint cannot be read: {error}'
        raise BearingTwinError(msg) from None
    if not isinstance(values, dict):
        msg = 'the configuration of a checkpoint is no table of parameters'
        raise BearingTwinError(msg)
    return values


class TwinRun:
    """
    The twin node's work on one block after the other.

    Parameters
    ----------
    values
        Parameters of the twin node.
    state
        State to go on from, as in a checkpoint; None: the start.

    Raises
    ------
    BearingTwinError
        If they do not fit together.

    """

    def __init__(self, values: Mapping[str, Any], state: bytes | None = None) -> None:
        self.values = dict(values)
        try:
            self._simulator = build_simulator(values)
        except (KeyError, TypeError) as error:
            msg = f'parameters of the twin are missing or of another version ({error!r})'
            raise BearingTwinError(msg) from None
        if state is not None:
            self._simulator.load(state)

    @property
    def state(self) -> bytes:
        """State before the next block."""
        return self._simulator.save()

    def checkpoint(self, due: Due) -> Output:
        """Return the checkpoint before the block ``due``."""
        message = checkpoint_message(
            stamp=due.stamp,
            first_sample=due.first_sample,
            node=TWIN,
            kind='twin',
            configuration=yaml.safe_dump(self.values),
            state=self.state,
        )
        return _output('/twin_checkpoint', message)

    def block(
        self, due: Due, length: int, temperature: GatedTemperature, shaft_hz: float
    ) -> tuple[Any, tuple[Output, Output]]:
        """
        Advance by ``length`` samples.

        Returns
        -------
        message, outputs
            The vibration message; it and the twin's state as the node publishes them.

        """
        values = self.values
        block = self._simulator.advance(length, temperature.used, shaft_hz)
        vibration = vibration_message(
            block, due=due, sample_rate=values['sample_rate'], frame_id=values['frame_id']
        )
        state = twin_state_message(
            block,
            due=due,
            frame_id=values['frame_id'],
            temperature=temperature,
            bearing=values['bearing'],
            thermal_mode=values['thermal_mode'],
            defect=values['defect'],
        )
        # How long it took and how late it was says nothing here, and would differ each time.
        state.blocks_published = due.first_sample // length + 1
        return vibration, (_output('/vibration', vibration), _output('/twin_state', state))


class DiagnosisRun:
    """
    The diagnosis node's work on one vibration message after the other.

    Parameters
    ----------
    values
        Parameters of the diagnosis node.
    state
        State to go on from, as in a checkpoint; None: the start.

    Raises
    ------
    BearingTwinError
        If they do not fit together.

    """

    def __init__(self, values: Mapping[str, Any], state: bytes | None = None) -> None:
        self.values = dict(values)
        self.counts: Counter[str] = Counter()
        """Verdicts so far, by name."""
        try:
            self._bearing = build_bearing(values)
            self._diagnoser = build_diagnoser(values)
            self.nominal_hz = nominal_speed(values)
        except (KeyError, TypeError) as error:
            msg = f'parameters of the diagnosis are missing or of another version ({error!r})'
            raise BearingTwinError(msg) from None
        if state is not None:
            self._diagnoser.load(state)

    @property
    def state(self) -> bytes:
        """State before the next block."""
        return self._diagnoser.save()

    def reconfigure(self, values: Mapping[str, Any]) -> None:
        """Take other parameters as the running node does; the window starts anew."""
        self.values = dict(values)
        self._bearing = build_bearing(values)
        self.nominal_hz = nominal_speed(values)
        self._diagnoser.reconfigure(bearing=self._bearing, settings=build_settings(values))

    def checkpoint(self, message: Any) -> Output:
        """Return the checkpoint before the vibration ``message``."""
        checkpoint = checkpoint_message(
            stamp=stamp_ns(message.header.stamp),
            first_sample=message.first_sample,
            node=DIAGNOSIS,
            kind='diagnosis',
            configuration=yaml.safe_dump(self.values),
            state=self.state,
        )
        return _output('/diagnosis_checkpoint', checkpoint)

    def push(
        self,
        message: Any,
        *,
        temperature: float,
        joint_hz: float = math.nan,
        measured: bool = False,
    ) -> Iterator[Output]:
        """
        Take one vibration message; yield what the node publishes.

        Parameters
        ----------
        message
            Vibration with the fields of the ROS message.
        temperature
            Last bearing temperature, degC; NaN where there is none.
        joint_hz
            Speed to use where the message has none, Hz; NaN: that of the parameters.
        measured
            Whether ``joint_hz`` comes from a joint.

        Raises
        ------
        BearingTwinError
            If the message cannot be used.

        """
        block = read_vibration(message, self.values['axis'])
        carried = not math.isnan(block.shaft_hz)
        if carried:
            shaft_hz = block.shaft_hz
        else:
            shaft_hz = self.nominal_hz if math.isnan(joint_hz) else joint_hz
        stamp = stamp_ns(message.header.stamp)
        for result in self._diagnoser.push(
            block.first_sample,
            block.samples,
            block.sample_rate,
            shaft_hz,
            speed_measured=carried or measured,
            temperature=temperature,
            unit=block.unit,
        ):
            offset = round((result.first_sample - block.first_sample) * NANO / block.sample_rate)
            at = {'stamp': stamp + offset, 'frame_id': message.header.frame_id}
            self.counts[result.result] += 1
            verdict = diagnosis_message(result, bearing=self._bearing.name, **at)
            yield _output('/diagnosis', verdict)
            yield _output('/features', features_message(verdict))
            yield _output('/spectrum', spectrum_message(result.spectrum, result, **at))
            yield _output(
                '/envelope_spectrum', spectrum_message(result.envelope_spectrum, result, **at)
            )
