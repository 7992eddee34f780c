# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Subscribe to topics of any type when they appear; messages are passed on as bytes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
import re
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcap.schema import message_schema
from bearing_twin.ros.executor import PolledGroup
from bearing_twin.ros.topics.qos import own
from bearing_twin.ros.topics.raw import (
    message_class,
    published_type,
    SUBSCRIPTION_DEPTH,
    subscription_qos,
)
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import qos_check_compatible, QoSCompatibility

if TYPE_CHECKING:
    from rclpy.event_handler import QoSMessageLostInfo
    from rclpy.node import Node
    from rclpy.qos import QoSProfile
    from rclpy.subscription import MessageInfo, Subscription

    OnMessage = Callable[[str, str, bytes, MessageInfo], None]


MOST_SILENT = 500
"""Most topics without a publisher that stay subscribed, or reported as left out."""
POLL_PERIOD = 0.02
"""Longest time that a message waits, s: enough for 25 000 messages per second on one topic."""


class TopicChoice:
    """
    The set of topics to subscribe to.

    Parameters
    ----------
    values
        Parameters ``regex``, ``exclude`` and ``include_hidden`` of the node.
    resolved
        Resolved names of the parameter ``topics``.
    namespace
        Namespace of the node; it replaces ``{namespace}`` in ``regex`` and ``exclude``.

    """

    def __init__(
        self, values: Mapping[str, Any], resolved: set[str], namespace: str = '/'
    ) -> None:
        self._named = resolved
        self._regex, self._exclude = (
            _compiled(name, values[name].replace('{namespace}', re.escape(namespace.rstrip('/'))))
            for name in ('regex', 'exclude')
        )
        self._hidden = bool(values['include_hidden'])

    def __contains__(self, topic: str) -> bool:
        """Return whether ``topic`` is chosen."""
        if topic in self._named:
            return True
        if self._exclude is not None and self._exclude.fullmatch(topic):
            return False
        if not self._hidden and any(part.startswith('_') for part in topic.split('/')):
            return False
        if self._regex is not None:
            return bool(self._regex.fullmatch(topic))
        return not self._named


