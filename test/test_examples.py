# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The examples in the docstrings: they hold, and no public function of a room is without one.

Compiled functions may do without: most are the inside of a kernel, which `Simulator` and `Fleet`
show at work.
"""

import doctest
import importlib
import inspect
from pathlib import Path
import pkgutil

import bearing_twin
import pytest

pytestmark = pytest.mark.usefixtures('reference')

PACKAGE = Path(bearing_twin.__file__).parent

ROOMS = ('numerics', 'bearing', 'thermal', 'dynamics', 'diagnosis', 'calibration')
"""Rooms whose every public function has an example."""


def modules(room):
    """Return the modules of a room, its own first."""
    package = importlib.import_module(f'bearing_twin.{room}')
    below = pkgutil.walk_packages(package.__path__, f'{package.__name__}.')
    return [package, *(importlib.import_module(module.name) for module in below)]


def shown():
    """Return the names of the modules that have an example."""
    for path in sorted(PACKAGE.rglob('*.py')):
        if '>>>' in path.read_text():
            parts = path.relative_to(PACKAGE.parent).with_suffix('').parts
            yield '.'.join(parts[:-1] if parts[-1] == '__init__' else parts)


@pytest.mark.parametrize('name', list(shown()))
def test_examples_hold(name):
    failed, tried = doctest.testmod(importlib.import_module(name))
    assert tried and not failed


def is_compiled(function):
    """Whether numba made it: a kernel (`compiled`) or an operation of its registers."""
    return type(function).__module__.startswith('numba.')


@pytest.mark.parametrize('room', ROOMS)
def test_every_public_function_has_an_example(room):
    without = [
        f'{module.__name__}.{name}'
        for module in modules(room)[1:]
        for name, of in vars(module).items()
        if not name.startswith('_')
        and inspect.isfunction(inspect.unwrap(of))
        and of.__module__ == module.__name__
        and not is_compiled(of)
        and '>>>' not in (of.__doc__ or '')
    ]
    assert without == []
