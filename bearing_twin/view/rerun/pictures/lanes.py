# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Coloured lanes: a state over time, legible from across a room."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.view.rerun.pictures.picture import Asset, Picture
from bearing_twin.view.rerun.pictures.texts import entity
from bearing_twin.view.style import LANE_LEVELS
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Canvas
    from bearing_twin.view.style import State


AGAIN = 10_000_000_000
"""Period after which unchanged data are logged again, ns: servers forget, viewers come late."""


STALE = [state.key for state in LANE_LEVELS].index('stale')
"""Level of a status that is no longer about the present."""
SILENT = 5_000_000_000
"""Time without a status after which diagnostic_aggregator takes a node for dead, ns."""


class Lane:
    """One lane; ``states`` are indexed by the number in the message."""

    def __init__(self, canvas: Canvas, name: str, states: Sequence[State]) -> None:
        self._canvas = canvas
        self._name = name
        self._states = states
        self._last: int | None = None
        self._time = 0

    def set(self, number: int, time: int) -> bool:
        """
        Log the state at ``time`` in ns if it has changed, or again after ``AGAIN``.

        Return whether it was logged.
        """
        if not 0 <= number < len(self._states):
            return False
        if number == self._last and 0 <= time - self._time < AGAIN:
            return False
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
        return True


class _Heard(NamedTuple):
    """Latest arrival of a status, ns."""

    at: int
    step: int
    """Time since the arrival before; 0 of the first."""
    lane: Lane


class HealthPicture(Picture):
    """
    Draw a DiagnosticArray: a lane for each status.

    A status that is not sent again turns stale after 5 s, or three times as long as it was from
    one to the next: its node has ended, or hangs.
    """

    kind = 'diagnostics'

    def __init__(self, canvas: Canvas, asset: Asset) -> None:
        super().__init__(canvas, asset)
        self._heard: dict[str, _Heard] = {}

    def draw(self, message: Any, time: int) -> bool:
        """Log the levels at ``time`` in ns."""
        now = self.asset.received
        for status in message.status:
            name = str(status.name)
            before = self._heard.get(name)
            lane = before.lane if before else Lane(self.canvas, entity(name), LANE_LEVELS)
            self._heard[name] = _Heard(now, now - before.at if before else 0, lane)
            level = int(status.level)
            lane.set(level, time)
            self._tell(name, (str(status.message), time) if level == STALE else None)
        for name, (at, step, lane) in self._heard.items():
            if step and now - at > max(SILENT, 3 * step) and lane.set(STALE, time):
                node = name.partition(': ')[0]
                self._tell(name, (f'{node} is silent: it has ended or hangs', time))
        return True

    def _tell(self, name: str, told: tuple[str, int] | None) -> None:
        """Tell the bearing whose verdict a status is about why there is none on the present."""
        if (namespace := _judged(name)) is not None:
            self.asset.sources[namespace].lapsed[name] = told


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
