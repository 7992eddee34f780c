# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Answers of single snapshots: a machine may be damaged from the first snapshot on."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import LEVELS, PLACES
from bearing_twin.diagnosis.machine.level import with_required_level
from bearing_twin.diagnosis.rules.table import RULES
from bearing_twin.diagnosis.series.newest import EARLIER, FEWEST, judged, levels_reached
from bearing_twin.diagnosis.signal.severity import valid_for_length
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.diagnosis.chain import Analysis
    from bearing_twin.diagnosis.result import Diagnosis


CONFIRMING = 5
"""Number of snapshots whose median is judged: two of five may be disturbed."""

WHY = {rule.name: rule.why.rstrip('.') for rule in RULES}
"""Reason of each rule."""
_AMBIGUOUS = frozenset(rule.name for rule in RULES if rule.answer == 'ambiguous')
_TELLS = frozenset(rule.name for rule in RULES if rule.answer == 'suspect' and rule.tells)
"""Rules of suspicions that have a next step of their own."""

NEWEST = 2 * CONFIRMING - 1
"""Number of newest answers: the level that ``CONFIRMING`` of them reach is their median."""
_OK = LEVELS.index('ok')
_SUSPECT = LEVELS.index('suspect')


def answer_alone(analysis: Analysis) -> Diagnosis:
    """
    Return the diagnosis of a snapshot alone; snapshots below a second have no velocity.

    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.diagnosis.chain import Excerpt
    >>> from bearing_twin.diagnosis.settings import DiagnosisSettings
    >>> x = np.random.default_rng(0).standard_normal(2560)
    >>> snapshot = Excerpt.of(x, 25.0, 25600.0, find_bearing('6205'), DiagnosisSettings())
    >>> answer_alone(snapshot.analyse()).result
    'insufficient'

    """
    found, excerpt = analysis.alone, analysis.excerpt
    severity = valid_for_length(found.severity, len(excerpt.samples), excerpt.sample_rate)
    return with_required_level(replace(found, severity=severity))


@dataclass
class Answer:
    """What one snapshot says alone, in plain values that can be saved."""

    level: str
    place: str = ''
    """Faulty place; '' if none, several, or with a rule below."""
    rule: str = ''
    """Rule of an ambiguous answer with places, or of a suspicion with a next step of its own."""
    open_places: str = ''
    """Places that the answer leaves open, in words."""
    reason: str = ''
    """First reason."""

    @property
    def rank(self) -> int:
        """Index of the level."""
        return LEVELS.index(self.level)

    @property
    def named_rank(self) -> int:
        """Index of the level if the answer names a part of the bearing, else at most of *ok*."""
        return self.rank if self.place or self.open_places else min(self.rank, _OK)


@dataclass
class Answers:
    """
    Newest answers of single snapshots.

    Shocks, cavitation or a zone that names no part of the bearing can be in any snapshot of a
    sound machine. Such an answer counts by how many there usually are; see :mod:`series.newest`.

    Examples
    --------
    >>> answers = Answers([Answer('fault', 'outer')] * 5 + [Answer('none')] * 4)
    >>> answers.level, answers.place, str(answers)
    ('fault', 'outer', '5 of the last 9 snapshots alone say outer, fault')
    >>> doubted = Answers([Answer('fault', rule='masked_by_shaft', open_places='outer')] * 5)
    >>> doubted.place, doubted.doubt, str(doubted).partition('; ')[2][:34]
    ('', 'masked_by_shaft', '5 of them are ambiguous (outer: An')

    """

    newest: list[Answer] = field(default_factory=list)
    usual: float = 0.5
    """Share of *suspect* or worse answers before an alarm, by the rule of succession."""

    def add(self, answer: Diagnosis, *, sound: bool = True) -> None:
        """Take an answer; of a ``sound`` machine it tells how many are usually disturbed."""
        # An ambiguous answer may be about a place and something else.
        unsure = answer.rule in _AMBIGUOUS and bool(answer.faults)
        rule = answer.rule if unsure or answer.rule in _TELLS else ''
        named = answer.result in PLACES and answer.level == 'fault' and not rule
        self.newest.append(
            Answer(
                level=answer.level,
                place=answer.result if named else '',
                rule=rule,
                open_places=' or '.join(answer.faults),
                reason=answer.reasons[0] if answer.reasons else '',
            )
        )
        del self.newest[: -EARLIER - FEWEST]
        if sound:
            before = [each.rank >= _SUSPECT for each in self.newest[:-FEWEST]]
            self.usual = (sum(before) + 1) / (len(before) + 2)

    @property
    def level(self) -> str:
        """
        Level of the newest answers; 'none' with fewer than ``CONFIRMING``.

        ``CONFIRMING`` of the last ``NEWEST`` reach it and name a part of the bearing, or are *ok*;
        or all but one of as many as are judged reach it.
        """
        if len(self.newest) < CONFIRMING:
            return 'none'
        named = sorted((each.named_rank for each in self._last), reverse=True)[CONFIRMING - 1]
        ranks = np.array([[float(each.rank)] for each in self.newest[-EARLIER:]])
        reached = levels_reached(ranks, [judged(math.ceil(EARLIER * self.usual))])
        return LEVELS[max(named, int(reached[0]))]

    @property
    def _last(self) -> list[Answer]:
        return self.newest[-NEWEST:]

    @property
    def place(self) -> str:
        """Place that ``CONFIRMING`` of the newest answers name as a fault; '' if there is none."""
        named = Counter(each.place for each in self._last if each.place).most_common(1)
        return named[0][0] if named and named[0][1] >= CONFIRMING else ''

    @property
    def doubt(self) -> str:
        """Rule by which most of the answers that make the level name no place; '' of none."""
        rules = Counter(each.rule for each in self._agreeing())
        rule, count = rules.most_common(1)[0] if rules else ('', 0)
        return rule if 2 * count > rules.total() else ''

    def _agreeing(self) -> list[Answer]:
        """Return the answers whose level is at least that of the series."""
        rank = LEVELS.index(self.level)
        return [each for each in self._last if each.rank >= rank]

    def __str__(self) -> str:
        """Return the common answer in words, or why there is none."""
        level, of = self.level, f'of the last {len(self._last)} snapshots alone'
        if level == 'none':
            mute = [each.reason for each in self._last if each.level == 'none']
            if len(mute) < CONFIRMING:
                return ''
            text, why = f'{len(mute)} {of} say nothing', Counter(mute).most_common(1)[0][0]
            return f'{text} ({why})' if why else text
        if place := self.place:
            count = sum(each.place == place for each in self._last)
            return f'{count} {of} say {place}, {level}'
        agree = self._agreeing()
        counts = Counter(each.level for each in agree)
        # Worse answers are too few for the level, but each of them is a finding.
        least, *worse = [each for each in LEVELS if counts[each]]
        text = f'{counts[least]} {of} say {least}'
        text += ''.join(f', {counts[each]} {each}' for each in worse)
        # There is nothing to tell of an ok answer.
        told = level if counts[level] and level != 'ok' else max(counts, key=LEVELS.index)
        if told == 'ok':
            return text
        unsure = Counter(
            (each.open_places, each.rule) for each in agree if each.rule in _AMBIGUOUS
        )
        if unsure:
            [((places, rule), count)] = unsure.most_common(1)
            are = 'are' if count > 1 else 'is'
            return f'{text}; {count} of them {are} ambiguous ({places}: {WHY[rule]})'
        last = f'the last {told}' if worse else 'the last'
        reason = next(each.reason for each in reversed(agree) if each.level == told)
        return f'{text}; {last}: {reason}' if reason else text
