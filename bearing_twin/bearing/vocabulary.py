# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The words of a diagnosis: fault places, answers, levels and codes, for every room."""

from __future__ import annotations

from typing import Literal

__all__ = [
    'FAULT_CODES',
    'LEVELS',
    'NEXT_STEPS',
    'PLACES',
    'RESULTS',
    'TITLES',
    'Place',
]

Place = Literal['inner', 'outer', 'ball', 'cage']

PLACES: tuple[Place, ...] = ('inner', 'outer', 'ball', 'cage')
"""Where a defect sits, in the order of every array that has one element a place."""

RESULTS: tuple[str, ...] = ('healthy', *PLACES, 'suspect', 'ambiguous', 'insufficient')
"""Every answer of a diagnosis, in the order of the constants of ``Diagnosis.msg``."""

LEVELS: tuple[str, ...] = ('none', 'ok', 'suspect', 'fault')
"""Every level, from the least to the most urgent; ``none`` makes no statement."""

FAULT_CODES: dict[str, str] = {
    'healthy': 'BEARING_OK',
    'inner': 'BEARING_INNER_RACE',
    'outer': 'BEARING_OUTER_RACE',
    'ball': 'BEARING_BALL',
    'cage': 'BEARING_CAGE',
    'suspect': 'BEARING_SUSPECT',
    'ambiguous': 'BEARING_AMBIGUOUS',
    'insufficient': 'BEARING_NO_STATEMENT',
}
"""Stable code of every answer, for programs that react to it."""

TITLES: dict[str, str] = {
    'healthy': 'Healthy',
    'inner': 'Inner race fault',
    'outer': 'Outer race fault',
    'ball': 'Ball fault',
    'cage': 'Cage fault',
    'suspect': 'Suspect',
    'ambiguous': 'Ambiguous',
    'insufficient': 'Insufficient',
}
"""Heading of every answer, for people."""

NEXT_STEPS: dict[str, str] = {
    'healthy': 'nothing now; record again at the usual interval, at the same speed and load',
    'inner': 'record again soon; if the level rises, plan to replace the bearing',
    'outer': 'record again soon; if the level rises, plan to replace the bearing',
    'ball': 'record again soon; if the level rises, plan to replace the bearing',
    'cage': 'plan to replace the bearing soon: a cage fails without much warning',
    'suspect': 'record again at a shorter interval, as long as possible, and watch the level',
    'ambiguous': 'record longer and measure the shaft speed: that parts what coincides',
    'insufficient': 'mend what the reasons name, and record again',
}
"""What to do after every answer, for people."""
