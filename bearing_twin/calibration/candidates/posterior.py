# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Which candidates give a vibration like the measured one: approximate Bayesian computation.

Candidates are drawn from the prior and simulated; those nearest in their summaries are kept. A
second round is drawn from the prior truncated to the widths that were kept, so that no candidate
needs a weight for how it was drawn (Deistler, Goncalves, Macke, NeurIPS 2022: truncated
proposals). What is kept of both rounds is moved to the measured summaries by local linear
regression (Beaumont, Zhang, Balding, Genetics 2002, 162, 2025).

The libraries for this (pyabc, sbi, elfi) bring SQLAlchemy, distributed, torch or TensorFlow onto
the machine beside the bearing and start processes of their own; two rounds in fifty lines do not.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
import math
from typing import TYPE_CHECKING

from bearing_twin.calibration.candidates.cloud import simulate, unknowns
from bearing_twin.calibration.candidates.passage import widest
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.calibration.candidates.cloud import Situation, Unknown
    from bearing_twin.calibration.measured.summaries import Summary


FloatArray = npt.NDArray[np.float64]

WIDTH = 'defect_width_mm'
KEPT = 0.12
"""Share of the candidates of a round that is kept."""
RESOLVED = 8.0
"""Shortest spacing that is told from the ringing or the rebound of one impact, over the half width
of an impact after whitening. Fixed on one rig only, CWRU: its faults of 0.2 to 0.5 mm leave a
second impact 5 to 6 half widths after the first, at a time that does not follow the speed."""
SUPPOSED = 64
"""Candidates where nothing is told."""
LIKE = 0.4
"""Share of the candidates without a spacing that is kept where none can be told."""
SPREAD = 1.05
"""Factor by which what is kept is spread about its median: regression on some fifty candidates
takes out too much. Fixed on 548 simulated twins (docs/calibration.md), on no real rig."""
_SPACING_SHARE = 0.025
_SCALES = np.array([1.0, 2.8, 1.6, 1.2, 1.2])
"""Differences that count alike: spacing (over `_SPACING_SHARE` of the widest defect), logarithms
of prominence and lobe, impulsiveness, rival. All but the spacing count little, because a twin gets
them wrong about a machine. With a quarter of these scales they make the widths of 548 twins no
more exact (4 %), and of 197 trains of impacts, which share nothing with the twin, 0.84 of the
intervals of 90 % hold instead of 0.92."""
_RIDGE = 0.2
"""Ridge of the regression. A unit of the spacing is 1/40 of the range, which moves the log odds of
a width by 0.1 in its middle; no other figure is supposed to move them more. About 75 candidates
count, whose odds scatter by 0.2, so that the most probable slopes have a ridge of
0.2 / (0.1 sqrt(75)) = 0.23. One of 0.05, which supposes four times the slopes, followed chance."""
_UNLIKE = 10.0
"""Distance between a passage that shows two impacts and one that does not."""


@dataclass(frozen=True, kw_only=True)
class Posterior:
    """Candidates that were kept, with their weights."""

    values: dict[str, FloatArray]
    """A value a candidate of each unknown, shape (kept,)."""
    weights: FloatArray
    """Sum 1, shape (kept,)."""
    prior: dict[str, Unknown]
    distance: float
    """Of the farthest candidate kept."""
    typical: float
    """Median of the same distance for candidates in the place of the measurement."""

    def quantiles(self, name: str, at: tuple[float, ...] = (0.05, 0.5, 0.95)) -> FloatArray:
        """Quantiles of a quantity, shape of ``at``."""
        return weighted_quantile(self.values[name], self.weights, at)

    def or_else(self, other: Posterior) -> Posterior:
        """Return what is left possible if either of two holds, one as likely as the other."""
        return replace(
            self,
            values={n: np.concatenate([v, other.values[n]]) for n, v in self.values.items()},
            weights=0.5 * np.concatenate([self.weights, other.weights]),
        )

    def narrowed(self, name: str) -> float:
        """Width of the 90 % interval over that of the prior, in the prior's own measure."""
        prior = self.prior[name]
        low, high = prior.share(self.quantiles(name, (0.05, 0.95)))
        return float(high - low) / 0.9


def weighted_quantile(
    values: FloatArray, weights: FloatArray, at: tuple[float, ...]
) -> FloatArray:
    """
    Quantiles of weighted values.

    Examples
    --------
    >>> weighted_quantile(np.array([3.0, 1.0, 2.0]), np.array([0.25, 0.25, 0.5]), (0.5,))
    array([2.])

    """
    order = np.argsort(values)
    cumulated = np.cumsum(weights[order]) - 0.5 * weights[order]
    return np.asarray(np.interp(np.array(at), cumulated, values[order]))


