# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a rule decides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.confidence import confidence

if TYPE_CHECKING:
    from bearing_twin.diagnosis.search import Candidate

__all__ = ['Verdict']


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
        named = self.faults or tuple(self.candidates)
        return confidence(self.result, max(self.candidates[name].z for name in named))

    @property
    def weight(self) -> float:
        """Weight of the comb that the verdict is about; 0 without any."""
        return self.strongest.weight if self.strongest else 0.0
