# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Statuses of a node on /diagnostics (REP 107), once a second; changes go to the log."""

from __future__ import annotations

import enum
from itertools import islice
import math
import re
import time
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.ros.topics.qos import RESULT
from bearing_twin.stamps import NANO
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock, ClockType

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from rclpy.node import Node


PLAIN = str.maketrans({'"': "'", '\n': ' ', '\\': '/'})
PARTS = 64
"""Most statuses of a message: they are made in 1 to 2 ms, for which a block can wait."""
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

    The keys of ``values`` are stable and carry their unit (``age_s``). A value is always a number
    or always a text; a number that is not known (NaN) is left out.
    """

    level: Level
    message: str
    values: Mapping[str, object]
    kind: str = ''
    """What has to change, besides the level, for the log; '': the message without its numbers."""


class _Spell(NamedTuple):
    """Time for which a part has been in one state."""

    key: tuple[Level, str]
    message: str
    began: float
    first: bool


class Health:
    """
    Publish the statuses of a node's parts on the absolute topic /diagnostics.

    The idiom of diagnostic_updater, which is not available from PyPI: named tasks, 1 Hz,
    names ``NODE: PART``, a fresh message even where nothing has changed so that an aggregator
    sees the node become stale when it dies. Those of a large fleet are spread over the second. A
    part that leaves OK, comes back or changes its trouble is logged once, with the time that the
    state before has lasted.

    Parameters
    ----------
    node
        The node.
    hardware_id
        Asset or sensor that the statuses speak of, such as the node's namespace; the name of the
        node where it is empty or the root namespace.

    """

    def __init__(self, node: Node, hardware_id: str) -> None:
        self.hardware_id = hardware_id.strip('/') or node.get_name()
        self._node = node
        self._spells: dict[str, _Spell] = {}
        self.tasks: dict[str, tuple[Callable[[], Status], str]] = {}
        """What returns the status of each part, and the asset that it speaks of."""
        self._turn = 0
        self._publisher = node.create_publisher(DiagnosticArray, '/diagnostics', RESULT)
        # The wall clock: a paused /clock must not silence a node.
        self._timer = node.create_timer(
            1.0, self.publish, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )

    def add(self, part: str, task: Callable[[], Status], *, hardware_id: str = '') -> None:
        """Add a part, whose ``task`` returns its status: of the asset of the node if no other."""
        self.tasks[part] = (task, hardware_id.strip('/') or self.hardware_id)
        self._timer.timer_period_ns = NANO // math.ceil(len(self.tasks) / PARTS)

    def destroy(self) -> None:
        """Stop publishing."""
        self._node.destroy_timer(self._timer)
        self._node.destroy_publisher(self._publisher)

    def publish(self) -> None:
        """Ask the parts whose turn it is, of a few dozen all, and publish."""
        array = DiagnosticArray()
        array.header.stamp = self._node.get_clock().now().to_msg()
        name = self._node.get_fully_qualified_name().lstrip('/')
        begin, self._turn = self._turn, self._turn + PARTS
        for part, (task, hardware_id) in islice(self.tasks.items(), begin, self._turn):
            status = task()
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

    def _log(self, part: str, status: Status) -> None:
        key = (status.level, status.kind or NUMBER.sub('', status.message))
        now = time.monotonic()
        former = self._spells.get(part)
        if former is not None and former.key == key:
            return
        self._spells[part] = _Spell(key, status.message, now, former is None)
        if former is None or (status.level is Level.OK and former.first):
            # How a node starts is no news.
            return
        if status.level is Level.OK and former.key[0] is Level.OK:
            return
        # Only the level changes where a suspicion that stands becomes an alarm.
        alike = former.message == status.message
        was = former.key[0].name if alike else former.message
        text = f'{part}: {status.message} (before, for {now - former.began:.0f} s: {was})'
        logger = self._node.get_logger()
        if status.level is Level.ERROR:
            logger.error(text)
        elif status.level is Level.OK:
            logger.info(text)
        else:
            logger.warning(text)


def known(values: Mapping[str, object]) -> Iterator[tuple[str, object]]:
    """Yield what is sent of the values of a status: numbers that are NaN or infinite are not."""
    for key, value in values.items():
        if not isinstance(value, float) or math.isfinite(value):
            yield key, value


def _text(value: object) -> str:
    if isinstance(value, float):
        return f'{value:.6g}'
    # diagnostic_remote_logging sends texts between double quotes, as they are, in one line.
    return str(int(value) if isinstance(value, bool) else value).translate(PLAIN)
