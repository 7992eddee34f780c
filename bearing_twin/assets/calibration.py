# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""From blocks of vibration to calibrations of the twin: when, on what, and as which message."""

from __future__ import annotations

from collections import deque
from dataclasses import asdict, dataclass, field
import json
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.diagnosis_parameters import build_bearing
from bearing_twin.assets.fitted import GEOMETRY
from bearing_twin.assets.messages import floats, message_header
from bearing_twin.bearing import PLACES
from bearing_twin.calibration import Calibration as Fitted
from bearing_twin.calibration import fit
from bearing_twin.calibration.fit import decimated, fitted_vibration
from bearing_twin.calibration.impacts import Impacts
from bearing_twin.calibration.joint import compared
from bearing_twin.calibration.passage import load_range
from bearing_twin.calibration.residual import Residual, spectral_levels, Unexplained
from bearing_twin.diagnosis.state import pack, unpack
from bearing_twin.dynamics.parameters import check_bearing
from bearing_twin.dynamics.sensor_path import BAND_HZ, band_levels
from bearing_twin.errors import BearingTwinError
from bearing_twin.stamps import samples_ns
from bearing_twin_msgs.msg import Calibration
import numpy as np
from scipy import signal

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bearing_twin.bearing import Bearing
    from bearing_twin.streams.vibration_input import VibrationBlock
    from bearing_twin_msgs.msg import Diagnosis
    from numpy.typing import NDArray

__all__ = ['CalibrationCore', 'Fit', 'Task', 'work']

_VERSION = 2003
SHARE = 1.0 / 3.0
"""Most of one core that is used, over time: 10 s each 30 s."""
SHOWN_S = 2.0
"""Length of the fitted twin's vibration that is shown beside the machine's, s."""
MOST_SEEN = 100
"""Fits whose spacing of the impacts is compared with the newest, at another speed."""
DECISION_S = 60.0
"""Time from one decision on the residual to the next: its alarm rate is counted for that."""
MOVED = 0.02
"""Most that the speed may move within a record, from the slowest to the fastest over the mean. The
lines of the shaft then stay where `residual.ORDER_WIDTH` looks for them. On impact trains with a
ramp, 2 % leaves the spacing of the impacts within 0.1 % and nine tenths of its prominence; 10 %
makes it up to 1.5 % too short."""


@dataclass(frozen=True, kw_only=True)
class Task:
    """A record to be fitted; plain values that go to another process."""

    samples: NDArray[np.float64]
    sample_rate: float
    bearing: Bearing
    shaft_hz: float
    temperature: float
    unit: str
    place: str | None
    load: tuple[float, float] | None
    candidates: int
    others: tuple[Impacts, ...]
    """What the fits before have seen of the impacts of a passage."""
    reference: dict[str, Any] | None
    """The calibration that the residual is taken from; None: the one that is found."""
    stamp: int
    """ns."""
    frame_id: str
    first_sample: int


@dataclass(frozen=True, kw_only=True)
class Fit:
    """What became of a task."""

    found: dict[str, Any]
    """The calibration, as plain values."""
    bands: tuple[str, ...]
    measured: NDArray[np.float64]
    """Level of the machine in each band, dB, shape (m,)."""
    twin: NDArray[np.float64]
    """Level of the twin of the reference, dB, shape (m,)."""
    spectrum: NDArray[np.float64]
    """`band_levels` of the fitted twin, dB; those of the machine are in ``found``."""
    turns: NDArray[np.float64]
    """One revolution of machine and fitted twin, shape (2, n)."""


def work(task: Task) -> Fit:
    """
    Fit a record, and take the spectra of machine and twin; in a process of its own.

    Raises
    ------
    BearingTwinError
        If the record cannot be fitted.

    """
    found = fit(
        task.samples, task.sample_rate, task.bearing, task.shaft_hz, load=task.load,
        temperature=task.temperature, unit=task.unit, place=task.place,
        candidates=task.candidates,
    )  # fmt: skip
    found = compared(found, task.others)
    reference = Fitted.from_dict(task.reference) if task.reference else found
    here = reference.at(shaft_hz=task.shaft_hz)
    if math.isfinite(task.temperature):
        here = here.at(temperature=task.temperature)
    seconds = len(task.samples) / task.sample_rate
    # The twin may run at a lower rate than the sensor; bands beyond it are not compared.
    bands, measured = spectral_levels(task.samples, task.sample_rate, task.shaft_hz)
    names, levels = spectral_levels(
        fitted_vibration(here, seconds), here.situation.sample_rate, task.shaft_hz
    )
    own = dict(zip(names, levels, strict=True))
    twin = np.array([own.get(band, math.nan) for band in bands])
    rate = found.situation.sample_rate
    shown = fitted_vibration(found, max(SHOWN_S, 2.0 / task.shaft_hz))
    slow = decimated(task.samples - task.samples.mean(), task.sample_rate)[0]
    length = int(rate / task.shaft_hz)
    # The second one: the filter has settled.
    turn = slow[length : 2 * length]
    turn = turn - turn.mean()
    # The twin turns at an angle of its own: shown where it is most like the machine.
    alike = signal.correlate(np.abs(shown), np.abs(turn), 'valid')
    first = int(np.argmax(alike))
    return Fit(
        found=found.to_dict(), bands=bands, measured=measured, twin=twin,
        spectrum=band_levels(shown, rate),
        turns=np.array([turn, shown[first : first + len(turn)]]),
    )  # fmt: skip


