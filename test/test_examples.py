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
import pkgutil

import pytest

ROOMS = ('bearing', 'thermal', 'dynamics', 'diagnosis', 'calibration')
"""Rooms whose every public function has an example."""


def modules(room):
    """Return the modules of a room, its own first."""
    package = importlib.import_module(f'bearing_twin.{room}')
    names = sorted(module.name for module in pkgutil.iter_modules(package.__path__))
    return [package, *(importlib.import_module(f'{package.__name__}.{name}') for name in names)]


@pytest.mark.parametrize('module', [m for room in ROOMS for m in modules(room)],
                         ids=lambda module: module.__name__)  # fmt: skip
def test_examples_hold(module):
    failed, _ = doctest.testmod(module)
    assert not failed


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
