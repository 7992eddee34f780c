# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a vibration does not tell of a defect, and why."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.calibration.answer.healthy import (
    between_impacts,
    COMB_OVER_FLOOR,
    line_over_floor,
    order_of_the_shaft,
    SLIPPED,
)
from bearing_twin.calibration.candidates import posterior
from bearing_twin.calibration.candidates.passage import widest
from bearing_twin.calibration.measured.summaries import CLEAR, ELSEWHERE, likeness, RIVAL
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.calibration.candidates.cloud import Situation
    from bearing_twin.calibration.candidates.posterior import Posterior
    from bearing_twin.calibration.measured.summaries import Correlation, Summary
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


NARROWED = 0.5
"""A quantity is identifiable where its 90 % interval is at most this share of the prior's."""
COPY = 0.33
"""Least `summaries.likeness` of two impacts that are no entry and exit; an exact inverse has 0.2
by its side lobes. It refuses an eighth of true passages: of 112 slots that share nothing with the
twin 16 are above, of 18 twins two, of 24 trains of impacts one; of 20 pairs of pits 14. Of 19
slots so shallow that balls roll on the bottom 11 are: such a passage is the same backwards."""
BETWEEN = 0.25
"""Least `healthy.between_impacts` of impacts that are half as frequent. Of 73 slots that share
nothing with the twin none is above 0.04; impacts of the other frequency have 0.7 and more."""
ALIKE = 2.0
"""Most that the candidates kept may be farther from the machine than from each other."""
NEXT_BALL = 1.1
"""Most that the exit of a ball and the entry of the next repeat as clearly as its own entry and
exit. Of 96 twins with both impacts one is above 1 (1.02) and one above 1.1, whose spacing was not
that of the defect; trains of narrow defects reach 0.75, 39 of defects wider than half of the way
to the next ball begin at 1.4."""
PERIODS = 2.0
"""Least periods of the resonance it excites that a passage has to last."""


class Kind(str, Enum):
    """Why no width is told."""

    NO_PART = 'no_part'
    """The diagnosis finds something and names no part."""
    NOT_FITTED = 'not_fitted'
    """Defects of this part are not fitted."""
    NO_IMPACTS = 'no_impacts'
    """The part that was named does not strike."""
    TOO_WIDE = 'too_wide'
    """The defect may be wider than any that is simulated."""
    ONE_IMPACT = 'one_impact'
    """One impact a passage is heard: the defect is narrow, or its other edge is faint or far."""
    HIDDEN = 'hidden'
    """The ringing of one impact hides a second."""
    SEVERAL_SPACINGS = 'several_spacings'
    """Impacts repeat after several times that are about as clear."""
    ALIKE = 'alike'
    """The second impact is a copy of the first."""
    SHORT_PASSAGE = 'short_passage'
    """The passage is too short for the resonance that it excites."""
    UNLIKE_THE_TWIN = 'unlike_the_twin'
    """No candidate of the twin is like the record."""
    MANY_WIDTHS = 'many_widths'
    """Candidates of many widths are."""
    SAME_AT_ANOTHER_SPEED = 'same_at_another_speed'
    """Another record shows the same time between impacts at another speed."""

    @property
    def unseen(self) -> bool:
        """Whether nothing is known of the defect, so that a twin has none."""
        return self in (Kind.NO_IMPACTS, Kind.NOT_FITTED)


class Refusal(NamedTuple):
    """A width that is not told."""

    kind: Kind
    why: str
    """In words."""
    farther: float = 0.0
    """Longest time between impacts, beyond those of simulated defects, that may be that of a
    passage, s; 0 if there is none."""


def no_impacts(x: FloatArray, situation: Situation) -> Refusal | None:
    """
    Return why the part that is named does not strike in a record; None if it does.

    Examples
    --------
    >>> import numpy as np
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example()
    >>> no_impacts(np.random.default_rng(1).standard_normal(25600), machine).why[:44]
    'no impacts at the 89.6 Hz of the outer race '

    """
    said = (
        f'no impacts at the {situation.strikes:.1f} Hz of the {situation.place} race stand out: '
    )
    if line_over_floor(x, situation) < COMB_OVER_FLOOR:
        return Refusal(Kind.NO_IMPACTS, f'{said}check bearing, speed and place')
    if situation.place == 'outer' and (order := order_of_the_shaft(x, situation)):
        return Refusal(
            Kind.NO_IMPACTS,
            f'{said}the line there is order {order} of the shaft, and the orders beside it are '
            'about as high',
        )
    return None


