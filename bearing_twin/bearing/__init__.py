# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Bearing geometry, fault frequencies, ratings, Hertz contact and the catalogue."""

from bearing_twin.bearing.catalogue import (
    bearing_of_orders,
    catalogue,
    close_bearings,
    find_bearing,
    named_bearing,
    own_bearing,
)
from bearing_twin.bearing.geometry import (
    Bearing,
    check_geometry,
    fault_frequencies,
    fault_orders,
    FaultFrequencies,
)
from bearing_twin.bearing.hertz import (
    contact_pressure,
    contact_stiffness,
    load_deflection_factor,
    POISSON_STEEL,
    radial_factor,
    YOUNG_STEEL,
)
from bearing_twin.bearing.ratings import basic_dynamic_rating, basic_static_rating, static_factor
from bearing_twin.bearing.vocabulary import (
    FAULT_CODES,
    LEVELS,
    next_step,
    Place,
    PLACES,
    RESULTS,
    TITLES,
)

__all__ = [
    'FAULT_CODES',
    'LEVELS',
    'PLACES',
    'POISSON_STEEL',
    'RESULTS',
    'TITLES',
    'YOUNG_STEEL',
    'Bearing',
    'FaultFrequencies',
    'Place',
    'basic_dynamic_rating',
    'basic_static_rating',
    'bearing_of_orders',
    'catalogue',
    'check_geometry',
    'close_bearings',
    'contact_pressure',
    'contact_stiffness',
    'fault_frequencies',
    'fault_orders',
    'find_bearing',
    'load_deflection_factor',
    'named_bearing',
    'next_step',
    'own_bearing',
    'radial_factor',
    'static_factor',
]
