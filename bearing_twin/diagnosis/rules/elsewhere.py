# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Rules on other causes: lines that no fault of this bearing makes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.diagnosis.rules.fits import what_fits
from bearing_twin.diagnosis.rules.rule import EVEN, rule
from bearing_twin.diagnosis.rules.verdict import no_statement, say, unless_shaft
from bearing_twin.diagnosis.thresholds import (
    CARRIER,
    IMPACTS,
    INDEX_FAULT,
    INDEX_SMOOTH,
    SWAY,
    UNLIKELY_SLIP,
    Z_FAULT,
)

if TYPE_CHECKING:
    from bearing_twin.diagnosis.rules.evidence import Evidence
    from bearing_twin.diagnosis.rules.verdict import Verdict


_STRIKES_WITH_THE_SHAFT = (
    'record longer, with a measured speed, so that the fault orders separate; look at what else '
    'strikes in time with the shaft'
)


@rule(
    'ambiguous',
    'Lines at a fault order on a multiple of the shaft belong to either.',
    at_most=EVEN,
    tells=_STRIKES_WITH_THE_SHAFT,
)
def masked_candidate(e: Evidence) -> Verdict | None:
    if not e.masked_candidates:
        return None
    first = e.masked_candidates[0]
    text = (
        f'{first.place} order {first.order:.3f} and shaft order {round(first.order)} coincide '
        'within the resolution of this window: the lines '
        'there belong to either; a longer window or an exact speed may part them'
    )
    combs = {c.place: c for c in e.masked_candidates}
    found = e.candidates | combs
    return say(e, str(first), text, faults=tuple(combs), candidates=found)


@rule(
    'insufficient',
    'Lines on a multiple of the shaft may hide a fault that modulates little.',
    faint=True,
    nothing_shows=True,
    tells=_STRIKES_WITH_THE_SHAFT,
)
def masked_faintly(e: Evidence) -> Verdict | None:
    if not e.masked_combs:
        return None
    comb = max(e.masked_combs, key=lambda c: c.z)
    text = (
        f'not known: {comb.place} order and shaft order {round(comb.order)} coincide within the '
        'resolution of this window, and the lines there may be a fault too weak for an alarm; a '
        'longer window or an exact speed may part them'
    )
    return no_statement(e, str(comb), text)


@rule(
    'suspect',
    'What rings low only may be an outer race, or its variable compliance.',
    at_most=EVEN,
    tells='compare with an earlier record, or sample faster, so that higher bands show',
)
def low_bands(e: Evidence) -> Verdict | None:
    outer = e.candidates['outer']
    shown = outer.z >= Z_FAULT and outer.harmonics >= 2 and e.outer_index >= INDEX_FAULT
    if not shown or e.impacts.get('outer', 0.0) < IMPACTS:
        return None
    text = (
        f'it modulates by {e.outer_index:.2f} in bands below {CARRIER:g} times its frequency '
        'only, where the variable compliance of a sound bearing shows as well'
    )
    return say(e, text, about=outer)


@rule('suspect', 'Impacts repeat at an order that no part of this bearing makes.')
def impacts_elsewhere(e: Evidence) -> Verdict | None:
    return _elsewhere(e, 'fit no part of') if e.strikes_elsewhere else None


@rule(
    'suspect',
    'Impacts in time with the shaft, deeper than a load makes, are of something else.',
    tells='look at coupling, key, gear, looseness and rubs, and record again',
)
def strikes_each_turn(e: Evidence) -> Verdict | None:
    comb = e.impacts_each_turn
    if comb is None:
        return None
    text = (
        f'{comb}: {round(comb.order)} a turn of the shaft, deeper than any load '
        'modulates; a coupling, looseness, a rub, a key or a tooth of a gear? No part of the '
        'bearing strikes in time with the shaft, but this may hide one that does not'
    )
    return say(e, text)


@rule(
    'ambiguous',
    'Rectifiers and converters pulse twice a period of the mains, and swell with no shaft.',
    at_most=EVEN,
    tells='record at a speed some per cent off, or while the machine coasts down: pulses of the '
    'mains keep their frequency or end',
)
def mains_pulses(e: Evidence) -> Verdict | None:
    sways = e.leading.place == 'inner' and e.leading.shaft_sideband_ratio >= SWAY
    if sways or not e.mains_hz:
        return None
    text = (
        f'it coincides with a multiple of {2.0 * e.mains_hz:g} Hz: the pulses of rectifiers and '
        f'converters on mains of {e.mains_hz:g} Hz; another shaft speed parts them'
    )
    return say(e, text, about=e.leading)


