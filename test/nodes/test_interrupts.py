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
import threading
import time
from typing import TYPE_CHECKING

from bearing_twin.cli import main
from bearing_twin.recording.reader import recording_info
from bearing_twin.ros.processes.launching import NodeProcesses
from commands import python
import pytest

if TYPE_CHECKING:
    import subprocess

    from probe import Probe

HOOK = """
import os, signal, sys

class Interrupt:
    def find_spec(self, name, path=None, target=None):
        if name == os.environ['INTERRUPT_AT']:
            os.kill(os.getpid(), signal.SIGINT)

signal.signal(signal.SIGINT, getattr(signal, os.environ['HANDLER']))
sys.meta_path.insert(0, Interrupt())
"""
"""Presses Ctrl-C where a module is about to be loaded."""

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


def interrupted(
    words: list[str], module: str, handler: str, folder: Path
) -> subprocess.CompletedProcess[str]:
    """Run Python with an interrupt where ``module`` is about to be loaded."""
    (folder / 'sitecustomize.py').write_text(HOOK)
    given = {'PYTHONPATH': str(folder), 'INTERRUPT_AT': module, 'HANDLER': handler}
    return python(*words, env={**os.environ, **given}, cwd=Path(__file__).parents[2])


@pytest.mark.parametrize(
    ('words', 'module', 'status'),
    [
        (['-m', 'bearing_twin', 'run', 'twin'], 'argparse', 0),
        (['-m', 'bearing_twin', 'run', 'twin'], 'bearing_twin.nodes', 0),
        (['-m', 'bearing_twin', 'run', 'twin'], 'numpy', 0),
        (['-m', 'bearing_twin', 'run', 'recorder'], 'rclpy', 0),
        (['-c', 'from bearing_twin.start import twin; twin()'], 'rclpy', 0),
        (['-m', 'bearing_twin', 'info', 'x.mcap'], 'argparse', 130),
        (['-m', 'bearing_twin', 'info', 'x.mcap'], 'mcap', 130),
    ],
)
def test_an_interrupt_while_libraries_load_prints_nothing(
    words: list[str], module: str, status: int, tmp_path: Path
) -> None:
    ran = interrupted(words, module, 'default_int_handler', tmp_path)
    assert (ran.returncode, ran.stdout, ran.stderr) == (status, '', '')


@pytest.mark.parametrize('module', ['argparse', 'bearing_twin.bearing.catalogue'])
def test_a_command_in_the_background_of_a_script_hears_no_interrupt(
    module: str, tmp_path: Path
) -> None:
    ran = interrupted(['-m', 'bearing_twin', 'bearings', '6205'], module, 'SIG_IGN', tmp_path)
    assert (ran.returncode, ran.stderr) == (0, '')
    assert '6205' in ran.stdout


def test_the_command_leaves_signals_to_its_caller() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        assert main(['bearings', '6205']) == 0
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)
    statuses: list[int] = []
    thread = threading.Thread(target=lambda: statuses.append(main(['bearings', '6205'])))
    thread.start()
    thread.join()
    assert statuses == [0]


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
