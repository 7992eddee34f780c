# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin run NODE``: run a node as ``ros2 run bearing_twin NODE`` does, without ros2."""

from __future__ import annotations

import argparse
import importlib
import inspect
from typing import Any, TYPE_CHECKING

from bearing_twin.cli.terminal import by_level, fitted
from bearing_twin.process import begin_collection

if TYPE_CHECKING:
    from bearing_twin.assets.parameters.spec import Spec


NODES = ('adapter', 'calibration', 'diagnosis', 'fleet', 'recorder', 'replay', 'twin')


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        'node',
        metavar='NODE',
        choices=NODES,
        help=f'one of {", ".join(NODES)}; NODE --help: its parameters',
    )
    rest = parser.add_argument(
        'arguments',
        nargs=argparse.REMAINDER,
        help='passed on to the node, e.g. --ros-args -p defect:=inner -r __ns:=/line3',
    )
    # Without a NODE, argparse would call them required too.
    rest.required = False


def run(args: argparse.Namespace) -> int:
    """Run the node until it is told to end."""
    from bearing_twin.ros.processes import running

    node = importlib.import_module(f'bearing_twin.nodes.{args.node}')
    begin_collection()
    if {'-h', '--help'} & set(args.arguments):
        print(_help(args.node, node))
        return 0
    return running.run(node.NODE, args.arguments)


def _help(name: str, module: Any) -> str:
    """Return the help of a node: its purpose and its parameters."""
    specs: tuple[Spec, ...] = module.SPECS
    if name == 'twin':
        specs = (*specs, *module.PUBLISHING)
    usage = f'usage: bearing-twin run {name} [--ros-args -p PARAMETER:=VALUE ... -r FROM:=TO ...]'
    lines = [
        *fitted(usage, indent='    '),
        '',
        *fitted(inspect.cleandoc(module.__doc__ or '')),
        '',
        'parameters (default, values, meaning):',
    ]
    for spec in specs:
        default = ','.join(spec.default) if isinstance(spec.default, list) else spec.default
        first, *more = fitted(f'{spec.name}  {default!r} {_values(spec)}', '  ', ' ' * 8)
        lines += [first.replace(spec.name, by_level(spec.name, 'bold'), 1), *more]
        lines += fitted(spec.description, ' ' * 6, ' ' * 6)
    return '\n'.join(lines)


def _values(spec: Spec) -> str:
    """Return the unit and the values that a parameter may have, in brackets."""
    if spec.choices:
        return f'({", ".join(choice or repr("") for choice in spec.choices)})'
    if spec.low is None or spec.high is None:
        return spec.unit
    return f'({spec.low:g} to {spec.high:g} {spec.unit}'.rstrip() + ')'
