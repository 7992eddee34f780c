# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Build the wheel of the message package from the install tree of cmake, laid out for ament."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py

HERE = Path(__file__).resolve().parent
NAME = 'bearing_twin_msgs'


def ros_prefixes() -> list[str]:
    """Return the prefixes of ROS 2: of a sourced installation, or of wheels for this Python."""
    sourced = [p for p in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep) if p]
    found = importlib.util.find_spec('std_msgs')
    if found is None or found.origin is None:
        return sourced
    # PREFIX/lib/python3.N/site-packages/std_msgs/__init__.py
    return [str(Path(found.origin).parents[4]), *sourced]


class BuildMessages(build_py):
    """Run cmake, then package its install tree as modules and data files."""

    def run(self) -> None:
        """Build."""
        work = Path(self.get_finalized_command('build').build_temp).resolve() / 'messages'
        stage = work / 'stage'
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir(parents=True)
        prefixes = ros_prefixes()
        environment = {
            **os.environ,
            'AMENT_PREFIX_PATH': os.pathsep.join(prefixes),
            'CMAKE_PREFIX_PATH': os.pathsep.join(prefixes),
        }
        configure = [
            'cmake',
            '-S',
            str(HERE),
            '-B',
            str(work / 'build'),
            f'-DCMAKE_INSTALL_PREFIX={stage}',
            f'-DPython3_EXECUTABLE={sys.executable}',
            '-DBUILD_TESTING=OFF',
            '-DCMAKE_BUILD_TYPE=Release',
        ]
        jobs = str(os.cpu_count() or 1)
        for words in (
            configure,
            ['cmake', '--build', str(work / 'build'), '--parallel', jobs],
            ['cmake', '--install', str(work / 'build')],
        ):
            subprocess.run(words, env=environment, check=True)
        [module] = stage.glob(f'lib/python3*/**/{NAME}/__init__.py')
        shutil.copytree(module.parent, Path(self.build_lib) / NAME, dirs_exist_ok=True)
        files: dict[str, list[str]] = {}
        for path in sorted(stage.rglob('*')):
            inside = path.relative_to(stage)
            if path.is_file() and not str(inside).startswith('lib/python3'):
                files.setdefault(str(inside.parent), []).append(str(path))
        self.distribution.data_files = list(files.items())


class GeneratedDistribution(Distribution):
    """Distribution without listed files: modules and compiled code are generated."""

    def has_pure_modules(self) -> bool:
        """Return True: build_py has to run."""
        return True

    def has_ext_modules(self) -> bool:
        """Return True."""
        return True


setup(
    name=NAME,
    version=ElementTree.parse(HERE / 'package.xml').findtext('version'),
    description='Messages and services of bearing_twin',
    license='Apache-2.0',
    python_requires='>=3.11',
    packages=[],
    py_modules=[],
    cmdclass={'build_py': BuildMessages},
    distclass=GeneratedDistribution,
)
