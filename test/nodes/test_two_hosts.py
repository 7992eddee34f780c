# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Twin on one host, diagnosis and recorder on another, and the cable between them pulled.

The hosts are network namespaces joined by a bridge in a third one, so that pulling a port of the
bridge is what pulling the cable of a machine is: no carrier, addresses stay.
"""

from itertools import pairwise
import os
import shutil
import subprocess
import time

import pytest

pytest.importorskip('rclpy')

from bearing_twin.recording.reader import read_messages
from bearing_twin.ros.processes.launching import NodeProcesses

pytestmark = pytest.mark.ros

CUT = 5.0


def ip(*words, check=True):
    return subprocess.run(['ip', *words], check=check, capture_output=True, text=True)


@pytest.fixture
def hosts():
    """Return the names of two hosts and a function that pulls or plugs the cable of the first."""
    if shutil.which('ip') is None:
        pytest.skip('no ip command (Debian package iproute2)')
    if os.geteuid() != 0:
        pytest.skip('network namespaces need root')
    tag = f'bt{os.getpid()}'
    switch, *pair = (f'{tag}_{name}' for name in ('switch', 'a', 'b'))
    try:
        made = ip('netns', 'add', switch, check=False)
        if made.returncode:
            pytest.skip(f'no network namespaces here: {made.stderr.strip()}')
        ip('-n', switch, 'link', 'add', 'bridge0', 'type', 'bridge')
        ip('-n', switch, 'link', 'set', 'bridge0', 'up')
        for number, host in enumerate(pair, 1):
            port = f'port{number}'
            ip('netns', 'add', host)
            ip('-n', switch, 'link', 'add', port, 'type', 'veth', 'peer', 'eth0', 'netns', host)
            ip('-n', switch, 'link', 'set', port, 'master', 'bridge0', 'up')
            ip('-n', host, 'addr', 'add', f'10.77.0.{number}/24', 'dev', 'eth0')
            ip('-n', host, 'link', 'set', 'eth0', 'up')
            ip('-n', host, 'link', 'set', 'lo', 'up')
            ip('-n', host, 'route', 'add', '224.0.0.0/4', 'dev', 'eth0')
        yield *pair, lambda state: ip('-n', switch, 'link', 'set', 'port1', state)
    finally:
        for name in (switch, *pair):
            ip('netns', 'del', name, check=False)


def wait_for_growth(folder, nodes, by):
    """Wait until the recording has grown by some bytes."""
    end = time.monotonic() + 120.0
    start = None
    while True:
        size = sum(path.stat().st_size for path in folder.glob('*.mcap'))
        start = size if start is None else start
        if size > start + by:
            return
        nodes.check()
        assert time.monotonic() < end, f'the recording stays at {size} bytes'
        time.sleep(0.1)


def test_a_pulled_cable_costs_the_samples_of_that_time_and_nothing_else(
    ros_domain, hosts, tmp_path, monkeypatch
):
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'SUBNET')
    # Two machines share no memory; for the rest this is what the nodes set themselves.
    monkeypatch.setenv('FASTDDS_BUILTIN_TRANSPORTS', 'UDPv4?non_blocking=true')
    far, near, cable = hosts
    bag = tmp_path / 'bag'
    with NodeProcesses(tmp_path / 'logs', os.environ) as nodes:
        for node, parameters in (('recorder', {'output': str(bag)}), ('diagnosis', {})):
            nodes.start(node, parameters, within=('ip', 'netns', 'exec', near))
        nodes.start('twin', {'defect': 'inner'}, within=('ip', 'netns', 'exec', far))
        wait_for_growth(bag, nodes, 600_000)
        down = time.time()
        cable('down')
        time.sleep(CUT)
        cable('up')
        up = time.time()
        cut = up - down
        wait_for_growth(bag, nodes, 3_000_000)
        for node in ('twin', 'diagnosis', 'recorder'):
            assert nodes.end(node) == 0

    blocks, stamps, verdicts, states, inputs = [], {}, [], [], []
    for message in read_messages(bag):
        if message.topic == '/vibration':
            block = message.decode()
            blocks.append(block.first_sample // 1024)
            stamps[blocks[-1]] = block.header.stamp.sec + block.header.stamp.nanosec * 1e-9
        elif message.topic == '/diagnosis':
            verdicts.append(message.decode())
        elif message.topic == '/twin_state':
            states.append(message.decode())
        elif message.topic == '/diagnostics':
            inputs += [
                {item.key: item.value for item in status.values} | {'message': status.message}
                for status in message.decode().status
                if status.name == 'diagnosis: vibration input'
            ]
    # The twin was not held up: a socket that blocks would cost it the blocks of the cut, and more.
    # A machine that is busy with something else may cost some, which it counts.
    given_up = states[-1].blocks_dropped
    assert states[-1].blocks_published + given_up == states[-1].first_sample // 1024 + 1
    assert given_up * 0.04 < 0.9 * cut
    # In order, and no more is missing than the cut explains; the last blocks were sent again.
    assert all(a < b for a, b in pairwise(blocks))
    missing = [(a, b) for a, b in pairwise(blocks) if b != a + 1]
    gaps = [(a, b) for a, b in missing if stamps[b] > down and stamps[a] < up]
    lost, elsewhere = (sum(b - a - 1 for a, b in g) for g in (gaps, set(missing) - set(gaps)))
    assert elsewhere <= given_up
    assert 0 < (lost - given_up) * 0.04 <= cut + 1.0
    assert (gaps[-1][1] - gaps[0][0] - given_up) * 0.04 <= cut + 4.0
    assert blocks[-1] > gaps[-1][1] + 50
    # The diagnosis said so while it lasted, counted what is missing, and came back by itself.
    assert any('no vibration for' in status['message'] for status in inputs)
    assert int(inputs[-1]['samples_lost']) >= 1024
    assert inputs[-1]['source_restarts'] == '0'
    first, last = gaps[0][0] * 1024, gaps[-1][1] * 1024
    assert verdicts[-1].first_sample > first
    assert not [
        v for v in verdicts if v.first_sample < first and v.first_sample + v.sample_count > last
    ]
