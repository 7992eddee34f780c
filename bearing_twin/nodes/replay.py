# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Replay node: the topics of a recording on ROS again, and its time on /clock."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from itertools import islice
import math
import threading
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.messages import time_message
from bearing_twin.assets.parameters.spec import fixed, parameter
from bearing_twin.errors import BearingTwinError, shown, UsageError
from bearing_twin.recording.mcap.schema import message_schema
from bearing_twin.recording.player import Player
from bearing_twin.ros.health import Health, Level, Status
from bearing_twin.ros.lifecycle import ManagedNode
from bearing_twin.ros.topics.qos import RESULT
from bearing_twin.ros.topics.raw import check_topic_name, message_class, replay_qos
from bearing_twin.wholefile import given_path
from rclpy.duration import Duration
from rclpy.exceptions import NameValidationException
from rosgraph_msgs.msg import Clock

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.catalogue import RecordedMessage
    from bearing_twin.recording.reader import TopicInfo
    from rclpy.publisher import Publisher


PROGRESS_PERIOD = 5.0
LONGEST_WAIT = 0.5
LONG_WAIT = 60.0
"""Shortest wait for the next message that is logged, s."""
SHARED = ('/diagnostics', '/parameter_events', '/rosout', '/transition_event')
"""Ends of the names of topics that every node publishes."""
MOST_AT_ONCE = 100
"""Most messages to publish before services and parameters get a turn."""

SPECS = (
    fixed('recording', '', 'MCAP file or bag folder to replay.'),
    parameter('rate', 1.0, 'Pace: recorded seconds per second.', '', 0.001, 1e6),
    fixed('loop', False, 'Start again at the end.'),
    fixed('start_offset', 0.0, 'Recorded time to skip at the start.', 's', 0.0, 1e9),
    fixed('duration', 0.0, 'Recorded time to replay; 0: to the end.', 's', 0.0, 1e9),
    fixed('topics', [''], 'Topics to replay; none given: all.'),
    fixed('remap', [''], "Other names for recorded topics, each as 'recorded:=new'."),
    fixed('clock_rate', 0.0, 'Rate of /clock, which then follows recorded time; 0: no /clock.',
          'Hz', 0.0, 1000.0),
    fixed('start_paused', False, 'Wait for ~/resume.'),
    fixed('subscriber_timeout', 3.0, 'Longest wait at the start until every topic has a '
          'subscriber.', 's', 0.0, 3600.0),
    fixed('wait_for_nodes', [''], 'Nodes that have to subscribe to every topic by then too: '
          'recorder, in the namespace of this node, or /fan_7/recorder.'),
    fixed('exit_at_end', True, 'End the process when everything has been replayed.'),
)  # fmt: skip


