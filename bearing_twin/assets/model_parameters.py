# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Parameters of the twin node that describe machine, sensor, oil and thermal laws.

One parameter a field of :class:`TwinParameters` and of the groups in it, with the field's name,
default and range. A parameter that has its default leaves the field to the preset.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.spec import Spec
from bearing_twin.dynamics.parameters import RANGES, TwinParameters
from bearing_twin.thermal.friction import SERIES
from bearing_twin.thermal.gcr15 import Beta0
from bearing_twin.thermal.lubricant import Lubricant
from bearing_twin.thermal.rings import NETWORK_RANGES, ThermalNetwork

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ['SPECS', 'fields']

FROM_PRESET = -1.0
"""Stands for 'from the preset' where 0 is a value of its own."""


def _machine(name: str, description: str, *, preset: float | None = None) -> Spec:
    """Return a field of the twin; `preset` is the value that leaves it to the preset."""
    low, high, unit = RANGES[name]
    default = getattr(TwinParameters, name) if preset is None else preset
    return Spec(
        name=name,
        default=default,
        description=description,
        unit=unit,
        low=min(low, default),
        high=high,
        implied=True,
    )


def _given(name: str, description: str, unit: str, high: float) -> Spec:
    """Return a field of the twin that 0 leaves to the preset or the geometry."""
    return Spec(
        name=name,
        default=0.0,
        description=description,
        unit=unit,
        low=0.0,
        high=high,
        implied=True,
    )


_MACHINE = (
    _machine('clearance', 'Radial clearance, half the internal one, at one ring temperature.'),
    _given(
        'hertz_stiffness',
        'K_b0, radial force over deformation^1.5; 0: from preset or geometry.',
        'N/m^1.5',
        1e12,
    ),
    _machine('contact_damping', 'Damping of a loaded ball.'),
    _machine('inner_mass', 'Mass of rotor and shaft; 0: from the preset.', preset=0.0),
    _machine('inner_stiffness', 'Stiffness of the shaft.'),
    _machine('inner_damping', 'Damping of the shaft.'),
    _machine('outer_mass', 'Mass of the housing.'),
    _machine('outer_stiffness', 'Stiffness of the housing.'),
    _machine('outer_damping', 'Damping of the housing.'),
    _machine(
        'unbalance',
        "Unbalance, mass times eccentricity; at most 1 mm of the rotor's mass; -1: from preset.",
        preset=FROM_PRESET,
    ),
    _machine('slip', "Cage slip, 'constant' or, where mu is that of 20 degC, 'mu_proportional'."),
    replace(
        _machine('start_angle', "Angle of ball 0 and of the shaft's mark at sample 0, from +x."),
        running=False,
    ),
    replace(
        _given('resonance_hz', "Sensor's resonance, 500 to 11000; 0: none.", 'Hz', 11000.0),
        default=TwinParameters.resonance_hz,
    ),
    _machine('resonance_damping', "Damping ratio of the sensor's resonance."),
    Spec(
        name='friction_series',
        default='',
        description="Series of the SKF friction model; '' for the bearing's own.",
        choices=('', *SERIES),
        implied=True,
    ),
    _given('dynamic_rating', 'C of ISO 281, from 10 N; 0: from the geometry.', 'N', 1e8),
    _given('fatigue_limit', 'C_u of ISO 281, from 1 N; 0: from the geometry.', 'N', 1e7),
)


def _grouped(
    group: str, owner: type, name: str, description: str, low: float, high: float, unit: str = ''
) -> Spec:
    return Spec(
        name=f'{group}.{name}',
        default=getattr(owner, name),
        description=description,
        unit=unit,
        low=low,
        high=high,
        implied=True,
    )


def _term(name: str, description: str) -> Spec:
    return Spec(name=f'beta0.{name}', default=True, description=description, implied=True)


_beta0 = partial(_grouped, 'beta0', Beta0)
_oil = partial(_grouped, 'lubricant', Lubricant)

_BETA0 = (
    _term('expansion', 'Thermal mode paper: beta0 with the term of thermal expansion.'),
    _term('hardness', 'Thermal mode paper: beta0 with the term of hardness.'),
    _term('friction', 'Thermal mode paper: beta0 with the term of friction.'),
    _beta0(
        'alpha_unit',
        "Unit of table 1: 1e-5 (the paper's numbers) or 1e-6 (magnitude of real steel).",
        1e-6,
        1e-5,
        '1/K',
    ),
    _beta0('delta_h', 'Weight of hardness in beta0, which must stay in 0.5..1.5.', 0.0, 2.0),
    _beta0('delta_mu', 'Weight of friction in beta0, which must stay in 0.5..1.5.', 0.0, 2.0),
    _beta0('reference_temperature', 'T0 of beta0.', 20.0, 110.0, 'degC'),
    _beta0('reference_hardness', 'H0 of beta0.', 1.0, 100.0, 'HRC'),
    _beta0('reference_friction', 'mu0 of beta0 and of slip in proportion to mu.', 1e-4, 10.0),
)

_LUBRICANT = (
    _oil('viscosity_40', 'Kinematic viscosity of the oil at 40 degC.', 2e-6, 5e-3, 'm^2/s'),
    _oil('viscosity_100', 'Kinematic viscosity of the oil at 100 degC.', 2e-6, 5e-3, 'm^2/s'),
    _oil('replenishment', 'K_rs of SKF: 3e-8 low oil level, 6e-8 grease or oil spot.', 0.0, 1e-6),
    _oil('boundary_friction', 'Sliding friction with metallic contact.', 0.0, 0.5),
    _oil('film_friction', 'Sliding friction on a full film.', 0.0, 0.5),
    _oil('contamination', 'e_C of ISO 281: 1 extreme cleanliness, 0 severe dirt.', 0.0, 1.0),
)

# Not the capacity and the losses of the outer ring: its temperature is measured.
_NETWORK = tuple(
    _grouped('network', ThermalNetwork, name, description, *NETWORK_RANGES[name])
    for name, description in (
        ('inner_capacity', 'Thermal mode physical: heat capacity of the inner ring.'),
        ('ring_to_ring', 'Thermal mode physical: conductance between the rings.'),
        ('ring_to_shaft', 'Thermal mode physical: conductance from inner ring to shaft.'),
        ('ambient', 'Thermal mode physical: temperature of the surroundings.'),
        (
            'shaft_ratio',
            'Thermal mode physical: rise of the shaft over ambient by that of the outer ring.',
        ),
    )
)

SPECS = (*_MACHINE, *_BETA0, *_LUBRICANT, *_NETWORK)

_GROUPS: Mapping[str, type] = {
    'beta0': Beta0,
    'lubricant': Lubricant,
    'network': ThermalNetwork,
}


def fields(values: Mapping[str, Any]) -> dict[str, Any]:
    """
    Return the fields of :class:`TwinParameters` that the parameters set.

    Raises
    ------
    BearingTwinError
        If those of a group do not fit together.

    """
    given: dict[str, Any] = {}
    grouped: dict[str, dict[str, Any]] = {group: {} for group in _GROUPS}
    for spec in SPECS:
        if values[spec.name] == spec.default:
            continue
        group, _, name = spec.name.rpartition('.')
        (grouped[group] if group else given)[name] = values[spec.name]
    return given | {group: _GROUPS[group](**found) for group, found in grouped.items()}