@rule(
    'ambiguous',
    'An impact once a turn has lines at all multiples of the shaft.',
    at_most=EVEN,
    tells=_STRIKES_WITH_THE_SHAFT,
)
def masked_by_shaft(e: Evidence) -> Verdict | None:
    if e.leading in e.nameable or e.leading.place not in e.masked_by_shaft:
        return None
    text = (
        f'it coincides with {round(e.leading.order)} turns of the shaft within the resolution, '
        'and the other multiples of the shaft are as high: an impact once a turn, or the '
        'fault; a longer window or an exact speed may part them'
    )
    return say(e, text, about=e.leading)


@rule('suspect', 'A comb may be part of stronger impacts at an order of no part of the bearing.')
def elsewhere_explains(e: Evidence) -> Verdict | None:
    return _elsewhere(e, 'explain it, and fit no part of') if e.elsewhere_explains else None


@rule('suspect', 'A gear, a belt or another bearing may have a harmonic at this order.')
def extraneous(e: Evidence) -> Verdict | None:
    if e.leading in e.nameable:
        return None
    order = e.extraneous_orders[e.leading.place]
    text = (
        f'it shares its harmonics with a comb at {order:.3f} orders, which no part '
        'of this bearing has: check geometry and speed; a gear, a belt, another bearing or a '
        'cage that slips far?'
    )
    return say(e, text, about=e.leading)


@rule('suspect', 'Sound parts, blades and vanes modulate smoothly; impacts have all harmonics.')
def smooth(e: Evidence) -> Verdict | None:
    # A comb with the sidebands of its place is not of blades. Blades and lobes pass a whole number
    # of times in one or two turns.
    place, sways = e.leading.place, e.leading.shaft_sideband_ratio >= SWAY
    sided = place == 'ball' or (not e.half_turn and sways == (place == 'inner'))
    if sided or not e.smooth or e.leading.index > INDEX_SMOOTH:
        return None
    text = (
        'its third and fourth harmonic are missing, so it is smooth: most likely an extended '
        'spall, else an error of form, or blades, vanes or lobes; check bearing and speed'
    )
    return say(e, text, about=e.leading)


@rule(
    'ambiguous',
    'What strikes a whole number of times a turn may be a part of the shaft.',
    tells='compare the speed with a tachometer, look at the coupling, and record again; until '
    'that is known measure weekly',
)
def whole_turns(e: Evidence) -> Verdict | None:
    # A place at an unlikely slip is no alarm, and its reasons ask for the speed.
    if e.leading.slip > UNLIKELY_SLIP or not e.whole_turns:
        return None
    text = (
        f'the shaft speed is not known well enough, or moves too far, to tell it from '
        f'{e.whole_turns} impacts a turn, as of a coupling; give a measured speed, and record '
        'while it is steady'
    )
    return say(e, text, about=e.leading, level=unless_shaft(e, e.leading))


@rule('suspect', "A comb with sidebands of another bearing's cage is that of its ball.")
def another_cage(e: Evidence) -> Verdict | None:
    if not e.another_cage_order:
        return None
    text = (
        f'its sidebands are {e.another_cage_order:.3f} orders apart, as the cage of another '
        f'bearing turns, and not that of a {e.bearing.name}: a ball of another bearing? check '
        'bearing and speed'
    )
    return say(e, text, about=e.leading)


def _elsewhere(e: Evidence, what: str) -> Verdict:
    """Return a verdict on impacts at an order of no part of the bearing, with explanations."""
    comb = e.elsewhere
    if abs(comb.order - 1.0) < 0.1:
        text = f'the shaft seems to turn at {comb.order * e.shaft_hz:.4g} Hz: check the speed'
    else:
        text = f'periodic impacts at {comb.order:.3f} orders {what} a {e.bearing.name}: check '
        text += 'bearing and speed'
        text += what_fits(
            comb.order, 2.0 * e.step, e.shaft_hz, e.bearing, e.elsewhere_has_shaft_sidebands
        )
    return say(e, str(comb), text)
