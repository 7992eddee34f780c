# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Rules without a comb that can be named: whether the bearing is known to be healthy."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.rules.confidence import confidence, Trust
from bearing_twin.diagnosis.rules.rule import EVEN, rule
from bearing_twin.diagnosis.rules.verdict import highest_comb, no_statement, say
from bearing_twin.diagnosis.signal.demodulation import highest_fault_order
from bearing_twin.diagnosis.signal.gate import (
    CONVERTER_STEPS,
    fastest_impacts_hz,
    HEALTHY_TURNS,
    LOWEST_RINGING_HZ,
)
from bearing_twin.diagnosis.thresholds import (
    IMPACTS,
    INDEX_SUSPECT,
    KURTOSIS,
    LOW_LINES,
    RIVAL,
    Z_ELSEWHERE,
    Z_FAULT,
)

if TYPE_CHECKING:
    from bearing_twin.diagnosis.rules.evidence import Evidence
    from bearing_twin.diagnosis.rules.verdict import Verdict

_SHOWN = 0.6
"""Height from which harmonics of a comb may be those of impacts: a smooth modulation 1 + a cos has
a second one of a/4 of the first and no others, and one line of noise in ten is as high."""


@rule(
    'insufficient',
    "A dead sensor has no comb either: its noise is the converter's rounding.",
    tells='check sensor, cable and gain, and record again',
)
def few_steps(e: Evidence) -> Verdict | None:
    if e.steps >= CONVERTER_STEPS:
        return None
    text = (
        f'the RMS is {e.steps:.2g} steps of the converter ({CONVERTER_STEPS:g} are needed to call '
        'it healthy): is the sensor dead? If it is not, raise the gain'
    )
    return no_statement(e, text)


@rule(
    'suspect',
    'No load modulates noise so much: impacts or bursts, whatever their period.',
    tells='check lubrication, bearing currents, rubs and looseness; check bearing and speed, and '
    'record again',
)
def bursts(e: Evidence) -> Verdict | None:
    if e.kurtosis <= KURTOSIS:
        return None
    text = (
        f'impacts or bursts without a period of this bearing: kurtosis {e.kurtosis:.1f} without '
        f'single shocks, {KURTOSIS:.1f} is the most of noise that a load modulates; worn '
        'surfaces, dirt, lack of grease, currents, a rub, looseness? check bearing and speed too'
    )
    return say(e, text)


@rule(
    'suspect',
    'Impacts too regular for noise, however faint: of such machines two of five are damaged.',
    faint=True,
    at_most=EVEN,
    tells='compare with an earlier record, or measure nearer to the bearing',
)
def mostly_damaged(e: Evidence) -> Verdict | None:
    comb = highest_comb(e.all_combs)
    if comb is None or comb.z < Z_FAULT or e.impacts.get(comb.place, 0.0) < IMPACTS:
        return None
    # Two claims are told apart from a factor 2 on, in odds as in power.
    if Trust.on(e, comb, e.candidates).healthy_log_odds >= -2.0 * math.log(RIVAL):
        return None
    text = (
        'impacts too regular for noise, modulation index too low for an alarm: of simulated '
        'machines with such impacts two of five are damaged; compare with an earlier record, or '
        'measure nearer to it'
    )
    return say(e, text, about=comb)


@rule(
    'insufficient',
    'Combs of two places of one bearing are not chance: first damage, or waves of its surfaces.',
    faint=True,
    nothing_shows=True,
    tells='compare with an earlier record, and record longer or nearer to the bearing',
)
def two_faint_places(e: Evidence) -> Verdict | None:
    if len(e.faint) < 2:
        return None
    text = (
        'too weak for a fault, but two places of one bearing are not chance: compare with an '
        'earlier record of this machine, and repeat it with a longer window or a nearer sensor'
    )
    return no_statement(e, text)


@rule(
    'suspect',
    'Impacts that come faster than ringing dies away have a small index, whatever their size.',
    faint=True,
    # Waves of sound surfaces make such combs as well.
    at_most=EVEN,
    tells='compare with an earlier record, or record at a lower speed',
)
def fast_impacts(e: Evidence) -> Verdict | None:
    comb = e.fast
    if comb is None or e.impacts.get(comb.place, 0.0) < IMPACTS or e.fast_harmonics[1] < _SHOWN:
        return None
    text = (
        f'impacts, {comb.order * e.shaft_hz:.0f} a second: what rings at '
        f'{1e-3 * LOWEST_RINGING_HZ:g} kHz does not die away between them, so that the index is '
        'small whatever their size; compare with an earlier record, or record at a lower speed'
    )
    return say(e, text, about=comb)


