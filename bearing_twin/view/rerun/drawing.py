# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What is drawn of the messages: the scenes of all namespaces and the layout of the views."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TYPE_CHECKING

from bearing_twin.stamps import NANO
from bearing_twin.view.rerun.blueprint import automatic, layout
from bearing_twin.view.rerun.scene import namespace_of, Scene
from bearing_twin.view.timebase import Timebase

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from bearing_twin.bearing.geometry import Bearing
    from bearing_twin.view.rerun.canvas import Emit

__all__ = ['Drawing', 'Look']

SETTLED = NANO
"""A new topic is laid out when none has followed for this long, ns."""
TICK = 200_000_000
"""What is held is sent this often, ns: eyes take it for at once."""
SLOW = 5
"""Ticks after which the slow lines are sent too."""


@dataclass(frozen=True)
class Look:
    """What is drawn how, see the parameters of ``RerunLogger``."""

    bearing: Bearing | None
    full_samples: bool
    sides: Mapping[str, int] | None
    timeline: str


class Drawing:
    """
    Draw messages; to be used by one thread at a time.

    Parameters
    ----------
    look
        What is drawn how.
    emit
        Where the marks go.
    complain
        Called with the topic and the reason when a message cannot be drawn.

    """

    def __init__(self, look: Look, emit: Emit, complain: Callable[[str, Exception], None]) -> None:
        self._look = look
        self._emit = emit
        self._complain = complain
        self._timebases = {'': Timebase(look.timeline)}
        if look.sides:
            self._timebases = {
                side: Timebase('since_start', zero=start) for side, start in look.sides.items()
            }
        self._scenes: dict[tuple[str, str], Scene] = {}
        self._native_lines: set[str] = set()
        self._laid_out = 0
        self._known = 0
        self._changed = 0
        self._flushed = 0
        self._ticks = 0

    def draw(self, topic: str, type_name: str, message: Any, time_ns: int, side: str) -> None:
        """Draw a message as ``RerunLogger.log`` describes; never raises."""
        try:
            namespace, name = namespace_of(topic)
            scene = self._scenes.get((side, namespace))
            if scene is None:
                scene = self._scenes[side, namespace] = Scene(
                    self._emit,
                    f'/{side}{namespace}' if side else namespace,
                    self._timebases[side],
                    bearing=self._look.bearing,
                    full=self._look.full_samples,
                )
            scene.draw(name, type_name, message, time_ns)
            self._lay_out(time_ns)
        except Exception as error:
            # The caller is a node, the message a stranger's: a picture is not worth a failure.
            self._complain(topic, error)
        if not 0 <= time_ns - self._flushed < TICK:
            self._flushed = time_ns
            self._ticks += 1
            self._flush(slow=self._ticks % SLOW == 0)

    def add_native(self, lines: Iterable[str]) -> None:
        """Lay topics out that Rerun itself draws as time series."""
        self._native_lines.update(lines)

    def finish(self) -> None:
        """Draw what is held back; never raises."""
        self._flush(slow=True)
        self._send_layout()

    def _flush(self, *, slow: bool) -> None:
        for scene in self._scenes.values():
            scene.flush(self._complain, slow=slow)

    def _lay_out(self, now: int) -> None:
        known = sum(len(scene.contents) for scene in self._scenes.values())
        if known != self._known:
            self._known, self._changed = known, now
        elif known != self._laid_out and now - self._changed > SETTLED:
            self._send_layout()

    def _send_layout(self) -> None:
        known = sum(len(scene.contents) for scene in self._scenes.values())
        if known == self._laid_out or not known:
            return
        self._laid_out = known
        titles = {' '.join(filter(None, key)) or '/': scene for key, scene in self._scenes.items()}
        base = next(iter(self._timebases.values()))
        blueprint = (
            layout(titles, timeline=base.timeline, side_by_side=len(self._timebases) > 1)
            if base.stamped
            else automatic(
                self._scenes.values(), timeline=base.timeline, lines=sorted(self._native_lines)
            )
        )
        self._emit(lambda recording: recording.send_blueprint(blueprint), lasting=True)
