# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Every rule, reached by evidence that is written down by hand."""

from dataclasses import replace
import math
from pathlib import Path
import re
import runpy
from types import SimpleNamespace

from bearing_twin.bearing import fault_orders, find_bearing
from bearing_twin.diagnosis.combs.candidate import Candidate, Claims
from bearing_twin.diagnosis.rules.confidence import CLAIMS, confidence
from bearing_twin.diagnosis.rules.evidence import Evidence
from bearing_twin.diagnosis.rules.rule import EVEN
from bearing_twin.diagnosis.rules.table import decide, DOUBTED, FAINT, NOTHING_SHOWS, RULES, TELLS
from bearing_twin.recording.topics import LEVEL_FAULT, LEVEL_NONE, LEVEL_OK, LEVEL_SUSPECT
from bearing_twin.view.verdict import LOUDER, next_step
import numpy as np
import pytest

DOCUMENT = Path(__file__).parents[3] / 'docs' / 'diagnosis.md'


def comb(place, *, order=None, z=9.0, index=0.8, slip=0.01, **more):
    orders = {'inner': 4.93, 'outer': 3.07, 'ball': 4.05, 'cage': 0.38}
    return Candidate(place, order or orders[place], slip, z, index, **more)


INNER, OUTER, BALL = comb('inner'), comb('outer'), comb('ball')
CAGE = comb('cage', z=20.0, index=3.0)
CAGE_IMPACTS = (comb('outer', order=8 * 0.38, z=12.0), CAGE)
RIPPLING_BALL = comb('ball', order=11 * 0.38)
WEAK = comb('inner', index=0.4)
INNER_SIDEBAND = comb('outer', order=3.93, z=12.0, shaft_sideband_ratio=0.8)
SIDEBAND = {'shaft_sideband_ratios': {'outer': 0.8}, 'inner_race_ratios': {'outer': 0.8}}

