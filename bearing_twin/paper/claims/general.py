# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Claims about the generality of the trends: other settings, other models, temperature ramps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.dynamics import preset
from bearing_twin.paper import settings
from bearing_twin.paper.claims.claim import Claim, percents, same_direction, share
from bearing_twin.paper.claims.trend import formula_change, own_ratio, RESOLUTION
from bearing_twin.paper.space import PATHS, STATES
from bearing_twin.paper.study import LITERATURE_DEPTHS, LITERATURE_LOADS, LITERATURE_WIDTHS
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.paper.study import Study


def general_claims(study: Study) -> list[Claim]:
    """Judge the generality of the trends and the causes that the paper names."""
    return [
        _formula_verifies(study),
        _general(study),
        _literature(study),
        _clearance(study),
        _proportional_to_time(study),
        _initial_conditions(study),
    ]


def _formula_verifies(study: Study) -> Claim:
    space = study.grid.space
    cold = space.specs()[:: len(STATES)]
    changes = np.array([formula_change('friction', own_ratio(spec.parameters())) for spec in cold])
    falls = (changes.reshape(space.shape) < 0.0) & (study.grid.large < 0.0)
    own = {
        name: own_ratio(preset(name, bearing=settings.BEARING)) for name in settings.PRESET_NAMES
    }
    pairs = {
        f'paper, {name}': (formula_change('all', ratio), study.formula_depths[name])
        for name, ratio in settings.FORMULA_RATIOS.items()
    }
    pairs |= {
        f'{name}, C_d0/approach={ratio:.1f}': (
            formula_change('all', ratio),
            study.change(name, 'all'),
        )
        for name, ratio in own.items()
    }
    return Claim(
        id='formula-verifies-simulation',
        where='sections 3.1 to 3.4, "consistent with the theoretical calculation results"',
        claim='the amplitude of the simulation decreases as the force of the static formula does',
        paper_value='both decrease',
        our_value={
            **{
                name: percents({'formula': formula, 'simulation': simulation})
                for name, (formula, simulation) in pairs.items()
            },
            'both fall, share of the space': float(np.mean(falls)),
            'contact lost in the formula, share': float(np.mean(np.isnan(changes))),
        },
        as_printed={
            name: same_direction(-1, formula, 0.0) and same_direction(-1, simulation, RESOLUTION)
            for name, (formula, simulation) in pairs.items()
        },
        why=(
            'Rule: with all factors both fall from 20 to 110 degC, the formula taken with the '
            'spall depth and the static approach of the simulation. In a spall that is shallow '
            'against the approach both rise. Where the formula falls the ball keeps contact in '
            'the spall, and a stiffer contact strikes harder. With a ratio above 1 the formula '
            f'says that the ball carries nothing at any temperature. Over {len(changes)} '
            'combinations of path, speed, load, spall and clearance (shares given) it is no guide '
            'either: the trend of the simulation comes from the duration of the passage against '
            'the contact resonance.'
        ),
    )


def _general(study: Study) -> Claim:
    space, falls = study.grid.space, study.grid.falls
    shares = {
        PATHS[p]: float(np.mean(part)) for p, part in zip(space.profiles, falls, strict=True)
    }
    speeds = {f'{speed:g} Hz': float(np.mean(falls[:, k])) for k, speed in enumerate(space.speeds)}
    widths = {
        f'{1e3 * width:g} mm wide': float(np.mean(falls[:, :, :, k]))
        for k, width in enumerate(space.widths)
    }
    return Claim(
        id='trend-is-general',
        where='abstract, conclusion 2',
        claim='the overall acceleration amplitude decreases with temperature',
        paper_value='decreases',
        our_value={
            'all four trends, share of the space': float(np.mean(falls)),
            **shares,
            **speeds,
            **widths,
            'points': falls.size,
        },
        verdict=share(float(np.mean(falls))),
        why=(
            'Rule: at least 95 % of a space of two paths over the spall, shaft '
            f'{_list(space.speeds)} Hz, load {_list(space.loads)} N, spall '
            f'{_list(space.widths, 1e3)} mm wide and {_list(space.depths, 1e6)} um deep, '
            f'clearance {_list(space.clearances, 1e6)} um, with the dampings of '
            'the preset `paper`. K_b and C_d share one factor, so all temperature trends of the '
            'model are one statement: A falls with beta0. It does where the ball leaves the races '
            'in the spall and the '
            'passage lasts 1 to 1.5 periods of the contact mode: a stiffer contact then rings '
            'less. In a shallow or short spall a stiffer contact strikes harder.'
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
            '`sawalhi2008`, and both with the unbalance of Dong are those of the models; the '
            "rest is ours. Dong's is the thesis that the paper's equations come from (its "
            'reference 19).'
        ),
    )


