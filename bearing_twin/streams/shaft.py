# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Shaft speed from joint_states or from a parameter. Knows no ROS."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


FASTEST_SHAFT = 1000.0
"""Fastest shaft that is believed, Hz."""


class ShaftSpeed:
    """
    Hold the shaft speed in use and say where it comes from.

    A joint without velocity, or with one that is NaN, infinite or faster than ``highest``, leaves
    the last valid speed in use; :meth:`problem` then says so. A message that does not name the
    joint says nothing of it: several publishers may share joint_states, each with its part. The
    direction of rotation does not matter to a bearing: the magnitude is used.

    A speed that is older than ``timeout`` is no measured one any more: a fault would be looked for
    at the frequencies of another speed, as narrowly as if it were measured.

    Parameters
    ----------
    nominal
        Speed where no joint tells it, Hz; NaN: unknown.
    joint
        Name of the joint in joint_states; '' for none.
    highest
        Fastest speed that is believed, Hz.
    timeout
        Age above which a measured speed is stale, s.
    hold
        Whether a stale speed stays in use, as that of a twin, whose shaft goes on to turn;
        otherwise the nominal one is used.

    """

    def __init__(
        self,
        *,
        nominal: float,
        joint: str = '',
        highest: float = FASTEST_SHAFT,
        timeout: float = 5.0,
        hold: bool = False,
    ) -> None:
        self.joint = joint
        self.highest = highest
        self.timeout = timeout
        self.hold = hold
        self.nominal = self._measured = nominal
        self._arrived = -math.inf
        self._problem = ''

    def offer(self, names: Sequence[str], velocities: Sequence[float], *, now: float) -> None:
        """Take one JointState: names, and velocities in rad/s; ``now`` in s."""
        if not self.joint or self.joint not in names:
            return
        index = list(names).index(self.joint)
        if index >= len(velocities):
            self._problem = f"joint_states has no velocity of joint '{self.joint}'"
            return
        velocity = velocities[index]
        hz = abs(velocity) / (2.0 * math.pi)
        if not hz <= self.highest:
            self._problem = f'speed {hz:.6g} Hz is not within 0..{self.highest:g} Hz'
            return
        self._measured = hz
        self._arrived = now
        self._problem = ''

    def at(self, now: float, length: float = 0.0) -> float:
        """Return the speed during the last ``length`` s before ``now`` (s), Hz."""
        limit = math.inf if self.hold else self.timeout + length
        return self._measured if self._age(now) < limit else self.nominal

    def problem(self, now: float) -> str:
        """Return what is wrong with the input at ``now`` (s); '' if nothing."""
        if not self.joint or self._problem:
            return self._problem
        age = self._age(now)
        if math.isinf(age):
            return f"no velocity of joint '{self.joint}' yet: the nominal speed is used"
        if age > self.timeout:
            use = 'held' if self.hold else 'too old to be used'
            return f'no velocity for {age:.1f} s: the last one is {use}'
        return ''

    def _age(self, now: float) -> float:
        # A receiver's clock that was set back must not make an age negative.
        self._arrived = min(self._arrived, now)
        return now - self._arrived
