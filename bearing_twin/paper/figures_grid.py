# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the stated trends hold: a map that the paper does not have."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.paper.figures_style import label, new_figure
from bearing_twin.paper.study import GRID_CLEARANCES, GRID_DEPTHS, GRID_LOADS, GRID_WIDTHS
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.paper.study import Study
    from matplotlib.figure import Figure

__all__ = ['grid_map']


def grid_map(study: Study) -> Figure:
    """Draw d ln A / d ln beta0 over load and width for the largest depth and clearance."""
    figure = new_figure(
        'Map. Change of the impact amplitude A with β₀: blue falls (as the paper states), red '
        'rises',
        width=13.0,
    )
    shape = (len(GRID_LOADS), len(GRID_WIDTHS), len(GRID_DEPTHS), len(GRID_CLEARANCES))
    slopes = study.grid.slopes.reshape(shape)
    panels = figure.subplots(1, len(GRID_DEPTHS))
    for k, (axes, depth) in enumerate(zip(panels, GRID_DEPTHS, strict=True)):
        values = slopes[:, :, k, -1]
        image = axes.imshow(values, cmap='RdBu_r', vmin=-2.0, vmax=2.0, aspect='auto')
        for row, column in np.ndindex(values.shape):
            value = values[row, column]
            axes.text(
                column, row, f'{value:+.1f}', ha='center', va='center', fontsize=7,
                color='white' if abs(value) > 1.3 else 'black',
            )  # fmt: skip
        label(
            axes,
            f'depth {depth * 1e6:g} µm, clearance {GRID_CLEARANCES[-1] * 1e6:g} µm',
            'width of the spall / mm',
            'load W / N',
        )
        axes.grid(visible=False)
        axes.set_xticks(range(len(GRID_WIDTHS)), [f'{1e3 * w:g}' for w in GRID_WIDTHS])
        axes.set_yticks(range(len(GRID_LOADS)), [f'{w:g}' for w in GRID_LOADS])
    figure.colorbar(image, ax=panels, label='d ln A / d ln β₀ / 1', shrink=0.9)
    return figure
