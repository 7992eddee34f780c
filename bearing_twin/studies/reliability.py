# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
How often the answers of the diagnosis are right: basis of its confidence.

``python -m bearing_twin.studies.reliability ANSWERS.jsonl [TWINS IMPACTS] [--fresh TWINS IMPACTS]
[--weights JSON | --shipped] [--picture PNG]`` diagnoses random machines of both models of
:mod:`bearing_twin.studies.generalisation`, as many sound as damaged ones. Every fourth machine
with impacts is diagnosed again with another bearing or a speed 3 to 5 % off. A fifth of the
damaged bearings are worn; all twins and half of the other machines have surface waviness. Each
answer is added to ANSWERS.jsonl, and the next run continues there: delete the file after a change
of the rules. The study fits the weights that the diagnosis reads as
``bearing_twin/diagnosis/rules/reliability.json`` (one logistic regression for each kind of
answer). Fresh machines, which no weight has seen, show how far the confidence holds: it prints
this, and draws it. With ``--shipped`` it fits no weights and checks those in use. No real record
is used. A twin takes 0.35 s of one processor, a machine with impacts 0.08 s: the default takes
some forty minutes of one processor.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
import itertools
import json
import os
from pathlib import Path
from typing import Any, NamedTuple, TYPE_CHECKING, TypeAlias

from bearing_twin.diagnosis.rules.confidence import KINDS, share_right, shipped_weights, Trust
from bearing_twin.diagnosis.rules.table import RULES
from bearing_twin.errors import BearingTwinError
from bearing_twin.studies import impact_machines, twin_machines
from bearing_twin.studies.generalisation import judge_case
from bearing_twin.studies.output import arguments, print_table, read_lines, write_table
import numpy as np
from numpy.typing import NDArray
from scipy import optimize

if TYPE_CHECKING:
    from bearing_twin.diagnosis import Diagnosis
    from bearing_twin.studies.generalisation import Machine


FEWEST = 25
"""Fewest answers of a kind to which weights are fitted."""

FIRST, FRESH = 1_600_000, 6_400_000
"""Number of the first machine of the fit, and of the first machine of the check."""

STRIKING = ('impacts', 'impulses', 'pulses')
"""Machines that cause impacts or shocks outside the bearing."""

UNRATED = ('record_gate', 'two_faint_places')
"""Rules whose answers are left out, because their confidence is not that of their kind."""

BINS = 10
"""Equal ranges of confidence in which answers are counted together."""

TERMS = tuple(name for name in Trust().terms() if name not in ('sound', ''))

GROWS = {
    'significance': 1,
    'effect': 1,
    'slip': -1,
    'elsewhere': -1,
    'elsewhere_effect': 0,
    'impacts': 0,
    'others': -1,
    'unsteady': -1,
    'sound': 1,
}
"""Sign of each weight: the share of right answers grows (1) or falls (-1) with the term. It is
fixed, so that a few answers cannot reverse it; 0: not fixed."""

_SHRINK = 1.0
"""Penalty on the squares of the weights, in answers. Few answers are mostly chance, so that the
confidence of their kind stays near their share."""


_AGAIN = 500
"""Draws of the bootstrap."""

Task: TypeAlias = tuple[str, int, bool]
"""Model, number, and whether the diagnosis is misled."""


class RatedAnswer(NamedTuple):
    """One answer of the diagnosis, and whether it is right."""

    kind: str
    trust: Trust
    right: bool


def rate_answer(case: Machine, said: Diagnosis) -> RatedAnswer | None:
    """Return an answer with its kind, and whether it is right; None if not rated."""
    # An answer from the level alone has a result and no kind.
    if said.rule in UNRATED or not (said.kind or said.result == 'insufficient'):
        return None
    sound = case.condition == 'none'
    # Bearings that only low confidence or a short record keeps from *healthy* count as healthy.
    kind = said.kind or 'healthy'
    if kind == 'healthy':
        right = sound
    elif kind == 'elsewhere':
        right = not sound or case.machine in STRIKING
    elif kind == 'suspect':
        # Neither an alarm nor a sure place: right if anything is wrong with the bearing.
        right = not sound
    elif kind == 'fault':
        right = said.faults == (case.condition,)
    else:
        right = case.condition in said.faults
    return RatedAnswer(kind, said.trust, right)


