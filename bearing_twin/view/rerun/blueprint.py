# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""How the views are laid out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.view.over_temperature import QUANTITIES
from bearing_twin.view.rerun.bearing3d import MAGNIFIED, SLOWED
from bearing_twin.view.rerun.waveform import AXES
from bearing_twin.view.trends import CALIBRATION, DIAGNOSIS, OVER_LIMITS, TWIN_STATE
import rerun.blueprint as rrb

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from bearing_twin.view.rerun.scene import Scene
    from bearing_twin.view.trends import Panel

__all__ = ['PAGES', 'automatic', 'layout']

PAGES = ('Verdict', 'Vibration', 'Evidence', 'Temperature', 'Twin', 'Calibration', 'Nodes')
"""Pages of a bearing, each of them for a laptop's screen."""
CLOSE = 0.25
"""Length of the close look at the waveform, s."""
WIDE = 10.0
"""Length of the waveform's envelope, s."""

MOST_CARDS = 12
"""Bearings up to which each has a card on the page of all; more could not be read."""

View = rrb.View | rrb.Container


def layout(
    scenes: Mapping[str, Scene],
    *,
    timeline: str,
    side_by_side: bool = False,
    page: str = '',
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
    page
        Name of the page in front; '': the first.

    """
    bearings = {title: scene for title, scene in scenes.items() if _is_bearing(scene)}
    others = {title: scene for title, scene in scenes.items() if scene.contents}
    besides = {t: s for t, s in bearings.items() if _is_of_twin(s, bearings.values())}
    bearings = {title: scene for title, scene in bearings.items() if title not in besides}
    shown = bearings or others
    parts: list[View]
    if side_by_side:
        narrow = _narrow if len(shown) < 3 else _narrowest
        pairs = rrb.Horizontal(*(narrow(s, title, timeline) for title, s in shown.items()))
        legend = next((view for s in shown.values() for view in _colours(s)), None)
        rows = [pairs, legend] if legend else [pairs]
        parts = [rrb.Vertical(*rows, row_shares=[1.0, 0.06][: len(rows)], name='Side by side')]
    elif len(shown) == 1 and bearings:
        parts = [page for scene in shown.values() for page in _pages(scene, timeline)]
    else:
        wide = [_wide(s, timeline, name=title, page=page) for title, s in shown.items()]
        parts = [*_all_bearings(shown), *wide]
        # The page is one of the first bearing's.
        page = str(wide[0].name) if bearings and page not in ('', 'Nodes') else page
    if not side_by_side:
        pages = (_vibration(s, timeline, name=f'Vibration: {t}') for t, s in besides.items())
        parts += [page for page in pages if page is not None]
    nodes = _nodes(scenes.values())
    if nodes:
        parts.append(rrb.Vertical(*nodes, name='Nodes'))
    return rrb.Blueprint(
        rrb.Tabs(*parts, active_tab=_front(parts, page))
        if len(parts) > 1
        else rrb.Vertical(*parts),
        rrb.BlueprintPanel(state='collapsed'),
        rrb.SelectionPanel(state='collapsed'),
        rrb.TimePanel(state='collapsed', timeline=timeline, play_state='following'),
        auto_views=False,
        auto_layout=False,
    )


def automatic(
    scenes: Iterable[Scene],
    *,
    timeline: str,
    lines: Iterable[str] = (),
    tables: Iterable[str] = (),
) -> rrb.Blueprint:
    """
    Return a blueprint with one view for the numbers of a topic; the viewer adds the rest.

    ``lines`` are topics that Rerun itself draws as time series, ``tables`` those that it reads but
    does not know how to draw.
    """
    views = [view for scene in scenes for view in _numbers(scene)]
    views += [_lines(topic, [f'{topic}/**'], legend=True) for topic in lines]
    query = rrb.archetypes.DataframeQuery(timeline=timeline)
    views += [rrb.DataframeView(origin=topic, name=topic, query=query) for topic in tables]
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


def _is_of_twin(scene: Scene, bearings: Iterable[Scene]) -> bool:
    """Whether it is the vibration of a twin beside its machine, as twin/vibration."""
    above = scene.root.rpartition('/')[0]
    beside = any(s.root == above and 'twin_state' in s.contents.values() for s in bearings)
    return beside and set(scene.contents.values()) <= {'vibration'}


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


def _all_time() -> rrb.TimeAxis:
    """
    Return the axis of views over time: from the beginning to the end.

    With the axis that views share Rerun opens at half a minute on either side of the cursor.
    """
    ends = rrb.TimeRange(rrb.TimeRangeBoundary.infinite(), rrb.TimeRangeBoundary.infinite())
    return rrb.TimeAxis(link=rrb.components.LinkAxis.Independent, view_range=ends)


def _lines(
    name: str,
    contents: Sequence[str],
    *,
    window: rrb.VisibleTimeRange | None = None,
    legend: bool = False,
    span: tuple[float, float] | None = None,
) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        origin='/',
        contents=list(contents),
        name=name,
        axis_x=rrb.TimeAxis(link=rrb.components.LinkAxis.Independent) if window else _all_time(),
        axis_y=rrb.ScalarAxis(range=span) if span else None,
        plot_legend=rrb.PlotLegend(rrb.Corner2D.LeftTop, visible=legend),
        time_ranges=[window] if window else None,
    )


def _lanes(name: str, contents: Sequence[str]) -> rrb.StateTimelineView:
    return rrb.StateTimelineView(
        origin='/', contents=list(contents), name=name, time_view=_all_time()
    )


def _verdict(path: str, title: str) -> View:
    name = f'Verdict: {title}' if title else 'Verdict'
    return rrb.Spatial2DView(origin=f'{path}/card', name=name)


def _card(scene: Scene, title: str = '', shares: tuple[float, float] = (3, 10)) -> list[View]:
    """Return card and reasons, with their shares of the height."""
    return [
        rrb.Vertical(
            _verdict(path, title),
            rrb.TextDocumentView(origin=f'{path}/words', name='Reasons'),
            row_shares=shares,
        )
        for path in _of(scene, 'diagnosis')
    ]


def _all_bearings(scenes: Mapping[str, Scene]) -> list[View]:
    """Return the page of the verdicts of several bearings: over time, and as cards."""
    lanes = [v for scene in scenes.values() for v in _lane_contents(scene)]
    cards = [_verdict(v, t) for t, scene in scenes.items() for v in _of(scene, 'diagnosis')]
    if not lanes:
        return []
    views: list[View] = [_lanes('Verdicts over time', lanes)]
    views += [rrb.Grid(*cards)] if len(cards) <= MOST_CARDS else []
    return [rrb.Vertical(*views, name='All bearings')]


def _lane_contents(scene: Scene) -> list[str]:
    return [f'{path}/verdict' for path in _of(scene, 'diagnosis')]


def _lane(scene: Scene) -> list[View]:
    lanes = _lane_contents(scene)
    lanes += [f'{path}/temperature_status' for path in _of(scene, 'twin_state')]
    return [_lanes('Verdict over time', lanes)] if _of(scene, 'diagnosis') else []


def _solid(scene: Scene) -> list[View]:
    return [
        rrb.Spatial3DView(
            origin=f'{path}/bearing',
            name=f'Bearing, {SLOWED:g} x slower, shift x {MAGNIFIED:g}',
            eye_controls=rrb.EyeControls3D(
                position=[15.0, -24.0, 114.0], look_target=[0.0, -6.0, 0.0], eye_up=[0.0, 1.0, 0.0]
            ),
            line_grid=False,
        )
        for path in _of(scene, 'twin_state')
    ]


def _waveforms(scene: Scene, timeline: str) -> list[View]:
    peak = scene.asset.scales.vibration
    views: list[View] = []
    for path in _of(scene, 'vibration'):
        views += [
            _lines(
                f'Vibration [{_unit(scene)}], last {CLOSE:g} s',
                [f'{path}/samples/**'],
                window=_window(timeline, CLOSE),
                span=(-peak, peak) if peak else None,
            ),
            _lines(
                f'Extremes over {WIDE:g} s [{_unit(scene)}]: {_axes(scene)}',
                [f'{path}/envelope/**'],
                window=_window(timeline, WIDE),
            ),
            rrb.Spatial2DView(origin=f'{path}/spectrogram', name='Spectrogram of the last minute'),
        ]
    return views


def _unit(scene: Scene) -> str:
    return scene.asset.unit or 'unit unknown'


def _axes(scene: Scene) -> str:
    """Name the axes that have samples by their colours; a legend would cover the lines."""
    return ', '.join(f'{n} {c}' for n, c in AXES.values() if n in scene.asset.panels)


def _waterfalls(scene: Scene) -> list[View]:
    return [
        rrb.Spatial3DView(
            origin=f'{path}/waterfall',
            name='Waveform over temperature',
            eye_controls=rrb.EyeControls3D(
                position=[0.5, -6.5, 6.5], look_target=[5.2, 3.6, -0.7], eye_up=[0.0, 0.0, 1.0]
            ),
            line_grid=False,
        )
        for path in _of(scene, 'vibration')
        if _of(scene, 'temperature') or _of(scene, 'twin_state')
    ]


def _bars(name: str, origin: str) -> View:
    # A legend would cover lines and names entities, not what they are.
    return rrb.BarChartView(origin=origin, name=name, plot_legend=rrb.PlotLegend(visible=False))


def _spectra(scene: Scene) -> list[View]:
    return [_bars(f'Spectrum [{_unit(scene)} over Hz]', path) for path in _of(scene, 'spectrum')]


def _envelope_spectra(scene: Scene, *, legend: bool = True, near: bool = True) -> list[View]:
    views: list[View] = []
    colours = _colours(scene) if legend else []
    for path in _of(scene, 'envelope_spectrum'):
        name = 'Squared envelope spectrum: modulation index over Hz'
        whole = _bars(name if legend else 'Envelope spectrum: index over Hz', f'{path}/whole')
        close = _bars('First harmonic from near', f'{path}/near')
        parts = [(6.0, whole), *((0.55, view) for view in colours)]
        parts += [(4.0, close)] if near and 'near' in scene.asset.panels else []
        shares, shown = zip(*parts, strict=True)
        views.append(rrb.Vertical(*shown, row_shares=shares))
    return views


def _colours(scene: Scene) -> list[View]:
    return [
        rrb.Spatial2DView(origin=f'{path}/legend', name='Colours', titlebar=False)
        for path in _of(scene, 'envelope_spectrum')
    ]


def _over_temperature(scene: Scene) -> list[View]:
    """Return a view for each quantity over temperature."""
    return [
        _bars(
            f'{name}{"" if key == "slip" else ", change"} [%] over °C',
            f'{path}/over_temperature/{key}',
        )
        for path in _of(scene, 'vibration')
        for key, name in QUANTITIES.items()
        if f'{path}/over_temperature/{key}' in scene.asset.panels
    ]


def _panels(scene: Scene, kind: str, panels: Sequence[Panel]) -> list[View]:
    """Return a view for each panel that has values."""
    return [
        _lines(
            panel.named.replace('[unit]', f'[{_unit(scene)}]'),
            [f'{path}/{panel.key}/**'],
        )
        for path in _of(scene, kind)
        for panel in panels
        if panel.key in scene.asset.panels
    ]


def _temperatures(scene: Scene) -> list[View]:
    contents = [f'{path}/measured' for path in _of(scene, 'temperature')]
    contents += [f'{path}/temperature/**' for path in _of(scene, 'twin_state')]
    name = 'Temperature [°C]'
    if 'temperature' in scene.asset.panels:
        name += ', twin orange'
    span = scene.asset.scales.temperature
    return [_lines(name, contents, span=span)] if contents else []


def _over_each_other(scene: Scene) -> list[View]:
    """Return views of machine (grey) and fitted twin (blue)."""
    views: list[View] = []
    for path in _of(scene, 'calibration'):
        if 'fitted_spectrum' in scene.asset.panels:
            views.append(_bars('Machine grey, twin blue [dB over Hz]', f'{path}/spectrum'))
        if 'fitted_turn' in scene.asset.panels:
            views.append(_bars(f'One revolution [{_unit(scene)} over ms]', f'{path}/turn'))
    return views


def _numbers(scene: Scene) -> list[View]:
    """Return views of topics that are not the bearing's."""
    return [_lines(path, [f'{path}/fields/**'], legend=True) for path in _of(scene, 'numbers')]


def _rows(*rows: tuple[float, Sequence[View]], name: str) -> View | None:
    """Return rows of views with their shares of the height; None where there is no view."""
    filled = [(share, views) for share, views in rows if views]
    if not filled:
        return None
    return rrb.Vertical(
        *(rrb.Horizontal(*views) for _, views in filled),
        row_shares=[share for share, _ in filled],
        name=name,
    )


def _columns(left: Sequence[View], right: Sequence[View], *, name: str) -> View | None:
    """Return views above each other, and beside them others in rows of two."""
    if not right:
        return None
    beside = rrb.Grid(*right, grid_columns=2)
    return rrb.Horizontal(*([rrb.Vertical(*left)] if left else []), beside, name=name)


def _pages(scene: Scene, timeline: str) -> list[View]:
    """Return the pages of a bearing: what each answers fits a laptop's screen."""
    envelope, waves = _envelope_spectra(scene), _waveforms(scene, timeline)
    twin = _panels(scene, 'twin_state', TWIN_STATE[1:])
    evidence = _panels(scene, 'diagnosis', DIAGNOSIS)
    verdict = [*_card(scene), *_solid(scene), *envelope] or [*waves[:1], *_spectra(scene)]
    levels = ('level', 'velocity') if 'severity' in scene.asset.panels else ('level',)
    trends = [
        *_lane(scene),
        *_panels(scene, 'diagnosis', (OVER_LIMITS, *(p for p in DIAGNOSIS if p.key in levels))),
        *_temperatures(scene),
    ]
    fitted = [
        rrb.TextDocumentView(origin=f'{path}/words', name='What the vibration tells')
        for path in _of(scene, 'calibration')
    ]
    pages = (
        _rows((5.6, verdict), (2.4, trends), name='Verdict'),
        _vibration(scene, timeline, name='Vibration'),
        _rows((5, evidence[:3]), (0.5, _colours(scene)), (5, evidence[3:]), name='Evidence'),
        _columns(
            [*_waterfalls(scene), *_solid(scene)],
            [*_over_temperature(scene), *_temperatures(scene)],
            name='Temperature',
        ),
        _rows((4, twin[:3]), (4, twin[3:]), name='Twin'),
        _rows(
            (3, _panels(scene, 'calibration', CALIBRATION)),
            (3, _over_each_other(scene)),
            (4, fitted),
            name='Calibration',
        ),
    )
    return [page for page in pages if page is not None]


def _vibration(scene: Scene, timeline: str, *, name: str) -> View | None:
    waves = _waveforms(scene, timeline)
    return _rows((4, waves[:2]), (4, [*waves[2:], *_spectra(scene)]), name=name)


def _wide(scene: Scene, timeline: str, *, name: str, page: str) -> View:
    if not _is_bearing(scene):
        return rrb.Grid(*_numbers(scene), name=name)
    pages = _pages(scene, timeline)
    return rrb.Tabs(*pages, active_tab=_front(pages, page), name=name)


def _front(parts: Sequence[View], page: str) -> int:
    names = [part.name for part in parts]
    return names.index(page) if page in names else 0


def _narrow(scene: Scene, title: str, timeline: str) -> View:
    if not _is_bearing(scene):
        return rrb.Vertical(*_numbers(scene), name=title)
    # Beside card and reasons, so that these have the height to be read.
    seen = [*_solid(scene), *_envelope_spectra(scene, legend=False)] or _spectra(scene)
    page = _rows(
        (5.3, [*_card(scene, title, (1, 5)), *([rrb.Vertical(*seen)] if seen else [])]),
        (1.5, _lane(scene)),
        # A waterfall as wide as a sixth of the screen would be all labels.
        (2.2, [*_waveforms(scene, timeline)[:1], *_temperatures(scene)]),
        name=title,
    )
    assert page is not None
    return page


def _narrowest(scene: Scene, title: str, timeline: str) -> View:
    """Return one of three recordings or more: what tells them apart, one above the other."""
    views = [
        *_card(scene, title, (2, 5)),
        *_envelope_spectra(scene, legend=False, near=False),
        *_lane(scene),
        *_waveforms(scene, timeline)[:1],
    ]
    shares = [5.2, 2.7, 1.7, 1.8] if len(views) == 4 else None
    return rrb.Vertical(*(views or _numbers(scene)), row_shares=shares, name=title)


def _nodes(scenes: Iterable[Scene]) -> list[View]:
    """Return what is about the nodes: log, health, parameters."""
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
        # The text names its node: a column of entities would cut it.
        columns = rrb.archetypes.TextLogColumns(text_log_columns=['LogLevel', 'Body'])
        views.append(rrb.TextLogView(origin='/', contents=logs, name='Log', columns=columns))
    if lanes:
        views.append(_lanes('Health of the nodes', lanes))
    if panels:
        views.append(rrb.Tabs(*panels, name='Parameters'))
    return views
