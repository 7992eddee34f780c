# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Reasons why a record tells no width of a defect."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.calibration.answer.healthy import (
    between_impacts,
    COMB_OVER_FLOOR,
    line_over_floor,
    order_of_the_shaft,
    SLIPPED,
)
from bearing_twin.calibration.measured.summaries import CLEAR, ELSEWHERE, likeness, RIVAL
from bearing_twin.dynamics.parameters import widest
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.calibration.candidates.cloud import Situation
    from bearing_twin.calibration.candidates.posterior import Posterior
    from bearing_twin.calibration.measured.summaries import Correlation, Summary

    FloatArray = NDArray[np.float64]


NARROWED = 0.5
"""A width is identifiable if its 90 % interval is at most this share of the prior's."""
COPY = 0.33
"""`summaries.likeness` from which two impacts are not entry and exit; an exact inverse has 0.2 by
its side lobes. An eighth of true passages is above: 16 of 112 slots that share nothing with the
twin, 2 of 18 twins and 1 of 24 trains of impacts. Of 20 pairs of pits 14 are above. So are 11 of
19 slots so shallow that balls roll on the bottom: such a passage is symmetric in time."""
BETWEEN = 0.25
"""`healthy.between_impacts` from which the impacts are half as frequent. None of 73 slots that
share nothing with the twin is above 0.04; impacts of half the frequency have 0.7 and more."""
ALIKE = 2.0
"""Largest distance of the kept candidates from the machine, over the distance among them."""
NEXT_BALL = 1.1
"""Largest peak at the time from the exit of a ball to the entry of the next, over the peak at the
time from its own entry to its exit. Of 96 twins with both impacts, one is above 1 (1.02), and one
above 1.1 whose spacing was not that of the defect. Trains of narrow defects reach 0.75; 39 trains
of defects wider than half the way to the next ball begin at 1.4."""
PERIODS = 2.0
"""Shortest passage, in periods of the resonance that it excites."""


class Kind(StrEnum):
    """Why the width is not identifiable."""

    NO_PART = 'no_part'
    """The diagnosis finds a fault but names no part."""
    NOT_FITTED = 'not_fitted'
    """Defects of this part are not fitted."""
    NO_IMPACTS = 'no_impacts'
    """The record shows no impacts of the named part."""
    TOO_WIDE = 'too_wide'
    """The defect may be wider than any that is simulated."""
    ONE_IMPACT = 'one_impact'
    """Each passage has one impact: the defect is narrow, or its other edge is faint or far."""
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
    """Candidates of many widths are like the record."""
    SAME_AT_ANOTHER_SPEED = 'same_at_another_speed'
    """Another record shows the same time between impacts at another speed."""

    @property
    def defect_unknown(self) -> bool:
        """Whether nothing is known of the defect; its twin is simulated without one."""
        return self in (Kind.NO_IMPACTS, Kind.NOT_FITTED)


class Refusal(NamedTuple):
    """Reason why a width is not identifiable."""

    kind: Kind
    why: str
    """In words."""
    longest_spacing: float = 0.0
    """Longest time between impacts, beyond those of simulated defects, that a passage may have, s;
    0 if there is none."""


def no_impacts(x: FloatArray, situation: Situation) -> Refusal | None:
    """
    Return a refusal if a record shows no impacts of the named part, else None.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example()
    >>> no_impacts(np.random.default_rng(1).standard_normal(25600), machine).why[:44]
    'no impacts at the 89.6 Hz of the outer race '

    """
    rate, place = situation.impact_rate, situation.place
    said = f'no impacts at the {rate:.1f} Hz of the {place} race stand out: '
    if line_over_floor(x, situation) < COMB_OVER_FLOOR:
        return Refusal(Kind.NO_IMPACTS, f'{said}check bearing, speed and place')
    if situation.place == 'outer' and (order := order_of_the_shaft(x, situation)):
        return Refusal(
            Kind.NO_IMPACTS,
            f'{said}the line there is order {order} of the shaft, and the orders beside it are '
            'about as high',
        )
    return None


def half_frequency(x: FloatArray, situation: Situation) -> Refusal | None:
    """
    Return a refusal if the impacts are half as frequent as those of the named part, else None.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example()
    >>> x = np.random.default_rng(1).standard_normal(51200)
    >>> x[::143] += 12.0
    >>> half_frequency(x, machine) is None
    True
    >>> half_frequency(x, replace(machine, sample_rate=0.5 * machine.sample_rate)).kind.value
    'no_impacts'

    """
    if between_impacts(x, situation) < BETWEEN:
        return None
    return Refusal(
        Kind.NO_IMPACTS,
        f'the impacts repeat at half the {situation.impact_rate:.1f} Hz of the {situation.place} '
        'race: check speed and sample rate',
    )


