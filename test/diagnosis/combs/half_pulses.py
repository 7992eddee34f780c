# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Pulses at twice the order of a race, and faults of that race: the limit ``MISSING`` parts them.

The heights of pulses scatter by 25 % and vary by up to a half with the shaft (eccentricity). A
fault with two edges strikes twice: the second impact comes half a gap after the first and has 0.5
to 0.8 of its height, so that the odd harmonics are weak.
"""

from bearing_twin.bearing import fault_orders, find_bearing
from bearing_twin.diagnosis.chain import Excerpt
from bearing_twin.diagnosis.combs.search import CombSearch
from bearing_twin.diagnosis.rules.evidence import Evidence
from bearing_twin.diagnosis.rules.table import decide
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.thresholds import INDEX_FAULT, Z_FAULT
import numpy as np
from scipy import signal

BEARINGS = ('6205', '6307', '6308', '6203', '6318')
RATES = (12800.0, 25600.0, 51200.0)


def _train(kind, order, turns, rng):
    """Return the times of the impacts, in turns of the shaft, and their heights."""
    per_turn = 2.0 * order if kind == 'pulses' else order
    count = int(turns * per_turn)
    jitter = 0.0 if kind == 'pulses' else 0.005
    places = np.cumsum(1.0 + jitter * rng.standard_normal(count)) / per_turn
    turning = np.cos(2.0 * np.pi * (places + rng.random()))
    heights = 1.0 + rng.uniform(0.0, 0.5) * turning + 0.25 * rng.standard_normal(count)
    if kind != 'two edges':
        return places, heights
    second = rng.uniform(0.5, 0.8) * (1.0 + 0.25 * rng.standard_normal(count))
    return (np.concatenate((places, places + 0.5 / per_turn)), np.concatenate((heights, second)))


def measured(kind, number):
    """
    Return odd over even harmonics of a record, and whether it raises an alarm; None if too weak.

    ``kind`` is 'pulses', 'fault' or 'two edges'. A number is always the same record.
    """
    rng = np.random.default_rng([2031, number])
    bearing, place = find_bearing(str(rng.choice(BEARINGS))), str(rng.choice(('outer', 'inner')))
    rate, shaft_hz = float(rng.choice(RATES)), float(rng.uniform(10.0, 40.0))
    turns = float(rng.uniform(50.0, 200.0))
    order = fault_orders(bearing, rng.uniform(0.0, 0.015)).impacts(place)
    places, heights = _train(kind, order, turns, rng)
    impacts = np.zeros(int(rate * turns / shaft_hz))
    at = (places / shaft_hz * rate).astype(int)
    np.add.at(impacts, at[at < len(impacts)], heights[at < len(impacts)])
    angle = 2.0 * np.pi * rng.uniform(0.15, 0.4) * np.arange(int(0.02 * rate))
    x = signal.fftconvolve(impacts, np.exp(-0.04 * angle) * np.sin(angle))[: len(impacts)]
    x = x * (rng.uniform(0.2, 1.5) / x.std()) + rng.standard_normal(len(x))
    given_hz = shaft_hz * float(rng.uniform(0.998, 1.002))
    found = Excerpt.of(x, given_hz, rate, bearing, DiagnosisSettings()).analyse().window
    if found is None:
        return None
    combs = CombSearch(found.orders, bearing, found.speed)
    comb = combs.best(place)
    if comb.z < Z_FAULT or comb.index < INDEX_FAULT:
        return None
    verdict = decide(Evidence(combs, found.revolutions))
    return combs.harmonics.unshared_height(comb.order, 2), verdict.level == 'fault'
