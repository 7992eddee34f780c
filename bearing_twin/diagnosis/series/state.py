# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a series knows of its machine, and the level that it holds."""

from __future__ import annotations

from dataclasses import dataclass, field
import math

from bearing_twin.bearing import LEVELS, PLACES
from bearing_twin.diagnosis.machine.baseline import Memory
from bearing_twin.diagnosis.machine.onset import Rise
from bearing_twin.diagnosis.machine.trend import Source
from bearing_twin.diagnosis.series.alone import Answers, NEWEST
from bearing_twin.diagnosis.series.averaging import Comb  # noqa: TC002 - `restored` reads types
from bearing_twin.diagnosis.series.result import SeriesPoint  # noqa: TC002 - it does
from bearing_twin.errors import BearingTwinError


@dataclass
class Kept:
    """What a monitor knows of its machine, besides arrays: it is saved as it is."""

    memory: Memory = field(default_factory=Memory)
    rise: Rise = field(default_factory=Rise)
    points: list[SeriesPoint] = field(default_factory=list)
    answers: Answers = field(default_factory=Answers)
    strong: Comb | None = None
    """Fault that stands out of the envelopes of the last ``LEAST_AVERAGED`` snapshots, or of as
    many before that are complete."""
    source: Source = field(default_factory=Source)
    held: str = 'none'
    """Level that is held."""
    low_since: float = math.nan
    """Since when the level is low while an alarm is held, s; NaN if it is not."""
    low: int = 0
    """Snapshots since then."""
    began: float = math.nan
    """When the level that is held last rose from 'none' or 'ok', s."""
    risen: float = math.nan
    """First time since then at which the vibration itself asked for an alarm, s; NaN if none."""
    alarms: dict[str, float] = field(default_factory=dict)
    """Time of the first alarm of each level, s."""
    changes: int = 0
    refused: dict[str, int] = field(default_factory=dict)
    """Snapshots that were not judged, by the reason."""
    unjudged: int = 0
    """Those since the last that was."""

    def __post_init__(self) -> None:
        """Refuse, of a saved series, a level or a place that none is."""
        place = self.strong.place if self.strong else PLACES[0]
        if self.held not in LEVELS or place not in PLACES:
            said = f'level {self.held!r:.60} or place {place!r:.60}'
            msg = f'saved {said} is invalid; use what save() returned'
            raise BearingTwinError(msg)

    def leave_out(self, reason: str) -> None:
        """Count a snapshot that is not judged."""
        self.refused[reason] = self.refused.get(reason, 0) + 1
        self.unjudged += 1

    def hold(self, time: float, wanted: str, least: float) -> bool:
        """
        Rise at once, fall only after the level was low for long enough; tell whether it fell.

        Level wanted at ``time`` of the newest snapshot; ``least`` is how long it has to be low, s.

        Examples
        --------
        >>> kept = Kept()
        >>> [kept.hold(600.0 * n, 'ok' if n else 'fault', 3600.0) for n in range(11)].index(True)
        9
        >>> kept.held, kept.alarms
        ('ok', {'suspect': 0.0, 'fault': 0.0})

        """
        if wanted == self.held:
            self.low_since = math.nan
            return False
        rises = LEVELS.index(wanted) > LEVELS.index(self.held)
        if not rises:
            if math.isnan(self.low_since):
                self.low_since, self.low = time, 0
            self.low += 1
            # Where the cycle is longer than the hold: until the answers that raised it are gone.
            if time - self.low_since < least or self.low < NEWEST:
                return False
            if self.held == 'fault':
                # What was repaired is another machine.
                self.memory.forget_before(self.low_since)
        elif self.held in ('none', 'ok'):
            self.began, self.risen = time, math.nan
        self.changes += self.held != 'none'
        self.held, self.low_since = wanted, math.nan
        for level in ('suspect', 'fault'):
            if rises and LEVELS.index(wanted) >= LEVELS.index(level):
                self.alarms.setdefault(level, time)
        return not rises
