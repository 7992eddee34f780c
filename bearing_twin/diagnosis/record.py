# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagnosis of a whole record."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
import functools
import itertools
import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import check_geometry, LEVELS, PLACES
from bearing_twin.diagnosis.chain import Analysis, Excerpt
from bearing_twin.diagnosis.machine.level import unrated, with_fault_stage, with_required_level
from bearing_twin.diagnosis.rules.table import FAINT
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.signal.gate import SHAFT_TURNS
from bearing_twin.diagnosis.signal.shaft import other_shafts_hz, SpeedProfile
from bearing_twin.diagnosis.signal.spectra import floor_levels
from bearing_twin.diagnosis.signal.speed_track import PRECISION, track_speed
from bearing_twin.diagnosis.thresholds import INDEX_FAULT, RIVAL
from bearing_twin.errors import BearingTwinError
from bearing_twin.given import one_axis, real_number, real_numbers
from bearing_twin.repeats import repeated_span
import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.result import Diagnosis


WINDOW_TURNS = 256.0
"""Shaft turns of the windows into which a record is cut."""

_PART_TURNS = 2.0 * SHAFT_TURNS
"""Least shaft turns of a part of a record: twice those that a diagnosis needs."""

_NEAR = 10
"""Width of the floor that smeared lines raise, counted in every other bin: sharp ones have 3."""

_ABOVE_TURN = 1.5
"""Lowest order at which smeared lines are looked for."""

_SMEARED = 0.375 * INDEX_FAULT**2 / 2.0
"""Power of smeared lines, relative to that of the mean: half the power of lines with the
modulation index of a fault. A line of the index m has m^2 / 4, and its two neighbours together
half as much."""

_LOUD = INDEX_FAULT / RIVAL
"""Modulation index, with segments weighted by power, above which the record is analysed as a
whole: in another band than that of the answer it may be a fault."""

_BURSTS = 'second by second the modulation is weaker: the impacts come in bursts'


