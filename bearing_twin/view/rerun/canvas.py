# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Where a picture draws: an entity path and a timeline. Lines are held and sent together."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import Any, TYPE_CHECKING

import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Protocol

    from bearing_twin.view.rerun.outlet import Mark
    from bearing_twin.view.rerun.timebase import Timebase
    from bearing_twin.view.style import Colour
    from numpy.typing import NDArray

    class Emit(Protocol):
        """Brings a mark to every outlet; ``lasting`` ones are never dropped."""

        def __call__(self, mark: Mark, *, lasting: bool = False) -> None:
            """Bring it there."""


__all__ = ['Canvas']


@dataclass
class _Held:
    """Rows of a line that wait to be sent."""

    slow: bool
    times: list[NDArray[np.int64]] = field(default_factory=list)
    values: list[NDArray[np.float64]] = field(default_factory=list)


@dataclass
class Canvas:
    """
    Draw at times in ns below one entity path.

    What Rerun takes at once costs nearly the same whether it is one row or a thousand: lines are
    held until :meth:`flush`.
    """

    emit: Emit
    """Where the marks go."""
    root: str
    """Entity path below which everything lies; '' is the top."""
    timebase: Timebase
    _known: set[str] = field(default_factory=set)
    _lines: dict[str, _Held] = field(default_factory=dict)

    def path(self, name: str) -> str:
        """Return the entity path of a name."""
        return f'{self.root}/{name}'.replace('//', '/')

    def is_new(self, name: str) -> bool:
        """Whether :meth:`once` has yet to log it; making an archetype costs as much as a block."""
        return name not in self._known

    def once(self, name: str, *archetypes: Any) -> None:
        """Log what does not change with time, the first time only."""
        if name not in self._known:
            self._known.add(name)
            path = self.path(name)
            self.emit(
                lambda recording: recording.log(path, *archetypes, static=True), lasting=True
            )

    def put(self, name: str, time: int, *archetypes: Any) -> None:
        """Log at one time."""
        self.emit(partial(_log, self.timebase, time, self.path(name), archetypes))

    def columns(
        self, name: str, times: NDArray[np.int64], columns: Iterable[rr.ComponentColumn]
    ) -> None:
        """Log at several times, shape (n,); columns of n rows."""
        path, index, rows = self.path(name), [self.timebase.column(times)], list(columns)
        self.emit(lambda recording: recording.send_columns(path, index, rows))

    def line(
        self,
        name: str,
        times: NDArray[np.int64],
        values: NDArray[np.float64],
        *,
        label: str | tuple[str, ...],
        colour: Colour,
        width: float = 1.5,
        slow: bool = False,
    ) -> None:
        """
        Hold samples of a time series for the next flush.

        Parameters
        ----------
        name
            Its entity.
        times
            Shape (n,), ns.
        values
            Shape (n,), or (n, k) for k lines.
        label, colour, width
            Look; k labels for k lines.
        slow
            Whether it can wait for a slow flush.

        """
        if self.is_new(name):
            labels = [label] if isinstance(label, str) else list(label)
            count = len(labels)
            self.once(
                name,
                rr.SeriesLines(names=labels, colors=[colour] * count, widths=[width] * count),
            )
        held = self._lines.get(name)
        if held is None:
            held = self._lines[name] = _Held(slow)
        held.times.append(times)
        held.values.append(values)

    def flush(self, *, slow: bool) -> None:
        """Send the lines that are held; ``slow``: the slow ones too."""
        names = [name for name, held in self._lines.items() if slow or not held.slow]
        for name in names:
            held = self._lines.pop(name)
            values = np.concatenate(held.values)
            columns = rr.Scalars.columns(scalars=values.ravel())
            if values.ndim == 2:
                columns = columns.partition(np.full(len(values), values.shape[1]))
            self.columns(name, np.concatenate(held.times), columns)


def _log(
    timebase: Timebase,
    time: int,
    path: str,
    archetypes: tuple[Any, ...],
    recording: rr.RecordingStream,
) -> None:
    timebase.set(recording, time)
    recording.log(path, *archetypes)
