# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Series of short snapshots of sound machines, and of machines damaged from the first one on.

``python -m bearing_twin.studies.short_snapshots [RECORDS [FIRST]]`` cuts the record of each of
RECORDS (400) machines with impacts, from number FIRST (0) on, into as many snapshots as the
averaged envelope of a series needs, of some turns each. It prints for each condition how many
averages show significant harmonics, how many are *suspect*, and how many of both name the damaged
part.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.diagnosis.series.averaging import AveragedEnvelope, Comb, LEAST_AVERAGED
from bearing_twin.studies.disturbances import CONDITIONS
from bearing_twin.studies.impact_machines import draw, record
from bearing_twin.studies.output import arguments, print_table
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence


LOWEST_RATE = 8000.0
"""Lowest sample rate of the machines, Hz: below it a series has hardly a band."""


def averaged(number: int) -> tuple[str, Comb | None, Comb | None] | None:
    """
    Return condition of a machine, the fault that its average shows, and the suspected fault.

    None if the sample rate is below :data:`LOWEST_RATE`. A number is always the same machine.
    """
    case = draw(number)
    if case.sample_rate < LOWEST_RATE:
        return None
    average = AveragedEnvelope()
    for x in np.array_split(record(case), LEAST_AVERAGED):
        average.add(x - x.mean(), case.sample_rate, case.given_hz)
    shown = average.place(case.geometry, AveragedEnvelope())
    return case.condition, shown, average.strong(case.geometry, case.given_hz)


def main(argv: Sequence[str] | None = None) -> None:
    """Print the table."""
    args = arguments(__name__, records=400, first=0).parse_args(argv)
    found = [averaged(number) for number in range(args.first, args.first + args.records)]
    rows = []
    for condition in CONDITIONS:
        own = [row for row in found if row and row[0] == condition]
        cells = []
        for combs in ([shown for _, shown, _ in own], [strong for *_, strong in own]):
            places = [comb.place for comb in combs if comb]
            cells += [len(places), places.count(condition)]
        rows.append((condition, len(own), *cells))
    heading = ('damaged', 'machines', 'significant', 'of them right', 'suspect', 'of them right')
    print_table(heading, rows)


if __name__ == '__main__':
    main()
