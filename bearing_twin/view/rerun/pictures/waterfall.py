# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Time-domain waterfall over temperature, as in the paper's figures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.view.over_temperature import STEP, STRIP_SECONDS
from bearing_twin.view.spectrum import low_high
from bearing_twin.view.style import LINE
from bearing_twin.view.verdict import pretty
import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.over_temperature import Strips
    from bearing_twin.view.rerun.canvas import Canvas


POINTS = 600
COLD, HOT = 20.0, 110.0
WIDTH, DEPTH, HEIGHT = 10.0, 9.0, 1.6


class Waterfall:
    """
    Draw the waveform strips over temperature, one behind the other.

    The scale includes their peak, at least ``peak``.
    """

    def __init__(self, canvas: Canvas, name: str, peak: float) -> None:
        self._canvas = canvas
        self._name = name
        self._peak, self._scale = peak, 0.0

    def draw(self, strips: Strips, time: int, unit: str) -> None:
        """Draw the strips at ``time`` in ns."""
        swings = {step: s.samples - np.nanmean(s.samples) for step, s in sorted(strips.items())}
        # There are no strips just after the defect has changed.
        peak = max([self._peak, *(float(np.nanmax(np.abs(s))) for s in swings.values())])
        scale = 10.0 ** np.ceil(np.log10(max(peak, 1e-12)))
        scale = next(s for s in (scale / 5.0, scale / 2.0, scale) if s >= peak)
        lines, colours = [], []
        for step, swing in swings.items():
            edges = np.arange(0, swing.size, max(1, swing.size // (POINTS // 2)))
            z = low_high(swing, edges).ravel() / scale * HEIGHT
            y = np.full(z.size, _depth(step * STEP))
            lines.append(np.stack([np.linspace(0.0, WIDTH, z.size), y, z], axis=1))
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
            labels.append(f'{part * STRIP_SECONDS * 1e3:g} ms')
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
    """Return a colour from blue (cold) over violet to red (hot)."""
    part = float(np.clip((temperature - COLD) / (HOT - COLD), 0.0, 1.0))
    return round(60 + 180 * part), round(110 - 50 * part), round(230 - 180 * part)
