# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the network of a machine can reach of a node that is to be alone on it."""

from __future__ import annotations

import os
from pathlib import Path

from bearing_twin.recording.reader import recording_info
from bearing_twin.ros.processes.domain import server_port
from bearing_twin.ros.processes.fastdds import OLDER, PROFILES
from forked import ForkedNodes
import psutil
import pytest
from recorder_process import Source

pytestmark = pytest.mark.ros

PROFILE = 'fastdds2_localhost.xml' if OLDER else 'fastdds_localhost.xml'
EPHEMERAL = 32768
"""First port that Linux hands out by itself: sockets from which is sent."""


def test_with_the_profile_every_port_is_bound_to_this_machine(
    ros_domain: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(PROFILES[OLDER], str(Path(__file__).parents[2] / 'config' / PROFILE))
    port = server_port(ros_domain)
    with ForkedNodes(tmp_path / 'logs', os.environ) as nodes, Source() as source:
        nodes.start('recorder', {'output': str(tmp_path / 'bag'), 'rerun_port': port})
        source.wait_for_recorder()
        source.publish_for(1.0)
        source.settle()
        bound = {
            (socket.laddr.ip, socket.laddr.port)
            for socket in psutil.Process(nodes.pid('recorder')).net_connections()
            if socket.laddr and (socket.status == 'LISTEN' or socket.laddr.port < EPHEMERAL)
        }
        assert nodes.end('recorder') == 0
    assert ('127.0.0.1', port) in bound
    assert len(bound) > 2
    assert {address for address, _ in bound} == {'127.0.0.1'}
    assert recording_info(tmp_path / 'bag').topics['/vibration'].count == len(source.sent)
