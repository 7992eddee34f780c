# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Common look of the figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes


COLOURS = ('#1f5fa8', '#c8502d', '#3b8a4e', '#7a4fa3')
"""Blue, red, green, violet: distinct in print and for most colour-blind readers."""
TEMPERATURE_LABEL = 'temperature T / °C'
_GRID = '#d9d9d9'
_DPI = 130


def new_figure(
    title: str, *, width: float = 10.0, height: float = 4.4, automatic: bool = True
) -> Figure:
    """Return a figure, size in inches. Without pyplot, no backend of the user opens a window."""
    figure = Figure(figsize=(width, height), layout='constrained' if automatic else None)
    figure.suptitle(title, fontsize=12, fontweight='bold')
    return figure


def label(axes: Axes, title: str, x: str, y: str) -> None:
    """Put title and axis labels on a panel and give it a light grid."""
    axes.set_title(title, fontsize=10)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(color=_GRID, linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ('top', 'right'):
        axes.spines[side].set_visible(False)


def save(figure: Figure, path: Path) -> None:
    """Write a PNG."""
    figure.savefig(path, dpi=_DPI, facecolor='white')
