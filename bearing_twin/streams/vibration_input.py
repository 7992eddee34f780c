# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Validation of incoming vibration, temperature and shaft speed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
import math
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.stamps import NANO, stamp_ns
from bearing_twin.streams.shaft import FASTEST_SHAFT, ShaftSpeed
from bearing_twin.thermal.gate import PHYSICAL_LOW, TemperatureGate, TemperatureStatus
from bearing_twin.thermal.gcr15 import TABLE_HIGH, TABLE_LOW
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.thermal.gate import GatedTemperature


LOWEST_RATE = 100.0
HIGHEST_RATE = 1_000_000.0
LONGEST_BLOCK = 1_000_000
HIGHEST_INDEX = 2**62
COLDEST = -40.0
"""Lowest temperature at which a machine stands, degC."""
SILENT_AFTER = 2.0
"""Time without a block after which a source of short blocks counts as silent, s."""
REMEMBERED = 5.0
"""Time for which an ignored source of short blocks counts as present, s."""
SEVERAL_SOURCES = 'several sources on one topic: only the first is used'
"""Status while a :class:`SourceLock` is contested."""
COARSE = 100.0
"""Range from which on whole numbers of m/s^2 or g are counts: sensors have finer steps."""
FEWEST = 32
"""Fewest samples that are told to be counts."""
SOURCE_UNKNOWN, SOURCE_MEASURED, SOURCE_SIMULATED = range(3)
"""Constants of a Vibration message."""


@dataclass(frozen=True)
class VibrationBlock:
    """Validated samples of one axis from one message."""

    first_sample: int
    samples: NDArray[np.float32]
    sample_rate: float
    """Hz."""
    shaft_hz: float
    """Shaft speed, Hz; NaN if the source does not know it."""
    unit: str
    simulated: bool
    """Whether the message says that its source is a twin."""
    stamp: int = 0
    """Time of the first sample, ns."""
    frame_id: str = ''
    """Frame of the sensor."""

    @property
    def length(self) -> float:
        """Duration of the samples, s."""
        return self.samples.size / self.sample_rate


def read_vibration(message: Any, axis: str) -> VibrationBlock:
    """
    Validate a ``bearing_twin_msgs/Vibration`` and return the samples of an axis, 'x' or 'y'.

    If that axis is empty, the other one is taken.

    Raises
    ------
    BearingTwinError
        If the block cannot be used. NaN samples pass: the diagnosis checks for them.

    """
    rate = float(message.sample_rate)
    if not LOWEST_RATE <= rate <= HIGHEST_RATE:
        msg = f'sample_rate={rate:g} Hz is outside {LOWEST_RATE:g}..{HIGHEST_RATE:g} Hz'
        raise BearingTwinError(msg)
    x, y = np.asarray(message.x), np.asarray(message.y)
    if x.size and y.size and x.size != y.size:
        msg = f'x has {x.size} samples and y has {y.size}: they must be equal, or one empty'
        raise BearingTwinError(msg)
    first, second = (x, y) if axis == 'x' else (y, x)
    samples = first if first.size else second
    if not 1 <= samples.size <= LONGEST_BLOCK:
        msg = f'the block has {samples.size} samples; 1..{LONGEST_BLOCK} are taken'
        raise BearingTwinError(msg)
    if message.first_sample > HIGHEST_INDEX:
        raise BearingTwinError(f'first_sample={message.first_sample} is above {HIGHEST_INDEX}')
    shaft = float(message.shaft_hz)
    return VibrationBlock(
        first_sample=int(message.first_sample),
        samples=samples.astype(np.float32, copy=False),
        sample_rate=rate,
        shaft_hz=shaft if 0.0 <= shaft <= FASTEST_SHAFT else math.nan,
        unit=str(message.unit)[:32],
        simulated=message.source == SOURCE_SIMULATED,
        stamp=stamp_ns(message.header.stamp),
        frame_id=message.header.frame_id,
    )


