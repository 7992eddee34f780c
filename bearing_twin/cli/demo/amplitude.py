# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Impact amplitude over temperature in a demo run, beside the paper's statement."""

from __future__ import annotations

from collections import defaultdict
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.dynamics.trend import mean_of_largest
from bearing_twin.paper.figures.style import COLOURS, label, new_figure, save, TEMPERATURE_LABEL
import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt


STEP = 10.0
"""Width of a temperature class, K: the distance of the paper's nodes."""


class AmplitudeByTemperature:
    """
    Collect one maximum per ball passage, with its temperature.

    Blocks and states may come in any order; only a few numbers of each are kept.
    """

    def __init__(self) -> None:
        self._maxima: dict[int, npt.NDArray[np.float64]] = {}
        self._states: dict[int, tuple[float, float]] = {}
        self._waiting: dict[int, tuple[npt.NDArray[np.float32], float]] = {}

    def add_vibration(self, message: Any) -> None:
        """Take a ``Vibration``."""
        samples = np.asarray(message.y)
        self._waiting[message.first_sample] = samples, message.sample_rate
        self._match(message.first_sample)

    def add_state(self, message: Any) -> None:
        """Take a ``TwinState``."""
        self._states[message.first_sample] = message.temperature_used, message.bpfi
        self._match(message.first_sample)

    def _match(self, first: int) -> None:
        if first not in self._waiting or first not in self._states:
            return
        samples, rate = self._waiting.pop(first)
        bpfi = self._states[first][1]
        period = max(1, min(len(samples), round(rate / bpfi) if bpfi > 0.0 else len(samples)))
        whole = len(samples) // period * period
        self._maxima[first] = np.abs(samples[:whole]).reshape(-1, period).max(axis=1)

    def by_temperature(self) -> dict[float, float]:
        """Return the amplitude, m/s^2, by the closest multiple of `STEP` in degC."""
        bars: dict[float, list[npt.NDArray[np.float64]]] = defaultdict(list)
        for first, maxima in self._maxima.items():
            temperature = self._states[first][0]
            bars[STEP * round(temperature / STEP)].append(maxima)
        return {t: mean_of_largest(np.concatenate(bars[t])) for t in sorted(bars)}

    def change(self) -> float:
        """Return the relative change from coldest to hottest third; NaN if they are too close."""
        points = [(self._states[first][0], maxima) for first, maxima in self._maxima.items()]
        temperatures = np.array([temperature for temperature, _ in points])
        if not points or np.ptp(temperatures) < STEP:
            return math.nan
        low, high = temperatures.min(), temperatures.max()
        third = (high - low) / 3.0
        cold = np.concatenate([m for t, m in points if t <= low + third])
        hot = np.concatenate([m for t, m in points if t >= high - third])
        return mean_of_largest(hot) / mean_of_largest(cold) - 1.0

    def draw(self, path: Path, preset: str) -> None:
        """Write a picture of the amplitude over temperature."""
        bars = self.by_temperature()
        figure = new_figure(f'Impact amplitude over temperature, preset {preset}')
        axes = figure.subplots()
        axes.plot(list(bars), list(bars.values()), 'o-', color=COLOURS[0])
        axes.set_ylim(0.0, 1.2 * max(bars.values(), default=1.0))
        label(
            axes,
            f'{100.0 * self.change():+.1f} % from the coldest to the hottest third; the paper '
            'states a decrease',
            TEMPERATURE_LABEL,
            'acceleration |a| / m s⁻²',
        )
        save(figure, path)
