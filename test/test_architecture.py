# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The rooms: what each may import, and that the core runs without ROS, MCAP and Rerun."""

import ast
from functools import cache
from pathlib import Path

from commands import python
import pytest

PACKAGE = Path(__file__).resolve().parents[1] / 'bearing_twin'

ROOMS = (
    'numerics',
    'bearing',
    'thermal',
    'dynamics',
    'diagnosis',
    'calibration',
    'paper',
    'recording',
    'streams',
    'assets',
    'offline',
    'view',
    'ros',
    'nodes',
    'studies',
    'bench',
    'cli',
)
"""From the ground up: a room imports itself and the rooms before it."""

DYNAMICS = (
    'parameters',
    'defect_text',
    'presets',
    'limits',
    'saved',
    'equations',
    'single',
    'fleet',
    'trend',
    'reference',
    'compilation',
)
"""The same for the rooms of the dynamics and the files beside them."""

DIAGNOSIS = (
    'thresholds',
    'settings',
    'signal',
    'combs',
    'rules',
    'result',
    'detection_power',
    'window',
    'chain',
    'machine',
    'record',
    'streaming',
    'series',
    'compilation',
)
"""The same for the rooms of the diagnosis and the files beside them."""

CALIBRATION = ('measured', 'candidates', 'answer', 'fit', 'joint', 'whatif', 'residual')
"""The same for the calibration."""

RECORDING = (
    'topics',
    'plainyaml',
    'qos',
    'finding',
    'mcap',
    'bagmetadata',
    'outfile',
    'writer',
    'snapshot',
    'reader',
    'health',
    'player',
    'recover',
    'dates',
    'signals',
    'temperature',
)
"""The same for the recordings."""

ASSETS = (
    'parameters',
    'messages',
    'checkpoints',
    'message_template',
    'twin_messages',
    'diagnosis',
    'calibration',
    'twin',
    'fleet',
)
"""The same for the assets."""

RERUN = (
    'timebase',
    'ending',
    'ports',
    'outlet',
    'canvas',
    'pictures',
    'scene',
    'views',
    'blueprint',
    'logger',
    'opening',
    'viewer',
)
"""The same for Rerun, a room of the view."""

ROS = (
    'executor',
    'topics',
    'reserves',
    'health',
    'parameterfile',
    'parameters',
    'lifecycle',
    'realtime',
    'cycle',
    'processes',
)
"""The same for what every node needs."""

CORE = ('numerics', 'bearing', 'thermal', 'dynamics', 'diagnosis', 'calibration', 'paper')

MIDDLEWARE = ('rclpy', 'mcap', 'rerun', 'rosbags', 'bearing_twin_msgs', 'sensor_msgs')


def modules():
    """Return every module of the package but its top level."""
    return sorted(path for path in PACKAGE.rglob('*.py') if path.parent != PACKAGE)


def dotted(path):
    """Return the dotted name of a module, that of a head without its __init__."""
    parts = path.relative_to(PACKAGE.parent).with_suffix('').parts
    return '.'.join(parts[:-1] if parts[-1] == '__init__' else parts)


def named(path):
    """Return which dotted names a module imports, wherever in it, and how it calls each."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from ((alias.name, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module, ''
            for alias in node.names:
                yield f'{node.module}.{alias.name}', alias.asname or alias.name


@cache
def given_by_heads():
    """Return for each name that a head gives away the name of what it has imported."""
    heads = PACKAGE.rglob('*/__init__.py')
    return {f'{dotted(head)}.{own}': name for head in heads for name, own in named(head) if own}


def imports(path):
    """Return the dotted names that a module imports, each as that of where it is defined."""
    for name, _ in named(path):
        yield given_by_heads().get(name, name)


def assert_order(path, rooms, within):
    """Assert that a module below the dotted name ``within`` imports no later one of the rooms."""
    depth = len(within)
    room = path.relative_to(PACKAGE.parent).with_suffix('').parts[depth]
    allowed = rooms[: rooms.index(room) + 1]
    for name in imports(path):
        parts = tuple(name.split('.'))
        if parts[:depth] == within and len(parts) > depth and parts[depth] in rooms:
            assert parts[depth] in allowed, f'{room} must not import {name}'


@pytest.mark.parametrize('path', modules(), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_a_room_imports_only_rooms_before_it(path):
    assert_order(path, ROOMS, ('bearing_twin',))


def test_files_beside_the_rooms_import_no_room_unless_they_start_it():
    for path in PACKAGE.glob('*.py'):
        if path.stem not in {'__main__', 'start'}:
            names = (name for name in imports(path) if name.startswith('bearing_twin.'))
            assert not {name.split('.')[1] for name in names} & {*ROOMS}, path


@pytest.mark.parametrize(
    ('room', 'rooms'),
    [
        ('dynamics', DYNAMICS),
        ('diagnosis', DIAGNOSIS),
        ('calibration', CALIBRATION),
        ('recording', RECORDING),
        ('assets', ASSETS),
        ('view/rerun', RERUN),
        ('ros', ROS),
    ],
)
def test_a_room_within_a_room_imports_only_those_before_it(room, rooms):
    # Its head names what others import of it.
    for path in set((PACKAGE / room).rglob('*.py')) - {PACKAGE / room / '__init__.py'}:
        assert_order(path, rooms, ('bearing_twin', *room.split('/')))


def edges():
    """Return which modules each module imports, whatever is imported for types alone too."""
    names = {dotted(path): path for path in modules() if path.name != '__init__.py'}
    return {
        name: {
            other
            for full in imports(path)
            for other in (full, full.rpartition('.')[0])
            if other in names and other != name
        }
        for name, path in names.items()
    }


def test_no_files_import_each_other_in_a_circle():
    left = edges()
    while left:
        ground = {name for name, needs in left.items() if not needs & left.keys()}
        assert ground, f'in a circle, or above one: {", ".join(sorted(left))}'
        left = {name: needs for name, needs in left.items() if name not in ground}


def test_the_core_runs_without_ros_mcap_and_rerun():
    blocked = ', '.join(repr(name) for name in MIDDLEWARE)
    script = f"""
import importlib, pkgutil, sys
for name in ({blocked}):
    sys.modules[name] = None
for room in {CORE!r}:
    package = importlib.import_module('bearing_twin.' + room)
    for module in pkgutil.walk_packages(package.__path__, f'{{package.__name__}}.'):
        importlib.import_module(module.name)
"""
    ran = python('-c', script)
    assert ran.returncode == 0, ran.stderr


def test_every_module_has_its_licence():
    root = PACKAGE.parent
    for folder in ('bearing_twin', 'test', 'launch', 'msg_defs'):
        for path in (root / folder).rglob('*.py'):
            if 'build' in path.relative_to(root).parts:
                continue
            head = path.read_text().splitlines()[:2]
            assert head == [
                '# SPDX-FileCopyrightText: 2026 bearing_twin contributors',
                '# SPDX-License-Identifier: Apache-2.0',
            ], path
