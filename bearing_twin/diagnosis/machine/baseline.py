# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Baseline of a machine: its lowest levels so far, and its levels when it has settled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
import math
import statistics

from bearing_twin.diagnosis.machine.dependence import (
    Condition,
    HealthyRecord,
    Law,
    PER_KELVIN,
    SAME_OCTAVES,
    Z90,
)
from bearing_twin.diagnosis.machine.level import FAULT_DB
from bearing_twin.diagnosis.signal.severity import MEASURES
from bearing_twin.errors import BearingTwinError
import numpy as np
from numpy.typing import NDArray

SETTLED_DB, SETTLED_K = 1.0, 1.5
"""Largest change of level, dB, and temperature, K, over a settled window. While a bearing warms
up, film and clearance change, and the vibration with them."""
WARM_UP = 1800.0
"""Time, s, after which a baseline need not wait until the temperature has settled."""
CREEPING_K = SETTLED_DB / (abs(PER_KELVIN[0]) + Z90 * PER_KELVIN[1])
"""Largest change of temperature over a settled window then, K: it changes the level of a bearing
by less than `SETTLED_DB`."""

MOST_SCATTER_DB = 2.0
"""Largest scatter of a baseline, dB. Six times as much are 12 dB: a machine that scatters more
would be called ok at four times its level. Several machines in one series scatter more."""

_ANY = 'at '
"""Start of the name of the class of all speeds; its end is the speed they are corrected to, in
octaves."""

_PARTS, _LEAST = 4, 5
"""Number of parts of a window for the lowest median, and least number of levels in a part. The
lowest median of fewer levels is chance; the first whole window of a machine whose level climbs is
already half way up."""


@dataclass(frozen=True)
class Baseline:
    """Levels of a settled machine and their condition."""

    levels: list[float]
    """Median of each measure, dB."""
    scatter: list[float]
    """Standard deviation of each measure from the median absolute deviation, dB."""
    temperature: float
    """degC; NaN if unknown."""
    octaves: float
    """Base-2 logarithm of the shaft speed in Hz; NaN if unknown."""
    times: list[float]
    """Time of the first and the last level, s."""


def settled_baseline(
    window: Sequence[Sequence[float]], laws: Sequence[Law] = (), kelvin: float = SETTLED_K
) -> tuple[Baseline | None, str]:
    """
    Return the baseline of a window, or None and in words what of it has not settled.

    Each row holds time in s, temperature in degC, log2 of the speed in Hz and the levels in dB.
    With the law of each measure, levels are compared at one temperature, and the temperature may
    move within the range in which its effect is known. Elsewhere it may move by ``kelvin``.

    Examples
    --------
    >>> base, _ = settled_baseline([[t, 60.0, 4.6, 3.0] for t in range(20)])
    >>> base.times, base.levels
    ([0.0, 19.0], [3.0])
    >>> settled_baseline([[t, 60.0, 4.6, 0.1 * t] for t in range(20)])
    (None, 'the level moves by 2.0 dB')

    """
    table = np.array(window, dtype=np.float64)
    heat, measured = table[:, 1], table[:, 3:]
    levels, known = measured.copy(), heat[np.isfinite(heat)]
    middle_heat = float(np.median(known)) if len(known) else math.nan
    for column, law in enumerate(laws):
        levels[:, column] -= [law.temperature.correct(value, middle_heat)[0] for value in heat]
    if (moves := _drift(levels[:, 0])) > SETTLED_DB:
        return None, f'the level moves by {moves:.1f} dB'
    # The level of the whole signal is what settles: its law is the first.
    if laws and (whole := laws[0].temperature).known:
        known = known - np.clip(known, whole.low, whole.high)
    if len(known) > len(table) // 2 and (moves := _drift(known)) > kelvin:
        return None, f'the temperature moves by {moves:.1f} K'
    # From the levels as measured: a law that turns out to be of something else is given up.
    apart = np.abs(measured - np.median(measured, axis=0))
    scatter = 1.4826 * np.median(apart, axis=0)
    if scatter[0] > MOST_SCATTER_DB:
        return None, f'the level scatters by {scatter[0]:.1f} dB'
    base = Baseline(
        levels=np.median(levels, axis=0).tolist(),
        scatter=scatter.tolist(),
        temperature=middle_heat,
        octaves=float(np.median(table[:, 2])),
        times=table[[0, -1], 0].tolist(),
    )
    return base, ''


