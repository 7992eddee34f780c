# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Draw ROS messages in Rerun as they come."""

from __future__ import annotations

import logging
import socket
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.view.blueprint import APPLICATION, automatic, layout
from bearing_twin.view.scene import namespace_of, Scene
from bearing_twin.view.timebase import Timebase
import rerun as rr
from rerun.chunk import McapReader

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path
    from types import TracebackType

    from bearing_twin.bearing.geometry import Bearing

__all__ = ['RerunLogger']

SETTLED = 1_000_000_000
"""A new topic is laid out when none has followed for this long, ns."""
COMPLAINTS = 20
"""Most reasons that are kept of messages that could not be drawn."""


class RerunLogger:
    """
    Draw messages to a Rerun file, to a Rerun server, or to both.

    Viewers connect to the server when they like and get the recent past; one that is absent or
    killed delays nobody, one frozen for minutes does: Rerun waits once its buffers are full.
    Nothing that a message holds raises: what cannot be drawn is counted
    in `failed` and explained in `problems`.

    Parameters
    ----------
    recording_id
        Name of the recording; files and servers of the same one belong together.
    rrd
        File to write; it must not exist.
    serve
        Address and port of a server for live viewers.
    memory_limit
        Most memory of the server; the oldest is dropped.
    bearing
        Geometry to draw, where the messages name none of the catalogue.
    full_samples
        Draw every sample of the vibration instead of a part of each second and its envelope.
    sides
        Names of recordings that are drawn side by side, with the time in ns at which each begins;
        time counts from there.
    timeline
        Timeline of messages by their stamps; any other name: by their arrival, for the viewer to
        lay out.

    Raises
    ------
    BearingTwinError
        If the file exists or cannot be made, or the port is taken.

    """

    def __init__(
        self,
        *,
        recording_id: str,
        rrd: Path | None = None,
        serve: tuple[str, int] | None = None,
        memory_limit: str = '256MB',
        bearing: Bearing | None = None,
        full_samples: bool = False,
        sides: Mapping[str, int] | None = None,
        timeline: str = 'ros_time',
    ) -> None:
        self.failed = 0
        """Messages that could not be drawn."""
        self.problems: dict[str, str] = {}
        """Reason by topic."""
        # The first text loads pandas, where it is installed: a second that no message shall wait.
        rr.TextLog('')
        self._recording = rr.RecordingStream(APPLICATION, recording_id=recording_id)
        self._timebases = {'': Timebase(timeline)}
        if sides:
            self._timebases = {
                side: Timebase('since_start', zero=start) for side, start in sides.items()
            }
        self._bearing = bearing
        self._full = full_samples
        self._scenes: dict[tuple[str, str], Scene] = {}
        self._native_lines: set[str] = set()
        self._laid_out = 0
        self._known = 0
        self._changed = 0
        sinks: list[Any] = []
        if rrd is not None:
            if rrd.exists():
                msg = f'{rrd} exists and is not overwritten; name another file'
                raise BearingTwinError(msg)
            if not rrd.parent.is_dir():
                msg = f'{rrd}: there is no folder {rrd.parent}'
                raise BearingTwinError(msg)
            sinks.append(rr.FileSink(str(rrd)))
        if serve is not None:
            address, port = serve
            _check_free(address, port)
            sinks.append(rr.GrpcServerSink(address, port, server_memory_limit=memory_limit))
        try:
            self._recording.set_sinks(*sinks)
        except Exception as error:
            msg = f'Rerun cannot write {rrd} ({error}); choose another place'
            raise BearingTwinError(msg) from None

    def log(
        self, topic: str, type_name: str, message: Any, time_ns: int, *, side: str = ''
    ) -> None:
        """
        Draw a message that was received at ``time_ns``; never raises.

        Parameters
        ----------
        topic, type_name
            ``/line3/bearing_7/vibration`` and ``pkg/msg/Type``.
        message
            Anything with the fields of the ROS message.
        time_ns
            When it was received, ns.
        side
            One of the `sides`, where there are any.

        """
        try:
            namespace, name = namespace_of(topic)
            scene = self._scenes.get((side, namespace))
            if scene is None:
                scene = self._scenes[side, namespace] = Scene(
                    self._recording,
                    f'/{side}{namespace}' if side else namespace,
                    self._timebases[side],
                    bearing=self._bearing,
                    full=self._full,
                )
            scene.draw(name, type_name, message, time_ns)
            self._lay_out(time_ns)
        except Exception as error:
            # The caller is a node, the message a stranger's: a picture is not worth a failure.
            self.failed += 1
            if topic not in self.problems and len(self.problems) < COMPLAINTS:
                reason = f'{type(error).__name__}: {error}'
                self.problems[topic] = reason
                logging.getLogger(__name__).warning('%s cannot be drawn: %s', topic, reason)

    def import_mcap(self, path: Path, *, lines: Iterable[str] = ()) -> str:
        """
        Draw what Rerun itself can draw of an MCAP file; return why not, '' if it could.

        ``lines`` are its topics that come out as time series.
        """
        self._native_lines.update(lines)
        try:
            reader = McapReader(path, recover=True)
            self._recording.send_chunks(reader.stream())
        except Exception as error:
            # A stranger's file; Rerun raises many kinds on damaged ones.
            return f'{type(error).__name__}: {error}'
        return ''

    def close(self) -> None:
        """Draw what is held back and finish; a second time does nothing."""
        for scene in self._scenes.values():
            scene.flush()
        self._send_layout()
        self._recording.flush(timeout_sec=5.0)
        self._recording.disconnect()

    def __enter__(self) -> RerunLogger:
        """Return itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close."""
        self.close()

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


def _check_free(address: str, port: int) -> None:
    """Rerun itself only logs that it cannot serve."""
    try:
        with socket.socket(socket.AF_INET6 if ':' in address else socket.AF_INET) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind((address, port))
    except OSError as error:
        msg = f'Rerun cannot be served at {address}:{port} ({error.strerror}); choose another port'
        raise BearingTwinError(msg) from None
