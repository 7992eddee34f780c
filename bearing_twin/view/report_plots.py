# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The pictures of a report, as SVG to be put into a page."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from bearing_twin.view.report_data import Machine

__all__ = ['FAMILY_COLOURS', 'VERDICT_COLOURS', 'cursor_lines', 'figures']

FAMILY_COLOURS = {
    'inner': '#c62828',
    'outer': '#1565c0',
    'ball': '#e65100',
    'cage': '#7b1fa2',
    'shaft': '#78909c',
}
"""Dark enough for white paper; told apart in print by their labels too."""

FAMILY_LABELS = {
    'inner': 'BPFI',
    'outer': 'BPFO',
    'ball': '2×BSF',
    'cage': 'FTF',
    'shaft': 'shaft',
}
DEFECTS = ('inner', 'outer', 'ball', 'cage')
"""In the order of the per-family arrays of a Diagnosis."""

VERDICT_COLOURS = {
    'healthy': '#2e7d32',
    'inner': '#c62828',
    'outer': '#ad1457',
    'ball': '#e65100',
    'cage': '#7b1fa2',
    'suspect': '#f9a825',
    'ambiguous': '#b71c1c',
    'insufficient': '#757575',
}

HARMONICS = 4
BINS = 2400
"""Most points of a drawn spectrum; of neighbouring bins the highest is kept."""
STYLE: dict[Any, Any] = {
    'svg.fonttype': 'none',
    'font.family': 'sans-serif',
    'font.size': 9.0,
    'axes.spines.top': False,
    'axes.spines.right': False,
    'axes.grid': True,
    'grid.color': '#e0e0e0',
    'grid.linewidth': 0.6,
    'axes.axisbelow': True,
    'axes.titlesize': 9.0,
    'axes.titlelocation': 'left',
    'legend.frameon': False,
    'legend.fontsize': 8.0,
}
WIDTH = 7.4
"""Of every picture, inches: fits a printed A4 page."""


def figures(machine: Machine, prefix: str) -> list[tuple[str, str]]:
    """Return caption and SVG of every picture that the machine has data for.

    Parameters
    ----------
    machine
        What was collected.
    prefix
        Put before every id in the SVG, so that pictures on one page do not share them.
    """
    plots: tuple[Callable[[Machine], tuple[str, Figure] | None], ...] = (
        _history,
        _envelope_spectrum,
        _spectrum,
        _waterfall,
        _trend,
        _model,
    )
    found = []
    # The style is that of the figure being made, never that of the program around it.
    with mpl.rc_context(STYLE):
        for number, plot in enumerate(plots):
            made = plot(machine)
            if made is not None:
                caption, figure = made
                found.append((caption, _svg(figure, f'{prefix}{number}-')))
    return found


def cursor_lines(message: Any, harmonics: int = HARMONICS) -> list[tuple[str, float, bool]]:
    """Return where the defects strike as (family, frequency in Hz, whether it is a sideband).

    A defect on the inner ring passes the load zone once a turn of the shaft and one on a ball
    once a turn of the cage, so that their harmonics carry sidebands at that distance (Randall and
    Antoni, Mechanical Systems and Signal Processing 25, 2011, section 2).
    """
    families = (
        ('shaft', message.shaft_hz, 0.0),
        ('inner', message.bpfi, message.shaft_hz),
        ('outer', message.bpfo, 0.0),
        ('ball', 2.0 * message.bsf, message.ftf),
        ('cage', message.ftf, 0.0),
    )
    lines: list[tuple[str, float, bool]] = []
    for family, frequency, side in families:
        if not frequency > 0.0:
            continue
        for k in range(1, harmonics + 1):
            lines.append((family, k * frequency, False))
            if side > 0.0:
                lines.append((family, k * frequency - side, True))
                lines.append((family, k * frequency + side, True))
    return lines


def _svg(figure: Figure, prefix: str) -> str:
    """Return a figure as an SVG element whose ids all start with ``prefix``."""
    buffer = io.StringIO()
    with mpl.rc_context({'svg.hashsalt': prefix}):
        figure.savefig(buffer, format='svg', metadata={'Date': None, 'Creator': None})
    text = buffer.getvalue()
    text = text[text.index('<svg') :]
    text = re.sub(r'\bid="', f'id="{prefix}', text)
    text = text.replace('url(#', f'url(#{prefix}').replace('href="#', f'href="#{prefix}')
    return re.sub(r'<metadata>.*?</metadata>', '', text, flags=re.DOTALL)


def _pretty(unit: str) -> str:
    return str(unit).replace('^2', '²')


def _columns(pairs: Sequence[tuple[float, ...]]) -> NDArray[np.float64]:
    rows: NDArray[np.float64] = np.array(pairs, dtype=np.float64).T
    return rows


