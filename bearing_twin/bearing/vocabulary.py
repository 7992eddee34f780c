# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The words of a diagnosis: fault places, answers, levels and codes, for every room."""

from __future__ import annotations

from typing import Literal

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

STAGES: tuple[str, ...] = ('', 'incipient', 'developing', 'advanced', 'severe')
"""Name of every stage of a defect, 1 to 4; 0: the stage is not known."""

STAGE_STEPS: tuple[str, ...] = (
    'record again soon; if the level rises, plan to replace the bearing',
    'check the lubrication; measure weekly',
    'order a bearing; measure daily',
    'replace the bearing at the next planned stop',
    'stop the machine as soon as it is safe and replace the bearing',
)
"""What to do about a defect of every stage, for people; 0: the stage is not known."""

_STEPS: dict[str, str] = {
    'healthy': 'nothing; go on measuring at the same speed and load',
    'cage': 'plan to replace the bearing soon: a cage fails without much warning',
    'suspect': 'check bearing and speed, record again as long as possible, and watch the level',
    'ambiguous': 'record longer, or at a speed some per cent off, so that the orders part',
    'insufficient': 'mend what the reasons name, and record again',
}


def next_step(result: str, stage: int = 0, *, urgent: bool = False, standing: bool = False) -> str:
    """
    Return what to do after an answer, for people.

    Parameters
    ----------
    result : str
        The answer, one of ``RESULTS``.
    stage : int
        Stage of the defect, an index of ``STAGES``; it decides where a place is named, and where
        it is one of several.
    urgent : bool
        Whether the vibration is that of a damaged machine; where a place is named, more than
        its fault alone asks for.
    standing : bool
        Whether the shaft stands still; asked where the answer is *insufficient*.

    Returns
    -------
    str
        One clause, without a capital and a full stop.

    Examples
    --------
    >>> next_step('inner', 2)
    'order a bearing; measure daily'
    >>> next_step('ambiguous', urgent=True)
    'find the cause of the high vibration now: balance, alignment, looseness, bearing'
    >>> next_step('inner', 2, urgent=True).partition('; ')[2]
    'order a bearing; measure daily'
    >>> next_step('cage', 1)
    'plan to replace the bearing soon: a cage fails without much warning'
    >>> next_step('ambiguous', 2).partition('; record')[0]
    'order a bearing; measure daily'

    """
    urgently = 'find the cause of the high vibration now: balance, alignment, looseness, bearing'
    if result in PLACES:
        begun = result == 'cage' and stage < 3
        step = _STEPS[result] if begun else STAGE_STEPS[stage]
        return f'{urgently}; {step}' if urgent and stage < 4 else step
    if urgent:
        return urgently
    if standing and result == 'insufficient':
        return 'measure while the shaft turns'
    if result == 'ambiguous' and stage:
        # The bearing is damaged, in whichever of its places.
        return f'{STAGE_STEPS[stage]}; {_STEPS[result]}'
    return _STEPS.get(result, STAGE_STEPS[0])
