# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""List the publishers, subscriptions, services and timers of a node, and remove new ones."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable

    from rclpy.lifecycle import LifecycleNode


def entities(node: LifecycleNode) -> set[Any]:
    """Return publishers, subscriptions, services, clients and timers of a node."""
    return {
        *(*node.publishers, *node.subscriptions),
        *(*node.services, *node.clients, *node.timers),
    }


def destroy_new(node: LifecycleNode, before: Collection[Any]) -> None:
    """Destroy all entities of a node that are not in ``before``."""
    destroyers: tuple[tuple[Iterable[Any], Callable[[Any], bool]], ...] = (
        (node.timers, node.destroy_timer),
        (node.clients, node.destroy_client),
        (node.services, node.destroy_service),
        (node.subscriptions, node.destroy_subscription),
        (node.publishers, node.destroy_lifecycle_publisher),
    )
    for made, destroy in destroyers:
        for entity in list(made):
            if entity not in before:
                destroy(entity)
