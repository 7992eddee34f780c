# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures 9, 16, 23, 28 (waterfalls) and 10, 17, 24, 29 (peaks over temperature)."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

from bearing_twin.paper import settings
from bearing_twin.paper.figures.style import COLOURS, label, new_figure, TEMPERATURE_LABEL
from matplotlib import colormaps
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.paper.study import Study
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_COLUMNS = 900


def _outline(
    time: npt.NDArray[np.float64], values: npt.NDArray[np.float32]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float32]]:
    """Keep the smallest and largest sample of each column of the picture."""
    size = len(values) // _COLUMNS
    rows = values[: size * _COLUMNS].reshape(_COLUMNS, size)
    both = np.stack([rows.min(axis=1), rows.max(axis=1)], axis=1).ravel()
    return np.repeat(time[: size * _COLUMNS : size], 2), both


def waterfall(study: Study, *, number: int, factor: settings.Factor) -> Figure:
    """Draw the time signals at ten temperatures, and the change of the peaks at four times."""
    figure = new_figure(
        f'Figure {number}. Time-domain waterfall: {settings.FACTOR_TEXT[factor]}',
        width=13.0,
        height=8.6,
        automatic=False,  # an automatic layout leaves half of a 3-D panel empty
    )
    for column, name in enumerate(settings.PRESET_NAMES):
        _signals(figure, study, name, factor, left=0.475 * column)
        axes = figure.add_axes((0.07 + 0.49 * column, 0.07, 0.41, 0.24))
        _ratios(axes, study, name, factor)
    return figure


def _signals(
    figure: Figure, study: Study, name: str, factor: settings.Factor, left: float
) -> None:
    """Draw the waterfall of one preset, with a line through the peaks at each peak time."""
    axes: Any = figure.add_axes((left, 0.33, 0.475, 0.6), projection='3d')
    # A background would hide the axis label of the panel on the left.
    axes.patch.set_visible(False)
    nodes = settings.TEMPERATURE_NODES
    points = study.trends[name, factor]
    top = 0.0
    for temperature, point in reversed(list(zip(nodes, points, strict=True))):
        time, values = _outline(point.time, point.acceleration - point.acceleration.mean())
        fraction = (temperature - nodes[0]) / (nodes[-1] - nodes[0])
        axes.plot(
            time, np.full(len(time), temperature), values,
            color=colormaps['plasma'](0.02 + 0.86 * fraction), linewidth=0.35,
        )  # fmt: skip
        top = max(top, float(np.abs(values).max()))
    for k, instant in enumerate(settings.PEAK_TIMES):
        heights = [point.peak_heights[k] for point in points]
        axes.plot(
            np.full(len(nodes), instant), nodes, heights, 'o-',
            color=COLOURS[k], linewidth=1.2, markersize=2.5, zorder=10,
        )  # fmt: skip
    axes.set_xlim(0.0, settings.DURATION)
    axes.set_ylim(nodes[0], nodes[-1])
    axes.set_zlim(-1.25 * top, 1.25 * top)
    axes.set_yticks(nodes[::3])
    axes.set_xlabel('time t / s', labelpad=9)
    axes.set_ylabel(TEMPERATURE_LABEL, labelpad=9)
    axes.set_zlabel('acceleration a / m s⁻²', labelpad=2)
    axes.view_init(elev=32, azim=-66)
    axes.set_box_aspect((1.7, 1.5, 0.62), zoom=1.09)
    change = 100.0 * study.change(name, factor)
    axes.set_title(
        f'{name}: impact amplitude {change:+.1f} % from 20 to 110 °C', fontsize=10, pad=0
    )
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.pane.set_facecolor((0.97, 0.97, 0.97, 1.0))


def _ratios(axes: Axes, study: Study, name: str, factor: settings.Factor) -> None:
    """Draw the change of the four peaks and of the amplitude from 20 degC on, %."""
    nodes = settings.TEMPERATURE_NODES
    heights = np.array([point.peak_heights for point in study.trends[name, factor]])
    for k, instant in enumerate(settings.PEAK_TIMES):
        axes.plot(
            nodes, 100.0 * (heights[:, k] / heights[0, k] - 1.0), 'o-', color=COLOURS[k],
            markersize=3.5, linewidth=1.2, label=f'peak at {instant} s',
        )  # fmt: skip
    amplitudes = study.amplitudes(name, factor)
    axes.plot(
        nodes, 100.0 * (amplitudes / amplitudes[0] - 1.0), 's--', color='black', markersize=3.5,
        linewidth=1.2, label='impact amplitude A',
    )  # fmt: skip
    axes.axhline(0.0, color='black', linewidth=0.6)
    label(axes, 'ratio to 20 °C', TEMPERATURE_LABEL, 'change of the peak / %')
    axes.set_xticks(nodes)
    axes.legend(fontsize=7, ncols=2, frameon=False)


def peaks(study: Study, *, number: int, factor: settings.Factor) -> Figure:
    """Draw the heights of the four peaks and the impact amplitude over temperature."""
    figure = new_figure(
        f'Figure {number}. Peak acceleration over temperature: {settings.FACTOR_TEXT[factor]}'
    )
    nodes = settings.TEMPERATURE_NODES
    for axes, name in zip(figure.subplots(1, 2), settings.PRESET_NAMES, strict=True):
        heights = np.array([point.peak_heights for point in study.trends[name, factor]])
        for k, instant in enumerate(settings.PEAK_TIMES):
            axes.plot(
                nodes, heights[:, k], 'o-', color=COLOURS[k], markersize=4, linewidth=1.3,
                label=f't = {instant} s',
            )  # fmt: skip
        axes.plot(
            nodes, study.amplitudes(name, factor), 's--', color='black', markersize=4,
            linewidth=1.3, label='impact amplitude A',
        )  # fmt: skip
        change = 100.0 * study.change(name, factor)
        label(axes, f'{name}: A {change:+.1f} %', TEMPERATURE_LABEL, 'acceleration |a| / m s⁻²')
        axes.set_xticks(nodes)
        low, high = axes.get_ylim()
        axes.set_ylim(low, high + 0.28 * (high - low))
        axes.legend(fontsize=8, ncols=3, frameon=False, loc='upper center')
    return figure
