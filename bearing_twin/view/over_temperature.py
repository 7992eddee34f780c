# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Amplitude, level, fault frequency and slip against temperature: the subject of the paper."""

from __future__ import annotations

import math
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.bearing.vocabulary import PLACES
from bearing_twin.view.trends import recorded
from bearing_twin.view.verdict import impacts, pretty
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


QUANTITIES = {
    'amplitude': 'Amplitude',
    'level': 'Level, rms',
    'found': 'Frequency found',
    'frequency': 'Frequency, twin',
    'slip': 'Cage slip, twin',
}
"""What is collected."""

STEP = 5.0
"""Width of a class of temperature, K."""
STRIP_SECONDS = 0.12
"""Length of a strip of the waveform: three turns at 25 Hz, s."""
REFERENCE = 20.0
"""Temperature that values are compared with, degC."""
SAME_SPEED = 0.02
"""Part by which a shaft speed may move and still be one: that by which slip moves a frequency."""
NUMBERED, UNNUMBERED = (0.0, 100.0), 45.0
"""
Two temperatures that an axis in the viewer holds where it spans more than ``UNNUMBERED``: it is
then numbered at each 100 degC only on a laptop.
"""
NO_SECOND = (0.0, 0.0, 0.0)
"""Length in s, its product with the temperature and largest magnitude, before any block."""


class Curve(NamedTuple):
    """Means of a quantity, class by class."""

    key: str
    title: str
    """With the unit."""
    temperatures: NDArray[np.float64]
    """degC, rising."""
    values: NDArray[np.float64]

    @property
    def reference(self) -> float:
        """Temperature that the ratios refer to: the class closest to 20 degC."""
        return float(self.temperatures[np.abs(self.temperatures - REFERENCE).argmin()])

    @property
    def base(self) -> float:
        """Value at the reference; NaN for the slip, whose ratio to nearly nothing says nothing."""
        value = float(self.values[self.temperatures == self.reference][0])
        return value if value and self.key != 'slip' else math.nan


class Strip(NamedTuple):
    """A short piece of the waveform at one temperature."""

    temperature: float
    """degC; NaN where it is not known."""
    sample_rate: float
    """Hz."""
    samples: NDArray[np.floating]


