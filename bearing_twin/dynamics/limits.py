# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Validity limits of the twin's model and of the rating life.

ISO 281 gives no life for loads above half the dynamic rating or above the static rating, because
the contacts yield, nor below a viscosity ratio of 0.1. Hertz's theory assumes elastic contact: for
ball bearings ISO 76 sets the limit at 4.2 GPa, where a permanent deformation of 1/10000 of the
ball diameter remains.
"""

from __future__ import annotations

from enum import IntFlag
import math
from typing import NamedTuple

from bearing_twin.thermal.slip import HIGHEST_SLIP

HIGHEST_PRESSURE = 4.2e9
"""Contact pressure that defines the static rating of ball bearings, Pa (ISO 76)."""
LEAST_KAPPA = 0.1
"""Least viscosity ratio for which ISO 281 gives a life."""


class Limit(IntFlag):
    """Limits as bits, as in the field `limits_passed` of `TwinState`."""

    LIFE_LOAD = 1
    STATIC_LOAD = 2
    PRESSURE = 4
    FILM = 8
    CLEARANCE = 16
    SKIDDING = 32


class ExceededLimits(NamedTuple):
    """Limits that are exceeded."""

    which: Limit
    sentences: tuple[str, ...]
    """One sentence per limit, with value, limit and consequence."""


class OperatingPoint(NamedTuple):
    """Loads of a bearing and the quantities that limit them."""

    load: float
    """Radial load, N."""
    equivalent: float
    """Result of `life.equivalent_load`, which determines the life, N."""
    dynamic_rating: float
    """N."""
    static_rating: float
    """N."""
    pressure: float
    """Contact pressure of the most loaded ball at rest, Pa."""
    kappa: float
    """Viscosity ratio."""
    shaft_hz: float
    """Shaft speed, Hz; at rest the limit of the film does not apply."""
    thermal_clearance: float
    """Radial clearance at the ring temperatures, m."""
    model_clearance: float
    """Radial clearance that the model uses, m."""
    ring_difference: float
    """Inner minus outer ring temperature, K."""
    skids: bool
    """Whether the drag of the oil exceeds the traction of the balls."""


_NOTHING = ExceededLimits(Limit(0), ())
_LIFE_LOAD, _STATIC_LOAD, _PRESSURE, _FILM, _CLEARANCE, _SKIDDING = (int(each) for each in Limit)


def which_limits(point: OperatingPoint) -> int:
    """
    Return the exceeded limits as bits of `Limit`; can be compiled.

    >>> clearances = 5e-6, 5e-6
    >>> point = OperatingPoint(7.5e3, 7.5e3, 14e3, 7850.0, 2e9, 1.0, 25.0, *clearances, 0.0, False)
    >>> which_limits(point)
    1

    """
    of, bits = point, 0
    if of.equivalent > 0.5 * of.dynamic_rating:
        bits |= _LIFE_LOAD
    if of.equivalent > of.static_rating:
        bits |= _STATIC_LOAD
    if of.pressure > HIGHEST_PRESSURE:
        bits |= _PRESSURE
    if of.shaft_hz > 0.0 and of.kappa < LEAST_KAPPA:
        bits |= _FILM
    if of.thermal_clearance != of.model_clearance:
        bits |= _CLEARANCE
    if of.skids:
        bits |= _SKIDDING
    return bits


def exceeded_limits(point: OperatingPoint, bits: int) -> ExceededLimits:
    """
    Return the limits in ``bits``, see `which_limits`, with a sentence for each.

    Examples
    --------
    >>> point = OperatingPoint(7.5e3, 7.5e3, 14e3, 7850.0, 2e9, 1.0, 25.0, 5e-6, 5e-6, 0.0, False)
    >>> exceeded_limits(point, which_limits(point)).sentences[0]
    'no life: the load of 7.5 kN exceeds half the dynamic rating of 14 kN, where ISO 281 ends'

    """
    if not bits:
        return _NOTHING
    load, equivalent, dynamic_rating, static_rating, pressure, kappa, shaft_hz = point[:7]
    left, used, apart, _ = point[7:]
    pressed = f'the load of {load * 1e-3:g} kN'
    if not math.isclose(load, equivalent, rel_tol=0.05):
        pressed += f' (equivalent to {equivalent * 1e-3:.3g} kN with this clearance)'
    said = {
        Limit.LIFE_LOAD: f'no life: {pressed} exceeds half the dynamic rating of '
        f'{dynamic_rating * 1e-3:g} kN, where ISO 281 ends',
        Limit.STATIC_LOAD: f'no life: {pressed} exceeds the static rating of '
        f'{static_rating * 1e-3:g} kN, above which balls and races deform permanently',
        Limit.PRESSURE: f'the contacts yield: {pressure * 1e-9:.1f} GPa under the hardest '
        f'pressed ball exceed {HIGHEST_PRESSURE * 1e-9:g} GPa (ISO 76), and the twin takes them '
        'as elastic',
        Limit.FILM: f'no life: the viscosity ratio of {kappa:.2g} is below {LEAST_KAPPA:g}, '
        'where ISO 281 ends: the oil is too thin or the shaft too slow for a film',
        Limit.CLEARANCE: f'the bearing {"would seize" if left < used else "hangs loose"}: an '
        f'inner ring {apart:+.0f} K from the outer one leaves a radial clearance of '
        f'{left * 1e6:.1f} um, the model goes on with {used * 1e6:g} um',
        Limit.SKIDDING: f'the balls skid: a load of {load:g} N is too small at {shaft_hz:g} Hz '
        f'for this oil; the model goes on with a cage slip of {HIGHEST_SLIP:.0%}',
    }
    return ExceededLimits(Limit(bits), tuple(text for limit, text in said.items() if limit & bits))
