# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Blocks of vibration, and spans of a record, that repeat those before."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

FEWEST_STEPS = 32
"""Fewest steps from sample to sample in a block that is compared with the one before."""
REPEATED = (
    'its samples are those of the block before: the driver sends each block twice, or hangs; '
    'correct or restart it; a simulation whose period is a block needs noise'
)
"""Why a block is refused that a :class:`RepeatCheck` recognises."""
_PLACES = 20
"""Number of places of a record at which a repeated span is searched."""
_PATTERN = 128
"""Samples that are compared at such a place; the shortest repetition that counts."""
_SHARE = 0.05
"""Share of copies in a record from which it is refused: one place of `_PLACES` is a twentieth."""
_PREDICTORS = 16
"""Samples from which the next one is predicted: those of seven lines or modes suffice."""
_PREDICTED = 48
"""Samples that are predicted together."""
_MOST = 8192
"""Samples of a span that are looked at."""
_ROUNDED = 4.0
"""Largest error of the prediction that rounding makes, in steps of the converter."""
_UNPREDICTED = 1e-4
"""Least error of the prediction, relative to the RMS, of a signal with noise."""


class RepeatCheck:
    """
    Recognise a block whose samples are those of the block before, which no live sensor gives.

    A driver that sends each block twice, or that has stopped and sends its last buffer again,
    does. Blocks of few steps do not count, as they may be equal by chance: those of a sensor that
    is not connected, or of a machine at rest that changes the last bit of the counts now and then.

    Examples
    --------
    >>> check = RepeatCheck()
    >>> noise = np.random.default_rng(0).normal(size=128)
    >>> [check.repeats(block) for block in (noise, noise[::-1], noise[::-1])]
    [False, False, True]

    """

    def __init__(self) -> None:
        self._former: NDArray[Any] | None = None

    def repeats(self, samples: NDArray[Any]) -> bool:
        """Whether ``samples``, shape (n,) or (channels, n), are those of the last call."""
        former, self._former = self._former, samples
        return (
            former is not None
            and np.array_equal(samples, former)
            and int(np.count_nonzero(samples[..., 1:] != samples[..., :-1])) >= FEWEST_STEPS
        )


def repeated_span(x: NDArray[np.float64]) -> str:
    """
    Return why a record is refused that repeats a span of itself, noise included; '' if none does.

    A driver that hangs writes its last buffer again and again. Noise never repeats in all its
    bits. A simulation without noise may, and is no such record: most of its samples follow from
    those before them.

    Parameters
    ----------
    x
        Samples, shape (n,).

    Examples
    --------
    >>> noise = np.random.default_rng(0).normal(size=5000)
    >>> repeated_span(noise)
    ''
    >>> repeated_span(np.concatenate([noise, *9 * [noise[-1024:]]]))[:52]
    '65 % of the samples repeat those 1024 samples before'
    >>> repeated_span(np.tile(np.sin(2.0 * np.pi * np.arange(1024) / 256), 20))
    ''

    """
    for place in range(0, len(x) - 2 * _PATTERN, max(len(x) // _PLACES, 1)):
        span = _span(x, place)
        if not span:
            continue
        again = x[span:] == x[:-span]
        edges = np.flatnonzero(np.diff(again, prepend=False, append=False))
        runs = edges[1::2] - edges[::2]
        share = float(runs[runs >= _PATTERN].sum()) / len(x)
        if share > _SHARE and _is_noisy(x[place : place + span]):
            return (
                f'{100.0 * share:.0f} % of the samples repeat those {span} samples before, bit by '
                'bit with all noise: the driver hung or sent blocks twice, or copies were joined; '
                'measure again, or leave the copies out'
            )
    return ''


def _span(x: NDArray[np.float64], place: int) -> int:
    """Return after how many samples those at a place come again; 0 if they do not."""
    pattern = x[place : place + _PATTERN]
    if np.count_nonzero(pattern[1:] != pattern[:-1]) < FEWEST_STEPS:
        return 0
    begins = np.flatnonzero(x[place + _PATTERN : len(x) - _PATTERN + 1] == pattern[0])
    begins += place + _PATTERN
    for offset in range(1, _PATTERN):
        if not len(begins):
            return 0
        begins = begins[x[begins + offset] == pattern[offset]]
    return int(begins[0]) - place if len(begins) else 0


def _is_noisy(span: NDArray[np.float64]) -> bool:
    """Return whether nowhere in a span do samples follow from those before, up to rounding."""
    step = float(np.diff(np.unique(span)).min())
    least = max(_ROUNDED * step, _UNPREDICTED * float(span.std()))
    rows = np.lib.stride_tricks.sliding_window_view(span[:_MOST] - span.mean(), _PREDICTORS + 1)
    # Between two impacts of a simulation: the begin of an impact follows from nothing.
    for begin in range(0, len(rows) - _PREDICTED + 1, _PREDICTORS):
        given, wanted = np.split(rows[begin : begin + _PREDICTED], [_PREDICTORS], axis=1)
        errors = wanted - given @ np.linalg.lstsq(given, wanted, rcond=None)[0]
        if float(errors.std()) < least:
            return False
    return True
