# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Amplitude, level, fault frequency and slip against temperature: the subject of the paper."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from bearing_twin.bearing.vocabulary import PLACES
from bearing_twin.view.verdict import impacts, pretty
import numpy as np
from numpy.typing import NDArray

QUANTITIES = {
    'amplitude': 'Amplitude',
    'level': 'Level, rms',
    'found': 'Frequency found',
    'frequency': 'Frequency, twin',
    'slip': 'Cage slip, twin',
}
"""Titles of the quantities by key."""

STEP = 5.0
"""Width of a class of temperature, K."""
STRIP_SECONDS = 0.12
"""Length of a strip of the waveform: three turns at 25 Hz, s."""
REFERENCE = 20.0
"""Temperature that values are compared with, degC."""
SAME_SPEED = 0.02
"""Relative difference up to which two shaft speeds count as equal: the range of slip."""
NUMBERED, UNNUMBERED = (0.0, 100.0), 45.0
"""
Temperatures in degC that an axis in the viewer includes if it spans more than ``UNNUMBERED`` K:
on a laptop it is then numbered only at each 100 degC.
"""
NO_SECOND = (0.0, 0.0, 0.0)
"""Start of a second: length in s, length times temperature, largest magnitude."""


class Curve(NamedTuple):
    """Means of a quantity in classes of 5 K."""

    key: str
    title: str
    """Name with the unit."""
    temperatures: NDArray[np.float64]
    """Temperatures of the classes, degC, rising."""
    values: NDArray[np.float64]

    @property
    def reference(self) -> float:
        """Temperature that the ratios refer to: the class closest to 20 degC."""
        return float(self.temperatures[np.abs(self.temperatures - REFERENCE).argmin()])

    @property
    def base(self) -> float:
        """Value at the reference; NaN if it is 0, and for the slip, which is nearly 0 there."""
        value = float(self.values[self.temperatures == self.reference][0])
        return value if value and self.key != 'slip' else math.nan


class Strip(NamedTuple):
    """A short piece of the waveform at one temperature."""

    temperature: float
    """Temperature, degC; NaN if it is not known."""
    sample_rate: float
    """Sample rate, Hz."""
    samples: NDArray[np.floating]


class Strips(dict[int, Strip]):
    """Strips by class of 5 K: the closest one of each class, the newest of equally close ones."""

    def __init__(self) -> None:
        super().__init__()
        self._parts: list[NDArray[np.floating]] = []
        self._begins: tuple[int, int] = 0, -1

    def take(
        self, samples: NDArray[np.floating], first: int, rate: float, temperature: float
    ) -> bool:
        """
        Add a block whose first sample has the index ``first``; return whether a strip is new.

        Blocks without a gap and of one class are joined.
        """
        step = round(temperature / STEP) if math.isfinite(temperature) else 0
        if (step, first) != self._begins:
            self._parts = []
        self._begins = step, first + samples.size
        self._parts.append(samples)
        length = round(STRIP_SECONDS * rate)
        if sum(part.size for part in self._parts) < length:
            return False
        joined, self._parts = np.concatenate(self._parts)[:length], []
        known = self.get(step)
        if known and abs(temperature - STEP * step) > abs(known.temperature - STEP * step):
            return False
        self[step] = Strip(temperature, rate, joined)
        return True


class _AtSpeed:
    """Data collected at one shaft speed."""

    def __init__(self, hertz: float) -> None:
        self.hertz = hertz
        """Shaft speed, Hz; NaN while it is not known."""
        self.count = 0
        self.strips = Strips()
        self.sums: dict[str, dict[int, list[float]]] = {}
        self._second = NO_SECOND

    def add(self, key: str, temperature: float, value: float) -> None:
        """Add a value to its class of temperature."""
        if math.isfinite(temperature) and math.isfinite(value):
            step = round(temperature / STEP)
            total = self.sums.setdefault(key, {}).setdefault(step, [0.0, 0.0])
            total[0] += value
            total[1] += 1.0
            self.count += 1

    def peak(self, length: float, temperature: float, peak: float) -> None:
        """Take the largest magnitude of ``length`` s; each full second adds an amplitude."""
        before, heat, largest = self._second
        length, heat = before + length, heat + length * temperature
        self._second = length, heat, max(largest, peak)
        if length > 1.0 - 1e-9:
            self.add('amplitude', heat / length, self._second[2])
            self._second = NO_SECOND


