# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The launch files load and start what they say; needs an installed ROS 2."""

import contextlib
import importlib.util
import inspect
import os
from pathlib import Path
import re
import shutil
import signal
import subprocess
import time

from bearing_twin.assets.parameters.recorder import SPECS as RECORDER
from bearing_twin.assets.parameters.twin import SPECS as TWIN
from bearing_twin.cli import main
from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes.fleet import SPECS as FLEET
from bearing_twin.nodes.replay import SPECS as REPLAY
from bearing_twin.recording.reader import recording_info
from mcap.reader import make_reader
import pytest

launch = pytest.importorskip('launch', reason='launch is part of an installed ROS 2 only')
pytest.importorskip('launch_ros', reason='launch_ros is part of an installed ROS 2 only')

FOLDER = Path(__file__).resolve().parents[1] / 'launch'
PARAMETERS = {spec.name for specs in (FLEET, RECORDER, REPLAY, TWIN) for spec in specs}
NOT_PARAMETERS = {
    *('calibrate', 'joint_states', 'namespace', 'params_file', 'record', 'samples'),
    *('temperature', 'twin', 'use_sim_time'),
}

PREFIXES = [Path(prefix) for prefix in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)]
INSTALLED = shutil.which('ros2') and any(
    (prefix / 'lib' / 'bearing_twin' / 'twin').exists() for prefix in PREFIXES
)
STARTS = {
    'fleet': ({'rerun_port': 0, 'record': 'true', 'output': 'bag'}, '2 twins and 3 diagnoses'),
    'machine': ({'record': 'true', 'output': 'bag'}, 'listening to /line1/samples'),
    'replay': ({'rate': 2, 'loop': 'true', 'clock_rate': 10, 'start_offset': 1}, 'at pace 2'),
    'twin': (
        {
            **{'rerun_port': 0, 'shaft_hz': 20, 'bearing': 6205, 'defect': 'outer'},
            **{'output': 'bag', 'params_file': 'own.yaml'},
        },
        'twin of 6205, defect outer',
    ),
}
"""Arguments of each type, and what a node then says."""
OWN = """
/**:
  ros__parameters: {use_sim_time: false}
/**/twin:
  ros__parameters: {defect: none, bearing: '6307'}
"""
"""A parameter file over which arguments win."""


