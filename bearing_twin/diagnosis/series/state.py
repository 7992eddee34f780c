# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""State of a series: memory of the machine, points and held level."""

from __future__ import annotations

from dataclasses import dataclass, field
import math

from bearing_twin.bearing import LEVELS, PLACES
from bearing_twin.diagnosis.machine.baseline import Memory
from bearing_twin.diagnosis.machine.onset import Rise
from bearing_twin.diagnosis.machine.trend import Source
from bearing_twin.diagnosis.series.alone import Answers, NEWEST, WHY
from bearing_twin.diagnosis.series.averaging import Comb  # noqa: TC002 - `restored` reads types
from bearing_twin.diagnosis.series.result import SeriesPoint  # noqa: TC002 - it does
from bearing_twin.errors import BearingTwinError


@dataclass
class SeriesMemory:
    """State of a monitor without its arrays; it is saved as it is."""

    memory: Memory = field(default_factory=Memory)
    rise: Rise = field(default_factory=Rise)
    points: list[SeriesPoint] = field(default_factory=list)
    answers: Answers = field(default_factory=Answers)
    strong: Comb | None = None
    """Strong fault in the averaged envelope of the last complete ``LEAST_AVERAGED`` snapshots."""
    source: Source = field(default_factory=Source)
    held: str = 'none'
    """Held level."""
    low_since: float = math.nan
    """Time since which the level is low while an alarm is held, s; NaN if it is not low."""
    low: int = 0
    """Number of snapshots since ``low_since``."""
    began: float = math.nan
    """Time at which the held level last rose from 'none' or 'ok', s."""
    risen: float = math.nan
    """First time since then at which the vibration level required an alarm, s; NaN if none."""
    place: str = ''
    """Place that the answers of single snapshots named when they last reached the held level."""
    doubt: str = ''
    """Rule of most of these answers if they named no place; '' if none."""
    alarms: dict[str, float] = field(default_factory=dict)
    """Time of the first alarm of each level, s."""
    changes: int = 0
    refused: dict[str, int] = field(default_factory=dict)
    """Number of snapshots that were not judged, by reason."""
    unjudged: int = 0
    """Number of snapshots since the last judged one."""

    def __post_init__(self) -> None:
        """Refuse a saved series with an unknown level, place or rule."""
        places = (self.place or PLACES[0], self.strong.place if self.strong else PLACES[0])
        named = all(place in PLACES for place in places)
        if self.held not in LEVELS or not named or self.doubt not in ('', *WHY):
            said = f'level {self.held!r:.60}, places {places!r:.60} or rule {self.doubt!r:.60}'
            raise BearingTwinError(f'saved {said} is invalid; use what save() returned')

    def leave_out(self, reason: str) -> None:
        """Count a snapshot that is not judged."""
        self.refused[reason] = self.refused.get(reason, 0) + 1
        self.unjudged += 1

    def hold(self, time: float, wanted: str, least: float) -> bool:
        """
        Raise the held level at once, lower it after it was low for long; return whether it fell.

        ``wanted`` is the level at ``time``, s, of the newest snapshot; ``least`` is the shortest
        time for which it must be low before the held level falls, s.

        Examples
        --------
        >>> kept = SeriesMemory()
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
            # If the cycle is longer than the hold, wait until the answers that raised the level
            # are gone.
            if time - self.low_since < least or self.low < NEWEST:
                return False
            if self.held == 'fault':
                # A repaired machine is learnt anew.
                self.memory.forget_before(self.low_since)
        elif self.held in ('none', 'ok'):
            self.began, self.risen = time, math.nan
        self.changes += self.held != 'none'
        self.held, self.low_since = wanted, math.nan
        for level in ('suspect', 'fault'):
            if rises and LEVELS.index(wanted) >= LEVELS.index(level):
                self.alarms.setdefault(level, time)
        return not rises
