# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Set options of Fast DDS that the nodes need, unless the user has set them."""

from __future__ import annotations

import os
from pathlib import Path

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

PROFILES = ('FASTDDS_DEFAULT_PROFILES_FILE', 'FASTRTPS_DEFAULT_PROFILES_FILE')
TRANSPORTS = 'FASTDDS_BUILTIN_TRANSPORTS'
MODE = 'RMW_FASTRTPS_PUBLICATION_MODE'
"""Environment variables of Fast DDS: profile files, transports, publication mode."""
OLDER = not hasattr(_rclpy.Timer, 'call_timer_with_info')
"""Whether Fast DDS 2 is in use (ROS 2 Jazzy; its timers lack this method)."""


def set_up_fast_dds(*, fleet: bool) -> None:
    """
    Configure Fast DDS so that it does not block publishers, lose blocks or keep large buffers.

    By default its sockets block for seconds when the other host is gone, which would miss every
    deadline. With non-blocking sockets, data that cannot be sent is dropped, and sent again if it
    is still in the history of the writer. Heartbeats detect the loss, by default every 3 s, which
    is longer than blocks are kept. And by default each entry of a queue keeps the size of the
    largest message that it has ever held. A ``fleet`` gets more shared memory, as that of one node
    does not hold the blocks that it publishes in a row. Profiles, transports or a publication mode
    set by the user are not changed. Other middleware ignores these settings.
    """
    if any(name in os.environ for name in PROFILES):
        return
    large = '_fleet' if fleet and TRANSPORTS not in os.environ else ''
    os.environ.setdefault(TRANSPORTS, 'DEFAULT?non_blocking=true')
    if MODE in os.environ:
        # With a profile, Fast DDS would ignore the mode set by the user.
        return
    # Fast DDS 2 knows only the older name of the variable; version 3 warns about it.
    profiles = f'fastdds{2 if OLDER else ""}{large}.xml'
    os.environ[PROFILES[OLDER]] = str(Path(__file__).with_name(profiles))
    os.environ.setdefault('RMW_FASTRTPS_USE_QOS_FROM_XML', '1')