CASES = {
    'ball_ripple': (Evidence.of(CAGE, RIPPLING_BALL), 'ball', 'fault', ('ball',)),
    'ball_passages': (Evidence.of(CAGE, ball_passages=5.0), 'ball', 'fault', ('ball',)),
    'cage_ripple': (
        Evidence.of(CAGE, comb('ball', index=0.2)),
        'ambiguous',
        'suspect',
        ('ball', 'cage'),
    ),
    'few_cage_turns': (
        Evidence.of(*CAGE_IMPACTS, cage_turns=39.0),
        'suspect',
        'suspect',
        ('cage',),
    ),
    'cage_impacts': (Evidence.of(*CAGE_IMPACTS), 'cage', 'fault', ('cage',)),
    'weak_cage': (
        Evidence.of(comb('cage', z=12.0, index=0.5), impacts={'cage': 2.0}),
        'suspect',
        'suspect',
        ('ball', 'cage'),
    ),
    'load_zone_modulated': (
        Evidence.of(INNER_SIDEBAND, **SIDEBAND),
        'ambiguous',
        'fault',
        ('inner', 'outer'),
    ),
    'masked_candidate': (
        Evidence.of(masked_candidates=(comb('ball', order=4.001),)),
        'ambiguous',
        'suspect',
        ('ball',),
    ),
    'low_bands': (
        Evidence.of(comb('outer', z=15.0, index=0.0), outer_index=0.8, impacts={'outer': 2.3}),
        'suspect',
        'suspect',
        ('outer',),
    ),
    'impacts_elsewhere': (
        Evidence.of(elsewhere=comb('elsewhere', order=3.76, z=8.1, index=0.7)),
        'suspect',
        'suspect',
        (),
    ),
    'strikes_each_turn': (
        Evidence.of(impacts_each_turn=comb('elsewhere', order=3.0, z=8.1, index=1.4)),
        'suspect',
        'suspect',
        (),
    ),
    'few_steps': (Evidence.of(steps=1.9, kurtosis=500.0), 'insufficient', 'none', ()),
    'bursts': (Evidence.of(kurtosis=6.0), 'suspect', 'suspect', ()),
    'mostly_damaged': (
        Evidence.of(
            comb('inner', z=25.0, index=0.25),
            elsewhere=comb('elsewhere', order=3.76, z=7.9, index=0.9),
            impacts={'inner': 2.0},
        ),
        'suspect',
        'suspect',
        ('inner',),
    ),
    'two_faint_places': (
        Evidence.of(comb('inner', z=6.3, index=0.17), comb('outer', z=5.6, index=0.17)),
        'insufficient',
        'none',
        (),
    ),
    'fast_impacts': (
        Evidence.of(
            comb('inner', z=12.0, index=0.1),
            impacts={'inner': 1.2},
            fast_harmonics=(2.0, 0.8),
            shaft_hz=100.0,
        ),
        'suspect',
        'suspect',
        ('inner',),
    ),
    'uncertain_health': (
        Evidence.of(
            comb('inner', z=12.0, index=0.25),
            elsewhere=comb('elsewhere', order=3.76, z=7.9, index=0.9),
        ),
        'insufficient',
        'none',
        (),
    ),
    'few_shaft_turns': (Evidence.of(turns=49.0), 'insufficient', 'none', ()),
    # The inner race of a 6205 strikes 5.4 times a turn of 1/25 s.
    'run_together': (Evidence.of(sample_rate=2400.0), 'insufficient', 'none', ()),
    'low_lines': (Evidence.of(low_lines=0.5), 'insufficient', 'none', ()),
    'masked_faintly': (
        Evidence.of(masked_combs=(comb('outer', order=3.001, z=15.0, index=0.5),)),
        'insufficient',
        'none',
        (),
    ),
    'faint_comb': (Evidence.of(comb('inner', z=12.0, index=0.17)), 'healthy', 'ok', ()),
    'no_comb': (Evidence.of(turns=50.0), 'healthy', 'ok', ()),
    'same_lines': (
        Evidence.of(INNER, OUTER, explained={('inner', 'outer'), ('outer', 'inner')}),
        'ambiguous',
        'fault',
        ('inner', 'outer'),
    ),
    'mains_pulses': (
        Evidence.of(comb('inner', shaft_sideband_ratio=0.1), mains_hz=50.0),
        'ambiguous',
        'suspect',
        ('inner',),
    ),
    'cage_sideband_dominated': (
        Evidence.of(INNER, cage_sideband_order=0.35),
        'ambiguous',
        'suspect',
        ('ball', 'cage'),
    ),
    'masked_by_shaft': (
        Evidence.of(OUTER, masked_by_shaft={'outer'}),
        'ambiguous',
        'suspect',
        ('outer',),
    ),
    'shaft_sideband_dominated': (
        Evidence.of(BALL, shaft_sidebands_dominate=True),
        'ambiguous',
        'suspect',
        ('inner', 'ball'),
    ),
    'elsewhere_explains': (Evidence.of(INNER, elsewhere_explains=True), 'suspect', 'suspect', ()),
    'ball_without_cage_sidebands': (
        Evidence.of(BALL, cage_sideband_ratio=0.1),
        'suspect',
        'suspect',
        ('ball',),
    ),
    'slipping_race': (
        Evidence.of(comb('outer', slip=0.021, shaft_sideband_ratio=0.4)),
        'suspect',
        'suspect',
        ('outer',),
    ),
    'extraneous': (
        Evidence.of(OUTER, extraneous_orders={'outer': 1.535}),
        'suspect',
        'suspect',
        ('outer',),
    ),
    'contested_comb': (
        Evidence.of(OUTER, claims=Claims((OUTER,), ((OUTER, BALL),))),
        'ambiguous',
        'fault',
        ('outer', 'ball'),
    ),
    'uncertain_second': (
        Evidence.of(INNER, OUTER, others=(OUTER,), speed_known=False),
        'ambiguous',
        'fault',
        ('inner', 'outer'),
    ),
    'both_races': (
        Evidence.of(WEAK, other_race=OUTER),
        'suspect',
        'suspect',
        ('inner', 'outer', 'ball'),
    ),
    'weak_modulation': (Evidence.of(WEAK), 'suspect', 'suspect', ('inner',)),
    'smooth': (Evidence.of(INNER, smooth=True, half_turn=True), 'suspect', 'suspect', ('inner',)),
    'whole_turns': (Evidence.of(OUTER, whole_turns=3), 'ambiguous', 'fault', ('outer',)),
    'another_cage': (
        Evidence.of(INNER, another_cage_order=0.43),
        'suspect',
        'suspect',
        ('inner',),
    ),
    'another_shaft': (
        Evidence.of(INNER, other_shafts={'outer': 37.4}),
        'ambiguous',
        'fault',
        ('inner', 'outer'),
    ),
    'fault': (Evidence.of(INNER), 'inner', 'fault', ('inner',)),
}


