# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Outer races that ring at a few times their frequency, and sound ones: basis of ``LOW_LINES``.

``python -m bearing_twin.studies.low_ringing [RECORDS [FIRST]]`` draws RECORDS (300) sound and as
many damaged bearings, from number FIRST (0) on. All have the lines of variable compliance and half
of them those of waviness, with random phases. Most machines also have a shaft, a gear, mains,
shocks or modulated noise. The impacts of damaged bearings ring at 4 to 11 times their frequency.
For the records that the other rules call healthy it prints how many reach each share: power in the
lines of the outer race over the power in the range of its low multiples.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_orders, find_bearing
from bearing_twin.diagnosis.chain import Excerpt
from bearing_twin.diagnosis.combs.plain_lines import low_lines
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.thresholds import LOW_LINES
from bearing_twin.studies.disturbances import disturbance, MACHINES
from bearing_twin.studies.output import arguments, print_table
import numpy as np
from numpy.typing import NDArray
from scipy import signal

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


BEARINGS = ('6203', '6205', '6206', '6306', '6307', '6309', '6311', '6313')
RATES = (8000.0, 10000.0, 12800.0, 25600.0)
SECONDS = 4.0
SHARES = (0.1, 0.2, 0.25, 0.3, LOW_LINES, 0.4, 0.5)


def _lines(
    turns: NDArray[np.float64], order: float, fall: float, count: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return lines at the first multiples of an order, which fall with their number; RMS 1."""
    total = np.zeros(len(turns))
    for k in range(1, count + 1):
        phase = 2.0 * np.pi * (k * order * turns + rng.random())
        total += rng.uniform(0.3, 1.0) * k**-fall * np.cos(phase)
    return np.asarray(total / total.std())


def record(number: int, *, damaged: bool) -> tuple[NDArray[np.float64], float, Bearing, float]:
    """Return samples, sample rate, bearing and shaft speed; a number is always the same record."""
    rng = np.random.default_rng([2041, number, damaged])
    bearing, rate = find_bearing(str(rng.choice(BEARINGS))), float(rng.choice(RATES))
    shaft_hz = float(rng.uniform(12.0, 60.0))
    turns = np.arange(int(SECONDS * rate), dtype=np.float64) * (shaft_hz / rate)
    order = fault_orders(bearing, float(rng.uniform(0.0, 0.02))).bpfo
    x = rng.standard_normal(len(turns))
    x *= 1.0 + rng.uniform(0.0, 0.16) * np.cos(2.0 * np.pi * order * turns)
    x += 10.0 ** rng.uniform(-1.0, 0.3) * _lines(turns, order, rng.uniform(1.0, 2.5), 12, rng)
    if rng.random() < 0.5:
        x += 10.0 ** rng.uniform(-1.5, -0.3) * _lines(turns, order, 0.5, 24, rng)
    machine = str(rng.choice(MACHINES))
    if machine != 'quiet':
        other = disturbance(machine, turns, rate, rng)
        x += 10.0 ** rng.uniform(-1.0, 0.3) * x.std() / other.std() * other
    if damaged:
        count = int(order * turns[-1])
        gaps = 1.0 + rng.choice((0.003, 0.008)) * rng.standard_normal(count)
        at = np.searchsorted(turns, np.cumsum(gaps) / order)
        impacts = np.zeros(len(turns))
        impacts[at[at < len(turns)]] = 1.0 + 0.2 * rng.standard_normal(
            int((at < len(turns)).sum())
        )
        angle = 2.0 * np.pi * rng.uniform(4.0, 11.0) * order * turns
        ring = np.exp(-rng.uniform(0.02, 0.06) * angle) * np.sin(angle)
        ringing = signal.oaconvolve(impacts, ring[: int(0.1 * rate)])[: len(turns)]
        x += 10.0 ** rng.uniform(-0.4, 0.3) * ringing / ringing.std()
    return x, rate, bearing, shaft_hz


def share(number: int, *, damaged: bool) -> float | None:
    """Return the share of a record's power in the low lines; None if another rule decides."""
    x, rate, bearing, shaft_hz = record(number, damaged=damaged)
    analysis = Excerpt.of(x, shaft_hz, rate, bearing, DiagnosisSettings()).analyse()
    window = analysis.window
    if window is None or analysis.alone.rule not in ('low_lines', 'faint_comb', 'no_comb'):
        return None
    hertz = window.speed.shaft_hz
    outer_hz = fault_orders(bearing).bpfo * hertz
    return low_lines(window.amplitude, window.bin_hz, outer_hz, hertz)


def main(argv: Sequence[str] | None = None) -> None:
    """Print the table."""
    args = arguments(__name__, records=300, first=0).parse_args(argv)
    numbers = range(args.first, args.first + args.records)
    rows = []
    for damaged in (False, True):
        found = [share(number, damaged=damaged) for number in numbers]
        healthy = np.array([value for value in found if value is not None])
        counts = (int((healthy >= least).sum()) for least in SHARES)
        rows.append(('damaged' if damaged else 'sound', args.records, len(healthy), *counts))
    print_table(('bearings', 'records', 'else healthy', *(f'{s:.2f}' for s in SHARES)), rows)


if __name__ == '__main__':
    main()
