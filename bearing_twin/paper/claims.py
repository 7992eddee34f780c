# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A claim of the paper beside our number and a verdict."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from bearing_twin.paper.verdicts import Verdict

__all__ = ['Claim', 'percent', 'percents', 'rounded']


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
    verdict: Verdict
    """Computed from the numbers by the rule that `why` names."""
    why: str
    """Rule and reason."""

    def to_dict(self) -> dict[str, Any]:
        """Return the fields, numbers rounded to 6 digits, ready for JSON."""
        fields = dataclasses.asdict(self)
        for name in ('paper_value', 'our_value'):
            fields[name] = rounded(fields[name])
        return fields


def rounded(value: Any, digits: int = 6) -> Any:
    """Round every number inside ``value`` to significant digits; NumPy becomes plain Python."""
    if isinstance(value, Mapping):
        return {str(key): rounded(item, digits) for key, item in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [rounded(item, digits) for item in value]
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (float, np.floating)):
        return float(f'{value:.{digits}g}')
    if isinstance(value, np.integer):
        return int(value)
    return value


def percent(change: float) -> str:
    """Write a relative change, e.g. ``'-2.7 %'``."""
    return f'{100.0 * change:+.1f} %'


def percents(changes: Mapping[str, float]) -> dict[str, float]:
    """Return relative changes in percent, to two decimals, the unit in their names."""
    return {f'{name} (%)': round(100.0 * change, 2) for name, change in changes.items()}
