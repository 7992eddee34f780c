# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A claim of the paper, our value and a verdict, with the rules of the verdicts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
import math
from typing import Any, Literal

import numpy as np

Verdict = Literal[
    'reproduced',
    'reproduced_only_under_stated_settings',
    'misprint_holds_as_read',
    'contradicted',
    'not_checkable',
]
REPRODUCED: Verdict = 'reproduced'
UNDER_SETTINGS: Verdict = 'reproduced_only_under_stated_settings'
MISPRINT: Verdict = 'misprint_holds_as_read'
CONTRADICTED: Verdict = 'contradicted'
NOT_CHECKABLE: Verdict = 'not_checkable'
VERDICTS: tuple[Verdict, ...] = (REPRODUCED, UNDER_SETTINGS, MISPRINT, CONTRADICTED, NOT_CHECKABLE)


def within(paper: float | None, ours: float | None, tolerance: float) -> Verdict:
    """
    Judge one number: reproduced if ``|ours - paper| <= tolerance``.

    Not checkable where either is missing (None).
    """
    if paper is None or ours is None:
        return NOT_CHECKABLE
    return REPRODUCED if abs(ours - paper) <= tolerance else CONTRADICTED


def all_settings(holds: Mapping[str, bool]) -> Verdict:
    """
    Judge a statement tested under several settings or readings.

    Reproduced if it holds under all of them, contradicted if under none, otherwise reproduced
    only under stated settings; not checkable if nothing could be tested.
    """
    if not holds:
        return NOT_CHECKABLE
    if all(holds.values()):
        return REPRODUCED
    return UNDER_SETTINGS if any(holds.values()) else CONTRADICTED


def share(fraction: float) -> Verdict:
    """
    Judge a general statement by the fraction of a grid of settings in which it holds.

    Reproduced from 0.95 on, contradicted up to 0.05.
    """
    if math.isnan(fraction):
        return NOT_CHECKABLE
    if fraction >= 0.95:
        return REPRODUCED
    return CONTRADICTED if fraction <= 0.05 else UNDER_SETTINGS


def same_direction(stated: int, change: float, resolution: float) -> bool:
    """Whether a relative ``change`` goes the ``stated`` way (+1, -1), beyond ``resolution``."""
    return stated * change > resolution


@dataclass(frozen=True, kw_only=True)
class Claim:
    """One entry of claims.json."""

    id: str
    """Stable name."""
    where: str
    """Place in the paper."""
    claim: str
    """What the paper states."""
    paper_value: Any
    """Its number or direction; None if it states none."""
    our_value: Any
    """The same from our computation; None if there is nothing to compute it from."""
    why: str
    """Rule and reason; the settings too, if they decide."""
    verdict: Verdict = NOT_CHECKABLE
    """Computed from the numbers by the rule that `why` names; from `as_printed` where given."""
    as_printed: Mapping[str, bool] | None = None
    """Whether the claim holds as it is printed, under each setting that the paper leaves open."""
    as_read: Mapping[str, bool] | None = None
    """Whether it holds under the natural reading of a misprint. Only a claim that fails as
    printed under every setting, and holds under every reading, becomes a misprint."""

    def __post_init__(self) -> None:
        verdict, why = self.verdict, self.why
        if self.as_printed is not None:
            verdict = all_settings(self.as_printed)
            if len(set(self.as_printed.values())) > 1:
                why += _outcome('As printed ', self.as_printed)
        if self.as_read is not None:
            if self.as_printed is None:
                raise ValueError(f'{self.id}: a reading needs what is printed beside it')
            why += _outcome('As read ', self.as_read)
            if verdict == CONTRADICTED and all_settings(self.as_read) == REPRODUCED:
                verdict = MISPRINT
        object.__setattr__(self, 'verdict', verdict)
        object.__setattr__(self, 'why', why)

    def to_dict(self) -> dict[str, Any]:
        """Return the fields, numbers rounded to 6 digits, ready for JSON."""
        return {
            'id': self.id,
            'where': self.where,
            'claim': self.claim,
            'paper_value': rounded(self.paper_value),
            'our_value': rounded(self.our_value),
            'verdict': self.verdict,
            'why': self.why,
        }


def _outcome(lead: str, held: Mapping[str, bool]) -> str:
    """Return the settings in which a claim holds and fails, as a text."""
    text = ''
    for word, good in (('holds', True), ('fails', False)):
        names = '; '.join(name for name, outcome in held.items() if bool(outcome) is good)
        if names:
            text += f' {lead}{word}: {names}.'
    return text


def rounded(value: Any) -> Any:
    """Round every number inside ``value`` to 6 digits; NumPy becomes plain Python."""
    if isinstance(value, Mapping):
        return {str(key): rounded(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [rounded(item) for item in value]
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (float, np.floating)):
        return float(f'{value:.6g}')
    if isinstance(value, np.integer):
        return int(value)
    return value


def percent(change: float) -> str:
    """Write a relative change, e.g. ``'-2.7 %'``."""
    return f'{100.0 * change:+.1f} %'


def percents(changes: Mapping[str, float]) -> dict[str, float | None]:
    """Return relative changes in percent to two decimals, named with the unit; None for NaN."""
    return {
        f'{name} (%)': None if math.isnan(change) else round(100.0 * change, 2)
        for name, change in changes.items()
    }
