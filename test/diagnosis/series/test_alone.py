# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Answers of single snapshots in the words of the page: no more than the snapshots say."""

from dataclasses import replace

from bearing_twin.bearing import find_bearing
from bearing_twin.diagnosis.result import insufficient
from bearing_twin.diagnosis.rules.table import RULES
from bearing_twin.diagnosis.series.alone import Answer, Answers
import numpy as np
import pytest

WHY = {rule.name: rule.why.rstrip('.') for rule in RULES}
TURNS = Answer('fault', rule='whole_turns', open_places='outer')
LINES = Answer('fault', rule='same_lines', open_places='inner or ball')
OK, SUSPECT = Answer('ok'), Answer('suspect', reason='a comb')
OUTER = Answer('fault', 'outer', reason='outer: comb')


def said(answer):
    """Return a diagnosis with the level and place of an answer."""
    faults = tuple(filter(None, [answer.open_places]))
    return replace(
        insufficient([], find_bearing('6203')), level=answer.level, faults=faults, reasons=()
    )


@pytest.mark.parametrize(
    ('newest', 'text'),
    [
        ([OK] * 9, '9 of the last 9 snapshots alone say ok'),
        (
            [OK] * 5 + [TURNS] * 4,
            '5 of the last 9 snapshots alone say ok, 4 fault; 4 of them are ambiguous '
            f'(outer: {WHY["whole_turns"]})',
        ),
        (
            [OK] * 6 + [SUSPECT] * 2 + [OUTER],
            '6 of the last 9 snapshots alone say ok, 2 suspect, 1 fault; the last fault: '
            'outer: comb',
        ),
        (
            [TURNS] * 5 + [LINES] * 4,
            '9 of the last 9 snapshots alone say fault; 5 of them are ambiguous '
            f'(outer: {WHY["whole_turns"]})',
        ),
        (
            [SUSPECT] * 8 + [LINES],
            '8 of the last 9 snapshots alone say suspect, 1 fault; 1 of them is ambiguous '
            f'(inner or ball: {WHY["same_lines"]})',
        ),
        (
            [SUSPECT] * 5 + [OUTER] * 4,
            '5 of the last 9 snapshots alone say suspect, 4 fault; the last suspect: a comb',
        ),
        ([SUSPECT] * 9, '9 of the last 9 snapshots alone say suspect; the last: a comb'),
        ([Answer('suspect')] * 9, '9 of the last 9 snapshots alone say suspect'),
        ([Answer('none')] * 9, '9 of the last 9 snapshots alone say nothing'),
        ([OUTER] * 5 + [TURNS] * 4, '5 of the last 9 snapshots alone say outer, fault'),
    ],
)
def test_page_says_no_more_than_the_snapshots(newest, text):
    assert str(Answers(newest)) == text
    assert str(Answers(newest[::-1])) == text


@pytest.mark.parametrize(
    'rule',
    [r for r in RULES if r.tells and r.answer in ('suspect', 'ambiguous')],
    ids=lambda rule: rule.name,
)
def test_most_answers_of_a_rule_with_a_next_step_give_it_to_the_series(rule):
    """Whether the rule suspects or leaves places open; half of the answers are too few."""
    name = rule.name
    found = replace(
        insufficient(['too short'], find_bearing('6203')), result=rule.answer, rule=name,
        level='suspect', faults=('outer',), reasons=('outer: comb',),
    )  # fmt: skip
    answers = Answers()
    for _ in range(5):
        answers.add(found)
    assert (answers.level, answers.place, answers.doubt) == ('suspect', '', name)
    open_place = f'ambiguous (outer: {WHY[name]})'
    assert str(answers).endswith(open_place if rule.answer == 'ambiguous' else 'outer: comb')
    answers.newest[2:] = [SUSPECT] * 2
    assert answers.doubt == ''


@pytest.mark.parametrize(
    ('share', 'answer', 'alarmed'),
    [
        (0.25, Answer('suspect'), (0, 1)),
        (0.25, Answer('fault'), (0, 1)),
        (0.8, Answer('suspect'), (20, 20)),
        (1.0, Answer('fault'), (20, 20)),
        # A comb of the bearing is no shock: 5 of 9 are an alarm.
        (0.6, Answer('suspect', open_places='outer'), (20, 20)),
    ],
)
def test_answers_that_name_no_part_count_by_how_many_there_are(share, answer, alarmed):
    """Shocks make a quarter of the snapshots of a sound machine suspect: 20 lives of 200."""
    rng, found = np.random.default_rng(0), 0
    for _ in range(20):
        answers, alarm = Answers(), False
        for _ in range(200):
            newest = answer if rng.random() < share else Answer('none')
            answers.add(said(newest), sound=not alarm)
            alarm |= answers.level in ('suspect', 'fault')
        found += alarm
    assert alarmed[0] <= found <= alarmed[1]


def test_disturbed_answers_become_usual_in_sound_snapshots_only():
    answers = Answers()
    for number in range(100):
        answers.add(said(Answer('suspect' if number % 3 == 0 else 'ok')))
    assert answers.usual == pytest.approx(21 / 62)
    # 12 are judged then.
    for count in range(1, 14):
        answers.add(said(Answer('fault')), sound=False)
        assert (answers.level == 'fault') == (count >= 11)
    assert answers.usual == pytest.approx(21 / 62)
    assert str(answers) == '9 of the last 9 snapshots alone say fault'
