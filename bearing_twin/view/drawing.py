# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One Rerun recording as it is drawn: the scenes of all namespaces and the layout of the views."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.view.blueprint import APPLICATION, automatic, layout
from bearing_twin.view.scene import namespace_of, Scene
from bearing_twin.view.timebase import Timebase
import rerun as rr
from rerun.chunk import McapReader

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from pathlib import Path

    from bearing_twin.bearing.geometry import Bearing

__all__ = ['Drawing', 'Look']

SETTLED = 1_000_000_000
"""A new topic is laid out when none has followed for this long, ns."""
FLUSH_TIMEOUT = 5.0


@dataclass(frozen=True)
class Look:
    """What is drawn how, see the parameters of ``RerunLogger``."""

    recording_id: str
    bearing: Bearing | None
    full_samples: bool
    sides: Mapping[str, int] | None
    timeline: str


class Drawing:
    """
    Draw messages to one sink; to be used by one thread at a time.

    Parameters
    ----------
    look
        What is drawn how.
    sink
        File or server of Rerun.
    complain
        Called with the topic and the reason when a message cannot be drawn.
    place
        The sink by name, for errors.

    Raises
    ------
    BearingTwinError
        If Rerun refuses the sink.

    """

    def __init__(
        self, look: Look, sink: Any, complain: Callable[[str, Exception], None], *, place: str
    ) -> None:
        self._look = look
        self._complain = complain
        self._recording = rr.RecordingStream(APPLICATION, recording_id=look.recording_id)
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
        try:
            self._recording.set_sinks(sink)
        except Exception as error:
            msg = f'Rerun cannot write {place} ({error}); choose another place'
            raise BearingTwinError(msg) from None

    def draw(self, topic: str, type_name: str, message: Any, time_ns: int, side: str) -> None:
        """Draw a message as ``RerunLogger.log`` describes; never raises."""
        try:
            namespace, name = namespace_of(topic)
            scene = self._scenes.get((side, namespace))
            if scene is None:
                scene = self._scenes[side, namespace] = Scene(
                    self._recording,
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

    def import_mcap(self, path: Path, lines: Iterable[str]) -> str:
        """Draw what Rerun itself can draw of an MCAP file; return why not, '' if it could."""
        self._native_lines.update(lines)
        try:
            reader = McapReader(path, recover=True)
            self._recording.send_chunks(reader.stream())
        except Exception as error:
            # A stranger's file; Rerun raises many kinds on damaged ones.
            return f'{type(error).__name__}: {error}'
        return ''

    def finish(self) -> None:
        """
        Draw what is held back and close the sink; a second time does nothing.

        Raises
        ------
        RuntimeError
            If the sink does not take what is left in time.

        """
        for scene in self._scenes.values():
            scene.flush()
        self._send_layout()
        self._recording.flush(timeout_sec=FLUSH_TIMEOUT)
        self._recording.disconnect()

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
        self._recording.send_blueprint(
            layout(titles, timeline=base.timeline, side_by_side=len(self._timebases) > 1)
            if base.stamped
            else automatic(
                self._scenes.values(), timeline=base.timeline, lines=sorted(self._native_lines)
            )
        )
