# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Record gate: reasons why samples cannot be diagnosed, checked before any analysis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
import math

import numpy as np
from numpy.typing import NDArray

SHAFT_TURNS = 20.0
"""Least shaft turns in a window for any statement: a shaft order has 20 bins then."""

HEALTHY_TURNS = 50.0
"""Least shaft turns, all windows together, to call a bearing healthy; fewer show only strong
faults (measured: docs/diagnosis_results.md, detection power)."""

CAGE_TURNS = 40.0
"""Least cage turns in a window for a cage statement."""

DAMPING = 0.04
"""Assumed damping ratio of the ringing after an impact: housings and their races have 2 to 5 %."""

HIGHEST_RINGING_HZ = 20_000.0
"""Highest frequency, Hz, at which impacts are searched: few sensors and mountings pass more."""
LOWEST_RINGING_HZ = 3000.0
"""Frequency, Hz, at which a housing may ring and no higher."""

_PASSED = 1.0 / 2.56
"""Pass band of the filters of a measuring chain over the sample rate."""
_RUN_TOGETHER = 1.8
"""Highest rate of impacts, relative to c of :func:`fastest_impacts_hz`, with a fault's index."""

FAINTEST, LARGEST = 1e-100, 1e100
"""Range of samples whose powers do not overflow or underflow, in any unit."""
_SPOILT_SHARE = 0.005
"""Largest share of samples that are clipped, or held at one value."""
CONVERTER_STEPS = 2.0
"""Least RMS of a healthy signal in steps of its converter: rounding, which has an RMS of
1/sqrt(12) steps, is 17 dB below it. A dead sensor may have a smaller RMS; a fault shows all the
same."""
_LOOKED_AT, _MOST_VALUES = 1024, 64
"""Number of samples that are searched for different values, and number of values of a signal with
many steps: noise with an RMS of two steps has about 15."""
_HELD = 64
"""Least length of a run of one value, samples."""
_SILENT_TURNS = 3.0
"""Shaft turns for which no live sensor repeats one value. Noise may be below a step of the
converter with impacts of a defect above it. But these come at least once a cage turn, and no cage
is slower than a third of the shaft."""
_RUN = 3
_ENDS = 1e-6
"""Width of each end of the range, relative to the range."""
_RAIL = 0.06
"""Share of the samples at one end, in runs or not, that means clipping: a sine of 32 steps, the
fewest that count as many values, has 5.6 % at the highest."""


@dataclass(frozen=True)
class Extent:
    """
    Range of a part of a record, and number of samples at its ends.

    >>> Extent.of(np.array([1.0, 1.0, 1.0, -1.0, -1.0, -1.0]))
    Extent(count=6, bad=0, low=-1.0, high=1.0, at_low=3, at_high=3, steps=inf, held=())

    """

    count: int
    bad: int
    """Number of samples that are NaN or infinite."""
    low: float
    high: float
    at_low: int
    """Number of samples at the lowest value in runs of three or more; all of them if many."""
    at_high: int
    steps: float = math.inf
    """RMS about the mean in steps between values; infinite if there are many values."""
    held: tuple[int, ...] = ()
    """Lengths of the runs of one value, samples; short runs are left out."""

    @classmethod
    def of(cls, x: NDArray[np.float64]) -> Extent:
        """Return the extent of samples, shape (n,)."""
        if len(x) == 0:
            return cls(0, 0, math.nan, math.nan, 0, 0)
        low, high = float(x.min()), float(x.max())
        if not (math.isfinite(low) and math.isfinite(high)):
            bad = int(np.count_nonzero(~np.isfinite(x)))
            return cls(len(x), bad, math.nan, math.nan, 0, 0)
        span, steps = _ENDS * (high - low), _steps(x)
        most = len(x) if math.isfinite(steps) else _RAIL * len(x)
        at_low, at_high = (_at_end(end, most) for end in (x <= low + span, x >= high - span))
        return cls(len(x), 0, low, high, at_low, at_high, steps, _held(x))


