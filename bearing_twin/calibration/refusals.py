# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a vibration does not tell of a defect, and why."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.calibration import posterior
from bearing_twin.calibration.healthy import COMB_OVER_FLOOR, line_over_floor
from bearing_twin.calibration.passage import widest
from bearing_twin.calibration.summaries import summarise

if TYPE_CHECKING:
    from collections.abc import Iterable

    from bearing_twin.calibration.cloud import Situation
    from bearing_twin.calibration.posterior import Posterior
    from bearing_twin.calibration.summaries import Summary
    import numpy as np
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

__all__ = [
    'MANY_WIDTHS',
    'NARROWED',
    'WIDER',
    'no_impacts',
    'ringing',
    'too_wide',
    'unresolved',
    'untold',
]

NARROWED = 0.5
"""A quantity is identifiable where its 90 % interval is at most this share of the prior's."""
ALIKE = 2.0
"""Most that the candidates kept may be farther from the machine than from each other."""
RIVAL = 0.25
"""Most that a second spacing may be as clear as the first. Fixed on CWRU, as is `RESOLVED`: spots
of 0.18 mm leave a second impact after 2.0 ms at any speed, beside another a third as clear."""
MANY_WIDTHS = 'defects of many widths give impacts like these'
WIDER = 'the defect may be wider'
PERIODS = 2.0
"""Least periods of the resonance it excites that a passage has to last."""
SAME_TIME, OTHER_SPEED = 0.03, 1.08
"""Two impacts at the same time within this share at speeds this far apart are ringing."""


def no_impacts(x: FloatArray, situation: Situation) -> str:
    """
    Return why the part that is named does not strike in a record; '' if it does.

    Parameters
    ----------
    x
        The record, shape (n,).
    situation
        Of the machine; its slip is not known.

    Examples
    --------
    >>> import numpy as np
    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.calibration.cloud import Situation
    >>> machine = Situation(
    ...     bearing=find_bearing('6205'), place='outer', shaft_hz=25.0, sample_rate=12800.0
    ... )
    >>> no_impacts(np.random.default_rng(1).standard_normal(25600), machine)[:44]
    'no impacts at the 89.6 Hz of the outer race '

    """
    strikes = situation.strikes
    if line_over_floor(x, situation) >= COMB_OVER_FLOOR:
        return ''
    return (
        f'no impacts at the {strikes:.1f} Hz of the {situation.place} race stand out: check '
        'bearing, speed and place'
    )


def too_wide(x: FloatArray, situation: Situation, measured: Summary) -> str:
    """
    Why a defect may be wider than is simulated; '' if it is not.

    Parameters
    ----------
    x
        The record, shape (n,).
    situation
        Of the machine.
    measured
        Summary of the record.

    Examples
    --------
    >>> import numpy as np
    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.calibration.cloud import Situation
    >>> machine = Situation(
    ...     bearing=find_bearing('6205'), place='outer', shaft_hz=25.0, sample_rate=12800.0
    ... )
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> too_wide(noise, machine, summarise(noise, 12800.0, machine.longest))
    ''

    """
    # Half way to the next ball it is no longer clear which two impacts are of one.
    farther = summarise(x, situation.sample_rate, 0.45 / situation.strikes)
    # Of noise alone, the longer the lags the likelier a peak; but never one so much clearer.
    clear = farther.prominence > measured.prominence and farther.rival <= RIVAL
    if not (clear and farther.spacing > situation.longest):
        return ''
    return (
        f'the clearest two impacts are {1e3 * farther.spacing * situation.speed:.1f} mm apart on '
        f'the race, and the widest defect that is simulated has '
        f'{1e3 * widest(situation.bearing):.1f} mm: {WIDER}'
    )


def unresolved(measured: Summary) -> str:
    """
    Why a record tells no spacing of the impacts of a passage; '' if it does.

    Examples
    --------
    >>> import numpy as np
    >>> from bearing_twin.calibration.summaries import summarise
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> bool(unresolved(summarise(noise, 12800.0, 5e-4)))
    True

    """
    shortest = posterior.resolved(measured)
    if not measured.seen or measured.spacing < shortest:
        seen = f'{1e3 * measured.spacing:.2f} ms apart' if measured.seen else 'not told apart'
        return (
            f'the impacts of a passage are {seen}; the ringing of one hides a second up to '
            f'{1e3 * shortest:.2f} ms'
        )
    return ''


def untold(measured: Summary, left: Posterior, situation: Situation, fastest: float) -> str:
    """
    Why the candidates that were kept tell no width; '' if they do.

    Parameters
    ----------
    measured
        Summary of the vibration.
    left
        The candidates.
    situation
        Of the machine.
    fastest
        Highest frequency of a resonance that the impacts excite, Hz; NaN if none was found.

    Examples
    --------
    >>> from dataclasses import replace
    >>> import numpy as np
    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.calibration.cloud import Situation
    >>> from bearing_twin.calibration.summaries import summarise
    >>> machine = Situation(
    ...     bearing=find_bearing('6205'), place='outer', shaft_hz=25.0, sample_rate=12800.0
    ... )
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> measured = replace(summarise(noise, 12800.0, machine.longest), rival=0.0)
    >>> left = posterior.limit(measured, machine, candidates=32)
    >>> untold(measured, left, machine, 10.0).startswith('the passage lasts')
    True

    """
    if measured.rival > RIVAL:
        return 'the impacts repeat after several times that are about as clear: ringing'
    median = 1e-3 * float(left.quantiles('defect_width_mm', (0.5,))[0])
    periods = median / situation.speed * fastest
    if periods < PERIODS:
        return (
            f'the passage lasts {periods:.1f} periods of the resonance at {fastest:.0f} Hz '
            f'that it excites; {PERIODS:g} are needed'
        )
    if left.distance > ALIKE * left.typical:
        return 'no candidate of the twin gives impacts like these'
    return MANY_WIDTHS if left.narrowed('defect_width_mm') > NARROWED else ''


def ringing(
    place: str, shaft_hz: float, spacing: float, others: Iterable[tuple[str, float, float]]
) -> str:
    """
    Why a spacing is no passage: it is the same at another speed; '' if it is at none.

    Parameters
    ----------
    place, shaft_hz, spacing
        Part with the defect, shaft speed in Hz and time between the impacts in s.
    others
        The same of other records of the machine.

    Examples
    --------
    >>> ringing('inner', 20.0, 1.50e-3, [('inner', 10.0, 3.1e-3)])
    ''
    >>> ringing('inner', 20.0, 1.50e-3, [('inner', 10.0, 1.51e-3)]).partition(':')[0]
    'the impacts are 1.51 ms apart at 10.0 and at 20.0 Hz'

    """
    for other, hz, time in others:
        apart = max(hz, shaft_hz) / min(hz, shaft_hz)
        if other == place and apart > OTHER_SPEED and abs(time / spacing - 1.0) < SAME_TIME:
            return (
                f'the impacts are {1e3 * time:.2f} ms apart at {hz:.1f} and at '
                f'{shaft_hz:.1f} Hz: ringing, which does not follow the speed'
            )
    return ''
