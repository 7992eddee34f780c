# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a report shows of a recording, collected in one pass and in little memory."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.plainyaml import load_plain
from bearing_twin.recording.reader import known_fields, read_messages, recording_info
from bearing_twin.stamps import NANO
from bearing_twin.streams.vibration_input import HIGHEST_RATE
from bearing_twin.view.over_temperature import OverTemperature
from bearing_twin.view.source import Source
from bearing_twin.view.trends import recorded
from bearing_twin.view.verdict import Headline
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from bearing_twin.recording.catalogue import RecordedMessage
    from numpy.typing import NDArray

__all__ = ['Machine', 'Strip', 'collect']

SPECTRUM = 'bearing_twin_msgs/msg/Spectrum'
STRIP_STEP = 5.0
"""Distance between two strips of the waterfall, K."""
STRIP_SECONDS = 0.16
"""Length of a strip: four turns at 25 Hz, s."""


@dataclass(frozen=True)
class Strip:
    """A short piece of the waveform at one temperature."""

    temperature: float
    """degC; NaN where the recording knows none."""
    sample_rate: float
    """Hz."""
    samples: NDArray[np.float32]


@dataclass
class Machine:
    """
    One namespace of a recording: a bearing, its sensors, its twin and its verdicts.

    Times are seconds since the start of the recording, taken from when a message was received:
    a replayed sensor and the twin that answers it may stamp by different clocks.
    """

    namespace: str
    """'' at the top."""
    diagnoses: list[tuple[float, Any]] = field(default_factory=list)
    """Diagnosis messages."""
    headline: Headline = field(default_factory=Headline)
    spectra: dict[str, Any] = field(default_factory=dict)
    """Spectrum message by kind, of the window of the headline; without a verdict the latest."""
    measured: list[tuple[float, float]] = field(default_factory=list)
    """Temperature in degC."""
    states: list[tuple[float, Any]] = field(default_factory=list)
    """TwinState messages, thinned."""
    last_state: Any = None
    """The last TwinState message; None without a twin."""
    calibrations: list[tuple[float, Any]] = field(default_factory=list)
    """Calibration messages."""
    worst_lateness: float = math.nan
    """Of any block, s."""
    vibration: list[tuple[float, float, float]] = field(default_factory=list)
    """rms and largest magnitude of each block."""
    unit: str = ''
    sample_rate: float = math.nan
    """Hz."""
    strips: dict[int, Strip] = field(default_factory=dict)
    """By number of the step of temperature; of each the newest that is closest to it."""
    source: Source = field(default_factory=Source)
    over_temperature: OverTemperature = field(default_factory=OverTemperature)
    parameters: dict[str, tuple[str, Any]] = field(default_factory=dict)
    """Kind and parameters of each node."""
    undecodable: int = 0

    @property
    def name(self) -> str:
        """Name for a heading."""
        return self.namespace or '/'

    @property
    def hardware(self) -> str:
        """Identity of the asset or sensor, where a node's parameters give it."""
        named = (v.get('hardware_id') for _, v in self.parameters.values() if isinstance(v, dict))
        return next((str(name) for name in named if name), '')

    @property
    def empty(self) -> bool:
        """Whether there is nothing of a bearing in it."""
        return not (self.diagnoses or self.spectra or self.states or self.vibration)


def collect(path: Path) -> dict[str, Machine]:
    """
    Return every machine of a recording by namespace; unfinished files up to their end.

    Raises
    ------
    BearingTwinError
        If there is no recording, or nothing in it that a report can show.

    """
    start = recording_info(path).start
    machines: dict[str, _Collector] = {}
    spectra: set[str] = set()
    for message in read_messages(path, recover=True, problems=[]):
        if message.type_name == SPECTRUM:
            spectra.add(message.topic)
        namespace, _, _ = message.topic.rpartition('/')
        collector = machines.setdefault(namespace, _Collector(Machine(namespace)))
        collector.take(message, (message.log_time - start) / NANO)
    found = {name: c.machine for name, c in sorted(machines.items()) if not c.machine.empty}
    if spectra:
        _take_spectra_of_headlines(path, found, spectra)
    if not found:
        msg = (
            f'{path} holds neither vibration nor diagnosis of type bearing_twin_msgs, so that '
            "there is nothing to report; 'bearing-twin info' lists what is in it"
        )
        raise BearingTwinError(msg)
    return found