class OverTemperature:
    """
    Collect means and strips in classes of 5 K; another defect of the twin starts over.

    The results are those of the shaft speed held longest: another speed, or a standing shaft,
    changes the values more than temperature does.
    """

    def __init__(self) -> None:
        self._defect: str | None = None
        self._unit = ''
        self._found = self._first = ''
        self.forget()

    def forget(self) -> None:
        """Discard what has been collected."""
        self._now: _AtSpeed | None = _AtSpeed(math.nan)
        self._speeds = [self._now]

    @property
    def strips(self) -> Strips:
        """Return the strips at the speed held longest."""
        return self._longest.strips

    @property
    def is_wide(self) -> bool:
        """Whether the temperatures span more than ``UNNUMBERED`` K."""
        steps = [step for sums in self._longest.sums.values() for step in sums]
        return bool(steps) and STEP * (max(steps) - min(steps)) > UNNUMBERED

    def take_strip(
        self, samples: NDArray[np.floating], first: int, rate: float, temperature: float
    ) -> bool:
        """Add a block like `Strips.take`; return whether it changes the strips."""
        if self._now is None:
            return False
        return self._now.strips.take(samples, first, rate, temperature)

    def vibration(
        self,
        samples: NDArray[np.floating],
        unit: str,
        rate: float,
        temperature: float,
        shaft_hz: float = math.nan,
    ) -> tuple[float, float]:
        """
        Add samples at a temperature in degC; return their rms and largest magnitude.

        ``shaft_hz`` is the speed that a sensor reports; it is known before a window is judged.

        The mean is removed, as the diagnosis removes a sensor's offset. The amplitude over
        temperature is the largest magnitude of a second: a single block may have no impact, and
        the load on the balls beats over many blocks.
        """
        finite = samples[np.isfinite(samples)].astype(np.float64)
        if not finite.size:
            return math.nan, math.nan
        self._unit = unit
        if self._defect is None:
            self._turn(shaft_hz)
        finite -= finite.mean()
        power, peak = float(np.dot(finite, finite)) / finite.size, float(np.abs(finite).max())
        if self._now is not None and math.isfinite(temperature):
            self._now.add('level', temperature, power)
            self._now.peak(samples.size / rate, temperature, peak)
        return math.sqrt(power), peak

    def state(self, message: Any) -> None:
        """Add the slip and the impact frequencies of the defects of a TwinState."""
        temperature = float(message.temperature_used)
        places = [part.partition(':')[0].strip() for part in str(message.defect).split('+')]
        defect = '+'.join(places)
        if defect != self._defect and self._defect is not None:
            # These changes come from the defect, not from the temperature.
            self.forget()
        self._defect, self._first = defect, places[0]
        self._turn(float(message.shaft_hz))
        if self._now is None:
            return
        for place in sorted(set(places) & set(PLACES)):
            self._now.add(f'frequency {place}', temperature, impacts(message, place))
        self._now.add('slip', temperature, 100.0 * message.slip)

    def diagnosis(self, message: Any) -> None:
        """Add the fault frequency of a Diagnosis if it names the place that was named first."""
        place = str(message.result_name)
        if place in PLACES:
            self._found = self._found or place
        if self._defect is None:
            self._turn(float(message.shaft_hz))
        if place == self._found and self._now is not None:
            self._now.add('found', float(message.temperature), float(message.fault_hz))

    @property
    def curves(self) -> list[Curve]:
        """Curves of the quantities that have values."""
        unit = pretty(self._unit)
        units = {'amplitude': unit, 'level': unit, 'slip': '%'}
        sums = self._longest.sums
        # Of several defects, the one that the diagnosis found.
        struck = (f'frequency {place}' for place in (self._found, self._first))
        sums = sums | {'frequency': next((sums[key] for key in struck if key in sums), {})}
        curves = []
        for key, name in QUANTITIES.items():
            classes = sorted(sums.get(key, {}).items())
            if not classes:
                continue
            temperatures = STEP * np.array([step for step, _ in classes], dtype=np.float64)
            values = np.array([total / count for _, (total, count) in classes])
            # The level is collected as mean squares.
            values = np.sqrt(values) if key == 'level' else values
            title = f'{name} [{units.get(key, "Hz")}]'
            curves.append(Curve(key, title, temperatures, values))
        return curves

    @property
    def _longest(self) -> _AtSpeed:
        return max(self._speeds, key=lambda at: (at.count, len(at.strips)))

    def _turn(self, hertz: float) -> None:
        """Switch to the data of a speed in Hz; an unknown speed changes nothing."""
        if not math.isfinite(hertz):
            return
        if hertz and self._now is not None and math.isnan(self._now.hertz):
            self._now.hertz = hertz
        near = [at for at in self._speeds if abs(at.hertz - hertz) <= SAME_SPEED * abs(hertz)]
        if hertz and not near:
            near = [_AtSpeed(hertz)]
            self._speeds += near
        self._now = near[0] if hertz else None