def features(summaries: list[Summary], situation: Situation) -> FloatArray:
    """
    Return what is compared, in units that count alike, shape (n, 5); NaN for no spacing.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> machine = example()
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> features([summarise(noise, 12800.0, machine.longest)], machine).shape
    (1, 5)

    """
    unit = _SPACING_SHARE * widest(situation.bearing) / situation.speed
    rows = [
        (
            s.spacing / unit,
            math.log(s.prominence) if s.seen else math.nan,
            math.log(s.lobe * situation.sample_rate),
            s.impulsiveness,
            min(s.rival, 1.0),
        )
        for s in summaries
    ]
    return np.asarray(np.array(rows) / _SCALES)


def distances(rows: FloatArray, measured: FloatArray) -> FloatArray:
    """
    Distance of each row of features from the measured ones.

    >>> distances(np.array([[0.0, 1.0], [3.0, 5.0]]), np.array([0.0, 1.0])).tolist()
    [0.0, 5.0]

    """
    difference = rows - measured
    unlike = np.isnan(rows[:, 0]) != math.isnan(measured[0])
    return np.asarray(np.sqrt((np.nan_to_num(difference) ** 2).sum(axis=1)) + _UNLIKE * unlike)


def sample(
    measured: Summary, situation: Situation, *, candidates: int = 384, seed: int = 0
) -> Posterior:
    """
    Draw from the posterior of what is not known about a machine with a defect.

    In each of two rounds ``candidates`` are simulated.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> machine = example()
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> left = sample(summarise(noise, 12800.0, machine.longest), machine, candidates=32)
    >>> sorted(left.prior)[:3]
    ['clearance_um', 'contact_damping', 'defect_angle']

    """
    prior = unknowns(situation)
    goal = features([measured], situation)[0]
    drawn, summaries = _round(situation, prior, candidates, seed)
    rows = features(summaries, situation)
    width = drawn[WIDTH]
    nearest = np.argsort(distances(rows, goal))[: max(20, int(KEPT * candidates))]
    # What was kept of few candidates ends too early by about a tenth of its span.
    low, high = width[nearest].min(), width[nearest].max()
    margin = 0.1 * (high - low) + 0.1
    low, high = max(prior[WIDTH].low, low - margin), min(prior[WIDTH].high, high + margin)
    inside = (width >= low) & (width <= high)
    truncated = prior | {WIDTH: replace(prior[WIDTH], low=low, high=high)}
    more, summaries = _round(situation, truncated, candidates, seed + 1)
    rows = np.concatenate([rows[inside], features(summaries, situation)])
    values = {name: np.concatenate([drawn[name][inside], more[name]]) for name in prior}
    return keep(values, rows, goal, prior)


def limit(
    measured: Summary, situation: Situation, *, candidates: int = 384, seed: int = 0
) -> Posterior:
    """
    Draw from what is left possible where no spacing can be told.

    The spacing is no longer than those that are seen, or than what the record resolves.

    Parameters as for :func:`sample`.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> machine = example()
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> left = limit(summarise(noise, 12800.0, machine.longest), machine, candidates=32)
    >>> bool(left.quantiles('defect_width_mm', (0.95,))[0] > 1.0)
    True

    """
    prior = unknowns(situation)
    drawn, summaries = _round(situation, prior, candidates, seed)
    longest = longest_doubtful(measured)
    kept = np.array([not s.seen or s.spacing <= longest for s in summaries])
    if not kept.any():
        kept[:] = True
    # Of these, those whose impacts are as sharp and stand out of the noise as much.
    difference = (
        features(summaries, situation)[kept, 2:4] - features([measured], situation)[0, 2:4]
    )
    distance = np.sqrt((difference**2).sum(axis=1))
    reach = 1.0001 * max(float(np.quantile(distance, LIKE)), 1e-9)
    weights = np.maximum(1.0 - (distance / reach) ** 2, 0.0)
    if measured.seen:
        # What is seen is a spacing, or it is ringing and there is none to be seen: one as likely
        # as the other.
        spaced = np.array([s.seen for s in summaries])[kept]
        for group in (spaced, ~spaced):
            if weights[group].any():
                weights[group] /= weights[group].sum()
    near = weights > 0.0
    values = {name: v[kept][near] for name, v in drawn.items()}
    weights = weights[near] / weights.sum()
    return Posterior(values=values, weights=weights, prior=prior, distance=reach, typical=reach)