def _clearance(study: Study) -> Claim:
    cold, *_, hot = study.trends['paper', 'all']
    holds = {"the paper's equations": hot.clearance < cold.clearance}
    for name, warming in study.physical.items():
        weaker = same_direction(-1, warming.change, RESOLUTION)
        shrinks = warming.hot.clearance < warming.cold.clearance
        holds[f"mode 'physical', {name}"] = shrinks and weaker
    return Claim(
        id='clearance-shrinks',
        where='section 3.1, last paragraph',
        claim='the clearance becomes smaller and so the impact becomes smaller',
        paper_value='decreases',
        our_value=percents({name: warming.change for name, warming in study.physical.items()}),
        as_printed=holds,
        why=(
            'Rule: c_r of the model is smaller at 110 than at 20 degC, and the amplitude is '
            'smaller by more than 0.1 %. c_r does not depend on T in equation 15: the mechanism '
            "named in words is absent from the paper's model. The twin's mode 'physical' has it: "
            'the inner ring runs hotter than the outer.'
        ),
    )


def _proportional_to_time(study: Study) -> Claim:
    ramp, held = {}, {}
    for name in settings.PRESET_NAMES:
        amplitudes = study.ramp[name]
        ramp[name] = float(amplitudes[-1] / amplitudes[0] - 1.0)
        held[name] = study.change(name, 'all')
    nodes = settings.TEMPERATURE_NODES
    reached = [
        nodes[0] + (nodes[-1] - nodes[0]) * t / settings.DURATION for t in settings.PEAK_TIMES
    ]
    one_record = all(
        any(abs(temperature - node) < 0.5 for temperature in reached) for node in nodes
    )
    return Claim(
        id='temperature-in-proportion-to-time',
        where='section 2, last but two paragraphs',
        claim='a proportional relationship between temperature and time, 20 to 110 degC',
        paper_value='ten temperatures',
        our_value=percents(
            {f'ramp, {name}': value for name, value in ramp.items()}
            | {f'held, {name}': value for name, value in held.items()}
        ),
        as_printed={
            'within one record of 0.7 s': one_record,
            **{
                f'over 15 s, {name}': same_direction(
                    1 if held[name] > 0.0 else -1, ramp[name], RESOLUTION
                )
                for name in settings.PRESET_NAMES
            },
        },
        why=(
            'Rule: the peak times of one record meet all ten temperatures; or the amplitude moves '
            'from the first to the last tenth of a ramp over 15 s as from 20 to 110 degC held. '
            'Four peaks in one record meet '
            + ', '.join(f'{temperature:.0f}' for temperature in reached)
            + ' degC, so the figures need a record for each temperature.'
        ),
    )


def _initial_conditions(study: Study) -> Claim:
    motion = study.initial_state_effect
    parameters = {name: study.change(name, 'all') for name in settings.PRESET_NAMES}
    return Claim(
        id='different-initial-conditions',
        where='section 3.4, before the applications',
        claim='temperature acts through the difference in initial condition parameters',
        paper_value='initial conditions',
        our_value=percents(
            {f'other motion at t = 0, {name}': value for name, value in motion.items()}
            | {f'other K_b and C_d, {name}': value for name, value in parameters.items()}
        ),
        as_printed={
            f'motion at t = 0, {name}': abs(value) > RESOLUTION for name, value in motion.items()
        },
        as_read={
            f'K_b and C_d, {name}': abs(value) > RESOLUTION for name, value in parameters.items()
        },
        why=(
            'Rule: the amplitude differs by more than 0.1 %. A run at 20 degC that comes from 110 '
            'degC forgets where it came from. Reading taken: the parameters that are set at the '
            'start, K_b and C_d.'
        ),
    )
