# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a series of snapshots answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bearing_twin.diagnosis.machine.dependence import Law


@dataclass(frozen=True, kw_only=True)
class SeriesPoint:
    """State of the machine after a snapshot."""

    time: float
    """s."""
    level: str
    """Held level, of :data:`bearing_twin.bearing.LEVELS`; 'none' until the baseline is known."""
    over_baseline: float
    """Median of the last five levels over their baseline, dB, of the measure that rose most."""
    measure: str
    """Which measure that is; '' before there is a baseline."""
    rms: float
    """Of the snapshot, in its unit."""
    temperature: float
    """degC; NaN if unknown."""
    iso_zone: str
    correction: float = 0.0
    """Change with temperature and speed that was taken off the whole signal, dB."""
    correction_sd: float = 0.0
    """Its standard deviation, dB."""
    rising: int = 0
    """Snapshots for which the level has stood over its baseline for good; 0: it has not."""


@dataclass(frozen=True, kw_only=True)
class SeriesReport:
    """What all snapshots together say."""

    level: str
    """Held level at the end."""
    points: tuple[SeriesPoint, ...]
    """One a snapshot that could be judged."""
    baseline: tuple[float, float] | None
    """First and last time of the snapshots that the present baseline rests on, s; None: none."""
    scatter: float
    """Standard deviation of the level within the baseline, dB."""
    change: float
    """When the level began to rise to the newest alarm, s; NaN if it did not rise."""
    alarm: float
    """When that was: when the level last left 'ok', s; NaN if it never did."""
    first_alarm: float
    """When the level first left 'ok', s; NaN if it never did."""
    first_fault: float
    """When it first was 'fault', s; NaN if it never was."""
    changes: int
    """How often the held level changed after it was first known."""
    trend: float
    """Slope of the level over the last quarter of the time since the baseline, dB/h (Theil and
    Sen); NaN where too little is there."""
    warmer: float
    """Temperature at the end over that of the baseline, K; NaN if unknown."""
    law: Law
    """How the level of the whole signal depends on temperature and speed."""
    place: str
    """Place that the newest snapshots name alone, or else the average of the envelopes since the
    change; '' if neither does, or the level is 'ok'."""
    reasons: tuple[str, ...]

    @property
    def result(self) -> str:
        """Answer that the held level stands for, one of ``RESULTS``."""
        if self.level == 'fault':
            return self.place or 'ambiguous'
        return {'ok': 'healthy', 'suspect': 'suspect'}.get(self.level, 'insufficient')