def supposed(situation: Situation, seed: int) -> Posterior:
    """
    Draw from the prior: what is left possible where the vibration says nothing of a defect.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example()
    >>> len(supposed(machine, 0).values['load'])
    64

    """
    prior = unknowns(situation)
    return Posterior(
        values=_drawn(prior, SUPPOSED, seed),
        weights=np.full(SUPPOSED, 1.0 / SUPPOSED),
        prior=prior,
        distance=math.nan,
        typical=math.nan,
    )


def resolved(measured: Summary) -> float:
    """
    Shortest spacing of two impacts that is told from the ringing of one, s.

    Examples
    --------
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> resolved(summarise(noise, 12800.0, 5e-3)) < 1e-3
    True

    """
    return RESOLVED * measured.lobe


def longest_doubtful(measured: Summary) -> float:
    """
    Longest spacing that may be that of a passage where none can be told, s.

    Examples
    --------
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> measured = summarise(noise, 12800.0, 5e-3)
    >>> longest_doubtful(measured) >= resolved(measured)
    True

    """
    seen = (measured.spacing, *measured.rivals) if measured.seen else ()
    return max(resolved(measured), *seen, 0.0)


def _round(
    situation: Situation, prior: dict[str, Unknown], candidates: int, seed: int
) -> tuple[dict[str, FloatArray], list[Summary]]:
    """Draw candidates and simulate them."""
    drawn = _drawn(prior, candidates, seed)
    return drawn, simulate(situation, drawn, seed)


def _drawn(prior: dict[str, Unknown], candidates: int, seed: int) -> dict[str, FloatArray]:
    shares = np.random.default_rng([seed, 0]).random((candidates, len(prior)))
    return {name: about.place(shares[:, i]) for i, (name, about) in enumerate(prior.items())}


def keep(
    values: dict[str, FloatArray], rows: FloatArray, goal: FloatArray, prior: dict[str, Unknown]
) -> Posterior:
    """
    Keep the candidates that are nearest to a measurement, moved to it by regression.

    Parameters
    ----------
    values
        A value a candidate of each unknown, shape (n,).
    rows, goal
        `features` of the candidates and of the measurement, shapes (n, 5) and (5,).
    prior
        Ranges of the unknowns.

    Examples
    --------
    A width that is the spacing, in its own units, plus chance:

    >>> from bearing_twin.calibration.candidates.cloud import Unknown
    >>> rng = np.random.default_rng(1)
    >>> width = rng.uniform(0.0, 4.0, 500)
    >>> rows = np.zeros((500, 5))
    >>> rows[:, 0] = 10.0 * width + rng.standard_normal(500)
    >>> goal = np.array([20.0, 0.0, 0.0, 0.0, 0.0])
    >>> left = keep({'w': width}, rows, goal, {'w': Unknown(0.0, 4.0, 'mm')})
    >>> bool(abs(left.quantiles('w')[1] - 2.0) < 0.1)
    True

    """
    distance = distances(rows, goal)
    count = max(40, int(KEPT * len(rows)))
    kept = np.argsort(distance)[:count]
    reach = max(float(distance[kept[-1]]), 1e-9)
    weights = 1.0 - (distance[kept] / (1.0001 * reach)) ** 2
    weights /= weights.sum()
    alike = rows[np.isnan(rows[:, 0]) == math.isnan(goal[0])]
    step = max(1, len(alike) // 40)
    among = [np.partition(distances(rows, row), count)[count] for row in alike[::step]]
    typical = float(np.median(among)) if among else 0.0
    difference = np.nan_to_num(rows[kept] - goal)
    moved = {}
    for name, about in prior.items():
        share = np.clip(about.share(values[name][kept]), 1e-3, 1.0 - 1e-3)
        odds = np.log(share / (1.0 - share))
        odds = _regressed(odds, difference, weights)
        middle = weighted_quantile(odds, weights, (0.5,))[0]
        odds = middle + SPREAD * (odds - middle)
        moved[name] = about.place(1.0 / (1.0 + np.exp(-odds)))
    return Posterior(values=moved, weights=weights, prior=prior, distance=reach, typical=typical)


def _regressed(y: FloatArray, difference: FloatArray, weights: FloatArray) -> FloatArray:
    """Take out of ``y`` what follows the difference of the summaries from the measured ones."""
    root = np.sqrt(weights)[:, None]
    design = np.column_stack([np.ones(len(y)), difference])
    penalty = _RIDGE * np.eye(design.shape[1])
    penalty[0, 0] = 0.0
    solved = np.linalg.lstsq(
        np.concatenate([root * design, penalty]),
        np.concatenate([root[:, 0] * y, np.zeros(design.shape[1])]),
        rcond=None,
    )[0]
    return np.asarray(y - difference @ solved[1:])
