# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures 6 to 8, 13 to 15, 20 to 22 and 27: the static force over temperature."""

from __future__ import annotations

from collections.abc import Callable
import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import load_deflection_factor
from bearing_twin.paper import equations, settings
from bearing_twin.paper.figures.style import COLOURS, label, new_figure, TEMPERATURE_LABEL
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.paper.study import Study
    from matplotlib.figure import Figure


FloatArray = npt.NDArray[np.float64]


def unit_force() -> float:
    """``K_b0 approach^1.5``, the force without spall and temperature, N."""
    return float(load_deflection_factor(settings.BEARING) * settings.APPROACH**1.5)


def _note(force: FloatArray, beta: FloatArray) -> str:
    """Return in words how the force depends on beta0, from the curve itself."""
    _, rows = np.unique(beta, return_index=True)
    slopes = np.diff(force[rows])
    if np.all(slopes < 0.0):
        return 'falls with β₀'
    return 'rises with β₀' if np.all(slopes > 0.0) else 'not monotonic in β₀'


def _draw(
    title: str, text: str, force: Callable[[FloatArray, float], FloatArray], number: int,
    factor: settings.Factor,
) -> Figure:  # fmt: skip
    """Draw ``force(beta0, C_d0/approach)``, N, one panel per ratio."""
    figure = new_figure(f'Figure {number}. {title}: {settings.FACTOR_TEXT[factor]}')
    beta = np.array([equations.beta0(factor, t) for t in settings.TEMPERATURE_NODES])
    panels = figure.subplots(1, 2)
    ratios = settings.FORMULA_RATIOS.items()
    for axes, (name, ratio), colour in zip(panels, ratios, COLOURS[:2], strict=True):
        curve = force(beta, ratio)
        axes.plot(settings.TEMPERATURE_NODES, curve, 'o-', color=colour, linewidth=1.8)
        change = 100.0 * (curve[-1] / curve[0] - 1.0)
        axes.text(
            0.97, 0.06 if change > 0.0 else 0.94, f'{change:+.2f} %', transform=axes.transAxes,
            ha='right', va='center', color=colour,
        )  # fmt: skip
        axes.margins(y=0.15)
        note = _note(curve, beta)
        label(axes, f'{name.replace("approach", "δ")}  ({note})', TEMPERATURE_LABEL, text)
        axes.set_xticks(settings.TEMPERATURE_NODES)
    return figure


def _component(
    beta_stiffness: FloatArray | float, beta_depth: FloatArray | float, ratio: float
) -> FloatArray:
    """F_x at cos(theta) = sin(theta), N."""
    scale = unit_force() * math.sqrt(0.5)
    return scale * equations.static_force(beta_stiffness, beta_depth, ratio)


def single_stiffness(_: Study, *, number: int, factor: settings.Factor) -> Figure:
    """Draw figure 6, 13 or 20: F_x with beta0 on K_b alone, cos(theta) = sin(theta)."""
    return _draw(
        'F_x, stiffness K_b alone', 'F_x / N', lambda beta, ratio: _component(beta, 1.0, ratio),
        number, factor,
    )  # fmt: skip


def single_damping(_: Study, *, number: int, factor: settings.Factor) -> Figure:
    """Draw figure 7, 14 or 21: F_x with beta0 on C_d alone, cos(theta) = sin(theta)."""
    return _draw(
        "F_x, 'damping' C_d alone", 'F_x / N', lambda beta, ratio: _component(1.0, beta, ratio),
        number, factor,
    )  # fmt: skip


def resultant(_: Study, *, number: int, factor: settings.Factor) -> Figure:
    """Draw figure 8, 15, 22 or 27: F = sqrt(F_x^2 + F_y^2), beta0 on both."""
    return _draw(
        'Resultant force F', 'F / N',
        lambda beta, ratio: math.sqrt(2.0) * _component(beta, beta, ratio), number, factor,
    )  # fmt: skip
