# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Publish statuses of a node on /diagnostics (REP 107) once a second, and log changes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
import enum
from itertools import islice
import math
import re
import time
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.ros.reserves import Reserves
from bearing_twin.ros.topics.qos import RESULT
from bearing_twin.stamps import NANO
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock, ClockType

if TYPE_CHECKING:
    from rclpy.node import Node


PLAIN = str.maketrans({'"': "'", '\n': ' ', '\\': '/'})
PARTS = 64
"""Most statuses per message: they take 1 to 2 ms, which a block can wait."""
TOPICS = 16
"""Topics a second whose publishers are counted: 5 us each, 60 where there are a thousand."""
RIVAL_AFTER = 30.0
"""Time after which a second node of one name, or a second publisher of one topic, counts: a killed
one stays known for 20 s."""
START = 10.0
"""Time for which a part is not OK from the start on after which that is logged, s; of parts of a
fleet in one state, one is."""
NUMBER = re.compile(r'[-+]?\d[\d.e+-]*|\bnan\b|\binf\b')


class Level(enum.Enum):
    """Levels of a diagnostic status."""

    OK = DiagnosticStatus.OK
    WARN = DiagnosticStatus.WARN
    ERROR = DiagnosticStatus.ERROR
    STALE = DiagnosticStatus.STALE


class Status(NamedTuple):
    """
    One status.

    The keys of ``values`` are stable and include their unit (``age_s``). A value is always a
    number or always a text; an unknown number (NaN) is omitted.
    """

    level: Level
    message: str
    values: Mapping[str, object]
    kind: str = ''
    """A change of this text or of the level is logged; '': use the message without its numbers."""


class _Spell(NamedTuple):
    """Time for which a part has been in one state."""

    key: tuple[Level, str]
    message: str
    began: float
    first: bool


