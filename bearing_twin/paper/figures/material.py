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


def _table(title: str, values: gcr15.FloatArray, text: str, colour: str) -> Figure:
    figure = new_figure(title, width=7.0, height=4.2)
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


def expansion(_: Study) -> Figure:
    """Draw figure 5."""
    return _table(
        'Figure 5. Instantaneous thermal expansion coefficient (table 1)',
        gcr15.EXPANSION_TABLE,
        'α / 10⁻⁵ K⁻¹ (printed: 10⁵ K⁻¹)',
        COLOURS[1],
    )


def hardness(_: Study) -> Figure:
    """Draw figure 12."""
    return _table(
        'Figure 12. Hardness (table 2)', gcr15.HARDNESS_TABLE, 'hardness H / HRC', COLOURS[0]
    )


def friction(_: Study) -> Figure:
    """Draw figure 19."""
    return _table(
        'Figure 19. Average friction coefficient (table 3)',
        gcr15.FRICTION_TABLE,
        'friction coefficient µ / 1',
        COLOURS[2],
    )
