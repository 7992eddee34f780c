# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of a report as SVG for its page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
import math
from textwrap import wrap
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing.vocabulary import TITLES
from bearing_twin.stamps import time_unit
from bearing_twin.view.report.fitted import explained, fitted_figure
from bearing_twin.view.report.spectra import (
    draw_envelope_spectrum,
    draw_spectrum,
    envelope_caption,
)
from bearing_twin.view.report.svg import (
    BINS,
    hex_colour,
    STYLE,
    svg_element,
    WIDTH,
)
from bearing_twin.view.spectrum import ENVELOPE, low_high, SpectrumPicture
from bearing_twin.view.style import ink, verdict_state
from bearing_twin.view.trends import CALIBRATION, DIAGNOSIS, TWIN_STATE
from bearing_twin.view.verdict import judged_by_velocity, pretty
import matplotlib as mpl
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.view.report.data import Machine
    from bearing_twin.view.trends import Limit, Panel, Trend
    from matplotlib.axes import Axes


DECIDING = ('significance', 'modulation', 'baseline')
"""Evidence panels in the main part, besides level or velocity; the appendix has the others."""
CLOSE = 0.22
"""Height of a line of text relative to that of a panel."""
SHAPES = {'o': '●', 's': '■', '^': '▲', 'D': '◆'}
"""Markers of the lines of a panel in their order, and how a title writes them: in print, and for
eyes that do not tell red from green, they stand for the colours."""
LANE, LANES = 460.0, 330.0
"""Least length of the time axis of one verdict lane and of those of several machines, points."""
LETTER = 4.8
"""Width of a letter in a lane, points."""
LANES_IN_A_FIGURE = 40
"""Largest number of machines in one figure: it fits a sheet."""
PAUSE = 0.02
"""Part of a time axis from which on a pause is seen: no line is drawn over it."""
LONGEST_NAME = 36
"""Longest name of a machine beside a lane, letters."""


def figures(machine: Machine, prefix: str) -> list[tuple[str, str]]:
    """Return caption and SVG of each figure that has data; the ids begin with ``prefix``."""
    plots = (
        _envelope_spectrum, _history, _over_temperature, _evidence, _waterfall, _fitted,
    )  # fmt: skip
    return _all(machine, prefix, plots)


def appended_figures(machine: Machine, prefix: str) -> list[tuple[str, str]]:
    """Return the figures of the appendix like :func:`figures`."""
    return _all(machine, prefix, (_spectrum, _other_evidence, _model, explained, fitted_figure))


def _all(
    machine: Machine, prefix: str, plots: Sequence[Callable[[Machine], tuple[str, Figure] | None]]
) -> list[tuple[str, str]]:
    found = []
    # The style applies to these figures only, not to the calling program.
    with mpl.rc_context(STYLE):
        for number, plot in enumerate(plots):
            found += _drawn(plot, machine, f'{prefix}{number}-')
    return found


def _drawn(
    plot: Callable[[Machine], tuple[str, Figure] | None], machine: Machine, prefix: str
) -> list[tuple[str, str]]:
    """Draw one figure; if that fails, return a caption with the reason."""
    try:
        made = plot(machine)
        return [(made[0], svg_element(made[1], prefix))] if made is not None else []
    except Exception as error:
        # Matplotlib raises many kinds of errors on numbers near the largest of their type.
        name = plot.__name__.strip('_').replace('_', ' ')
        return [(f'The {name} cannot be drawn ({type(error).__name__}: {error})', '')]


def _columns(pairs: Sequence[tuple[float, ...]]) -> NDArray[np.float64]:
    rows: NDArray[np.float64] = np.array(pairs, dtype=np.float64).T
    return rows


def _values(items: Sequence[tuple[float, Any]], name: str) -> NDArray[np.float64]:
    return np.array([getattr(message, name) for _, message in items], dtype=np.float64)


def _times(items: Sequence[tuple[float, Any]]) -> NDArray[np.float64]:
    return np.array([time for time, _ in items], dtype=np.float64)


def _history(machine: Machine) -> tuple[str, Figure] | None:
    panels: list[tuple[str, Callable[[Axes, Machine], None]]] = []
    if machine.diagnoses:
        panels.append(('verdict', _lane))
    if machine.measured or machine.states:
        panels.append(('temperature', _temperature))
    if machine.vibration:
        panels.append(('vibration', _level))
    if not panels:
        return None
    heights = [0.4 if machine.diagnoses and k == 0 else 1.0 for k in range(len(panels))]
    figure = Figure(figsize=(WIDTH, 0.4 + 0.9 * sum(heights)), layout='constrained')
    rows = figure.subplots(
        len(panels), sharex=True, squeeze=False, gridspec_kw={'height_ratios': heights}
    )[:, 0]
    for axes, (_, panel) in zip(rows, panels, strict=True):
        panel(axes, machine)
    _time_axis(rows[-1], machine.end, 'time since the start of the recording')
    *names, last = (name for name, _ in panels)
    shown = f'{", ".join(names)} and {last}' if names else last
    return f'{shown.capitalize()} over time', figure


