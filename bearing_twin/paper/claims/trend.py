# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Claims about the change of the acceleration amplitude with temperature."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.dynamics import preset
from bearing_twin.paper import equations, settings
from bearing_twin.paper.claims.claim import Claim, percent, percents, same_direction
from bearing_twin.paper.settings import COLD, HOT
from bearing_twin.paper.space import PATHS
from bearing_twin.paper.study import SMALL_DELTA_MU, STARTS, WINDOW_WIDTH
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.dynamics import TwinParameters
    from bearing_twin.paper.study import Study


RESOLUTION = 0.001
"""Relative error of the simulation: changes below it have no direction."""
_SECTION = {'expansion': '3.1', 'hardness': '3.2', 'friction': '3.3', 'all': '3.4'}
_FIGURES = {
    'expansion': ('figure 8', 'figures 9 and 10'),
    'hardness': ('figure 15', 'figures 16 and 17'),
    'friction': ('figure 22', 'figures 23 and 24'),
    'all': ('figure 27', 'figures 28 and 29'),
}
_WORD = {-1: 'decreases', 1: 'increases'}


def formula_change(
    factor: settings.Factor, ratio: float, delta_mu: float = settings.DELTA_MU
) -> float:
    """
    Relative change of the static force from 20 to 110 degC at ``ratio`` = C_d0/approach.

    NaN if the contact is already lost at 20 degC.
    """
    cold, hot = (equations.beta0(factor, t, delta_mu) for t in (COLD, HOT))
    before = float(equations.static_force(cold, cold, ratio))
    after = float(equations.static_force(hot, hot, ratio))
    return after / before - 1.0 if before > 0.0 else float('nan')


def falling_window() -> tuple[float, float]:
    """
    Smallest and largest C_d0/approach at which the formula gives all four stated trends.

    Contact has to be kept at every temperature.
    """
    highest = max(
        equations.beta0(factor, t)
        for factor in settings.FACTORS
        for t in settings.TEMPERATURE_NODES
    )
    ratios = np.arange(0.001, 1.0 / highest, 0.001)
    good = [
        ratio
        for ratio in ratios
        if all(
            same_direction(stated, formula_change(factor, float(ratio)), 0.0)
            for factor, stated in settings.STATED_TRENDS.items()
        )
    ]
    return float(min(good)), float(max(good))


def trend_claims(study: Study) -> list[Claim]:
    """Judge the trends of sections 3.1 to 3.4, their generality and the strongest factor."""
    claims = []
    for factor in settings.FACTORS:
        claims += [_by_formula(factor), _by_simulation(study, factor), _at_peaks(study, factor)]
    return [*claims, *_strongest(study), _single_curves(), _hardness_force()]


def _text(factor: settings.Factor) -> str:
    word = _WORD[settings.STATED_TRENDS[factor]]
    return f'the amplitude {word} with temperature through {settings.FACTOR_TEXT[factor]}'


def _by_formula(factor: settings.Factor) -> Claim:
    stated = settings.STATED_TRENDS[factor]
    changes = {
        name: formula_change(factor, ratio) for name, ratio in settings.FORMULA_RATIOS.items()
    }
    changes['healthy ball, b = 0'] = formula_change(factor, 0.0)
    for name in settings.PRESET_NAMES:
        ratio = own_ratio(preset(name, bearing=settings.BEARING))
        changes[f'{name}, C_d0/approach={ratio:.1f}'] = formula_change(factor, ratio)
    low, high = falling_window()
    return Claim(
        id=f'trend-{factor}-formula',
        where=f'section {_SECTION[factor]}, {_FIGURES[factor][0]}',
        claim=f'static formula: {_text(factor)}',
        paper_value=_WORD[stated],
        our_value=percents(changes),
        as_printed={name: same_direction(stated, change, 0.0) for name, change in changes.items()},
        why=(
            'Rule: sign of F(110)/F(20) - 1 for each ratio of spall depth to approach (the paper '
            f'gives no ratio). All four trends hold for {low:.2f} to {high:.2f} only: '
            'dF/dbeta0 < 0 needs beta0 C_d0/approach > 0.4; beyond 1 contact is lost (no value).'
        ),
    )