@pytest.mark.parametrize('rule', RULES, ids=[rule.name for rule in RULES])
def test_rule_is_reached_without_a_signal(rule):
    evidence, result, level, faults = CASES[rule.name]
    said = decide(evidence)
    assert (said.rule, said.result, said.level, said.faults) == (rule.name, result, level, faults)
    assert said.reasons
    assert rule.answer in (said.result, 'its place')


def test_rules_without_a_statement_are_marked():
    """Parts of a record and a trend ask by these marks; of a dead sensor nothing is learnt."""
    silent = {name for name, (_, _, level, _) in CASES.items() if level == 'none'}
    assert silent - NOTHING_SHOWS == {'few_steps'}
    suspect = {name for name, (_, _, level, _) in CASES.items() if level == 'suspect'}
    assert suspect & FAINT == {'both_races', 'weak_modulation', 'mostly_damaged', 'fast_impacts'}


def test_a_healthy_answer_with_a_weak_comb_asks_for_the_comparison_that_it_names():
    clear = decide(CASES['faint_comb'][0])
    assert 'compare with an earlier record' in clear.reasons[1]
    message = SimpleNamespace(
        result_name='healthy', rule='faint_comb', level=LEVEL_OK, faults=(), stage=0.0,
        shaft_hz=25.0, shaft_hz_given=25.0, velocity_rms=math.nan,
        level_over_baseline=math.nan, iso_zone='',
    )  # fmt: skip
    assert next_step(message) == 'Go on measuring, and compare with an earlier record.'
    # After a lasting rise the level is why it is suspect.
    risen = SimpleNamespace(**vars(message) | {'result_name': 'suspect', 'level': LEVEL_SUSPECT})
    assert next_step(risen) == next_step(SimpleNamespace(**vars(risen) | {'rule': 'no_comb'}))


@pytest.mark.parametrize('name', [n for n in TELLS if CASES[n][2] in ('suspect', 'fault')])
def test_what_something_sound_explains_as_well_is_not_sure_and_orders_no_bearing(name):
    evidence, result, level, faults = CASES[name]
    clear = decide(evidence)._replace(level=level)
    sure = replace(clear.trust, z=40.0, index=2.0, impacts=3.0, turns=2000.0)
    clear = clear._replace(trust=sure)
    assert clear.confidence <= EVEN or CLAIMS[clear.kind].startswith('that something strikes')
    message = SimpleNamespace(
        result_name=result, rule=name, faults=faults,
        level={'suspect': LEVEL_SUSPECT, 'fault': LEVEL_FAULT}[level],
        stage=2.0 * (level == 'fault'), shaft_hz=25.0, shaft_hz_given=25.0,
        velocity_rms=math.nan, level_over_baseline=5.9, iso_zone='B',
    )  # fmt: skip
    assert next_step(message).casefold() == f'{TELLS[name]}.'.casefold()
    # A level that has doubled answers what comparing with an earlier record would.
    louder = SimpleNamespace(**vars(message) | {'level_over_baseline': 6.1})
    worn = SimpleNamespace(**vars(message) | {'iso_zone': 'C'})
    assert next_step(louder).casefold() != f'{TELLS[name]}.'.casefold()
    assert next_step(louder) == next_step(worn)
    assert result != 'suspect' or next_step(worn).casefold() == f'{LOUDER}.'.casefold()
    # A vibration that is that of a damaged machine asks for more.
    message.stage = 4.0
    assert 'find the cause' in next_step(message).casefold() or level == 'suspect'


