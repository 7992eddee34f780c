# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Rule of the diagnosis: a function of the evidence, with its answer and properties."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TYPE_CHECKING

if TYPE_CHECKING:
    from bearing_twin.diagnosis.rules.evidence import Evidence
    from bearing_twin.diagnosis.rules.verdict import Verdict

    _Apply = Callable[[Evidence], Verdict | None]

EVEN = 0.5
"""Highest confidence of an answer if a healthy cause explains the lines as well as a fault."""


class Rule(NamedTuple):
    """One rule of the table."""

    name: str
    answer: str
    why: str
    apply: Callable[[Evidence], Verdict | None]
    """Function that returns the verdict on the evidence; None if the rule does not apply."""
    faint: bool = False
    """Whether a second look at parts of the record may change the answer. Set it if the rule gives
    no alarm although there is a weak comb."""
    nothing_shows: bool = False
    """Whether the vibration level may enter the baseline although the answer is not healthy. Set
    it if the window shows no fault, but cannot call the machine healthy."""
    at_most: float = 1.0
    """Highest confidence of its answers."""
    tells: str = ''
    """Next step that tells the bearing from what else its sentence names, before anything is done
    to the bearing; '' where the answer alone decides."""


def rule(answer: str, why: str, **marks: Any) -> Callable[[_Apply], Rule]:
    """
    Make a function a rule with its name; ``marks`` are the other fields of :class:`Rule`.

    >>> @rule('suspect', 'A comb is there.', faint=True)
    ... def anything(evidence):
    ...     return None
    >>> anything.name, anything.faint
    ('anything', True)

    """
    return lambda apply: Rule(apply.__name__, answer, why, apply, **marks)


def where_no_comb_remains(*rules: Rule) -> list[Rule]:
    """
    Return rules that apply only if no comb remains. `Evidence.leading` does not exist then.

    >>> from bearing_twin.diagnosis.combs.candidate import Candidate
    >>> from bearing_twin.diagnosis.rules.evidence import Evidence
    >>> said = rule('healthy', 'Nothing is there.')(lambda evidence: 'a verdict')
    >>> [quiet] = where_no_comb_remains(said)
    >>> quiet.apply(Evidence.of())
    'a verdict'
    >>> quiet.apply(Evidence.of(Candidate('outer', order=3.07, slip=0.01, z=9.0, index=0.8)))

    """

    def quiet(apply: _Apply) -> _Apply:
        return lambda e: None if e.remaining else apply(e)

    return [rule._replace(apply=quiet(rule.apply)) for rule in rules]