def _matrix(told: Sequence[RatedAnswer], names: Sequence[str]) -> NDArray[np.float64]:
    rows = (t.trust.terms() for t in told)
    return np.array([[row.get(name, 0.0) for name in names] for row in rows])


def fit(told: Sequence[RatedAnswer]) -> dict[str, dict[str, float]]:
    """Return the weights of the terms for each kind of answer, by logistic regression."""
    weights = {}
    for kind in KINDS:
        rows = [t for t in told if t.kind == kind]
        if len(rows) < FEWEST:
            msg = f'{len(rows)} answers {kind!r} are fewer than {FEWEST}; draw more machines'
            raise BearingTwinError(msg)
        # Rules call a bearing healthy by its odds: its confidence is how far these hold.
        rules = sorted({t.trust.rule for t in rows} - {''})
        names = ('constant', 'sound') if kind == 'healthy' else (*TERMS, *rules)
        weights[kind] = _logistic(rows, names, {})
    return weights


def fit_rules(
    told: Sequence[RatedAnswer], rules: Sequence[str], weights: dict[str, dict[str, float]]
) -> dict[str, dict[str, float]]:
    """Fit the weights of some rules and keep all others."""
    found = {kind: dict(known) for kind, known in weights.items()}
    for kind, known in found.items():
        for rule in rules:
            rows = [t for t in told if (t.kind, t.trust.rule) == (kind, rule)]
            if rows:
                held = {name: weight for name, weight in known.items() if name != rule}
                known.update(_logistic(rows, (rule,), held))
    return found


def _logistic(
    rows: Sequence[RatedAnswer], names: Sequence[str], held: dict[str, float]
) -> dict[str, float]:
    """Return the weights of terms, beside other weights that are held."""
    terms = _matrix(rows, names)
    offset = _matrix(rows, tuple(held)) @ np.array(list(held.values()))
    # Add one right and one wrong answer, so that no kind is certain.
    terms = np.vstack((terms, terms.mean(axis=0), terms.mean(axis=0)))
    offset = np.append(offset, (offset.mean(), offset.mean()))
    right = np.append([t.right for t in rows], (True, False))
    shrunk = np.array([name != 'constant' for name in names])

    def loss(values: NDArray[np.float64]) -> float:
        total = offset + terms @ values
        unlikely = np.logaddexp(0.0, np.where(right, -total, total))
        return float(unlikely.mean() + _SHRINK / len(rows) * (values[shrunk] ** 2).sum())

    ends = {-1: (None, 0.0), 0: (None, None), 1: (0.0, None)}
    bounds = [ends[GROWS.get(name, 0)] for name in names]
    found = optimize.minimize(loss, np.zeros(len(names)), bounds=bounds).x
    return {name: round(float(value), 4) for name, value in zip(names, found, strict=True)}


