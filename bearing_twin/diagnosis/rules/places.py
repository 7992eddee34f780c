# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Rules on the place: the leading comb is of its place, of another one, or of either."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.diagnosis.combs.candidate import RACES
from bearing_twin.diagnosis.rules.rule import EVEN, rule
from bearing_twin.diagnosis.rules.verdict import NO_ALARM, say, unless_shaft
from bearing_twin.diagnosis.signal.gate import HEALTHY_TURNS
from bearing_twin.diagnosis.thresholds import INDEX_FAULT, RIVAL, SLIP_COST, SWAY

if TYPE_CHECKING:
    from bearing_twin.diagnosis.rules.evidence import Evidence
    from bearing_twin.diagnosis.rules.verdict import Verdict


_GIVE_SPEED = (
    'the shaft speed is not known well enough to name a second fault beside the first: '
    'its lines may be sidebands; give a measured speed'
)


@rule('ambiguous', 'A comb with high shaft sidebands may be a sideband of the inner race.')
def load_zone_modulated(e: Evidence) -> Verdict | None:
    comb = e.load_zone.uncertain if e.unexplained else None
    if comb is None:
        return None
    inner = e.candidates['inner']
    text = (
        f'the comb at {comb.order:.3f} orders has shaft sidebands of '
        f'{e.shaft_sideband_ratios[comb.place]:.1f} of its height and may be one of the inner '
        'race, which passes through the load zone; a longer window or steadier conditions '
        'part them'
    )
    places, level = ('inner', comb.place), unless_shaft(e, comb)
    return say(e, str(inner), text, about=comb, faults=places, level=level)


@rule('ambiguous', "Two faults that explain each other's lines cannot be told apart.")
def same_lines(e: Evidence) -> Verdict | None:
    if not e.same_lines:
        return None
    one, other = e.leading, e.same_lines[0]
    text = (
        f'{one.place} at {one.order:.3f} and {other.place} at '
        f'{other.order:.3f} orders explain the same lines, one as sidebands of the other; '
        'a longer window or an exact speed may part them'
    )
    places = (one.place, *(c.place for c in e.same_lines))
    level = unless_shaft(e, one)
    return say(e, *map(str, e.same_lines), text, about=one, faults=places, level=level)


@rule('ambiguous', 'Cage sidebands are of a ball or the cage, or of balls passing an outer race.')
def cage_sideband_dominated(e: Evidence) -> Verdict | None:
    if not e.cage_sideband_order:
        return None
    text = f'its sidebands are {e.cage_sideband_order:.3f} orders apart, as the cage turns, '
    places: tuple[str, ...] = ('ball', 'cage')
    if e.passing_balls_ratio:
        text += (
            f'and its order is that of {e.bearing.n_balls} balls in a turn of that cage: an outer '
            'race whose impacts vary once a turn of the cage, as with balls of different sizes, '
            'a ball, or the cage'
        )
        # A strike once a turn of the cage has equally high lines.
        lower = e.passing_balls_ratio * RIVAL < 1.0
        places = ('outer', *places) if lower else (*places, 'outer')
    else:
        text += 'and a race does not move with the cage: a ball, or the cage'
    return say(e, text, about=e.leading, faults=places)


@rule('ambiguous', 'A ball moves with the cage, so its comb has no higher shaft sidebands.')
def shaft_sideband_dominated(e: Evidence) -> Verdict | None:
    if not e.shaft_sidebands_dominate:
        return None
    text = (
        'its sidebands are one turn of the shaft apart, higher than those of the cage with '
        'which a ball moves: the inner race at a slip or a speed that was not expected, or '
        'the ball; check the shaft speed'
    )
    return say(e, text, about=e.leading, faults=('inner', 'ball'))


@rule('suspect', 'A ball passes the load zone with the cage, so its comb has cage sidebands.')
def ball_without_cage_sidebands(e: Evidence) -> Verdict | None:
    # A short window resolves the sidebands badly: within 3 dB they are equally high.
    least = max(SWAY, e.turning_sideband_ratio / (RIVAL if e.turns < HEALTHY_TURNS else 1.0))
    if e.leading.place != 'ball' or e.cage_sideband_ratio >= least:
        return None
    text = (
        f'its sidebands at the turns of the cage are {e.cage_sideband_ratio:.2f} of its height, '
        f'at those of the shaft {e.turning_sideband_ratio:.2f}, and a ball moves with the cage: '
        'impacts of another part, another bearing or another speed? check bearing and speed'
    )
    return say(e, text, about=e.leading)


