# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Held level of a stream: rises within a few verdicts, falls when silence tells of a change.

Level *ok* also needs windows that tell something: :class:`Known`.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass, field
import itertools
import math
from typing import NamedTuple

from bearing_twin.bearing import LEVELS
from bearing_twin.errors import BearingTwinError

_HOUR = 3600.0
"""Mean time between changes of :class:`Known` if half of the windows tell nothing, s."""


class Pace(NamedTuple):
    """How verdicts follow each other, and how long a level is held."""

    updates: int = 3
    """Verdicts in a row before a level rises, and the least number before it falls."""
    interval: float = 1.0
    """Time between verdicts, s."""
    span: float = 8.0
    """Time that one verdict stands for, s: verdicts that far apart share no samples."""
    longest: float = 3600.0
    """Time without a level after which it falls in any case, s."""
    simulated: bool = False
    """Whether it is a twin, which does not change unless somebody changes it."""
    window: float = 8.0
    """Length of a window, s."""

    @property
    def balance(self) -> float:
        """Largest balance of windows that tell something or nothing, s; see :class:`Known`."""
        return max(math.sqrt(_HOUR * self.span), self.window)


def _log_beta(a: float, b: float) -> float:
    return math.lgamma(a) + math.lgamma(b) - math.lgamma(a + b)


@dataclass
class HeldLevel:
    """
    Level of a machine that may be at the edge of a rule. Its fields are values that can be saved.

    A steady machine at the edge asks for a level in a share p of its windows. Windows that do not
    ask, in a row, are then its usual pauses, and no recovery. The level falls after a pause that
    such a machine makes in less than one of ``longest / span`` windows, so at most once in the
    time ``longest``. Any p is as likely before; the window that raised the level is why one counts
    and tells nothing of p. From a further windows that asked and b that did not, T in a row
    without the level have the probability B(a + 1, b + 1 + T) / B(a + 1, b + 1), B the beta
    function: Laplace's rule of succession.

    A machine whose load comes and goes has no such p. So a level that rises within ``longest``
    after one has fallen is held until the whole time ``longest`` has passed without it; that of a
    twin is not, whose defect somebody has taken out and put in again. The first verdict sets the
    level at once; until ``updates`` verdicts have asked for it, as many end it.

    Examples
    --------
    >>> held, pace = HeldLevel(), Pace()
    >>> [held.take(level, pace) for level in ['ok', 'fault', 'fault', 'fault']]
    ['ok', 'ok', 'ok', 'fault']
    >>> _ = [held.take('fault', pace) for _ in range(57)]
    >>> held.wait(pace), [held.take('ok', pace) for _ in range(60)].index('ok')
    (33.0, 32)

    """

    level: str = ''
    """Held level; empty before the first verdict."""
    newest: list[str] = field(default_factory=list)
    """Levels of the newest verdicts."""
    times: list[float] = field(default_factory=lambda: [0.0] * len(LEVELS))
    """Time for which verdicts have asked for each of ``LEVELS`` since the level last rose, s."""
    quiet: float = 0.0
    """Length of the present pause, in which none asks for the level or a higher one, s."""
    since_fall: float = math.inf
    """Time since a level fell, s."""
    returned: bool = False
    """Whether the level rose within the longest hold after a fall."""

    def __post_init__(self) -> None:
        """Refuse a saved level that there is not."""
        times = (*self.times, self.quiet, self.since_fall)
        known = {self.level or 'ok', *self.newest} <= {*LEVELS}
        known = known and len(self.times) == len(LEVELS)
        if not (known and all(time >= 0.0 for time in times)):
            raise BearingTwinError(f'saved level is {self!r:.200}; use what save() returned')

    def take(self, level: str, pace: Pace) -> str:
        """Take the level of a verdict and return the held one."""
        self.newest = [*self.newest, level][-pace.updates :]
        self.since_fall += pace.interval
        full, ranks = len(self.newest) == pace.updates, [LEVELS.index(it) for it in self.newest]
        held = LEVELS.index(self.level) if self.level else -1
        if not self.level or (full and ranks[-1] == min(ranks) > held):
            self.returned = self.since_fall < pace.longest and not pace.simulated
            self.level, self.quiet = level, 0.0
            self.times = [0.0] * len(LEVELS)
            self.times[ranks[-1]] = len(self.newest) * pace.interval
            return level
        self.times[ranks[-1]] += pace.interval
        self.quiet = 0.0 if ranks[-1] >= held else self.quiet + pace.interval
        lower = full and held > ranks[-1] == max(ranks)
        if lower and self.quiet >= self.wait(pace):
            self.level, self.quiet, self.since_fall = level, 0.0, 0.0
        return self.level

    def in_a_row(self, level: str) -> int:
        """Return how many of the newest verdicts in a row ask for a level or a higher one."""
        lower = LEVELS[: LEVELS.index(level)]
        asks = (each not in lower for each in reversed(self.newest))
        return sum(1 for _ in itertools.takewhile(bool, asks))

    def would_rise(self, level: str) -> bool:
        """Return whether as many verdicts as needed with this level would raise the held one."""
        return level not in {'none', 'ok', *LEVELS[: LEVELS.index(self.level or 'ok') + 1]}

    def wait(self, pace: Pace) -> float:
        """Return the length of a pause after which the level falls, s."""
        least = pace.updates * pace.interval
        if self.returned:
            return max(pace.longest, least)
        held = LEVELS.index(self.level)
        asked, others = sum(self.times[held:]), sum(self.times[:held])
        if asked < least:
            return least
        span, longest = pace.span, pace.longest
        a, b = max(asked / span, 1.0), 1.0 + (others - self.quiet) / span

        def is_change(count: int) -> bool:
            pause = count * pace.interval / span
            return _log_beta(a, b + pause) - _log_beta(a, b) <= math.log(span / longest)

        most = math.ceil(longest / pace.interval)
        return max(bisect_left(range(most), True, key=is_change) * pace.interval, least)

    def is_low(self, pace: Pace) -> bool:
        """Return whether the newest verdicts are all *ok*, whatever level is held."""
        least = pace.updates * pace.interval
        low = set(self.newest) <= {'ok', 'none'} and self.quiet >= least
        return self.level in ('', 'none', 'ok') or low