@pytest.mark.parametrize('name', [name for name in TELLS if CASES[name][2] == 'none'])
def test_what_shows_nothing_says_how_to_record_again(name):
    message = SimpleNamespace(
        result_name='insufficient', rule=name, level=LEVEL_NONE, faults=(), stage=math.nan,
        shaft_hz=25.0, shaft_hz_given=25.0, velocity_rms=math.nan, level_over_baseline=math.nan,
        iso_zone='',
    )  # fmt: skip
    assert next_step(message).casefold() == f'{TELLS[name]}.'.casefold()
    standing = SimpleNamespace(**vars(message) | {'shaft_hz': 0.0})
    assert next_step(standing) == 'Measure while the shaft turns.'


def test_every_rule_has_a_case_and_a_sentence():
    assert list(CASES) == [rule.name for rule in RULES]
    assert all(rule.why.endswith('.') for rule in RULES)


def test_the_documented_table_is_that_of_the_rules():
    text = DOCUMENT.read_text('utf-8')
    made = runpy.run_path(str(DOCUMENT.with_name('rules.py')))['with_rules'](text)
    assert text == made, "run 'python docs/rules.py docs/diagnosis.md'"


@pytest.mark.parametrize(
    ('evidence', 'faults'),
    [
        # The greater weight leads: z times index, less for a comb beside high sidebands.
        (Evidence.of(comb('inner', z=8.0), OUTER), 'outer'),
        (Evidence.of(comb('inner', shaft_sideband_ratio=0.4), comb('outer', z=12.0)), 'inner'),
        # A comb of its own is named whatever stronger comb is a gear's.
        (Evidence.of(comb('inner', z=30.0), OUTER, extraneous_orders={'inner': 0.7}), 'outer'),
        # The cause leads where it is the more significant one.
        (
            Evidence.of(comb('inner', z=9.5, index=0.7), OUTER, explained={('inner', 'outer')}),
            'inner',
        ),
        # An outer race's comb that is the inner race's sideband is not named.
        (Evidence.of(comb('inner', z=20.0), INNER_SIDEBAND, **SIDEBAND), 'inner'),
        # Faint and chance combs say nothing.
        (Evidence.of(INNER, comb('outer', z=5.4, index=3.0)), 'inner'),
        (Evidence.of(INNER, comb('outer', z=50.0, index=0.29)), 'inner'),
        (Evidence.of(INNER, comb('outer', z=50.0, harmonics=1)), 'inner'),
    ],
)
def test_the_leading_comb_is_named(evidence, faults):
    said = decide(evidence)
    assert (said.rule, said.faults) == ('fault', (faults,))


def test_combs_of_other_places_make_a_suspicion_less_sure():
    """A spall marks one part of a bearing; waves of its surfaces show at the orders of all."""
    alone = decide(Evidence.of(WEAK))
    among = decide(Evidence.of(WEAK, comb('outer', z=8.0, index=0.2), comb('cage', index=0.2)))
    assert alone.rule == among.rule == 'weak_modulation'
    assert alone.trust.others == 0.0
    assert among.trust.others == pytest.approx(np.log([8.0, 1.0, 9.0]).mean())
    assert confidence('suspect', alone.trust) > confidence('suspect', among.trust)


@pytest.mark.parametrize(('index', 'rule'), [(0.8, 'fault'), (0.4, 'weak_modulation')])
def test_two_faults_are_named_and_their_order_is_that_of_their_weight(index, rule):
    first, second = comb('outer', z=20.0, index=index), comb('inner', index=index)
    said = decide(Evidence.of(second, first, others=(second,)))
    assert (said.rule, said.faults) == (rule, ('outer', 'inner'))
    assert said.reasons[:2] == (str(first), str(second))


def test_a_doubtful_second_fault_that_is_much_weaker_leaves_the_first():
    weaker = comb('outer', z=6.0)
    said = decide(Evidence.of(INNER, weaker, others=(weaker,), speed_known=False))
    assert said.faults == ('inner',)
    assert 'give a measured speed' in said.reasons[-1]


def test_cage_does_not_lead_where_a_stronger_fault_is_off_its_harmonics():
    said = decide(Evidence.of(comb('outer', order=3.2), CAGE))
    assert said.faults == ('outer',)


