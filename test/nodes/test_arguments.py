# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What is asked for is done or refused, never ignored."""

import os
from pathlib import Path

from bearing_twin.cli import main
from bearing_twin.ros.processes.launching import NodeProcesses
import pytest

pytest.importorskip('rclpy')

from bearing_twin.ros.processes.fastdds import OLDER
from commands import python
from forked import run_command
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters, SetParametersAtomically

SCHEDULE = Path(__file__).parents[2] / 'recordings' / 'paper_schedule.mcap'


def assert_ended(ran, status, *texts):
    """Assert that a command has ended with a status, and with these texts instead of a trace."""
    assert ran.returncode == status, ran.stderr
    assert 'Traceback' not in ran.stderr
    for text in texts:
        assert text in ran.stderr


@pytest.mark.ros
@pytest.mark.parametrize(
    ('words', 'status', 'text'),
    [
        (['--bogus'], 2, "'--bogus'"),
        (['--ros-args', '-p', 'bearing:=6307.5'], 2, '''bearing:="'6307.5'"'''),
        (
            ['--ros-args', '-p', 'load:=5.0'],
            2,
            'twin: load=5.0 is outside 10..50000 N; choose a value inside (0: from the preset)\n',
        ),
        (
            ['--ros-args', '-p', 'shaft_hz:=1480'],
            2,
            'twin: shaft_hz=1480.0 is outside 0..100 Hz; choose a value inside: 1480 1/min are '
            '24.667 Hz\n',
        ),
        (
            ['--ros-args', '-p', 'defect:=no'],
            2,
            'twin: defect=False must be of type str; quote a text twice: defect:="\'no\'"\n',
        ),
        (
            ['--ros-args', '-p', 'preset:=dungs'],
            2,
            "twin: preset='dungs' is not one of paper, incipient, mishra2017, sawalhi2008; "
            'choose one of these\n',
        ),
    ],
)
def test_a_node_refuses_what_it_cannot_take(ros_domain, words, status, text):
    ran = run_command('run', 'twin', *words)
    assert_ended(ran, status, text)
    assert ran.stderr.count('\n') == 1


@pytest.mark.ros
@pytest.mark.parametrize(
    ('domain', 'content', 'text'),
    [
        ('', b'a: &a [*a]\n', 'a.yaml'),
        ('', bytes(range(128, 256)), "a.yaml: 'utf-8' codec can't decode byte 0x80"),
        ('', b'a:\n  b:\n\tc: 1\n', "a.yaml, line 3: found character '\\t' that cannot start"),
        ('abc', b'', 'ROS_DOMAIN_ID'),
    ],
)
def test_what_rclpy_cannot_begin_with_is_said_in_a_sentence(
    ros_domain, tmp_path, domain, content, text
):
    path = tmp_path / 'a.yaml'
    path.write_bytes(content)
    words = ['recorder', '--ros-args', '--params-file', path]
    ran = run_command('run', *words, ROS_DOMAIN_ID=domain or os.environ['ROS_DOMAIN_ID'])
    assert_ended(ran, 2, 'recorder: failed to initialize rcl', text)


@pytest.mark.ros
@pytest.mark.parametrize(
    ('node', 'option', 'value'),
    [
        ('recorder', '--params-file', 'a.yaml'),
        ('fleet', '-p', 'assets_file:=a.yaml'),
        ('replay', '-p', 'recording:=a.yaml'),
    ],
)
def test_a_file_that_is_missing_may_be_there_later(ros_domain, node, option, value):
    ran = run_command('run', node, '--ros-args', option, value)
    assert_ended(ran, 1, 'a.yaml')


@pytest.mark.ros
@pytest.mark.parametrize('section', ['adapter', '/**/adaptor', 'fan_8: {adapter'])
def test_a_parameter_file_that_misses_a_node_is_told(ros_domain, tmp_path, section):
    path = tmp_path / 'a.yaml'
    end = '}' * section.count('{')
    path.write_text(f'{section}: {{ros__parameters: {{sample_rate: 1000.0}}}}{end}\n')
    ran = run_command('run', 'adapter', '--ros-args', '-r', '__ns:=/fan_7', '--params-file', path)
    assert_ended(ran, 2, 'sample_rate=0', f'{path} sets parameters of /', "write '/**/adapter'")


