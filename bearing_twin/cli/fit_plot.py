# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Picture of a calibration: spectra of machine and twin, and what widths are left possible."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.calibration.fit import fitted_vibration
from bearing_twin.view.report.svg import STYLE
from bearing_twin.view.verdict import pretty
from bearing_twin.wholefile import whole_file
import matplotlib as mpl
from matplotlib.figure import Figure
import numpy as np
from scipy import signal

if TYPE_CHECKING:
    from pathlib import Path

    from bearing_twin.calibration import Calibration
    from numpy.typing import NDArray


def draw(found: Calibration, x: NDArray[np.float64], sample_rate: float, path: Path) -> None:
    """Write the picture of a calibration to ``path`` (PNG)."""
    rate = found.situation.sample_rate
    twin = fitted_vibration(found, 1.0)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11, 8), layout='constrained')
        upper, middle, lower = figure.subplots(3, 1)
        figure.suptitle(found.statement)
        unit = pretty(found.sensor_unit)
        for y, at, name in ((x - x.mean(), sample_rate, 'machine'), (twin, rate, 'twin')):
            hz, density = signal.welch(y, at, nperseg=min(len(y), int(0.04 * at)))
            upper.semilogy(hz / 1e3, density, label=name, linewidth=0.8)
            turn = y[: int(at / found.situation.shaft_hz)]
            middle.plot(1e3 * np.arange(len(turn)) / at, turn, label=name, linewidth=0.6)
        density_unit = f'power spectral density [({unit})²/Hz]'
        upper.set(xlabel='frequency [kHz]', ylabel=density_unit, xlim=(0, rate / 2e3))
        middle.set(xlabel='one revolution [ms]', ylabel=f'vibration [{unit}]')
        upper.legend()
        widths = found.candidates['defect_width_mm']
        lower.hist(widths, bins=40, weights=found.weights)
        lower.set(xlabel='width of the defect [mm]', ylabel='share of the candidates')
        with whole_file(path) as file:
            figure.savefig(file, format='png', dpi=110)
