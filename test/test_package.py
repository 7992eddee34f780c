# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The package as ROS and pip see it."""

import importlib
import importlib.util
import os
from pathlib import Path
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import bearing_twin
from bearing_twin.cli import COMMANDS
from commands import python
import pytest

ROOT = Path(__file__).resolve().parents[1]


def test_one_version_everywhere():
    for manifest in ('package.xml', 'msg_defs/package.xml'):
        assert ElementTree.parse(ROOT / manifest).findtext('version') == bearing_twin.__version__


@pytest.mark.parametrize('manifest', ['package.xml', 'msg_defs/package.xml'])
def test_manifests_hold_what_format_3_asks_for(manifest):
    package = pytest.importorskip('catkin_pkg.package')
    warnings = []
    parsed = package.parse_package(ROOT / manifest, warnings=warnings)
    parsed.validate(warnings=warnings)
    assert not warnings
    assert parsed.package_format == 3
    assert parsed.get_build_type() in ('ament_python', 'ament_cmake')


def test_rosdep_keys_are_those_that_bloom_can_release():
    keys = {key.text for key in ElementTree.parse(ROOT / 'package.xml').iter('exec_depend')}
    # Both resolve to pip (rosdep/python.yaml of ros/rosdistro, 2026-08-22), which bloom refuses.
    assert keys.isdisjoint({'mcap-ros2-support', 'python3-rosbags-pip'})
    assert not {key for key in keys if key.endswith('-pip')}


def test_tests_that_a_page_names_exist():
    page = (ROOT / 'docs' / 'reliability.md').read_text(encoding='utf-8')
    tests = 0
    for file, names in re.findall(r'`(\S+\.py)`: ((?:`test_\w+`(?:, )?)+)', page):
        source = (ROOT / 'test' / file).read_text(encoding='utf-8')
        for name in re.findall(r'\w+', names):
            assert f'def {name}(' in source, (file, name)
            tests += 1
    assert tests == len(re.findall(r'`test_\w+`', page)) > 30


def test_the_description_of_the_messages_names_each():
    text = ElementTree.parse(ROOT / 'msg_defs/package.xml').findtext('description')
    files = [*(ROOT / 'msg_defs').glob('msg/*.msg'), *(ROOT / 'msg_defs').glob('srv/*.srv')]
    names = [' '.join(re.findall('[A-Z][a-z]+', file.stem)).lower() for file in files]
    assert not [name for name in names if name not in text.lower()]


def test_every_message_is_built():
    listed = set(
        re.findall(r'"((?:msg|srv)/\w+\.\w+)"', (ROOT / 'msg_defs/CMakeLists.txt').read_text())
    )
    there = {
        f'{path.parent.name}/{path.name}'
        for folder in ('msg', 'srv')
        for path in (ROOT / 'msg_defs' / folder).iterdir()
    }
    assert listed == there


def test_pins_of_the_message_build_are_those_of_the_environment():
    pins = dict(
        re.findall(r'^([\w-]+)==(\S+)', (ROOT / 'requirements-dev.txt').read_text(), re.MULTILINE)
    )
    pins |= dict(
        re.findall(r'^([\w-]+)==(\S+)', (ROOT / 'requirements.txt').read_text(), re.MULTILINE)
    )
    backend = (ROOT / 'msg_defs/build_messages.py').read_text()
    for name, version in re.findall(r"'([\w-]+)==(\S+)'", backend):
        assert pins[name] == version, name


def test_every_picture_is_shown_small_and_there():
    shown = set()
    for page in (ROOT / 'README.md', *(ROOT / 'docs').glob('*.md')):
        for name in re.findall(r'!\[[^]]*\]\(([^)]+)\)', page.read_text(encoding='utf-8')):
            shown.add((page.parent / name).resolve())
    pictures = {path.resolve() for path in (ROOT / 'docs' / 'images').glob('*.png')}
    assert pictures == shown
    assert max(path.stat().st_size for path in pictures) < 300_000


@pytest.mark.parametrize('name', COMMANDS)
def test_every_command_can_be_imported(name):
    module = importlib.import_module(f'bearing_twin.cli.{name.replace("-", "_")}')
    assert callable(module.configure)
    assert callable(module.run)


def test_setup_names_nodes_that_exist():
    [names] = re.findall(r'^NODES = \((.*)\)$', (ROOT / 'setup.py').read_text(), re.MULTILINE)
    for node in re.findall(r"'(\w+)'", names):
        assert callable(importlib.import_module(f'bearing_twin.nodes.{node}').NODE)


@pytest.mark.skipif(not importlib.util.find_spec('colcon_core'), reason='colcon is not installed')
def test_colcon_installs_nodes_for_ros2_run_and_the_command_for_the_path(tmp_path):
    built = subprocess.run(
        [
            *(sys.executable, '-m', 'colcon', '--log-base', tmp_path / 'log', 'build'),
            *('--build-base', tmp_path / 'build', '--install-base', tmp_path / 'install'),
            *('--paths', ROOT, '--packages-select', 'bearing_twin'),
        ],
        check=True,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env={**os.environ, 'AMENT_PREFIX_PATH': ''},
    )
    # The messages inside are not found: it says what to add.
    assert f'--base-paths {ROOT} {ROOT / "msg_defs"}' in built.stderr
    prefix = tmp_path / 'install' / 'bearing_twin'
    nodes = {path.name for path in (prefix / 'lib' / 'bearing_twin').iterdir()}
    assert nodes == {
        *('adapter', 'bearing-twin', 'calibration', 'diagnosis', 'fleet', 'recorder', 'replay'),
        'twin',
    }
    sourced = f'. {tmp_path}/install/local_setup.sh && bearing-twin --version'
    said = subprocess.run(['sh', '-c', sourced], check=True, capture_output=True, text=True)
    assert said.stdout.split() == ['bearing-twin', bearing_twin.__version__]
    found = 'from bearing_twin.cli.demo.command import shipped_schedule as s; print(s())'
    sourced = f'. {tmp_path}/install/local_setup.sh && "{sys.executable}" -c "{found}"'
    said = subprocess.run(
        ['sh', '-c', sourced], check=True, capture_output=True, text=True, cwd=tmp_path
    )
    assert Path(said.stdout.strip()).is_relative_to(prefix)


def test_nodes_without_their_messages_say_what_to_build():
    script = "import sys; sys.modules['bearing_twin_msgs'] = None; import bearing_twin.nodes.twin"
    ran = python('-c', script)
    assert ran.returncode == 1
    assert "build it with 'colcon build --base-paths . msg_defs'" in ran.stderr.splitlines()[-1]


def test_who_publishes_it_is_filled_in_at_one_place():
    spec = importlib.util.spec_from_file_location('identity', ROOT / 'docs' / 'identity.py')
    identity = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(identity)
    wanted = ('Ann & Co <ann@example.org>', 'https://example.org/ann/bearing_twin')
    for path in identity.PACKAGES:
        filled = identity.identified(path.read_text(), *wanted)
        assert identity.identified(filled, *wanted) == filled
        root = ElementTree.fromstring(filled.split('?>', 2)[2])
        assert (root.find('maintainer').text, root.find('maintainer').get('email')) == (
            'Ann & Co',
            'ann@example.org',
        )
        assert [url.get('type') for url in root.findall('url')] == [
            'website',
            'repository',
            'bugtracker',
        ]
        # The order of REP 149.
        tags = [element.tag for element in root]
        assert tags.index('maintainer') < tags.index('license') < tags.index('url')
    with pytest.raises(SystemExit, match='usage'):
        identity.identified('', 'Ann', 'https://example.org/x')
