# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Measured temperature, with a band of one standard deviation if the sensor gives it."""

from __future__ import annotations

import math
from typing import Any, TYPE_CHECKING

from bearing_twin.view.rerun.pictures.picture import Asset, Picture
from bearing_twin.view.style import LINE
import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Canvas


NAME = 'measured'


class TemperaturePicture(Picture):
    """Draw the messages of one temperature topic."""

    kind = 'temperature'

    def __init__(self, canvas: Canvas, asset: Asset) -> None:
        super().__init__(canvas, asset)
        self._held: list[tuple[int, float, float]] = []

    def draw(self, message: Any, time: int) -> bool:
        """Hold a temperature at ``time`` in ns; without a band if its variance is 0."""
        value, variance = float(message.temperature), float(message.variance)
        if not math.isfinite(value):
            return False
        own = self.canvas.root
        if own.endswith('/temperature') or not self.asset.thermometer:
            # There may be another temperature, such as that of the room.
            self.asset.thermometer = own
        if not self.asset.twin and self.asset.thermometer == own:
            self.asset.temperature = value
        if self.canvas.is_new(NAME):
            self.canvas.once(
                NAME,
                rr.Measurements.from_fields(
                    units=['°C'],
                    names=[self.canvas.root.rpartition('/')[2]],
                    colors=[LINE['red']],
                    widths=[1.5],
                ),
            )
        self._held.append((time, value, variance if variance > 0.0 else 0.0))
        return True

    def flush(self, *, slow: bool) -> None:
        """Log the held temperatures."""
        if slow and self._held:
            held, self._held = self._held, []
            times, values, variances = zip(*held, strict=True)
            columns = rr.Measurements.columns(
                values=values, variances=variances if any(variances) else None
            )
            self.canvas.columns(NAME, np.array(times, dtype=np.int64), columns)
        super().flush(slow=slow)
