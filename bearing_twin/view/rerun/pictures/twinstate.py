# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""State of the twin: its quantities over time, and the bearing itself."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

from bearing_twin.bearing.catalogue import find_bearing
from bearing_twin.errors import BearingTwinError
from bearing_twin.view.rerun.pictures.bearing3d import Bearing3D
from bearing_twin.view.rerun.pictures.lanes import Lane
from bearing_twin.view.rerun.pictures.picture import Asset, Picture
from bearing_twin.view.style import TEMPERATURE_STATES
from bearing_twin.view.trends import TWIN_STATE
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Canvas


class TwinPicture(Picture):
    """Draw the messages of one twin_state topic."""

    kind = 'twin_state'
    panels = TWIN_STATE

    def __init__(self, canvas: Canvas, asset: Asset) -> None:
        super().__init__(canvas, asset)
        self._solid: Bearing3D | None = None
        self._unknown: str | None = None
        self._lane = Lane(canvas, 'temperature_status', TEMPERATURE_STATES)

    def draw(self, message: Any, time: int) -> bool:
        """Draw a state at ``time`` in ns."""
        self.asset.twin = True
        self.asset.temperature = float(message.temperature_used)
        self.asset.over_temperature.state(message)
        self.trends.hold(message, time)
        self._lane.set(int(message.temperature_status), time)
        solid = self._solid_of(message)
        if solid is not None:
            solid.draw(message, time)
        return True

    def flush(self, *, slow: bool) -> None:
        """Send what is held, the poses too."""
        if self._solid is not None:
            self._solid.flush()
        super().flush(slow=slow)

    def _solid_of(self, message: Any) -> Bearing3D | None:
        """Return the drawn bearing; None, and log why, if its geometry is unknown."""
        name = str(message.bearing)
        if self._solid is None and name != self._unknown:
            try:
                bearing = find_bearing(name)
            except BearingTwinError as error:
                self._unknown = name
                self.canvas.once('bearing', rr.TextDocument(str(error)))
                return None
            self._solid = Bearing3D(self.canvas, 'bearing', bearing, self.asset.scales.force)
        return self._solid