def half_as_often(x: FloatArray, situation: Situation) -> Refusal | None:
    """
    Return why impacts are not those of a part: they are half as frequent; None if they are not.

    Examples
    --------
    >>> import numpy as np
    >>> from dataclasses import replace
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example()
    >>> x = np.random.default_rng(1).standard_normal(51200)
    >>> x[::143] += 12.0
    >>> half_as_often(x, machine) is None
    True
    >>> half_as_often(x, replace(machine, sample_rate=0.5 * machine.sample_rate)).kind.value
    'no_impacts'

    """
    if between_impacts(x, situation) < BETWEEN:
        return None
    return Refusal(
        Kind.NO_IMPACTS,
        f'the impacts repeat at half the {situation.strikes:.1f} Hz of the {situation.place} '
        'race: check speed and sample rate',
    )


def too_wide(whole: Correlation, situation: Situation, measured: Summary) -> Refusal | None:
    """
    Return why a defect may be wider than is simulated; None if it is not.

    Examples
    --------
    >>> import numpy as np
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example()
    >>> from bearing_twin.calibration.measured.summaries import correlate
    >>> noise = correlate(np.random.default_rng(1).standard_normal(25600), 12800.0)
    >>> too_wide(noise, machine, noise.summary(machine.longest)) is None
    True

    """
    apart = 0.0
    for share in (0.45, 0.9):
        # Beyond half way the exit and the next ball's entry repeat too, but less clearly.
        farther = whole.summary(share / situation.strikes)
        # Of noise alone, the longer the lags the likelier a peak; but never one so much clearer.
        clear = farther.prominence > measured.prominence and farther.rival <= RIVAL
        if clear and farther.spacing > situation.longest:
            apart = apart or farther.spacing
    if not apart and measured.seen and measured.spacing >= posterior.resolved(measured):
        # Balls do not keep time: two impacts of one repeat more clearly than one of each of two.
        own, reach = measured.spacing, measured.lobe
        next_ball = whole.highest(1.0 / situation.strikes, SLIPPED / situation.strikes)[0]
        over_own = whole.highest(next_ball - own, reach)[1] / whole.highest(own, reach)[1]
        if over_own > NEXT_BALL:
            apart = next_ball - own
    if not apart:
        return None
    return Refusal(
        Kind.TOO_WIDE,
        f'the clearest two impacts are {1e3 * apart * situation.speed:.1f} mm apart on '
        f'the race, and the widest defect that is simulated has '
        f'{1e3 * widest(situation.bearing):.1f} mm: the defect may be wider',
    )


def unresolved(whole: Correlation, measured: Summary, situation: Situation) -> Refusal | None:
    """
    Return why a record tells no spacing of the impacts of a passage; None if it does.

    Examples
    --------
    >>> import numpy as np
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example()
    >>> from bearing_twin.calibration.measured.summaries import correlate
    >>> noise = correlate(np.random.default_rng(0).standard_normal(25600), 12800.0)
    >>> unresolved(noise, noise.summary(machine.longest), machine).kind.value
    'one_impact'

    """
    shortest = posterior.resolved(measured)
    if not measured.seen:
        return Refusal(
            Kind.ONE_IMPACT,
            'one impact a passage is heard: of a narrow defect, or of one whose other edge is '
            'faint, or farther away than any that is simulated',
        )
    if measured.spacing < shortest:
        refusal = Refusal(
            Kind.HIDDEN,
            f'the impacts of a passage are {1e3 * measured.spacing:.2f} ms apart; the ringing of '
            f'one hides a second up to {1e3 * shortest:.2f} ms',
        )
        return with_farther(refusal, whole, measured, situation)
    # What goes on after twice the time is no passage, but the teeth of a gear.
    far = whole.summary(2.0 * ELSEWHERE * situation.longest)
    twice = 2.0 * measured.spacing
    goes_on = any(abs(time - twice) < measured.lobe for time in (far.spacing, *far.rivals))
    if measured.rival > RIVAL or goes_on:
        refusal = Refusal(
            Kind.SEVERAL_SPACINGS,
            'the impacts repeat after several times that are about as clear: ringing, or a gear',
        )
        return with_farther(refusal, whole, measured, situation)
    return None


