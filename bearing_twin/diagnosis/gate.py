# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The record gate: whether samples can be diagnosed at all, checked before any analysis."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ['CAGE_TURNS', 'HEALTHY_TURNS', 'SHAFT_TURNS', 'check_record', 'check_speeds']

SHAFT_TURNS = 20.0
"""Least shaft turns in a window for any statement: the comb has then 20 bins a shaft order."""

HEALTHY_TURNS = 50.0
"""Least shaft turns, all windows together, to call a bearing healthy; fewer show only strong
faults (measured: docs/diagnosis.md, detection power)."""

CAGE_TURNS = 40.0
"""Least cage turns in a window for a cage statement."""

_CLIPPED_SHARE = 0.005
_RUN = 3


def check_record(
    x: NDArray[np.float64], sample_rate: float, shaft_hz: float, highest_order: float
) -> list[str]:
    """
    Reasons why a record cannot be diagnosed; empty if it can.

    Parameters
    ----------
    x
        Samples, shape (n,).
    sample_rate
        Hz.
    shaft_hz
        Shaft speed, Hz.
    highest_order
        Highest fault order of the bearing.

    >>> import numpy as np
    >>> check_record(np.sin(np.arange(25600.0)), 25600.0, 25.0, 5.0)
    []
    >>> check_record(np.ones(25600), 25600.0, 25.0, 5.0)
    ['the signal is constant at 1: check sensor and cable']

    """
    if len(x) == 0:
        return ['the record is empty: give at least a second of vibration']
    if not (math.isfinite(sample_rate) and sample_rate > 0.0):
        return [f'sample rate {sample_rate} Hz: a positive number is needed']
    bad = len(x) - int(np.isfinite(x).sum())
    if bad:
        return [f'{bad} of {len(x)} samples are NaN or infinite: repair or leave out that part']
    low, high = float(x.min()), float(x.max())
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        return [f'the signal is constant at {low:g}: check sensor and cable']
    if not math.isfinite(shaft_hz) or shaft_hz <= 0.0:
        return ['the shaft speed is unknown: give it (joint_states, rpm or --shaft-hz)']
    reasons = []
    clipped = _clipped_share(x, low, high)
    if clipped > _CLIPPED_SHARE:
        reasons.append(
            f'{100.0 * clipped:.1f} % of the samples sit at the end of the range: the signal is '
            f'clipped (limit {100.0 * _CLIPPED_SHARE:g} %); lower the gain'
        )
    turns = len(x) / sample_rate * shaft_hz
    if turns < SHAFT_TURNS:
        held = len(x) / sample_rate
        reasons.append(
            f'{turns:.1f} shaft turns in {held:.3g} s: at least {SHAFT_TURNS:g} are needed, '
            f'{SHAFT_TURNS / shaft_hz - held:.2g} s more, and {HEALTHY_TURNS:g} to call it '
            f'healthy, {HEALTHY_TURNS / shaft_hz - held:.2g} s more'
        )
    wanted = 8.0 * highest_order * shaft_hz
    if sample_rate < wanted:
        reasons.append(
            f'sample rate {sample_rate:g} Hz: at least {wanted:.0f} Hz are needed to demodulate '
            'four harmonics of the highest fault frequency'
        )
    return reasons


def check_speeds(shaft_hz: NDArray[np.float64]) -> list[str]:
    """
    Reasons why speeds within a record are none that it can be taken over; empty if they are.

    >>> import numpy as np
    >>> check_speeds(np.array([25.0, 25.1]))
    []
    >>> check_speeds(np.array([25.0, 0.0]))
    ['the shaft stood still or turned backwards within the window']

    """
    if not np.isfinite(shaft_hz).all() or shaft_hz.min() <= 0.0:
        return ['the shaft stood still or turned backwards within the window']
    return []


def _clipped_share(x: NDArray[np.float64], low: float, high: float) -> float:
    """Share of samples in runs of three or more at either end of the range."""
    span = 1e-6 * (high - low)
    at_end = (x >= high - span) | (x <= low + span)
    if int(at_end.sum()) < _RUN:
        return 0.0
    edges = np.flatnonzero(np.diff(np.concatenate(([0], at_end.view(np.int8), [0]))))
    runs = edges[1::2] - edges[::2]
    return float(runs[runs >= _RUN].sum()) / len(x)
