# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Topics of any type as bytes: message classes by name, and QoS profiles for recordings."""

from __future__ import annotations

from collections.abc import Sequence
import importlib
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcap.schema import message_schema
from bearing_twin.recording.qos import qos_profile, qos_yaml, read_qos
from bearing_twin.ros.topics.qos import DEEPEST, profile
from rclpy.exceptions import NameValidationException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.type_support import check_for_type_support
from rclpy.validate_full_topic_name import validate_full_topic_name

if TYPE_CHECKING:
    from rclpy.topic_endpoint_info import TopicEndpointInfo


SUBSCRIPTION_DEPTH = 500
"""Messages queued while a slow disk delays the recorder: 20 s of blocks of 40 ms."""


def check_topic_name(name: str, what: str) -> None:
    """Refuse the name of a topic that ROS cannot have; ``what`` names the value in the error."""
    try:
        validate_full_topic_name(expand_topic_name(name, 'node', '/'))
    except (ValueError, NameValidationException) as error:
        reason = str(error).partition(', at ')[0].splitlines()[0].rstrip(':')
        raise BearingTwinError(f'{what}: {reason}') from None


def message_class(type_name: str) -> Any:
    """Return the Python class of ``pkg/msg/Type``; raise BearingTwinError if it is of no use."""
    parts = type_name.split('/')
    why, remedy = 'is not installed', 'source the workspace that has it'
    if len(parts) == 3 and parts[1] == 'msg' and all(part.isidentifier() for part in parts):
        try:
            found = getattr(importlib.import_module(f'{parts[0]}.msg'), parts[2])
            check_for_type_support(found)
        except (ModuleNotFoundError, AttributeError):
            pass
        except Exception as error:
            # Importing a package that was built for another Python may raise anything.
            why = f'cannot be used ({type(error).__name__}: {error})'
            remedy = f'build {parts[0]} for this Python'
        else:
            return found
    raise BearingTwinError(f'message type {type_name} {why}; {remedy}')


def published_type(publishers: Sequence[TopicEndpointInfo]) -> str:
    """
    Return the type that is published on a topic.

    Raises
    ------
    BearingTwinError
        If there are several types, or if the definition of a publisher differs from the installed
        one, so that its bytes would be misread.

    """
    types = sorted({info.topic_type for info in publishers})
    if len(types) > 1:
        msg = f'{" and ".join(types)} are published on it; give one of them another name'
        raise BearingTwinError(msg)
    type_name = types[0]
    ours = message_schema(type_name).type_hash
    # Publishers of releases before Iron do not send a type hash.
    theirs = {str(info.topic_type_hash) for info in publishers} - {'INVALID'}
    if theirs - {ours}:
        raise BearingTwinError(
            f'its publisher was built with another definition of {type_name} '
            f'({", ".join(sorted(theirs))}) than the installed one ({ours})'
        )
    return type_name


def subscription_qos(publishers: Sequence[TopicEndpointInfo]) -> QoSProfile:
    """Return the strongest profile that matches every publisher."""
    profiles = [info.qos_profile for info in publishers]
    return profile(
        SUBSCRIPTION_DEPTH,
        reliable=all(p.reliability == ReliabilityPolicy.RELIABLE for p in profiles),
        latched=all(p.durability == DurabilityPolicy.TRANSIENT_LOCAL for p in profiles),
    )


def offered_qos_yaml(publishers: Sequence[TopicEndpointInfo]) -> str:
    """Return the offered profiles of the publishers as text for a recording."""
    return qos_yaml(
        [
            qos_profile(
                history=info.qos_profile.history.name.lower(),
                depth=info.qos_profile.depth,
                reliability=info.qos_profile.reliability.name.lower(),
                durability=info.qos_profile.durability.name.lower(),
            )
            for info in publishers
        ]
    )


def replay_qos(text: str) -> QoSProfile:
    """Return a profile to publish with that matches the subscribers of the recorded topic."""
    profiles = read_qos(text)
    # Metadata before version 9 uses numbers: 2 is best effort, and 1 is transient local.
    best_effort = any(p.get('reliability') in ('best_effort', 2) for p in profiles)
    latched = bool(profiles) and all(
        p.get('durability') in ('transient_local', 1) for p in profiles
    )
    depths = [p.get('depth') for p in profiles]
    depth = max((d for d in depths if isinstance(d, int)), default=0)
    kept = min(max(depth, 1 if latched else 50), DEEPEST)
    return profile(kept, reliable=not best_effort, latched=latched)