def _by_simulation(study: Study, factor: settings.Factor) -> Claim:
    stated = settings.STATED_TRENDS[factor]
    changes = {name: study.change(name, factor) for name in settings.PRESET_NAMES}
    changes[f"paper, equation 8's own window, {WINDOW_WIDTH * 1e3:g} mm"] = study.window[factor]
    ranges = []
    for name in settings.PRESET_NAMES:
        starts = study.changes_by_start(name, factor)
        rises = np.diff(study.amplitudes(name, factor)) * stated
        ranges.append(
            f'{name} {percent(starts.min())} to {percent(starts.max())}, '
            f'{int((rises > 0).sum())} of {len(rises)} steps of 10 K go that way'
        )
    return Claim(
        id=f'trend-{factor}-simulation',
        where=f'section {_SECTION[factor]}, {_FIGURES[factor][1]}',
        claim=f'simulation: {_text(factor)}',
        paper_value=_WORD[stated],
        our_value=percents(changes),
        as_printed={name: same_direction(stated, c, RESOLUTION) for name, c in changes.items()},
        why=(
            'Rule: A(110)/A(20) - 1 goes the stated way by more than 0.1 %; A is the mean of the '
            'largest 20 % of the maxima per impact of |a - mean a| over 0.7 s, a the vertical '
            'housing acceleration before the sensor, no jitter, no noise, no waviness. Over '
            f'{STARTS} starts of the record: {"; ".join(ranges)}. Of the whole space it holds in '
            f'{_share_text(study, factor)}.'
        ),
    )


def _share_text(study: Study, factor: settings.Factor) -> str:
    """Share of the space in which the trend of a factor holds, by path over the spall."""
    falls = study.grid.small if factor in ('expansion', 'hardness') else study.grid.large
    return ', '.join(
        f'{100.0 * np.mean(part < 0.0):.0f} % ({PATHS[profile]})'
        for profile, part in zip(study.grid.space.profiles, falls, strict=True)
    )


def _at_peaks(study: Study, factor: settings.Factor) -> Claim:
    stated = settings.STATED_TRENDS[factor]
    changes = {name: study.peak_change(name, factor) for name in settings.PRESET_NAMES}
    figure = _FIGURES[factor][1].rsplit(' ', 1)[1]
    return Claim(
        id=f'trend-{factor}-peaks',
        where=f'section {_SECTION[factor]}, figure {figure}',
        claim=f'peaks at 0.079, 0.277, 0.435, 0.633 s: {_text(factor)}',
        paper_value=_WORD[stated],
        our_value=percents(changes),
        as_printed={name: same_direction(stated, c, RESOLUTION) for name, c in changes.items()},
        why='Rule: mean height of the four peaks, 110 against 20 degC, by more than 0.1 %.',
    )


