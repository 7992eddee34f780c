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
    the last valid speed in use; :attr:`problem` then says so. A message that does not name the
    joint says nothing of it: several publishers may share joint_states, each with its part. The
    direction of rotation does not matter to a bearing: the magnitude is used.

    Parameters
    ----------
    nominal
        Speed until a joint is heard of, Hz; NaN: unknown.
    joint
        Name of the joint in joint_states; '' for none.
    highest
        Fastest speed that is believed, Hz.
    timeout
        Age above which a measured speed is reported as stale, s.

    """

    def __init__(
        self,
        *,
        nominal: float,
        joint: str = '',
        highest: float = FASTEST_SHAFT,
        timeout: float = 5.0,
    ) -> None:
        self.joint = joint
        self.highest = highest
        self.timeout = timeout
        self.hz = nominal
        self._arrived: float | None = None
        self._problem = ''

    def set_nominal(self, hz: float) -> None:
        """Use a new nominal speed, Hz, unless a measured one is in use."""
        if self._arrived is None:
            self.hz = hz

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
        self.hz = hz
        self._arrived = now
        self._problem = ''

    def problem(self, now: float) -> str:
        """Return what is wrong with the input at ``now`` (s); '' if nothing."""
        if not self.joint or self._problem:
            return self._problem
        if self._arrived is None:
            return f"no velocity of joint '{self.joint}' yet: the nominal speed is used"
        # A receiver's clock that was set back must not make an age negative.
        self._arrived = min(self._arrived, now)
        age = now - self._arrived
        if age > self.timeout:
            return f'no velocity for {age:.1f} s: the last one is held'
        return ''