def _read(
    weights: dict[str, dict[str, float]], told: Sequence[RatedAnswer]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the confidence of each answer, and 1 if it is right, else 0."""
    said = [share_right(weights[t.kind], t.trust) for t in told]
    return np.array(said), np.array([t.right for t in told], dtype=float)


def _counts(said: NDArray[np.float64], right: NDArray[np.float64]) -> NDArray[np.float64]:
    """
    Return answers in each range of confidence, mean confidence and share right, shape (3, BINS).

    Without answers in a range, both are zero.
    """
    at = np.minimum((said * BINS).astype(int), BINS - 1)
    count = np.bincount(at, minlength=BINS)
    sums = [np.bincount(at, values, BINS) for values in (said, right)]
    return np.array([count, *(total / np.maximum(count, 1) for total in sums)])


def calibration_error(said: NDArray[np.float64], right: NDArray[np.float64]) -> float:
    """
    Return the expected calibration error: mean distance of confidence and share right.

    Few answers raise it, as the share right of each range is then uncertain: see
    :func:`square_error`.

    ``said`` are the confidences of answers, 0 to 1, and ``right`` is 1 where one is right, else 0.

    >>> one = np.ones(4)
    >>> round(calibration_error(0.9 * one, one), 3)
    0.1
    """
    count, mean, share = _counts(said, right)
    return float(np.average(np.abs(mean - share), weights=count))


def square_error(said: NDArray[np.float64], right: NDArray[np.float64]) -> float:
    """
    Return the mean square distance of confidence and share right, without the part from chance.

    The variance of each range's mean is subtracted from its squared distance. The expected value
    is then the same for few and for many answers, and zero for a confidence that holds. Its root
    is at least the expected calibration error. Arguments as in :func:`calibration_error`.

    >>> rng = np.random.default_rng(0)
    >>> said = rng.uniform(0.5, 1.0, 2000)
    >>> right = (rng.random(2000) < said).astype(float)
    >>> round(calibration_error(said, right), 3), round(square_error(said, right), 4)
    (0.013, -0.0002)

    """
    count, mean, share = _counts(said, right)
    off = said - right
    squares = _counts(said, off * off)[2]
    spread = np.maximum(squares - (mean - share) ** 2, 0.0) / np.maximum(count - 1.0, 1.0)
    # The variance of a single answer is not known.
    several = np.where(count > 1.0, count, 0.0)
    return float((several * ((mean - share) ** 2 - spread)).sum() / len(said))


def _one(task: Task) -> RatedAnswer | None:
    model, number, misled = task
    case, said = judge_case(model, number, misled=misled)
    return rate_answer(case, said)


def tasks(twins: int, impacts: int, first: int) -> list[Task]:
    """Return machines of both models; every fourth pair with impacts is also misled."""
    rigs = _numbers(impacts, first, impact_machines.draw)
    return [
        *(('twin', number, False) for number in _numbers(twins, first, twin_machines.draw)),
        *(('impacts', number, False) for number in rigs),
        *(('impacts', number, True) for at, number in enumerate(rigs) if at % 8 < 2),
    ]


def _numbers(count: int, first: int, draw: Callable[[int], Machine]) -> list[int]:
    """Return numbers of machines from ``first`` on, sound and damaged ones in turn."""

    def of(*, sound: bool) -> Iterator[int]:
        return (n for n in itertools.count(first) if (draw(n).condition == 'none') == sound)

    pairs = itertools.chain.from_iterable(zip(of(sound=True), of(sound=False), strict=True))
    return list(itertools.islice(pairs, count))


def _answers(path: Path, wanted: Sequence[Task], jobs: int) -> list[RatedAnswer]:
    """Return the answers on machines; those that are not in the file yet are added to it."""
    known = {tuple(task): told for task, told in read_lines(path)}
    left = [task for task in wanted if task not in known]
    with ProcessPoolExecutor(jobs) as pool, path.open('a', encoding='utf-8') as out:
        for task, told in zip(left, pool.map(_one, left, chunksize=8), strict=True):
            known[task] = told and [told.kind, asdict(told.trust), told.right]
            print(json.dumps([task, known[task]], default=float), file=out, flush=True)
    found = filter(None, map(known.__getitem__, wanted))
    return [RatedAnswer(kind, Trust(**trust), right) for kind, trust, right in found]


def _errors(said: NDArray[np.float64], right: NDArray[np.float64]) -> tuple[str, str, str]:
    """
    Return the calibration error, that of a confidence that holds, and the error without chance.

    For the second, answers are drawn that are right as often as their confidence. The third is the
    root of `square_error`, with its 90 % interval (bootstrap of the machines).
    """
    rng = np.random.default_rng(0)
    chance = [
        calibration_error(said, (rng.random(len(said)) < said).astype(float))
        for _ in range(_AGAIN)
    ]
    picks = rng.integers(0, len(said), (_AGAIN, len(said)))
    again = np.array([square_error(said[pick], right[pick]) for pick in picks])
    found = square_error(said, right)
    # The mean of the bootstrap is biased by the chance of the sample itself.
    ends = found - np.quantile(again - again.mean(), (0.95, 0.05))
    root, low, high = np.sqrt(np.maximum((found, *ends), 0.0))
    return (
        f'{calibration_error(said, right):.3f}',
        f'{np.mean(chance):.3f}',
        f'{root:.3f} ({low:.3f} to {high:.3f})',
    )


def _draw(path: Path, weights: dict[str, dict[str, float]], told: Sequence[RatedAnswer]) -> None:
    """Draw the share of right answers over the confidence, one panel for each kind of answer."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 2.6), layout='constrained')
    axes: Any = figure.subplots(1, len(KINDS), sharey=True)
    for axis, kind in zip(axes, KINDS, strict=True):
        said, right = _read(weights, [t for t in told if t.kind == kind])
        count, mean, share = _counts(said, right)
        axis.plot((0.0, 1.0), (0.0, 1.0), color='0.7', linewidth=1.0)
        shown = count > 0.0
        axis.scatter(mean[shown], share[shown], s=8.0 + 0.4 * count[shown], color='tab:blue')
        error = calibration_error(said, right)
        axis.set_title(f'{kind}: {len(said)}, error {error:.3f}', fontsize=9)
        axis.set_xlabel('confidence')
        axis.set_xlim(-0.05, 1.05)
        axis.set_ylim(-0.05, 1.05)
    axes[0].set_ylabel('share right')
    figure.savefig(path, dpi=80, metadata={'Software': None})


def _parser() -> argparse.ArgumentParser:
    """Return the parser of the arguments."""
    parser = arguments(__name__, writes=True, twins=400, impacts=3000)
    parser.add_argument('--fresh', type=int, nargs=2, default=(400, 8000))
    parser.add_argument(
        '--rules',
        nargs='+',
        choices=[rule.name for rule in RULES],
        help='rules whose weights alone are fitted; all others stay as they are',
    )
    which = parser.add_mutually_exclusive_group()
    which.add_argument('--weights', type=Path, help='JSON file to write: the weights')
    which.add_argument(
        '--shipped', action='store_true', help='check the weights in use, without fitting any'
    )
    parser.add_argument('--picture', type=Path, help='PNG file to write: the reliability diagram')
    parser.add_argument('--jobs', type=int, default=len(os.sched_getaffinity(0)))
    return parser


def _fitted(args: argparse.Namespace) -> dict[str, dict[str, float]]:
    """Return the weights in use, with those that the arguments ask for fitted anew."""
    if args.shipped:
        return shipped_weights()
    told = _answers(args.output, tasks(args.twins, args.impacts, FIRST), args.jobs)
    if args.rules:
        return fit_rules(told, args.rules, shipped_weights())
    return fit(told)


def _check(
    weights: dict[str, dict[str, float]], fresh: Sequence[RatedAnswer]
) -> Iterator[Sequence[object]]:
    """Yield how far the confidence of fresh answers holds, by kind."""
    groups = {kind: [t for t in fresh if t.kind == kind] for kind in KINDS}
    # Answers with a lower cap than their rule.
    caps = {rule.name: rule.at_most for rule in RULES}
    groups['unlikely slip'] = [t for t in fresh if t.trust.at_most < caps[t.trust.rule]]
    for kind, told in (groups | {'all': fresh}).items():
        said, right = _read(weights, told)
        if told:
            means = (f'{values.mean():.2f}' for values in (said, right))
            yield kind, len(told), *means, *_errors(said, right)


def main(argv: Sequence[str] | None = None) -> None:
    """Write the data files and print the check."""
    parser = _parser()
    args = parser.parse_args(argv)
    if args.shipped and args.rules:
        parser.error('--shipped fits no weights: leave out --rules')
    weights = _fitted(args)
    if args.weights:
        about = 'written by python -m bearing_twin.studies.reliability'
        write_table(args.weights, {'about': about, 'weights': weights})
    fresh = _answers(args.output, tasks(args.fresh[0], args.fresh[1], FRESH), args.jobs)
    heading = ('answer', 'answers', 'mean', 'right', 'error', 'by chance', 'without chance')
    print_table(heading, _check(weights, fresh))
    if args.picture:
        _draw(args.picture, weights, fresh)


if __name__ == '__main__':
    main()
