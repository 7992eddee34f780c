# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Validation of the measured temperature before it reaches the model."""

from __future__ import annotations

from dataclasses import dataclass
import enum
import math

from bearing_twin.thermal.gcr15 import TABLE_HIGH, TABLE_LOW

PHYSICAL_LOW = -273.15
PHYSICAL_HIGH = 1000.0
"""Absolute zero, and a temperature that no bearing survives, degC. A reading outside comes from a
broken sensor."""

RESTART_AFTER = 3
"""Consecutive readings with rising stamps after which a clock that went back is accepted."""


class TemperatureStatus(enum.IntEnum):
    """State of the temperature input; values as in ``TwinState.msg``."""

    OK = 0
    WAITING = 1
    STALE = 2
    INVALID = 3
    CLAMPED = 4
    BACKWARDS = 5


@dataclass(frozen=True)
class GatedTemperature:
    """Output of the gate at one instant."""

    used: float
    """Temperature for the model, degC, always finite and inside the tables."""
    measured: float
    """Last value received, degC; NaN before the first."""
    taken: float
    """Last valid value, degC, before clamping to the tables; NaN before the first."""
    age: float
    """Age of the last valid value, s; NaN before the first."""
    status: TemperatureStatus


class TemperatureGate:
    """
    Hold the last valid temperature and report the state of the input.

    ============================  =============================================================
    input                         behaviour
    ============================  =============================================================
    none yet                      ``start`` is used, WAITING
    older than ``timeout``        the last valid value is held, STALE
    NaN, infinite, or outside     rejected, the last valid value is held, INVALID: no bearing has
    -273.15..1000 degC            such a temperature
    outside the tables            the nearest end of 20..110 degC is used, CLAMPED
    stamp not after the last one  rejected, the last valid value is held, BACKWARDS; the third of
                                  three consecutive such readings with rising stamps is accepted:
                                  the source has restarted
    ============================  =============================================================

    STALE has priority over the status of the latest reading: a source that sends nothing usable
    for longer than ``timeout`` is treated like a silent one.

    Age is measured with the receiver's clock, so a replayed recording with stamps of last year is
    not stale. Stamps only order the readings.

    Parameters
    ----------
    start
        Temperature before the first reading, degC; clamped to the tables.
    timeout
        Age above which a reading is stale, s.

    Examples
    --------
    >>> gate = TemperatureGate(start=20.0, timeout=5.0)
    >>> gate.offer(300.0, stamp=1, now=0.0).name
    'CLAMPED'

    """

    def __init__(self, *, start: float = TABLE_LOW, timeout: float = 5.0) -> None:
        self.timeout = timeout
        self._used = _clamp(start)
        self._taken = math.nan
        self._measured = math.nan
        self._arrived: float | None = None
        self._stamp: int | None = None
        self._rejected_stamp = 0
        self._rejected_in_a_row = 0
        self._status = TemperatureStatus.WAITING

    def offer(self, value: float, *, stamp: int, now: float) -> TemperatureStatus:
        """
        Take one reading.

        Parameters
        ----------
        value
            Temperature, degC.
        stamp
            Time of the measurement, ns; 0 if the source gives none: the order is not checked.
        now
            The receiver's clock, s.

        """
        self._measured = value
        if not PHYSICAL_LOW <= value <= PHYSICAL_HIGH:
            self._status = TemperatureStatus.INVALID
        elif stamp and self._stamp is not None and not self._believe(stamp):
            self._status = TemperatureStatus.BACKWARDS
        else:
            self._stamp = stamp or self._stamp
            self._rejected_in_a_row = 0
            self._arrived = now
            self._taken = value
            self._used = _clamp(value)
            inside = self._used == value
            self._status = TemperatureStatus.OK if inside else TemperatureStatus.CLAMPED
        return self._status

    def at(self, now: float) -> GatedTemperature:
        """Return the temperature to use at ``now`` (receiver's clock, s)."""
        if self._arrived is None:
            status = self._status if self._status else TemperatureStatus.WAITING
            return GatedTemperature(self._used, self._measured, self._taken, math.nan, status)
        # The age must not become negative when the receiver's clock is set back.
        self._arrived = min(self._arrived, now)
        age = now - self._arrived
        status = self._status
        if age > self.timeout:
            status = TemperatureStatus.STALE
        return GatedTemperature(self._used, self._measured, self._taken, age, status)

    def _believe(self, stamp: int) -> bool:
        """Whether a reading's stamp is in order, or the source has restarted."""
        assert self._stamp is not None
        if stamp > self._stamp:
            return True
        rising = self._rejected_in_a_row > 0 and stamp > self._rejected_stamp
        self._rejected_in_a_row = self._rejected_in_a_row + 1 if rising else 1
        self._rejected_stamp = stamp
        return self._rejected_in_a_row >= RESTART_AFTER


def _clamp(value: float) -> float:
    return min(max(value, TABLE_LOW), TABLE_HIGH)
