# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Data of a report, collected from a recording in one pass with little memory."""

from __future__ import annotations

from collections.abc import Callable
import contextlib
from dataclasses import dataclass, field
import math
from pathlib import Path
from typing import Any, ClassVar, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording import topics
from bearing_twin.recording.finding import natural
from bearing_twin.recording.health import examine
from bearing_twin.recording.mcap.catalogue import known_fields
from bearing_twin.recording.plainyaml import load_table
from bearing_twin.stamps import NANO
from bearing_twin.streams.vibration_input import HIGHEST_RATE
from bearing_twin.view.over_temperature import OverTemperature
from bearing_twin.view.source import fleet_tables, Source
from bearing_twin.view.verdict import Headline
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.recording.health import RecordingHealth
    from bearing_twin.recording.mcap.catalogue import RecordedMessage
    from bearing_twin.recording.reader import RecordingInfo


STATE_PERIOD = 0.5
"""Least time between two kept twin states, s."""


@dataclass
class Machine:
    """
    One namespace of a recording: a bearing, its sensors, its twin and its verdicts.

    Times are reception times in seconds since the first message of the recording: a replayed
    sensor and its twin may stamp by different clocks.
    """

    namespace: str
    """'' for the root namespace."""
    diagnoses: list[tuple[float, Any]] = field(default_factory=list)
    """Times and Diagnosis messages."""
    headline: Headline = field(default_factory=Headline)
    measured: list[tuple[float, float]] = field(default_factory=list)
    """Times and measured temperatures in degC."""
    states: list[tuple[float, Any]] = field(default_factory=list)
    """Times and TwinState messages, thinned."""
    last_state: Any = None
    """The last TwinState message; None without a twin."""
    calibrations: list[tuple[float, Any]] = field(default_factory=list)
    """Times and Calibration messages."""
    worst_lateness: float = math.nan
    """Largest lateness of a block, s."""
    vibration: list[tuple[float, float, float]] = field(default_factory=list)
    """Time, rms and largest magnitude of each block."""
    unit: str = ''
    source: Source = field(default_factory=Source)
    over_temperature: OverTemperature = field(default_factory=OverTemperature)
    parameters: dict[str, tuple[str, dict[str, Any]]] = field(default_factory=dict)
    """Kind and parameters of each node."""
    unread: dict[str, tuple[int, str]] = field(default_factory=dict)
    """Number of unreadable messages and the first reason, by topic."""
    sensors: set[str] = field(default_factory=set)
    """Topics of vibration; the report shows ``vibration``, or else the first."""
    _temperature: float = math.nan
    _topic: str = ''
    _chosen: dict[str, str] = field(default_factory=dict)
    _next_state: float = -math.inf

    @property
    def unexplained(self) -> str:
        """Residual alarm of the last calibration in words; '' without an alarm."""
        if not self.calibrations or not self.calibrations[-1][1].residual_alarm:
            return ''
        newest = self.calibrations[-1][1]
        return f'{newest.residual_reason} (residual {newest.residual:.2g}, an alarm)'

    @property
    def name(self) -> str:
        """Name for a heading."""
        return self.namespace or '/'

    @property
    def hardware(self) -> str:
        """``hardware_id`` of the asset or sensor from a node's parameters; '' if not given."""
        named = (v.get('hardware_id') for _, v in self.parameters.values())
        return next((str(name) for name in named if name), '')

    @property
    def end(self) -> float:
        """Reception time of the last plotted message, s."""
        plotted = self.diagnoses, self.measured, self.vibration, self.states
        return max((items[-1][0] for items in plotted if items), default=0.0)

    @property
    def only_vibration(self) -> bool:
        """Whether it has neither a twin nor a verdict."""
        return not (self.diagnoses or self.headline.spectra or self.states)

    @property
    def empty(self) -> bool:
        """Whether it has no data of a bearing."""
        return self.only_vibration and not self.vibration

    def take(self, message: RecordedMessage, time: float) -> None:
        """Take a message of the namespace, in the order of the recording."""
        taker, self._topic = self._TAKERS.get(message.type_name), message.topic
        if taker is None:
            return
        try:
            with known_fields(message.topic, message.type_name):
                taker(self, time, message.decode())
        except BearingTwinError as error:
            count, reason = self.unread.get(message.topic, (0, str(error)))
            self.unread[message.topic] = count + 1, reason

    def _counts(self, name: str, forget: Callable[[], None]) -> bool:
        """
        Whether the topic is used for its kind: the one called ``name``, or else the first.

        If the topic called ``name`` comes later, ``forget`` discards the data of the other one.
        """
        before = self._chosen.setdefault(name, self._topic)
        if before != self._topic and self._topic.endswith(f'/{name}'):
            self._chosen[name] = self._topic
            forget()
        return self._chosen[name] == self._topic

    def _forget_vibration(self) -> None:
        self.vibration.clear()
        self.over_temperature.forget()
        self.source.forget_vibration()

    def _diagnosis(self, time: float, message: Any) -> None:
        self.diagnoses.append((time, message))
        self.headline.take(time, message)
        self.over_temperature.diagnosis(message)

    def _calibration(self, time: float, message: Any) -> None:
        self.calibrations.append((time, message))

    def _checkpoint(self, _: float, message: Any) -> None:
        node, kind = str(message.node), str(message.kind)
        with contextlib.suppress(BearingTwinError):
            values = load_table(str(message.configuration), f'the configuration of {node}')
            self.parameters[node] = kind, values
            self.source.parameters(node, kind, values)

    def _spectrum(self, _: float, message: Any) -> None:
        if np.asarray(message.values).size and message.bin_hz > 0.0:
            self.headline.spectrum(message)

    def _measured(self, time: float, message: Any) -> None:
        if not self._counts('temperature', self.measured.clear):
            # Another temperature, such as that of the room.
            return
        self.measured.append((time, float(message.temperature)))
        if not self.states:
            self._temperature = float(message.temperature)

    def _state(self, time: float, message: Any) -> None:
        self._temperature = float(message.temperature_used)
        self.last_state = message
        self.over_temperature.state(message)
        self.worst_lateness = float(np.fmax(self.worst_lateness, message.lateness))
        if time >= self._next_state:
            self._next_state = time + STATE_PERIOD
            self.states.append((time, message))

    def _vibration(self, time: float, message: Any) -> None:
        samples = np.asarray(message.y if len(message.y) else message.x, dtype=np.float32)
        self.sensors.add(self._topic)
        if not self._counts('vibration', self._forget_vibration):
            return
        if not samples.size or not 0.0 < message.sample_rate <= HIGHEST_RATE:
            return
        self.unit = str(message.unit)
        self.source.vibration(message)
        over, rate = self.over_temperature, float(message.sample_rate)
        speed = float(message.shaft_hz)
        rms, peak = over.vibration(samples, self.unit, rate, self._temperature, speed)
        if math.isfinite(rms):
            self.vibration.append((time, rms, peak))
        over.take_strip(samples, int(message.first_sample), rate, self._temperature)

    _TAKERS: ClassVar[dict[str, Callable[[Machine, float, Any], None]]] = {
        topics.DIAGNOSIS: _diagnosis,
        topics.CHECKPOINT: _checkpoint,
        topics.CALIBRATION: _calibration,
        topics.SPECTRUM: _spectrum,
        topics.TWIN_STATE: _state,
        topics.VIBRATION: _vibration,
        topics.TEMPERATURE: _measured,
    }


