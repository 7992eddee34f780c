# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Answers of single snapshots: a machine may be damaged from the first snapshot on."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from bearing_twin.bearing import LEVELS, PLACES
from bearing_twin.diagnosis.machine.level import with_required_level
from bearing_twin.diagnosis.rules.table import RULES
from bearing_twin.diagnosis.signal.severity import valid_for_length

if TYPE_CHECKING:
    from bearing_twin.diagnosis.chain import Analysis
    from bearing_twin.diagnosis.result import Diagnosis


CONFIRMING = 5
"""Number of snapshots whose median is judged: two of five may be disturbed."""

_WHY = {rule.name: rule.why.rstrip('.') for rule in RULES if rule.answer == 'ambiguous'}
_TELLS = frozenset(rule.name for rule in RULES if rule.answer == 'suspect' and rule.tells)
"""Rules of suspicions that have a next step of their own."""

NEWEST = 2 * CONFIRMING - 1
"""Number of answers that are kept: the level that ``CONFIRMING`` reach is their median."""


def answer_alone(analysis: Analysis) -> Diagnosis:
    """
    Return the diagnosis of a snapshot alone; snapshots below a second have no velocity.

    >>> import numpy as np
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
class Answers:
    """
    Newest answers of single snapshots. The field holds plain values that can be saved.

    Examples
    --------
    >>> answers = Answers([['fault', 'outer', '']] * 5 + [['none', '', 'too short']] * 4)
    >>> answers.level, answers.place, str(answers)
    ('fault', 'outer', '5 of the last 9 snapshots alone say outer, fault')
    >>> doubted = Answers([['fault', 'masked_by_shaft', 'outer']] * 5)
    >>> doubted.place, doubted.doubt, str(doubted).partition('; ')[2][:34]
    ('', 'masked_by_shaft', '5 of them are ambiguous (outer: An')

    """

    newest: list[list[str]] = field(default_factory=list)
    """Level, faulty place ('' if none or several) and first reason of each answer. An ambiguous
    one has the rule that decided and the places that it leaves open; a suspicion with a next step
    of its own has its rule instead of a place."""

    def add(self, answer: Diagnosis) -> None:
        """Take an answer."""
        named: str = answer.result if answer.result in PLACES and answer.level == 'fault' else ''
        reason = answer.reasons[0] if answer.reasons else ''
        if answer.rule in _WHY and answer.faults:
            # It may be about a place and something else.
            named, reason = answer.rule, ' or '.join(answer.faults)
        elif answer.rule in _TELLS:
            named = answer.rule
        self.newest.append([answer.level, named, reason])
        del self.newest[:-NEWEST]

    @property
    def level(self) -> str:
        """Level that ``CONFIRMING`` of the newest answers reach; 'none' with fewer answers."""
        ranks = sorted((LEVELS.index(level) for level, _, _ in self.newest), reverse=True)
        return LEVELS[ranks[CONFIRMING - 1]] if len(ranks) >= CONFIRMING else 'none'

    @property
    def place(self) -> str:
        """Place that ``CONFIRMING`` of the newest answers name as a fault; '' if there is none."""
        named = Counter(place for _, place, _ in self.newest if place in PLACES).most_common(1)
        return named[0][0] if named and named[0][1] >= CONFIRMING else ''

    @property
    def doubt(self) -> str:
        """Rule by which most of the answers that make the level name no place; '' of none."""
        rules = ['' if named in PLACES else named for said, named, _ in self.newest
                 if self._agrees(said)]  # fmt: skip
        rule, count = Counter(rules).most_common(1)[0] if rules else ('', 0)
        return rule if 2 * count > len(rules) else ''

    def _agrees(self, said: str) -> bool:
        """Whether the level of an answer is at least that of the series."""
        return LEVELS.index(said) >= LEVELS.index(self.level)

    def __str__(self) -> str:
        """Return the common answer in words, or why there is none."""
        level, of = self.level, f'of the last {len(self.newest)} snapshots alone'
        if level == 'none':
            mute = [why for said, _, why in self.newest if said == 'none']
            if len(mute) < CONFIRMING:
                return ''
            text, why = f'{len(mute)} {of} say nothing', Counter(mute).most_common(1)[0][0]
            return f'{text} ({why})' if why else text
        place = self.place
        if place:
            count = sum(named == place for _, named, _ in self.newest)
            return f'{count} {of} say {place}, {level}'
        agree = [answer for answer in self.newest if self._agrees(answer[0])]
        same = [answer for answer in agree if answer[0] == level]
        worse = len(same) < len(agree)
        text = f'{len(agree)} {of} say {level}{" or worse" if worse else ""}'
        if level == 'ok':
            return text
        unsure = Counter((places, rule) for _, rule, places in agree if rule in _WHY)
        if unsure:
            [((places, rule), count)] = unsure.most_common(1)
            are = 'are' if count > 1 else 'is'
            return f'{text}; {count} of them {are} ambiguous ({places}: {_WHY[rule]})'
        last = f'the last {level}' if worse else 'the last'
        return f'{text}; {last}: {same[-1][2]}' if same[-1][2] else text
