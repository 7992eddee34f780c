# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
The coefficients of the equations of motion at given temperatures and speed, compiled.

Stiffness, defect depth, clearance, slip and the foot of the shaft's spring, and beside them what
the lubricant does. The formulas live in `bearing_twin.thermal` as plain functions; here they are
put together for one bearing, in a form that a fleet evaluates a thousand times a block. The
equations themselves, the contact law among them, are in `model`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import contact_pressure
from bearing_twin.dynamics.compiled import compiled
from bearing_twin.dynamics.layout import COS, SIN
from bearing_twin.dynamics.model import contact_law
from bearing_twin.dynamics.parameters import SLIP_MODELS
from bearing_twin.dynamics.statics import (
    equilibrium,
    healthy_balls,
    spring_position,
    Supports,
    supports,
    upwards,
)
from bearing_twin.thermal import friction, gcr15, life, lubricant, network, slip
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters


FloatArray = npt.NDArray[np.float64]

# The name after the last of a list is their number.
_ROWS = range(99)

# What `evaluate` gives. The first, INPUTS of them, are what the kernel ramps.
K_B, DEPTH, CLEARANCE, SHAFT_HZ, SLIP, FOOT_X, FOOT_Y, INPUTS, *_ = _ROWS
(
    ALPHA, HARDNESS, FRICTION, BETA0, INNER, OUTER, VISCOSITY, KAPPA, MOMENT, EQUIVALENT, LIFE,
    THERMAL_GAP, CONDITION_SIZE, *_,
) = _ROWS[INPUTS:]  # fmt: skip

# What it takes: one row of constants a bearing.
(
    PHYSICAL, K_B0, CLEARANCE0, LOAD, UP_X, UP_Y, ACROSS, SKEW, ALONG, ASIDE, N_BALLS,
    SLIP_MODEL, SLIP0, PRESSED, COSINE, D_BALL, GAMMA, ALPHA_UNIT, EXPANDS,
    DELTA_H, DELTA_MU, T0, H0, MU0, D_PITCH, D_MEAN, SECTION, ASTM_A, ASTM_B, REPLENISHMENT,
    BOUNDARY, FILM, CONTAMINATION, ROLLING, SLIDING, RATING, STATIC, LIMIT, CAPACITY, RING_TO_RING,
    RING_TO_SHAFT, AMBIENT, SHAFT_RATIO, LEAST_GAP, MOST_GAP,
    LAW_SIZE, *_,
) = _ROWS  # fmt: skip

_CONSTANT, _MU_PROPORTIONAL, _TRACTION = (
    SLIP_MODELS.index(name) for name in ('constant', 'mu_proportional', 'traction')
)

_viscosity = compiled()(lubricant.viscosity)
_rated_viscosity = compiled()(lubricant.rated_viscosity)
_sliding_friction = compiled()(friction.sliding_friction)
_metallic_share = compiled()(friction.metallic_share)
_friction_moment = compiled()(friction.friction_moment)
_power_loss = compiled()(friction.power_loss)
_clearance_change = compiled()(network.clearance_change)
_relative_modulus = compiled()(network.relative_modulus)
_inner_ring_target = compiled()(network.inner_ring_target)
_inner_ring_step = compiled()(network.inner_ring_step)
_beta0 = compiled()(gcr15.beta0)
_equivalent_load = compiled()(life.equivalent_load)
_life_factor = compiled()(life.life_factor)
_life_hours = compiled()(life.life_hours)
_drag = compiled()(slip.drag)
_film_slope = compiled()(slip.film_slope)
_traction = compiled()(slip.traction)