@dataclass
class _Record:
    """The newest samples of one sensor, without a gap, and the shaft speed of each block."""

    parts: deque[NDArray[np.float32]] = field(default_factory=deque)
    speeds: deque[float] = field(default_factory=deque)
    """Hz; NaN where it is not known."""
    held: int = 0
    following: tuple[int, float, str] = (-1, 0.0, '')
    """Index, sample rate and unit of a block that goes on."""

    def add(self, block: VibrationBlock, shaft_hz: float, most: int) -> None:
        if (block.first_sample, block.sample_rate, block.unit) != self.following:
            self.parts.clear()
            self.speeds.clear()
            self.held = 0
        self.parts.append(block.samples)
        self.speeds.append(shaft_hz)
        self.held += len(block.samples)
        end = block.first_sample + len(block.samples)
        self.following = (end, block.sample_rate, block.unit)
        while self.held - len(self.parts[0]) >= most:
            self.held -= len(self.parts.popleft())
            self.speeds.popleft()

    def shaft_hz(self) -> tuple[float, str]:
        """Return the mean speed, Hz, and why there is none to fit at; '' if there is."""
        speeds = np.array(self.speeds)
        if not np.isfinite(speeds).all():
            return math.nan, 'no shaft speed: set shaft_hz, or joint where joint_states has it'
        slowest, fastest = float(speeds.min()), float(speeds.max())
        mean = float(np.average(speeds, weights=[len(part) for part in self.parts]))
        if fastest <= 0.0:
            return math.nan, 'the shaft stands still: start the machine'
        if fastest - slowest > MOVED * mean:
            return math.nan, (
                f'the speed moved from {slowest:.3g} to {fastest:.3g} Hz within the window, more '
                f'than {100.0 * MOVED:g} %: keep it steady, or choose a shorter window'
            )
        return mean, ''