def _take_spectra_of_headlines(path: Path, machines: dict[str, Machine], topics: set[str]) -> None:
    """Keep the spectra of the window that the headline and its table come from."""
    for message in read_messages(path, topics=topics, recover=True, problems=[]):
        machine = machines.get(message.topic.rpartition('/')[0])
        if message.type_name != SPECTRUM or machine is None or not machine.diagnoses:
            continue
        try:
            content = message.decode()
        except BearingTwinError:
            continue
        if content.first_sample == machine.headline.worst.best.first_sample:
            machine.spectra[str(content.kind)] = content


class _Collector:
    """Take the messages of one machine in the order of the recording."""

    STATE_PERIOD = 0.5
    """Twin states closer than this are passed over, s."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self._temperature = math.nan
        self._next_state = -math.inf
        self._piece: list[NDArray[np.float32]] = []
        self._piece_step: int | None = None
        self._next_sample = -1
        self._takers: dict[str, Callable[[float, Any], None]] = {
            'bearing_twin_msgs/msg/Diagnosis': self._diagnosis,
            'bearing_twin_msgs/msg/Checkpoint': self._checkpoint,
            'bearing_twin_msgs/msg/Calibration': self._calibration,
            SPECTRUM: self._spectrum,
            'bearing_twin_msgs/msg/TwinState': self._state,
            'bearing_twin_msgs/msg/Vibration': self._vibration,
            'sensor_msgs/msg/Temperature': self._measured,
        }

    def take(self, message: RecordedMessage, time: float) -> None:
        taker = self._takers.get(message.type_name)
        if taker is None:
            return
        try:
            with known_fields(message.topic, message.type_name):
                taker(time, message.decode())
        except BearingTwinError:
            self.machine.undecodable += 1

    def _diagnosis(self, time: float, message: Any) -> None:
        self.machine.diagnoses.append((time, message))
        self.machine.headline.take(time, message)
        self.machine.over_temperature.diagnosis(message)

    def _calibration(self, time: float, message: Any) -> None:
        self.machine.calibrations.append((time, message))

    def _checkpoint(self, _: float, message: Any) -> None:
        node = str(message.node)
        with contextlib.suppress(BearingTwinError):
            values = load_plain(str(message.configuration), f'the configuration of {node}')
            self.machine.parameters[node] = str(message.kind), values
            self.machine.source.checkpoint(message)

    def _spectrum(self, _: float, message: Any) -> None:
        if np.asarray(message.values).size and message.bin_hz > 0.0:
            self.machine.spectra[str(message.kind)] = message

    def _measured(self, time: float, message: Any) -> None:
        self.machine.measured.append((time, float(message.temperature)))
        if not self.machine.states:
            self._temperature = float(message.temperature)

    def _state(self, time: float, message: Any) -> None:
        machine = self.machine
        self._temperature = recorded(message, 'temperature_used')
        machine.last_state = message
        machine.over_temperature.state(message)
        lateness = recorded(message, 'lateness')
        machine.worst_lateness = float(np.fmax(machine.worst_lateness, lateness))
        if time >= self._next_state:
            self._next_state = time + self.STATE_PERIOD
            machine.states.append((time, message))

    def _vibration(self, time: float, message: Any) -> None:
        samples = np.asarray(message.y if len(message.y) else message.x, dtype=np.float32)
        machine = self.machine
        if not samples.size or not 0.0 < message.sample_rate <= HIGHEST_RATE:
            return
        machine.unit = str(message.unit)
        machine.source.vibration(message)
        machine.sample_rate = float(message.sample_rate)
        finite = samples[np.isfinite(samples)].astype(np.float64)
        if finite.size:
            # The diagnosis leaves a sensor's offset out too.
            finite -= finite.mean()
            rms = float(np.sqrt(np.mean(finite**2)))
            machine.vibration.append((time, rms, float(np.abs(finite).max())))
            machine.over_temperature.vibration(finite, machine.unit, self._temperature)
        self._strip(samples, int(message.first_sample))

    def _strip(self, samples: NDArray[np.float32], first_sample: int) -> None:
        """Join blocks without a gap and at one temperature into a strip."""
        known = math.isfinite(self._temperature)
        step = round(self._temperature / STRIP_STEP) if known else 0
        if step != self._piece_step or first_sample != self._next_sample:
            self._piece = []
        self._piece_step = step
        self._next_sample = first_sample + samples.size
        self._piece.append(samples)
        rate = self.machine.sample_rate
        length = round(STRIP_SECONDS * rate)
        if sum(piece.size for piece in self._piece) >= length:
            joined = np.concatenate(self._piece)[:length]
            self._piece = []
            known_strip = self.machine.strips.get(step)
            distance = abs(self._temperature - step * STRIP_STEP)
            if known_strip is None or not distance > abs(
                known_strip.temperature - step * STRIP_STEP
            ):
                self.machine.strips[step] = Strip(self._temperature, rate, joined)
