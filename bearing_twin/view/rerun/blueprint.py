# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""How the views are laid out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.view.rerun.bearing3d import MAGNIFIED, SLOWED
import rerun.blueprint as rrb

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from bearing_twin.view.rerun.scene import Scene

__all__ = ['automatic', 'layout']

"""Application id: a blueprint belongs to recordings of the same one."""
CLOSE = 0.25
"""Length of the close look at the waveform, s."""
WIDE = 10.0
"""Length of the waveform's envelope, s."""

LANES = 60.0
"""Length of the lanes, s."""

View = rrb.View | rrb.Container


def layout(
    scenes: Mapping[str, Scene], *, timeline: str, side_by_side: bool = False
) -> rrb.Blueprint:
    """
    Return the blueprint for what the scenes hold.

    Parameters
    ----------
    scenes
        By the title they are shown under.
    timeline
        Timeline to follow.
    side_by_side
        Whether scenes stand beside each other, to be compared, instead of on tabs.

    """
    bearings = {title: scene for title, scene in scenes.items() if _is_bearing(scene)}
    others = {title: scene for title, scene in scenes.items() if scene.contents}
    shown = bearings or others
    parts: list[View]
    if side_by_side:
        parts = [
            rrb.Horizontal(*(_narrow(scene, title, timeline) for title, scene in shown.items()))
        ]
    elif len(shown) == 1:
        parts = [_wide(scene, timeline) for scene in shown.values()]
    else:
        parts = [rrb.Tabs(*(_wide(scene, timeline, name=title) for title, scene in shown.items()))]
    foot = _foot(scenes.values())
    root = rrb.Vertical(*parts, foot, row_shares=[9, 2]) if foot else rrb.Vertical(*parts)
    return rrb.Blueprint(
        root,
        rrb.BlueprintPanel(state='collapsed'),
        rrb.SelectionPanel(state='collapsed'),
        rrb.TimePanel(state='collapsed', timeline=timeline, play_state='following'),
        auto_views=False,
        auto_layout=False,
    )


def automatic(
    scenes: Iterable[Scene], *, timeline: str, lines: Iterable[str] = ()
) -> rrb.Blueprint:
    """
    Return a blueprint with one view for the numbers of a topic; the viewer adds the rest.

    ``lines`` are topics that Rerun itself draws as time series.
    """
    views = [view for scene in scenes for view in _numbers(scene)]
    views += [_lines(topic, [f'{topic}/**']) for topic in lines]
    return rrb.Blueprint(
        rrb.Grid(*views),
        rrb.SelectionPanel(state='collapsed'),
        rrb.TimePanel(state='collapsed', timeline=timeline),
        auto_views=True,
        auto_layout=True,
    )


def _is_bearing(scene: Scene) -> bool:
    kinds = set(scene.contents.values())
    return bool(kinds & {'vibration', 'twin_state', 'diagnosis', 'spectrum', 'envelope_spectrum'})


def _of(scene: Scene, kind: str) -> list[str]:
    return [_join(scene.root, name) for name, known in scene.contents.items() if known == kind]


def _join(root: str, name: str) -> str:
    return f'{root}/{name}'.replace('//', '/')


def _window(timeline: str, seconds: float) -> rrb.VisibleTimeRange:
    return rrb.VisibleTimeRange(
        timeline,
        start=rrb.TimeRangeBoundary.cursor_relative(seconds=-seconds),
        end=rrb.TimeRangeBoundary.cursor_relative(),
    )


def _lines(
    name: str,
    contents: Sequence[str],
    *,
    window: rrb.VisibleTimeRange | None = None,
) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        origin='/',
        contents=list(contents),
        name=name,
        plot_legend=rrb.PlotLegend(rrb.Corner2D.LeftTop),
        time_ranges=[window] if window else None,
    )


def _lanes(name: str, contents: Sequence[str]) -> rrb.StateTimelineView:
    end = rrb.TimeRangeBoundary.cursor_relative()
    start = rrb.TimeRangeBoundary.cursor_relative(seconds=-LANES)
    return rrb.StateTimelineView(
        origin='/',
        contents=list(contents),
        name=name,
        time_view=rrb.TimeAxis(view_range=rrb.TimeRange(start=start, end=end)),
    )


def _verdict(scene: Scene, *, title: str = '', evidence: bool = True) -> list[View]:
    rows: list[View] = []
    for path in _of(scene, 'diagnosis'):
        lanes = [f'{path}/verdict'] + [
            f'{state}/temperature_status' for state in _of(scene, 'twin_state')
        ]
        views: list[View] = [
            rrb.Spatial2DView(
                origin=f'{path}/card', name=f'Verdict: {title}' if title else 'Verdict'
            ),
            rrb.TextDocumentView(origin=f'{path}/words', name='Reasons'),
            _lanes('Verdict over time', lanes),
        ]
        shares = [4, 3, 5]
        if evidence:
            views.append(_lines('Evidence: comb score [sd]', [f'{path}/evidence/**']))
            shares.append(4)
        rows.append(rrb.Horizontal(*views, column_shares=shares))
    return rows


