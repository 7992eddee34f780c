# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Rules on ball and cage: impacts, or a ripple, once a turn of the cage."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.diagnosis.rules.rule import EVEN, rule
from bearing_twin.diagnosis.rules.verdict import NO_ALARM, say
from bearing_twin.diagnosis.signal.gate import CAGE_TURNS
from bearing_twin.diagnosis.thresholds import (
    IMPACTS,
    INDEX_FAULT,
    INDEX_STRIKE,
    KURTOSIS,
    RIPPLE,
    RIVAL,
    Z_FAULT,
    Z_PASSAGES,
)

if TYPE_CHECKING:
    from bearing_twin.diagnosis.rules.evidence import Evidence
    from bearing_twin.diagnosis.rules.verdict import Verdict


@rule(
    'ball', 'A ball in the load zone ripples the envelope with the cage and has a comb of its own.'
)
def ball_ripple(e: Evidence) -> Verdict | None:
    ball = e.candidates['ball']
    smooth = e.cage_leads and e.cage_high_harmonics * RIVAL * RIVAL < RIPPLE
    if not (smooth and ball in e.unexplained and ball.index >= INDEX_FAULT):
        return None
    text = (
        'the envelope ripples with the cage, without the higher harmonics of a cage that strikes: '
        'a ball in and out of the load'
    )
    return say(e, text, about=ball, level='fault')


@rule(
    'ball',
    'Impacts in groups, once a cage turn, keep the time of a ball within each group.',
    # Of 13 simulated ones 7 are right; most of the others are damaged cages.
    at_most=EVEN,
)
def ball_passages(e: Evidence) -> Verdict | None:
    ball = e.candidates['ball']
    # A load does not raise the kurtosis of healthy parts, or their cyclic spectrum, as much.
    # Impacts elsewhere may raise both.
    bursts = not e.remaining and e.kurtosis > KURTOSIS and not e.strikes_elsewhere
    # Lines narrow enough for a comb keep their phase: those of waviness do so as well.
    wide = ball.z < Z_FAULT and (bursts or _cage_or_ball(e))
    if not wide or e.ball_passages < Z_PASSAGES:
        return None
    text = (
        'impacts in groups, once a turn of the cage, that keep the time of a ball within each '
        f'group: significance {e.ball_passages:.1f}'
    )
    return say(e, text, about=ball, level='fault')


@rule(
    'ambiguous', 'A ball in the load zone ripples the envelope once a cage turn, as a cage does.'
)
def cage_ripple(e: Evidence) -> Verdict | None:
    if not _cage_or_ball(e):
        return None
    return say(e, _coincide(e), about=e.candidates['cage'], faults=e.ball_or_cage)


@rule('suspect', 'Few cage turns do not resolve the comb of a cage.')
def few_cage_turns(e: Evidence) -> Verdict | None:
    if not e.cage_leads or e.cage_turns >= CAGE_TURNS:
        return None
    text = f'{e.cage_turns:.0f} cage turns: {CAGE_TURNS:g} are needed to call it a cage fault'
    return say(e, text, about=e.candidates['cage'])


@rule('cage', 'Impacts once a cage turn, with harmonics everywhere, come from the cage.')
def cage_impacts(e: Evidence) -> Verdict | None:
    if not e.cage_leads:
        return None
    return say(e, about=e.candidates['cage'], level='fault')


@rule('suspect', 'Impacts once a cage turn that modulate the envelope little are no alarm.')
def weak_cage(e: Evidence) -> Verdict | None:
    cage = e.candidates['cage']
    if e.remaining or cage not in e.unexplained or e.impacts.get('cage', 0.0) < IMPACTS:
        return None
    # Only a strong comb can tell a cage that strikes from a ball in the load zone.
    return say(e, _coincide(e), NO_ALARM, about=cage, faults=e.ball_or_cage)


def _coincide(e: Evidence) -> str:
    """Return the sentence about a comb that a ball or the cage may have made."""
    first, _ = e.ball_or_cage
    # Within a factor 2 in power neither is likelier.
    clear = not 1.0 / RIVAL**2 <= e.cage_high_harmonics / RIPPLE <= RIVAL**2
    return (
        'ball and cage coincide: the envelope ripples with the cage; a ball strikes while it '
        'passes the load zone, once a cage turn, or the cage is damaged; '
        f'{f"the {first}" if clear else "neither"} is likelier'
    )


def _cage_or_ball(e: Evidence) -> bool:
    """
    Return whether the cage leads, but a ball in and out of the load may make its comb.

    An impact has every harmonic, exactly one at the outer race's order. A comb that is clearer at
    the ball's order is the ripple of such a ball. The turns of a cage may differ so much that its
    harmonics smear up there: then those below it tell, if they have twice the power of a ripple.
    """
    outer, ball, cage = (e.candidates[place] for place in ('outer', 'ball', 'cage'))
    few_harmonics = outer.z < max(ball.z, Z_FAULT) and not (
        ball.z < Z_FAULT and e.cage_high_harmonics >= RIVAL**2 * RIPPLE
    )
    return e.cage_leads and (few_harmonics or cage.index < INDEX_STRIKE)
