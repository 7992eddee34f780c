# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures 6 to 8, 13 to 15, 20 to 22 and 27: the static force over temperature."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import load_deflection_factor
from bearing_twin.paper import equations, settings
from bearing_twin.paper.figures_style import COLOURS, label, new_figure, TEMPERATURE_LABEL
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.paper.study import Study
    from matplotlib.figure import Figure


FloatArray = npt.NDArray[np.float64]


def unit_force() -> float:
    """``K_b0 approach^1.5``, the force without spall and temperature, N."""
    return float(load_deflection_factor(settings.BEARING) * settings.APPROACH**1.5)


def _beta(factor: settings.Factor) -> FloatArray:
    return np.array([equations.beta0(factor, t) for t in settings.TEMPERATURE_NODES])


def _note(force: FloatArray, beta: FloatArray) -> str:
    """Say how the force goes with beta0, from the curve itself."""
    _, rows = np.unique(beta, return_index=True)
    slopes = np.diff(force[rows])
    if np.all(slopes < 0.0):
        return 'falls with β₀'
    return 'rises with β₀' if np.all(slopes > 0.0) else 'not monotonic in β₀'


def _draw(title: str, text: str, curves: dict[str, FloatArray], notes: dict[str, str]) -> Figure:
    figure = new_figure(title)
    panels = figure.subplots(1, 2)
    for axes, (name, force), colour in zip(panels, curves.items(), COLOURS[:2], strict=True):
        axes.plot(settings.TEMPERATURE_NODES, force, 'o-', color=colour, linewidth=1.8)
        change = 100.0 * (force[-1] / force[0] - 1.0)
        axes.text(
            0.97, 0.06 if change > 0.0 else 0.94, f'{change:+.2f} %', transform=axes.transAxes,
            ha='right', va='center', color=colour,
        )  # fmt: skip
        axes.margins(y=0.15)
        label(axes, f'{name.replace("approach", "δ")}  ({notes[name]})', TEMPERATURE_LABEL, text)
        axes.set_xticks(settings.TEMPERATURE_NODES)
    return figure


def _title(number: int, what: str, factor: settings.Factor) -> str:
    return f'Figure {number}. {what}: {settings.FACTOR_TEXT[factor]}'


def single_stiffness(_: Study, *, number: int, factor: settings.Factor) -> Figure:
    """Draw figure 6, 13 or 20: F_x with beta0 on K_b alone, cos(theta) = sin(theta)."""
    scale, beta = unit_force() * math.sqrt(0.5), _beta(factor)
    curves = {
        name: scale * equations.static_force(beta, 1.0, ratio)
        for name, ratio in settings.FORMULA_RATIOS.items()
    }
    notes = {name: _note(force, beta) for name, force in curves.items()}
    return _draw(_title(number, 'F_x, stiffness K_b alone', factor), 'F_x / N', curves, notes)


def single_damping(_: Study, *, number: int, factor: settings.Factor) -> Figure:
    """Draw figure 7, 14 or 21: F_x with beta0 on C_d alone, cos(theta) = sin(theta)."""
    scale, beta = unit_force() * math.sqrt(0.5), _beta(factor)
    curves = {
        name: scale * equations.static_force(1.0, beta, ratio)
        for name, ratio in settings.FORMULA_RATIOS.items()
    }
    notes = {name: _note(force, beta) for name, force in curves.items()}
    return _draw(_title(number, "F_x, 'damping' C_d alone", factor), 'F_x / N', curves, notes)


def resultant(_: Study, *, number: int, factor: settings.Factor) -> Figure:
    """Draw figure 8, 15, 22 or 27: F = sqrt(F_x^2 + F_y^2), beta0 on both."""
    beta, component = _beta(factor), unit_force() * math.sqrt(0.5)
    curves = {}
    for name, ratio in settings.FORMULA_RATIOS.items():
        f_x = component * equations.static_force(beta, beta, ratio)
        curves[name] = np.hypot(f_x, f_x)
    notes = {name: _note(force, beta) for name, force in curves.items()}
    return _draw(_title(number, 'Resultant force F', factor), 'F / N', curves, notes)
