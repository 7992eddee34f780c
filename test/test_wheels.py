# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Wheels of both packages work in a bare environment, away from the tree."""

import importlib.metadata
import importlib.util
import os
from pathlib import Path
import shutil
import site
import subprocess
import sys

import pytest

ROOT = Path(__file__).resolve().parents[1]
LEFT_OUT = ('.*', 'build', 'install', 'log', '*.egg-info', 'runs', '__pycache__')

pytestmark = [
    pytest.mark.skipif(
        not any(importlib.metadata.distributions(name='build')),
        reason="build is not installed ('make release' does)",
    ),
    pytest.mark.skipif(
        not importlib.util.find_spec('rosidl_generator_py'),
        reason='the message generators are not installed',
    ),
]


def run(*words, **more):
    done = subprocess.run(
        [str(word) for word in words], capture_output=True, text=True, check=False, **more
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def messages_of_setup():
    """Wheel of the messages from `make setup`, which takes minutes; none if it is not of today."""
    sources = [path for path in (ROOT / 'msg_defs').rglob('*') if path.is_file()]
    newest = max(path.stat().st_mtime for path in sources if 'build' not in path.parts)
    wheels = (Path(sys.prefix) / 'wheels').glob('bearing_twin_msgs-*.whl')
    return [wheel for wheel in wheels if wheel.stat().st_mtime > newest]


@pytest.fixture(scope='module')
def bare(tmp_path_factory):
    """Return the prefix of an environment in which the two wheels are installed."""
    work = tmp_path_factory.mktemp('wheels')
    shutil.copytree(ROOT, work / 'tree', ignore=shutil.ignore_patterns(*LEFT_OUT))
    tools = f'{Path(sys.executable).parent}{os.pathsep}{os.environ["PATH"]}'
    made = messages_of_setup()
    for package in ('.',) if made else ('.', 'msg_defs'):
        run(
            *(sys.executable, '-m', 'build', '--wheel', '--no-isolation', '-o', work, package),
            cwd=work / 'tree',
            env={**os.environ, 'PATH': tools},
        )
    shutil.rmtree(work / 'tree')
    prefix = work / 'bare'
    run(sys.executable, '-m', 'venv', '--without-pip', prefix)
    run(
        *(sys.executable, '-m', 'pip', '--python', prefix / 'bin' / 'python', 'install'),
        *('--no-deps', '--no-index', '--quiet', *work.glob('*.whl'), *made),
    )
    # What they need is borrowed; our own packages there come after those of the wheels.
    [packages] = prefix.glob('lib/python3*/site-packages')
    (packages / 'borrowed.pth').write_text('\n'.join(site.getsitepackages()))
    return prefix


@pytest.fixture
def environment(bare):
    # The wheels of ROS 2 set it when Python starts, for the environment that they lie in.
    libraries = (bare / 'lib', os.environ.get('LD_LIBRARY_PATH', ''), Path(sys.prefix) / 'lib')
    return {
        **{name: value for name, value in os.environ.items() if name != 'PYTHONPATH'},
        'AMENT_PREFIX_PATH': f'{bare}{os.pathsep}{sys.prefix}',
        'LD_LIBRARY_PATH': os.pathsep.join(map(str, libraries)),
    }


def test_messages_and_command_come_from_the_wheels(bare, environment, tmp_path):
    script = (
        'import bearing_twin, bearing_twin_msgs\n'
        'from bearing_twin_msgs.msg import Diagnosis\n'
        'from rclpy.serialization import deserialize_message, serialize_message\n'
        'again = deserialize_message(serialize_message(Diagnosis(rule="x")), Diagnosis)\n'
        'print(bearing_twin.__file__, bearing_twin_msgs.__file__, again.rule, sep="\\n")\n'
    )
    python = bare / 'bin' / 'python'
    *places, rule = run(python, '-c', script, cwd=tmp_path, env=environment).splitlines()
    assert rule == 'x'
    assert all(Path(place).is_relative_to(bare) for place in places)
    said = run(bare / 'bin' / 'bearing-twin', '--version', cwd=tmp_path, env=environment)
    assert said.startswith('bearing-twin ')


def test_nodes_launch_files_and_layouts_are_where_ros_looks(bare, environment, tmp_path):
    share = bare / 'share' / 'bearing_twin'
    for folder in ('launch', 'config', 'recordings'):
        tree = {path.name for path in (ROOT / folder).iterdir() if path.is_file()}
        installed = {path.name for path in (share / folder).iterdir() if path.is_file()}
        assert installed == tree
    helped = run(bare / 'bin' / 'bearing-twin', 'run', 'twin', '--help', cwd=tmp_path,
                 env=environment)  # fmt: skip
    assert 'temperature_timeout' in helped
    assert os.access(bare / 'lib' / 'bearing_twin' / 'twin', os.X_OK)
    assert (bare / 'share' / 'bearing_twin_msgs' / 'msg' / 'Diagnosis.msg').is_file()
