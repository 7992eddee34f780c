# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Draw ROS messages in Rerun as they arrive.

A message goes to the scene of its namespace and there to the picture of its topic. The picture
draws on its canvas, whose marks go to the file and to the server for live viewers.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from functools import partial
import logging
from pathlib import Path
import re
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.finding import natural
from bearing_twin.recording.topics import is_feature
from bearing_twin.stamps import NANO
from bearing_twin.view.rerun.blueprint import automatic, layout, pages_of
from bearing_twin.view.rerun.outlet import Outlet, release, ServedOutlet
from bearing_twin.view.rerun.pictures.picture import Asset
from bearing_twin.view.rerun.pictures.scales import Scales
from bearing_twin.view.rerun.ports import bracketed, free_port
from bearing_twin.view.rerun.scene import namespace_of, Scene, SILENT
from bearing_twin.view.rerun.timebase import Timebase
from bearing_twin.view.source import Source
import rerun as rr
from rerun.chunk import McapReader

if TYPE_CHECKING:
    from bearing_twin.view.rerun.outlet import Mark


SETTLED, SETTLED_FILE = NANO, 10 * NANO
"""New topics are laid out for viewers, and in a file, when no other appeared for this long, ns.
With many layouts of a fleet in a file, a viewer needs minutes to show the last one."""
TICK = 3 * NANO // 10
"""Period of flushes, ns; with the 0.2 s that Rerun waits, live views lag half a second."""
SLOW = 3
"""Ticks after which the slow lines are sent too."""
COMPLAINTS = 20
"""Largest number of topics for which the reason of a failed drawing is kept."""


