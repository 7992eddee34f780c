# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a rule decides."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from bearing_twin.bearing import PLACES
from bearing_twin.diagnosis.rules.confidence import confidence, Trust
from bearing_twin.diagnosis.thresholds import INDEX_NOISE

if TYPE_CHECKING:
    from collections.abc import Iterable

    from bearing_twin.diagnosis.combs.candidate import Candidate


def highest_comb(candidates: Iterable[Candidate]) -> Candidate | None:
    """
    Most significant comb that modulates the envelope by more than noise does.

    >>> from bearing_twin.diagnosis.combs.candidate import Candidate
    >>> chance = Candidate('outer', 3.06, 0.0, z=5.0, index=0.0)
    >>> highest_comb([chance, Candidate('inner', 4.94, 0.0, z=4.0, index=0.2)]).place
    'inner'

    """
    shown = (c for c in candidates if c.index >= INDEX_NOISE)
    return max(shown, key=lambda c: c.z, default=None)


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """The decision on one window or on the mean of several."""

    result: str = ''
    """Answer of the rule that decided; '' until
    :func:`bearing_twin.diagnosis.rules.table.decide`."""
    level: str
    faults: tuple[str, ...] = ()
    reasons: tuple[str, ...]
    candidates: dict[str, Candidate]
    strongest: Candidate | None = None
    """The comb that the verdict is about; None where it is about none."""
    rule: str = ''
    """Name of the rule that decided."""
    trust: Trust = field(default_factory=Trust)
    """What the confidence rests on."""

    @property
    def kind(self) -> str:
        """Kind of answer, by which answers are compared: see ``confidence``; '' for no answer."""
        if self.result == 'insufficient':
            return ''
        if self.result in PLACES:
            # A place that is named without an alarm has the trust of a suspicion.
            return 'suspect' if self.level == 'suspect' else 'fault'
        if self.result == 'suspect' and (not self.faults or self.rule == 'extraneous'):
            # The lines at a fault order are said to be of something else.
            return 'elsewhere'
        return self.result

    @property
    def confidence(self) -> float:
        """Share of right answers among simulated ones like this: see ``confidence``."""
        return confidence(self.kind, self.trust) if self.kind else 0.0

    @property
    def weight(self) -> float:
        """Weight of the comb that the verdict is about; 0 without any."""
        return self.strongest.weight if self.strongest else 0.0
