# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Layout of the Rerun views."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, cast, TYPE_CHECKING

from bearing_twin.view.rerun.pictures.texts import entity
from bearing_twin.view.rerun.views import (
    bearing_views,
    card_and_reasons,
    card_view,
    colour_legend,
    difference_views,
    envelope_views,
    fitted_views,
    is_bearing,
    lane_paths,
    lanes_view,
    lines_view,
    number_views,
    over_temperature_views,
    panel_views,
    paths_of,
    spectrum_views,
    temperature_views,
    verdict_lane,
    View,
    waterfall_views,
    waveform_views,
)
from bearing_twin.view.style import PAGES
from bearing_twin.view.trends import CALIBRATION, DIAGNOSIS, OVER_LIMITS, TWIN_STATE
import rerun.blueprint as rrb

if TYPE_CHECKING:
    from bearing_twin.view.rerun.scene import Scene


MOST_CARDS = 12
"""Largest number of bearings with cards on the common page; more could not be read."""
LONGEST = 22
"""Longest name above a card, characters; a card is a quarter of a laptop's screen wide."""


def layout(
    scenes: Mapping[str, Scene], *, timeline: str, side_by_side: bool = False, page: str = ''
) -> rrb.Blueprint:
    """
    Return the blueprint of scenes by title.

    The scenes are on tabs, or with ``side_by_side`` in columns. ``page`` is the name of the page
    in front; '': the first.
    """
    bearings = {title: scene for title, scene in scenes.items() if is_bearing(scene)}
    others = {title: scene for title, scene in scenes.items() if _other_views(scene)}
    besides = {t: s for t, s in bearings.items() if _is_of_twin(s, bearings.values())}
    bearings = {title: scene for title, scene in bearings.items() if title not in besides}
    shown = bearings or others
    parts: list[View]
    if side_by_side:
        narrow = _narrow if len(shown) < 3 else _narrowest
        pairs = (narrow(s, title, timeline) for title, s in shown.items())
        parts = [rrb.Horizontal(*pairs, name='Side by side')]
    elif len(shown) == 1 and bearings:
        parts = [page for scene in shown.values() for page in _pages(scene, timeline)]
    else:
        wide = [_wide(s, timeline, name=title, page=page) for title, s in shown.items()]
        parts = [*_all_bearings(shown, _unheard_lanes(scenes.values())), *wide]
        # The first bearing that has the page shows it in front.
        having = [w for w in wide if page in [v.name for v in cast('list[View]', w.contents)]]
        page = str(having[0].name) if having else page
    if not side_by_side:
        pages = (_vibration(s, timeline, name=f'Vibration: {t}') for t, s in besides.items())
        parts += [page for page in pages if page is not None]
    nodes = _nodes(scenes.values())
    if nodes:
        parts.append(rrb.Horizontal(*nodes, name='Nodes'))
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


def pages_of(blueprint: rrb.Blueprint) -> list[str]:
    """Return the names of the pages of :func:`layout`, in their order."""
    found: list[str] = []
    left: list[Any] = [blueprint.root_container]
    while left:
        part = left.pop(0)
        if isinstance(part, (rrb.Tabs, rrb.Vertical, rrb.Horizontal, rrb.Grid)):
            found += [part.name] if part.name in PAGES and part.name not in found else []
            left += part.contents
    return found


def automatic(
    scenes: Iterable[Scene], *, timeline: str, lines: Iterable[str], tables: Iterable[str]
) -> rrb.Blueprint:
    """
    Return a blueprint with one view for the numbers of a topic; the viewer adds the rest.

    ``lines`` are topics that Rerun itself draws as time series, ``tables`` topics that it reads
    but cannot draw.
    """
    views = [view for scene in scenes for view in number_views(scene)]
    views += [lines_view(topic, [f'{topic}/**'], legend=True) for topic in lines]
    query = rrb.archetypes.DataframeQuery(timeline=timeline)
    views += [rrb.DataframeView(origin=topic, name=topic, query=query) for topic in tables]
    return rrb.Blueprint(
        rrb.Grid(*views),
        rrb.SelectionPanel(state='collapsed'),
        rrb.TimePanel(state='collapsed', timeline=timeline),
        auto_views=True,
        auto_layout=True,
    )