def too_wide(whole: Correlation, situation: Situation, measured: Summary) -> Refusal | None:
    """
    Return a refusal if a defect may be wider than any that is simulated, else None.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example()
    >>> from bearing_twin.calibration.measured.summaries import correlate
    >>> noise = correlate(np.random.default_rng(1).standard_normal(25600), 12800.0)
    >>> too_wide(noise, machine, noise.summary(machine.longest_spacing)) is None
    True

    """
    apart = 0.0
    for share in (0.45, 0.9):
        # Beyond half way, exit and next entry also give a peak, but a less clear one.
        farther = whole.summary(share / situation.impact_rate)
        # Over longer lags noise alone has peaks more often, but none as clear as this.
        clear = farther.prominence > measured.prominence and farther.rival <= RIVAL
        if clear and farther.spacing > situation.longest_spacing:
            apart = apart or farther.spacing
    if not apart and measured.shows_two_impacts and measured.spacing >= measured.resolved:
        # Intervals of balls vary: two impacts of one ball repeat more clearly than those of two.
        own, reach = measured.spacing, measured.lobe
        next_ball = whole.highest(1.0 / situation.impact_rate, SLIPPED / situation.impact_rate)[0]
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
    Return a refusal if a record shows no clear spacing of the impacts of a passage, else None.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example()
    >>> from bearing_twin.calibration.measured.summaries import correlate
    >>> noise = correlate(np.random.default_rng(0).standard_normal(25600), 12800.0)
    >>> unresolved(noise, noise.summary(machine.longest_spacing), machine).kind.value
    'one_impact'

    """
    shortest = measured.resolved
    if not measured.shows_two_impacts:
        return Refusal(
            Kind.ONE_IMPACT,
            'only one impact per passage is heard: of a narrow defect, or of one whose other edge '
            'is faint, or farther away than any that is simulated',
        )
    if measured.spacing < shortest:
        refusal = Refusal(
            Kind.HIDDEN,
            f'the impacts of a passage are {1e3 * measured.spacing:.2f} ms apart; the ringing of '
            f'one hides a second up to {1e3 * shortest:.2f} ms',
        )
        return with_longest_spacing(refusal, whole, measured, situation)
    # A repetition after twice the time is not a passage but the teeth of a gear.
    far = whole.summary(2.0 * ELSEWHERE * situation.longest_spacing)
    twice = 2.0 * measured.spacing
    goes_on = any(abs(time - twice) < measured.lobe for time in (far.spacing, *far.rivals))
    if measured.rival > RIVAL or goes_on:
        refusal = Refusal(
            Kind.SEVERAL_SPACINGS,
            'the impacts repeat after several times that are about as clear: ringing, or a gear',
        )
        return with_longest_spacing(refusal, whole, measured, situation)
    return None


def copied(x: FloatArray, situation: Situation, measured: Summary) -> Refusal | None:
    """
    Return a refusal if the second impact of a passage is a copy of the first, else None.

    A ball loses its load where it enters and regains it where it leaves, so that both impacts
    differ in sign, unless it rolls on the bottom. Two pits, or an impact and its echo, have the
    same sign.

    The record has zero mean, and ``measured`` has a second impact.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> machine = example()
    >>> x = 1e-3 * np.random.default_rng(1).standard_normal(25600)
    >>> x[200:25000:143] += 1.0
    >>> x[220:25020:143] += 0.7
    >>> copied(x, machine, summarise(x, 12800.0, machine.longest_spacing)).kind.value
    'alike'

    """
    if likeness(x, situation.sample_rate, measured) < COPY:
        return None
    return Refusal(
        Kind.ALIKE,
        'the second impact is a copy of the first: of a second pit or an echo. Entry and exit '
        'differ in sign',
    )


def with_longest_spacing(
    refusal: Refusal, whole: Correlation, measured: Summary, situation: Situation
) -> Refusal:
    """
    Return a refusal with the longest time between impacts that a passage may have.

    The impacts of a narrow defect also repeat from the exit to the entry of the next ball, but
    less clearly than from entry to exit, because the intervals of balls vary. Only a clearer
    repetition counts.

    The refusal is unchanged if nothing repeats later; otherwise its ``longest_spacing`` is the
    time, s.

    Examples
    --------
    A ball about every 11 ms, whose exit is 7 ms after its entry:

    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.measured.summaries import correlate
    >>> machine, rng = example(), np.random.default_rng(1)
    >>> x = 1e-3 * rng.standard_normal(128000)
    >>> entries = np.arange(200, 127000, 143) + rng.integers(-9, 10, 887)
    >>> x[entries] += 1.0
    >>> x[entries + 90] += 0.7
    >>> whole = correlate(x, 12800.0)
    >>> early = Refusal(Kind.HIDDEN, 'they ring')
    >>> with_longest_spacing(early, whole, whole.summary(machine.longest_spacing), machine).why
    'they ring; others are 10.3 mm apart'

    """
    slipped = SLIPPED / situation.impact_rate
    next_ball = whole.highest(1.0 / situation.impact_rate, slipped)[0]
    far = whole.summary(next_ball - CLEAR * measured.lobe)
    lags, prominences = far.repetitions()
    for lag, prominence in zip(lags[::-1], prominences[::-1], strict=True):
        rest = np.abs(lags - (next_ball - lag)) < max(measured.lobe, slipped)
        least = NEXT_BALL * float(np.max(prominences, initial=0.0, where=rest))
        if lag > situation.longest_spacing and far.significant(prominence) and prominence > least:
            why = f'{refusal.why}; others are {1e3 * lag * situation.speed:.1f} mm apart'
            return refusal._replace(why=why, longest_spacing=float(lag))
    return refusal


def width_not_determined(left: Posterior, situation: Situation, fastest: float) -> Refusal | None:
    """
    Return a refusal if the kept candidates determine no width, else None.

    ``fastest`` is the highest resonance frequency that the impacts excite, Hz; NaN if none.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.candidates.posterior import without_spacing
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> machine = example()
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> measured = summarise(noise, 12800.0, machine.longest_spacing)
    >>> left = without_spacing(measured, machine, candidates=32)
    >>> width_not_determined(left, machine, 10.0).kind.value
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
    if left.narrowed > NARROWED:
        return Refusal(Kind.MANY_WIDTHS, 'defects of many widths give impacts like these')
    return None
