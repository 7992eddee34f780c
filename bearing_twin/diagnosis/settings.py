# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Settings of a diagnosis; the defaults suit an unknown machine and are fitted to no data."""

from __future__ import annotations

from dataclasses import dataclass, replace
import functools

from bearing_twin.quantity import check_fields, quantity

LONGEST_WINDOW = 60.0
"""Longest window, s."""


@dataclass(frozen=True, kw_only=True)
class DiagnosisSettings:
    """
    Settings of a diagnosis, with their units and ranges.

    Raises
    ------
    BearingTwinError
        If a value is outside its range.

    """

    speed_tolerance: float = quantity(
        0.02, 'Uncertainty of the parameter shaft_hz, as a fraction of the speed.', '', 0.0, 0.1
    )
    """2 % is the error of a nameplate speed, because the slip of the motor depends on its load."""
    measured_speed_tolerance: float = quantity(
        0.002,
        'Uncertainty of a speed that comes with the samples or from a joint; the speed of a twin '
        'is exact.',
        '',
        0.0,
        0.1,
    )
    window: float = quantity(8.0, 'Length of the sliding window.', 's', 1.0, LONGEST_WINDOW)
    """Eight seconds are 200 turns at 25 Hz: enough to separate a line of one race from a sideband
    of the other, and more than the 40 cage turns that a cage fault needs."""
    update_interval: float = quantity(1.0, 'Time between verdicts.', 's', 0.2, 60.0)
    unit: str = quantity(
        '', "Unit of the samples, 'm/s^2' or 'g'; '' to believe the message.",
        choices=('', 'm/s^2', 'g'),
    )  # fmt: skip
    memory: float = quantity(
        8.0, 'Span over which windows are averaged; below two windows, none are.', 's', 1.0, 600.0
    )
    hold_updates: int = quantity(
        3,
        'Verdicts in a row before a level rises or an answer changes; the least before it falls.',
        '', 1, 1000,
    )  # fmt: skip
    baseline_windows: int = quantity(
        60,
        'Healthy windows from which the baseline of the asset is learnt; at least 10 snapshots of '
        'a series.', '', 1, 10_000,
    )  # fmt: skip
    power_group: int = quantity(
        0, 'Group of ISO 20816-3: 1 above 300 kW, 2 for 15 to 300 kW; 0: not known.', '', 0, 2
    )
    mounting: str = quantity(
        '', "Foundation of the machine for the zone of ISO 20816-3; '': not known.",
        choices=('', 'rigid', 'flexible'),
    )  # fmt: skip

    series_cycle: float = quantity(
        0.0,
        'Time from one snapshot to the next, judged together as one series; 0: a stream, judged '
        'window by window.',
        's',
        0.0,
        1e8,
        # A stream and a series keep different states, which must not overwrite each other.
        running=False,
    )
    series_snapshot: float = quantity(
        1.0, 'Length of a snapshot of a series; a gap may cut it short.', 's', 0.05, LONGEST_WINDOW
    )
    longest_hold: float = quantity(
        3600.0,
        'Time without its level after which an alarm ends; that of a stream ends earlier if it '
        'has not come back and the windows are clear.',
        's',
        0.0,
        1e8,
    )

    @property
    def averages(self) -> bool:
        """Whether the memory holds an earlier window, so that windows can be averaged."""
        return self.memory >= 2.0 * self.window

    @property
    def nominal(self) -> bool:
        """Whether the speed is known no better than by a nameplate."""
        return self.speed_tolerance > self.measured_speed_tolerance

    @functools.cached_property
    def measured(self) -> DiagnosisSettings:
        """Return the same settings for a speed that is measured with the samples."""
        return replace(self, speed_tolerance=self.measured_speed_tolerance)

    @functools.cached_property
    def _exact(self) -> DiagnosisSettings:
        return replace(self, speed_tolerance=0.0)

    def for_speed(self, *, measured: bool, simulated: bool) -> DiagnosisSettings:
        """
        Return the same settings for a speed that may come with the samples.

        >>> DiagnosisSettings().for_speed(measured=True, simulated=True).speed_tolerance
        0.0

        """
        if not measured:
            return self
        return self._exact if simulated else self.measured

    def __post_init__(self) -> None:
        check_fields(self)
