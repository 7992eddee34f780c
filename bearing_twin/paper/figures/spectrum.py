# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures 4, 30 and 32: signal and spectra, and the line f_in without and with temperature."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.paper import settings
from bearing_twin.paper.figures.style import COLOURS, label, new_figure

if TYPE_CHECKING:
    from bearing_twin.paper.study import FrequencyPoint, Study
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_FREQUENCY = 'frequency f / Hz'
_HARMONICS = 3


def _envelope(axes: Axes, point: FrequencyPoint, title: str) -> None:
    frequency, values = point.envelope
    shown = frequency <= 450.0
    axes.plot(frequency[shown], values[shown], color=COLOURS[0], linewidth=0.9)
    top = float(values[shown].max())
    for order in range(1, _HARMONICS + 1):
        line = order * point.prescribed
        axes.axvline(line, color=COLOURS[1], linewidth=0.8, linestyle=':')
        name = 'f_in' if order == 1 else f'{order} f_in'
        axes.annotate(
            name, (line, top), xytext=(3, -2), textcoords='offset points', fontsize=8,
            color=COLOURS[1],
        )  # fmt: skip
    axes.set_xlim(0.0, 450.0)
    axes.set_ylim(0.0, 1.08 * top)
    label(axes, title, _FREQUENCY, 'envelope / m s⁻²')


def signal(study: Study) -> Figure:
    """Draw figure 4: signal, spectrum and envelope spectrum without temperature."""
    figure = new_figure(
        "Figure 4. Inner-ring fault without temperature, preset 'paper'", height=7.2
    )
    first, second, third = figure.subplots(3, 1)
    trend = study.trends['paper', 'expansion'][0]
    acceleration = trend.acceleration - trend.acceleration.mean()
    first.plot(trend.time, acceleration, color=COLOURS[0], linewidth=0.5)
    first.set_xlim(0.0, settings.DURATION)
    for instant in settings.PEAK_TIMES:
        first.axvline(instant, color=COLOURS[1], linewidth=0.8, linestyle=':')
    label(first, "housing acceleration; dotted: the paper's peak times", 'time t / s', 'a / m s⁻²')
    point = study.frequencies['paper', 'none', settings.COLD]
    second.plot(*point.acceleration, color=COLOURS[0], linewidth=0.8)
    second.set_xlim(0.0, 3000.0)
    second.set_ylim(bottom=0.0)
    label(second, 'spectrum of 0.7 s', _FREQUENCY, 'a / m s⁻²')
    _envelope(third, point, f'envelope spectrum of 12 s: f_in = {point.line:.3f} Hz')
    return figure


def spectrum(study: Study, *, number: int, temperature: float) -> Figure:
    """Draw figure 30 or 32: envelope spectra and a close-up of the line f_in."""
    quoted = settings.F_IN[f'fig{number}']
    figure = new_figure(
        f'Figure {number}. Envelope spectrum at {temperature:g} °C, all factors', width=12.0
    )
    wide, close = figure.subplots(1, 2, width_ratios=(1.5, 1.0))
    rigid = study.frequencies['paper', 'none', temperature]
    slipping = study.frequencies['paper', 'mu_proportional', temperature]
    _envelope(wide, rigid, "preset 'paper', the paper's equations")
    for point, name, colour in (
        (rigid, "the paper's equations", COLOURS[0]),
        (slipping, 'with cage slip s₀ µ(T)/µ₀', COLOURS[2]),
    ):
        frequency, values = point.envelope
        shown = (frequency > 125.4) & (frequency < 127.6)
        close.plot(
            frequency[shown], values[shown], '.-', color=colour, markersize=4, linewidth=1.1,
            label=f'{name}: {point.line:.3f} Hz',
        )  # fmt: skip
    close.axvline(
        quoted, color='black', linestyle='--', linewidth=1.0, label=f'paper: {quoted} Hz'
    )
    half = 0.5 / settings.DURATION
    close.axvspan(
        max(125.4, quoted - half), min(127.6, quoted + half), color='black', alpha=0.07,
        label='one bin of a 0.7 s record',
    )  # fmt: skip
    close.set_xlim(125.4, 127.6)
    close.set_xticks([125.5, 126.0, 126.5, 127.0, 127.5])
    close.set_ylim(0.0, 1.6 * close.get_ylim()[1])
    label(close, 'the line f_in, records of 12 s', _FREQUENCY, 'envelope / m s⁻²')
    close.legend(fontsize=8, framealpha=0.9, edgecolor='none', loc='upper left')
    return figure