def law_table(p: TwinParameters) -> FloatArray:
    """
    Return the row of constants that :func:`evaluate` takes.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> float(law_table(preset('incipient'))[LOAD])
    500.0

    """
    row = np.zeros(LAW_SIZE)
    row[PHYSICAL] = p.thermal_mode == 'physical'
    row[K_B0], row[CLEARANCE0], row[LOAD] = p.k_b0, p.clearance, p.load
    (row[ACROSS], row[SKEW], row[ALONG]), row[ASIDE] = supports(p)
    row[UP_X], row[UP_Y] = upwards(p)
    row[N_BALLS], row[D_PITCH] = p.bearing.n_balls, p.bearing.d_pitch
    row[D_MEAN], row[SECTION] = p.bearing.mean_diameter, friction.section_height(p.bearing)
    row[SLIP_MODEL], row[SLIP0] = SLIP_MODELS.index(p.slip_law), p.slip
    # Mean pressure under 1 N, in the mean of both contacts: two thirds of the greatest one.
    inner, outer = (contact_pressure(p.bearing, 1.0, race=race) for race in ('inner', 'outer'))
    row[PRESSED], row[COSINE] = math.sqrt(inner * outer) / 1.5, math.cos(p.bearing.contact_angle)
    row[D_BALL], row[GAMMA] = p.bearing.d_ball, p.bearing.gamma
    row[ALPHA_UNIT], row[T0] = p.beta0.alpha_unit, p.beta0.reference_temperature
    row[[EXPANDS, DELTA_H, DELTA_MU, H0, MU0]] = p.beta0.weights
    oil, thermal = p.lubricant, p.thermal_network
    row[[ASTM_A, ASTM_B]] = oil.astm_constants
    row[REPLENISHMENT], row[CONTAMINATION] = oil.replenishment, oil.contamination
    row[BOUNDARY], row[FILM] = oil.boundary_friction, oil.film_friction
    row[[ROLLING, SLIDING]] = friction.SERIES[
        p.friction_series or p.bearing.series or friction.UNKNOWN_SERIES
    ]
    row[RATING] = p.dynamic_rating or life.dynamic_rating(p.bearing)
    row[STATIC] = life.static_rating(p.bearing)
    row[LIMIT] = p.fatigue_limit or life.fatigue_limit(p.bearing)
    row[CAPACITY] = thermal.inner_capacity
    row[RING_TO_RING], row[RING_TO_SHAFT] = thermal.ring_to_ring, thermal.ring_to_shaft
    row[AMBIENT], row[SHAFT_RATIO] = thermal.ambient, thermal.shaft_ratio
    row[LEAST_GAP], row[MOST_GAP] = network.clearance_limits(p.bearing.d_pitch)
    return row


@compiled()
def evaluate(law: FloatArray, outer: float, inner: float, hz: float, out: FloatArray) -> None:
    """
    Fill ``out`` (CONDITION_SIZE) for ring temperatures in degC and a shaft speed in Hz.

    In the paper's mode ``inner`` is not used, the ring temperatures are NaN, and the lubricant has
    the one temperature measured. In the physical mode the clearance that the equations use is
    held inside the limits of `thermal.network`; what the temperatures leave stands beside it.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> law, out = law_table(preset('paper')), np.empty(CONDITION_SIZE)
    >>> evaluate(law, 110.0, 110.0, 25.0, out)
    >>> round(float(out[BETA0]), 3)
    1.13

    """
    alpha = np.interp(outer, gcr15.TEMPERATURES, gcr15.EXPANSION_TABLE) * law[ALPHA_UNIT]
    hardness = np.interp(outer, gcr15.TEMPERATURES, gcr15.HARDNESS_TABLE)
    mu = np.interp(outer, gcr15.TEMPERATURES, gcr15.FRICTION_TABLE)
    out[ALPHA], out[HARDNESS], out[FRICTION], out[SHAFT_HZ] = alpha, hardness, mu, hz
    if law[PHYSICAL] == 0.0:
        weights = (law[EXPANDS], law[DELTA_H], law[DELTA_MU], law[H0], law[MU0])
        factor = _beta0(outer - law[T0], alpha, hardness, mu, weights)
        out[K_B], out[DEPTH], out[BETA0] = factor * law[K_B0], factor, factor
        out[CLEARANCE] = out[THERMAL_GAP] = law[CLEARANCE0]
        # The paper knows one temperature; the lubricant, and with it the life, needs no more.
        out[INNER] = out[OUTER] = math.nan
        _lubricate(law, outer, outer, hz, out)
    else:
        out[DEPTH] = out[BETA0] = 1.0
        out[INNER], out[OUTER] = inner, outer
        _fit(law, outer, inner, out)
        _lubricate(law, outer, inner, hz, out)
    held = Supports((law[ACROSS], law[SKEW], law[ALONG]), law[ASIDE])
    spring = spring_position(law[LOAD], out[K_B], out[CLEARANCE], held, int(law[N_BALLS]))
    out[FOOT_X] = law[UP_X] * spring + law[UP_Y] * law[ASIDE]
    out[FOOT_Y] = law[UP_Y] * spring - law[UP_X] * law[ASIDE]
    model, out[SLIP] = law[SLIP_MODEL], 0.0
    if model == _CONSTANT:
        out[SLIP] = law[SLIP0]
    elif model == _MU_PROPORTIONAL:
        out[SLIP] = law[SLIP0] * mu / law[MU0]
    elif model == _TRACTION:
        out[SLIP] = _slip(law, out)


