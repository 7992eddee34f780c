# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a rule is: a function of the evidence, its answer, and what is asked about this."""

from __future__ import annotations

from typing import Any, NamedTuple, TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from bearing_twin.diagnosis.rules.evidence import Evidence
    from bearing_twin.diagnosis.rules.verdict import Verdict

    _Apply = Callable[[Evidence], Verdict | None]

EVEN = 0.5
"""Most that an answer is sure of where something sound explains the lines as well as a fault."""


class Rule(NamedTuple):
    """One rule of the table."""

    name: str
    answer: str
    why: str
    apply: Callable[[Evidence], Verdict | None]
    """Verdict on the evidence; None where the rule does not apply."""
    faint: bool = False
    """Whether a second look at parts of the record may change the answer. Set it where the rule
    answers without an alarm although a weak comb is there."""
    nothing_shows: bool = False
    """Whether the level of the record may go into the baseline although the answer is not healthy.
    Set it where a window shows no fault, but cannot call the machine healthy."""
    at_most: float = 1.0
    """Confidence that its answers cannot pass."""


def rule(answer: str, why: str, **marks: Any) -> Callable[[_Apply], Rule]:
    """
    Make a function a rule, which has its name; ``marks`` are the other fields of :class:`Rule`.

    >>> @rule('suspect', 'A comb is there.', faint=True)
    ... def anything(evidence):
    ...     return None
    >>> anything.name, anything.faint
    ('anything', True)

    """
    return lambda apply: Rule(apply.__name__, answer, why, apply, **marks)


def where_no_comb_remains(*rules: Rule) -> list[Rule]:
    """
    Return rules that apply only where no comb is left to lead: `Evidence.leading` is none there.

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
