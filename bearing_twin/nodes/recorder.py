# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recorder node: every topic as it came off the wire, to MCAP and to Rerun."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from datetime import datetime
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.parameters.recorder import SPECS
from bearing_twin.errors import BearingTwinError, UsageError
from bearing_twin.nodes.recorder_watch import RecordingWatch
from bearing_twin.recording.health import SENT_BEFORE
from bearing_twin.recording.recover import find_unfinished
from bearing_twin.recording.snapshot import SnapshotWriter
from bearing_twin.recording.topics import OWN_TOPICS
from bearing_twin.recording.writer import RecordingWriter, WriterOptions
from bearing_twin.ros.health import Health, Level, Status
from bearing_twin.ros.lifecycle import ManagedNode
from bearing_twin.ros.topics.qos import CHECKPOINT, RESULT, STREAM
from bearing_twin.ros.topics.raw import check_topic_name, offered_qos_yaml, SUBSCRIPTION_DEPTH
from bearing_twin.ros.topics.rawsubscriptions import RawSubscriptions, TopicChoice
from bearing_twin.stamps import NANO
from bearing_twin.streams.arrival import ArrivalTimes, MessageNumbers, MOST_HEARD
from bearing_twin.wholefile import free_path, given_path
from rclpy.clock import Clock, ClockType

if TYPE_CHECKING:
    from rclpy.qos import QoSProfile
    from rclpy.subscription import MessageInfo


DISCOVERY_PERIOD = 0.25
READING_TIME = 0.05
"""Longest time per flush for reading parameters from checkpoints, s; the rest waits."""
MIB = 1024 * 1024
ABOUT_NODES = ('diagnostic_msgs/', 'lifecycle_msgs/', 'rcl_interfaces/')
"""Types that nodes publish about themselves: at their start no subscriber can be there yet."""

OFFERED: dict[str, QoSProfile] = {
    'vibration': STREAM,
    'twin_state': STREAM,
    'twin_checkpoint': CHECKPOINT,
    'diagnosis_checkpoint': CHECKPOINT,
}
EXPECTED = {name: (kind, OFFERED.get(name, RESULT)) for name, kind in OWN_TOPICS.items()}
"""Topics of this package; the recorder subscribes before they are published, to lose no block.

A publisher with a weaker QoS offer is detected at once, and the subscription follows its offer.
"""


