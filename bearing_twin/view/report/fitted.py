# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of machine and fitted twin: spectra, one revolution, and their difference."""

from __future__ import annotations

from collections.abc import Iterable
import re
from typing import Any, TYPE_CHECKING

from bearing_twin.view.report.svg import WIDTH
from bearing_twin.view.verdict import pretty
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.view.report.data import Machine
    from matplotlib.axes import Axes


MACHINE: dict[str, Any] = {'color': '#bdbdbd', 'label': 'machine', 'linewidth': 2.4}
TWIN: dict[str, Any] = {'color': '#1565c0', 'label': 'twin', 'linewidth': 0.7}
"""The twin's line is drawn over the machine's and is thinner, so that both are seen."""


def fitted_figure(machine: Machine) -> tuple[str, Figure] | None:
    """Draw spectrum and one revolution of the newest calibration that has them."""
    found = [m for _, m in machine.calibrations if len(m.measured_turn)]
    if not found:
        return None
    message = found[-1]
    figure = Figure(figsize=(WIDTH, 2.2), layout='constrained')
    spectra = message.measured_spectrum, message.twin_spectrum
    turns = message.measured_turn, message.twin_turn
    steps = message.spectrum_step, 1.0 / message.turn_rate
    draw_comparison(figure.subplots(1, 2), spectra, turns, steps, message.unit)
    return (
        f'Machine and fitted twin: {message.distance:.1f} dB apart in the spectrum (not fitted '
        f'{message.distance_before:.1f} dB). The twin is shown at the angle where it is most '
        'like the machine; single impacts differ, since slip is chance',
        figure,
    )


def draw_comparison(
    axes: Iterable[Axes], spectra: Any, turns: Any, steps: tuple[float, float], unit: str
) -> None:
    """Draw spectra in dB and one revolution of machine and twin, with ``steps`` in Hz and s."""
    (left, right), unit = axes, pretty(unit)
    for levels, turn, look in zip(spectra, turns, (MACHINE, TWIN), strict=True):
        left.plot(1e-3 * steps[0] * np.arange(1, len(levels)), levels[1:], **look)
        right.plot(1e3 * steps[1] * np.arange(len(turn)), turn, **look)
    left.set(title=f'power density [dB re 1 ({unit})²/Hz]', xlabel='frequency [kHz]')
    right.set(title=f'one revolution [{unit}]', xlabel='time [ms]')
    right.legend(ncols=2, loc='lower right', bbox_to_anchor=(1.0, 1.0))


def explained(machine: Machine) -> tuple[str, Figure] | None:
    """Draw the third octaves of machine and twin over each other, their difference below."""
    if not machine.calibrations:
        return None
    message = machine.calibrations[-1][1]
    bands = [n for n, name in enumerate(message.band) if re.fullmatch(r'\d+ Hz', name)]
    if not bands:
        return None
    hertz = np.array([float(message.band[n].split()[0]) for n in bands])
    measured, twin = (
        np.array(levels, dtype=float)[bands]
        for levels in (message.measured_level, message.twin_level)
    )
    figure = Figure(figsize=(WIDTH, 2.6), layout='constrained')
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    above.step(hertz, measured, where='mid', color='#424242', label='machine')
    above.step(hertz, twin, where='mid', color='#1565c0', label='twin', linewidth=1.1)
    above.set_title('third octaves [dB]')
    above.legend(loc='upper left', ncols=2)
    below.bar(hertz, measured - twin, width=0.2 * hertz, color='#c62828')
    below.set_title('machine over twin [dB]')
    below.set_xscale('log')
    below.xaxis.set_major_formatter('{x:g}')
    below.xaxis.set_minor_formatter(NullFormatter())
    below.set_xlabel('frequency [Hz]')
    caption = (
        'Third octaves of the machine, and of its twin: that of the healthy machine as soon as '
        f'there is one; {message.residual_reason}'
    )
    return caption, figure
