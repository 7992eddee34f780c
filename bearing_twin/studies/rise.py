# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
False alarms of the detection of a rise in level, and its delay in a machine that gets louder.

``python -m bearing_twin.studies.rise [MACHINES]`` simulates a year of levels over the median of
their first hour, one per minute, as an autoregressive process. It prints how often
:class:`bearing_twin.diagnosis.machine.onset.Rise` finds a rise in them, and how long it takes to
find a real one.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from bearing_twin.diagnosis.machine.onset import DECISION_DB, REFERENCE_DB, Rise
from bearing_twin.studies.disturbances import with_memory
from bearing_twin.studies.output import arguments, print_table
import numpy as np

YEAR = 365 * 24 * 60
BASELINE = 60


def _levels(rng: np.random.Generator, count: int, wander: float, memory: float) -> np.ndarray:
    return wander * with_memory(rng.standard_normal(count + 400), memory)[400:]


def largest_sum(rng: np.random.Generator, wander: float, memory: float) -> float:
    """Return the largest sum of a healthy year, dB; from DECISION_DB on, Rise finds a rise."""
    levels = _levels(rng, YEAR + BASELINE, wander, memory)
    over = levels[BASELINE:] - np.median(levels[:BASELINE])
    # The sum of Rise, for a whole year at once: the distance to the lowest plain sum so far.
    sums = np.cumsum(over - REFERENCE_DB)
    return float((sums - np.minimum.accumulate(np.minimum(sums, 0.0))).max())


def minutes_until(rng: np.random.Generator, height: float) -> int:
    """Return the minutes until a step of ``height`` dB is found, -1 if not; scatter 0.8 dB."""
    levels = _levels(rng, BASELINE + 1440, 0.8, 10.0)
    rise = Rise()
    floor = float(np.median(levels[:BASELINE]))
    found = (rise.add(level + height - floor) for level in levels[BASELINE:].tolist())
    return next((minute for minute, alarm in enumerate(found, start=1) if alarm), -1)


def main(argv: Sequence[str] | None = None) -> None:
    """Print both tables."""
    machines = arguments(__name__, machines=100).parse_args(argv).machines
    rng = np.random.default_rng(0)
    rows = []
    for wander, memory in product((0.8, 1.2), (5.0, 10.0, 20.0)):
        sums = np.array([largest_sum(rng, wander, memory) for _ in range(machines)])
        rows.append((wander, f'{memory:g}', f'{(sums > DECISION_DB).mean():.0%}',
                     f'{np.median(sums):.0f}'))  # fmt: skip
    heading = ('wander, dB', 'memory, min', 'machines alarmed in a year', 'median sum, dB')
    print_table(heading, rows)
    print()
    steps = []
    for height in (4.0, 5.0, 6.0, 9.0):
        found = np.array([minutes_until(rng, height) for _ in range(machines)])
        steps.append((f'{height:g}', f'{(found > 0).mean():.0%}', f'{np.median(found):.0f}'))
    print_table(('rise, dB', 'found within a day', 'median minutes'), steps)


if __name__ == '__main__':
    main()
