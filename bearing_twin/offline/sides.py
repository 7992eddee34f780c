# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Twin and diagnosis without nodes, DDS or clocks: the same core, the same messages, bytes out.

What the live nodes publish is a function of what is handed in here; ``verify`` and the offline
replay rest on that.
"""

from __future__ import annotations

import array
from collections import Counter
import contextlib
import math
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.assets.diagnosis import DiagnosisCore
from bearing_twin.assets.messages import (
    checkpoint_message,
    twin_state_message,
    vibration_message,
)
from bearing_twin.assets.spec import configuration
from bearing_twin.assets.twin_parameters import build_simulator, SPECS
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.plainyaml import load_plain
from bearing_twin.recording.schema import message_schema, store_from_text
from bearing_twin.stamps import stamp_ns
from bearing_twin.streams.vibration_input import read_vibration
import numpy as np
import yaml

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from bearing_twin.assets.diagnosis import DueVerdict, Verdict
    from bearing_twin.streams.pacer import Due
    from bearing_twin.thermal.gate import GatedTemperature

__all__ = ['DiagnosisRun', 'Output', 'TwinRun', 'configuration_values', 'decode']

TWIN = '/twin'
DIAGNOSIS = '/diagnosis'


class Output(NamedTuple):
    """One message to be published or recorded."""

    topic: str
    type_name: str
    cdr: bytes


def _output(topic: str, message: Any) -> Output:
    """Serialise a message as :func:`canonical_cdr` would make it of the bytes rclpy makes."""
    kind = type(message)
    type_name = f'{kind.__module__.split(".")[0]}/msg/{kind.__name__}'
    store = store_from_text(type_name, message_schema(type_name).text)
    # Each field is read once, into the plain object that rosbags serialises: it asks for some of
    # them twice, and rclpy's are properties. Sequences of numbers it takes as numpy arrays.
    values = [getattr(message, name) for name, _ in store.fielddefs[type_name][1]]
    plain = store.types[type_name](
        *[np.asarray(value) if isinstance(value, array.array) else value for value in values]
    )
    return Output(topic, type_name, bytes(store.serialize_cdr(plain, type_name)))


def decode(output: Output) -> Any:
    """Return an object with the fields of a message that was made here."""
    store = store_from_text(output.type_name, message_schema(output.type_name).text)
    return store.deserialize_cdr(output.cdr, output.type_name)


def configuration_values(text: str) -> dict[str, Any]:
    """
    Read the configuration of a checkpoint.

    Raises
    ------
    BearingTwinError
        If it is no table of parameters.

    """
    values = load_plain(text, 'the configuration of a checkpoint')
    if not isinstance(values, dict):
        msg = 'the configuration of a checkpoint is no table of parameters'
        raise BearingTwinError(msg)
    return values


@contextlib.contextmanager
def _parameters_of(node: str) -> Iterator[None]:
    """Say of parameters that do not make up a node that they are none of this version's."""
    try:
        yield
    except (KeyError, TypeError) as error:
        msg = f'parameters of the {node} are missing or of another version ({error!r})'
        raise BearingTwinError(msg) from None


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
        with _parameters_of('twin'):
            self._simulator = build_simulator(values)
        self._text = yaml.safe_dump(configuration(SPECS, self.values))
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
            configuration=self._text,
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
        block = self._simulator.advance(length, temperature.used, shaft_hz)
        vibration = vibration_message(block, due=due, values=self.values)
        state = twin_state_message(block, due=due, values=self.values, temperature=temperature)
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
        with _parameters_of('diagnosis'):
            self._core = DiagnosisCore(values)
        self._text = yaml.safe_dump(self.values)
        if state is not None:
            self._core.diagnoser.load(state)

    @property
    def state(self) -> bytes:
        """State before the next block."""
        return self._core.diagnoser.save()

    def load(self, state: bytes) -> None:
        """Take up a state; blocks that were taken right before it stay in the window."""
        self._core.diagnoser.load(state)

    def reconfigure(self, values: Mapping[str, Any]) -> None:
        """Take other parameters as the running node does; the window starts anew."""
        self.values = dict(values)
        self._text = yaml.safe_dump(self.values)
        self._core.reconfigure(values)

    def checkpoint(self, message: Any) -> Output:
        """Return the checkpoint before the vibration ``message``."""
        checkpoint = checkpoint_message(
            stamp=stamp_ns(message.header.stamp),
            first_sample=message.first_sample,
            node=DIAGNOSIS,
            kind='diagnosis',
            configuration=self._text,
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

        The same as :meth:`take`, the analyses and verdicts that are due, and :meth:`outputs`.
        """
        for due in self.take(
            message, temperature=temperature, joint_hz=joint_hz, measured=measured
        ):
            yield from self.outputs(due.judge(due.analyse()))

    def take(
        self,
        message: Any,
        *,
        temperature: float,
        joint_hz: float = math.nan,
        measured: bool = False,
    ) -> list[DueVerdict]:
        """
        Take one vibration message; return the verdicts that are due.

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
        return self._core.take(
            read_vibration(message, self.values['axis']),
            stamp=stamp_ns(message.header.stamp),
            frame_id=message.header.frame_id,
            temperature=temperature,
            joint_hz=joint_hz,
            measured=measured,
        )

    def outputs(self, verdict: Verdict) -> Iterator[Output]:
        """Yield what the node publishes of a verdict."""
        self.counts[verdict.result.result] += 1
        yield _output('/diagnosis', verdict.diagnosis)
        yield _output('/features', verdict.features)
        yield _output('/spectrum', verdict.spectrum)
        yield _output('/envelope_spectrum', verdict.envelope_spectrum)
