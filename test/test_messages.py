# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a verdict and a block become on the wire."""

from dataclasses import replace
import doctest
import math

from bearing_twin.bearing import find_bearing, PLACES
from bearing_twin.diagnosis.machine.held import Pace
from bearing_twin.diagnosis.machine.trend import Source, Trend
from bearing_twin.diagnosis.result import insufficient
from bearing_twin.dynamics.single.condition import Condition
from bearing_twin.recording import topics
from bearing_twin.streams.vibration_input import SOURCE_MEASURED, SOURCE_SIMULATED, SOURCE_UNKNOWN
import pytest

pytest.importorskip('bearing_twin_msgs', reason='the message package is not built')
messages = pytest.importorskip('bearing_twin.assets.messages')
TwinState = pytest.importorskip('bearing_twin_msgs.msg').TwinState

SOURCE = Source('imu y', '6307', 'm/s^2', 25600.0)


NOT_PUBLISHED = {'thermal_clearance', 'warnings'}


def test_a_twin_publishes_its_whole_condition():
    published = TwinState.get_fields_and_field_types().keys()
    missing = set(Condition._fields) - published - NOT_PUBLISHED
    assert not missing, 'not in TwinState.msg, or messages of before: make setup'


def verdict(result, level, *, place='', score=8.0):
    """Return what one window says alone."""
    nothing = insufficient([], find_bearing('6307'), sample_rate=25600.0)
    return replace(
        nothing,
        result=result,
        rule=f'a_rule_for_{result}',
        level=level,
        faults=(place,) if place else (),
        confidence=0.9,
        score={name: score if name == place else 2.0 + k for k, name in enumerate(PLACES)},
        modulation_index={
            name: 1.5 if name == place else 0.1 * k for k, name in enumerate(PLACES)
        },
        severity=replace(nothing.severity, rms=1.0, band_rms=(1.0, 0.0, 0.0)),
    )


def said(trend, found):
    """Return the message about a window after those that the trend has seen."""
    held = trend.update(found, SOURCE, wanted=100, pace=Pace(), full=True)
    return messages.diagnosis_message(held, stamp=0, frame_id='', bearing='6307')


def test_the_answer_of_a_window_stays_visible_while_another_is_held():
    from bearing_twin_msgs.msg import Diagnosis

    trend = Trend()
    first = said(trend, verdict('healthy', 'ok'))
    assert (first.result, first.window_result) == (Diagnosis.HEALTHY, Diagnosis.HEALTHY)
    assert (first.level, first.window_level) == (Diagnosis.LEVEL_OK, Diagnosis.LEVEL_OK)
    second = said(trend, verdict('inner', 'fault', place='inner'))
    assert (second.result, second.level) == (Diagnosis.HEALTHY, Diagnosis.LEVEL_OK)
    assert (second.window_result, second.window_level) == (Diagnosis.INNER, Diagnosis.LEVEL_FAULT)
    # The held answer has its own rule; it is no fault, so it has no stage.
    assert (second.rule, second.stage) == ('a_rule_for_healthy', 0)


def test_levels_are_the_constants_of_the_message():
    from bearing_twin_msgs.msg import Diagnosis

    names = [name for name in vars(topics) if name.startswith('LEVEL_')]
    assert len(names) == 4
    assert all(getattr(topics, name) == getattr(Diagnosis, name) for name in names)


def test_before_a_full_window_only_its_own_level_is_known():
    from bearing_twin_msgs.msg import Diagnosis

    found = verdict('inner', 'fault', place='inner')
    cold = Trend().update(found, SOURCE, wanted=100, pace=Pace(), full=False)
    message = messages.diagnosis_message(cold, stamp=0, frame_id='', bearing='6307')
    assert (message.level, message.window_level) == (Diagnosis.LEVEL_NONE, Diagnosis.LEVEL_FAULT)


@pytest.mark.parametrize(('place', 'strongest'), [('inner', 'inner'), ('', 'cage')])
def test_the_strongest_family_is_the_one_named_or_that_of_the_highest_score(place, strongest):
    found = verdict('inner' if place else 'healthy', 'fault' if place else 'ok', place=place)
    message = said(Trend(), found)
    k = PLACES.index(strongest)
    assert message.strongest_score == message.score[k]
    assert message.strongest_modulation_index == pytest.approx(message.modulation_index[k])
    nothing = insufficient(['too short'], find_bearing('6307'))
    message = messages.diagnosis_message(nothing, stamp=0, frame_id='', bearing='6307')
    assert math.isnan(message.strongest_score)
    assert message.rule == 'record_gate'


def test_topics_of_figures_are_told_from_others():
    assert doctest.testmod(topics) == (0, 1)


def test_each_feature_is_a_field_of_the_verdict():
    message = said(Trend(), verdict('inner', 'fault', place='inner'))
    for name, feature in messages.features_messages(message).items():
        assert list(feature.data) == pytest.approx([float(getattr(message, name))], nan_ok=True)


def test_the_codes_of_a_source_are_those_of_the_message():
    from bearing_twin_msgs.msg import Vibration

    theirs = (Vibration.SOURCE_UNKNOWN, Vibration.SOURCE_MEASURED, Vibration.SOURCE_SIMULATED)
    assert theirs == (SOURCE_UNKNOWN, SOURCE_MEASURED, SOURCE_SIMULATED)