@compiled()
def skids(law: FloatArray, values: FloatArray) -> bool:
    """
    Whether the traction of the balls does not suffice; ``values`` of `evaluate`.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> law = law_table(preset('paper', thermal_mode='physical', load=20.0))
    >>> values = np.empty(CONDITION_SIZE)
    >>> evaluate(law, 20.0, 20.0, 50.0, values)
    >>> skids(law, values)
    True

    """
    return bool(law[SLIP_MODEL] == _TRACTION and values[SLIP] >= slip.HIGHEST_SLIP)


@compiled()
def _foot(law: FloatArray, values: FloatArray) -> tuple[float, float]:
    """Foot of the shaft's spring in the load's frame, m."""
    x, y, up_x, up_y = values[FOOT_X], values[FOOT_Y], law[UP_X], law[UP_Y]
    return up_y * x - up_x * y, up_x * x + up_y * y


@compiled()
def _slip(law: FloatArray, values: FloatArray) -> float:
    """Slip at which the balls' traction is the drag, see `thermal.slip`: Newton from below."""
    hz, n, clearance = values[SHAFT_HZ], int(law[N_BALLS]), values[CLEARANCE]
    if hz == 0.0:
        return 0.0
    rpm, nu, race = 60.0 * hz, values[VISCOSITY], law[D_PITCH] * (1.0 - law[GAMMA])
    braked, metallic = (_drag(rpm, nu, law[D_MEAN], race), _metallic_share(rpm, nu, law[D_MEAN]))
    rolling = 0.5 * math.pi * hz * race * (1.0 + law[GAMMA])
    # Force, mean pressure and film of the loaded balls, of the mean of two cage positions.
    pressed, loaded = np.empty((2 * n, 3)), 0
    compliance, foot = (law[ACROSS], law[SKEW], law[ALONG]), _foot(law, values)
    for half in range(2):
        balls = healthy_balls((half / n - 0.5) * math.pi, clearance, n)
        x, y, _, _ = equilibrium(foot, values[K_B], compliance, balls, foot)
        for k in range(n):
            delta = x * balls[COS, k] + y * balls[SIN, k] - clearance
            if delta > 0.0:
                force = contact_law(delta, values[K_B])[0] / law[COSINE]
                pressure = law[PRESSED] * force ** (1.0 / 3.0)
                slope = _film_slope(pressure, force, nu, rolling, law[D_BALL])
                pressed[loaded] = force, pressure, slope
                loaded += 1
    slid = 0.0
    for _ in range(100):
        given, growth = 0.0, 0.0
        for k in range(loaded):
            force, pressure, slope = pressed[k, 0], pressed[k, 1], pressed[k, 2]
            mu, rise = _traction(slid, pressure, slope, metallic, law[BOUNDARY])
            given += force * mu
            growth += force * rise
        step = (braked - given) / growth
        slid += step
        if not (step > 1e-12 * slid and slid < slip.HIGHEST_SLIP):
            break
    return min(slid, slip.HIGHEST_SLIP)