class RecorderNode(ManagedNode):
    """Record topics: the received bytes are written unchanged."""

    def __init__(self) -> None:
        super().__init__('recorder', SPECS)

    def check(self, values: Mapping[str, Any]) -> None:
        """Refuse invalid regular expressions and names of topics."""
        TopicChoice(values, set())
        for topic in filter(None, values['topics']):
            check_topic_name(topic, f"topics='{topic}'")

    def setup(self) -> None:
        """Open the recording; warn of unfinished recordings from earlier crashes."""
        p = self.parameters
        named = {self.resolve_topic_name(topic) for topic in p['topics'] if topic}
        choice = TopicChoice(p.values, named, self.get_namespace())
        self._topics = RawSubscriptions(self, choice, self._on_message)
        self._writer = build_writer(p.values)
        self._told = ''
        try:
            self._begin()
        except Exception:
            # Perhaps interrupted while starting: finish the recording.
            self._writer.close()
            raise
        self.get_logger().info(f'recording to {self._writer.path}')

    def _begin(self) -> None:
        # Found out now: the working directory may be removed.
        self._folder = self._writer.path.absolute().parent
        self._unfinished = find_unfinished(self._folder)
        for path in self._unfinished:
            self.get_logger().warning(
                f"{path} was not finished: 'bearing-twin recover {path}' saves what is in it"
            )
        self._arrivals = ArrivalTimes()
        self._qos: dict[str, str] = {}
        self._early: deque[tuple[str, str, bytes, MessageInfo]] = deque()
        self._early_size = 0
        self._lost = 0
        self._numbers = MessageNumbers()
        self._longest_wait = 0
        self.offer('~/split', self._split)
        self.offer('~/snapshot', self._snapshot)
        self.health = Health(self, self.get_namespace())
        self._watch = RecordingWatch(self._writer, self.parameters.values, self.get_logger())
        self.health.add('recording', self._status)

    def start(self) -> None:
        """Subscribe, and search for new topics from now on."""
        self._topics.expect(EXPECTED)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(DISCOVERY_PERIOD, self._topics.discover, clock=steady)
        self.create_timer(self.parameters['flush_period'], self._flush, clock=steady)
        self._topics.discover()

    def stop(self) -> None:
        """Write the messages that were received; the node destroys the subscriptions."""
        self._topics.close()
        # Messages sent until the node is active again do not count as lost.
        self._numbers.pause()
        if self._early:
            self._lost += len(self._early)
            self.get_logger().error(
                f'{len(self._early)} messages are lost: there was no time on /clock for them'
            )
            self._early.clear()
            self._early_size = 0
        self._flush()

    def teardown(self) -> None:
        """Finish the recording."""
        self._watch.close()
        try:
            self._writer.close()
        except BearingTwinError:
            # The error tells what is lost; what was written is not yet known to be on the disk.
            self.failed = True
            raise
        missing = self._lost_on_the_way
        self.get_logger().info(
            f'{self._writer.path}: {self._writer.written} messages, '
            f'{self._writer.size / 1e6:.1f} MB, {self._writer.lost} lost'
            + (f', {missing} more on the way' if missing else '')
        )

    def _on_message(self, topic: str, type_name: str, cdr: bytes, info: MessageInfo) -> None:
        if info['received_timestamp']:
            waited = time.time_ns() - info['received_timestamp']
            self._longest_wait = max(self._longest_wait, waited)
        if not type_name.startswith(ABOUT_NODES):
            self._numbers.count(
                topic, info.get('publisher_gid'), info['publication_sequence_number']
            )
        received = self._log_time(topic, info)
        if not received:
            self._wait_for_clock(topic, type_name, cdr, info)
            return
        while self._early:
            self._write(*self._early.popleft(), received)
        self._early_size = 0
        self._write(topic, type_name, cdr, info, received)

    def _wait_for_clock(self, topic: str, type_name: str, cdr: bytes, info: MessageInfo) -> None:
        """Keep a message until the first /clock; beyond a memory limit the oldest are dropped."""
        self._early.append((topic, type_name, cdr, info))
        self._early_size += len(cdr)
        most = self.parameters['max_cache_size'] * MIB
        while self._early and (len(self._early) > SUBSCRIPTION_DEPTH or self._early_size > most):
            self._early_size -= len(self._early.popleft()[2])
            self._lost += 1

    @property
    def _lost_on_the_way(self) -> int:
        # The middleware reports no losses while it considers this process dead; the message
        # numbers show them.
        return self._lost + max(self._numbers.skipped, self._topics.lost)

    def _log_time(self, topic: str, info: MessageInfo) -> int:
        """Return the time of reception of a message, ns; 0 before the first /clock."""
        if self.get_parameter('use_sim_time').value:
            # Simulated time may jump back when a recording is played in a loop; so does log time.
            return int(self.get_clock().now().nanoseconds)
        now = time.time_ns()
        return self._arrivals.of(topic, info['received_timestamp'] or now, now=now)

    def _write(
        self, topic: str, type_name: str, cdr: bytes, info: MessageInfo, received: int
    ) -> None:
        qos = self._qos.get(topic)
        if qos is None:
            if len(self._qos) >= MOST_HEARD:
                # The profiles are requested again.
                self._qos.clear()
            qos = self._qos[topic] = self._offered(topic)
        try:
            self._writer.write(
                topic,
                type_name,
                cdr,
                log_time=received,
                publish_time=max(0, info['source_timestamp'] or received),
                qos=qos,
            )
        except BearingTwinError as error:
            # A single file has no channel number left for another topic.
            self._lost += 1
            self.get_logger().error(str(error), once=True)
            return
        # The writer may have flushed by itself, if the timer was late: report its problem.
        self._tell_problem()
        self._watch.take(topic, type_name, cdr, received)

    def _offered(self, topic: str) -> str:
        try:
            return offered_qos_yaml(self.get_publishers_info_by_topic(topic))
        except Exception:
            if self.context.ok():
                raise
            # rclpy does not answer after a shutdown; still write the message.
            return ''

    def _flush(self) -> None:
        self._watch.read(READING_TIME)
        self._writer.flush()
        self._tell_problem()

    def _tell_problem(self) -> None:
        """Log a problem with the disk when it begins and when it ends."""
        problem = self._writer.problem
        if problem and problem != self._told:
            self.get_logger().error(f'not recording: {problem}')
        elif self._told and not problem:
            self.get_logger().info('the disk takes data again: recording goes on')
        self._told = problem

    def _split(self) -> str:
        if isinstance(self._writer, SnapshotWriter):
            raise BearingTwinError('each snapshot has a file of its own')
        self._writer.split()
        return ''

    def _snapshot(self) -> str:
        if not isinstance(self._writer, SnapshotWriter):
            msg = "everything is being recorded; snapshots need the parameter 'snapshot'"
            raise BearingTwinError(msg)
        self._writer.trigger(self.get_clock().now().nanoseconds)
        return str(self._writer.path)

    def _status(self) -> Status:
        writer, left_out = self._writer, self._topics.left_out
        lost = self._lost_on_the_way
        values = {
            'output': self._folder / writer.path.name,
            'messages_written': writer.written,
            'messages_lost_by_disk': writer.lost,
            'messages_lost_on_the_way': lost,
            'longest_wait_s': self._longest_wait / NANO,
            'pictures_dropped': self._watch.pictures_dropped,
            'size_mb': writer.size / 1e6,
            'topics': len(self._topics),
            'topics_left_out': len(left_out),
            'why_left_out': '; '.join(f'{topic}: {why}' for topic, why in left_out.items()),
            'messages_sent_before': self._numbers.sent_before.total(),
            SENT_BEFORE: '; '.join(
                f'{topic} {n}' for topic, n in self._numbers.sent_before.items()
            ),
            'unfinished': '; '.join(map(str, self._unfinished)),
        }
        self._longest_wait = 0
        if writer.stopped or writer.problem:
            return Status(
                Level.ERROR, f'not recording: {writer.stopped or writer.problem}', values
            )
        texts = [
            'waiting for the first time on /clock' if self._early else '',
            'none of the chosen topics exists' if self.active and not self._topics else '',
            f'{len(left_out)} topics are not recorded, or not in each type' if left_out else '',
            f'{lost} messages were lost on the way' if lost else '',
            f'{writer.lost} messages were lost by the disk' if writer.lost else '',
            writer.sync_problem and f'not safe from power loss: {writer.sync_problem}',
            self._watch.problem,
        ]
        if any(texts):
            return Status(Level.WARN, '; '.join(filter(None, texts)), values)
        return Status(Level.OK, 'recording', values)


def build_writer(values: Mapping[str, Any]) -> RecordingWriter:
    """Return the writer for the given parameters; this creates the recording."""
    path = given_path(values['output'] or f'bearing_twin_{datetime.now():%Y%m%d-%H%M%S}')
    if not path.name:
        msg = f"output='{path}' has no name of its own: give a new folder, or a file .mcap"
        raise UsageError(msg)
    path = free_path(path)
    options = WriterOptions(
        compression=values['compression'],
        flush_period=values['flush_period'],
        split_size=values['max_bag_size'] * MIB,
        split_duration=values['max_bag_duration'],
        storage_limit=values['storage_limit'] * MIB,
        delete_oldest=values['delete_oldest'],
        cache_size=values['max_cache_size'] * MIB,
        sync_period=values['sync_period'],
    )
    if not values['snapshot']:
        return RecordingWriter(path, options)
    return SnapshotWriter(
        path,
        options,
        before=values['snapshot_before'],
        after=values['snapshot_after'],
        memory=values['snapshot_memory'] * MIB,
    )


NODE = RecorderNode
