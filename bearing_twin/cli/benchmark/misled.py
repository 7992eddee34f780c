# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin benchmark --misled``: labelled records with wrong bearings and wrong speeds."""

from __future__ import annotations

from collections import Counter
from itertools import islice
from typing import TYPE_CHECKING
import zlib

from bearing_twin.bearing import catalogue, PLACES
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.studies.impact_machines import is_another
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from bearing_twin.bearing import Bearing
    from bearing_twin.recording.signals.signalfile import Signal


COUNT = 12
"""Number of other bearings that are tried on a record."""


OFF = (-0.05, -0.03, 0.03, 0.05)
"""Relative errors of the given speed, without a stated tolerance."""

SECONDS = 10.0
"""Longest part of a record that is judged, s."""

ANSWERS = ('the damaged place', 'another place', 'suspect', 'ambiguous', 'insufficient', 'healthy')

Judged = tuple[str, bool, str, bool]
"""Trial, whether the machine is damaged, the answer, and whether it is an alarm."""


def others(record: str, bearing: Bearing) -> Iterator[Bearing]:
    """Yield catalogue bearings other than the machine's; a record always has the same ones."""
    known = list(catalogue().values())
    order = np.random.default_rng(zlib.crc32(record.encode())).permutation(len(known))
    yield from islice((known[i] for i in order if is_another(known[i], bearing)), COUNT)


def judge_misled(
    record: str, label: str, bearing: Bearing, signal: Signal, shaft_hz: float
) -> list[Judged]:
    """Return the verdicts on a record with other bearings, and with its own at other speeds."""
    x = signal.x[: int(SECONDS * signal.sample_rate)]
    trials = [('wrong bearing', other, shaft_hz) for other in others(record, bearing)]
    trials += [('speed 3 and 5 % off', bearing, shaft_hz * (1.0 + off)) for off in OFF]
    judged = []
    for trial, given, hertz in trials:
        said = diagnose_record(x, signal.sample_rate, given, hertz)
        answer = said.result
        if answer in PLACES:
            answer = ANSWERS[0] if said.faults == (label,) else ANSWERS[1]
        judged.append((trial, label in PLACES, answer, said.level == 'fault'))
    return judged


def misled_rows(judged: Iterable[Judged]) -> list[tuple[object, ...]]:
    """Return the rows of the table: trial, machine, verdicts, each answer as a share, alarms."""
    told: dict[tuple[str, bool], Counter[str]] = {}
    for trial, damaged, answer, alarm in judged:
        count = told.setdefault((trial, damaged), Counter())
        count[answer] += 1
        count['alarm'] += alarm
    rows: list[tuple[object, ...]] = []
    for (trial, damaged), count in sorted(told.items(), reverse=True):
        total = sum(count[answer] for answer in ANSWERS)
        shares = (f'{count[a]} ({100.0 * count[a] / total:.1f} %)' for a in ANSWERS)
        rows.append((trial, 'damaged' if damaged else 'sound', total, *shares, count['alarm']))
    return rows
