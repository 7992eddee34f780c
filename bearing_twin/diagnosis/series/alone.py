# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Answers of single snapshots: a machine may be damaged from the first snapshot on."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from bearing_twin.bearing import LEVELS, PLACES
from bearing_twin.diagnosis.machine.level import raised
from bearing_twin.diagnosis.signal.severity import of_length

if TYPE_CHECKING:
    from bearing_twin.diagnosis.chain import Analysis
    from bearing_twin.diagnosis.result import Diagnosis


CONFIRMING = 5
"""Number of snapshots whose median is judged: two of five may be disturbed."""

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
    severity = of_length(found.severity, len(excerpt.samples), excerpt.sample_rate)
    return raised(replace(found, severity=severity))


@dataclass
class Answers:
    """
    Newest answers of single snapshots. The field holds plain values that can be saved.

    Examples
    --------
    >>> answers = Answers([['fault', 'outer', '']] * 5 + [['none', '', 'too short']] * 4)
    >>> answers.level, answers.place, str(answers)
    ('fault', 'outer', '5 of the last 9 snapshots alone say outer, fault')

    """

    newest: list[list[str]] = field(default_factory=list)
    """Level, faulty place ('' if none or several) and first reason of each answer."""

    def add(self, answer: Diagnosis) -> None:
        """Take an answer."""
        # An ambiguous alarm names no single place.
        place = answer.result if answer.result in PLACES and answer.level == 'fault' else ''
        reason = answer.reasons[0] if answer.reasons else ''
        self.newest.append([answer.level, place, reason])
        del self.newest[:-NEWEST]

    @property
    def level(self) -> str:
        """Level that ``CONFIRMING`` of the newest answers reach; 'none' with fewer answers."""
        ranks = sorted((LEVELS.index(level) for level, _, _ in self.newest), reverse=True)
        return LEVELS[ranks[CONFIRMING - 1]] if len(ranks) >= CONFIRMING else 'none'

    @property
    def place(self) -> str:
        """Place that ``CONFIRMING`` of the newest answers name as a fault; '' if there is none."""
        named = Counter(place for _, place, _ in self.newest if place).most_common(1)
        return named[0][0] if named and named[0][1] >= CONFIRMING else ''

    def __str__(self) -> str:
        """Return the common answer in words, or why there is none."""
        level, of = self.level, f'of the last {len(self.newest)} snapshots alone'
        if level == 'none':
            mute = [why for said, _, why in self.newest if said == 'none']
            if len(mute) < CONFIRMING:
                return ''
            return f'{len(mute)} {of} say nothing ({Counter(mute).most_common(1)[0][0]})'
        place, rank = self.place, LEVELS.index(level)
        agree = [said for said, *_ in self.newest if LEVELS.index(said) >= rank]
        if place:
            agree = [said for said, named, _ in self.newest if named == place]
        return f'{len(agree)} {of} say {place and f"{place}, "}{level}'
