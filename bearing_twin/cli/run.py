# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin run NODE``: what ``ros2 run bearing_twin NODE`` does, where there is no ros2."""

from __future__ import annotations

import argparse
import importlib

__all__ = ['NODES', 'configure', 'run']

NODES = ('adapter', 'diagnosis', 'fleet', 'recorder', 'replay', 'twin')


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument('node', choices=NODES, help='node to run')
    parser.add_argument(
        'arguments',
        nargs=argparse.REMAINDER,
        help='passed on to the node, e.g. --ros-args -p defect:=inner -r __ns:=/line3',
    )


def run(args: argparse.Namespace) -> int:
    """Run the node until it is told to end."""
    node = importlib.import_module(f'bearing_twin.nodes.{args.node}')
    status: int = node.main(args.arguments)
    return status
