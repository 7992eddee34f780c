# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""An executor that does not look at everything each time something comes."""

from __future__ import annotations

import time
from typing import Any, TYPE_CHECKING

from rclpy.executors import SingleThreadedExecutor
from rclpy.service import Service
from rclpy.waitable import Waitable

if TYPE_CHECKING:
    from rclpy.context import Context

__all__ = ['LeanExecutor']

RARE_PERIOD = 0.1
"""Longest that a service request or an event of the middleware waits, s."""


class LeanExecutor(SingleThreadedExecutor):
    """
    Look at services and at events of the middleware ten times a second only.

    rclpy gathers everything that a node has before each wait: a dozen services and a dozen events
    beside two topics, which costs more than what most messages bring.
    """

    def __init__(self, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        self._rare = True
        self._looked = False
        self._next_look = 0.0

    def can_execute(self, entity: Any) -> bool:
        """Whether to wait for something; rclpy asks before each wait."""
        if isinstance(entity, (Service, Waitable)):
            if not self._rare:
                return False
            self._looked = True
        return bool(super().can_execute(entity))

    def wait_for_ready_callbacks(
        self, timeout_sec: Any = None, *args: Any, **kwargs: Any
    ) -> tuple[Any, Any, Any]:
        """Return what is ready next; every way of spinning asks here."""
        now = time.monotonic()
        if self._looked:
            self._looked = False
            self._next_look = now + RARE_PERIOD
        self._rare = now >= self._next_look
        if timeout_sec is None:
            # A wait without services must end.
            timeout_sec = RARE_PERIOD
        return super().wait_for_ready_callbacks(timeout_sec, *args, **kwargs)
