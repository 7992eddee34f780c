# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Offered QoS profiles of a topic in the format of rosbag2 recordings (metadata version 9)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.plainyaml import load_plain
import yaml

NEVER = {'sec': 9223372036, 'nsec': 854775807}
"""The infinite duration of rmw."""


def qos_profile(
    *,
    history: str = 'keep_last',
    depth: int = 10,
    reliability: str = 'reliable',
    durability: str = 'volatile',
) -> dict[str, Any]:
    """Return one profile with the field names of rosbag2."""
    return {
        'history': history,
        'depth': depth,
        'reliability': reliability,
        'durability': durability,
        'deadline': dict(NEVER),
        'lifespan': dict(NEVER),
        'liveliness': 'automatic',
        'liveliness_lease_duration': dict(NEVER),
        'avoid_ros_namespace_conventions': False,
    }


def qos_yaml(profiles: Sequence[Mapping[str, Any]]) -> str:
    """Return profiles as the text of a channel's ``offered_qos_profiles``."""
    return str(yaml.safe_dump([dict(p) for p in profiles], sort_keys=False)).strip()


def sensor_qos() -> str:
    """Return the profile text of a reliable publisher of sensor data."""
    return qos_yaml([qos_profile()])


def read_qos(text: str) -> list[dict[str, Any]]:
    """Return the profiles in ``offered_qos_profiles``; unreadable ones are ignored."""
    try:
        profiles = load_plain(text, 'the offered QoS')
    except BearingTwinError:
        return []
    if not isinstance(profiles, list):
        return []
    return [profile for profile in profiles if isinstance(profile, dict)]
