# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The examples in the docstrings of the core say what they print."""

import doctest
import importlib
import pkgutil

import pytest

ROOMS = ('bearing', 'diagnosis')


def modules():
    for room in ROOMS:
        package = importlib.import_module(f'bearing_twin.{room}')
        for module in pkgutil.iter_modules(package.__path__):
            yield f'{package.__name__}.{module.name}'


@pytest.mark.parametrize('name', modules())
def test_examples(name):
    assert doctest.testmod(importlib.import_module(name)).failed == 0
