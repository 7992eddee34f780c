# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Coloured lanes: a state over time, legible from across a room."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

from bearing_twin.view.rerun.pictures.picture import Asset, Picture
from bearing_twin.view.rerun.pictures.texts import entity
from bearing_twin.view.style import LANE_LEVELS
import rerun as rr

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bearing_twin.view.rerun.canvas import Canvas
    from bearing_twin.view.style import State


AGAIN = 10_000_000_000
"""Period after which unchanged data are logged again, ns: servers forget, viewers come late."""


STALE = [state.key for state in LANE_LEVELS].index('stale')
"""Level of a status that is no longer about the present."""


class Lane:
    """One lane; ``states`` are indexed by the number in the message."""

    def __init__(self, canvas: Canvas, name: str, states: Sequence[State]) -> None:
        self._canvas = canvas
        self._name = name
        self._states = states
        self._last: int | None = None
        self._time = 0

    def set(self, number: int, time: int) -> None:
        """Log the state at ``time`` in ns if it has changed, or again after ``AGAIN``."""
        if not 0 <= number < len(self._states):
            return
        if number == self._last and 0 <= time - self._time < AGAIN:
            return
        self._last, self._time = number, time
        self._canvas.once(
            self._name,
            rr.StateConfiguration(
                values=[state.key for state in self._states],
                labels=[state.label for state in self._states],
                colors=[state.colour for state in self._states],
            ),
        )
        self._canvas.put(self._name, time, rr.StateChange(state=self._states[number].key))


class HealthPicture(Picture):
    """Draw a DiagnosticArray: a lane for each status."""

    kind = 'diagnostics'

    def __init__(self, canvas: Canvas, asset: Asset) -> None:
        super().__init__(canvas, asset)
        self._lanes: dict[str, Lane] = {}

    def draw(self, message: Any, time: int) -> bool:
        """Log the levels at ``time`` in ns."""
        for status in message.status:
            name = entity(status.name)
            lane = self._lanes.get(name)
            if lane is None:
                lane = self._lanes[name] = Lane(self.canvas, name, LANE_LEVELS)
            level = int(status.level)
            lane.set(level, time)
            if (namespace := _judged(status.name)) is not None:
                told = (str(status.message), time) if level == STALE else None
                self.asset.sources[namespace].lapsed[status.name] = told
        return True


def _judged(name: str) -> str | None:
    """
    Return the namespace of the bearing whose verdict a status is about; None for other statuses.

    Examples
    --------
    >>> _judged('diagnosis: bearing'), _judged('plant/fleet: line3/pump bearing')
    ('', '/plant/line3/pump')

    """
    node, _, part = name.partition(': ')
    *asset, last = part.rsplit(' ', 1)
    if last != 'bearing':
        return None
    return '/'.join(['', *filter(None, (node.rpartition('/')[0], *asset))]).rstrip('/')
