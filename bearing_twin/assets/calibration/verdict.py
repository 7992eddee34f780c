# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Which verdict of the diagnosis holds for a record that is fitted."""

from __future__ import annotations

import math
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import fault_orders, PLACES
from bearing_twin.diagnosis.streaming import same_rate

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin_msgs.msg import Diagnosis


OLDEST_S = 10.0
"""Greatest age of a verdict that is used, from the end of its window to that of the record, s; two
windows of the diagnosis where they are longer."""
AHEAD_S = 5.0
"""Most that a verdict may be ahead of the record: blocks reach two nodes at two times, s."""
_ALIKE = 1e-3
"""Most that orders of one bearing differ by the digits in which its geometry is given."""


class Heard(NamedTuple):
    """What the diagnosis says of a record."""

    place: str | None
    """Part with the defect, 'none' of a healthy bearing; None: it names no part."""
    why: str = ''
    """Why there is no verdict; '' if there is one."""

    @property
    def healthy(self) -> bool:
        """Whether the diagnosis finds the bearing healthy."""
        return self.place == 'none'


class Verdicts:
    """
    The newest verdict of the diagnosis of one bearing.

    It holds for a record of the same sensor that ends when its window does, or a little later.

    ``bearing`` is the one that is calibrated; that of the diagnosis may have another name, or be
    given by its geometry.
    """

    def __init__(self, bearing: Bearing) -> None:
        self._bearing = bearing
        self._newest: Diagnosis | None = None
        self._other = ''

    def take(self, message: Diagnosis, frame_id: str | None) -> None:
        """Take a verdict; one of another bearing, or of another sensor than this one, is none."""
        if not self._is_alike(message):
            self._other = (
                f'the diagnosis is of bearing {message.bearing}, not {self._bearing.name}'
            )
        elif frame_id is not None and message.header.frame_id != frame_id:
            self._other = (
                f'the diagnosis is of sensor {message.header.frame_id!r}, not {frame_id!r}'
            )
        else:
            self._newest = message

    def _is_alike(self, message: Diagnosis) -> bool:
        """Whether a verdict expects of its bearing what this one does, whatever its name."""
        if not message.ftf > 0.0:
            # The shaft stands, or its speed is not known.
            return bool(message.bearing == self._bearing.name)
        own = fault_orders(self._bearing)
        return all(
            math.isclose(hertz * own.ftf, order * message.ftf, rel_tol=_ALIKE)
            for hertz, order in ((message.bpfo, own.bpfo), (message.bpfi, own.bpfi))
        )

    def of(self, frame_id: str, end: int, sample_rate: float) -> Heard:
        """Return what the diagnosis says of a sensor's record that ends before sample ``end``."""
        said = self._newest
        if said is None:
            return Heard(
                None, self._other or 'no diagnosis was heard, start the diagnosis node beside this'
            )
        alike = same_rate(said.sample_rate, sample_rate)
        if not (said.header.frame_id == frame_id and alike):
            return Heard(
                None,
                f'the diagnosis is of sensor {said.header.frame_id!r} at {said.sample_rate:g} Hz, '
                f'not of {frame_id!r} at {sample_rate:g} Hz',
            )
        age = (end - said.first_sample - said.sample_count) / sample_rate
        oldest = max(OLDEST_S, 2.0 * said.sample_count / sample_rate)
        if age > oldest:
            return Heard(
                None, f'the last verdict is {age:.0f} s old, and {oldest:.0f} s is the most'
            )
        if age < -AHEAD_S:
            return Heard(None, 'the last verdict is of samples before the source started anew')
        if said.level == said.LEVEL_FAULT and said.faults and said.faults[0] in PLACES:
            return Heard(str(said.faults[0]))
        return Heard('none' if said.level == said.LEVEL_OK else None)
