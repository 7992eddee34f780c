# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Subscribe with validation: malformed messages are rejected and logged."""

from __future__ import annotations

from collections.abc import Callable, Mapping
import time
from types import MappingProxyType
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.ros.topics.qos import OVERRIDES, own
from bearing_twin.stamps import LATEST, NANO, stamp_ns
from rclpy.qos import qos_check_compatible, QoSCompatibility
from rclpy.serialization import deserialize_message
from rosgraph_msgs.msg import Clock

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup
    from rclpy.node import Node
    from rclpy.qos import QoSProfile
    from rclpy.subscription import MessageInfo, Subscription


HEADER = 4
"""Bytes of the CDR header: encoding of the message, and number of padding bytes at its end."""
LARGEST = 16 * 1024 * 1024
"""Largest message, bytes: twice the longest block of both axes."""


def receiver_clock(node: Node) -> Callable[[], float]:
    """
    Return the clock for the age of inputs, s: simulated time if the node uses it.

    Simulated time counts from its first reading, which may come after the first input.
    """
    # use_sim_time does not change while a node is configured.
    if not node.get_parameter('use_sim_time').value:
        return time.monotonic
    clock, first = node.get_clock(), 0

    def simulated() -> float:
        nonlocal first
        now = clock.now().nanoseconds
        first = first or now
        return float((now - first) / NANO)

    return simulated


def read_message(cdr: bytes, kind: type) -> Any:
    """
    Return the ROS message of class ``kind`` in ``cdr``, the received bytes.

    Fast CDR (2.3.3) subtracts the padding from the length without a check, and then reads beyond
    the end of the memory. So four bytes from any sender could end the process; this is checked
    here.
    """
    if len(cdr) > LARGEST:
        raise BearingTwinError(
            f'{len(cdr)} bytes are too large a {kind.__name__}: {LARGEST} at most are taken; '
            'send shorter messages'
        )
    if len(cdr) < HEADER or len(cdr) - HEADER < cdr[HEADER - 1] & 3:
        raise BearingTwinError(f'{len(cdr)} bytes are no {kind.__name__}: refused')
    try:
        return deserialize_message(cdr, kind)
    except Exception as error:
        # The bytes come from outside; rclpy raises RMWError or UnicodeDecodeError.
        msg = f'{len(cdr)} bytes are no {kind.__name__} ({type(error).__name__}): refused'
        raise BearingTwinError(msg) from None


def subscribe(
    node: Node,
    kind: Any,
    topic: str,
    callback: Callable[[Any, MessageInfo], None],
    qos: QoSProfile,
    *,
    group: CallbackGroup | None = None,
    refused: Callable[[str], None] | None = None,
) -> Subscription[Any]:
    """
    Subscribe to a topic; its QoS can be overridden by parameters.

    ``refused`` is called with the reason if a message is rejected; by default it is logged.
    """
    return node.create_subscription(
        kind,
        topic,
        validated(node, kind, topic, callback, refused),
        own(qos),
        raw=True,
        callback_group=group,
        qos_overriding_options=OVERRIDES,
    )


def with_mismatch_reasons(
    node: Node,
    subscription: Subscription[Any],
    text: str,
    remedies: Mapping[str, str] = MappingProxyType({}),
) -> str:
    """
    Return ``text`` with the topic, and the reasons why messages of its publishers cannot arrive.

    ``remedies`` tells for other types than the one subscribed to what to do.
    """
    kind = subscription.msg_type
    name = f'{kind.__module__.split(".")[0]}/msg/{kind.__name__}'
    reasons = []
    for info in node.get_publishers_info_by_topic(subscription.topic_name):
        if info.topic_type != name:
            remedy = remedies.get(info.topic_type, '')
            reasons.append(
                f'it is published as {info.topic_type}, not {name}{remedy and f": {remedy}"}'
            )
            continue
        fits, why = qos_check_compatible(info.qos_profile, subscription.qos_profile)
        if fits == QoSCompatibility.ERROR:
            reasons.append(
                f'the QoS of its publisher does not match ({why.strip(" ;")}): set qos_overrides.'
                f'{subscription.topic_name}.subscription.reliability to best_effort'
            )
    why = '; '.join(dict.fromkeys(reasons))
    return f'{text} on {subscription.topic_name}{why and f": {why}"}'


def unheard(node: Node, subscription: Subscription[Any]) -> str:
    """Return "not heard" and why, as `with_mismatch_reasons` says; '' if there is no reason."""
    said = with_mismatch_reasons(node, subscription, 'not heard')
    return said if ': ' in said else ''


def validated(
    node: Node,
    kind: Any,
    topic: str,
    callback: Callable[[Any, MessageInfo], None],
    refused: Callable[[str], None] | None = None,
) -> Callable[[bytes, MessageInfo], None]:
    """Return a callback for serialised messages; it passes valid ones to ``callback``."""

    def log(reason: str) -> None:
        node.get_logger().warning(f'{topic}: {reason}', throttle_duration_sec=10.0)

    def on_bytes(cdr: bytes, info: MessageInfo) -> None:
        try:
            message = read_message(cdr, kind)
            if kind is Clock:
                _check_time(message)
        except BearingTwinError as error:
            (refused or log)(str(error))
            return
        callback(message, info)

    return on_bytes


def _check_time(message: Clock) -> None:
    """Raise BearingTwinError for a time outside the range of a stamp: rclpy would end the node."""
    if not 0 <= stamp_ns(message.clock) <= LATEST:
        raise BearingTwinError(
            f'time {message.clock.sec} s + {message.clock.nanosec} ns is outside '
            f'0..{LATEST // NANO} s: refused'
        )