@pytest.mark.ros
@pytest.mark.parametrize(
    ('section', 'told'),
    [
        ('    sample_rate: -1.0', '/adapter in lines 5 and 6'),
        ('adapter:\n  ros__parameters:\n    sample_rate: -1.0', '/adapter in lines 5 and 8'),
        # This is the way to override what all nodes share, and what other nodes get.
        ('fan_7:\n  adapter: {ros__parameters: {sample_rate: -1.0}}', ''),
    ],
)
def test_a_parameter_that_a_file_gives_twice_is_told(ros_domain, tmp_path, section, told):
    path = tmp_path / 'a.yaml'
    others = '/**: {ros__parameters: {sample_rate: 500.0}}\nplay: {ros__parameters: {a: 1, a: 2}}'
    path.write_text(
        f'{others}\nadapter:\n  ros__parameters:\n    sample_rate: 1000.0\n{section}\n'
    )
    names = [] if told else ['-r', '__ns:=/fan_7']
    ran = run_command('run', 'adapter', '--ros-args', *names, '--params-file', path)
    assert_ended(ran, 2, 'sample_rate=-1', f'{path} gives sample_rate of {told}' if told else '')
    assert ran.stderr.count(' gives ') == bool(told)


@pytest.mark.ros
@pytest.mark.parametrize(
    ('variable', 'value', 'text', 'status'),
    [
        ('ROS_DOMAIN_ID', '300', 'ROS_DOMAIN_ID=300 is outside 0..232; choose a value inside', 2),
        ('ROS_DOMAIN_ID', '-1', 'ROS_DOMAIN_ID=-1 is outside 0..232; choose a value inside', 2),
        # A name that is not known yet may be known at the next start.
        ('ROS_STATIC_PEERS', 'nobody.invalid', 'Unable to resolve peer nobody.invalid', 1),
    ],
)
def test_a_network_that_cannot_be_joined_is_named(
    ros_domain, tmp_path, variable, value, text, status
):
    samples = tmp_path / 'samples.csv'
    samples.write_text('acc\n' + '0.1\n-0.1\n' * 500)
    for command in (
        ['run', 'adapter', '--ros-args', '-p', 'sample_rate:=1000.0'],
        ['play', samples, '--rate', '1000'],
    ):
        ran = run_command(*command, **{variable: value})
        assert_ended(ran, status, text)
        assert '2038' not in ran.stderr