def _values(items: Sequence[tuple[float, Any]], name: str) -> NDArray[np.float64]:
    return np.array([getattr(message, name) for _, message in items], dtype=np.float64)


def _times(items: Sequence[tuple[float, Any]]) -> NDArray[np.float64]:
    return np.array([time for time, _ in items], dtype=np.float64)


def _history(machine: Machine) -> tuple[str, Figure] | None:
    panels: list[Callable[[Axes], None]] = []
    if machine.diagnoses:
        panels.append(lambda axes: _lane(axes, machine))
    if machine.measured or machine.states:
        panels.append(lambda axes: _temperature(axes, machine))
    if machine.vibration:
        panels.append(lambda axes: _level(axes, machine))
    if not panels:
        return None
    heights = [0.45 if machine.diagnoses and k == 0 else 1.0 for k in range(len(panels))]
    figure = Figure(figsize=(WIDTH, 0.5 + 1.35 * sum(heights)), layout='constrained')
    rows = figure.subplots(
        len(panels), sharex=True, squeeze=False, gridspec_kw={'height_ratios': heights}
    )[:, 0]
    for axes, panel in zip(rows, panels, strict=True):
        panel(axes)
    rows[-1].set_xlabel('time since the start of the recording [s]')
    return 'Verdict, temperature and vibration over time', figure


def _lane(axes: Axes, machine: Machine) -> None:
    times = _times(machine.diagnoses)
    # A verdict holds until the next; the last one as long as they usually do.
    usual = float(np.median(np.diff(times))) if times.size > 1 else 1.0
    ends = np.append(times[1:], times[-1] + usual)
    names = [str(message.result_name) for _, message in machine.diagnoses]
    changes = [k for k in range(len(names)) if k == 0 or names[k] != names[k - 1]]
    seen: dict[str, Rectangle] = {}
    for first, after in zip(changes, [*changes[1:], len(names)], strict=True):
        colour = VERDICT_COLOURS.get(names[first], VERDICT_COLOURS['insufficient'])
        begin = times[first]
        patch = Rectangle(
            (begin, 0.0), ends[after - 1] - begin, 1.0, facecolor=colour, linewidth=0.0
        )
        axes.add_patch(patch)
        seen.setdefault(names[first], patch)
    axes.set(ylim=(0.0, 1.0), yticks=[], title='verdict')
    axes.grid(visible=False)
    axes.autoscale_view(scaley=False)
    axes.legend(seen.values(), seen, ncols=len(seen), loc='lower right', bbox_to_anchor=(1.0, 1.0))


def _temperature(axes: Axes, machine: Machine) -> None:
    if machine.measured:
        time, measured = _columns(machine.measured)
        axes.plot(time, measured, color='#c62828', linewidth=1.2, label='measured')
    if machine.states:
        used = _values(machine.states, 'temperature_used')
        axes.plot(
            _times(machine.states), used, color='#1565c0', linewidth=1.0, dashes=(4, 2),
            label='used by the twin',
        )  # fmt: skip
    axes.set_ylabel('°C')
    axes.set_title('bearing temperature')
    axes.legend(ncols=2, loc='lower right', bbox_to_anchor=(1.0, 1.0))


def _level(axes: Axes, machine: Machine) -> None:
    time, rms, peak = _thinned(_columns(machine.vibration))
    axes.plot(time, peak, color='#90a4ae', linewidth=0.7, label='peak')
    axes.plot(time, rms, color='#1565c0', linewidth=1.2, label='rms')
    axes.set_ylabel(_pretty(machine.unit))
    axes.set_ylim(bottom=0.0)
    axes.set_title('vibration, block by block')
    axes.legend(ncols=2, loc='lower right', bbox_to_anchor=(1.0, 1.0))


