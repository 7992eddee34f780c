# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
From evidence to a verdict: the first rule of an ordered table that applies.

A rule is a function of the evidence that returns a verdict, or None where it does not apply. The
rules are asked in the order of this file: what strikes with the cage, where no comb remains, where
one leads. A new rule touches:

- this file: the function, at its place in the order, and what `Rule` asks about its answer;
- ``evidence.py``: a property for each new quantity, with its value where nothing disturbs the
  combs, and ``combs/search.py`` if the quantity has to be measured in the spectra;
- ``thresholds.py`` and the table of thresholds in ``docs/diagnosis_why.md``;
- ``CASES`` in ``test/diagnosis/test_rules.py``: evidence that reaches the rule;
- the table of rules: ``python docs/rules.py docs/diagnosis.md``;
- the share of right answers, where it changes many: ``studies.reliability``. Without it the rule
  has no weight of its own: its answers are as sure as others of their kind.
"""

from __future__ import annotations

from dataclasses import replace
from functools import wraps
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import PLACES
from bearing_twin.diagnosis.rules.confidence import confidence, LEAST_CONFIDENCE, Trust
from bearing_twin.diagnosis.rules.fits import what_fits
from bearing_twin.diagnosis.rules.verdict import highest_comb, Verdict
from bearing_twin.diagnosis.signal.demodulation import highest_fault_order
from bearing_twin.diagnosis.signal.gate import (
    CAGE_TURNS,
    CONVERTER_STEPS,
    fastest_impacts_hz,
    HEALTHY_TURNS,
)
from bearing_twin.diagnosis.thresholds import (
    CARRIER,
    IMPACTS,
    INDEX_FAULT,
    INDEX_SMOOTH,
    INDEX_STRIKE,
    INDEX_SUSPECT,
    KURTOSIS,
    LOW_LINES,
    RIPPLE,
    RIVAL,
    SLIP_COST,
    SWAY,
    UNLIKELY_SLIP,
    Z_ELSEWHERE,
    Z_FAULT,
    Z_PASSAGES,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from bearing_twin.diagnosis.combs.candidate import Candidate
    from bearing_twin.diagnosis.rules.evidence import Evidence

    _Apply = Callable[[Evidence], Verdict | None]


class Rule(NamedTuple):
    """One rule of the table."""

    name: str
    answer: str
    why: str
    apply: Callable[[Evidence], Verdict | None]
    faint: bool
    """Whether a second look at parts of the record may change the answer. Set it where the rule
    answers without an alarm although a weak comb is there."""
    nothing_shows: bool
    """Whether the level of the record may go into the baseline although the answer is not healthy.
    Set it where a window shows no fault, but cannot call the machine healthy."""
    at_most: float
    """Confidence that its answers cannot pass."""


RULES: list[Rule] = []
"""All rules, in the order in which they are asked; the last always applies."""

EVEN = 0.5
"""Most that an answer is sure of where something sound explains the lines as well as a fault."""

DOUBTED = 0.76
"""Most that an answer is sure of at an unlikely slip: of 20 such answers on simulated machines 19
were right, and 0.76 is the lower end of the 95 % interval of their share (Wilson)."""


def _rule(
    answer: str,
    why: str,
    *,
    faint: bool = False,
    nothing_shows: bool = False,
    at_most: float = 1.0,
) -> Callable[[_Apply], _Apply]:
    """Append a rule to the table; it has the name of its function."""

    def append(apply: _Apply) -> _Apply:
        name = apply.__name__.lstrip('_')
        RULES.append(Rule(name, answer, why, apply, faint, nothing_shows, at_most))
        return apply

    return append


def _where_no_comb_remains(apply: _Apply) -> _Apply:
    """Ask a rule only where no comb is left to lead: `Evidence.leading` does not exist there."""

    @wraps(apply)
    def asked(e: Evidence) -> Verdict | None:
        return None if e.remaining else apply(e)

    return asked


@_rule(
    'ball', 'A ball in the load zone ripples the envelope with the cage and has a comb of its own.'
)
def _ball_ripple(e: Evidence) -> Verdict | None:
    ball = e.candidates['ball']
    smooth = e.cage_leads and e.cage_high_harmonics * RIVAL * RIVAL < RIPPLE
    if not (smooth and ball in e.own and ball.index >= INDEX_FAULT):
        return None
    text = (
        'the envelope ripples with the cage, without the higher harmonics of a cage that strikes: '
        'a ball in and out of the load'
    )
    return _say(e, text, about=ball, level='fault')


@_rule('ball', 'Impacts in groups, once a cage turn, keep the time of a ball within each group.')
def _ball_passages(e: Evidence) -> Verdict | None:
    ball = e.candidates['ball']
    # Both are more than a load does to the noise of sound parts. Impacts elsewhere have both a
    # kurtosis and lines near the harmonics of the ball.
    bursts = not e.remaining and e.kurtosis > KURTOSIS and not _strikes_elsewhere(e)
    # Lines that are narrow enough for a comb keep their phase, those of waves as well.
    wide = ball.z < Z_FAULT and (bursts or _cage_or_ball(e))
    if not wide or e.ball_passages < Z_PASSAGES:
        return None
    text = (
        'impacts in groups, once a turn of the cage, that keep the time of a ball within each '
        f'group: significance {e.ball_passages:.1f}'
    )
    return _say(e, text, about=ball, level='fault')


@_rule(
    'ambiguous', 'A ball in the load zone ripples the envelope once a cage turn, as a cage does.'
)
def _cage_ripple(e: Evidence) -> Verdict | None:
    if not _cage_or_ball(e):
        return None
    first, _ = e.ball_or_cage
    # Within a factor 2 in power neither is nearer.
    clear = not 1.0 / RIVAL**2 <= e.cage_high_harmonics / RIPPLE <= RIVAL**2
    text = (
        'ball and cage coincide: the envelope ripples with the cage; a ball strikes while it '
        'passes the load zone, once a cage turn, or the cage is damaged; '
        f'{f"the {first}" if clear else "neither"} is likelier'
    )
    return _say(e, text, about=e.candidates['cage'], faults=e.ball_or_cage)


@_rule('suspect', 'Few cage turns do not resolve the comb of a cage.')
def _few_cage_turns(e: Evidence) -> Verdict | None:
    if not e.cage_leads or e.cage_turns >= CAGE_TURNS:
        return None
    text = f'{e.cage_turns:.0f} cage turns: {CAGE_TURNS:g} are needed to call it a cage fault'
    return _say(e, text, about=e.candidates['cage'])


@_rule('cage', 'Impacts once a cage turn, with harmonics everywhere, come from the cage.')
def _cage_impacts(e: Evidence) -> Verdict | None:
    if not e.cage_leads:
        return None
    return _say(e, about=e.candidates['cage'], level='fault')


@_rule('suspect', 'Impacts once a cage turn that modulate the envelope little are no alarm.')
@_where_no_comb_remains
def _weak_cage(e: Evidence) -> Verdict | None:
    cage = e.candidates['cage']
    if cage not in e.own or e.impacts.get('cage', 0.0) < IMPACTS:
        return None
    return _say(e, _NO_ALARM, about=cage)


@_rule('ambiguous', 'A comb with high shaft sidebands may be a sideband of the inner race.')
def _load_zone_modulated(e: Evidence) -> Verdict | None:
    comb = e.load_zone.uncertain if e.own else None
    if comb is None:
        return None
    inner = e.candidates['inner']
    text = (
        f'the comb at {comb.order:.3f} orders has shaft sidebands of '
        f'{e.shaft_sideband_ratios[comb.place]:.1f} of its height and may be one of the inner '
        'race, which passes through the load zone; a longer window or steadier conditions '
        'part them'
    )
    places, level = ('inner', comb.place), _unless_loose(e, comb)
    return _say(e, str(inner), text, about=comb, faults=places, level=level)


@_rule(
    'ambiguous',
    'Lines at a fault order on a multiple of the shaft belong to either.',
    at_most=EVEN,
)
@_where_no_comb_remains
def _masked_candidate(e: Evidence) -> Verdict | None:
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
    return _say(e, str(first), text, faults=tuple(combs), candidates=found)


@_rule('suspect', 'What rings low only may be an outer race, or its variable compliance.')
@_where_no_comb_remains
def _low_bands(e: Evidence) -> Verdict | None:
    outer = e.candidates['outer']
    shown = outer.z >= Z_FAULT and outer.harmonics >= 2 and e.outer_index >= INDEX_FAULT
    if not shown or e.impacts.get('outer', 0.0) < IMPACTS:
        return None
    return _say(e, _rings_low(e), about=outer)


@_rule('suspect', 'Impacts repeat at an order that no part of this bearing makes.')
@_where_no_comb_remains
def _impacts_elsewhere(e: Evidence) -> Verdict | None:
    return _elsewhere(e, 'fit no part of') if _strikes_elsewhere(e) else None


@_rule('insufficient', "A dead sensor has no comb either: its noise is the converter's rounding.")
@_where_no_comb_remains
def _few_steps(e: Evidence) -> Verdict | None:
    if e.steps >= CONVERTER_STEPS:
        return None
    text = (
        f'the RMS is {e.steps:.2g} steps of the converter ({CONVERTER_STEPS:g} are needed to call '
        'it healthy): is the sensor dead? If it is not, raise the gain'
    )
    return _silent(e, text)


@_rule('suspect', 'No load modulates noise so much: impacts or bursts, whatever their period.')
@_where_no_comb_remains
def _bursts(e: Evidence) -> Verdict | None:
    if e.kurtosis <= KURTOSIS:
        return None
    text = (
        f'impacts or bursts without a period of this bearing: kurtosis {e.kurtosis:.1f} without '
        f'single shocks, {KURTOSIS:.1f} is the most of noise that a load modulates; worn '
        'surfaces, dirt, lack of grease, currents, a rub, looseness? check bearing and speed too'
    )
    return _say(e, text)


@_rule(
    'suspect',
    'Of machines with impacts so regular, however faint, two of three are damaged.',
    faint=True,
)
@_where_no_comb_remains
def _mostly_damaged(e: Evidence) -> Verdict | None:
    comb = highest_comb(e.heard)
    if comb is None or comb.z < Z_FAULT or e.impacts.get(comb.place, 0.0) < IMPACTS:
        return None
    sound = confidence('healthy', _trust(e, comb))
    # A factor 2 in power tells two claims apart.
    if sound * (1.0 + RIVAL**2) >= 1.0:
        return None
    text = (
        f'{100.0 * sound:.0f} % of simulated machines with such impacts are sound; modulation '
        'index too low for an alarm: compare with an earlier record, or measure nearer to it'
    )
    return _say(e, text, about=comb)


@_rule(
    'insufficient',
    'Combs of two places of one bearing are not chance: first damage, or waves of its surfaces.',
    faint=True,
    nothing_shows=True,
)
@_where_no_comb_remains
def _two_faint_places(e: Evidence) -> Verdict | None:
    if len(e.faint) < 2:
        return None
    text = (
        'too weak for a fault, but two places of one bearing are not chance: compare with an '
        'earlier record of this machine, and repeat it with a longer window or a nearer sensor'
    )
    return _silent(e, text)


@_rule(
    'insufficient',
    'Of machines with such combs more are damaged than sound.',
    faint=True,
    nothing_shows=True,
)
@_where_no_comb_remains
def _uncertain_health(e: Evidence) -> Verdict | None:
    trust = _trust(e, highest_comb(e.heard))
    sound = confidence('healthy', trust)
    if sound >= LEAST_CONFIDENCE:
        return None
    text = (
        f'not known: {100.0 * sound:.0f} % of simulated machines with a comb of significance '
        f'{trust.z:.1f} and index {trust.index:.2f}, and one of {trust.elsewhere_z:.1f} at any '
        'order, are sound; a longer window, a measured speed, the exact bearing, or a sensor '
        'nearer to it may tell'
    )
    return _silent(e, text)


@_rule(
    'insufficient',
    'A short window shows strong faults only, so it cannot call a bearing healthy.',
    nothing_shows=True,
)
@_where_no_comb_remains
def _few_shaft_turns(e: Evidence) -> Verdict | None:
    if e.turns >= HEALTHY_TURNS:
        return None
    text = (
        f'{e.turns:.0f} shaft turns show strong faults only, and no such one is there: '
        f'{HEALTHY_TURNS:g} are needed to call it healthy, {HEALTHY_TURNS / e.shaft_hz:.1f} s'
    )
    return _silent(e, text)


@_rule(
    'insufficient',
    'Impacts hardly show that come faster than their ringing dies away.',
    nothing_shows=True,
)
@_where_no_comb_remains
def _run_together(e: Evidence) -> Verdict | None:
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
    return _silent(e, text)


@_rule('insufficient', 'What rings low has steady lines and modulates little.', nothing_shows=True)
@_where_no_comb_remains
def _low_lines(e: Evidence) -> Verdict | None:
    if e.low_lines < LOW_LINES:
        return None
    text = (
        f'{100.0 * e.low_lines:.0f} % of the power from the 4th to the 12th multiple of the outer '
        "race's frequency is in lines at these multiples: a fault that rings low, or the variable "
        'compliance of a sound bearing; compare with an earlier record, sample faster or slow down'
    )
    return _silent(e, text)


@_rule('healthy', 'No comb is both significant and strong.', faint=True)
@_where_no_comb_remains
def _no_comb(e: Evidence) -> Verdict | None:
    text = (
        f'no fault comb above a significance of {Z_FAULT:g} with modulation index '
        f'{INDEX_SUSPECT:g}'
    )
    heard = [f'{c}: too weak for a remark alone; compare with an earlier record' for c in e.faint]
    if e.elsewhere.z >= Z_ELSEWHERE and e.impacts['elsewhere'] >= IMPACTS:
        heard.append(
            f'{_impacts(e.elsewhere)}: of no part of a {e.bearing.name}, and too weak for a '
            'remark alone; check bearing and speed'
        )
    return _say(e, text, *heard, level='ok')


@_rule('ambiguous', "Two faults that explain each other's lines cannot be told apart.")
def _same_lines(e: Evidence) -> Verdict | None:
    if not e.same_lines:
        return None
    one, other = e.leading, e.same_lines[0]
    text = (
        f'{one.place} at {one.order:.3f} and {other.place} at '
        f'{other.order:.3f} orders explain the same lines, one as sidebands of the other; '
        'a longer window or an exact speed may part them'
    )
    places = (one.place, *(c.place for c in e.same_lines))
    level = _unless_loose(e, one)
    return _say(e, *map(str, e.same_lines), text, about=one, faults=places, level=level)


@_rule(
    'ambiguous',
    'Rectifiers and converters pulse twice a period of the mains, and swell with no shaft.',
)
def _mains_pulses(e: Evidence) -> Verdict | None:
    sways = e.leading.place == 'inner' and e.leading.shaft_sideband_ratio >= SWAY
    if sways or not e.mains_hz:
        return None
    text = (
        f'it coincides with a multiple of {2.0 * e.mains_hz:g} Hz: the pulses of rectifiers and '
        f'converters on mains of {e.mains_hz:g} Hz; another shaft speed parts them'
    )
    return _say(e, text, about=e.leading)


@_rule('ambiguous', 'A race does not move with the cage, so its comb has no cage sidebands.')
def _cage_sideband_dominated(e: Evidence) -> Verdict | None:
    if not e.cage_sideband_order:
        return None
    text = (
        f'its sidebands are {e.cage_sideband_order:.3f} orders apart, as the cage turns, and a '
        'race does not move with the cage: a ball, or the cage'
    )
    return _say(e, text, about=e.leading, faults=('ball', 'cage'))


@_rule('ambiguous', "An impact once a cage turn may have a harmonic at the ball's order.")
def _cage_harmonic_series(e: Evidence) -> Verdict | None:
    if not e.cage_series_order:
        return None
    text = (
        f'it is one of many lines {e.cage_series_order:.3f} orders apart that do not fade, as a '
        'strike once a cage turn makes them: the cage, or less likely a ball'
    )
    return _say(e, text, about=e.leading, faults=('cage', 'ball'))


@_rule('ambiguous', 'An impact once a turn has lines at all multiples of the shaft.', at_most=EVEN)
def _masked_by_shaft(e: Evidence) -> Verdict | None:
    if e.leading in e.nameable or e.leading.place not in e.masked_by_shaft:
        return None
    text = (
        f'it coincides with {round(e.leading.order)} turns of the shaft within the resolution, '
        'and the other multiples of the shaft are as high: an impact once a turn, or the '
        'fault; a longer window or an exact speed may part them'
    )
    return _say(e, text, about=e.leading)


@_rule('ambiguous', 'A ball moves with the cage, so its comb has no higher shaft sidebands.')
def _shaft_sideband_dominated(e: Evidence) -> Verdict | None:
    if not e.shaft_sidebands_dominate:
        return None
    text = (
        'its sidebands are one turn of the shaft apart, higher than those of the cage with '
        'which a ball moves: the inner race at a slip or a speed that was not expected, or '
        'the ball; check the shaft speed'
    )
    return _say(e, text, about=e.leading, faults=('inner', 'ball'))


@_rule('suspect', 'A comb may be part of stronger impacts at an order of no part of the bearing.')
def _elsewhere_explains(e: Evidence) -> Verdict | None:
    return _elsewhere(e, 'explain it, and fit no part of') if e.elsewhere_explains else None


@_rule('suspect', 'A ball passes the load zone with the cage, so its comb has cage sidebands.')
def _ball_without_cage_sidebands(e: Evidence) -> Verdict | None:
    # A short window resolves the sidebands badly: within 3 dB neither are the higher ones.
    least = max(SWAY, e.turning_sideband_ratio / (RIVAL if e.turns < HEALTHY_TURNS else 1.0))
    if e.leading.place != 'ball' or e.cage_sideband_ratio >= least:
        return None
    text = (
        f'its sidebands at the turns of the cage are {e.cage_sideband_ratio:.2f} of its height, '
        f'at those of the shaft {e.turning_sideband_ratio:.2f}, and a ball moves with the cage: '
        'impacts of another part, another bearing or another speed? check bearing and speed'
    )
    return _say(e, text, about=e.leading)


@_rule('suspect', 'With a large slip a race needs sidebands that fit: shaft ones if it turns.')
def _slipping_race(e: Evidence) -> Verdict | None:
    leading = e.leading
    if leading.place not in ('inner', 'outer') or leading.slip <= SLIP_COST:
        return None
    turns = leading.shaft_sideband_ratio >= SWAY
    if turns == (leading.place == 'inner'):
        return None
    text = (
        f'it needs a slip of {100.0 * leading.slip:.1f} %, and its shaft sidebands of '
        f'{leading.shaft_sideband_ratio:.2f} of its height are those of a part that '
        f'{"turns" if turns else "stands still"}: check bearing and speed'
    )
    return _say(e, text, about=leading)


@_rule('suspect', 'A gear, a belt or another bearing may have a harmonic at this order.')
def _extraneous(e: Evidence) -> Verdict | None:
    if e.leading in e.nameable:
        return None
    order = e.extraneous_orders[e.leading.place]
    text = (
        f'it shares its harmonics with a comb at {order:.3f} orders, which no part '
        'of this bearing has: check geometry and speed; a gear, a belt, another bearing or a '
        'cage that slips far?'
    )
    return _say(e, text, about=e.leading)


@_rule('ambiguous', 'A comb that two places claim at likely slips belongs to either.')
def _contested_comb(e: Evidence) -> Verdict | None:
    for pair in e.claims.contested:
        one, other = pair
        if e.leading not in pair:
            continue
        text = (
            f'{one.place} with a slip of {100.0 * one.slip:.1f} % and {other.place} with '
            f'{100.0 * other.slip:.1f} % coincide at {one.order:.3f} orders, and sidebands do not '
            'tell them apart: an exact shaft speed may part them'
        )
        strong = any(c.index >= INDEX_FAULT for c in (e.leading, *_certain(e)))
        level = 'fault' if strong else 'suspect'
        places, found = (one.place, other.place), _updated(e)
        texts = (str(other), text)
        return _say(e, *texts, about=one, faults=places, level=level, candidates=found)
    return None


@_rule(
    'ambiguous', 'Without an exact speed lines of a second fault may be sidebands of the first.'
)
def _uncertain_second(e: Evidence) -> Verdict | None:
    doubtful = _doubtful(e)
    # Beside a leading comb that is too weak for an alarm, the alarm is the other's.
    named = e.leading.index >= INDEX_FAULT
    if not doubtful or (named and max(c.z for c in doubtful) * RIVAL <= e.leading.z):
        return None
    places = (e.leading.place, *(c.place for c in doubtful))
    texts = (*map(str, _in_order(e)[1:]), _GIVE_SPEED)
    found = _updated(e)
    return _say(e, *texts, about=e.leading, faults=places, level='fault', candidates=found)


@_rule('suspect', 'A significant comb that modulates the envelope little is no alarm.', faint=True)
def _weak_modulation(e: Evidence) -> Verdict | None:
    places = tuple(c.place for c in _in_order(e))
    if any(c.index >= INDEX_FAULT for c in (e.leading, *_certain(e))):
        return None
    texts = (*map(str, _in_order(e)[1:]), _NO_ALARM)
    return _say(e, *texts, about=e.leading, faults=places, candidates=_updated(e))


@_rule('suspect', 'Sound parts, blades and vanes modulate smoothly; impacts have all harmonics.')
def _smooth(e: Evidence) -> Verdict | None:
    # What has the sidebands of its place is no blade; these and lobes pass at whole or half turns.
    place, sways = e.leading.place, e.leading.shaft_sideband_ratio >= SWAY
    sided = place == 'ball' or (not e.half_turn and sways == (place == 'inner'))
    if sided or not e.smooth or e.leading.index > INDEX_SMOOTH:
        return None
    text = (
        'its third and fourth harmonic are missing, so it is smooth: an extended spall, an error '
        'of form, or the pulses of blades, vanes or lobes? check bearing and speed'
    )
    return _say(e, text, about=e.leading)


@_rule('ambiguous', 'What strikes a whole number of times a turn may be a part of the shaft.')
def _whole_turns(e: Evidence) -> Verdict | None:
    # A name at an unlikely slip is no alarm and asks for the speed itself.
    if e.leading.slip > UNLIKELY_SLIP or not e.whole_turns:
        return None
    text = (
        f'the shaft speed is not known well enough to tell it from {e.whole_turns} impacts a '
        'turn, as of a coupling; give a measured speed'
    )
    return _say(e, text, about=e.leading, level=_unless_loose(e, e.leading))


@_rule('suspect', "A comb with sidebands of another bearing's cage is that of its ball.")
def _another_cage(e: Evidence) -> Verdict | None:
    if not e.another_cage_order:
        return None
    text = (
        f'its sidebands are {e.another_cage_order:.3f} orders apart, as the cage of another '
        f'bearing turns, and not that of a {e.bearing.name}: a ball of another bearing? check '
        'bearing and speed'
    )
    return _say(e, text, about=e.leading)


@_rule('its place', 'The comb is significant, strong, and nothing else explains it.')
def _fault(e: Evidence) -> Verdict | None:
    places = tuple(c.place for c in (e.leading, *_certain(e)) if c.index >= INDEX_FAULT)
    texts = (*map(str, _in_order(e)[1:]), *((_GIVE_SPEED,) if _doubtful(e) else ()))
    found = _updated(e)
    return _say(e, *texts, about=e.leading, faults=places, level='fault', candidates=found)


FAINT = frozenset(rule.name for rule in RULES if rule.faint)
NOTHING_SHOWS = frozenset(rule.name for rule in RULES if rule.nothing_shows)


def decide(evidence: Evidence) -> Verdict:
    """
    Verdict of the first rule that applies.

    >>> from bearing_twin.diagnosis.rules.evidence import Evidence
    >>> from bearing_twin.diagnosis.combs.candidate import Candidate
    >>> outer = Candidate('outer', order=3.07, slip=0.01, z=9.0, index=0.8)
    >>> decide(Evidence.of(outer)).rule
    'fault'
    >>> decide(Evidence.of(outer, mains_hz=50.0)).rule
    'mains_pulses'

    """
    return trusted(evidence, answer(evidence))


def answer(evidence: Evidence) -> Verdict:
    """
    Verdict of the first rule that applies, without what its confidence rests on.

    >>> from bearing_twin.diagnosis.rules.evidence import Evidence
    >>> from bearing_twin.diagnosis.combs.candidate import Candidate
    >>> slipped = answer(Evidence.of(Candidate('inner', 4.9, slip=0.03, z=9.0, index=0.8)))
    >>> slipped.result, slipped.level
    ('inner', 'suspect')

    """
    for rule in RULES:
        verdict = rule.apply(evidence)
        if verdict is not None:
            result = verdict.faults[0] if rule.answer == 'its place' else rule.answer
            verdict = replace(verdict, result=result, rule=rule.name)
            slip = _unlikely_slip(verdict)
            if not slip:
                return verdict
            text = (
                f'it needs a slip of {100.0 * slip:.1f} %: no alarm, as a bearing under load '
                'slips by less; check bearing and speed'
            )
            return replace(verdict, level='suspect', reasons=(*verdict.reasons, text))
    raise AssertionError('the last rule applies to any evidence')


def trusted(evidence: Evidence, verdict: Verdict) -> Verdict:
    """
    Return an answer with what its confidence rests on; it is capped at an unlikely slip.

    >>> from bearing_twin.diagnosis.rules.evidence import Evidence
    >>> from bearing_twin.diagnosis.combs.candidate import Candidate
    >>> slipped = Evidence.of(Candidate('inner', 4.9, slip=0.03, z=9.0, index=0.8))
    >>> trusted(slipped, answer(slipped)).trust.at_most == DOUBTED
    True

    """
    rule = next(rule for rule in RULES if rule.name == verdict.rule)
    named = (verdict.candidates[place] for place in verdict.faults)
    # Of two faults both must be there; of several places one.
    pick = min if verdict.result in verdict.faults else max
    comb = pick(named, key=lambda c: c.z, default=None)
    trust = _trust(evidence, comb or highest_comb(evidence.heard), rule)
    if _unlikely_slip(verdict):
        trust = replace(trust, at_most=min(trust.at_most, DOUBTED))
    return replace(verdict, trust=trust)


def _unlikely_slip(verdict: Verdict) -> float:
    """
    Slip that an answer needs if that is an unlikely one, else 0.

    Places named together need it where one does; of several that are possible all must. But
    places that explain each other's lines are as clear as each other: where one of them needs it,
    bearing or speed are doubtful.
    """
    if verdict.result not in (*PLACES, 'ambiguous'):
        return 0.0
    # A comb that may be chance has any slip: the answer does not rest on it.
    slips = [c.slip for c in map(verdict.candidates.__getitem__, verdict.faults) if c.z >= Z_FAULT]
    pick = min if verdict.result == 'ambiguous' and verdict.rule != 'same_lines' else max
    slip = pick(slips, default=0.0)
    return slip if slip > UNLIKELY_SLIP else 0.0


def _trust(e: Evidence, comb: Candidate | None, rule: Rule | None = None) -> Trust:
    """Return what an answer about a comb, or about none, rests on."""
    # The comb is one at any order itself, also where it lies on a multiple of the shaft.
    strongest = max(e.elsewhere, comb or e.elsewhere, key=lambda c: c.z)
    z, index, slip = (comb.z, comb.index, comb.slip) if comb else (0.0, 0.0, 0.0)
    return Trust(
        z, index, slip, strongest.z, strongest.index, e.impacts.get(strongest.place, 0.0),
        e.turns, e.speed_known, *((rule.name, rule.at_most) if rule else ()),
    )  # fmt: skip


def _cage_or_ball(e: Evidence) -> bool:
    """
    Whether the cage leads, and a ball in and out of the load may be what it shows.

    An impact has every harmonic, the outer race's order exactly among them. What shows the ball's
    order better than that is the ripple of such a ball.
    """
    outer, ball, cage = (e.candidates[place] for place in ('outer', 'ball', 'cage'))
    few_harmonics = outer.z < max(ball.z, Z_FAULT)
    return e.cage_leads and (few_harmonics or cage.index < INDEX_STRIKE)


def _strikes_elsewhere(e: Evidence) -> bool:
    """Whether strong impacts repeat at an order off the shaft, whatever makes them."""
    comb = e.elsewhere
    strong = comb.z >= Z_ELSEWHERE and comb.index >= INDEX_FAULT
    return strong and e.impacts['elsewhere'] >= IMPACTS


_NO_ALARM = f'modulation index below {INDEX_FAULT:g}: not an alarm'

_GIVE_SPEED = (
    'the shaft speed is not known well enough to name a second fault beside the first: '
    'its lines may be sidebands; give a measured speed'
)


def _certain(e: Evidence) -> tuple[Candidate, ...]:
    """Other combs that are faults of their own."""
    return tuple(c for c in e.others if c.index >= INDEX_FAULT and e.speed_known)


def _doubtful(e: Evidence) -> tuple[Candidate, ...]:
    """Other combs that would be faults if the speed were known exactly."""
    return tuple(c for c in e.others if c.index >= INDEX_FAULT and not e.speed_known)


def _in_order(e: Evidence) -> tuple[Candidate, ...]:
    """Return the leading comb, those of other faults, then those that are none for certain."""
    certain = _certain(e)
    return (e.leading, *certain, *(c for c in e.others if c not in certain))


def _updated(e: Evidence) -> dict[str, Candidate]:
    """Candidates; those beside the leading one without the lines that it explains."""
    return e.candidates | {c.place: c for c in _in_order(e)}


def _say(
    e: Evidence,
    *texts: str,
    about: Candidate | None = None,
    faults: tuple[str, ...] | None = None,
    level: str = 'suspect',
    candidates: dict[str, Candidate] | None = None,
) -> Verdict:
    """
    Verdict for the reasons ``texts``; :func:`decide` adds the answer that the rule has.

    It is about a comb, or about none, and then about the place of that comb or about ``faults``.
    """
    if faults is None:
        faults = (about.place,) if about else ()
    return Verdict(
        level=level,
        faults=faults,
        reasons=(str(about), *texts) if about else texts,
        candidates=candidates or e.candidates,
        strongest=about,
    )


def _unless_loose(e: Evidence, comb: Candidate) -> str:
    """Level of a comb: an alarm where it is strong and no loose shaft has such lines."""
    return 'fault' if comb.index >= INDEX_FAULT and comb.place not in e.loose else 'suspect'


def _silent(e: Evidence, text: str) -> Verdict:
    return _say(e, *map(str, e.faint), text, level='none')


def _elsewhere(e: Evidence, what: str) -> Verdict:
    """Verdict on impacts that no part of the bearing makes, with what would explain them."""
    comb, outer = e.elsewhere, e.candidates['outer']
    if abs(comb.order - outer.order) <= 2.0 * e.step:
        return _say(e, _rings_low(e), about=outer)
    if abs(comb.order - 1.0) < 0.1:
        text = f'the shaft seems to turn at {comb.order * e.shaft_hz:.4g} Hz: check the speed'
    else:
        text = f'periodic impacts at {comb.order:.3f} orders {what} a {e.bearing.name}: check '
        text += f'bearing and speed{what_fits(comb.order, 2.0 * e.step, e.shaft_hz, e.bearing)}'
    return _say(e, _impacts(comb), text)


def _impacts(comb: Candidate) -> str:
    return str(comb).replace('elsewhere: comb', 'impacts')


def _rings_low(e: Evidence) -> str:
    return (
        f'it modulates by {e.outer_index:.2f} in bands below {CARRIER:g} times its frequency '
        'only, where the variable compliance of a sound bearing shows as well'
    )
