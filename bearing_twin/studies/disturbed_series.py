# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
False alarms of series with disturbed snapshots: the basis of ``series/newest``.

``python -m bearing_twin.studies.disturbed_series [LIVES]`` simulates LIVES (1000) sound machines
of 1000 snapshots after their baseline. A share of the snapshots, at random, has shocks or spikes
above the limit. It prints in how many lives the newest snapshots reach the limit: if a fixed
number of them must, and if the earlier ones of the machine say how many are judged. Then the same
for 300 snapshots of machines whose disturbances begin after 500 snapshots without any.
"""

from __future__ import annotations

from collections.abc import Sequence

from bearing_twin.diagnosis.series.newest import EARLIER, FEWEST, judged, LATELY, OFTEN
from bearing_twin.studies.output import arguments, print_table
import numpy as np
from numpy.typing import NDArray

SHARES = (0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.5)
FIXED = (3, 5)
"""Snapshots that must reach the limit in a fixed rule, and of how many."""
_JUDGED = np.array([judged(reached) for reached in range(EARLIER + 1)])


def alarmed(disturbed: NDArray[np.bool_], rule: tuple[int, int] | None = None) -> float:
    """
    Return the share of lives with an alarm.

    ``disturbed`` says which snapshots reach the limit, shape (lives, snapshots); the first ones
    are the baseline. Without a fixed ``rule`` it is that of :mod:`series.newest`.

    >>> alarmed(np.arange(200)[None] % 4 == 0, (3, 5)), alarmed(np.arange(200)[None] % 2 < 1)
    (0.0, 0.0)
    >>> alarmed(np.arange(200)[None] >= 190), alarmed(np.arange(200)[None] % 5 < 3)
    (1.0, 1.0)

    """
    sums = np.cumsum(np.pad(disturbed, ((0, 0), (1, 0))), axis=1)
    lives, found = np.arange(len(sums)), np.zeros(len(sums), dtype=bool)
    for end in range(EARLIER + FEWEST, sums.shape[1]):
        if rule:
            reached = sums[:, end] - sums[:, end - rule[1]] >= rule[0]
        else:
            before = end - FEWEST + 1
            counts = _JUDGED[sums[:, before] - sums[:, before - EARLIER]]
            reached = sums[:, end] - sums[lives, end - counts] >= counts - 1
            often = sums[:, end] - sums[:, end - EARLIER] >= OFTEN
            reached |= often & (sums[:, end] - sums[:, end - FEWEST] >= LATELY)
        found |= reached
    return float(found.mean())


def main(argv: Sequence[str] | None = None) -> None:
    """Print both tables."""
    lives = arguments(__name__, lives=1000).parse_args(argv).lives
    rng = np.random.default_rng(0)
    rules = (FIXED, None)
    heading = ('disturbed snapshots', '{} of {}'.format(*FIXED), 'that of series/newest')
    for clean, snapshots in ((0, 1000 + EARLIER), (500, 300)):
        rows = []
        for share in SHARES:
            disturbed = rng.random((lives, clean + snapshots)) < share
            disturbed[:, :clean] = False
            rows.append((f'{share:.0%}', *(f'{alarmed(disturbed, rule):.1%}' for rule in rules)))
        print_table(heading, rows)
        print()


if __name__ == '__main__':
    main()
