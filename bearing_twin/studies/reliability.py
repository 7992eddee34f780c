# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
How often the answers of the diagnosis are right, by their score: what its confidence rests on.

``python -m bearing_twin.studies.reliability OUT.json [TWINS IMPACTS [FIRST]]`` diagnoses machines
drawn at random, from number FIRST (300000) on, with both models of
:mod:`bearing_twin.studies.generalisation`, writes what the diagnosis reads as
``bearing_twin/diagnosis/reliability.json`` from those of even number, and prints how far the
confidence so gained holds on those of odd number. No real record takes part.
"""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from itertools import pairwise
import os
import sys
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.confidence import KINDS
from bearing_twin.diagnosis.thresholds import INDEX_NOISE
from bearing_twin.errors import BearingTwinError
from bearing_twin.studies.generalisation import judge_case
from bearing_twin.studies.output import arguments, print_table, write_table
import numpy as np
from scipy import optimize

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from bearing_twin.diagnosis import Diagnosis
    from bearing_twin.studies.generalisation import Machine

__all__ = ['main', 'tell']

GROWS = {'fault': True, 'suspect': True, 'ambiguous': True, 'healthy': False}
"""Whether the share of right answers grows with the score; healthy with a high one is doubtful."""

GROUP = 25
"""Least answers of about one score that are counted together."""

HEALTHY_SHARE = 0.2
"""Of the machines drawn; they are weighted to be as many as the damaged ones."""

BINS = (0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 1.01)


def tell(case: Machine, said: Diagnosis) -> tuple[str, float, bool, float]:
    """Kind of answer, its score, whether it is right, and its weight."""
    healthy = case.condition == 'none'
    weight = (1.0 - HEALTHY_SHARE) / HEALTHY_SHARE if healthy else 1.0
    kind = said.result if said.result in KINDS else 'fault'
    if kind == 'healthy' or said.rule == 'uncertain_health' or not said.faults:
        score = max(
            (z for place, z in said.score.items() if said.modulation_index[place] >= INDEX_NOISE),
            default=0.0,
        )
        # What is not called healthy for its score counts: the table says from which score on.
        quiet = kind in ('healthy', 'fault')
        return 'healthy' if quiet else kind, score, healthy == quiet, weight
    score = max(said.score[place] for place in said.faults)
    if kind == 'fault':
        return kind, score, said.faults == (case.condition,), weight
    return kind, score, case.condition in said.faults, weight


def _count(told: list[tuple[str, float, bool, float]]) -> dict[str, dict[str, list[float]]]:
    """
    Per kind, for groups of about one score, their mean score and the share of right answers.

    The share is made to grow, or to fall, with the score (isotonic regression): what few answers
    say against it is chance.
    """
    table: dict[str, dict[str, list[float]]] = {}
    for kind, grows in GROWS.items():
        rows = np.array(sorted(t[1:] for t in told if t[0] == kind)).reshape(-1, 3)
        if len(rows) < GROUP:
            msg = f'{len(rows)} answers {kind!r} are fewer than {GROUP}; draw more machines'
            raise BearingTwinError(msg)
        groups = np.array_split(rows, len(rows) // GROUP)
        weights = np.array([group[:, 2].sum() for group in groups])
        right = np.array([(group[:, 1] * group[:, 2]).sum() for group in groups])
        pooled = optimize.isotonic_regression(right / weights, weights=weights, increasing=grows)
        alike = np.repeat(pooled.weights, np.diff(pooled.blocks))
        # The rule of succession: no count makes certain.
        share = optimize.isotonic_regression(
            (pooled.x * alike + 1.0) / (alike + 2.0), weights=weights, increasing=grows
        ).x
        table[kind] = {
            'score': [round(float(group[:, 0].mean()), 2) for group in groups],
            'right': [round(float(value), 3) for value in share],
        }
    return table


def _one(task: tuple[str, int]) -> tuple[int, tuple[str, float, bool, float]] | None:
    model, number = task
    case, said = judge_case(model, number)
    return None if said.level == 'none' else (number, tell(case, said))


def main(argv: Sequence[str] | None = None) -> None:
    """Write the data file and print the check."""
    parser = arguments(sys.modules[__name__], writes=True)
    parser.add_argument('twins', type=int, nargs='?', default=600)
    parser.add_argument('impacts', type=int, nargs='?', default=1150)
    parser.add_argument('first', type=int, nargs='?', default=300_000)
    args = parser.parse_args(argv)
    tasks = [('twin', args.first + n) for n in range(args.twins)]
    tasks += [('impacts', args.first + n) for n in range(args.impacts)]
    with ProcessPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        found = [said for said in pool.map(_one, tasks, chunksize=8) if said is not None]
    table = _count([told for number, told in found if number % 2 == 0])
    about = 'written by python -m bearing_twin.studies.reliability'
    write_table(args.output, {'about': about, **table})
    checked = [(told, _read(table, *told[:2])) for number, told in found if number % 2]
    print_table(('answer', 'confidence', 'answers', 'mean', 'right'), _checks(checked))


def _checks(
    checked: list[tuple[tuple[str, float, bool, float], float]],
) -> Iterator[tuple[object, ...]]:
    """Yield per kind and range of confidence how often the answers were right."""
    for kind in KINDS:
        for low, high in pairwise(BINS):
            rows = [(p, t[2], t[3]) for t, p in checked if t[0] == kind and low <= p < high]
            if rows:
                said, right, weight = np.array(rows, dtype=float).T
                share = (right * weight).sum() / weight.sum()
                mean = (said * weight).sum() / weight.sum()
                among = f'{low:g} to {min(high, 1):g}'
                yield kind, among, len(rows), f'{mean:.2f}', f'{share:.2f}'


def _read(table: dict[str, dict[str, list[float]]], kind: str, score: float) -> float:
    return float(np.interp(score, table[kind]['score'], table[kind]['right']))


if __name__ == '__main__':
    main()
