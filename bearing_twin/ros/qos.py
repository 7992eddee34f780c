# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Quality of service of every topic, in one place; each can be overridden by parameters."""

from __future__ import annotations

import copy
import math

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

__all__ = [
    'CHECKPOINT',
    'MEASUREMENT',
    'OVERRIDES',
    'RESULT',
    'SENSOR',
    'STREAM',
    'own',
    'stream',
]

HELD = 2.0
"""Time whose blocks a publisher holds for those who have missed one, s."""


def stream(period: float) -> QoSProfile:
    """Return the profile of vibration, and of what comes with each block of ``period`` s."""
    depth = max(10, math.ceil(HELD / period))
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST, depth=depth, reliability=ReliabilityPolicy.RELIABLE
    )


STREAM = stream(0.04)
"""The same for blocks of 40 ms, and for those who listen."""

MEASUREMENT = QoSProfile(
    history=HistoryPolicy.KEEP_LAST, depth=10, reliability=ReliabilityPolicy.BEST_EFFORT
)
"""Subscriptions to sensors: best effort matches reliable and best-effort publishers alike."""

SENSOR = QoSProfile(
    history=HistoryPolicy.KEEP_LAST, depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT
)
"""Subscription of the adapter: as above, deep enough for one sample a message."""

RESULT = QoSProfile(
    history=HistoryPolicy.KEEP_LAST, depth=10, reliability=ReliabilityPolicy.RELIABLE
)
"""Diagnosis, spectra, diagnostics."""

CHECKPOINT = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
"""Checkpoints: a recorder that starts late still gets the last one."""

OVERRIDES = QoSOverridingOptions.with_default_policies()
"""Lets users set history, depth and reliability as ``qos_overrides.TOPIC.publisher.depth``."""


def own(profile: QoSProfile) -> QoSProfile:
    """Return a copy for one topic: rclpy writes overrides into the profile it is given."""
    return copy.copy(profile)
