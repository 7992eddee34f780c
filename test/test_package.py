# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The package as ROS and pip see it."""

import importlib
from pathlib import Path
import re
import xml.etree.ElementTree as ElementTree

import bearing_twin
from bearing_twin.cli import COMMANDS
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


@pytest.mark.parametrize('name', COMMANDS)
def test_every_command_can_be_imported(name):
    module = importlib.import_module(f'bearing_twin.cli.{name.replace("-", "_")}')
    assert callable(module.configure)
    assert callable(module.run)


def test_setup_names_nodes_that_exist():
    [names] = re.findall(r'^NODES = \((.*)\)$', (ROOT / 'setup.py').read_text(), re.MULTILINE)
    for node in re.findall(r"'(\w+)'", names):
        assert callable(importlib.import_module(f'bearing_twin.nodes.{node}').main)