def verdicts_over_time(machines: Sequence[Machine]) -> list[tuple[str, str]]:
    """Return caption and SVG of the verdicts of several machines, one above the other."""
    judged = [machine for machine in machines if machine.diagnoses]
    end = max((machine.end for machine in judged), default=0.0)
    drawn = []
    with mpl.rc_context(STYLE):
        for first in range(0, len(judged), LANES_IN_A_FIGURE):
            figure = _lanes(judged[first : first + LANES_IN_A_FIGURE], end)
            drawn.append(('Verdicts over time', svg_element(figure, f'o{first}-')))
    return drawn


def _lanes(machines: Sequence[Machine], end: float) -> Figure:
    figure = Figure(figsize=(WIDTH, 0.8 + 0.17 * len(machines)), layout='constrained')
    axes = figure.subplots()
    seen: dict[str, Rectangle] = {}
    for row, machine in enumerate(machines):
        seen |= _patches(axes, machine, LETTER * end / LANES, row)
    axes.set(ylim=(len(machines), 0), yticks=np.arange(len(machines)) + 0.5)
    axes.set_yticklabels([_short(machine.name) for machine in machines])
    _time_axis(axes, end, 'time since the start of the recording')
    axes.autoscale_view(scaley=False)
    axes.grid(axis='y', visible=False)
    figure.legend(seen.values(), seen, ncols=4, loc='outside upper right')
    return figure


def _short(name: str) -> str:
    """Return a name, of a long one its begin and its end."""
    half = LONGEST_NAME // 2
    return name if len(name) <= LONGEST_NAME else f'{name[: half - 6]}…{name[-half - 5 :]}'


def _patches(axes: Axes, machine: Machine, letter: float, row: int = 0) -> dict[str, Rectangle]:
    """
    Draw the verdicts of a machine from ``row`` to ``row + 1``; return a patch of each kind.

    A patch that is long enough has its name in it; ``letter`` is the width of a letter, s.
    """
    times = _times(machine.diagnoses)
    # A verdict holds until the next, the last one until the recording ends; but not over a pause.
    ends = np.append(times[1:], machine.end)
    last = pauses(np.append(times, machine.end))
    ends[last] = times[last] + np.median(np.diff(times)) if times.size > 1 else machine.end
    names = [str(message.result_name) for _, message in machine.diagnoses]
    changes = [k for k in range(len(names)) if k == 0 or names[k] != names[k - 1] or k - 1 in last]
    seen: dict[str, Rectangle] = {}
    for first, after in zip(changes, [*changes[1:], len(names)], strict=True):
        ground = verdict_state(names[first]).colour
        begin, length = times[first], ends[after - 1] - times[first]
        # A verdict at the very end is a line.
        patch = Rectangle((begin, row + 0.1), length, 0.8, color=hex_colour(ground), linewidth=0.5)
        axes.add_patch(patch)
        title = TITLES.get(names[first], names[first])
        seen.setdefault(title, patch)
        if length > (len(title) + 2) * letter:
            axes.text(
                begin + 0.5 * length, row + 0.5, title, ha='center', va='center_baseline',
                color=ink(ground), fontsize='small',
            )  # fmt: skip
    return seen


def _lane(axes: Axes, machine: Machine) -> None:
    seen = _patches(axes, machine, LETTER * machine.end / LANE)
    axes.set(ylim=(0.0, 1.0), yticks=[], title='verdict')
    axes.grid(visible=False)
    axes.autoscale_view(scaley=False)
    axes.legend(seen.values(), seen, ncols=len(seen), loc='lower right', bbox_to_anchor=(1.0, 1.0))


def _temperature(axes: Axes, machine: Machine) -> None:
    if machine.measured:
        time, measured = _parted(_columns(machine.measured))
        axes.plot(time, measured, color='#c62828', linewidth=1.2, label='measured')
    if machine.states:
        used = _values(machine.states, 'temperature_used')
        axes.plot(
            *_parted(np.stack([_times(machine.states), used])), color='#1565c0', linewidth=1.0,
            dashes=(4, 2), label='used by the twin',
        )  # fmt: skip
    axes.set_ylabel('°C')
    axes.set_title('bearing temperature')
    axes.legend(ncols=2, loc='lower right', bbox_to_anchor=(1.0, 1.0))


