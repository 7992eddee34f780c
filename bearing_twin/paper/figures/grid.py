# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Map of the settings in which the stated trends hold; the paper has none."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.paper.figures.style import label, new_figure
from bearing_twin.paper.space import PATHS
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.paper.study import Study
    from matplotlib.figure import Figure


def grid_map(study: Study) -> Figure:
    """Draw the share of speeds, depths and clearances in which A falls, over load and width."""
    space = study.grid.space
    figure = new_figure(
        'Map. Share of speeds, depths and clearances in which all four stated trends hold',
        width=12.0,
    )
    panels = figure.subplots(1, len(space.profiles))
    for axes, profile, falls in zip(panels, space.profiles, study.grid.falls, strict=True):
        values = 100.0 * falls.mean(axis=(0, 3, 4))
        image = axes.imshow(values, cmap='RdBu', vmin=0.0, vmax=100.0, aspect='auto')
        for row, column in np.ndindex(values.shape):
            value = values[row, column]
            axes.text(
                column, row, f'{value:.0f}', ha='center', va='center', fontsize=8,
                color='white' if abs(value - 50.0) > 35.0 else 'black',
            )  # fmt: skip
        label(axes, PATHS[profile], 'width of the spall / mm', 'load W / N')
        axes.grid(visible=False)
        axes.set_xticks(range(len(space.widths)), [f'{1e3 * w:g}' for w in space.widths])
        axes.set_yticks(range(len(space.loads)), [f'{w:g}' for w in space.loads])
    figure.colorbar(image, ax=panels, label='share of settings / %', shrink=0.9)
    return figure
