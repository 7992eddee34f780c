# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What changes on /diagnostics is in the terminal too, once."""

import math
import re

import pytest

pytest.importorskip('rclpy')

from bearing_twin.assets.messages import time_message
from bearing_twin.stamps import NANO
from sensor_msgs.msg import Temperature

pytestmark = pytest.mark.ros

INPUT = 'twin: temperature input'


def test_trouble_with_the_temperature_is_logged_once_and_so_is_its_end(nodes, probe, tmp_path):
    nodes.start('twin', {'temperature_timeout': 3600.0})
    probe.watch_diagnostics()
    seconds = iter(range(1, 10**6))

    def expect(status, value):
        def send():
            message = Temperature(temperature=value)
            message.header.stamp = time_message(next(seconds) * NANO)
            probe.publish('temperature', message)

        probe.until(
            lambda: probe.statuses.get(INPUT, (0, '', {}))[2].get('status') == status,
            status,
            every=send,
        )

    expect('OK', 40.0)
    expect('INVALID', math.nan)
    probe.spin(2.5)
    expect('CLAMPED', 150.0)
    expect('OK', 40.0)
    assert probe.set_parameters('twin', temperature_timeout=0.1) == (True, '')
    probe.until(lambda: probe.statuses[INPUT][2]['status'] == 'STALE', 'silence')
    probe.spin(2.5)
    assert nodes.end('twin') == 0
    log = (tmp_path / 'logs' / 'twin.log').read_text()
    found = re.findall(r'\[(\w+)\].*temperature input: (.*) \(before, for (\d+) s: ', log)
    assert [(level, text.split(':')[0]) for level, text, _ in found] == [
        ('WARN', 'temperature is no number or impossible'),
        ('WARN', 'temperature is outside 20..110 degC'),
        ('INFO', 'temperature is fresh'),
        ('WARN', 'temperature is stale'),
    ]
    # What the second one ended.
    assert int(found[1][2]) >= 2
