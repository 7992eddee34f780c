# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Verdicts on claims, each a function of numbers and a stated rule."""

from __future__ import annotations

import math
from typing import Literal, TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping


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
