# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""State of the twin: temperature, stiffness, real time, and the bearing itself."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

from bearing_twin.bearing.catalogue import find_bearing
from bearing_twin.errors import BearingTwinError
from bearing_twin.view.rerun.bearing3d import Bearing3D
from bearing_twin.view.rerun.lanes import Lane
from bearing_twin.view.style import LINE, TEMPERATURE_STATES
import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from collections.abc import Callable

    from bearing_twin.bearing.geometry import Bearing
    from bearing_twin.view.rerun.canvas import Canvas
    from bearing_twin.view.style import Colour

__all__ = ['TwinPicture']

TRENDS: dict[str, tuple[str, Colour, Callable[[Any], float]]] = {
    'temperature/used': ('used [°C]', LINE['used'], lambda s: s.temperature_used),
    'temperature/inner_ring': (
        'inner ring [°C]',
        LINE['fourth'],
        lambda s: s.inner_ring_temperature,
    ),
    'contact/beta0': ('beta0 [1]', LINE['first'], lambda s: s.beta0),
    'contact/k_b': ('K_b [1e10 N/m^1.5]', LINE['second'], lambda s: 1e-10 * s.k_b),
    'contact/c_d': ('C_d [10 µm]', LINE['third'], lambda s: 1e5 * s.c_d),
    'contact/kappa': ('kappa [1]', LINE['fourth'], lambda s: s.kappa),
    'real_time/lateness': ('late [ms]', LINE['third'], lambda s: 1e3 * s.lateness),
    'real_time/execution': ('computing [ms]', LINE['first'], lambda s: 1e3 * s.execution_time),
    'real_time/late': ('late blocks [1]', LINE['fourth'], lambda s: s.blocks_late),
    'real_time/dropped': ('dropped blocks [1]', LINE['measured'], lambda s: s.blocks_dropped),
}
"""Label, colour and value of each line by entity."""


class TwinPicture:
    """Draw the messages of one twin_state topic."""

    def __init__(self, canvas: Canvas, name: str, bearing: Bearing | None) -> None:
        self._canvas = canvas
        self._name = name
        self._given = bearing
        self._solid: Bearing3D | None = None
        self._unknown = ''
        self._lane = Lane(canvas, f'{name}/temperature_status', TEMPERATURE_STATES)
        self._times: list[int] = []
        self._rows: list[list[float]] = []

    def draw(self, state: Any, time: int) -> None:
        """Draw a state at ``time`` in ns."""
        self._lane.set(int(state.temperature_status), time)
        self._times.append(time)
        self._rows.append([float(value(state)) for _, _, value in TRENDS.values()])
        solid = self._solid_of(str(state.bearing))
        if solid is not None:
            solid.draw(state, time)

    def flush(self, *, slow: bool) -> None:
        """Log the poses that are held, and if ``slow`` the trends."""
        if self._solid is not None:
            self._solid.flush()
        if not (slow and self._rows):
            return
        times = np.array(self._times, dtype=np.int64)
        columns = np.array(self._rows)
        self._times, self._rows = [], []
        for (name, (label, colour, _)), values in zip(TRENDS.items(), columns.T, strict=True):
            there = np.isfinite(values)
            if there.any():
                self._canvas.line(
                    f'{self._name}/{name}',
                    times[there],
                    values[there],
                    label=label,
                    colour=colour,
                    slow=True,
                )

    def _solid_of(self, name: str) -> Bearing3D | None:
        if self._solid is None and name != self._unknown:
            bearing = self._given
            if bearing is None:
                try:
                    bearing = find_bearing(name)
                except BearingTwinError as error:
                    self._unknown = name
                    self._canvas.once(f'{self._name}/bearing', rr.TextDocument(str(error)))
                    return None
            self._solid = Bearing3D(self._canvas, f'{self._name}/bearing', bearing)
        return self._solid