def check_record(
    parts: Sequence[Extent], sample_rate: float, shaft_hz: float, highest_order: float
) -> list[str]:
    """
    Return the reasons why a record cannot be diagnosed; empty if it can.

    Parameters
    ----------
    parts
        Extents of the parts of the record; of the whole record if it is one.
    sample_rate
        Hz.
    shaft_hz
        Shaft speed, Hz.
    highest_order
        Highest fault order of the bearing.

    >>> check_record([Extent.of(np.sin(np.arange(25600.0)))], 25600.0, 25.0, 5.0)
    []
    >>> check_record([Extent.of(np.ones(25600))], 25600.0, 25.0, 5.0)
    ['the signal is constant at 1: check sensor and cable']

    """
    unusable = _unusable(parts, sample_rate, shaft_hz)
    if unusable:
        return [unusable]
    seconds = sum(part.count for part in parts) / sample_rate
    found = (
        _clipped(parts),
        _stuck(parts, _SILENT_TURNS * sample_rate / shaft_hz),
        _too_short(seconds, shaft_hz),
        _sampled_too_slowly(sample_rate, shaft_hz, highest_order),
    )
    return [reason for reason in found if reason]


def _unusable(parts: Sequence[Extent], sample_rate: float, shaft_hz: float) -> str:
    """Return why nothing can be said of the samples; '' if something can."""
    count = sum(part.count for part in parts)
    if count < 2:
        holds = 'has one sample' if count else 'is empty'
        return f'the record {holds}: give at least a second of vibration'
    if not (math.isfinite(sample_rate) and sample_rate > 0.0):
        return f'sample rate {sample_rate} Hz: a positive number is needed'
    bad = sum(part.bad for part in parts)
    if bad:
        return f'{bad} of {count} samples are NaN or infinite: repair or leave out that part'
    low, high = min(part.low for part in parts), max(part.high for part in parts)
    largest = max(abs(low), abs(high))
    if largest > LARGEST:
        return f'samples reach {largest:g}: beyond the range of any sensor; check its driver'
    if high - low <= max(1e-12 * largest, FAINTEST):
        return f'the signal is constant at {low:g}: check sensor and cable'
    if shaft_hz == 0.0:
        return 'the shaft stands still: measure while it turns'
    if not math.isfinite(shaft_hz) or shaft_hz < 0.0:
        return 'the shaft speed is unknown: give it (joint_states, rpm or --shaft-hz)'
    return ''


def _clipped(parts: Sequence[Extent]) -> str:
    """Return the reason if many samples are at the ends of the range of the record, else ''."""
    low, high = min(part.low for part in parts), max(part.high for part in parts)
    span, count = _ENDS * (high - low), sum(part.count for part in parts)
    at_ends = sum(part.at_high for part in parts if part.high >= high - span)
    at_ends += sum(part.at_low for part in parts if part.low <= low + span)
    if at_ends <= _SPOILT_SHARE * count:
        return ''
    share, steps = 100.0 * at_ends / count, max(part.steps for part in parts)
    if steps < CONVERTER_STEPS:
        # The end of so few values is no end of a converter, which has many.
        return (
            f'the RMS is {steps:.2g} steps of the converter, and {share:.1f} % of the samples sit '
            'at an end of the few values: is the sensor dead? If it is not, raise the gain'
        )
    return (
        f'{share:.1f} % of the samples sit at the end of the range: the '
        f'signal is clipped (limit {100.0 * _SPOILT_SHARE:g} %); lower the gain'
    )


def _stuck(parts: Sequence[Extent], silent: float) -> str:
    """Return the reason if many samples are in runs of ``silent`` or more equal ones, else ''."""
    count = sum(part.count for part in parts)
    held = sum(run for part in parts for run in part.held if run >= silent)
    if held <= _SPOILT_SHARE * count:
        return ''
    return (
        f'{100.0 * held / count:.1f} % of the samples repeat one value for '
        f'{_SILENT_TURNS:g} shaft turns or more (limit {100.0 * _SPOILT_SHARE:g} %): the '
        'sensor or its connection fails at times, or the signal is below the steps of the '
        'converter; leave out that part or raise the gain'
    )