def counts_doubt(block: VibrationBlock) -> str:
    """
    Return why samples of a sensor seem to be counts of its converter; '' if they do not.

    Examples
    --------
    >>> samples = np.float32([2000, -1870] * 16)
    >>> block = VibrationBlock(0, samples, 25600.0, math.nan, 'g', simulated=False)
    >>> counts_doubt(block)
    'all samples are whole numbers, as counts of a converter are, but called g: scale them to g'

    """
    x, unit = block.samples, block.unit
    if block.simulated or unit not in ('m/s^2', 'g') or len(x) < FEWEST or x[0] % 1.0:
        return ''
    if not (np.ptp(x) >= COARSE and (x == np.rint(x)).all()):
        return ''
    said = 'all samples are whole numbers, as counts of a converter are, but called'
    return f'{said} {unit}: scale them to {unit}'


class GapCounter:
    """Count lost samples and restarts of the source from the running index."""

    def __init__(self) -> None:
        self.lost = 0
        """Samples missing between the first and the last block."""
        self.restarts = 0
        """Number of restarts of the source, seen as an index that goes back."""
        self._next: int | None = None

    def count(self, first_sample: int, samples: int, *, pause: float = math.inf) -> None:
        """
        Count one block.

        A gap of ``pause`` samples or more is meant, as between snapshots: nothing of it is lost.
        """
        if self._next is not None:
            gap = max(0, first_sample - self._next)
            self.lost += gap if gap < pause else 0
            self.restarts += first_sample < self._next
        self._next = first_sample + samples


class SourceLock:
    """
    Accept one publisher of a topic and ignore the others.

    Two interleaved streams are not a valid signal. The first source is kept; another one takes
    over after the first has been silent for ``timeout`` seconds.

    Parameters
    ----------
    timeout
        Silence after which another source takes over, s.
    remember
        Time for which an ignored source counts as present after its last block, s.

    """

    def __init__(self, timeout: float = SILENT_AFTER, remember: float = REMEMBERED) -> None:
        self.timeout = timeout
        self.remember = remember
        self.ignored = 0
        """Blocks of other sources since the last change of source."""
        self._source: object = None
        self._heard = -math.inf
        self._ignored_at = -math.inf

    def accept(self, source: object, now: float) -> bool:
        """Whether a block of ``source`` that arrived at ``now`` (s) is to be used."""
        if now < self._heard:
            # Simulated time has gone back: in the new run no source has been heard yet.
            self._heard = self._ignored_at = -math.inf
        if source != self._source:
            if now - self._heard <= self.timeout:
                self.ignored += 1
                self._ignored_at = now
                return False
            self._source = source
            self.ignored = 0
            self._ignored_at = -math.inf
        self._heard = now
        return True

    def contested(self, now: float) -> bool:
        """Whether at ``now`` (s) another source has been heard recently."""
        return 0.0 <= now - self._ignored_at < self.remember


def unit_doubt(value: float) -> str:
    """
    Return in which other unit a reading would be the temperature of a bearing; '' if in none.

    Examples
    --------
    >>> unit_doubt(293.15)
    'temperature 293.15 would be 20 degC in kelvin: if it is, publish degC'
    >>> unit_doubt(150.0)
    'temperature 150 would be 66 degC in fahrenheit: if it is, publish degC'

    """
    for unit, celsius in (('kelvin', value + PHYSICAL_LOW), ('fahrenheit', (value - 32.0) / 1.8)):
        if value > TABLE_HIGH and COLDEST <= celsius <= TABLE_HIGH:
            said = f'temperature {value:.5g} would be {celsius:.0f} degC in {unit}'
            return f'{said}: if it is, publish degC'
    return ''


