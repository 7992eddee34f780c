# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""An executor whose cost per wait does not grow with the number of topics and services."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import ExitStack, suppress
import time
from typing import Any, TYPE_CHECKING

from rclpy.callback_groups import CallbackGroup
from rclpy.exceptions import InvalidHandle
from rclpy.executors import (
    ExternalShutdownException,
    ShutdownException,
    SingleThreadedExecutor,
    TimeoutException,
)
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.node import Node
    from rclpy.signals import SignalHandlerGuardCondition
    from rclpy.subscription import Subscription


RARE_PERIOD = 0.1
"""Interval of checking services and events of the middleware, s."""
SERVICES, EVENTS = 100, 10
"""Most services and events that are checked at a time; if there are more, they take turns."""
EARLY = 0.6
"""Part of its period after which a group is polled if the executor is awake anyway."""
AT_ONCE = 500
"""Most messages taken from a topic before other topics get a turn."""


class PolledGroup(CallbackGroup):
    """
    Subscriptions that the executor polls instead of waiting for them.

    Waiting for a topic costs 4 us each time, polling it 1 us.

    A message waits at most ``period`` seconds, and less if the executor is awake anyway.
    """

    def __init__(self, period: float) -> None:
        super().__init__()
        self.period = period
        self.asked = 0.0
        """Time of the last poll, s of the monotonic clock."""

    def can_execute(self, entity: Any) -> bool:
        """Return False, so that no executor waits for a subscription of the group."""
        return False

    def beginning_execution(self, entity: Any) -> bool:
        """Return False, so that no executor executes a subscription of the group."""
        return False

    def ending_execution(self, entity: Any) -> None:
        """Do nothing."""


