# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Find the verdict of the diagnosis that applies to the record of a fit."""

from __future__ import annotations

import math
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import fault_orders, PLACES
from bearing_twin.diagnosis.streaming import same_rate

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin_msgs.msg import Diagnosis


OLDEST_S = 10.0
"""Largest age of a usable verdict, from the end of its window to the end of the record, s; or two
windows of the diagnosis if these are longer."""
AHEAD_S = 5.0
"""Longest time that a verdict may be ahead of the record, s: nodes receive blocks at different
times."""
_ALIKE = 1e-3
"""Largest relative difference of the orders of one bearing, due to rounding of its geometry."""


class RecordVerdict(NamedTuple):
    """Verdict of the diagnosis on a record."""

    place: str | None
    """Place of the defect; 'none' for a healthy bearing; None if the verdict names no place."""
    why: str = ''
    """Why there is no verdict; '' if there is one."""

    @property
    def healthy(self) -> bool:
        """Whether the diagnosis finds the bearing healthy."""
        return self.place == 'none'


class NewestVerdict:
    """
    The newest verdict of the diagnosis of one bearing.

    It applies to a record of the same sensor that ends with its window or a little later.

    ``bearing`` is the bearing of the calibration. The diagnosis may know the same bearing by
    another name or by its geometry.
    """

    def __init__(self, bearing: Bearing) -> None:
        self._bearing = bearing
        self._newest: Diagnosis | None = None
        self._other = ''

    def take(self, message: Diagnosis, frame_id: str | None) -> None:
        """Take a verdict. Verdicts on another bearing or sensor are ignored."""
        if not self._is_of_bearing(message):
            self._other = (
                f'the diagnosis is of bearing {message.bearing}, not {self._bearing.name}'
            )
        elif frame_id is not None and message.header.frame_id != frame_id:
            self._other = (
                f'the diagnosis is of sensor {message.header.frame_id!r}, not {frame_id!r}'
            )
        else:
            self._newest = message

    def _is_of_bearing(self, message: Diagnosis) -> bool:
        """Return whether a verdict belongs to this bearing, by its fault orders."""
        if not message.ftf > 0.0:
            # The shaft stands still or its speed is unknown: compare the names.
            return bool(message.bearing == self._bearing.name)
        own = fault_orders(self._bearing)
        return all(
            math.isclose(hertz * own.ftf, order * message.ftf, rel_tol=_ALIKE)
            for hertz, order in ((message.bpfo, own.bpfo), (message.bpfi, own.bpfi))
        )

    def on_record(self, frame_id: str, end: int, sample_rate: float) -> RecordVerdict:
        """Return the verdict on a record of a sensor that ends before sample ``end``."""
        said = self._newest
        if said is None:
            return RecordVerdict(
                None, self._other or 'no diagnosis was heard, start the diagnosis node beside this'
            )
        alike = same_rate(said.sample_rate, sample_rate)
        if not (said.header.frame_id == frame_id and alike):
            return RecordVerdict(
                None,
                f'the diagnosis is of sensor {said.header.frame_id!r} at {said.sample_rate:g} Hz, '
                f'not of {frame_id!r} at {sample_rate:g} Hz',
            )
        age = (end - said.first_sample - said.sample_count) / sample_rate
        oldest = max(OLDEST_S, 2.0 * said.sample_count / sample_rate)
        if age > oldest:
            return RecordVerdict(
                None, f'the last verdict is {age:.0f} s old, and {oldest:.0f} s is the most'
            )
        if age < -AHEAD_S:
            return RecordVerdict(None, 'the last verdict is older than the restart of the source')
        if said.level == said.LEVEL_FAULT and said.faults and said.faults[0] in PLACES:
            return RecordVerdict(str(said.faults[0]))
        return RecordVerdict('none' if said.level == said.LEVEL_OK else None)
