# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Spectra of a report, with the frequencies at which each defect would show."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

from bearing_twin.view.report.svg import BINS, FAMILY_COLOURS, FAMILY_LABELS, pretty, WIDTH
from bearing_twin.view.rerun.spectra import cursors, HARMONICS
from matplotlib.figure import Figure
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.view.report.data import Machine
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ['cursor_lines', 'envelope_spectrum', 'spectrum']


def cursor_lines(message: Any, harmonics: int = HARMONICS) -> list[tuple[str, float, bool]]:
    """
    Return where the defects strike as (family, frequency in Hz, whether it is a sideband).

    Those of the viewer (`view.rerun.spectra.cursors`) and the shaft's harmonics.
    """
    lines: list[tuple[str, float, bool]] = []
    if message.shaft_hz > 0.0:
        lines += [('shaft', k * message.shaft_hz, False) for k in range(1, harmonics + 1)]
    for family, places in cursors(message, harmonics=harmonics).items():
        lines += [(family, frequency, height < 1.0) for frequency, height in places]
    return lines


def _pooled(
    frequencies: NDArray[np.float64], values: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return at most BINS points, each the highest of its neighbours and where that lies."""
    group = -(-values.size // BINS)
    if group == 1:
        return frequencies, values
    edges = np.arange(0, values.size, group)
    places = [k + int(np.argmax(values[k : k + group])) for k in edges]
    return frequencies[places], values[places]


def _axis_of(message: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    values = np.nan_to_num(np.asarray(message.values, dtype=np.float64))
    return message.start_hz + np.arange(values.size) * message.bin_hz, values


def envelope_spectrum(machine: Machine) -> tuple[str, Figure] | None:
    """Return caption and picture of the squared envelope spectrum with cursors."""
    message = machine.spectra.get('squared_envelope_spectrum')
    if message is None:
        return None
    frequencies, values = _axis_of(message)
    lines = cursor_lines(message)
    main = [f for _, f, sideband in lines if not sideband]
    top = min(1.04 * max(main), frequencies[-1]) if main else frequencies[-1]
    keep = frequencies <= top
    figure = Figure(figsize=(WIDTH, 2.9), layout='constrained')
    axes = figure.subplots()
    height = 1.3 * float(values[keep].max(initial=0.0)) or 1.0
    _cursors(axes, [line for line in lines if 0.0 < line[1] <= top], height)
    axes.plot(*_pooled(frequencies[keep], values[keep]), color='#212121', linewidth=0.8)
    floor = np.asarray(message.floor, dtype=np.float64)
    if floor.size == values.size:
        axes.plot(frequencies[keep], floor[keep], color='#9e9e9e', linewidth=0.8)
    unit = '' if message.unit in ('', '1') else f' [{message.unit}]'
    axes.set(
        xlim=(0.0, top), ylim=(0.0, height), xlabel='frequency [Hz]',
        ylabel=f'squared envelope{unit}',
    )  # fmt: skip
    axes.grid(axis='x', visible=False)
    caption = (
        'Squared envelope spectrum of the band '
        f'{message.band_low:.0f} to {message.band_high:.0f} Hz with the expected frequencies of '
        f'each defect (solid, {HARMONICS} harmonics) and their sidebands (dotted); shaft '
        f'{message.shaft_hz:.2f} Hz. Grey: local noise floor'
    )
    return caption, figure


def _cursors(axes: Axes, lines: list[tuple[str, float, bool]], height: float) -> None:
    numbers = dict.fromkeys(FAMILY_LABELS, 0)
    for family, frequency, sideband in lines:
        axes.vlines(
            frequency,
            0.0,
            height * (0.45 if sideband else 0.86),
            colors=FAMILY_COLOURS[family],
            linestyles='dotted' if sideband else 'solid',
            linewidth=0.8,
            alpha=0.8,
        )
        if sideband:
            continue
        numbers[family] += 1
        order = numbers[family]
        # Cage and shaft harmonics stand close: only the first of them is named.
        if family in ('cage', 'shaft') and order > 1:
            continue
        label = FAMILY_LABELS[family] if order == 1 else f'{order}×'
        axes.text(
            frequency,
            height * (0.88 + 0.05 * (tuple(FAMILY_LABELS).index(family) % 2)),
            label,
            color=FAMILY_COLOURS[family],
            fontsize=7.5,
            ha='center',
        )


def spectrum(machine: Machine) -> tuple[str, Figure] | None:
    """Return caption and picture of the amplitude spectrum with the demodulated band."""
    message = machine.spectra.get('spectrum')
    if message is None:
        return None
    frequencies, values = _pooled(*_axis_of(message))
    figure = Figure(figsize=(WIDTH, 2.3), layout='constrained')
    axes = figure.subplots()
    peak = float(values.max(initial=0.0)) or 1.0
    axes.semilogy(
        frequencies / 1e3, np.maximum(values, 1e-9 * peak), color='#37474f', linewidth=0.6
    )
    envelope = machine.spectra.get('squared_envelope_spectrum')
    if envelope is not None and envelope.band_high > envelope.band_low:
        axes.axvspan(
            envelope.band_low / 1e3, envelope.band_high / 1e3, color='#ffb300', alpha=0.2,
            linewidth=0,
        )  # fmt: skip
        caption = 'Amplitude spectrum; shaded: the band that was demodulated'
    else:
        caption = 'Amplitude spectrum'
    floor = max(float(np.median(values)) / 30.0, 1e-6 * peak)
    axes.set(
        xlim=(frequencies[0] / 1e3, frequencies[-1] / 1e3), ylim=(floor, 2.0 * peak),
        xlabel='frequency [kHz]', ylabel=pretty(message.unit),
    )  # fmt: skip
    return caption, figure