@rule('suspect', 'With a large slip a race needs sidebands that fit: shaft ones if it turns.')
def slipping_race(e: Evidence) -> Verdict | None:
    leading = e.leading
    if leading.place not in RACES or leading.slip <= SLIP_COST:
        return None
    turns = leading.shaft_sideband_ratio >= SWAY
    if turns == (leading.place == 'inner'):
        return None
    text = (
        f'it needs a slip of {100.0 * leading.slip:.1f} %, and its shaft sidebands of '
        f'{leading.shaft_sideband_ratio:.2f} of its height are those of a part that '
        f'{"turns" if turns else "stands still"}: check bearing and speed'
    )
    return say(e, text, about=leading)


@rule('ambiguous', 'A comb that two places claim at likely slips belongs to either.')
def contested_comb(e: Evidence) -> Verdict | None:
    for pair in e.claims.contested:
        one, other = pair
        if e.leading not in pair:
            continue
        text = (
            f'{one.place} with a slip of {100.0 * one.slip:.1f} % and {other.place} with '
            f'{100.0 * other.slip:.1f} % coincide at {one.order:.3f} orders, and sidebands do not '
            'tell them apart: an exact shaft speed may part them'
        )
        level = 'fault' if e.alarms else 'suspect'
        places, found = (one.place, other.place), e.separated
        texts = (str(other), text)
        return say(e, *texts, about=one, faults=places, level=level, candidates=found)
    return None


@rule('ambiguous', 'Without an exact speed lines of a second fault may be sidebands of the first.')
def uncertain_second(e: Evidence) -> Verdict | None:
    doubtful = e.uncertain_faults
    # If the leading comb is too weak for an alarm, the other comb gives the alarm.
    named = e.leading.index >= INDEX_FAULT
    if not doubtful or (named and max(c.z for c in doubtful) * RIVAL <= e.leading.z):
        return None
    places = (e.leading.place, *(c.place for c in doubtful))
    texts = (*map(str, e.leading_first[1:]), _GIVE_SPEED)
    found = e.separated
    return say(e, *texts, about=e.leading, faults=places, level='fault', candidates=found)


@rule(
    'suspect',
    'Weak combs of both races that one cage makes are not of one spall.',
    faint=True,
    at_most=EVEN,
    tells='compare with an earlier record; look for standstill, a wrong fit and bearing currents',
)
def both_races(e: Evidence) -> Verdict | None:
    if e.alarms or e.other_race is None:
        return None
    other, n_balls = e.other_race, e.bearing.n_balls
    text = (
        f'{other.place} shows too, at {other.order:.3f} orders: together {n_balls}, as one cage '
        f'makes them with {n_balls} balls; one spall marks one race; a damaged ball, standstill, '
        'mounting or currents mark both, and sound races may have waves'
    )
    places = (e.leading.place, other.place, 'ball')
    beside = (str(c) for c in e.leading_first[1:] if abs(c.order - other.order) > 2.0 * e.step)
    texts = (*beside, text, NO_ALARM)
    return say(e, *texts, about=e.leading, faults=places, candidates=e.separated)


@rule('suspect', 'A significant comb that modulates the envelope little is no alarm.', faint=True)
def weak_modulation(e: Evidence) -> Verdict | None:
    if e.alarms:
        return None
    places = tuple(c.place for c in e.leading_first)
    texts = (*map(str, e.leading_first[1:]), NO_ALARM)
    return say(e, *texts, about=e.leading, faults=places, candidates=e.separated)


@rule('ambiguous', 'Lines of a shaft show at another speed only, where another place strikes so.')
def another_shaft(e: Evidence) -> Verdict | None:
    if not e.other_shafts:
        return None
    texts = (
        f'no lines of a shaft show at {e.shaft_hz:.4g} Hz, but at {hertz:.4g} Hz, and at that '
        f'speed it is a fault of the {place}: check the speed'
        for place, hertz in e.other_shafts.items()
    )
    places = (e.leading.place, *e.other_shafts)
    return say(e, *texts, about=e.leading, faults=places, level='fault', candidates=e.separated)


@rule('its place', 'The comb is significant, strong, and nothing else explains it.')
def fault(e: Evidence) -> Verdict | None:
    places = tuple(c.place for c in e.alarms)
    texts = (*map(str, e.leading_first[1:]), *((_GIVE_SPEED,) if e.uncertain_faults else ()))
    found = e.separated
    return say(e, *texts, about=e.leading, faults=places, level='fault', candidates=found)
