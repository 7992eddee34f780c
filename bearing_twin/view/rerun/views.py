# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Rerun views of one bearing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from bearing_twin.view.over_temperature import QUANTITIES
from bearing_twin.view.rerun.pictures.bearing3d import MAGNIFIED, SLOWED
from bearing_twin.view.rerun.pictures.spectrogram import COLUMNS, ROWS
from bearing_twin.view.rerun.pictures.waveform import AXES
import rerun.blueprint as rrb

if TYPE_CHECKING:
    from bearing_twin.view.rerun.scene import Scene
    from bearing_twin.view.trends import Panel


CLOSE = 0.25
"""Length of the close view of the waveform, s."""
WIDE = 10.0
"""Length of the waveform's envelope, s."""

View = rrb.View | rrb.Container


def is_bearing(scene: Scene) -> bool:
    """Whether a scene holds data of a bearing."""
    kinds = set(scene.contents.values())
    return bool(kinds & {'vibration', 'twin_state', 'diagnosis', 'spectrum', 'envelope_spectrum'})


def paths_of(scene: Scene, kind: str) -> list[str]:
    """Return the entity paths of the topics of a kind."""
    names = (name for name, known in scene.contents.items() if known == kind)
    return [f'{scene.root}/{name}'.replace('//', '/') for name in names]


def _window(timeline: str, seconds: float) -> rrb.VisibleTimeRange:
    return rrb.VisibleTimeRange(
        timeline,
        start=rrb.TimeRangeBoundary.cursor_relative(seconds=-seconds),
        end=rrb.TimeRangeBoundary.cursor_relative(),
    )


def _all_time() -> rrb.TimeAxis:
    """
    Return a time axis from the beginning to the end.

    With a shared axis Rerun opens at half a minute on either side of the cursor.
    """
    ends = rrb.TimeRange(rrb.TimeRangeBoundary.infinite(), rrb.TimeRangeBoundary.infinite())
    return rrb.TimeAxis(link=rrb.components.LinkAxis.Independent, view_range=ends)


def lines_view(
    name: str,
    contents: Sequence[str],
    *,
    window: rrb.VisibleTimeRange | None = None,
    legend: bool = False,
    span: tuple[float, float] | None = None,
) -> rrb.TimeSeriesView:
    """Return a view of lines over time."""
    return rrb.TimeSeriesView(
        origin='/',
        contents=list(contents),
        name=name,
        axis_x=rrb.TimeAxis(link=rrb.components.LinkAxis.Independent) if window else _all_time(),
        axis_y=rrb.ScalarAxis(range=span) if span else None,
        plot_legend=rrb.PlotLegend(rrb.Corner2D.LeftTop, visible=legend),
        time_ranges=[window] if window else None,
    )


def lanes_view(name: str, contents: Sequence[str]) -> rrb.StateTimelineView:
    """Return a view of states over time."""
    return rrb.StateTimelineView(
        origin='/', contents=list(contents), name=name, time_view=_all_time()
    )


def card_view(path: str, title: str) -> View:
    """Return the view of a verdict as a card."""
    name = f'Verdict: {title}' if title else 'Verdict'
    return rrb.Spatial2DView(origin=f'{path}/card', name=name)


def card_and_reasons(
    scene: Scene, title: str = '', shares: tuple[float, float] = (3, 10)
) -> list[View]:
    """Return card and reasons, with their shares of the height."""
    return [
        rrb.Vertical(
            card_view(path, title),
            rrb.TextDocumentView(origin=f'{path}/words', name='Reasons'),
            row_shares=shares,
        )
        for path in paths_of(scene, 'diagnosis')
    ]


def lane_paths(scene: Scene) -> list[str]:
    """Return the entity paths of the verdicts over time."""
    return [f'{path}/verdict' for path in paths_of(scene, 'diagnosis')]


def verdict_lane(scene: Scene) -> list[View]:
    """Return the view of the verdicts over time."""
    lanes = lane_paths(scene)
    if not scene.asset.narrow:
        lanes += [f'{path}/temperature_status' for path in paths_of(scene, 'twin_state')]
    return [lanes_view('Verdict over time', lanes)] if paths_of(scene, 'diagnosis') else []


def bearing_views(scene: Scene) -> list[View]:
    """Return the bearing in three dimensions."""
    return [
        rrb.Spatial3DView(
            origin=f'{path}/bearing',
            name=f'Bearing, {SLOWED:g} x slower, shift x {MAGNIFIED:g}',
            eye_controls=rrb.EyeControls3D(
                position=[15.0, -24.0, 114.0], look_target=[0.0, -6.0, 0.0], eye_up=[0.0, 1.0, 0.0]
            ),
            line_grid=False,
        )
        for path in paths_of(scene, 'twin_state')
    ]


def waveform_views(scene: Scene, timeline: str) -> list[View]:
    """Return waveform, its extremes and the spectrogram of each sensor."""
    peak = scene.asset.scales.vibration
    views: list[View] = []
    for path in paths_of(scene, 'vibration'):
        unit = scene.asset.units.get(path, _unit(scene))
        views += [
            lines_view(
                # A low axis may have only one number: the title gives the range of all sides.
                f'Vibration {f"±{peak:.3g} " if peak else ""}[{unit}], last {CLOSE:g} s',
                [f'{path}/samples/**'],
                window=_window(timeline, CLOSE),
                span=(-peak, peak) if peak else None,
            ),
            lines_view(
                f'Extremes over {WIDE:g} s [{unit}]: {_axes(scene)}',
                [f'{path}/envelope/**'],
                window=_window(timeline, WIDE),
            ),
            rrb.Spatial2DView(
                origin=f'{path}/spectrogram',
                name='Spectrogram of the last minute',
                # With room for the labels, which Rerun does not include.
                visual_bounds=rrb.VisualBounds2D(
                    x_range=[-50.0, COLUMNS + 20.0], y_range=[-22.0, ROWS + 26.0]
                ),
            ),
        ]
    return views