def _strongest(study: Study) -> list[Claim]:
    single = settings.FACTORS[:3]
    weights = (SMALL_DELTA_MU, settings.DELTA_MU)
    formula: dict[str, dict[str, float]] = {
        f'{name}, delta_mu={weight:g}': {f: formula_change(f, ratio, weight) for f in single}
        for weight in weights
        for name, ratio in settings.FORMULA_RATIOS.items()
    }
    simulated: dict[str, dict[str, float]] = {
        f'{name}, delta_mu={settings.DELTA_MU:g}': {f: study.change(name, f) for f in single}
        for name in settings.PRESET_NAMES
    }
    simulated |= {
        f'{name}, delta_mu={SMALL_DELTA_MU:g}': {f: study.small_mu[name, f] for f in single}
        for name in settings.PRESET_NAMES
    }
    # beta0 is linear in delta_mu, so the weight at which friction equals the others is a ratio.
    span = {f: _span(f) for f in single}
    level = settings.DELTA_MU * max(span['expansion'], span['hardness']) / span['friction']
    return [
        Claim(
            id=f'friction-strongest-{method}',
            where='section 3.4, conclusion 2',
            claim=f'{method}: friction is the most significant of the three factors',
            paper_value='friction',
            our_value={name: percents(changes) for name, changes in table.items()},
            as_printed={
                name: max(c, key=lambda factor: abs(c[factor])) == 'friction'
                for name, c in table.items()
            },
            why=(
                'Rule: largest |change| from 20 to 110 degC. The paper gives no weight delta_mu; '
                f'the friction term of beta0 is the largest above delta_mu = {level:.4f} (with '
                f'delta_h = {settings.DELTA_H:g}), whatever the mechanics.'
            ),
        )
        for method, table in (('formula', formula), ('simulation', simulated))
    ]


def _span(factor: settings.Factor) -> float:
    """Range of beta0 over the tables."""
    values = [equations.beta0(factor, t) for t in settings.TEMPERATURE_NODES]
    return max(values) - min(values)


def _single_curves() -> Claim:
    ratio = settings.FORMULA_RATIOS['C_d0/approach=0.7']
    changes = {}
    for factor in settings.FACTORS[:3]:
        cold, hot = (equations.beta0(factor, t) for t in (COLD, HOT))
        for name, (a, b) in {
            'stiffness': ((cold, 1.0), (hot, 1.0)),
            'damping': ((1.0, cold), (1.0, hot)),
        }.items():
            change = float(
                equations.static_force(*b, ratio) / equations.static_force(*a, ratio) - 1.0
            )
            changes[f'{factor}, single {name}'] = change
    return Claim(
        id='single-stiffness-and-damping',
        where='figures 6, 7, 13, 14, 20, 21',
        claim='F_x after a change of stiffness or of damping alone',
        paper_value=None,
        our_value=percents(changes),
        as_printed={
            name: same_direction(stated, changes[name], 0.0)
            for name, stated in settings.STATED_SINGLE_CURVES.items()
        },
        why=(
            'Rule: stated direction; the text states none, and no value. The stiffness '
            'curve always follows beta0, the damping curve always opposes it.'
        ),
    )


def _hardness_force() -> Claim:
    ratios = {**settings.FORMULA_RATIOS, 'healthy ball, b = 0': 0.0}
    changes = {name: formula_change('hardness', ratio) for name, ratio in ratios.items()}
    return Claim(
        id='soft-steel-raises-the-force',
        where='section 3.2, last paragraph',
        claim='the reduced hardness results in an increase in force',
        paper_value='increases',
        our_value=percents(changes),
        as_printed={name: same_direction(+1, c, 0.0) for name, c in changes.items()},
        why=(
            'Rule: sign of F(110)/F(20) - 1 of one ball at a held approach. Softer contacts carry '
            'less at the same approach; only a ball that is deep in the spall carries more. The '
            'balls together carry the load, at every temperature.'
        ),
    )


def own_ratio(parameters: TwinParameters) -> float:
    """
    Spall depth that a ball reaches, over the static approach of the most loaded ball.

    The ball carries 4.37 W/Z (Stribeck, no clearance). Its radius lets it sink between the edges
    by at most ``(w/2)^2 (1/d + 1/(D - d))`` on the inner race. Through the window of equation 8 it
    sinks by the whole depth.
    """
    bearing, defect = parameters.bearing, parameters.defects[0]
    force = 4.37 * parameters.load / bearing.n_balls
    curvature = 1.0 / bearing.d_ball + 1.0 / (bearing.d_pitch - bearing.d_ball)
    path = math.inf if defect.profile == 'rect' else (0.5 * defect.width) ** 2 * curvature
    reached = min(defect.depth, path)
    return float(reached / (force / parameters.k_b0) ** (2.0 / 3.0))
