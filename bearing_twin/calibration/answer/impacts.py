# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The two impacts of a passage at several speeds: a passage follows the speed, ringing does not.

The edges of a defect are a fixed angle of the race apart, so that the time between their impacts
times the shaft speed is constant. For a resonance or a rebound of the rotor the time is constant.
"""

from __future__ import annotations

from collections.abc import Iterable
import math
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.calibration.answer.refusals import Kind, Refusal
from bearing_twin.calibration.measured.summaries import ELSEWHERE, HIGH_SHARE
import numpy as np
from numpy.typing import NDArray
import scipy

if TYPE_CHECKING:
    from bearing_twin.calibration.candidates.cloud import Situation
    from bearing_twin.calibration.measured.summaries import Correlation, Summary

    FloatArray = NDArray[np.float64]


SAME_TIME, OTHER_SPEED = 0.03, 1.08
"""Impacts are ringing if the time between them is the same, within this share, at two speeds of at
least this ratio."""
LOCATED = 0.5
"""Uncertainty of the time between two edges, over the half width of an impact. The impacts of
entry and exit differ in shape, which moves the peak of their correlation."""
APART = 3.0
"""Least ratio of two speeds that distinguishes ringing from a passage: its logarithm over the
uncertainty of the spacings."""


_GEAR_LINES, _OVER_FLOOR, _OVER_BESIDE = 3, 100.0, 3.0
"""Lines of a gear in the spectrum, at harmonics of its tooth frequency: least number, and least
power over the floor and over any line between two of them. Noise reaches 100 times the floor once
in e^100 lines. A bearing has lines between the harmonics as well, and its balls pass at irregular
intervals. None of 145 simulated pairs of impacts, with and without echoes, has a single such line;
each of 30 pairs beside a gear has three or more."""
_ECHO = 1.5
"""Largest distance of the echo by whitening from the tooth period of a gear, over the half width
of an impact. With the prediction of 1.2 ms it reaches 1.1 if the gear has three lines."""
_MOST_HARMONICS, _PARTS = 8, 16


class Impacts(NamedTuple):
    """Measured spacing of the two impacts of a passage."""

    place: str
    """Part with the defect."""
    shaft_hz: float
    """Shaft speed, Hz."""
    spacing_s: float
    """Time between them, s."""
    lobe_s: float
    """Half width of one impact after whitening, s."""
    rivals_s: tuple[float, ...] = ()
    """Other times after which impacts repeat about as clearly, s."""

    @property
    def turn(self) -> float:
        """Shaft turns between the impacts."""
        return self.spacing_s * self.shaft_hz

    def ratio_uncertainty(self, other: Impacts) -> float:
        """Return the uncertainty of the ratio of both spacings, as a logarithm."""
        return LOCATED * math.hypot(self.lobe_s / self.spacing_s, other.lobe_s / other.spacing_s)

    def speeds_differ(self, other: Impacts) -> bool:
        """Whether the speeds differ enough to distinguish ringing from a passage."""
        faster = abs(math.log(self.shaft_hz / other.shaft_hz))
        return self.place == other.place and faster > APART * self.ratio_uncertainty(other)


def gear_mesh(x: FloatArray, sample_rate: float, measured: Summary) -> Refusal | None:
    """
    Return a refusal if the time between two impacts is the tooth period of a gear, else None.

    The whitening of a gear's vibration leaves an echo of any other impact after the period of a
    tooth, which looks like a second impact. The spectrum itself shows the lines of the gear.

    Examples
    --------
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> rng = np.random.default_rng(1)
    >>> x = 1e-3 * rng.standard_normal(51200)
    >>> entry = np.cumsum(143 + rng.integers(-2, 3, size=300))
    >>> x[entry] += 1.0
    >>> x[entry + 20] -= 0.7
    >>> measured = summarise(x, 12800.0, 4e-3)
    >>> gear_mesh(x, 12800.0, measured) is None
    True
    >>> x[::20] += 0.3
    >>> gear_mesh(x, 12800.0, measured).why[:38]
    'the vibration repeats each 1.56 ms all'

    """
    if not measured.shows_two_impacts:
        return None
    # The speed drifts within a record: a line may be narrow only in the spectra of its parts.
    if max(_gear_lines(x, sample_rate, measured, parts) for parts in (1, _PARTS)) < _GEAR_LINES:
        return None
    return Refusal(
        Kind.SEVERAL_SPACINGS,
        f'the vibration repeats each {1e3 * measured.spacing:.2f} ms all the time: the teeth of a '
        'gear, or another part that turns',
    )


def _gear_lines(x: FloatArray, sample_rate: float, measured: Summary, parts: int) -> int:
    """Count the lines at harmonics of the inverse spacing, in the mean spectrum of ``parts``."""
    length = len(x) // parts
    power = scipy.signal.welch(x, sample_rate, nperseg=length)[1]
    step, own = sample_rate / length, 1.0 / measured.spacing
    within = _ECHO * measured.lobe / measured.spacing
    most = min(_MOST_HARMONICS, int(0.5 * HIGH_SHARE * sample_rate / (own * (1.0 + within))))
    if most < _GEAR_LINES:
        return 0
    # The main lobe of a line is two bins to either side: no line lies between two frequencies.
    tried = own * np.exp(np.arange(-within, within, step / (most * own)))
    at = np.round(np.multiply.outer(tried, np.arange(1, most + 1)) / step).astype(int)
    lines = scipy.ndimage.maximum_filter1d(power, 3)[at]
    reach = int(0.45 * own / step)
    near = [power[middle - reach : middle + reach + 1] for middle in at[len(at) // 2]]
    over = lines / np.median(near, axis=1)
    # Only as many lines as are required count: a gear may have no more.
    best = int(np.argmax(np.sort(over, axis=1)[:, -_GEAR_LINES]))
    found = 0
    for line, centre in zip(lines[best], at[best], strict=True):
        around = power[centre - reach : centre + reach + 1]
        beside = np.delete(around, slice(reach - 3, reach + 4)).max(initial=0.0)
        found += line > _OVER_FLOOR * np.median(around) and line > _OVER_BESIDE * beside
    return int(found)


def impacts_of(whole: Correlation, measured: Summary, situation: Situation) -> Impacts | None:
    """
    Return the two impacts of a passage; None if they are not seen.

    Rivals are searched up to twice the longest time of a passage, because the teeth of a gear
    repeat after twice the time too.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.measured.summaries import correlate
    >>> machine = example()
    >>> x = 1e-3 * np.random.default_rng(1).standard_normal(25600)
    >>> x[200:25000:143] += 1.0
    >>> x[220:25020:143] -= 0.7
    >>> whole = correlate(x, 12800.0)
    >>> found = impacts_of(whole, whole.summary(machine.longest_spacing), machine)
    >>> round(1e3 * found.spacing_s, 2), round(found.turn, 3)
    (1.56, 0.039)

    """
    if not measured.shows_two_impacts:
        return None
    far = whole.summary(2.0 * ELSEWHERE * situation.longest_spacing)
    times = (far.spacing, *far.rivals) if far.shows_two_impacts else measured.rivals
    # Times up to the entry of the next ball, counted from the exit, may be rivals.
    next_ball = (1.0 / situation.impact_rate - measured.spacing) / ELSEWHERE

    def rivals(time: float) -> bool:
        elsewhere = abs(math.log(time / measured.spacing)) > math.log(ELSEWHERE)
        twice = abs(time - 2.0 * measured.spacing) < measured.lobe
        return twice or (elsewhere and time < next_ball)

    return Impacts(
        place=situation.place,
        shaft_hz=situation.shaft_hz,
        spacing_s=measured.spacing,
        lobe_s=measured.lobe,
        rivals_s=tuple(filter(rivals, times)),
    )


def ringing(seen: Impacts, others: Iterable[Impacts]) -> Refusal | None:
    """
    Return a refusal if the time between the impacts is the same at another speed, else None.

    Examples
    --------
    >>> slow = Impacts('inner', 10.0, 1.51e-3, 1e-4)
    >>> ringing(Impacts('inner', 20.0, 0.76e-3, 1e-4), [slow]) is None
    True
    >>> ringing(Impacts('inner', 20.0, 1.50e-3, 1e-4), [slow]).why.partition(':')[0]
    'the impacts are 1.51 ms apart at 10.0 and at 20.0 Hz'

    """
    for other in others:
        apart = max(other.shaft_hz, seen.shaft_hz) / min(other.shaft_hz, seen.shaft_hz)
        same_time = abs(other.spacing_s / seen.spacing_s - 1.0) < SAME_TIME
        if other.place == seen.place and apart > OTHER_SPEED and same_time:
            return Refusal(
                Kind.SAME_AT_ANOTHER_SPEED,
                f'the impacts are {1e3 * other.spacing_s:.2f} ms apart at {other.shaft_hz:.1f} '
                f'and at {seen.shaft_hz:.1f} Hz: ringing, which does not follow the speed',
            )
    return None


def follows_speed(seen: Impacts, others: Iterable[Impacts]) -> tuple[Impacts, ...]:
    """
    Return the records at other speeds that show the same passage; empty if it is not proved.

    It is proved if the angle between the impacts is the same in most records at speeds that differ
    enough (`Impacts.speeds_differ`), and no record has a clear repetition at the time of another's
    passage. If impacts repeat after twice the angle too, or after a second angle in both records,
    they are from a rotating part: a gear or a fan.

    Examples
    --------
    >>> fast = Impacts('outer', 20.0, 2.34e-3, 1e-4)
    >>> len(follows_speed(fast, [Impacts('outer', 10.0, 4.65e-3, 1e-4)]))
    1

    Ringing, with another repetition that is the clearest at the other speed:

    >>> ring = Impacts('outer', 10.0, 4.65e-3, 1e-4, (2.33e-3,))
    >>> len(follows_speed(fast, [ring]))
    0

    """
    far = [other for other in others if seen.speeds_differ(other)]
    alike = tuple(other for other in far if _passage(seen, other))
    return alike if 2 * len(alike) > len(far) else ()


def _passage(one: Impacts, two: Impacts) -> bool:
    """Whether two records at speeds far apart show one passage and no other explanation."""
    within = one.ratio_uncertainty(two)
    if abs(math.log(one.turn / two.turn)) > within:
        return False
    times = (
        *((time, two.spacing_s) for time in one.rivals_s),
        *((one.spacing_s, time) for time in two.rivals_s),
    )
    twice = ((time, 2.0 * each.spacing_s) for each in (one, two) for time in each.rivals_s)
    if any(abs(math.log(a / b)) < within for a, b in (*times, *twice)):
        return False
    return not any(
        abs(math.log(a * one.shaft_hz / (b * two.shaft_hz))) < within
        for a in one.rivals_s
        for b in two.rivals_s
    )
