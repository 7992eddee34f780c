# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Vocabulary of the diagnosis: fault places, results, levels, codes and advice."""

from __future__ import annotations

from typing import Literal

Place = Literal['inner', 'outer', 'ball', 'cage']

PLACES: tuple[Place, ...] = ('inner', 'outer', 'ball', 'cage')
"""Places of a defect, in the order of every array with one element per place."""

RESULTS: tuple[str, ...] = ('healthy', *PLACES, 'suspect', 'ambiguous', 'insufficient')
"""Results of a diagnosis, in the order of the constants of ``Diagnosis.msg``."""

LEVELS: tuple[str, ...] = ('none', 'ok', 'suspect', 'fault')
"""Levels, from the least to the most urgent; ``none`` makes no statement."""

FAULT_CODES: dict[str, str] = {
    'healthy': 'BEARING_OK',
    'inner': 'BEARING_INNER_RACE',
    'outer': 'BEARING_OUTER_RACE',
    'ball': 'BEARING_BALL',
    'cage': 'BEARING_CAGE',
    'suspect': 'BEARING_SUSPECT',
    'ambiguous': 'BEARING_AMBIGUOUS',
    'insufficient': 'BEARING_INSUFFICIENT',
}
"""Stable code of each result, for programs that react to it."""

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
"""Heading of each result, for people."""

STAGES: tuple[str, ...] = ('', 'incipient', 'developing', 'advanced', 'severe')
"""Names of the stages of a defect, 1 to 4; 0: the stage is not known."""

STAGE_STEPS: tuple[str, ...] = (
    'record again soon; if the level rises, plan to replace the bearing',
    'check the lubrication; measure weekly',
    'order a bearing; measure daily',
    'replace the bearing at the next planned stop',
    'stop the machine as soon as it is safe and replace the bearing',
)
"""Advice for each stage of a defect, for people; 0: the stage is not known."""

_BY_LEVEL = 3
"""Stage from which on the level of the vibration asks for a step, whatever strikes."""

_STEPS: dict[str, str] = {
    'healthy': 'nothing; go on measuring at the same speed and load',
    'cage': 'plan to replace the bearing soon: a cage fails without much warning',
    'suspect': 'check bearing and speed, record again as long as possible, and watch the level',
    'ambiguous': 'record longer, with a measured speed, so that the fault orders separate',
    'insufficient': 'correct the causes that the reasons name, and record again',
}


def next_step(
    result: str,
    stage: int = 0,
    *,
    urgent: bool = False,
    standing: bool = False,
    tells: str = '',
) -> str:
    """
    Return the advice for a result, for people.

    Parameters
    ----------
    result : str
        One of ``RESULTS``.
    stage : int
        Stage of the defect, an index of ``STAGES``; it counts when the result is a place or
        *ambiguous*.
    urgent : bool
        Whether the vibration severity is that of a damaged machine. When the result is a place,
        the severity must exceed what that fault alone explains.
    standing : bool
        Whether the shaft stands still; it counts when the result is *insufficient*.
    tells : str
        What would tell the bearing from something else that the answer may be about. It comes
        instead of a step about the bearing, unless the vibration alone asks for that.

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
    >>> next_step('ambiguous', 2, tells='look at the coupling')
    'look at the coupling'

    """
    urgently = 'find the cause of the high vibration now: balance, alignment, looseness, bearing'
    if result in PLACES:
        begun = result == 'cage' and stage < _BY_LEVEL
        step = _STEPS[result] if begun else STAGE_STEPS[stage]
        return f'{urgently}; {step}' if urgent and stage < 4 else step
    if urgent:
        return urgently
    if standing and result == 'insufficient':
        return 'measure while the shaft turns'
    if tells and stage < _BY_LEVEL:
        return tells
    if result == 'ambiguous' and stage:
        # The bearing is damaged; only the place is not known.
        return f'{STAGE_STEPS[stage]}; {_STEPS[result]}'
    return _STEPS.get(result, STAGE_STEPS[0])
