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

__all__ = ['QUANTITIES', 'STEP', 'Curve', 'OverTemperature']

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
REFERENCE = 20.0
"""Temperature that values are compared with, degC."""


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


class OverTemperature:
    """Collect means in classes of 5 K."""

    def __init__(self) -> None:
        self._sums: dict[str, dict[int, list[float]]] = {}
        self._unit = ''
        self._found = ''

    def vibration(self, samples: NDArray[np.floating], unit: str, temperature: float) -> None:
        """Take samples at a temperature in degC: rms and largest magnitude about their mean."""
        if not (math.isfinite(temperature) and samples.size):
            return
        self._unit = unit
        samples = samples - samples.mean()
        self._add('amplitude', temperature, float(np.abs(samples).max()))
        self._add('level', temperature, float(np.dot(samples, samples)) / samples.size)

    def state(self, message: Any) -> None:
        """Take a TwinState: the slip and the frequency at which its first defect strikes."""
        temperature = recorded(message, 'temperature_used')
        place = str(getattr(message, 'defect', '')).partition('+')[0].partition(':')[0].strip()
        if place in PLACES:
            self._add('frequency', temperature, impacts(message, place))
        self._add('slip', temperature, 100.0 * recorded(message, 'slip'))

    def diagnosis(self, message: Any) -> None:
        """Take a Diagnosis: the fault frequency found, of the place that was named first."""
        place = str(message.result_name)
        if place in PLACES:
            self._found = self._found or place
        if place == self._found:
            self._add('found', float(message.temperature), float(message.fault_hz))

    @property
    def curves(self) -> list[Curve]:
        """What has been collected, without classes and quantities that are empty."""
        unit = pretty(self._unit)
        units = {'amplitude': unit, 'level': unit, 'slip': '%'}
        curves = []
        for key, name in QUANTITIES.items():
            classes = sorted(self._sums.get(key, {}).items())
            if not classes:
                continue
            temperatures = STEP * np.array([step for step, _ in classes], dtype=np.float64)
            values = np.array([total / count for _, (total, count) in classes])
            # Mean squares are what is collected of the level.
            values = np.sqrt(values) if key == 'level' else values
            title = f'{name} [{units.get(key, "Hz")}]'
            curves.append(Curve(key, title, temperatures, values))
        return curves

    def _add(self, key: str, temperature: float, value: float) -> None:
        if math.isfinite(temperature) and math.isfinite(value):
            step = round(temperature / STEP)
            total = self._sums.setdefault(key, {}).setdefault(step, [0.0, 0.0])
            total[0] += value
            total[1] += 1.0
