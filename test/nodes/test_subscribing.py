# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Bytes that are no message, before Fast CDR sees them."""

from bearing_twin.errors import BearingTwinError
import pytest

pytest.importorskip('rclpy')

from bearing_twin.ros.topics.subscribing import read_message
from bearing_twin_msgs.msg import Vibration
from rclpy.serialization import serialize_message


@pytest.mark.parametrize('order', [0, 1])
@pytest.mark.parametrize('padding', [0, 1, 2, 3, 255])
@pytest.mark.parametrize('length', [0, 1, 2, 3])
def test_shorter_than_its_own_padding(order, padding, length):
    with pytest.raises(BearingTwinError, match='bytes are no Vibration'):
        read_message(bytes([0, order, 0, padding]) + bytes(length), Vibration)


@pytest.mark.parametrize('cdr', [b'', b'\x00', b'\x00\x01\x00', b'\xff' * 64])
def test_no_message_at_all(cdr):
    with pytest.raises(BearingTwinError, match=f'{len(cdr)} bytes are no Vibration'):
        read_message(cdr, Vibration)


def test_a_message_comes_as_it_was_sent():
    message = Vibration(sample_rate=25600.0, first_sample=7, y=[1.0, 2.0, 3.0])
    assert read_message(serialize_message(message), Vibration) == message