@compiled()
def heaviest(law: FloatArray, values: FloatArray) -> float:
    """
    Radial force on a ball that stands in the direction of the load, N; ``values`` of `evaluate`.

    Examples
    --------
    Of 3.2 kN a ball of eight bears somewhat less than 5/8:

    >>> from bearing_twin.dynamics import preset
    >>> law, values = law_table(preset('paper')), np.empty(CONDITION_SIZE)
    >>> evaluate(law, 20.0, 20.0, 25.0, values)
    >>> round(heaviest(law, values))
    1832

    """
    balls = healthy_balls(-0.5 * math.pi, values[CLEARANCE], int(law[N_BALLS]))
    compliance, foot = (law[ACROSS], law[SKEW], law[ALONG]), _foot(law, values)
    _, y, _, _ = equilibrium(foot, values[K_B], compliance, balls, foot)
    force: float = contact_law(max(-y - values[CLEARANCE], 0.0), values[K_B])[0]
    return force


@compiled()
def _fit(law: FloatArray, outer: float, inner: float, out: FloatArray) -> None:
    """Contact stiffness and clearance that the rings' temperatures leave."""
    out[K_B] = law[K_B0] * _relative_modulus(0.5 * (inner + outer))
    gap = law[CLEARANCE0] + _clearance_change(inner, outer, law[D_PITCH])
    out[THERMAL_GAP] = gap
    out[CLEARANCE] = min(max(gap, law[LEAST_GAP]), law[MOST_GAP])


@compiled()
def _lubricate(law: FloatArray, outer: float, inner: float, hz: float, out: FloatArray) -> None:
    """Viscosity between the rings' temperatures, kappa, friction moment and life."""
    load = _equivalent_load(law[LOAD], out[K_B], out[CLEARANCE], int(law[N_BALLS]))
    # The friction model knows no preload: under one this is the least that it adds.
    rubbing = max(law[LOAD], load) if out[CLEARANCE] < 0.0 else law[LOAD]
    rpm = 60.0 * hz
    nu = _viscosity(0.5 * (inner + outer), law[ASTM_A], law[ASTM_B])
    mu = _sliding_friction(_metallic_share(rpm, nu, law[D_MEAN]), law[BOUNDARY], law[FILM])
    kappa = nu / _rated_viscosity(rpm, law[D_MEAN])
    out[VISCOSITY], out[KAPPA], out[EQUIVALENT] = nu, kappa, load
    out[MOMENT] = _friction_moment(
        rpm, nu, rubbing, law[D_MEAN], law[SECTION], law[ROLLING], law[SLIDING],
        law[REPLENISHMENT], mu,
    )  # fmt: skip
    factor = _life_factor(kappa, law[CONTAMINATION] * law[LIMIT] / load)
    out[LIFE] = _life_hours(factor, load, rpm, law[RATING], law[STATIC])


@compiled()
def inner_temperature(
    law: FloatArray, outer: float, inner: float, hz: float, duration: float
) -> float:
    """
    Inner ring temperature after ``duration`` s, degC; the steady state if it is infinite.

    It is held inside the limits of `thermal.network`.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> law = law_table(preset('incipient', thermal_mode='physical'))
    >>> round(inner_temperature(law, 60.0, 60.0, 25.0, 1.0), 1)
    60.4
    >>> round(inner_temperature(law, 60.0, 60.0, 25.0, math.inf), 1)
    63.3

    """
    out = np.zeros(CONDITION_SIZE)
    start = inner if duration < math.inf else outer
    for _ in range(1 if duration < math.inf else 30):
        _fit(law, outer, start, out)
        _lubricate(law, outer, start, hz, out)
        shaft = law[AMBIENT] + law[SHAFT_RATIO] * (outer - law[AMBIENT])
        target = _inner_ring_target(
            outer, shaft, _power_loss(out[MOMENT], 60.0 * hz), law[RING_TO_RING],
            law[RING_TO_SHAFT],
        )  # fmt: skip
        start = (
            _inner_ring_step(
                inner, target, duration, law[CAPACITY], law[RING_TO_RING], law[RING_TO_SHAFT]
            )
            if duration < math.inf
            else target
        )
        start = min(max(start, network.RING_LOW), network.RING_HIGH)
    return start