def _too_short(seconds: float, shaft_hz: float) -> str:
    """Return the reason if a record has too few shaft turns, else ''."""
    turns = seconds * shaft_hz
    if turns >= SHAFT_TURNS:
        return ''
    return (
        f'{turns:.1f} shaft turns in {seconds:.3g} s: at least {SHAFT_TURNS:g} are needed, '
        f'{SHAFT_TURNS / shaft_hz - seconds:.3g} s more, and {HEALTHY_TURNS:g} to call it '
        f'healthy, {HEALTHY_TURNS / shaft_hz - seconds:.3g} s more'
    )


def _sampled_too_slowly(sample_rate: float, shaft_hz: float, highest_order: float) -> str:
    """Return the reason if four harmonics of the highest fault order do not fit, else ''."""
    wanted = 8.0 * highest_order * shaft_hz
    if sample_rate >= wanted:
        return ''
    return (
        f'sample rate {sample_rate:g} Hz: at least {wanted:.0f} Hz are needed to demodulate '
        f'four harmonics of the highest fault frequency of a shaft at {60.0 * shaft_hz:.5g} '
        '1/min: are speed and rate right, and in these units?'
    )


def fastest_impacts_hz(sample_rate: float, highest_hz: float = HIGHEST_RINGING_HZ) -> float:
    """
    Return the highest rate of impacts, Hz, at which a fault shows in the envelope.

    The squared envelope of a ringing at f0 decays as exp(-t 2 pi c), c = 2 zeta f0. This lowers
    the k-th harmonic of impacts at f by H_k = 1 / sqrt(1 + (k f / c)^2). Impacts as loud as the
    noise in their band have the modulation index sqrt(sum H_k^2) over four harmonics. It falls to
    0.6, the index of a fault, at f = 1.8 c. The damping zeta is 4 %.

    Parameters
    ----------
    sample_rate
        Hz.
    highest_hz
        Highest f0, Hz, if the pass band of the samples holds it.

    >>> round(fastest_impacts_hz(25600.0)), round(fastest_impacts_hz(204800.0))
    (1440, 2880)
    >>> round(fastest_impacts_hz(204800.0, LOWEST_RINGING_HZ))
    432

    """
    ringing_hz = min(_PASSED * sample_rate, highest_hz)
    return _RUN_TOGETHER * 2.0 * DAMPING * ringing_hz


def _steps(x: NDArray[np.float64]) -> float:
    """Return the RMS about the mean in steps between values; infinite if there are many."""
    looked_at = x[:: max(len(x) // _LOOKED_AT, 1)]
    # For most signals the first samples are enough.
    if len(set(looked_at[: 2 * _MOST_VALUES].tolist())) > _MOST_VALUES:
        return math.inf
    values = np.unique(looked_at)
    if len(values) > _MOST_VALUES or len(x) < _MOST_VALUES:
        return math.inf
    if len(values) == 1:
        return 0.0
    return float(x.std() / np.diff(values).min())


def _held(x: NDArray[np.float64]) -> tuple[int, ...]:
    """Return the lengths of the runs of one value."""
    # A run contains two neighbours of a grid of half its length: most signals have none.
    grid = x[:: _HELD // 2]
    if not np.any(grid[1:] == grid[:-1]):
        return ()
    runs = _runs(x[1:] == x[:-1]) + 1
    return tuple(int(run) for run in runs[runs >= _HELD])


def _at_end(at_end: NDArray[np.bool_], most: float) -> int:
    """Return the number of true values; if they are few, of those in runs of three or more."""
    count = int(np.count_nonzero(at_end))
    if count > most:
        return count
    if count < _RUN:
        return 0
    runs = _runs(at_end)
    return int(runs[runs >= _RUN].sum())


def _runs(true: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Return the lengths of the runs of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], true.view(np.int8), [0]))))
    return edges[1::2] - edges[::2]
