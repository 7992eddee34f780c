# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Claims about how the acceleration amplitude follows the temperature."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.dynamics import preset
from bearing_twin.paper import equations, settings
from bearing_twin.paper.claims import Claim, percent, percents
from bearing_twin.paper.study import (
    CLEARANCE_COLD,
    CLEARANCE_HOT,
    LITERATURE_DEPTHS,
    LITERATURE_LOADS,
    LITERATURE_WIDTHS,
    SMALL_DELTA_MU,
    STARTS,
)
from bearing_twin.paper.verdicts import same_direction, share
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bearing_twin.dynamics import TwinParameters
    from bearing_twin.paper.study import Study
    import numpy.typing as npt

__all__ = ['falling_window', 'formula_change', 'trend_claims']

RESOLUTION = 0.001
"""Relative error of the simulation: changes below it have no direction."""
COLD, HOT = settings.TEMPERATURE_NODES[0], settings.TEMPERATURE_NODES[-1]
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


def falling_window(step: float = 0.001) -> tuple[float, float]:
    """
    Smallest and largest C_d0/approach at which the formula gives all four stated trends.

    Contact has to be kept at every temperature.
    """
    highest = max(
        equations.beta0(factor, t)
        for factor in settings.FACTORS
        for t in settings.TEMPERATURE_NODES
    )
    ratios = np.arange(step, 1.0 / highest, step)
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
    return [
        *claims,
        *_strongest(study),
        _formula_verifies(study),
        _general(study),
        _literature(study),
        _clearance(study),
        _single_curves(),
    ]


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
        ratio = _own_ratio(preset(name, bearing=settings.BEARING))
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
            'Rule: sign of F(110)/F(20) - 1 for each ratio of spall depth to approach, of which '
            f'the paper gives none. All four trends hold for {low:.2f} to {high:.2f} only: '
            'dF/dbeta0 < 0 needs beta0 C_d0/approach > 0.4; beyond 1 contact is lost (no value).'
        ),
    )


def _by_simulation(study: Study, factor: settings.Factor) -> Claim:
    stated = settings.STATED_TRENDS[factor]
    changes = {name: study.change(name, factor) for name in settings.PRESET_NAMES}
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
            'housing acceleration before the sensor, no jitter, no noise. Over '
            f'{STARTS} starts of the record: {"; ".join(ranges)}.'
        ),
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


