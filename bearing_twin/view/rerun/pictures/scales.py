# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Scales that recordings side by side share, so that equal values have equal heights."""

from __future__ import annotations

import math
from typing import Any

from bearing_twin.view.over_temperature import NUMBERED, UNNUMBERED
from bearing_twin.view.rerun.pictures.bearing3d import greatest_force
from bearing_twin.view.spectrum import ENVELOPE, SpectrumPicture
import numpy as np


class Scales:
    """Largest values of the messages taken; 0 or None if there were none."""

    def __init__(self) -> None:
        self.index = 0.0
        """Largest line of an envelope spectrum, modulation index."""
        self.force = 0.0
        """Greatest contact force, N."""
        self._peak = 0.0
        self._units: set[str] = set()
        self._coldest = self._hottest = math.nan

    @property
    def vibration(self) -> float:
        """Largest magnitude of the vibration; 0 if the units differ."""
        return self._peak if len(self._units) == 1 else 0.0

    @property
    def temperature(self) -> tuple[float, float] | None:
        """Lowest and highest temperature, degC."""
        if not self._hottest > self._coldest:
            return None
        wide = NUMBERED if self._hottest - self._coldest > UNNUMBERED else ()
        return min((self._coldest, *wide)), max((self._hottest, *wide))

    def take(self, type_name: str, message: Any) -> None:
        """Take a message."""
        match type_name.removeprefix('bearing_twin_msgs/msg/'):
            case 'Vibration':
                samples = np.concatenate([message.x, message.y])
                self._units.add(str(message.unit))
                finite = np.abs(samples[np.isfinite(samples)])
                self._peak = max(self._peak, float(finite.max(initial=0.0)))
            case 'Spectrum' if message.kind == ENVELOPE:
                if (picture := SpectrumPicture.of(message)) is not None:
                    self.index = max(self.index, float(picture.deciding().values.max()))
            case 'TwinState':
                self._degrees(message.temperature_used)
                self._degrees(message.inner_ring_temperature)
                self.force = max(self.force, greatest_force(message))
            case 'sensor_msgs/msg/Temperature':
                self._degrees(message.temperature)

    def _degrees(self, value: float) -> None:
        if math.isfinite(value):
            self._coldest = float(np.fmin(self._coldest, value))
            self._hottest = float(np.fmax(self._hottest, value))
