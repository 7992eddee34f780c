# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Compilation of the diagnosis before its first use."""

from __future__ import annotations

from bearing_twin.bearing import fault_orders, find_bearing
from bearing_twin.diagnosis.combs.comb import OrderSpectra
from bearing_twin.diagnosis.machine.dependence import fit_law, LEAST_ROWS
from bearing_twin.diagnosis.record import diagnose_record
from bearing_twin.diagnosis.series.monitor import SeriesMonitor
from bearing_twin.diagnosis.signal.shaft import resample
import numpy as np

RATE, SHAFT_HZ = 25600, 25.0


def warm_up() -> None:
    """
    Compile, or load from the cache, all compiled functions of a diagnosis.

    It diagnoses a second of inner race impacts: a healthy signal calls fewer functions.

    Examples
    --------
    >>> warm_up()

    """
    bearing = find_bearing('6307')
    x = np.random.default_rng(0).standard_normal(RATE)
    impacts = np.arange(0.0, 0.99, 1.0 / fault_orders(bearing).bpfi / SHAFT_HZ)
    for at in (RATE * impacts).astype(int):
        x[at : at + 8] += 20.0 * (-0.7) ** np.arange(8)
    diagnose_record(x, RATE, bearing, SHAFT_HZ)
    # Called only beside the comb of another race, or if the cage's comb is the strongest.
    OrderSpectra.of_lines(np.ones(1)).line_power(np.ones(1), slice(1))
    # Called only with a healthy record of one machine.
    level = np.zeros(LEAST_ROWS)
    fit_law(level, level, level)
    # The level of a snapshot is taken from a spectrum of double precision.
    SeriesMonitor(None).add(0.0, x, RATE, SHAFT_HZ)
    # Called only if the speed varies.
    resample(np.zeros(4), np.zeros(1))