def _is_friction(changes: Mapping[str, float]) -> bool:
    return max(changes, key=lambda factor: abs(changes[factor])) == 'friction'


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
    # beta0 is linear in delta_mu, so the weight at which friction draws level is a ratio.
    span = {f: _span(f) for f in single}
    level = settings.DELTA_MU * max(span['expansion'], span['hardness']) / span['friction']
    return [
        Claim(
            id=f'friction-strongest-{method}',
            where='section 3.4, conclusion 2',
            claim=f'{method}: friction is the most significant of the three factors',
            paper_value='friction',
            our_value={name: percents(changes) for name, changes in table.items()},
            as_printed={name: _is_friction(c) for name, c in table.items()},
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


def _formula_verifies(study: Study) -> Claim:
    grid = study.grid
    changes = [formula_change('friction', _own_ratio(spec.parameters())) for spec in grid.specs]
    signs_agree = np.array(changes) * grid.slopes > 0.0
    own = {
        name: _own_ratio(preset(name, bearing=settings.BEARING)) for name in settings.PRESET_NAMES
    }
    holds = {
        name: formula_change('all', ratio) * study.change(name, 'all') > 0.0
        for name, ratio in own.items()
    }
    return Claim(
        id='formula-verifies-simulation',
        where='sections 3.1 to 3.4, "consistent with the theoretical calculation results"',
        claim='the static formula predicts the trend of the simulation',
        paper_value='consistent',
        our_value={
            'C_d0/approach': own,
            'grid_same_sign': float(np.mean(signs_agree)),
            'grid_contact_lost': float(np.mean(np.isnan(changes))),
        },
        as_printed=holds,
        why=(
            'Rule: one sign of the change with all factors in both, the formula taken with the '
            "preset's own spall depth and static approach. With a ratio above 1 the formula says "
            f'that the ball carries nothing at any temperature. Over {len(changes)} combinations '
            'of load, spall and clearance (fractions given) it is no guide either: the trend of '
            'the simulation comes from the duration of the passage against the contact resonance.'
        ),
    )


def _own_ratio(parameters: TwinParameters) -> float:
    """
    Spall depth that a ball reaches, over the static approach of the most loaded ball.

    The ball carries 4.37 W/Z (Stribeck, no clearance). It sinks no deeper than its radius lets it
    between the edges, ``(w/2)^2 (1/d + 1/(D - d))`` on the inner race.
    """
    bearing, defect = parameters.bearing, parameters.defects[0]
    force = 4.37 * parameters.load / bearing.n_balls
    curvature = 1.0 / bearing.d_ball + 1.0 / (bearing.d_pitch - bearing.d_ball)
    reached = min(defect.depth, (0.5 * defect.width) ** 2 * curvature)
    return float(reached / (force / parameters.k_b0) ** (2.0 / 3.0))


def _general(study: Study) -> Claim:
    return Claim(
        id='trend-is-general',
        where='abstract, conclusion 2',
        claim='the overall acceleration amplitude decreases with temperature',
        paper_value='decreases',
        our_value={'fraction_of_grid': study.grid.falling, 'points': len(study.grid.slopes)},
        verdict=share(study.grid.falling),
        why=(
            'Rule: at least 95 % of a grid of load 0.5 to 4 kN, spall 0.4 to 4.8 mm wide and 15 '
            'to 60 um deep, clearance 0 and 5 um. K_b and C_d share one factor, so all '
            'temperature trends of the model are one statement: A falls with beta0.'
        ),
    )


def _falls(changes: npt.NDArray[np.float64]) -> list[bool]:
    return [same_direction(-1, float(change), RESOLUTION) for change in changes]


def _list(values: tuple[float, ...], scale: float = 1.0) -> str:
    return ', '.join(f'{value * scale:g}' for value in values)


def _literature(study: Study) -> Claim:
    falls = [fell for changes in study.literature.values() for fell in _falls(changes)]
    return Claim(
        id='trend-in-published-models',
        where='conclusion 2',
        claim='with all factors the amplitude decreases, with the masses and stiffnesses of '
        'models that the paper builds on',
        paper_value='decreases',
        our_value={
            f'fraction, {name}': float(np.mean(_falls(changes)))
            for name, changes in study.literature.items()
        }
        | {'fraction': float(np.mean(falls)), 'points': len(falls)},
        verdict=share(float(np.mean(falls))),
        why=(
            f'Rule: share of {len(falls)} combinations in which the amplitude falls by more than '
            f'0.1 % from 20 to 110 degC, at least 95 %: load {_list(LITERATURE_LOADS)} N, spall '
            f'{_list(LITERATURE_WIDTHS, 1e3)} mm wide and {_list(LITERATURE_DEPTHS, 1e6)} um deep '
            'for each model. Only the contact stiffness of `mishra2017`, the rotor mass of '
            '`sawalhi2008`, and both with the unbalance of `dong` are those of the models; the '
            "rest is ours. `dong` is the thesis that the paper's equations come from (its "
            'reference 19).'
        ),
    )


def _clearance(study: Study) -> Claim:
    changes = {name: hot / cold - 1.0 for name, (cold, hot) in study.clearance.items()}
    holds = {name: same_direction(-1, change, RESOLUTION) for name, change in changes.items()}
    cold, *_, hot = study.trends['paper', 'all']
    return Claim(
        id='clearance-shrinks',
        where='section 3.1, last paragraph',
        claim='the clearance becomes smaller and so the impact becomes smaller',
        paper_value='decreases',
        our_value=percents(changes),
        as_printed={"c_r falls in the paper's equations": hot.clearance < cold.clearance},
        as_read={f'c_r of warm rings, {name}': held for name, held in holds.items()},
        why=(
            'Rule: c_r of the model is smaller at 110 than at 20 degC; then '
            f'amplitude falls by more than 0.1 % when c_r goes from '
            f'{CLEARANCE_COLD * 1e6:g} to {CLEARANCE_HOT * 1e6:.2g} um, as with an inner ring 9 K '
            'hotter. But c_r does not depend on T in equation 15: the '
            'mechanism named in words is absent from the model. Reading taken: rings of unlike '
            'temperature.'
        ),
    )


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