def test_impacts_elsewhere_say_which_speed_and_which_bearings_would_fit():
    # 5 % above the outer race of the 6205 that hand-made evidence is about, at 25 Hz.
    said = decide(Evidence.of(elsewhere=comb('elsewhere', order=3.585 * 1.05, z=9.0)))
    assert 'a speed of 26.3 Hz (outer) would fit' in said.reasons[-1]
    # Impacts with sidebands of the shaft are of an inner race before they are of a ball.
    for sways, first in ((True, 'inner of 6205'), (False, 'ball of 60/28')):
        found = comb('elsewhere', order=5.41, z=9.0)
        said = decide(Evidence.of(elsewhere=found, elsewhere_has_shaft_sidebands=sways))
        assert f'in the catalogue {first}' in said.reasons[-1]
    # An axial load opens a contact angle that the catalogue does not know of.
    loaded = fault_orders(replace(find_bearing('6205'), contact_angle=np.radians(18.0)))
    for place in ('inner', 'outer', 'ball'):
        found = comb('elsewhere', order=loaded.impacts(place), z=9.0)
        said = decide(Evidence.of(elsewhere=found, elsewhere_has_shaft_sidebands=place == 'inner'))
        assert re.search('of 6205[, ]', said.reasons[-1]), said.reasons
    said = decide(Evidence.of(elsewhere=comb('elsewhere', order=1.05, z=9.0)))
    assert said.reasons[-1] == 'the shaft seems to turn at 26.25 Hz: check the speed'


@pytest.mark.parametrize(('z', 'index'), [(7.9, 2.0), (20.0, 0.59)])
def test_faint_impacts_elsewhere_are_no_suspicion(z, index):
    impacts = comb('elsewhere', order=3.7, z=z, index=index)
    assert decide(Evidence.of(elsewhere=impacts)).rule in (
        'faint_comb',
        'no_comb',
        'uncertain_health',
    )


@pytest.mark.parametrize(('order', 'said'), [(3.585, 0), (3.593, 0), (3.7, 1)])
def test_a_faint_comb_of_a_part_is_not_said_to_be_of_no_part(order, said):
    outer = comb('outer', order=3.585, z=10.5, index=0.2)
    heard = comb('elsewhere', order=order, z=10.7, index=0.2)
    reasons = decide(Evidence.of(outer, elsewhere=heard, impacts={'elsewhere': 1.2})).reasons
    assert sum('of no part of a 6205' in reason for reason in reasons) == said


def test_one_faint_place_or_two_that_may_be_chance_are_no_doubt():
    for second in (comb('outer', z=5.4, index=0.17), comb('outer', z=20.0, index=0.12)):
        said = decide(Evidence.of(comb('inner', z=6.3, index=0.17), second, turns=100.0))
        assert said.rule in ('faint_comb', 'no_comb', 'uncertain_health')
    # Four times as long a record shows half as much of noise.
    faint = comb('inner', z=6.3, index=0.07), comb('outer', z=6.0, index=0.07)
    assert decide(Evidence.of(*faint, turns=400.0)).rule == 'two_faint_places'
    # Rough races that ring low: the outer one's comb is in the bands of the variable compliance.
    rough = comb('inner', z=9.4, index=0.22), comb('outer', z=8.4, index=0.0)
    assert decide(Evidence.of(*rough, outer_index=0.3)).rule == 'two_faint_places'


def test_a_comb_without_effect_does_not_make_health_uncertain():
    """Variable compliance: a healthy bearing forces its housing at the outer race's order."""
    assert decide(Evidence.of(comb('outer', z=20.0, index=0.1))).result == 'healthy'


@pytest.mark.parametrize(
    ('high', 'first', 'likelier'),
    [
        (0.10, 'ball', 'the ball'),
        (0.19, 'ball', 'neither'),
        (0.21, 'cage', 'neither'),
        (0.40, 'cage', 'the cage'),
    ],
)
def test_of_ball_and_cage_the_likelier_comes_first(high, first, likelier):
    combs = (comb('ball', z=5.6, index=0.4), comb('outer', z=5.0, index=0.4), CAGE)
    said = decide(Evidence.of(*combs, cage_high_harmonics=high))
    assert (said.rule, said.result, said.faults[0]) == ('cage_ripple', 'ambiguous', first)
    assert f'{likelier} is likelier' in said.reasons[-1]


