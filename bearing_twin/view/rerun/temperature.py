# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Temperature as measured, with a band of one standard deviation where the sensor gives it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.view.style import LINE
import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Canvas

__all__ = ['TemperaturePicture']


class TemperaturePicture:
    """Draw the messages of one temperature topic."""

    def __init__(self, canvas: Canvas, name: str) -> None:
        self._canvas = canvas
        self._name = f'{name}/measured'
        self._held: list[tuple[int, float, float]] = []

    def draw(self, value: float, variance: float, time: int) -> None:
        """Hold a temperature in degC at ``time`` in ns; no band where its variance is 0."""
        if self._canvas.is_new(self._name):
            self._canvas.once(
                self._name,
                rr.Measurements.from_fields(
                    units=['°C'], names=['measured'], colors=[LINE['measured']], widths=[1.5]
                ),
            )
        self._held.append((time, value, variance if variance > 0.0 else 0.0))

    def flush(self, *, slow: bool) -> None:
        """Log what is held."""
        if not (slow and self._held):
            return
        held, self._held = self._held, []
        variances = [variance for _, _, variance in held]
        self._canvas.columns(
            self._name,
            np.array([time for time, _, _ in held], dtype=np.int64),
            rr.Measurements.columns(
                values=[value for _, value, _ in held],
                variances=variances if any(variances) else None,
            ),
        )