class Inputs:
    """
    Validated temperature and shaft speed of a node.

    Parameters
    ----------
    clock
        The receiver's clock, s; simulated time may go back.
    start, timeout
        As for :class:`~bearing_twin.thermal.gate.TemperatureGate`.
    nominal, joint, highest, hold
        As for :class:`~bearing_twin.streams.shaft.ShaftSpeed`.
    first
        Called once with the first valid temperature, clamped to the tables, degC.

    """

    def __init__(
        self,
        clock: Callable[[], float] = time.monotonic,
        *,
        start: float = TABLE_LOW,
        timeout: float = 5.0,
        nominal: float = math.nan,
        joint: str = '',
        highest: float = FASTEST_SHAFT,
        hold: bool = False,
        first: Callable[[float], None] = lambda _: None,
    ) -> None:
        self.clock = clock
        self._first = first
        self.settled = False
        """Whether the model has a temperature: from a first reading or a loaded state."""
        self.gate = TemperatureGate(start=start, timeout=timeout)
        self._stamp = 0
        # Why the last reading was refused, or seems to be of another unit; '' if neither.
        self._doubt = ''
        # Another source is accepted when the temperature of the first one is stale.
        self._sources = SourceLock(timeout, timeout)
        self.shaft = ShaftSpeed(nominal=nominal, joint=joint, highest=highest, hold=hold)

    def take_temperature(self, message: Any, info: Mapping[str, Any] | None = None) -> None:
        """Take a ``sensor_msgs/Temperature``; only the first of several publishers counts."""
        now = self.clock()
        if self._sources.accept((info or {}).get('publisher_gid'), now):
            former, self._stamp = self._stamp, stamp_ns(message.header.stamp)
            status = self.gate.offer(message.temperature, stamp=self._stamp, now=now)
            self._doubt = ''
            if status is TemperatureStatus.BACKWARDS:
                how = 'stand still' if self._stamp == former else 'run backwards'
                self._doubt = (
                    f'the stamps of temperature {how} at {self._stamp / NANO:.3f} s: stamp each '
                    'reading when it is measured'
                )
            elif status is TemperatureStatus.INVALID:
                self._doubt = f'the last temperature received is {message.temperature:g} degC'
            elif status is TemperatureStatus.CLAMPED:
                self._doubt = unit_doubt(message.temperature)
            reading = self.gate.at(now)
            if not (self.settled or math.isnan(reading.taken)):
                self.settled = True
                self._first(reading.used)

    def take_joints(self, message: Any, _: object = None) -> None:
        """Take a ``sensor_msgs/JointState``."""
        self.shaft.offer(message.name, message.velocity, now=self.clock())

    @property
    def temperature(self) -> GatedTemperature:
        """Temperature to use now."""
        return self.gate.at(self.clock())

    def shaft_hz(self, length: float = 0.0) -> float:
        """Return the shaft speed to use for a block of ``length`` (s) that ends now, Hz."""
        return self.shaft.at(self.clock(), length)

    def problems(self) -> tuple[str, str, str]:
        """Return the problems of shaft speed, temperature sources and readings; '' for none."""
        now = self.clock()
        several = 'several sources of temperature: only the first is used'
        contested = several if self._sources.contested(now) else ''
        return self.shaft.problem(now), contested, self._doubt

    def set_timeout(self, timeout: float) -> None:
        """Set the age above which a temperature is stale, s."""
        self.gate.timeout = self._sources.timeout = self._sources.remember = timeout


@dataclass
class Intake:
    """Counts and times of the blocks of one topic; times in s."""

    blocks: int = 0
    """Blocks used."""
    refused: int = 0
    problem: str = ''
    """Reason why the last refused block was refused."""
    refused_at: float = -math.inf
    """Arrival of that block."""
    arrived: float = math.nan
    """Arrival of the last block, used or refused."""
    used: float = math.nan
    """Arrival of the last block that was used."""
    pause: float = 0.0
    """Longest time from one block to the next that is meant, as between snapshots."""
    length: float = 0.0
    """Duration of the last block that was used: the next one comes so much later."""
    sources: SourceLock = field(default_factory=SourceLock)
    gaps: GapCounter = field(default_factory=GapCounter)

    @property
    def silent_after(self) -> float:
        """Age of the last block above which the source counts as silent."""
        return SILENT_AFTER + self.length + self.pause

    def use(self, length: float) -> None:
        """Count the block that has arrived now, of a duration of ``length``, as used."""
        self.blocks += 1
        self.used, self.length = self.arrived, length
        self.sources.timeout, self.sources.remember = SILENT_AFTER + length, REMEMBERED + length

    def refuse(self, problem: str) -> None:
        """Count the block that has arrived now as refused."""
        self.refused += 1
        self.problem, self.refused_at = problem, self.arrived

    def trouble(self, now: float) -> str:
        """
        Return why a block was refused lately, '' if none was.

        It stands for ``SILENT_AFTER`` and the length of a block, so that a status does not change
        with each second block.
        """
        return self.problem if now - self.refused_at <= SILENT_AFTER + self.length else ''