@pytest.mark.parametrize(
    ('high', 'ball_z', 'rule'),
    [(0.38, 5.4, 'cage_ripple'), (0.4, 5.4, 'cage_impacts'), (0.4, 5.6, 'cage_ripple')],
)
def test_a_cage_whose_turns_differ_needs_no_harmonic_at_the_outer_race(high, ball_z, rule):
    combs = (comb('ball', z=ball_z, index=0.4), comb('outer', z=4.0, index=0.4), CAGE)
    assert decide(Evidence.of(*combs, cage_high_harmonics=high)).rule == rule


@pytest.mark.parametrize(('high', 'rule'), [(0.09, 'ball_ripple'), (0.11, 'cage_ripple')])
def test_a_ball_is_named_only_where_the_cage_ripples_clearly(high, rule):
    combs = (RIPPLING_BALL, CAGE)
    assert decide(Evidence.of(*combs, cage_high_harmonics=high)).rule == rule


def test_a_faint_ball_beside_the_ripple_of_the_cage_is_not_named():
    """Of six simulated machines with such a comb four were sound."""
    faint = comb('ball', order=11 * 0.38, index=0.59)
    # Its narrow lines, of waves for instance, keep their phase as groups of impacts do.
    said = decide(Evidence.of(CAGE, faint, ball_passages=18.0))
    assert (said.rule, said.level) == ('cage_ripple', 'suspect')


def test_a_name_that_needs_an_unlikely_slip_is_no_alarm():
    steady = {'slip': 0.028, 'shaft_sideband_ratio': 0.1}
    said = decide(Evidence.of(comb('outer', **steady)))
    assert (said.result, said.level) == ('outer', 'suspect')
    assert 'slip of 2.8 %' in said.reasons[-1]
    sure = decide(Evidence.of(comb('outer', **steady | {'slip': 0.024})))
    assert (sure.result, sure.level) == ('outer', 'fault')
    assert said.confidence < sure.confidence
    # An inner race turns through the load: with a large slip and no sidebands it is doubted.
    assert decide(Evidence.of(comb('inner', **steady))).rule == 'slipping_race'


SLIPPING = [comb(place, slip=0.03, shaft_sideband_ratio=0.3) for place in ('inner', 'ball')]
SLIPPING_OUTER = comb('outer', slip=0.03, shaft_sideband_ratio=0.1)


@pytest.mark.parametrize(
    'evidence',
    [
        Evidence.of(INNER, SLIPPING_OUTER, others=(SLIPPING_OUTER,)),
        Evidence.of(SLIPPING[0], SLIPPING_OUTER, others=(SLIPPING_OUTER,), speed_known=False),
        Evidence.of(
            comb('inner', z=3.0, slip=0.0),
            comb('outer', z=12.0, slip=0.03, order=3.93, shaft_sideband_ratio=0.8),
            **SIDEBAND,
        ),
        Evidence.of(
            *SLIPPING, claims=Claims((SLIPPING[0],), ((SLIPPING[0], SLIPPING[1]),)),
        ),
        Evidence.of(comb('cage', z=20.0, index=3.0, slip=0.03), comb('outer', order=8 * 0.38)),
        Evidence.of(CAGE, comb('ball', order=11 * 0.38, slip=0.03)),
        Evidence.of(masked_candidates=(comb('ball', order=4.001, slip=0.03),)),
    ],
    ids=['second', 'uncertain_second', 'load_zone', 'contested', 'cage', 'ripple', 'masked'],
)  # fmt: skip
def test_whatever_names_a_place_at_an_unlikely_slip_is_no_alarm_and_not_sure(evidence):
    said = decide(evidence)
    assert said.level == 'suspect'
    assert said.confidence <= DOUBTED
    assert 'slip of 3.0 %: no alarm' in said.reasons[-1]


def test_of_two_possible_places_one_at_a_likely_slip_is_enough():
    likely, other = comb('outer', shaft_sideband_ratio=0.1), comb('ball', slip=0.03)
    said = decide(Evidence.of(likely, claims=Claims((likely,), ((likely, other),))))
    assert (said.rule, said.level) == ('contested_comb', 'fault')
    # Two that explain each other's lines show alike, so that the inputs are doubtful.
    said = decide(Evidence.of(OUTER, other, explained={('ball', 'outer'), ('outer', 'ball')}))
    assert (said.rule, said.faults, said.level) == ('same_lines', ('outer', 'ball'), 'suspect')


