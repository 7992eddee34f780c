# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recorder node: every topic as it came off the wire, to MCAP and to Rerun."""

from __future__ import annotations

from collections import deque
import sys
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes.recorder_config import build_writer, EXPECTED, SPECS, TopicChoice
from bearing_twin.nodes.recorder_watch import RecordingWatch
from bearing_twin.recording.recover import find_unfinished
from bearing_twin.recording.schema import message_schema
from bearing_twin.recording.snapshot import SnapshotWriter
from bearing_twin.ros.health import Health, Level, Status
from bearing_twin.ros.lifecycle import ManagedNode, run
from bearing_twin.ros.rawtopics import (
    deepened,
    matches,
    message_class,
    offered_qos_yaml,
    published_type,
    SUBSCRIPTION_DEPTH,
    subscription_qos,
)
from bearing_twin.stamps import NANO
from bearing_twin.view.rerun.ending import leave
from rclpy.clock import Clock, ClockType
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.logging import get_logger
from std_srvs.srv import Trigger

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rclpy.event_handler import QoSMessageLostInfo
    from rclpy.qos import QoSProfile
    from rclpy.subscription import MessageInfo, Subscription

__all__ = ['RecorderNode', 'main']

DISCOVERY_PERIOD = 0.25
LOGGER = 'bearing_twin.recorder'