class LeanExecutor(SingleThreadedExecutor):
    """
    Wait for timers and topics; check services and events of the middleware only rarely.

    Before each wait rclpy collects all entities of a node. It wraps each callback in a task, and
    wakes once more after it. That costs more than the work for most messages. This executor waits
    for timers, and for topics that are not in a `PolledGroup`. Ten times a second rclpy checks the
    rest in its usual way. Callbacks of timers and subscriptions must be plain functions.
    """

    _sigint_gc: SignalHandlerGuardCondition | None = None
    """Set late by rclpy, which looks for it when an executor is deleted that it refused."""

    def __init__(self, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        self._shares: dict[Node, _Share] = {}
        self._next_look = self._next_rare = 0.0
        self._timers: list[Any] = []
        self._clients: list[Any] = []
        self._prompt: list[Subscription[Any]] = []
        self._polled: dict[PolledGroup, list[Subscription[Any]]] = {}

    def get_nodes(self) -> list[Any]:
        """Return the part of each node that rclpy checks: services, events, clients, guards."""
        nodes = super().get_nodes()
        self._shares = {node: self._shares.get(node) or _Share(node) for node in nodes}
        return list(self._shares.values())

    def _spin_once_impl(
        self, timeout_sec: Any = None, wait_condition: Any = lambda: False
    ) -> None:
        """Execute ready callbacks or wait for them; all spin methods call this."""
        until = getattr(timeout_sec, 'timeout', timeout_sec)
        until = time.monotonic() + (RARE_PERIOD if until is None or until < 0.0 else until)
        try:
            while not wait_condition() and not self._is_shutdown:
                worked = self._look() if time.monotonic() >= self._next_look else False
                left = 0.0 if worked else min(until, self._due()) - time.monotonic()
                if self._wait(max(0.0, left)) or worked or time.monotonic() >= until:
                    return
        except ShutdownException:
            return

    def _due(self) -> float:
        """Return the latest time to wake, s of the monotonic clock."""
        return min([self._next_look, *(group.asked + group.period for group in self._polled)])

    def _look(self) -> bool:
        """Let rclpy check its part of the nodes; return whether a callback was executed."""
        now, worked = time.monotonic(), False
        for share in self.get_nodes():
            share.turn(rare=now >= self._next_rare)
        if now >= self._next_rare:
            self._next_rare = now + RARE_PERIOD
        self._next_look = self._next_rare
        try:
            while True:
                handler, _, _ = self.wait_for_ready_callbacks(timeout_sec=0.0)
                handler()
                # A service may be destroyed while its answer waited for the disk.
                with suppress(InvalidHandle):
                    handler.result()
                worked = True
        except TimeoutException:
            self._gather()
        return worked

    def _gather(self) -> None:
        """Collect the entities to wait for and to poll."""
        nodes = super().get_nodes()
        self._timers = [timer for node in nodes for timer in node.timers]
        self._clients = [client for node in nodes for client in node.clients]
        self._prompt, self._polled = [], {}
        for node in nodes:
            for subscription in node.subscriptions:
                if isinstance(group := subscription.callback_group, PolledGroup):
                    self._polled.setdefault(group, []).append(subscription)
                else:
                    self._prompt.append(subscription)

    def _wait(self, seconds: float) -> bool:
        """Wait and execute ready callbacks; return whether there were any."""
        context = self._context
        if context.handle is None:
            raise ExternalShutdownException
        guards = [guard for guard in (self._guard, self._sigint_gc) if guard is not None]
        # Entities in the stack are not destroyed before it is left.
        with ExitStack() as stack:
            stack.enter_context(context.handle)
            topics, timers = _usable(stack, self._prompt), _usable(stack, self._timers)
            clients, guards = _usable(stack, self._clients), _usable(stack, guards)
            sizes = len(topics), len(guards), len(timers), len(clients), 0, 0
            wait_set = _rclpy.WaitSet(*sizes, context.handle)
            wait_set.clear_entities()
            for subscription in topics:
                wait_set.add_subscription(subscription.handle)
            for guard in guards:
                wait_set.add_guard_condition(guard.handle)
            for timer in timers:
                wait_set.add_timer(timer.handle)
            for client in clients:
                wait_set.add_client(client.handle)
            wait_set.wait(int(seconds * 1e9))
            if self._is_shutdown:
                raise ShutdownException
            if not context.ok():
                raise ExternalShutdownException
            if wait_set.get_ready_entities('guard_condition'):
                # There are new entities, or a task was created.
                self._gather()
                if any(not task.done() for task, _, _ in self._tasks):
                    self._next_look = 0.0
            worked = self._poll()
            for timer in timers:
                if timer.handle.is_timer_ready():
                    _call(timer.handle)
                    timer.callback()
                    worked = True
            ready = wait_set.get_ready_entities('subscription')
            for subscription in topics:
                if subscription.handle.pointer in ready:
                    # One message per topic, so that other topics and /clock get a turn.
                    worked = _take(subscription, 1) or worked
            ready = wait_set.get_ready_entities('client')
            for client in clients:
                if client.handle.pointer in ready:
                    self._next_look = 0.0
        return worked

    def _poll(self) -> bool:
        worked, now = False, time.monotonic()
        for group, subscriptions in self._polled.items():
            if now - group.asked >= EARLY * group.period:
                group.asked = now
                for subscription in subscriptions:
                    worked = _take(subscription, AT_ONCE) or worked
        return worked


class _Share:
    """
    The part of a node that rclpy checks at a time.

    Services and events take turns, so that a check costs the same in a node with hundreds of them:
    rclpy compares each event with each other one.
    """

    subscriptions: tuple[()] = ()
    timers: tuple[()] = ()

    def __init__(self, node: Node) -> None:
        self._node = node
        self._looks = -1
        self.services: Sequence[Any] = ()
        self.waitables: Sequence[Any] = ()

    def turn(self, *, rare: bool) -> None:
        """Select the next services and events if ``rare``, else none."""
        self._looks += rare
        self.services = self._next(self._node.services, SERVICES) if rare else ()
        self.waitables = self._next(self._node.waitables, EVENTS) if rare else ()

    def _next(self, entities: Iterable[Any], most: int) -> list[Any]:
        entities = list(entities)
        turns = max(1, -(-len(entities) // most))
        return entities[self._looks % turns :: turns]

    @property
    def clients(self) -> Any:
        """Clients of services."""
        return self._node.clients

    @property
    def guards(self) -> Any:
        """Guard conditions."""
        return self._node.guards


def _usable(stack: ExitStack, entities: Iterable[Any]) -> list[Any]:
    """Return the entities that are not destroyed; ``stack`` keeps them until it is closed."""
    usable = []
    for entity in entities:
        try:
            stack.enter_context(entity.handle)
        except InvalidHandle:
            continue
        usable.append(entity)
    return usable


def _call(timer: Any) -> None:
    """Mark a timer as called, so that its next period begins."""
    if hasattr(timer, 'call_timer_with_info'):
        timer.call_timer_with_info()
    else:
        # rclpy 7 (Jazzy).
        timer.call_timer()


def _take(subscription: Any, most: int) -> bool:
    """Take up to ``most`` waiting messages of a topic; return whether there was one."""
    worked = False
    for _ in range(most):
        try:
            with subscription.handle:
                taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
        except InvalidHandle:
            break
        if taken is None:
            break
        worked = True
        if subscription._callback_type is subscription.CallbackType.MessageOnly:
            subscription.callback(taken[0])
        else:
            subscription.callback(*taken)
    return worked
