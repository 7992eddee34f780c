# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Confidence: share of right answers with such evidence on simulated machines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
import functools
from importlib import resources
import json
import math
from statistics import fmean
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import PLACES
from bearing_twin.diagnosis.signal.gate import HEALTHY_TURNS
from bearing_twin.diagnosis.thresholds import SLIP_COST

if TYPE_CHECKING:
    from bearing_twin.diagnosis.combs.candidate import Candidate
    from bearing_twin.diagnosis.rules.evidence import Evidence

CLAIMS = {
    'fault': 'that this place is damaged',
    'suspect': 'that the bearing is damaged',
    'ambiguous': 'that one of these places is damaged',
    'elsewhere': 'that something strikes, not which part',
    'healthy': 'that no part is damaged',
}
"""Kinds of answers with a confidence, and the claim that is right or wrong. ``'fault'`` is for
every named fault, ``'elsewhere'`` for impacts at an order of no part of the bearing."""
KINDS = tuple(CLAIMS)

_OF_ELSE = ('another_cage', 'ball_without_cage_sidebands', 'extraneous', 'whole_turns')
"""Rules that say of the lines at a fault order that something else makes them, or may."""

_SOUND = {
    'constant': 3.3489,
    'significance': -0.9981,
    'effect': -0.2942,
    'slip': -0.3883,
    'elsewhere_effect': -0.7882,
    'impacts': -0.1215,
    'turns': -0.1047,
    'unsteady': -0.0436,
}
"""Weights of the terms in the log odds that a bearing without a statement is healthy. Rules use
them, so they are not fitted anew with the confidence."""


@dataclass(frozen=True)
class Trust:
    """
    Basis of the confidence of an answer.

    >>> Trust(z=9.0, index=0.8).terms()['significance'] > Trust(z=6.0, index=0.8).terms()[
    ...     'significance'
    ... ]
    True
    """

    z: float = 0.0
    """Score of the comb that the answer is about; of the highest comb if it is about none."""
    index: float = 0.0
    """Modulation index of that comb."""
    slip: float = 0.0
    """Slip that the comb needs."""
    elsewhere_z: float = 0.0
    """Score of the best comb at any order."""
    elsewhere_index: float = 0.0
    impacts: float = 0.0
    """Mean log score over noise of the second to fourth harmonic of the clearer of the two combs:
    0 for a smooth modulation, which has the first harmonic only."""
    others: float = 0.0
    """Mean logarithm of the scores of the best combs of the other places: a spall marks one part
    of a bearing, waviness shows at the orders of all parts."""
    turns: float = HEALTHY_TURNS
    """Number of shaft turns."""
    steady: bool = True
    """Whether the shaft speed is known well enough to compare slips."""
    rule: str = ''
    """Rule that decided: rules with the same answer are not equally reliable."""
    at_most: float = 1.0
    """Highest confidence of its answers."""

    @classmethod
    def on(
        cls, e: Evidence, comb: Candidate | None, candidates: dict[str, Candidate], **known: Any
    ) -> Trust:
        """
        Return the basis of an answer about a comb, or none; ``candidates`` are the places' combs.

        ``known`` are other fields.
        """
        # The comb itself counts at any order, also on a multiple of the shaft.
        strongest = max(e.elsewhere, comb or e.elsewhere, key=lambda c: c.z)
        z, index, slip = (comb.z, comb.index, comb.slip) if comb else (0.0, 0.0, 0.0)
        impacts = e.impacts.get(strongest.place, 0.0)
        own = comb.place if comb else ''
        others = fmean(math.log(max(c.z, 1.0)) for c in candidates.values() if c.place != own)
        return cls(
            z, index, slip, strongest.z, strongest.index, impacts, others, e.turns, e.speed_known,
            **known,
        )  # fmt: skip

    @property
    def healthy_log_odds(self) -> float:
        """Log odds that a bearing without a statement is healthy; rules use them."""
        return self.terms()['sound']

    def terms(self) -> dict[str, float]:
        """Return the terms of the logistic model by name; that of the rule has the rule's name."""
        significance = math.log(max(self.z, 1.0))
        elsewhere = math.log(max(self.elsewhere_z, 1.0))
        terms = {
            'constant': 1.0,
            'significance': significance,
            'effect': min(self.index, 2.0),
            'slip': min(abs(self.slip) / SLIP_COST, 3.0),
            'elsewhere': max(elsewhere - significance, 0.0),
            'elsewhere_effect': elsewhere * min(self.elsewhere_index, 1.0),
            'impacts': min(max(self.impacts, 0.0), 3.0),
            'others': self.others,
            'turns': math.log(self.turns / HEALTHY_TURNS),
            'unsteady': 0.0 if self.steady else 1.0,
        }
        sound = sum(weight * terms[name] for name, weight in _SOUND.items())
        return {**terms, 'sound': sound, self.rule: 1.0}


