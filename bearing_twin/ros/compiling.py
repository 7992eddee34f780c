# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Compile a node's kernels beside its executor: it is seen and answers meanwhile."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING

from bearing_twin.ros.health import Health, Level, Status
from bearing_twin.ros.launching import COMPILING

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.executors import Executor
    from rclpy.node import Node

__all__ = ['is_compiling', 'prepare']

SLOW = 2.0
"""Time after which the preparation of a node must be compiling, s."""

THREAD = 'compiler'
PART = 'real time'
"""Part of the node that a status speaks of; every node that compiles has it later on, too."""


def prepare(node: Node, work: Callable[[], None], executor: Executor) -> None:
    """
    Let a node do its preparing `work` in a thread, and answer services until it is done.

    If that takes long the log and /diagnostics say why.
    """
    started = time.monotonic()
    thread = threading.Thread(target=work, name=THREAD, daemon=True)
    thread.start()
    health: Health | None = None
    while thread.is_alive() and node.context.ok():
        executor.spin_once(timeout_sec=0.1)
        if health is None and time.monotonic() - started > SLOW:
            node.get_logger().info(COMPILING)
            health = Health(node, node.get_namespace())
            health.add(
                PART,
                lambda: Status(Level.WARN, COMPILING, {'time s': time.monotonic() - started}),
            )
    if health is not None:
        health.destroy()


def is_compiling() -> bool:
    """Whether a preparation is under way: the compiler cannot be told to stop."""
    return any(thread.name == THREAD for thread in threading.enumerate())
