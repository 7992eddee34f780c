# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Settings of Fast DDS."""

import os
from pathlib import Path
import tempfile
from xml.etree import ElementTree

import pytest

pytest.importorskip('rclpy')

from bearing_twin.ros.processes.fastdds import fast_dds_settings, OLDER, PROFILES
from bearing_twin.ros.processes.fastdds import profiles as made_profiles
from bearing_twin.ros.topics.qos import HELD

ROOT = Path(__file__).resolve().parents[2]
DDS = '{http://www.eprosima.com}'


@pytest.fixture(
    params=[
        *((fleet, older) for fleet in (False, True) for older in (False, True)),
        'config/fastdds_localhost.xml',
        'config/fastdds2_localhost.xml',
    ]
)
def profiles(request):
    if isinstance(request.param, str):
        return ElementTree.parse(ROOT / request.param).getroot()
    fleet, older = request.param
    root = ElementTree.fromstring(made_profiles(fleet=fleet, older=older))
    assert (root.find(f'.//{DDS}segment_size') is not None) == fleet
    assert (root.find(f'.//{DDS}heartbeatPeriod') is not None) == older
    return root


def seconds(period):
    return float(period.findtext(f'{DDS}sec')) + 1e-9 * float(period.findtext(f'{DDS}nanosec'))


def test_a_reader_is_asked_what_it_lacks_while_that_is_held(profiles):
    *wait, period = map(seconds, profiles.find(f'.//{DDS}data_writer').find(f'{DDS}times'))
    # One heartbeat may be lost as well.
    assert 0.0 < sum(wait) + 2.0 * period < HELD


def test_a_node_announces_itself_while_the_first_blocks_are_held(profiles):
    period = profiles.find(f'.//{DDS}participant//{DDS}leaseAnnouncement')
    assert 0.0 < seconds(period) < HELD


def test_a_node_starts_where_the_settings_cannot_be_written(monkeypatch, capsys, tmp_path):
    # So that what the settings change is undone.
    monkeypatch.setattr(os, 'environ', {k: v for k, v in os.environ.items() if k not in PROFILES})
    with fast_dds_settings(fleet=True):
        file = Path(os.environ[PROFILES[OLDER]])
        assert 'large_memory' in file.read_text()
    assert not file.exists()
    monkeypatch.setattr(tempfile, 'tempdir', str(tmp_path / 'missing'))
    with fast_dds_settings(fleet=True):
        assert PROFILES[OLDER] not in os.environ
    assert 'free or name a TMPDIR' in capsys.readouterr().err
