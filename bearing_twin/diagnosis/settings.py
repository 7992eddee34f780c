# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Settings of a diagnosis. The defaults suit an unknown machine; none is fitted to a data set."""

from __future__ import annotations

from dataclasses import dataclass, fields
import math

from bearing_twin.errors import BearingTwinError

__all__ = ['DiagnosisSettings']

_RANGES: dict[str, tuple[float, float, str]] = {
    'window': (0.25, 120.0, 's'),
    'update_interval': (0.05, 3600.0, 's'),
    'memory': (0.25, 600.0, 's'),
    'speed_tolerance': (0.0, 0.1, 'as a fraction of the speed'),
    'measured_speed_tolerance': (0.0, 0.1, 'as a fraction of the speed'),
    'baseline_windows': (1.0, 1e6, 'windows'),
    'hold_updates': (1.0, 1000.0, 'updates'),
}


@dataclass(frozen=True, kw_only=True)
class DiagnosisSettings:
    """
    What the user may choose.

    Raises
    ------
    BearingTwinError
        If a value is outside its range.

    """

    window: float = 8.0
    """Length of a window, s. Eight seconds hold 200 turns at 25 Hz: enough to part a line of one
    race from a sideband of the other, and for the 40 cage turns that a cage fault needs."""
    update_interval: float = 1.0
    """Time between two diagnoses, s."""
    memory: float = 8.0
    """Span over which windows are averaged, s; at least the window."""
    speed_tolerance: float = 0.02
    """Relative tolerance of the given shaft speed: 2 % is a nameplate against the real slip."""
    measured_speed_tolerance: float = 0.002
    """The same where the speed is measured along with the samples, as by an encoder."""
    unit: str = ''
    """Unit of the signal where the data do not say: ``'m/s^2'``, ``'g'`` or empty (unknown)."""
    power_group: int = 0
    """Group of ISO 20816-3: 1 above 300 kW, 2 for 15 to 300 kW, 0 unknown."""
    mounting: str = ''
    """Mounting of ISO 20816-3: ``'rigid'``, ``'flexible'`` or empty (unknown)."""
    baseline_windows: int = 60
    """Healthy windows from which the asset's baseline is learnt."""
    hold_updates: int = 3
    """Equal answers in a row before the level rises or falls (hysteresis of the stream)."""

    @property
    def averages(self) -> bool:
        """Whether the memory holds a window before the newest, so that they can be averaged."""
        return self.memory >= 2.0 * self.window

    def __post_init__(self) -> None:
        for field in fields(self):
            if field.name not in _RANGES:
                continue
            value = getattr(self, field.name)
            low, high, unit = _RANGES[field.name]
            if not (math.isfinite(value) and low <= value <= high):
                msg = (
                    f'{field.name}={value} is outside {low:g}..{high:g} {unit}; choose one inside'
                )
                raise BearingTwinError(msg)
        if self.memory < self.window:
            msg = f'memory={self.memory} s is shorter than window={self.window} s; make it longer'
            raise BearingTwinError(msg)
        if self.power_group not in (0, 1, 2):
            msg = f'power_group={self.power_group}: ISO 20816-3 has 1 and 2; 0 where unknown'
            raise BearingTwinError(msg)
        if self.mounting not in ('', 'rigid', 'flexible'):
            msg = f"mounting={self.mounting!r}: choose 'rigid', 'flexible' or ''"
            raise BearingTwinError(msg)
