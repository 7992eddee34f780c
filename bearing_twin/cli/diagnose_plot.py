# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Picture of a diagnosis: spectrum and envelope spectrum with the fault cursors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.bearing import PLACES
from matplotlib.figure import Figure
import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    from bearing_twin.diagnosis import Diagnosis, Spectrum
    from matplotlib.axes import Axes

__all__ = ['draw']

_COLOURS = {'inner': 'tab:red', 'outer': 'tab:blue', 'ball': 'tab:green', 'cage': 'tab:purple'}
_HARMONICS = 4


def draw(diagnosis: Diagnosis, path: Path, *, title: str) -> None:
    """Write the picture of a diagnosis to ``path`` (PNG)."""
    figure = Figure(figsize=(11, 7), layout='constrained')
    upper, lower = figure.subplots(2, 1)
    faults = ', '.join(diagnosis.faults) or diagnosis.result
    figure.suptitle(f'{title}: {faults} [{diagnosis.level}]')
    _curve(upper, diagnosis.spectrum)
    upper.set_ylabel(f'amplitude {diagnosis.spectrum.unit}'.strip())
    _curve(lower, diagnosis.envelope_spectrum)
    low, high = diagnosis.envelope_spectrum.band
    lower.set_ylabel(f'squared envelope, {low / 1e3:.2f} to {high / 1e3:.2f} kHz')
    lower.set_xlabel('frequency, Hz')
    _cursors(lower, diagnosis)
    figure.savefig(path, dpi=110)


def _curve(axes: Axes, spectrum: Spectrum) -> None:
    hertz = spectrum.start_hz + spectrum.bin_hz * np.arange(len(spectrum.values))
    axes.semilogy(hertz, np.maximum(spectrum.values, 1e-20), linewidth=0.6, color='0.25')
    if len(spectrum.floor):
        axes.semilogy(hertz, spectrum.floor, linewidth=1.0, color='tab:orange', label='floor')
    positive = spectrum.values[spectrum.values > 0.0]
    if len(positive):
        axes.set_ylim(bottom=float(np.quantile(positive, 0.02)))
    axes.set_xlim(hertz[0], hertz[-1])
    axes.grid(visible=True, alpha=0.3)


def _cursors(axes: Axes, diagnosis: Diagnosis) -> None:
    for name in PLACES:
        hertz = diagnosis.expected.impacts(name)
        named = name in diagnosis.faults
        if named:
            hertz *= (
                diagnosis.fault_hz / diagnosis.fault_hz_expected
                if name == diagnosis.faults[0]
                else 1.0
            )
        for harmonic in range(1, _HARMONICS + 1):
            axes.axvline(
                harmonic * hertz,
                color=_COLOURS[name],
                linewidth=1.2 if named else 0.7,
                linestyle='-' if named else ':',
                label=f'{name} {hertz:.2f} Hz' if harmonic == 1 else None,
            )
    for harmonic in range(1, _HARMONICS + 1):
        label = f'shaft {diagnosis.shaft_hz:.2f} Hz' if harmonic == 1 else None
        axes.axvline(
            harmonic * diagnosis.shaft_hz, color='0.6', linewidth=0.7, linestyle='--', label=label
        )
    axes.legend(loc='upper right', fontsize='small')
