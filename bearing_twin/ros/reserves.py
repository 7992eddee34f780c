# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Which other nodes are in reserve: configured, but inactive."""

from __future__ import annotations

from contextlib import suppress
from functools import partial
import math
import time
from typing import Any, TYPE_CHECKING

from lifecycle_msgs.msg import State
from lifecycle_msgs.srv import GetState
from rclpy.exceptions import NameValidationException

if TYPE_CHECKING:
    from rclpy.client import Client
    from rclpy.node import Node
    from rclpy.task import Future


PERIOD = 1.0
"""Shortest time between two requests to one node, s."""
MOST = 64
"""Most nodes that are asked."""


class Reserves:
    """Ask other nodes for their lifecycle state: inactive ones have publishers, but are silent."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._clients: dict[str, Client[Any, Any]] = {}
        self._requests: dict[str, tuple[float, Future[Any] | None]] = {}
        self._inactive: set[str] = set()

    def is_inactive(self, name: str) -> bool:
        """
        Return whether the node of a full name was inactive when it last answered; ask it again.

        False for a node that does not answer or has no lifecycle.
        """
        asked, request = self._requests.get(name, (-math.inf, None))
        now = time.monotonic()
        if now - asked > PERIOD:
            # A name in the graph may be of no ROS node.
            with suppress(NameValidationException):
                self._requests[name] = now, self._ask(name, request)
        return name in self._inactive

    def _ask(self, name: str, former: Future[Any] | None) -> Future[Any] | None:
        """Send a request if the service is there; drop the former one if it has no answer."""
        client = self._clients.get(name)
        # A client ends with the lifecycle state of this node in which it was made.
        if client is None or client not in [*self._node.clients]:
            self._clients[name] = self._node.create_client(GetState, f'{name}/get_state')
            if len(self._clients) > MOST:
                self._forget(next(iter(self._clients)))
            return None
        if former is not None:
            client.remove_pending_request(former)
        if not client.service_is_ready():
            return None
        request = client.call_async(GetState.Request())
        request.add_done_callback(partial(self._take, name))
        return request

    def _take(self, name: str, request: Future[Any]) -> None:
        answer = request.result()
        if answer is not None and answer.current_state.id == State.PRIMARY_STATE_INACTIVE:
            self._inactive.add(name)
        else:
            self._inactive.discard(name)

    def _forget(self, name: str) -> None:
        self._node.destroy_client(self._clients.pop(name))
        self._requests.pop(name, None)
        self._inactive.discard(name)
