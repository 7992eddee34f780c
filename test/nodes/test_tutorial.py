# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The tutorial's commands, read from its page, do what it says."""

import contextlib
import os
from pathlib import Path
import re
import shlex
import shutil
import signal
import subprocess
import sys

import numpy as np
import pytest
from scipy.io import savemat

pytestmark = pytest.mark.ros

PAGE = Path(__file__).resolve().parents[2] / 'docs' / 'tutorial.md'


def section(number):
    """Return a section of the page."""
    text = PAGE.read_text(encoding='utf-8')
    return re.split(r'(?m)^## \d+\. ', text)[number]


def commands(text):
    """Return the commands of a section: what is indented, continued lines joined."""
    prose = re.sub(r'(?ms)^```.*?^```', '', text)
    lines = re.findall(r'(?m)^ {4}(\S(?:\\\n|.)*)', prose)
    return [line.replace('\\\n', ' ') for line in lines]


def save_files(text, folder):
    """Save each block of the section under the name that the page gives it."""
    for name, block in re.findall(r'(?s)[Ss]ave as\s`(\S+)`.*?```\w+\n(.*?)```', text):
        (folder / name).write_text(block)


def words_of(command):
    """Return a command as it is run here; ROS 2's own where there is no ``ros2``."""
    words = shlex.split(command)
    if words[:3] == ['ros2', 'run', 'bearing_twin'] and shutil.which('ros2') is None:
        words = ['bearing-twin', 'run', *words[3:]]
    if words[0] == 'bearing-twin':
        words = [sys.executable, '-m', 'bearing_twin', *words[1:]]
    return [sys.executable if word == 'python3' else word for word in words]


@pytest.fixture
def terminals(tmp_path):
    """Start commands as one does in terminals of their own; return what they printed."""
    running = {}

    def start(command):
        log = tmp_path / f'{len(running)}.log'
        with log.open('wb') as out:
            running[command] = subprocess.Popen(
                words_of(command),
                cwd=tmp_path,
                stdout=out,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        return log

    start.running = running
    yield start
    for process in running.values():
        interrupt(process)
    assert [process.wait(120) for process in running.values()] == [0] * len(running)


def interrupt(process):
    """Press Ctrl-C in a terminal: ``ros2 run`` counts on it to reach the node as well."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGINT)


def finish(command, folder):
    """Run a command that ends by itself; return what it prints."""
    ran = subprocess.run(
        words_of(command), cwd=folder, capture_output=True, text=True, timeout=300, check=False
    )
    assert ran.returncode == 0, f'{command}\n{ran.stdout}{ran.stderr}'
    return ran.stdout


def until(probe, text, log):
    probe.until(lambda: text in log.read_text(), f'{text!r} from {log.read_text()}')


def test_a_measured_bearing_from_the_file_to_the_alarm(probe, terminals, tmp_path, data_dir):
    from bearing_twin_msgs.msg import Calibration, Diagnosis

    probe.watch_diagnostics()
    record = np.load(data_dir / 'cwru' / 'cwru_0105_DE.npz')
    # The file that the page downloads, with the names that it has.
    signal_ = record['x'][:, None].astype(float)
    savemat(tmp_path / '105.mat', {'X105_DE_time': signal_, 'X105RPM': [[record['rpm']]]})
    download, diagnose = commands(section(1))
    assert download.split()[-1].endswith('/105.mat')
    assert 'inner' in finish(diagnose, tmp_path)

    verdicts = probe.collect(Diagnosis, '/fan_7/diagnosis')
    alarms = section(6)
    for text in (section(2), alarms):
        save_files(text, tmp_path)
    *live, echo = commands(section(2))
    assert [words.split()[0] for words in live] == ['ros2', 'ros2', 'bearing-twin']
    alarm = terminals(next(c for c in commands(alarms) if c.startswith('python3')))
    for command in live:
        terminals(command)
    until(probe, 'ALARM BEARING_INNER_RACE', alarm)
    found = probe.until(lambda: named(verdicts)[3:], 'more verdicts')
    assert found[-1].fault_hz == pytest.approx(161.7, abs=0.2)
    if shutil.which('ros2'):
        assert 'inner' in finish(echo, tmp_path)

    states = probe.collect(*twin_state('/fan_7/twin_state'))
    twin = next(c for c in commands(section(5)) if c.startswith('ros2 run'))
    terminals(twin)
    heat(probe, '/fan/bearing_temperature', 60.0, states)
    fitted = probe.collect(Calibration, '/fan_7/calibration')
    terminals(next(c for c in commands(section(5)) if ' calibration ' in c))
    said = probe.until(lambda: [m for m in fitted if m.defect == 'inner'], 'a calibration')
    # The pit is passed in one to two samples: its width is not identifiable, but below the limit.
    width = said[0].quantity.index('defect_width_mm')
    assert not said[0].identifiable[width] and said[0].q95[width] > 0.18
    probe.until(
        lambda: any(
            name.endswith('twin: calibration') and 'distance_db' in values
            for name, (_, _, values) in probe.statuses.items()
        ),
        'how alike twin and machine are',
    )
    assert all(process.poll() is None for process in terminals.running.values())
    # Where the machine is too busy for all blocks, a verdict may be insufficient.
    assert {verdict.result_name for verdict in named(verdicts)} == {'inner'}


@pytest.mark.proof
def test_the_nodes_one_by_one_and_their_recording(probe, terminals, tmp_path):
    listed = commands(section(4))
    from bearing_twin_msgs.msg import Diagnosis
    from std_srvs.srv import Trigger

    states = probe.collect(*twin_state('/twin_state'))
    verdicts = probe.collect(Diagnosis, '/diagnosis')
    probe.watch_diagnostics()
    nodes = [c for c in listed if c.startswith('ros2 run')]
    for command in nodes:
        # The port of the page may be in use on this machine.
        terminals(command.replace('rerun_port:=9876', 'rerun_port:=0'))
    probe.until(
        lambda: int(probe.status('recorder: recording')[2].get('messages_written', 0)) > 200,
        'the recording of all three, whichever came up first',
    )
    # What is compared at the end begins with the checkpoints of a reset.
    for node in ('twin', 'diagnosis'):
        assert probe.call(Trigger, f'/{node}/reset').success
    del verdicts[:]
    probe.until(lambda: named(verdicts), 'a verdict')
    heat(probe, '/temperature', 80.0, states)
    for command in listed if shutil.which('ros2') else ():
        if re.match(r'ros2 (topic|param|service)', command) and 'jitter' not in command:
            finish(command, tmp_path)
    for process in terminals.running.values():
        interrupt(process)
        assert process.wait(120) == 0
    reads = [c for c in listed if re.match(r'bearing-twin (info|report|verify)', c)]
    assert len(reads) == 3
    for command in reads:
        finish(command, tmp_path)


def named(verdicts):
    """Return the verdicts that name a fault."""
    return [verdict for verdict in verdicts if verdict.faults]


def twin_state(topic):
    from bearing_twin_msgs.msg import TwinState

    return TwinState, topic


def heat(probe, topic, value, states):
    """Publish what the page publishes by ``ros2 topic pub``, until the twin has taken it."""
    from sensor_msgs.msg import Temperature

    def tell():
        # The first subscriber that is found may be the recorder, and the twin a moment later.
        message = Temperature(temperature=value)
        message.header.stamp = probe.node.get_clock().now().to_msg()
        probe.publish(topic, message)

    probe.until(lambda: states and states[-1].temperature_used == value, 'the heat', every=tell)