class ReplayNode(ManagedNode):
    """
    Publish the messages of a recording at their own pace, or faster.

    The recorded bytes are published unchanged. A separate thread keeps the pace, so that services
    and parameters can answer.
    """

    def __init__(self) -> None:
        super().__init__('replay', SPECS)

    def check(self, values: Mapping[str, Any]) -> None:
        """Refuse invalid rules in ``remap``."""
        remapping(values['remap'])

    def setup(self) -> None:
        """Open the recording; create publishers and services."""
        p = self.parameters
        self._player = self._open()
        # Found out now: the working directory may be removed.
        self._path = self._player.path.absolute()
        for problem in self._player.info.problems:
            self.get_logger().warning(shown(f'not everything can be played: {problem}'))
        self._topics: dict[str, Publisher[Any]] = {}
        self._left_out: dict[str, str] = {}
        self._make_publishers(self._player.topics())
        self._clock_publisher = (
            self.create_publisher(Clock, '/clock', RESULT) if p['clock_rate'] else None
        )
        self.offer('~/pause', partial(self._set_paused, paused=True))
        self.offer('~/resume', partial(self._set_paused, paused=False))
        self.offer('~/step', self._step)
        self._wake = threading.Condition()
        self._running = False
        self._problem = ''
        self.health = Health(self, self.get_namespace())
        self.health.add('replay', self._status)

    def _open(self) -> Player:
        p = self.parameters
        if not p['recording']:
            raise UsageError("parameter recording is empty; give it: '-p recording:=FILE'")
        topics = [topic for topic in p['topics'] if topic]
        return Player(
            given_path(p['recording']),
            start_offset=p['start_offset'],
            duration=p['duration'] or math.inf,
            topics=topics or None,
            rate=p['rate'],
            loop=p['loop'],
            paused=p['start_paused'],
        )

    def _make_publishers(self, played: Mapping[str, TopicInfo]) -> None:
        """Create a publisher for each topic; those that cannot be published are left out."""
        p = self.parameters
        names = {
            recorded: self.resolve_topic_name(new)
            for recorded, new in remapping(p['remap']).items()
        }
        check_remapping(names, {name: topic.type_name for name, topic in played.items()})
        for name, topic in played.items():
            if p['clock_rate'] and name == '/clock':
                continue
            try:
                _check_definition(topic)
                self._topics[name] = self.create_publisher(
                    message_class(topic.type_name), names.get(name, name), replay_qos(topic.qos)
                )
            except (BearingTwinError, NameValidationException) as error:
                # Other recorders accept topic names that are invalid in ROS.
                self._left_out[name] = str(error)
                self.get_logger().error(shown(f'{name} is left out: {error}'))

    def start(self) -> None:
        """Start the thread that plays."""
        self._playing = True
        self._thread = threading.Thread(target=self._play, name='replay')
        self._thread.start()

    def stop(self) -> None:
        """Stop playing; a later start continues from here."""
        # Set before waiting for the lock, which a batch of messages may hold for long.
        self._playing = False
        with self._wake:
            self._wake.notify()
        self._thread.join()

    def apply(self, values: Mapping[str, Any]) -> None:
        """Apply a changed pace."""
        with self._wake:
            self._catch_up()
            self._player.rate = values['rate']
            self._wake.notify()

    def _catch_up(self) -> None:
        """Advance recorded time to now before the pace changes, if the thread is playing."""
        if self._running:
            self._player.wait(time.monotonic())

    def _play(self) -> None:
        try:
            self._play_through()
        except Exception as error:
            if self.executor is not None:
                # The executor ends the node, as after an error in any callback.
                self.executor.create_task(self._fail, error)

    def _fail(self, error: Exception) -> None:
        """Report why playing cannot continue; end the node with this error."""
        self._problem = str(error)
        self.failed = True
        self.health.publish()
        raise error

    def _play_through(self) -> None:
        if not self._await_subscribers():
            return
        player = self._player
        self.get_logger().info(
            f'replaying {player.path}: {player.info.count} messages, {player.info.duration:.1f} s '
            f'at pace {player.rate:g}'
        )
        clock_period = 1.0 / self.parameters['clock_rate'] if self._clock_publisher else math.inf
        clock_due = progress_due = time.monotonic()
        with self._wake:
            player.resync(time.monotonic())
            self._running = True
            while self._playing:
                now = time.monotonic()
                for message in islice(player.due(now), MOST_AT_ONCE):
                    self._publish(message)
                    if not self._playing:
                        break
                if now >= clock_due and not player.paused:
                    self._publish_clock()
                    clock_due = max(clock_due + clock_period, now)
                if now >= progress_due:
                    self._show_progress()
                    progress_due = now + PROGRESS_PERIOD
                if player.finished:
                    break
                now = time.monotonic()
                clock_wait = math.inf if player.paused else max(0.0, clock_due - now)
                self._wake.wait(min(player.wait(now), clock_wait, LONGEST_WAIT))
            self._running = False
        if player.finished:
            self._end()

    def _await_subscribers(self) -> bool:
        """Wait for the subscribers; return False if the node stops meanwhile."""
        deadline = time.monotonic() + self.parameters['subscriber_timeout']
        namespace = self.get_namespace().rstrip('/')
        names = (name for name in self.parameters['wait_for_nodes'] if name)
        wanted = {name if name.startswith('/') else f'{namespace}/{name}' for name in names}
        # rclpy prints an error if it is asked after a shutdown.
        while self._playing and self.context.ok() and time.monotonic() < deadline:
            if all(self._is_heard(p, wanted) for p in self._topics.values()):
                return True
            time.sleep(0.02)
        if not (self._playing and self.context.ok()):
            return False
        if wanted:
            self.get_logger().warning(
                f'{", ".join(sorted(wanted))}: not subscribed to every topic after '
                f'{self.parameters["subscriber_timeout"]:g} s; they may miss the first messages'
            )
        return True

    def _is_heard(self, publisher: Publisher[Any], wanted: set[str]) -> bool:
        matched = publisher.get_subscription_count()
        if not matched or not wanted:
            return matched > 0
        known = self.get_subscriptions_info_by_topic(publisher.topic_name)
        names = {f'{each.node_namespace.rstrip("/")}/{each.node_name}' for each in known}
        return matched >= len(known) and wanted <= names

    def _publish(self, message: RecordedMessage) -> None:
        publisher = self._topics.get(message.topic)
        if publisher is not None:
            publisher.publish(message.cdr)

    def _publish_clock(self) -> None:
        if self._clock_publisher is not None:
            self._clock_publisher.publish(Clock(clock=time_message(self._player.position)))

    def _show_progress(self) -> None:
        player = self._player
        wait = player.wait(time.monotonic())
        self.get_logger().info(
            f'{100.0 * player.fraction:3.0f} %  {player.played} messages'
            + (f'  round {player.loops + 1}' if player.loops else '')
            + ('  paused' if player.paused else '')
            + (f'  the next is due in {wait:.0f} s' if LONG_WAIT < wait < math.inf else '')
        )

    def _end(self) -> None:
        self._show_progress()
        for publisher in self._topics.values():
            # With best-effort publishers this returns at once.
            publisher.wait_for_all_acked(Duration(seconds=1))
        self.get_logger().info('the recording has ended')
        self.failed = bool(self._left_out or self._player.info.problems)
        if self.parameters['exit_at_end']:
            self.context.try_shutdown()

    def _set_paused(self, *, paused: bool) -> str:
        with self._wake:
            self._catch_up()
            self._player.paused = paused
            self._wake.notify()
        return f'{"paused" if paused else "playing"} at {self._player.position} ns'

    def _step(self) -> str:
        with self._wake:
            if not self._player.paused:
                raise BearingTwinError("not paused; call '~/pause' first")
            message = self._player.step()
            if message is None:
                raise BearingTwinError('at the end')
            self._publish(message)
            self._publish_clock()
            self._wake.notify()
        return f'{message.topic} at {message.log_time} ns'

    def _status(self) -> Status:
        player = self._player
        values = {
            'recording': self._path,
            'progress_percent': 100.0 * player.fraction,
            'messages': player.played,
            'pace': player.rate,
            'rounds_completed': player.loops,
            'paused': player.paused,
            'topics_left_out': len(self._left_out),
            'why_left_out': '; '.join(f'{topic}: {why}' for topic, why in self._left_out.items()),
        }
        if self._problem:
            return Status(Level.ERROR, self._problem, values)
        if self._left_out:
            return Status(Level.WARN, f'{len(self._left_out)} topics are left out', values)
        state = 'at the end' if player.finished else 'paused' if player.paused else 'playing'
        if live := self._live():
            text = (
                f'{state}; {live} published by other nodes, too: end these, or use remap or topics'
            )
            return Status(Level.WARN, text, values)
        return Status(Level.OK, state, values)

    def _live(self) -> str:
        """Return which replayed topics other nodes publish, with a verb; '' if they do not."""
        names = {publisher.topic_name for publisher in self._topics.values()}
        own = {name for name in names if not name.endswith(SHARED)}
        live = sorted(name for name in own if self.count_publishers(name) > 1)
        if not live:
            return ''
        return f'{live[0]} and {len(live) - 1} more are' if live[1:] else f'{live[0]} is'


