# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Where a scene draws: a recording, a place in it and a timeline."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, TYPE_CHECKING

import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bearing_twin.view.style import Colour
    from bearing_twin.view.timebase import Timebase
    from numpy.typing import ArrayLike, NDArray

__all__ = ['Canvas']


@dataclass
class Canvas:
    """Draw at times in ns below one entity path."""

    recording: rr.RecordingStream
    root: str
    """Entity path below which everything lies; '' is the top."""
    timebase: Timebase
    _known: set[str] = field(default_factory=set)

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
            self.recording.log(self.path(name), *archetypes, static=True)

    def put(self, name: str, time: int, *archetypes: Any) -> None:
        """Log at one time."""
        self.timebase.set(self.recording, time)
        self.recording.log(self.path(name), *archetypes)

    def line(
        self,
        name: str,
        times: NDArray[np.int64],
        values: ArrayLike,
        *,
        label: str,
        colour: Colour,
        width: float = 1.5,
    ) -> None:
        """Log samples of a time series, shape (n,)."""
        if self.is_new(name):
            self.once(name, rr.SeriesLines(names=label, colors=colour, widths=width))
        self.recording.send_columns(
            self.path(name),
            [self.timebase.column(times)],
            rr.Scalars.columns(scalars=np.asarray(values, dtype=np.float64)),
        )

    def points(
        self, time: int, series: Mapping[str, tuple[float, str, Colour]], *, width: float = 1.5
    ) -> None:
        """
        Log one value of several time series, given as value, label and colour by name.

        What is not finite is left out: a line has a gap where a quantity does not exist.
        """
        for name, (value, label, colour) in series.items():
            if np.isfinite(value):
                self.line(
                    name,
                    np.array([time], dtype=np.int64),
                    [value],
                    label=label,
                    colour=colour,
                    width=width,
                )