@rule(
    'insufficient',
    'Of machines with such combs hardly more are sound than damaged, or fewer.',
    faint=True,
    nothing_shows=True,
    tells='compare with an earlier record, and record longer or nearer to the bearing, with a '
    'measured speed',
)
def uncertain_health(e: Evidence) -> Verdict | None:
    trust = Trust.on(e, highest_comb(e.all_combs), e.candidates)
    if trust.healthy_log_odds >= 0.0:
        return None
    share = 100.0 * confidence('healthy', trust)
    text = (
        f'not known: {share:.0f} % of simulated machines with a comb of significance '
        f'{trust.z:.1f} and index {trust.index:.2f}, and one of {trust.elsewhere_z:.1f} at any '
        'order, are sound; a longer window, a measured speed, the exact bearing, or a sensor '
        'nearer to it may tell'
    )
    return no_statement(e, text)


@rule(
    'insufficient',
    'A short window shows strong faults only, so it cannot call a bearing healthy.',
    nothing_shows=True,
    tells='record longer',
)
def few_shaft_turns(e: Evidence) -> Verdict | None:
    if e.turns >= HEALTHY_TURNS:
        return None
    text = (
        f'{e.turns:.0f} shaft turns show strong faults only, and no such one is there: '
        f'{HEALTHY_TURNS:g} are needed to call it healthy, {HEALTHY_TURNS / e.shaft_hz:.1f} s'
    )
    return no_statement(e, text)


@rule(
    'insufficient',
    'Impacts hardly show that come faster than their ringing dies away.',
    nothing_shows=True,
    tells='sample faster or slow the shaft down, and compare with an earlier record',
)
def run_together(e: Evidence) -> Verdict | None:
    comb = e.fast
    if comb is not None and e.fast_harmonics[0] >= _SHOWN:
        text = (
            f'not known: {comb.order * e.shaft_hz:.0f} impacts a second have a small index, '
            f'whatever their size, where a housing rings at {1e-3 * LOWEST_RINGING_HZ:g} kHz, and '
            'the comb has a second harmonic; compare with an earlier record, or record at a lower '
            'speed'
        )
        return no_statement(e, text)
    highest_hz = highest_fault_order(e.bearing) * e.shaft_hz
    shown_hz = fastest_impacts_hz(e.sample_rate)
    if highest_hz <= shown_hz:
        return None
    text = (
        f'a fault would strike up to {highest_hz:.0f} times a second, and at this sample rate '
        f'only what strikes up to {shown_hz:.0f} times is sure to show, before ringing runs '
        'together: call it healthy from a record with faster sampling or a slower shaft, and look '
        'for lines at multiples of the fault frequencies in the spectrum'
    )
    return no_statement(e, text)


@rule(
    'insufficient',
    'What rings low has steady lines and modulates little.',
    nothing_shows=True,
    tells='compare with an earlier record, sample faster or slow the shaft down',
)
def low_lines(e: Evidence) -> Verdict | None:
    if e.low_lines < LOW_LINES:
        return None
    text = (
        f'{100.0 * e.low_lines:.0f} % of the power from the 4th to the 12th multiple of the outer '
        "race's frequency is in lines at these multiples: a fault that rings low, or the variable "
        'compliance of a sound bearing; compare with an earlier record, sample faster or slow down'
    )
    return no_statement(e, text)


_HEALTHY = (
    f'no fault comb above a significance of {Z_FAULT:g} with modulation index {INDEX_SUSPECT:g}'
)


@rule(
    'healthy',
    'A comb is significant, and too weak for a remark alone.',
    faint=True,
    tells='go on measuring, and compare with an earlier record',
)
def faint_comb(e: Evidence) -> Verdict | None:
    heard = [f'{c}: too weak for a remark alone; compare with an earlier record' for c in e.faint]
    # In the bands of the variable compliance the comb of an outer race is clearer at any order.
    own = any(abs(c.order - e.elsewhere.order) <= 2.0 * e.step for c in e.faint)
    if not own and e.elsewhere.z >= Z_ELSEWHERE and e.impacts['elsewhere'] >= IMPACTS:
        heard.append(
            f'{e.elsewhere}: of no part of a {e.bearing.name}, and too weak for a '
            'remark alone; check bearing and speed'
        )
    return say(e, _HEALTHY, *heard, level='ok') if heard else None


@rule('healthy', 'No comb is both significant and strong.', faint=True)
def no_comb(e: Evidence) -> Verdict | None:
    return say(e, _HEALTHY, level='ok')
