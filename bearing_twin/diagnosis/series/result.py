# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Results of a series: the state after each snapshot, and the report on all."""

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
    """Level over the baseline that all but one of the newest snapshots reach, dB, of the measure
    that rose most."""
    measure: str
    """Measure that rose most; '' before there is a baseline."""
    rms: float
    """RMS of the snapshot, in its unit."""
    temperature: float
    """degC; NaN if unknown."""
    iso_zone: str
    correction: float = 0.0
    """Change with temperature and speed, taken off the level of the whole signal, dB."""
    correction_sd: float = 0.0
    """Standard deviation of the correction, dB."""
    rising: int = 0
    """Number of snapshots since a lasting rise over the baseline began; 0 without one."""


@dataclass(frozen=True, kw_only=True)
class SeriesReport:
    """Report on all snapshots."""

    level: str
    """Held level at the end."""
    points: tuple[SeriesPoint, ...]
    """State after each snapshot that could be judged."""
    baseline: tuple[float, float] | None
    """First and last time of the snapshots of the present baseline, s; None without one."""
    scatter: float
    """Standard deviation of the level within the baseline, dB."""
    change: float
    """Time at which the rise to the newest alarm began, s; NaN if the level did not rise."""
    alarm: float
    """Time of the newest alarm, when the level last left 'ok', s; NaN without an alarm."""
    first_alarm: float
    """Time at which the level first left 'ok', s; NaN without an alarm."""
    first_fault: float
    """Time at which the level first was 'fault', s; NaN without a fault."""
    changes: int
    """Number of changes of the held level after it was first known."""
    trend: float
    """Slope of the level over the last quarter of the time since the baseline, dB/h (Theil and
    Sen); NaN with too few snapshots."""
    warmer: float
    """Temperature at the end less that of the baseline, K; NaN if unknown."""
    law: Law
    """Dependence of the level of the whole signal on temperature and speed."""
    place: str
    """Place that single snapshots named when they last reached the held level, or else the place
    in the averaged envelopes since the change; '' without a place, and at the level 'ok'."""
    doubt: str
    """Rule of most answers of single snapshots, if these answers alone raised the level that is
    held and name no place; else ''. Its answers are ambiguous or have a next step of their own."""
    reasons: tuple[str, ...]

    @property
    def result(self) -> str:
        """Answer for the held level, one of ``RESULTS``."""
        if self.level == 'fault':
            return self.place or 'ambiguous'
        return {'ok': 'healthy', 'suspect': 'suspect'}.get(self.level, 'insufficient')
