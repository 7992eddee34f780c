# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Spectra as the report and ``bearing-twin diagnose --plot`` draw them."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

from bearing_twin.diagnosis.thresholds import HARMONICS, INDEX_FAULT, INDEX_SUSPECT
from bearing_twin.view.report.svg import BINS, FAMILY_COLOURS
from bearing_twin.view.spectrum import highest, SpectrumPicture
from matplotlib.ticker import MaxNLocator
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.view.spectrum import Comb
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def envelope_caption(picture: SpectrumPicture) -> str:
    """Return what the marks and lines of an envelope spectrum are."""
    ticks = 'Ticks: nominal harmonics, without slip'
    if picture.found:
        ticks = f'Triangles: the {HARMONICS} harmonics found; t{ticks[1:]}'
    return (
        f'{ticks}; dots: sidebands. Grey: noise floor, and dashed what one bin of noise in a '
        'thousand passes. Red: limit of a fault, for the root of the sum of squares of its '
        'harmonics; dotted: of suspect'
    )


def draw_envelope_spectrum(figure: Figure, picture: SpectrumPicture) -> None:
    """
    Draw an envelope spectrum, and a zoom of the first harmonic found.

    The combs are rows below the frequency axis with labels at the left: they never cover a line of
    the spectrum.
    """
    # The comb found comes first.
    near, combs = picture.zoom(), sorted(picture.combs, key=lambda comb: not comb.found)
    columns = [picture.deciding(), *([near] if near is not None else [])]
    rows = 0.16 * max(len(combs), 1)
    grid = figure.subplots(
        2,
        len(columns),
        sharex='col',
        squeeze=False,
        gridspec_kw={'height_ratios': [2.2, rows], 'width_ratios': [2.6, 1.0][: len(columns)]},
    )
    for column, part in enumerate(columns):
        axes, strip = grid[:, column]
        _curve(axes, part)
        _strip(strip, combs, part, named=column == 0)
        strip.set_xlabel('frequency [Hz]')
        axes.set_xlim(part.start if column else 0.0, part.end)
    upper = grid[0, 0]
    upper.set_title(picture.title)
    upper.set_ylabel(picture.quantity)
    # The axis always includes the limit of a fault, so that a healthy spectrum stays low.
    top = 1.15 * max(float(picture.deciding().values.max(initial=0.0)), 1.05 * INDEX_FAULT)
    for axes in grid[0]:
        axes.set_ylim(0.0, top)
        for limit, dashes in ((INDEX_FAULT, (6, 3)), (INDEX_SUSPECT, (1, 2))):
            axes.axhline(limit, color='#b71c1c', linewidth=0.7, dashes=dashes)
    if near is not None:
        grid[0, 1].set_title('first harmonic, enlarged')
        grid[0, 1].xaxis.set_major_locator(MaxNLocator(3))


def draw_spectrum(axes: Axes, picture: SpectrumPicture, band: tuple[float, float]) -> None:
    """Draw an amplitude spectrum and shade the demodulated ``band`` in Hz."""
    peak = float(picture.values.max(initial=0.0)) or 1.0
    kept, _ = highest(picture.values, BINS)
    axes.semilogy(
        picture.frequencies[kept] / 1e3,
        np.maximum(picture.values[kept], 1e-9 * peak),
        color='#37474f',
        linewidth=0.6,
    )
    # Powers of ten would be written in TeX, which this style does not render.
    axes.yaxis.set_major_formatter('{x:g}')
    floor = max(float(np.median(picture.values)) / 30.0, 1e-6 * peak)
    axes.set(
        xlim=(picture.start / 1e3, picture.end / 1e3), ylim=(floor, 2.0 * peak),
        xlabel='frequency [kHz]', ylabel=picture.quantity, title=picture.title,
    )  # fmt: skip
    if band[1] > band[0]:
        axes.axvspan(band[0] / 1e3, band[1] / 1e3, color='#ffb300', alpha=0.2, linewidth=0)
        axes.annotate(
            'demodulated band', (0.5 * sum(band) / 1e3, 1.0), (0, -9),
            xycoords=('data', 'axes fraction'), textcoords='offset points', ha='center',
            fontsize='small',
        )  # fmt: skip


def _curve(axes: Axes, picture: SpectrumPicture) -> None:
    kept, _ = highest(picture.values, BINS)
    frequencies = picture.frequencies
    axes.plot(frequencies[kept], picture.values[kept], color='#212121', linewidth=0.8)
    if picture.floor.size:
        axes.plot(frequencies, picture.floor, color='#9e9e9e', linewidth=0.8)
        axes.plot(frequencies, picture.threshold, color='#616161', linewidth=0.7, dashes=(2, 2))
    axes.grid(axis='x', visible=False)
    axes.tick_params(axis='x', labelbottom=False)


def _strip(axes: Axes, combs: list[Comb], picture: SpectrumPicture, *, named: bool) -> None:
    """Draw a row for each comb."""
    look: dict[str, Any] = {'linestyle': 'none', 'clip_on': True}
    for row, comb in enumerate(combs):
        colour = FAMILY_COLOURS[comb.family]
        lines, sides = comb.harmonics(picture.end), comb.sidebands(picture.end)
        marker, size = ('^', 5.0) if comb.found else ('|', 7.0)
        axes.plot(lines, np.full(lines.size, row), marker=marker, ms=size, color=colour, **look)
        axes.plot(sides, np.full(sides.size, row), marker='.', ms=2.5, color=colour, **look)
    axes.set(ylim=(len(combs) - 0.4, -0.6), yticks=range(len(combs)))
    axes.grid(visible=False)
    axes.tick_params(axis='y', length=0)
    axes.set_yticklabels([comb.label if named else '' for comb in combs], fontsize='small')
    for label, comb in zip(axes.get_yticklabels(), combs, strict=True):
        label.set_color(FAMILY_COLOURS[comb.family])
        label.set_fontweight('bold' if comb.found else 'normal')
    axes.spines['left'].set_visible(False)