class CalibrationCore:
    """
    The calibration that a set of parameters describes: no clocks, no threads, no topics.

    Parameters
    ----------
    values
        Parameters of the calibration node.

    Raises
    ------
    BearingTwinError
        If they do not fit together.

    """

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._values = values
        self.bearing = build_bearing(values)
        low, high = values['load_low'], values['load_high']
        if bool(low) != bool(high) or low > high:
            msg = f'load_low={low} N and load_high={high} N are no range; give both, or neither'
            raise BearingTwinError(msg)
        self._load = (low, high) if high else None
        check_bearing(self.bearing)
        load_range(self.bearing, self._load)
        self._record = _Record()
        self._place: str | None = None
        self._heard = self._well = False
        self._next = -math.inf
        self._decided = -math.inf
        self._residual = Residual()
        self._reference: dict[str, Any] | None = None
        self._seen: deque[Impacts] = deque(maxlen=MOST_SEEN)
        self.unexplained = Unexplained(math.nan, '', math.nan, 'nothing was fitted yet')
        self.waiting = ''
        """What is missing for a fit, besides vibration; '' if nothing."""

    def verdict(self, message: Diagnosis) -> None:
        """Take what the diagnosis says: where a defect is looked for, and what health is."""
        self._heard = True
        place = message.faults[0] if message.faults else ''
        fault = message.level == message.LEVEL_FAULT and place in PLACES
        self._place = place if fault else 'none'
        self._well = message.level == message.LEVEL_OK

    def take(
        self, block: VibrationBlock, *, stamp: int, frame_id: str, temperature: float,
        shaft_hz: float, now: float,
    ) -> Task | None:  # fmt: skip
        """
        Take a block; return what is to be fitted, if it is due.

        Parameters
        ----------
        block
            The block.
        stamp
            Of its first sample, ns.
        frame_id
            Of the sensor.
        temperature
            Of the bearing, degC; NaN where there is none.
        shaft_hz
            Speed to use where the block has none, Hz; NaN if unknown.
        now
            s, on any clock that runs on.

        """
        wanted = round(self._values['window'] * block.sample_rate)
        known = shaft_hz if math.isnan(block.shaft_hz) else block.shaft_hz
        self._record.add(block, known, wanted)
        full = self._record.held >= wanted
        hertz, self.waiting = self._record.shaft_hz() if full else (math.nan, '')
        if not full or now < self._next or self.waiting:
            return None
        self._next = now + self._values['period']
        samples = np.concatenate(self._record.parts)[-wanted:].astype(np.float64)
        first = self._record.following[0] - wanted
        return Task(
            samples=samples, sample_rate=block.sample_rate, bearing=self.bearing,
            shaft_hz=hertz, temperature=temperature, unit=block.unit, place=self._place,
            load=self._load, candidates=self._values['candidates'], others=tuple(self._seen),
            reference=self._reference,
            stamp=stamp + samples_ns(first - block.first_sample, block.sample_rate),
            frame_id=frame_id, first_sample=first,
        )  # fmt: skip

    def conclude(self, task: Task, done: Fit, now: float) -> Calibration:
        """Take what was fitted; return the message, and put the next fit off if it cost much."""
        cost = float(done.found['cost_s'])
        self._next = max(self._next, now + cost * (1.0 / SHARE - 1.0))
        if done.found['impacts'] is not None:
            self._seen.append(Impacts.of(done.found['impacts']))
        decides = now - self._decided >= DECISION_S
        if self._reference is None:
            said = self._no_reference(done.found['defect'])
            if not said:
                self._reference = done.found
                said = 'this calibration is the healthy twin: the next ones are compared with it'
            self.unexplained = Unexplained(math.nan, '', math.nan, said)
        elif decides:
            self._decided = now
            difference = done.measured - done.twin
            self.unexplained = self._residual.update(done.bands, difference, healthy=self._well)
        return self._message(task, done)

    def _no_reference(self, defect: str) -> str:
        """Return why a calibration is not that of the healthy machine; '' if it is."""
        none = 'no calibration of the healthy machine yet: '
        if not self._heard:
            return f'{none}no diagnosis was heard, start the diagnosis node beside this one'
        if not self._well:
            return f'{none}the diagnosis is not ok'
        return '' if defect == 'none' else f'{none}this one has a defect ({defect})'

    def _message(self, task: Task, done: Fit) -> Calibration:
        found, said = done.found, self.unexplained
        spectrum, quantities = found['spectrum'], found['quantities']
        before = spectrum['level_before_db']
        columns = {
            key: [value[key] for value in quantities.values()]
            for key in ('q05', 'median', 'q95', 'identifiable', 'why')
        }
        return Calibration(
            header=message_header(task.stamp, task.frame_id),
            first_sample=task.first_sample,
            sample_count=len(task.samples),
            sample_rate=task.sample_rate,
            bearing=task.bearing.name,
            shaft_hz=task.shaft_hz,
            temperature=task.temperature,
            defect=found['defect'],
            statement=found['statement'],
            quantity=list(quantities),
            quantity_unit=[value['unit'] for value in quantities.values()],
            **columns,
            **{
                f'width_{key}': quantities.get('defect_width_mm', {}).get(key, math.nan)
                for key in ('q05', 'median', 'q95')
            },
            distance_before=spectrum['distance_before_db'],
            distance=spectrum['distance_after_db'],
            level_before=math.nan if before is None else before,
            level=spectrum['level_after_db'],
            residual=said.number,
            residual_alarm=said.alarm,
            residual_where=said.where,
            residual_over=said.over,
            residual_reason=said.reason,
            band=list(done.bands),
            measured_level=floats(done.measured),
            twin_level=floats(done.twin),
            unit=task.unit,
            spectrum_step=BAND_HZ,
            measured_spectrum=floats(np.array(spectrum['machine_db'])),
            twin_spectrum=floats(done.spectrum),
            turn_rate=found['machine']['sample_rate'],
            measured_turn=floats(done.turns[0]),
            twin_turn=floats(done.turns[1]),
            cost=float(found['cost_s']),
            json=json.dumps(found),
        )

    @property
    def _geometry(self) -> list[float]:
        return [getattr(self.bearing, name) for name in GEOMETRY]

    def save(self) -> bytes:
        """Return what is worth keeping over a restart: the healthy twin, and its residual."""
        values = {
            'geometry': self._geometry,
            'reference': self._reference,
            'residual': asdict(self._residual),
        }
        return pack(_VERSION, values, {})

    def load(self, data: bytes) -> None:
        """
        Take up a saved state.

        Raises
        ------
        BearingTwinError
            If the bytes are not such a state, or of another bearing; the present state is then
            unchanged.

        """
        values, _ = unpack(data, _VERSION)
        if values.get('geometry') != self._geometry:
            msg = (
                f'the saved healthy twin is not of {self.bearing.name}; choose another state_name'
            )
            raise BearingTwinError(msg)
        reference = values.get('reference')
        if reference is not None:
            Fitted.from_dict(reference)
        self._residual = Residual.of(values.get('residual', {}))
        self._reference = reference
