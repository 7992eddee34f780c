# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a machine did so far: its lowest levels, and what it does when it has settled."""

from __future__ import annotations

from dataclasses import dataclass, field
import math
import statistics
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.machine.dependence import (
    Condition,
    HealthyRecord,
    Law,
    PER_KELVIN,
    SAME_OCTAVES,
    Z90,
)
from bearing_twin.diagnosis.signal.severity import MEASURES
from bearing_twin.errors import BearingTwinError
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


SETTLED_DB, SETTLED_K = 1.0, 1.5
"""Change over a window up to which level and temperature count as settled. Film and clearance, and
with them the vibration, move as long as a bearing warms up."""


MOST_SCATTER_DB = 2.0
"""Scatter up to which a machine has a baseline. Six times as much are 12 dB: a machine that
scatters more would be called ok at four times its level. Several machines in one series do."""

_ANY = 'at '
"""Begins the name of the class of all speeds; the octaves that they are corrected to end it."""

_PARTS, _LEAST = 4, 5
"""Parts of a window whose medians are compared, and least levels in one. The lowest of fewer
levels is chance; the first whole window of a machine that climbs is half way up."""


@dataclass(frozen=True)
class Baseline:
    """What a settled machine does."""

    levels: list[float]
    """Median of each measure, dB."""
    scatter: list[float]
    """Its standard deviation, from the median of the distances, dB."""
    temperature: float
    """degC; NaN if unknown."""
    octaves: float
    """Base-2 logarithm of the shaft speed in Hz; NaN if unknown."""
    times: list[float]
    """First and last, s."""


def settled(window: Sequence[Sequence[float]]) -> Baseline | None:
    """
    Return the baseline of a window over which level and temperature stay; None if they move.

    A row of it is time in s, temperature in degC, log2 of the speed in Hz and levels in dB.

    Examples
    --------
    >>> base = settled([[t, 60.0, 4.6, 3.0] for t in range(20)])
    >>> base.times, base.levels
    ([0.0, 19.0], [3.0])
    >>> settled([[t, 40.0 + t, 4.6, 3.0] for t in range(20)]) is None
    True

    """
    table = np.array(window, dtype=np.float64)
    heat, levels = table[:, 1], table[:, 3:]
    if _drift(levels[:, 0]) > SETTLED_DB:
        return None
    known = heat[np.isfinite(heat)]
    if len(known) > len(heat) // 2 and _drift(known) > SETTLED_K:
        return None
    middle = np.median(levels, axis=0)
    scatter = 1.4826 * np.median(np.abs(levels - middle), axis=0)
    if scatter[0] > MOST_SCATTER_DB:
        return None
    return Baseline(
        levels=middle.tolist(),
        scatter=scatter.tolist(),
        temperature=float(np.median(known)) if len(known) else math.nan,
        octaves=float(np.median(table[:, 2])),
        times=table[[0, -1], 0].tolist(),
    )


def _drift(values: NDArray[np.float64]) -> float:
    """Change over a window: between the medians of its halves lies half of a steady one."""
    if len(values) < 2:
        return 0.0
    early, late = np.array_split(values, 2)
    return 2.0 * abs(float(np.median(late)) - float(np.median(early)))


def _median(values: list[float]) -> float:
    """Return the median; NaN where one of the values is."""
    return math.nan if any(map(math.isnan, values)) else statistics.median(values)


