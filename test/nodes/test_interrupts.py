# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
A node that is told to end early ends in order; told more than once, it still finishes its work.

Who presses Ctrl-C twice does that, and 'ros2 launch' without a terminal too: the whole process
group gets the signal, and the launcher passes it on once more.
"""

from __future__ import annotations

import os
from pathlib import Path
import pty
import select
import signal
import sys
import time
from typing import TYPE_CHECKING

from bearing_twin.recording.reader import recording_info
from bearing_twin.ros.processes.launching import NodeProcesses
from commands import python
import pytest

if TYPE_CHECKING:
    from probe import Probe

SCHEDULE = Path(__file__).parents[2] / 'recordings' / 'paper_schedule.mcap'

PAUSES = (0.0, 0.001, 0.01, 0.05)
"""From the first interrupt to the second, s."""


@pytest.mark.ros
@pytest.mark.parametrize('pause', PAUSES)
def test_a_second_interrupt_leaves_no_torn_recording(
    pause: float, ros_domain: int, tmp_path: Path
) -> None:
    bag = tmp_path / 'bag'
    with NodeProcesses(tmp_path / 'logs', os.environ) as nodes:
        nodes.start('recorder', {'output': str(bag)})
        deadline = time.monotonic() + 120.0
        while b'recording to' not in (tmp_path / 'logs' / 'recorder.log').read_bytes():
            nodes.check()
            assert time.monotonic() < deadline
            time.sleep(0.1)
        pid = nodes.pid('recorder')
        os.kill(pid, signal.SIGINT)
        time.sleep(pause)
        assert nodes.end('recorder') == 0
    assert recording_info(bag).finished
    assert (bag / 'metadata.yaml').exists()


@pytest.mark.ros
@pytest.mark.parametrize('name', ['adapter', 'twin'])
def test_a_node_that_has_ended_is_known_no_longer(
    nodes: NodeProcesses, probe: Probe, name: str
) -> None:
    nodes.start(name, {'sample_rate': 25600.0})
    probe.until_active(name)
    assert nodes.end(name) == 0
    # The middleware forgets a node that is only killed after 20 s.
    known = probe.node.get_node_names
    probe.until(lambda: name not in known(), 'its leave', timeout=10.0)


@pytest.mark.ros
@pytest.mark.parametrize(
    ('name', 'parameters'),
    [
        ('twin', {'wait_for_subscribers': 1}),
        ('replay', {'recording': str(SCHEDULE), 'subscriber_timeout': 3600.0}),
    ],
)
def test_an_interrupt_while_a_node_waits_for_subscribers_prints_no_error(
    nodes: NodeProcesses, probe: Probe, tmp_path: Path, name: str, parameters: dict[str, object]
) -> None:
    nodes.start(name, parameters)
    # It publishes its topics, and waits.
    topic = {'twin': '/vibration', 'replay': '/temperature'}[name]
    probe.until(lambda: probe.node.count_publishers(topic), 'the node')
    probe.spin(0.5)
    assert nodes.end(name) == 0
    lines = (tmp_path / 'logs' / f'{name}.log').read_text().splitlines()
    assert [line for line in lines if not line.startswith('[INFO]')] == []


@pytest.mark.ros
def test_an_interrupt_while_a_node_is_built_prints_no_error(ros_domain: int) -> None:
    code = (
        'import os, signal, sys, time; import rclpy\n'
        'from bearing_twin.cli import main\n'
        'from bearing_twin.ros.processes import running\n'
        'build = running._build\n'
        'def interrupted(kind):\n'
        '    node = build(kind)\n'
        '    os.kill(os.getpid(), signal.SIGINT)\n'
        '    while rclpy.ok(): time.sleep(0.01)\n'
        '    return node\n'
        'running._build = interrupted\n'
        "sys.exit(main('run adapter --ros-args -p sample_rate:=25600.0'.split()))"
    )
    ran = python('-c', code, cwd=Path(__file__).parents[2])
    assert ran.stderr == ''
    assert ran.returncode == 0


@pytest.mark.ros
def test_a_closed_terminal_leaves_no_torn_recording(ros_domain: int, tmp_path: Path) -> None:
    bag = tmp_path / 'bag'
    words = ['-m', 'bearing_twin', 'run', 'recorder', '--ros-args', '-p', f'output:={bag}']
    pid, terminal = pty.fork()
    if not pid:
        # Under nohup the tests ignore the signal, and so would the node.
        signal.signal(signal.SIGHUP, signal.SIG_DFL)
        os.execv(sys.executable, [sys.executable, *words])
    process, said = os.pidfd_open(pid), b''
    try:
        while b'recording to' not in said:
            said += os.read(terminal, 4096)
        os.close(terminal)
        select.select([process], [], [], 120.0)
    finally:
        signal.pidfd_send_signal(process, signal.SIGKILL)
        status = os.waitpid(pid, 0)[1]
        os.close(process)
    assert os.waitstatus_to_exitcode(status) == 0
    assert recording_info(bag).finished


def test_missing_messages_are_a_sentence() -> None:
    """Where colcon has built the package and not the messages inside it."""
    code = (
        "import sys; sys.modules['bearing_twin_msgs'] = None; "
        'from bearing_twin.start import twin; sys.exit(twin())'
    )
    ran = python('-c', code, cwd=Path(__file__).parents[2])
    assert ran.returncode == 1
    assert ran.stderr.startswith('bearing-twin run: bearing_twin_msgs is not there: build it with')
    assert ran.stderr.count('\n') == 1