def _level(axes: Axes, machine: Machine) -> None:
    time, rms, peak = _parted(_thinned(_columns(machine.vibration)))
    axes.plot(time, peak, color='#90a4ae', linewidth=0.7, label='peak')
    axes.plot(time, rms, color='#1565c0', linewidth=1.2, label='rms')
    axes.set_ylabel(pretty(machine.unit))
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


def pauses(times: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the indices of the times after which nothing is for so long that it is seen."""
    steps = np.diff(times)
    if not steps.size:
        return np.empty(0, dtype=np.intp)
    return np.flatnonzero(steps > max(PAUSE * (times[-1] - times[0]), 3.0 * np.median(steps)))


def _parted(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return columns of (time, values...) with NaN for values in pauses, which parts the lines."""
    after = pauses(rows[0]) + 1
    parted: NDArray[np.float64] = np.insert(rows, after, math.nan, axis=1)
    parted[0] = np.insert(rows[0], after, rows[0, after])
    return parted


def _waterfall(machine: Machine) -> tuple[str, Figure] | None:
    strips = [strip for _, strip in sorted(machine.over_temperature.strips.items())]
    if not strips:
        return None
    swings = [strip.samples - np.nanmean(strip.samples) for strip in strips]
    peak = max(float(np.nanmax(np.abs(swing))) for swing in swings) or 1.0
    figure = Figure(figsize=(WIDTH, 0.7 + 0.11 * len(strips)), layout='constrained')
    axes = figure.subplots()
    # The largest swing spans one and a half rows.
    scale = 1.5 / peak
    known = [strip.temperature for strip in strips if np.isfinite(strip.temperature)]
    coldest, hottest = (known[0], known[-1]) if known else (0.0, 0.0)
    span = max(hottest - coldest, 1e-9)
    lines, colours = [], []
    for row, strip in reversed(list(enumerate(strips))):
        time = np.arange(strip.samples.size) / strip.sample_rate * 1e3
        low_high = _extremes(time, swings[row].astype(np.float64))
        lines.append(np.stack([low_high[0], row + scale * low_high[1]], axis=1))
        part = (strip.temperature - coldest) / span
        colour = (0.08 + 0.7 * part, 0.35 - 0.2 * part, 0.75 - 0.6 * part)
        colours.append(colour if np.isfinite(part) else (0.5, 0.5, 0.5))
    axes.add_collection(LineCollection(lines, colors=colours, linewidths=0.6))
    # Rows are lower than text, so only some are labelled.
    named = range(0, len(strips), max(2, 1 + len(strips) // 8))
    axes.set_yticks(named)
    temperatures = [strips[k].temperature for k in named]
    axes.set_yticklabels(
        [f'{t:.0f} °C' if np.isfinite(t) else 'temperature not known' for t in temperatures]
    )
    duration = max(line[-1, 0] for line in lines)
    axes.set(xlim=(0.0, duration), ylim=(-1.6, len(strips) + 0.6), xlabel='time [ms]')
    axes.grid(axis='y', visible=False)
    over = ' over temperature, one strip every 5 K, to one scale' if known else ''
    unit = pretty(machine.unit) if machine.unit else '(unit unknown)'
    caption = f'Waveform{over}: the largest swing is {peak:.3g} {unit}'
    return caption, figure


def _extremes(
    time: NDArray[np.float64], samples: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return times and the lowest and highest sample of each group: the shape in fewer points."""
    group = max(1, samples.size // 800)
    if group < 2:
        return time, samples
    edges = np.arange(0, samples.size, group)
    return np.repeat(time[edges], 2), low_high(samples, edges).ravel()


def _envelope_spectrum(machine: Machine) -> tuple[str, Figure] | None:
    picture = _picture(machine, ENVELOPE)
    if picture is None:
        return None
    figure = Figure(figsize=(WIDTH, 3.1), layout='constrained')
    draw_envelope_spectrum(figure, picture)
    return envelope_caption(picture), figure


def _spectrum(machine: Machine) -> tuple[str, Figure] | None:
    picture, envelope = _picture(machine, 'spectrum'), _picture(machine, ENVELOPE)
    if picture is None:
        return None
    figure = Figure(figsize=(WIDTH, 2.1), layout='constrained')
    draw_spectrum(figure.subplots(), picture, envelope.band if envelope else (0.0, 0.0))
    return 'Amplitude spectrum of the same window', figure


def _picture(machine: Machine, kind: str) -> SpectrumPicture | None:
    message = machine.headline.spectra.get(kind)
    diagnosis = machine.headline.worst.best if machine.diagnoses else None
    return SpectrumPicture.of(message, diagnosis) if message is not None else None


def _over_temperature(machine: Machine) -> tuple[str, Figure] | None:
    curves = [c for c in machine.over_temperature.curves if c.temperatures.size > 1]
    if not curves:
        return None
    figure = Figure(figsize=(WIDTH, 1.75), layout='constrained')
    for axes, curve in zip(figure.subplots(1, len(curves), squeeze=False)[0], curves, strict=True):
        axes.plot(curve.temperatures, curve.values, '.-', color='#1565c0', linewidth=1.0, ms=4.0)
        axes.set_xlabel('°C')
        axes.ticklabel_format(useOffset=False)
        axes.xaxis.set_major_locator(MaxNLocator(4))
        axes.yaxis.set_major_locator(MaxNLocator(4))
        title = wrap(curve.title, 75 // len(curves))
        if np.isfinite(curve.base):
            ratio = curve.values[-1] / curve.base
            # Slip changes a frequency by less than 1 %.
            digits = 2 if curve.key in ('amplitude', 'level') else 4
            title.append(f'× {ratio:.{digits}f} at {curve.temperatures[-1]:.0f} °C')
            axes.axhline(curve.base, color='#9e9e9e', linewidth=0.7, dashes=(4, 2))
        axes.set_title('\n'.join(title))
    references = {curve.reference for curve in curves}
    where = 'the temperature next to 20 °C'
    if len(references) == 1:
        where = f'{references.pop():.0f} °C'
    caption = (
        'Over temperature at the speed held longest, means of 5 K (amplitude: of the largest '
        f'magnitude of each second). Dashed: the value at {where}, to which the ratios refer'
    )
    return caption, figure


def _deciding(machine: Machine) -> tuple[str, ...]:
    """Return keys of the deciding panels: with velocity if judged, or level without a baseline."""
    if any(judged_by_velocity(message) for _, message in machine.diagnoses):
        return *DECIDING, 'velocity'
    known = np.isfinite(_values(machine.diagnoses, 'level_over_baseline')).any()
    return DECIDING if known else (*DECIDING, 'level')


def _evidence(machine: Machine) -> tuple[str, Figure] | None:
    panels = [panel for panel in DIAGNOSIS if panel.key in _deciding(machine)]
    caption = (
        'What decides, window by window. Dashed: limit, told at its right; dotted: of suspect, '
        'and of the cage'
    )
    return _panels(caption, panels, machine.diagnoses, machine.source.zones)


def _other_evidence(machine: Machine) -> tuple[str, Figure] | None:
    panels = [panel for panel in DIAGNOSIS if panel.key not in _deciding(machine)]
    caption = 'Other quantities, window by window. Dashed: limit'
    return _panels(caption, panels, machine.diagnoses, machine.source.zones)


def _model(machine: Machine) -> tuple[str, Figure] | None:
    return _panels('The twin over time', TWIN_STATE, machine.states)


def _fitted(machine: Machine) -> tuple[str, Figure] | None:
    if not machine.calibrations:
        return None
    statement = machine.calibrations[-1][1].statement
    caption = f'The twin fitted to the machine: {statement}. Dashed: limit'
    return _panels(caption, CALIBRATION, machine.calibrations)


def _panels(
    caption: str,
    panels: Sequence[Panel],
    items: Sequence[tuple[float, Any]],
    zones: Sequence[Limit] = (),
) -> tuple[str, Figure] | None:
    """
    Draw the panels that have values, three or four in a row, over one range of time.

    ``zones`` are the limits of the velocity.
    """
    time = _times(items)
    shown = [(panel, lines) for panel in panels if (lines := _lines(panel, items))]
    if not shown:
        return None
    # Four in two rows would take a third sheet.
    columns = 4 if len(shown) == 4 else 3
    rows = -(-len(shown) // columns)
    figure = Figure(figsize=(WIDTH, 0.2 + 1.45 * rows), layout='constrained')
    grid = figure.subplots(rows, columns, sharex=True, squeeze=False).ravel()
    named: dict[str, Any] = {}
    unit = str(getattr(items[-1][1], 'unit', ''))
    for axes, (panel, lines) in zip(grid, shown, strict=False):
        shapes = dict(zip(panel.trends, SHAPES.values(), strict=False))
        besides = [f'{t.named} {shapes[t]}' for t, _ in lines if t in panel.other_trends]
        # No-break spaces keep a name and its colour together when the title is wrapped.
        whole = (name.replace(' ', '\N{NO-BREAK SPACE}') for name in besides)
        title = ', '.join([panel.title, *whole]).replace('[unit]', f'[{pretty(unit)}]')
        axes.set_title('\n'.join(wrap(title, 90 // columns)).replace('\N{NO-BREAK SPACE}', ' '))
        _panel(axes, panel, time, lines, zones if panel.key == 'velocity' else panel.limits)
        if len(lines) > 1 and not besides:
            for line in axes.get_lines()[: len(lines)]:
                named.setdefault(str(line.get_label()), line)
    for axes in grid[len(shown) :]:
        axes.remove()
    for axes in grid[: len(shown)][-columns:]:
        _time_axis(axes, time[-1], 'time', 4)
        axes.tick_params(axis='x', labelbottom=True)
    if named:
        figure.legend(named.values(), named, loc='outside upper right', ncols=len(named))
    return caption, figure


def _lines(
    panel: Panel, items: Sequence[tuple[float, Any]]
) -> list[tuple[Trend, NDArray[np.float64]]]:
    """Return the trends of a panel that have values, with them; none without the first trend."""
    lines = [(t, np.array([t.value(m) for _, m in items], dtype=float)) for t in panel.trends]
    lines = [(trend, values) for trend, values in lines if np.isfinite(values).any()]
    return lines if lines and lines[0][0] is panel.trends[0] else []


def _panel(
    axes: Axes,
    panel: Panel,
    time: NDArray[np.float64],
    lines: Sequence[tuple[Trend, NDArray[np.float64]]],
    limits: Sequence[Limit],
) -> None:
    """Draw the curves of a panel, its band and its limits."""
    time, *parted = _parted(np.stack([time, *(values for _, values in lines)]))
    lines = [(trend, values) for (trend, _), values in zip(lines, parted, strict=True)]
    for trend, values in lines:
        colour, number = hex_colour(trend.colour), panel.trends.index(trend)
        # Fractions of the diagonal: the markers of a line are beside those of the others.
        axes.plot(
            time, values, color=colour, label=trend.label, linewidth=1.1, ms=3.0,
            marker=[*SHAPES][number] if len(lines) > 1 else None,
            markevery=(0.05 + 0.07 * number, 0.35),
        )  # fmt: skip
        # A line does not show a single value between missing ones: it becomes a point.
        there = np.pad(np.isfinite(values), 1)
        alone = there[1:-1] & ~there[:-2] & ~there[2:]
        axes.scatter(time[alone], values[alone], s=9.0, color=colour)
    of = {trend.key: values for trend, values in lines}
    if panel.band and of.keys() >= set(panel.band):
        low, high = (of[key] for key in panel.band)
        axes.fill_between(time, low, high, color='#bbdefb')
    for limit in limits:
        dashes = (4, 2) if limit.look == 'limit' else (1, 2)
        axes.axhline(limit.value, color='#616161', linewidth=0.8, dashes=dashes)
    if panel.from_zero:
        # With zero among the data, the upper margin is relative to the whole height.
        axes.update_datalim([(time[0], 0.0)])
        axes.autoscale_view(scalex=False)
        axes.set_ylim(bottom=0.0)
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.ticklabel_format(useOffset=False)
    _mark_limits(axes, limits)


def _time_axis(axes: Axes, end: float, name: str, numbers: int = 9) -> None:
    """Label a time axis in s with the unit that suits ``end`` in s."""
    unit, length = time_unit(end)
    axes.set_xlabel(f'{name} [{unit}]')
    if unit != 's':
        low, high = axes.get_xlim()
        ticks = MaxNLocator(numbers).tick_values(low / length, high / length)
        axes.set_xticks([length * t for t in ticks if low <= length * t <= high])
        axes.xaxis.set_major_formatter(lambda value, _: f'{value / length:g}')


def _mark_limits(axes: Axes, limits: Sequence[Limit]) -> None:
    """Label the limits right of the axes, where no curve is; close ones share a line of text."""
    low, high = axes.get_ylim()
    rows: list[list[Limit]] = []
    for limit in sorted((limit for limit in limits if limit.mark), key=lambda limit: limit.value):
        if rows and limit.value - rows[-1][-1].value < CLOSE * (high - low):
            rows[-1].append(limit)
        else:
            rows.append([limit])
    for row in rows:
        axes.annotate(
            ', '.join(limit.mark for limit in row), (1.0, row[-1].value), (2, 0),
            xycoords=('axes fraction', 'data'), textcoords='offset points', va='center',
            color='#616161', fontsize='small',
        )  # fmt: skip