class Health:
    """
    Publish the statuses of a node's parts on the absolute topic /diagnostics.

    It follows diagnostic_updater, which is not available from PyPI: named tasks, 1 Hz, names
    ``NODE: PART``, and a message even without changes, so that an aggregator sees a dead node
    become stale. The statuses of a large fleet are spread over the second. A part that leaves OK,
    returns to it or changes its problem is logged once, with the duration of its former state.

    Parameters
    ----------
    node
        The node.
    hardware_id
        Asset or sensor of the statuses, such as the namespace of the node. If it is empty or the
        root namespace, the name of the node is used.

    """

    def __init__(self, node: Node, hardware_id: str) -> None:
        self.hardware_id = hardware_id.strip('/') or node.get_name()
        self._node = node
        self._spells: dict[str, _Spell] = {}
        self._told: set[tuple[Level, str]] = set()
        self._unique = time.monotonic()
        self._shared: dict[str, float] = {}
        self._reserves = Reserves(node)
        self._looked = 0
        self.tasks: dict[str, tuple[Callable[[], Status], str]] = {}
        """Function that returns the status, and the asset, by part."""
        self._turn = 0
        self._publisher = node.create_publisher(DiagnosticArray, '/diagnostics', RESULT)
        # Not the ROS clock: a paused /clock must not silence a node.
        self._timer = node.create_timer(
            1.0, self.publish, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )

    def add(self, part: str, task: Callable[[], Status], *, hardware_id: str = '') -> None:
        """Add a part whose ``task`` returns its status; by default for the asset of the node."""
        self.tasks[part] = (task, hardware_id.strip('/') or self.hardware_id)
        self._timer.timer_period_ns = NANO // math.ceil(len(self.tasks) / PARTS)

    def destroy(self) -> None:
        """Stop publishing."""
        self._node.destroy_timer(self._timer)
        self._node.destroy_publisher(self._publisher)

    def publish(self) -> None:
        """Publish the statuses of the next ``PARTS`` parts."""
        array = DiagnosticArray()
        array.header.stamp = self._node.get_clock().now().to_msg()
        name = self._node.get_fully_qualified_name().lstrip('/')
        begin, self._turn = self._turn, self._turn + PARTS
        if begin == 0:
            self._count_publishers()
        for part, (task, hardware_id) in islice(self.tasks.items(), begin, self._turn):
            status = task()
            if begin == 0 and not array.status:
                status = self._with_rivals(status)
            self._log(part, status)
            level, message, values, _ = status
            array.status.append(
                DiagnosticStatus(
                    level=level.value,
                    name=f'{name}: {part}',
                    message=_text(message),
                    hardware_id=hardware_id,
                    values=[KeyValue(key=k, value=_text(v)) for k, v in known(values)],
                )
            )
        self._publisher.publish(array)
        if self._turn >= len(self.tasks):
            self._turn = 0

    def _with_rivals(self, status: Status) -> Status:
        """Return a status with what other nodes have in common with this one, if anything."""
        if why := self._namesake():
            return status._replace(level=Level.ERROR, message=f'{why}; {status.message}')
        if why := self._rivals():
            level = Level.WARN if status.level is Level.OK else status.level
            return status._replace(level=level, message=f'{why}; {status.message}')
        return status

    def _namesake(self) -> str:
        """Return that another node has the name of this one; '' if there is none."""
        us, now = (self._node.get_name(), self._node.get_namespace()), time.monotonic()
        if self._node.get_node_names_and_namespaces().count(us) < 2:
            self._unique = now
        if now - self._unique < RIVAL_AFTER:
            return ''
        name = self._node.get_fully_qualified_name()
        return f'another node is called {name}, too: end it, or give it another name or namespace'

    def _count_publishers(self) -> None:
        """Note since when topics of this node have other publishers, a few topics at a time."""
        every = list(self._node.publishers)
        begin = self._looked if self._looked < len(every) else 0
        self._looked = begin + TOPICS
        for publisher in every[begin : begin + TOPICS]:
            topic = publisher.topic_name
            # An inactive node publishes nothing, so it may share the topics of an active one.
            active = getattr(publisher, 'is_activated', False)
            if active and self._node.count_publishers(topic) > 1 and self._rivals_on(topic):
                self._shared.setdefault(topic, time.monotonic())
            else:
                self._shared.pop(topic, None)

    def _rivals(self) -> str:
        """Return which other nodes publish on topics of this one; '' if there are none."""
        since = time.monotonic() - RIVAL_AFTER
        topics = [topic for topic, began in self._shared.items() if began <= since]
        others = ', '.join(self._rivals_on(topics[0])) if topics else ''
        if not others:
            return ''
        more = f' and {len(topics) - 1} more topics of this node' if len(topics) > 1 else ''
        return (
            f'{others} publishes on {topics[0]}{more}, too: end it, or give it another namespace'
        )

    def _rivals_on(self, topic: str) -> list[str]:
        """Return the other nodes that publish on a topic and are not inactive, sorted."""
        infos = self._node.get_publishers_info_by_topic(topic)
        names = {f'{info.node_namespace.rstrip("/")}/{info.node_name}' for info in infos}
        others = names - {self._node.get_fully_qualified_name()}
        if not others:
            return ['this node itself']
        return sorted(name for name in others if not self._reserves.is_inactive(name))

    def _log(self, part: str, status: Status) -> None:
        key = (status.level, status.kind or NUMBER.sub('', status.message))
        now = time.monotonic()
        former = self._spells.get(part)
        if former is not None and former.key == key:
            lasts = former.first and now - former.began > START
            if lasts and status.level is not Level.OK and key not in self._told:
                self._told.add(key)
                self._write(status.level, f'{part}: {status.message} (since the start)')
            return
        self._spells[part] = _Spell(key, status.message, now, former is None)
        silent = former is None or (former.first and former.key not in self._told)
        if former is None or (status.level is Level.OK and silent):
            # The first states of a node are logged only if they last.
            return
        if status.level is Level.OK and former.key[0] is Level.OK:
            return
        # If only the level changes, as from suspicion to alarm, name the former level.
        alike = former.message == status.message
        was = former.key[0].name if alike else former.message
        text = f'{part}: {status.message} (before, for {now - former.began:.0f} s: {was})'
        self._write(status.level, text)

    def _write(self, level: Level, text: str) -> None:
        logger = self._node.get_logger()
        if level is Level.ERROR:
            logger.error(text)
        elif level is Level.OK:
            logger.info(text)
        else:
            logger.warning(text)


def known(values: Mapping[str, object]) -> Iterator[tuple[str, object]]:
    """Yield the values of a status that are published: all except NaN and infinite numbers."""
    for key, value in values.items():
        if not isinstance(value, float) or math.isfinite(value):
            yield key, value


def _text(value: object) -> str:
    if isinstance(value, float):
        return f'{value:.6g}'
    # diagnostic_remote_logging sends texts unescaped in double quotes and on one line.
    return str(int(value) if isinstance(value, bool) else value).translate(PLAIN)
