# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Quality of service of all topics; users can override each one by parameters."""

from __future__ import annotations

import copy
import math
from typing import Any, TYPE_CHECKING

from rcl_interfaces.msg import SetParametersResult
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

if TYPE_CHECKING:
    from rclpy.lifecycle import LifecycleNode
    from rclpy.lifecycle.publisher import LifecyclePublisher


DEEPEST = 10_000
"""Largest depth of a queue, messages."""
HELD = 2.0
"""Duration of the blocks that a publisher keeps for subscribers that missed one, s."""


def profile(depth: int, *, reliable: bool = True, latched: bool = False) -> QoSProfile:
    """Return a profile that keeps the last messages; if ``latched``, for late subscribers too."""
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def stream(period: float) -> QoSProfile:
    """Return the profile of topics with one message per block; a block lasts ``period`` s."""
    return profile(max(10, math.ceil(HELD / period)))


STREAM = stream(0.04)
"""Profile of blocks of 40 ms, also used by subscriptions."""

MEASUREMENT = profile(10, reliable=False)
"""Subscriptions to sensors: best effort matches both reliable and best-effort publishers."""

SENSOR = profile(1000, reliable=False)
"""Subscription of the adapter: best effort, deep enough for one sample per message."""

RESULT = profile(10)
"""Diagnosis, spectra, diagnostics."""

CHECKPOINT = profile(1, latched=True)
"""Checkpoints: a recorder that starts late still receives the last one."""


def _check_depth(profile: QoSProfile) -> SetParametersResult:
    """Refuse a depth that the middleware cannot queue, or would silently take for its own."""
    successful = 1 <= profile.depth <= DEEPEST
    reason = f'depth={profile.depth} is outside 1..{DEEPEST}; choose a value inside'
    return SetParametersResult(successful=successful, reason='' if successful else reason)


OVERRIDES = QoSOverridingOptions.with_default_policies(callback=_check_depth)
"""Users can set history, depth and reliability as ``qos_overrides.TOPIC.publisher.depth``."""


def own(profile: QoSProfile) -> QoSProfile:
    """Return a copy for one topic, because rclpy writes overrides into the given profile."""
    return copy.copy(profile)


def advertise(
    node: LifecycleNode, kind: type, topic: str, profile: QoSProfile
) -> LifecyclePublisher[Any]:
    """Create a lifecycle publisher whose QoS can be overridden by parameters."""
    return node.create_lifecycle_publisher(
        kind, topic, own(profile), qos_overriding_options=OVERRIDES
    )
