# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a rule decides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bearing_twin.bearing import PLACES
from bearing_twin.diagnosis.confidence import confidence
from bearing_twin.diagnosis.thresholds import INDEX_NOISE

if TYPE_CHECKING:
    from collections.abc import Iterable

    from bearing_twin.diagnosis.search import Candidate

__all__ = ['Verdict', 'highest_comb']


def highest_comb(candidates: Iterable[Candidate]) -> Candidate | None:
    """
    Most significant comb that modulates the envelope by more than noise does.

    A healthy bearing forces its housing at the outer race's frequency (variable compliance): such
    a comb may be as significant as any, but has no effect in the bands in which impacts ring.

    >>> from bearing_twin.diagnosis.search import Candidate
    >>> compliance = Candidate('outer', 3.06, 0.0, z=20.0, index=0.0)
    >>> highest_comb([compliance, Candidate('inner', 4.94, 0.0, z=4.0, index=0.2)]).place
    'inner'

    """
    shown = (c for c in candidates if c.index >= INDEX_NOISE)
    return max(shown, key=lambda c: c.z, default=None)


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """The decision on one window or on the mean of several."""

    result: str
    level: str
    faults: tuple[str, ...] = ()
    reasons: tuple[str, ...]
    candidates: dict[str, Candidate]
    strongest: Candidate | None = None
    """The comb that the verdict is about; None where it is about none."""
    rule: str = ''
    """Name of the rule that decided."""

    @property
    def confidence(self) -> float:
        """Share of right answers among simulated ones like this: see ``confidence``."""
        if not self.faults:
            highest = highest_comb(self.candidates.values())
            return confidence(self.result, highest.z if highest else 0.0)
        # A place that is named without an alarm has the trust of a suspicion.
        quiet = self.level == 'suspect' and self.result in PLACES
        kind = 'suspect' if quiet else self.result
        return confidence(kind, max(self.candidates[name].z for name in self.faults))

    @property
    def weight(self) -> float:
        """Weight of the comb that the verdict is about; 0 without any."""
        return self.strongest.weight if self.strongest else 0.0