def described(path):
    spec = importlib.util.spec_from_file_location(path.name.split('.')[0], path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert inspect.getdoc(module)
    return module.generate_launch_description()


@pytest.mark.parametrize('path', sorted(FOLDER.glob('*.launch.py')), ids=lambda p: p.name)
def test_launch_file_describes_itself(path):
    arguments = described(path).get_launch_arguments()
    assert arguments
    for argument in arguments:
        assert argument.description, argument.name
        assert argument.name in PARAMETERS | NOT_PARAMETERS
        # As 'ros2 launch --show-args' prints it.
        default = ' + '.join(part.describe() for part in argument.default_value)
        assert ' object at 0x' not in default, argument.name


@pytest.mark.parametrize(
    ('name', 'recorded', 'alone'), [('fleet', '1', '0'), ('machine', '1', '0'), ('twin', '2', '1')]
)
def test_a_twin_waits_for_the_recorder_that_is_started_beside_it(name, recorded, alone):
    for record, wanted in (('true', recorded), ('false', alone)):
        context = launch.LaunchService(argv=[]).context
        context.launch_configurations['record'] = record
        for declared in described(FOLDER / f'{name}.launch.py').get_launch_arguments():
            declared.visit(context)
        assert context.launch_configurations['wait_for_subscribers'] == wanted


@pytest.mark.parametrize(
    ('name', 'arguments', 'said'),
    [
        ('twin', {'params_file': 'my_machine.yaml'}, 'params_file:=my_machine.yaml is no file'),
        ('twin', {'shaft_hz': 'fast'}, 'shaft_hz:=fast must be of type float'),
        ('twin', {'rerun_port': '98.5'}, 'rerun_port:=98.5 must be of type int'),
        ('fleet', {'record': 'maybe'}, 'record:=maybe must be of type bool'),
        ('twin', {'record': 'yes'}, 'record:=yes is not one of true, false, 1, 0'),
    ],
)
def test_arguments_that_cannot_be_used_are_refused(name, arguments, said):
    description = described(FOLDER / f'{name}.launch.py')
    service = launch.LaunchService(argv=[])
    context = service.context
    context.launch_configurations.update(arguments)
    for declared in description.get_launch_arguments():
        declared.visit(context)
    [start] = [a for a in description.entities if isinstance(a, launch.actions.OpaqueFunction)]
    with pytest.raises(BearingTwinError, match=said):
        start.visit(context)


def test_an_argument_that_is_misspelt_is_told(capfd):
    # The log of launch holds the stdout of the test that logged first.
    launch.logging.reset()
    description = described(FOLDER / 'twin.launch.py')
    typed = ['defct:=inner', 'params:=x.yaml', 'map_of_the_hall:=x.yaml']
    context = launch.LaunchService(argv=typed).context
    # 'params' is that of a launch file that includes this one; launch_ros keeps ros_namespace.
    context.launch_configurations.update({'ros_namespace': '/plant', 'shaft_hertz': '20'})
    for declared in description.get_launch_arguments():
        declared.visit(context)
    [start] = [a for a in description.entities if isinstance(a, launch.actions.OpaqueFunction)]
    start.visit(context)
    assert capfd.readouterr().out.splitlines() == [
        "[WARNING] [bearing_twin]: there is no argument 'defct'; is 'defect' meant?"
    ]


@pytest.mark.ros
@pytest.mark.skipif(not INSTALLED, reason='ros2 does not find this package')
@pytest.mark.parametrize('name', STARTS)
def test_launch_file_starts_its_nodes(name, ros_domain, tmp_path):
    arguments, said = STARTS[name]
    (tmp_path / 'own.yaml').write_text(OWN)
    given = [f'{key}:={value}' for key, value in arguments.items()]
    command = ['ros2', 'launch', str(FOLDER / f'{name}.launch.py'), 'namespace:=line1', *given]
    log = launched(command, tmp_path, lambda text: said in text)
    # Where the interpreter itself is still starting it ends by the signal (-2), and where the
    # libraries load, with the status of Ctrl-C.
    assert not re.search(r'process has died.*exit code (?!-2|130)', log)


@pytest.mark.ros
@pytest.mark.skipif(not INSTALLED, reason='ros2 does not find this package')
def test_a_replay_ends_by_itself_and_what_it_drove_is_reproduced(ros_domain, tmp_path):
    replay = ['ros2', 'launch', str(FOLDER / 'replay.launch.py'), 'rate:=8']

    def replayed(text):
        if 'twin of 6307' not in text:
            return False
        ran = subprocess.run(replay, cwd=tmp_path, capture_output=True, text=True, check=True)
        assert '100 %  401 messages' in ran.stdout
        return True

    twin = ['ros2', 'launch', str(FOLDER / 'twin.launch.py'), 'output:=bag', 'rerun_port:=0']
    launched(twin, tmp_path, replayed)
    assert recording_info(tmp_path / 'bag').topics['/temperature'].count == 401
    assert main(['verify', str(tmp_path / 'bag')]) == 0


@pytest.mark.ros
@pytest.mark.skipif(not INSTALLED, reason='ros2 does not find this package')
def test_what_dies_is_started_again_and_what_refuses_its_parameters_is_not(ros_domain, tmp_path):
    (tmp_path / 'own.yaml').write_text(
        '/**/adapter:\n  ros__parameters: {sample_rate: 25600.0}\n'
        '/**/diagnosis:\n  ros__parameters: {window: 0.01}\n'
    )
    command = ['ros2', 'launch', str(FOLDER / 'machine.launch.py'), 'params_file:=own.yaml']

    killed = []

    def kill_adapter(text):
        if not killed and 'listening to' in text and 'it is not started again' in text:
            killed.append(int(re.search(r'\[adapter-\d+\]: .* with pid \[(\d+)\]', text)[1]))
            os.kill(killed[0], signal.SIGKILL)
        return text.count('listening to') == 2

    log = launched([*command, 'twin:=false', 'record:=false'], tmp_path, kill_adapter)
    assert 'diagnosis: window=0.01 is outside 1..60 s' in log
    assert len(re.findall(r'\[diagnosis-\d+\]: process started', log)) == 1


@pytest.mark.ros
@pytest.mark.skipif(not INSTALLED, reason='ros2 does not find this package')
def test_two_machines_record_themselves_only_and_nodes_end_with_their_launch(ros_domain, tmp_path):
    machines = {}
    try:
        for name in ('a', 'b'):
            given = [f'namespace:=line1/{name}', f'output:=bag_{name}']
            command = ['ros2', 'launch', str(FOLDER / 'machine.launch.py'), *given]
            machines[name] = started(command, tmp_path, f'log_{name}')
        for name, (process, log) in machines.items():
            wait_for(process, log, lambda _, name=name: size(tmp_path / f'bag_{name}') > 300_000)
        (first, _), (second, said) = machines.values()
        # Ctrl-C reaches the nodes and launch, SIGTERM from a script or a container launch alone.
        os.killpg(first.pid, signal.SIGINT)
        second.terminate()
        assert (first.wait(120.0), second.wait(120.0)) == (0, -signal.SIGTERM)
        nodes = re.findall(r'process started with pid \[(\d+)\]', said.read_text())
        assert len(nodes) == 4
        deadline = time.monotonic() + 60.0
        while any(map(is_running, nodes)):
            assert time.monotonic() < deadline, said.read_text()
            time.sleep(0.2)
    finally:
        for process, _ in machines.values():
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
    for name, (_, log) in machines.items():
        assert 'process has died' not in log.read_text()
        assert (tmp_path / f'bag_{name}' / 'metadata.yaml').is_file()
        topics = recorded(tmp_path / f'bag_{name}')
        assert f'/line1/{name}/twin/vibration' in topics
        assert all(t.startswith(f'/line1/{name}/') for t in topics - {'/diagnostics'})


def size(bag):
    return sum(path.stat().st_size for path in bag.glob('*.mcap'))


def recorded(bag):
    """Topics of a bag."""
    [path] = bag.glob('*.mcap')
    with path.open('rb') as file:
        return {channel.topic for channel in make_reader(file).get_summary().channels.values()}


def is_running(pid):
    try:
        return Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()[0] != 'Z'
    except FileNotFoundError:
        return False


def started(command, folder, name='log'):
    """Start a launch in a session of its own; return it and its log."""
    log = folder / name
    with log.open('wb') as out:
        process = subprocess.Popen(
            command, stdout=out, stderr=subprocess.STDOUT, cwd=folder, start_new_session=True
        )
    return process, log


def wait_for(process, log, holds):
    """Wait until something holds for what is printed."""
    deadline = time.monotonic() + 120.0
    while not holds(log.read_text()):
        assert process.poll() is None and time.monotonic() < deadline, log.read_text()
        time.sleep(0.2)


def launched(command, folder, holds):
    """Launch until something holds for what is printed, end by Ctrl-C; return what it is."""
    process, log = started(command, folder)
    try:
        wait_for(process, log, holds)
    finally:
        # Ctrl-C reaches the whole group.
        os.killpg(process.pid, signal.SIGINT)
        process.wait(120.0)
    assert process.returncode == 0
    return log.read_text()
