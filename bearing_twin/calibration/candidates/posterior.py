# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Posterior of the unknown quantities of a machine, by approximate Bayesian computation.

Candidates are drawn from the prior and simulated; those nearest in their summaries are kept. A
second round is drawn from the prior truncated to the kept widths, so that no candidate needs an
importance weight (Deistler, Goncalves, Macke, NeurIPS 2022: truncated proposals). Local linear
regression moves the kept candidates of both rounds to the measured summaries (Beaumont, Zhang,
Balding, Genetics 2002, 162, 2025).

Libraries for this (pyabc, sbi, elfi) require SQLAlchemy, distributed, torch or TensorFlow on the
machine beside the bearing and start processes of their own. Two rounds take fifty lines here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
import math
from typing import TYPE_CHECKING

from bearing_twin.calibration.candidates.cloud import simulate, unknowns
from bearing_twin.dynamics.parameters import widest
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.calibration.candidates.cloud import Situation, Unknown
    from bearing_twin.calibration.measured.summaries import Summary


FloatArray = npt.NDArray[np.float64]

WIDTH = 'defect_width_mm'
KEPT = 0.12
"""Share of the candidates of a round that is kept."""
PRIOR_DRAWS = 64
"""Candidates drawn from the prior if the vibration tells nothing."""
LIKE = 0.4
"""Share of the possible candidates that :func:`limit` keeps."""
SPREAD = 1.05
"""Factor by which kept candidates are spread about their median: regression on some fifty
candidates narrows them too much. Set on 548 simulated twins (docs/calibration.md), on no rig."""
_SPACING_SHARE = 0.025
_SCALES = np.array([1.0, 2.8, 1.6, 1.2, 1.2])
"""Unit of each feature: spacing (over `_SPACING_SHARE` of the widest defect), logarithms of
prominence and lobe, impulsiveness, rival. All but the spacing have little weight, because the twin
predicts them poorly. With a quarter of these scales the widths of 548 twins are no more exact
(4 %), and of 197 trains of impacts, which share nothing with the twin, 0.84 of the 90 % intervals
hold instead of 0.92."""
_RIDGE = 0.2
"""Ridge of the regression. A unit of the spacing is 1/40 of the range and moves the log odds of a
width by 0.1 in mid-range; no other feature is assumed to move them more. About 75 candidates
count, whose log odds scatter by 0.2. The most probable slopes then have a ridge of
0.2 / (0.1 sqrt(75)) = 0.23. A ridge of 0.05, which assumes four times the slopes, fits chance."""
_UNLIKE = 10.0
"""Distance between a passage that shows two impacts and one that does not."""


@dataclass(frozen=True, kw_only=True)
class Posterior:
    """Candidates that were kept, with their weights."""

    values: dict[str, FloatArray]
    """Values of each unknown, one per candidate, shape (kept,)."""
    weights: FloatArray
    """Weights of the candidates, sum 1, shape (kept,)."""
    prior: dict[str, Unknown]
    distance: float
    """Distance of the farthest kept candidate from the measurement."""
    typical: float
    """Median of this distance if candidates take the place of the measurement."""

    def quantiles(self, name: str, at: tuple[float, ...] = (0.05, 0.5, 0.95)) -> FloatArray:
        """Quantiles of a quantity, shape of ``at``."""
        return weighted_quantile(self.values[name], self.weights, at)

    def mixed_with(self, other: Posterior) -> Posterior:
        """Return the mixture of this posterior and another with equal weights."""
        return replace(
            self,
            values={n: np.concatenate([v, other.values[n]]) for n, v in self.values.items()},
            weights=0.5 * np.concatenate([self.weights, other.weights]),
        )

    @property
    def narrowed(self) -> float:
        """90 % interval of the width over that of the prior, on the prior's scale."""
        low, high = self.prior[WIDTH].share(self.quantiles(WIDTH, (0.05, 0.95)))
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
    Return the features that are compared, in units of `_SCALES`, shape (n, 5); NaN: no spacing.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> machine = example()
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> features([summarise(noise, 12800.0, machine.longest_spacing)], machine).shape
    (1, 5)

    """
    unit = _SPACING_SHARE * widest(situation.bearing) / situation.speed
    rows = [
        (
            s.spacing / unit,
            math.log(s.prominence) if s.shows_two_impacts else math.nan,
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
    Draw from the posterior of the unknown quantities of a machine with a defect.

    Each of two rounds simulates ``candidates`` machines.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> machine = example()
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> left = sample(summarise(noise, 12800.0, machine.longest_spacing), machine, candidates=32)
    >>> sorted(left.prior)[:3]
    ['clearance_um', 'contact_damping', 'defect_angle']

    """
    prior = unknowns(situation)
    goal = features([measured], situation)[0]
    drawn, summaries = _round(situation, prior, candidates, seed)
    rows = features(summaries, situation)
    width = drawn[WIDTH]
    nearest = np.argsort(distances(rows, goal))[: max(20, int(KEPT * candidates))]
    # With few kept candidates the span is about a tenth too short.
    low, high = width[nearest].min(), width[nearest].max()
    margin = 0.1 * (high - low) + 0.1
    low, high = max(prior[WIDTH].low, low - margin), min(prior[WIDTH].high, high + margin)
    inside = (width >= low) & (width <= high)
    truncated = prior | {WIDTH: replace(prior[WIDTH], low=low, high=high)}
    more, summaries = _round(situation, truncated, candidates, seed + 1)
    rows = np.concatenate([rows[inside], features(summaries, situation)])
    values = {name: np.concatenate([drawn[name][inside], more[name]]) for name in prior}
    return nearest_candidates(values, rows, goal, prior)


