# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Bytes from templates hold what messages hold, by rclpy's and by an independent reader."""

from itertools import pairwise
import math

import numpy as np
import pytest

pytest.importorskip('rclpy', reason='ROS 2 is not installed')

from bearing_twin.assets.message_template import MessageTemplate
from bearing_twin.assets.parameters.twin import SPECS
from bearing_twin.assets.twin import Twin
from bearing_twin.assets.twin_messages import (
    state_message,
    StateSchedule,
    TwinBytes,
    vibration_message,
)
from bearing_twin.dynamics.defect_text import read_defects
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcap.schema import canonical_cdr, message_schema
from bearing_twin.streams.pacer import Due
from bearing_twin_msgs.msg import Vibration
from rclpy.serialization import deserialize_message, serialize_message

REALTIME = {
    'blocks_published': 2**40 + 7,
    'blocks_late': 3,
    'blocks_dropped': 2,
    'lateness': 0.25,
    'execution_time': math.nan,
}
CHANGES = (
    {},
    {'defect': 'outer:angle=1.5+ball', 'frame_id': 'drive end, radial'},
    {'thermal_mode': 'physical', 'bearing': '6205'},
)


def canonical(cdr, message):
    kind = type(message)
    name = f'{kind.__module__.split(".")[0]}/msg/{kind.__name__}'
    return canonical_cdr(name, message_schema(name).text, cdr)


@pytest.mark.parametrize('block_size', [1, 1023, 1024])
def test_bytes_from_templates_are_those_of_the_messages(block_size):
    values = {spec.name: spec.default for spec in SPECS} | {'block_size': block_size}
    twin = Twin(values)
    made_bytes = TwinBytes(serialize_message)
    number = 0
    for changes in CHANGES:
        twin.apply(twin.values | changes)
        for stamp in (0, 1_795_339_838_999_999_999):
            number += 1
            due = Due(number * block_size, stamp, 0.0, number)
            made = twin.advance()
            expected = vibration_message(made, due, twin.values)
            cdr = made_bytes.vibration(made, due, twin.values)
            assert deserialize_message(cdr, type(expected)) == expected
            assert canonical(cdr, expected) == canonical(serialize_message(expected), expected)
            expected = state_message(made, due, twin.values)
            for name, value in REALTIME.items():
                setattr(expected, name, value)
            cdr = made_bytes.state(made, due, twin.values, REALTIME)
            assert canonical(cdr, expected) == canonical(serialize_message(expected), expected)


def test_the_state_says_where_a_turned_load_puts_the_defects():
    values = {spec.name: spec.default for spec in SPECS}
    twin = Twin(values | {'load_angle': 0.25, 'defect': 'outer+inner+cage:ball=2'})
    stated = state_message(twin.advance(), Due(0, 0, 0.0, 0), twin.values).defect
    assert stated == 'outer:angle=0.25+inner+cage:ball=2,angle=0.25'
    drawn = read_defects(stated, width=1e-3, depth=1e-5, profile='ball')
    assert [defect.angle for defect in drawn] == [0.25, 0.0, 0.25]


def test_a_number_that_is_not_in_the_bytes_as_it_should_is_refused():
    def swapped(message):
        cdr = bytes(serialize_message(message))
        return cdr[:4] + np.frombuffer(cdr[4:], np.uint32).byteswap().tobytes()

    with pytest.raises(BearingTwinError, match='occurs 0 times'):
        MessageTemplate(Vibration(), ('sample_rate',), (), swapped)


def test_an_array_of_another_length_is_refused():
    template = MessageTemplate(Vibration(x=[0.0] * 4), (), ('x',), serialize_message)
    cdr = template.fill((), np.ones(4, np.float32))
    assert deserialize_message(cdr, Vibration).x.tolist() == [1.0, 1.0, 1.0, 1.0]
    with pytest.raises(BearingTwinError, match=f'{len(cdr) - 4} bytes, but {len(cdr)} in'):
        template.fill((), np.ones(3, np.float32))


def test_the_state_has_its_turn_or_a_reason():
    blocks = [Due(k * 1024, 0, 0.0, k + 1) for k in range(50)]
    assert all(StateSchedule(0.0, 0.04).wants(due, 20.0) for due in blocks)
    turns = [StateSchedule(5.0, 0.04, turn) for turn in range(5)]
    chosen = [[k for k, due in enumerate(blocks) if each.wants(due, 20.0)] for each in turns]
    for each in chosen:
        assert each[0] == 0
        assert {b - a for a, b in pairwise(each[1:])} == {5}
    assert len({each[1] % 5 for each in chosen}) == 5
    one = StateSchedule(5.0, 0.04)
    seen = [k for k, due in enumerate(blocks) if one.wants(due, 20.0 + (k >= 7) + (k >= 8))]
    assert seen == [0, 4, 7, 8, 9, *range(14, 50, 5)]
    # 6.25 blocks a second: four of five have a state.
    fleet = StateSchedule(5.0, 0.16)
    assert sum(fleet.wants(due, 20.0) for due in blocks) == pytest.approx(40, abs=1)