def _solid(scene: Scene) -> list[View]:
    return [
        rrb.Spatial3DView(
            origin=f'{path}/bearing',
            name=f'Bearing {SLOWED:g} x slower, shift x {MAGNIFIED:g}',
            eye_controls=rrb.EyeControls3D(
                position=[14.0, -22.0, 105.0], look_target=[0.0, -6.0, 0.0], eye_up=[0.0, 1.0, 0.0]
            ),
            line_grid=False,
        )
        for path in _of(scene, 'twin_state')
    ]


def _waveforms(scene: Scene, timeline: str) -> list[View]:
    views: list[View] = []
    for path in _of(scene, 'vibration'):
        views += [
            _lines(
                f'Vibration, last {CLOSE:g} s',
                [f'{path}/samples/**'],
                window=_window(timeline, CLOSE),
            ),
            _lines(
                f'Vibration, envelope of {WIDE:g} s',
                [f'{path}/envelope/**'],
                window=_window(timeline, WIDE),
            ),
            rrb.Spatial2DView(origin=f'{path}/spectrogram', name='Spectrogram of the last minute'),
        ]
    return views


def _waterfalls(scene: Scene) -> list[View]:
    return [
        rrb.Spatial3DView(
            origin=f'{path}/waterfall',
            name='Waveform over temperature',
            eye_controls=rrb.EyeControls3D(
                position=[0.5, -6.5, 6.5], look_target=[5.2, 3.6, 0.0], eye_up=[0.0, 0.0, 1.0]
            ),
            line_grid=False,
        )
        for path in _of(scene, 'vibration')
        if _of(scene, 'temperature') or _of(scene, 'twin_state')
    ]


def _spectra(scene: Scene, *, legend: bool = True) -> list[View]:
    names = (
        ('envelope_spectrum', 'Squared envelope spectrum [over Hz]', legend),
        ('spectrum', 'Spectrum [over Hz], same cursors', False),
    )
    return [
        rrb.BarChartView(origin=path, name=name, plot_legend=rrb.PlotLegend(visible=explained))
        for kind, name, explained in names
        for path in _of(scene, kind)
    ]


def _trends(scene: Scene) -> list[View]:
    states, diagnoses = _of(scene, 'twin_state'), _of(scene, 'diagnosis')
    temperatures = [f'{path}/measured' for path in _of(scene, 'temperature')]
    temperatures += [f'{path}/temperature/**' for path in states]
    groups = (
        ('Temperature [°C]', temperatures),
        ('Contact: beta0, K_b, C_d', [f'{path}/contact/**' for path in states]),
        ('Severity', [f'{path}/severity/**' for path in diagnoses]),
        ('Real time', [f'{path}/real_time/**' for path in states]),
    )
    return [_lines(name, contents) for name, contents in groups if contents]


def _numbers(scene: Scene) -> list[View]:
    """Return views of topics that are not the bearing's."""
    return [_lines(path, [f'{path}/fields/**']) for path in _of(scene, 'numbers')]


def _wide(scene: Scene, timeline: str, *, name: str | None = None) -> View:
    columns = [
        [*_solid(scene), *_waterfalls(scene)],
        _waveforms(scene, timeline),
        _spectra(scene),
        _trends(scene),
    ]
    filled = [rrb.Vertical(*column) for column in columns if column]
    body: list[View] = [*_verdict(scene)]
    if filled:
        body.append(rrb.Horizontal(*filled))
    extra = _numbers(scene)
    if extra and not _is_bearing(scene):
        body.append(rrb.Grid(*extra))
    shares = [2, 7] if len(body) == 2 else None
    return rrb.Vertical(*body, row_shares=shares, name=name)


def _narrow(scene: Scene, title: str, timeline: str) -> View:
    solids = [*_solid(scene), *_waterfalls(scene)]
    rows: list[tuple[float, View]] = [
        (2.0, view) for view in _verdict(scene, title=title, evidence=False)
    ]
    rows += [(2.0, view) for view in _waveforms(scene, timeline)[:1]]
    rows += [(2.5, view) for view in _spectra(scene, legend=False)[:1]]
    if solids:
        rows.append((3.5, rrb.Horizontal(*solids)))
    if trends := _trends(scene)[:3]:
        rows.append((2.0, rrb.Horizontal(*trends)))
    if not rows:
        rows = [(1.0, view) for view in _numbers(scene)]
    return rrb.Vertical(
        *(view for _, view in rows), row_shares=[share for share, _ in rows], name=title
    )


def _foot(scenes: Iterable[Scene]) -> View | None:
    logs, lanes, panels = [], [], []
    for scene in scenes:
        logs += [f'{path}/**' for kind in ('log', 'text') for path in _of(scene, kind)]
        lanes += [f'{path}/**' for path in _of(scene, 'diagnostics')]
        panels += [
            rrb.TextDocumentView(origin=f'{path}/parameters', name=path.strip('/'))
            for path in _of(scene, 'checkpoint')
        ]
    views: list[View] = []
    if logs:
        views.append(rrb.TextLogView(origin='/', contents=logs, name='Log'))
    if lanes:
        views.append(_lanes('Health of the nodes', lanes))
    if panels:
        views.append(rrb.Tabs(*panels, name='Parameters'))
    return rrb.Horizontal(*views) if views else None