def _drift(values: NDArray[np.float64]) -> float:
    """Return the change over a window: twice that between the medians of its halves."""
    if len(values) < 2:
        return 0.0
    early, late = np.array_split(values, 2)
    return 2.0 * abs(float(np.median(late)) - float(np.median(early)))


def _median(values: list[float]) -> float:
    """Return the median; NaN if a value is NaN."""
    return math.nan if any(map(math.isnan, values)) else statistics.median(values)


@dataclass
class Memory:
    """
    Levels of one machine so far, and its baseline. Its fields can be saved.

    A first baseline waits until level and temperature have settled. A temperature may creep or
    swing for as long as the machine runs, so after half an hour it may move more.

    A machine that gets worse during learning may settle, too. So the lowest median of a quarter of
    a window is kept for each speed. Levels that settle far above it make no baseline. Before there
    is a baseline, the level that four fifths of the last quarter reach is compared with it.

    Examples
    --------
    >>> memory, now = Memory(), Condition.at(60.0, 25.0)
    >>> [memory.learn(t, [1.0, 0.0, 0.0], now, 20, 3.0) for t in range(20)][-2:]
    [False, True]
    >>> worn = Memory()
    >>> for t in range(200):
    ...     _ = worn.learn(t, [min(0.1 * t, 9.0), 0.0, 0.0], now, 20, 3.0)
    >>> worn.base is None, round(worn.over([0.0, 0.0, 0.0], now)[0])
    (True, 9)

    """

    windows: dict[str, list[list[float]]] = field(default_factory=dict)
    """Rows of time, temperature, octaves and levels of the newest window, for each speed."""
    medians: dict[str, list[list[float]]] = field(default_factory=dict)
    """Lowest median level of the whole signal, dB, and the level that four fifths of the newest
    reach, each with its median temperature, for each speed."""
    began: float = math.nan
    """Time of the first level, s."""
    base: Baseline | None = None
    former: list[Baseline] = field(default_factory=list)
    """Louder baselines that were replaced: of another load, or before the machine ran in."""
    record: HealthyRecord = field(default_factory=HealthyRecord)

    def __post_init__(self) -> None:
        """Refuse a saved memory with a class of speeds whose speed is no number."""
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
        Take the level of each measure, dB; return whether there is a new or a lower baseline.

        A baseline needs ``wanted`` levels less than ``most`` dB above the lowest so far. They must
        be at one speed unless the dependence on speed is known.
        """
        if math.isnan(self.began):
            self.began = time
        speed, laws = self._speed(now), self.laws(len(levels))
        if speed.startswith(_ANY):
            at = now._replace(octaves=float(speed.removeprefix(_ANY)))
            pairs = zip(levels, laws, strict=True)
            levels, now = [level - law.correct(now, at)[0] for level, law in pairs], at
        window = self.windows.setdefault(speed, [])
        window.append([time, *now, *levels])
        del window[:-wanted]
        count = min(max(wanted // _PARTS, _LEAST), wanted)
        if len(window) >= count:
            whole, heats = ([row[column] for row in window[-count:]] for column in (3, 1))
            middle = [_median(whole), _median(heats)]
            # If a quarter of the levels is disturbed, more than half of so few are by chance.
            reached = [sorted(whole)[count // 5], middle[1]]
            self.medians[speed] = [min(self.medians.get(speed, [middle])[0], middle), reached]
        if len(window) < wanted:
            return False
        (new, _), base = settled_baseline(window), self.base
        allowed = self._allowed(laws, time)
        if not (new or base) and allowed != ([], SETTLED_K):
            # A first baseline need not wait for a temperature that swings or creeps.
            new, _ = settled_baseline(window, *allowed)
        if not new or self._over_lowest(speed, new.levels[0], new.temperature) >= most:
            return False
        if base and base.levels[0] - new.levels[0] < max(SETTLED_DB, 2.0 * base.scatter[0]):
            return False
        if base:
            self.former.append(base)
        self.base = new
        return True

    def was_settled_at(self, levels: NDArray[np.float64]) -> Baseline | None:
        """Return the former baseline that agrees with the level of each measure, dB, or None."""
        for base in self.former:
            reach = SETTLED_DB + 2.0 * np.array(base.scatter)
            if (np.abs(levels - np.array(base.levels)) <= reach).all():
                return base
        return None

    def has_fallen(self, level: float, now: Condition) -> bool:
        """Return whether a level of the whole signal, dB, is ``FAULT_DB`` below those so far."""
        if self.base:
            return level <= self.base.levels[0] - FAULT_DB
        speed = self._speed(now)
        known = speed in self.medians and not speed.startswith(_ANY)
        return known and level <= self.medians[speed][0][0] - FAULT_DB

    def forget_before(self, time: float) -> None:
        """Drop levels before a time, s, that are in no baseline yet."""
        self.began = time
        for window in self.windows.values():
            window[:] = [row for row in window if row[0] >= time]

    def why_not_settled(self) -> str:
        """Return why the largest window of levels at one speed is no baseline, in words."""
        speed, window = max(self.windows.items(), key=lambda each: len(each[1]))
        laws = self.laws(len(window[0]) - 3)
        found, why = settled_baseline(window, *self._allowed(laws, window[-1][0]))
        if found is None:
            return why
        over = self._over_lowest(speed, found.levels[0], found.temperature)
        return (
            f'the level has settled {over:.1f} dB above the lowest so far (if the machine was '
            'idle or ran in then, leave out what was measured before; a node: ~/reset)'
        )

    def _allowed(self, laws: list[Law], time: float) -> tuple[list[Law], float]:
        """Return the laws that may correct a first baseline, and the most its heat may move, K."""
        kelvin = CREEPING_K if time - self.began >= WARM_UP else SETTLED_K
        return laws if laws[0].temperature.known else [], kelvin

    def most_at_one_speed(self) -> tuple[int, float]:
        """Return the largest number of levels kept at one speed, and that speed, Hz."""
        window = max(self.windows.values(), key=len, default=[])
        return len(window), 2.0 ** window[-1][2] if window else math.nan

    @property
    def at(self) -> Condition:
        """Condition of the baseline; unknown without a baseline."""
        base = self.base
        return Condition(base.temperature, base.octaves) if base else Condition()

    def laws(self, measures: int = len(MEASURES)) -> list[Law]:
        """Return the law of each measure, whose number is known before there is a record."""
        return self.record.laws() or [Law()] * measures

    def over(self, levels: Sequence[float], now: Condition) -> list[float]:
        """
        Return the level of each measure over the earlier one of the machine, dB; NaN at first.

        With a baseline it is the level over the baseline. Before, it is the level that four fifths
        of the newest reach over the lowest median, of the whole signal only: the bands in which
        bearings ring move with film and clearance.
        """
        if self.base is not None:
            # Rounded, because bands beyond half the sample rate must equal the whole signal to the
            # bit.
            pairs = zip(levels, self.base.levels, strict=True)
            return [round(level - base, 6) for level, base in pairs]
        speed = self._speed(now)
        known = speed in self.medians
        whole = self._over_lowest(speed, *self.medians[speed][1]) if known else math.nan
        return [whole, *[-math.inf] * (len(levels) - 1)]

    def _over_lowest(self, speed: str, level: float, heat: float) -> float:
        """Return a level over the lowest, dB, less the largest effect of their temperatures."""
        lowest, was = self.medians[speed][0]
        mean, deviation = PER_KELVIN
        may = mean * (heat - was) + Z90 * deviation * abs(heat - was)
        return level - lowest - (0.0 if math.isnan(may) else may)

    def _speed(self, now: Condition) -> str:
        """Return the name of the class of speeds in which levels are compared."""
        if math.isnan(now.octaves):
            return ''
        laws = self.laws()
        if all(law.octaves.known for law in laws):
            name = next((name for name in self.windows if name.startswith(_ANY)), '')
            # A speed that the machine had is comparable without the law, too.
            name = name or f'{_ANY}{statistics.median_low(row[1] for row in self.record.rows)}'
            at = Condition(octaves=float(name.removeprefix(_ANY)))
            if all(law.comparable(now, at) for law in laws):
                return name
        return str(round(now.octaves / SAME_OCTAVES))