class RerunLogger:
    """
    Draw messages to a Rerun file, to a Rerun server, or to both.

    Everything is drawn once. Viewers connect to the server at any time and get the recent past. A
    separate thread serves them, so that an absent, killed or frozen viewer delays nothing; what a
    viewer does not take in time is counted in `dropped`. The file is written by the calling thread
    and is complete. No message raises an error: messages that cannot be drawn are counted in
    `failed` and explained in `problems`.

    Parameters
    ----------
    recording_id
        Name of the recording; files and servers of the same one belong together.
    rrd
        File to write; it must not exist.
    serve
        Address and port of a server for live viewers.
    footer
        Whether the file is looked at only when it is complete. It then has one layout, and ends
        with a list of its parts, which finds each of them faster. This list is kept in memory
        until then, 12 MB a minute of a bearing (rerun-io/rerun#12623).
    memory_limit
        Memory limit of the server; it drops the oldest data.
    full_samples
        Draw every sample of the vibration instead of a part of each second and its envelope.
    sides
        Recordings that are drawn side by side: the time in ns at which each begins, by its name.
        Time counts from there. ``{'': TIME}`` for one recording without a date.
    timeline
        ``'ros_time'`` draws messages at their stamps. Any other name draws them at their arrival
        and leaves the layout to the viewer.
    page
        Name of the page in front; '': the first.
    scales
        Scales that the sides share.

    """

    def __init__(
        self,
        *,
        recording_id: str,
        rrd: Path | None = None,
        serve: tuple[str, int] | None = None,
        footer: bool = True,
        memory_limit: str = '256MB',
        full_samples: bool = False,
        sides: Mapping[str, int] | None = None,
        timeline: str = 'ros_time',
        page: str = '',
        scales: Scales | None = None,
    ) -> None:
        self.failed = 0
        """Messages that could not be drawn."""
        self.problems: dict[str, str] = {}
        """First reason of each topic."""
        self.pages: list[str] = []
        """Names of the pages that were laid out."""
        # The first text loads pandas, where installed: a second that no message shall wait.
        rr.TextLog('')
        if rrd is not None:
            if rrd.exists():
                raise BearingTwinError(f'{rrd} exists and is not overwritten; name another file')
            if not rrd.parent.is_dir():
                raise BearingTwinError(f'{rrd}: there is no folder {rrd.parent}')
        if serve is not None:
            _check_free(*serve)
        self._file: Outlet | None = None
        self._served: ServedOutlet | None = None
        self._closed = False
        if rrd is not None:
            self._file = Outlet(
                recording_id, rr.FileSink(str(rrd), write_footer=footer), place=rrd
            )
        if serve is not None:
            address, port = serve
            sink = rr.GrpcServerSink(bracketed(address), port, server_memory_limit=memory_limit)
            self._served = ServedOutlet(Outlet(recording_id, sink, place=f'port {port}'))
        self._full, self._page = full_samples, page
        self._live_file = not footer
        self._scales = scales or Scales()
        self._timebases = {'': Timebase(timeline)}
        if sides:
            self._timebases = {
                side: Timebase('since_start', zero=start) for side, start in sides.items()
            }
        self._sources: dict[str, defaultdict[str, Source]] = {
            side: defaultdict(Source) for side in self._timebases
        }
        self._scenes: dict[tuple[str, str], Scene] = {}
        self._native_lines: set[str] = set()
        self._native_tables: set[str] = set()
        self._views = 0
        self._laid_out: dict[Outlet | ServedOutlet, int] = {}
        self._appeared = self._flushed = self._ticks = 0

    @property
    def dropped(self) -> int:
        """Return the number of marks that live viewers miss, as one of them did not keep up."""
        return self._served.dropped if self._served is not None else 0

    @staticmethod
    def draws(topic: str, type_name: str) -> bool:
        """Whether the messages of a topic are drawn; others need not be decoded."""
        return type_name not in SILENT and not is_feature(topic)

    def log(
        self, topic: str, type_name: str, message: Any, time_ns: int, *, side: str = ''
    ) -> None:
        """
        Draw a message that was received at ``time_ns``; never raise.

        The message is one that rosbags decoded. ``side`` is its recording's name in `sides`, if
        these were given.
        """
        if not self.draws(topic, type_name):
            return
        due = not 0 <= time_ns - self._flushed < TICK
        try:
            namespace, name = namespace_of(topic)
            self._scene(side, namespace).draw(name, type_name, message, time_ns)
            if due:
                self._settle(time_ns)
        except Exception as error:
            # The message may come from anywhere: a drawing error must not stop the calling node.
            self._complain(topic, error)
        if due:
            self._flushed = time_ns
            self._ticks += 1
            self._flush(slow=self._ticks % SLOW == 0)

    def drain(self, timeout: float) -> bool:
        """
        Wait until the server has drawn everything; return False after ``timeout`` seconds.

        For callers that log faster than real time and want nothing dropped.
        """
        return self._served is None or self._served.drain(timeout)

    def import_mcap(
        self, path: Path, topics: Iterable[str], *, lines: Iterable[str], tables: Iterable[str]
    ) -> str:
        """
        Let Rerun draw topics of an MCAP file to the file; return why it cannot, or ''.

        Only ``topics`` are read. Of these Rerun draws ``lines`` as time series, and reads
        ``tables`` without drawing them.
        """
        # Without any pattern Rerun would take all topics.
        chosen = [f'^{re.escape(topic)}$' for topic in topics]
        if self._file is None or not chosen:
            return ''
        self._native_lines.update(lines)
        self._native_tables.update(tables)
        try:
            reader = McapReader(path, include_topic_regex=chosen, recover=True)
            self._file.recording.send_chunks(reader.stream())
        except Exception as error:
            # Rerun raises many kinds of errors on damaged files.
            return f'{type(error).__name__}: {error}'
        return ''

    def close(self) -> None:
        """
        Draw what is held and finish; a second call does nothing.

        Viewers that do not take the rest within seconds miss it; the file is complete.
        """
        if self._closed:
            return
        self._closed = True
        self._flush(slow=True, last=True)
        self._lay_out(self._file)
        self._lay_out(self._served)
        for (side, namespace), scene in self._scenes.items():
            if text := scene.asset.source.whole:
                name = ' '.join(filter(None, ('vibration', side, namespace.strip('/'))))
                about = rr.AnyValues(source=text)
                self._emit(partial(rr.RecordingStream.send_property, name=name, values=about))
        try:
            if self._file is not None:
                self._file.close()
        finally:
            if self._served is not None and not self._served.close():
                logging.getLogger(__name__).warning(
                    'a viewer does not read; its unread data are dropped'
                )
            else:
                release()

    def __enter__(self) -> RerunLogger:
        """Return itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close."""
        self.close()

    def _scene(self, side: str, namespace: str) -> Scene:
        scene = self._scenes.get((side, namespace))
        if scene is None:
            root = f'/{side}{namespace}' if side else namespace
            asset = Asset(
                namespace,
                narrow=len(self._timebases) > 1,
                full=self._full,
                sources=self._sources[side],
                scales=self._scales,
            )
            scene = Scene(self._emit, root, self._timebases[side], asset)
            self._scenes[side, namespace] = scene
        return scene

    def _flush(self, *, slow: bool, last: bool = False) -> None:
        for scene in self._scenes.values():
            scene.flush(self._complain, slow=slow, last=last)

    def _count_views(self) -> int:
        drawn = sum(len(s.contents) + len(s.asset.panels) for s in self._scenes.values())
        return drawn + len(self._native_tables)

    def _settle(self, time_ns: int) -> None:
        """Lay out new topics when no other has followed for a while."""
        if self._views != (views := self._count_views()):
            self._views, self._appeared = views, time_ns
            return
        quiet = time_ns - self._appeared
        if quiet > SETTLED:
            self._lay_out(self._served)
        if quiet > SETTLED_FILE and self._live_file:
            self._lay_out(self._file)

    def _lay_out(self, outlet: Outlet | ServedOutlet | None) -> None:
        """Send the layout to an outlet that does not have it."""
        views = self._count_views()
        if outlet is None or views == self._laid_out.get(outlet, 0):
            return
        self._laid_out[outlet] = views
        base = next(iter(self._timebases.values()))
        beside = len(self._timebases) > 1
        # Live they are known in the order in which they are heard.
        keys = self._scenes if beside else sorted(self._scenes, key=lambda key: natural(key[1]))
        titles = {' '.join(filter(None, key)) or '/': self._scenes[key] for key in keys}
        blueprint = (
            layout(titles, timeline=base.timeline, side_by_side=beside, page=self._page)
            if base.stamped
            else automatic(
                self._scenes.values(),
                timeline=base.timeline,
                lines=sorted(self._native_lines),
                tables=sorted(self._native_tables),
            )
        )
        self.pages = pages_of(blueprint)

        def mark(recording: rr.RecordingStream) -> None:
            recording.send_blueprint(blueprint)

        if isinstance(outlet, ServedOutlet):
            outlet.put(mark, lasting=True)
        else:
            outlet.put(mark)

    def _emit(self, mark: Mark, *, lasting: bool = False) -> None:
        if self._served is not None:
            self._served.put(mark, lasting=lasting)
        if self._file is not None:
            self._file.put(mark)

    def _complain(self, topic: str, error: Exception) -> None:
        self.failed += 1
        if topic not in self.problems and len(self.problems) < COMPLAINTS:
            reason = f'{type(error).__name__}: {error}'
            self.problems[topic] = reason
            logging.getLogger(__name__).warning('%r cannot be drawn: %r', topic, reason)


def _check_free(address: str, port: int) -> None:
    """Raise if a port is taken; Rerun itself only logs it."""
    try:
        free_port(address, port)
    except OSError as error:
        msg = f'Rerun cannot be served at {address}:{port} ({error.strerror}); choose another port'
        raise BearingTwinError(msg) from None