def test_a_ball_needs_higher_sidebands_of_the_cage_than_of_the_shaft():
    said = decide(Evidence.of(BALL, cage_sideband_ratio=0.4, turning_sideband_ratio=0.5))
    assert said.rule == 'ball_without_cage_sidebands'
    # In a short window neither is the higher one within 3 dB.
    short = {'cage_sideband_ratio': 0.4, 'turns': 30.0}
    assert decide(Evidence.of(BALL, **short, turning_sideband_ratio=0.5)).result == 'ball'
    said = decide(Evidence.of(BALL, **short, turning_sideband_ratio=0.6))
    assert said.rule == 'ball_without_cage_sidebands'
    assert decide(Evidence.of(BALL, cage_sideband_ratio=0.4)).result == 'ball'


def test_groups_of_a_ball_are_an_alarm_only_where_more_strikes_than_a_load_modulates():
    assert decide(Evidence.of(ball_passages=5.0)).result == 'healthy'
    said = decide(Evidence.of(ball_passages=5.0, kurtosis=6.0))
    assert (said.result, said.level) == ('ball', 'fault')
    assert decide(Evidence.of(ball_passages=3.9, kurtosis=6.0)).rule == 'bursts'
    assert decide(Evidence.of(CAGE, ball_passages=3.9)).rule == 'cage_ripple'
    # Another bearing's race has a kurtosis as well, and lines near the ball's harmonics.
    struck = comb('elsewhere', order=5.116, z=32.0, index=2.4)
    said = decide(Evidence.of(ball_passages=10.0, kurtosis=9.4, elsewhere=struck))
    assert said.rule == 'impacts_elsewhere'
    assert decide(Evidence.of(INNER, ball_passages=5.0)).result == 'inner'
    # A cage that strikes shows at all its harmonics, those near the ball's order among them.
    assert decide(Evidence.of(*CAGE_IMPACTS, ball_passages=5.0)).result == 'cage'


def test_a_second_look_counts_only_where_nothing_else_is_significant():
    again = comb('inner', z=6.0)
    doubtful = comb('inner', z=5.2)
    seen = Evidence.of(doubtful, on_second_look=(again,), claims=Claims((again,)))
    assert decide(seen).faults == ('inner',)
    seen = Evidence.of(doubtful, OUTER, on_second_look=(again,), claims=Claims((OUTER,)))
    assert decide(seen).faults == ('outer',)


@pytest.mark.parametrize(
    ('ratio', 'places'),
    [(0.0, ('ball', 'cage')), (0.4, ('outer', 'ball', 'cage')), (0.9, ('ball', 'cage', 'outer'))],
)
def test_cage_sidebands_that_passing_balls_make_leave_the_outer_race_open(ratio, places):
    seen = Evidence.of(OUTER, cage_sideband_order=0.38, passing_balls_ratio=ratio)
    assert decide(seen).faults == places


def test_lines_of_a_loose_shaft_are_no_alarm():
    of_shaft = {'fits_shaft': frozenset({'outer'})}
    doubtful = (
        Evidence.of(INNER_SIDEBAND, **SIDEBAND, **of_shaft),
        Evidence.of(OUTER, whole_turns=3, **of_shaft),
    )
    assert [decide(seen).level for seen in doubtful] == ['suspect', 'suspect']


def test_a_quantity_is_computed_once():
    class Counted:
        asked, harmonics, sidebands = 0, None, None

        def best(self, place):
            self.asked += 1
            return comb(place, z=0.0)

    combs = Counted()
    evidence = Evidence(combs, 200.0)
    assert decide(Evidence.of(turns=200.0)).rule == 'no_comb'
    assert evidence.candidates is evidence.candidates
    assert combs.asked == 4


def test_an_unknown_quantity_is_refused():
    with pytest.raises(TypeError, match='no such quantity: shocks'):
        Evidence.of(INNER, shocks=3)


