# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The cycle of a publishing node: a timer, the deadlines, and what became of them."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from bearing_twin.ros import realtime
from bearing_twin.stamps import NANO
from bearing_twin.streams.timing import CycleStatistics
from rclpy.clock import Clock, JumpThreshold
from rclpy.clock_type import ClockType
from rclpy.duration import Duration

if TYPE_CHECKING:
    from collections.abc import Callable

    from bearing_twin.ros.health import Status
    from bearing_twin.ros.lifecycle import ManagedNode
    from bearing_twin.ros.parameters import ParameterSet
    from bearing_twin.streams.pacer import Due
    from rclpy.clock import JumpHandle, TimeJump


STILL_AFTER = 1.0
JUMP = 10.0
"""
Advance of /clock between two of its readings above which it has jumped, and most that a node may
lag behind it, s: a simulation does not wait, and a busy moment of ours is no gap in it.
"""
REST_PERIOD = 0.05
"""Time after which more of what is due behind /clock is published, s: readers queue 50 blocks."""


class BlockCycle:
    """
    Call ``publish`` for each block that is due.

    Real time is paced by the steady clock, which nobody sets; with ``use_sim_time`` by /clock.

    Parameters
    ----------
    node
        The node.
    parameters : ParameterSet
        Its parameters, with those of :mod:`bearing_twin.ros.realtime`.
    publish
        Computes and publishes a block.
    slots
        Wake-ups a period; more than one lets a node spread its publishing.
    between
        Called at every wake-up with the part of the period that is over, 0 to 1.

    Raises
    ------
    BearingTwinError
        If priority or memory locking are asked for and refused.

    """

    def __init__(
        self,
        node: ManagedNode,
        parameters: ParameterSet,
        publish: Callable[[Due], None],
        *,
        slots: int = 1,
        between: Callable[[float], None] | None = None,
    ) -> None:
        self._node = node
        self._parameters = parameters
        self._publish = publish
        self._slots = slots
        self._between = between
        self._simulated = node.get_parameter('use_sim_time').value
        self._pacer = realtime.build_pacer(parameters.values, JUMP if self._simulated else 0.0)
        self._statistics = CycleStatistics()
        self._began = 0.0
        self._busy = 0.0
        self._more = False
        self._cycle_began: int | None = None
        self._woken = time.monotonic()
        if parameters['lock_memory']:
            realtime.lock_memory()
        self._scheduling = realtime.raise_priority(parameters['priority'])

    @property
    def period(self) -> float:
        """Time between blocks, s."""
        return self._pacer.period

    def start(self) -> None:
        """Let the first block begin with the first wake-up, or reading of /clock, that follows."""
        self._ticks = Clock(clock_type=ClockType.STEADY_TIME)
        self._jumps: JumpHandle | None = None
        if self._simulated:
            self._ticks = self._node.get_clock()
            self._jumps = self._ticks.create_jump_callback(
                JumpThreshold(
                    min_forward=Duration(seconds=JUMP),
                    min_backward=Duration(nanoseconds=-1),
                    on_clock_change=True,
                ),
                post_callback=self._on_jump,
            )
            # Also where /clock has ended.
            steady = Clock(clock_type=ClockType.STEADY_TIME)
            self._node.create_timer(REST_PERIOD, self._publish_rest, clock=steady)
        # Not now: /clock is read by the executor alone, and may have gone on for seconds.
        self._pacer.release()
        self._pause()
        self._timer = self._node.create_timer(1 / NANO, self._on_timer, clock=self._ticks)

    def stop(self) -> None:
        """Publish no more blocks."""
        if self._jumps is not None:
            self._jumps.unregister()

    def fields(self, due: Due) -> dict[str, float]:
        """Return the real-time fields of the state message for the block being published."""
        return {
            'blocks_published': due.number,
            'blocks_late': self._pacer.late,
            'blocks_dropped': due.dropped,
            'lateness': due.lateness,
            'execution_time': time.perf_counter() - self._began,
        }

    def status(self) -> Status:
        """Status of the deadlines for /diagnostics."""
        asleep = time.monotonic() - self._woken
        return realtime.status(
            self._pacer.report(),
            self._statistics,
            self._parameters.values,
            period=self.period,
            scheduling=self._scheduling,
            active=self._node.active,
            simulated=self._simulated,
            still=self._simulated and asleep > STILL_AFTER + self.period,
        )

    def _now(self) -> int:
        return self._node.get_clock().now().nanoseconds

    def _on_jump(self, _: TimeJump) -> None:
        # A recording that was sought or begins again: nothing is late, and nothing is dropped.
        self._pacer.step(ticks=self._ticks.now().nanoseconds, time=self._now())
        self._pause()

    def _on_timer(self) -> None:
        self._woken = time.monotonic()
        ticks = self._ticks.now().nanoseconds
        # The next wake-up is set already; what is set here is the time from it to the one after.
        following = ticks + (self._timer.time_until_next_call() or 0)
        self._publish_due()
        if self._between is not None:
            began = time.perf_counter()
            self._between(self._pacer.phase(self._ticks.now().nanoseconds))
            self._busy += time.perf_counter() - began
        # Behind the blocks: the first call lets them begin.
        self._timer.timer_period_ns = self._pacer.wake_up(following, self._slots) - following

    def _publish_due(self) -> None:
        ticks = self._ticks.now().nanoseconds
        blocks = self._pacer.due(ticks=ticks, time=self._now())
        for due in blocks:
            self._finish_cycle(ticks)
            self._began = time.perf_counter()
            self._publish(due)
            self._busy += time.perf_counter() - self._began
        self._more = len(blocks) == self._pacer.catch_up

    def _publish_rest(self) -> None:
        if self._more:
            self._publish_due()

    def _pause(self) -> None:
        """Let no cycle reach over the time up to now."""
        self._cycle_began = None
        self._statistics.pause()

    def _finish_cycle(self, ticks: int) -> None:
        # What is done between the blocks before the first one belongs to no cycle.
        if self._cycle_began is not None:
            self._statistics.add(self._cycle_began / NANO, self._busy)
        self._cycle_began, self._busy = ticks, 0.0
