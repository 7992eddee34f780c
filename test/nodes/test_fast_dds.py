# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Settings of Fast DDS."""

from pathlib import Path
from xml.etree import ElementTree

import pytest

pytest.importorskip('rclpy')

from bearing_twin.ros.topics.qos import HELD

ROOT = Path(__file__).resolve().parents[2]
DDS = '{http://www.eprosima.com}'


@pytest.mark.parametrize(
    'profiles',
    [
        'bearing_twin/ros/processes/fastdds.xml',
        'bearing_twin/ros/processes/fastdds2.xml',
        'config/fastdds_localhost.xml',
        'config/fastdds2_localhost.xml',
    ],
)
def test_a_reader_is_asked_what_it_lacks_while_that_is_held(profiles):
    writer = ElementTree.parse(ROOT / profiles).find(f'.//{DDS}data_writer')
    (period,) = writer.find(f'{DDS}times')
    seconds = float(period.findtext(f'{DDS}sec')) + 1e-9 * float(period.findtext(f'{DDS}nanosec'))
    # One heartbeat may be lost as well.
    assert 0.0 < 2.0 * seconds < HELD
