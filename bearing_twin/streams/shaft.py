# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Shaft speed from joint_states or from a parameter."""

from __future__ import annotations

from collections.abc import Sequence
import math

from bearing_twin.errors import shown

MOST_NAMED = 5
"""Most joints that are named in place of the one that is missing."""
FASTEST_SHAFT = 1000.0
"""Highest shaft speed that is accepted, Hz."""

UNITS = (('Hz', 1.0), ('1/min', 60.0), ('deg/s', 360.0))
"""Units of a speed other than rad/s, and how much of each is one turn a second."""
NEAR = 0.03
"""Largest relative difference of a speed from the nominal one: the slip of an induction motor."""


def speed_doubt(measured: float, nominal: float) -> str:
    """
    Return in which other unit than rad/s a measured speed would be the nominal one; '' if in none.

    Both are in Hz, NaN if unknown.

    Examples
    --------
    >>> speed_doubt(238.7, 25.4)
    'a velocity of 1500 rad/s would be near shaft_hz=25.4 in 1/min: if it is, publish rad/s'
    >>> speed_doubt(24.8, 25.4)
    ''

    """
    velocity = 2.0 * math.pi * measured
    for unit, turn in UNITS:
        if abs(velocity / turn - nominal) <= NEAR * nominal:
            said = f'a velocity of {velocity:.4g} rad/s would be near shaft_hz={nominal:g}'
            return f'{said} in {unit}: if it is, publish rad/s'
    return ''


class ShaftSpeed:
    """
    Hold the shaft speed in use and report problems of its input.

    If the velocity of the joint is missing, NaN, infinite or above ``highest``, the last valid
    speed stays in use and :meth:`problem` reports it. Messages without the joint are ignored,
    since several publishers may share joint_states. The magnitude of the velocity is used: the
    direction of rotation does not matter to a bearing.

    A speed older than ``timeout`` no longer counts as measured: the diagnosis would search at
    the fault frequencies of a past speed, in the narrow band of a measured one.

    Parameters
    ----------
    nominal
        Speed when there is no measured one, Hz; NaN: unknown.
    joint
        Name of the joint in joint_states; '' for none.
    highest
        Highest speed that is accepted, Hz.
    timeout
        Age above which a measured speed is stale, s.
    hold
        Whether a stale speed stays in use, as for a twin, whose shaft keeps turning; otherwise
        the nominal speed is used.

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
        self._others: list[str] = []

    def offer(self, names: Sequence[str], velocities: Sequence[float], *, now: float) -> None:
        """Take one JointState: joint names, velocities in rad/s; ``now`` in s."""
        if not self.joint:
            return
        if self.joint not in names:
            self._others = [shown(name)[:40] for name in names[:MOST_NAMED]]
            return
        index = list(names).index(self.joint)
        if index >= len(velocities):
            self._problem = f"joint_states has no velocity of joint '{self.joint}'"
            return
        velocity = velocities[index]
        hz = abs(velocity) / (2.0 * math.pi)
        if not hz <= self.highest:
            self._problem = f'speed {hz:.6g} Hz is not within 0..{self.highest:g} Hz; give rad/s'
            return
        self._measured = hz
        self._arrived = now
        self._problem = ''

    def at(self, now: float, length: float = 0.0) -> float:
        """Return the shaft speed, Hz, for the ``length`` seconds before ``now`` (s)."""
        limit = math.inf if self.hold else self.timeout + length
        return self._measured if self._age(now) < limit else self.nominal

    def problem(self, now: float) -> str:
        """Return the problem of the input at ``now`` (s) as text; '' if there is none."""
        if not self.joint or self._problem:
            return self._problem
        age = self._age(now)
        others = f'; joint_states has {", ".join(self._others)}' if self._others else ''
        if math.isinf(age):
            return f"no velocity of joint '{self.joint}' yet: the nominal speed is used{others}"
        if age > self.timeout:
            use = 'held' if self.hold else 'too old to be used'
            return f'no velocity for {age:.1f} s: the last one is {use}{others}'
        return ''

    def _age(self, now: float) -> float:
        # The age must not become negative when the receiver's clock is set back.
        self._arrived = min(self._arrived, now)
        return now - self._arrived