def collect(path: Path) -> tuple[RecordingInfo, RecordingHealth, dict[str, Machine]]:
    """
    Return the contents of a recording, its health, and its machines by namespace.

    Unfinished files are read up to their end.
    """
    machines: dict[str, Machine] = {}
    start: int | None = None

    def take(message: RecordedMessage) -> None:
        nonlocal start
        start = message.log_time if start is None else start
        namespace, _, _ = message.topic.rpartition('/')
        machine = machines.setdefault(namespace, Machine(namespace))
        machine.take(message, (message.log_time - start) / NANO)

    info, health = examine(path, take)
    names = sorted((name for name in machines if not machines[name].empty), key=natural)
    found = {name: machines[name] for name in names}
    for machine in machines.values():
        _take_fleet(machine, found)
    for name, machine in [*found.items()]:
        parent = found.get(name.rpartition('/')[0])
        if machine.only_vibration and parent is not None and parent.states:
            # Vibration of a twin that runs beside its machine, such as twin/vibration.
            parent.sensors |= machine.sensors
            del found[name]
    if not found:
        msg = (
            f'{path} holds neither vibration nor diagnosis of type bearing_twin_msgs, so that '
            "there is nothing to report; 'bearing-twin info' lists what is in it"
        )
        raise BearingTwinError('; '.join((msg, *info.problems)))
    return info, health, found


def _take_fleet(fleet: Machine, machines: dict[str, Machine]) -> None:
    """Give each bearing of a fleet its part of the parameters of the node."""
    # A copy, since an asset with the name of the node adds to the parameters.
    for node, (kind, values) in [*fleet.parameters.items()]:
        for namespace, table in fleet_tables(node, kind, values).items():
            machine = machines.get(namespace)
            if machine is not None:
                machine.parameters[f'{namespace} in {node}'] = 'twin', table
                machine.source.parameters(node, 'twin', table)