def test_what_has_sidebands_of_its_own_place_is_no_blade():
    assert decide(Evidence.of(INNER, smooth=True)).rule == 'fault'
    assert decide(Evidence.of(BALL, smooth=True)).rule == 'fault'
    # Nor does an outer race need whole or half turns; off them no blade or lobe passes.
    still = comb('outer', shaft_sideband_ratio=0.1)
    assert decide(Evidence.of(still, smooth=True)).rule == 'fault'
    assert decide(Evidence.of(still, smooth=True, half_turn=True)).rule == 'smooth'
    swaying = comb('outer', shaft_sideband_ratio=0.35)
    assert decide(Evidence.of(swaying, smooth=True)).rule == 'smooth'
    # 1 + cos has an index of 1.37: what modulates more is not smooth, wherever it lies.
    wide = comb('outer', index=1.4)
    assert decide(Evidence.of(wide, smooth=True, half_turn=True)).rule == 'fault'


def test_a_second_place_does_not_take_the_alarm_of_the_first_away():
    """At a nameplate speed the second is not sure; that one of the two is damaged is."""
    outer, inner = comb('outer', z=20.4, index=0.49), comb('inner', z=9.3, index=0.63)
    said = decide(Evidence.of(outer, inner, others=(inner,), speed_known=False))
    assert (said.rule, said.result, said.level) == ('uncertain_second', 'ambiguous', 'fault')
    assert said.faults == ('outer', 'inner')
    faint = comb('inner', z=9.3, index=0.4)
    assert decide(Evidence.of(outer, faint, others=(faint,), speed_known=False)).level == 'suspect'


def test_healthy_says_which_comb_it_heard():
    said = decide(Evidence.of(comb('outer', z=8.3, index=0.18)))
    assert said.result == 'healthy'
    assert 'significance 8.3' in said.reasons[-1]
    assert 'too weak' in said.reasons[-1]
    assert len(decide(Evidence.of()).reasons) == 1
    # And which impacts of no part of the bearing; a smooth swell is none.
    struck = Evidence.of(elsewhere=comb('elsewhere', order=3.76, z=9.6, index=0.3))
    assert decide(struck).result == 'healthy'
    assert 'impacts at 3.760 orders' in decide(struck).reasons[-1]
    swell = Evidence.of(elsewhere=struck.elsewhere, impacts={'elsewhere': 0.9})
    assert len(decide(swell).reasons) == 1
    # So does a window that is too short to say it.
    short = decide(Evidence.of(comb('outer', z=9.1, index=0.18), turns=33.0))
    assert short.rule == 'few_shaft_turns'
    assert 'significance 9.1' in short.reasons[0]


def test_an_outer_race_that_rings_low_needs_the_harmonics_of_impacts():
    outer = comb('outer', z=15.0, index=0.0)
    smooth = Evidence.of(outer, outer_index=0.8, impacts={'outer': 0.5, 'elsewhere': 0.0})
    assert decide(smooth).rule not in ('low_bands', 'impacts_elsewhere')


def test_a_smooth_modulation_elsewhere_is_no_impact():
    """Noise that swells with a belt has a first harmonic only."""
    swell = comb('elsewhere', order=3.7, z=15.0, index=0.9)
    assert decide(Evidence.of(elsewhere=swell)).rule == 'impacts_elsewhere'
    said = decide(Evidence.of(elsewhere=swell, impacts={'elsewhere': 0.9}))
    assert said.rule in ('faint_comb', 'no_comb', 'uncertain_health')


def test_turns_of_several_windows_do_not_resolve_the_cage():
    """Eight windows of one second: eighty turns of the cage, ten in each."""
    assert decide(Evidence.of(*CAGE_IMPACTS, turns=200.0)).rule == 'cage_impacts'
    assert decide(Evidence.of(*CAGE_IMPACTS, turns=200.0, step=0.04)).rule == 'few_cage_turns'


def test_the_outer_races_own_comb_takes_no_ball_away():
    """Below ``CARRIER`` the outer race's comb is the highest: it is the bearing's all the same."""
    outer = Candidate('outer', order=3.557, slip=0.006, z=26.0, index=0.28)
    ball = Candidate('ball', order=4.651, slip=0.006, z=21.6, index=1.99)
    impacts = Candidate('elsewhere', order=3.557, slip=0.0, z=26.0, index=1.2)
    evidence = Evidence.of(outer, ball, elsewhere=impacts)
    assert evidence.leading is ball
    # Computed anew, where ``of`` takes it as undisturbed.
    assert not Evidence.__dict__['elsewhere_explains'].func(evidence)