def _check_definition(topic: TopicInfo) -> None:
    """Raise BearingTwinError if the recorded type differs from the installed message type."""
    try:
        ours = message_schema(topic.type_name).type_hash
    except BearingTwinError:
        return
    if topic.type_hash not in ('', 'INVALID', ours):
        msg = f'{topic.type_name} was recorded with another definition than the installed one'
        raise BearingTwinError(msg)


def remapping(rules: list[str]) -> dict[str, str]:
    """Return the new name by recorded name, from rules ``recorded:=new``."""
    names = {}
    for rule in filter(None, rules):
        recorded, separator, new = rule.partition(':=')
        if not (recorded and separator and new):
            raise BearingTwinError(f"remap='{rule}' does not read 'recorded:=new'")
        check_topic_name(new, f"remap='{rule}'")
        names[recorded] = new
    return names


def check_remapping(names: Mapping[str, str], types: Mapping[str, str]) -> None:
    """
    Refuse rules that do not match the recording; ``types`` holds the types of replayed topics.

    Raises
    ------
    BearingTwinError
        If a rule names a topic that is not replayed, or two topics of different types would have
        the same name.

    """
    unknown = sorted(names.keys() - types.keys())
    if unknown:
        raise BearingTwinError(
            f'remap names {", ".join(unknown)}, which is not replayed; '
            f'there is {", ".join(sorted(types))}'
        )
    taken: dict[str, str] = {}
    for topic, kind in sorted(types.items()):
        new = names.get(topic, topic)
        if taken.setdefault(new, kind) != kind:
            msg = f'remap puts {taken[new]} and {kind} on one topic, {new}; give {topic} another'
            raise BearingTwinError(msg)


NODE = ReplayNode
