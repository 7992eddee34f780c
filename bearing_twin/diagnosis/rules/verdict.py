# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Verdict of a rule."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.diagnosis.rules.confidence import confidence, kind_of, Trust
from bearing_twin.diagnosis.thresholds import INDEX_FAULT, INDEX_NOISE

if TYPE_CHECKING:
    from bearing_twin.diagnosis.combs.candidate import Candidate
    from bearing_twin.diagnosis.rules.evidence import Evidence

NO_ALARM = f'modulation index below {INDEX_FAULT:g}: not an alarm'


def highest_comb(candidates: Iterable[Candidate]) -> Candidate | None:
    """
    Return the most significant comb with a larger index than noise, or None.

    >>> from bearing_twin.diagnosis.combs.candidate import Candidate
    >>> chance = Candidate('outer', 3.06, 0.0, z=5.0, index=0.0)
    >>> highest_comb([chance, Candidate('inner', 4.94, 0.0, z=4.0, index=0.2)]).place
    'inner'

    """
    shown = (c for c in candidates if c.index >= INDEX_NOISE)
    return max(shown, key=lambda c: c.z, default=None)


class Verdict(NamedTuple):
    """Decision on one window or on the mean of several."""

    level: str
    reasons: tuple[str, ...]
    candidates: dict[str, Candidate]
    result: str = ''
    """Answer of the rule that decided; '' until
    :func:`bearing_twin.diagnosis.rules.table.decide`."""
    faults: tuple[str, ...] = ()
    strongest: Candidate | None = None
    """Comb that the verdict is about, or None."""
    rule: str = ''
    """Name of the rule that decided."""
    trust: Trust = Trust()
    """Basis of the confidence."""

    @property
    def kind(self) -> str:
        """Kind of answer, see :data:`bearing_twin.diagnosis.rules.confidence.CLAIMS`, or ''."""
        return kind_of(self.result, self.level, self.faults, self.rule)

    @property
    def confidence(self) -> float:
        """Share of right answers on simulated machines with such evidence: see ``confidence``."""
        return confidence(self.kind, self.trust) if self.kind else 0.0

    @property
    def weight(self) -> float:
        """Weight of the comb that the verdict is about; 0 without one."""
        return self.strongest.weight if self.strongest else 0.0


def say(
    e: Evidence,
    *texts: str,
    about: Candidate | None = None,
    faults: tuple[str, ...] | None = None,
    level: str = 'suspect',
    candidates: dict[str, Candidate] | None = None,
) -> Verdict:
    """
    Return a verdict with the reasons ``texts``; the table of rules adds the answer.

    It is about a comb or none. It names ``faults``, by default the place of the comb.

    >>> from bearing_twin.diagnosis.combs.candidate import Candidate
    >>> from bearing_twin.diagnosis.rules.evidence import Evidence
    >>> inner = Candidate('inner', order=4.93, slip=0.01, z=9.0, index=0.8)
    >>> said = say(Evidence.of(inner), 'check the speed', about=inner)
    >>> said.faults, said.level, said.reasons[1]
    (('inner',), 'suspect', 'check the speed')

    """
    if faults is None:
        faults = (about.place,) if about else ()
    return Verdict(
        level=level,
        faults=faults,
        reasons=(str(about), *texts) if about else texts,
        candidates=candidates or e.candidates,
        strongest=about,
    )


def no_statement(e: Evidence, *texts: str) -> Verdict:
    """
    Return a verdict without a statement: the reasons are the faint combs and ``texts``.

    >>> from bearing_twin.diagnosis.rules.evidence import Evidence
    >>> no_statement(Evidence.of(), 'few turns').level
    'none'

    """
    return say(e, *map(str, e.faint), *texts, level='none')


def unless_shaft(e: Evidence, comb: Candidate) -> str:
    """
    Return the level of a comb: *fault* if it is strong and strikes of the shaft do not fit it.

    >>> from bearing_twin.diagnosis.combs.candidate import Candidate
    >>> from bearing_twin.diagnosis.rules.evidence import Evidence
    >>> inner = Candidate('inner', order=4.93, slip=0.01, z=9.0, index=0.8)
    >>> unless_shaft(Evidence.of(inner), inner)
    'fault'
    >>> unless_shaft(Evidence.of(fits_shaft={'inner'}), inner)
    'suspect'

    """
    return 'fault' if comb.index >= INDEX_FAULT and comb.place not in e.fits_shaft else 'suspect'