def without_spacing(
    measured: Summary, situation: Situation, *, candidates: int = 384, seed: int = 0
) -> Posterior:
    """
    Draw from the posterior if no spacing can be determined.

    The spacing is then at most `Summary.longest_unresolved_spacing`.

    Parameters as for :func:`sample`.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> machine = example()
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> measured = summarise(noise, 12800.0, machine.longest_spacing)
    >>> left = without_spacing(measured, machine, candidates=32)
    >>> bool(left.quantiles('defect_width_mm', (0.95,))[0] > 1.0)
    True

    """
    prior = unknowns(situation)
    drawn, summaries = _round(situation, prior, candidates, seed)
    longest = measured.longest_unresolved_spacing
    kept = np.array([not s.shows_two_impacts or s.spacing <= longest for s in summaries])
    if not kept.any():
        kept[:] = True
    # Weight them by how well the sharpness and impulsiveness of their impacts match.
    difference = (
        features(summaries, situation)[kept, 2:4] - features([measured], situation)[0, 2:4]
    )
    distance = np.sqrt((difference**2).sum(axis=1))
    reach = 1.0001 * max(float(np.quantile(distance, LIKE)), 1e-9)
    weights = np.maximum(1.0 - (distance / reach) ** 2, 0.0)
    if measured.shows_two_impacts:
        # The peak is either a spacing, or ringing and no spacing is seen: both are equally likely.
        spaced = np.array([s.shows_two_impacts for s in summaries])[kept]
        for group in (spaced, ~spaced):
            if weights[group].any():
                weights[group] /= weights[group].sum()
    near = weights > 0.0
    values = {name: v[kept][near] for name, v in drawn.items()}
    weights = weights[near] / weights.sum()
    return Posterior(values=values, weights=weights, prior=prior, distance=reach, typical=reach)


def from_prior(situation: Situation, seed: int) -> Posterior:
    """
    Draw from the prior, for a vibration that tells nothing about a defect.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example()
    >>> len(from_prior(machine, 0).values['load'])
    64

    """
    prior = unknowns(situation)
    return Posterior(
        values=_drawn(prior, PRIOR_DRAWS, seed),
        weights=np.full(PRIOR_DRAWS, 1.0 / PRIOR_DRAWS),
        prior=prior,
        distance=math.nan,
        typical=math.nan,
    )


def _round(
    situation: Situation, prior: dict[str, Unknown], candidates: int, seed: int
) -> tuple[dict[str, FloatArray], list[Summary]]:
    """Draw candidates and simulate them."""
    drawn = _drawn(prior, candidates, seed)
    return drawn, simulate(situation, drawn, seed)


def _drawn(prior: dict[str, Unknown], candidates: int, seed: int) -> dict[str, FloatArray]:
    shares = np.random.default_rng([seed, 0]).random((candidates, len(prior)))
    return {name: about.place(shares[:, i]) for i, (name, about) in enumerate(prior.items())}


def nearest_candidates(
    values: dict[str, FloatArray], rows: FloatArray, goal: FloatArray, prior: dict[str, Unknown]
) -> Posterior:
    """
    Keep the candidates that are nearest to a measurement, moved to it by regression.

    Parameters
    ----------
    values
        Values of each unknown, one per candidate, shape (n,).
    rows, goal
        `features` of the candidates and of the measurement, shapes (n, 5) and (5,).
    prior
        Ranges of the unknowns.

    Examples
    --------
    A width proportional to the spacing, which has random errors:

    >>> from bearing_twin.calibration.candidates.cloud import Unknown
    >>> rng = np.random.default_rng(1)
    >>> width = rng.uniform(0.0, 4.0, 500)
    >>> rows = np.zeros((500, 5))
    >>> rows[:, 0] = 10.0 * width + rng.standard_normal(500)
    >>> goal = np.array([20.0, 0.0, 0.0, 0.0, 0.0])
    >>> left = nearest_candidates({'w': width}, rows, goal, {'w': Unknown(0.0, 4.0, 'mm')})
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
    """Remove from ``y`` its linear dependence on the difference from the measured features."""
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
