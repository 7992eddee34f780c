# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Claims about tables 1 to 3 and the factor beta0."""

from __future__ import annotations

import math

from bearing_twin.paper import equations, settings
from bearing_twin.paper.claims.claim import Claim, within
from bearing_twin.paper.settings import COLD, HOT
from bearing_twin.thermal import gcr15
from bearing_twin.thermal.friction import (
    friction_moment,
    metallic_share,
    section_height,
    SERIES,
    sliding_friction,
)
from bearing_twin.thermal.lubricant import Lubricant
from bearing_twin.thermal.network import EXPANSION_STEEL, relative_modulus
import numpy as np
from scipy.stats import kendalltau


def material_claims() -> list[Claim]:
    """Judge sections 3.1 to 3.4 on the tables and on beta0."""
    return [*_table_claims(), *_hardness_claims(), *_beta_claims(), _lubricant()]


def _overall(table: gcr15.FloatArray) -> float:
    return float(kendalltau(gcr15.TEMPERATURES, table).statistic)


def _table_claims() -> list[Claim]:
    tables = (
        ('1', 'expansion coefficient', gcr15.EXPANSION_TABLE, +1, 'figure 5'),
        ('2', 'hardness', gcr15.HARDNESS_TABLE, -1, 'figure 12'),
        ('3', 'friction coefficient', gcr15.FRICTION_TABLE, +1, 'figure 19'),
    )
    claims = [
        Claim(
            id=f'table-{number}-trend',
            where=f'table {number}, {figure}',
            claim=f'{name}: overall {"upward" if sign > 0 else "downward"} trend',
            paper_value='upward' if sign > 0 else 'downward',
            our_value={
                'kendall_tau': _overall(table),
                'steps_the_other_way': int((sign * np.diff(table) < 0).sum()),
            },
            as_printed={'rank correlation': sign * _overall(table) > 0.0},
            why='Rule: sign of the rank correlation with temperature; the paper says overall.',
        )
        for number, name, table, sign, figure in tables
    ]
    units = {'10^-5/K': 1e-5, '10^-6/K': 1e-6}
    middle = float(np.median(gcr15.EXPANSION_TABLE))
    ratios = {name: middle * unit / EXPANSION_STEEL for name, unit in units.items()}
    claims.append(
        Claim(
            id='table-1-magnitude',
            where='table 1',
            claim='table 1 is the expansion coefficient of GCr15 bearing steel',
            paper_value=EXPANSION_STEEL,
            our_value={f'median over steel, {name}': ratio for name, ratio in ratios.items()},
            as_printed={'10^-5/K': 0.5 < ratios['10^-5/K'] < 2.0},
            as_read={'10^-6/K': 0.5 < ratios['10^-6/K'] < 2.0},
            why=(
                'Rule: median of the table within a factor 2 of 12e-6/K. The head of the table '
                'gives 10^5/K in our text of the paper, which has lost its minus signs; section '
                '3.1 gives microns per metre and degree, which is 10^-6/K and fits.'
            ),
        )
    )
    return claims


def _hardness_claims() -> list[Claim]:
    rise = gcr15.hardness(HOT) - gcr15.hardness(COLD)
    tau = float(kendalltau(gcr15.HARDNESS_TABLE, gcr15.FRICTION_TABLE).statistic)
    beta = equations.beta0('hardness', COLD)
    return [
        Claim(
            id='hardness-increases',
            where='sections 3.2 and 3.3: "the increase in temperature causes the hardness value H '
            'of the rolling bearing to increase"',
            claim='hardness increases with temperature',
            paper_value='increases',
            our_value=rise,
            as_printed={'table 2': rise > 0.0},
            as_read={'decreases, as table 2 and both conclusions have it': rise < 0.0},
            why=(
                'Rule: H(110) - H(20) of table 2 in HRC. The sentence is repeated in section 3.3, '
                'where it should speak of friction.'
            ),
        ),
        Claim(
            id='table-3-called-hardness',
            where='section 3.3, before table 3',
            claim='table 3 is "a data table of the change of hardness value", trend upward',
            paper_value='hardness',
            our_value={'kendall_tau_with_table_2': tau},
            as_printed={'tables 2 and 3 go together': tau > 0.0},
            as_read={'the friction coefficient, rising': _overall(gcr15.FRICTION_TABLE) > 0.0},
            why='Rule: rank correlation of tables 2 and 3. Table 3 is the friction coefficient.',
        ),
        Claim(
            id='initial-hardness',
            where='section 3.2',
            claim='the initial hardness H0 is 63.6 HRC',
            paper_value=63.6,
            our_value={'H(20)': gcr15.hardness(COLD), 'beta0(20), hardness': beta},
            as_printed={
                'a value of table 2': bool(np.isclose(gcr15.HARDNESS_TABLE, 63.6).any()),
                'the value at T0 = 20 degC': math.isclose(gcr15.hardness(COLD), 63.6),
            },
            why=(
                'Rule: a declared choice has to be in table 2, and may be meant for T0. It is the '
                'value of 40 and 50 degC; therefore beta0 is not 1 at the reference temperature.'
            ),
        ),
    ]


def _beta_claims() -> list[Claim]:
    literal, strain = equations.expansion_term(HOT), equations.alpha_strain(HOT)
    stiffness = 1.0 + literal
    steel = relative_modulus(HOT)
    return [
        Claim(
            id='expansion-is-a-strain',
            where='equations 13 and 14',
            claim='alpha (T - T0) with the instantaneous coefficient is the expansion',
            paper_value=literal,
            our_value=strain,
            verdict=within(literal, strain, 0.05 * literal),
            why=(
                'Rule: equal to the integral of alpha from 20 to 110 degC to 5 %. An '
                'instantaneous coefficient has to be integrated; and a strain changes lengths, '
                'not a stiffness.'
            ),
        ),
        Claim(
            id='stiffness-rises',
            where='equation 14',
            claim='stiffness rises with temperature through expansion',
            paper_value=stiffness,
            our_value=steel,
            as_printed={"Young's modulus of steel": (steel - 1.0) * literal > 0.0},
            why="Rule: same direction as Young's modulus of steel, -3e-4/K.",
        ),
    ]


def _lubricant() -> Claim:
    oil, bearing, load = Lubricant(), settings.BEARING, 500.0
    rpm = 60.0 * settings.SHAFT_HZ
    sliding, moment = [], []
    for temperature in (COLD, HOT):
        nu = oil.viscosity(temperature)
        metallic = metallic_share(rpm, nu, bearing.mean_diameter)
        mu = sliding_friction(metallic, oil.boundary_friction, oil.film_friction)
        sliding.append(mu)
        moment.append(
            friction_moment(
                rpm, nu, load, bearing.mean_diameter, section_height(bearing),
                *SERIES[bearing.series], oil.replenishment, mu,
            )
        )  # fmt: skip
    return Claim(
        id='hot-oil-rubs-more',
        where='section 3.3, last paragraph',
        claim='with temperature the viscosity falls and the friction of the bearing rises',
        paper_value='rises',
        our_value={'sliding coefficient': sliding, 'moment / N m': moment},
        as_printed={
            'sliding friction coefficient': sliding[1] > sliding[0],
            'friction moment of the bearing': moment[1] > moment[0],
        },
        why=(
            'Rule: larger at 110 than at 20 degC in the SKF friction model, ISO VG 68, 500 N. '
            'The sliding part goes the stated way and table 3 looks like it; the moment that '
            'brakes the bearing is rolling in oil and falls.'
        ),
    )
