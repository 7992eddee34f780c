# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Claims about the times at which the paper reads its peaks."""

from __future__ import annotations

from collections.abc import Sequence
import itertools
import math
from typing import TYPE_CHECKING

from bearing_twin.paper import equations, settings
from bearing_twin.paper.claims.claim import Claim

if TYPE_CHECKING:
    from bearing_twin.paper.study import Study


TIME_DIGIT = 0.001
"""Last printed digit of a time, s."""
HOT = 100.0


def impact_numbers(times: Sequence[float], frequency: float) -> list[int]:
    """Numbers of the impacts, counted from t0 = 0, next to ``times`` (s)."""
    return [round(time * frequency) for time in times]


def frequency_interval(times: Sequence[float], numbers: Sequence[int]) -> tuple[float, float]:
    """
    Impact frequencies (Hz) compatible with peak ``times`` (s) of the ``numbers``-th impacts.

    Every time is rounded to 1 ms and follows its impact by one unknown constant delay. Such a
    delay exists if and only if every pair of times agrees:
    ``|t_i - t_j - (n_i - n_j)/f| <= 1 ms``.
    """
    low, high = 0.0, math.inf
    for (t, n), (s, m) in itertools.combinations(zip(times, numbers, strict=True), 2):
        low = max(low, (m - n) / (s - t + TIME_DIGIT))
        high = min(high, (m - n) / (s - t - TIME_DIGIT))
    return low, high


def peak_claims(study: Study) -> list[Claim]:
    """Judge the times of figures 10, 17, 24 and 29."""
    times = list(settings.PEAK_TIMES)
    f_in = equations.inner_frequency(settings.BEARING, settings.SHAFT_HZ)
    numbers = impact_numbers(times, f_in)
    instants = [n / f_in for n in numbers]
    turns = [n * settings.SHAFT_HZ / f_in for n in numbers]
    delays = {
        preset: [
            float(peak - time)
            for peak, time in zip(study.trends[preset, 'all'][0].peak_times, times, strict=True)
        ]
        for preset in settings.PRESET_NAMES
    }
    spread = {preset: max(lags) - min(lags) for preset, lags in delays.items()}
    holds = {
        'impact instants k/f_in': all(
            abs(i - t) <= TIME_DIGIT / 2 for i, t in zip(instants, times, strict=True)
        )
    }
    for preset, extent in spread.items():
        holds[f'peaks of {preset}'] = extent <= TIME_DIGIT
    interval = frequency_interval(times, numbers)
    slipping = study.frequencies['incipient', 'mu_proportional', HOT].prescribed
    rigid = study.frequencies['incipient', 'none', HOT].prescribed
    return [
        Claim(
            id='peak-times',
            where='sections 3.1 to 3.4',
            claim='peaks at 0.079, 0.277, 0.435 and 0.633 s',
            paper_value=times,
            our_value={'impacts': numbers, 'instants_s': instants, 'peak_delay_s': delays},
            as_printed=holds,
            why=(
                'Rule: with t0 = 0 at an impact in the load direction, impacts '
                f'{numbers} round to the quoted times, and the simulated peaks at 20 degC do so '
                'after one common delay, which lets the delays differ by 1 ms, the digit printed. '
                'Spread of the delays '
                + ', '.join(f'{1e3 * extent:.2f} ms ({name})' for name, extent in spread.items())
                + '. At the impacts the shaft has made '
                f'{", ".join(f"{t:.2f}" for t in turns)} turns: the defect is under the load.'
            ),
        ),
        Claim(
            id='peak-times-at-every-temperature',
            where='figures 10, 17, 24, 29 against figure 32',
            claim='the peak times are the same at ten temperatures while f_in rises to 126.823 Hz',
            paper_value=settings.F_IN['fig32'],
            our_value={
                'compatible_hz': list(interval),
                'last_peak_without_slip_s': numbers[-1] / rigid,
                'last_peak_with_slip_s': numbers[-1] / slipping,
            },
            as_printed={'126.823 Hz': interval[0] <= settings.F_IN['fig32'] <= interval[1]},
            why=(
                f'Rule: 126.823 Hz inside the interval {interval[0]:.2f} to {interval[1]:.2f} Hz '
                'that four times, rounded to 1 ms, with one common delay, allow. The waterfalls '
                'contain no shift of frequency.'
            ),
        ),
    ]
