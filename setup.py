# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Install bearing_twin: colcon runs this file, and so does pip."""

from __future__ import annotations

import os
from pathlib import Path
import sys
import xml.etree.ElementTree as ElementTree

from setuptools import find_packages, setup

HERE = Path(__file__).resolve().parent
NAME = 'bearing_twin'
PIP = {'bdist_wheel', 'dist_info', 'editable_wheel'}
"""Commands that pip runs and colcon does not."""

NODES = ('adapter', 'calibration', 'diagnosis', 'fleet', 'recorder', 'replay', 'twin')

EXECUTABLE = """#!/bin/sh
# What 'ros2 run' and 'ros2 launch' find; the interpreter is that of the environment it lies in.
prefix=$(dirname "$(readlink -f "$0")")/../..
python=$prefix/bin/python3
[ -x "$python" ] || python=python3
exec "$python" -m bearing_twin{words} "$@"
"""


def requirements() -> list[str]:
    """Return what has to be there to run, without the ROS 2 wheels where ROS 2 is sourced."""
    lines = (HERE / 'requirements.txt').read_text().splitlines()
    wanted = [line for line in lines if line and not line.startswith('#')]
    prefixes = [p for p in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep) if p]
    if any((Path(p) / 'share' / 'rclpy' / 'package.xml').exists() for p in prefixes):
        wanted = [line for line in wanted if not line.startswith('ros-')]
    return [*wanted, f'{NAME}_msgs']


def by_colcon() -> bool:
    """Whether colcon runs this file: setup.cfg then sends every script to lib/bearing_twin."""
    given = set(sys.argv)
    if 'install_data' in given:
        return bool({'install', 'develop'} & given)
    return not PIP & given


def messages_are_missing() -> bool:
    """Whether colcon builds this package where the message package inside it was not found."""
    prefixes = os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    built = any((Path(p) / 'share' / f'{NAME}_msgs').is_dir() for p in prefixes if p)
    return {'install', 'develop'} & set(sys.argv) != set() and not built


def executables() -> list[tuple[str, list[str]]]:
    """Return the executables of lib/bearing_twin for pip; colcon puts console_scripts there."""
    if by_colcon():
        return []
    folder = Path('build') / 'executables'
    folder.mkdir(parents=True, exist_ok=True)
    names = ('bearing-twin', *NODES)
    for name in names:
        path = folder / name
        path.write_text(EXECUTABLE.format(words=f' run {name}' if name in NODES else ''))
        path.chmod(0o755)
    return [(f'lib/{NAME}', [str(folder / name) for name in names])]


def scripts() -> list[str]:
    """Return the nodes as console scripts for colcon: not into a venv's bin, under such names."""
    return [f'{node} = {NAME}.start:{node}' for node in NODES] if by_colcon() else []


def command() -> list[tuple[str, list[str]]]:
    """Return what calls the command from the PATH; pip puts the command itself there."""
    return [('bin', ['resource/bearing-twin'])] if by_colcon() else []


def shared(folder: str) -> tuple[str, list[str]]:
    """Return a folder of the tree as data files of share/bearing_twin."""
    files = sorted(str(path) for path in Path(folder).iterdir() if path.is_file())
    return f'share/{NAME}/{folder}', files


os.chdir(HERE)
if messages_are_missing():
    print(
        f'{NAME}: its messages are not built, since colcon looks inside no package: build with '
        f"'colcon build --base-paths {HERE} {HERE / 'msg_defs'}'",
        file=sys.stderr,
    )
setup(
    name=NAME,
    version=ElementTree.parse(HERE / 'package.xml').findtext('version'),
    description='Temperature-aware digital twin and diagnosis of bearings for ROS 2',
    license='Apache-2.0',
    python_requires='>=3.11',
    packages=find_packages(include=[NAME, f'{NAME}.*']),
    package_data={'': ['*.csv', '*.html', '*.json', '*.xml', '*.yaml', 'py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (f'share/{NAME}', ['package.xml']),
        shared('launch'),
        shared('config'),
        shared('recordings'),
        *executables(),
        *command(),
    ],
    install_requires=requirements(),
    extras_require={
        'dask': ['dask[distributed]'],
        'files': ['h5py', 'npTDMS', 'pyuff'],
        'test': ['pytest', 'hypothesis'],
    },
    zip_safe=False,
    entry_points={'console_scripts': ['bearing-twin = bearing_twin.start:command', *scripts()]},
)