@dataclass
class Memory:
    """
    What a stream or a series of one machine did so far; plain values, so that it can be saved.

    A machine that gets worse while it is learnt settles, too. So the lowest median of a quarter
    of a window is kept for each speed: what settles far over that has no baseline, and before
    there is one, the last such median is compared with it.

    Examples
    --------
    >>> memory, now = Memory(), Condition.at(60.0, 25.0)
    >>> [memory.learn(t, [1.0, 0.0, 0.0], now, 20, 3.0) for t in range(20)][-2:]
    [False, True]
    >>> worn = Memory()
    >>> for t in range(200):
    ...     _ = worn.learn(t, [min(0.1 * t, 9.0), 0.0, 0.0], now, 20, 3.0)
    >>> worn.base is None, round(worn.over(np.zeros(3), now)[0])
    (True, 9)

    """

    windows: dict[str, list[list[float]]] = field(default_factory=dict)
    """Time, temperature, octaves and levels of the last at each speed."""
    medians: dict[str, list[list[float]]] = field(default_factory=dict)
    """Lowest and last median of the whole signal at each speed: dB and temperature."""
    base: Baseline | None = None
    former: list[Baseline] = field(default_factory=list)
    """Louder ones that it took the place of: another load, or before the machine ran in."""
    record: HealthyRecord = field(default_factory=HealthyRecord)

    def __post_init__(self) -> None:
        """Refuse, of a saved memory, a class of speeds at no speed."""
        for name in filter(None, self.windows):
            try:
                known = math.isfinite(float(name.removeprefix(_ANY)))
            except ValueError:
                known = False
            if not known:
                msg = f'saved class of speeds {name!r:.40} is invalid; use what save() returned'
                raise BearingTwinError(msg)

    def learn(
        self, time: float, levels: list[float], now: Condition, wanted: int, most: float
    ) -> bool:
        """
        Take levels in, dB, one a measure; tell whether they made a baseline, or a lower one.

        It needs ``wanted`` of them which are less than ``most`` dB above the lowest before, at one
        speed or where the dependence on speed is known.
        """
        speed, laws = self._speed(now), self.laws()
        if speed.startswith(_ANY):
            at = now._replace(octaves=float(speed.removeprefix(_ANY)))
            pairs = zip(levels, laws, strict=True)
            levels, now = [level - law.correct(now, at)[0] for level, law in pairs], at
        window = self.windows.setdefault(speed, [])
        window.append([time, *now, *levels])
        del window[:-wanted]
        count = min(max(wanted // _PARTS, _LEAST), wanted)
        if len(window) >= count:
            last = [_median([row[column] for row in window[-count:]]) for column in (3, 1)]
            self.medians[speed] = [min(self.medians.get(speed, [last])[0], last), last]
        if len(window) < wanted:
            return False
        new, base = settled(window), self.base
        if not new or self._over_lowest(speed, new.levels[0], new.temperature) >= most:
            return False
        if base and base.levels[0] - new.levels[0] < max(SETTLED_DB, 2.0 * base.scatter[0]):
            return False
        if base:
            self.former.append(base)
        self.base = new
        return True

    def was_settled_at(self, levels: NDArray[np.float64]) -> Baseline | None:
        """Return the former baseline that levels, dB, one a measure, agree with; None: no one."""
        for base in self.former:
            reach = SETTLED_DB + 2.0 * np.array(base.scatter)
            if (np.abs(levels - np.array(base.levels)) <= reach).all():
                return base
        return None

    def fallen(self, level: float, now: Condition, by: float) -> bool:
        """Whether a level of the whole signal, dB, is so far below what the machine did so far."""
        if self.base:
            return level <= self.base.levels[0] - by
        speed = self._speed(now)
        known = speed in self.medians and not speed.startswith(_ANY)
        return known and level <= self.medians[speed][0][0] - by

    def forget_before(self, time: float) -> None:
        """Drop what was seen before a time, s, and is in no baseline yet."""
        for window in self.windows.values():
            window[:] = [row for row in window if row[0] >= time]

    def most(self) -> tuple[int, float]:
        """Return how many levels are kept at the speed that has most, and it, Hz."""
        window = max(self.windows.values(), key=len, default=[])
        return len(window), 2.0 ** window[-1][2] if window else math.nan

    @property
    def at(self) -> Condition:
        """Condition of the baseline; unknown without one."""
        base = self.base
        return Condition(base.temperature, base.octaves) if base else Condition()

    def laws(self) -> list[Law]:
        """Law of each measure."""
        return self.record.laws() or [Law()] * len(MEASURES)

    def over(self, levels: NDArray[np.float64], now: Condition) -> NDArray[np.float64]:
        """
        Return by how much the machine is louder than it was, dB, one a measure; NaN at first.

        That of levels over the baseline. Before there is one, that of the last median over the
        lowest, and of the whole signal only: the bands in which bearings ring move with film and
        clearance.
        """
        if self.base is not None:
            # Bands beyond half the sample rate are as much over it as the whole to the last bit.
            return np.asarray(np.round(levels - np.array(self.base.levels), 6))
        speed, over = self._speed(now), np.full(len(MEASURES), -math.inf)
        known = speed in self.medians
        over[0] = self._over_lowest(speed, *self.medians[speed][1]) if known else math.nan
        return over

    def _over_lowest(self, speed: str, level: float, heat: float) -> float:
        """Level over the lowest, dB, less what the difference in temperature may make of it."""
        lowest, was = self.medians[speed][0]
        mean, deviation = PER_KELVIN
        may = mean * (heat - was) + Z90 * deviation * abs(heat - was)
        return level - lowest - (0.0 if math.isnan(may) else may)

    def _speed(self, now: Condition) -> str:
        """Name of the class of speeds in which levels are compared."""
        if math.isnan(now.octaves):
            return ''
        laws = self.laws()
        if all(law.octaves.known for law in laws):
            name = next((name for name in self.windows if name.startswith(_ANY)), '')
            # One that the machine had is comparable without the law, too.
            name = name or f'{_ANY}{statistics.median_low(row[1] for row in self.record.rows)}'
            at = Condition(octaves=float(name.removeprefix(_ANY)))
            if all(law.comparable(now, at) for law in laws):
                return name
        return str(round(now.octaves / SAME_OCTAVES))
