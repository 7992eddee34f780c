# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Time of a whole diagnosis and of another library's fast kurtogram in the same process."""

from __future__ import annotations

from collections.abc import Callable
import itertools
import time

from bearing_twin.bearing import fault_orders, find_bearing
from bearing_twin.diagnosis import diagnose_record, DiagnosisSettings, StreamingDiagnoser
import numpy as np
from numpy.typing import NDArray
from scipy import signal

RATE, SHAFT_HZ, LEVEL = 25600.0, 25.0, 6
REPEATS = 15


def fault_signal(seconds: float = 1.0) -> NDArray[np.float64]:
    """Return an inner race fault of a 6307 in white noise, which gives every stage work to do."""
    rng = np.random.default_rng(0)
    n = round(seconds * RATE)
    bpfi = fault_orders(find_bearing('6307')).bpfi * SHAFT_HZ
    times = np.arange(0.0, seconds, 1.0 / bpfi)
    impulses = np.zeros(n)
    load = 1.0 + 0.8 * np.cos(2.0 * np.pi * SHAFT_HZ * times)
    impulses[np.minimum((times * RATE).astype(int), n - 1)] = load
    ring = np.exp(-600.0 * np.arange(512) / RATE) * np.sin(
        2.0 * np.pi * 4500.0 * np.arange(512) / RATE
    )
    return np.asarray(8.0 * signal.fftconvolve(impulses, ring)[:n] + rng.standard_normal(n))


def measure() -> dict[str, float]:
    """
    Measure all stages on one second at 25.6 kHz, and a stream with a full window, on one core.

    The figures of a kurtogram need PySDKit.

    """
    x = fault_signal()
    bearing = find_bearing('6307')
    figures = {'diagnosis_ms': _median_ms(lambda: diagnose_record(x, RATE, bearing, SHAFT_HZ))}
    seconds = round(DiagnosisSettings().window)
    stream = fault_signal(float(seconds + REPEATS + 1))
    diagnoser = StreamingDiagnoser(bearing)
    diagnoser.push(0, stream[: seconds * len(x)], RATE, SHAFT_HZ)
    following = iter(np.split(stream, seconds + REPEATS + 1)[seconds:])
    places = itertools.count(seconds * len(x), len(x))
    figures['stream_verdict_ms'] = _median_ms(
        lambda: diagnoser.push(next(places), next(following), RATE, SHAFT_HZ)
    )
    window = stream[: seconds * len(x)]
    whole = _median_ms(lambda: diagnose_record(window, RATE, bearing, SHAFT_HZ))
    figures['stream_verdict_ratio'] = figures['stream_verdict_ms'] / whole
    try:
        from pysdkit.utils import fast_kurtogram
    except ImportError:
        return figures
    figures['kurtogram_ms'] = _median_ms(lambda: fast_kurtogram(x, LEVEL, RATE))
    figures['kurtogram_ratio'] = figures['diagnosis_ms'] / figures['kurtogram_ms']
    return figures


def _median_ms(call: Callable[[], object]) -> float:
    call()
    spent = []
    for _ in range(REPEATS):
        began = time.thread_time()
        call()
        spent.append(time.thread_time() - began)
    return 1e3 * float(np.median(spent))
