# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The block cycle of a publishing node: timer, deadlines and their statistics."""

from __future__ import annotations

from collections.abc import Callable
import time
from typing import TYPE_CHECKING

from bearing_twin.ros import realtime
from bearing_twin.stamps import NANO
from bearing_twin.streams.timing import CycleStatistics
from rclpy.clock import Clock, JumpThreshold
from rclpy.clock_type import ClockType
from rclpy.duration import Duration

if TYPE_CHECKING:
    from bearing_twin.ros.health import Status
    from bearing_twin.ros.lifecycle import ManagedNode
    from bearing_twin.ros.parameters import ParameterSet
    from bearing_twin.streams.pacer import Due
    from rclpy.clock import JumpHandle, TimeJump


STILL_AFTER = 1.0
JUMP = 10.0
"""
Advance between two readings of /clock that counts as a jump, and longest lag of a node behind
/clock, s: a simulation does not wait for a busy node, and such a lag is not a gap.
"""
REST_PERIOD = 0.1
"""Interval of publishing overdue blocks in simulated time, s: subscribers queue 50 blocks, and a
verdict on each second of them takes time, too."""


class BlockCycle:
    """
    Call ``publish`` for each block that is due.

    The steady clock paces real time, because it is never set; with ``use_sim_time`` /clock does.

    Parameters
    ----------
    node
        The node.
    parameters : ParameterSet
        Parameters of the node, including those for real time.
    publish
        Function that computes and publishes a block.
    slots
        Wake-ups per period; with several, a node can spread its publishing.
    between
        Called at every wake-up with the phase of the period, 0 to 1.

    Raises
    ------
    BearingTwinError
        If real-time priority or memory locking is requested and refused.

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
        self._steps = 0
        # Blocks that waited when they began to; 0 if none waits.
        self._most = 0
        self._cycle_began: int | None = None
        self._woken = time.monotonic()
        if parameters['lock_memory']:
            realtime.lock_memory()
        self._scheduling = realtime.raise_priority(parameters['priority'])

    @property
    def period(self) -> float:
        """Time between blocks, s."""
        return self._pacer.period

    @property
    def punctual(self) -> float:
        """Duration of the blocks since the last late one, s; infinite if none was late."""
        return self._pacer.punctual

    def start(self) -> None:
        """Start the cycle; the first block begins at the next wake-up or reading of /clock."""
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
            # On the steady clock, so that it also works after /clock has stopped.
            steady = Clock(clock_type=ClockType.STEADY_TIME)
            self._node.create_timer(REST_PERIOD, self._publish_rest, clock=steady)
        # Do not begin now: only the executor updates /clock, which may be seconds ahead.
        self._pacer.release()
        self._pause()
        self._timer = self._node.create_timer(1 / NANO, self._on_timer, clock=self._ticks)

    def stop(self) -> None:
        """Stop the cycle: ignore further jumps of /clock. The node destroys the timers."""
        if self._jumps is not None:
            self._jumps.unregister()

    def fields(self, due: Due) -> dict[str, float]:
        """Return the real-time fields of the state message of the current block."""
        return {
            'blocks_published': due.number,
            'blocks_late': self._pacer.late,
            'blocks_dropped': due.dropped,
            'lateness': due.lateness,
            'execution_time': time.perf_counter() - self._began,
        }

    def status(self) -> Status:
        """Return the status of the deadlines for /diagnostics."""
        asleep = time.monotonic() - self._woken
        report = self._pacer.report()
        steps, self._steps = self._steps, report.clock_steps
        jumped = self._simulated and report.clock_steps > steps
        still = self._simulated and asleep > STILL_AFTER + self.period
        # Several clocks that have not jumped may agree.
        clocks = self._node.count_publishers('/clock') if still or jumped else 1
        return realtime.status(
            report,
            self._statistics,
            self._parameters.values,
            period=self.period,
            scheduling=self._scheduling,
            active=self._node.active,
            simulated=self._simulated,
            still=still,
            clocks=clocks if jumped else min(clocks, 1),
        )

    def _now(self) -> int:
        return self._node.get_clock().now().nanoseconds

    def _on_jump(self, _: TimeJump) -> None:
        # A replayed recording was moved or restarted: no block is late or dropped.
        self._pacer.step(ticks=self._ticks.now().nanoseconds, time=self._now())
        self._pause()

    def _on_timer(self) -> None:
        self._woken = time.monotonic()
        ticks = self._ticks.now().nanoseconds
        # The next wake-up is already set; the timer period determines the one after it.
        following = ticks + (self._timer.time_until_next_call() or 0)
        if not 0 < self._pacer.waiting <= self._most:
            # Else the timer of the rest keeps the pace, unless /clock is faster.
            self._publish_due()
        if self._between is not None:
            began = time.perf_counter()
            self._between(self._pacer.phase(self._ticks.now().nanoseconds))
            self._busy += time.perf_counter() - began
        # After publishing, because the first call starts the pacer.
        self._timer.timer_period_ns = self._pacer.wake_up(following, self._slots) - following

    def _publish_due(self) -> None:
        ticks = self._ticks.now().nanoseconds
        for due in self._pacer.due(ticks=ticks, time=self._now()):
            self._finish_cycle(ticks)
            self._began = time.perf_counter()
            self._publish(due)
            self._busy += time.perf_counter() - self._began
        self._most = self._pacer.waiting and (self._most or self._pacer.waiting)

    def _publish_rest(self) -> None:
        if self._pacer.waiting:
            self._publish_due()

    def _pause(self) -> None:
        """Interrupt the cycle statistics: no cycle spans the time before now."""
        self._cycle_began = None
        self._statistics.pause()

    def _finish_cycle(self, ticks: int) -> None:
        # Work before the first block does not belong to a cycle.
        if self._cycle_began is not None:
            self._statistics.add(self._cycle_began / NANO, self._busy)
        self._cycle_began, self._busy = ticks, 0.0