@pytest.mark.parametrize(
    ('status', 'words'),
    [
        (2, ['replay', 'missing.mcap', '--offline']),
        (2, ['replay', SCHEDULE, '--offline', '-o', 'new.mcap', '--twin', 'load=5']),
        (2, ['replay', SCHEDULE, '--offline', '-o', 'new.mcap', '--twin', 'load']),
        (2, ['diagnose', 'missing.npz', '--shaft-hz', '-1']),
        (2, ['diagnose', 'missing.npz', '--bearing', '63077']),
        (2, ['diagnose', 'missing.npz', '--speed-tolerance', '9']),
        (2, ['diagnose', 'missing.npz', '--series', '--baseline', '-1']),
        (2, ['play', 'missing.npz', '--block', '0']),
        (1, ['replay', 'missing.mcap', '--offline', '-o', 'new.mcap']),
        (1, ['diagnose', 'missing.npz']),
        *((1, [command, 'missing.mcap']) for command in ('info', 'play', 'recover', 'view')),
    ],
)
def test_a_command_that_is_refused_ends_with_2_and_one_that_lacks_a_file_with_1(
    status, words, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    assert main(list(map(str, words))) == status, capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.ros
@pytest.mark.parametrize(
    ('status', 'words'),
    [
        (2, ['replay']),
        (2, ['replay', 'recording:=missing.mcap', 'rate:=-1.0']),
        (2, ['recorder', 'output:=/']),
        (2, ['recorder', 'output:=a.mcap', 'max_bag_duration:=1.0']),
        (2, ['recorder', 'output:=a', 'delete_oldest:=true']),
        (2, ['recorder', 'output:=a', 'topics:=["/a b"]']),
        (1, ['replay', 'recording:=missing.mcap']),
        (1, ['recorder', 'output:=/proc/a']),
    ],
)
def test_a_node_that_is_refused_ends_with_2_and_one_that_lacks_a_file_with_1(
    ros_domain, status, words, tmp_path, monkeypatch
):
    name, *given = words
    monkeypatch.chdir(tmp_path)
    ran = run_command('run', name, '--ros-args', *(w for each in given for w in ('-p', each)))
    assert_ended(ran, status)


def test_a_picture_is_kept_and_what_is_live_is_not(tmp_path, capsys):
    source, target = tmp_path / 'a.rrd', tmp_path / 'b.rrd'
    source.write_bytes(b'picture')
    assert main(['view', str(source), '--save', str(target)]) == 0
    assert target.read_bytes() == b'picture'
    assert main(['view', '--live', '--save', str(tmp_path / 'c.rrd')]) == 2
    assert '--save' in capsys.readouterr().err


@pytest.mark.ros
@pytest.mark.parametrize('home', [None, '/proc/nobody'])
def test_a_node_needs_no_home(ros_domain, probe, tmp_path, monkeypatch, home):
    for name in ('HOME', 'ROS_HOME', 'ROS_LOG_DIR'):
        monkeypatch.delenv(name, raising=False)
    if home is not None:
        monkeypatch.setenv('HOME', home)
    monkeypatch.setenv('TMPDIR', str(tmp_path))
    with NodeProcesses(tmp_path / 'logs', os.environ) as nodes:
        nodes.start('adapter', {'sample_rate': 100.0})
        probe.until_active('/adapter')
        assert nodes.end('adapter') == 0
    assert list(tmp_path.glob('ros_log_*/*.log'))


@pytest.mark.ros
def test_what_is_given_is_taken_as_meant_or_refused_by_name(nodes, probe, tmp_path):
    # The twin is in a namespace, and so is its topic.
    depth, meant = (f'qos_overrides.{ns}/vibration.publisher.depth' for ns in ('', '/twin'))
    words = {'bearing': 6307, 'noise': 0, 'lod': 500.0, depth: 99}
    nodes.start('twin', words, ros=('-r', '__ns:=/twin'))
    probe.until_active('/twin/twin')
    assert probe.get_parameters('/twin/twin', 'bearing', 'noise') == ['6307', 0.0]
    log = (tmp_path / 'logs/twin.log').read_text
    for name, near in (('lod', 'load,'), (depth, f'{meant},')):
        said = f"there is no parameter '{name}'; the nearest are {near}"
        probe.until(lambda said=said: said in log(), said)
    # Simulated time is not switched on under a running node.
    accepted, reason = probe.set_parameters('/twin/twin', use_sim_time=True)
    assert not accepted
    assert 'use_sim_time' in reason


@pytest.mark.ros
def test_a_running_node_reads_a_value_as_at_start(nodes, probe):
    nodes.start('diagnosis', {})
    probe.until_active('/diagnosis')
    services = (
        (SetParameters, 'set_parameters', lambda answer: answer.results[0]),
        (SetParametersAtomically, 'set_parameters_atomically', lambda answer: answer.result),
    )
    for name, value, why in (
        # As 'ros2 param set' sends them.
        ('bearing', ParameterValue(type=2, integer_value=6205), ''),
        ('window', ParameterValue(type=2, integer_value=4), ''),
        ('window', ParameterValue(type=2, integer_value=61), 'is outside 1..60 s'),
        (
            'window',
            ParameterValue(type=4, string_value='4 s'),
            'write a decimal point and no unit',
        ),
        ('windw', ParameterValue(type=2, integer_value=4), "no parameter 'windw'; 'ros2"),
        ('series_cycle', ParameterValue(type=2, integer_value=4), 'cannot change while the node'),
        ('windw', ParameterValue(type=77), "no parameter 'windw'"),
        # rclpy would end the node.
        ('bearing', ParameterValue(type=77), 'Static parameter cannot be undeclared'),
        # The node would stand still for minutes, and look for a bearing of that name.
        (
            'bearing',
            ParameterValue(type=4, string_value='x' * 10_000_000),
            '10000000 characters are too many',
        ),
    ):
        given = [Parameter(name=name, value=value)]
        for kind, service, result_of in services:
            result = result_of(probe.call(kind, f'/diagnosis/{service}', parameters=given))
            assert result.successful == (not why), result.reason
            assert why in result.reason
    assert probe.get_parameters('/diagnosis', 'bearing', 'window') == ['6205', 4.0]


ASSETS = {
    '{widow: 4.0}': "there is no parameter 'widow'; the nearest are window,",
    '{window: 0.5}': 'window=0.5 is outside 1..60 s; choose a value inside\n',
    '{bearing: 6307.5}': 'bearing=6307.5 must be of type str',
    r'{"\e[31m": 1}': r"there is no parameter '\x1b[31m'",
}
FLEETS = """
import sys
from bearing_twin.nodes.fleet import NODE
from bearing_twin.ros.processes.running import _run

for path in sys.argv[1:]:
    print(_run(NODE, ['--ros-args', '-p', f'assets_file:={path}']))
"""
"""One fleet after the other in one process, which loads the libraries once."""


@pytest.mark.ros
def test_a_file_of_assets_is_checked_as_every_other_input(ros_domain, tmp_path):
    paths = [tmp_path / f'{number}.yaml' for number in range(len(ASSETS))]
    for path, given in zip(paths, ASSETS, strict=True):
        path.write_text(f'assets: {{fan: {{diagnosis: {given}}}}}')
    ran = python('-c', FLEETS, *paths)
    assert ran.stdout.split() == ['2'] * len(paths)
    # A slow machine says besides that it compiles.
    lines = [line for line in ran.stderr.splitlines() if '[INFO]' not in line]
    for line, said in zip(lines, ASSETS.values(), strict=True):
        assert f'fleet: asset fan: {said}' in f'{line}\n'


@pytest.mark.ros
@pytest.mark.parametrize(
    ('given', 'said'),
    [
        ('use_sim_time:=yes please', "'use_sim_time' to 'yes please' of type 'STRING'"),
        ('qos_overrides./vibration.publisher.depth:=deep', "to 'deep' of type 'STRING'"),
        ('qos_overrides./vibration.publisher.reliability:=relable', '`reliability`: `relable`'),
        ('qos_overrides./vibration.publisher.depth:=-1', 'depth=-1 is outside 1..10000'),
    ],
)
def test_what_rclpy_refuses_is_one_sentence(ros_domain, given, said):
    words = ['run', 'adapter', '--ros-args', '-p', 'sample_rate:=25600.0', '-p', given]
    ran = run_command(*words)
    assert_ended(ran, 2, said)


@pytest.mark.ros
@pytest.mark.parametrize(
    ('rules', 'said'),
    [
        (['__node:=' + 300 * 'n'], "node name length should not exceed '255'"),
        (['__ns:=/' + 225 * 'n'], "topic length should not exceed '255"),
        pytest.param(
            ['samples:=v', 'vibration:=v'],
            'existing topic name rt/v with incompatible type',
            marks=pytest.mark.skipif(OLDER, reason='rcl 9 (Jazzy) says something else'),
        ),
    ],
)
def test_names_that_ros_does_not_take_are_refused(ros_domain, rules, said):
    words = ['run', 'adapter', '--ros-args', '-p', 'sample_rate:=25600.0']
    ran = run_command(*words, *(word for rule in rules for word in ('-r', rule)))
    assert_ended(ran, 2, said)


@pytest.mark.ros
def test_a_dump_of_the_parameters_can_be_given_again(ros_domain, tmp_path):
    dump = tmp_path / 'dump.yaml'
    # As ros2 param dump writes it: ROS reads this axis as true.
    dump.write_text('/diagnosis:\n  ros__parameters: {axis: y, window: 0.01}\n')
    ran = run_command('run', 'diagnosis', '--ros-args', '--params-file', dump)
    # Only the window, which is wrong by intention, is refused.
    assert_ended(ran, 2, 'diagnosis: window=0.01 is outside')
