# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures 5, 12 and 19: the material tables over temperature."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.paper.figures.style import COLOURS, label, new_figure, TEMPERATURE_LABEL
from bearing_twin.thermal import gcr15

if TYPE_CHECKING:
    from bearing_twin.paper.study import Study
    from matplotlib.figure import Figure


TABLES = {
    5: (
        'Instantaneous thermal expansion coefficient (table 1)', gcr15.EXPANSION_TABLE,
        'α / 10⁻⁵ K⁻¹ (printed: 10⁵ K⁻¹)', COLOURS[1],
    ),
    12: ('Hardness (table 2)', gcr15.HARDNESS_TABLE, 'hardness H / HRC', COLOURS[0]),
    19: (
        'Average friction coefficient (table 3)', gcr15.FRICTION_TABLE,
        'friction coefficient µ / 1', COLOURS[2],
    ),
}  # fmt: skip
"""Title, values, axis label and colour by the number of the figure."""


def table(_: Study, *, number: int) -> Figure:
    """Draw figure 5, 12 or 19."""
    title, values, text, colour = TABLES[number]
    figure = new_figure(f'Figure {number}. {title}', width=7.0, height=4.2)
    axes = figure.add_subplot()
    axes.plot(gcr15.TEMPERATURES, values, 'o-', color=colour, linewidth=1.8, markersize=6)
    span = values.max() - values.min()
    for temperature, value in zip(gcr15.TEMPERATURES, values, strict=True):
        axes.annotate(
            f'{value:g}', (temperature, value), xytext=(0, 7), textcoords='offset points',
            ha='center', fontsize=8, bbox={'facecolor': 'white', 'edgecolor': 'none', 'pad': 0.6},
        )  # fmt: skip
    axes.set_ylim(values.min() - 0.08 * span, values.max() + 0.14 * span)
    axes.set_xticks(gcr15.TEMPERATURES)
    label(axes, '', TEMPERATURE_LABEL, text)
    return figure