@dataclass
class Known:
    """
    Whether the windows of a machine tell enough to call it *ok*. Its fields can be saved.

    The balance is the time of windows that tell something less the time of those that tell
    nothing. It ends at zero and at a largest value. The machine is known until the balance is
    zero, and not known from then on until it is largest. So a machine is *ok* only while most of
    its newest windows tell something. If half of the windows tell nothing, the balance is a
    random walk with steps of ``span``, which takes ``(balance / span)^2`` steps from one end to
    the other in the mean (reflected at the end where it begins). This is an hour for a largest
    balance of ``sqrt(span hour)``. With any other share of such windows the walk drifts to one
    end and stays there.

    At first the machine is known as soon as no more windows told nothing than something, with a
    balance of one window. An unusable input ends the knowledge at once, because it is a fact and
    no chance, and all begins as at first. If the input has been unusable within ``longest``
    before, it is so now and then: its windows are windows that tell nothing. A twin is unusable
    only if somebody makes it so.

    Examples
    --------
    >>> known, pace = Known(), Pace()
    >>> [known.take(told, pace) for told in [False, True, False, True]]
    [False, True, True, True]
    >>> _ = [known.take(True, pace) for _ in range(600)]
    >>> round(known.balance), [known.take(False, pace) for _ in range(300)].index(False)
    (170, 169)
    >>> [known.take(True, pace) for _ in range(300)].index(True)
    169

    """

    known: bool = False
    balance: float = 0.0
    """s."""
    needed: float = 0.0
    """Balance from which the machine is known again, s."""
    told: float = 0.0
    """Time of windows that told something since ``known`` changed, s."""
    silent: float = 0.0
    """Time of windows that told nothing since then, s."""
    usable: float = math.inf
    """Time since the input was last unusable, s."""
    fact: bool = False
    """Whether it was usable for ``longest`` before that."""

    def __post_init__(self) -> None:
        """Refuse saved times that there are not."""
        times = self.needed, self.told, self.silent, self.usable
        if not (math.isfinite(self.balance) and all(time >= 0.0 for time in times)):
            raise BearingTwinError(f'saved state is {self!r:.300}; use what save() returned')

    def take(self, told: bool, pace: Pace, *, unusable: bool = False) -> bool:
        """Take whether a window told something; return whether the machine is known."""
        before, step = self.known, pace.interval
        lowest = 0.0 if self.known or self.needed else -pace.balance
        self.balance = max(self.balance + (step if told else -step), lowest)
        if unusable and self.usable:
            self.fact = self.usable >= pace.longest or pace.simulated
        self.usable = 0.0 if unusable else self.usable + step
        fact = unusable and self.fact
        if fact:
            self.known, self.balance, self.needed = False, 0.0, 0.0
        elif self.known and self.balance <= 0.0:
            self.known, self.needed = False, pace.balance
        elif not self.known and told and self.balance >= self.needed:
            self.known, self.balance = True, max(self.balance, pace.window)
        if self.known:
            self.balance = min(self.balance, pace.balance)
        if self.known != before or fact:
            self.told = self.silent = 0.0
        self.told += step * told
        self.silent += step * (not told and not fact)
        return self.known

    def __str__(self) -> str:
        """Say how many windows told nothing, and how many more change what is shown."""
        total = self.told + self.silent
        if self.known:
            said, then = f'{self.silent:.9g} of {total:.9g} s tell nothing', 'not known'
            left = self.balance
        else:
            said, then = f'{self.told:.9g} of {total:.9g} s tell something', 'known'
            left = self.needed - self.balance
        return f'{said}; {then} after {max(left, 0.0):.0f} s more of them'
