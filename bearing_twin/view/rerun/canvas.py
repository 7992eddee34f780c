# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Canvas of a picture: an entity path and a timeline. Drawings are held and sent together."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
import io
from typing import Any, Protocol, TYPE_CHECKING, TypeVar

from bearing_twin.stamps import NANO
import numpy as np
from numpy.typing import NDArray
import rerun as rr
from rerun.chunk import Chunk

if TYPE_CHECKING:
    from bearing_twin.view.rerun.outlet import Mark
    from bearing_twin.view.rerun.timebase import Timebase
    from bearing_twin.view.style import Colour
    from PIL import Image

    class Emit(Protocol):
        """Sends a mark to every outlet; ``lasting`` ones go first."""

        def __call__(self, mark: Mark, *, lasting: bool = False) -> None:
            """Send the mark."""


_T = TypeVar('_T', bound=np.generic)

PAUSE = NANO
"""Longest step that never parts a line, ns."""
UNKNOWN = np.iinfo(np.int64).max
"""Step to the first sample of a line, ns."""


def png(image: Image.Image, colours: int) -> rr.EncodedImage:
    """Return an image of few colours as Rerun shows it; a PNG of some kB."""
    buffer = io.BytesIO()
    image.quantize(colours).save(buffer, 'PNG', optimize=True)
    return rr.EncodedImage(contents=buffer.getvalue(), media_type='image/png')


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

    A call to Rerun costs nearly the same for one row as for a thousand, so lines are held until
    :meth:`flush`. Each drawing becomes one chunk for all outlets, and a flush sends its chunks in
    one call.
    """

    emit: Emit
    """Receives the marks."""
    root: str
    """Entity path below which everything lies; '' is the top."""
    timebase: Timebase
    _known: set[str] = field(default_factory=set)
    _lines: dict[str, _Held] = field(default_factory=dict)
    _ends: dict[str, tuple[int, int]] = field(default_factory=dict)
    _chunks: list[Chunk] = field(default_factory=list)

    def path(self, name: str) -> str:
        """Return the entity path of a name."""
        return f'{self.root}/{name}'.replace('//', '/')

    def is_new(self, name: str) -> bool:
        """Whether :meth:`once` has yet to log it; making an archetype costs as much as a block."""
        return name not in self._known

    def once(self, name: str, *archetypes: Any) -> None:
        """Log static archetypes, the first time only."""
        if name not in self._known:
            self._known.add(name)
            chunk = Chunk.from_columns(self.path(name), [], _row(archetypes))
            self.emit(lambda recording: recording.send_chunks(chunk), lasting=True)

    def put(self, name: str, time: int, *archetypes: Any) -> None:
        """Draw at one time, with the next flush."""
        self.columns(name, np.array([time]), _row(archetypes))

    def columns(
        self, name: str, times: NDArray[np.int64], columns: Iterable[rr.ComponentColumn]
    ) -> None:
        """Draw at several times, shape (n,), with the next flush; columns of n rows."""
        index = [self.timebase.column(times)]
        self._chunks.append(Chunk.from_columns(self.path(name), index, columns))

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
        parted: bool = False,
    ) -> None:
        """
        Hold samples of a time series for the next flush.

        Times are in ns, values of shape (n,), or (n, k) for k lines with k labels. ``slow`` lines
        are sent by slow flushes only. ``parted`` lines end and begin anew where a step is longer
        than a second and three times the one before.
        """
        if self.is_new(name):
            labels = [label] if isinstance(label, str) else list(label)
            count = len(labels)
            self.once(
                name,
                rr.SeriesLines(
                    names=labels,
                    colors=[colour] * count,
                    widths=[width] * count,
                    # The average, which is the default, would flatten peaks where several samples
                    # fall on one pixel.
                    aggregation_policy=rr.components.AggregationPolicy.MinMax,
                ),
            )
        held = self._lines.get(name)
        if held is None:
            held = self._lines[name] = _Held(slow)
        if parted and times.size:
            times, values = self._parted(name, times, values)
        held.times.append(times)
        held.values.append(values)

    def _parted(
        self, name: str, times: NDArray[np.int64], values: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return samples of a line with a NaN, which Rerun does not draw, in each pause."""
        begins = name not in self._ends
        end, step = self._ends.get(name, (int(times[0]), UNKNOWN))
        before = np.concatenate([[end], times[:-1]])
        steps = times - before
        if begins:
            steps[0] = UNKNOWN
        self._ends[name] = int(times[-1]), int(steps[-1])
        usual = np.concatenate([[step], steps[:-1]])
        after = np.flatnonzero((steps > PAUSE) & (steps // 3 > usual))
        if not after.size:
            return times, values
        return np.insert(times, after, before[after] + 1), np.insert(values, after, np.nan, axis=0)

    def flush(self, *, slow: bool) -> None:
        """Send what is held, with ``slow`` the slow lines too."""
        names = [name for name, held in self._lines.items() if slow or not held.slow]
        for name in names:
            held = self._lines.pop(name)
            values, times = _joined(held.values), _joined(held.times)
            columns = rr.Scalars.columns(scalars=values.ravel())
            if values.ndim == 2:
                columns = columns.partition(np.full(len(values), values.shape[1]))
            self.columns(name, times, columns)
        if self._chunks:
            chunks, self._chunks = self._chunks, []
            self.emit(lambda recording: recording.send_chunks(chunks))


def _row(archetypes: Iterable[rr.AsComponents]) -> list[rr.ComponentColumn]:
    """Return archetypes as columns of one row."""
    batches = [batch for archetype in archetypes for batch in archetype.as_component_batches()]
    return [batch.partition([len(batch.as_arrow_array())]) for batch in batches]


def _joined(parts: list[NDArray[_T]]) -> NDArray[_T]:
    """Return joined arrays; a single one is returned itself, as its time column may be reused."""
    return parts[0] if len(parts) == 1 else np.concatenate(parts)