def _thinned(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return at most BINS columns of (time, rms, peak): mean of time and rms, largest peak."""
    group = -(-rows.shape[1] // BINS)
    if group == 1:
        return rows
    edges = np.arange(0, rows.shape[1], group)
    counts = np.diff(np.append(edges, rows.shape[1]))
    thinned: NDArray[np.float64] = np.stack(
        [
            np.add.reduceat(rows[0], edges) / counts,
            np.sqrt(np.add.reduceat(rows[1] ** 2, edges) / counts),
            np.maximum.reduceat(rows[2], edges),
        ]
    )
    return thinned


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


def _envelope_spectrum(machine: Machine) -> tuple[str, Figure] | None:
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


def _spectrum(machine: Machine) -> tuple[str, Figure] | None:
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
        xlabel='frequency [kHz]', ylabel=_pretty(message.unit),
    )  # fmt: skip
    return caption, figure


def _waterfall(machine: Machine) -> tuple[str, Figure] | None:
    strips = [strip for _, strip in sorted(machine.strips.items())]
    if not strips:
        return None
    peak = max(float(np.nanmax(np.abs(strip.samples))) for strip in strips) or 1.0
    figure = Figure(figsize=(WIDTH, 1.2 + 0.2 * len(strips)), layout='constrained')
    axes = figure.subplots()
    # The largest swing reaches over one and a half of its neighbours.
    scale = 1.5 / peak
    coldest = strips[0].temperature
    lines, colours = [], []
    for row, strip in reversed(list(enumerate(strips))):
        time = np.arange(strip.samples.size) / strip.sample_rate * 1e3
        low_high = _extremes(time, strip.samples.astype(np.float64))
        lines.append(np.stack([low_high[0], row + scale * low_high[1]], axis=1))
        span = max(strips[-1].temperature - coldest, 1e-9)
        part = (strip.temperature - coldest) / span if np.isfinite(coldest) else 0.0
        colours.append((0.08 + 0.7 * part, 0.35 - 0.2 * part, 0.75 - 0.6 * part))
    axes.add_collection(LineCollection(lines, colors=colours, linewidths=0.6))
    axes.set_yticks(range(len(strips)))
    axes.set_yticklabels(
        [f'{s.temperature:.0f} °C' if np.isfinite(s.temperature) else 'unknown' for s in strips]
    )
    duration = max(line[-1, 0] for line in lines)
    axes.set(xlim=(0.0, duration), ylim=(-1.6, len(strips) + 0.6), xlabel='time [ms]')
    axes.grid(axis='y', visible=False)
    caption = (
        'Waveform over temperature, one strip every 5 K, all to one scale: the largest swing is '
        f'{peak:.3g} {_pretty(machine.unit)}'
    )
    return caption, figure


def _extremes(
    time: NDArray[np.float64], samples: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return lowest and highest of neighbouring samples in turn: the shape, in fewer points."""
    group = max(1, samples.size // 800)
    if group < 2:
        return time, samples
    edges = np.arange(0, samples.size, group)
    low, high = np.minimum.reduceat(samples, edges), np.maximum.reduceat(samples, edges)
    return np.repeat(time[edges], 2), np.stack([low, high], axis=1).ravel()


def _trend(machine: Machine) -> tuple[str, Figure] | None:
    items = machine.diagnoses
    if not items:
        return None
    time = _times(items)
    figure = Figure(figsize=(WIDTH, 3.2), layout='constrained')
    (rms, kurtosis), (score, confidence) = figure.subplots(2, 2, sharex=True)
    unit = _pretty(items[-1][1].unit)
    rms.plot(time, _values(items, 'rms'), color='#1565c0', label='rms')
    rms.set(title=f'rms [{unit}]' if unit else 'rms')
    rms.set_ylim(bottom=0.0)
    kurtosis.plot(time, _values(items, 'kurtosis'), color='#6a1b9a', label='kurtosis')
    kurtosis.plot(time, _values(items, 'crest_factor'), color='#00838f', label='crest factor')
    kurtosis.set_title('shape')
    kurtosis.legend(ncols=2, loc='lower right', bbox_to_anchor=(1.0, 0.97))
    for index, family in enumerate(DEFECTS):
        scores = [m.score[index] if len(m.score) > index else np.nan for _, m in items]
        score.plot(time, scores, color=FAMILY_COLOURS[family], label=family, linewidth=1.1)
    score.set(title='comb score [σ]', xlabel='time [s]')
    score.legend(
        ncols=4, loc='lower right', bbox_to_anchor=(1.0, 0.97), columnspacing=0.8, handlelength=1.2
    )
    confidence.plot(time, _values(items, 'confidence'), color='#212121')
    confidence.set(title='confidence', xlabel='time [s]', ylim=(0.0, 1.02))
    for axes in (rms, kurtosis, score, confidence):
        axes.yaxis.set_major_locator(MaxNLocator(5))
    return 'Severity and evidence, window by window', figure


def _model(machine: Machine) -> tuple[str, Figure] | None:
    items = machine.states
    if not items:
        return None
    time = _times(items)
    figure = Figure(figsize=(WIDTH, 1.7), layout='constrained')
    panels = figure.subplots(1, 3)
    rows = (
        ('beta0', 1.0, 'β₀ [1]', '#00838f'),
        ('k_b', 1e-9, 'K_b [10⁹ N/m^1.5]', '#1565c0'),
        ('c_d', 1e6, 'C_d [µm]', '#c62828'),
    )
    for axes, (name, factor, title, colour) in zip(panels, rows, strict=True):
        axes.plot(time, factor * _values(items, name), color=colour)
        axes.set(title=title, xlabel='time [s]')
        axes.yaxis.set_major_locator(MaxNLocator(4))
        axes.ticklabel_format(useOffset=False)
    return 'Temperature-dependent parameters of the twin', figure