def _unit(scene: Scene) -> str:
    return scene.asset.unit or 'unit unknown'


def _axes(scene: Scene) -> str:
    """Return directions that have samples, with their colours; a legend would cover the lines."""
    return ', '.join(f'{n} {c}' for n, c in AXES.values() if n in scene.asset.panels)


def waterfall_views(scene: Scene) -> list[View]:
    """Return the waveform over temperature."""
    return [
        rrb.Spatial3DView(
            origin=f'{path}/waterfall',
            name='Waveform over temperature',
            eye_controls=rrb.EyeControls3D(
                position=[1.9, -6.2, 5.6], look_target=[5.4, 3.0, -1.1], eye_up=[0.0, 0.0, 1.0]
            ),
            line_grid=False,
        )
        for path in paths_of(scene, 'vibration')
        if paths_of(scene, 'temperature') or paths_of(scene, 'twin_state')
    ]


def _bars(name: str, origin: str) -> View:
    # A legend would cover lines, and it shows only entity names.
    return rrb.BarChartView(origin=origin, name=name, plot_legend=rrb.PlotLegend(visible=False))


def spectrum_views(scene: Scene) -> list[View]:
    """Return the amplitude spectra."""
    return [
        _bars(f'Spectrum [{_unit(scene)} over Hz]', path) for path in paths_of(scene, 'spectrum')
    ]


def envelope_views(scene: Scene) -> list[View]:
    """Return the envelope spectra with their colour legend, and a zoom of the first harmonic."""
    views: list[View] = []
    for path, legend in zip(
        paths_of(scene, 'envelope_spectrum'), colour_legend(scene), strict=True
    ):
        narrow = scene.asset.narrow
        name = 'Squared envelope spectrum: modulation index over Hz'
        whole = _bars('Envelope spectrum: index over Hz' if narrow else name, f'{path}/whole')
        parts = [(6.0, whole), (2.0 if narrow else 1.0, legend)]
        if 'near' in scene.asset.panels and not narrow:
            parts.append((4.0, _bars('First harmonic, enlarged [1 over Hz]', f'{path}/near')))
        shares, shown = zip(*parts, strict=True)
        views.append(rrb.Vertical(*shown, row_shares=shares))
    return views


def colour_legend(scene: Scene) -> list[View]:
    """Return the colour legend of the combs."""
    return [
        rrb.Spatial2DView(origin=f'{path}/legend', name='Colours', titlebar=False)
        for path in paths_of(scene, 'envelope_spectrum')
    ]


def over_temperature_views(scene: Scene) -> list[View]:
    """Return a view for each quantity over temperature."""
    references = {c.reference for c in scene.asset.over_temperature.curves}
    against = f' against {references.pop():g} °C' if len(references) == 1 else ', change'
    return [
        _bars(
            f'{name}{"" if key == "slip" else against} [%] over °C',
            f'{path}/over_temperature/{key}',
        )
        for path in paths_of(scene, 'vibration')
        for key, name in QUANTITIES.items()
        if f'{path}/over_temperature/{key}' in scene.asset.panels
    ]


def panel_views(scene: Scene, kind: str, panels: Sequence[Panel]) -> list[View]:
    """Return a view for each panel that has values."""
    return [
        lines_view(panel.named.replace('[unit]', f'[{_unit(scene)}]'), [f'{path}/{panel.key}/**'])
        for path in paths_of(scene, kind)
        for panel in panels
        if panel.key in scene.asset.panels
    ]


def temperature_views(scene: Scene) -> list[View]:
    """Return the temperatures over time."""
    contents = [f'{path}/measured' for path in paths_of(scene, 'temperature')]
    contents += [f'{path}/temperature/**' for path in paths_of(scene, 'twin_state')]
    name = 'Temperature [°C]'
    if 'temperature' in scene.asset.panels:
        name += ', twin orange'
    span = scene.asset.scales.temperature
    return [lines_view(name, contents, span=span)] if contents else []


def fitted_views(scene: Scene) -> list[View]:
    """Return views of machine (grey) and fitted twin (blue)."""
    views: list[View] = []
    for path in paths_of(scene, 'calibration'):
        if 'fitted_spectrum' in scene.asset.panels:
            views.append(_bars('Machine grey, twin blue [dB over Hz]', f'{path}/spectrum'))
        if 'fitted_turn' in scene.asset.panels:
            views.append(_bars(f'One revolution [{_unit(scene)} over ms]', f'{path}/turn'))
    return views


def difference_views(scene: Scene) -> list[View]:
    """Return views of the difference between the spectra of machine and twin."""
    return [
        _bars('Machine over twin [dB over Hz]', f'{path}/difference')
        for path in paths_of(scene, 'calibration')
        if 'fitted_spectrum' in scene.asset.panels
    ]


def number_views(scene: Scene) -> list[View]:
    """Return views of the numbers of other topics."""
    return [
        lines_view(path, [f'{path}/fields/**'], legend=True) for path in paths_of(scene, 'numbers')
    ]
