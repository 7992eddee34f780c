# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Values that the paper states, and values that it leaves open and we chose.

Zhang, C.; Liu, T.; Wang, Y.; He, H.; Zhang, C. Symmetry 2023, 15, 2166 (CC BY).
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

from bearing_twin.bearing import Bearing
from bearing_twin.thermal.gcr15 import Beta0, TEMPERATURES

Factor = Literal['expansion', 'hardness', 'friction', 'all']

# Stated by the paper, section 2.

BORE, OUTSIDE = 35e-3, 80e-3
"""Boundary dimensions of a 6307, m (ISO 15). The paper's text calls them d and D."""
BEARING = Bearing(
    name='6307',
    n_balls=8,
    d_ball=14e-3,
    d_pitch=57.5e-3,
    bore=BORE,
    outside=OUTSIDE,
    series='63',
    source='Symmetry 2023, 15, 2166, sec. 2',
)
"""N_b = 8, d = 14 mm, D = 57.5 mm, read as ball and pitch diameter."""
SHAFT_HZ = 25.4
"""f_r, rev/s."""
TEMPERATURE_NODES = tuple(float(t) for t in TEMPERATURES)
"""degC."""
COLD, HOT = TEMPERATURE_NODES[0], TEMPERATURE_NODES[-1]
"""Temperatures between which the paper states its trends, degC."""
DURATION = 0.7
"""Length of the time records, s."""

# Stated by the paper, section 3.

PEAK_TIMES = (0.079, 0.277, 0.435, 0.633)
"""Times at which figures 10, 17, 24 and 29 are read, the same at all ten temperatures, s."""
F_IN: Mapping[str, float] = MappingProxyType(
    {'fig4': 126.463, 'fig30': 126.423, 'fig32': 126.823, 'fig31': 127.0}
)
"""Inner-ring fault frequency as quoted for each figure, Hz. Figure 31 is the experiment."""
F_IN_PRINTED_AT_20 = (F_IN['fig4'], F_IN['fig30'])
"""The two values quoted for the model without temperature, Hz."""
FACTORS: tuple[Factor, ...] = ('expansion', 'hardness', 'friction', 'all')
STATED_TRENDS: Mapping[Factor, int] = MappingProxyType(
    {'expansion': -1, 'hardness': +1, 'friction': -1, 'all': -1}
)
"""Direction of the acceleration amplitude with rising temperature."""
FACTOR_TEXT: Mapping[Factor, str] = MappingProxyType(
    {
        'expansion': 'thermal expansion',
        'hardness': 'hardness',
        'friction': 'friction',
        'all': 'all three factors',
    }
)
C_D_UNIT = 'N s/m'
"""Unit of C_d as a damping: section 3 calls it 'friction damping'."""
AMPLITUDE_UNIT: str | None = None
"""Unit of the axis 'amplitude V' of the waterfalls: none is given; V is a symbol, like t and T."""
EXPERIMENT = None
"""The record behind figure 31: 'the data are not disclosed'."""
AMPLITUDE_AT_20 = None
"""Amplitude of the simulated signal: drawn in the figures, given nowhere in the text."""
SYSTEM_MASS = None
"""m of equation 19: named, not given."""
STATED_SINGLE_CURVES: Mapping[str, int] = MappingProxyType({})
"""Directions that the text states for the single stiffness and damping curves: none."""
DISCLOSED = frozenset(
    {'n_balls', 'd_ball', 'd_pitch', 'contact_angle', 'shaft_hz', 'temperature', 'duration'}
)
"""Quantities for which the paper gives a value."""
REQUIRED = DISCLOSED | {
    'hertz_stiffness', 'defect depth', 'defect width', 'clearance', 'load', 'contact_damping',
    'inner_mass', 'inner_stiffness', 'inner_damping', 'outer_mass', 'outer_stiffness',
    'outer_damping', 'delta_h', 'delta_mu', 'sample_rate',
}  # fmt: skip
"""Quantities that its simulation needs."""

# Chosen here, because the paper gives no value.

DELTA_H, DELTA_MU = 0.10, 0.02
"""Weights of hardness and friction in beta0, dimensionless."""
FORMULA_RATIOS: Mapping[str, float] = MappingProxyType(
    {'C_d0/approach=0.7': 0.7, 'C_d0/approach=0.3': 0.3}
)
"""Spall depth over ring approach at which the static formula is drawn, inside and outside the
window 0.4 to 1 in which the force falls with beta0."""
APPROACH = 27e-6
"""Ring approach at the ball for the static formula, m: its value in `paper` under 3.2 kN."""
PUBLISHED_MODELS: Mapping[str, tuple[str, Mapping[str, float]]] = MappingProxyType(
    {
        'mishra2017': ('mishra2017', {}),
        'sawalhi2008': ('sawalhi2008', {}),
        'dong': (
            'incipient',
            {'inner_mass': 50.0, 'unbalance': 2.5e-3, 'hertz_stiffness': 8.753e9},
        ),
    }
)
"""Preset with the masses and stiffnesses of published models, and the parameters changed in it.
Dong's thesis and the code that cites it have a rotor of 50 kg with an eccentricity of 50 um. It is
not a preset of the twin, because its trend depends on speed, load and clearance."""
PRESET_NAMES = ('paper', 'incipient')
"""Presets of the simulation: the stated trends hold in the first and not in the second."""


def factor_of(factor: Factor | None, *, delta_mu: float = DELTA_MU) -> Beta0:
    """Return beta0 with only the terms of ``factor``; with None beta0 = 1."""
    return Beta0(
        expansion=factor in ('expansion', 'all'),
        hardness=factor in ('hardness', 'all'),
        friction=factor in ('friction', 'all'),
        delta_h=DELTA_H,
        delta_mu=delta_mu,
    )