def kind_of(result: str, level: str, faults: Sequence[str], rule: str) -> str:
    """
    Return the kind of an answer, one of :data:`KINDS`; '' if it makes no statement.

    Parameters
    ----------
    result, level, faults
        The answer, its level and the places that it names.
    rule
        Rule that decided.

    >>> kind_of('outer', 'fault', ('outer',), ''), kind_of('outer', 'suspect', ('outer',), '')
    ('fault', 'suspect')
    >>> CLAIMS[kind_of('suspect', 'suspect', (), 'elsewhere')]
    'that something strikes, not which part'

    """
    if result == 'insufficient':
        return ''
    if result in PLACES:
        # A named place without an alarm has the confidence of a suspicion.
        return 'suspect' if level == 'suspect' else 'fault'
    if rule in _OF_ELSE or (result in ('suspect', 'ambiguous') and not faults):
        return 'elsewhere'
    return result


@functools.cache
def shipped_weights() -> dict[str, dict[str, float]]:
    """
    Return the weights by kind of answer, from :mod:`bearing_twin.studies.reliability`.

    >>> sorted(shipped_weights()) == sorted(KINDS)
    True

    """
    text = resources.files('bearing_twin.diagnosis.rules').joinpath('reliability.json')
    table: dict[str, dict[str, float]] = json.loads(text.read_text('utf-8'))['weights']
    return table


def confidence(kind: str, trust: Trust) -> float:
    """
    Return the share of right answers of a kind with such evidence on simulated machines.

    A named fault is right if it is there and no other; an ambiguous answer, if it names the fault
    among others; *suspect*, if any part of the bearing is damaged; impacts elsewhere, if something
    strikes; *healthy*, if there is no fault, however small. Half of the machines are healthy. They
    are drawn at random, some with another bearing or speed than the diagnosis is given (``python
    -m bearing_twin.studies.reliability``). The share on your machines differs with the size of
    their faults.

    Parameters
    ----------
    kind
        One of :data:`KINDS`.
    trust
        Basis of the confidence.

    Returns
    -------
    0 to 1: the logistic function of the weighted sum of :meth:`Trust.terms`.

    >>> clear, faint = Trust(z=15.0, index=1.5), Trust(z=6.0, index=0.6)
    >>> confidence('fault', clear) > confidence('fault', faint)
    True

    """
    return share_right(shipped_weights()[kind], trust)


def share_right(weights: dict[str, float], trust: Trust) -> float:
    """
    Return the logistic function of the weighted terms; a rule without a weight adds none.

    >>> trust = Trust(z=10.0, rule='mains_pulses', at_most=0.9)
    >>> round(share_right({'constant': 1.0, 'mains_pulses': -1.0}, trust), 2)
    0.5
    >>> share_right({'constant': 9.0}, trust)
    0.9

    """
    total = sum(weights.get(name, 0.0) * value for name, value in trust.terms().items())
    return min(1.0 / (1.0 + math.exp(-total)), trust.at_most)