class Strips(dict[int, Strip]):
    """Keep of each class of 5 K the newest piece of the waveform that is closest to it."""

    def __init__(self) -> None:
        super().__init__()
        self._parts: list[NDArray[np.floating]] = []
        self._begins: tuple[int, int] = 0, -1

    def take(
        self, samples: NDArray[np.floating], first: int, rate: float, temperature: float
    ) -> bool:
        """
        Take a block whose first sample has the index ``first``; return whether a strip is new.

        Blocks without a gap and at one temperature are joined.
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
    """What was collected while the shaft turned at one speed."""

    def __init__(self, hertz: float) -> None:
        self.hertz = hertz
        """NaN: not known."""
        self.count = 0
        self.strips = Strips()
        self.sums: dict[str, dict[int, list[float]]] = {}
        self._second = NO_SECOND

    def add(self, key: str, temperature: float, value: float) -> None:
        """Take a value into its class."""
        if math.isfinite(temperature) and math.isfinite(value):
            step = round(temperature / STEP)
            total = self.sums.setdefault(key, {}).setdefault(step, [0.0, 0.0])
            total[0] += value
            total[1] += 1.0
            self.count += 1

    def peak(self, length: float, temperature: float, peak: float) -> None:
        """Take the largest magnitude of ``length`` s; that of a whole second into its class."""
        before, heat, largest = self._second
        length, heat = before + length, heat + length * temperature
        self._second = length, heat, max(largest, peak)
        if length > 1.0 - 1e-9:
            self.add('amplitude', heat / length, self._second[2])
            self._second = NO_SECOND


class OverTemperature:
    """
    Collect means in classes of 5 K, and strips, as long as the twin has one defect.

    They are those of the speed that was held longest: another speed, or a shaft that stands,
    changes more than temperature does.
    """

    def __init__(self) -> None:
        self._defect: str | None = None
        self._unit = ''
        self._found = self._first = ''
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        self._now: _AtSpeed | None = _AtSpeed(math.nan)
        self._speeds = [self._now]

    @property
    def strips(self) -> Strips:
        """Of the speed that was held longest."""
        return self._longest.strips

    @property
    def is_wide(self) -> bool:
        """Whether the temperatures are too far apart for each tenth to be numbered."""
        steps = [step for sums in self._longest.sums.values() for step in sums]
        return bool(steps) and STEP * (max(steps) - min(steps)) > UNNUMBERED

    def take_strip(
        self, samples: NDArray[np.floating], first: int, rate: float, temperature: float
    ) -> bool:
        """Take a block as `Strips.take`; return whether it changes what is shown."""
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
        Take samples at a temperature in degC; return their rms and largest magnitude.

        Their own shaft speed, where a sensor tells it, is known before a window is judged.

        Both are about the mean, as the diagnosis leaves a sensor's offset out too. The amplitude
        over temperature is the largest magnitude of a second: a block may have no impact, and the
        load on the balls beats over many of them.
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
        """Take a TwinState: the slip and the frequencies at which its defects strike."""
        temperature = recorded(message, 'temperature_used')
        said = str(getattr(message, 'defect', ''))
        places = [part.partition(':')[0].strip() for part in said.split('+')]
        defect = '+'.join(places)
        if defect != self._defect and self._defect is not None:
            # What changes with the defect is not what temperature does.
            self.forget()
        self._defect, self._first = defect, places[0]
        self._turn(recorded(message, 'shaft_hz'))
        if self._now is None:
            return
        for place in sorted(set(places) & set(PLACES)):
            self._now.add(f'frequency {place}', temperature, impacts(message, place))
        self._now.add('slip', temperature, 100.0 * recorded(message, 'slip'))

    def diagnosis(self, message: Any) -> None:
        """Take a Diagnosis: the fault frequency found, of the place that was named first."""
        place = str(message.result_name)
        if place in PLACES:
            self._found = self._found or place
        if self._defect is None:
            self._turn(recorded(message, 'shaft_hz'))
        if place == self._found and self._now is not None:
            self._now.add('found', float(message.temperature), float(message.fault_hz))

    @property
    def curves(self) -> list[Curve]:
        """What has been collected, without classes and quantities that are empty."""
        unit = pretty(self._unit)
        units = {'amplitude': unit, 'level': unit, 'slip': '%'}
        sums = self._longest.sums
        # The twin's defect that the diagnosis found, where it has several.
        struck = (f'frequency {place}' for place in (self._found, self._first))
        sums = sums | {'frequency': next((sums[key] for key in struck if key in sums), {})}
        curves = []
        for key, name in QUANTITIES.items():
            classes = sorted(sums.get(key, {}).items())
            if not classes:
                continue
            temperatures = STEP * np.array([step for step, _ in classes], dtype=np.float64)
            values = np.array([total / count for _, (total, count) in classes])
            # Mean squares are what is collected of the level.
            values = np.sqrt(values) if key == 'level' else values
            title = f'{name} [{units.get(key, "Hz")}]'
            curves.append(Curve(key, title, temperatures, values))
        return curves

    @property
    def _longest(self) -> _AtSpeed:
        return max(self._speeds, key=lambda at: (at.count, len(at.strips)))

    def _turn(self, hertz: float) -> None:
        """Go on with what was collected at a speed in Hz; one that is not known is the last."""
        if not math.isfinite(hertz):
            return
        if hertz and self._now is not None and math.isnan(self._now.hertz):
            self._now.hertz = hertz
        near = [at for at in self._speeds if abs(at.hertz - hertz) <= SAME_SPEED * abs(hertz)]
        if hertz and not near:
            near = [_AtSpeed(hertz)]
            self._speeds += near
        self._now = near[0] if hertz else None
