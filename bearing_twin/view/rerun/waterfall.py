# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Time-domain waterfall over temperature, as in the paper's figures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.view.style import LINE
from bearing_twin.view.verdict import pretty
import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Canvas
    from numpy.typing import NDArray

__all__ = ['Waterfall']

STEP = 5.0
"""Distance between two strips, K."""
SECONDS = 0.12
"""Length of a strip: three turns at 25 Hz, s."""
POINTS = 600
COLD, HOT = 20.0, 110.0
WIDTH, DEPTH, HEIGHT = 10.0, 9.0, 1.6


class Waterfall:
    """
    Keep one short piece of the waveform for every 5 K and draw them one behind the other.

    The scale holds their peak, at least ``peak``.
    """

    def __init__(self, canvas: Canvas, name: str, peak: float) -> None:
        self._canvas = canvas
        self._name = name
        self._parts: list[NDArray[np.float64]] = []
        self._peak, self._scale = peak, 0.0
        self._strips: dict[int, NDArray[np.float64]] = {}
        self._wanted: int | None = None

    def add(
        self,
        samples: NDArray[np.float64],
        time: int,
        rate: float,
        temperature: float,
        unit: str,
    ) -> None:
        """Take samples of the temperature in degC; nothing is drawn where that is unknown."""
        if not np.isfinite(temperature):
            return
        step = round(temperature / STEP)
        if step != self._wanted:
            self._wanted, self._parts = step, []
        elif not self._parts:
            return
        self._parts.append(samples)
        length = round(SECONDS * rate)
        if sum(part.size for part in self._parts) < length:
            return
        strip = np.concatenate(self._parts)[:length]
        self._parts = []
        group = max(1, length // (POINTS // 2))
        edges = np.arange(0, length, group)
        pairs = np.stack([np.minimum.reduceat(strip, edges), np.maximum.reduceat(strip, edges)])
        self._strips[step] = pairs.T.ravel()
        self._draw(time, unit)

    def _draw(self, time: int, unit: str) -> None:
        peak = max(self._peak, *(float(np.abs(s).max()) for s in self._strips.values()))
        scale = 10.0 ** np.ceil(np.log10(max(peak, 1e-12)))
        scale = next(s for s in (scale / 5.0, scale / 2.0, scale) if s >= peak)
        lines, colours = [], []
        for step, strip in sorted(self._strips.items()):
            x = np.linspace(0.0, WIDTH, strip.size)
            y = np.full(strip.size, _depth(step * STEP))
            lines.append(np.stack([x, y, strip / scale * HEIGHT], axis=1))
            colours.append(_colour(step * STEP))
        self._canvas.put(
            self._name,
            time,
            rr.LineStrips3D(lines, colors=colours, radii=rr.Radius.ui_points(1.0)),
        )
        if scale != self._scale:
            self._scale = scale
            self._axes(time, scale, unit)

    def _axes(self, time: int, scale: float, unit: str) -> None:
        ticks = np.arange(COLD, HOT + 1.0, 30.0)
        places = [[WIDTH * 1.06, _depth(t), 0.0] for t in ticks]
        labels = [f'{t:g} °C' for t in ticks]
        for part in (0.0, 0.5, 1.0):
            places.append([WIDTH * part, -0.9, 0.0])
            labels.append(f'{part * SECONDS * 1e3:g} ms')
        places += [[-0.3, 0.0, HEIGHT], [-0.3, 0.0, -HEIGHT]]
        labels += [f'{scale:g} {pretty(unit)}', f'-{scale:g} {pretty(unit)}']
        self._canvas.put(
            f'{self._name}/labels',
            time,
            rr.Points3D(
                places,
                labels=labels,
                colors=LINE['ground'],
                radii=rr.Radius.ui_points(0.5),
                show_labels=True,
            ),
        )
        corners = np.array([[0, 0, 0], [WIDTH, 0, 0], [WIDTH, DEPTH, 0], [0, DEPTH, 0], [0, 0, 0]])
        self._canvas.put(
            f'{self._name}/frame',
            time,
            rr.LineStrips3D(
                [corners, np.array([[0, 0, -HEIGHT], [0, 0, HEIGHT]])],
                colors=LINE['ground'],
                radii=rr.Radius.ui_points(0.7),
            ),
        )


def _depth(temperature: float) -> float:
    return (temperature - COLD) / (HOT - COLD) * DEPTH


def _colour(temperature: float) -> tuple[int, int, int]:
    """Return blue for cold over violet to red for hot."""
    part = float(np.clip((temperature - COLD) / (HOT - COLD), 0.0, 1.0))
    return round(60 + 180 * part), round(110 - 50 * part), round(230 - 180 * part)
