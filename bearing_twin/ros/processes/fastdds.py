# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Settings of Fast DDS that our nodes need, where the user has none."""

from __future__ import annotations

import os
from pathlib import Path

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

PROFILES = ('FASTDDS_DEFAULT_PROFILES_FILE', 'FASTRTPS_DEFAULT_PROFILES_FILE')
TRANSPORTS = 'FASTDDS_BUILTIN_TRANSPORTS'
MODE = 'RMW_FASTRTPS_PUBLICATION_MODE'
"""Settings of Fast DDS in the environment."""
OLDER = not hasattr(_rclpy.Timer, 'call_timer_with_info')
"""Whether it is Fast DDS 2 (Jazzy, whose timers lack this)."""


def set_up_fast_dds() -> None:
    """
    Let Fast DDS neither hold up a publisher, nor lose blocks, nor keep large messages.

    By default its sockets block for seconds when the other host has gone, and so would every
    deadline: what a pulled cable cannot take is dropped, and sent again if it is still in the
    writer's history. That a reader lacks it is found by heartbeats, by default each 3 s, which is
    longer than a block is held. And by default each place of a queue stays as large as the
    largest message that it has ever held. A user who has set up either, or the mode of
    publication, keeps it; other middleware does not look at this.
    """
    if any(name in os.environ for name in PROFILES):
        return
    os.environ.setdefault(TRANSPORTS, 'DEFAULT?non_blocking=true')
    if MODE in os.environ:
        # Fast DDS would not look at it beside a profile.
        return
    # Fast DDS 2 knows only the older name; 3 warns of that one.
    profiles = 'fastdds2.xml' if OLDER else 'fastdds.xml'
    os.environ[PROFILES[OLDER]] = str(Path(__file__).with_name(profiles))
    os.environ.setdefault('RMW_FASTRTPS_USE_QOS_FROM_XML', '1')