def copied(x: FloatArray, situation: Situation, measured: Summary) -> Refusal | None:
    """
    Return why two impacts are not those of entry and exit: one is a copy of the other.

    A ball loses its load where it enters and gets it back where it leaves, so that both impacts
    differ in sign, unless it rolls on the bottom. Two pits, or an impact and its echo, do not.

    The record has no mean, and its summary a second impact.

    Examples
    --------
    >>> import numpy as np
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> machine = example()
    >>> x = 1e-3 * np.random.default_rng(1).standard_normal(25600)
    >>> x[200:25000:143] += 1.0
    >>> x[220:25020:143] += 0.7
    >>> copied(x, machine, summarise(x, 12800.0, machine.longest)).kind.value
    'alike'

    """
    if likeness(x, situation.sample_rate, measured) < COPY:
        return None
    return Refusal(
        Kind.ALIKE,
        'the second impact is a copy of the first: of a second pit or an echo. Entry and exit '
        'differ in sign',
    )


def with_farther(
    refusal: Refusal, whole: Correlation, measured: Summary, situation: Situation
) -> Refusal:
    """
    Return a refusal with the longest time between impacts that may be that of a passage.

    A narrow defect repeats after the rest of the way to the next ball, too, but less clearly than
    after its own, because balls do not keep time. What repeats more clearly is no such rest.

    Returns
    -------
    refusal
        Itself where nothing repeats later; otherwise ``farther`` is the time in seconds.

    Examples
    --------
    A ball about each 11 ms, whose exit is 7 ms after its entry:

    >>> import numpy as np
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.measured.summaries import correlate
    >>> machine, rng = example(), np.random.default_rng(1)
    >>> x = 1e-3 * rng.standard_normal(128000)
    >>> entries = np.arange(200, 127000, 143) + rng.integers(-9, 10, 887)
    >>> x[entries] += 1.0
    >>> x[entries + 90] += 0.7
    >>> whole = correlate(x, 12800.0)
    >>> early = Refusal(Kind.HIDDEN, 'they ring')
    >>> with_farther(early, whole, whole.summary(machine.longest), machine).why
    'they ring; others are 10.3 mm apart'

    """
    slipped = SLIPPED / situation.strikes
    next_ball = whole.highest(1.0 / situation.strikes, slipped)[0]
    far = whole.summary(next_ball - CLEAR * measured.lobe)
    lags, prominences = far.repetitions()
    for lag, prominence in zip(lags[::-1], prominences[::-1], strict=True):
        rest = np.abs(lags - (next_ball - lag)) < max(measured.lobe, slipped)
        least = NEXT_BALL * float(np.max(prominences, initial=0.0, where=rest))
        if lag > situation.longest and far.significant(prominence) and prominence > least:
            why = f'{refusal.why}; others are {1e3 * lag * situation.speed:.1f} mm apart'
            return refusal._replace(why=why, farther=float(lag))
    return refusal


def untold(left: Posterior, situation: Situation, fastest: float) -> Refusal | None:
    """
    Return why the candidates that were kept tell no width; None if they do.

    ``fastest`` is the highest frequency of a resonance that the impacts excite, Hz; NaN if none is
    found.

    Examples
    --------
    >>> import numpy as np
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> machine = example()
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> measured = summarise(noise, 12800.0, machine.longest)
    >>> left = posterior.limit(measured, machine, candidates=32)
    >>> untold(left, machine, 10.0).kind.value
    'short_passage'

    """
    median = 1e-3 * float(left.quantiles('defect_width_mm', (0.5,))[0])
    periods = median / situation.speed * fastest
    if periods < PERIODS:
        return Refusal(
            Kind.SHORT_PASSAGE,
            f'the passage lasts {periods:.1f} periods of the resonance at {fastest:.0f} Hz '
            f'that it excites; {PERIODS:g} are needed',
        )
    if left.distance > ALIKE * left.typical:
        return Refusal(Kind.UNLIKE_THE_TWIN, 'no candidate of the twin gives impacts like these')
    if left.narrowed('defect_width_mm') > NARROWED:
        return Refusal(Kind.MANY_WIDTHS, 'defects of many widths give impacts like these')
    return None