def _is_of_twin(scene: Scene, bearings: Iterable[Scene]) -> bool:
    """Whether it holds only the vibration of a twin beside its machine, such as twin/vibration."""
    above = scene.root.rpartition('/')[0]
    beside = any(s.root == above and 'twin_state' in s.contents.values() for s in bearings)
    return beside and set(scene.contents.values()) <= {'vibration'}


def _unheard_lanes(scenes: Iterable[Scene]) -> list[str]:
    """Return the lanes of health of bearings without any verdict, such as without a sensor."""
    scenes = list(scenes)
    judged = {scene.asset.namespace for scene in scenes if lane_paths(scene)}
    return [
        f'{path}/{entity(name)}'
        for scene in scenes
        for path in paths_of(scene, 'diagnostics')
        for namespace, source in scene.asset.sources.items()
        for name in source.lapsed
        if namespace not in judged
    ]


def _all_bearings(scenes: Mapping[str, Scene], unheard: Sequence[str]) -> list[View]:
    """Return the page of the verdicts of several bearings: over time, and as cards."""
    lanes = [*(v for scene in scenes.values() for v in lane_paths(scene)), *unheard]
    cards = [
        # The viewer would cut off the end of a long name, by which similar names differ.
        card_view(v, t if len(t) <= LONGEST else f'…{t[-LONGEST:]}')
        for t, scene in scenes.items()
        for v in paths_of(scene, 'diagnosis')
    ]
    if not cards:
        return []
    views: list[View] = [lanes_view('Verdicts over time', lanes)]
    # Heights in pixels: 40 for a lane, 100 for a row of cards.
    heights = [60 + 40 * len(lanes)]
    if len(cards) <= MOST_CARDS:
        views.append(rrb.Grid(*cards, grid_columns=min(4, len(cards))))
        heights.append(-(-len(cards) // 4) * 100)
    return [rrb.Vertical(*views, row_shares=heights, name='All bearings')]


def _rows(*rows: tuple[float, Sequence[View]], name: str) -> View | None:
    """Return rows of views with their shares of the height; None if there is no view."""
    filled = [(share, views) for share, views in rows if views]
    if not filled:
        return None
    return rrb.Vertical(
        *(rrb.Horizontal(*views) for _, views in filled),
        row_shares=[share for share, _ in filled],
        name=name,
    )


def _columns(left: Sequence[View], right: Sequence[View], *, name: str) -> View | None:
    """Return a column of views, and right of it others in rows of two; None if there are none."""
    columns: list[tuple[float, View]] = []
    if left:
        columns.append((2.0, rrb.Vertical(*left)))
    if right:
        columns.append((3.0, rrb.Grid(*right, grid_columns=2)))
    if not columns:
        return None
    shares, shown = zip(*columns, strict=True)
    return rrb.Horizontal(*shown, column_shares=shares, name=name)


def _pages(scene: Scene, timeline: str) -> list[View]:
    """Return the pages of a bearing. Each page fits the screen of a laptop."""
    twin = panel_views(scene, 'twin_state', TWIN_STATE[1:])
    evidence = panel_views(scene, 'diagnosis', DIAGNOSIS)
    verdict = [*card_and_reasons(scene), *bearing_views(scene), *envelope_views(scene)]
    known = scene.asset.panels
    levels = {'baseline' if 'baseline' in known else 'level'}
    if 'severity' in known:
        levels.add('velocity')
    trends = [
        *verdict_lane(scene),
        *panel_views(
            scene, 'diagnosis', (OVER_LIMITS, *(p for p in DIAGNOSIS if p.key in levels))
        ),
        *temperature_views(scene),
    ]
    # At half the height of the page, a waterfall is wide enough.
    below, beside = bearing_views(scene), temperature_views(scene)
    if not below:
        below, beside = beside, below
    fitted = [
        rrb.TextDocumentView(origin=f'{path}/words', name='What the vibration tells')
        for path in paths_of(scene, 'calibration')
    ]
    pages = (
        _rows((5.6, verdict), (2.4, trends if verdict else []), name='Verdict'),
        _vibration(scene, timeline, name='Vibration'),
        _rows((5, evidence[:3]), (0.8, colour_legend(scene)), (5, evidence[3:]), name='Evidence'),
        _columns(
            [*waterfall_views(scene), *below],
            [*over_temperature_views(scene), *beside],
            name='Temperature',
        ),
        _rows((4, twin[:3]), (4, twin[3:]), name='Twin'),
        _rows(
            (3.4, fitted_views(scene)),
            (3.8, [*difference_views(scene), *panel_views(scene, 'calibration', CALIBRATION[:1])]),
            (3.2, panel_views(scene, 'calibration', CALIBRATION[1:])),
            (4.6, fitted),
            name='Calibration',
        ),
    )
    return [page for page in pages if page is not None]


def _vibration(scene: Scene, timeline: str, *, name: str) -> View | None:
    waves = waveform_views(scene, timeline)
    return _rows((4, waves[:2]), (4, [*waves[2:], *spectrum_views(scene)]), name=name)


def _wide(scene: Scene, timeline: str, *, name: str, page: str) -> View:
    if not is_bearing(scene):
        return rrb.Grid(*_other_views(scene), name=name)
    pages = _pages(scene, timeline)
    return rrb.Tabs(*pages, active_tab=_front(pages, page), name=name)


def _other_views(scene: Scene) -> list[View]:
    """Return the views of a scene without a bearing, besides those of its nodes."""
    return [*temperature_views(scene), *number_views(scene)]


def _front(parts: Sequence[View], page: str) -> int:
    names = [part.name for part in parts]
    return names.index(page) if page in names else 0


def _narrow(scene: Scene, title: str, timeline: str) -> View:
    if not is_bearing(scene):
        return rrb.Vertical(*_other_views(scene), name=title)
    # Beside card and reasons, which need their height to be read.
    seen = [*bearing_views(scene), *envelope_views(scene)] or spectrum_views(scene)
    beside = [rrb.Vertical(*seen, row_shares=[2.0, 3.0][-len(seen) :])] if seen else []
    page = _rows(
        (5.6, [*card_and_reasons(scene, title, (1, 5)), *beside]),
        (1.2, verdict_lane(scene)),
        # A waterfall as wide as a sixth of the screen would be all labels.
        (2.2, [*waveform_views(scene, timeline)[:1], *temperature_views(scene)]),
        name=title,
    )
    assert page is not None
    return page


def _narrowest(scene: Scene, title: str, timeline: str) -> View:
    """Return the column of one of three or more recordings: the views in which they differ."""
    views = [
        *card_and_reasons(scene, title),
        *envelope_views(scene),
        *verdict_lane(scene),
        *waveform_views(scene, timeline)[:1],
    ]
    shares = [5.6, 3.4, 1.6, 1.4] if len(views) == 4 else None
    return rrb.Vertical(*(views or _other_views(scene)), row_shares=shares, name=title)


def _nodes(scenes: Iterable[Scene]) -> list[View]:
    """Return the views of the nodes: log, health, parameters."""
    logs, lanes, panels = [], [], []
    for scene in scenes:
        logs += [f'{path}/**' for kind in ('log', 'text') for path in paths_of(scene, kind)]
        lanes += [f'{path}/**' for path in paths_of(scene, 'diagnostics')]
        panels += [
            rrb.TextDocumentView(origin=f'{path}/parameters', name=path.strip('/'))
            for path in paths_of(scene, 'checkpoint')
        ]
    left: list[View] = []
    if logs:
        # The text names its node: a column of entities would cut it off.
        columns = rrb.archetypes.TextLogColumns(text_log_columns=['LogLevel', 'Body'])
        left.append(rrb.TextLogView(origin='/', contents=logs, name='Log', columns=columns))
    if panels:
        left.append(rrb.Tabs(*panels, name='Parameters'))
    # A machine has a dozen lanes, which need the whole height.
    right = [lanes_view('Health of the nodes', lanes)] if lanes else []
    return [*([rrb.Vertical(*left)] if left else []), *right]