class RawSubscriptions:
    """Subscriptions to the chosen topics, with the type and QoS of their publishers."""

    def __init__(self, node: Node, choice: TopicChoice, on_message: OnMessage) -> None:
        self.lost = 0
        """Messages that the middleware reported as lost."""
        self.left_out: dict[str, str] = {}
        """Why a topic, or one of its types, is not subscribed to, by topic."""
        self._refused: dict[str, set[tuple[str, str]]] = {}
        self._node = node
        self._choice = choice
        self._on_message = on_message
        self._types: dict[str, str] = {}
        self._subscriptions: dict[str, Subscription[Any]] = {}
        self._expected: set[str] = set()
        # Known topics without a publisher, in the order in which they lost it.
        self._silent: dict[str, None] = {}
        # In simulated time do not poll: messages are dated by /clock when they are taken.
        simulated = node.get_parameter('use_sim_time').value
        self._group = None if simulated else PolledGroup(POLL_PERIOD)

    def __len__(self) -> int:
        """Return the number of topics subscribed to."""
        return len(self._subscriptions)

    def expect(self, topics: Mapping[str, tuple[str, QoSProfile]]) -> None:
        """Subscribe to the chosen ones of these topics before they have a publisher."""
        for name, (type_name, qos) in topics.items():
            topic = self._node.resolve_topic_name(name)
            if topic in self._choice:
                deep = own(qos)
                deep.depth = SUBSCRIPTION_DEPTH
                self._subscribe(topic, type_name, deep)
                self._expected.add(topic)

    def discover(self) -> None:
        """
        Subscribe to new topics, and again to topics whose type or QoS has changed.

        A subscription keeps its type while that type is published, even beside others. It also
        stays when all publishers are gone, so that no message is missed when one returns. It ends
        when ``MOST_SILENT`` other topics have lost their publishers after it.
        """
        published = set()
        for topic, _ in self._node.get_topic_names_and_types():
            if topic not in self._choice:
                continue
            publishers = self._node.get_publishers_info_by_topic(topic)
            kinds = {(info.topic_type, str(info.topic_type_hash)) for info in publishers}
            if publishers:
                published.add(topic)
            if not publishers or kinds == self._refused.get(topic):
                continue
            if (renamed := self._node.resolve_topic_name(topic)) != topic:
                # A subscription would be made to the remapped topic instead.
                self._leave_out(topic, f'a remap rule of this node makes {renamed} of it')
                continue
            known = self._subscriptions.get(topic)
            former = self._types[topic] if known else ''
            same = [info for info in publishers if info.topic_type == former] or publishers
            try:
                type_name = published_type(same)
                qos = subscription_qos(same)
                if known is None or former != type_name or _misses(known.qos_profile, qos):
                    self._subscribe(topic, type_name, qos)
            except OSError as error:
                # Of no descriptor that is left, for instance: it is tried again.
                self._leave_out(topic, str(error))
            except BearingTwinError as error:
                self._unsubscribe(topic)
                self._refused[topic] = kinds
                self._leave_out(topic, str(error))
            else:
                self._refused.pop(topic, None)
                others = ' and '.join(sorted({kind for kind, _ in kinds} - {type_name}))
                self._leave_out(topic, others and f'{others} beside {type_name}')
        self._forget_silent(published)

    def _forget_silent(self, published: set[str]) -> None:
        for topic in published & self._silent.keys():
            del self._silent[topic]
        known = self._subscriptions.keys() | self.left_out.keys()
        self._silent |= dict.fromkeys(known - published - self._expected - self._silent.keys())
        while len(self._silent) > MOST_SILENT:
            topic = next(iter(self._silent))
            del self._silent[topic]
            self._unsubscribe(topic)
            for about in (self._types, self._refused, self.left_out):
                about.pop(topic, None)

    def _leave_out(self, topic: str, why: str) -> None:
        """Note and log why a topic, or one of its types, is not recorded; '' if all are."""
        if why == self.left_out.get(topic, ''):
            return
        if why:
            self.left_out[topic] = why
            how = 'recorded in one type only' if topic in self._subscriptions else 'not recorded'
            self._node.get_logger().error(f'{topic} is {how}: {why}')
        else:
            del self.left_out[topic]
            self._node.get_logger().info(f'{topic} is recorded, all of it')

    def close(self) -> None:
        """Take the queued messages of all topics; the node destroys the subscriptions."""
        self._take_waiting(*self._subscriptions)

    def _subscribe(self, topic: str, type_name: str, qos: QoSProfile) -> None:
        message_schema(type_name)
        self._unsubscribe(topic)

        def on_bytes(cdr: bytes, info: MessageInfo) -> None:
            self._on_message(topic, type_name, cdr, info)

        self._types[topic] = type_name
        self._subscriptions[topic] = self._node.create_subscription(
            message_class(type_name),
            topic,
            on_bytes,
            qos,
            raw=True,
            callback_group=self._group,
            event_callbacks=SubscriptionEventCallbacks(message_lost=self._on_lost),
        )

    def _unsubscribe(self, topic: str) -> None:
        for subscription in self._take_waiting(topic):
            self._node.destroy_subscription(subscription)

    def _take_waiting(self, *topics: str) -> list[Subscription[Any]]:
        """Take the queued messages, which publishers consider received; return their origins."""
        former = {t: self._subscriptions.pop(t) for t in topics if t in self._subscriptions}
        waiting: list[tuple[str, bytes, MessageInfo]] = []
        for topic, subscription in former.items():
            with subscription.handle:
                # At most as many as the queue holds, as a publisher may send without a pause.
                for _ in range(SUBSCRIPTION_DEPTH):
                    taken = subscription.handle.take_message(subscription.msg_type, True)
                    if taken is None:
                        break
                    waiting.append((topic, *taken))
        # In order of reception, because simulated time may be the same for all of them.
        for topic, cdr, info in sorted(waiting, key=lambda m: m[2]['received_timestamp'] or 0):
            self._on_message(topic, self._types[topic], cdr, info)
        return list(former.values())

    def _on_lost(self, info: QoSMessageLostInfo) -> None:
        self.lost += info.total_count_change


def _misses(subscribed: QoSProfile, offered: QoSProfile) -> bool:
    """Return whether a subscription receives nothing from publishers with the offered profile."""
    return qos_check_compatible(offered, subscribed)[0] == QoSCompatibility.ERROR


def _compiled(name: str, text: str) -> re.Pattern[str] | None:
    try:
        return re.compile(text) if text else None
    except re.error as error:
        raise BearingTwinError(f"{name}='{text}' is no regular expression: {error}") from None