class RecorderNode(ManagedNode):
    """Record topics: the bytes that came are the bytes that are written."""

    def __init__(self) -> None:
        super().__init__('recorder', SPECS)

    def check(self, values: Mapping[str, Any]) -> None:
        """Refuse parameters that do not fit together."""
        TopicChoice(values, set())

    def setup(self) -> None:
        """Make the recording; say what a crash has left."""
        p = self.parameters
        named = {self.resolve_topic_name(topic) for topic in p['topics'] if topic}
        self._choice = TopicChoice(p.values, named)
        self._writer = build_writer(p.values)
        try:
            self._begin()
        except Exception:
            # Told to end while it comes up: what has been made is finished.
            self._writer.close()
            raise
        self.get_logger().info(f'recording to {self._writer.path}')

    def _begin(self) -> None:
        self._unfinished = find_unfinished(self._writer.path.absolute().parent)
        for path in self._unfinished:
            self.get_logger().warning(
                f"{path} was not finished: 'bearing-twin recover {path}' saves what is in it"
            )
        self._subscriptions_of: dict[str, Subscription[Any]] = {}
        self._types: dict[str, str] = {}
        self._received: dict[str, int] = {}
        self._qos: dict[str, str] = {}
        self._left_out: dict[str, str] = {}
        self._early: deque[tuple[str, bytes, MessageInfo]] = deque(maxlen=SUBSCRIPTION_DEPTH)
        self._lost = 0
        self._longest_wait = 0
        self._answers = [
            self.create_service(Trigger, '~/split', self._on_split),
            self.create_service(Trigger, '~/snapshot', self._on_snapshot),
        ]
        self._health = Health(self, self.get_namespace())
        self._watch = RecordingWatch(self._writer, self.parameters.values, self.get_logger())
        self._health.add('recording', self._status)

    def start(self) -> None:
        """Subscribe, and look for new topics from now on."""
        for name, (type_name, qos) in EXPECTED.items():
            topic = self.resolve_topic_name(name)
            if topic in self._choice:
                self._subscribe(topic, type_name, deepened(qos))
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._timers_of_recording = [
            self.create_timer(DISCOVERY_PERIOD, self._discover, clock=steady),
            self.create_timer(self.parameters['flush_period'], self._flush, clock=steady),
        ]
        self._discover()

    def stop(self) -> None:
        """Write what has arrived; unsubscribe from everything."""
        for timer in self._timers_of_recording:
            self.destroy_timer(timer)
        self._take_what_waits()
        for subscription in self._subscriptions_of.values():
            self.destroy_subscription(subscription)
        self._subscriptions_of.clear()
        if self._early:
            self._lost += len(self._early)
            get_logger(LOGGER).error(
                f'{len(self._early)} messages are lost: there was no time on /clock for them'
            )
            self._early.clear()
        self._flush()

    def _take_what_waits(self) -> None:
        """Write what the middleware holds: their publishers believe that it has been received."""
        waiting: list[tuple[str, bytes, MessageInfo]] = []
        for topic, subscription in self._subscriptions_of.items():
            with subscription.handle:
                # No more than can have waited: some publisher may go on without a pause.
                for _ in range(SUBSCRIPTION_DEPTH):
                    taken = subscription.handle.take_message(subscription.msg_type, True)
                    if taken is None:
                        break
                    waiting.append((topic, *taken))
        # In the order in which it came, since simulated time may be the same for all of it.
        for message in sorted(waiting, key=lambda m: m[2]['received_timestamp'] or 0):
            self._on_message(*message)

    def teardown(self) -> None:
        """Finish the recording."""
        self._health.destroy()
        for service in self._answers:
            self.destroy_service(service)
        self._watch.close()
        self._writer.close()
        # Not the node's logger: its /rosout may be gone by now.
        get_logger(LOGGER).info(
            f'{self._writer.path}: {self._writer.written} messages, '
            f'{self._writer.size / 1e6:.1f} MB, {self._writer.dropped} lost'
        )

    def _discover(self) -> None:
        for topic, _ in self.get_topic_names_and_types():
            if topic not in self._choice or topic in self._left_out:
                continue
            publishers = self.get_publishers_info_by_topic(topic)
            if not publishers:
                continue
            try:
                type_name = published_type(publishers)
                qos = subscription_qos(publishers)
                known = self._subscriptions_of.get(topic)
                if known is None or (
                    self._types[topic] != type_name or not matches(known.qos_profile, qos)
                ):
                    self._subscribe(topic, type_name, qos)
            except BearingTwinError as error:
                self._unsubscribe(topic)
                self._left_out[topic] = str(error)
                self.get_logger().error(f'{topic} is not recorded: {error}')

    def _subscribe(self, topic: str, type_name: str, qos: QoSProfile) -> None:
        message_schema(type_name)
        self._unsubscribe(topic)

        def on_message(cdr: bytes, info: MessageInfo) -> None:
            self._on_message(topic, cdr, info)

        self._types[topic] = type_name
        self._subscriptions_of[topic] = self.create_subscription(
            message_class(type_name),
            topic,
            on_message,
            qos,
            raw=True,
            event_callbacks=SubscriptionEventCallbacks(message_lost=self._on_lost),
        )

    def _unsubscribe(self, topic: str) -> None:
        former = self._subscriptions_of.pop(topic, None)
        if former is not None:
            self.destroy_subscription(former)

    def _on_message(self, topic: str, cdr: bytes, info: MessageInfo) -> None:
        if info['received_timestamp']:
            waited = time.time_ns() - info['received_timestamp']
            self._longest_wait = max(self._longest_wait, waited)
        received = self._log_time(topic, info)
        if not received:
            self._lost += len(self._early) == self._early.maxlen
            self._early.append((topic, cdr, info))
            return
        while self._early:
            early = self._early.popleft()
            self._write(*early, received)
        self._write(topic, cdr, info, received)

    def _log_time(self, topic: str, info: MessageInfo) -> int:
        """Return when a message was received, ns; 0 while /clock has not been heard of."""
        if self.get_parameter('use_sim_time').value:
            # It may jump back, as a recording that is played in a loop does; the log follows it.
            return int(self.get_clock().now().nanoseconds)
        received = info['received_timestamp'] or time.time_ns()
        # What is sent again after a loss arrives late and is handed out in order: by the time of
        # its arrival it would stand behind messages that follow it.
        self._received[topic] = max(received, self._received.get(topic, 0))
        return self._received[topic]

    def _write(self, topic: str, cdr: bytes, info: MessageInfo, received: int) -> None:
        type_name = self._types[topic]
        qos = self._qos.get(topic)
        if qos is None:
            qos = self._qos[topic] = self._offered(topic)
        self._writer.write(
            topic,
            type_name,
            cdr,
            log_time=received,
            publish_time=max(0, info['source_timestamp'] or received),
            qos=qos,
        )
        self._watch.see(topic, type_name, cdr, received)

    def _offered(self, topic: str) -> str:
        try:
            return offered_qos_yaml(self.get_publishers_info_by_topic(topic))
        except Exception:
            if self.context.ok():
                raise
            # Told to end: rclpy answers no more, and what has come is written nevertheless.
            return ''

    def _on_lost(self, info: QoSMessageLostInfo) -> None:
        self._lost += info.total_count_change

    def _flush(self) -> None:
        before = self._writer.problem
        self._writer.flush()
        if self._writer.problem and self._writer.problem != before:
            self.get_logger().error(f'not recording: {self._writer.problem}')
        elif before and not self._writer.problem:
            self.get_logger().info('the disk takes data again: recording goes on')

    def _on_split(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        if isinstance(self._writer, SnapshotWriter):
            response.message = 'each snapshot has a file of its own'
            return response
        try:
            self._writer.split()
        except BearingTwinError as error:
            response.message = str(error)
            return response
        response.success = True
        return response

    def _on_snapshot(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        try:
            self._watch.snapshot(self.get_clock().now().nanoseconds)
        except BearingTwinError as error:
            response.message = str(error)
            return response
        response.success = True
        response.message = str(self._writer.path)
        return response

    def _status(self) -> Status:
        writer = self._writer
        values = {
            'output': writer.path,
            'messages written': writer.written,
            'messages lost by the disk': writer.dropped,
            'messages lost on the way': self._lost,
            'longest wait of a message [s]': self._longest_wait / NANO,
            'pictures not shown to live viewers': self._watch.pictures_dropped,
            'size [MB]': writer.size / 1e6,
            'topics': len(self._subscriptions_of),
            **{f'not recorded: {topic}': reason for topic, reason in self._left_out.items()},
            **{f'unfinished {i}': path for i, path in enumerate(self._unfinished)},
        }
        self._longest_wait = 0
        if writer.stopped or writer.problem:
            return Status(
                Level.ERROR, f'not recording: {writer.stopped or writer.problem}', values
            )
        if self._left_out or self._lost or self._watch.problem or self._early:
            texts = [
                'waiting for the first time on /clock' if self._early else '',
                f'{len(self._left_out)} topics are not recorded' if self._left_out else '',
                f'{self._lost} messages were lost on the way' if self._lost else '',
                self._watch.problem,
            ]
            return Status(Level.WARN, '; '.join(filter(None, texts)), values)
        return Status(Level.OK, 'recording', values)


def main(args: list[str] | None = None) -> int:
    """Run the node."""
    status = run(RecorderNode, args)
    leave(status)
    return status


if __name__ == '__main__':
    sys.exit(main())