def diagnose_record(
    x: ArrayLike,
    sample_rate: float,
    bearing: Bearing,
    shaft_hz: ArrayLike,
    *,
    speed_tolerance: float | None = None,
    unit: str = '',
    temperature: float = math.nan,
    settings: DiagnosisSettings | None = None,
) -> Diagnosis:
    """
    Diagnose a whole record.

    Parameters
    ----------
    x
        Vibration, one axis, shape (n,), in any unit.
    sample_rate
        Hz.
    bearing
        Geometry.
    shaft_hz
        Shaft speed, Hz; NaN (unknown) gives ``insufficient``. One number, or the speed at each
        sample, shape (n,): if it varies by more than 0.5 % the envelopes are resampled over angle.
    speed_tolerance
        Relative tolerance of ``shaft_hz``. The default is ``speed_tolerance`` of the settings, or
        ``measured_speed_tolerance`` for a speed that varies from sample to sample.
    unit
        Unit of x, for the severity.
    temperature
        Bearing temperature, degC, if known.
    settings
        See :class:`DiagnosisSettings`.

    Raises
    ------
    BearingTwinError
        If x is not one-dimensional, ``bearing`` is only a name, ``shaft_hz`` is neither a number
        nor of the shape of x, or a setting is outside its range. A record that cannot be diagnosed
        is no error: the result is ``insufficient`` and the reasons say why.

    Examples
    --------
    Impacts at the frequency of the inner race in noise:

    >>> import numpy as np
    >>> from bearing_twin.bearing import fault_orders, find_bearing
    >>> bearing = find_bearing('6307')
    >>> rng = np.random.default_rng(1)
    >>> x = rng.standard_normal(102400)
    >>> gap = 25600.0 / (fault_orders(bearing).bpfi * 24.7)
    >>> x[np.arange(0.0, 102400.0, gap).astype(int)] += 25.0
    >>> verdict = diagnose_record(x, 25600.0, bearing, 24.7, speed_tolerance=0.002)
    >>> verdict.result, verdict.level
    ('inner', 'fault')

    """
    check_geometry(bearing)
    settings = settings or DiagnosisSettings()
    if speed_tolerance is not None:
        settings = replace(settings, speed_tolerance=speed_tolerance)
    signal, speeds = one_axis(x), real_numbers('shaft_hz', shaft_hz)
    sample_rate = real_number('sample_rate', sample_rate)
    temperature = real_number('temperature', temperature)
    if speeds.shape not in ((), signal.shape):
        raise BearingTwinError(
            f'shaft_hz has shape {speeds.shape}, x has {signal.shape}; give one number or one '
            'a sample'
        )
    if speeds.size > 1 and np.ptp(speeds) > 0.0 and speed_tolerance is None:
        settings = settings.measured
    lengths = np.full(max(speeds.size, 1), len(signal) // max(speeds.size, 1))
    profile = SpeedProfile(np.atleast_1d(speeds), lengths)
    cut = functools.partial(
        Excerpt.of, sample_rate=sample_rate, bearing=bearing, settings=settings,
        longest=WINDOW_TURNS, temperature=temperature, unit=unit,
    )  # fmt: skip
    analysis = cut(signal, profile).analyse()
    if analysis.window and (copies := repeated_span(signal)):
        analysis = Analysis(analysis.excerpt, analysis.shaft_hz, refused=(copies,))
    found = analysis.alone
    if found.rule in FAINT and found.level == 'suspect' and _may_strike_in_bursts(analysis):
        # A segment is whitened by its own noise: bursts of seconds count little in the mean.
        whole = cut(signal, profile, divided=False).analyse().alone
        if whole.level == 'fault':
            found = replace(whole, reasons=(*whole.reasons, _BURSTS))
    if speeds.size == 1:
        found = at_other_speeds(found, analysis, signal, cut)
    return with_fault_stage(with_required_level(found))


def at_other_speeds(
    found: Diagnosis,
    analysis: Analysis,
    x: NDArray[np.float64],
    cut: Callable[..., Excerpt],
) -> Diagnosis:
    """
    Return the answer after looks at other speeds than the steady one that is given.

    Parameters
    ----------
    found
        Answer at the given speed.
    analysis
        Analysis at the given speed.
    x
        Samples, shape (n,).
    cut
        Makes an excerpt of samples and their speed.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.diagnosis.settings import DiagnosisSettings
    >>> known = {'bearing': find_bearing('6307'), 'settings': DiagnosisSettings()}
    >>> cut = functools.partial(Excerpt.of, sample_rate=25600.0, **known)
    >>> x = np.random.default_rng(0).standard_normal(102400)
    >>> analysis = cut(x, 25.0).analyse()
    >>> at_other_speeds(analysis.alone, analysis, x, cut).result
    'healthy'

    """
    # If the speed moves, the lines of a fault smear over the whole but not over its parts.
    if found.rule in FAINT and found.level != 'fault' and _smeared(analysis):
        turns = len(x) / analysis.excerpt.sample_rate * _steady_hz(analysis.excerpt)
        parts = functools.partial(_parts, analysis.excerpt, x, turns, cut)
        found = _moving(found, turns, parts) or found
    found = _at_moving_speed(found, analysis, x, cut)
    return _with_other_shafts(found, analysis, functools.partial(cut, x))


def _at_moving_speed(
    found: Diagnosis,
    analysis: Analysis,
    x: NDArray[np.float64],
    cut: Callable[..., Excerpt],
) -> Diagnosis:
    """Return the answer after a look at the speed that the lines of the shaft move through."""
    excerpt = analysis.excerpt
    if found.level == 'fault' or analysis.window is None:
        return found
    speeds = track_speed(x, excerpt.sample_rate, _steady_hz(excerpt))
    if speeds is None:
        return found
    # Tenths of a turn: parts of single samples would take 4 GB more for an hour.
    step = max(int(0.1 * excerpt.sample_rate / speeds.max()), 1)
    begins = np.arange(0, len(x), step)
    lengths = np.diff(begins, append=len(x))
    profile = SpeedProfile(speeds[begins + lengths // 2], lengths)
    said = cut(x, profile).analyse().alone
    if said.level == 'fault' and said.result in PLACES:
        said = _whole_turns(said, PRECISION * said.fault_hz)
    elif found.level == 'suspect' or said.result == 'healthy':
        return found
    elif said.level == 'fault':
        said = replace(said, level='suspect')
    text = (
        f'the speed moves from {speeds.min():.4g} to {speeds.max():.4g} Hz within the record, as '
        'the lines of the shaft show, and the answer is that at these speeds; give the speed of '
        'each sample'
    )
    given, severity = found.shaft_hz_given, found.severity
    reasons = (*said.reasons, text)
    return replace(said, reasons=reasons, severity=severity, shaft_hz_given=given)


def _may_strike_in_bursts(analysis: Analysis) -> bool:
    """Return whether impacts in the loudest segments may be a fault in the record as a whole."""
    window, excerpt, said = analysis.window, analysis.excerpt, analysis.alone
    if window is None or len(excerpt.stretches) == excerpt.pieces:
        return False
    order = said.fault_hz / said.shaft_hz
    return bool(analysis.before) or window.index_by_power(order, said.band) >= _LOUD


def _parts(
    whole: Excerpt,
    x: NDArray[np.float64],
    turns: float,
    cut: Callable[..., Excerpt],
    count: int,
) -> list[Excerpt]:
    """Return equal parts of a record, x; they share transforms with ``whole`` if they are long."""
    many = len(whole.stretches)
    if turns * (many // count) >= _PART_TURNS * many:
        edges = [round(many * number / count) for number in range(count + 1)]
        return [_part(whole, *ends) for ends in itertools.pairwise(edges)]
    return [cut(part, _steady_hz(whole)) for part in np.array_split(x, count)]


def _steady_hz(whole: Excerpt) -> float:
    """Return the shaft speed, Hz, that is given for a whole record."""
    return float(whole.speed_profile.shaft_hz[0])


def _with_other_shafts(
    found: Diagnosis, analysis: Analysis, at_speed: Callable[[float], Excerpt]
) -> Diagnosis:
    """Return the answer after looks at other speeds at which lines of a shaft show."""
    window, excerpt = analysis.window, analysis.excerpt
    if window is None:
        return found
    bin_hz, tolerance = 1.0 / window.seconds, excerpt.settings.speed_tolerance
    for hertz in other_shafts_hz(window.low.power, bin_hz, _steady_hz(excerpt), tolerance):
        # The lines of the named fault can be mistaken for those of a shaft.
        own = found.level == 'fault' and abs(hertz - found.fault_hz) <= bin_hz
        if own or not analysis.may_show(hertz, _clearest(found)):
            continue
        said = at_speed(hertz).analyse().alone
        found = _at_another_speed(found, said, hertz) or found
    return found


def _clearest(said: Diagnosis) -> float:
    """Return the score of the clearest comb of an alarm; 0 without an alarm."""
    alarm = said.level == 'fault'
    return max((said.score[place] for place in said.faults), default=0.0) if alarm else 0.0


def _at_another_speed(given: Diagnosis, said: Diagnosis, hertz: float) -> Diagnosis | None:
    """
    Return the answer if lines of a shaft and a fault show at another speed; else None.

    A fault at the given speed remains the answer if its comb is clearer.
    """
    if said.level != 'fault' or said.result not in PLACES or said.result in given.faults:
        return None
    alarm = given.level == 'fault'
    if _clearest(given) > RIVAL * said.score[said.result]:
        return None
    text = (
        f'no lines of a shaft show at {given.shaft_hz_given:.4g} Hz, but at {hertz:.4g} Hz, and '
        f'at that speed it is a fault of the {said.result}: check the speed'
    )
    result = 'ambiguous' if alarm else 'suspect'
    return unrated(
        given, result=result, rule='another_speed', level='fault' if alarm else 'suspect',
        faults=(said.result, *given.faults) if alarm else (), reasons=(*given.reasons, text),
    )  # fmt: skip


def _smeared(analysis: Analysis) -> bool:
    """
    Return whether lines may be smeared, as those of a fault are if the speed moves.

    A median floor over few bins ignores sharp lines but not smeared ones, which raise it above the
    floor over many bins. The two are compared above the first harmonic of the shaft: at and below
    it healthy machines sway. Sharp lines may move between several windows, so then all lines
    count.
    """
    if analysis.window is None:
        return False
    envelopes = analysis.window.envelopes
    first = int(_ABOVE_TURN * analysis.shaft_hz / envelopes.bin_hz)
    # With a Hann window every other bin holds the same information.
    power = envelopes.power[:, first::2]
    near = power if analysis.before else floor_levels(power, _NEAR)[0]
    rise = near.mean(axis=1) - envelopes.levels.mean(axis=1)
    return bool(2.0 * power.shape[1] * rise.max() > _SMEARED)


def _part(excerpt: Excerpt, first: int, end: int) -> Excerpt:
    """Return some stretches of an excerpt as an excerpt; their transforms are kept."""
    many = end - first
    mean_hz = excerpt.speed_profile.mean_hz
    turns = many * len(excerpt.stretches[0].samples) / excerpt.sample_rate * mean_hz
    least = max(1, round(turns / WINDOW_TURNS))
    return replace(
        excerpt,
        stretches=excerpt.stretches[first:end],
        before=excerpt.stretches[first - 1] if first else None,
        left_over=0,
        pieces=next(pieces for pieces in range(least, many + 1) if many % pieces == 0),
    )


def _moving(
    whole: Diagnosis, turns: float, parts: Callable[[int], Sequence[Excerpt]]
) -> Diagnosis | None:
    """
    Return the answer of the parts of a record whose lines smear over the whole; None without one.

    It is the fault that two neighbouring parts name at frequencies more than a line apart. Two
    parts must agree, so false names are as rare as those of one part. Otherwise a record whose
    level is *ok* or unknown becomes suspect if two such parts suspect one place, or if one part
    has an alarm.
    """
    weaker, alarms_only = None, whole.level == 'suspect'

    @functools.cache
    def said(part: Excerpt) -> Diagnosis:
        return part.analyse().alone

    for count in (2, 4):
        if turns < count * _PART_TURNS:
            break
        cut = parts(count)
        for first in range(count - 1):
            # One of two neighbours has an odd number: without an alarm there, the pair has none.
            if alarms_only and said(cut[first | 1]).level != 'fault':
                continue
            one, other = said(cut[first]), said(cut[first + 1])
            line_hz = one.sample_rate / min(one.sample_count, other.sample_count)
            moved = abs(other.fault_hz - one.fault_hz)
            if one.faults != other.faults or not moved > line_hz:
                continue
            text = (
                f'in two neighbouring parts of about {turns / count:.0f} turns it is at '
                f'{one.fault_hz:.1f} and {other.fault_hz:.1f} Hz: the speed moves within the '
                'record, so the whole does not show it; give the speed of each sample'
            )
            if one.level == other.level == 'fault' and one.result in PLACES:
                return _of_part(whole, _whole_turns(other, moved), text)
            less = min(one, other, key=lambda said: LEVELS.index(said.level))
            if less.level == 'suspect':
                weaker = weaker or _of_part(whole, less, text)
        if alarms_only:
            continue
        alarm = next((one for one in map(said, cut) if one.level == 'fault'), None)
        if alarm and not weaker:
            text = (
                f'only one part of about {turns / count:.0f} turns is an alarm, and the speed '
                'seems to move within the record, so that its place is not sure: repeat it, and '
                'give the speed of each sample'
            )
            alarm = unrated(alarm, result='suspect', level='suspect')
            weaker = _of_part(whole, alarm, text)
    return None if alarms_only else weaker


def _whole_turns(part: Diagnosis, moved_hz: float) -> Diagnosis:
    """
    Return a part as ambiguous if its order is off a whole number by no more than the speed moved.

    Impacts a whole number of times a turn would look the same in each part. The same holds where
    the speed is known no better.
    """
    order = part.fault_hz / part.shaft_hz
    if abs(order - round(order)) > order * moved_hz / part.fault_hz:
        return part
    text = f'impacts {round(order)} times a turn would look the same'
    return unrated(part, result='ambiguous', level='suspect', reasons=(*part.reasons, text))


def _of_part(whole: Diagnosis, part: Diagnosis, text: str) -> Diagnosis:
    """Return the answer of a part as the answer of the whole record."""
    return replace(
        part,
        reasons=(*part.reasons, text),
        first_sample=whole.first_sample,
        sample_count=whole.sample_count,
        severity=whole.severity,
        spectrum=whole.spectrum,
    )
