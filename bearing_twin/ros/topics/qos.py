# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Quality of service of every topic, in one place; each can be overridden by parameters."""

from __future__ import annotations

import copy
import math

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

HELD = 2.0
"""Time whose blocks a publisher holds for those who have missed one, s."""


def profile(depth: int, *, reliable: bool = True, latched: bool = False) -> QoSProfile:
    """Return a profile that keeps the last messages; ``latched`` ones also for late listeners."""
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def stream(period: float) -> QoSProfile:
    """Return the profile of vibration, and of what comes with each block of ``period`` s."""
    return profile(max(10, math.ceil(HELD / period)))


STREAM = stream(0.04)
"""The same for blocks of 40 ms, and for those who listen."""

MEASUREMENT = profile(10, reliable=False)
"""Subscriptions to sensors: best effort matches reliable and best-effort publishers alike."""

SENSOR = profile(1000, reliable=False)
"""Subscription of the adapter: as above, deep enough for one sample a message."""

RESULT = profile(10)
"""Diagnosis, spectra, diagnostics."""

CHECKPOINT = profile(1, latched=True)
"""Checkpoints: a recorder that starts late still gets the last one."""

OVERRIDES = QoSOverridingOptions.with_default_policies()
"""Lets users set history, depth and reliability as ``qos_overrides.TOPIC.publisher.depth``."""


def own(profile: QoSProfile) -> QoSProfile:
    """Return a copy for one topic: rclpy writes overrides into the profile it is given."""
    return copy.copy(profile)
